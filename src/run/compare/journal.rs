//! What an unfinished comparison has solved, in `compare.part.bin`: every solve in full, written when it is done, from
//! which it goes on.

use std::collections::VecDeque;
use std::path::Path;

use super::PART;
use crate::bytes::{NotWhatWasWritten, Reader, Writer};
use crate::compare::{Method, Solved, Work};
use crate::run::RunError;
use crate::run::journal::{Log, read_density, read_report, write_density, write_report};
use crate::system::Family;

/// The solves of a comparison, open for more.
#[derive(Debug)]
pub struct CompareJournal {
    log: Log,
    family: Family,
    stored: VecDeque<Vec<Solved>>,
}

impl CompareJournal {
    pub(super) fn create(home: &Path, of: &str, family: &Family) -> Result<Self, RunError> {
        Ok(Self {
            log: Log::create(home.join(PART), of)?,
            family: family.clone(),
            stored: VecDeque::new(),
        })
    }

    pub(super) fn open(
        home: &Path,
        of: &str,
        family: &Family,
        methods: &[&'static str],
    ) -> Result<Self, RunError> {
        let mut stored = VecDeque::new();
        let log = Log::open(home.join(PART), of, &mut |reader| {
            let mut step = Vec::new();
            for _ in 0..reader.count()? {
                step.push(read(reader, family, methods)?);
            }
            stored.push_back(step);
            Ok(())
        })?;
        Ok(Self {
            log,
            family: family.clone(),
            stored,
        })
    }

    /// Solves that are stored and not taken yet.
    pub fn waiting(&self) -> usize {
        self.stored.len()
    }

    /// The next solve that is stored.
    pub fn take(&mut self) -> Option<Vec<Solved>> {
        self.stored.pop_front()
    }

    /// Writes a solve, by one method or by those that share samples.
    ///
    /// # Errors
    /// [`RunError::Write`].
    pub fn keep(&mut self, solved: &[Solved]) -> Result<(), RunError> {
        let family = &self.family;
        self.log.append(|writer| {
            writer.count(solved.len());
            for one in solved {
                write(writer, family, one);
            }
        })
    }
}

fn write(writer: &mut Writer, family: &Family, solved: &Solved) {
    writer.text(solved.method.name());
    write_report(writer, family, &solved.report);
    let work = &solved.work;
    writer
        .number(work.preparation_seconds)
        .number(work.sampling_seconds)
        .number(work.solve_seconds);
    writer.count(work.steps as usize).count(work.samples);
    writer.optional(work.bytes).count(work.cells);
    writer
        .optional(solved.time_step)
        .optional(solved.share_outside);
    writer.count(solved.densities.len());
    for density in &solved.densities {
        write_density(writer, density);
    }
}

fn read(
    reader: &mut Reader<'_>,
    family: &Family,
    methods: &[&'static str],
) -> Result<Solved, NotWhatWasWritten> {
    let name = reader.text()?;
    let mut known = Method::ALL.into_iter();
    let method = known.find(|method| method.name() == name);
    let report = read_report(reader, family, methods)?;
    let work = Work {
        preparation_seconds: reader.number()?,
        sampling_seconds: reader.number()?,
        solve_seconds: reader.number()?,
        steps: reader.count()? as u64,
        samples: reader.count()?,
        bytes: reader.optional()?,
        cells: reader.count()?,
    };
    let (time_step, share_outside) = (reader.optional()?, reader.optional()?);
    let mut densities = Vec::new();
    for _ in 0..reader.count()? {
        densities.push(read_density(reader)?);
    }
    Ok(Solved {
        method: method.ok_or(NotWhatWasWritten)?,
        status: report.status,
        report,
        work,
        time_step,
        share_outside,
        densities,
    })
}

//! A solve in full, as bytes and back.

use std::sync::Arc;

use super::profile::{read_profile, write_profile};
use crate::bytes::{NotWhatWasWritten, Reader, Writer};
use crate::continuation::{Finding, Measure, PointStatus, Solution, SolveReport};
use crate::density::{Density, EstimatedDensity, Kink, Observable, Structure, Variants};
use crate::run::findings::{findings_cell, parse_findings};
use crate::space::Axis;
use crate::system::Family;

/// What a session gave at a value, and what it remembers of it.
#[derive(Debug)]
pub(super) struct Record {
    pub(super) value: f64,
    pub(super) seconds: f64,
    /// The solution, or what the method said instead.
    pub(super) solved: Result<Found, String>,
    pub(super) memory: Vec<u8>,
}

/// A solution that can be kept: it answers no questions.
#[derive(Debug, Clone)]
pub(super) struct Found {
    pub(super) report: SolveReport,
    pub(super) densities: Vec<EstimatedDensity>,
}

impl Found {
    /// What a solution holds, which is still to be handed on.
    pub(super) fn copied(solution: &Solution<'_>) -> Self {
        Self {
            report: solution.report.clone(),
            densities: solution.densities.clone(),
        }
    }
}

impl From<Solution<'_>> for Found {
    fn from(solution: Solution<'_>) -> Self {
        Self {
            report: solution.report,
            densities: solution.densities,
        }
    }
}

impl From<Found> for Solution<'static> {
    fn from(found: Found) -> Self {
        Self {
            report: found.report,
            densities: found.densities,
            sensitivity: None,
        }
    }
}

impl Record {
    /// All of it.
    pub(super) fn write(&self, writer: &mut Writer, family: &Family) {
        writer.number(self.value).number(self.seconds);
        writer.flag(self.solved.is_ok());
        match &self.solved {
            Ok(solution) => write_solution(writer, family, solution),
            Err(words) => {
                writer.text(words);
            }
        }
        writer.bytes(&self.memory);
    }

    /// What was written of a family's density.
    pub(super) fn read(
        reader: &mut Reader<'_>,
        family: &Family,
        methods: &[&'static str],
    ) -> Result<Self, NotWhatWasWritten> {
        let (value, seconds) = (reader.number()?, reader.number()?);
        let solved = match reader.flag()? {
            true => Ok(read_solution(reader, family, methods)?),
            false => Err(reader.text()?.to_owned()),
        };
        Ok(Self {
            value,
            seconds,
            solved,
            memory: reader.bytes()?.to_vec(),
        })
    }
}

fn write_solution(writer: &mut Writer, family: &Family, solution: &Found) {
    write_report(writer, family, &solution.report);
    writer.count(solution.densities.len());
    for density in &solution.densities {
        write_density(writer, density);
    }
}

fn read_solution(
    reader: &mut Reader<'_>,
    family: &Family,
    methods: &[&'static str],
) -> Result<Found, NotWhatWasWritten> {
    let report = read_report(reader, family, methods)?;
    let mut solution = Found::from(Solution::without_density(report));
    for _ in 0..reader.count()? {
        solution.densities.push(read_density(reader)?);
    }
    Ok(solution)
}

pub(in crate::run) fn write_report(writer: &mut Writer, family: &Family, report: &SolveReport) {
    writer.text(report.status.word()).text(report.method);
    writer.count(report.iterations).number(report.residual);
    writer.number(report.solver_error);
    writer.count(report.measures.len());
    for one in &report.measures {
        writer.text(&one.name).number(one.value);
        writer.optional(one.error).text(&one.unit);
    }
    writer.count(report.findings.len());
    for finding in &report.findings {
        let told = match finding {
            Finding::Told(words) => Some(words),
            _ => None,
        };
        writer.flag(told.is_some());
        match told {
            Some(words) => writer.text(words),
            None => writer.text(&findings_cell(family, std::slice::from_ref(finding))),
        };
    }
}

pub(in crate::run) fn read_report(
    reader: &mut Reader<'_>,
    family: &Family,
    methods: &[&'static str],
) -> Result<SolveReport, NotWhatWasWritten> {
    let word = reader.text()?;
    let mut known = PointStatus::ALL.into_iter();
    let status = known.find(|status| status.word() == word);
    let name = reader.text()?;
    let method = methods.iter().find(|method| **method == name);
    let mut report = SolveReport::solved(method.ok_or(NotWhatWasWritten)?);
    report.status = status.ok_or(NotWhatWasWritten)?;
    report.iterations = reader.count()?;
    report.residual = reader.number()?;
    report.solver_error = reader.number()?;
    for _ in 0..reader.count()? {
        report.measures.push(Measure {
            name: reader.text()?.to_owned(),
            value: reader.number()?,
            error: reader.optional()?,
            unit: reader.text()?.to_owned(),
        });
    }
    for _ in 0..reader.count()? {
        if reader.flag()? {
            let words = reader.text()?.to_owned();
            report.findings.push(Finding::Told(words));
        } else {
            let found = parse_findings(family, reader.text()?);
            report
                .findings
                .extend(found.map_err(|_| NotWhatWasWritten)?);
        }
    }
    Ok(report)
}

/// With the cells that it is on: those of a quantity, of a series or of a finer source are not the run's.
pub(in crate::run) fn write_density(writer: &mut Writer, estimate: &EstimatedDensity) {
    let numbers = estimate.observable.axes();
    writer.count(numbers.len());
    for (number, axis) in numbers.into_iter().zip(&estimate.density.axes) {
        writer.count(number);
        axis.write(writer);
    }
    writer.numbers(&estimate.density.values);
    writer.numbers(&estimate.standard_error);
    match &estimate.variants {
        Variants::None => {
            writer.count(0);
        }
        Variants::Scheme(second) => {
            writer.count(1).numbers(second);
        }
        Variants::Jackknife(replicates) => {
            writer.count(2).count(replicates.len());
            for replicate in replicates {
                writer.numbers(replicate);
            }
        }
    }
    let Structure {
        centre,
        kinks,
        profile,
    } = &estimate.structure;
    writer.flag(centre.is_some());
    writer.numbers(centre.as_deref().unwrap_or(&[]));
    writer.count(kinks.len());
    for kink in kinks {
        writer.count(kink.axis).number(kink.at).numbers(&kink.jump);
    }
    writer.flag(profile.is_some());
    if let Some(profile) = profile {
        write_profile(writer, profile);
    }
    writer.number(estimate.negligible);
}

pub(in crate::run) fn read_density(
    reader: &mut Reader<'_>,
) -> Result<EstimatedDensity, NotWhatWasWritten> {
    let (mut numbers, mut axes) = (Vec::new(), Vec::new());
    for _ in 0..reader.count()? {
        numbers.push(reader.count()?);
        axes.push(Axis::read(reader)?);
    }
    let observable = match numbers[..] {
        [axis] => Observable::Marginal(axis),
        [first, second] => Observable::Joint(first, second),
        _ => return Err(NotWhatWasWritten),
    };
    let cells: usize = axes.iter().map(Axis::count).product();
    let values = of_length(reader.numbers()?, cells)?;
    let standard_error = of_length(reader.numbers()?, cells)?;
    let variants = match reader.count()? {
        0 => Variants::None,
        1 => Variants::Scheme(of_length(reader.numbers()?, cells)?),
        2 => {
            let mut replicates = Vec::new();
            for _ in 0..reader.count()? {
                replicates.push(of_length(reader.numbers()?, cells)?);
            }
            Variants::Jackknife(replicates)
        }
        _ => return Err(NotWhatWasWritten),
    };
    let has_centre = reader.flag()?;
    let centre = Some(reader.numbers()?).filter(|_| has_centre);
    let mut kinks = Vec::new();
    for _ in 0..reader.count()? {
        kinks.push(Kink {
            axis: reader.count()?,
            at: reader.number()?,
            jump: reader.numbers()?,
        });
    }
    let has_profile = reader.flag()?;
    let profile = has_profile.then(|| read_profile(reader)).transpose()?;
    Ok(EstimatedDensity {
        observable,
        density: Density { axes, values },
        standard_error,
        variants,
        structure: Structure {
            centre,
            kinks,
            profile: profile.map(Arc::new),
        },
        negligible: reader.number()?,
    })
}

fn of_length(numbers: Vec<f64>, length: usize) -> Result<Vec<f64>, NotWhatWasWritten> {
    match numbers.len() == length {
        true => Ok(numbers),
        false => Err(NotWhatWasWritten),
    }
}

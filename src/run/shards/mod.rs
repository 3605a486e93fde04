//! The shards of a sweep: runs of their own in `shards/1-of-4`, `shards/2-of-4`, … of a run's folder, each with its own
//! lock, and read together.

use std::collections::HashMap;
use std::collections::hash_map::Entry;
use std::path::{Path, PathBuf};

use rayon::prelude::*;

use super::holding_shard::HoldingShard;
use super::kept_detections::give_detections;
use super::place::{SHARDS, shard_folder};
use super::{Ending, Journal, RunError, StoredRun};
use crate::continuation::{CheckedIndicator, Point, Shard, Subject};
use crate::space::{Axis, CellSpace};
use crate::system::Family;

/// The shards of one sweep, as far as they are there.
#[derive(Debug)]
pub(crate) struct Shards {
    path: PathBuf,
    of: usize,
    /// Those with points, in the order of their numbers.
    runs: Vec<StoredRun>,
    /// Those that are not complete, with what there is of them in words.
    missing: Vec<(Shard, String)>,
}

/// Shards that are read side by side: their files are read once for the densities, and once for the checksums, then
/// from what the system still has of them in memory.
const AT_ONCE: usize = 8;

/// What shards have solved and seen.
#[derive(Debug, Default)]
pub(crate) struct Gathered {
    /// All points, each value once.
    pub(crate) points: Vec<Point>,
    /// The shards that hold their densities.
    pub(crate) holders: Holders,
    /// What was seen in their checks; `None` where there were none.
    pub(crate) checks: Option<Vec<CheckedIndicator>>,
}

/// Which shards hold the densities of which points.
#[derive(Debug, Default)]
pub(crate) struct Holders {
    /// In the order of their numbers; `None` of one that nobody could know again.
    shards: Vec<Option<HoldingShard>>,
    /// By the bits of the values of points: the place of the shard that a point is of.
    points: HashMap<u64, usize>,
}

impl Holders {
    /// Whether these are the shards that an unfinished merge in a folder has begun with: of one that was computed anew
    /// since, its tables tell what the shard does not hold any more.
    ///
    /// # Errors
    /// [`RunError::Journal`], [`RunError::Read`].
    pub(crate) fn are_those_of(&self, run: &Path) -> Result<bool, RunError> {
        let Some(journal) = Journal::look(run)? else {
            return Ok(true);
        };
        let begun_with = journal.shards::<Option<HoldingShard>>()?;
        let is_same =
            |(here, there): (&Option<HoldingShard>, &Option<HoldingShard>)| match (here, there) {
                (Some(here), Some(there)) => here.is(there),
                (here, there) => here.is_none() && there.is_none(),
            };
        // One that was stopped before it named its shards has none of their points.
        let is_begun = !begun_with.is_empty();
        let mut pairs = self.shards.iter().zip(&begun_with);
        Ok(!is_begun || self.shards.len() == begun_with.len() && pairs.all(is_same))
    }

    /// Tells a journal of the shards.
    ///
    /// # Errors
    /// [`RunError::Write`].
    pub(crate) fn tell(&self, journal: &Journal) -> Result<(), RunError> {
        if self.shards.is_empty() {
            return Ok(());
        }
        journal.write_shards(&self.shards)
    }

    /// Keeps a point in a journal if a shard has solved it, and says whether one has.
    ///
    /// # Errors
    /// [`RunError::Write`].
    pub(crate) fn keep(
        &self,
        journal: &Journal,
        family: &Family,
        point: &Point,
    ) -> Result<bool, RunError> {
        let Some(&place) = self.points.get(&point.value.to_bits()) else {
            return Ok(false);
        };
        let holds = self.shards.get(place).is_some_and(Option::is_some);
        journal.write_known(family, point, holds.then_some(place))?;
        Ok(true)
    }
}

impl Shards {
    /// Looks for the shards in the folder of a run. All that are there must be of one sweep.
    ///
    /// # Errors
    /// [`RunError::NoShards`]; [`RunError::MixedShards`] when a sweep was cut into shards in more than one way;
    /// [`RunError::OtherSweep`]; [`RunError::OtherShard`]; as [`StoredRun::open`].
    pub(crate) fn open(path: &Path) -> Result<Self, RunError> {
        let of = count(path)?;
        let (mut runs, mut missing) = (Vec::new(), Vec::new());
        for shard in (1..=of).filter_map(|number| Shard::new(number, of)) {
            let folder = shard_folder(path, shard);
            let run = match StoredRun::open(&folder) {
                Err(RunError::NotARun { .. }) => {
                    missing.push((shard, "not begun".to_owned()));
                    continue;
                }
                run => run?,
            };
            if run.shard() != Some(shard) {
                return Err(RunError::OtherShard { path: folder });
            }
            if run.ending() != Ending::Complete {
                let points = run.points_done().unwrap_or(0);
                missing.push((shard, format!("not done, {points} points so far")));
            }
            runs.push(run);
        }
        if let Some((first, others)) = runs.split_first() {
            for other in others {
                other.check_sweep(first.resolved())?;
            }
        }
        Ok(Self {
            path: path.to_owned(),
            of,
            runs,
            missing,
        })
    }

    /// How many shards the sweep was cut into.
    pub(crate) fn of(&self) -> usize {
        self.of
    }

    /// Shards that are not complete, with what there is of them in words.
    pub(crate) fn missing(&self) -> &[(Shard, String)] {
        &self.missing
    }

    /// Refuses shards that are not all complete.
    ///
    /// # Errors
    /// [`RunError::MissingShards`].
    pub(crate) fn check_complete(&self) -> Result<(), RunError> {
        match self.missing.is_empty() {
            true => Ok(()),
            false => Err(self.lacking()),
        }
    }

    /// A run whose sweep is that of all.
    ///
    /// # Errors
    /// [`RunError::MissingShards`] when none has begun.
    pub(crate) fn any(&self) -> Result<&StoredRun, RunError> {
        self.runs.first().ok_or_else(|| self.lacking())
    }

    fn lacking(&self) -> RunError {
        RunError::MissingShards {
            path: self.path.clone(),
            of: self.of,
            missing: self.missing.clone(),
        }
    }

    /// All that was solved and seen. Of a value at a border, which two shards have, that of the first is taken: it was
    /// solved from its neighbour.
    ///
    /// # Errors
    /// As [`StoredRun::points`] and [`StoredRun::checks`]; [`RunError::Checksums`].
    pub(crate) fn gather(
        &self,
        subject: &Subject,
        cells: (&CellSpace, &[Axis]),
        methods: &[&'static str],
    ) -> Result<Gathered, RunError> {
        // A shard that has just begun has no table yet.
        let begun =
            |run: &&StoredRun| run.points_done() != Some(0) || run.ending() == Ending::Complete;
        let runs: Vec<&StoredRun> = self.runs.iter().filter(begun).collect();
        let read = runs.chunks(AT_ONCE).flat_map(|some| {
            let read = some
                .par_iter()
                .map(|run| read(run, subject, cells, methods));
            read.collect::<Vec<_>>()
        });
        let mut gathered = Gathered::default();
        for (place, one) in read.enumerate() {
            let (shard, points, seen) = one?;
            let holders = &mut gathered.holders;
            holders.shards.push(shard);
            for point in points {
                if let Entry::Vacant(entry) = holders.points.entry(point.value.to_bits()) {
                    entry.insert(place);
                    gathered.points.push(point);
                }
            }
            if let Some(seen) = seen {
                gathered.checks.get_or_insert_default().extend(seen);
            }
        }
        Ok(gathered)
    }
}

/// What is read of a shard: how it is known again where its densities can be read later, its points, and what was seen
/// in its checks.
type Read = (
    Option<HoldingShard>,
    Vec<Point>,
    Option<Vec<CheckedIndicator>>,
);

fn read(
    run: &StoredRun,
    subject: &Subject,
    cells: (&CellSpace, &[Axis]),
    methods: &[&'static str],
) -> Result<Read, RunError> {
    let mut points = run.points(subject, cells, methods)?;
    let shard = run.shard().filter(|_| run.ending() == Ending::Complete);
    let shard = shard.and_then(|shard| HoldingShard::at(run.path(), shard));
    if shard.is_some() {
        give_detections(run.path(), &mut points)?;
    }
    Ok((shard, points, run.checks(subject)?))
}

/// Into how many shards the sweep was cut whose shards are there.
pub(super) fn count(path: &Path) -> Result<usize, RunError> {
    let entries = std::fs::read_dir(path.join(SHARDS));
    let names = entries.into_iter().flatten().flatten();
    let mut counts: Vec<usize> = names
        .filter_map(|entry| {
            let name = entry.file_name().into_string().ok()?;
            let (number, of) = name.split_once("-of-")?;
            Some(Shard::new(number.parse().ok()?, of.parse().ok()?)?.of())
        })
        .collect();
    counts.sort_unstable();
    counts.dedup();
    match counts[..] {
        [] => Err(RunError::NoShards {
            path: path.to_owned(),
        }),
        [of] => Ok(of),
        _ => Err(RunError::MixedShards {
            path: path.join(SHARDS),
            counts,
        }),
    }
}

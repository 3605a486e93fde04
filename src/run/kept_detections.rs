//! What a complete shard has detected in its densities, so that a merge need not detect it again.
//!
//! It is written for the program that reads it, and is of use to the very build that wrote it, on a processor with the
//! same instruction sets: any other one may detect differently in the last digits, and detects anew.

use std::collections::HashMap;
use std::path::Path;

use super::atomic::write_atomically;
use super::checksums::{self, Sums};
use super::place::read;
use super::{Provenance, RunError};
use crate::bytes::{from_bytes, to_bytes};
use crate::continuation::Point;
use crate::topology::Detection;

/// Name of the file.
pub(super) const NAME: &str = "detections.bin";

/// What stands in the file after the words for the program: the bits of values, with what was detected there.
type Kept = Vec<(u64, Vec<Detection>)>;

/// Writes what was detected at points into the folder of a run, and returns the checksum of the file by its name.
///
/// # Errors
/// [`RunError::Write`].
pub(super) fn write_detections(run: &Path, points: &[Point]) -> Result<Sums, RunError> {
    let all = points.iter();
    let kept = all.map(|point| (point.value.to_bits(), &point.detections));
    let kept: Vec<_> = kept.collect();
    let Some(program) = Provenance::of_arithmetic() else {
        return Ok(Sums::new());
    };
    let bytes = to_bytes(&(program, kept));
    write_atomically(&run.join(NAME), &bytes)?;
    Ok(Sums::from([(NAME.to_owned(), checksums::sum(&bytes))]))
}

/// Gives points of a complete run what was detected there; nothing where this program has not detected it, or the run
/// does not know its files.
///
/// # Errors
/// [`RunError::Checksums`].
pub(super) fn give_detections(run: &Path, points: &mut [Point]) -> Result<(), RunError> {
    let known = checksums::read(run)?;
    let Some(wanted) = known.as_ref().and_then(|known| known.get(NAME)) else {
        return Ok(());
    };
    let path = run.join(NAME);
    // Without it detections are made anew.
    let Ok(bytes) = read(&path) else {
        return Ok(());
    };
    // A run with another file in its place is damaged, which is told by whoever reads its tables.
    if checksums::sum(&bytes) != *wanted {
        return Ok(());
    }
    let Ok((program, kept)) = from_bytes::<(String, Kept)>(&bytes) else {
        return Ok(());
    };
    if Provenance::of_arithmetic() != Some(program) {
        return Ok(());
    }
    let mut kept: HashMap<u64, Vec<Detection>> = kept.into_iter().collect();
    for point in points {
        let found = kept.remove(&point.value.to_bits());
        point.detections = found
            .filter(|found| found.len() == point.densities.len())
            .unwrap_or_default();
    }
    Ok(())
}

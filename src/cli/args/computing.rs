//! Arguments of the commands that compute: sweeps and maps, comparisons, curves.

use std::path::PathBuf;

use clap::Args;

use crate::continuation::Shard;
use crate::continuation::curve::CurveOptions;

/// A sweep file with its overrides.
#[derive(Debug, Args)]
pub(crate) struct SweepInput {
    /// Sweep file (TOML)
    pub(crate) file: PathBuf,
    /// Override a key of the file, such as sweep.points=301 (repeatable; the last one counts)
    #[arg(long = "set", value_name = "KEY=VALUE")]
    pub(crate) overrides: Vec<String>,
}

impl SweepInput {
    /// What results are named after: the file's name without folder and ending.
    pub(crate) fn name(&self) -> String {
        let stem = self.file.file_stem();
        let stem = stem.map(|stem| stem.to_string_lossy().into_owned());
        // Dots alone are no name: the folder `..` holds other things.
        stem.filter(|stem| !stem.chars().all(|c| c == '.'))
            .unwrap_or_else(|| "sweep".to_owned())
    }
}

/// How a command works that computes.
#[derive(Debug, Args)]
pub(crate) struct Work {
    /// Threads to use, all if left out; results do not depend on it, only times do
    #[arg(long, value_name = "N", value_parser = threads)]
    pub(crate) threads: Option<usize>,
    /// No progress and no warnings on stderr, results alone
    #[arg(long)]
    pub(crate) quiet: bool,
}

/// How a sweep is run.
#[derive(Debug, Args)]
pub(crate) struct SweepArguments {
    /// Folder for the results [default: output/NAME, after the sweep file]
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
    /// Go on with the run in the folder that was interrupted or killed; a complete one is not run again
    #[arg(long)]
    pub(crate) resume: bool,
    /// Run the K-th of N shards of the sweep alone, in shards/K-of-N of the folder; `pbif merge` puts them together
    #[arg(long, value_name = "K/N", value_parser = shard)]
    pub(crate) shard: Option<Shard>,
    /// How to work.
    #[command(flatten)]
    pub(crate) work: Work,
}

/// How a comparison is run.
#[derive(Debug, Args)]
pub(crate) struct CompareArguments {
    /// Folder for the results [default: output/NAME-compare, after the sweep file]
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
    /// Go on with the comparison in the folder that was interrupted or killed; a complete one is not made again
    #[arg(long)]
    pub(crate) resume: bool,
    /// How to work.
    #[command(flatten)]
    pub(crate) work: Work,
}

/// A curve in a plane of two parameters.
#[derive(Debug, Args)]
pub(crate) struct CurveArguments {
    /// Folder of a run, as `pbif sweep` left it, or a sweep file (TOML), which is swept first
    #[arg(value_name = "RUN|FILE")]
    pub(crate) target: PathBuf,
    /// Label of the P-bifurcation to start from, such as PB1; may be left out where only one can be followed [default:
    /// the rows of `[curve]` in the sweep file]
    #[arg(long, value_name = "LABEL")]
    pub(crate) row: Option<String>,
    /// The second parameter, which the sweep holds [default: that of `[curve]` in the sweep file, and so the box]
    #[arg(long, value_name = "PARAMETER")]
    pub(crate) second: Option<String>,
    /// One end of the box in the second parameter
    #[arg(long, value_name = "VALUE", allow_negative_numbers = true, value_parser = finite)]
    pub(crate) from: Option<f64>,
    /// The other end
    #[arg(long, value_name = "VALUE", allow_negative_numbers = true, value_parser = finite)]
    pub(crate) to: Option<f64>,
    /// Lower end of the box in the swept parameter [default: that of the sweep]
    #[arg(long, value_name = "VALUE", allow_negative_numbers = true, value_parser = finite)]
    pub(crate) first_from: Option<f64>,
    /// Upper end of the box in the swept parameter [default: that of the sweep]
    #[arg(long, value_name = "VALUE", allow_negative_numbers = true, value_parser = finite)]
    pub(crate) first_to: Option<f64>,
    /// Follow this curve alone, not those that start from its points of codimension two
    #[arg(long)]
    pub(crate) alone: bool,
    /// Longest step between points, as a share of the sides of the box
    #[arg(long, value_name = "SHARE", value_parser = share, help = step_help())]
    pub(crate) step: Option<f64>,
    /// Override a key of a sweep file, such as cells.x.count=60; of a run those under detect, locate, figures and curve
    /// (repeatable; the last one counts)
    #[arg(long = "set", value_name = "KEY=VALUE")]
    pub(crate) overrides: Vec<String>,
    /// Folder for the results [default: RUN/curves/ROW-SECOND]
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
    /// Go on with the curves in the folder that were interrupted or killed; complete ones are not followed again
    #[arg(long)]
    pub(crate) resume: bool,
    /// How to work.
    #[command(flatten)]
    pub(crate) work: Work,
}

fn finite(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(value) if f64::is_finite(value) => Ok(value),
        _ if text.starts_with("PB") => Err(format!(
            "allowed: a number; the P-bifurcation to start from is named by `--row {text}`"
        )),
        _ => Err("allowed: a number".to_owned()),
    }
}

/// The help of `--step`, with the default where it stands.
fn step_help() -> String {
    format!(
        "Longest step between points, as a share of the sides of the box [default: {}]",
        CurveOptions::default().largest_step
    )
}

fn share(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(share) if (1e-4..=0.25).contains(&share) => Ok(share),
        _ => Err("allowed: a number from 0.0001 to 0.25".to_owned()),
    }
}

fn threads(text: &str) -> Result<usize, String> {
    match text.parse() {
        Ok(threads @ 1..=4096) => Ok(threads),
        _ => Err("allowed: an integer from 1 to 4096".to_owned()),
    }
}

/// The shard that `K/N` names.
fn shard(text: &str) -> Result<Shard, String> {
    let named = text.split_once('/').and_then(|(number, of)| {
        let of = of.trim().parse().ok().filter(|&of| of <= MOST_SHARDS)?;
        Shard::new(number.trim().parse().ok()?, of)
    });
    named.ok_or_else(|| {
        format!("allowed: K/N, the K-th of N shards, such as 1/4, 2/4, 3/4, 4/4; N is at most {MOST_SHARDS}")
    })
}

/// More shards than any sweep has values worth a process of their own.
const MOST_SHARDS: usize = 100_000;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shards_are_named_by_number_and_count() {
        assert_eq!(shard("2/4").unwrap(), Shard::new(2, 4).unwrap());
        assert_eq!(shard(" 1 / 1 ").unwrap(), Shard::WHOLE);
        for wrong in [
            "",
            "2",
            "0/4",
            "5/4",
            "1/0",
            "-1/4",
            "1/4/2",
            "a/b",
            "1/1000000000000",
        ] {
            assert!(shard(wrong).unwrap_err().contains("such as 1/4"), "{wrong}");
        }
    }
}

//! Arguments of the commands that keep runs: putting shards together.

use std::path::PathBuf;

use clap::Args;

use super::Work;
use crate::continuation::Shard;

pub(super) const MERGE_EXAMPLES: &str = "\
Examples:
  pbif sweep sweeps/coulomb_fc.toml --shard 1/2      on one machine
  pbif sweep sweeps/coulomb_fc.toml --shard 2/2      on another one
  pbif merge output/coulomb_fc                       when both are done
  pbif merge output/coulomb_fc --partial             what is there so far

What the shards have solved is taken from them; what only the whole asks for (a change at their border, a check) is solved. The result is a run
like any other, the same as that of a sweep in one piece within the solver's tolerance. Job scripts: docs/cluster.md

Exit status: 0 done; 1 finished, but some row is unresolved, did not converge or has no steady state, or shards are missing (--partial);
2 bad usage, or shards are missing, nothing written; 130 interrupted: the same command goes on.";

/// Shards that are put together.
#[derive(Debug, Args)]
pub(crate) struct MergeArguments {
    /// Folder whose `shards/` hold the shards: what `pbif sweep --shard` was given with --out, or output/NAME
    pub(crate) run: PathBuf,
    /// Take what is there although shards are missing; nothing is solved, and the run says that it is unfinished
    #[arg(long)]
    pub(crate) partial: bool,
    /// Folder for the run [default: RUN itself]
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
    /// How to work.
    #[command(flatten)]
    pub(crate) work: Work,
}

/// The shard that `K/N` names.
pub(super) fn shard(text: &str) -> Result<Shard, String> {
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

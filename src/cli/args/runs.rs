//! Arguments of the commands that keep runs: listing, showing, exporting, removing them, and putting shards together.

use std::path::PathBuf;

use clap::Args;

use super::Work;
use crate::run::ExportFormat;

pub(super) const MERGE_EXAMPLES: &str = "\
Examples:
  pbif sweep sweeps/coulomb_fc.toml --shard 1/2      on one machine
  pbif sweep sweeps/coulomb_fc.toml --shard 2/2      on another one
  pbif merge output/coulomb_fc                       when both are done
  pbif merge output/coulomb_fc --partial             what is there so far

What the shards have solved is taken from them; what only the whole asks for (a change at their border, a check) is solved. The result is a run
like any other, the same as that of a sweep in one piece within the solver's tolerance. Job scripts: docs/cluster.md

Exit status: 0 done; 1 finished, but some row is unresolved, did not converge or has no steady state, or densities are too
negative for their shape, or shards are missing (--partial); 2 bad usage, or shards are missing, nothing written;
130 interrupted: the same command goes on.";

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

pub(super) const LIST_EXAMPLES: &str = "\
Examples:
  pbif list                     the runs below output/
  pbif list output/coulomb_fc   one run with its earlier versions and shards";

pub(super) const SHOW_EXAMPLES: &str = "\
Examples:
  pbif show output/coulomb_fc
  pbif show output/coulomb_fc --sweep > again.toml   the complete sweep file of the run, every default filled in
  pbif show output/coulomb_fc/previous/1";

pub(super) const CLEAN_EXAMPLES: &str = "\
Examples:
  pbif clean output/coulomb_fc              lists what may go, and asks
  pbif clean output --earlier --yes         every earlier version below output/, without asking

What may go: earlier versions (previous/), unfinished runs, and shards that were merged. Only files that pbif wrote and nobody has changed
since are removed: notes, tables and figures that were changed stay, and are named.

Exit status: 0 removed, or nothing to remove; 1 the answer was no, or a file cannot be removed; 2 cannot ask, or not a run.";

pub(super) const EXPORT_EXAMPLES: &str = "\
Examples:
  pbif export output/coulomb_fc --format netcdf            output/coulomb_fc.nc, for xarray, MATLAB, Octave, Julia, ...
  pbif export output/coulomb_fc --format csv --out tables  a folder with a table a density

Densities (∫ = 1) with their errors, centres and edges of the cells, means and standard deviations, at every value that has a density.
xarray and zarr read the run's densities.zarr as it is. Programs that read a run: examples/python/, examples/octave/";

/// Where runs are looked for.
#[derive(Debug, Args)]
pub(crate) struct ListArguments {
    /// Folder of runs, or of one run
    #[arg(default_value = "output")]
    pub(crate) folder: PathBuf,
}

/// A run that is shown.
#[derive(Debug, Args)]
pub(crate) struct ShowArguments {
    /// Folder of a run, as `pbif sweep` left it
    pub(crate) run: PathBuf,
    /// Print the complete sweep file of the run alone
    #[arg(long)]
    pub(crate) sweep: bool,
    /// Print the sweep file as it was typed alone, word for word, with what was set as comments behind it
    #[arg(long, conflicts_with = "sweep")]
    pub(crate) typed: bool,
}

/// Runs that are removed.
#[derive(Debug, Args)]
pub(crate) struct CleanArguments {
    /// Folder of a run, or of several
    pub(crate) folder: PathBuf,
    /// Earlier versions alone
    #[arg(long)]
    pub(crate) earlier: bool,
    /// Unfinished runs alone
    #[arg(long)]
    pub(crate) unfinished: bool,
    /// Do not ask
    #[arg(long)]
    pub(crate) yes: bool,
}

/// A run that is written for other programs.
#[derive(Debug, Args)]
pub(crate) struct ExportArguments {
    /// Folder of a run, as `pbif sweep` left it
    pub(crate) run: PathBuf,
    /// What to write
    #[arg(long, value_name = "FORMAT", value_parser = format, default_value = "netcdf")]
    pub(crate) format: ExportFormat,
    /// File, or folder of tables; it must not be there yet [default: RUN.nc or RUN-csv]
    #[arg(long, value_name = "PATH")]
    pub(crate) out: Option<PathBuf>,
}

/// The format of a name.
fn format(text: &str) -> Result<ExportFormat, String> {
    let mut known = ExportFormat::ALL.into_iter();
    let found = known.find(|format| format.name() == text);
    found.ok_or_else(|| {
        format!(
            "allowed: {}",
            ExportFormat::ALL.map(ExportFormat::name).join(", ")
        )
    })
}

//! The command line: commands and their arguments.

mod runs;

use std::path::PathBuf;

use clap::{Args, Parser, Subcommand};

use crate::continuation::Shard;
use crate::continuation::curve::CurveOptions;
use crate::sweep_file;
pub(crate) use runs::{
    CleanArguments, ExportArguments, ListArguments, MergeArguments, ShowArguments,
};

const EXAMPLES: &str = "\
Examples:
  pbif new mine.toml --like vanderpol  a sweep file to start from; `pbif new` lists them
  pbif systems                       list the models
  pbif systems coulomb               show one: equations, parameters, source
  pbif check sweeps/coulomb_fc.toml  what would be run, and what it costs
  pbif sweep sweeps/coulomb_fc.toml  run it; results go to output/coulomb_fc/
  pbif sweep sweeps/coulomb_fc.toml --resume   go on with it after an interrupt, a kill or a full disk
  pbif sweep sweeps/coulomb_fc.toml --shard 1/4   one of four shards, on a machine of its own; `pbif merge output/coulomb_fc` joins them
  pbif sweep sweeps/coulomb_fc.toml --set sweep.points=11 --set cells.x.count=30 --out trial
  pbif sweep sweeps/cusp.toml        a map: regimes over two parameters, where the file has [map]
  pbif compare sweeps/coulomb_fc.toml                          the methods side by side
  pbif curve output/coulomb_fc --row PB1 --second sigma2 --from 0.005 --to 0.02   PB1 in a plane of two parameters
  pbif detect output/coulomb_fc --set detect.confidence=0.99   detect again, without solving
  pbif plot output/coulomb_fc        draw again
  pbif explore output/coulomb_fc     one page that slides through the densities of the run
  pbif explore sweeps/coulomb_fc.toml --open                   the same page, solving live

Exit status: 0 done; 1 finished, but some row is unresolved, did not converge or has no steady state;
2 bad usage or input, or a folder that cannot be written to; 130 interrupted.

Results are never overwritten: an earlier run in the same folder is kept in its folder previous/1,
previous/2, and so on.";

const SYSTEMS_EXAMPLES: &str = "\
Examples:
  pbif systems
  pbif systems dahl
  pbif systems lugre --plot
  pbif systems lugre --plot --set f_s=2 --set v_s=0.2 --format pdf,csv,txt --style single,serif --out figures

A parameter that has no default and is not set takes a value about 1 that shows the shape of the law.";

const DETECT_EXAMPLES: &str = "\
Examples:
  pbif detect output/coulomb_fc --set detect.confidence=0.99
  pbif detect output/coulomb_fc --set detect.floor=0.01 --out stricter

Tables, figures and run.json are written anew, the densities stay. Without --out they take the
place of those of the run, whose earlier version is kept below its folder previous/; with --out the
run is left as it is.

Exit status: 0 done; 1 finished, but some row is unresolved, did not converge or has no steady
state, or the run had been interrupted; 2 bad usage or input, nothing written.";

const CURVE_EXAMPLES: &str = "\
Examples:
  pbif curve output/coulomb_fc --row PB1 --second sigma2 --from 0.005 --to 0.02
  pbif curve output/coulomb_fc --row PB1 --second sigma2 --from 0.005 --to 0.02 --first-from -0.05 --first-to 0.05
  pbif curve sweeps/bistable.toml --second sigma2 --from 0.2 --to 1
  pbif curve output/mine                        the curves of the section [curve] of its sweep file
  pbif curve output/coulomb_fc --row PB1 --second sigma2 --from 0.005 --to 0.02 --resume   go on after an interrupt or a kill

From the located row on, the zero of its indicator is followed in both directions until it leaves the box, closes, or its
feature is lost; then the curves that start from its cusps and degenerate splits. curves.csv, codimension_two.csv, curve.json and a figure of the plane go to RUN/curves/ROW-SECOND/ (of a sweep file, which is swept
first, to output/NAME-ROW-SECOND/) or --out; an earlier curve is kept below its folder previous/.
What the columns mean, and how far to trust them: docs/curves.md

Exit status: 0 done; 1 finished, but some point is not located; 2 bad usage or input, nothing written; 130 interrupted.";

const COMPARE_EXAMPLES: &str = "\
Examples:
  pbif compare sweeps/coulomb_fc.toml
  pbif compare sweeps/coulomb_fc.toml --set 'figures.at=[-0.02, 0.0]' --set method.error=0.004 --out trial
  pbif compare sweeps/coulomb_fc.toml --resume   go on with it after an interrupt or a kill

Methods are compared at the values of figures.at: the generator with the settings of the file; SGCM as the
paper has it (50 x 50 cells of equal width, method.samples samples a cell, map step 1, densities flat in the
cells); the same samples with slope correction; and Monte Carlo to the relative error method.error. Tables
and figures go to output/NAME-compare/ or --out; earlier comparisons are kept below its folder previous/.

Exit status: 0 done; 1 finished, but generator and Monte Carlo disagree beyond their uncertainties, or a
method did not converge or has no steady state; 2 bad usage or input, nothing written; 130 interrupted.
The keys of a sweep file: pbif sweep --help";

const PLOT_EXAMPLES: &str = "\
Examples:
  pbif plot output/coulomb_fc
  pbif plot output/coulomb_fc --only diagram_x,joint --at -0.01,0 --style single --format pdf --out paper
  pbif plot output/coulomb_fc --style slide,dark,cividis --out talk
  pbif plot output/coulomb_fc --set 'figures.at=[0.0, 0.005]' --out more_figures
  pbif plot output/coulomb_plane --with output/coulomb_fc   mark what a sweep located in the plane of a map or of curves

--style takes, in any order, a width (single, one-and-a-half, double, slide, own, or a number of millimetres),
a typeface (sans, serif), colours (viridis, cividis, magma, grey), a ground (light, dark), and no-title, no-letters.
The figures themselves, and every key of their style: docs/figures.md";

const EXPLORE_EXAMPLES: &str = "\
Examples:
  pbif explore output/coulomb_fc
  pbif explore output/coulomb_fc --html coulomb.html
  pbif explore sweeps/coulomb_fc.toml --open
  pbif explore sweeps/dahl_alpha.toml --set cells.x.count=30 --set cells.y.count=30

Of a run, the page is one file that needs no network and nothing installed but a browser: open it, send it, put it beside a
paper. Of a sweep file, densities are solved while the sliders of the page move; the address that is printed works on this machine
alone, until Ctrl-C.";

/// Finds where the steady-state density of a noisy oscillator changes its topology (P-bifurcations).
#[derive(Debug, Parser)]
#[command(name = "pbif", version, after_help = EXAMPLES, subcommand_required = true, arg_required_else_help = true)]
pub(super) struct Arguments {
    /// What to do.
    #[command(subcommand)]
    pub(super) command: Command,
}

/// The commands.
#[derive(Debug, Subcommand)]
pub(super) enum Command {
    /// Write a commented sweep file to start from; without FILE, list those that there are
    #[command(after_help = "Examples:\n  pbif new\n  pbif new mine.toml --like vanderpol")]
    New {
        /// File to write; it must not be there yet
        file: Option<PathBuf>,
        /// Starting file [default: vanderpol]
        #[arg(long, value_name = "NAME")]
        like: Option<String>,
    },
    /// Sweep a parameter, locate the P-bifurcations, write tables, densities and figures
    #[command(after_help = "The keys of a sweep file: pbif sweep --help", after_long_help = sweep_file::help())]
    Sweep {
        /// What to run.
        #[command(flatten)]
        input: SweepInput,
        /// How to run it.
        #[command(flatten)]
        run: SweepArguments,
    },
    /// Check a sweep file, print it with every default filled in and what it will cost; run nothing
    #[command(after_help = "The keys of a sweep file: pbif check --help", after_long_help = sweep_file::help())]
    Check {
        /// What to check.
        #[command(flatten)]
        input: SweepInput,
    },
    /// Solve by every method and compare: times, distances with their uncertainties, figures
    #[command(after_help = COMPARE_EXAMPLES)]
    Compare {
        /// What to compare.
        #[command(flatten)]
        input: SweepInput,
        /// How to run it.
        #[command(flatten)]
        run: CompareArguments,
    },
    /// Follow a located P-bifurcation in the plane of the swept and a second parameter
    #[command(after_help = CURVE_EXAMPLES)]
    Curve {
        /// What to follow.
        #[command(flatten)]
        run: CurveArguments,
    },
    /// Detect and locate again from the stored densities of a run, without solving
    #[command(after_help = DETECT_EXAMPLES)]
    Detect {
        /// What to work on.
        #[command(flatten)]
        run: DetectArguments,
    },
    /// Draw the figures of a stored run again
    #[command(after_help = PLOT_EXAMPLES)]
    Plot {
        /// What to draw.
        #[command(flatten)]
        run: PlotArguments,
    },
    /// Slide along a parameter in the browser: through a stored run in one file, or solving live from a sweep file
    #[command(after_help = EXPLORE_EXAMPLES)]
    Explore {
        /// What to show.
        #[command(flatten)]
        run: ExploreArguments,
    },
    /// Put the shards of a sweep together: detect, locate and draw over the whole
    #[command(after_help = runs::MERGE_EXAMPLES)]
    Merge {
        /// What to put together.
        #[command(flatten)]
        run: MergeArguments,
    },
    /// Check that every file of a run is as the run left it
    #[command(
        after_help = "Examples:\n  pbif verify output/coulomb_fc\n  pbif verify output/coulomb_fc --recompute 3\n\nExit status: 0 every file is; 1 one is not, or the run has no checksums yet, or a point is solved to another density."
    )]
    Verify {
        /// What to check.
        #[command(flatten)]
        run: VerifyArguments,
    },
    /// Print BibTeX entries: the program, and the model and method of a run
    #[command(
        after_help = "Examples:\n  pbif cite\n  pbif cite output/coulomb_fc >> references.bib\n\nOf a run: the version and commit that made it, its equations with their source, and what its method is from."
    )]
    Cite {
        /// Folder of a run, as `pbif sweep` left it
        run: Option<PathBuf>,
    },
    /// List runs: what, when, how far, and what was found; earlier versions and shards too
    #[command(after_help = runs::LIST_EXAMPLES)]
    List {
        /// Where to look.
        #[command(flatten)]
        run: ListArguments,
    },
    /// Show a run: its sweep, how it ended, what was found
    #[command(after_help = runs::SHOW_EXAMPLES)]
    Show {
        /// What to show.
        #[command(flatten)]
        run: ShowArguments,
    },
    /// Remove earlier versions and unfinished runs, after asking
    #[command(after_help = runs::CLEAN_EXAMPLES)]
    Clean {
        /// What to remove.
        #[command(flatten)]
        run: CleanArguments,
    },
    /// Write the densities of a run for other programs: NetCDF, NumPy, tables
    #[command(after_help = runs::EXPORT_EXAMPLES)]
    Export {
        /// What to write.
        #[command(flatten)]
        run: ExportArguments,
    },
    /// Print the completions of a shell, to be sourced
    #[command(
        after_help = "Examples:\n  source <(pbif completions bash)\n  pbif completions fish > ~/.config/fish/completions/pbif.fish"
    )]
    Completions {
        /// The shell
        shell: clap_complete::Shell,
    },
    /// Print the manual page, or write one a command into a folder
    #[command(
        after_help = "Examples:\n  pbif man | man -l -\n  pbif man --out ~/.local/share/man/man1"
    )]
    Man {
        /// Folder for pbif.1, pbif-sweep.1, …
        #[arg(long, value_name = "DIR")]
        out: Option<PathBuf>,
    },
    /// List the models, or show one: equations, axes, parameters, domain, source; or draw its friction law
    #[command(after_help = SYSTEMS_EXAMPLES)]
    Systems {
        /// Model to show
        name: Option<String>,
        /// How it is drawn.
        #[command(flatten)]
        drawn: FrictionPlotArguments,
    },
}

/// How a friction law is drawn.
#[derive(Debug, Args)]
pub(crate) struct FrictionPlotArguments {
    /// Draw the friction law of the model: force against velocity, and hysteresis loops
    #[arg(long, requires = "name")]
    pub(crate) plot: bool,
    /// Value of a parameter of the law, such as f_s=1.5, or a key under figures (repeatable; the last one counts)
    #[arg(long = "set", value_name = "NAME=VALUE", requires = "plot")]
    pub(crate) overrides: Vec<String>,
    /// Style: a width, and words such as serif, grey, dark, no-title
    #[arg(long, value_name = "WORDS", value_delimiter = ',', requires = "plot")]
    pub(crate) style: Vec<String>,
    /// File formats: svg, png, pdf; csv for the numbers behind the figure, txt for its caption [default: svg,png]
    #[arg(long, value_name = "FORMATS", value_delimiter = ',', requires = "plot")]
    pub(crate) format: Vec<String>,
    /// Folder for the figure [default: output/systems]
    #[arg(long, value_name = "DIR", requires = "plot")]
    pub(crate) out: Option<PathBuf>,
}

/// A sweep file with its overrides.
#[derive(Debug, Args)]
pub(super) struct SweepInput {
    /// Sweep file (TOML)
    pub(super) file: PathBuf,
    /// Override a key of the file, such as sweep.points=301 (repeatable; the last one counts)
    #[arg(long = "set", value_name = "KEY=VALUE")]
    pub(super) overrides: Vec<String>,
}

impl SweepInput {
    /// What results are named after: the file's name without folder and ending.
    pub(super) fn name(&self) -> String {
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
    #[arg(long, value_name = "K/N", value_parser = runs::shard)]
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

/// A stored run that is detected again.
#[derive(Debug, Args)]
pub(crate) struct DetectArguments {
    /// Folder of a run, as `pbif sweep` left it
    pub(crate) run: PathBuf,
    /// Override a key of the run's sweep under detect, locate or figures, such as detect.confidence=0.99 (repeatable; the
    /// last one counts)
    #[arg(long = "set", value_name = "KEY=VALUE")]
    pub(crate) overrides: Vec<String>,
    /// Folder for the results, a complete run with the same densities [default: RUN itself]
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
    /// No progress and no warnings on stderr, results alone
    #[arg(long)]
    pub(crate) quiet: bool,
}

/// A curve in a plane of two parameters.
#[derive(Debug, Args)]
pub(crate) struct CurveArguments {
    /// Folder of a run, as `pbif sweep` left it, or a sweep file (TOML), which is swept first
    #[arg(value_name = "RUN|FILE")]
    pub(crate) target: PathBuf,
    /// Label of the P-bifurcation to start from, such as PB1; may be left out where only one can be followed [default: the rows of
    /// `[curve]` in the sweep file]
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
    /// Override a key of a sweep file, such as cells.x.count=60; of a run those under detect, locate, figures and curve (repeatable;
    /// the last one counts)
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

/// A stored run that is checked.
#[derive(Debug, Args)]
pub(crate) struct VerifyArguments {
    /// Folder of a run, as `pbif sweep` left it
    pub(crate) run: PathBuf,
    /// Solve so many points again, picked at random, and compare with the stored densities
    #[arg(long, value_name = "N", default_value_t = 0, hide_default_value = true)]
    pub(crate) recompute: usize,
}

/// A stored run that is drawn again.
#[derive(Debug, Args)]
pub(crate) struct PlotArguments {
    /// Folder of a run or a map, as `pbif sweep` left it, or of curves, as `pbif curve` did
    pub(crate) run: PathBuf,
    /// Figures to draw, by name or kind, such as diagram_x,joint; all for every one
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    pub(crate) only: Vec<String>,
    /// Values to draw at; the run must have densities there
    #[arg(
        long,
        value_name = "VALUES",
        value_delimiter = ',',
        allow_hyphen_values = true
    )]
    pub(crate) at: Vec<String>,
    /// Of a map or of curves: mark what this run of a sweep over one of both parameters located (repeatable)
    #[arg(long = "with", value_name = "RUN")]
    pub(crate) with: Vec<PathBuf>,
    /// Style: a width, and words such as serif, grey, dark, no-title
    #[arg(long, value_name = "WORDS", value_delimiter = ',')]
    pub(crate) style: Vec<String>,
    /// File formats: svg, png, pdf; csv for the numbers behind a figure, txt for its caption
    #[arg(long, value_name = "FORMATS", value_delimiter = ',')]
    pub(crate) format: Vec<String>,
    /// Override a key of the run's sweep under figures, such as figures.formats=["svg"] (repeatable; the last one counts)
    #[arg(long = "set", value_name = "KEY=VALUE")]
    pub(crate) overrides: Vec<String>,
    /// Folder for the figures [default: RUN/figures]
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
    /// No progress and no warnings on stderr, results alone
    #[arg(long)]
    pub(crate) quiet: bool,
}

/// What is explored: a stored run or a sweep file.
#[derive(Debug, Args)]
pub(crate) struct ExploreArguments {
    /// Folder of a run or a map, as `pbif sweep` left it, or a sweep file (TOML)
    #[arg(value_name = "RUN|FILE")]
    pub(crate) target: PathBuf,
    /// Of a run: file of the page; one that is there is replaced [default: RUN/explorer.html]
    #[arg(long, value_name = "FILE")]
    pub(crate) html: Option<PathBuf>,
    /// Override a key of a sweep file, such as cells.x.count=60; of a run those under detect and locate (repeatable; the last one
    /// counts)
    #[arg(long = "set", value_name = "KEY=VALUE")]
    pub(crate) overrides: Vec<String>,
    /// Of a sweep file: port on the loopback address [default: one that is free]
    #[arg(long, value_name = "N", conflicts_with = "html")]
    pub(crate) port: Option<u16>,
    /// Open the page in the browser
    #[arg(long)]
    pub(crate) open: bool,
    /// No progress and no warnings on stderr, results alone
    #[arg(long)]
    pub(crate) quiet: bool,
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

#[cfg(test)]
mod tests {
    use clap::CommandFactory as _;

    #[test]
    fn the_commands_are_sound() {
        super::Arguments::command().debug_assert();
    }
}

//! The command line: commands and their arguments.

mod computing;
mod examples;
mod looking;
mod runs;

use std::path::{Path, PathBuf};

use clap::{Parser, Subcommand};

use crate::sweep_file;
pub(crate) use computing::{CompareArguments, CurveArguments, SweepArguments, SweepInput, Work};
pub(crate) use looking::{
    DetectArguments, ExploreArguments, FrictionPlotArguments, PlotArguments, VerifyArguments,
};
pub(crate) use runs::{
    CleanArguments, ExportArguments, ListArguments, MergeArguments, ShowArguments,
};

/// Finds where the steady-state density of a noisy oscillator changes its topology (P-bifurcations).
#[derive(Debug, Parser)]
#[command(name = "pbif", version, after_help = examples::EXAMPLES, subcommand_required = true, arg_required_else_help = true)]
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
    #[command(after_help = examples::COMPARE_EXAMPLES)]
    Compare {
        /// What to compare.
        #[command(flatten)]
        input: SweepInput,
        /// How to run it.
        #[command(flatten)]
        run: CompareArguments,
    },
    /// Follow a located P-bifurcation in the plane of the swept and a second parameter
    #[command(after_help = examples::CURVE_EXAMPLES)]
    Curve {
        /// What to follow.
        #[command(flatten)]
        run: CurveArguments,
    },
    /// Detect and locate again from the stored densities of a run, without solving
    #[command(after_help = examples::DETECT_EXAMPLES)]
    Detect {
        /// What to work on.
        #[command(flatten)]
        run: DetectArguments,
    },
    /// Draw the figures of a stored run again
    #[command(after_help = examples::PLOT_EXAMPLES)]
    Plot {
        /// What to draw.
        #[command(flatten)]
        run: PlotArguments,
    },
    /// Slide along a parameter in the browser: through a stored run in one file, or solving live from a sweep file
    #[command(after_help = examples::EXPLORE_EXAMPLES)]
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
    #[command(after_help = examples::SYSTEMS_EXAMPLES)]
    Systems {
        /// Model to show
        name: Option<String>,
        /// How it is drawn.
        #[command(flatten)]
        drawn: FrictionPlotArguments,
    },
}

impl Command {
    /// The file or folder that a command is about.
    pub(super) fn target(&self) -> Option<&Path> {
        match self {
            Self::Sweep { input, .. } | Self::Check { input } | Self::Compare { input, .. } => {
                Some(&input.file)
            }
            Self::Curve { run } => Some(&run.target),
            Self::Detect { run } => Some(&run.run),
            Self::Plot { run } => Some(&run.run),
            Self::Explore { run } => Some(&run.target),
            Self::Merge { run } => Some(&run.run),
            Self::Verify { run } => Some(&run.run),
            Self::Cite { run } => run.as_deref(),
            Self::List { run } => Some(&run.folder),
            Self::Show { run } => Some(&run.run),
            Self::Clean { run } => Some(&run.folder),
            Self::Export { run } => Some(&run.run),
            Self::New { .. }
            | Self::Completions { .. }
            | Self::Man { .. }
            | Self::Systems { .. } => None,
        }
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

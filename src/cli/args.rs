//! The command line: commands and their arguments.

use std::path::PathBuf;

use clap::{Args, Parser, Subcommand};

use super::keys;

const EXAMPLES: &str = "\
Examples:
  pbif systems                       list the models
  pbif systems coulomb               show one: equations, parameters, source
  pbif check sweeps/coulomb_fc.toml  what would be run, and what it costs
  pbif sweep sweeps/coulomb_fc.toml  run it; results go to output/coulomb_fc/
  pbif sweep sweeps/coulomb_fc.toml --set sweep.points=11 --set cells.x.count=30 --out trial

Exit status: 0 done; 1 finished, but some row is unresolved, did not converge or has no steady state;
2 bad usage or input, nothing written; 130 interrupted.";

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
    /// Sweep a parameter, locate the P-bifurcations, write tables, densities and figures
    #[command(after_help = "The keys of a sweep file: pbif sweep --help", after_long_help = keys::help())]
    Sweep {
        /// What to run.
        #[command(flatten)]
        input: SweepFile,
        /// How to run it.
        #[command(flatten)]
        run: SweepArguments,
    },
    /// Check a sweep file, print it with every default filled in and what it will cost; run nothing
    #[command(after_help = "The keys of a sweep file: pbif check --help", after_long_help = keys::help())]
    Check {
        /// What to check.
        #[command(flatten)]
        input: SweepFile,
    },
    /// List the models, or show one: equations, axes, parameters, domain, source
    #[command(after_help = "Examples:\n  pbif systems\n  pbif systems dahl")]
    Systems {
        /// Model to show
        name: Option<String>,
    },
}

/// A sweep file with its overrides.
#[derive(Debug, Args)]
pub(super) struct SweepFile {
    /// Sweep file (TOML)
    pub(super) file: PathBuf,
    /// Override a key of the file, such as sweep.points=301 (repeatable; the last one counts)
    #[arg(long = "set", value_name = "KEY=VALUE")]
    pub(super) overrides: Vec<String>,
}

/// How a sweep is run.
#[derive(Debug, Args)]
pub(crate) struct SweepArguments {
    /// Folder for the results [default: output/NAME, after the sweep file]
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
    /// Threads to use, all if left out; results do not depend on it
    #[arg(long, value_name = "N", value_parser = threads)]
    pub(crate) threads: Option<usize>,
    /// No progress and no warnings on stderr, results alone
    #[arg(long)]
    pub(crate) quiet: bool,
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

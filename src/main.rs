//! The program `pbif`.

use std::process::ExitCode;

fn main() -> ExitCode {
    pbif::cli::run()
}

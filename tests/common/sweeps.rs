//! Sweep files as text, made ready to run.

use pbif::cancellation::Cancellation;
use pbif::sweep_file::{Sweep, SweepFile};

/// The sweep of a file with this text, with some keys set.
pub(crate) fn prepared(text: &str, settings: &[&str]) -> Sweep {
    let mut file = SweepFile::parse("sweep.toml", text);
    let settings = file.set_all("--set", settings).validate().unwrap();
    settings.prepare(&Cancellation::new()).unwrap()
}

//! What the first Ctrl-C, or a request to end, cancels; the second ends the program at once.

use crate::cancellation::Cancellation;

/// Cancels when the system asks the program to end, and ends it when it is asked again. What was ignored when the
/// program started stays ignored: a run under `nohup` outlives its terminal.
///
/// # Errors
/// The system's, where signals cannot be handled.
#[cfg(unix)]
pub(super) fn cancel(cancellation: &Cancellation) -> std::io::Result<()> {
    use signal_hook::consts::{SIGHUP, SIGINT, SIGQUIT, SIGTERM};
    use signal_hook::iterator::Signals;
    let ignored = ignored_signals();
    let is_ignored = |signal: i32| ignored & (1 << (signal - 1)) != 0;
    // A shell's `&` ignores both of these, by habit and for nobody's sake: an interrupt sent to such a run is meant for
    // it.
    let by_habit = is_ignored(SIGINT) && is_ignored(SIGQUIT);
    let heard = [SIGINT, SIGTERM, SIGHUP].into_iter();
    let heard = heard.filter(|&signal| !is_ignored(signal) || (signal == SIGINT && by_habit));
    let mut signals = Signals::new(heard)?;
    let asked = cancellation.clone();
    std::thread::Builder::new().spawn(move || {
        for _ in signals.forever() {
            ask(&asked);
        }
    })?;
    Ok(())
}

/// See above.
#[cfg(not(unix))]
pub(super) fn cancel(cancellation: &Cancellation) -> std::io::Result<()> {
    use std::sync::{Mutex, PoisonError};
    // The system takes one handler alone: what is computed last is what is cancelled.
    static ASKED: Mutex<Option<Cancellation>> = Mutex::new(None);
    let asked = || ASKED.lock().unwrap_or_else(PoisonError::into_inner);
    if asked().replace(cancellation.clone()).is_some() {
        return Ok(());
    }
    let heard = move || asked().iter().for_each(ask);
    ctrlc::set_handler(heard).map_err(std::io::Error::other)
}

/// Lets a write beyond the largest file that a user may have (`ulimit -f`) fail with an error, which is told, instead
/// of ending the program.
#[cfg(unix)]
pub(super) fn hear_of_full_files() {
    let heard = std::sync::Arc::default();
    // Where it cannot be heard of, it ends the program as before.
    let _ = signal_hook::flag::register(signal_hook::consts::SIGXFSZ, heard);
}

/// See above.
#[cfg(not(unix))]
pub(super) fn hear_of_full_files() {}

fn ask(asked: &Cancellation) {
    if asked.is_cancelled() {
        // Nothing is half-written: files are put in place by renaming.
        #[allow(clippy::exit)]
        std::process::exit(130);
    }
    asked.cancel();
}

/// Signals that are ignored, a bit each from the first on; none where the system does not say.
#[cfg(unix)]
fn ignored_signals() -> u64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let mut lines = status.lines();
    let mask = lines.find_map(|line| line.strip_prefix("SigIgn:"));
    mask.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok())
        .unwrap_or(0)
}

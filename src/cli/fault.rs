//! What is said when the program itself is at fault: a panic ends with sentences, not with a backtrace.

use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

use super::{CommandError, Outcome, tell};
use crate::run::Layout;

/// Status of a program whose own fault ended it (`EX_SOFTWARE` of sysexits).
pub(super) const STATUS: u8 = 70;

/// The folder in which a job is at work.
static AT_WORK: Mutex<Option<(PathBuf, Layout)>> = Mutex::new(None);

/// Notes where a job is at work.
pub(super) fn at_work(home: &Path, layout: Layout) {
    *lock() = Some((home.to_owned(), layout));
}

fn lock() -> std::sync::MutexGuard<'static, Option<(PathBuf, Layout)>> {
    AT_WORK.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Carries out a command on what `target` names. `None` where it came to a fault of the program, of which is then told
/// on stderr.
pub(super) fn guard(
    target: Option<&Path>,
    command: impl FnOnce() -> Result<Outcome, CommandError>,
) -> Option<Result<Outcome, CommandError>> {
    let before = std::panic::take_hook();
    std::panic::set_hook(Box::new(move |fault| {
        let place = fault.location().map_or(String::new(), |place| {
            format!("{}:{}: ", place.file(), place.line())
        });
        tell(
            false,
            &format!("\nfault: {place}{}\n", words(fault.payload())),
        );
        // Who asks for it by RUST_BACKTRACE wants to look for the cause.
        if std::env::var_os("RUST_BACKTRACE").is_some() {
            before(fault);
        }
    }));
    let ended = catch_unwind(AssertUnwindSafe(command));
    // The hook of before is not put back: the command may have left threads.
    ended.map_err(|_| tell(false, &describe(target))).ok()
}

fn words(payload: &(dyn Any + Send)) -> &str {
    let text = payload.downcast_ref::<String>().map(String::as_str);
    let text = text.or_else(|| payload.downcast_ref::<&str>().copied());
    text.unwrap_or("no words")
}

/// What was worked on, and what is left of it.
fn describe(target: Option<&Path>) -> String {
    let mut text = "pbif itself is at fault".to_owned();
    if let Some(target) = target {
        text += &format!(", at work on {}", target.display());
    }
    text += ": please report this line and that file\n";
    let folder = lock().take();
    match folder {
        Some((home, layout)) if layout.has_part(&home) => {
            let home = home.display();
            text +=
                &format!("what was solved is kept in {home}, and `--resume` goes on from there\n");
        }
        Some((home, _)) => text += &format!("what is in {} may not be whole\n", home.display()),
        None => {}
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_panic_names_the_file_it_worked_on_and_how_to_go_on() {
        let home = tempfile::tempdir().unwrap();
        at_work(home.path(), Layout::SWEEP);
        let target = Path::new("my.toml");
        assert!(describe(Some(target)).contains("may not be whole"));
        at_work(home.path(), Layout::SWEEP);
        std::fs::write(home.path().join("journal.bin"), "").unwrap();
        let text = describe(Some(target));
        assert!(
            text.contains("at work on my.toml") && text.contains("`--resume`"),
            "{text}"
        );
        #[allow(clippy::panic)]
        let ended = guard(Some(target), || panic!("a {} trial", "deliberate"));
        assert!(ended.is_none());
        assert!(matches!(guard(None, || Ok(Outcome::Complete)), Some(Ok(_))));
        let _ = std::panic::take_hook();
    }
}

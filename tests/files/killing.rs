//! Programs that are stopped while they run.

#![cfg(unix)]

use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::Duration;

use crate::common::room::Room;

/// Starts a run and sends it a signal when so many points are reported; `false` if it was done before.
pub(super) fn stopped_at(room: &Room, line: &str, points: usize, signal: &str) -> bool {
    let mut command = room.command(line);
    let command = command.stdout(Stdio::null()).stderr(Stdio::piped());
    let mut child = command.spawn().unwrap();
    let mut lines = BufReader::new(child.stderr.take().unwrap()).lines();
    let reported = format!("{points:4} of");
    let seen = lines.any(|line| line.unwrap().starts_with(&reported));
    let sent = send(&child, signal);
    lines.for_each(drop);
    let code = child.wait().unwrap().code();
    seen && sent && !matches!(code, Some(0 | 1))
}

pub(super) fn send(child: &Child, signal: &str) -> bool {
    let pid = child.id().to_string();
    let sent = Command::new("kill").args([signal, &pid]).status();
    sent.unwrap().success()
}

pub(super) fn started(room: &Room, line: &str) -> Child {
    let mut command = room.command(line);
    let silent = command.stdout(Stdio::null()).stderr(Stdio::null());
    silent.spawn().unwrap()
}

/// Length of a file, none where it is not.
pub(super) fn size(file: &Path) -> u64 {
    std::fs::metadata(file).map_or(0, |data| data.len())
}

/// Waits as long as a program runs and something is not yet so; `false` if the program ended before.
pub(super) fn wait_until(child: &mut Child, is_so: impl Fn() -> bool) -> bool {
    while !is_so() && child.try_wait().unwrap().is_none() {
        std::thread::sleep(Duration::from_micros(500));
    }
    child.try_wait().unwrap().is_none()
}

/// Kills a program once a file is so long; `false` if it had ended before.
pub(super) fn killed_at(mut child: Child, file: &Path, length: u64) -> bool {
    let running = wait_until(&mut child, || size(file) >= length);
    let _ = child.kill();
    child.wait().unwrap();
    running
}

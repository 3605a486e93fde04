//! Where a page of the explorer may be written.

use crate::common::room::Room;

#[test]
fn a_page_replaces_pages_and_nothing_else() {
    let room = Room::new();
    let settings = "sweep.points=3 cells.x.count=40 locate.grid_check=off";
    room.run(&format!(
        "sweep sweeps/bistable.toml --quiet --out run {settings}"
    ));
    let refused = |page: &str, words: &str| {
        room.refused(&format!("explore run --html {page}"), &[words]);
    };
    // A page takes the place of a page, with and without `--html`.
    for _ in 0..2 {
        room.done("explore run --html page.html");
        room.done("explore run");
    }
    let (written, manifest) = (room.bytes("page.html"), room.bytes("run/run.json"));
    refused("run/run.json", "`run/run.json` is no page that pbif wrote");
    assert_eq!(room.bytes("run/run.json"), manifest);
    for text in [
        "",
        "title = 1",
        "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n",
    ] {
        room.write("mine.toml", text);
        refused("mine.toml", "--force");
        assert_eq!(room.read("mine.toml"), text);
    }
    room.done("explore run --html mine.toml --force");
    assert_eq!(room.bytes("mine.toml"), written);
    for folder in ["run", "run --force"] {
        refused(folder, "`--html run/explorer.html`");
    }
    assert!(room.path("run/points.csv").is_file());
}

#[cfg(unix)]
#[test]
fn a_page_replaces_no_link_and_no_pipe() {
    use std::os::unix::fs::symlink;
    let room = Room::new();
    // What is wrong is said before the run is read.
    std::fs::create_dir(room.path("run")).unwrap();
    room.write("outside.html", "mine");
    symlink("outside.html", room.path("link.html")).unwrap();
    symlink("../outside.html", room.path("run/explorer.html")).unwrap();
    symlink("nowhere", room.path("dangling.html")).unwrap();
    let mut pipe = std::process::Command::new("mkfifo");
    assert!(pipe.arg(room.path("pipe")).status().unwrap().success());
    for (page, words) in [
        ("--html link.html", "the link leads to `outside.html`"),
        ("--html link.html --force", "is a link"),
        ("--force", "`run/explorer.html` is a link"),
        ("--html dangling.html", "the link leads to `nowhere`"),
        ("--html pipe --force", "a device, a pipe or a socket"),
        ("--html /dev/null --force", "a device, a pipe or a socket"),
    ] {
        room.refused(&format!("explore run {page}"), &[words]);
    }
    assert_eq!(room.read("outside.html"), "mine");
    assert!(room.path("link.html").is_symlink() && !room.holds("nowhere"));
}

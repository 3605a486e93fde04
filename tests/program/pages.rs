//! Where a page of the explorer may be written.

use std::path::Path;
use std::process::Command;

use tempfile::TempDir;

fn pbif(arguments: &[&str], folder: &Path) -> (String, String, Option<i32>) {
    let mut command = Command::new(env!("CARGO_BIN_EXE_pbif"));
    let output = command.args(arguments).current_dir(folder).output();
    let output = output.unwrap();
    let text = |bytes: &[u8]| String::from_utf8(bytes.to_vec()).unwrap();
    (
        text(&output.stdout),
        text(&output.stderr),
        output.status.code(),
    )
}

#[test]
fn a_page_replaces_pages_and_nothing_else() {
    let room = TempDir::new().unwrap();
    let folder = room.path();
    let sweep = Path::new(env!("CARGO_MANIFEST_DIR")).join("sweeps/bistable.toml");
    let mut arguments = vec!["sweep", sweep.to_str().unwrap(), "--quiet", "--out", "run"];
    let settings = [
        "sweep.points=3",
        "cells.x.count=40",
        "locate.grid_check=off",
    ];
    arguments.extend(settings.iter().flat_map(|setting| ["--set", *setting]));
    pbif(&arguments, folder);
    let page = |file: &str, more: &[&str]| {
        pbif(
            &[&["explore", "run", "--html", file], more].concat(),
            folder,
        )
    };
    let refused = |file: &str, more: &[&str], words: &str| {
        let (_, stderr, code) = page(file, more);
        assert!(
            code == Some(2) && stderr.contains(words),
            "{file}: {code:?} {stderr}"
        );
    };
    // A page takes the place of a page, with and without `--html`.
    for _ in 0..2 {
        assert_eq!(page("page.html", &[]).2, Some(0));
        assert_eq!(pbif(&["explore", "run"], folder).2, Some(0));
    }
    let written = std::fs::read(folder.join("page.html")).unwrap();

    let manifest = std::fs::read(folder.join("run/run.json")).unwrap();
    refused(
        "run/run.json",
        &[],
        "`run/run.json` is no page that pbif wrote",
    );
    assert_eq!(
        std::fs::read(folder.join("run/run.json")).unwrap(),
        manifest
    );
    let mine = folder.join("mine.toml");
    for text in [
        "",
        "title = 1",
        "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n",
    ] {
        std::fs::write(&mine, text).unwrap();
        refused("mine.toml", &[], "--force");
        assert_eq!(std::fs::read_to_string(&mine).unwrap(), text);
    }
    assert_eq!(page("mine.toml", &["--force"]).2, Some(0));
    assert_eq!(std::fs::read(&mine).unwrap(), written);
    for more in [&[][..], &["--force"]] {
        refused("run", more, "`--html run/explorer.html`");
    }
    assert!(folder.join("run/points.csv").is_file());
}

#[cfg(unix)]
#[test]
fn a_page_replaces_no_link_and_no_pipe() {
    let room = TempDir::new().unwrap();
    let folder = room.path();
    // What is wrong is said before the run is read.
    std::fs::create_dir(folder.join("run")).unwrap();
    std::fs::write(folder.join("outside.html"), "mine").unwrap();
    std::os::unix::fs::symlink("outside.html", folder.join("link.html")).unwrap();
    std::os::unix::fs::symlink("../outside.html", folder.join("run/explorer.html")).unwrap();
    std::os::unix::fs::symlink("nowhere", folder.join("dangling.html")).unwrap();
    let made = Command::new("mkfifo").arg(folder.join("pipe")).status();
    assert!(made.unwrap().success());
    let refused = |more: &[&str], words: &str| {
        let (_, stderr, code) = pbif(&[&["explore", "run"], more].concat(), folder);
        assert!(
            code == Some(2) && stderr.contains(words),
            "{more:?}: {code:?} {stderr}"
        );
    };
    refused(&["--html", "link.html"], "the link leads to `outside.html`");
    refused(&["--html", "link.html", "--force"], "is a link");
    refused(&["--force"], "`run/explorer.html` is a link");
    refused(&["--html", "dangling.html"], "the link leads to `nowhere`");
    refused(
        &["--html", "pipe", "--force"],
        "a device, a pipe or a socket",
    );
    refused(
        &["--html", "/dev/null", "--force"],
        "a device, a pipe or a socket",
    );
    assert_eq!(
        std::fs::read_to_string(folder.join("outside.html")).unwrap(),
        "mine"
    );
    assert!(folder.join("link.html").is_symlink() && !folder.join("nowhere").exists());
}

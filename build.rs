//! Says what the program is built from and by what, for `run.json`: commit, compiler, target. Whatever cannot be found
//! out is left out, so that a package without git builds too.

use std::path::Path;
use std::process::Command;

fn main() {
    // Nothing but these makes another program; without a list, every edit of a document would compile it anew.
    for path in ["src", "build.rs", "Cargo.toml", "Cargo.lock"] {
        println!("cargo::rerun-if-changed={path}");
    }
    println!("cargo::rerun-if-env-changed=PBIF_COMMIT");
    let variable = |name: &str| std::env::var(name).ok().filter(|text| !text.is_empty());
    let root = variable("CARGO_MANIFEST_DIR").unwrap_or_else(|| ".".to_owned());
    let root = Path::new(&root);
    let commit = variable("PBIF_COMMIT")
        .or_else(|| of_repository(root))
        .or_else(|| of_package(root));
    tell("PBIF_COMMIT", commit);
    let compiler = variable("RUSTC").and_then(|rustc| said(Command::new(rustc).arg("--version")));
    tell("PBIF_COMPILER", compiler);
    tell("PBIF_TARGET", variable("TARGET"));
    tell("PBIF_TARGET_FEATURES", variable("CARGO_CFG_TARGET_FEATURE"));
    tell("PBIF_OPTIMISATION", variable("OPT_LEVEL"));
}

fn tell(name: &str, value: Option<String>) {
    println!("cargo::rustc-env={name}={}", value.unwrap_or_default());
}

/// The commit of the repository whose root this is, with `-dirty` where tracked files are changed. A package that lies
/// within somebody else's repository has none.
fn of_repository(root: &Path) -> Option<String> {
    let git = |arguments: &[&str]| said(Command::new("git").current_dir(root).args(arguments));
    let top = git(&["rev-parse", "--show-toplevel"])?;
    let same = Path::new(&top).canonicalize().ok()? == root.canonicalize().ok()?;
    same.then(|| {
        git(&[
            "describe",
            "--always",
            "--dirty",
            "--abbrev=40",
            "--exclude=*",
        ])
    })
    .flatten()
}

/// The commit that `cargo package` writes into a package.
fn of_package(root: &Path) -> Option<String> {
    let text = std::fs::read_to_string(root.join(".cargo_vcs_info.json")).ok()?;
    let (_, rest) = text.split_once("\"sha1\"")?;
    let commit = rest.split('"').nth(1)?;
    let is_commit = commit.bytes().all(|byte| byte.is_ascii_hexdigit());
    let dirty = if rest.contains("\"dirty\": true") {
        "-dirty"
    } else {
        ""
    };
    is_commit.then(|| format!("{commit}{dirty}"))
}

/// The line that a program prints; `None` where it cannot be run or fails.
fn said(command: &mut Command) -> Option<String> {
    let output = command.output().ok()?;
    let text = String::from_utf8(output.stdout).ok()?;
    let line = text.lines().next()?.trim();
    (output.status.success() && !line.is_empty()).then(|| line.to_owned())
}

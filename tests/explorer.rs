//! The explorer through the real binary: the page of a stored run, read back by the page's own code where Node.js is installed and
//! shown by a browser where Chromium is. Both tests say when they skip.

#![allow(clippy::unwrap_used, clippy::panic, clippy::print_stderr)]

use std::path::{Path, PathBuf};
use std::process::Command;

use assert_cmd::cargo::CommandCargoExt as _;
use pbif::cancellation::Cancellation;
use pbif::run::StoredRun;
use pbif::sweep_file::SweepFile;
use tempfile::TempDir;

fn pbif(arguments: &[&str], folder: &Path) -> (String, String, Option<i32>) {
    let mut command = Command::cargo_bin("pbif").unwrap();
    let output = command
        .args(arguments)
        .current_dir(folder)
        .output()
        .unwrap();
    let text = |bytes: &[u8]| String::from_utf8(bytes.to_vec()).unwrap();
    (
        text(&output.stdout),
        text(&output.stderr),
        output.status.code(),
    )
}

/// A small run of `coulomb_fc` in the folder `run`, and its page.
fn explored(folder: &Path) -> PathBuf {
    let sweep = Path::new(env!("CARGO_MANIFEST_DIR")).join("sweeps/coulomb_fc.toml");
    let sweep = sweep.to_str().unwrap();
    let settings = [
        "sweep.points=7",
        "cells.x.count=30",
        "cells.y.count=30",
        "locate.grid_check=off",
        "locate.tolerance=1e-3",
    ];
    let mut arguments = vec!["sweep", sweep, "--quiet", "--out", "run"];
    arguments.extend(settings.iter().flat_map(|setting| ["--set", *setting]));
    pbif(&arguments, folder);
    let (stdout, stderr, code) = pbif(&["explore", "run", "--html", "pages/page.html"], folder);
    assert_eq!(code, Some(0), "{stderr}");
    assert!(
        stdout.contains("pages/page.html") && stdout.contains("MB"),
        "{stdout}"
    );
    folder.join("pages/page.html")
}

/// Whether a program can be started.
fn has(program: &str) -> bool {
    Command::new(program).arg("--version").output().is_ok()
}

/// Reads a page with the page's own sources: with the browser's inflation and with its own, which must agree.
const READ: &str = r"
const fs = require('fs');
const [page, ...sources] = process.argv.slice(2);
const html = fs.readFileSync(page, 'utf8');
const document = { getElementById: (id) => ({ textContent: html.split(`id=\x22${id}\x22>`)[1].split('</script>')[0] }) };
const code = sources.map((name) => fs.readFileSync(name, 'utf8')).join('');
const run = new Function('document', 'fromNode', `${code}
  return (async () => {
    const bytes = await readBlock('scene');
    const own = inflateHere(fromBase64(document.getElementById('scene').textContent));
    const told = JSON.parse(new TextDecoder().decode(bytes));
    const found = { same: Buffer.compare(Buffer.from(bytes), Buffer.from(own)) === 0, arrays: [] };
    for (const arrays of told.arrays) {
      const at = arrays.frames.map((index) => told.frames[index].value);
      const block = 'block-' + arrays.values.block;
      const own = inflateHere(fromBase64(document.getElementById(block).textContent));
      const packed = new Packed(arrays.values, await readBlock(block), at);
      const again = new Packed(arrays.values, own, at);
      found.same = found.same && packed.steps.every((step, i) => step === again.steps[i]);
      found.arrays.push({ top: arrays.values.top, frames: at.map((_, i) => Array.from(packed.frame(i))) });
    }
    return found;
  })();`);
run(document).then((found) => process.stdout.write(JSON.stringify(found)));
";

#[test]
fn the_code_of_the_page_reads_the_stored_densities() {
    if !has("node") {
        eprintln!("skipped: Node.js is not installed");
        return;
    }
    let folder = TempDir::new().unwrap();
    let page = explored(folder.path());
    let script = folder.path().join("read.cjs");
    std::fs::write(&script, READ).unwrap();
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("src/explore/page");
    let sources = ["inflate.js", "unpack.js"].map(|name| root.join(name));
    let output = Command::new("node")
        .arg(&script)
        .arg(&page)
        .args(sources)
        .output()
        .unwrap();
    assert!(
        output.status.success(),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    let read: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(
        read["same"], true,
        "the page's inflation is not the browser's"
    );

    let run = StoredRun::open(&folder.path().join("run")).unwrap();
    let sweep = SweepFile::parse("run.json", run.resolved());
    let sweep = sweep
        .validate()
        .unwrap()
        .prepare(&Cancellation::new())
        .unwrap();
    let subject = sweep.problem.subject();
    let points = run
        .points(
            subject,
            (sweep.problem.space(), sweep.problem.bins()),
            &["generator"],
        )
        .unwrap();
    let with_density = || points.iter().filter(|point| !point.densities.is_empty());
    for (k, arrays) in read["arrays"].as_array().unwrap().iter().enumerate() {
        let top = arrays["top"].as_f64().unwrap();
        // Marginals have 2⁻²⁴ of the largest value; of a joint density the square root has 2⁻¹⁴.
        let tolerance = if subject.observables[k].axes().len() == 1 {
            1e-7
        } else {
            7e-5
        };
        for (frame, point) in arrays["frames"]
            .as_array()
            .unwrap()
            .iter()
            .zip(with_density())
        {
            let frame: Vec<f64> = serde_json::from_value(frame.clone()).unwrap();
            for (value, stored) in frame.iter().zip(&point.densities[k].density.values) {
                assert!(
                    (value - stored).abs() <= tolerance * top,
                    "{value} {stored}"
                );
            }
        }
    }
}

#[test]
fn a_browser_shows_the_page_from_disk() {
    let names = ["chromium", "chromium-browser", "google-chrome"];
    let Some(browser) = names.into_iter().find(|name| has(name)) else {
        eprintln!("skipped: Chromium is not installed");
        return;
    };
    let folder = TempDir::new().unwrap();
    let page = explored(folder.path());
    let shown = |state: &str| {
        let address = format!("file://{}#{state}", page.display());
        let profile = format!(
            "--user-data-dir={}",
            folder.path().join("profile").display()
        );
        let options = [
            "--headless",
            "--no-sandbox",
            "--disable-gpu",
            "--virtual-time-budget=4000",
            "--dump-dom",
        ];
        let output = Command::new(browser)
            .args(options)
            .arg(profile)
            .arg(address)
            .output()
            .unwrap();
        String::from_utf8(output.stdout).unwrap()
    };
    let at_end = shown("f_c=0.01&pin=-0.02");
    assert!(
        at_end.contains("data-ready=\"true\""),
        "the script did not run to its end"
    );
    assert!(
        at_end.contains("f_c = 0.01: p(x) 1 peak; p(ẋ) 1 peak"),
        "what is seen is not said"
    );
    assert!(
        at_end.contains("Hellinger distance"),
        "the pinned state is not compared"
    );
    // What an address says wrongly changes nothing.
    let odd = shown("f_c=much&pin=NaN&joint=7&theme=loud");
    assert!(odd.contains("data-ready=\"true\"") && odd.contains("aria-live=\"polite\">f_c = "));
}

#[test]
fn what_cannot_be_explored_is_refused() {
    let folder = TempDir::new().unwrap();
    let (_, stderr, code) = pbif(&["explore", "nothing"], folder.path());
    assert_eq!(code, Some(2));
    assert!(
        stderr.contains("`nothing` is not the folder of a run"),
        "{stderr}"
    );
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
}

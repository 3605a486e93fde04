//! The explorer through the real binary: the page of a stored run, read back by the page's own code where Node.js is
//! installed and shown by a browser where Chromium is. Both tests say when they skip.

use std::io::{Read as _, Write as _};
use std::net::TcpStream;
use std::path::{Path, PathBuf};
use std::process::Command;

use base64::Engine as _;
use pbif::cancellation::Cancellation;
use pbif::continuation::DensitySource as _;
use pbif::explore::LiveServer;
use pbif::run::StoredRun;
use pbif::sweep_file::SweepFile;
use pbif::topology::Detector as _;
use tempfile::TempDir;

fn pbif(arguments: &[&str], folder: &Path) -> (String, String, Option<i32>) {
    let mut command = Command::new(env!("CARGO_BIN_EXE_pbif"));
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
    // On a busy machine the browser's clock may run out before the page has read its data.
    let mut odd = String::new();
    for _ in 0..5 {
        odd = shown("f_c=much&pin=NaN&joint=7&theme=loud");
        if odd.contains("data-ready=\"true\"") {
            break;
        }
    }
    assert!(odd.contains("data-ready=\"true\"") && odd.contains("aria-live=\"polite\">f_c = "));
}

/// The rows of a table of a run, by the names of their columns.
fn table(file: &Path) -> Vec<std::collections::HashMap<String, String>> {
    let mut reader = csv::Reader::from_path(file).unwrap();
    reader.deserialize().map(Result::unwrap).collect()
}

/// What a page is told.
fn told(page: &Path) -> serde_json::Value {
    let html = std::fs::read_to_string(page).unwrap();
    let packed = html.split("id=\"scene\">").nth(1).unwrap();
    let packed = packed.split("</script>").next().unwrap();
    let packed = base64::engine::general_purpose::STANDARD
        .decode(packed)
        .unwrap();
    let mut told = Vec::new();
    flate2::read::ZlibDecoder::new(packed.as_slice())
        .read_to_end(&mut told)
        .unwrap();
    serde_json::from_slice(&told).unwrap()
}

/// The points of the curves of a plane over h and a are the numbers of a table, to the last digit.
fn assert_curves_are_those_of(file: &Path, found: &serde_json::Value) {
    let points: Vec<&serde_json::Value> = (found["curves"].as_array().unwrap().iter())
        .flat_map(|curve| curve["points"].as_array().unwrap())
        .collect();
    let rows = table(file);
    assert!(rows.len() > 20 && rows.len() == points.len());
    for (row, point) in rows.iter().zip(points) {
        for (column, k) in [
            ("h", 0),
            ("a", 1),
            ("error", 2),
            ("edge_h", 3),
            ("edge_a", 4),
        ] {
            let wanted = row[column].parse::<f64>().unwrap();
            assert_eq!(point[k].as_f64().unwrap(), wanted, "{column}");
        }
    }
}

#[test]
fn the_page_of_curves_holds_them_and_the_densities_of_their_plane() {
    let folder = TempDir::new().unwrap();
    let sweep = "[system.equations]\nx = \"h + a x - x^3\"\n[system.noise]\nx = \"sqrt(0.1)\"\n\
        [system.parameters]\na = 1.0\n[sweep]\nparameter = \"h\"\nfrom = 0.1\nto = 0.6\npoints = 6\n\
        [cells]\nx = { from = -2.5, to = 2.5, count = 200 }\n\
        [curve]\nparameter = \"a\"\nfrom = 0.6\nto = 1.2\n";
    std::fs::write(folder.path().join("tilted.toml"), sweep).unwrap();
    let run = ["sweep", "tilted.toml", "--out", "run", "--quiet"];
    assert_eq!(pbif(&run, folder.path()).2, Some(0));
    let (stdout, stderr, code) = pbif(&["explore", "run"], folder.path());
    assert_eq!(code, Some(0), "{stderr}");
    let curves = "run/curves/PB1-a";
    assert!(
        stdout.contains(&format!("pbif explore {curves}")),
        "{stdout}"
    );
    let (_, stderr, code) = pbif(&["explore", curves, "--quiet"], folder.path());
    assert_eq!(code, Some(0), "{stderr}");
    let curves = folder.path().join(curves);
    let told = told(&curves.join("explorer.html"));
    let found = &told["plane"]["found"];
    assert_curves_are_those_of(&curves.join("curves.csv"), found);
    let kinds = found["regions"][0]["kinds"].as_array().unwrap();
    assert!(
        ["1 peak", "2 peaks"]
            .iter()
            .all(|one| kinds.contains(&(*one).into())),
        "{kinds:?}"
    );
    // On both sides of the exact fold, 27 h² = 4 a³, as far from it as a shallow peak needs to be counted.
    let frames = told["frames"].as_array().unwrap();
    assert_eq!(frames.len(), 21 * 21);
    for (frame, second) in frames.iter().zip(told["across"].as_array().unwrap()) {
        let (h, a) = (frame["value"].as_f64().unwrap(), second.as_f64().unwrap());
        let off = 27.0 * h * h - 4.0 * a.powi(3);
        if off.abs() < 0.6 {
            continue;
        }
        let words = if off < 0.0 { "2 peaks" } else { "1 peak" };
        assert_eq!(frame["found"][0]["words"], words, "h = {h}, a = {a}");
    }
}

#[test]
fn the_page_of_a_map_holds_what_its_tables_hold() {
    let folder = TempDir::new().unwrap();
    let sweep = Path::new(env!("CARGO_MANIFEST_DIR")).join("sweeps/cusp.toml");
    let settings = ["sweep.points=9", "map.points=8", "map.depth=1"];
    let mut arguments = vec!["sweep", sweep.to_str().unwrap(), "--quiet", "--out", "map"];
    arguments.extend(settings.iter().flat_map(|setting| ["--set", *setting]));
    pbif(&arguments, folder.path());
    let (_, stderr, code) = pbif(&["explore", "map", "--html", "map.html"], folder.path());
    assert_eq!(code, Some(0), "{stderr}");
    let told = told(&folder.path().join("map.html"));
    let found = &told["plane"]["found"];
    assert_curves_are_those_of(&folder.path().join("map/curves.csv"), found);
    let number = |text: &String| text.parse::<f64>().unwrap();
    let rows = table(&folder.path().join("map/codimension_two.csv"));
    assert_eq!(rows.len(), found["points"].as_array().unwrap().len());
    assert_eq!(
        found["points"][0]["at"][1].as_f64().unwrap(),
        number(&rows[0]["a"])
    );

    // Every state of the page is a node of the map, with its words; its density is the exact one of that place.
    let nodes = table(&folder.path().join("map/map.csv"));
    let frames = told["frames"].as_array().unwrap();
    assert_eq!(frames.len(), 9 * 8);
    for (frame, second) in frames.iter().zip(told["across"].as_array().unwrap()) {
        let (h, a) = (frame["value"].as_f64().unwrap(), second.as_f64().unwrap());
        let node = nodes
            .iter()
            .find(|row| number(&row["h"]) == h && number(&row["a"]) == a);
        assert_eq!(
            frame["found"][0]["words"],
            node.unwrap()["signature_x"].as_str(),
            "{h} {a}"
        );
        // p ∝ exp((2/σ²)(h x + a x²/2 - x⁴/4)), by the trapezoidal rule, which has all digits for a density that
        // vanishes at both ends.
        let weight = |x: f64| (20.0 * (h * x + a * x * x / 2.0 - x.powi(4) / 4.0)).exp();
        let places = (0..=5000).map(|i| -2.5 + 1e-3 * f64::from(i));
        let (sum, first) = places.fold((0.0, 0.0), |(sum, first), x| {
            (sum + weight(x), first + x * weight(x))
        });
        let mean = frame["moments"][0][0].as_f64().unwrap();
        assert!(
            (mean - first / sum).abs() < 1e-5,
            "{h} {a}: {mean} {}",
            first / sum
        );
    }

    let (_, stderr, code) = pbif(
        &["explore", "map", "--set", "detect.noise=0.1"],
        folder.path(),
    );
    assert!(
        code == Some(2) && stderr.contains("stands in its tables"),
        "{stderr}"
    );
    std::fs::write(
        folder.path().join("map/curves.csv"),
        "curve,h,a\nC1,0.1,much\n",
    )
    .unwrap();
    let (_, stderr, code) = pbif(&["explore", "map"], folder.path());
    assert!(
        code == Some(2) && stderr.contains("`much` is no number"),
        "{stderr}"
    );
    std::fs::write(folder.path().join("map/map.json"), "{}").unwrap();
    let (_, stderr, code) = pbif(&["explore", "map"], folder.path());
    assert!(code == Some(2) && stderr.contains("map.json"), "{stderr}");
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
    // What is named like a sweep file is meant as one.
    let (_, stderr, code) = pbif(&["explore", "nothing.toml"], folder.path());
    assert_eq!(code, Some(2));
    assert!(
        stderr.contains("nothing.toml") && !stderr.contains("folder of a run"),
        "{stderr}"
    );
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
}

/// A live server of a small sweep, which ends with the test.
struct Served {
    address: String,
    port: u16,
    sweep: pbif::sweep_file::Sweep,
    cancellation: Cancellation,
    thread: Option<std::thread::JoinHandle<()>>,
}

impl Served {
    fn new() -> Self {
        let settings = [
            ("cells.x.count", "30"),
            ("cells.y.count", "30"),
            ("locate.grid_check", "off"),
        ];
        Self::of(include_str!("../../sweeps/coulomb_fc.toml"), &settings)
    }

    fn of(text: &str, settings: &[(&str, &str)]) -> Self {
        let mut file = SweepFile::parse("sweep.toml", text);
        for (key, value) in settings {
            file.set(key, value);
        }
        let cancellation = Cancellation::new();
        let sweep = file.validate().unwrap().prepare(&cancellation).unwrap();
        let server = LiveServer::bind(&sweep, 0).unwrap();
        let address = server.address();
        let port = address.split([':', '/']).nth(4).unwrap().parse().unwrap();
        let stop = cancellation.clone();
        let thread = Some(std::thread::spawn(move || server.serve(&stop)));
        Self {
            address,
            port,
            sweep,
            cancellation,
            thread,
        }
    }

    /// Sends bytes and reads what comes back.
    fn raw(&self, bytes: &[u8]) -> String {
        let mut stream = TcpStream::connect(("127.0.0.1", self.port)).unwrap();
        // A server that refuses may not read on.
        let _ = stream.write_all(bytes);
        let mut answer = Vec::new();
        let _ = stream.read_to_end(&mut answer);
        String::from_utf8_lossy(&answer).into_owned()
    }

    fn path(&self) -> &str {
        self.address.split_once(&self.port.to_string()).unwrap().1
    }

    fn post(&self, name: &str, body: &str) -> (u16, serde_json::Value) {
        let (port, path) = (self.port, self.path());
        let length = body.len();
        let answer = self.raw(
            format!(
                "POST {path}{name} HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\nOrigin: http://127.0.0.1:{port}\r\n\
                 Content-Type: application/json\r\nContent-Length: {length}\r\n\r\n{body}"
            )
            .as_bytes(),
        );
        let (head, body) = answer.split_once("\r\n\r\n").unwrap();
        (status(head), serde_json::from_str(body).unwrap_or_default())
    }
}

impl Drop for Served {
    fn drop(&mut self) {
        self.cancellation.cancel();
        let _ = self.thread.take().map(std::thread::JoinHandle::join);
    }
}

fn status(answer: &str) -> u16 {
    answer
        .split(' ')
        .nth(1)
        .and_then(|word| word.parse().ok())
        .unwrap_or(0)
}

#[test]
fn a_live_page_solves_what_the_library_solves() {
    let served = Served::new();
    let body = r#"{"lane":"a","ticket":1,"moving":"f_c","values":{"f_c":-0.013,"kappa":0.012}}"#;
    let (code, answer) = served.post("solve", body);
    assert_eq!(code, 200, "{answer}");
    let answer = &answer["done"];
    assert_eq!(answer["frame"]["value"], -0.013);

    let mut file = SweepFile::parse("again.toml", &served.sweep.to_toml());
    file.set("system.parameters.kappa", "0.012");
    let never = Cancellation::new();
    let sweep = file.validate().unwrap().prepare(&never).unwrap();
    let mut session = sweep.source(&never).unwrap().open(&never);
    let solution = session.solve(-0.013).unwrap();
    let engine = base64::engine::general_purpose::STANDARD;
    for (grid, density) in answer["arrays"]
        .as_array()
        .unwrap()
        .iter()
        .zip(&solution.densities)
    {
        let bytes = engine.decode(grid["values"].as_str().unwrap()).unwrap();
        let values = bytes
            .chunks_exact(8)
            .map(|eight| f64::from_le_bytes(eight.try_into().unwrap()));
        let top = density.density.maximum();
        for (value, expected) in values.zip(&density.density.values) {
            assert!((value - expected).abs() <= 1e-7 * top, "{value} {expected}");
        }
    }
    let words = answer["frame"]["found"][0]["words"].as_str().unwrap();
    let found = sweep
        .detector()
        .detect(&solution.densities[0])
        .signature
        .to_string();
    assert_eq!(words, found);
}

#[test]
fn requests_of_a_live_page_are_answered_or_refused_in_words() {
    let served = Served::new();
    let solve = |ticket: u64, rest: &str| {
        let (code, answer) = served.post(
            "solve",
            &format!(r#"{{"lane":"a","ticket":{ticket},{rest}}}"#),
        );
        assert_eq!(code, 200);
        answer
    };
    let refused =
        |answer: &serde_json::Value| answer["refused"].as_str().unwrap_or_default().to_owned();
    let answer = solve(
        2,
        r#""moving":"kappa","values":{"kappa":0.02},"preview":true"#,
    );
    assert!(
        refused(&answer).contains("`f_c`"),
        "the swept parameter has no value: {answer}"
    );
    let answer = solve(
        3,
        r#""moving":"kappa","values":{"kappa":0.02,"f_c":0.0},"marginals_only":true"#,
    );
    let arrays = &answer["done"]["arrays"];
    assert_eq!(
        arrays[0]["edges"][0].as_array().unwrap().len(),
        31,
        "{answer}"
    );
    assert!(arrays[2]["values"].is_null());
    // An older ticket of the same lane is stale; values that are not allowed are refused with what is.
    assert_eq!(
        solve(1, r#""moving":"f_c","values":{"f_c":0.0}"#)["stale"],
        true
    );
    let answer = solve(4, r#""moving":"sigma2","values":{"f_c":0.0,"sigma2":-1.0}"#);
    assert!(refused(&answer).contains("greater than zero"), "{answer}");
    let answer = solve(5, r#""moving":"friction","values":{"friction":0.0}"#);
    assert!(
        refused(&answer).contains("no parameter `friction`"),
        "{answer}"
    );
    assert_ne!(
        refused(&solve(6, r#""moving":"f_c","values":{"f_c":1e999}"#)),
        ""
    );

    let (_, answer) = served.post("sweep-file", r#"{"values":{"kappa":0.03}}"#);
    let file = answer["done"].as_str().unwrap();
    let again = SweepFile::parse("copied.toml", file).validate().unwrap();
    assert!(again.family.fixed().any(|fixed| fixed == ("kappa", 0.03)));

    let locate = r#"{"lane":"l","ticket":1,"values":{},"from":-0.006,"to":0.004}"#;
    let (_, answer) = served.post("locate", locate);
    let rows = answer["done"]["labels"].as_array().unwrap();
    let at_rest = |row: &&serde_json::Value| {
        row["observable"] == 1 && row["value"].as_f64().unwrap().abs() < 1e-4
    };
    assert!(rows.iter().any(|row| at_rest(&row)), "{rows:?}");
}

#[test]
fn the_server_refuses_whoever_is_not_its_page() {
    let served = Served::new();
    let (port, path) = (served.port, served.path());
    let get = |path: &str, headers: &str| {
        status(&served.raw(format!("GET {path} HTTP/1.1\r\n{headers}\r\n\r\n").as_bytes()))
    };
    let host = format!("Host: 127.0.0.1:{port}");
    let page = served.raw(format!("GET {path} HTTP/1.1\r\n{host}\r\n\r\n").as_bytes());
    assert!(
        status(&page) == 200
            && page.contains("<!doctype html>")
            && page.contains("connect-src 'self'")
    );
    assert_eq!(get(path, &format!("Host: localhost:{port}")), 200);
    // Another name that leads here, as DNS rebinding makes one; another origin; no token, or a wrong one; another path.
    assert_eq!(get(path, &format!("Host: evil.example:{port}")), 403);
    assert_eq!(get(path, &format!("{host}\r\nHost: evil.example")), 403);
    assert_eq!(get(path, "X: y"), 403);
    assert_eq!(
        get(path, &format!("{host}\r\nOrigin: http://evil.example")),
        403
    );
    assert_eq!(get(path, &format!("{host}\r\nOrigin: null")), 403);
    assert_eq!(get("/", &host), 403);
    assert_eq!(get("/00000000000000000000000000000000/", &host), 403);
    assert_eq!(get(&format!("{path}../../etc/passwd"), &host), 404);
    assert_eq!(get(&format!("{path}solve"), &host), 405);
    let post =
        |headers: &str| {
            status(&served.raw(
                format!("POST {path}solve HTTP/1.1\r\n{host}\r\n{headers}\r\n\r\n").as_bytes(),
            ))
        };
    assert_eq!(post("Content-Type: text/plain\r\nContent-Length: 0"), 400);
    assert_eq!(
        post("Content-Type: application/json\r\nContent-Length: 70000"),
        413
    );
    assert_eq!(
        post("Content-Type: application/json\r\nSec-Fetch-Site: cross-site"),
        403
    );
    let long = format!("GET {path} HTTP/1.1\r\nX: {}\r\n", "x".repeat(40_000));
    assert!(matches!(status(&served.raw(long.as_bytes())), 413 | 0));
    assert_eq!(status(&served.raw(b"\x16\x03\x01 not HTTP\r\n\r\n")), 400);
}

#[test]
fn the_page_goes_on_when_many_connections_are_held() {
    let served = Served::new();
    // They ask for nothing and are let go after a while.
    let held: Vec<_> = (0..1000)
        .map(|_| TcpStream::connect(("127.0.0.1", served.port)))
        .collect();
    assert!(held.iter().any(Result::is_ok));
    let asked = || {
        status(
            &served.raw(
                format!(
                    "GET {} HTTP/1.1\r\nHost: 127.0.0.1:{}\r\n\r\n",
                    served.path(),
                    served.port
                )
                .as_bytes(),
            ),
        )
    };
    let again = (0..80).find(|_| {
        std::thread::sleep(std::time::Duration::from_millis(100));
        asked() == 200
    });
    assert!(again.is_some(), "the server does not answer any more");
}

/// Asks for paths at some values, from states with their seeds.
fn ask_paths(
    served: &Served,
    values: &str,
    starts: &[(Vec<f64>, u64)],
    turns: f64,
) -> serde_json::Value {
    static TICKET: std::sync::atomic::AtomicU64 = std::sync::atomic::AtomicU64::new(1);
    let ticket = TICKET.fetch_add(1, std::sync::atomic::Ordering::SeqCst);
    let start = |(state, seed): &(Vec<f64>, u64)| serde_json::json!({"state": state, "seed": seed});
    let starts: Vec<serde_json::Value> = starts.iter().map(start).collect();
    let starts = serde_json::Value::from(starts);
    let body = format!(
        r#"{{"lane":"paths","ticket":{ticket},"values":{values},"starts":{starts},"turns":{turns}}}"#
    );
    let (code, answer) = served.post("paths", &body);
    assert_eq!(code, 200, "{answer}");
    answer
}

/// The states of every path of an answer.
fn states(answer: &serde_json::Value) -> Vec<Vec<Vec<f64>>> {
    let done = &answer["done"];
    let dimension = done["dimension"].as_u64().unwrap() as usize;
    let path = |path: &serde_json::Value| {
        let engine = base64::engine::general_purpose::STANDARD;
        let bytes = engine.decode(path["states"].as_str().unwrap()).unwrap();
        let numbers: Vec<f64> = (bytes.chunks_exact(4))
            .map(|four| f64::from(f32::from_le_bytes(four.try_into().unwrap())))
            .collect();
        numbers.chunks(dimension).map(<[f64]>::to_vec).collect()
    };
    let paths = done["paths"].as_array();
    assert!(paths.is_some(), "{answer}");
    paths.unwrap().iter().map(path).collect()
}

#[test]
fn sample_paths_are_the_same_again_and_bounded() {
    let served = Served::new();
    let starts = [(vec![0.3, -0.2], 1), (vec![0.0, 0.0], 2)];
    let first = ask_paths(&served, r#"{"f_c":0.0}"#, &starts, 2.0);
    let paths = states(&first);
    assert_eq!(paths.len(), 2);
    for (path, (start, _)) in paths.iter().zip(&starts) {
        assert!(path.len() > 100 && path.len() <= 3001, "{}", path.len());
        let near = |(a, b): (&f64, &f64)| (a - b).abs() < 1e-7;
        assert!(path[0].iter().zip(start).all(near));
    }
    assert_ne!(paths[0], paths[1]);
    let done = &first["done"];
    // Two periods of an oscillator of frequency near one.
    let periods = done["time"].as_f64().unwrap() / std::f64::consts::TAU;
    assert!((1.5..2.5).contains(&periods), "{first}");
    // The same request, alone or beside another, by this server or another one.
    let other = Served::new();
    for (served, starts) in [(&served, &starts[..]), (&other, &starts[..1])] {
        let again = states(&ask_paths(served, r#"{"f_c":0.0}"#, starts, 2.0));
        assert_eq!(again[..], paths[..starts.len()]);
    }
    // However long a path is asked for, it ends, and its states do not stand further apart for that.
    let long = ask_paths(&served, r#"{"f_c":0.0}"#, &starts[..1], 140.0);
    assert!(states(&long)[0].len() <= 3001);
    assert!(long["done"]["steps"].as_u64().unwrap() <= 200_000);
    let apart = long["done"]["time"].as_f64().unwrap() / states(&long)[0].len() as f64;
    assert!(apart < 0.4, "{apart}");
}

#[test]
fn sample_paths_go_where_the_density_is() {
    let served = Served::new();
    let body = r#"{"lane":"a","ticket":1,"moving":"f_c","values":{"f_c":0.002,"kappa":0.1}}"#;
    let (_, solved) = served.post("solve", body);
    let moments = &solved["done"]["frame"]["moments"];
    let starts: Vec<(Vec<f64>, u64)> = (1..=8).map(|seed| (vec![0.0, 0.0], seed)).collect();
    let found = states(&ask_paths(
        &served,
        r#"{"f_c":0.002,"kappa":0.1}"#,
        &starts,
        140.0,
    ));
    for axis in 0..2 {
        let moment = |k: usize| moments[axis][k].as_f64().unwrap();
        let expected = [moment(0), moment(0).powi(2) + moment(1).powi(2)];
        for (power, expected) in (1..).zip(expected) {
            // Each path is an estimate of its own once it has forgotten its start; their spread tells the error of
            // their mean.
            let means: Vec<f64> = (found.iter())
                .map(|path| {
                    let settled = &path[path.len() / 4..];
                    let sum: f64 = settled.iter().map(|state| state[axis].powi(power)).sum();
                    sum / settled.len() as f64
                })
                .collect();
            let mean = means.iter().sum::<f64>() / 8.0;
            let spread = means.iter().map(|one| (one - mean).powi(2)).sum::<f64>() / 7.0;
            // Student's t of seven degrees of freedom exceeds 4.8 once in 500 times; the streams are fixed.
            let error = 4.8 * (spread / 8.0).sqrt();
            assert!(
                (mean - expected).abs() < error && error < 0.5 * moment(1).powi(power),
                "axis {axis}, power {power}: {mean} {expected} {error}"
            );
        }
    }
}

#[test]
fn sample_paths_follow_internal_states_and_the_memory_of_noise() {
    let dahl = include_str!("../../sweeps/dahl_alpha.toml");
    let served = Served::of(dahl, &[("cells.z.modes", "6")]);
    let paths = states(&ask_paths(
        &served,
        r#"{"alpha":-0.5}"#,
        &[(vec![0.5, 0.0, 0.0], 1)],
        2.0,
    ));
    // Dahl's z stays between ±f_c/λ, to the error of a step.
    let bound = 0.05 / 0.06;
    assert!(paths[0].iter().all(|state| state[2].abs() < 1.01 * bound));
    assert!(paths[0].iter().any(|state| state[2].abs() > 0.1 * bound));

    let served = Served::of(
        include_str!("../../sweeps/gallery/coloured_bistable.toml"),
        &[],
    );
    let starts: Vec<(Vec<f64>, u64)> = (1..=8).map(|seed| (vec![0.0, 0.0], seed)).collect();
    let found = states(&ask_paths(&served, r#"{"tau":0.3}"#, &starts, 140.0));
    let squares: Vec<f64> = (found.iter())
        .map(|path| path.iter().map(|state| state[1].powi(2)).sum::<f64>() / path.len() as f64)
        .collect();
    // The filter's state has the variance one.
    let mean = squares.iter().sum::<f64>() / 8.0;
    let spread = squares.iter().map(|one| (one - mean).powi(2)).sum::<f64>() / 7.0;
    let error = 4.8 * (spread / 8.0).sqrt();
    assert!((mean - 1.0).abs() < error && error < 0.5, "{mean} {error}");
}

#[test]
fn paths_that_cannot_be_followed_are_refused_in_words() {
    let served = Served::new();
    let refused = |values: &str, starts: &[(Vec<f64>, u64)], turns: f64| {
        let answer = ask_paths(&served, values, starts, turns);
        answer["refused"].as_str().unwrap_or_default().to_owned()
    };
    let here = r#"{"f_c":0.0}"#;
    let start = [(vec![0.0, 0.0], 1)];
    assert!(refused(here, &[], 2.0).contains("1 to 8"));
    assert!(refused(here, &vec![start[0].clone(); 9], 2.0).starts_with("9 paths"));
    assert!(refused(here, &[(vec![0.0], 1)], 2.0).contains("a state has 2"));
    let outside = refused(here, &[(vec![0.0, 0.0], 1), (vec![0.0, 77.0], 2)], 2.0);
    assert!(outside.starts_with("path 2 starts at y = 77"), "{outside}");
    for turns in [0.0, -1.0, 1e7] {
        assert!(refused(here, &start, turns).contains("turns"));
    }
    assert!(refused("{}", &start, 2.0).contains("`f_c`"));
    assert!(refused(r#"{"f_c":0.0,"friction":1}"#, &start, 2.0).contains("no parameter"));
    let negative = r#"{"f_c":0.0,"sigma2":-1.0}"#;
    assert!(refused(negative, &start, 2.0).contains("greater than zero"));
    // What is no request at all.
    let (_, answer) = served.post("paths", r#"{"lane":"a"}"#);
    assert!(
        answer["refused"]
            .as_str()
            .unwrap()
            .contains("missing field")
    );
}

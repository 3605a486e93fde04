//! The explorer's live page: what its server solves, answers and refuses.

use std::io::{Read as _, Write as _};
use std::net::TcpStream;
use std::path::{Path, PathBuf};

use base64::Engine as _;
use pbif::cancellation::Cancellation;
use pbif::continuation::DensitySource as _;
use pbif::explore::LiveServer;
use pbif::sweep_file::{MethodKind, SweepFile};
use pbif::topology::Detector as _;

use super::explorer::scene;
use crate::common::sweeps::prepared;

/// A live server of a small sweep, which ends with the test.
pub(super) struct Served {
    address: String,
    pub(super) port: u16,
    sweep: pbif::sweep_file::Sweep,
    cancellation: Cancellation,
    thread: Option<std::thread::JoinHandle<()>>,
}

impl Served {
    pub(super) fn new() -> Self {
        let coulomb = include_str!("../../sweeps/coulomb_fc.toml");
        Self::of(
            coulomb,
            "cells.x.count=30 cells.y.count=30 locate.grid_check=off",
        )
    }

    pub(super) fn of(text: &str, settings: &str) -> Self {
        let cancellation = Cancellation::new();
        let sweep = prepared(text, settings);
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

    /// A request as the page sends it.
    pub(super) fn request(&self, name: &str, body: &str) -> String {
        let (port, path) = (self.port, self.path());
        let length = body.len();
        format!(
            "POST {path}{name} HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\nOrigin: http://127.0.0.1:{port}\r\n\
             Content-Type: application/json\r\nContent-Length: {length}\r\n\r\n{body}"
        )
    }

    /// The page in a folder below the address, head included.
    pub(super) fn page(&self, folder: &str) -> String {
        let (port, path) = (self.port, self.path());
        let host = format!("Host: 127.0.0.1:{port}");
        self.raw(format!("GET {path}{folder} HTTP/1.1\r\n{host}\r\n\r\n").as_bytes())
    }

    pub(super) fn post(&self, name: &str, body: &str) -> (u16, serde_json::Value) {
        let answer = self.raw(self.request(name, body).as_bytes());
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

pub(super) fn status(answer: &str) -> u16 {
    let word = answer.split(' ').nth(1);
    word.and_then(|word| word.parse().ok()).unwrap_or(0)
}

/// Numbers of an array of bytes.
pub(super) fn decoded(packed: &serde_json::Value) -> Vec<u8> {
    let engine = base64::engine::general_purpose::STANDARD;
    engine.decode(packed.as_str().unwrap()).unwrap()
}

#[test]
fn clients_that_say_nothing_do_not_keep_the_page_from_being_served() {
    let served = Served::new();
    let slow: Vec<TcpStream> = (0..80)
        .map(|_| {
            let mut stream = TcpStream::connect(("127.0.0.1", served.port)).unwrap();
            let _ = stream.write_all(b"GET ");
            stream
        })
        .collect();
    let clock = std::time::Instant::now();
    let body = r#"{"lane":"a","ticket":1,"moving":"f_c","values":{"f_c":0.0}}"#;
    assert_eq!(served.post("solve", body).0, 200);
    // They are dismissed after three seconds.
    assert!(clock.elapsed().as_secs_f64() < 2.5 && slow.len() == 80);
}

#[test]
fn a_live_page_solves_what_the_library_solves() {
    let served = Served::new();
    let body = r#"{"lane":"a","ticket":1,"moving":"f_c","values":{"f_c":-0.013,"kappa":0.012}}"#;
    let (code, answer) = served.post("solve", body);
    assert_eq!(code, 200, "{answer}");
    let answer = &answer["done"];
    assert_eq!(answer["frame"]["value"], -0.013);

    let never = Cancellation::new();
    let sweep = prepared(&served.sweep.to_toml(), "system.parameters.kappa=0.012");
    let mut session = sweep.source(&never).unwrap().open(&never);
    let solution = session.solve(-0.013).unwrap();
    let arrays = answer["arrays"].as_array().unwrap();
    for (grid, density) in arrays.iter().zip(&solution.densities) {
        let bytes = decoded(&grid["values"]);
        let values = bytes.chunks_exact(8);
        let values = values.map(|eight| f64::from_le_bytes(eight.try_into().unwrap()));
        let top = density.density.maximum();
        for (value, expected) in values.zip(&density.density.values) {
            assert!((value - expected).abs() <= 1e-7 * top, "{value} {expected}");
        }
    }
    let words = answer["frame"]["found"][0]["words"].as_str().unwrap();
    let found = sweep.detector().detect(&solution.densities[0]);
    assert_eq!(words, found.signature.to_string());
}

#[test]
#[rustfmt::skip]
fn requests_of_a_live_page_are_answered_or_refused_in_words() {
    let served = Served::new();
    let solve = |ticket: u64, rest: &str| {
        let body = format!(r#"{{"lane":"a","ticket":{ticket},{rest}}}"#);
        let (code, answer) = served.post("solve", &body);
        assert_eq!(code, 200);
        answer
    };
    let refused = |ticket: u64, rest: &str| {
        let answer = solve(ticket, rest);
        answer["refused"].as_str().unwrap_or_default().to_owned()
    };
    // The swept parameter has no value.
    let words = refused(
        2,
        r#""moving":"kappa","values":{"kappa":0.02},"preview":true"#,
    );
    assert!(words.contains("`f_c`"), "{words}");
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
    for (ticket, rest, says) in [
        (4, r#""moving":"sigma2","values":{"f_c":0.0,"sigma2":-1.0}"#, "greater than zero"),
        (5, r#""moving":"friction","values":{"friction":0.0}"#, "no parameter `friction`"),
    ] {
        let words = refused(ticket, rest);
        assert!(words.contains(says), "{words}");
    }
    assert_ne!(refused(6, r#""moving":"f_c","values":{"f_c":1e999}"#), "");

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
#[rustfmt::skip]
fn the_server_refuses_whoever_is_not_its_page() {
    let served = Served::new();
    let (port, path) = (served.port, served.path());
    let get = |path: &str, headers: &str| {
        status(&served.raw(format!("GET {path} HTTP/1.1\r\n{headers}\r\n\r\n").as_bytes()))
    };
    let host = format!("Host: 127.0.0.1:{port}");
    let page = served.page("");
    assert!(
        status(&page) == 200
            && page.contains("<!doctype html>")
            && page.contains("connect-src 'self'")
    );
    assert_eq!(get(path, &format!("Host: localhost:{port}")), 200);
    // Another name that leads here, as DNS rebinding makes one; another origin; no token, or a wrong one; another path.
    for (path, headers, code) in [
        (path, &format!("Host: evil.example:{port}"), 403),
        (path, &format!("{host}\r\nHost: evil.example"), 403),
        (path, &"X: y".to_owned(), 403),
        (path, &format!("{host}\r\nOrigin: http://evil.example"), 403),
        (path, &format!("{host}\r\nOrigin: null"), 403),
        ("/", &host, 403),
        ("/00000000000000000000000000000000/", &host, 403),
        (&format!("{path}../../etc/passwd"), &host, 404),
        (&format!("{path}solve"), &host, 405),
    ] {
        assert_eq!(get(path, headers), code, "{path} {headers}");
    }
    for (headers, code) in [
        ("Content-Type: text/plain\r\nContent-Length: 0", 400),
        ("Content-Type: application/json\r\nContent-Length: 70000", 413),
        ("Content-Type: application/json\r\nSec-Fetch-Site: cross-site", 403),
    ] {
        let request = format!("POST {path}solve HTTP/1.1\r\n{host}\r\n{headers}\r\n\r\n");
        assert_eq!(status(&served.raw(request.as_bytes())), code, "{headers}");
    }
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
    let (path, port) = (served.path(), served.port);
    let request = format!("GET {path} HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\n\r\n");
    let asked = || status(&served.raw(request.as_bytes()));
    let again = (0..80).find(|_| {
        std::thread::sleep(std::time::Duration::from_millis(100));
        asked() == 200
    });
    assert!(again.is_some(), "the server does not answer any more");
}

/// The sweep files that are shipped, and those of the gallery.
fn shipped_files() -> Vec<PathBuf> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("sweeps");
    let folders = [root.clone(), root.join("gallery")].into_iter();
    let entries = folders.flat_map(|folder| std::fs::read_dir(folder).unwrap());
    let mut files: Vec<PathBuf> = entries.map(|entry| entry.unwrap().path()).collect();
    files.retain(|file| file.extension().is_some_and(|ending| ending == "toml"));
    files.sort();
    files
}

/// Keys that make a sweep cheap: a dozen cells an axis, two modes, few samples.
fn cheap(text: &str) -> Vec<(String, &'static str)> {
    let settings = SweepFile::parse("sweep.toml", text).validate().unwrap();
    let named = settings.family.model().axes.iter().zip(&settings.axes);
    let cells = named.map(|(axis, cells)| match cells.modes_by(settings.method.kind) {
        Some(_) => (format!("cells.{}.modes", axis.name), "2"),
        None => (format!("cells.{}.count", axis.name), "12"),
    });
    let sampled = [("samples", "16"), ("map_step", "1"), ("time_step", "0.1")];
    let sampled = sampled.map(|(key, value)| (format!("method.{key}"), value));
    let is_sampled = settings.method.kind == MethodKind::Sgcm;
    let sampled = sampled.into_iter().filter(|_| is_sampled);
    cells.chain(sampled).collect()
}

/// The live page of a file opens, and the swept slider and those of these numbers can be moved: the densities come on
/// the cells that the page was told, unless the system has none, which words say.
fn assert_sliders_move(file: &Path, is_moved: impl Fn(usize) -> bool) {
    let text = std::fs::read_to_string(file).unwrap();
    let settings = cheap(&text);
    let settings: Vec<String> = (settings.iter())
        .map(|(key, value)| format!("{key}={value}"))
        .collect();
    let served = Served::of(&text, &settings.join(" "));
    let page = served.page("");
    assert_eq!(status(&page), 200, "{}", file.display());
    let scene = scene(&page);
    let family = served.sweep.problem.family();
    let (from, to) = family.ends();
    let swept = family.parameter();
    let mut values = serde_json::Map::new();
    values.insert(swept.to_owned(), (0.5 * (from + to)).into());
    let parameters = scene["parameters"].as_array().unwrap();
    for (ticket, parameter) in (1..).zip(parameters) {
        let name = parameter["name"].as_str().unwrap();
        if name != swept && !is_moved(ticket) {
            continue;
        }
        let moved = parameter["value"]
            .as_f64()
            .map_or(0.6 * from + 0.4 * to, |value| 1.01 * value);
        let mut values = values.clone();
        values.insert(name.to_owned(), moved.into());
        let ask =
            serde_json::json!({"lane": "a", "ticket": ticket, "moving": name, "values": values});
        let (code, answer) = served.post("solve", &ask.to_string());
        let asked = format!("{}: {name} = {moved}: {answer}", file.display());
        assert_eq!(code, 200, "{asked}");
        assert!(answer["done"].is_object(), "{asked}");
        let status = &answer["done"]["frame"]["status"];
        // Where a system has no steady state, nothing can be told of one beside it.
        let is_unsolved = status == "not-converged" && file.ends_with("dahl_alpha_eq8.toml");
        if status == "no-steady-state" || is_unsolved {
            continue;
        }
        let (shown, grids) = (
            scene["arrays"].as_array(),
            answer["done"]["arrays"].as_array(),
        );
        let (shown, grids) = (shown.unwrap(), grids.unwrap());
        assert!(!shown.is_empty() && shown.len() == grids.len(), "{asked}");
        for (shown, grid) in shown.iter().zip(grids) {
            assert_eq!(shown["edges"], grid["edges"], "{asked}");
        }
    }
}

/// Sliders of most files are of the same models and names: a third of them, by turns, finds what all find.
#[test]
fn every_shipped_file_opens_live_and_its_sliders_move() {
    for (number, file) in shipped_files().iter().enumerate() {
        assert_sliders_move(file, |slider| (slider + number) % 3 == 0);
    }
}

#[test]
#[ignore = "half a minute: all sliders"]
fn every_slider_of_every_shipped_file_moves_at_length() {
    for file in shipped_files() {
        assert_sliders_move(&file, |_| true);
    }
}

//! Power spectra from a sweep file to tables, rows and figures.

use nalgebra::Complex;

use crate::common::numbers::assert_holds;
use crate::common::room::Room;

/// x'' = -x - 2ζx' + 0.4 ξ: the maximum of the spectrum of x leaves zero where 2ζ² = 1.
const FILE: &str = r#"title = "spectra"
[system.equations]
x = "v"
v = "-x - 2 zeta v"
[system.noise]
v = "0.4"
[system.parameters]
zeta = 0.5
[sweep]
parameter = "zeta"
from = 0.25
to = 0.85
points = 13
[cells]
x = { from = -2.4, to = 2.4, count = 48 }
v = { from = -2.4, to = 2.4, count = 48 }
[detect]
marginals = ["x"]
joint = []
[watch]
square = "x^2"
[spectrum]
of = ["x", "square", "x, v"]
to = 5.0
points = 51
lag = 20
[locate]
relative_tolerance = 1e-3
[figures]
draw = ["spectrum", "spectrogram", "correlation"]
"#;

/// Slope of the spectrum of x², up to a factor, from its closed form: twice the square of the correlation of x.
fn slope_of_square(zeta: f64, frequency: f64) -> f64 {
    let fast = (1.0 - zeta * zeta).sqrt();
    let (lean, decay, twice) = (zeta / fast, 2.0 * zeta, 2.0 * fast);
    let power = |frequency: f64| {
        let s = Complex::new(decay, frequency);
        let line = s * s + twice * twice;
        let terms = 0.5 * (1.0 + lean * lean) / s + 0.5 * (1.0 - lean * lean) * s / line;
        (terms + lean * twice / line).re
    };
    let h = 1e-5;
    (power(frequency + h) - power(frequency - h)) / (2.0 * h)
}

/// Where the maximum of the spectrum of x² above zero vanishes: its largest slope there passes zero.
fn fold_of_square() -> f64 {
    let largest = |zeta: f64| {
        let slopes = (0..4000).map(|number| slope_of_square(zeta, 1.0 + 5e-4 * f64::from(number)));
        slopes.fold(f64::NEG_INFINITY, f64::max)
    };
    let (mut low, mut high) = (0.25, 0.45);
    for _ in 0..40 {
        let middle = 0.5 * (low + high);
        if largest(middle) > 0.0 {
            low = middle
        } else {
            high = middle
        }
    }
    0.5 * (low + high)
}

#[test]
fn a_sweep_has_its_spectra_and_the_values_at_which_their_shapes_change() {
    let room = Room::new();
    room.write("a.toml", FILE);
    room.done("sweep a.toml --out run");
    for row in &room.table("run/points.csv").0 {
        let [zeta] = row.numbers(["zeta"]);
        let time = row.numbers(["correlation_time_x", "correlation_time_x_error"]);
        assert_holds(time, 2.0 * zeta, 1e-3);
        if 2.0 * zeta * zeta < 0.98 {
            let peak = row.numbers(["spectral_peak_x", "spectral_peak_x_error"]);
            assert_holds(peak, (1.0 - 2.0 * zeta * zeta).sqrt(), 1e-2);
        }
    }
    // The spectrum of x, and that of x with v, which is -iω of it.
    for row in &room.table("run/spectra.csv").0 {
        let [zeta, frequency, power, error] =
            row.numbers(["zeta", "frequency", "power", "power_error"]);
        let w = frequency * frequency;
        let exact = 0.16 / ((1.0 - w).powi(2) + 4.0 * zeta * zeta * w);
        match &row["of"] {
            "x" => assert_holds([power, error], exact, 1e-2 * exact),
            "x, v" => {
                let [imaginary, error] = row.numbers(["imaginary", "imaginary_error"]);
                assert!((imaginary + frequency * exact).abs() <= error, "{row:?}");
            }
            _ => {}
        }
    }
    let rows = room.table("run/bifurcations.csv");
    let of = |name: &str| {
        let row = rows.0.iter().find(|row| row["observable"] == *name);
        let row = row.unwrap_or_else(|| panic!("no row of {name}: {rows:?}"));
        assert!(
            row["label"].starts_with("SB") && row["status"] == *"located",
            "{row:?}"
        );
        row.numbers(["value", "error"])
    };
    assert_holds(of("spectrum of x"), 0.5f64.sqrt(), 1e-3);
    assert_holds(of("spectrum of square"), fold_of_square(), 2e-3);
    room.holds_all("run", "spectra.csv correlations.csv");
    room.holds_all(
        "run/figures",
        "spectrum_x.svg spectrum_square.svg spectrum_x_v.svg spectrogram_x.svg correlation_x.svg",
    );
    // What is stored is drawn and detected as what was solved.
    room.done("plot run --out again");
    assert_eq!(
        room.read("again/spectrogram_x.svg"),
        room.read("run/figures/spectrogram_x.svg")
    );
    room.done("detect run --out detected");
    assert_eq!(
        room.read("detected/bifurcations.csv"),
        room.read("run/bifurcations.csv")
    );
    assert_eq!(
        room.read("detected/spectra.csv"),
        room.read("run/spectra.csv")
    );
    room.done("verify run");
}

#[test]
fn what_cannot_be_asked_of_fluctuations_is_said() {
    let room = Room::new();
    room.write("a.toml", FILE);
    let refused = |set: &str, words: &[&str]| {
        room.refused(&format!("check a.toml {set}"), words);
    };
    refused(
        "spectrum.of=[\"y\"]",
        &["`y` is no axis", "square", "[watch]"],
    );
    refused("spectrum.of=[\"x,v,x\"]", &["names 3 observables"]);
    refused("spectrum.of=[]", &["empty"]);
    refused(
        "spectrum.from=6.0",
        &["the lowest frequency, 6, is not below the highest, 5"],
    );
    refused(
        "method.kind=\"monte-carlo\"",
        &["spectra are worked out by `generator`", "[spectrum]"],
    );
    refused("spectrum.to=-1", &["greater than zero"]);
}

#[test]
fn visits_that_have_no_numbers_are_refused_with_a_way_out() {
    let room = Room::new();
    let visits = "[visits]\nhigh = \"x > 0.5\"\n";
    room.write("a.toml", format!("{FILE}{visits}"));
    room.done("check a.toml")
        .says(&["[visits]", "high = \"x > 0.5\""]);
    let refused = |set: &str, words: &[&str]| {
        room.refused(&format!("check a.toml {set}"), words);
    };
    refused("visits.high=\"y>0.5\"", &["region `high_visits`", "`y`"]);
    refused(
        "visits.high=\"peak\"",
        &["`peak` is neither an inequality nor the name of a region"],
    );
    refused("visits.high=2", &["`visits.high`", "string"]);
    room.write(
        "forced.toml",
        "[system.equations]\nx = \"v\"\nv = \"-0.4 v - x + F cos(t)\"\n[system.noise]\nv = \"0.5\"\n\
         [system.parameters]\nF = 0.2\n[sweep]\nparameter = \"F\"\nfrom = 0.1\nto = 0.2\npoints = 2\n\
         [visits]\nhigh = \"x > 0.5\"\n[method]\nkind = \"sgcm\"\n",
    );
    room.refused(
        "check forced.toml",
        &["visits of a forced system are worked out by `generator` and `monte-carlo`"],
    );
    let line = "[system.equations]\nx = \"x - x^3\"\n[system.noise]\nx = \"sqrt(2 D)\"\n[system.parameters]\nD = 0.2\n\
                [sweep]\nparameter = \"D\"\nfrom = 0.1\nto = 0.2\npoints = 2\n";
    room.write("b.toml", format!("{line}{visits}"));
    room.refused("check b.toml", &["a system with one axis", "transitions"]);
}

#[test]
fn a_highest_frequency_is_found_and_stays() {
    let room = Room::new();
    room.write(
        "a.toml",
        FILE.replace("to = 5.0\npoints = 51\nlag = 20\n", ""),
    );
    let checked = room.done("check a.toml");
    // Six times the frequency of the oscillator, which is one: the deviation of v over that of x.
    checked.says(&[
        "frequencies up to",
        "[spectrum]",
        "points = 241",
        "sides = \"two\"",
    ]);
}

#[test]
fn a_maximum_that_leaves_zero_with_a_jump_of_its_rise_is_one_row() {
    // cos(φ) of a washboard: where the curvature at zero changes its sign, the rise to a maximum above zero begins at
    // once. The curvature is that of the table.
    let room = Room::new();
    let file = r#"
[system.equations]
phi = "w - sin(phi)"
[system.noise]
phi = "sqrt(2 * 0.3)"
[system.bounds]
phi = "periodic"
[system.parameters]
w = 0.5
[sweep]
parameter = "w"
from = 0.5
to = 1.1
points = 9
[watch]
c = "cos(phi)"
[spectrum]
of = ["c"]
[figures]
draw = []
"#;
    room.write("washboard.toml", file);
    room.solved("sweep washboard.toml --out run --quiet");
    let rows = room.table("run/bifurcations.csv");
    let labels = rows.column("label");
    let spectral: Vec<_> = labels.iter().filter(|one| one.starts_with("SB")).collect();
    assert_eq!(spectral.len(), 1, "{spectral:?}");
    assert!(rows.column("status").contains(&"located"));
    let curvatures = room.table("run/points.csv");
    let signs: Vec<bool> = (curvatures.0.iter())
        .map(|row| row.number("spectral_curvature_c") < 0.0)
        .collect();
    assert!(signs.first() != signs.last());
}

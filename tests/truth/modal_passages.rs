//! Passages, visits and means of systems with states that series carry: coloured noise and angles. What a series does
//! not tell must be in the errors.

use std::f64::consts::{PI, TAU};

use pbif::continuation::{Finding, Solution};
use statrs::function::erf::erfc;

use crate::common::sweeps::{measure, solved};

/// A double well that coloured noise drives.
const WELL: &str = r#"
[system.equations]
x = "x - x^3"
[system.noise]
kind = "ornstein-uhlenbeck"
x = "s"
[system.parameters]
tau = 0.5
[sweep]
parameter = "s"
from = 0.8
to = 0.9
points = 2
[cells]
x = { from = -2, to = 2, count = 100 }
[passage]
over = { start = { x = -1, noise = 0 }, until = "x > 0.5", times = [10] }
either = { start = { x = 0, noise = 0.5 }, until = ["x > 0.8", "x < -1.2"] }
"#;

/// A pendulum with noise on its velocity.
const ROTOR: &str = r#"
[system.equations]
th = "v"
v = "-0.74 v - k sin(th) + 0.3 cos(2 th)"
[system.noise]
v = "sqrt(0.62)"
[system.bounds]
th = "periodic"
[sweep]
parameter = "k"
from = 1.9
to = 1.95
points = 2
[cells]
v = { from = -4.2, to = 4.7, count = 80 }
[passage]
fast = { start = { th = -1.1, v = -0.15 }, until = ["v > 1.18", "v < -1.36"] }
"#;

/// A pendulum in balance at a temperature, by trajectories.
const BALANCE: &str = r#"
[system.equations]
p = "v"
v = "-0.4 v - 0.7 sin(p)"
[system.noise]
v = "sqrt(0.8 T)"
[system.bounds]
p = "periodic"
[sweep]
parameter = "T"
from = 0.9
to = 0.95
points = 2
[visits]
behind = "p < -2 or p > 1"
[method]
kind = "monte-carlo"
"#;

/// Both know a number, within so many of their errors together.
#[track_caller]
fn agree(one: &Solution<'_>, other: &Solution<'_>, names: &[&str], errors: f64) {
    for name in names {
        let (own, by_other) = (measure(one, name), measure(other, name));
        let off = (own.0 - by_other.0).abs() / (own.1 + by_other.1);
        println!("{name}: {own:?} and {by_other:?}, {off:.2}");
        assert!(off <= errors, "{name}: {own:?} and {by_other:?}");
    }
}

/// The rotor with a torque that turns it, and without a passage.
fn driven_rotor() -> String {
    let force = "-0.74 v - k sin(th) + 0.3 cos(2 th)";
    let text = ROTOR.replace(force, "0.5 - 0.6 v - k sin(th)");
    let text = text.replace("sqrt(0.62)", "sqrt(0.6)");
    let text = text.replace("from = 1.9\nto = 1.95", "from = 0.8\nto = 0.85");
    text[..text.find("[passage]").unwrap()].to_owned()
}

#[test]
fn passages_under_coloured_noise_do_not_depend_on_how_the_noise_is_carried() {
    let names = [
        "over_mean",
        "over_sd",
        "over_rate",
        "over_10_survival",
        "either_mean",
        "either_sd",
        "either_1_share",
    ];
    let by = |noise: &str| solved(WELL, &format!("cells.noise={{{noise}}}"), Some(0.8)).1;
    let cells = by("count=90");
    for modes in ["modes=12", "modes=24"] {
        let found = by(modes);
        agree(&found, &cells, &names, 1.0);
        // The errors are none that anything is within.
        for name in names {
            let (value, error) = measure(&found, name);
            assert!(error <= 5e-3 * value, "{modes}: {name} {value} ± {error}");
        }
    }
}

#[test]
fn noise_that_multiplies_the_state_is_seen_to_lead_over_a_border() {
    // At x = 0 the noise moves nothing.
    let text = WELL
        .replace("x - x^3", "0.2 - 0.5 x")
        .replace("x = \"s\"", "x = \"s x\"")
        .replace("from = -2, to = 2", "from = 0, to = 8");
    let text = format!(
        "{}[passage]\nup = {{ start = {{ x = 0.5, noise = -0.4 }}, until = \"x > 2\" }}\n",
        &text[..text.find("[passage]").unwrap()]
    );
    let by = |noise: &str| solved(&text, &format!("cells.noise={{{noise}}}"), Some(0.8)).1;
    agree(
        &by("modes=16"),
        &by("count=90"),
        &["up_mean", "up_sd", "up_rate"],
        1.0,
    );
}

#[test]
fn a_rotor_starts_at_the_angle_that_is_given() {
    let names = ["fast_mean", "fast_sd", "fast_1_share"];
    let (_, found) = solved(ROTOR, "", Some(1.9));
    let words = "method.kind=\"monte-carlo\" method.passages=20000";
    let (_, by_paths) = solved(ROTOR, words, Some(1.9));
    // Errors of paths are standard errors.
    agree(&found, &by_paths, &names, 3.0);
}

#[test]
fn visits_under_coloured_noise_are_those_of_rice() {
    let text = WELL
        .replace("x - x^3", "-x")
        .replace("from = -2, to = 2", "from = -3.6, to = 3.6");
    let text = format!(
        "{}[visits]\nu = \"x > 0.3\"\n",
        &text[..text.find("[passage]").unwrap()]
    );
    let (s, tau, level) = (0.8_f64, 0.5_f64, 0.3_f64);
    // x' = -x + s η/√(2τ) with η' = -η/τ + √(2/τ) w: variances of x and of x'.
    let coupling = s / (2.0 * tau).sqrt();
    let shared = coupling * tau / (1.0 + tau);
    let variance = coupling * shared;
    let of_speed = variance - 2.0 * coupling * shared + coupling * coupling;
    let exact = (of_speed / variance).sqrt() / TAU * (-level * level / (2.0 * variance)).exp();
    for modes in [8, 12, 24] {
        let words = format!("cells.noise={{modes={modes}}}");
        let (rate, error) = measure(&solved(&text, &words, Some(s)).1, "u_visits");
        println!("{modes} modes: {rate} ± {error:.1e}, exactly {exact}");
        let off = (rate - exact).abs();
        assert!(
            off <= error && error <= 1e-2 * exact,
            "{rate} ± {error}, exactly {exact}"
        );
    }
}

#[test]
fn means_under_coloured_noise_have_a_part_for_its_modes() {
    let text = WELL.replace("x - x^3", "0.1 - x^3 + 0.5 sin(3 x)");
    let text = text.replace("tau = 0.5", "tau = 0.08");
    let text = text.replace("count = 100", "count = 200");
    let text = format!(
        "{}[watch]\nax = \"tanh(3 x)\"\n",
        &text[..text.find("[passage]").unwrap()]
    );
    let by = |modes: usize| solved(&text, &format!("cells.noise={{modes={modes}}}"), Some(0.9)).1;
    let many = by(24);
    for modes in [5, 6, 8] {
        agree(
            &by(modes),
            &many,
            &["mean_x", "sd_x", "mean_ax", "sd_ax"],
            1.0,
        );
    }
}

#[test]
fn shares_of_the_time_have_a_part_for_modes_that_feed_into_the_first() {
    // A linear system under coloured noise: x is normal with the variance s²/(2 k (1 + k tau)). The mass of a region of
    // x alone is carried by the first mode, which leaving out the last ones takes nothing from.
    let text = r#"
system.equations = { x = "-0.107 - k x" }
system.noise = { kind = "ornstein-uhlenbeck", x = "0.52" }
system.parameters = { tau = 0.303 }
sweep = { parameter = "k", from = 0.589, to = 0.989, points = 2 }
cells = { x = { from = -2.83, to = 2.466, count = 90 } }
detect = { marginals = ["x"], joint = [] }
visits = { high = "x > 0.363" }
"#;
    for k in [0.589_f64, 0.989] {
        let deviation = 0.52 / (2.0 * k * (1.0 + k * 0.303)).sqrt();
        let exact = 0.5 * erfc((0.363 + 0.107 / k) / deviation / 2.0_f64.sqrt());
        for modes in [5, 6, 7, 8, 10] {
            let words = format!("cells.noise={{modes={modes}}}");
            let (_, found) = solved(text, &words, Some(k));
            let (share, error) = measure(&found, "high_time_share");
            let off = (share - exact).abs();
            assert!(
                off <= error,
                "{modes} at {k}: {share} ± {error:e}, exactly {exact}"
            );
            assert!(modes < 10 || error < 1e-3 * exact, "{k}: {error:e}");
        }
    }
}

#[test]
fn the_ends_of_the_range_of_a_velocity_are_in_the_errors_of_how_an_angle_turns() {
    let text = driven_rotor();
    // Deviations of the velocity from its mean to the ends, and the cells there.
    let by = |deviations: f64, cells: usize| {
        let half = deviations / 2.0_f64.sqrt();
        let (from, to) = (0.25 - half, 0.25 + half);
        let words = format!("cells.v={{from={from},to={to},count={cells}}}");
        solved(&text, &words, Some(0.8)).1
    };
    let whole = by(8.0, 250);
    for deviations in [4.0, 4.5, 5.0, 5.5] {
        let found = by(deviations, 140);
        agree(&found, &whole, &["velocity_th", "diffusion_th"], 1.0);
    }
}

#[test]
fn trajectories_see_regions_of_an_angle_within_its_turn() {
    let temperature = 0.9;
    let weight = |p: f64| (0.7 * p.cos() / temperature).exp();
    let integral = |from: f64, to: f64| -> f64 {
        let count = 20_000;
        let step = (to - from) / f64::from(count);
        let middles = (0..count).map(|k| weight(from + (f64::from(k) + 0.5) * step));
        middles.sum::<f64>() * step
    };
    let whole = integral(-PI, PI);
    let share = (integral(-PI, -2.0) + integral(1.0, PI)) / whole;
    // Entries through both ends, each with the mean speed of one direction.
    let rate = (temperature / TAU).sqrt() * (weight(-2.0) + weight(1.0)) / whole;
    let (_, found) = solved(BALANCE, "", Some(temperature));
    for (name, exact) in [("behind_time_share", share), ("behind_visits", rate)] {
        let (value, error) = measure(&found, name);
        println!("{name}: {value} ± {error:.1e}, exactly {exact}");
        let holds = (value - exact).abs() <= 4.0 * error && error <= 0.03 * exact;
        assert!(holds, "{name} {value} ± {error}, exactly {exact}");
    }
}

#[test]
fn the_step_of_trajectories_is_short_beside_a_turn_where_regions_are_looked_for() {
    let text = r#"
[system.equations]
p = "w"
[system.noise]
p = "0.3"
[system.bounds]
p = "periodic"
[sweep]
parameter = "w"
from = -1
to = -0.9
points = 2
[passage]
half = { from = "cos(p) < -0.5", to = "cos(p) > 0.5", transitions = "on" }
[method]
kind = "monte-carlo"
longest_passage = 50
"#;
    let (_, found) = solved(text, "", Some(-1.0));
    let (value, error) = measure(&found, "half_transition_flux");
    // Once a turn; against the drift one in exp(-2 w π/3 / (0.3²/2)) < 1e-19.
    let exact = 1.0 / TAU;
    println!("{value} ± {error:.1e}, exactly {exact}");
    assert!((value - exact).abs() <= 4.0 * error && error <= 0.01 * exact);
}

#[test]
fn errors_of_velocity_and_diffusion_by_few_harmonics_hold_and_are_no_bounds() {
    let cells = "from = -4.2, to = 4.7, count = 80";
    let text = driven_rotor().replace(cells, "from = -5.4, to = 5.9, count = 140");
    let by = |harmonics: usize| solved(&text, &format!("cells.th.modes={harmonics}"), Some(0.8)).1;
    let many = by(20);
    for (harmonics, widest) in [(4, 0.3), (6, 5e-4), (8, 2e-5)] {
        let found = by(harmonics);
        agree(&found, &many, &["velocity_th", "diffusion_th"], 1.0);
        for name in ["velocity_th", "diffusion_th"] {
            let (value, error) = measure(&found, name);
            assert!(
                error <= widest * value,
                "{harmonics}: {name} {value} ± {error}"
            );
        }
    }
}

#[test]
fn a_deviation_of_a_variance_below_zero_is_not_known() {
    let text = r#"
[system.equations]
phi = "w + 1.7 sin(phi) + 0.57 cos(phi)"
[system.noise]
phi = "sqrt(0.06)"
[system.bounds]
phi = "periodic"
[sweep]
parameter = "w"
from = 1.03
to = 1.13
points = 2
[cells]
phi = { modes = 5 }
[watch]
c = "cos(phi)"
"#;
    let (_, found) = solved(text, "", Some(1.03));
    let deviation = found
        .report
        .measures
        .iter()
        .find(|one| one.name == "sd_c")
        .unwrap();
    // Five harmonics cannot carry this density: what they give is below zero where it should be next to nothing.
    assert!(
        deviation.value > 0.0 || deviation.error.is_none(),
        "{deviation:?}"
    );
    assert!(
        found
            .report
            .findings
            .iter()
            .any(|one| matches!(one, Finding::FewModes { .. }))
    );
}

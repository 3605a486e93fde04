//! What fluctuates on a circle: relaxation, spectra, first passage and means of formulas with an angle, against closed
//! forms.

use crate::common::sweeps::{measure, settings, solved};
use pbif::cancellation::Cancellation;
use pbif::sweep_file::SweepFile;

/// θ' = v, v' = -g v + τ - force + √(2 g T) ξ at g = 0.5, T = 0.6, with τ swept, and lines of a file after it.
fn rotor(force: &str, rest: &str) -> String {
    format!(
        "[system.equations]\ntheta = \"v\"\nv = \"-g v + tau - {force}\"\n[system.noise]\nv = \"sqrt(2 g T)\"\n\
         [system.parameters]\ng = 0.5\nT = 0.6\ntau = 0.5\n[system.bounds]\ntheta = \"periodic\"\n\
         [sweep]\nparameter = \"tau\"\nfrom = 0.2\nto = 0.5\npoints = 2\n{rest}"
    )
}

/// Of a force that is zero.
const NONE: &str = "0 sin(theta)";

#[test]
fn a_free_rotor_relaxes_as_its_closed_form_says() {
    // H. Risken, The Fokker-Planck Equation, section 10.3: n g + k² T/g, and k τ/g for the frequency.
    let text = rotor(NONE, "[relaxation]\nmodes = 5\n");
    // Seven standard deviations about the mean velocity, so that the ends of the range change nothing.
    let range = "cells.v.from=-4.8 cells.v.to=6";
    let (_, solution) = solved(&text, range, Some(0.3));
    // Decay rate and frequency, and the largest error that serves; of the last mode fewer cells know less.
    let exact = [
        (0.5, 0.0, 1e-3),
        (1.0, 0.0, 1e-3),
        (1.2, 0.6, 1e-3),
        (1.5, 0.0, 1e-3),
        (1.7, 0.6, 0.05),
    ];
    for (mode, (decay, frequency, largest)) in exact.into_iter().enumerate() {
        for (name, exact) in [("rate", decay), ("frequency", frequency)] {
            let (value, error) = measure(&solution, &format!("decay_{name}_{}", mode + 1));
            let off = (value - exact).abs();
            // A frequency of zero has no error.
            assert!(off <= error + 1e-12, "{mode} {name}: {off:e} of {error:e}");
            assert!(error < largest, "{mode} {name}: {error:e}");
        }
    }
}

#[test]
fn the_spectrum_of_a_cosine_on_a_circle_is_two_lines() {
    // θ' = w + √(2 D) ξ: C(τ) = e^{-Dτ} cos(w τ)/2.
    let (d, w) = (0.3, 0.4);
    let text = format!(
        "[system.equations]\ntheta = \"w\"\n[system.noise]\ntheta = \"sqrt(2 D)\"\n\
         [system.parameters]\nD = {d}\nw = {w}\n[system.bounds]\ntheta = \"periodic\"\n\
         [sweep]\nparameter = \"w\"\nfrom = 0.2\nto = {w}\npoints = 2\n[watch]\nc = \"cos(theta)\"\n\
         [spectrum]\nof = [\"c\"]\nto = 3\npoints = 31\n"
    );
    for harmonics in [3, 12] {
        let words = format!("cells.theta.modes={harmonics}");
        let (sweep, solution) = solved(&text, &words, None);
        let (mean, error) = measure(&solution, "mean_c");
        assert!(mean.abs() <= error + 1e-12, "{mean:e} of {error:e}");
        let (deviation, error) = measure(&solution, "sd_c");
        let off = (deviation - 0.5_f64.sqrt()).abs();
        assert!(off <= error + 1e-14 && error < 1e-5, "{off:e} of {error:e}");
        let question = sweep.problem.family().questions.spectrum.as_ref().unwrap();
        let [of_c] = &solution.report.fluctuations[..] else {
            panic!("one spectrum");
        };
        for (frequency, (power, error)) in question.band.frequencies().into_iter().zip(&of_c.power)
        {
            let line = |at: f64| 0.5 * d / (d * d + at * at);
            let exact = line(frequency - w) + line(frequency + w);
            let off = (power - exact).abs();
            // The errors of so few numbers are rounding.
            assert!(
                off <= error + 1e-12,
                "{harmonics} {frequency}: {off:e} of {error:e}"
            );
            assert!(*error < 1e-9, "{harmonics} {frequency}: {error:e}");
        }
    }
}

#[test]
fn the_power_of_a_driven_rotors_velocity_at_zero_is_twice_its_diffusion() {
    let text = rotor(
        "sin(theta)",
        "[spectrum]\nof = [\"v\"]\nto = 3\npoints = 4\n",
    );
    for torque in [0.2, 0.5] {
        let (_, solution) = solved(&text, "", Some(torque));
        // By a solve of its own with the factors of the steady state.
        let (diffusion, of_diffusion) = measure(&solution, "diffusion_theta");
        let (power, of_power) = solution.report.fluctuations[0].power[0];
        let off = (power - 2.0 * diffusion).abs();
        assert!(
            off <= of_power + 2.0 * of_diffusion,
            "{torque}: {power} {diffusion}"
        );
        assert!(of_power < 1e-2 * power, "{torque}: {power} ± {of_power}");
    }
}

#[test]
fn the_first_passage_of_a_free_rotors_velocity_knows_nothing_of_its_angle() {
    let passage = "[passage]\nfast = { until = \"abs(v) > 2\", start = ";
    let text = rotor(NONE, &format!("{passage}{{ theta = 0, v = 0 }} }}\n"));
    let line = text
        .replace("theta = \"v\"\n", "")
        .replace(" - 0 sin(theta)", "");
    let line = line
        .replace("[system.bounds]\ntheta = \"periodic\"\n", "")
        .replace("theta = 0, ", "");
    let [(found, error), (exact, of_line)] = [&text, &line].map(|text| {
        let (_, solution) = solved(text, "", Some(0.3));
        measure(&solution, "fast_mean")
    });
    let off = (found - exact).abs();
    assert!(
        off <= error + of_line && error < 1e-3 * found,
        "{off:e}: {error:e}, {of_line:e}"
    );
}

#[test]
fn regions_that_an_angle_bounds_and_questions_under_a_force_are_refused_with_a_way_out() {
    let refused = |text: &str| {
        let prepared = settings(text, "").prepare(&Cancellation::new());
        prepared
            .err()
            .map(|report| report.to_string())
            .unwrap_or_default()
    };
    let region =
        "[passage]\nover = { until = \"cos(theta) < -0.5\", start = { theta = 0, v = 0 } }\n";
    // Also where all counts are given, so that nothing is tried beforehand.
    let cells = "[cells]\ntheta = { modes = 6 }\nv = { from = -5, to = 5, count = 40 }\n";
    let message = refused(&rotor("sin(theta)", &format!("{cells}{region}")));
    assert!(
        message.contains("depends on `theta`") && message.contains("monte-carlo"),
        "{message}"
    );
    for (watch, of) in [("", "theta"), ("[watch]\nc = \"theta v\"\n", "c")] {
        let jumps = format!("{watch}[spectrum]\nof = [\"{of}\"]\n");
        let given = SweepFile::parse("sweep.toml", &rotor("sin(theta)", &jumps)).validate();
        let message = given
            .err()
            .map(|report| report.to_string())
            .unwrap_or_default();
        assert!(
            message.contains("jumps where the turn of `theta` ends"),
            "{message}"
        );
    }
    let forced = rotor("sin(theta) + cos(t)", "[relaxation]\nmodes = 2\n");
    let message = refused(&forced);
    assert!(message.contains("under a periodic force"), "{message}");
}

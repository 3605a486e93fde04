//! Fluctuations about a mean that a periodic force moves, and the signal-to-noise ratio, against closed forms.

use std::f64::consts::PI;

use crate::common::sweeps::{measure, solved};
use pbif::continuation::Solution;
use pbif::sweep_file::Sweep;

/// Every power of the first spectrum holds its error, which is below a share of the power.
fn assert_powers(
    (sweep, solution): &(Sweep, Solution<'_>),
    exact: impl Fn(f64) -> f64,
    largest: f64,
) {
    let question = sweep.problem.family().questions.spectrum.as_ref().unwrap();
    let frequencies = question.band.frequencies();
    let powers = &solution.report.fluctuations[0].power;
    assert_eq!(powers.len(), frequencies.len());
    for (&(power, error), frequency) in powers.iter().zip(frequencies) {
        let exact = exact(frequency);
        let off = (power - exact).abs();
        assert!(off <= error, "{frequency}: {off:e} of {error:e}");
        assert!(error <= largest * exact, "{frequency}: {error:e}");
    }
}

#[test]
fn a_linear_system_fluctuates_about_its_moving_mean_as_without_a_force() {
    // The force's frequency and twice that are among those that are looked at.
    let text = "[system.equations]\nx = \"-a x + A cos(w t)\"\n[system.noise]\nx = \"sqrt(2 D)\"\n\
                [system.parameters]\na = 0.7\nA = 0.5\nw = 0.9\n[sweep]\nparameter = \"D\"\nfrom = 0.1\nto = 0.2\n\
                points = 2\n[spectrum]\nof = [\"x\"]\nto = 3.6\npoints = 25\n";
    let found = solved(text, "", None);
    let (a, force, d) = (0.7, 0.5_f64, 0.2);
    assert_powers(&found, |at| 2.0 * d / (a * a + at * at), 1e-5);
    // π (A²/(a² + w²)) / (2 D/(a² + w²)).
    let (ratio, error) = measure(&found.1, "signal_to_noise_x");
    let exact = PI * force * force / (2.0 * d);
    let off = (ratio - exact).abs();
    assert!(off <= error, "{off:e} of {error:e}");
    // Most of it is what layers of cells would do if their differences were independent.
    assert!(error < 2.5e-5 * exact, "{error:e}");
}

#[test]
fn a_linear_oscillator_does_so_too() {
    let text = "[system.equations]\nx = \"v\"\nv = \"-g v - x + A cos(w t)\"\n[system.noise]\nv = \"sqrt(2 D)\"\n\
                [system.parameters]\ng = 0.5\nA = 0.3\nw = 0.8\n[sweep]\nparameter = \"D\"\nfrom = 0.2\nto = 0.3\n\
                points = 2\n[cells]\nx = 32\nv = 32\nt = { modes = 3 }\n\
                [spectrum]\nof = [\"x\", \"x, v\"]\nto = 3\npoints = 16\n";
    let found = solved(text, "", None);
    let (g, force, d) = (0.5, 0.3_f64, 0.3);
    let response = |at: f64| 1.0 / ((1.0 - at * at).powi(2) + (g * at).powi(2));
    assert_powers(&found, |at| 2.0 * d * response(at), 1e-2);
    // E[x(t + τ) v(t)] has the spectrum -iω times that of x.
    let frequencies = (0..16).map(|number| 0.2 * f64::from(number));
    let cross = &found.1.report.fluctuations[1];
    for (&(value, error), at) in cross.imaginary.iter().zip(frequencies) {
        let off = (value + at * 2.0 * d * response(at)).abs();
        assert!(off <= error + 1e-12, "{at}: {off:e} of {error:e}");
    }
    let (ratio, error) = measure(&found.1, "signal_to_noise_x");
    let exact = PI * force * force / (2.0 * d);
    let off = (ratio - exact).abs();
    assert!(off <= error, "{off:e} of {error:e}");
    assert!(error < 1e-2 * exact, "{error:e}");
}

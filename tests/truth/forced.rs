//! Systems under a periodic force: what is called located against exact answers.

use crate::common::numbers::{Numbers, given};
use crate::common::sweeps::{rows, swept};
use pbif::continuation::BifurcationStatus;

/// Amplitude over standard deviation from where on the density of a moving normal density has two peaks over a period:
/// the zero of the confluent hypergeometric function ₁F₁(3/2; 1; -r²/2), by its series.
fn ratio() -> f64 {
    let series = |r: f64| {
        let mut term = 1.0;
        let terms = (0..100).map(|n| {
            let n = f64::from(n);
            term *= -(1.5 + n) / ((1.0 + n) * (1.0 + n)) * 0.5 * r * r;
            term
        });
        1.0 + terms.sum::<f64>()
    };
    let (mut low, mut high) = (1.7, 1.85);
    assert!(series(low) > 0.0 && series(high) < 0.0);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if series(middle) > 0.0 {
            low = middle;
        } else {
            high = middle;
        }
    }
    low
}

#[test]
fn the_split_over_a_period_of_random_linear_systems_is_within_its_error() {
    let mut dice = Numbers(given("OTHER_SEEDS", 300));
    let mut between = |from: f64, to: f64| {
        let unit = dice.next() as f64 / u64::MAX as f64;
        from + unit * (to - from)
    };
    for case in 0..6 {
        let (k, w, d) = (
            between(0.3, 2.0),
            between(0.2, 4.0),
            10.0_f64.powf(between(-2.0, 0.0)),
        );
        // x' = -k x + A cos(w t) moves with the amplitude A/√(k² + w²), with the variance D/k about it.
        let exact = ratio() * (d / k).sqrt() * k.hypot(w);
        let (from, to) = (exact * between(0.4, 0.8), exact * between(1.2, 1.6));
        let text = format!(
            "[system.equations]\nx = \"-k x + A cos(w t)\"\n[system.noise]\nx = \"sqrt(2 D)\"\n\
             [system.parameters]\nk = {k}\nw = {w}\nD = {d}\n\
             [sweep]\nparameter = \"A\"\nfrom = {from}\nto = {to}\npoints = 9\n\
             [detect]\nmarginals = [\"x @ mean\", \"x @ phase 1/8\"]\n"
        );
        let (_, result) = swept(&text, "");
        assert_eq!(rows(&result, "x_phase_1_8").len(), 0, "{case}");
        let [row] = rows(&result, "x")[..] else {
            panic!("{case}: one change of the density over the period\n{text}");
        };
        let off = (row.value - exact).abs();
        println!(
            "{case}: {} ± {:.1e}, off by {off:.1e}",
            row.value, row.error
        );
        assert_eq!(row.status(), BifurcationStatus::Located, "{case}");
        assert!(off <= row.error, "{case}: {off:e} of {:e}", row.error);
        assert!(row.error < 3e-4 * exact, "{case}: {:e}", row.error);
    }
}

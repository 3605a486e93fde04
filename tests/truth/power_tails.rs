//! Noise that grows with the state: densities that fall like powers, whose moments lie beyond any range.

use pbif::continuation::Finding;
use pbif::topology::{DetectOptions, Detector, PersistenceDetector};

use crate::common::sweeps::{measure, solved};

/// x' = -x + √0.2 ξ₁ + s x ξ₂ in Stratonovich's reading, alone or beside a state that is driven by it.
///
/// The density is a power of 0.2 + s² x², which falls like |x|^-(1 + 2/s²); E x² = 0.2/(2 - 2 s²) where that exists.
fn growing(beside: &str) -> String {
    let (equation, noise, cells) = match beside {
        "" => ("", "", ""),
        _ => (
            "y = \"-y + x\"",
            "y = \"0.5\"",
            "[cells]\nx = { from = -6, to = 6, count = 100, grade = \"auto\" }\n\
             y = { from = -6, to = 6, count = 60, grade = \"auto\" }",
        ),
    };
    format!(
        r#"
[system.equations]
x = "-x"
{equation}
[system.noise]
interpretation = "stratonovich"
x = ["sqrt(0.2)", "s x"]
{noise}
[sweep]
parameter = "s"
from = 0.4
to = 1.2
points = 6
{cells}
[locate]
grid_check = "off"
"#
    )
}

#[test]
fn the_error_of_a_deviation_holds_what_a_power_law_has_beyond_the_range() {
    for beside in ["", "y"] {
        for s in [0.5, 0.7, 0.8, 0.9] {
            let (_, point) = solved(&growing(beside), "", Some(s));
            let exact = (0.2 / (2.0 - 2.0 * s * s)).sqrt();
            let (found, error) = measure(&point, "sd_x");
            let off = (found - exact).abs();
            assert!(
                off <= error,
                "{beside} {s}: {found} ± {error:e}, exactly {exact}"
            );
            // On one axis what is beyond the range is integrated too.
            assert!(
                !beside.is_empty() || error < 1e-9 * exact,
                "{s}: off by {off:e}, error {error:e}"
            );
        }
    }
}

#[test]
fn a_deviation_that_does_not_exist_has_no_error_and_the_power_is_told() {
    let s = 1.2;
    let (_, point) = solved(&growing(""), "", Some(s));
    let found = point.report.measures.iter().find(|one| one.name == "sd_x");
    assert_eq!(found.unwrap().error, None);
    let powers = point
        .report
        .findings
        .iter()
        .filter_map(|finding| match finding {
            Finding::HeavyTail { axis: 0, power } => Some(*power),
            _ => None,
        });
    let powers: Vec<f64> = powers.collect();
    assert!(
        powers.len() == 1 && (powers[0] - (1.0 + 2.0 / (s * s))).abs() < 0.1,
        "{powers:?}"
    );
}

#[test]
fn the_error_of_a_height_holds_what_is_beyond_the_range() {
    // With s² = 2/3 the density is (0.2 + s² x²)^-2 but for a factor: at 0 it is 2 s/(π √0.2).
    let s = (2.0_f64 / 3.0).sqrt();
    let (_, point) = solved(&growing(""), "", Some(s));
    let exact = 2.0 * s / (std::f64::consts::PI * 0.2_f64.sqrt());
    let detector = PersistenceDetector::new(DetectOptions::default(), 1);
    let peak = detector.detect(&point.densities[0]).features.remove(0);
    let (off, error) = ((peak.density - exact).abs(), peak.errors.density.unwrap());
    assert!(
        off <= error && error < 4.0 * off,
        "off by {off:e}, error {error:e}"
    );
}

//! Probabilities at times of all sizes, and mean times over high barriers.

use crate::common::sweeps::{measure, solved};

/// A double well on one axis, left over its barrier, with lines of a file for the passage.
fn left_well(noise: f64, passage: &str) -> (String, String) {
    let text = format!(
        "[system.equations]\nx = \"x - x^3\"\n[system.noise]\nx = \"sqrt(2 D)\"\n\
         [system.parameters]\nD = {noise}\n[sweep]\nparameter = \"D\"\nfrom = {}\nto = {noise}\npoints = 2\n\
         [cells]\nx = {{ from = -2, to = 2, count = 120 }}\n[passage]\n{passage}\n",
        0.9 * noise
    );
    (text, "figures.draw=[]".to_owned())
}

#[test]
fn probabilities_at_times_of_all_sizes_are_those_of_each_alone() {
    let all =
        "out = { start = { x = -1.0 }, until = \"x > 0.3\", times = [1e-6, 10, 1e12, 1e300] }";
    let alone = "out = { start = { x = -1.0 }, until = \"x > 0.3\", times = [10] }";
    let solution = |passage: &str| {
        let (text, words) = left_well(0.11, passage);
        solved(&text, &words, None).1
    };
    let (together, single) = (solution(all), solution(alone));
    let (own, other) = (
        measure(&together, "out_10_survival"),
        measure(&single, "out_10_survival"),
    );
    assert!(
        (own.0 - other.0).abs() <= own.1 + other.1 && own.1 < 1e-5,
        "{own:?} {other:?}"
    );
    let survival = |time: &str| measure(&together, &format!("out_{time}_survival"));
    let early = survival("0.000001");
    assert!(
        (early.0 - 1.0).abs() <= early.1 + 1e-12 && early.1 < 1e-6,
        "{early:?}"
    );
    assert_eq!(survival("1000000000000").0, 0.0);
    let longest = format!("1{}", "0".repeat(300));
    assert_eq!(survival(&longest).0, 0.0);
}

#[test]
fn a_time_over_a_barrier_of_hundreds_of_times_the_noise_has_its_digits() {
    // exp(ΔU/D) = e^250 is beyond what rates of cells in double precision tell; Kramers' formula is off by a share D.
    let (text, words) = left_well(1e-3, "out = { start = { x = -1.0 }, until = \"x > 0.3\" }");
    let (_, solution) = solved(&text, &words, None);
    let exact = std::f64::consts::PI * 2.0_f64.sqrt() * 250.0_f64.exp();
    let (mean, error) = measure(&solution, "out_mean");
    assert!(
        (mean / exact - 1.0).abs() < 5e-3 && error < 1e-6 * mean,
        "{mean:e} ± {error:e}"
    );
    let (rate, error) = measure(&solution, "out_rate");
    assert!(
        (rate * exact - 1.0).abs() < 5e-3 && error < 1e-3 * rate,
        "{rate:e} ± {error:e}"
    );
}

//! Starts beside a border on one axis: what happens within times that are thousands of times shorter than the mean.
//!
//! Paths of x' = -x + ξ that have met zero are as likely on either side of it, so that the probability not to have met
//! it until t is erf(x e^{-t}/√(1 - e^{-2t})) from x, for all x and t.

use statrs::function::erf::{erf, erf_inv};

use crate::common::sweeps::{measure, solved};

const TIMES: [f64; 3] = [1e-5, 0.01, 1.0];
const SHARES: [f64; 3] = [0.1, 0.5, 0.9];

/// The passage from a start until zero.
fn text(start: f64) -> String {
    let until = if start > 0.0 { "x < 0" } else { "x > 0" };
    format!(
        "[system.equations]\nx = \"-a x\"\n[system.noise]\nx = \"1\"\n\
         [sweep]\nparameter = \"a\"\nfrom = 0.9\nto = 1.0\npoints = 2\n\
         [cells]\nx = {{ from = -4, to = 4, count = 100 }}\n\
         [passage]\nout = {{ start = {{ x = {start:?} }}, until = \"{until}\", times = {TIMES:?}, \
         quantiles = {SHARES:?} }}\n"
    )
}

#[test]
fn a_start_beside_a_border_ends_as_soon_as_reflected_paths_say() {
    for start in [0.002, -0.002, 0.03, 0.5] {
        let (_, solution) = solved(&text(start), "", None);
        let distance: f64 = f64::abs(start);
        let holds = |name: String, exact: f64, largest: f64| {
            let (value, error) = measure(&solution, &name);
            let off = (value - exact).abs();
            assert!(off <= error, "{start} {name}: {value} ± {error:e}, {exact}");
            assert!(error <= largest, "{start} {name}: {value} ± {error:e}");
        };
        for time in TIMES {
            let spread = (1.0 - (-2.0 * time).exp()).sqrt();
            let exact = erf(distance * (-time).exp() / spread);
            let name = [
                format!("out_{time}_survival"),
                format!("out_{time:e}_survival"),
            ];
            let is_there = |name: &&String| {
                let mut all = solution.report.measures.iter();
                all.any(|one| one.name == **name)
            };
            let name = name.iter().find(is_there).unwrap();
            holds(name.clone(), exact, 0.01);
        }
        for share in SHARES {
            let ratio = distance / erf_inv(1.0 - share);
            let exact = 0.5 * (ratio * ratio).ln_1p();
            holds(format!("out_{share}_quantile"), exact, 0.02 * exact);
        }
    }
}

//! Dahl's oscillator on 50 × 50 cells with modes, against a solve on four times as many cells along x and three times
//! as many along y, in a wider Ω and with more modes; and the density of its friction state with many of them.

use pbif::cancellation::Cancellation;
use pbif::continuation::{DensitySource as _, PointStatus};
use pbif::density::Observable;
use pbif::generator::automatic_grading;
use pbif::method::{GeneratorMethodOptions, GeneratorSource, Problem};
use pbif::space::{Axis, CellSpace};
use pbif::system::{Family, Path, registry};

use crate::common::steady::{masses, means};

/// α, then E[x²], E[y²], E[z²] and E[xz] on 200 × 160 cells × 10 modes of [-3, 3] × [-3.2, 3.2], y graded to 0.02.
/// 140 × 140 cells differ from it by at most 1e-5.
const REFERENCE: [(f64, [f64; 4]); 4] = [
    (0.5, [0.238006, 0.268425, 0.151582, 0.170613]),
    (0.0, [0.313413, 0.235196, 0.184442, 0.207603]),
    (-0.5, [0.482197, 0.206103, 0.199317, 0.218276]),
    (-1.0, [0.818587, 0.226927, 0.158703, 0.147106]),
];

/// The moments on `cells` cells along x and y, y graded as the program does it.
fn moments(alpha: f64, cells: usize, modes: usize) -> [f64; 4] {
    let values = [
        ("alpha", alpha),
        ("kappa", 0.02),
        ("mu", 1.0),
        ("lambda", 0.06),
        ("f_c", 0.05),
        ("sigma2", 0.02),
    ];
    let dahl = registry::find("dahl")
        .unwrap()
        .system_with(&values)
        .unwrap();
    let bound = 0.05 / 0.06;
    let ranges = [(-2.3, 2.3), (-3.0, 3.0), (-bound, bound)];
    let grading = automatic_grading(&*dahl, &ranges, 1, cells).unwrap();
    let x = Axis::uniform(-2.3, 2.3, cells).unwrap();
    let y = Axis::graded(-3.0, 3.0, cells, &grading).unwrap();
    let z = Axis::modes(-bound, bound, modes).unwrap();
    let space = CellSpace::new(vec![x, y, z]).unwrap();
    let moments = |state: &[f64]| {
        let (x, y, z) = (state[0], state[1], state[2]);
        [x * x, y * y, z * z, x * z]
    };
    means(&space, &masses(&*dahl, &space), moments)
}

fn error(found: [f64; 4], exact: [f64; 4]) -> f64 {
    let pairs = found.iter().zip(exact);
    pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

#[test]
fn fifty_cells_an_axis_have_second_moments_to_two_ten_thousandths() {
    for (alpha, exact) in REFERENCE {
        let off = error(moments(alpha, 50, 6), exact);
        assert!(off <= 2e-4, "{alpha}: {off:e}");
    }
}

#[test]
fn half_as_many_cells_have_a_several_times_larger_error() {
    let (alpha, exact) = REFERENCE[3];
    let off = error(moments(alpha, 26, 6), exact);
    assert!(off > 8e-4, "{off:e}");
}

/// Masses of the bins of z at α = -1, where most of it lies in steep edges near the walls.
fn friction_state(modes: usize) -> Vec<f64> {
    let given = [
        ("kappa", 0.02),
        ("mu", 1.0),
        ("lambda", 0.06),
        ("f_c", 0.05),
        ("sigma2", 0.02),
    ];
    let model = registry::find("dahl").unwrap();
    let family = Family::new(model, &given, Path::parameter("alpha", -1.0, -1.0)).unwrap();
    let bound = 0.05 / 0.06;
    let axes = [
        Axis::uniform(-2.3, 2.3, 32),
        Axis::uniform(-2.5, 2.5, 28),
        Axis::modes(-bound, bound, modes),
    ];
    let space = CellSpace::new(axes.map(Result::unwrap).to_vec()).unwrap();
    let problem = Problem::new(family, space, vec![Observable::Marginal(2)]).unwrap();
    let options = GeneratorMethodOptions::default();
    let source = GeneratorSource::new(&problem, &options).unwrap();
    let mut session = source.open(&Cancellation::new());
    let solution = session.solve(-1.0).unwrap();
    assert_eq!(solution.report.status, PointStatus::Solved);
    solution.densities[0].density.masses()
}

#[test]
fn the_density_of_the_friction_state_converges_with_a_hundred_modes() {
    let most = friction_state(128);
    let far = |modes: usize| {
        let masses = friction_state(modes);
        let gaps = masses.iter().zip(&most).map(|(a, b)| (a - b).abs());
        0.5 * gaps.sum::<f64>()
    };
    let [few, some, many] = [24, 64, 96].map(far);
    assert!(few > 3e-3, "{few:e}: the edges are not steep");
    assert!(
        some < 0.5 * few && many < 0.15 * few,
        "{few:e} {some:e} {many:e}"
    );
    // What sampling leaves of the comparison in docs/paper.md.
    assert!(many < 7e-4, "{many:e}");
}

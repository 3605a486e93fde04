//! Damping that is strong against the noise on a cell: van der Pol's oscillator, whose density no scheme is exact for.

use pbif::cancellation::Cancellation;
use pbif::continuation::DensitySource as _;
use pbif::density::{EstimatedDensity, Observable};
use pbif::method::{GeneratorMethodOptions, GeneratorSource, Problem};
use pbif::space::{Axis, CellSpace};
use pbif::system::{Family, Path, TypedModel};
use pbif::topology::{DetectOptions, Detector as _, PersistenceDetector};

/// E[x²] = E[y²] of x'' = 0.5 (1 - x²) x' - x + √0.4 ξ: 240 × 240 cells by three schemes agree to 1e-7. The equality is
/// the balance of power, E[x x''] = -E[y²].
const MEAN_SQUARE: f64 = 2.112_158_6;

/// Height of the peaks of p(x), on 200 × 200 cells; 140 × 140 differ by 1e-6.
const HEIGHT: f64 = 0.256_497;

/// The density of x on `count` cells an axis, and the standard deviations of x and y with their errors.
fn solved(count: usize) -> (EstimatedDensity, [(f64, f64); 2]) {
    let model = TypedModel::new("vdp", "Van der Pol's oscillator", ["x", "y"])
        .with_equation("x", "y")
        .with_equation("y", "mu (1 - x^2) y - x")
        .with_noise("y", ["sqrt(2 D)"])
        .with_parameters(["mu", "D"]);
    let path = Path::parameter("D", 0.2, 0.2);
    let family = Family::new(model.build().unwrap(), &[("mu", 0.5)], path).unwrap();
    let x = Axis::uniform(-4.4, 4.4, count).unwrap();
    let y = Axis::uniform(-5.8, 5.8, count).unwrap();
    let space = CellSpace::new(vec![x, y]).unwrap();
    let problem = Problem::new(family, space, vec![Observable::Marginal(0)]).unwrap();
    let source = GeneratorSource::new(&problem, &GeneratorMethodOptions::default()).unwrap();
    let mut session = source.open(&Cancellation::new());
    let mut solution = session.solve(0.2).unwrap();
    let deviations = ["sd_x", "sd_y"].map(|name| {
        let mut measures = solution.report.measures.iter();
        let one = measures.find(|one| one.name == name).unwrap();
        (one.value, one.error.unwrap())
    });
    (solution.densities.remove(0), deviations)
}

#[test]
fn damping_that_changes_much_over_a_cell_is_of_fourth_order() {
    // The largest change of a density in equilibrium with the damping over a cell of y is e^8 on 100 × 100 cells.
    let error = |count: usize| {
        let squares = solved(count).1.map(|(deviation, _)| deviation * deviation);
        let [x, y] = squares.map(|square| (square - MEAN_SQUARE).abs());
        x.max(y)
    };
    let [coarse, middle, fine] = [50, 70, 100].map(error);
    assert!(
        coarse < 1e-4 && middle < 2e-5 && fine < 4e-6,
        "{coarse:e} {middle:e} {fine:e}"
    );
    let order = (coarse / fine).log2();
    assert!(order > 4.0, "{coarse:e} {fine:e}, order {order}");
}

#[test]
fn the_difference_between_schemes_is_the_error_of_a_strongly_damped_density() {
    for count in [50, 70, 100] {
        let (density, deviations) = solved(count);
        for (deviation, stated) in deviations {
            let error = (deviation - MEAN_SQUARE.sqrt()).abs();
            assert!(
                error < stated && stated < 3e-3,
                "{count}: {error:e}, {stated:e}"
            );
        }
        let found = PersistenceDetector::new(DetectOptions::default(), 1).detect(&density);
        for peak in &found.features[..2] {
            let cell = density.density.axes[0].find(peak.position[0]).unwrap();
            let error = (peak.density - HEIGHT).abs();
            for stated in [density.standard_error[cell], peak.errors.density.unwrap()] {
                assert!(
                    error < stated,
                    "{count}: off by {error:e}, said to be by {stated:e}"
                );
            }
            let error = (peak.position[0].abs() - 1.77367).abs();
            let stated = peak.errors.position[0];
            assert!(
                error < stated + 1e-5 && stated < 0.1,
                "{count}: off by {error:e}, said to be by {stated:e}"
            );
        }
    }
}

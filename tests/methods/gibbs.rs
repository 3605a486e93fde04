//! Random systems of two axes whose densities are known: ranges, masses of cells, moments, critical points.

use pbif::density::Observable;
use pbif::space::CellSpace;
use pbif::topology::{Feature, FeatureKind};
use rand_xoshiro::Xoshiro256Plus;
use rand_xoshiro::rand_core::{Rng, SeedableRng};

/// A system as it is typed, and -log p up to a constant.
pub(crate) struct Case {
    pub(crate) family: &'static str,
    pub(crate) equations: [String; 2],
    pub(crate) noises: [Option<String>; 2],
    pub(crate) potential: Box<dyn Fn(f64, f64) -> f64>,
    /// Cells an axis.
    pub(crate) count: usize,
    /// The ranges beyond which the density is nothing, found once.
    reach: [(f64, f64); 2],
}

/// The nodes on [-½, ½] and the weights of the three-point Gauss-Legendre rule.
const GAUSS: [(f64, f64); 3] = [
    (-0.387_298_334_620_741_7, 5.0 / 18.0),
    (0.0, 8.0 / 18.0),
    (0.387_298_334_620_741_7, 5.0 / 18.0),
];

/// -log of the share of the largest density at which a range ends.
pub(crate) const DEPTH: f64 = 25.0;

pub(crate) fn drawn(seed: u64) -> Case {
    let mut case = of_seed(seed);
    case.reach = ranges(&*case.potential, DEPTH);
    case
}

fn of_seed(seed: u64) -> Case {
    let reach = [(0.0, 0.0); 2];
    let mut dice = Xoshiro256Plus::seed_from_u64(seed);
    let mut between = |from: f64, to: f64| {
        let unit = (dice.next_u64() >> 11) as f64 / (1u64 << 53) as f64;
        ((from + unit * (to - from)) * 1000.0).round() / 1000.0
    };
    let count = between(30.0, 100.0).round() as usize;
    let d = between(0.05, 0.3);
    match seed % 3 {
        0 => {
            // A damped particle in a potential.
            let (k, a, b, c) = (
                between(0.1, 3.0),
                between(-1.0, 1.0),
                between(0.3, 1.5),
                between(-0.3, 0.3),
            );
            Case {
                family: "oscillator in a potential",
                equations: ["y".into(), format!("-{k} y + {a} x - {b} x^3 + {c}")],
                noises: [None, Some(format!("sqrt({})", 2.0 * k * d))],
                potential: Box::new(move |x, y| {
                    (0.5 * y * y - 0.5 * a * x * x + 0.25 * b * x.powi(4) - c * x) / d
                }),
                count,
                reach,
            }
        }
        1 => {
            // Drift down a gradient, and around along its level lines.
            let (a, b, c, m) = (
                between(-1.0, 1.5),
                between(0.3, 1.5),
                between(-0.3, 0.3),
                between(0.5, 3.0),
            );
            let (tilt, turn) = (between(-0.7, 0.7), between(-2.0, 2.0));
            let ux = format!(
                "(-({a}) x + {b} x^3 - ({c}) - ({}) (y - ({tilt}) x))",
                m * tilt
            );
            let uy = format!("({m} (y - ({tilt}) x))");
            let noise = Some(format!("sqrt({})", 2.0 * d));
            Case {
                family: "gradient and circulation",
                equations: [
                    format!("-{ux} + ({turn}) {uy}"),
                    format!("-{uy} - ({turn}) {ux}"),
                ],
                noises: [noise.clone(), noise],
                potential: Box::new(move |x, y| {
                    let across = y - tilt * x;
                    (-0.5 * a * x * x + 0.25 * b * x.powi(4) - c * x + 0.5 * m * across * across)
                        / d
                }),
                count,
                reach,
            }
        }
        _ => {
            // Damping that depends on the energy.
            let (a, b) = (between(-0.5, 0.8), between(0.3, 1.5));
            Case {
                family: "damping by energy",
                equations: ["y".into(), format!("-(-({a}) + {b} (x^2 + y^2)/2) y - x")],
                noises: [None, Some(format!("sqrt({})", 2.0 * d))],
                potential: Box::new(move |x, y| {
                    let energy = 0.5 * (x * x + y * y);
                    (-a * energy + 0.5 * b * energy * energy) / d
                }),
                count,
                reach,
            }
        }
    }
}

/// The ranges beyond which the density is nothing: less than `exp(-depth)` of its largest value.
pub(crate) fn ranges(potential: &dyn Fn(f64, f64) -> f64, depth: f64) -> [(f64, f64); 2] {
    let grid = || (-240..=240).map(|step| f64::from(step) / 40.0);
    let states: Vec<[f64; 2]> = grid().flat_map(|x| grid().map(move |y| [x, y])).collect();
    let values: Vec<f64> = states.iter().map(|[x, y]| potential(*x, *y)).collect();
    let least = values.iter().copied().fold(f64::INFINITY, f64::min);
    let inside = || {
        states
            .iter()
            .zip(&values)
            .filter(move |(_, value)| **value < least + depth)
    };
    [0, 1].map(|axis| {
        let of_axis = || inside().map(move |(state, _)| state[axis]);
        (of_axis().fold(0.0, f64::min), of_axis().fold(0.0, f64::max))
    })
}

/// Exact masses of the cells, of a density whose integral over the plane is one.
pub(crate) fn exact(space: &CellSpace, case: &Case) -> Vec<f64> {
    let potential = &*case.potential;
    let mass = |cell: usize| {
        let centre = space.centre(cell);
        let width = |axis: usize| space.axes()[axis].width(space.position(cell, axis));
        let points = GAUSS.iter().flat_map(|x| GAUSS.iter().map(move |y| (x, y)));
        let terms = points.map(|(x, y)| {
            let value = potential(centre[0] + x.0 * width(0), centre[1] + y.0 * width(1));
            x.1 * y.1 * (-value).exp() * space.volume(cell)
        });
        terms.sum::<f64>()
    };
    let [whole] = integral(case, |_, _| [1.0]);
    (0..space.n_cells())
        .map(|cell| mass(cell) / whole)
        .collect()
}

/// Steps along each axis of the sums that stand for integrals of the exact density.
const STEPS: u32 = 600;

/// Integrals over the plane of the density, not normalised, times numbers.
pub(crate) fn integral<const N: usize>(case: &Case, of: impl Fn(f64, f64) -> [f64; N]) -> [f64; N] {
    let ends = case.reach;
    let [dx, dy] = ends.map(|(from, to)| (to - from) / f64::from(STEPS));
    let mut sums = [0.0; N];
    for (i, j) in (0..=STEPS).flat_map(|i| (0..=STEPS).map(move |j| (i, j))) {
        let (x, y) = (ends[0].0 + dx * f64::from(i), ends[1].0 + dy * f64::from(j));
        let weight = (-(case.potential)(x, y)).exp() * dx * dy;
        for (sum, term) in sums.iter_mut().zip(of(x, y)) {
            *sum += weight * term;
        }
    }
    sums
}

/// Exact mean and standard deviation of a function of the state.
pub(crate) fn exact_moments(case: &Case, of: impl Fn(f64, f64) -> f64) -> [f64; 2] {
    let [whole, sum, squares] = integral(case, |x, y| {
        let value = of(x, y);
        [1.0, value, value * value]
    });
    let [mean, square] = [sum / whole, squares / whole];
    [mean, (square - mean * mean).sqrt()]
}

/// The density along one axis, or of both, at a place; not normalised.
pub(crate) fn density_at(case: &Case, observable: Observable, place: &[f64]) -> f64 {
    let Observable::Marginal(axis) = observable else {
        return (-(case.potential)(place[0], place[1])).exp();
    };
    let (from, to) = case.reach[1 - axis];
    let step = (to - from) / f64::from(STEPS);
    let terms = (0..=STEPS).map(|number| {
        let other = from + step * f64::from(number);
        let state = if axis == 0 {
            [place[0], other]
        } else {
            [other, place[0]]
        };
        (-(case.potential)(state[0], state[1])).exp() * step
    });
    terms.sum()
}

/// The critical point of the logarithm of a density nearest to a place, by Newton's method; `None` where there is none
/// within a tenth of the deviation. Along a ray from the centre for a ring.
pub(crate) fn critical(
    case: &Case,
    observable: Observable,
    feature: &Feature,
    deviation: f64,
) -> Option<Vec<f64>> {
    let mut place = feature.position.clone();
    let along: Vec<Vec<f64>> = match (feature.kind, place.len()) {
        (FeatureKind::Ring, _) => {
            let length = place[0].hypot(place[1]);
            vec![vec![place[0] / length, place[1] / length]]
        }
        (_, 1) => vec![vec![1.0]],
        _ => vec![vec![1.0, 0.0], vec![0.0, 1.0]],
    };
    let step = 1e-3 * deviation;
    for _ in 0..30 {
        let at = |moves: &[f64]| {
            let mut moved = place.clone();
            for (direction, length) in along.iter().zip(moves) {
                for (own, part) in moved.iter_mut().zip(direction) {
                    *own += part * length;
                }
            }
            density_at(case, observable, &moved).ln()
        };
        let one = |k: usize, length: f64| -> Vec<f64> {
            (0..along.len())
                .map(|index| if index == k { length } else { 0.0 })
                .collect()
        };
        let here = at(&one(0, 0.0));
        let slope = |k: usize| (at(&one(k, step)) - at(&one(k, -step))) / (2.0 * step);
        let bend = |k: usize| (at(&one(k, step)) + at(&one(k, -step)) - 2.0 * here) / (step * step);
        let moves = if along.len() == 1 {
            vec![-slope(0) / bend(0)]
        } else {
            let both = |a: f64, b: f64| at(&[a * step, b * step]);
            let cross = (both(1.0, 1.0) + both(-1.0, -1.0) - both(1.0, -1.0) - both(-1.0, 1.0))
                / (4.0 * step * step);
            let (a, c, g, h) = (bend(0), bend(1), slope(0), slope(1));
            let determinant = a * c - cross * cross;
            vec![
                (cross * h - c * g) / determinant,
                (cross * g - a * h) / determinant,
            ]
        };
        let mut moved = place.clone();
        for (direction, length) in along.iter().zip(&moves) {
            for (own, part) in moved.iter_mut().zip(direction) {
                *own += part * length;
            }
        }
        place = moved;
    }
    let off = place
        .iter()
        .zip(&feature.position)
        .map(|(a, b)| (a - b).powi(2));
    (off.sum::<f64>().sqrt() < 0.1 * deviation).then_some(place)
}

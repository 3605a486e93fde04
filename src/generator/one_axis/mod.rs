//! The steady state of a system with one axis, free of subtraction: without flux the density is
//! p ∝ (1/b²) exp ∫ (2a/b²) dx, with drift a and noise intensity b².
//!
//! Every cell is correct to many digits *of its own value*, however deep the valleys between: where barriers are many
//! times the noise, weights of wells that no linear solver can tell from rounding come out of a quadrature. Polynomials
//! through Gauss-Legendre points on panels of each cell give the exponent and its integral. A cell is cut where the
//! drift jumps or bends, and halved where the exponent changes much, so that cells much wider than what they hold are
//! right too. Where the noise dies at an end, parts get smaller toward it, and the rest is the integral of a power.

mod cuts;
mod end;
mod line;
mod profile;
mod rule;
mod series;

pub(crate) use end::{End, exponent_at};
pub use profile::profile;

use crate::space::Axis;
use crate::system::{LANES, System, absorbs};
use cuts::cuts_toward;

pub(super) use cuts::surfaces;
pub(crate) use rule::NODES;
pub(super) use rule::{Rule, legendre, look};

/// Panels a cell; eight points on each of eight panels fill a batch.
const PANELS: usize = LANES / NODES;

/// The steady state on the cells of an axis.
#[derive(Debug, Clone, PartialEq)]
pub struct OneAxis {
    /// Mass of every cell, Σ = 1; length is the number of cells.
    pub masses: Vec<f64>,
    /// Largest relative change of a cell's mass when half as many panels are used.
    pub error: f64,
    /// Mean and variance of the coordinate.
    pub moments: (f64, f64),
    /// ln ∫ (1/b²) exp ∫ (2a/b²) over the axis, the inner integral from its lower end: what the density is divided by.
    pub log_integral: f64,
    /// Exponents of the density at the lower and the upper end, where these are natural (`exponent_at`).
    pub ends: [Option<f64>; 2],
}

/// The steady state without flux through the ends; `None` where drift and noise do not allow it: more than one axis,
/// noise that vanishes inside or is not finite somewhere, and a natural end that takes all mass (`exponent_at`).
pub fn one_axis(system: &dyn System, axis: &Axis) -> Option<OneAxis> {
    if system.dimension() != 1 || system.facts().period.is_some() {
        return None;
    }
    let ends = End::ALL.map(|end| exponent_at(system, axis, end));
    if ends.iter().flatten().any(|one| absorbs(*one)) {
        return None;
    }
    let rule = Rule::new();
    let fine = integrate(system, axis, ends, &rule, PANELS)?;
    let coarse = integrate(system, axis, ends, &rule, PANELS / 2)?;
    let pairs = fine.masses.iter().zip(&coarse.masses);
    let change = pairs.map(|(a, b)| if *a > 0.0 { (b / a - 1.0).abs() } else { 0.0 });
    Some(OneAxis {
        error: change.fold(0.0, f64::max),
        ..fine
    })
}

/// Most times that a part of a cell is halved.
const MOST_HALVINGS: usize = 12;
/// Largest change of the exponent over a part, in one direction: eight points on each of four panels follow an
/// exponential of that range to 1e-9.
const LARGEST_RISE: f64 = 24.0;

/// The density along the axis as it is gone through, from below to above.
struct Walk<'a> {
    system: &'a dyn System,
    rule: &'a Rule,
    panels: usize,
    /// ∫ 2a/b² up to here.
    exponent: f64,
}

/// Integrals over a cell of p and of p times the distance from its lower edge and its square, over exp(level).
#[derive(Default)]
struct Integrals {
    level: f64,
    sums: [f64; 3],
}

impl Integrals {
    /// Adds what lies between a natural end and the distance u from it, where the density over exp(level) is `density`:
    /// a power of the distance. The end is so far from the lower edge of the cell, in the direction `sign`.
    fn add_power(
        &mut self,
        level: f64,
        density: f64,
        exponent: f64,
        u: f64,
        (edge, sign): (f64, f64),
    ) {
        let moment = |order: f64| density * u.powf(1.0 + order) / (exponent + 1.0 + order);
        let [mass, first, second] = [0.0, 1.0, 2.0].map(moment);
        let offset = sign * first;
        self.add(
            level,
            [
                mass,
                edge * mass + offset,
                edge * edge * mass + 2.0 * edge * offset + second,
            ],
        );
    }

    /// Adds sums over exp(level): the higher level is kept, so that nothing overflows.
    fn add(&mut self, level: f64, sums: [f64; 3]) {
        if self.sums[0] == 0.0 {
            self.level = level;
        }
        let top = self.level.max(level);
        let (own, other) = ((self.level - top).exp(), (level - top).exp());
        for (sum, more) in self.sums.iter_mut().zip(sums) {
            *sum = *sum * own + more * other;
        }
        self.level = top;
    }
}

impl Walk<'_> {
    /// Goes on from one coordinate to another of the cell that begins at `edge`; `None` where drift or noise do not
    /// allow it. Where the exponent changes much the part is halved.
    fn go(
        &mut self,
        (from, to): (f64, f64),
        edge: f64,
        into: &mut Integrals,
        halvings: usize,
    ) -> Option<()> {
        let width = (to - from) / self.panels as f64;
        let mut places = [from; LANES];
        for (lane, place) in places.iter_mut().enumerate().take(self.panels * NODES) {
            *place = from + width * ((lane / NODES) as f64 + self.rule.points[lane % NODES]);
        }
        let (drift, intensity) = look(self.system, &places);
        let mut rates = [0.0; LANES];
        for lane in 0..self.panels * NODES {
            let usable = drift[lane].is_finite() && intensity[lane].is_finite();
            if !(usable && intensity[lane] > 0.0) {
                return None;
            }
            rates[lane] = 2.0 * drift[lane] / intensity[lane];
        }
        let steepest = rates
            .iter()
            .fold(0.0_f64, |most, rate| most.max(rate.abs()));
        let middle = 0.5 * (from + to);
        if steepest * (to - from) > LARGEST_RISE && halvings > 0 && from < middle && middle < to {
            self.go((from, middle), edge, into, halvings - 1)?;
            return self.go((middle, to), edge, into, halvings - 1);
        }
        let start = self.exponent;
        let mut sums = [0.0; 3];
        for panel in 0..self.panels {
            let rate = &rates[panel * NODES..(panel + 1) * NODES];
            let rise = |weights: &[f64; NODES]| -> f64 {
                weights.iter().zip(rate).map(|(w, r)| w * r).sum()
            };
            for node in 0..NODES {
                let lane = panel * NODES + node;
                let here = self.exponent + width * rise(&self.rule.integrals[node]) - start;
                let weight = self.rule.weights[node] * width * here.exp() / intensity[lane];
                let offset = places[lane] - edge;
                sums[0] += weight;
                sums[1] += weight * offset;
                sums[2] += weight * offset * offset;
            }
            self.exponent += width * rise(&self.rule.weights);
        }
        into.add(start, sums);
        Some(())
    }
}

/// The steady state with so many panels a cell; `ends` are the exponents at natural ends.
fn integrate(
    system: &dyn System,
    axis: &Axis,
    ends: [Option<f64>; 2],
    rule: &Rule,
    panels: usize,
) -> Option<OneAxis> {
    let count = axis.count();
    let (mut logs, mut firsts, mut seconds) =
        (vec![0.0; count], vec![0.0; count], vec![0.0; count]);
    let surfaces = surfaces(system);
    // The density over exp(exponent).
    let density = |place: f64| look(system, &[place; LANES]).1[0].recip();
    let mut walk = Walk {
        system,
        rule,
        panels,
        exponent: 0.0,
    };
    for cell in 0..count {
        let mut found = Integrals::default();
        let edge = axis.edges()[cell];
        let cuts = cuts_toward(system, axis, cell, &surfaces, ends);
        if let (0, Some(exponent)) = (cell, ends[0].filter(|one| one.is_finite())) {
            let (from, level) = (cuts[0], walk.exponent);
            found.add_power(level, density(from), exponent, from - edge, (0.0, 1.0));
        }
        for part in cuts.windows(2) {
            walk.go((part[0], part[1]), edge, &mut found, MOST_HALVINGS)?;
        }
        let is_last = cell + 1 == count;
        if let (true, Some(exponent)) = (is_last, ends[1].filter(|one| one.is_finite())) {
            let (to, level) = (cuts[cuts.len() - 1], walk.exponent);
            let end = (axis.width(cell), -1.0);
            found.add_power(level, density(to), exponent, axis.to() - to, end);
        }
        logs[cell] = found.level + found.sums[0].ln();
        firsts[cell] = found.sums[1] / found.sums[0];
        seconds[cell] = found.sums[2] / found.sums[0];
    }
    let largest = logs.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let mut masses: Vec<f64> = logs.iter().map(|log| (log - largest).exp()).collect();
    let total: f64 = masses.iter().sum();
    if !total.is_finite() || total <= 0.0 {
        return None;
    }
    masses.iter_mut().for_each(|mass| *mass /= total);
    let mean: f64 = (0..count)
        .map(|i| masses[i] * (axis.edges()[i] + firsts[i]))
        .sum();
    let variance: f64 = (0..count)
        .map(|i| {
            let edge = axis.edges()[i] - mean;
            masses[i] * (edge * edge + 2.0 * edge * firsts[i] + seconds[i])
        })
        .sum();
    Some(OneAxis {
        masses,
        error: 0.0,
        moments: (mean, variance),
        log_integral: largest + total.ln(),
        ends,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::system::test_families::OneState;
    use crate::system::{Interpretation, TypedModel};
    use statrs::distribution::ContinuousCDF;

    #[test]
    fn cells_of_a_shallow_well_have_all_their_digits_beside_a_deep_one() {
        // Depths differ by more than 100 times the noise: e^-100 of the mass is in the left well.
        let (h, sigma2) = (0.38, 0.014_f64);
        let system = OneState::new(sigma2.sqrt(), |x: f64| h + x - x.powi(3));
        let axis = Axis::uniform(-1.9, 1.9, 200).unwrap();
        let found = one_axis(&system, &axis).unwrap();
        let potential = |x: f64| -h * x - 0.5 * x * x + 0.25 * x.powi(4);
        let p = |x: f64| (-2.0 / sigma2 * (potential(x) - potential(1.15))).exp();
        let mass = |cell: usize| {
            let (from, width) = (axis.edges()[cell], axis.width(cell));
            (0..1000)
                .map(|i| p(from + width * (f64::from(i) + 0.5) / 1000.0))
                .sum::<f64>()
        };
        let left = axis.find(-0.6).unwrap();
        assert!(found.masses[left] > 0.0 && found.masses[left] < 1e-40);
        for cell in [left - 3, left + 5] {
            let (ratio, expected) = (
                found.masses[cell] / found.masses[left],
                mass(cell) / mass(left),
            );
            // The midpoint rule on 1000 points is off by (p''/p) h²/24e6, below 1e-6.
            assert!((ratio / expected - 1.0).abs() < 1e-6, "{ratio} {expected}");
        }
        assert!(found.error < 1e-8, "{}", found.error);
    }

    #[test]
    fn a_density_that_grows_at_a_natural_end_has_all_its_mass() {
        // Beta densities x^(α - 1) (1 - x)^(β - 1): on few cells, singular at both ends.
        let genes = |alpha: f64, beta: f64| {
            TypedModel::new("genes", "Genes", ["x"])
                .with_equation("x", format!("0.5 ({alpha} (1 - x) - {beta} x)"))
                .with_noise("x", ["sqrt(x (1 - x))"])
                .with_interpretation(Interpretation::Ito)
                .build()
                .unwrap()
        };
        for (alpha, beta) in [(0.5, 0.5), (0.02, 0.3), (1.0, 0.1), (3.0, 0.7)] {
            let system = genes(alpha, beta).system_with(&[]).unwrap();
            let axis = Axis::uniform(0.0, 1.0, 10).unwrap();
            let found = one_axis(system.as_ref(), &axis).unwrap();
            let (mean, variance) = found.moments;
            let sum = alpha + beta;
            let exact = alpha * beta / (sum * sum * (sum + 1.0));
            assert!((mean - alpha / sum).abs() < 1e-6, "{mean} {}", alpha / sum);
            assert!((variance - exact).abs() < 1e-6, "{variance} {exact}");
            let beta = statrs::distribution::Beta::new(alpha, beta).unwrap();
            for (cell, mass) in found.masses.iter().enumerate() {
                let [low, high] = [0, 1].map(|side| beta.cdf(axis.edges()[cell + side]));
                assert!((mass - (high - low)).abs() < 1e-6, "{cell}: {mass}");
            }
        }
        // All of it.
        let system = genes(0.0, 0.5).system_with(&[]).unwrap();
        let axis = Axis::uniform(0.0, 1.0, 10).unwrap();
        assert!(one_axis(system.as_ref(), &axis).is_none());
    }

    #[test]
    fn a_density_that_falls_faster_than_any_power_at_a_natural_end_has_all_its_mass() {
        // Decay with immigration, x' = c - a x + s x ξ in Itô's reading: 1/x has a gamma density, of the shape
        // 1 + 2a/s² and the rate 2c/s². All of it lies far inside the first of few cells, or across many.
        for (c, a, s, to) in [
            (1e-3, 0.5, 0.3, 1.0),
            (1e-3, 0.5, 0.3, 0.02),
            (0.4, 0.5, 0.3, 8.0),
            (1.1e-3, 0.5, 0.005, 1.0),
            (0.14, 1.0, 0.007, 16.0),
        ] {
            let typed = TypedModel::new("immigration", "Immigration", ["x"])
                .with_equation("x", format!("{c} - {a} x"))
                .with_noise("x", [format!("{s} x")])
                .with_interpretation(Interpretation::Ito);
            let system = typed.build().unwrap().system_with(&[]).unwrap();
            let axis = Axis::uniform(0.0, to, 40).unwrap();
            let found = one_axis(system.as_ref(), &axis).unwrap();
            assert_eq!(found.ends[0], Some(f64::INFINITY));
            let (shape, rate) = (1.0 + 2.0 * a / (s * s), 2.0 * c / (s * s));
            let exact = statrs::distribution::InverseGamma::new(shape, rate).unwrap();
            for (cell, mass) in found.masses.iter().enumerate() {
                let [low, high] = [0, 1].map(|side| exact.cdf(axis.edges()[cell + side]));
                assert!(
                    (mass - (high - low)).abs() < 1e-8,
                    "{c} {cell}: {mass} {}",
                    high - low
                );
            }
            assert!(
                (found.moments.0 / (c / a) - 1.0).abs() < 1e-6,
                "{:?}",
                found.moments
            );
        }
    }

    #[test]
    fn moments_are_those_of_the_density() {
        // A normal density of variance σ²/2: far inside the range.
        let linear = OneState::new(0.5, |x: f64| 0.3 - x);
        let axis = Axis::uniform(-3.0, 4.0, 60).unwrap();
        let (mean, variance) = one_axis(&linear, &axis).unwrap().moments;
        assert!((mean - 0.3).abs() < 1e-12 && (variance - 0.125).abs() < 1e-12);
    }

    #[test]
    fn cells_wider_than_what_they_hold_are_right_though_tails_fall_by_a_thousand_orders_a_cell() {
        let system = OneState::new(0.5, |x: f64| 0.9 * x - x.powi(3)).with_surface(0.0);
        let (wide, narrow) = (
            Axis::uniform(-12.0, 13.0, 50).unwrap(),
            Axis::uniform(-12.0, 13.0, 2000).unwrap(),
        );
        let (wide, narrow) = (
            one_axis(&system, &wide).unwrap(),
            one_axis(&system, &narrow).unwrap(),
        );
        assert!(wide.error < 1e-8 && narrow.error < 1e-8);
        for (cell, mass) in wide.masses.iter().enumerate() {
            let sum: f64 = narrow.masses[40 * cell..40 * cell + 40].iter().sum();
            assert!((mass - sum).abs() < 1e-11, "{cell}: {mass} {sum}");
        }
        assert!((wide.moments.1 / narrow.moments.1 - 1.0).abs() < 1e-10);
    }

    #[test]
    fn a_cell_is_cut_where_the_drift_jumps() {
        // p ∝ exp(-2 |x - 0.13| / σ²) on cells of a half: no face at 0.13.
        let system =
            OneState::new(1.0, |x: f64| if x < 0.13 { 1.0 } else { -1.0 }).with_surface(0.13);
        let axis = Axis::uniform(-5.0, 5.0, 20).unwrap();
        let found = one_axis(&system, &axis).unwrap();
        assert!(found.error < 1e-10, "{}", found.error);
        let primitive = |x: f64| {
            let u = 2.0 * (x - 0.13);
            if u < 0.0 { u.exp() } else { 2.0 - (-u).exp() }
        };
        let total = primitive(5.0) - primitive(-5.0);
        for (cell, mass) in found.masses.iter().enumerate() {
            let edges = &axis.edges()[cell..cell + 2];
            let exact = (primitive(edges[1]) - primitive(edges[0])) / total;
            assert!((mass - exact).abs() < 1e-12, "{cell}: {mass} {exact}");
        }
    }
}

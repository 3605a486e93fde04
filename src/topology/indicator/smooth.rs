//! Curvatures at the centre of a sampled density: a polynomial fitted to log p over a wide stretch.
//!
//! Noise of a second derivative falls with the 3/2 to 5/2 power of the stretch it is taken over, so the stretch should
//! be as wide as a polynomial of low degree follows the density. Densities of stochastic oscillators are exponentials
//! of smooth potentials: log p is followed much farther than p, and its curvature at a centre of symmetry is p''/p. By
//! the same symmetry only terms of even degree are needed; along a kink, terms in the distance from it are added. Where
//! the fit leaves more than noise, the stretch is narrowed; a fit of a higher degree shows what is missed, as far as
//! noise lets it.

use std::ops::Range;

use nalgebra::{DMatrix, DVector};

use crate::density::{EstimatedDensity, Variants};

/// Share of the largest value of a profile down to which the stretch goes.
const LOWEST: f64 = 0.02;
/// And the share of the value at the centre, where that is low itself.
const LOWEST_OF_CENTRE: f64 = 0.2;
/// Least cells on either side of the centre.
const LEAST: usize = 4;
/// Degree of the first fit, and the higher one.
const DEGREE: [i32; 2] = [6, 8];
/// The same along a kink.
const DEGREE_AT_KINK: [i32; 2] = [4, 5];
/// Shares of the stretch that are tried, until the fit leaves no more than noise.
const SHARES: [f64; 6] = [1.0, 0.75, 0.56, 0.42, 0.32, 0.24];
/// Squares of residuals over what noise makes of them, up to which a fit is accepted.
const LARGEST_MISFIT: f64 = 1.7;
/// Cells below this share of the largest value do not take part.
const EMPTY: f64 = 0.01;
/// Values below this share of the largest are raised to it before the logarithm.
const CLIP: f64 = 1e-4;
/// Cells of the other axis (one over this share of it on either side) over which a profile is averaged.
const PROFILE: usize = 16;

/// Powers of the two coordinates (of the second one's magnitude, along a kink).
type Powers = [i32; 2];

/// Even powers for a marginal, degree six and eight.
fn marginal_terms(degree: i32) -> Vec<Powers> {
    (0..=degree / 2).map(|k| [2 * k, 0]).collect()
}

/// Terms of even degree for a joint density; those for [`Smooth::joint`] first.
fn joint_terms(degree: i32) -> Vec<Powers> {
    let of = |total: i32| (0..=total).map(move |k| [total - k, k]);
    (0..=degree / 2).flat_map(|half| of(2 * half)).collect()
}

/// Terms along a kink: even in the coordinate along it, every power of the distance from it.
fn kinked_terms(degree: i32) -> Vec<Powers> {
    let of = |half: i32| (0..=degree - 2 * half).map(move |across| [2 * half, across]);
    (0..=degree / 2).flat_map(of).collect()
}

/// Value of a term at an offset from the centre in units of the window.
fn term(powers: Powers, offset: &[f64], kinked: bool) -> f64 {
    let second = offset.get(1).copied().unwrap_or(1.0);
    let second = if kinked { second.abs() } else { second };
    offset[0].powi(powers[0]) * second.powi(powers[1])
}

/// What is fitted: terms of the first fit and of that of a higher degree, and the second derivatives that are wanted,
/// by the powers of their terms.
struct PolynomialTerms {
    terms: [Vec<Powers>; 2],
    wanted: Vec<Powers>,
    kinked: bool,
}

/// Curvatures of log p as linear functions of log p on the cells of a window.
pub(super) struct Smooth {
    cells: Vec<usize>,
    floor: f64,
    /// Weights for the second derivatives, first fit and that of a higher degree: of a marginal [xx], of a joint
    /// density [xx, xy, yy], along a kink [along].
    weights: [Vec<Vec<f64>>; 2],
}

impl Smooth {
    /// For a marginal about its centre.
    pub(super) fn marginal(estimated: &EstimatedDensity, at: f64) -> Option<Self> {
        let model = PolynomialTerms {
            terms: [marginal_terms(DEGREE[0]), marginal_terms(DEGREE[1])],
            wanted: vec![[2, 0]],
            kinked: false,
        };
        widest_that_fits(estimated, &[at], &[0], &model)
    }

    /// For a joint density about its centre.
    pub(super) fn joint(estimated: &EstimatedDensity, centre: &[f64]) -> Option<Self> {
        let model = PolynomialTerms {
            terms: [joint_terms(DEGREE[0]), joint_terms(DEGREE[1])],
            wanted: vec![[2, 0], [1, 1], [0, 2]],
            kinked: false,
        };
        widest_that_fits(estimated, centre, &[0, 1], &model)
    }

    /// For a joint density about its centre, along a kink that stands on axis `across`.
    pub(super) fn along_kink(
        estimated: &EstimatedDensity,
        centre: &[f64],
        across: usize,
    ) -> Option<Self> {
        let model = PolynomialTerms {
            terms: [
                kinked_terms(DEGREE_AT_KINK[0]),
                kinked_terms(DEGREE_AT_KINK[1]),
            ],
            wanted: vec![[2, 0]],
            kinked: true,
        };
        widest_that_fits(estimated, centre, &[1 - across, across], &model)
    }

    /// The second derivatives for given values of the density, by the first fit or by that of a higher degree (1).
    pub(super) fn derivatives(&self, values: &[f64], level: usize) -> Vec<f64> {
        let logarithms: Vec<f64> = (self.cells.iter())
            .map(|&cell| values[cell].max(self.floor).ln())
            .collect();
        let sum = |weights: &Vec<f64>| weights.iter().zip(&logarithms).map(|(w, l)| w * l).sum();
        self.weights[level].iter().map(sum).collect()
    }
}

/// The fit on the widest window on which the first model leaves no more than noise.
fn widest_that_fits(
    estimated: &EstimatedDensity,
    centre: &[f64],
    order: &[usize],
    model: &PolynomialTerms,
) -> Option<Smooth> {
    let mut found = None;
    for share in SHARES {
        let Some(window) = Window::new(estimated, centre, order, share) else {
            break;
        };
        let Some((smooth, misfit)) = window.fit(estimated, model) else {
            break;
        };
        found = Some(smooth);
        if misfit <= LARGEST_MISFIT {
            break;
        }
    }
    found
}

/// Cells about the centre: offsets in units of the half-widths, in the order of axes asked for.
struct Window {
    cells: Vec<usize>,
    offsets: Vec<Vec<f64>>,
    units: Vec<f64>,
}

impl Window {
    fn new(
        estimated: &EstimatedDensity,
        centre: &[f64],
        order: &[usize],
        share: f64,
    ) -> Option<Self> {
        let axes = &estimated.density.axes;
        let stretches: Option<Vec<Range<usize>>> = (0..axes.len())
            .map(|k| stretch(estimated, centre, k, share))
            .collect();
        let stretches = stretches?;
        let unit = |k: usize| {
            0.5 * (axes[k].edges()[stretches[k].end] - axes[k].edges()[stretches[k].start])
        };
        let units: Vec<f64> = order.iter().map(|&k| unit(k)).collect();
        let offset = |k: usize, cell: usize| (axes[k].centre(cell) - centre[k]) / unit(k);
        let (mut cells, mut offsets) = (Vec::new(), Vec::new());
        for first in stretches[0].clone() {
            match axes.get(1) {
                None => {
                    cells.push(first);
                    offsets.push(vec![offset(0, first)]);
                }
                Some(axis) => {
                    for second in stretches[1].clone() {
                        cells.push(first * axis.count() + second);
                        let both = [offset(0, first), offset(1, second)];
                        offsets.push(order.iter().map(|&k| both[k]).collect());
                    }
                }
            }
        }
        Some(Self {
            cells,
            offsets,
            units,
        })
    }

    /// Weights for the second derivatives that a model wants, and the misfit of its first terms.
    fn fit(self, estimated: &EstimatedDensity, model: &PolynomialTerms) -> Option<(Smooth, f64)> {
        // log p of a histogram has the variance 1/(n p V): cells with little mass count less, nearly empty ones
        // nothing.
        let largest = estimated.density.maximum();
        let precision: Vec<f64> = (self.cells.iter())
            .map(|&cell| estimated.density.values[cell] / largest)
            .map(|share| if share < EMPTY { 0.0 } else { share })
            .collect();
        let first = self.solve(&model.terms[0], &precision, model)?;
        let second = self.solve(&model.terms[1], &precision, model)?;
        let misfit = self.misfit(estimated, &first, &precision);
        let smooth = Smooth {
            floor: CLIP * largest,
            weights: [first.weights, second.weights],
            cells: self.cells,
        };
        Some((smooth, misfit))
    }

    fn solve(&self, terms: &[Powers], precision: &[f64], model: &PolynomialTerms) -> Option<Fit> {
        let design = DMatrix::from_fn(self.cells.len(), terms.len(), |row, column| {
            term(terms[column], &self.offsets[row], model.kinked)
        });
        let mut weighted = design.clone();
        for (mut row, weight) in weighted.row_iter_mut().zip(precision) {
            row *= *weight;
        }
        let normal = (design.transpose() * &weighted).cholesky()?;
        let row = |&powers: &Powers| {
            let place = terms.iter().position(|&one| one == powers)?;
            let second = self.units.get(1).copied().unwrap_or(1.0);
            let unit = self.units[0].powi(powers[0]) * second.powi(powers[1]);
            // ∂² of a square is twice its coefficient, of a product the coefficient.
            let factor = if powers == [1, 1] { 1.0 } else { 2.0 };
            let mut one = DVector::zeros(terms.len());
            one[place] = factor / unit;
            Some((&weighted * normal.solve(&one)).iter().copied().collect())
        };
        let weights: Option<Vec<Vec<f64>>> = model.wanted.iter().map(row).collect();
        Some(Fit {
            weights: weights?,
            coefficients: normal.solve(&weighted.transpose()),
            design,
        })
    }

    /// Weighted sum of the squares of the residuals over that of their jackknife variances: about one where the model
    /// follows the density to within noise.
    fn misfit(&self, estimated: &EstimatedDensity, solved: &Fit, precision: &[f64]) -> f64 {
        let Variants::Jackknife(replicates) = &estimated.variants else {
            return 0.0;
        };
        let floor = CLIP * estimated.density.maximum();
        let residual = |values: &[f64]| {
            let logarithms = self.cells.iter().map(|&cell| values[cell].max(floor).ln());
            let logarithms = DVector::from_iterator(self.cells.len(), logarithms);
            let fitted = &solved.design * (&solved.coefficients * &logarithms);
            logarithms - fitted
        };
        let all: Vec<DVector<f64>> = replicates.iter().map(|one| residual(one)).collect();
        let groups = all.len() as f64;
        let own = residual(&estimated.density.values);
        let (mut found, mut expected) = (0.0, 0.0);
        for (cell, weight) in precision.iter().enumerate() {
            let mean = all.iter().map(|one| one[cell]).sum::<f64>() / groups;
            let squares: f64 = all.iter().map(|one| (one[cell] - mean).powi(2)).sum();
            found += weight * own[cell] * own[cell];
            expected += weight * (groups - 1.0) / groups * squares;
        }
        if expected > 0.0 {
            found / expected
        } else {
            0.0
        }
    }
}

/// One fit: weights for what is wanted, and the matrices that give all coefficients and the fitted values.
struct Fit {
    weights: Vec<Vec<f64>>,
    coefficients: DMatrix<f64>,
    design: DMatrix<f64>,
}

/// Cells of axis `k` about the centre, equally many on both sides, on which the density is not small.
fn stretch(
    estimated: &EstimatedDensity,
    centre: &[f64],
    k: usize,
    share: f64,
) -> Option<Range<usize>> {
    let axis = &estimated.density.axes[k];
    let profile = profile(estimated, centre, k);
    let (below, above) = match axis.face_at(centre[k]) {
        Some(face) => (face, face),
        None => (axis.find(centre[k])?, axis.find(centre[k])? + 1),
    };
    let most = below.min(axis.count() - above);
    if most < LEAST {
        return None;
    }
    let pair = |reach: usize| 0.5 * (profile[below - reach] + profile[above + reach - 1]);
    let largest = profile.iter().copied().fold(0.0, f64::max);
    let middle = (1..=LEAST).map(pair).sum::<f64>() / LEAST as f64;
    let lowest = (LOWEST * largest).min(LOWEST_OF_CENTRE * middle);
    let reach = (1..=most).take_while(|&reach| pair(reach) >= lowest).last();
    let reach = (reach.unwrap_or(0) as f64 * share).round() as usize;
    let reach = reach.max(LEAST).min(most);
    Some(below - reach..above + reach)
}

/// A marginal's values; of a joint density those along axis `k`, averaged over the middle cells of the other axis.
fn profile(estimated: &EstimatedDensity, centre: &[f64], k: usize) -> Vec<f64> {
    let values = &estimated.density.values;
    let [first, second] = estimated.density.axes.as_slice() else {
        return values.clone();
    };
    let other = if k == 0 { second } else { first };
    let middle = other.find(centre[1 - k]).unwrap_or(other.count() / 2);
    let spread = (other.count() / PROFILE).max(1);
    let band = middle.saturating_sub(spread)..(middle + spread).min(other.count());
    let columns = second.count();
    let count = if k == 0 { first.count() } else { columns };
    let value = |cell: usize, across: usize| match k {
        0 => values[cell * columns + across],
        _ => values[across * columns + cell],
    };
    let mean = |cell: usize| {
        let sum: f64 = band.clone().map(|across| value(cell, across)).sum();
        sum / band.len() as f64
    };
    (0..count).map(mean).collect()
}

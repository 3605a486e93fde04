//! Densities brought to other cells: by the exact overlap of cells, with the density linear inside each.
//!
//! The slope in a cell is that of the parabola with the masses of the cell and its two neighbours (Colella and Woodward
//! 1984, Eq. 1.7). Flat cells would put mass wrong by h²p'/8 at every edge that falls inside a cell, as much as a good
//! method errs. Masses are conserved, the map is linear, and where no new edge falls inside an old cell it is exact.

use crate::density::{
    Density, DensityError, EstimatedDensity, Kink, Observable, Variants, estimate_from_difference,
};
use crate::space::{Axis, CellSpace};

/// Masses of the cells of `to` from those of the cells of `from`; what lies beyond the ends of `to` goes to its first
/// and last cell.
pub(crate) fn rebin(masses: &[f64], from: &Axis, to: &Axis) -> Vec<f64> {
    let mut below = vec![0.0];
    for mass in masses {
        below.push(below[below.len() - 1] + mass);
    }
    let whole = below[below.len() - 1];
    let cumulative = |edge: f64| match from.find(edge) {
        // The last edge belongs to the last cell.
        Some(cell) => {
            let share = ((edge - from.edges()[cell]) / from.width(cell)).clamp(0.0, 1.0);
            let bend = 0.5 * share * (share - 1.0) * difference(masses, from, cell);
            below[cell] + masses[cell] * share + bend * from.width(cell)
        }
        None if edge < from.from() => 0.0,
        None => whole,
    };
    let count = to.count();
    let mut before = 0.0;
    (1..=count)
        .map(|edge| {
            let up_to = if edge == count {
                whole
            } else {
                cumulative(to.edges()[edge])
            };
            up_to - std::mem::replace(&mut before, up_to)
        })
        .collect()
}

/// Change of the density from one end of a cell to the other.
fn difference(masses: &[f64], axis: &Axis, cell: usize) -> f64 {
    let (density, width) = (
        |cell: usize| masses[cell] / axis.width(cell),
        |cell: usize| axis.width(cell),
    );
    let step = |low: usize| density(low + 1) - density(low);
    let (last, here) = (masses.len() - 1, width(cell));
    if last == 0 {
        0.0
    } else if cell == 0 {
        2.0 * here / (here + width(1)) * step(0)
    } else if cell == last {
        2.0 * here / (here + width(last - 1)) * step(last - 1)
    } else {
        let (low, high) = (width(cell - 1), width(cell + 1));
        let upward = (2.0 * low + here) / (high + here) * step(cell);
        let downward = (here + 2.0 * high) / (low + here) * step(cell - 1);
        here / (low + here + high) * (upward + downward)
    }
}

/// Masses on the product of the axes `from`, the last fastest, brought to the product of the axes `to`.
fn rebin_product(masses: &[f64], from: &[Axis], to: &[Axis]) -> Vec<f64> {
    let mut counts: Vec<usize> = from.iter().map(Axis::count).collect();
    let mut masses = masses.to_vec();
    for (index, (old, new)) in from.iter().zip(to).enumerate() {
        let stride: usize = counts[index + 1..].iter().product();
        let blocks: usize = counts[..index].iter().product();
        let mut next = vec![0.0; blocks * new.count() * stride];
        for block in 0..blocks {
            for line in 0..stride {
                let place = |cell: usize, count: usize| (block * count + cell) * stride + line;
                let along: Vec<f64> = (0..old.count())
                    .map(|cell| masses[place(cell, old.count())])
                    .collect();
                for (cell, mass) in rebin(&along, old, new).into_iter().enumerate() {
                    next[place(cell, new.count())] = mass;
                }
            }
        }
        counts[index] = new.count();
        masses = next;
    }
    masses
}

/// A density with its uncertainty on the cells of other axes, one for each of its own. Of replicates and second schemes
/// the same is made; densities that are on these cells already stay as they are.
///
/// # Errors
/// [`DensityError`].
pub(crate) fn rebin_density(
    estimated: &EstimatedDensity,
    to: &[Axis],
) -> Result<EstimatedDensity, DensityError> {
    let from = &estimated.density.axes;
    if from == to {
        return Ok(estimated.clone());
    }
    let empty = |values: Vec<f64>| Density {
        axes: from.clone(),
        values,
    };
    let masses = |values: &[f64]| rebin_product(&empty(values.to_vec()).masses(), from, to);
    let space = CellSpace::new(to.to_vec()).map_err(|_| DensityError::DifferentAxes)?;
    let observable = match to.len() {
        1 => Observable::Marginal(0),
        _ => Observable::Joint(0, 1),
    };
    let mass = masses(&estimated.density.values);
    let mut rebinned = match &estimated.variants {
        Variants::Scheme(second) => {
            let other = masses(second).into_iter();
            let difference: Vec<f64> = other.zip(&mass).map(|(b, a)| b - a).collect();
            estimate_from_difference(&space, observable, &mass, &difference)?
        }
        Variants::Jackknife(replicates) => {
            let all: Vec<Vec<f64>> = replicates.iter().map(|one| masses(one)).collect();
            crate::density::estimate(&space, observable, &mass, &all)?
        }
        Variants::None => crate::density::estimate(&space, observable, &mass, &[])?,
    };
    rebinned.observable = estimated.observable;
    let kinks = estimated.structure.kinks.iter();
    rebinned.structure.kinks = kinks.map(|kink| move_kink(kink, from, to)).collect();
    Ok(rebinned)
}

/// A kink with its jump at the cells of other axes.
fn move_kink(kink: &Kink, from: &[Axis], to: &[Axis]) -> Kink {
    let jump = match (from, to, kink.jump.len()) {
        ([_, _], [_, _], 2..) => {
            let (old, new) = (&from[1 - kink.axis.min(1)], &to[1 - kink.axis.min(1)]);
            let cell = |at: f64| old.find(at.clamp(old.from(), old.to())).unwrap_or(0);
            let jumps = (0..new.count()).map(|number| kink.jump_at(cell(new.centre(number))));
            jumps.collect()
        }
        _ => kink.jump.clone(),
    };
    Kink {
        jump,
        ..kink.clone()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::space::Grading;
    use statrs::function::erf::erf;

    fn graded(count: usize) -> Axis {
        let grading = Grading {
            at: vec![0.3],
            smallest: 0.02,
        };
        Axis::graded(-5.0, 5.0, count, &grading).unwrap()
    }

    /// Masses of the normal density.
    fn normal(axis: &Axis) -> Vec<f64> {
        let below: Vec<f64> = axis
            .edges()
            .iter()
            .map(|edge| 0.5 * erf(edge / 2f64.sqrt()))
            .collect();
        below.windows(2).map(|pair| pair[1] - pair[0]).collect()
    }

    #[test]
    fn mass_is_conserved_on_any_cells() {
        let (from, to) = (graded(37), Axis::uniform(-5.0, 5.0, 50).unwrap());
        let masses: Vec<f64> = (0..37).map(|cell| f64::from(cell * 7 % 11)).collect();
        let whole: f64 = masses.iter().sum();
        for (from, to, masses) in [
            (&from, &to, masses.clone()),
            (&from, &Axis::uniform(-2.0, 1.0, 9).unwrap(), masses),
        ] {
            let sum: f64 = rebin(&masses, from, to).iter().sum();
            assert!((sum - whole).abs() < 1e-12 * whole);
        }
    }

    #[test]
    fn nested_cells_are_added_up_exactly() {
        let fine = Axis::uniform(0.0, 1.0, 12).unwrap();
        let coarse = Axis::uniform(0.0, 1.0, 4).unwrap();
        let masses: Vec<f64> = (0..12).map(|cell| f64::from(cell * cell % 5)).collect();
        for (cell, mass) in rebin(&masses, &fine, &coarse).iter().enumerate() {
            let expected: f64 = masses[3 * cell..3 * cell + 3].iter().sum();
            assert!((mass - expected).abs() < 1e-12, "{mass} {expected}");
        }
        // A product of nested cells: the joint density's marginal is the marginal's rebinning.
        let joint: Vec<f64> = masses.iter().flat_map(|a| [a * 0.25, a * 0.75]).collect();
        let two = Axis::uniform(0.0, 2.0, 2).unwrap();
        let found = rebin_product(&joint, &[fine, two.clone()], &[coarse.clone(), two]);
        for (cell, pair) in found.chunks(2).enumerate() {
            let expected: f64 = masses[3 * cell..3 * cell + 3].iter().sum();
            assert!((pair[0] - 0.25 * expected).abs() < 1e-12);
            assert!((pair[1] - 0.75 * expected).abs() < 1e-12);
        }
    }

    #[test]
    fn smooth_densities_come_through_with_third_order() {
        let to = Axis::uniform(-5.0, 5.0, 50).unwrap();
        let error = |count: usize| {
            let from = graded(count);
            let pairs = rebin(&normal(&from), &from, &to);
            let pairs = pairs.into_iter().zip(normal(&to));
            0.5 * pairs.map(|(a, b)| (a - b).abs()).sum::<f64>()
        };
        let (coarse, fine) = (error(60), error(240));
        // Four times as many cells: 4³ = 64 times less, of which the places of edges in cells blur a part.
        assert!(fine < coarse / 30.0, "{coarse:e} {fine:e}");
        // An edge in a cell of h = 0.17 errs by at most h³ max|p''|/(9√3·2) = 6e-5; 50 edges, on average a third of
        // that.
        assert!(coarse < 2e-3, "{coarse:e}");
    }
}

//! The rate of the quasi-stationary density on one grid, and what another generator changes of it.

use super::PassageError;
use super::rate::slowest;
use crate::generator::AbsorbingGenerator;
use crate::stationary::generator::{Absorbing, AbsorbingSolver, Expected};

/// A rate stands where turning its density once toward that of the grid changes it by less than this share of what half
/// of the dissipation does.
const UNSETTLED: f64 = 0.02;

/// What moments have left for the rate.
pub(super) struct Given<'a> {
    /// What is expected with what is expected as a gain.
    pub(super) again: &'a Expected,
    /// The times of the times of a start, as a start.
    pub(super) second: &'a [f64],
    /// The quasi-stationary density of another grid, and the same turned once toward that of this one.
    pub(super) begun: Option<[Vec<f64>; 2]>,
    /// The mean time.
    pub(super) mean: f64,
}

/// The rate with the vectors of both sides.
pub(super) struct QuasiStationary {
    pub(super) rate: f64,
    /// What the other generator changes of it.
    pub(super) change: f64,
    /// What belongs to the density on the other side.
    pub(super) left: Expected,
    pub(super) density: Vec<f64>,
}

impl QuasiStationary {
    /// The rate on one grid. `other` is the generator whose change is wanted.
    pub(super) fn find(
        solver: &mut AbsorbingSolver<'_>,
        stage: &Absorbing<'_>,
        other: &AbsorbingGenerator,
        given: Given<'_>,
    ) -> Result<Self, PassageError> {
        let scaled = given.again.values();
        let scaled: Vec<f64> = (scaled.iter())
            .map(|value| value / given.mean.powi(2))
            .collect();
        let left = solver.expected(stage, &scaled)?;
        // -w·Q z over w·z, and w·Q z itself.
        let quotient = |density: &[f64]| {
            let own = stage.of_balance(&stage.balance(density), &left, density);
            (-own / left.over(density), own)
        };
        let change = |density: &[f64], own: f64| {
            let pair = [(&left, density)];
            let [through] = Expected::through(pair, &other.rates, &other.ends);
            (own - through) / left.over(density)
        };
        let from = match given.begun {
            Some([begun, turned]) => {
                let ((before, _), (rate, own)) = (quotient(&begun), quotient(&turned));
                let change = change(&turned, own);
                let stands = (rate - before).abs() <= UNSETTLED * change.abs();
                if stands && is_rate(rate) {
                    return Ok(Self {
                        rate,
                        change,
                        left,
                        density: turned,
                    });
                }
                turned
            }
            None => given.second.to_vec(),
        };
        solver.tighten();
        let (found, density) = slowest(&from, |vector| solver.times(stage, vector))?;
        let (rate, own) = quotient(&density);
        Ok(Self {
            rate: if is_rate(rate) { rate } else { found },
            change: change(&density, own),
            left,
            density,
        })
    }
}

fn is_rate(rate: f64) -> bool {
    rate > 0.0 && rate.is_finite()
}

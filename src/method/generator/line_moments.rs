//! Means and deviations on one axis, of the coordinate and of watched formulas, by quadrature over the exact density:
//! within the range and beyond it, as far as the density goes.

use crate::continuation::Finding;
use crate::density::{EstimatedMoments, Moments};
use crate::generator::{Mesh, NODES, Reach};
use crate::method::MethodError;
use crate::method::report::Reporter;
use crate::system::{BoundQuantity, LANES};

/// Number of places of a line for means, at least; where a formula is not smooth they are halved.
const PLACES: usize = 128;

/// ln of how much less likely than the likeliest states those are at the ends of such a line: the square of a formula
/// that grows like an exponential may grow by so much.
const DEPTH: f64 = 600.0;

/// A function at some places.
type Function<'a> = Box<dyn Fn(&[f64; NODES]) -> [f64; NODES] + 'a>;

/// Moments over a line, and whether the mean has no end.
struct OnLine {
    moments: EstimatedMoments,
    is_mean_endless: bool,
    /// Whether the deviation has no end, end by end.
    endless_deviation: [bool; 2],
}

/// Puts moments by quadrature in place of those of cells, of the coordinate first and then of formulas, and tells of
/// those that do not exist or are not known to; those stay without errors. Nothing is done where the line has no end.
pub(super) fn put_on_line<'a>(
    reporter: &mut Reporter<'_>,
    reach: &Reach<'_>,
    formulas: impl Iterator<Item = &'a BoundQuantity>,
    moments: &mut [EstimatedMoments],
) -> Result<(), MethodError> {
    let Some(line) = reach.mesh(PLACES, DEPTH, &[]) else {
        return Ok(());
    };
    reporter.is_whole();
    let functions = [coordinate()].into_iter().chain(formulas.map(values));
    for (index, (function, slot)) in functions.zip(moments).enumerate() {
        let found = of(&line, reach, &function);
        *slot = match found.is_mean_endless {
            true => EstimatedMoments {
                errors: found.moments.errors,
                ..*slot
            },
            false => found.moments,
        };
        match index.checked_sub(1) {
            None => {
                let heavy = [0, 1]
                    .into_iter()
                    .filter(|&end| found.endless_deviation[end]);
                let powers = heavy.filter_map(|end| line.fall(end));
                if let Some(power) = powers.min_by(f64::total_cmp) {
                    reporter.heavy_tail(0, power);
                }
            }
            Some(average) if found.is_mean_endless => {
                reporter.tell(Finding::EndlessMean { average });
            }
            _ => {}
        }
    }
    Ok(())
}

fn coordinate<'a>() -> Function<'a> {
    Box::new(|places| *places)
}

fn values(formula: &BoundQuantity) -> Function<'_> {
    Box::new(|places| {
        let mut states = [places[0]; LANES];
        states[..places.len()].copy_from_slice(places);
        let all = formula.values(&[states]);
        std::array::from_fn(|point| all[point])
    })
}

/// Mean and deviation of a function.
fn of(line: &Mesh, reach: &Reach<'_>, function: &Function<'_>) -> OnLine {
    let mean = line.mean(reach.system, function);
    let square = |places: &[f64; NODES]| function(places).map(|value| (value - mean.value).powi(2));
    let variance = line.mean(reach.system, &square);
    let deviation = variance.value.max(0.0).sqrt();
    // About a mean that is off by so much the variance is larger by its square.
    let of_variance = variance.error + mean.error * mean.error;
    let error = match deviation > 0.0 {
        true => 0.5 * of_variance / deviation,
        false => of_variance.sqrt(),
    };
    OnLine {
        moments: EstimatedMoments {
            moments: Moments {
                mean: mean.value,
                standard_deviation: deviation,
            },
            errors: Some(Moments {
                mean: mean.error + line.error() * deviation.min(2.0 * mean.size),
                standard_deviation: error + line.error() * deviation,
            }),
        },
        is_mean_endless: !mean.error.is_finite(),
        endless_deviation: variance.endless,
    }
}

//! What a time step, and noise that is larger by a share, make of the densities of trajectories.
//!
//! Beside a plane where the drift across it jumps, and noise acts, states are pushed back from both sides. One step of
//! length h takes them across by √(b² h), and pushes them by the drift's jump. In a layer of this width densities are
//! those of the step, and not of the equations: with ε = J √(b² h)/4, J the jump of the slope of log p, values are off
//! by shares of the order of ε, and within the push itself by more. Increments of four values make copies of that spike
//! at the places where one step leads from the plane. The envelopes of these shares were fitted to dry friction
//! (`tests/truth/sampled_time_steps.rs` holds them to other systems).

use super::structure::intensity_beside;
use crate::density::{EstimatedDensity, EstimatedMoments, Kink, Moments};
use crate::sampling::Integrator;
use crate::space::{Axis, CellSpace};
use crate::system::{SwitchingSurface, System};

/// Height of the layer over ε, and its width over √(b² h).
const LAYER: (f64, f64) = (0.7, 0.6);

/// Area of the spike at the plane over ε √(b² h), of normal increments and of those of four values.
const SPIKE: f64 = 0.3;
const OF_FOUR: f64 = 0.5;

/// Distance over √(b² h) to which increments of four values carry copies of the spike.
const COPIES: f64 = 2.0;

/// Width over √(b² h) from which cells average over what one step does, which moves mass and makes none.
const AVERAGING: f64 = 0.35;

/// Adds to the standard errors what the step does beside the kinks of densities; `masses` are those of all cells, and
/// `surfaces` are where kinks are.
pub(super) fn add_layers(
    densities: &mut [EstimatedDensity],
    (system, space): (&dyn System, &CellSpace),
    masses: &[f64],
    surfaces: &[SwitchingSurface],
    (integrator, time_step): (Integrator, f64),
) {
    for one in densities {
        let axes = one.observable.axes();
        let mut share = vec![0.0; one.density.values.len()];
        for kink in one.structure.kinks.iter().filter(|kink| !kink.is_bend()) {
            let is_its = |surface: &&SwitchingSurface| {
                axes.get(kink.axis) == Some(&surface.axis) && surface.at == kink.at
            };
            let Some(&surface) = surfaces.iter().find(is_its) else {
                continue;
            };
            let intensity = intensity_beside(system, space, masses, surface);
            let layer = Layer {
                width: (intensity * time_step).sqrt(),
                of_four: integrator.is_for_laws(),
            };
            if layer.width > 0.0 {
                layer.add(&mut share, &one.density.axes, kink);
            }
        }
        let values = one.density.values.iter().zip(share);
        for (error, (value, share)) in one.standard_error.iter_mut().zip(values) {
            *error = error.hypot(share * value);
        }
    }
}

/// Adds to the standard errors how densities change with the intensity of the noise, which is larger by a share.
pub(super) fn add_wider(densities: &mut [EstimatedDensity], share: f64) {
    for one in densities {
        let changes = by_wider_noise(&one.density.masses(), &one.density.values, share);
        for (error, change) in one.standard_error.iter_mut().zip(changes) {
            *error = error.hypot(change);
        }
    }
}

/// How the values of a density change with the intensity of the noise, which is larger by a share: -s p (log p -
/// ⟨log p⟩), exact where p is exp(-U/D). `masses` are those of the cells that the values are of.
pub(super) fn by_wider_noise(masses: &[f64], values: &[f64], share: f64) -> Vec<f64> {
    if share == 0.0 || !share.is_finite() {
        return vec![0.0; values.len()];
    }
    let logarithms: Vec<f64> = values.iter().map(|value| value.ln()).collect();
    let known = masses
        .iter()
        .zip(&logarithms)
        .filter(|(mass, _)| **mass > 0.0);
    let (total, sum) = known.fold((0.0, 0.0), |(total, sum), (mass, logarithm)| {
        (total + mass, sum + mass * logarithm)
    });
    let change = |(&value, logarithm): (&f64, &f64)| {
        if value > 0.0 {
            -share * value * (logarithm - sum / total)
        } else {
            0.0
        }
    };
    values.iter().zip(&logarithms).map(change).collect()
}

/// Moments with what cells and steps make of them beside sampling: variances in `excess`, one an axis, and noise that
/// is larger by a share. Quantities are taken to answer to that as squares of the axes do.
pub(super) fn widened(
    estimated: Vec<EstimatedMoments>,
    excess: &[f64],
    share: f64,
) -> Vec<EstimatedMoments> {
    let one = |(index, one): (usize, EstimatedMoments)| {
        let deviation = one.moments.standard_deviation;
        one.with(match excess.get(index) {
            Some(&excess) => Moments {
                mean: 0.0,
                // What does not vary has no variance in excess either.
                standard_deviation: 0.5
                    * (excess / deviation.max(f64::MIN_POSITIVE) + share * deviation),
            },
            None => Moments {
                mean: share * deviation,
                standard_deviation: share * deviation,
            },
        })
    };
    estimated.into_iter().enumerate().map(one).collect()
}

/// The layer about a plane.
struct Layer {
    /// √(b² h), in the unit of the axis across.
    width: f64,
    /// Whether increments have four values.
    of_four: bool,
}

impl Layer {
    /// Adds shares of the values by which a density may be off beside a kink; of several kinks the sum.
    fn add(&self, share: &mut [f64], axes: &[Axis], kink: &Kink) {
        let Ok(cells) = CellSpace::new(axes.to_vec()) else {
            return;
        };
        let across = &axes[kink.axis];
        let other = (0..axes.len()).find(|&axis| axis != kink.axis);
        for (cell, share) in share.iter_mut().enumerate() {
            let place = |axis: usize| cells.position(cell, axis);
            let position = place(kink.axis);
            let jump = kink.jump_at(other.map_or(0, place)).abs();
            let [from, to] = [across.edges()[position], across.edges()[position + 1]];
            let distance = (from - kink.at).max(kink.at - to).max(0.0);
            let epsilon = 0.25 * jump * self.width;
            if epsilon <= 0.0 {
                continue;
            }
            *share +=
                epsilon * self.envelope(epsilon, distance / self.width, (to - from) / self.width);
        }
    }

    /// Share over ε of a cell of some width at a distance from the plane, both over the layer's width.
    fn envelope(&self, epsilon: f64, distance: f64, width: f64) -> f64 {
        let within = |reach: f64| (-(distance / reach).powi(2)).exp();
        let narrow = width.max(epsilon);
        let (height, reach) = LAYER;
        let layer = height * within(reach);
        let (area, reach) = if self.of_four {
            (OF_FOUR, COPIES)
        } else {
            (SPIKE, epsilon)
        };
        (layer + area / narrow * within(reach)) * (AVERAGING / width).min(1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn axes_and_quantities_are_widened_as_squares_are() {
        let own = Moments {
            mean: 1.0,
            standard_deviation: 2.0,
        };
        let exact = EstimatedMoments::by_difference(own, &[own]);
        let found = widened(vec![exact, exact], &[0.04], 0.01);
        let errors = |index: usize| found[index].errors.unwrap();
        // √(4 + 0.04) - 2, and noise of 1.01 in place of 1.
        assert!((errors(0).standard_deviation - 0.02).abs() < 1e-12);
        assert_eq!(errors(0).mean, 0.0);
        assert!((errors(1).mean - 0.02).abs() < 1e-12);
    }
}

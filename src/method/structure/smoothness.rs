//! How smooth a system is across a plane on which its drift or noise may bend.

use crate::space::CellSpace;
use crate::system::{Noise, SwitchingSurface, System};

/// How smooth a system is across a surface on which the jump law asks for no kink of the density.
#[derive(Debug, Clone, Copy, PartialEq, PartialOrd)]
pub(super) enum Break {
    /// As smooth as elsewhere.
    None,
    /// The curvature of drift or noise jumps.
    Curvature,
    /// Drift or noise bends.
    Bend,
    /// The drift across it jumps: the jump law tells of it.
    Jump,
}

/// Distance between states from which values, slopes and curvatures on one side of a surface are taken, as a share of
/// the range.
const APART: f64 = 1e-5;
/// A jump of a value or of a slope that is a smaller share of the values, in units of the range, is rounding.
const ROUNDING: f64 = 1e-6;
/// The same of a curvature: smooth functions may turn fast.
const SMOOTH: f64 = 0.1;

/// How smooth drift and noise are across a surface, in so far as the density follows them: where noise acts across it,
/// only what moves across it counts.
pub(super) fn break_at(system: &dyn System, space: &CellSpace, surface: SwitchingSurface) -> Break {
    let axis = &space.axes()[surface.axis];
    if axis.find(surface.at).is_none() {
        return Break::None;
    }
    let step = APART * (axis.to() - axis.from());
    // Where noise acts across the surface, what moves other axes bends a density in higher derivatives only.
    let is_noisy = system.is_noisy(surface.axis);
    // On the middle of the other axes, and at two places aside.
    let worst = [0.31, 0.5, 0.73].into_iter().map(|share| {
        let ends = space.axes().iter();
        let mut state: Vec<f64> = ends
            .map(|one| one.from() + share * (one.to() - one.from()))
            .collect();
        let mut across = |offset: f64| {
            state[surface.axis] = surface.at + offset;
            let mut values = system.drift_at(0.0, &state);
            if is_noisy {
                values = vec![values[surface.axis]];
            }
            let counts = |noise: &&Noise| !is_noisy || noise.axis == surface.axis;
            let noises = system.noises().iter().filter(counts);
            values.extend(noises.map(|noise| noise.at(0.0, &state).powi(2)));
            values
        };
        let far = 0.25 / APART;
        let mut side = |sign: f64| [1.0, 2.0, 3.0, far].map(|k| across(sign * k * step));
        let (above, below) = (side(1.0), side(-1.0));
        let of = |side: &[Vec<f64>; 4], which: usize| [0, 1, 2, 3].map(|k| side[k][which]);
        let found =
            (0..above[0].len()).map(|which| how_smooth(of(&above, which), of(&below, which)));
        found.fold(
            Break::None,
            |worst, one| if one > worst { one } else { worst },
        )
    });
    worst.fold(
        Break::None,
        |worst, one| if one > worst { one } else { worst },
    )
}

/// From values at one, two and three steps on either side of a surface, and far away.
fn how_smooth(above: [f64; 4], below: [f64; 4]) -> Break {
    let size = above
        .iter()
        .chain(&below)
        .fold(0.0_f64, |max, one| max.max(one.abs()));
    // On the surface, in units of the range; away from it.
    let value = |f: [f64; 4]| 3.0 * f[0] - 3.0 * f[1] + f[2];
    let slope = |f: [f64; 4]| (-2.5 * f[0] + 4.0 * f[1] - 1.5 * f[2]) / APART;
    let curvature = |f: [f64; 4]| (f[0] - 2.0 * f[1] + f[2]) / (APART * APART);
    if (value(above) - value(below)).abs() > ROUNDING * size {
        Break::Jump
    } else if (slope(above) + slope(below)).abs() > ROUNDING * size {
        Break::Bend
    } else if (curvature(above) - curvature(below)).abs() > SMOOTH * size {
        Break::Curvature
    } else {
        Break::None
    }
}

//! Axes graded toward switching surfaces, fine enough for the layer in which the kink of the density lives.

use crate::numerics::sort_ascending;
use crate::space::Grading;
use crate::system::{SwitchingSurface, System, natural_ends};

/// Smallest cell, in thicknesses of the layer. At a quarter the slope law p'(0+)/p(0) = -2 f_c/σ² holds to
/// half a per cent with 100 cells (docs/accuracy.md).
const LAYER_SHARE: f64 = 0.25;

/// Smallest cell on a surface across which the force does not jump, as a share of the uniform width. There only the
/// rates of other states bend, as that of Dahl's z does: the density bends in a high derivative, over lengths that have
/// nothing to do with the force. With 50 cells 0.3 to 0.5 serve alike; at a tenth the cells that are missing elsewhere
/// cost more (docs/accuracy.md).
const BEND_SHARE: f64 = 0.4;

/// Jump of the force, relative to its root mean square, that is none.
const NO_JUMP: f64 = 1e-6;
/// Distance from a surface at which its jump is looked at, relative to the range.
const BESIDE: f64 = 1e-5;

/// Smallest cell at a wall that a coordinate without noise creeps up to, as a share of the uniform width.
const WALL_SHARE: f64 = 0.2;

/// Smallest cell at an end at which the noise dies, as a share of the uniform width: there the density goes like a
/// power of the distance.
const NATURAL_SHARE: f64 = 1.0 / 64.0;

/// Places along every other axis where the force across a surface is looked at.
const PLACES: usize = 9;

/// Grading of axis `axis` with `count` cells toward the switching surfaces that lie inside its range.
///
/// The density bends within a layer of thickness D/|a| on a surface, D = σ²/2 and a the drift across it: the
/// smallest cell is a share of that thickness for the root mean square drift over the other axes' `ranges`
/// (one range an axis, in the system's order). Where the drift does not jump across the surface there is no such layer,
/// and the cells become somewhat narrower only.
///
/// An axis is graded toward ends at which its noise dies, too.
///
/// An axis without noise is graded toward its walls: under steady sliding Dahl's z nears them exponentially,
/// 1 - |z|λ/f_c shrinking by e for every f_c/λ that x moves, and so do the widths of what the density shows.
///
/// `None` where there is nothing to grade toward, or uniform cells are fine enough.
pub fn automatic_grading(
    system: &dyn System,
    ranges: &[(f64, f64)],
    axis: usize,
    count: usize,
) -> Option<Grading> {
    let &(from, to) = ranges.get(axis)?;
    if ranges.len() != system.dimension() || count == 0 {
        return None;
    }
    if !system.is_noisy(axis) {
        return toward_walls(system, axis, (from, to), count);
    }
    let inside = |at: &f64| *at > from && *at < to;
    let surfaces = system.facts().surfaces_on(axis).filter(inside);
    let uniform = (to - from) / count as f64;
    let wanted = surfaces.map(|at| match layer(system, ranges, axis, at) {
        Some(thickness) => (at, LAYER_SHARE * thickness),
        None => (at, BEND_SHARE * uniform),
    });
    // Of one axis quadrature follows every power.
    let natural = match ranges.len() {
        1 => [false; 2],
        _ => natural_ends(system, axis, ranges),
    };
    let natural = natural.into_iter().zip([from, to]);
    let natural = natural.filter(|(is_natural, _)| *is_natural);
    let mut wanted: Vec<(f64, f64)> = wanted
        .chain(natural.map(|(_, end)| (end, NATURAL_SHARE * uniform)))
        .collect();
    sort_ascending(&mut wanted, |one| one.0);
    let smallest = wanted
        .iter()
        .fold(f64::INFINITY, |least, one| least.min(one.1));
    let mut at: Vec<f64> = wanted.into_iter().map(|(at, _)| at).collect();
    at.dedup();
    (smallest > 0.0 && smallest < uniform).then_some(Grading { at, smallest })
}

/// Grading of an axis without noise toward those ends of its range that are walls.
fn toward_walls(
    system: &dyn System,
    axis: usize,
    (from, to): (f64, f64),
    count: usize,
) -> Option<Grading> {
    let walls = system
        .facts()
        .walls(axis, (from, to))
        .into_iter()
        .zip([from, to]);
    let at: Vec<f64> = walls
        .filter_map(|(wall, end)| wall.then_some(end))
        .collect();
    let smallest = WALL_SHARE * (to - from) / count as f64;
    (!at.is_empty() && smallest > 0.0).then_some(Grading { at, smallest })
}

/// Thickness D/|a| of the layer on a surface; `None` where the force does not jump there.
fn layer(system: &dyn System, ranges: &[(f64, f64)], axis: usize, at: f64) -> Option<f64> {
    let others = u32::try_from(ranges.len() - 1).unwrap_or(0);
    let surface = SwitchingSurface { axis, at };
    let distance = BESIDE * (ranges[axis].1 - ranges[axis].0);
    let (mut squares, mut diffusion, mut states, mut jump) = (0.0, 0.0, 0.0, 0.0_f64);
    for number in 0..PLACES.pow(others) {
        let mut rest = number;
        let mut place = |range: &(f64, f64)| {
            let share = (rest % PLACES) as f64 / (PLACES - 1) as f64;
            rest /= PLACES;
            range.0 + share * (range.1 - range.0)
        };
        let axes = ranges.iter().enumerate();
        let state: Vec<f64> = axes
            .map(|(index, range)| if index == axis { at } else { place(range) })
            .collect();
        let force = system.drift_at(0.0, &state)[axis];
        jump = jump.max(surface.drift_jump(system, &state, distance)[axis].abs());
        if force.is_finite() {
            squares += force * force;
            states += 1.0;
        }
        diffusion += 0.5 * system.intensity_at(axis, 0.0, &state);
    }
    let mean_diffusion = diffusion / PLACES.pow(others) as f64;
    let force = (squares / f64::max(states, 1.0)).sqrt();
    (jump > NO_JUMP * force).then(|| mean_diffusion / force)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::system::test_families::built_in;

    #[test]
    fn the_smallest_cell_is_a_quarter_of_the_layer() {
        let values = [("kappa", 0.01), ("f_c", 0.01), ("sigma2", 0.01)];
        let coulomb = built_in("coulomb", &values);
        let ranges = [(-4.0, 4.0), (-4.0, 4.0)];
        let grading = automatic_grading(&*coulomb, &ranges, 1, 100).unwrap();
        assert_eq!(grading.at, vec![0.0]);
        // Force -x on y = 0 at x = -4, -3, … 4: mean square 60/9; D = 0.005.
        let expected = 0.25 * 0.005 / (60.0_f64 / 9.0).sqrt();
        assert!((grading.smallest - expected).abs() < 1e-12, "{grading:?}");
        assert_eq!(automatic_grading(&*coulomb, &ranges, 0, 100), None);
        assert_eq!(automatic_grading(&*coulomb, &ranges, 1, 100_000), None);
    }

    #[test]
    fn an_axis_between_walls_is_graded_toward_them() {
        let values = [
            ("kappa", 0.1),
            ("lambda", 0.2),
            ("f_c", 0.1),
            ("sigma2", 0.2),
        ];
        let dahl = built_in("dahl", &values);
        let grading = |z: (f64, f64)| {
            automatic_grading(&*dahl, &[(-2.0, 2.0), (-2.0, 2.0), z], 2, 20).map(|found| found.at)
        };
        assert_eq!(grading((-0.5, 0.5)), Some(vec![-0.5, 0.5]));
        assert_eq!(grading((-0.4, 0.5)), Some(vec![0.5]));
        assert_eq!(grading((-0.4, 0.4)), None);
    }

    #[test]
    fn a_bend_of_another_rate_makes_cells_somewhat_narrower() {
        let values = [
            ("kappa", 0.1),
            ("lambda", 0.2),
            ("f_c", 0.1),
            ("sigma2", 0.2),
        ];
        let dahl = built_in("dahl", &values);
        let ranges = [(-2.0, 2.0), (-3.0, 3.0), (-0.5, 0.5)];
        let grading = automatic_grading(&*dahl, &ranges, 1, 50).unwrap();
        assert_eq!(grading.at, vec![0.0]);
        assert!((grading.smallest - BEND_SHARE * 0.12).abs() < 1e-12);
    }

    #[test]
    fn a_smooth_system_is_not_graded() {
        let values = [("a", 0.5), ("sigma2", 0.1)];
        let bistable = built_in("bistable", &values);
        assert_eq!(automatic_grading(&*bistable, &[(-2.0, 2.0)], 0, 50), None);
    }
}

//! Where the signatures of a map change along its rows and columns, and which indicator tells where between two nodes.

use std::cmp::Ordering;

use super::lattice::{At, Lattice};
use super::node::{SolvedNode, SolvedNodes};
use crate::continuation::Point;
use crate::continuation::change::{Change, changes};
use crate::continuation::root::between;
use crate::topology::{Detector, IndicatorKind};

/// A zero of an indicator between two neighbours of a row or a column. Places are those of the box with sides of length
/// one.
#[derive(Debug, Clone)]
pub(super) struct Crossing {
    pub(super) observable: usize,
    pub(super) kind: IndicatorKind,
    /// Where the indicator is, one coordinate an axis of the density.
    pub(super) place: Vec<f64>,
    /// Where it is about zero.
    pub(super) at: [f64; 2],
    pub(super) ends: [[f64; 2]; 2],
}

/// A change between two neighbours that no indicator tells the place of.
#[derive(Debug, Clone)]
pub(super) struct Blurred {
    pub(super) observable: usize,
    pub(super) ends: [[f64; 2]; 2],
}

/// A row or a column: its nodes in order, with their places along it.
type NodeRow<'g> = Vec<(usize, At, &'g SolvedNode)>;

/// All changes along rows and columns.
pub(super) fn crossings(
    grid: &SolvedNodes,
    lattice: &Lattice,
    detector: &dyn Detector,
) -> (Vec<Crossing>, Vec<Blurred>) {
    let (mut found, mut blurred) = (Vec::new(), Vec::new());
    for side in 0..2 {
        for line in lines(grid, lattice, side) {
            // Densities are kept about changes only.
            let runs = line.chunk_by(|a, b| {
                let kept = a.2.point.is_some() && b.2.point.is_some();
                kept && b.0 - a.0 <= lattice.coarse()
            });
            for run in runs.filter(|run| run.len() > 1) {
                along(run, lattice, detector, &mut found, &mut blurred);
            }
        }
    }
    sort(&mut found);
    (found, blurred)
}

/// Brings crossings into an order that does not depend on how they were found: along rows, then along columns.
pub(super) fn sort(crossings: &mut [Crossing]) {
    crossings.sort_by(|a, b| {
        let places = in_order((&a.ends, a.observable), (&b.ends, b.observable));
        places.then_with(|| a.kind.code().cmp(b.kind.code()))
    });
}

/// The order of two pairs of neighbours.
pub(super) fn in_order(
    (a, of_a): (&[[f64; 2]; 2], usize),
    (b, of_b): (&[[f64; 2]; 2], usize),
) -> Ordering {
    let [places_of_a, places_of_b] = [a, b].map(|ends| {
        // Along a row or a column, in which one, and where in it.
        let side = usize::from(ends[0][0] == ends[1][0]);
        [side as f64, ends[0][1 - side], ends[0][side]]
    });
    let pairs = places_of_a.iter().zip(&places_of_b);
    let order = pairs.map(|(a, b)| a.total_cmp(b));
    order
        .fold(Ordering::Equal, Ordering::then)
        .then(of_a.cmp(&of_b))
}

fn lines<'g>(grid: &'g SolvedNodes, lattice: &Lattice, side: usize) -> Vec<NodeRow<'g>> {
    let mut lines: Vec<NodeRow<'g>> = vec![Vec::new(); lattice.last(1 - side) + 1];
    for (at, solved) in grid.all() {
        lines[at[1 - side]].push((at[side], at, solved));
    }
    for line in &mut lines {
        line.sort_by_key(|one| one.0);
    }
    lines
}

/// The changes along a run of neighbours whose densities are there.
fn along(
    run: &[(usize, At, &SolvedNode)],
    lattice: &Lattice,
    detector: &dyn Detector,
    found: &mut Vec<Crossing>,
    blurred: &mut Vec<Blurred>,
) {
    let solved: Vec<(At, &Point)> = run
        .iter()
        .filter_map(|&(_, at, solved)| Some((at, solved.point.as_ref()?)))
        .filter(|(_, point)| !point.detections.is_empty())
        .collect();
    let points: Vec<&Point> = solved.iter().map(|one| one.1).collect();
    let share = |index: usize| lattice.share(solved[index].0);
    for change in changes(&points, detector) {
        match crossing(&change, &share, &points) {
            Some(crossing) => found.push(crossing),
            None => blurred.push(Blurred {
                observable: change.observable,
                ends: [share(change.left), share(change.right)],
            }),
        }
    }
}

/// `None` where no indicator changes its sign.
fn crossing(
    change: &Change,
    share: &dyn Fn(usize) -> [f64; 2],
    points: &[&Point],
) -> Option<Crossing> {
    let crossing = change.crossing()?;
    let centre = |index: usize| {
        let density = points.get(index)?.densities.get(change.observable)?;
        match density.structure.centre.as_deref() {
            Some(&[centre]) => Some(centre),
            _ => None,
        }
    };
    let centre = centre(crossing.left).filter(|one| centre(crossing.left + 1) == Some(*one));
    let ends = [share(crossing.left), share(crossing.left + 1)];
    let [low, high] = &crossing.ends;
    let along = between((0.0, low.value), (1.0, high.value));
    let nearer = if along < 0.5 { low } else { high };
    let (kind, place) = on_upper_side(crossing.kind(), nearer.place.clone(), centre);
    Some(Crossing {
        observable: change.observable,
        kind,
        place,
        at: [0, 1].map(|k| (1.0 - along) * ends[0][k] + along * ends[1][k]),
        ends,
    })
}

/// Of a density over one axis that is symmetric about a centre, the indicator above it that has the same curve.
fn on_upper_side(
    kind: IndicatorKind,
    place: Vec<f64>,
    centre: Option<f64>,
) -> (IndicatorKind, Vec<f64>) {
    let (Some(centre), &[x]) = (centre, place.as_slice()) else {
        return (kind, place);
    };
    match (kind.traits().mirror)().filter(|_| x < centre) {
        Some(mirrored) => (mirrored, vec![2.0 * centre - x]),
        None => (kind, place),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mirror_images_have_one_indicator() {
        let [rising, falling] = [true, false].map(IndicatorKind::shoulder);
        let of = |kind, x: f64, centre| on_upper_side(kind, vec![x], centre);
        assert_eq!(of(falling, -0.5, Some(0.25)), (rising, vec![1.0]));
        assert_eq!(of(rising, 1.0, Some(0.25)), (rising, vec![1.0]));
        assert_eq!(of(falling, -0.5, None), (falling, vec![-0.5]));
    }
}

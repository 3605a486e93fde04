//! Shards of a map: contiguous parts of its rows that are solved by processes that know nothing of each other, and what
//! they found.

use super::crossing::{Blurred, Crossing, in_order, sort};
use super::found::MapNode;
use crate::continuation::Shard;
use crate::topology::IndicatorKind;

/// A change of signature between two neighbouring nodes. Places are shares of the sides of the box.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct MapChange {
    /// The observable, by its place in [`Subject::observables`](crate::continuation::Subject::observables).
    pub(crate) observable: usize,
    /// The two nodes.
    pub(crate) ends: [[f64; 2]; 2],
    /// The indicator that is zero between them, where it is in the density, and about where the zero is; `None` where
    /// no indicator tells.
    pub(crate) zero: Option<(IndicatorKind, Vec<f64>, [f64; 2])>,
}

/// What a shard of a map has found.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct MapShard {
    /// Which one.
    pub(crate) shard: Shard,
    /// Its nodes, those of the rows at its borders included.
    pub(crate) nodes: Vec<MapNode>,
    /// The changes between them.
    pub(crate) changes: Vec<MapChange>,
    /// Whether it was interrupted before it was complete.
    pub(crate) interrupted: bool,
}

/// What was found as changes.
pub(super) fn changes((crossings, blurred): (Vec<Crossing>, Vec<Blurred>)) -> Vec<MapChange> {
    let told = crossings.into_iter().map(|one| MapChange {
        observable: one.observable,
        ends: one.ends,
        zero: Some((one.kind, one.place, one.at)),
    });
    let others = blurred.into_iter().map(|one| MapChange {
        observable: one.observable,
        ends: one.ends,
        zero: None,
    });
    told.chain(others).collect()
}

/// Adds changes to those that are there, each once, in the order in which a map in one piece finds them.
pub(super) fn gather<'s>(
    changes: impl Iterator<Item = &'s MapChange>,
    crossings: &mut Vec<Crossing>,
    blurred: &mut Vec<Blurred>,
) {
    for MapChange {
        observable,
        ends,
        zero,
    } in changes
    {
        let (observable, ends) = (*observable, *ends);
        match zero {
            Some((kind, place, at)) => crossings.push(Crossing {
                observable,
                kind: *kind,
                place: place.clone(),
                at: *at,
                ends,
            }),
            None => blurred.push(Blurred { observable, ends }),
        }
    }
    sort(crossings);
    crossings.dedup_by(|a, b| {
        (a.observable, a.kind, a.ends) == (b.observable, b.kind, b.ends)
            && nearly(&a.place, &b.place)
    });
    blurred.sort_by(|a, b| in_order((&a.ends, a.observable), (&b.ends, b.observable)));
    blurred.dedup_by(|a, b| (a.observable, a.ends) == (b.observable, b.ends));
}

/// Whether two solves of one density have an indicator in one place.
fn nearly(a: &[f64], b: &[f64]) -> bool {
    let mut pairs = a.iter().zip(b);
    pairs.all(|(a, b)| (a - b).abs() <= 1e-4 * (1.0 + a.abs()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn changes_of_shards_are_gathered_once_along_rows_and_then_along_columns() {
        let change = |ends, at: f64| MapChange {
            observable: 0,
            ends,
            zero: Some((IndicatorKind::CURVATURE, vec![0.0], [at, 0.5])),
        };
        let row = |y: f64| [[0.2, y], [0.4, y]];
        let column = [[0.2, 0.5], [0.2, 0.75]];
        // The row at 0.5 is in both.
        let shards = [
            change(row(0.5), 0.3),
            change(column, 0.2),
            change(row(0.25), 0.3),
            change(row(0.5), 0.300_001),
        ];
        let (mut crossings, mut blurred) = (Vec::new(), Vec::new());
        gather(shards.iter(), &mut crossings, &mut blurred);
        let ends: Vec<_> = crossings.iter().map(|one| one.ends).collect();
        assert_eq!(ends, [row(0.25), row(0.5), column]);
        assert_eq!(changes((crossings, blurred)).len(), 3);
    }
}

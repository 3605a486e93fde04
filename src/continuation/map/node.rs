//! Nodes while a map is made: with the densities where a change may be near, and without them elsewhere, so that a map
//! of thousands of nodes fits into memory.

use std::collections::BTreeMap;

use super::found::MapNode;
use super::lattice::{At, Lattice};
use crate::continuation::Point;
use crate::topology::Signature;

/// Neighbours on either side whose signatures decide whether densities are kept: an indicator may pass zero a step or
/// two before what it tells is counted.
pub(super) const NEAR: usize = 2;

/// A node, and the solved point while it is kept.
#[derive(Debug, Clone)]
pub(super) struct SolvedNode {
    pub(super) node: MapNode,
    pub(super) point: Option<Point>,
}

/// All solved nodes, row by row.
#[derive(Debug, Default)]
pub(super) struct SolvedNodes(BTreeMap<(usize, usize), SolvedNode>);

impl SolvedNodes {
    pub(super) fn get(&self, [column, row]: At) -> Option<&SolvedNode> {
        self.0.get(&(row, column))
    }

    pub(super) fn insert(&mut self, [column, row]: At, solved: SolvedNode) {
        self.0.insert((row, column), solved);
    }

    /// All nodes with their places, by rows.
    pub(super) fn all(&self) -> impl Iterator<Item = (At, &SolvedNode)> {
        self.0
            .iter()
            .map(|(&(row, column), solved)| ([column, row], solved))
    }

    pub(super) fn into_nodes(self) -> Vec<MapNode> {
        self.0.into_values().map(|solved| solved.node).collect()
    }

    /// Whether two places are known to have different signatures.
    pub(super) fn differ(&self, a: At, b: At) -> bool {
        match (self.get(a), self.get(b)) {
            (Some(a), Some(b)) => a.differs(b),
            _ => false,
        }
    }

    /// Lets go of the densities of coarse nodes around some places that are not near a change. Where a neighbour is not
    /// solved yet they are kept, unless no more are to come.
    pub(super) fn let_go(&mut self, around: &[At], lattice: &Lattice, is_complete: bool) {
        let step = lattice.coarse();
        let reach = NEAR * step;
        let mut asked: Vec<At> = Vec::new();
        for &[column, row] in around {
            let rows = row.saturating_sub(reach)..=(row + reach).min(lattice.last(1));
            asked.extend(rows.step_by(step).map(|row| [column, row]));
        }
        asked.sort_unstable();
        asked.dedup();
        for at in asked {
            if self.is_quiet(at, lattice, is_complete)
                && let Some(solved) = self.0.get_mut(&(at[1], at[0]))
            {
                solved.point = None;
            }
        }
    }

    /// Whether no coarse neighbour within reach has another signature.
    pub(super) fn is_quiet(&self, at: At, lattice: &Lattice, is_complete: bool) -> bool {
        let step = lattice.coarse();
        let mut neighbours = (0..2).flat_map(|side| {
            (1..=NEAR).flat_map(move |away| {
                let mut below = at;
                let mut above = at;
                let has_below = at[side] >= away * step;
                below[side] = at[side].saturating_sub(away * step);
                above[side] = at[side] + away * step;
                let has_above = above[side] <= lattice.last(side);
                [(has_below, below), (has_above, above)]
            })
        });
        neighbours.all(|(exists, other)| {
            !exists
                || match self.get(other) {
                    Some(_) => !self.differ(at, other),
                    None => is_complete,
                }
        })
    }
}

impl SolvedNode {
    /// Whether the signatures of two nodes differ, as far as they were seen.
    pub(super) fn differs(&self, other: &Self) -> bool {
        let both: [&[Signature]; 2] = [&self.node.signatures, &other.node.signatures];
        if both.iter().any(|signatures| signatures.is_empty()) {
            return both[0].len() != both[1].len();
        }
        self.node.is_seen && other.node.is_seen && both[0] != both[1]
    }
}

//! Solving the nodes of a map: the coarse grid in strips, then what neighbours that differ ask for, in parts of fixed
//! length. Every strip and part is a session of its own along a path of its own.

use std::ops::RangeInclusive;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};

use rayon::prelude::*;

use super::found::MapNode;
use super::lattice::{At, Lattice, Leaf};
use super::node::{SolvedNode, SolvedNodes};
use super::{MapMaker, MapProgress};
use crate::continuation::curve::CurveWork;
use crate::continuation::levels::measure_of;
use crate::continuation::{Finding, Point, Session, SourceError};

/// Coarse rows of a strip: its first node is solved without a neighbour, and all strips can be solved side by side.
const ROWS: usize = 2;
/// Nodes of a part of a refinement.
const PART: usize = 16;

/// What solves a map, and what is solved.
pub(super) struct Solver<'a> {
    maker: &'a MapMaker<'a>,
    lattice: &'a Lattice,
    grid: Mutex<SolvedNodes>,
    work: Mutex<CurveWork>,
    done: AtomicUsize,
    wanted: AtomicUsize,
}

impl<'a> Solver<'a> {
    pub(super) fn new(maker: &'a MapMaker<'a>, lattice: &'a Lattice) -> Self {
        Self {
            maker,
            lattice,
            grid: Mutex::default(),
            work: Mutex::default(),
            done: AtomicUsize::new(0),
            wanted: AtomicUsize::new(0),
        }
    }

    /// What is solved. A poisoned lock holds nodes as whole as any other.
    pub(super) fn grid(&self) -> MutexGuard<'_, SolvedNodes> {
        self.grid.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// What the solves took so far.
    pub(super) fn work(&self) -> CurveWork {
        *self.work.lock().unwrap_or_else(PoisonError::into_inner)
    }

    pub(super) fn into_nodes(self) -> Vec<MapNode> {
        let grid = self.grid.into_inner();
        grid.unwrap_or_else(PoisonError::into_inner).into_nodes()
    }

    /// Takes nodes that are known already, without their densities. Those that are not of this lattice are left out.
    pub(super) fn recall(&self, known: &[MapNode]) {
        let mut grid = self.grid();
        for node in known {
            let Some(at) = self.lattice.at(self.maker.plane.place(node.values)) else {
                continue;
            };
            let node = MapNode {
                values: self.maker.plane.values(self.lattice.share(at)),
                level: self.lattice.level(at),
                ..node.clone()
            };
            grid.insert(at, SolvedNode { node, point: None });
        }
        let count = grid.all().count();
        self.done.store(count, Ordering::Relaxed);
        self.wanted.store(count, Ordering::Relaxed);
    }

    /// Solves again what was recalled and is near to a change, of places that are `asked`: its densities tell which
    /// indicator's zero to follow.
    fn complete(&self, asked: &dyn Fn(At) -> bool) -> Result<(), SourceError> {
        let wanted: Vec<At> = {
            let grid = self.grid();
            let near = grid.all().filter(|(at, solved)| {
                let is_refined = self.lattice.level(*at) > 0;
                let is_bare = solved.point.is_none() && asked(*at);
                is_bare && (is_refined || !grid.is_quiet(*at, self.lattice, true))
            });
            near.map(|(at, _)| at).collect()
        };
        let parts: Vec<Vec<At>> = wanted.chunks(PART).map(<[At]>::to_vec).collect();
        self.solve_parts(&parts)
    }

    /// Solves some rows of the coarse grid and refines between them; gives the cells that are not halved further. Of
    /// what was recalled, places near changes that are `asked` for are solved again.
    pub(super) fn solve_all(
        &self,
        rows: &RangeInclusive<usize>,
        asked: &dyn Fn(At) -> bool,
    ) -> Result<Vec<Leaf>, SourceError> {
        let mut strips = self.lattice.strips(rows.clone(), ROWS);
        let coarse: Vec<At> = strips.concat();
        {
            let grid = self.grid();
            strips
                .iter_mut()
                .for_each(|strip| strip.retain(|&at| grid.get(at).is_none()));
            strips.retain(|strip| !strip.is_empty());
        }
        self.solve_parts(&strips)?;
        self.grid().let_go(&coarse, self.lattice, true);
        let mut leaves = self.lattice.cells(rows);
        for level in 1..=self.lattice.depth() {
            let least = self.lattice.coarse() >> level;
            loop {
                let (mixed, rest): (Vec<Leaf>, Vec<Leaf>) = leaves
                    .into_iter()
                    .partition(|&leaf| leaf.size > least && self.is_mixed(leaf));
                leaves = rest;
                if mixed.is_empty() || self.maker.cancellation.is_cancelled() {
                    leaves.extend(mixed);
                    break;
                }
                let new = self.open_nodes(&mixed);
                let parts: Vec<Vec<At>> = new.chunks(PART).map(<[At]>::to_vec).collect();
                self.solve_parts(&parts)?;
                leaves.extend(mixed.into_iter().flat_map(Leaf::halves));
            }
        }
        leaves.sort_by_key(|leaf| (leaf.corner[1], leaf.corner[0]));
        self.complete(asked)?;
        Ok(leaves)
    }

    /// Whether signatures differ on the border of a cell.
    fn is_mixed(&self, leaf: Leaf) -> bool {
        let grid = self.grid();
        leaf.border().any(|at| grid.differ(leaf.corner, at))
    }

    /// The places that halving these cells asks for, each near to the one before.
    fn open_nodes(&self, cells: &[Leaf]) -> Vec<At> {
        let mut places: Vec<At> = cells.iter().flat_map(|leaf| leaf.middles()).collect();
        places.sort_unstable();
        places.dedup();
        let grid = self.grid();
        places.retain(|&at| grid.get(at).is_none());
        let mut walked = Vec::with_capacity(places.len());
        let mut here: At = [0, 0];
        while !places.is_empty() {
            let apart = |at: &At| {
                let [x, y] = [0, 1].map(|side| at[side].abs_diff(here[side]));
                x * x + y * y
            };
            let nearest = (0..places.len()).min_by_key(|&index| apart(&places[index]));
            here = places.swap_remove(nearest.unwrap_or(0));
            walked.push(here);
        }
        walked
    }

    /// Solves strips or parts side by side. Asked to stop, it leaves out what is not done.
    fn solve_parts(&self, parts: &[Vec<At>]) -> Result<(), SourceError> {
        let more = parts.iter().map(Vec::len).sum();
        self.wanted.fetch_add(more, Ordering::Relaxed);
        let solved = parts.par_iter().map(|part| self.solve_part(part));
        solved.collect()
    }

    fn solve_part(&self, part: &[At]) -> Result<(), SourceError> {
        let plane = self.maker.plane.afresh();
        let asked = self.maker.levels.map_or(&[][..], |levels| levels.asked);
        let source = self.maker.source_of(&plane, asked)?;
        let mut session = source.open(self.maker.cancellation);
        let mut behind = Vec::new();
        for (index, &at) in part.iter().enumerate() {
            if self.maker.cancellation.is_cancelled() {
                break;
            }
            let place = self.lattice.share(at);
            let coordinate = match index {
                0 => plane.begin(place),
                _ => plane.lay(place),
            };
            let method = source.method();
            let Some(solved) = self.solve_node(session.as_mut(), method, at, coordinate) else {
                break;
            };
            let done = self.done.fetch_add(1, Ordering::Relaxed) + 1;
            (self.maker.observer)(&MapProgress::Solved {
                node: &solved.node,
                done,
                wanted: self.wanted.load(Ordering::Relaxed),
            });
            self.grid().insert(at, solved);
            behind.push(at);
            // Now and then: what is let go makes room for what comes.
            if behind.len() == PART || index + 1 == part.len() {
                self.grid().let_go(&behind, self.lattice, false);
                behind.clear();
            }
        }
        Ok(())
    }

    /// A node; `None` where the source was asked to stop.
    fn solve_node(
        &self,
        session: &mut dyn Session,
        method: &'static str,
        at: At,
        coordinate: f64,
    ) -> Option<SolvedNode> {
        let (point, refusal) = Point::solve(session, method, self.maker.detector, coordinate)?;
        let detections = &point.detections;
        let mut work = self.work.lock().unwrap_or_else(PoisonError::into_inner);
        work.count(&point.report);
        drop(work);
        let mut findings = point.report.findings.iter();
        let is_at_rest = findings.any(|one| matches!(one, Finding::PointMass { .. }));
        let at_rest = is_at_rest.then(|| "all mass ends in the fixed point".to_owned());
        let node = MapNode {
            values: self.maker.plane.values(self.lattice.share(at)),
            level: self.lattice.level(at),
            status: point.report.status,
            signatures: detections.iter().map(|one| one.signature).collect(),
            is_seen: detections.iter().all(|one| one.is_seen),
            reason: refusal.map(|error| error.to_string()).or(at_rest),
            numbers: (self.maker.levels.iter())
                .flat_map(|levels| levels.asked)
                .map(|asked| Some(measure_of(&point.report, asked)?.value))
                .collect(),
            findings: point.report.findings.clone(),
        };
        Some(SolvedNode {
            point: Some(point),
            node,
        })
    }
}

//! The curves of a map on which numbers of the steady state are at levels: from each pair of neighbouring nodes between
//! which a number passes its level and no curve does yet, one is followed.

use rayon::prelude::*;

use super::MapMaker;
use super::found::{MapNode, Untraced, UntracedChange};
use super::lattice::{At, Lattice, Leaf};
use super::node::SolvedNodes;
use crate::continuation::SourceError;
use crate::continuation::curve::{
    CurveError, CurveOptions, CurveWork, LevelCurve, distance, follow_level,
};
use crate::system::MeasureLevel;

/// Starts of one level that may fail before its other pairs are not tried.
const MOST_FAILURES: usize = 4;

/// A curve that passes a pair of nodes nearer than this share of their distance is the one between them.
const BETWEEN: f64 = 0.25;

/// A curve that begins nearer to another one than this is that, in sides of the box.
const SAME: f64 = 1e-3;

/// Two neighbouring nodes between which a number passes its level, and about where. Places are shares of the box.
#[derive(Debug, Clone, Copy)]
struct Pair {
    ends: [[f64; 2]; 2],
    at: [f64; 2],
}

/// The curves of all levels, one level after the other, and where one was not met.
pub(super) fn level_curves(
    maker: &MapMaker<'_>,
    options: &CurveOptions,
    (lattice, leaves, nodes): (&Lattice, &[Leaf], &SolvedNodes),
    work: &mut CurveWork,
) -> (Vec<LevelCurve>, Vec<Untraced>) {
    let levels = maker.levels.map_or(&[][..], |levels| levels.asked);
    let found = levels.par_iter().enumerate().map(|(index, asked)| {
        let pairs = pairs(lattice, leaves, nodes, (index, asked.level));
        of_level(maker, options, asked, pairs)
    });
    let found: Vec<(Vec<LevelCurve>, Option<Untraced>)> = found.collect();
    let (curves, untraced): (Vec<Vec<LevelCurve>>, Vec<Option<Untraced>>) =
        found.into_iter().unzip();
    let curves = curves.concat();
    curves.iter().for_each(|curve| work.add(&curve.work));
    (curves, untraced.into_iter().flatten().collect())
}

/// The curves of one level, and what none explains.
fn of_level(
    maker: &MapMaker<'_>,
    options: &CurveOptions,
    asked: &MeasureLevel,
    mut open: Vec<Pair>,
) -> (Vec<LevelCurve>, Option<Untraced>) {
    let mut curves: Vec<LevelCurve> = Vec::new();
    let mut lines: Vec<Vec<[f64; 2]>> = Vec::new();
    let mut failures: Vec<(Pair, String)> = Vec::new();
    let place = |values: [f64; 2]| maker.plane.place(values);
    while failures.len() < MOST_FAILURES && !maker.cancellation.is_cancelled() {
        open.retain(|pair| lines.iter().all(|line| !pair.is_passed_by(line)));
        if open.is_empty() {
            break;
        }
        // The middle one, away from ends of curves.
        let pair = open.remove(open.len() / 2);
        match follow(maker, options, asked, pair.at) {
            Ok(curve) => {
                let points = curve.points.iter().map(|point| place(point.values));
                let line: Vec<[f64; 2]> = points.collect();
                let start = line.get(curve.start).copied().unwrap_or(pair.at);
                if lines.iter().all(|known| distance(known, start) > SAME) {
                    lines.push(line);
                    curves.push(curve);
                }
            }
            Err(CurveError::Source(SourceError::Interrupted)) => break,
            Err(error) => failures.push((pair, error.to_string())),
        }
    }
    failures.retain(|(pair, _)| lines.iter().all(|line| !pair.is_passed_by(line)));
    let untraced = failures.first().map(|(pair, reason)| Untraced {
        of: UntracedChange::Level(asked.clone()),
        pairs: failures.len() + open.len(),
        near: maker.plane.values(pair.at),
        reason: reason.clone(),
    });
    (
        curves,
        untraced.filter(|_| !maker.cancellation.is_cancelled()),
    )
}

fn follow(
    maker: &MapMaker<'_>,
    options: &CurveOptions,
    asked: &MeasureLevel,
    at: [f64; 2],
) -> Result<LevelCurve, CurveError> {
    let plane = maker.plane.afresh();
    let source = maker.source_of(&plane, std::slice::from_ref(asked))?;
    follow_level(
        source.as_ref(),
        &plane,
        (plane.values(at), asked),
        (options, maker.detector.confidence()),
        maker.cancellation,
        &mut |_| (),
    )
}

impl Pair {
    /// Whether a line passes between the two nodes, or as near as between them.
    fn is_passed_by(&self, line: &[[f64; 2]]) -> bool {
        let [[a, b], [c, d]] = self.ends;
        distance(line, self.at) <= BETWEEN * (c - a).hypot(d - b)
    }
}

/// Neighbouring corners of cells between which the number of this place among those asked for passes its level.
fn pairs(
    lattice: &Lattice,
    leaves: &[Leaf],
    nodes: &SolvedNodes,
    (index, level): (usize, f64),
) -> Vec<Pair> {
    let number = |at: At| -> Option<f64> {
        let node: &MapNode = &nodes.get(at)?.node;
        node.numbers.get(index).copied().flatten()
    };
    let edges = leaves.iter().flat_map(|leaf| {
        let [i, j] = leaf.corner;
        let corners = [[i, j], [i + leaf.size, j], [i, j + leaf.size]];
        [[corners[0], corners[1]], [corners[0], corners[2]]]
    });
    let pair = |[a, b]: [At; 2]| {
        let both = [number(a)?, number(b)?];
        let is_ratio = level > 0.0 && both.iter().all(|one| *one > 0.0);
        let over = both.map(|one| match is_ratio {
            true => (one / level).ln(),
            false => one - level,
        });
        let ends = [a, b].map(|at| lattice.share(at));
        let share = over[0] / (over[0] - over[1]);
        let at = [0, 1].map(|k| ends[0][k] + share * (ends[1][k] - ends[0][k]));
        ((over[0] < 0.0) != (over[1] < 0.0)).then_some(Pair { ends, at })
    };
    edges.filter_map(pair).collect()
}

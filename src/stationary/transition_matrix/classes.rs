//! Which cells carry the steady state.
//!
//! Without escape the answer is the closed communicating class. With escape no class is closed, and an edge
//! cell from which every sample escapes has no way to another cell either, yet holds nothing. What decides is
//! how long a class keeps its mass: the *leak* of a class is 1 - (spectral radius of P on it), the share of its
//! mass that leaves it, to other cells or the sink, in one step once it has settled.
//!
//! - The class with the smallest leak *dominates*: mass elsewhere dies out faster, or feeds it. A class that
//!   loses more than [`LARGEST_ESCAPE`] a step holds no steady state; if that goes for all, there is none.
//! - What the dominating class reaches downstream belongs to the quasi-steady state too (P p = λ p there as
//!   well), so the solve runs on both. Without escape nothing is downstream.
//! - Another class is reported beside it if neither reaches the other and it lives about as long: leak at
//!   most [`SIMILAR`] times the dominating one or at most [`SLOW`]. Others vanish while the first stands.

use super::LARGEST_ESCAPE;
use super::chain::SoundMatrix;
use super::components::Components;
use crate::cancellation::{Cancellation, Cancelled};

/// Ratio of leaks up to which two classes live about equally long.
const SIMILAR: f64 = 10.0;

/// Leak per step below which a class is reported however long the dominating one lives.
const SLOW: f64 = 1e-4;

/// Steps that estimate a leak, and the relative change of the estimate at which they stop.
const LEAK_STEPS: usize = 300;
const LEAK_ACCURACY: f64 = 1e-3;

/// A class of cells that holds a (quasi-)steady state of its own, beside others.
#[derive(Debug, Clone, PartialEq)]
pub struct ClassShare {
    /// Number of cells.
    pub cells: usize,
    /// Mean of the centres of the cells, one coordinate an axis.
    pub centre: Vec<f64>,
    /// Number in the cell space of the class's cell that is nearest to `centre`, in cell widths.
    pub representative: usize,
    /// Share of the initial mass that ends here.
    pub share: f64,
    /// Share of its mass that leaves the class in one map step.
    pub escape_per_step: f64,
}

/// What carries the steady state.
pub(super) enum Carrier {
    /// These rows: a class and all it reaches.
    One(Vec<usize>),
    /// Several classes, each with its leak per step and its rows; longest-lived first.
    Several(Vec<(f64, Vec<usize>)>),
    /// No class keeps enough of its mass; the smallest leak per step.
    None(f64),
}

/// A component that may hold a steady state.
#[derive(Debug, Clone, Copy)]
struct Candidate {
    component: u32,
    leak: f64,
    /// Whether `leak` is exact: the same from every cell.
    exact: bool,
}

/// Decides which cells carry the steady state.
pub(super) fn carrier(
    matrix: &SoundMatrix<'_>,
    cancellation: &Cancellation,
) -> Result<Carrier, Cancelled> {
    let components = Components::of(matrix);
    let leaks = leak_of_cells(matrix, &components);
    let mut candidates = candidates(&components, &leaks);
    if candidates.len() > 1 {
        refine(matrix, &components, &leaks, &mut candidates, cancellation)?;
    }
    candidates.sort_by(|a, b| {
        a.leak
            .total_cmp(&b.leak)
            .then(a.component.cmp(&b.component))
    });
    let Some(first) = candidates.first() else {
        return Ok(Carrier::None(1.0));
    };
    if first.leak > LARGEST_ESCAPE {
        return Ok(Carrier::None(first.leak));
    }
    let limit = (SIMILAR * first.leak).clamp(SLOW, LARGEST_ESCAPE);
    let links = Links::of(matrix, &components);
    let mut counted: Vec<Candidate> = Vec::new();
    let mut related = vec![false; components.count];
    for candidate in candidates
        .iter()
        .filter(|candidate| candidate.leak <= limit)
    {
        if !related[candidate.component as usize] {
            links.mark_related(candidate.component, &mut related);
            counted.push(*candidate);
        }
    }
    let rows_where = |keep: &dyn Fn(u32) -> bool| -> Vec<usize> {
        (0..matrix.len())
            .filter(|&row| keep(components.of[row]))
            .collect()
    };
    if counted.len() == 1 {
        let reached = links.downstream(first.component);
        let rows = rows_where(&|component| reached[component as usize]);
        return Ok(Carrier::One(rows));
    }
    let class = |candidate: &Candidate| {
        let rows = rows_where(&|component| component == candidate.component);
        (candidate.leak, rows)
    };
    Ok(Carrier::Several(counted.iter().map(class).collect()))
}

/// Probability to leave its component in one step, for each cell.
fn leak_of_cells(matrix: &SoundMatrix<'_>, components: &Components) -> Vec<f64> {
    let mut leaks = matrix.escape.to_vec();
    for row in 0..matrix.len() {
        for (column, value) in matrix.row(row) {
            if components.of[column] != components.of[row] {
                leaks[column] += value;
            }
        }
    }
    leaks
}

/// Components whose leak may be the smallest or small enough; a leak lies between its cells' extremes.
fn candidates(components: &Components, leaks: &[f64]) -> Vec<Candidate> {
    let mut bounds = vec![(f64::INFINITY, 0.0_f64); components.count];
    for (&component, &leak) in components.of.iter().zip(leaks) {
        let (lowest, highest) = &mut bounds[component as usize];
        *lowest = lowest.min(leak);
        *highest = highest.max(leak);
    }
    let best = bounds.iter().map(|bound| bound.1).fold(1.0, f64::min);
    let limit = (SIMILAR * best).max(SLOW);
    let candidate = |(component, &(lowest, highest)): (usize, &(f64, f64))| Candidate {
        component: component as u32,
        leak: lowest,
        exact: lowest == highest,
    };
    let all = bounds.iter().enumerate().map(candidate);
    all.filter(|candidate| candidate.leak <= limit).collect()
}

/// Replaces bounds by estimates: power iteration on each candidate by itself, all in the same passes, each
/// started from equal masses.
fn refine(
    matrix: &SoundMatrix<'_>,
    components: &Components,
    leaks: &[f64],
    candidates: &mut [Candidate],
    cancellation: &Cancellation,
) -> Result<(), Cancelled> {
    let mut slot = vec![usize::MAX; components.count];
    for (index, candidate) in candidates.iter().enumerate() {
        if !candidate.exact {
            slot[candidate.component as usize] = index;
        }
    }
    let rows: Vec<usize> = (0..matrix.len())
        .filter(|&row| slot[components.of[row] as usize] != usize::MAX)
        .collect();
    let mut mass: Vec<f64> = vec![0.0; matrix.len()];
    rows.iter().for_each(|&row| mass[row] = 1.0);
    for _ in 0..LEAK_STEPS {
        cancellation.check()?;
        let mut totals = vec![(0.0, 0.0); candidates.len()];
        for &row in &rows {
            let (total, lost) = &mut totals[slot[components.of[row] as usize]];
            *total += mass[row];
            *lost += mass[row] * leaks[row];
        }
        let mut settled = true;
        for (candidate, (total, lost)) in candidates.iter_mut().zip(&totals) {
            if !candidate.exact && *total > 0.0 {
                let leak = lost / total;
                settled &= (leak - candidate.leak).abs() <= LEAK_ACCURACY * leak;
                candidate.leak = leak;
            }
        }
        if settled || is_decided(candidates) {
            return Ok(());
        }
        let mut next = vec![0.0; matrix.len()];
        for &row in &rows {
            let component = components.of[row];
            let inside = matrix
                .row(row)
                .filter(|entry| components.of[entry.0] == component);
            let inflow: f64 = inside.map(|(column, value)| value * mass[column]).sum();
            next[row] = inflow / totals[slot[component as usize]].0.max(f64::MIN_POSITIVE);
        }
        mass = next;
    }
    Ok(())
}

/// Whether one class lives so much longer than the others that better estimates change nothing.
fn is_decided(candidates: &[Candidate]) -> bool {
    let (mut least, mut second) = (f64::INFINITY, f64::INFINITY);
    for candidate in candidates {
        second = second.min(candidate.leak.max(least));
        least = least.min(candidate.leak);
    }
    second > SIMILAR * (SIMILAR * least).max(SLOW)
}

/// Edges between components, in the order of their ends.
struct Links {
    /// (from, to), from < to, sorted.
    forward: Vec<(u32, u32)>,
    count: usize,
}

impl Links {
    fn of(matrix: &SoundMatrix<'_>, components: &Components) -> Self {
        let mut forward = Vec::new();
        for row in 0..matrix.len() {
            let to = components.of[row];
            let sources = matrix.row(row).map(|(column, _)| components.of[column]);
            forward.extend(sources.filter(|&from| from != to).map(|from| (from, to)));
        }
        forward.sort_unstable();
        forward.dedup();
        Self {
            forward,
            count: components.count,
        }
    }

    /// Marks a component and all it reaches. Sorted edges go from smaller to larger numbers: one pass.
    fn downstream(&self, component: u32) -> Vec<bool> {
        let mut reached = vec![false; self.count];
        reached[component as usize] = true;
        for &(from, to) in &self.forward {
            reached[to as usize] |= reached[from as usize];
        }
        reached
    }

    /// Marks a component, all it reaches and all that reach it.
    fn mark_related(&self, component: u32, related: &mut [bool]) {
        let mut reaching = vec![false; self.count];
        reaching[component as usize] = true;
        for &(from, to) in self.forward.iter().rev() {
            reaching[from as usize] |= reaching[to as usize];
        }
        let reached = self.downstream(component);
        for (mark, (up, down)) in related.iter_mut().zip(reaching.iter().zip(reached)) {
            *mark |= *up || down;
        }
    }
}

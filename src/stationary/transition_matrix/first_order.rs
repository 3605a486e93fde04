//! How a steady state changes with its cell map, to first order: what an estimate of sampling errors needs of the
//! cell map without a group of its samples, at a small part of the cost of solving that.
//!
//! Where the map P becomes P + R and the steady state p becomes p + δ, P δ + R p = λ δ + dλ p, Σ δ = 0 but for what
//! is of second order. With N v = (P v - p Σ P v)/λ this is (I - N) δ = (R p - p Σ R p)/λ, which GMRES solves in
//! the norm Σ v²/p, in which modes of a reversible chain are orthogonal: smoothing by one application of the map
//! leaves the few slow modes, for each of which it takes a step or two.

use crate::cancellation::{Cancellation, Cancelled};
use crate::sampling::{GROUPS_AT_ONCE, Linearised, OfGroups};
use crate::stationary::hessenberg::Triangle;

/// Reduction of the smoothed residual at which a change is known well enough to estimate an error by.
const REDUCTION: f64 = 1e-3;

/// Most applications of the map, each of which leaves a vector of the masses' size for each group.
pub(crate) const MOST_APPLICATIONS: usize = 40;

/// Share of a vector that may be left by making it orthogonal to others before it is taken for rounding.
const ROUNDING: f64 = 1e-12;

/// Changes of the masses of the sampled cells without each of some groups.
pub(crate) struct Changed {
    /// By group; `None` where the change was not found.
    pub(crate) by_group: [Option<Vec<f64>>; GROUPS_AT_ONCE],
    /// Applications of the map, each for all of these groups.
    pub(crate) applications: usize,
}

/// Changes without the groups from `first` on. `escape_per_step` is what the steady state loses in a map step.
///
/// # Errors
/// [`Cancelled`].
pub(crate) fn without_groups(
    map: &Linearised<'_>,
    first: usize,
    escape_per_step: f64,
    cancellation: &Cancellation,
) -> Result<Changed, Cancelled> {
    let scaled = Scaled::new(map, 1.0 - escape_per_step);
    let mut start = map.without(first);
    scaled.close(&mut start);
    let mut basis = vec![scaled.apply(&start)];
    let sizes = roots(&products(&basis[0], &basis[0]));
    divide(&mut basis[0], &sizes);
    let mut triangles = sizes.map(Triangle::new);
    // A group that changes nothing is known at once.
    let mut is_known = sizes.map(|size| size == 0.0);
    let mut applications = 1;
    while !is_known.iter().all(|&known| known) && applications < MOST_APPLICATIONS {
        cancellation.check()?;
        let latest = &basis[basis.len() - 1];
        let mut next = scaled.apply(latest);
        applications += 1;
        // The operator is I - N.
        for (value, own) in next.iter_mut().flatten().zip(latest.iter().flatten()) {
            *value = own - *value;
        }
        let before = roots(&products(&next, &next));
        let mut columns = [const { Vec::new() }; GROUPS_AT_ONCE];
        for vector in &basis {
            let overlap = products(&next, vector);
            subtract(&mut next, &overlap, vector);
            for (column, overlap) in columns.iter_mut().zip(overlap) {
                column.push(overlap);
            }
        }
        let mut lengths = roots(&products(&next, &next));
        for (group, column) in columns.into_iter().enumerate() {
            if is_known[group] {
                lengths[group] = 0.0;
                continue;
            }
            if lengths[group] <= ROUNDING * before[group] {
                lengths[group] = 0.0;
            }
            let remaining = triangles[group].push(column, lengths[group]);
            is_known[group] = remaining <= REDUCTION * sizes[group];
        }
        divide(&mut next, &lengths);
        basis.push(next);
    }
    let weights = triangles.map(|triangle| triangle.solve().0);
    for (number, vector) in basis.iter().enumerate() {
        let of_vector: OfGroups =
            std::array::from_fn(|group| -weights[group].get(number).copied().unwrap_or(0.0));
        subtract(&mut start, &of_vector, vector);
    }
    let change = |group: usize| -> Option<Vec<f64>> {
        let values = start.iter().zip(&scaled.root);
        let change: Vec<f64> = values.map(|(value, root)| value[group] * root).collect();
        (is_known[group] && change.iter().all(|value| value.is_finite())).then_some(change)
    };
    Ok(Changed {
        by_group: std::array::from_fn(change),
        applications,
    })
}

/// The map for changes over the roots of the masses.
struct Scaled<'a> {
    map: &'a Linearised<'a>,
    root: Vec<f64>,
    staying: f64,
}

impl<'a> Scaled<'a> {
    fn new(map: &'a Linearised<'a>, staying: f64) -> Self {
        Self {
            map,
            root: map.mass().iter().map(|mass| mass.sqrt()).collect(),
            staying,
        }
    }

    /// N, of and to changes over roots.
    fn apply(&self, change: &[OfGroups]) -> Vec<OfGroups> {
        let scaled = change.iter().zip(&self.root);
        let change: Vec<OfGroups> = scaled
            .map(|(of_cell, root)| of_cell.map(|value| value * root))
            .collect();
        let mut sent = self.map.apply(&change);
        self.close(&mut sent);
        sent
    }

    /// From what arrives to changes over roots, without what makes the sum differ from zero.
    fn close(&self, arriving: &mut [OfGroups]) {
        let mut sums = [0.0; GROUPS_AT_ONCE];
        for of_cell in arriving.iter() {
            for (sum, value) in sums.iter_mut().zip(of_cell) {
                *sum += value;
            }
        }
        let cells = arriving
            .iter_mut()
            .zip(self.map.mass().iter().zip(&self.root));
        for (of_cell, (mass, root)) in cells {
            let scale = if *root > 0.0 {
                1.0 / (self.staying * root)
            } else {
                0.0
            };
            for (value, sum) in of_cell.iter_mut().zip(&sums) {
                *value = (*value - mass * sum) * scale;
            }
        }
    }
}

fn products(a: &[OfGroups], b: &[OfGroups]) -> OfGroups {
    let mut sums = [0.0; GROUPS_AT_ONCE];
    for (a, b) in a.iter().zip(b) {
        for group in 0..GROUPS_AT_ONCE {
            sums[group] += a[group] * b[group];
        }
    }
    sums
}

fn roots(squares: &OfGroups) -> OfGroups {
    squares.map(f64::sqrt)
}

fn subtract(from: &mut [OfGroups], factors: &OfGroups, vector: &[OfGroups]) {
    for (slot, value) in from.iter_mut().zip(vector) {
        for group in 0..GROUPS_AT_ONCE {
            slot[group] -= factors[group] * value[group];
        }
    }
}

/// Divides by lengths; what has none becomes zero.
fn divide(vector: &mut [OfGroups], lengths: &OfGroups) {
    let scale = lengths.map(|length| if length > 0.0 { 1.0 / length } else { 0.0 });
    for of_cell in vector {
        for (value, scale) in of_cell.iter_mut().zip(&scale) {
            *value *= scale;
        }
    }
}

//! The motion on one axis as a birth-and-death chain, with exact masses of its places and exact conductances between
//! neighbours.
//!
//! Without flux p ∝ (1/b²) exp ∫ (2a/b²), and the backward generator is L f = (1/p) (D f')' with D = b² p/2.
//! Functions are sums of φ_i, one at a place and zero at its neighbours, D φ_i' constant between; then ∫ D φ_i'
//! φ_j' is of a chain, and the conductance between neighbours is 1/∫ dx/D. With the load ∫ φ_i p g, L f = -g has
//! the exact f at all places, whatever the barriers between; only where ∫ φ_i φ_j p is taken for a mass at one
//! place, as eigenvalues need it, is there an error, which goes with the square of the distance of places. It is
//! extrapolated from every other place.
//!
//! | part | file |
//! | --- | --- |
//! | how an axis ends, and how its line does | `ends.rs` |
//! | integrals by eight points | `panel.rs` |
//! | how far a line reaches, and its places | `reach.rs` |
//! | masses and conductances, and grids of a line | `mesh.rs` |
//! | means of functions along a line | `mean.rs` |
//! | L f = -g, without subtraction | `solve.rs` |
//! | eigenvalues and functions from a Krylov space | `krylov.rs` |

mod ends;
mod krylov;
mod mean;
mod mesh;
mod panel;
mod reach;
mod solve;
#[cfg(test)]
mod tests;

pub(crate) use ends::AxisEnd;
pub(crate) use krylov::Reduced;
pub(crate) use mesh::Mesh;
pub(crate) use reach::Reach;

/// Number of places of a line for rates, spectra and passages.
pub(crate) const MESH_PLACES: usize = 800;

/// ln of how much less likely than the likeliest states those are at the ends of such a line.
pub(crate) const MESH_DEPTH: f64 = 70.0;

/// Masses of places in their order, and conductances between neighbours: mass times the rate from one to the other.
#[derive(Debug, Clone)]
pub(crate) struct Chain {
    pub(crate) masses: Vec<f64>,
    pub(crate) conductances: Vec<f64>,
}

impl Chain {
    /// The place at which half of the mass is below.
    fn middle(&self) -> usize {
        let half = 0.5 * self.masses.iter().sum::<f64>();
        let mut below = 0.0;
        let place = self.masses.iter().position(|mass| {
            below += mass;
            below >= half
        });
        place.unwrap_or(0)
    }
}

/// A chain made of another one.
pub(crate) struct Grid {
    pub(crate) chain: Chain,
    /// Per place of the other chain the place at or below it, and the share that belongs to the next one; none of what
    /// is left out.
    parts: Vec<Option<(usize, f64)>>,
    /// Which of the other chain's places these are.
    kept: Vec<usize>,
}

impl Grid {
    fn whole(chain: Chain) -> Self {
        let parts = (0..chain.masses.len()).map(|place| Some((place, 0.0)));
        Self {
            parts: parts.collect(),
            kept: (0..chain.masses.len()).collect(),
            chain,
        }
    }

    /// Places that are kept, the first and the last among them. What others have goes to their neighbours as a process
    /// comes to these first.
    fn thinned(whole: &Chain, kept: &[bool]) -> Self {
        let count = kept.len();
        let mut parts = vec![None; count];
        let mut conductances = Vec::new();
        let (mut last, mut number) = (0, 0);
        parts[0] = Some((0, 0.0));
        for place in 1..count {
            if !kept[place] {
                continue;
            }
            let between = &whole.conductances[last..place];
            let resistance: f64 = between.iter().map(|one| one.recip()).sum();
            let mut gone = 0.0;
            let inner = parts[last + 1..place].iter_mut().zip(between);
            for (part, way) in inner {
                gone += way.recip();
                *part = Some((number, gone / resistance));
            }
            conductances.push(resistance.recip());
            number += 1;
            parts[place] = Some((number, 0.0));
            last = place;
        }
        let mut grid = Self {
            chain: Chain {
                masses: vec![0.0; number + 1],
                conductances,
            },
            parts,
            kept: (0..count).filter(|&place| kept[place]).collect(),
        };
        grid.chain.masses = grid.restricted(&whole.masses);
        grid
    }

    /// From one place to another, between walls; masses sum to one again.
    fn shortened(whole: &Chain, (first, last): (usize, usize)) -> Self {
        let kept: f64 = whole.masses[first..=last].iter().sum();
        let part = |place: usize| {
            let is_in = (first..=last).contains(&place);
            is_in.then(|| (place - first, 0.0))
        };
        Self {
            chain: Chain {
                masses: whole.masses[first..=last]
                    .iter()
                    .map(|mass| mass / kept)
                    .collect(),
                conductances: whole.conductances[first..last]
                    .iter()
                    .map(|one| one / kept)
                    .collect(),
            },
            parts: (0..whole.masses.len()).map(part).collect(),
            kept: (first..=last).collect(),
        }
    }

    /// A load on all places as one on these.
    pub(crate) fn restricted(&self, load: &[f64]) -> Vec<f64> {
        let mut own = vec![0.0; self.chain.conductances.len() + 1];
        for (value, part) in load.iter().zip(&self.parts) {
            if let Some((place, share)) = *part {
                own[place] += value * (1.0 - share);
                if share > 0.0 {
                    own[place + 1] += value * share;
                }
            }
        }
        own
    }

    /// The numbers of these places among all.
    pub(crate) fn kept(&self) -> impl Iterator<Item = usize> {
        self.kept.iter().copied()
    }

    /// Values at these places of those at all.
    pub(crate) fn sampled<T: Copy>(&self, values: &[T]) -> Vec<T> {
        self.kept.iter().map(|&place| values[place]).collect()
    }
}

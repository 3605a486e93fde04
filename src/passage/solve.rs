//! The numbers of a passage on one grid, by the scheme and with half of its dissipation.

use std::sync::{Arc, OnceLock};

use super::cells::{PassageCells, cells};
use super::density_start::DensityStart;
use super::exits::Exits;
use super::lasting::Lasting;
use super::masses::Masses;
use super::memory::GridMemory;
use super::moments::{Numbers, moments};
use super::start::add_state;
use super::survival::{Survival, models};
use super::{KnownDensity, Passage, PassageError, Start};
use crate::cancellation::Cancellation;
use crate::generator::{GeneratorError, GeneratorOptions, assemble_with_changes};
use crate::space::CellSpace;
use crate::space::nodes::{FEWER_NODES, NODES};
use crate::stationary::generator::{AbsorbingSolver, AbsorbingWork, RateOptions};
use crate::system::{Enclosed, System};

/// What one grid gives.
pub(super) struct GridNumbers {
    /// With all and with half of the dissipation.
    pub(super) both: [Numbers; 2],
    pub(super) lasting: Lasting,
    pub(super) work: AbsorbingWork,
}

/// What a passage is solved with.
pub(super) struct Question<'a> {
    pub(super) system: &'a Arc<dyn System>,
    /// The cells of the sweep.
    pub(super) space: &'a CellSpace,
    pub(super) passage: &'a Passage,
    pub(super) density: Option<KnownDensity<'a>>,
    pub(super) options: &'a GeneratorOptions,
    pub(super) rates: &'a RateOptions,
    pub(super) cancellation: &'a Cancellation,
    /// The masses of a start that is spread as the density, for all grids.
    pub(super) masses: OnceLock<Result<StartMasses<'a>, GeneratorError>>,
}

/// Negative in the region of a start.
type StartLevel<'a> = Box<dyn Fn(&[f64]) -> f64 + Send + Sync + 'a>;

/// Masses in the region of a start.
type StartMasses<'a> = Masses<'a, StartLevel<'a>>;

impl Question<'_> {
    /// The numbers with all and with half of the dissipation on `factor` times the sweep's cells an axis, and the
    /// density of the rate there, which is looked for from that of another grid on.
    pub(super) fn solve(
        &self,
        factor: f64,
        other: Option<&Lasting>,
        memory: &GridMemory,
    ) -> Result<GridNumbers, PassageError> {
        let until = &self.passage.until;
        let regions = (until, self.passage.exits.as_slice());
        let found = cells(self.system.as_ref(), self.space, regions, factor)?;
        let enclosed = enclosed(self.system, &found);
        let space = found.space;
        let (system, options) = (&enclosed, self.options);
        let (full, border, half) = assemble_with_changes(system, &space, until, options)?;
        let weights =
            |nodes, second: Option<&[f64]>| self.weights(&space, &full.kept, nodes, second);
        let start = weights(NODES, None)?;
        // The other grids are there for differences, and state no errors of their starts.
        let judged = self.density.filter(|_| factor == 1.0);
        let coarse = match factor == 1.0 {
            true => weights(FEWER_NODES, None)?,
            false => start.clone(),
        };
        let mut solver = AbsorbingSolver::new(&space, *self.rates, self.cancellation)
            .rough()
            .free()
            .light(other.is_some_and(|other| other.is_far_from_singular))
            .with_memory(memory.take());
        let cells = (&space, full.kept.as_slice());
        let of_density = match judged {
            Some(density) => DensityStart::new(self.passage, density, self.space, cells)?,
            None => None,
        };
        let starts = [start.as_slice(), &coarse];
        let begun = other.map(|other| other.on(&space, &full.kept));
        let exits = Exits::new(&self.passage.exits, &space);
        let (mut both, lasting) = moments(
            &mut solver,
            ([&full, &half], &border, &exits),
            starts,
            of_density.as_ref(),
            begun,
        )?;
        let (mut work, is_far_from_singular) = (solver.work, solver.is_far_from_singular());
        memory.put(solver.into_memory());
        let groups = self.passage.groups_of_times(&both[0]);
        if !groups.is_empty() {
            let settings = (self.rates, self.cancellation);
            let second = match judged.and_then(|density| density.second()) {
                Some(second) => weights(NODES, Some(&second))?,
                None => start.clone(),
            };
            let starts = [start.as_slice(), &second];
            let mut known: [Vec<Survival>; 2] = [Vec::new(), Vec::new()];
            for &times in &groups {
                let (models, more) = models(&space, [&full, &half], starts, times, settings)?;
                work.add(more);
                for (known, model) in known.iter_mut().zip(models) {
                    known.push(model);
                }
            }
            for (numbers, models) in both.iter_mut().zip(&known) {
                self.passage.add(numbers, &groups, models);
            }
        }
        Ok(GridNumbers {
            both,
            lasting: Lasting::new(space, lasting, is_far_from_singular),
            work,
        })
    }

    /// The weights of the cells at the start, Σ = 1, by polynomials through so many nodes an axis; of a steady state
    /// with other unknowns, if there are any.
    fn weights(
        &self,
        space: &CellSpace,
        kept: &[bool],
        nodes: usize,
        second: Option<&[f64]>,
    ) -> Result<Vec<f64>, PassageError> {
        let mut weights = vec![0.0; space.n_cells()];
        let mass = match &self.passage.start {
            Start::State(state) => {
                let found = self.passage.until.at(state) >= 0.0
                    && space.find(state).is_some()
                    && add_state(space, kept, (state, 1.0), nodes, &mut weights);
                if found { 1.0 } else { 0.0 }
            }
            Start::Density(_) => {
                let density = self.density.ok_or(PassageError::NoDensity)?;
                let target = (space, kept);
                match (second, nodes) {
                    (None, NODES) => {
                        let masses =
                            || masses_of(self.passage, (self.space, density.unknowns), NODES);
                        let masses = self.masses.get_or_init(masses).as_ref();
                        let masses = masses.map_err(Clone::clone)?;
                        masses.add(target, &mut weights)
                    }
                    (second, nodes) => {
                        let unknowns = second.unwrap_or(density.unknowns);
                        let masses = masses_of(self.passage, (self.space, unknowns), nodes)?;
                        masses.add(target, &mut weights)
                    }
                }
            }
        };
        if !(mass > f64::MIN_POSITIVE && mass.is_finite()) {
            return Err(PassageError::Start);
        }
        let total = sum(&weights);
        weights.iter_mut().for_each(|weight| *weight /= total);
        Ok(weights)
    }
}

/// The masses of a density (unknowns of cells) in the region of the start.
fn masses_of<'a>(
    passage: &'a Passage,
    (space, unknowns): (&'a CellSpace, &'a [f64]),
    nodes: usize,
) -> Result<StartMasses<'a>, GeneratorError> {
    let levels = passage.start_levels(space)?;
    let region: StartLevel<'_> = Box::new(|state| passage.start_level(state));
    Ok(Masses::new((space, unknowns), (region, &levels), nodes))
}

fn sum(values: &[f64]) -> f64 {
    values.iter().sum()
}

/// The system between walls at the ends of the cells that are no borders of the target: what would leave the range
/// there comes back sooner or later, and waits on.
pub(super) fn enclosed(system: &Arc<dyn System>, cells: &PassageCells) -> Enclosed {
    let ends = cells.space.axes().iter().zip(&cells.borders);
    let ranges: Vec<(f64, f64)> = ends
        .map(|(axis, &[lower, upper])| {
            let from = if lower {
                f64::NEG_INFINITY
            } else {
                axis.from()
            };
            let to = if upper { f64::INFINITY } else { axis.to() };
            (from, to)
        })
        .collect();
    Enclosed::new(Arc::clone(system), &ranges)
}

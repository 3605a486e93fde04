//! A mesh: places on a line, and the exact masses and conductances between them.

use super::ends::Reached;
use super::panel::{Panel, panels};
use super::{Chain, Grid};
use crate::generator::one_axis::{NODES, Rule, look};
use crate::system::{LANES, System};

/// Share of the way from the middle of the mass to an infinitely far end at which a shorter line ends: where the end
/// decides over a number that changes like one over the square of the length, the shorter line differs by what the
/// longer one is off by.
const SHORTER: f64 = 0.7;

/// Mass that a shorter line may lack, half as many digits as lines have: steep flanks are no part of a length.
const NO_MASS: f64 = 6e-16;

/// What is between two neighbouring places.
pub(super) struct Element {
    pub(super) ends: (f64, f64),
    /// Points, masses that belong to them, and how much of each belongs to the upper place.
    pub(super) points: [f64; NODES],
    pub(super) masses: [f64; NODES],
    shares: [f64; NODES],
    /// ∫ 2a/b² from the first place of the line, less the logarithm of what the density is divided by.
    pub(super) level: f64,
    spread: f64,
}

/// Places on a line, with what is between them.
pub(crate) struct Mesh {
    /// Ascending.
    pub(crate) places: Vec<f64>,
    pub(super) elements: Vec<Element>,
    conductances: Vec<f64>,
    /// Mass that is nearer to an end at which the noise dies than the first and than the last place.
    pub(super) lumps: [f64; 2],
    pub(super) reached: [Reached; 2],
    /// Places that every grid has.
    fixed: Vec<bool>,
    pub(super) rule: Rule,
    /// By what share halves of the elements would change masses and conductances.
    pub(super) error: f64,
}

impl Mesh {
    /// `None` where drift or noise are not finite, or the masses do not sum to a number.
    pub(super) fn new(
        system: &dyn System,
        rule: Rule,
        places: Vec<f64>,
        breaks: &[f64],
        reached: [Reached; 2],
    ) -> Option<Self> {
        let ends: Vec<(f64, f64)> = places.windows(2).map(|pair| (pair[0], pair[1])).collect();
        let panels = panels(system, &rule, &ends)?;
        let mut exponents = vec![0.0];
        for panel in &panels {
            exponents.push(exponents[exponents.len() - 1] + panel.rise);
        }
        let error = change_by_halves(system, &rule, &panels, &ends)?;
        let count = panels.len();
        let lump = |end: usize, panel: &Panel, element: usize| -> f64 {
            let whole: f64 = panel.masses.iter().sum();
            let power_law = |(at, exponent): (f64, f64)| {
                let distances = [ends[element].0, ends[element].1].map(|place| (place - at).abs());
                let ratio = distances[1 - end] / distances[end];
                (whole / (ratio.powf(exponent + 1.0) - 1.0)).ln() + exponents[element]
            };
            reached[end].natural.map_or(f64::NEG_INFINITY, power_law)
        };
        let logs = [
            lump(0, &panels[0], 0),
            lump(1, &panels[count - 1], count - 1),
        ];
        let masses = panels
            .iter()
            .zip(&exponents)
            .map(|(panel, exponent)| panel.masses.iter().sum::<f64>().ln() + exponent);
        let all: Vec<f64> = masses.chain(logs).collect();
        let top = all.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let whole = top + all.iter().map(|log| (log - top).exp()).sum::<f64>().ln();
        if !whole.is_finite() {
            return None;
        }
        let conductances = panels.iter().zip(&exponents).map(|(panel, exponent)| {
            let log = exponent - whole - (2.0 * panel.scale).ln();
            log.clamp(LEAST_LOG, -LEAST_LOG).exp()
        });
        let conductances: Vec<f64> = conductances.collect();
        let elements = panels.iter().zip(&exponents).zip(&ends);
        let elements = elements.map(|((panel, exponent), &ends)| {
            let factor = (exponent - whole).exp();
            Element {
                ends,
                points: panel.points,
                masses: panel.masses.map(|mass| mass * factor),
                shares: panel.scales.map(|scale| scale / panel.scale),
                level: exponent - whole,
                spread: panel.spread,
            }
        });
        let elements: Vec<Element> = elements.collect();
        let lumps = logs.map(|log| (log - whole).exp());
        // Next to an end the density is a power but for a share of the distance, and that has so many digits.
        let of_lump = |end: usize| {
            let place = [places[0], places[count]][end];
            reached[end].natural.map_or(0.0, |(at, _)| {
                let distance = (place - at).abs();
                let shares =
                    distance / (places[count] - places[0]) + f64::EPSILON * at.abs() / distance;
                LUMPED * lumps[end] * shares
            })
        };
        let error = error + of_lump(0) + of_lump(1);
        let is_fixed = |at: &f64| breaks.binary_search_by(|one| one.total_cmp(at)).is_ok();
        Some(Self {
            fixed: places.iter().map(is_fixed).collect(),
            elements,
            conductances,
            lumps,
            places,
            reached,
            rule,
            error,
        })
    }

    /// By what share masses may be off.
    pub(crate) fn error(&self) -> f64 {
        self.error
    }

    /// A number by all of a line, by every other place and by a shorter line, as a value with its error.
    pub(crate) fn extrapolated(&self, [whole, thinned, shorter]: [f64; 3]) -> (f64, f64) {
        let by_places = whole - thinned;
        let of_quadrature = (ROUNDING + 2.0 * self.error) * whole.abs();
        let error = by_places.abs() + (whole - shorter).abs() + of_quadrature;
        (whole + by_places / 3.0, error)
    }

    /// ∫ f p over the functions that are one at a place and zero at its neighbours, one number a place; f is taken in
    /// elements that are wanted alone.
    pub(crate) fn load(
        &self,
        is_wanted: impl Fn(usize) -> bool,
        of: impl Fn(f64) -> f64,
    ) -> Vec<f64> {
        let mut load = vec![0.0; self.places.len()];
        for (index, element) in self.elements.iter().enumerate() {
            if !is_wanted(index) {
                continue;
            }
            for node in 0..NODES {
                let value = element.masses[node] * of(element.points[node]);
                load[index] += value * (1.0 - element.shares[node]);
                load[index + 1] += value * element.shares[node];
            }
        }
        let last = self.places.len() - 1;
        for (lump, (place, element)) in self.lumps.iter().zip([(0, 0), (last, last - 1)]) {
            if *lump > 0.0 && is_wanted(element) {
                load[place] += lump * of(self.places[place]);
            }
        }
        load
    }

    /// A function that is known at the places, between two of them; beyond them that at the last.
    pub(crate) fn at(&self, values: &[f64], place: f64) -> f64 {
        let last = self.places.len() - 1;
        let above = self
            .places
            .partition_point(|one| *one <= place)
            .clamp(1, last);
        let (from, to) = (self.places[above - 1], self.places[above]);
        let share = ((place - from) / (to - from)).clamp(0.0, 1.0);
        values[above - 1] * (1.0 - share) + values[above] * share
    }

    /// The density of the system at the places, but for the last one, where no element begins.
    pub(crate) fn densities(&self, system: &dyn System) -> Vec<f64> {
        let batches = self.elements.chunks(LANES);
        let all = batches.flat_map(|batch| {
            let mut places = [batch[0].ends.0; LANES];
            let begins = places.iter_mut().zip(batch);
            begins.for_each(|(place, element)| *place = element.ends.0);
            let (_, intensity) = look(system, &places);
            let terms = batch.iter().zip(intensity);
            terms.map(|(element, intensity)| element.level.exp() / intensity)
        });
        all.collect()
    }

    /// All of the line as a chain; every other place of it; and what is left of it where its infinitely far ends are
    /// nearer. Numbers by the first are extrapolated by the second, and both differ from it by their errors.
    pub(crate) fn grids(&self) -> [Grid; 3] {
        let whole = Chain {
            masses: self.load(|_| true, |_| 1.0),
            conductances: self.conductances.clone(),
        };
        let count = self.places.len();
        let is_kept = |place: usize| {
            let is_end = place == 0 || place + 1 == count;
            is_end || self.fixed[place] || place.is_multiple_of(2)
        };
        let thinned = Grid::thinned(&whole, &(0..count).map(is_kept).collect::<Vec<_>>());
        let shorter = Grid::shortened(&whole, self.shorter(&whole));
        [Grid::whole(whole), thinned, shorter]
    }

    /// The first and the last place of a line with nearer ends.
    fn shorter(&self, whole: &Chain) -> (usize, usize) {
        let middle = whole.middle();
        let spreads: Vec<f64> = self.elements.iter().map(|element| element.spread).collect();
        let (below, above) = spreads.split_at(middle);
        let last = self.places.len() - 1;
        let within = |spreads: &mut dyn Iterator<Item = f64>, whole: f64| {
            let mut sum = 0.0;
            spreads
                .take_while(|spread| {
                    sum += spread;
                    sum <= SHORTER * whole
                })
                .count()
        };
        let first = match self.reached[0].infinitely_far {
            true => middle - within(&mut below.iter().rev().copied(), below.iter().sum()),
            false => 0,
        };
        let end = match self.reached[1].infinitely_far {
            true => middle + within(&mut above.iter().copied(), above.iter().sum()),
            false => last,
        };
        // States that have next to no mass together.
        let without_mass = |masses: &mut dyn Iterator<Item = &f64>| {
            let mut sum = 0.0;
            masses
                .take_while(|mass| {
                    sum += **mass;
                    sum < NO_MASS
                })
                .count()
        };
        let first = first.min(without_mass(&mut whole.masses.iter()));
        let end = end.max(last - without_mass(&mut whole.masses.iter().rev()).min(last));
        let fixed = |place: &usize| self.fixed[*place];
        let outermost = [(0..=last).find(fixed), (0..=last).rev().find(fixed)];
        (
            first.min(outermost[0].unwrap_or(last).saturating_sub(1)),
            end.max(outermost[1].unwrap_or(0) + 1).min(last),
        )
    }
}

/// What share of all masses and of all resistances would change were every element two: where the noise bends or
/// jumps between places, eight points see it roughly.
fn change_by_halves(
    system: &dyn System,
    rule: &Rule,
    whole: &[Panel],
    ends: &[(f64, f64)],
) -> Option<f64> {
    let halves = ends.iter().flat_map(|&(from, to)| {
        let middle = 0.5 * (from + to);
        [(from, middle), (middle, to)]
    });
    let halves = panels(system, rule, &halves.collect::<Vec<_>>())?;
    let (mut exponent, mut top, mut rises) = (0.0_f64, [f64::NEG_INFINITY; 2], 0.0);
    let (mut sums, mut changes) = ([0.0; 2], [0.0; 2]);
    for (one, two) in whole.iter().zip(halves.chunks_exact(2)) {
        let rise = two[0].rise.exp();
        let integrals = |panel: &Panel| [panel.masses.iter().sum::<f64>(), panel.scale];
        let [[mass, scale], [first, below], [second, above]] =
            [one, &two[0], &two[1]].map(integrals);
        let own = [
            (mass, first + rise * second, exponent),
            (scale, below + above / rise, -exponent),
        ];
        for (slot, (value, halved, level)) in own.into_iter().enumerate() {
            // The highest level is kept, so that nothing overflows.
            let before = (top[slot] - top[slot].max(level)).exp();
            top[slot] = top[slot].max(level);
            let factor = (level - top[slot]).exp();
            sums[slot] = sums[slot] * before + value * factor;
            changes[slot] = changes[slot] * before + (value - halved).abs() * factor;
        }
        rises += (two[0].rise + two[1].rise - one.rise).abs();
        exponent += one.rise;
    }
    Some(rises + changes[0] / sums[0] + changes[1] / sums[1])
}

/// Rounding of a number that some thousand places have a part in.
const ROUNDING: f64 = 1e-11;

/// What is nearer to an end than the first place is off by so many of the shares by which it is no power.
const LUMPED: f64 = 4.0;

/// Logarithm of the least conductance, and of the inverse of the largest.
const LEAST_LOG: f64 = -600.0;

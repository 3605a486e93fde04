//! How far a line reaches, and where its places are.
//!
//! Noise spreads states by the same amount everywhere in the coordinate ∫ dx/b (J. Lamperti, 1964). Half of the places
//! are even in it, from one end of the line to the other; the other half are so with a weight, the fourth root of the
//! density, and serve what happens where states are. An end at which the noise dies is neared by halves, and a line
//! goes on beyond an open end of the range until hardly anything is there.

use super::ends::{AxisEnd, Reached, STEP};
use super::mesh::Mesh;
use super::panel::{Panel, panels};
use crate::generator::one_axis::{Rule, look, surfaces};
use crate::space::Axis;
use crate::system::{LANES, System};

/// Intervals of the range, at least, on which its places are laid out.
const INTERVALS: usize = 128;
/// Steps beyond the range, at most: distances of 1e30 of the range.
const MOST_STEPS: usize = 400;
/// Halvings of the distance to an end at which the noise dies, at most.
const MOST_HALVINGS: usize = 200;
/// Share of an end's coordinate below which distances to it have lost their digits.
const LOST: f64 = 1e-7;
/// Largest change of the exponent between two places, of which eight points integrate the exponential to ten digits.
const LARGEST_RISE: f64 = 2.0;
/// ln of how much less likely than the likeliest states those of a well may be that is a part of a line.
const DEEPEST: f64 = 600.0;
/// Relative difference of places that are the same.
const SAME: f64 = 1e-14;
/// Share of what is between two places at which a third one takes the place of one of them.
const NEXT: f64 = 1e-6;
/// Rise of a density outward that is no rounding.
const RISING: f64 = 1e-6;
/// Ratio of ∫ dx/b over one halving to that over the one before, from which on an end is infinitely far.
const INFINITELY_FAR: f64 = 0.9;

/// A system on an axis whose ends are known.
pub(crate) struct Reach<'a> {
    /// One axis, and no period.
    pub(crate) system: &'a dyn System,
    /// Its range.
    pub(crate) axis: &'a Axis,
    /// The lower and the upper end.
    pub(crate) ends: [AxisEnd; 2],
    /// The mean of the coordinate, from which distances beyond the range are.
    pub(crate) mean: f64,
}

/// Places with what is between them.
struct Skeleton {
    places: Vec<f64>,
    panels: Vec<Panel>,
}

impl Reach<'_> {
    /// The line with about so many places, to where the density is exp(-depth) of what it is at most, with places on
    /// all `breaks`; `None` where it has no end: the density rises beyond the range, or the equations end there.
    pub(crate) fn mesh(&self, count: usize, depth: f64, breaks: &[f64]) -> Option<Mesh> {
        self.finer_mesh(count, depth, breaks, &[])
    }

    /// The same with some more places inside the range, which not every grid of the line has. Where there are such,
    /// they and those that the line has by itself are among every other place.
    pub(crate) fn finer_mesh(
        &self,
        count: usize,
        depth: f64,
        breaks: &[f64],
        more: &[f64],
    ) -> Option<Mesh> {
        let rule = Rule::new();
        let mut known: Vec<f64> = surfaces(self.system);
        known.extend_from_slice(breaks);
        known.sort_by(f64::total_cmp);
        known.dedup_by(|one, other| (*one - *other).abs() <= SAME * one.abs().max(other.abs()));
        let (mut skeleton, mut reached) = self.within(&rule, (&known, more), depth)?;
        let top = skeleton.top();
        for (end, reached) in reached.iter_mut().enumerate() {
            if self.ends[end] == AxisEnd::Open {
                reached.infinitely_far = true;
                reached.open_from =
                    Some(skeleton.extend(self, &rule, (end, &known), top - depth)?);
            }
        }
        skeleton.prune(top - depth.max(DEEPEST), &known, &reached);
        let places = skeleton.divided(count, !more.is_empty());
        Mesh::new(self.system, rule, places, &known, reached)
    }

    /// Inside the range.
    fn within(
        &self,
        rule: &Rule,
        (known, more): (&[f64], &[f64]),
        depth: f64,
    ) -> Option<(Skeleton, [Reached; 2])> {
        let parts = INTERVALS.div_ceil(self.axis.count());
        let mut places = Vec::new();
        for edges in self.axis.edges().windows(2) {
            let part = |number| edges[0] + (edges[1] - edges[0]) * number as f64 / parts as f64;
            places.extend((0..parts).map(part));
        }
        places.push(self.axis.to());
        insert(&mut places, more);
        insert(&mut places, known);
        let mut reached = [Reached {
            natural: None,
            open_from: None,
            infinitely_far: false,
        }; 2];
        for (end, reached) in reached.iter_mut().enumerate() {
            if let AxisEnd::Natural(exponent) = self.ends[end] {
                let at = [self.axis.from(), self.axis.to()][end];
                reached.natural = Some((at, exponent)).filter(|one| one.1.is_finite());
                self.near(&mut places, (end, exponent), depth);
            }
        }
        let panels = panels(self.system, rule, &pairs(&places))?;
        let count = panels.len();
        for (end, [first, second]) in [[0, 1], [count - 1, count - 2]].into_iter().enumerate() {
            let is_natural = matches!(self.ends[end], AxisEnd::Natural(_));
            let ratio = panels[first].spread / panels[second].spread;
            reached[end].infinitely_far = is_natural && ratio > INFINITELY_FAR;
        }
        Some((Skeleton { places, panels }, reached))
    }

    /// Replaces the place on an end at which the noise dies by places nearer and nearer to it.
    fn near(&self, places: &mut Vec<f64>, (end, exponent): (usize, f64), depth: f64) {
        if end == 1 {
            places.reverse();
        }
        let (at, width) = (places[0], places[1] - places[0]);
        let (mut fall, mut near) = (0.0, Vec::new());
        for halvings in 1..=MOST_HALVINGS {
            let distance = width * 0.5_f64.powi(halvings as i32);
            let place = at + distance;
            if halvings > 1 && (distance.abs() <= LOST * at.abs() || fall > depth) {
                break;
            }
            let (drift, intensity) = look(self.system, &[place; LANES]);
            if intensity[0].is_nan() || intensity[0] <= 0.0 {
                break;
            }
            fall += std::f64::consts::LN_2
                * match exponent.is_finite() {
                    true => exponent + 1.0,
                    false => (2.0 * drift[0] * distance / intensity[0]).abs(),
                };
            near.push(place);
        }
        near.reverse();
        places.splice(0..1, near);
        if end == 1 {
            places.reverse();
        }
    }
}

impl Skeleton {
    /// ln p at every place, ln of what it is divided by left out; the inner integral is from the first place.
    fn levels(&self) -> Vec<f64> {
        let mut exponent = 0.0;
        let mut levels = Vec::with_capacity(self.places.len());
        for panel in &self.panels {
            levels.push(exponent - panel.log_noise[0]);
            exponent += panel.rise;
        }
        let last = self.panels.last().map_or(0.0, |panel| panel.log_noise[1]);
        levels.push(exponent - last);
        levels
    }

    /// Largest logarithm of the mass between two places.
    fn top(&self) -> f64 {
        let levels = self.levels();
        let widths = self.places.windows(2).map(|pair| (pair[1] - pair[0]).ln());
        let between = levels
            .windows(2)
            .map(|pair| pair[0].max(pair[1]))
            .zip(widths);
        between.fold(f64::NEG_INFINITY, |most, (level, width)| {
            most.max(level + width)
        })
    }

    /// Goes on beyond an open end until the mass there is below exp(least).
    fn extend(
        &mut self,
        reach: &Reach<'_>,
        rule: &Rule,
        (end, known): (usize, &[f64]),
        least: f64,
    ) -> Option<f64> {
        let levels = self.levels();
        let sign = if end == 0 { -1.0 } else { 1.0 };
        let last = if end == 0 { 0 } else { levels.len() - 1 };
        let (mut place, mut level) = (self.places[last], levels[last]);
        let whole = reach.axis.to() - reach.axis.from();
        let mut distance = (sign * (place - reach.mean)).max(0.5 * whole);
        let origin = place - sign * distance;
        for _ in 0..MOST_STEPS {
            if level + distance.ln() < least {
                return Some(origin);
            }
            distance *= STEP;
            let next = origin + sign * distance;
            let (low, high) = (place.min(next), place.max(next));
            let mut stops = vec![low, high];
            insert(&mut stops, known);
            let mut more = panels(reach.system, rule, &pairs(&stops))?;
            let rise: f64 = more.iter().map(|panel| panel.rise).sum();
            let noises = match end {
                0 => [more[0].log_noise[0], more[more.len() - 1].log_noise[1]],
                _ => [more[more.len() - 1].log_noise[1], more[0].log_noise[0]],
            };
            let change = sign * rise - (noises[0] - noises[1]);
            if change.is_nan() || change > RISING {
                return None;
            }
            level += change;
            place = next;
            if end == 0 {
                stops.pop();
                self.places.splice(0..0, stops);
                self.panels.splice(0..0, more);
            } else {
                self.places.extend(stops.drain(1..));
                self.panels.append(&mut more);
            }
        }
        // What does not become less over all of that has no end.
        (level + distance.ln() < levels[last] + (0.5 * whole).ln()).then_some(origin)
    }

    /// Leaves out what is beyond the first and the last place at which the mass is above exp(least), but nothing that
    /// has a break.
    fn prune(&mut self, least: f64, known: &[f64], reached: &[Reached; 2]) {
        let levels = self.levels();
        let is_kept = |index: usize| {
            let (from, to) = (self.places[index], self.places[index + 1]);
            let has_break = known.iter().any(|at| from <= *at && *at <= to);
            has_break || levels[index].max(levels[index + 1]) + (to - from).ln() >= least
        };
        let count = self.panels.len();
        // What a line goes toward it was followed to already.
        let is_followed = |end: usize| {
            let Reached {
                natural, open_from, ..
            } = reached[end];
            natural.is_some() || open_from.is_some()
        };
        let mut kept = (0..count).filter(|&index| is_kept(index));
        let (first, last) = (
            kept.next().unwrap_or(0),
            kept.next_back().unwrap_or(count - 1),
        );
        let first = if is_followed(0) { 0 } else { first };
        let last = if is_followed(1) { count - 1 } else { last };
        self.places = self.places[first..=last + 1].to_vec();
        self.panels.truncate(last + 1);
        self.panels.drain(..first);
    }

    /// The places with more of them between; an odd number where every other place is to hold all of the former, so
    /// that what both lines are off by goes with the square of the distance place by place.
    fn divided(&self, count: usize, is_nested: bool) -> Vec<f64> {
        let levels = self.levels();
        // The density over ∫ dx/b.
        let log_densities: Vec<f64> = (self.panels.iter().zip(levels.windows(2)))
            .map(|(panel, pair)| {
                0.5 * (pair[0] + pair[1]) + 0.25 * (panel.log_noise[0] + panel.log_noise[1])
            })
            .collect();
        let most = log_densities
            .iter()
            .copied()
            .fold(f64::NEG_INFINITY, f64::max);
        let weights = log_densities
            .iter()
            .map(|level| (0.25 * (level - most)).exp());
        let weights: Vec<f64> = weights.collect();
        let whole: f64 = self.panels.iter().map(|panel| panel.spread).sum();
        let pairs = self.panels.iter().zip(&weights);
        let weighted: f64 = pairs.map(|(panel, weight)| panel.spread * weight).sum();
        let half = 0.5 * count as f64;
        let mut places = Vec::with_capacity(count + self.places.len());
        for (index, panel) in self.panels.iter().enumerate() {
            let share = panel.spread * (1.0 / whole + weights[index] / weighted);
            let wanted = (half * share).max(panel.variation / LARGEST_RISE);
            let parts = wanted.ceil().clamp(1.0, count as f64) as usize;
            let parts = parts + usize::from(is_nested && !parts.is_multiple_of(2));
            let (from, to) = (self.places[index], self.places[index + 1]);
            let part = |number| from + (to - from) * number as f64 / parts as f64;
            places.extend((0..parts).map(part));
        }
        places.extend(self.places.last());
        places
    }
}

fn pairs(places: &[f64]) -> Vec<(f64, f64)> {
    places.windows(2).map(|pair| (pair[0], pair[1])).collect()
}

/// Puts places between others. One that is next to another one, beside what is between others, takes its place: nothing
/// is to be narrower than rounding.
fn insert(places: &mut Vec<f64>, more: &[f64]) {
    for &at in more {
        let above = places.partition_point(|place| *place <= at);
        if above == 0 || above == places.len() {
            continue;
        }
        let (low, high) = (places[above - 1], places[above]);
        let near = NEXT * (high - low);
        if at - low <= near && (above > 1 || low == at) {
            places[above - 1] = at;
        } else if high - at <= near && above + 1 < places.len() {
            places[above] = at;
        } else {
            places.insert(above, at);
        }
    }
}

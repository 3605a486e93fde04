//! Means and standard deviations of functions of the coordinate over a line.

use super::ends::STEP;
use super::mesh::Mesh;
use super::panel::{Panel, panels};
use crate::generator::one_axis::{NODES, legendre};
use crate::system::System;

/// Share of an integral that the last coefficients of an element may have before it is halved.
const ROUGH: f64 = 1e-10;
/// Most times that an element is halved.
const MOST_HALVINGS: usize = 24;
/// Ratio of what one step toward an end adds to what the one before did, from which on sums are not known to end.
const ENDLESS: f64 = 0.998;

/// Growth over a halving of the distance to an end by which a function is the same there.
const EVEN: f64 = 1e-6;

/// A mean over a line, with its error.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct MeshMean {
    pub(crate) value: f64,
    /// E |f|.
    pub(crate) size: f64,
    /// Infinite where what lies beyond the ends does not sum to a number, or is not known to.
    pub(crate) error: f64,
    /// Whether that is so at each end.
    pub(crate) endless: [bool; 2],
}

/// An integral over an element, or over some beside each other.
struct Integral {
    integral: f64,
    size: f64,
    error: f64,
    /// What is integrated at both ends, by the polynomials there, and the width from each end to the nearest point.
    ends: [(f64, f64); 2],
}

impl Integral {
    /// What may be between the last point of a part and the first one of the next, where their polynomials differ.
    fn between(&self, next: &Self) -> f64 {
        let ((own, width), (other, next_width)) = (self.ends[1], next.ends[0]);
        (own - other).abs() * (width + next_width)
    }
}

impl Mesh {
    /// E f, of a function that may be infinite or nothing at single places.
    pub(crate) fn mean(
        &self,
        system: &dyn System,
        of: &dyn Fn(&[f64; NODES]) -> [f64; NODES],
    ) -> MeshMean {
        let rough: Vec<Integral> = self
            .elements
            .iter()
            .map(|element| {
                let width = element.ends.1 - element.ends.0;
                self.part(width, &of(&element.points), &element.masses)
            })
            .collect();
        let whole: f64 = rough.iter().map(|part| part.size).sum();
        let tolerance = ROUGH * whole / rough.len() as f64;
        let parts = rough
            .into_iter()
            .zip(&self.elements)
            .map(|(part, element)| {
                if part.error <= tolerance {
                    return part;
                }
                let known = (element.level, element.ends);
                self.halved(system, of, known, (part, tolerance), MOST_HALVINGS)
            });
        let parts: Vec<Integral> = parts.collect();
        let sums = |of: fn(&Integral) -> f64| parts.iter().map(of).sum::<f64>();
        let (mut value, mut error) = (sums(|part| part.integral), sums(|part| part.error));
        error += ROUNDING * whole;
        let neighbours = parts.windows(2).map(|pair| pair[0].between(&pair[1]));
        error += neighbours.sum::<f64>();
        let mut endless = [false; 2];
        for (end, endless) in endless.iter_mut().enumerate() {
            let Some((last, before)) = self.last_steps(end, &parts) else {
                continue;
            };
            let ratio = if last > 0.0 { last / before } else { 0.0 };
            let rest = last * ratio / (1.0 - ratio);
            // By how much the function grows from one halving of the distance to the next.
            let growth = self.reached[end]
                .natural
                .map_or(f64::INFINITY, |(_, exponent)| {
                    ratio * (exponent + 1.0).exp2()
                });
            let is_even = (growth - 1.0).abs() < EVEN;
            *endless = !is_even && (ratio > ENDLESS || !rest.is_finite());
            let place = if end == 0 { 0 } else { self.places.len() - 1 };
            let there = of(&[self.places[place]; NODES])[0];
            if self.lumps[end] > 0.0 {
                // Of a function that goes like a power of the distance, and as if it were the same all over.
                let even = self.lumps[end] * there;
                let by_power = if is_even { even } else { rest.copysign(there) };
                value += if by_power.is_finite() { by_power } else { even };
                error += (by_power - even).abs();
            } else {
                error += rest;
            }
        }
        if endless != [false; 2] {
            error = f64::INFINITY;
        }
        MeshMean {
            value,
            size: whole,
            error: if error.is_nan() { f64::INFINITY } else { error },
            endless,
        }
    }

    /// From values and masses at the points of an element.
    fn part(&self, width: f64, values: &[f64; NODES], masses: &[f64; NODES]) -> Integral {
        let terms = values.iter().zip(masses);
        // Where there is no mass, nothing is.
        let terms = terms.map(|(value, mass)| if *mass > 0.0 { value * mass } else { 0.0 });
        let mut products = [0.0; NODES];
        products
            .iter_mut()
            .zip(terms)
            .for_each(|(slot, term)| *slot = term);
        let mut coefficients = [0.0; NODES];
        for (point, product) in self.rule.points.iter().zip(products) {
            let polynomials = legendre(2.0 * point - 1.0);
            for (n, slot) in coefficients.iter_mut().enumerate() {
                *slot += (2 * n + 1) as f64 * product * polynomials[n];
            }
        }
        let near = self.rule.points[0] * width;
        let ends = [-1.0, 1.0].map(|sign: f64| {
            let terms = coefficients.iter().enumerate();
            let sum: f64 = terms.map(|(n, one)| one * sign.powi(n as i32)).sum();
            (sum / width, near)
        });
        Integral {
            integral: products.iter().sum(),
            size: products.iter().map(|one| one.abs()).sum(),
            error: coefficients[NODES - 2].abs() + coefficients[NODES - 1].abs(),
            ends,
        }
    }

    /// The same by halves of an element, and by halves of these, until they are smooth.
    fn halved(
        &self,
        system: &dyn System,
        of: &dyn Fn(&[f64; NODES]) -> [f64; NODES],
        (level, (from, to)): (f64, (f64, f64)),
        (known, tolerance): (Integral, f64),
        halvings: usize,
    ) -> Integral {
        let middle = 0.5 * (from + to);
        if halvings == 0 || middle <= from || middle >= to {
            return known;
        }
        let halves = [(from, middle), (middle, to)];
        let Some(two) = panels(system, &self.rule, &halves) else {
            return known;
        };
        let mut level = level;
        let mut done: Option<Integral> = None;
        for (
            Panel {
                points,
                masses,
                rise,
                ..
            },
            ends,
        ) in two.iter().zip(halves)
        {
            let factor = level.exp();
            let masses = masses.map(|mass| mass * factor);
            let mut part = self.part(ends.1 - ends.0, &of(points), &masses);
            if part.error > tolerance {
                part = self.halved(system, of, (level, ends), (part, tolerance), halvings - 1);
            }
            level += rise;
            done = Some(match done {
                None => part,
                Some(first) => Integral {
                    integral: first.integral + part.integral,
                    size: first.size + part.size,
                    error: first.error + part.error + first.between(&part),
                    ends: [first.ends[0], part.ends[1]],
                },
            });
        }
        done.unwrap_or(known)
    }

    /// How much lies in the last step toward an end, and in the one before, where steps are even in the logarithm of
    /// the distance: halves of that to an end at which the noise dies, or quarters of doublings beyond the range;
    /// `None` at a wall.
    fn last_steps(&self, end: usize, parts: &[Integral]) -> Option<(f64, f64)> {
        let count = self.elements.len();
        let place = if end == 0 { 0 } else { count };
        let at = self.places[place];
        let (origin, factor) = match (self.reached[end].natural, self.reached[end].open_from) {
            (Some((natural, _)), _) => (natural, 2.0),
            (None, Some(origin)) => (origin, STEP.recip()),
            (None, None) => return None,
        };
        let edges = [1, 2].map(|steps| origin + (at - origin) * f64::powi(factor, steps));
        let mut sums = [0.0; 2];
        for (part, element) in parts.iter().zip(&self.elements) {
            let middle = 0.5 * (element.ends.0 + element.ends.1);
            let is_within = |edge: f64| (middle - edge) * (at - edge) > 0.0;
            if is_within(edges[0]) {
                sums[0] += part.size;
            } else if is_within(edges[1]) {
                sums[1] += part.size;
            }
        }
        Some((sums[0], sums[1]))
    }

    /// Power with which the density falls at an open end, from one step of the distance to the next.
    pub(crate) fn fall(&self, end: usize) -> Option<f64> {
        let parts = self.elements.iter().map(|element| Integral {
            integral: 0.0,
            size: element.masses.iter().sum(),
            error: 0.0,
            ends: [(0.0, 0.0); 2],
        });
        let parts: Vec<Integral> = parts.collect();
        let (last, before) = self.last_steps(end, &parts)?;
        let power = 1.0 - (last / before).ln() / STEP.ln();
        (self.reached[end].open_from.is_some() && last > 0.0).then_some(power)
    }
}

/// Rounding of a sum over some thousand points, relative to the sum of their sizes.
const ROUNDING: f64 = 1e-12;

//! Splitting of an oscillator's step: positions move with their velocities, and everything else moves where the
//! positions stand.
//!
//! Half a step of the positions, a step of Heun's of the rest, half a step of the positions again (Strang 1968) is
//! symmetric: an undamped oscillator keeps its energy for all time up to a ripple of the order of (ω dt)², and of a
//! damped one no damping is taken. With noise this is the scheme called ABOBA (B. Leimkuhler and C. Matthews,
//! *Molecular Dynamics*, 2015, chapter 7). Its steady state is that of the equation in the positions of a linear
//! oscillator, while velocities are too fast by the factor 1 + (ω dt)²/8. That is taken away, before and after many
//! steps, by what is called a postprocessor (G. Vilmart, SIAM J. Sci. Comput. 37, A201 (2015)): with positions x, the
//! rest y and drifts F, it takes y to y + (dt²/8) ∂F_y/∂x F_x.

use std::borrow::Cow;

use super::Stepper;
use crate::MAX_DIMENSION;
use crate::sampling::random::OnLines;
use crate::system::{DISPLACEMENT, LANES, Lanes, System, VELOCITY};

/// A coordinate without noise whose drift is a multiple of another coordinate and a constant: a displacement, or a
/// phase. The other one is no position.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Position {
    pub(crate) axis: usize,
    /// Axis of the velocity; its own where the drift is constant.
    velocity: usize,
    factor: f64,
    constant: f64,
}

impl Position {
    /// The displacement of an oscillator, which moves with its velocity.
    pub(super) const DISPLACEMENT: Self = Self {
        axis: DISPLACEMENT,
        velocity: VELOCITY,
        factor: 1.0,
        constant: 0.0,
    };

    #[inline(always)]
    pub(super) fn advance(&self, states: &mut [Lanes], time: f64) {
        let (factor, constant) = (time * self.factor, time * self.constant);
        match states.get_disjoint_mut([self.axis, self.velocity]) {
            Ok([x, velocity]) => {
                for lane in 0..LANES {
                    x[lane] += factor * velocity[lane] + constant;
                }
            }
            // The drift is constant.
            Err(_) => {
                for x in &mut states[self.axis] {
                    *x += constant;
                }
            }
        }
    }
}

/// Relative difference of a drift from a line that is rounding.
const ROUNDING: f64 = 1e-12;

/// The positions of a system, found by trying its drift at states of many sizes and at two times.
pub(crate) fn positions(system: &dyn System) -> Vec<Position> {
    let dimension = system.dimension();
    let states: Vec<Lanes> = (0..dimension).map(tried).collect();
    let mut drifts = [0.0, 0.37].map(|time| {
        let mut drift = vec![[0.0; LANES]; dimension];
        system.drift(time, &states, &mut drift);
        drift
    });
    let [drift, later] = &mut drifts;
    let mut found: Vec<Position> = Vec::new();
    for axis in 0..dimension {
        let is_noisy = system.noises().iter().any(|noise| noise.axis == axis);
        if is_noisy || drift[axis] != later[axis] {
            continue;
        }
        let of_other = |other: usize| line(&states[other], &drift[axis]).map(|line| (other, line));
        let others = (0..dimension).filter(|&other| other != axis);
        let Some((velocity, (factor, constant))) = others.filter_map(of_other).next() else {
            continue;
        };
        let velocity = if factor == 0.0 { axis } else { velocity };
        let is_apart = |one: &Position| one.axis != velocity && one.velocity != axis;
        if found.iter().all(is_apart) {
            found.push(Position {
                axis,
                velocity,
                factor,
                constant,
            });
        }
    }
    found
}

/// Coordinates of an axis that are tried: of either sign, from a hundredth to a hundred.
fn tried(axis: usize) -> Lanes {
    std::array::from_fn(|lane| {
        let word = crate::sampling::random::mix((axis * LANES + lane) as u64 + 1);
        let size = 10.0_f64.powf(4.0 * crate::sampling::random::unit(word) - 2.0);
        if word & 1 == 0 { size } else { -size }
    })
}

/// Factor and constant of a drift that is a line in a coordinate, at all states that were tried.
fn line(coordinate: &Lanes, drift: &Lanes) -> Option<(f64, f64)> {
    let factor = (drift[0] - drift[1]) / (coordinate[0] - coordinate[1]);
    let constant = drift[0] - factor * coordinate[0];
    let constant = match constant.abs() <= ROUNDING * drift[0].abs() {
        true => 0.0,
        false => constant,
    };
    let fits = |(x, drift): (&f64, &f64)| {
        let size = (factor * x).abs() + constant.abs() + drift.abs();
        (factor * x + constant - drift).abs() <= ROUNDING * size
    };
    let both = coordinate.iter().zip(drift);
    both.into_iter().all(fits).then_some((factor, constant))
}

/// Turns of the inverse of the postprocessor, each of which leaves the (ω dt)²/8th part of what was there.
const TURNS: usize = 4;

impl Stepper<'_> {
    /// States of the process at states of the steps, which they are themselves where nothing moves apart.
    pub(crate) fn seen<'s>(&self, states: &'s [Lanes]) -> Cow<'s, [Lanes]> {
        if self.positions.is_empty() {
            return Cow::Borrowed(states);
        }
        let (mut seen, mut room) = (states.to_vec(), None);
        self.shift(1.0, states, &mut seen, &mut room);
        self.reflect(&mut seen);
        self.turn_back(&mut seen);
        Cow::Owned(seen)
    }

    /// Takes states of the process to states of the steps.
    pub(crate) fn enter(&self, states: &mut [Lanes]) {
        if self.positions.is_empty() {
            return;
        }
        let (mut rows, mut next) = (OnLines(rows_of(states)), OnLines(rows_of(states)));
        let (entered, next) = (&mut rows.0[..states.len()], &mut next.0[..states.len()]);
        let mut room = None;
        for _ in 0..TURNS {
            next.copy_from_slice(states);
            self.shift(-1.0, entered, next, &mut room);
            entered.copy_from_slice(next);
        }
        states.copy_from_slice(entered);
    }

    /// Adds (dt²/8) ∂F_y/∂x F_x of the rest at states, by a difference over a step of the positions, times a sign.
    fn shift(&self, sign: f64, states: &[Lanes], shifted: &mut [Lanes], room: &mut Option<Room>) {
        if let Some(compiled) = &self.compiled {
            return compiled.shift(self.time_step, sign, states, shifted);
        }
        let Room { moved, up, down } = room.get_or_insert_default();
        let moved = &mut moved[..states.len()];
        for (share, drift) in [(0.5, &mut *up), (-0.5, &mut *down)] {
            moved.copy_from_slice(states);
            self.move_positions(moved, share * self.time_step);
            self.drift_beyond(0.0, moved, &mut drift[..states.len()]);
        }
        for &axis in &self.rest {
            for lane in 0..LANES {
                let shift = 0.125 * self.time_step * (up[axis][lane] - down[axis][lane]);
                shifted[axis][lane] += if shift.is_finite() { sign * shift } else { 0.0 };
            }
        }
    }
}

/// Room for the drift at two states beside one.
struct Room {
    moved: [Lanes; MAX_DIMENSION],
    up: [Lanes; MAX_DIMENSION],
    down: [Lanes; MAX_DIMENSION],
}

impl Default for Room {
    fn default() -> Self {
        let rows = [[0.0; LANES]; MAX_DIMENSION];
        Self {
            moved: rows,
            up: rows,
            down: rows,
        }
    }
}

pub(super) fn rows_of(states: &[Lanes]) -> [Lanes; MAX_DIMENSION] {
    let mut rows = [[0.0; LANES]; MAX_DIMENSION];
    rows[..states.len()].copy_from_slice(states);
    rows
}

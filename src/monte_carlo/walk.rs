//! Paths on their way to the border of a region, a batch at a time, each at an age of its own.
//!
//! Where noise acts on the region's level, a path may have been inside between two states that are outside: of a
//! Brownian bridge that is so with probability exp(-2 a b/dt), with a and b the levels at both ends over the strength
//! of the noise that acts on them there (E. Gobet, Stochastic Processes and their Applications 87, 2000). A path ends
//! when the probability that it has not been inside falls below a random number of its own.
//!
//! The distance from the border is the level over the strength of the noise that acts on it, where that does not depend
//! on the state. Elsewhere the strength is its mean on the way to the border: the border of cos(πθ) > c is where that
//! of |θ| < a is.

use super::batch::{Limits, Purpose, key};
use crate::MAX_DIMENSION;
use crate::sampling::{Stepper, mix, unit};
use crate::space::CellSpace;
use crate::system::{BoundQuantity, LANES, Lanes, System};

/// Distance over which the slope of a level is taken, over the range of an axis.
const SLOPE: f64 = 1e-7;

/// Distance from a border up to which it is looked at how the strength of the noise on the level changes toward it, in
/// standard deviations of a step: what is farther off does not meet it.
const NEAR: f64 = 16.0;

/// Strengths halfway to a border that are so many times larger or smaller are those of another part of it.
const ALIKE: f64 = 2.0;

/// Parts of a turn from one state to the next, along each axis: their multiples are spread evenly over a turn.
const SPREAD: [f64; 4] = [
    0.618_033_988_749_894_8,
    0.414_213_562_373_095_1,
    0.732_050_807_568_877_2,
    0.236_067_977_499_789_7,
];

/// Share by which strengths differ that are the same.
const SAME: f64 = 1e-6;

/// The region at whose border paths end.
#[derive(Debug, Clone, Copy)]
pub struct PassageTarget<'a> {
    /// Its level, negative inside.
    pub until: &'a BoundQuantity,
    /// Parts of it, by their levels: the shares of paths are wanted that enter each.
    pub exits: &'a [BoundQuantity],
}

impl<'a> From<&'a BoundQuantity> for PassageTarget<'a> {
    fn from(until: &'a BoundQuantity) -> Self {
        Self { until, exits: &[] }
    }
}

/// The border of the region.
pub(super) struct Border<'a> {
    system: &'a dyn System,
    pub(super) until: &'a BoundQuantity,
    /// Parts of the region, by their levels.
    exits: &'a [BoundQuantity],
    /// Axes with noise on which the level depends, and how far a state is moved along each to see its slope.
    pub(super) noisy: Vec<(usize, f64)>,
    /// Whether the level depends on one axis alone, so that whatever comes to the other side passes through the region.
    pub(super) is_of_one_axis: bool,
    /// Whether noise acts on the level with the same strength everywhere.
    is_even: bool,
}

/// The level of a region for a batch of states, with what noise does to it.
struct LevelSlopes {
    levels: Lanes,
    /// The root of the variance that noise gives the level per unit of time.
    speeds: Lanes,
    /// One a noisy axis: by how much a state moves along it where noise alone moves it up the level as fast as it can,
    /// times the speed.
    ways: Vec<Lanes>,
}

impl<'a> Border<'a> {
    pub(super) fn new(
        system: &'a dyn System,
        space: &CellSpace,
        PassageTarget { until, exits }: PassageTarget<'a>,
    ) -> Self {
        let axes = space.axes().iter().zip(until.states()).enumerate();
        let noisy = axes.filter(|(axis, (_, matters))| **matters && system.is_noisy(*axis));
        let mut border = Self {
            noisy: noisy
                .map(|(number, (axis, _))| (number, SLOPE * (axis.to() - axis.from())))
                .collect(),
            is_of_one_axis: until.states().iter().filter(|matters| **matters).count() == 1,
            is_even: true,
            system,
            until,
            exits,
        };
        border.is_even = border.is_even_in(space);
        border
    }

    /// Whether noise acts on the level with the same strength in states all over the cells, which take other positions
    /// along each axis.
    fn is_even_in(&self, space: &CellSpace) -> bool {
        let mut states = vec![[0.0; LANES]; space.dimension()];
        let axes = space.axes().iter().zip(SPREAD.iter().cycle());
        for (lanes, (axis, turn)) in states.iter_mut().zip(axes) {
            for (lane, value) in lanes.iter_mut().enumerate() {
                let share = ((lane as f64 + 0.5) * turn).fract();
                *value = axis.nodes()[(share * axis.count() as f64) as usize];
            }
        }
        let speeds = self.slopes(&states).speeds;
        let largest = speeds.iter().copied().fold(0.0, f64::max);
        let least = speeds.iter().copied().fold(f64::INFINITY, f64::min);
        largest - least <= SAME * largest
    }

    /// The part of the region that a path enters which is in a state, or was inside on its way there: the nearest one.
    fn exit(&self, state: &[f64]) -> usize {
        let levels = self.exits.iter().map(|part| part.at(state)).enumerate();
        let least = levels.min_by(|one, other| one.1.total_cmp(&other.1));
        least.map_or(0, |(part, _)| part)
    }

    /// Levels of a batch of states, and the strength of the noise on each on the way to the border: levels over that
    /// are distances, in units of what noise does in a unit of time.
    pub(super) fn at(&self, states: &[Lanes], time_step: f64) -> (Lanes, Lanes) {
        let LevelSlopes {
            levels,
            speeds,
            ways,
        } = self.slopes(states);
        if self.is_even {
            return (levels, speeds);
        }
        let reach = NEAR * time_step.sqrt();
        let steps: Lanes = std::array::from_fn(|lane| {
            let distance = levels[lane] / speeds[lane];
            match distance.abs() < reach {
                true => 0.5 * distance,
                false => 0.0,
            }
        });
        if steps.iter().all(|step| *step == 0.0) {
            return (levels, speeds);
        }
        let mut halfway = states.to_vec();
        for (&(axis, _), way) in self.noisy.iter().zip(&ways) {
            for lane in 0..LANES {
                if steps[lane] != 0.0 {
                    halfway[axis][lane] -= steps[lane] * way[lane] / speeds[lane];
                }
            }
        }
        let there = self.slopes(&halfway).speeds;
        let mean = |lane: usize| match steps[lane] == 0.0 {
            true => speeds[lane],
            false => mean_speed(speeds[lane], there[lane]),
        };
        (levels, std::array::from_fn(mean))
    }

    fn slopes(&self, states: &[Lanes]) -> LevelSlopes {
        let levels = self.until.values(states);
        let mut squares = [0.0; LANES];
        let mut ways = Vec::with_capacity(self.noisy.len());
        let mut moved = match self.noisy.is_empty() {
            true => Vec::new(),
            false => states.to_vec(),
        };
        for &(axis, shift) in &self.noisy {
            moved[axis].iter_mut().for_each(|value| *value += shift);
            let beside = self.until.values(&moved);
            moved[axis] = states[axis];
            let mut way = [0.0; LANES];
            for noise in self.system.noises_on(axis) {
                let amplitudes = noise.amplitudes(0.0, states);
                for lane in 0..LANES {
                    let slope = (beside[lane] - levels[lane]) / shift;
                    squares[lane] += (slope * amplitudes[lane]).powi(2);
                    way[lane] += slope * amplitudes[lane] * amplitudes[lane];
                }
            }
            ways.push(way);
        }
        LevelSlopes {
            levels,
            speeds: squares.map(f64::sqrt),
            ways,
        }
    }
}

/// The mean of the strength of noise on a level on the way to its border, from that at a state and that at half of the
/// way as the first one has it, where the strength changes evenly: the level is a parabola then.
fn mean_speed(here: f64, halfway: f64) -> f64 {
    let is_alike = halfway < ALIKE * here && here < ALIKE * halfway;
    match is_alike {
        true => 0.5 * (here + (here * (4.0 * halfway - 3.0 * here).max(0.0)).sqrt()),
        false => here,
    }
}

/// The random numbers of a path beside its noise.
#[derive(Clone, Copy, Default)]
pub(super) struct Chance {
    /// The path ends when the probability that it has not been inside falls below this.
    pub(super) unmet: f64,
    /// Square of a standard normal, and a uniform number: when within a step it ends.
    square: f64,
    uniform: f64,
}

impl Chance {
    pub(super) fn new(seed: u64, purpose: Purpose, path: u64) -> Self {
        let word = key(seed, purpose, path).word();
        let [unmet, radius, angle, uniform] = [1, 2, 3, 4].map(|n| unit(mix(word.wrapping_add(n))));
        let cosine = (std::f64::consts::TAU * angle).cos();
        Self {
            unmet,
            square: -2.0 * (1.0 - radius).ln() * cosine * cosine,
            uniform,
        }
    }

    /// When, as a share of a step, Brownian motion from a > 0 to -b first meets 0, given that it ends there: `ratio` is
    /// b/a, `spread` its variance over the step as a share of a²; without any it moves evenly. The odds of that share
    /// have an inverse Gaussian distribution, drawn as by J. R. Michael, W. R. Schucany and R. W. Haas, The American
    /// Statistician 30, 1976.
    pub(super) fn crossing(&self, ratio: f64, spread: f64) -> f64 {
        let square = spread * self.square;
        let least = 2.0 / (2.0 * ratio + square + (square * (square + 4.0 * ratio)).sqrt());
        let is_least = self.uniform * (1.0 + ratio * least) <= 1.0;
        let odds = if is_least {
            least
        } else {
            1.0 / (ratio * ratio * least)
        };
        1.0 / (1.0 + 1.0 / odds)
    }
}

/// How a region was met within a step: when it was entered first and left last, as shares of the step.
#[derive(Clone, Copy)]
pub(super) struct Meeting {
    pub(super) first: f64,
    pub(super) last: f64,
}

/// Levels of a region at both ends of a step, over the strength of the noise that acts on them where there is any.
pub(super) struct StepLevels {
    pub(super) before: f64,
    pub(super) after: f64,
    /// The variance that noise gives over the step; zero without.
    variance: f64,
}

impl StepLevels {
    pub(super) fn new(
        (level, speed): (f64, f64),
        (next, next_speed): (f64, f64),
        time_step: f64,
    ) -> Self {
        let is_noisy = speed > 0.0 && next_speed > 0.0;
        let (units, variance) = match is_noisy {
            true => ((speed, next_speed), time_step),
            false => ((1.0, 1.0), 0.0),
        };
        Self {
            before: level / units.0,
            after: next / units.1,
            variance,
        }
    }

    /// The same levels with another one at the end, as the tangent at the beginning has it: where a step passes through
    /// the region, its border is met as if all behind it were inside.
    pub(super) fn onward(&self, (_, speed): (f64, f64), beyond: f64) -> Self {
        let unit = if self.variance > 0.0 { speed } else { 1.0 };
        Self {
            before: self.before,
            after: beyond / unit,
            variance: self.variance,
        }
    }

    /// The same levels with another one at the beginning, as the tangent at the end has it.
    pub(super) fn backward(&self, (_, speed): (f64, f64), beyond: f64) -> Self {
        let unit = if self.variance > 0.0 { speed } else { 1.0 };
        Self {
            before: beyond / unit,
            after: self.after,
            variance: self.variance,
        }
    }

    /// Probability that a path which is outside at both ends was not inside between them.
    pub(super) fn unmet(&self) -> f64 {
        if self.variance > 0.0 {
            -(-2.0 * self.before * self.after / self.variance).exp_m1()
        } else {
            1.0
        }
    }

    /// When the region is entered first, and left last, given that a path meets it.
    pub(super) fn meeting(&self, chance: &Chance) -> Meeting {
        let share = |near: f64, far: f64| match near > 0.0 {
            true => chance.crossing(far.abs() / near, self.variance / (near * near)),
            false => 0.0,
        };
        Meeting {
            first: share(self.before, self.after),
            last: 1.0 - share(self.after, self.before),
        }
    }
}

/// Paths with one time step, all of a batch at different ages.
pub(super) struct Walk<'a> {
    border: &'a Border<'a>,
    stepper: Stepper<'a>,
    time_step: f64,
    states: Vec<Lanes>,
    levels: Lanes,
    speeds: Lanes,
    /// Probability that a path has not been inside between its states.
    unmet: Lanes,
    /// Steps since a path has started.
    ages: [u64; LANES],
    pub(super) going: [bool; LANES],
    /// When it ended; infinite where it did not.
    pub(super) times: Lanes,
    /// Which part of the region it entered then.
    pub(super) exits: [usize; LANES],
}

impl<'a> Walk<'a> {
    pub(super) fn new(border: &'a Border<'a>, stepper: Stepper<'a>, time_step: f64) -> Self {
        Self {
            border,
            stepper,
            time_step,
            states: vec![[0.0; LANES]; border.system.dimension()],
            levels: [0.0; LANES],
            speeds: [0.0; LANES],
            unmet: [1.0; LANES],
            ages: [0; LANES],
            going: [false; LANES],
            times: [f64::INFINITY; LANES],
            exits: [0; LANES],
        }
    }

    pub(super) fn start(&mut self, lane: usize, state: &[f64]) {
        for (lanes, value) in self.states.iter_mut().zip(state) {
            lanes[lane] = *value;
        }
        self.unmet[lane] = 1.0;
        self.ages[lane] = 0;
        self.going[lane] = true;
        self.times[lane] = f64::INFINITY;
    }

    /// Where a path is.
    pub(super) fn state(&self, lane: usize) -> [f64; MAX_DIMENSION] {
        let mut state = [0.0; MAX_DIMENSION];
        for (x, lanes) in state.iter_mut().zip(&self.states) {
            *x = lanes[lane];
        }
        state
    }

    pub(super) fn step(&mut self, normals: &[Lanes], chances: &[Chance; LANES]) {
        let states = self.states.clone();
        self.stepper.advance_with(&mut self.states, 0, 1, normals);
        let before = (self.levels, self.speeds);
        self.look();
        let ends = [states.as_slice(), &self.states];
        let passing = self.border.passing(ends, [&before.0, &self.levels]);
        for (lane, chance) in chances.iter().enumerate() {
            if !self.going[lane] {
                continue;
            }
            let from = (before.0[lane], before.1[lane]);
            let to = (self.levels[lane], self.speeds[lane]);
            let ends = StepLevels::new(from, to, self.time_step);
            self.unmet[lane] *= ends.unmet();
            let passed = passing[lane].as_ref();
            if to.0 < 0.0 || self.unmet[lane] < chance.unmet || passed.is_some() {
                let onward = passed.map(|passed| ends.onward(from, passed.beyond[0]));
                let share = onward.unwrap_or(ends).meeting(chance).first;
                self.going[lane] = false;
                if self.border.exits.len() > 1 {
                    let end = || self.states.iter().map(|lanes| lanes[lane]).collect();
                    let state: Vec<f64> = passed.map_or_else(end, |passed| passed.state.clone());
                    self.exits[lane] = self.border.exit(&state);
                }
                self.times[lane] = (self.ages[lane] as f64 + share) * self.time_step;
            }
            self.ages[lane] += 1;
        }
    }

    /// Looks at the border from where paths are.
    pub(super) fn look(&mut self) {
        (self.levels, self.speeds) = self.border.at(&self.states, self.time_step);
    }

    /// Gives up paths that have gone on for the longest time; says how many have run away.
    pub(super) fn give_up(&mut self, longest: f64, limits: &Limits) -> usize {
        let mut runaways = 0;
        for lane in 0..LANES {
            if self.times[lane] > longest {
                self.times[lane] = f64::INFINITY;
            }
            if !self.going[lane] {
                continue;
            }
            let state: Vec<f64> = self.states.iter().map(|lanes| lanes[lane]).collect();
            let is_near = limits.hold(&state);
            runaways += usize::from(!is_near);
            self.going[lane] = is_near && (self.ages[lane] as f64) * self.time_step < longest;
        }
        runaways
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::space::Axis;
    use crate::system::{TypedModel, regions};

    #[test]
    fn whether_noise_is_even_does_not_hang_on_the_number_of_cells() {
        let model = TypedModel::new("free", "Free", vec!["x", "y"]).with_equation("x", "y");
        let model = model.with_equation("y", "-x").with_noise("y", ["1"]);
        let model = model.build().unwrap();
        let system = model.system_with(&[]).unwrap();
        for (text, is_even) in [("y^2/2 + x^4 > 2", false), ("x + 2 y > 1", true)] {
            let region = regions(&model, &[("out", text)]).unwrap().remove(0);
            let until = region.level().bind(&model.values(&[]).unwrap()).unwrap();
            for counts in [[64, 64], [128, 100], [80, 80], [17, 64], [640, 3]] {
                let axes = counts.map(|count| Axis::uniform(-2.0, 2.0, count).unwrap());
                let space = CellSpace::new(axes.to_vec()).unwrap();
                let border = Border::new(&*system, &space, (&until).into());
                assert_eq!(border.is_even, is_even, "{text}: {counts:?}");
            }
        }
    }
}

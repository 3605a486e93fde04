//! Where trajectories settle that start in a box, with steps that suit the places where they are.
//!
//! A pilot has one step for all of a box. In a wide box that may be far too short for the places where trajectories
//! settle, as that of a spring whose force grows exponentially. Here the step of a batch is found again every few
//! steps, and trajectories that go to infinity are told from those that stay.

use super::Integrator;
use super::integrator::{Position, Stepper, positions};
use super::jacobian::Around;
use super::random::{NormalStream, StreamKey, mix, unit};
use crate::cancellation::{Cancellation, Cancelled};
use crate::numerics::in_parallel;
use crate::system::{LANES, Lanes, System};

/// Batches of trajectories: the first starts in the middle of the box, the others all over it.
const BATCHES: u64 = 4;
/// Steps between two looks at the rates.
const STEPS: usize = 16;
/// Step in units of the fastest time scale of the batch.
const ANGLE: f64 = 0.1;
/// Looks of the first window, and of the last: each window is twice as long as the one before.
const LOOKS: (usize, usize) = (64, 16384);
/// Looks during which it is recorded where those go that have settled, at most.
const LAST: usize = 4096;
/// What is visited has settled where its length in a window is within this factor of that in the window before.
const ALIKE: f64 = 1.2;
/// A trajectory all over the box whose rates are so many times those in the middle is left out.
const FAST: f64 = 10.0;
/// A step is no longer than so many of the one before.
const LONGER: f64 = 2.0;
/// Share of a length over which differences are taken, and shortest length relative to the distance from zero.
const SHARE: f64 = 1.0 / 64.0;
/// How far beside a switching surface rates are looked at, over that length.
const BESIDE: f64 = 0.01;
/// Number among the cells that keys these streams apart from those of the cells and of a pilot.
const CELL: u64 = u64::MAX - 1;

/// What trajectories did.
pub(crate) struct Settled {
    /// From the least to the greatest coordinate that those which stay have had, with where they started.
    pub(crate) passed: Vec<(f64, f64)>,
    /// The same after they have settled.
    pub(crate) visited: Vec<(f64, f64)>,
}

/// Where trajectories settle along the axes `along`, of those that start in the box and do not go to infinity. None
/// where one from the middle does, or where what they visit goes on changing.
///
/// # Errors
/// [`Cancelled`].
pub(crate) fn settled(
    system: &dyn System,
    start: &[(f64, f64)],
    along: &[usize],
    seed: u64,
    cancellation: &Cancellation,
) -> Result<Option<Settled>, Cancelled> {
    let batch = |number: u64| Batch::new(system, start, number, seed);
    let over_box = batch(1).rates(f64::INFINITY);
    let first = over_box.map_or(f64::INFINITY, |[_, fastest]| ANGLE / fastest);
    let run = |number: u64, middle: Pace| {
        let batch = Batch {
            step: first,
            ..batch(number)
        };
        batch.settle(along, middle, cancellation)
    };
    let unknown = Pace {
        rate: f64::INFINITY,
        time: 0.0,
    };
    let Some((mut all, middle)) = run(0, unknown)? else {
        return Ok(None);
    };
    let others = in_parallel(BATCHES as usize - 1, |number| {
        run(number as u64 + 1, middle)
    })?;
    for (batch, _) in others.into_iter().flatten() {
        all.passed = hull(&all.passed, &batch.passed);
        all.visited = hull(&all.visited, &batch.visited);
    }
    Ok(Some(all))
}

/// How fast trajectories are.
#[derive(Clone, Copy)]
struct Pace {
    /// Median of their rates at the end.
    rate: f64,
    /// Time that they took.
    time: f64,
}

/// The least ranges that hold both.
pub(crate) fn hull(one: &[(f64, f64)], other: &[(f64, f64)]) -> Vec<(f64, f64)> {
    let pairs = one.iter().zip(other);
    pairs.map(|(a, b)| (a.0.min(b.0), a.1.max(b.1))).collect()
}

/// Trajectories that take their steps together.
struct Batch<'a> {
    system: &'a dyn System,
    positions: Vec<Position>,
    /// Shortest length of an axis over which differences are taken.
    lengths: Vec<f64>,
    states: Vec<Lanes>,
    /// Those that stay.
    stays: [bool; LANES],
    is_in_middle: bool,
    /// The step that was taken last.
    step: f64,
    stream: NormalStream,
}

impl<'a> Batch<'a> {
    fn new(system: &'a dyn System, start: &[(f64, f64)], number: u64, seed: u64) -> Self {
        let mut states: Vec<Lanes> = vec![[0.0; LANES]; start.len()];
        for lane in 0..LANES {
            let key = StreamKey {
                seed,
                cell: CELL,
                block: u64::MAX - (number * LANES as u64 + lane as u64),
            };
            let word = key.word();
            for (axis, (lanes, &(from, to))) in states.iter_mut().zip(start).enumerate() {
                let share = match number {
                    0 => 0.5,
                    _ => unit(mix(word.wrapping_add(axis as u64))),
                };
                lanes[lane] = from + share * (to - from);
            }
        }
        Self {
            system,
            positions: positions(system),
            lengths: start.iter().map(|&(from, to)| to - from).collect(),
            states,
            stays: [true; LANES],
            is_in_middle: number == 0,
            step: f64::INFINITY,
            stream: NormalStream::new(StreamKey {
                seed,
                cell: CELL,
                block: number,
            }),
        }
    }

    /// What those that stay do, and their pace. It takes as long as those in the middle took at least; what begins with
    /// rates much faster than theirs is left out.
    fn settle(
        mut self,
        along: &[usize],
        middle: Pace,
        cancellation: &Cancellation,
    ) -> Result<Option<(Settled, Pace)>, Cancelled> {
        let (mut too_fast, mut time) = (FAST * middle.rate, 0.0);
        let mut passed = Reach::of(&self.states);
        let mut before: Option<Vec<(f64, f64)>> = None;
        let (mut looks, mut rate) = (LOOKS.0, 0.0);
        let mut is_settled = false;
        while looks <= LOOKS.1 && !is_settled {
            let Some((window, pace)) = self.window(looks, too_fast, cancellation)? else {
                return Ok(None);
            };
            too_fast = f64::INFINITY;
            (time, rate) = (time + pace.time, pace.rate);
            passed.join(&window);
            let visited = window.ends(&self.stays);
            let is_alike = |before: &Vec<(f64, f64)>| {
                along.iter().all(|&axis| {
                    let [now, then] = [&visited, before].map(|ends| ends[axis].1 - ends[axis].0);
                    now <= ALIKE * then && then <= ALIKE * now
                })
            };
            is_settled = time >= middle.time && before.as_ref().is_some_and(is_alike);
            before = Some(visited);
            looks *= 2;
        }
        // What began elsewhere may take longer, and is where it was last.
        if self.is_in_middle && !is_settled {
            return Ok(None);
        }
        let Some((window, _)) = self.window(LAST.min(4 * looks), f64::INFINITY, cancellation)?
        else {
            return Ok(None);
        };
        passed.join(&window);
        let [passed, visited] = [passed, window].map(|reach| reach.ends(&self.stays));
        Ok(Some((Settled { passed, visited }, Pace { rate, time })))
    }

    /// Where trajectories go between so many looks, and their pace at the end; none where one from the middle, or every
    /// one, goes to infinity. Those whose rates at first are greater than given are left out.
    fn window(
        &mut self,
        looks: usize,
        mut too_fast: f64,
        cancellation: &Cancellation,
    ) -> Result<Option<(Reach, Pace)>, Cancelled> {
        let mut reach = Reach::of(&self.states);
        let mut pace = Pace {
            rate: 0.0,
            time: 0.0,
        };
        for _ in 0..looks {
            let Some(now) = self.advance(too_fast, cancellation)? else {
                return Ok(None);
            };
            too_fast = f64::INFINITY;
            (pace.rate, pace.time) = (now.rate, pace.time + now.time);
            reach.join(&Reach::of(&self.states));
        }
        Ok(Some((reach, pace)))
    }

    /// How far those that stay are from zero along each axis, or where they started.
    fn across(&self) -> Vec<f64> {
        let axes = self.states.iter().zip(&self.lengths);
        let farthest = |(lanes, &length): (&Lanes, &f64)| {
            let staying = lanes.iter().zip(self.stays).filter(|(_, stays)| *stays);
            let sizes = staying.map(|(value, _)| value.abs());
            sizes.filter(|size| size.is_finite()).fold(length, f64::max)
        };
        axes.map(farthest).collect()
    }

    /// The rate at which drift or noise crosses such lengths, which matters where the drift does not change.
    fn crossing(&self, across: &[f64], drift: &[Lanes]) -> Lanes {
        let mut rates: Lanes = [0.0; LANES];
        for (drift, length) in drift.iter().zip(across) {
            for (rate, drift) in rates.iter_mut().zip(drift) {
                *rate = rate.max(drift.abs() / length);
            }
        }
        for noise in self.system.noises() {
            let amplitudes = noise.amplitudes(0.0, &self.states);
            for (rate, amplitude) in rates.iter_mut().zip(amplitudes) {
                let share = amplitude / across[noise.axis];
                *rate = rate.max(0.5 * share * share);
            }
        }
        rates
    }

    /// Takes some steps that suit the fastest, and says their pace; none where one from the middle, or every one, goes
    /// to infinity. Steps get longer by and by: rates may vanish where trajectories start.
    fn advance(
        &mut self,
        too_fast: f64,
        cancellation: &Cancellation,
    ) -> Result<Option<Pace>, Cancelled> {
        let Some([median, fastest]) = self.rates(too_fast) else {
            return Ok(None);
        };
        self.step = (ANGLE / fastest).min(LONGER * self.step);
        let (system, step) = (self.system, self.step);
        let stepper = Stepper::new(system, Integrator::StochasticHeun, step, cancellation);
        stepper.advance(&mut self.states, 0, STEPS, &mut self.stream)?;
        Ok(Some(Pace {
            rate: median,
            time: STEPS as f64 * step,
        }))
    }

    /// The median and the greatest of the rates, which are above zero.
    fn rates(&mut self, too_fast: f64) -> Option<[f64; 2]> {
        let mut rates = Vec::new();
        let across: Vec<f64> = self.across();
        let mut drift = vec![[0.0; LANES]; self.states.len()];
        self.system.drift(0.0, &self.states, &mut drift);
        let crossing = self.crossing(&across, &drift);
        let lengths: Vec<Lanes> = (self.states.iter().zip(&self.lengths))
            .map(|(lanes, length)| lanes.map(|at| SHARE * length.max(at.abs())))
            .collect();
        let around = Around::new(self.system, &self.states, &lengths);
        let mut beside: Option<Around> = None;
        for lane in 0..LANES {
            let is_finite = |all: &[Lanes]| all.iter().all(|lanes| lanes[lane].is_finite());
            self.stays[lane] &= is_finite(&self.states) && is_finite(&drift);
            if !self.stays[lane] {
                continue;
            }
            // Where a switching surface is, the rates are those beside it.
            let mut rates_beside = || {
                let around = beside.get_or_insert_with(|| {
                    let places = self.states.iter().zip(&lengths);
                    let place = |(at, by): (&Lanes, &Lanes)| {
                        std::array::from_fn(|lane| at[lane] + BESIDE * by[lane])
                    };
                    let states: Vec<Lanes> = places.map(place).collect();
                    Around::new(self.system, &states, &lengths)
                });
                around.rates(lane, &self.positions)
            };
            let rate = (around.rates(lane, &self.positions))
                .or_else(&mut rates_beside)
                .map_or(0.0, |rate| rate.fastest);
            if rate > too_fast {
                self.stays[lane] = false;
            } else {
                rates.push(rate.max(crossing[lane]));
            }
        }
        let is_lost = self.is_in_middle && self.stays.contains(&false);
        if is_lost {
            return None;
        }
        rates.sort_by(f64::total_cmp);
        let median = *rates.get(rates.len() / 2)?;
        let fastest = *rates.last().filter(|&&rate| rate > 0.0)?;
        Some([median, fastest])
    }
}

/// The least and the greatest coordinates that each trajectory has had.
struct Reach {
    low: Vec<Lanes>,
    high: Vec<Lanes>,
}

impl Reach {
    fn of(states: &[Lanes]) -> Self {
        Self {
            low: states.to_vec(),
            high: states.to_vec(),
        }
    }

    fn join(&mut self, other: &Self) {
        let extend = |ends: &mut [Lanes], others: &[Lanes], farther: fn(f64, f64) -> f64| {
            for (lanes, others) in ends.iter_mut().zip(others) {
                for (end, &other) in lanes.iter_mut().zip(others) {
                    *end = farther(*end, other);
                }
            }
        };
        extend(&mut self.low, &other.low, f64::min);
        extend(&mut self.high, &other.high, f64::max);
    }

    /// From the least to the greatest coordinate of those that stay.
    fn ends(&self, stays: &[bool; LANES]) -> Vec<(f64, f64)> {
        let axes = self.low.iter().zip(&self.high);
        let of = |(low, high): (&Lanes, &Lanes)| {
            let staying = || (0..LANES).filter(|&lane| stays[lane]);
            let least = staying()
                .map(|lane| low[lane])
                .fold(f64::INFINITY, f64::min);
            let most = staying()
                .map(|lane| high[lane])
                .fold(f64::NEG_INFINITY, f64::max);
            (least, most)
        };
        axes.map(of).collect()
    }
}

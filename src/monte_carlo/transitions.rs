//! How often long trajectories go from one region to another, and how long they are on their way, with a time step and
//! with half of it.
//!
//! Both trajectories of a pair see the same Wiener process and meet borders by the same random numbers, so that what
//! they differ by is what the step does.

use rayon::prelude::*;

use super::MonteCarloError;
use super::batch::{Limits, Purpose, key};
use super::crossings::{Chances, Crossings, TransitionCounts};
use super::ergodic::Starts;
use super::estimate::BLOCKS;
use super::exit_times::{ExitNumber, differences};
use super::halving::over_two_steps;
use super::walk::Border;
use crate::cancellation::{Cancellation, Cancelled};
use crate::numerics::jackknife;
use crate::sampling::{Integrator, NormalStream, Stepper};
use crate::space::CellSpace;
use crate::system::{BoundQuantity, LANES, Lanes, System};

/// Steps of the coarser trajectories that are made at once.
const CHUNK: usize = 16;

/// Steps that a batch of pairs takes in a chunk: of each a whole one and two halves.
const CHUNK_STEPS: f64 = (3 * CHUNK * LANES) as f64;

/// Fewest batches, and the share of all steps that burn-in may take with more.
const FEWEST_BATCHES: f64 = 4.0;
const BURN_IN_SHARE: f64 = 0.25;

/// The first look at what was counted, as a share of the burn-in.
const FIRST_LOOK: f64 = 0.25;

/// How trajectories are followed.
#[derive(Debug, Clone, PartialEq)]
pub struct TransitionRun {
    /// Step of the coarser trajectory of each pair; the other has half of it, and what is counted on it is the result.
    pub time_step: f64,
    /// The integrator.
    pub integrator: Integrator,
    /// Seed of the random streams.
    pub seed: u64,
    /// Time before transitions are counted.
    pub burn_in: f64,
    /// Transitions that are wanted: trajectories end when so many have been counted.
    pub transitions: usize,
    /// Integrator steps of all trajectories after which they end in any case.
    pub most_steps: f64,
}

/// Transitions that were counted on trajectories.
#[derive(Debug, Clone, PartialEq)]
pub struct Transitions {
    /// Of each pair of trajectories with the step, and with half of it.
    tallies: Vec<[TransitionCounts; 2]>,
    runaways: usize,
    steps: f64,
}

impl Transitions {
    /// Number of transitions, with the step or with half of it, whichever is less.
    pub fn count(&self) -> usize {
        let counts = [0, 1].map(|with| {
            let of = self.tallies.iter().map(|pair| pair[with].transitions);
            of.sum::<f64>() as usize
        });
        counts[0].min(counts[1])
    }

    /// Trajectories that ran away.
    pub fn runaways(&self) -> usize {
        self.runaways
    }

    /// Integrator steps of all trajectories.
    pub(crate) fn steps(&self) -> f64 {
        self.steps
    }

    /// Transitions per unit of time, the same per unit of time that the first region was the last one of the two, and
    /// their mean time on the way. Not finite where there are none.
    ///
    /// The error of sampling is that of a jackknife that leaves out one trajectory at a time.
    pub fn numbers(&self) -> [ExitNumber; 3] {
        self.numbers_by(numbers_of)
    }

    /// Of two regions that are all there is, visits of the second one: the share of the time that is spent in it, how
    /// often it is entered per unit of time, and the mean time of a visit; with errors as those of
    /// [`Transitions::numbers`].
    pub fn visits(&self) -> [ExitNumber; 3] {
        self.numbers_by(|tally| {
            let inside = tally.time - tally.from_last;
            vec![
                inside / tally.time,
                tally.transitions / tally.time,
                inside / tally.transitions,
            ]
        })
    }

    fn numbers_by(&self, numbers_of: impl Fn(&TransitionCounts) -> Vec<f64>) -> [ExitNumber; 3] {
        let none = TransitionCounts::default();
        let totals = self.tallies.iter().fold([none; 2], |sums, pair| {
            [0, 1].map(|with| sums[with].plus(1.0, &pair[with]))
        });
        let of = |[coarse, fine]: [TransitionCounts; 2]| {
            let fine = numbers_of(&fine);
            (differences(&numbers_of(&coarse), &fine), fine)
        };
        let (shifts, values) = of(totals);
        let without = self.tallies.iter();
        let without =
            without.map(|pair| of([0, 1].map(|with| totals[with].plus(-1.0, &pair[with]))));
        let (shifted, fine): (Vec<_>, Vec<_>) = without.unzip();
        std::array::from_fn(|index| ExitNumber {
            value: values[index],
            sampling: jackknife(fine.iter().map(|numbers| numbers[index])),
            step: (
                shifts[index],
                jackknife(shifted.iter().map(|numbers| numbers[index])),
            ),
        })
    }
}

/// Flux, rate and mean time on the way.
fn numbers_of(tally: &TransitionCounts) -> Vec<f64> {
    vec![
        tally.transitions / tally.time,
        tally.transitions / tally.from_last,
        tally.on_way / tally.transitions,
    ]
}

/// Counts transitions from the first of two regions, given by their levels, to the second, on long trajectories that
/// start from `states` (any, d values each; settled ones of a [`super::Relaxation`] need the least burn-in; all over Ω
/// without any). Results are the same bits for any number of threads.
///
/// # Errors
/// [`MonteCarloError`].
pub fn transitions(
    (system, space): (&dyn System, &CellSpace),
    regions: [&BoundQuantity; 2],
    states: &[Vec<f64>],
    run: &TransitionRun,
    cancellation: &Cancellation,
) -> Result<Transitions, MonteCarloError> {
    MonteCarloError::check(system, space)?;
    MonteCarloError::check_times([("time step", run.time_step), ("burn-in", run.burn_in)])?;
    if states.iter().any(|state| state.len() != space.dimension()) {
        return Err(MonteCarloError::Start);
    }
    let limits = Limits::new(space);
    let borders = regions.map(|region| Border::new(system, space, region.into()));
    let starts = Starts::among(states, space);
    let burn_in = (run.burn_in / (run.time_step * CHUNK as f64)).ceil();
    let affordable = BURN_IN_SHARE * run.most_steps / (CHUNK_STEPS * burn_in);
    let count = affordable.clamp(FEWEST_BATCHES, BLOCKS as f64) as usize;
    let pair = |number: usize| {
        let states = starts.batch(run.seed, number, space.dimension());
        Pair::new(
            (system, &borders),
            (number, count),
            states,
            run,
            cancellation,
        )
    };
    let mut pairs: Vec<Pair<'_>> = (0..count).map(pair).collect();
    let mut advance = |chunks: f64, is_first: bool| -> Result<Transitions, MonteCarloError> {
        let ran = pairs.par_iter_mut().with_max_len(1);
        let ran: Result<Vec<usize>, Cancelled> = ran
            .map(|pair| pair.advance(chunks as usize, &limits, cancellation))
            .collect();
        if is_first {
            pairs.iter_mut().for_each(Pair::begin);
        }
        Ok(Transitions {
            runaways: ran?.iter().sum(),
            tallies: pairs.iter().flat_map(Pair::tallies).collect(),
            steps: pairs.iter().map(|pair| pair.steps as f64).sum::<f64>() * 3.0 * LANES as f64,
        })
    };
    let mut found = advance(burn_in, true)?;
    let (mut counted, mut next) = (0.0, (FIRST_LOOK * burn_in).ceil());
    while found.runaways == 0 && found.count() < run.transitions && next >= 1.0 {
        found = advance(next, false)?;
        counted += next;
        // Twice as long, or as long as it takes by what was counted.
        let share = run.transitions as f64 / found.count().max(1) as f64 - 1.0;
        let left = (run.most_steps - found.steps) / (CHUNK_STEPS * count as f64);
        next = (counted * share.clamp(0.05, 1.0)).ceil().min(left.floor());
    }
    Ok(found)
}

/// A batch of pairs of trajectories.
struct Pair<'a> {
    seed: u64,
    /// Number of this batch, and how many there are.
    number: (usize, usize),
    channels: usize,
    stream: NormalStream,
    normals: Vec<Lanes>,
    walks: [Crossings<'a>; 2],
    /// Whole steps that were made.
    steps: u64,
}

impl<'a> Pair<'a> {
    fn new(
        (system, borders): (&'a dyn System, &'a [Border<'a>; 2]),
        number: (usize, usize),
        states: Vec<Lanes>,
        run: &TransitionRun,
        cancellation: &Cancellation,
    ) -> Self {
        let channels = system.noises().len();
        let walks = [run.time_step, 0.5 * run.time_step].map(|step| {
            let stepper = Stepper::new(system, run.integrator, step, cancellation);
            Crossings::new(borders, (stepper, step), states.clone())
        });
        Self {
            seed: run.seed,
            number,
            channels,
            stream: NormalStream::new(key(run.seed, Purpose::Transition, number.0 as u64)),
            normals: vec![[0.0; LANES]; 2 * CHUNK * channels],
            walks,
            steps: 0,
        }
    }

    /// Makes so many chunks of steps; ends early, and says how many, where trajectories run away.
    fn advance(
        &mut self,
        chunks: usize,
        limits: &Limits,
        cancellation: &Cancellation,
    ) -> Result<usize, Cancelled> {
        let channels = self.channels;
        for _ in 0..chunks {
            cancellation.check()?;
            self.stream.fill(&mut self.normals);
            let sums = over_two_steps(&self.normals, channels);
            let row = |step: usize| step * channels..(step + 1) * channels;
            for step in 0..CHUNK {
                let (number, of) = self.number;
                let chances = Chances {
                    seed: self.seed,
                    number: self.steps * of as u64 + number as u64,
                };
                let [coarse, fine] = &mut self.walks;
                coarse.renew();
                fine.renew();
                coarse.step(&sums[row(step)], &chances);
                fine.step(&self.normals[row(2 * step)], &chances);
                fine.step(&self.normals[row(2 * step + 1)], &chances);
                self.steps += 1;
            }
            let ran = self.walks.iter().map(|walk| walk.runaways(limits)).sum();
            if ran > 0 {
                return Ok(ran);
            }
        }
        Ok(0)
    }

    /// From here on it is counted.
    fn begin(&mut self) {
        self.walks.iter_mut().for_each(Crossings::begin);
    }

    fn tallies(&self) -> Vec<[TransitionCounts; 2]> {
        let [coarse, fine] = [0, 1].map(|with| self.walks[with].tallies());
        coarse.into_iter().zip(fine).map(|(a, b)| [a, b]).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::space::Axis;
    use crate::system::{TypedModel, regions};

    /// x' = -x + √2 ξ from below -1/2 to above 1/2, with so many transitions wanted.
    fn counted(wanted: usize, most_steps: f64) -> Transitions {
        let model = TypedModel::new("one", "One", vec!["x"]).with_equation("x", "-x");
        let model = model.with_noise("x", ["sqrt(2)"]);
        let model = model.build().unwrap();
        let values = model.values(&[]).unwrap();
        let [from, to] = ["x < -0.5", "x > 0.5"].map(|text| {
            let region = regions(&model, &[("one", text)]).unwrap().remove(0);
            region.level().bind(&values).unwrap()
        });
        let space = CellSpace::new(vec![Axis::uniform(-4.0, 4.0, 40).unwrap()]).unwrap();
        let system = model.system_with(&[]).unwrap();
        let run = TransitionRun {
            time_step: 0.05,
            integrator: Integrator::StochasticHeun,
            seed: 4,
            burn_in: 8.0,
            transitions: wanted,
            most_steps,
        };
        let on = (&*system, &space);
        transitions(on, [&from, &to], &[], &run, &Cancellation::new()).unwrap()
    }

    #[test]
    fn a_process_goes_from_one_side_to_the_other_as_quadrature_says() {
        // With p = exp(-x²/2)/√(2π) and q' in proportion to exp(x²/2) between the borders, the flux is p q', and on the
        // way is ∫ p q (1 - q). For each side it was the last one half of the time.
        let places = (0..4000).map(|step| -0.5 + (f64::from(step) + 0.5) / 4000.0);
        let slope = |x: f64| (0.5 * x * x).exp() / 4000.0;
        let rising: f64 = places.clone().map(slope).sum();
        let root = (2.0 * std::f64::consts::PI).sqrt();
        let (mut q, mut way, flux) = (0.0, 0.0, 1.0 / (root * rising));
        for x in places {
            let middle = q + 0.5 * slope(x) / rising;
            way += (-0.5 * x * x).exp() / root * middle * (1.0 - middle) / 4000.0;
            q += slope(x) / rising;
        }
        let found = counted(20_000, 1e9);
        assert!(found.count() >= 20_000 && found.runaways() == 0);
        let exact = [flux, 2.0 * flux, way / flux];
        for (number, exact) in found.numbers().iter().zip(exact) {
            let (off, error) = (number.value - exact, number.error());
            assert!(off.abs() < 3.0 * error, "{number:?}, exactly {exact}");
            assert!(error < 0.02 * exact, "{number:?}");
        }
    }

    #[test]
    fn trajectories_are_the_same_for_any_number_of_threads_and_end_with_their_steps() {
        let with = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
            pool.build().unwrap().install(|| counted(1000, 1e9))
        };
        let one = with(1);
        assert_eq!(one, with(2));
        assert_eq!(one.numbers(), with(3).numbers());
        let short = counted(1_000_000, 3e6);
        assert!(short.count() < 1_000_000 && short.steps() <= 3e6);
    }
}

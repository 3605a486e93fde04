//! Single trajectories, kept as the states they come through: to be looked at, drawn over a density.

use std::f64::consts::TAU;

use super::MonteCarloError;
use super::batch::{Limits, Purpose, key};
use crate::cancellation::Cancellation;
use crate::sampling::{Integrator, NormalStream, Stepper, pilot};
use crate::space::CellSpace;
use crate::system::{LANES, Lanes, System};

/// Steps that are made between two looks at whether to stop; even, because normals come in pairs.
const CHUNK: usize = 64;

/// How a path is followed.
#[derive(Debug, Clone, PartialEq)]
pub struct PathRun {
    /// Step of stochastic Heun's method.
    pub time_step: f64,
    /// Number of steps.
    pub steps: usize,
    /// Steps from one state that is kept to the next. Which states the path comes through does not depend on it.
    pub stride: usize,
}

/// A path that was followed.
#[derive(Debug, Clone, PartialEq)]
pub struct SamplePath {
    /// The states that were kept, d values each, from the start on; one stride of steps lies between them.
    pub states: Vec<Vec<f64>>,
    /// Whether the path ran away (not finite, or beyond a hundred times the half range of an axis); it ends before it
    /// did.
    pub ran_away: bool,
}

impl PathRun {
    /// A run over a number of turns, of which at most `most_states` are kept. It is shorter where it would take more
    /// than `most_steps`, and has at least one step.
    ///
    /// A turn is 2π over the rate at which the state moves through where it is found: a period of a harmonic
    /// oscillator. The rate, root mean square drift over standard deviation, is that of the slowest axis on which no
    /// noise acts, or of all axes where noise acts on each. A few trajectories keyed by `seed` tell it, and the time
    /// step with it.
    ///
    /// # Errors
    /// [`MonteCarloError`].
    pub(crate) fn over_turns(
        system: &dyn System,
        space: &CellSpace,
        turns: f64,
        (most_states, most_steps): (usize, usize),
        seed: u64,
        cancellation: &Cancellation,
    ) -> Result<Self, MonteCarloError> {
        MonteCarloError::check(system, space)?;
        MonteCarloError::check_times([("number of turns", turns)])?;
        let pilot = pilot(system, space, seed, cancellation)?;
        let time_step = pilot.automatic_time_step(Integrator::StochasticHeun);
        let centres: Vec<Vec<f64>> = pilot.cells.iter().map(|&cell| space.centre(cell)).collect();
        let rate = rate(system, &centres).unwrap_or(pilot.frequency);
        let wanted = (turns * TAU / (rate * time_step)).ceil();
        // What is not finite ends at the largest number of steps.
        let steps = if wanted >= 1.0 { wanted as usize } else { 1 };
        let steps = steps.min(most_steps.max(1));
        Ok(Self {
            time_step,
            stride: steps.div_ceil(most_states.saturating_sub(1).max(1)),
            steps,
        })
    }

    /// Time that the path covers.
    pub(crate) fn time(&self) -> f64 {
        self.steps as f64 * self.time_step
    }

    fn check(&self) -> Result<(), MonteCarloError> {
        MonteCarloError::check_times([("time step", self.time_step)])?;
        match self.stride {
            0 => Err(MonteCarloError::Stride),
            _ => Ok(()),
        }
    }
}

/// Root mean square drift over standard deviation, both of the same states, of the slowest axis on which no noise acts;
/// of all where noise acts on each.
fn rate(system: &dyn System, states: &[Vec<f64>]) -> Option<f64> {
    let count = states.len() as f64;
    let drifts: Vec<Vec<f64>> = states.iter().map(|x| system.drift_at(0.0, x)).collect();
    let of_axis = |axis: usize| {
        let mean = states.iter().map(|state| state[axis]).sum::<f64>() / count;
        let spread = states.iter().map(|state| (state[axis] - mean).powi(2));
        let square = drifts.iter().map(|drift| drift[axis].powi(2));
        (square.sum::<f64>() / spread.sum::<f64>()).sqrt()
    };
    let slowest = |axes: &mut dyn Iterator<Item = usize>| {
        let rates = axes.map(of_axis);
        rates
            .filter(|rate| rate.is_finite() && *rate > 0.0)
            .min_by(f64::total_cmp)
    };
    let all = || 0..system.dimension();
    let quiet = |axis: &usize| !system.is_noisy(*axis);
    slowest(&mut all().filter(quiet)).or_else(|| slowest(&mut all()))
}

/// Follows one path from a state, by stochastic Heun. The same seed gives the same noise from whatever state the path
/// starts and whatever the parameters are. The space tells only how far a path may go.
///
/// # Errors
/// [`MonteCarloError`].
pub fn sample_path(
    system: &dyn System,
    space: &CellSpace,
    start: &[f64],
    seed: u64,
    run: &PathRun,
    cancellation: &Cancellation,
) -> Result<SamplePath, MonteCarloError> {
    MonteCarloError::check(system, space)?;
    run.check()?;
    if start.len() != space.dimension() || !start.iter().all(|value| value.is_finite()) {
        return Err(MonteCarloError::Start);
    }
    let integrator = Integrator::StochasticHeun;
    let stepper = Stepper::new(system, integrator, run.time_step, cancellation);
    let limits = Limits::new(space);
    let channels = system.noises().len();
    let mut stream = NormalStream::new(key(seed, Purpose::Path, 0));
    let mut normals = vec![[0.0; LANES]; CHUNK * channels];
    // A batch is what a stepper moves; its first lane is the path.
    let mut states: Vec<Lanes> = start.iter().map(|&value| [value; LANES]).collect();
    let mut path = SamplePath {
        states: vec![start.to_vec()],
        ran_away: false,
    };
    for step in 0..run.steps {
        let within = step % CHUNK;
        if within == 0 {
            cancellation.check()?;
            stream.fill(&mut normals);
        }
        let row = &normals[within * channels..(within + 1) * channels];
        stepper.advance_with(&mut states, step, 1, row);
        if (step + 1) % run.stride == 0 || step + 1 == run.steps {
            let state: Vec<f64> = states.iter().map(|lanes| lanes[0]).collect();
            if !limits.hold(&state) {
                path.ran_away = true;
                break;
            }
            path.states.push(state);
        }
    }
    Ok(path)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::space::Axis;
    use crate::system::registry;
    use std::sync::Arc;

    fn oscillator(kappa: f64) -> (Arc<dyn System>, CellSpace) {
        let values = [
            ("kappa", kappa),
            ("mu", 0.0),
            ("f_c", 0.0),
            ("sigma2", 0.01),
        ];
        let model = registry::find("coulomb").unwrap();
        let axis = Axis::uniform(-2.0, 2.0, 40).unwrap();
        let space = CellSpace::new(vec![axis.clone(), axis]).unwrap();
        (model.system_with(&values).unwrap(), space)
    }

    fn follow(start: &[f64], seed: u64, run: &PathRun) -> Result<SamplePath, MonteCarloError> {
        let (system, space) = oscillator(0.05);
        sample_path(&*system, &space, start, seed, run, &Cancellation::new())
    }

    /// x'' + κx' + x = ξ has E x = E y = 0 and the variance σ²/(2κ) along both axes.
    #[test]
    fn a_long_path_visits_states_as_often_as_the_steady_state_says() {
        let (kappa, time_step) = (0.05, 0.05);
        let run = PathRun {
            time_step,
            steps: 2_000_000,
            stride: 10,
        };
        let path = follow(&[0.0, 0.0], 3, &run).unwrap();
        assert!(!path.ran_away && path.states.len() == 200_001);
        let variance = 0.01 / (2.0 * kappa);
        let count = path.states.len() as f64;
        for axis in 0..2 {
            let power = |n: i32| {
                path.states
                    .iter()
                    .map(|state| state[axis].powi(n))
                    .sum::<f64>()
                    / count
            };
            // Over T = 1e5 a mean has the standard error √(2 S T⁻¹) with ∫C dt = σ²/2 for x and 0 for y, below √(σ²/T)
            // = 3.2e-4; a variance that of √(4∫C²dt/T)/v = √((2/κ)/T) = 2 %. The step of 0.05 takes dt³/(4κ) = 6e-4 of
            // the damping.
            assert!(power(1).abs() < 4.0 * 3.2e-4, "mean {}", power(1));
            assert!(
                (power(2) / variance - 1.0).abs() < 4.0 * 0.02,
                "variance {}",
                power(2)
            );
        }
    }

    #[test]
    fn a_path_is_made_by_its_seed_and_not_by_what_is_kept_of_it() {
        let run = |stride: usize| PathRun {
            time_step: 0.05,
            steps: 301,
            stride,
        };
        let every = follow(&[0.3, -0.1], 7, &run(1)).unwrap();
        assert_eq!(every, follow(&[0.3, -0.1], 7, &run(1)).unwrap());
        assert_eq!(every.states.len(), 302);
        let some = follow(&[0.3, -0.1], 7, &run(50)).unwrap();
        let kept = [0, 50, 100, 150, 200, 250, 300, 301].map(|step| every.states[step].clone());
        assert_eq!(some.states, kept);
        let other = follow(&[0.3, -0.1], 8, &run(1)).unwrap();
        assert_ne!(every.states[1], other.states[1]);
    }

    #[test]
    fn a_turn_is_a_period_and_a_run_keeps_to_its_bounds() {
        let (system, space) = oscillator(0.05);
        let never = Cancellation::new();
        let run = |turns: f64, bounds: (usize, usize)| {
            PathRun::over_turns(&*system, &space, turns, bounds, 1, &never)
        };
        // Visited cells fill a disc, in which root mean square drift and deviation are the same times the frequency, to
        // the ragged edge of some hundred cells.
        let ten = run(10.0, (100_000, 1 << 20)).unwrap();
        assert!((ten.time() / (10.0 * TAU) - 1.0).abs() < 0.1 && ten.stride == 1);
        let long = run(100.0, (1000, 1 << 20)).unwrap();
        assert!(long.stride > 1 && long.steps <= 999 * long.stride);
        assert_eq!(run(1e9, (usize::MAX, 77)).unwrap().steps, 77);
        assert_eq!(run(1e300, (0, 0)).unwrap().steps, 1);
        for turns in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            let refused = run(turns, (10, 10)).unwrap_err();
            assert!(refused.to_string().contains("number of turns"));
        }
    }

    #[test]
    fn what_runs_away_ends_and_what_is_wrong_is_refused() {
        let (system, space) = oscillator(-0.5);
        let run = PathRun {
            time_step: 0.05,
            steps: 100_000,
            stride: 1,
        };
        let never = Cancellation::new();
        let path = sample_path(&*system, &space, &[1.0, 0.0], 1, &run, &never).unwrap();
        let last = path.states.last().unwrap();
        assert!(path.ran_away && path.states.len() < 1000);
        assert!(last.iter().all(|value| value.abs() <= 200.0));
        for start in [&[0.0][..], &[0.0, f64::NAN]] {
            assert_eq!(follow(start, 1, &run), Err(MonteCarloError::Start));
        }
        let still = PathRun {
            stride: 0,
            ..run.clone()
        };
        assert_eq!(follow(&[0.0, 0.0], 1, &still), Err(MonteCarloError::Stride));
        let stopped = Cancellation::new();
        stopped.cancel();
        let stopped = sample_path(&*system, &space, &[1.0, 0.0], 1, &run, &stopped);
        assert!(matches!(stopped, Err(MonteCarloError::Cancelled(_))));
    }
}

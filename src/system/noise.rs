//! The noises of a system: white, each on one axis.

use std::sync::Arc;

use super::{LANES, Lanes};

/// Amplitudes b(X, t) of a batch.
type AmplitudeOfState = dyn Fn(f64, &[Lanes], &mut Lanes) + Send + Sync;

/// A white noise b(X, t) dW on one axis, in Itô's sense.
#[derive(Clone)]
pub struct Noise {
    /// The axis that it drives.
    pub axis: usize,
    /// Its amplitude b.
    pub amplitude: Amplitude,
}

/// The amplitude of a noise.
#[derive(Clone)]
pub enum Amplitude {
    /// The same everywhere and at all times.
    Constant(f64),
    /// A function of time and a batch of states, `states[axis][lane]`, that writes the amplitude in each lane.
    OfState(Arc<AmplitudeOfState>),
}

impl Noise {
    /// A noise of constant amplitude.
    pub fn constant(axis: usize, amplitude: f64) -> Self {
        let amplitude = Amplitude::Constant(amplitude);
        Self { axis, amplitude }
    }

    /// A noise whose amplitude depends on time and state; see [`Amplitude::OfState`].
    pub fn of_state(
        axis: usize,
        amplitude: impl Fn(f64, &[Lanes], &mut Lanes) + Send + Sync + 'static,
    ) -> Self {
        let amplitude = Amplitude::OfState(Arc::new(amplitude));
        Self { axis, amplitude }
    }

    /// The amplitude, where it depends on neither state nor time.
    pub fn additive(&self) -> Option<f64> {
        match self.amplitude {
            Amplitude::Constant(amplitude) => Some(amplitude),
            Amplitude::OfState(_) => None,
        }
    }

    /// Amplitudes of a batch, `states[axis][lane]`.
    pub(crate) fn amplitudes(&self, time: f64, states: &[Lanes]) -> Lanes {
        match &self.amplitude {
            Amplitude::Constant(amplitude) => [*amplitude; LANES],
            Amplitude::OfState(amplitude) => {
                let mut lanes = [0.0; LANES];
                amplitude(time, states, &mut lanes);
                lanes
            }
        }
    }

    /// The amplitude at a single state.
    pub fn at(&self, time: f64, state: &[f64]) -> f64 {
        if let Some(amplitude) = self.additive() {
            return amplitude;
        }
        let states: Vec<Lanes> = state.iter().map(|&value| [value; LANES]).collect();
        self.amplitudes(time, &states)[0]
    }
}

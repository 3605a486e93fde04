//! What noise can be, and the linear filters behind which white noise becomes coloured.

use super::{CORRELATION_TIME, NOISE_DAMPING, NOISE_FREQUENCY};
use crate::system::typed::statement::{Statement, equation, white};
use crate::system::{LANES, Lanes, ParameterDescription, ParameterRange};

/// What noise is, by its name in files.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum NoiseKind {
    /// Without memory.
    #[default]
    White,
    /// With the correlation exp(-|s|/τ): white noise behind a filter of first order.
    OrnsteinUhlenbeck,
    /// With a spectrum that has a peak near the frequency ω_n: white noise behind a filter of second order.
    Harmonic,
}

words! {
    NoiseKind, pub name:
    White: "white",
    OrnsteinUhlenbeck: "ornstein-uhlenbeck",
    Harmonic: "harmonic",
}

impl NoiseKind {
    /// Whether noises have a memory.
    pub(crate) fn is_coloured(self) -> bool {
        self != Self::White
    }

    /// States of the filter of each noise, which are axes.
    pub(crate) fn filter_states(self) -> usize {
        match self {
            Self::White => 0,
            Self::OrnsteinUhlenbeck => 1,
            Self::Harmonic => 2,
        }
    }

    /// Parameters of the filter, one set for all noises of a model.
    pub(crate) fn parameters(self) -> Vec<ParameterDescription> {
        let positive = |name: &str, symbol: &str, meaning: &str| {
            ParameterDescription::new(name, symbol, meaning).within(ParameterRange::Positive)
        };
        match self {
            Self::White => Vec::new(),
            Self::OrnsteinUhlenbeck => {
                vec![positive(
                    CORRELATION_TIME,
                    "τ",
                    "correlation time of the noise",
                )]
            }
            Self::Harmonic => vec![
                positive(
                    NOISE_FREQUENCY,
                    "ω_n",
                    "natural frequency of the noise's filter",
                ),
                positive(
                    NOISE_DAMPING,
                    "ζ_n",
                    "damping of the noise's filter over the critical one",
                ),
            ],
        }
    }

    /// Whether the filter has a parameter of this name.
    pub(crate) fn has_parameter(self, name: &str) -> bool {
        self.parameters().iter().any(|one| one.name == name)
    }

    /// The equations of the filters of this many noises.
    pub(super) fn statements(self, noises: usize) -> Vec<Statement> {
        let mut statements = Vec::new();
        for number in 1..=noises {
            let index = if noises == 1 {
                String::new()
            } else {
                format!("_{number}")
            };
            let [noise, state, rate] = ["ξ", "η", "ν"].map(|name| format!("{name}{index}"));
            let mut add = |left: &str, right: &str, amplitude: Option<&str>| {
                let white = amplitude.map(|one| (one.to_owned(), format!("w{index}")));
                let white: Vec<_> = white.into_iter().collect();
                statements.push(equation(left, "=", right, &white));
            };
            match self {
                Self::White => {}
                Self::OrnsteinUhlenbeck => {
                    add(&noise, &format!("{state}/sqrt(2 τ)"), None);
                    add(
                        &format!("{state}'"),
                        &format!("-{state}/τ"),
                        Some("sqrt(2/τ)"),
                    );
                }
                Self::Harmonic => {
                    add(&noise, &format!("sqrt(ω_n/(4 ζ_n)) {state}"), None);
                    add(&format!("{state}'"), &format!("ω_n {rate}"), None);
                    let damped = format!("-ω_n {state} - 2 ζ_n ω_n {rate}");
                    add(&format!("{rate}'"), &damped, Some("2 sqrt(ζ_n ω_n)"));
                }
            }
        }
        statements.push(white("w", noises > 1, "s", ""));
        statements
    }

    /// The filter with values of [`NoiseKind::parameters`]; `None` for white noise.
    pub(super) fn filter(self, values: &[f64]) -> Option<Filter> {
        match (self, values) {
            (Self::OrnsteinUhlenbeck, &[tau]) => Some(Filter {
                gain: (0.5 / tau).sqrt(),
                amplitude: (2.0 / tau).sqrt(),
                damping: 1.0 / tau,
                frequency: None,
            }),
            (Self::Harmonic, &[frequency, damping]) => Some(Filter {
                gain: (0.25 * frequency / damping).sqrt(),
                amplitude: 2.0 * (damping * frequency).sqrt(),
                damping: 2.0 * damping * frequency,
                frequency: Some(frequency),
            }),
            _ => None,
        }
    }
}

/// A linear filter of one noise: its last state is driven by white noise, its first one drives the system.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Filter {
    /// What its first state, of unit variance, is multiplied by.
    pub(super) gain: f64,
    /// Amplitude of the white noise on its last state.
    pub(super) amplitude: f64,
    /// Rate at which its last state is damped.
    damping: f64,
    /// Frequency at which the two states of a filter of second order turn into one another.
    frequency: Option<f64>,
}

impl Filter {
    /// Number of its states.
    pub(super) fn states(&self) -> usize {
        1 + usize::from(self.frequency.is_some())
    }

    /// Rates of its states, a batch at a time.
    pub(super) fn rates(&self, states: &[Lanes], rates: &mut [Lanes]) {
        let Some(frequency) = self.frequency else {
            rates[0] = states[0].map(|state| -self.damping * state);
            return;
        };
        for lane in 0..LANES {
            let (noise, turned) = (states[0][lane], states[1][lane]);
            rates[0][lane] = frequency * turned;
            rates[1][lane] = -frequency * noise - self.damping * turned;
        }
    }
}

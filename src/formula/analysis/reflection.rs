//! Reflections that map a stochastic equation onto itself.

use crate::formula::graph::{Expression, Graph, TooLarge};

/// A reflection: marked coordinates change sign about the centre, the others stay.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Reflection {
    /// Centre, one value a state. Values of states that are not reflected do not matter.
    pub centre: Vec<f64>,
    /// Which states are reflected.
    pub reflected: Vec<bool>,
}

/// What a reflection does to an expression.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Parity {
    /// It is zero everywhere.
    Zero,
    /// It keeps its value.
    Even,
    /// It changes its sign.
    Odd,
    /// Neither.
    Neither,
}

/// Why a reflection does not map an equation onto itself.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub(crate) enum ReflectionError {
    /// The drift of a state does not change as it has to.
    #[error("the drift of state {state} is not {wanted} under the reflection")]
    Drift {
        /// Number of the state.
        state: usize,
        /// `odd` for a reflected state, `even` for another.
        wanted: &'static str,
        /// A state at which it fails, where one was found.
        at: Option<Vec<f64>>,
    },
    /// The amplitudes of a noise process do not all change as they have to.
    #[error(
        "the amplitudes of noise process {process} do not change together under the reflection"
    )]
    Noise {
        /// Number of the process.
        process: usize,
        /// A state at which an amplitude is neither even nor odd, where one was found.
        at: Option<Vec<f64>>,
    },
    /// The graph has no room for the parity's expressions.
    #[error(transparent)]
    TooLarge(#[from] TooLarge),
}

impl Reflection {
    /// The mirror image of a state.
    pub(crate) fn mirrored(&self, state: &[f64]) -> Vec<f64> {
        let mirrored = state.iter().zip(&self.centre).zip(&self.reflected);
        let mirrored = mirrored.map(
            |((x, centre), reflected)| {
                if *reflected { 2.0 * centre - x } else { *x }
            },
        );
        mirrored.collect()
    }
}

impl Graph {
    /// Checks that a reflection maps the process dX = drift dt + Σ_k noise\[k\] dW_k onto itself, with these values of
    /// the parameters: the drift of reflected states is odd, that of the others even, and each process' amplitudes
    /// (`noise[process][state]`) do so all together or the other way round all together. Returns whether the form of
    /// the expressions shows it; if not, trials at many states do.
    ///
    /// # Errors
    /// [`ReflectionError`], with a state at which it fails.
    pub(crate) fn check_reflection(
        &mut self,
        drift: &[Expression],
        noise: &[Vec<Expression>],
        reflection: &Reflection,
        parameters: &[f64],
    ) -> Result<bool, ReflectionError> {
        let mut proven = true;
        for (state, (&drift, &reflected)) in drift.iter().zip(&reflection.reflected).enumerate() {
            let found = self.parity(drift, reflection, parameters)?;
            let wanted = if reflected { Parity::Odd } else { Parity::Even };
            if found.parity != wanted && found.parity != Parity::Zero {
                let trials = self.parity_of_trials(drift, reflection, parameters)?;
                let (wanted, at) = if reflected {
                    ("odd", trials.not_odd)
                } else {
                    ("even", trials.not_even)
                };
                return Err(ReflectionError::Drift { state, wanted, at });
            }
            proven &= found.proven;
        }
        for (process, amplitudes) in noise.iter().enumerate() {
            let mut together = None;
            for (&amplitude, &reflected) in amplitudes.iter().zip(&reflection.reflected) {
                let found = self.parity(amplitude, reflection, parameters)?;
                proven &= found.proven;
                let changes = match found.parity {
                    Parity::Zero => continue,
                    Parity::Even => !reflected,
                    Parity::Odd => reflected,
                    Parity::Neither => {
                        return Err(ReflectionError::Noise {
                            process,
                            at: found.not_even,
                        });
                    }
                };
                if *together.get_or_insert(changes) != changes {
                    return Err(ReflectionError::Noise { process, at: None });
                }
            }
        }
        Ok(proven)
    }

    /// A reflection about a centre that maps the process onto itself, if there is one; of several the one that
    /// reflects most states. With it, whether the form of the expressions shows it.
    ///
    /// # Errors
    /// [`TooLarge`].
    pub(crate) fn find_reflection(
        &mut self,
        drift: &[Expression],
        noise: &[Vec<Expression>],
        centre: &[f64],
        parameters: &[f64],
    ) -> Result<Option<(Reflection, bool)>, TooLarge> {
        let dimension = drift.len().min(centre.len()).min(MOST_STATES);
        let mut masks: Vec<u32> = (1..1_u32 << dimension).collect();
        masks.sort_by_key(|mask| std::cmp::Reverse(mask.count_ones()));
        for mask in masks {
            let reflected = (0..dimension).map(|state| mask >> state & 1 == 1).collect();
            let reflection = Reflection {
                centre: centre[..dimension].to_vec(),
                reflected,
            };
            match self.check_reflection(drift, noise, &reflection, parameters) {
                Ok(proven) => return Ok(Some((reflection, proven))),
                Err(ReflectionError::TooLarge(error)) => return Err(error),
                Err(_) => {}
            }
        }
        Ok(None)
    }
}

/// Most states whose reflections are all tried.
const MOST_STATES: usize = 6;

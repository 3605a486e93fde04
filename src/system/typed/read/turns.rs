//! Axes that close on themselves: angles, in which the formulas must be periodic, and the phase of a forcing, which
//! stands for time in them.

use std::f64::consts::TAU;

use super::{Reader, Turns};
use crate::MAX_DIMENSION;
use crate::formula::analysis::{NotPeriodic, Wave};
use crate::formula::graph::{Expression, Point, Symbol};
use crate::system::typed::{FormulaPlace, PeriodFault, TypedModelError};

/// Largest numerator and denominator of the ratio of two frequencies with a common period.
const LARGEST: i32 = 12;

/// Relative deviation of a ratio from one of whole numbers that is rounding.
const ROUNDING: f64 = 1e-9;

/// Values of the parameters at which ratios are looked at.
const TRIALS: usize = 5;

/// Drift and noise with a phase for time.
pub(super) struct Forced {
    pub(super) drift: Vec<Expression>,
    pub(super) noise: Vec<Vec<Expression>>,
}

impl Reader<'_> {
    /// The angles, and drift and noise with the phase of the forcing for time, as a last axis, where time is in them.
    pub(super) fn turns(
        &mut self,
        drift: &[Expression],
        noise: &[Vec<Expression>],
    ) -> Result<(Turns, Option<Forced>), TypedModelError> {
        let mut turns = Turns::default();
        for axis in 0..drift.len() {
            let name = self.model.axes[axis].name.clone();
            let Some((_, period)) = self.model.turns.iter().find(|(own, _)| *own == name) else {
                continue;
            };
            self.check_angle(axis, *period, drift, noise)?;
            turns.of_axes.insert(axis, (-0.5 * period, 0.5 * period));
        }
        if self.model.period.is_some() {
            return Ok((turns, None));
        }
        let waves = self.waves(Symbol::Time, drift, noise)?;
        if waves.is_empty() {
            return Ok((turns, None));
        }
        let forced = self.forced(&waves, drift, noise)?;
        turns.phase = Some(drift.len());
        turns.of_axes.insert(drift.len(), (0.0, 1.0));
        Ok((turns, Some(forced)))
    }

    /// All formulas with their places.
    fn placed(
        &self,
        drift: &[Expression],
        noise: &[Vec<Expression>],
    ) -> Vec<(FormulaPlace, Expression)> {
        let name = |axis: usize| self.model.axes[axis].name.clone();
        let drift = drift.iter().enumerate();
        let drift = drift.map(|(axis, &one)| (FormulaPlace::Equation { axis: name(axis) }, one));
        let noise = noise.iter().enumerate().flat_map(|(process, amplitudes)| {
            let amplitudes = amplitudes.iter().enumerate();
            amplitudes.map(move |(axis, &one)| {
                let axis = name(axis);
                (FormulaPlace::Noise { axis, process }, one)
            })
        });
        drift.chain(noise).collect()
    }

    /// The sines and cosines that a symbol is in, each with its place.
    fn waves(
        &mut self,
        symbol: Symbol,
        drift: &[Expression],
        noise: &[Vec<Expression>],
    ) -> Result<Vec<(FormulaPlace, Wave)>, TypedModelError> {
        let mut all: Vec<(FormulaPlace, Wave)> = Vec::new();
        for (place, expression) in self.placed(drift, noise) {
            match self.scope.graph_mut().waves(&[expression], symbol)? {
                Ok(found) => {
                    let new = |wave: &Wave| all.iter().all(|(_, known)| known != wave);
                    let found: Vec<Wave> = found.into_iter().filter(new).collect();
                    all.extend(found.into_iter().map(|wave| (place.clone(), wave)));
                }
                Err(why) => {
                    let symbol = self.scope.symbols().name(symbol).to_owned();
                    let part = |part| self.scope.typeset(part);
                    let fault = match why {
                        NotPeriodic::Bare(at) => PeriodFault::Bare {
                            symbol,
                            part: part(at),
                        },
                        NotPeriodic::Bent(at) => PeriodFault::Bent {
                            symbol,
                            part: part(at),
                        },
                        NotPeriodic::Torn(at) => PeriodFault::Torn {
                            symbol,
                            part: part(at),
                        },
                    };
                    return Err(TypedModelError::Periodic { place, fault });
                }
            }
        }
        Ok(all)
    }

    /// Whether drift and noise have the period of an angle.
    fn check_angle(
        &mut self,
        axis: usize,
        period: f64,
        drift: &[Expression],
        noise: &[Vec<Expression>],
    ) -> Result<(), TypedModelError> {
        for (place, wave) in self.waves(Symbol::State(axis), drift, noise)? {
            // A number that is worked out, as 2 pi is, is one too.
            let tried = self.at_trials(wave.rate);
            let first = tried.first().copied();
            let rate = first.filter(|first| tried.iter().all(|one| one == first));
            let turns = rate.map(|rate| rate * period / TAU);
            let is_whole = |turns: f64| (turns - turns.round()).abs() <= ROUNDING * turns.abs();
            if !turns.is_some_and(is_whole) {
                let fault = PeriodFault::Other {
                    symbol: self.model.axes[axis].name.clone(),
                    part: self.scope.typeset(wave.expression),
                    period,
                    turns,
                };
                return Err(TypedModelError::Periodic { place, fault });
            }
        }
        Ok(())
    }

    /// Drift and noise with the phase, in periods, in place of time.
    fn forced(
        &mut self,
        waves: &[(FormulaPlace, Wave)],
        drift: &[Expression],
        noise: &[Vec<Expression>],
    ) -> Result<Forced, TypedModelError> {
        let axes = drift.len();
        let first = &waves[0].0;
        let refused = |place: &FormulaPlace, fault| TypedModelError::Periodic {
            place: place.clone(),
            fault,
        };
        if axes >= MAX_DIMENSION {
            return Err(refused(first, PeriodFault::Axes { axes }));
        }
        let values: Vec<Vec<f64>> = waves
            .iter()
            .map(|(_, wave)| self.at_trials(wave.rate))
            .collect();
        let (rate, multiples) = common(&values).map_err(|other| {
            let named = |number: usize| self.scope.typeset(waves[number].1.rate);
            let fault = PeriodFault::NoCommonPeriod {
                one: named(0),
                other: named(other),
                most: LARGEST,
            };
            refused(&waves[other].0, fault)
        })?;
        let phase = self.scope.add_state(PHASE_IN_FORMULAS);
        let base = waves[rate.wave].1.rate;
        let (frequency, zero, arguments) = self.scope.graph_mut().build(|builder| {
            let phase = builder.symbol(phase);
            let scale = builder.constant(rate.share / TAU);
            let frequency = builder.multiply(scale, base);
            let arguments = waves.iter().zip(&multiples).map(|((_, wave), &turns)| {
                let scale = builder.constant(TAU * f64::from(turns));
                let moving = builder.multiply(scale, phase);
                (wave.expression, builder.add(moving, wave.constant))
            });
            let arguments: Vec<(Expression, Expression)> = arguments.collect();
            (frequency, builder.constant(0.0), arguments)
        })?;
        let all: Vec<Expression> = drift
            .iter()
            .chain(noise.iter().flatten())
            .copied()
            .collect();
        let mut made = self
            .scope
            .graph_mut()
            .with_arguments(&all, &arguments)?
            .into_iter();
        let mut drift: Vec<Expression> = made.by_ref().take(axes).collect();
        drift.push(frequency);
        let noise = noise.iter().map(|amplitudes| {
            let own = made.by_ref().take(amplitudes.len());
            own.chain([zero]).collect()
        });
        Ok(Forced {
            noise: noise.collect(),
            drift,
        })
    }

    /// Values of an expression of parameters at some values of them without simple ratios.
    fn at_trials(&self, expression: Expression) -> Vec<f64> {
        let count = self.scope.symbols().parameters().len();
        let value = |trial: usize| {
            let share = |number: usize| {
                let step = (number + 1) as f64 * 0.618_033_988_75 + trial as f64 * 0.754_877_666_25;
                0.5 + step.fract()
            };
            let parameters: Vec<f64> = (0..count).map(share).collect();
            let point = Point {
                states: &[],
                parameters: &parameters,
                time: f64::NAN,
            };
            self.scope.graph().evaluate(expression, &point)
        };
        (0..TRIALS).map(value).collect()
    }
}

/// Name of the phase in formulas that are shown.
const PHASE_IN_FORMULAS: &str = "t/T";

/// A common frequency, as a share of the rate of one of the waves.
struct Common {
    wave: usize,
    share: f64,
}

/// The largest frequency of which all rates are whole multiples at all trials, with these multiples; the number of a
/// rate that has none in common with the first.
fn common(rates: &[Vec<f64>]) -> Result<(Common, Vec<i32>), usize> {
    let moves = |rate: &[f64]| rate.iter().any(|value| *value != 0.0);
    let Some(wave) = rates.iter().position(|rate| moves(rate)) else {
        return Err(0);
    };
    let ratios: Result<Vec<(i32, i32)>, usize> = rates
        .iter()
        .enumerate()
        .map(|(number, rate)| ratio(rate, &rates[wave]).ok_or(number))
        .collect();
    let ratios = ratios?;
    let whole = ratios
        .iter()
        .fold(1, |whole, &(_, q)| whole / divisor(whole, q) * q);
    let multiples: Vec<i32> = ratios.iter().map(|(p, q)| p * (whole / q)).collect();
    let shared = multiples
        .iter()
        .fold(0, |shared, &one| divisor(shared, one));
    // Time runs forward at positive parameters.
    let sign = if rates[wave][0] < 0.0 { -1 } else { 1 };
    let share = f64::from(sign * shared) / f64::from(whole);
    let multiples = multiples.into_iter().map(|one| sign * one / shared);
    Ok((Common { wave, share }, multiples.collect()))
}

/// Numerator and denominator of a ratio that is the same at all trials.
fn ratio(rate: &[f64], unit: &[f64]) -> Option<(i32, i32)> {
    let ratios: Vec<f64> = rate
        .iter()
        .zip(unit)
        .map(|(rate, unit)| rate / unit)
        .collect();
    let first = *ratios.first()?;
    let close = |a: f64, b: f64| (a - b).abs() <= ROUNDING * a.abs().max(b.abs());
    if !ratios.iter().all(|&ratio| close(ratio, first)) {
        return None;
    }
    (1..=LARGEST).find_map(|q| {
        let p = (first * f64::from(q)).round();
        let fits = p.abs() <= f64::from(LARGEST * q) && close(first * f64::from(q), p);
        fits.then_some((p as i32, q))
    })
}

/// The greatest common divisor.
fn divisor(a: i32, b: i32) -> i32 {
    if b == 0 { a.abs() } else { divisor(b, a % b) }
}

//! Coloured noise: every white noise of a model goes through a linear filter with a memory, whose state is an axis of its own.
//!
//! b ξ(t) becomes b η/√(2τ) with η' = -η/τ + √(2/τ) w(t), w white noise of unit intensity: an Ornstein-Uhlenbeck process of mean 0 and
//! variance 1. The force has the correlation b²/(2τ) exp(-|s|/τ), of the intensity b² whatever τ is, and goes to the white noise as
//! τ → 0, in Stratonovich's reading where b depends on the state (E. Wong and M. Zakai, 1965). The unit variance keeps the axis the
//! same when τ is swept.

use std::sync::Arc;

use super::{
    AxisDescription, LANES, Lanes, Model, ParameterDescription, ParameterRange, SwitchingSurface,
    Symmetry, System,
};
use crate::MAX_DIMENSION;

/// Name of the axis of coloured noise; numbered from 1 where there are several.
pub const NOISE_AXIS: &str = "noise";

/// Name of the correlation time of coloured noise among the parameters.
pub const CORRELATION_TIME: &str = "tau";

/// What noise is, by its name in files.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum NoiseKind {
    /// Without memory.
    #[default]
    White,
    /// With the correlation exp(-|s|/τ): white noise behind a filter of first order.
    OrnsteinUhlenbeck,
}

impl NoiseKind {
    /// All kinds.
    pub const ALL: [Self; 2] = [Self::White, Self::OrnsteinUhlenbeck];

    /// Name used in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::White => "white",
            Self::OrnsteinUhlenbeck => "ornstein-uhlenbeck",
        }
    }
}

/// Why a model cannot have coloured noise.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum ColouredNoiseError {
    /// Typed equations that cannot be read anew with coloured noise, in words.
    #[error("{0}")]
    Equations(String),
    /// The model's noises are so many, or its state so large, that there is no room.
    #[error(
        "coloured noise adds an axis for each of {noises} noises to the {axes} of the state; at most {MAX_DIMENSION} axes are possible"
    )]
    Axes {
        /// Axes of the model.
        axes: usize,
        /// Its noises.
        noises: usize,
    },
    /// A name that coloured noise needs means something else.
    #[error("coloured noise needs the name `{name}`, which the model has given to something else")]
    Taken {
        /// The name.
        name: String,
    },
}

/// A model with coloured noise in place of each of `noises` white noises, with one correlation time for all.
pub(super) fn coloured(model: &Arc<Model>, noises: usize) -> Result<Model, ColouredNoiseError> {
    let axes = model.axes.len();
    if axes + noises > MAX_DIMENSION {
        return Err(ColouredNoiseError::Axes { axes, noises });
    }
    let names: Vec<String> = (1..=noises)
        .map(|number| match noises {
            1 => NOISE_AXIS.to_owned(),
            _ => format!("{NOISE_AXIS}_{number}"),
        })
        .collect();
    check_names(model, &names)?;
    let mut parameters = model.parameters.clone();
    let known = parameters
        .iter()
        .position(|one| one.name == CORRELATION_TIME);
    let place = known.unwrap_or(parameters.len());
    match known {
        Some(place) => parameters[place].range = ParameterRange::Positive,
        None => parameters.push(correlation_time()),
    }
    let own = known.is_some();
    let white = Arc::clone(model);
    let bind = move |values: &[f64]| -> Arc<dyn System> {
        let mut inner = values.to_vec();
        if !own {
            inner.truncate(place);
        }
        Arc::new(Coloured::new(white.bound(&inner), values[place]))
    };
    let described = model.axes.iter().cloned();
    let filters = names.iter().enumerate().map(|(index, name)| {
        let symbol = match noises {
            1 => "η".to_owned(),
            _ => format!("η_{{{}}}", index + 1),
        };
        AxisDescription::new(name, symbol, "coloured noise, of unit variance").carried_by_modes()
    });
    let coloured = Model::new(&model.name, &model.title, bind)
        .with_equations(lines(model))
        .with_axes(described.chain(filters).collect::<Vec<_>>())
        .with_parameters(parameters)
        .with_source(&model.source)
        // What is said of built-in models beside their equations holds for white noise.
        .with_notes(model.typed().map_or(Vec::new(), |_| model.notes.clone()))
        .with_definitions(model.definitions().to_vec())
        .with_noise_kind(NoiseKind::OrnsteinUhlenbeck);
    Ok(match model.typed() {
        Some(typed) => coloured.with_typed(typed.clone()),
        None => coloured,
    })
}

fn correlation_time() -> ParameterDescription {
    ParameterDescription::new(CORRELATION_TIME, "τ", "correlation time of the noise")
        .within(ParameterRange::Positive)
}

/// Axes and definitions must have other names than the noise, and than its correlation time.
fn check_names(model: &Model, names: &[String]) -> Result<(), ColouredNoiseError> {
    let axes = model.axes.iter().map(|axis| axis.name.as_str());
    let defined = model.definitions().iter().map(|(name, _)| name.as_str());
    let taken: Vec<&str> = axes.chain(defined).collect();
    let parameters = model.parameters.iter().map(|one| one.name.as_str());
    let needed = names.iter().map(String::as_str);
    let mut clash = needed
        .filter(|name| taken.contains(name) || parameters.clone().any(|one| one == *name))
        .chain(
            [CORRELATION_TIME]
                .into_iter()
                .filter(|name| taken.contains(name)),
        );
    match clash.next() {
        Some(name) => Err(ColouredNoiseError::Taken {
            name: name.to_owned(),
        }),
        None => Ok(()),
    }
}

/// The model's equations, with the correlation that its noises have now, and where they come from.
fn lines(model: &Model) -> Vec<String> {
    let states_intensity = |line: &&String| line.starts_with("E[ξ");
    let kept = model
        .equations
        .iter()
        .filter(|line| !states_intensity(line));
    let intensity = model.equations.iter().find(states_intensity);
    let coloured = intensity.map(|line| {
        line.replace("(t+τ)", "(t+s)")
            .replace("δ(τ)", "exp(-|s|/τ)/(2 τ)")
    });
    let filter =
        "noise b ξ(t) = b η/√(2 τ),   η' = -η/τ + √(2/τ) w(t),   w white noise of unit intensity";
    kept.cloned()
        .chain(coloured)
        .chain([filter.to_owned()])
        .collect()
}

/// A system whose white noises come through filters, one axis each after those of the system.
struct Coloured {
    system: Arc<dyn System>,
    /// Axes of the system without its filters.
    own: usize,
    noise_axes: Vec<usize>,
    /// 1/τ.
    rate: f64,
    /// 1/√(2τ): what a filter's state of unit variance is multiplied by.
    gain: f64,
    /// Amplitude of the white noise of each filter, √(2/τ).
    amplitude: f64,
}

impl Coloured {
    /// With a correlation time above zero.
    fn new(system: Arc<dyn System>, tau: f64) -> Self {
        let own = system.dimension();
        Self {
            own,
            noise_axes: (own..own + system.noise_axes().len()).collect(),
            rate: 1.0 / tau,
            gain: (0.5 / tau).sqrt(),
            amplitude: (2.0 / tau).sqrt(),
            system,
        }
    }

    /// Whether an amplitude changes its sign with a reflection of the system: its noise is then reflected too, but for the axis's own
    /// sign. `None` where it does neither.
    fn is_odd(&self, channel: usize, symmetry: &Symmetry) -> Option<bool> {
        if self.system.additive_amplitude(channel).is_some() {
            return Some(false);
        }
        let states: Vec<Lanes> = (0..self.own)
            .map(|axis| {
                let centre = symmetry.centre[axis];
                // Spread over both sides of the centre, of no simple ratio between the axes.
                let step = 0.618_033_988_75 + 0.07 * axis as f64;
                std::array::from_fn(|lane| {
                    centre + 4.0 * (((lane + 1) as f64 * step).fract() - 0.5)
                })
            })
            .collect();
        let images: Vec<Lanes> = (0..self.own)
            .map(|axis| match symmetry.reflected[axis] {
                true => states[axis].map(|x| 2.0 * symmetry.centre[axis] - x),
                false => states[axis],
            })
            .collect();
        let at = |states: &[Lanes]| {
            let mut amplitude = [0.0; LANES];
            self.system.amplitude(channel, 0.0, states, &mut amplitude);
            amplitude
        };
        let (here, there) = (at(&states), at(&images));
        let size = here.iter().map(|b| b.abs()).fold(0.0, f64::max);
        let mut signs = [1.0, -1.0].into_iter();
        let sign = signs.find(|sign| {
            let mut pairs = here.iter().zip(&there);
            pairs.all(|(b, image)| (image - sign * b).abs() <= 1e-9 * size)
        });
        sign.map(|sign| sign < 0.0)
    }
}

impl System for Coloured {
    fn dimension(&self) -> usize {
        self.own + self.noise_axes.len()
    }

    fn drift(&self, time: f64, states: &[Lanes], drift: &mut [Lanes]) {
        let (own, filters) = states.split_at(self.own);
        let (slopes, relaxations) = drift.split_at_mut(self.own);
        self.system.drift(time, own, slopes);
        let driven = self.system.noise_axes();
        for (channel, (filter, relaxation)) in filters.iter().zip(relaxations).enumerate() {
            let mut amplitude = [0.0; LANES];
            self.system.amplitude(channel, time, own, &mut amplitude);
            let slopes = &mut slopes[driven[channel]];
            for lane in 0..LANES {
                slopes[lane] += self.gain * amplitude[lane] * filter[lane];
                relaxation[lane] = -self.rate * filter[lane];
            }
        }
    }

    fn noise_axes(&self) -> &[usize] {
        &self.noise_axes
    }

    fn additive_amplitude(&self, channel: usize) -> Option<f64> {
        (channel < self.noise_axes.len()).then_some(self.amplitude)
    }

    fn period(&self) -> Option<f64> {
        self.system.period()
    }

    fn bounds(&self, axis: usize) -> Option<(f64, f64)> {
        (axis < self.own)
            .then(|| self.system.bounds(axis))
            .flatten()
    }

    fn filtered_noise(&self, axis: usize) -> Option<(f64, f64)> {
        self.noise_axes.contains(&axis).then_some((0.0, 1.0))
    }

    fn switching_surfaces(&self) -> Vec<SwitchingSurface> {
        self.system.switching_surfaces()
    }

    /// That of the system; a filter goes with the axis that it drives.
    fn symmetry(&self) -> Option<Symmetry> {
        let mut symmetry = self.system.symmetry()?;
        let driven = self.system.noise_axes();
        let filters: Option<Vec<bool>> = (0..driven.len())
            .map(|channel| {
                let odd = self.is_odd(channel, &symmetry)?;
                Some(symmetry.reflected[driven[channel]] != odd)
            })
            .collect();
        symmetry.reflected.extend(filters?);
        symmetry.centre.resize(self.dimension(), 0.0);
        Some(symmetry)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::system::contract;
    use crate::system::{TypedModel, registry};

    #[test]
    fn every_built_in_model_keeps_its_contract_with_coloured_noise() {
        for white in registry::models() {
            let model = match Model::with_coloured_noise(white) {
                Ok(model) => model,
                Err(error) => {
                    assert_eq!(white.axes.len(), MAX_DIMENSION, "{error}");
                    continue;
                }
            };
            let given = model.parameters.iter().map(|one| {
                let value = one.default.filter(|&value| value != 0.0).unwrap_or(0.3);
                (one.name.as_str(), value)
            });
            let values = model.values(&given.collect::<Vec<_>>()).unwrap();
            let ranges = vec![(-1.5, 1.5); model.axes.len()];
            match contract::verify_model(&model, &values, &ranges) {
                Ok(()) | Err(contract::ContractViolation::SmoothSurface { .. }) => {}
                Err(violation) => panic!("{}: {violation}", model.name),
            }
            let (system, inner) = (model.system(&values), white.bound(values.as_slice()));
            assert_eq!(system.symmetry().is_some(), inner.symmetry().is_some());
            assert_eq!(system.dimension(), inner.dimension() + 1);
        }
    }

    fn typed(noise: &[&str]) -> TypedModel {
        TypedModel::new("test", "test", ["x", "y"])
            .with_equation("x", "y")
            .with_equation("y", "-x - x^3 - y")
            .with_noise("y", noise.iter().copied())
            .with_parameters(["tau"])
    }

    #[test]
    fn a_noise_is_reflected_with_its_axis_unless_its_amplitude_is_odd() {
        let reflected = |noise: &[&str]| {
            let model = typed(noise).with_coloured_noise().build().unwrap();
            let values = model.values(&[("tau", 0.7)]).unwrap();
            let ranges = vec![(-2.0, 2.0); model.axes.len()];
            contract::verify_model(&model, &values, &ranges).unwrap();
            model.system(&values).symmetry().map(|one| one.reflected)
        };
        assert_eq!(reflected(&["0.5"]), Some(vec![true; 3]));
        assert_eq!(reflected(&["x^2 + 1"]), Some(vec![true; 3]));
        assert_eq!(reflected(&["x"]), Some(vec![true, true, false]));
        assert_eq!(
            reflected(&["0.5", "y"]),
            Some(vec![true, true, true, false])
        );
        assert_eq!(reflected(&["1 + x"]), None);
    }

    #[test]
    fn what_cannot_be_coloured_is_refused() {
        let refused = |model: TypedModel| model.build().unwrap_err().to_string();
        let three = typed(&["1", "x", "y"]).with_coloured_noise();
        assert!(refused(three).contains("adds an axis for each of 3 noises"));
        let ito = typed(&["1 + y"]).with_coloured_noise();
        let ito = ito.with_interpretation(crate::system::Interpretation::Ito);
        assert!(refused(ito).contains("Stratonovich"));
        let taken = typed(&["1"])
            .with_definition("noise", "x")
            .with_coloured_noise();
        assert!(refused(taken).contains("`noise`"));
        let four = Model::with_coloured_noise(&registry::find("bliman_sorine").unwrap());
        assert!(matches!(
            four,
            Err(ColouredNoiseError::Axes { axes: 4, noises: 1 })
        ));
    }
}

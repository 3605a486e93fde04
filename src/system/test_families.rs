//! Families and systems that tests share.

use std::sync::Arc;

use super::{Facts, Family, Lanes, Noise, Path, SwitchingSurface, System, registry};

/// A built-in model with these values.
pub(crate) fn built_in(model: &str, values: &[(&str, f64)]) -> Arc<dyn System> {
    registry::find(model).unwrap().system_with(values).unwrap()
}

/// The paper's first example along its friction level.
pub(crate) fn coulomb() -> Family {
    let fixed = [("kappa", 0.01), ("sigma2", 0.01)];
    let path = Path::parameter("f_c", -0.02, 0.01);
    Family::new(registry::find("coulomb").unwrap(), &fixed, path).unwrap()
}

/// The smallest model with a bifurcation, along its growth rate.
pub(crate) fn bistable(from: f64, to: f64) -> Family {
    let path = Path::parameter("a", from, to);
    Family::new(
        registry::find("bistable").unwrap(),
        &[("sigma2", 0.5)],
        path,
    )
    .unwrap()
}

/// dx = a(x) dt + σ dW.
pub(crate) struct OneState<D> {
    drift: D,
    noise: [Noise; 1],
    facts: Facts,
}

impl<D: Fn(f64) -> f64 + Send + Sync> OneState<D> {
    /// With this drift a and amplitude σ.
    pub(crate) fn new(sigma: f64, drift: D) -> Self {
        Self {
            drift,
            noise: [Noise::constant(0, sigma)],
            facts: Facts::default(),
        }
    }

    /// The same with a place at which the drift jumps or bends.
    pub(crate) fn with_surface(mut self, at: f64) -> Self {
        self.facts.switching_surfaces = vec![SwitchingSurface { axis: 0, at }];
        self
    }
}

impl<D: Fn(f64) -> f64 + Send + Sync> System for OneState<D> {
    fn dimension(&self) -> usize {
        1
    }
    fn drift(&self, _time: f64, states: &[Lanes], drift: &mut [Lanes]) {
        drift[0] = states[0].map(&self.drift);
    }
    fn noises(&self) -> &[Noise] {
        &self.noise
    }
    fn facts(&self) -> &Facts {
        &self.facts
    }
}

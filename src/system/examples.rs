//! Families and systems that tests share.

use super::{Family, Lanes, Path, SwitchingSurface, System, registry};

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
    sigma: f64,
    /// Where the drift is not smooth.
    surface: Option<f64>,
}

impl<D: Fn(f64) -> f64 + Send + Sync> OneState<D> {
    /// With this drift a and amplitude σ.
    pub(crate) fn new(sigma: f64, drift: D) -> Self {
        let surface = None;
        Self {
            drift,
            sigma,
            surface,
        }
    }

    /// The same with a place at which the drift jumps or bends.
    pub(crate) fn with_surface(self, at: f64) -> Self {
        let surface = Some(at);
        Self { surface, ..self }
    }
}

impl<D: Fn(f64) -> f64 + Send + Sync> System for OneState<D> {
    fn dimension(&self) -> usize {
        1
    }
    fn drift(&self, _time: f64, states: &[Lanes], drift: &mut [Lanes]) {
        for (slope, x) in drift[0].iter_mut().zip(&states[0]) {
            *slope = (self.drift)(*x);
        }
    }
    fn noise_axes(&self) -> &[usize] {
        &[0]
    }
    fn additive_amplitude(&self, _channel: usize) -> Option<f64> {
        Some(self.sigma)
    }
    fn switching_surfaces(&self) -> Vec<SwitchingSurface> {
        let surface = |at| SwitchingSurface { axis: 0, at };
        self.surface.map(surface).into_iter().collect()
    }
}

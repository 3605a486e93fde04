//! A system between walls: the same drift and noise, and nothing leaves given ranges. What the densities of the two
//! differ by is what the mass that leaves the ranges does.

use std::collections::BTreeMap;
use std::sync::Arc;

use super::{Facts, Lanes, Noise, System};

/// A system whose coordinates stay within given ranges.
pub(crate) struct Enclosed {
    system: Arc<dyn System>,
    facts: Facts,
}

impl Enclosed {
    /// The system with a lower and an upper wall on each axis.
    pub(crate) fn new(system: Arc<dyn System>, ranges: &[(f64, f64)]) -> Self {
        let facts = Facts {
            bounds: ranges.iter().copied().enumerate().collect(),
            ..system.facts().clone()
        };
        Self { system, facts }
    }

    /// The system whose coordinates are reflected: axes with a lower and an upper wall, infinite where there is none.
    pub(crate) fn reflecting(system: Arc<dyn System>, walls: &BTreeMap<usize, (f64, f64)>) -> Self {
        let facts = Facts {
            reflecting: walls.clone(),
            ..system.facts().clone()
        };
        Self { system, facts }
    }
}

impl System for Enclosed {
    fn dimension(&self) -> usize {
        self.system.dimension()
    }
    fn drift(&self, time: f64, states: &[Lanes], drift: &mut [Lanes]) {
        self.system.drift(time, states, drift);
    }
    fn noises(&self) -> &[Noise] {
        self.system.noises()
    }
    fn facts(&self) -> &Facts {
        &self.facts
    }
}

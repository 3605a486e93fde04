//! Friction levels that depend on the velocity of sliding: what Stribeck found, in the two forms that are used most.

use crate::formula::arithmetic::{exponential, sign};

/// A friction force that is known from the velocity of sliding alone; odd in it.
pub(super) trait SlidingForce: Send + Sync {
    /// The force at a velocity of sliding, zero at rest.
    fn at(&self, sliding: f64) -> f64;
}

/// g(u) = f_c + (f_s - f_c) exp(-(u/v_s)²): static at rest, kinetic when fast.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct StribeckLevel {
    kinetic: f64,
    excess: f64,
    velocity: f64,
}

impl StribeckLevel {
    /// From f_c, f_s and v_s.
    pub(super) fn new(kinetic: f64, at_rest: f64, velocity: f64) -> Self {
        Self {
            kinetic,
            excess: at_rest - kinetic,
            velocity,
        }
    }

    /// g(u).
    #[inline(always)]
    pub(super) fn at(&self, sliding: f64) -> f64 {
        let ratio = sliding / self.velocity;
        self.kinetic + self.excess * exponential(-(ratio * ratio))
    }
}

impl SlidingForce for StribeckLevel {
    #[inline(always)]
    fn at(&self, sliding: f64) -> f64 {
        StribeckLevel::at(self, sliding) * sign(sliding)
    }
}

/// f_s sgn(u) - (3/2)(f_s - f_m)(u/v_m - (u/v_m)³/3): f_m, the least force of sliding, is reached at u = v_m.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct CubicForce {
    at_rest: f64,
    drop: f64,
    velocity: f64,
}

impl CubicForce {
    /// From f_s, f_m and v_m.
    pub(super) fn new(at_rest: f64, least: f64, velocity: f64) -> Self {
        Self {
            at_rest,
            drop: 1.5 * (at_rest - least),
            velocity,
        }
    }
}

impl SlidingForce for CubicForce {
    #[inline(always)]
    fn at(&self, sliding: f64) -> f64 {
        let ratio = sliding / self.velocity;
        self.at_rest * sign(sliding) - self.drop * ratio * (1.0 - ratio * ratio / 3.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn levels_are_static_at_rest_and_kinetic_when_fast() {
        let level = StribeckLevel::new(0.2, 0.5, 0.25);
        assert_eq!(level.at(0.0), 0.5);
        assert!((level.at(-0.25) - (0.2 + 0.3 * (-1.0_f64).exp())).abs() < 1e-15);
        assert!((level.at(3.0) - 0.2).abs() < 1e-15);
        // Without a Stribeck part the level is the kinetic one to the last bit.
        assert_eq!(StribeckLevel::new(0.3, 0.3, 0.1).at(0.07), 0.3);
    }

    #[test]
    fn the_cubic_force_is_least_at_its_velocity() {
        let force = CubicForce::new(0.5, 0.2, 0.8);
        assert!((force.at(0.8) - 0.2).abs() < 1e-15 && (force.at(-0.8) + 0.2).abs() < 1e-15);
        assert!((force.at(1e-12) - 0.5).abs() < 1e-11);
        let slope = (force.at(0.8 + 1e-4) - force.at(0.8 - 1e-4)) / 2e-4;
        assert!(slope.abs() < 1e-6 && force.at(0.7) > 0.2 && force.at(0.9) > 0.2);
        assert_eq!(force.at(0.0), 0.0);
    }
}

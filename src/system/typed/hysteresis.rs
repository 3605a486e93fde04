//! States of hysteresis, found in the formulas: z' = v g(z) while v > 0 and v h(z) while v < 0, as in the laws of Dahl
//! (1968) and of Bouc and Wen (1976). Such a state depends on the path alone, not on how fast it is run through. It
//! stays between the values at which it yields: where it no longer grows, whichever way the path goes.

use crate::formula::graph::{Expression, Graph};

/// Factors by which a path is run through faster or more slowly, and states at which that is tried: a law that is
/// rounded off where the path turns back is none of these.
const FASTER: [f64; 9] = [1e-12, 1e-9, 1e-6, 1e-3, 0.37, 29.0, 1e4, 1e8, 1e12];
const STATES: [f64; 6] = [-31.0, -1.0, -0.013, 0.021, 0.7, 17.0];

/// Relative difference that is rounding.
const ROUNDING: f64 = 1e-9;

/// A state yields smoothly: this near to its bound, as a share, it moves outward no faster than this share of its rate
/// at the origin. Paths in steps would pass a bound at which the rate jumps.
const NEAR: f64 = 1e-6;
const SLOW: f64 = 1e-3;

/// Bounds are looked for from this size on, in so many steps of a factor of two.
const SMALLEST: f64 = 1e-9;
const DOUBLINGS: usize = 70;

/// Halvings between two numbers, to the last bit.
const HALVINGS: usize = 60;

/// The state v along whose path an axis may have hysteresis, by the form of its equation: it depends on that and on
/// itself alone.
pub(super) fn path_of(graph: &Graph, drift: Expression, axis: usize) -> Option<usize> {
    let dependence = graph.dependence(drift);
    let mut others = dependence.states.iter().copied().filter(|&one| one != axis);
    let path = others.next()?;
    let is_form = others.next().is_none() && dependence.states.contains(&axis) && !dependence.time;
    is_form.then_some(path)
}

/// The values between which a state of hysteresis stays, from its drift as a function of v and z; `None` where the
/// drift is none of hysteresis, or keeps the state nowhere.
pub(super) fn bounds(drift: impl Fn(f64, f64) -> f64) -> Option<(f64, f64)> {
    let depends_on_path_alone = STATES.iter().all(|&z| {
        [1.0, -1.0].iter().all(|&v| {
            let rate = drift(v, z);
            // Where it yields the rate itself is rounding.
            let size = rate.abs() + drift(v, 0.0).abs();
            let is_alike = |faster: f64| {
                (drift(faster * v, z) - faster * rate).abs() <= ROUNDING * faster * size
            };
            rate.is_finite() && FASTER.into_iter().all(is_alike)
        })
    });
    // How fast the state moves outward at a distance to either side, at most.
    let outward = |side: f64, size: f64| {
        let rates = [1.0, -1.0].map(|v| side * drift(v, side * size));
        rates[0].max(rates[1])
    };
    let bound = |side: f64| {
        let sizes = (0..DOUBLINGS).map(|step| SMALLEST * 2_f64.powi(step as i32));
        let mut outer = sizes.into_iter().find(|&size| outward(side, size) <= 0.0)?;
        let mut inner = 0.5 * outer;
        // It yields at a distance: at the origin it moves.
        if outward(side, 0.0) <= 0.0 || outward(side, inner) <= 0.0 {
            return None;
        }
        for _ in 0..HALVINGS {
            let middle = 0.5 * (inner + outer);
            match outward(side, middle) <= 0.0 {
                true => outer = middle,
                false => inner = middle,
            }
        }
        let is_smooth = outward(side, outer * (1.0 - NEAR)) <= SLOW * outward(side, 0.0);
        is_smooth.then_some(side * outer)
    };
    let (low, high) = (bound(-1.0)?, bound(1.0)?);
    depends_on_path_alone.then_some((low, high))
}

#[cfg(test)]
mod tests {
    use super::bounds;

    #[test]
    fn states_of_hysteresis_yield_where_their_closed_forms_say() {
        let (a, b, c) = (1.3, 0.7, -0.2);
        for n in [1.0, 2.0, 3.5] {
            let bouc_wen = |v: f64, z: f64| {
                a * v - b * v.abs() * z.abs().powf(n - 1.0) * z - c * v * z.abs().powf(n)
            };
            let (low, high) = bounds(bouc_wen).unwrap();
            let exact = (a / (b + c)).powf(1.0 / n);
            assert!(
                (high - exact).abs() < 1e-14 * exact.abs() && low == -high,
                "{n}: {high} {exact}"
            );
        }
        let at_one = |v: f64, z: f64| 0.8 * v - 0.5 * v.abs() * z - 0.3 * v * z.abs();
        assert!((bounds(at_one).unwrap().1 - 1.0).abs() < 1e-15);
        let hardening = |v: f64, z: f64| v - 1.5 * v.abs() * z + 0.5 * v * z.abs();
        assert_eq!(bounds(hardening), Some((-1.0, 1.0)));
        // Dahl's law, one that yields earlier on one side, and one that is run through backwards.
        let dahl = |v: f64, z: f64| v - 4.0 * v.abs() * z;
        assert_eq!(bounds(dahl), Some((-0.25, 0.25)));
        let lopsided = |v: f64, z: f64| v * if v > 0.0 { 1.0 - z } else { 1.0 + 2.0 * z };
        assert_eq!(bounds(lopsided), Some((-0.5, 1.0)));
        assert_eq!(bounds(|v, z| -dahl(v, -z)), Some((-0.25, 0.25)));
    }

    #[test]
    fn what_is_no_hysteresis_or_keeps_nothing_has_no_bounds() {
        // A filter, a position, a law whose state grows for ever, and one that depends on how fast it is run through.
        assert_eq!(bounds(|v, z| v - z), None);
        assert_eq!(bounds(|v, _| v), None);
        assert_eq!(bounds(|v, z| v + v.abs() * z), None);
        assert_eq!(
            bounds(|v, z| v - v.abs() * z / (1.0 + (-v * v).exp())),
            None
        );
        let rounded = |v: f64, z: f64| v - v * (v / 3e-5).tanh() * z;
        assert_eq!(bounds(rounded), None);
        assert_eq!(bounds(|v, z| v - v.abs().min(50.0) * z), None);
        // Where the rate jumps, as of an elasto-plastic law without a transition.
        let sharp = |v: f64, z: f64| if z * v.signum() < 1.0 { v } else { 0.0 };
        assert_eq!(bounds(sharp), None);
        // A point of rest is no yielding.
        assert_eq!(bounds(|v, z| -v.abs() * z), None);
    }
}

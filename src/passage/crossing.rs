//! Where the level of a region changes its sign along a line.

/// Steps by which a crossing is narrowed within a cell, and the width at which it is known.
const NARROWING: usize = 100;
const NARROW: f64 = 1e-13;

/// Where a level changes its sign between two places, by secants of which an end that stays counts half (Illinois), and
/// by halving after every step that narrows by less than that, as where the level jumps.
pub(super) fn crossing(level: &impl Fn(f64) -> f64, [mut a, mut b]: [(f64, f64); 2]) -> f64 {
    let (mut stayed, mut is_slow) = (0_i32, false);
    for _ in 0..NARROWING {
        let width = (b.0 - a.0).abs();
        if width <= NARROW {
            break;
        }
        let secant = a.1 / (a.1 - b.1);
        let by_secant = secant.is_finite() && !is_slow;
        let at = a.0 + if by_secant { secant } else { 0.5 } * (b.0 - a.0);
        let value = level(at);
        if value == 0.0 {
            return at;
        }
        if (value < 0.0) == (a.1 < 0.0) {
            stayed = stayed.max(0) + 1;
            a = (at, value);
            b.1 *= if stayed > 1 { 0.5 } else { 1.0 };
        } else {
            stayed = stayed.min(0) - 1;
            b = (at, value);
            a.1 *= if stayed < -1 { 0.5 } else { 1.0 };
        }
        is_slow = (b.0 - a.0).abs() > 0.5 * width;
    }
    0.5 * (a.0 + b.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn crossings_are_found_of_lines_curves_and_jumps() {
        let at = 0.317_2;
        let levels: [&dyn Fn(f64) -> f64; 4] = [
            &|x| at - x,
            &|x| (x - at) * (1.0 + 9.0 * x * x),
            &|x| (40.0 * (x - at)).exp() - 1.0,
            &|x| if x < at { -1.0 } else { 1e6 },
        ];
        for level in levels {
            let found = crossing(&level, [(0.0, level(0.0)), (0.5, level(0.5))]);
            assert!((found - at).abs() < 1e-9, "{found}");
        }
    }
}

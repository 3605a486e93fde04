//! Ticks at round numbers (1, 2 or 5 times a power of ten), with labels that share their decimals, and at parts of π on
//! the range of an angle.

use std::f64::consts::PI;

use super::symbols;

/// A labelled tick.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Tick {
    /// Where it stands.
    pub(super) value: f64,
    /// Its label, as markup.
    pub(super) label: String,
}

/// The ticks of an axis.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Ticks {
    /// Labelled ticks, ascending.
    pub(super) major: Vec<Tick>,
    /// Places of ticks without label.
    pub(super) minor: Vec<f64>,
    /// Power of ten that the labels are to be multiplied with; it belongs into the axis' title.
    pub(super) exponent: i32,
}

/// At most `most` (at least 2) labelled ticks in `from..=to`, `from < to`.
pub(super) fn ticks(from: f64, to: f64, most: usize) -> Ticks {
    if let Some(ticks) = parts_of_pi(from, to, most.max(2)) {
        return ticks;
    }
    let (step, parts) = step(from, to, most.max(2));
    ticks_at(from, to, (step, parts)).unwrap_or_else(|| outermost(from, to, step))
}

/// The multiples of a step with labels, and its parts without; `None` where fewer than two multiples lie inside.
fn ticks_at(from: f64, to: f64, (step, parts): (f64, i64)) -> Option<Ticks> {
    let exponent = common_exponent(from, to, step);
    let scale = 10f64.powi(exponent);
    // The step is 1, 2 or 5 times a power of ten, which fixes the decimals.
    let decimals = (-(step / scale).log10().floor() + 1e-9).max(0.0) as usize;
    let slack = 1e-9 * (to - from);
    let multiples = |step: f64| {
        let first = ((from - slack) / step).ceil() as i64;
        let last = ((to + slack) / step).floor() as i64;
        first..=last
    };
    let major: Vec<Tick> = multiples(step)
        .map(|multiple| {
            let value = multiple as f64 * step;
            Tick {
                value,
                label: symbols::fixed(value / scale, decimals),
            }
        })
        .collect();
    let part = step / parts as f64;
    let minor = multiples(part)
        .filter(|multiple| multiple.rem_euclid(parts) != 0)
        .map(|multiple| multiple as f64 * part)
        .collect();
    (major.len() > 1).then_some(Ticks {
        major,
        minor,
        exponent,
    })
}

/// Ticks of an axis on which two labels have room and a step has but one multiple inside, which tells no scale: labels
/// at the first and the last multiple of a shorter step.
fn outermost(from: f64, to: f64, step: f64) -> Ticks {
    // The next shorter round step, of which more than the two that have room lie inside.
    let power = 10f64.powf(step.log10().floor());
    let shorter = if step > 4.0 * power && step < 6.0 * power {
        0.4 * step
    } else {
        0.5 * step
    };
    let mut ticks = ticks_at(from, to, (shorter, 1)).unwrap_or(Ticks {
        major: Vec::new(),
        minor: Vec::new(),
        exponent: 0,
    });
    if ticks.major.len() > 2 {
        let last = ticks.major.len() - 1;
        let between = ticks.major.drain(1..last).map(|tick| tick.value);
        ticks.minor = between.collect();
    }
    ticks
}

/// Ticks at π, π/2 or π/4, of an axis that goes around once or a few times from one multiple of π to another: that of
/// an angle.
fn parts_of_pi(from: f64, to: f64, most: usize) -> Option<Ticks> {
    let [low, high] = [from, to].map(|end| (end / PI).round());
    let is_whole = |end: f64, multiple: f64| (end - multiple * PI).abs() <= 1e-12 * (to - from);
    let turns = (high - low) / 2.0;
    if !is_whole(from, low) || !is_whole(to, high) || turns.fract() != 0.0 || turns > 4.0 {
        return None;
    }
    let (low, high) = (low as i64, high as i64);
    let cuts = [4, 2, 1]
        .into_iter()
        .find(|cuts| (high - low) * cuts < most as i64);
    let cuts = cuts.filter(|_| turns > 0.0)?;
    let major = (low * cuts..=high * cuts).map(|part| Tick {
        value: part as f64 * PI / cuts as f64,
        label: part_of_pi(part, cuts),
    });
    // Small ticks stand at sixths, as degrees are counted, or at halves of what is labelled.
    let small = if cuts == 4 { 2 } else { 3 };
    let minor = (low * cuts * small..=high * cuts * small).filter(|part| part % small != 0);
    Some(Ticks {
        major: major.collect(),
        minor: minor
            .map(|part| part as f64 * PI / (cuts * small) as f64)
            .collect(),
        exponent: 0,
    })
}

/// π times a fraction, in lowest terms.
fn part_of_pi(part: i64, cuts: i64) -> String {
    let shared = (1..=cuts).rev().find(|by| part % by == 0 && cuts % by == 0);
    let shared = shared.unwrap_or(1);
    let (part, cuts) = (part / shared, cuts / shared);
    let size = match part.abs() {
        0 => return "0".to_owned(),
        1 => "π".to_owned(),
        more => format!("{more}π"),
    };
    let sign = if part < 0 { "\u{2212}" } else { "" };
    match cuts {
        1 => format!("{sign}{size}"),
        _ => format!("{sign}{size}/{cuts}"),
    }
}

/// Ticks at the powers of ten between two exponents, small ones at 2 to 9 times each; where there are more than `most`
/// powers, every second, third, … is labelled and the others are the small ticks.
pub(super) fn decades(from: f64, to: f64, most: usize) -> Ticks {
    let slack = 1e-9;
    let inside = |exponent: f64| exponent >= from - slack && exponent <= to + slack;
    let powers = from.floor() as i32..=to.ceil() as i32;
    let count = powers
        .clone()
        .filter(|&power| inside(f64::from(power)))
        .count();
    let every = count.div_ceil(most.max(1)).max(1) as i32;
    // Multiples of the step are labelled, or, where that is a single one, the first power and what follows on it.
    let multiples = powers.clone().filter(|&power| inside(f64::from(power)));
    let (first, multiples) = (
        multiples.clone().next().unwrap_or_default(),
        multiples.filter(|power| power.rem_euclid(every) == 0),
    );
    let offset = if multiples.count() < 2 { first } else { 0 };
    let (major, others): (Vec<i32>, Vec<i32>) = powers
        .clone()
        .partition(|power| (power - offset).rem_euclid(every) == 0);
    let major = major
        .into_iter()
        .map(f64::from)
        .filter(|&power| inside(power));
    let minor: Vec<f64> = match every {
        1 => powers
            .flat_map(|power| (2..10).map(move |n| f64::from(power) + f64::from(n).log10()))
            .collect(),
        _ => others.into_iter().map(f64::from).collect(),
    };
    Ticks {
        major: major
            .map(|value| Tick {
                value,
                label: format!("10^{{{}}}", symbols::fixed(value, 0)),
            })
            .collect(),
        minor: minor
            .into_iter()
            .filter(|&exponent| inside(exponent))
            .collect(),
        exponent: 0,
    }
}

/// The smallest round step that gives at most `most` ticks, and into how many parts small ticks cut it.
fn step(from: f64, to: f64, most: usize) -> (f64, i64) {
    let slack = 1e-9 * (to - from);
    let count =
        |step: f64| (((to + slack) / step).floor() - ((from - slack) / step).ceil()) as i64 + 1;
    let smallest = (to - from) / most as f64;
    let mut power = smallest.log10().floor() as i32;
    loop {
        for (factor, parts) in [(1.0, 5), (2.0, 4), (5.0, 5)] {
            // A quotient of whole numbers is the nearest double to the round number.
            let step = if power < 0 {
                factor / 10f64.powi(-power)
            } else {
                factor * 10f64.powi(power)
            };
            if count(step) <= most as i64 {
                return (step, parts);
            }
        }
        power += 1;
    }
}

/// Zero, unless plain decimals would be long.
fn common_exponent(from: f64, to: f64, step: f64) -> i32 {
    let largest = from.abs().max(to.abs());
    if !(1e-2..1e5).contains(&largest) || (step < 1e-4 && largest < 0.1) {
        (largest * (1.0 + 1e-9)).log10().floor() as i32
    } else {
        0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn labels(from: f64, to: f64, most: usize) -> Vec<String> {
        let major = ticks(from, to, most).major.into_iter();
        major.map(|tick| tick.label).collect()
    }

    #[test]
    fn an_angle_has_parts_of_pi() {
        let whole = std::f64::consts::PI;
        assert_eq!(labels(-whole, whole, 7), ["−π", "−π/2", "0", "π/2", "π"]);
        assert_eq!(labels(0.0, 2.0 * whole, 9).len(), 9);
        assert_eq!(labels(0.0, 2.0 * whole, 9)[3], "3π/4");
        assert_eq!(labels(-whole, whole, 3), ["−π", "0", "π"]);
        // Half a turn is no angle's range, and too few labels for parts of π are round numbers.
        assert_eq!(labels(0.0, whole, 7), labels(0.0, 3.1, 7));
        assert_eq!(labels(-whole, whole, 2), labels(-3.1, 3.1, 2));
    }

    #[test]
    fn usual_axes_get_the_usual_labels() {
        assert_eq!(labels(-1.0, 0.5, 5), ["−1.0", "−0.5", "0", "0.5"]);
        assert_eq!(
            labels(-0.02, 0.01, 7),
            [
                "−0.020", "−0.015", "−0.010", "−0.005", "0", "0.005", "0.010"
            ]
        );
        assert_eq!(labels(0.0, 30.0, 4), ["0", "10", "20", "30"]);
        assert_eq!(labels(-2.5, 2.5, 6), ["−2", "−1", "0", "1", "2"]);
    }

    #[test]
    fn small_and_large_values_share_a_power_of_ten() {
        let small = ticks(0.0, 3e-6, 5);
        assert_eq!(small.exponent, -6);
        assert_eq!(small.major.last().unwrap().label, "3");
        let large = ticks(0.0, 2e7, 3);
        assert_eq!((large.exponent, large.major[2].label.as_str()), (7, "2"));
    }

    #[test]
    fn decades_are_labelled_and_divided() {
        let ticks = decades(-2.1, 1.0, 7);
        let labels: Vec<&str> = ticks.major.iter().map(|tick| tick.label.as_str()).collect();
        assert_eq!(labels, ["10^{−2}", "10^{−1}", "10^{0}", "10^{1}"]);
        // 0.008 and 0.009 below 10⁻², and eight in each of three decades.
        assert_eq!(ticks.minor.len(), 26);
    }

    #[test]
    fn an_axis_with_little_room_has_two_labels() {
        assert_eq!(labels(-0.35, 0.35, 2), ["−0.2", "0.2"]);
        assert_eq!(labels(-0.45, 0.45, 2), ["−0.4", "0.4"]);
        let decades = |from: f64, to: f64| {
            let major = decades(from, to, 2).major.into_iter();
            major.map(|tick| tick.value).collect::<Vec<_>>()
        };
        assert_eq!(decades(-11.3, -8.6), [-11.0, -9.0]);
        assert_eq!(decades(-8.4, -3.7), [-8.0, -5.0]);
    }

    proptest! {
        #[test]
        fn ticks_are_few_ascending_inside_and_labelled_apart(
            from in -1e3..1e3f64, exponent in -4.0..4.0f64, most in 2usize..9,
        ) {
            let to = from + 10f64.powf(exponent);
            let ticks = ticks(from, to, most);
            let slack = 1e-6 * (to - from);
            prop_assert!((2..=most).contains(&ticks.major.len()), "{ticks:?}");
            for pair in ticks.major.windows(2) {
                prop_assert!(pair[0].value < pair[1].value);
                prop_assert_ne!(&pair[0].label, &pair[1].label);
            }
            for tick in &ticks.major {
                prop_assert!(tick.value >= from - slack && tick.value <= to + slack);
                let read: f64 = tick.label.replace('−', "-").parse().unwrap();
                let error = read * 10f64.powi(ticks.exponent) - tick.value;
                prop_assert!(error.abs() <= slack, "{tick:?}");
            }
        }
    }
}

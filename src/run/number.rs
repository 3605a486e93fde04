//! Numbers as text: exact for tables, rounded to their error for people.

/// The shortest text that reads back as the same number; powers of ten outside 1e-4 … 1e15. Empty for values that
/// are not finite, which tables never show as numbers.
pub(crate) fn format_number(value: f64) -> String {
    if !value.is_finite() {
        return String::new();
    }
    let magnitude = value.abs();
    if value == 0.0 {
        "0".to_owned()
    } else if (1e-4..1e15).contains(&magnitude) {
        format!("{value}")
    } else {
        format!("{value:e}")
    }
}

/// Errors from here on are given as powers of ten, and values from its square on.
const LARGEST_IN_DIGITS: f64 = 1e6;

/// A value and its error, both to the error's second significant digit, for example `("-0.0123", "0.0045")`.
/// Without an error the value is given to twelve digits: the last ones of a value of a sweep are rounding.
pub(crate) fn format_with_error(value: f64, error: f64) -> (String, String) {
    if !(error > 0.0 && error.is_finite() && value.is_finite()) {
        let rounded = format!("{value:.11e}").parse().unwrap_or(value);
        return (format_number(rounded), format_number(error));
    }
    if error >= LARGEST_IN_DIGITS || value.abs() >= LARGEST_IN_DIGITS * LARGEST_IN_DIGITS {
        let digits = (value.abs() / error).log10().floor() + 1.0;
        let digits = if digits.is_finite() {
            digits.clamp(0.0, 15.0) as usize
        } else {
            1
        };
        return (format!("{value:.digits$e}"), format!("{error:.1e}"));
    }
    let decimals = (1.0 - error.log10().floor()).clamp(0.0, 15.0) as usize;
    let text = |number: f64| {
        let text = format!("{number:.decimals$}");
        // A value that rounds to zero has no sign.
        match text.strip_prefix('-') {
            Some(rest) if rest.chars().all(|c| matches!(c, '0' | '.')) => rest.to_owned(),
            _ => text,
        }
    };
    (text(value), text(error))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn values_are_rounded_to_their_error() {
        let pair = |value, error| format_with_error(value, error);
        assert_eq!(pair(-0.012345, 0.0045), ("-0.0123".into(), "0.0045".into()));
        assert_eq!(pair(12.0, 3.0), ("12.0".into(), "3.0".into()));
        assert_eq!(pair(-1e-9, 0.01), ("0.000".into(), "0.010".into()));
        assert_eq!(pair(0.5, 0.0), ("0.5".into(), "0".into()));
        assert_eq!(pair(-0.6 + 23.0 / 64.0, 0.0).0, "-0.240625");
        assert_eq!(pair(5.43e35, 7.5e34), ("5.4e35".into(), "7.5e34".into()));
        assert_eq!(pair(-2.0, 7.53e34), ("-2e0".into(), "7.5e34".into()));
        assert_eq!(pair(123456.0, 200.0), ("123456".into(), "200".into()));
        assert_eq!(format_number(f64::NAN), "");
        assert_eq!(format_number(-0.0), "0");
    }

    proptest! {
        #[test]
        fn numbers_read_back_exactly(value in proptest::num::f64::NORMAL) {
            prop_assert_eq!(format_number(value).parse::<f64>().unwrap(), value);
        }
    }
}

//! An independent reader and evaluators of formulas, and random formulas.

pub(crate) mod evaluate;
pub(crate) mod random;
pub(crate) mod read;

use pbif::formula::scope::{Scope, Symbols};

pub(crate) const STATES: [&str; 3] = ["x", "y", "z"];
pub(crate) const PARAMETERS: [&str; 4] = ["a", "β", "c0", "f_c"];
pub(crate) const PARAMETER_VALUES: [f64; 4] = [1.25, -0.5, 0.3, 2.0];

pub(crate) fn scope() -> Scope {
    let mut symbols = Symbols::default();
    for name in STATES {
        symbols.add_state(name).unwrap();
    }
    for name in PARAMETERS {
        symbols.add_parameter(name).unwrap();
    }
    symbols.define("H", "y^2/2 + a x^2").unwrap();
    Scope::new(symbols).unwrap()
}

/// The value of a name at a state and time, for the independent evaluators.
pub(crate) fn lookup(state: &[f64; 3], time: f64) -> impl Fn(&str) -> Option<f64> + '_ {
    move |name| {
        let name = name
            .replace('₀', "0")
            .replace("beta", "β")
            .replace("c_0", "c0");
        if let Some(number) = STATES.iter().position(|own| **own == name) {
            return Some(state[number]);
        }
        if let Some(number) = PARAMETERS.iter().position(|own| **own == name) {
            return Some(PARAMETER_VALUES[number]);
        }
        match name.as_str() {
            "t" => Some(time),
            "pi" | "π" => Some(std::f64::consts::PI),
            "e" => Some(std::f64::consts::E),
            _ => None,
        }
    }
}

pub(crate) fn same(a: f64, b: f64) -> bool {
    a.to_bits() == b.to_bits() || (a.is_nan() && b.is_nan())
}

/// States that are worth trying, and random ones.
pub(crate) fn states(random: &mut random::Random, count: usize) -> Vec<[f64; 3]> {
    let mut states = vec![
        [0.0; 3],
        [-0.0, 1.0, -1.0],
        [2.0, -0.5, 1e-3],
        [1e200, -1e200, 3.0],
        [f64::NAN, 1.0, f64::INFINITY],
    ];
    states.truncate(count);
    while states.len() < count {
        states.push(std::array::from_fn(|_| 4.0 * random.unit() - 2.0));
    }
    states
}

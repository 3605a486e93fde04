//! Equations as lines of text and as their layouts: what a model shows of itself.

use crate::formula::mathml::{self, Element};

/// A line of a model's equations, and the same typeset.
pub(in crate::system) type Statement = (String, Element);

/// `left = right + amplitude noise(t) + …`; left may be a name with primes, and another relation stand between.
pub(in crate::system) fn equation(
    left: &str,
    relation: &str,
    right: &str,
    noises: &[(String, String)],
) -> Statement {
    let mut line = format!("{left} {relation} {right}");
    for (amplitude, noise) in noises {
        line.push_str(&format!(" + {amplitude} {noise}(t)"));
    }
    let layout = mathml::equation(left, relation, right, noises);
    let layout = layout.unwrap_or_else(|_| mathml::words(&line));
    (line, layout)
}

/// That noises are white and of unit intensity: of one noise, or of `several` that are independent; with how they are
/// read.
pub(in crate::system) fn white(noise: &str, several: bool, lag: &str, read: &str) -> Statement {
    let (names, delta) = if several {
        ([format!("{noise}_i"), format!("{noise}_j")], "δ_ij ")
    } else {
        ([noise.to_owned(), noise.to_owned()], "")
    };
    let [one, other] = &names;
    let line = format!("E[{one}(t) {other}(t+{lag})] = {delta}δ({lag}){read}");
    let layout = mathml::correlation([one, other], delta.trim_end(), lag, read);
    (line, layout)
}

/// The line with absolute values between bars.
pub(super) fn with_bars(mut statement: Statement) -> Statement {
    let line = &mut statement.0;
    while let Some(begin) = line.find("abs(") {
        let mut depth = 0;
        let end = line[begin..].find(|c| {
            depth += i32::from(c == '(') - i32::from(c == ')');
            c == ')' && depth == 0
        });
        let Some(length) = end else { break };
        line.replace_range(begin + length..=begin + length, "|");
        line.replace_range(begin..begin + "abs(".len(), "|");
    }
    statement
}

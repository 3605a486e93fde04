//! The column `findings`: codes and numbers of what a point's solve found, such as
//! `escaping:0.012:3e-5;edge-mass-x:0.0031:-8:8`.

use super::number::format_number;
use crate::continuation::Finding;
use crate::system::Family;

/// Findings as one cell, joined by `;`: the code, with the name of the axis where it has one, then the numbers, each
/// after a `:`. Sentences of an older run have no code: the column `warnings` has them.
pub(super) fn findings_cell(family: &Family, findings: &[Finding]) -> String {
    cell(family, findings, &|number| number)
}

/// The same with numbers of three digits: those of nodes of a map depend in the last ones on which neighbour was solved
/// before.
pub(super) fn rounded_findings_cell(family: &Family, findings: &[Finding]) -> String {
    let rounded = |number: f64| format!("{number:.2e}").parse().unwrap_or(number);
    cell(family, findings, &rounded)
}

fn cell(family: &Family, findings: &[Finding], digits: &dyn Fn(f64) -> f64) -> String {
    let coded = findings
        .iter()
        .filter(|one| !matches!(one, Finding::Told(_)));
    let words: Vec<String> = coded.map(|finding| word(family, finding, digits)).collect();
    words.join(";")
}

fn word(family: &Family, finding: &Finding, digits: &dyn Fn(f64) -> f64) -> String {
    let (code, axis, numbers) = finding.parts();
    let mut word = code.to_owned();
    if let Some(axis) = axis {
        word += "-";
        word += family.axis(axis);
    }
    for number in numbers.into_iter().map(digits) {
        word += ":";
        // An estimate that has overflowed is not a number, and is told so.
        if number.is_finite() {
            word += &format_number(number)
        } else {
            word += &number.to_string()
        }
    }
    word
}

/// Findings read back; the first word that is none as an error.
pub(super) fn parse_findings<'t>(family: &Family, cell: &'t str) -> Result<Vec<Finding>, &'t str> {
    let words = cell.split(';').filter(|word| !word.is_empty());
    words.map(|word| parse(family, word).ok_or(word)).collect()
}

fn parse(family: &Family, word: &str) -> Option<Finding> {
    let mut parts = word.split(':');
    let name = parts.next()?;
    let numbers: Result<Vec<f64>, _> = parts.map(str::parse).collect();
    let numbers = numbers.ok()?;
    let whole = Finding::from_parts(name, None, &numbers);
    whole.or_else(|| {
        let (code, axis) = name.rsplit_once('-')?;
        let axes = 0..family.model().axes.len();
        let axis = axes.into_iter().find(|&index| family.axis(index) == axis)?;
        Finding::from_parts(code, Some(axis), &numbers)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::continuation::every_finding;
    use crate::run::finding_in_words;
    use crate::system::test_families::coulomb;

    #[test]
    fn findings_are_read_back_bit_for_bit() {
        let mut findings = every_finding();
        let cell = findings_cell(&coulomb(), &findings);
        findings.retain(|finding| !matches!(finding, Finding::Told(_)));
        assert_eq!(parse_findings(&coulomb(), &cell), Ok(findings));
        assert!(
            cell.starts_with("escaping:0.012:3.3333333333333335e-5;no-steady-state:0.1:20:0.5;")
        );
        assert!(cell.contains(";edge-mass-y:0.003:-8:8;"));
        assert!(
            !cell.contains([',', '"', '\n']),
            "a cell of CSV without quotes"
        );
        assert_eq!(parse_findings(&coulomb(), ""), Ok(Vec::new()));
    }

    #[test]
    fn words_that_are_no_finding_are_named() {
        for word in ["escaping", "edge-mass-z:1:2:3", "escaping:a:b", "magic:1"] {
            let cell = format!("outside:0.5;{word}");
            assert_eq!(parse_findings(&coulomb(), &cell), Err(word));
        }
    }

    #[test]
    fn every_finding_has_words_of_its_own() {
        let mut said: Vec<String> = Vec::new();
        for finding in every_finding() {
            let words = finding_in_words(&coulomb(), &finding);
            assert!(words.contains(' ') && !said.contains(&words), "{words}");
            said.push(words);
        }
    }
}

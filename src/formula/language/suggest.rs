//! The nearest known name for one that is not known.

use std::collections::HashSet;

use super::spelling::canonical_name;
use crate::formula::limits;

/// The names that a formula may use: how they are written, by canonical name.
#[derive(Debug, Default)]
pub(crate) struct Known {
    names: Vec<(String, String)>,
}

impl Known {
    /// Adds a name as it is written.
    pub(crate) fn add(&mut self, written: &str) {
        self.names
            .push((canonical_name(written), written.to_owned()));
    }

    /// The nearest name, if one is near.
    pub(crate) fn nearest(&self, name: &str) -> Option<String> {
        let name = canonical_name(name);
        let known = self.names.iter().map(|(canonical, _)| canonical.as_str());
        let nearest = nearest(&name, known)?;
        let entry = self
            .names
            .iter()
            .find(|(canonical, _)| *canonical == nearest)?;
        Some(entry.1.clone())
    }

    /// A name split into known names, as in `c1 x` for `c1x`; fewest factors first.
    pub(crate) fn product(&self, name: &str) -> Option<String> {
        let name = canonical_name(name);
        if name.len() > limits::NAME_LENGTH || !name.is_ascii() {
            return None;
        }
        let known: HashSet<&str> = self.names.iter().map(|(name, _)| name.as_str()).collect();
        // best[end]: the fewest pieces that make up the first `end` bytes, and where the last begins.
        let mut best: Vec<Option<(usize, usize)>> = vec![None; name.len() + 1];
        best[0] = Some((0, 0));
        for end in 1..=name.len() {
            for start in 0..end {
                let Some((pieces, _)) = best[start] else {
                    continue;
                };
                let shorter = best[end].is_none_or(|(most, _)| pieces + 1 < most);
                if shorter && known.contains(&name[start..end]) {
                    best[end] = Some((pieces + 1, start));
                }
            }
        }
        let (mut end, mut pieces) = (name.len(), Vec::new());
        while end > 0 {
            let (_, start) = best[end]?;
            pieces.push(&name[start..end]);
            end = start;
        }
        pieces.reverse();
        (2..=4).contains(&pieces.len()).then(|| pieces.join(" "))
    }
}

/// The candidate nearest to `name`, if it differs by at most a third of its letters, case apart.
pub(crate) fn nearest<'a>(
    name: &str,
    candidates: impl Iterator<Item = &'a str>,
) -> Option<&'a str> {
    let length = name.chars().count();
    if length > limits::NAME_LENGTH {
        return None;
    }
    let lower = name.to_lowercase();
    let distance = |candidate: &str| {
        let plain = strsim::damerau_levenshtein(name, candidate);
        let without_case = strsim::damerau_levenshtein(&lower, &candidate.to_lowercase());
        // Names that differ in case alone are as near as names can be.
        (without_case, plain)
    };
    let limit = (length / 3).max(1);
    let near = candidates.map(|candidate| (distance(candidate), candidate));
    let near = near.filter(|((without_case, _), candidate)| {
        *without_case <= limit && *without_case < candidate.chars().count()
    });
    near.min_by_key(|(distance, _)| *distance)
        .map(|(_, candidate)| candidate)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn near_names_are_found_and_far_ones_are_not() {
        let names = ["alpha", "kappa", "f_c", "x", "sigma2"];
        for (name, expected) in [
            ("alhpa", Some("alpha")),
            ("Kappa", Some("kappa")),
            ("fc", Some("f_c")),
            ("X", Some("x")),
            ("sigma", Some("sigma2")),
            ("q", None),
            ("theta", None),
        ] {
            assert_eq!(nearest(name, names.into_iter()), expected, "{name}");
        }
    }

    #[test]
    fn names_run_together_are_taken_apart() {
        let mut known = Known::default();
        for name in ["c0", "c1", "c", "x", "y", "ω"] {
            known.add(name);
        }
        assert_eq!(known.product("c1x").as_deref(), Some("c1 x"));
        assert_eq!(known.product("ωxy").as_deref(), Some("omega x y"));
        assert_eq!(known.product("xq"), None);
        assert_eq!(known.product("c1"), None);
    }
}

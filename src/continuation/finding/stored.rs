//! Findings in files of text: each as its code, its axis and its numbers, which may be none of JSON's.

use serde::de::Error;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use super::Finding;

/// Code, axis, and numbers as text.
type Stored = (String, Option<usize>, Vec<String>);

/// Writes findings. Sentences have no numbers that would bring them back, and are left out.
///
/// # Errors
/// Those of the serializer.
pub(crate) fn serialize<S: Serializer>(
    findings: &[Finding],
    serializer: S,
) -> Result<S::Ok, S::Error> {
    let coded = findings
        .iter()
        .filter(|one| !matches!(one, Finding::Told(_)));
    let stored: Vec<Stored> = coded
        .map(|finding| {
            let (code, axis, numbers) = finding.parts();
            let numbers = numbers.iter().map(f64::to_string);
            (code.to_owned(), axis, numbers.collect())
        })
        .collect();
    stored.serialize(serializer)
}

/// Reads them back.
///
/// # Errors
/// Those of the deserializer; for what is no finding.
pub(crate) fn deserialize<'de, D: Deserializer<'de>>(
    deserializer: D,
) -> Result<Vec<Finding>, D::Error> {
    let stored = Vec::<Stored>::deserialize(deserializer)?;
    let finding = |(code, axis, numbers): &Stored| {
        let numbers: Result<Vec<f64>, _> = numbers.iter().map(|one| one.parse()).collect();
        Finding::from_parts(code, *axis, &numbers.ok()?)
    };
    let found = stored.iter().map(|one| {
        let unknown = || D::Error::custom(format!("`{}` is no finding", one.0));
        finding(one).ok_or_else(unknown)
    });
    found.collect()
}

#[cfg(test)]
mod tests {
    use super::super::tests::every_finding;
    use super::*;

    #[derive(Debug, PartialEq, Serialize, Deserialize)]
    struct Holder(#[serde(with = "super")] Vec<Finding>);

    #[test]
    fn findings_come_back_from_json_with_numbers_that_are_none() {
        let mut all = every_finding();
        all.push(Finding::WideCells {
            axis: 1,
            peclet: f64::INFINITY,
        });
        let text = serde_json::to_string(&Holder(all.clone())).unwrap();
        all.retain(|one| !matches!(one, Finding::Told(_)));
        assert_eq!(serde_json::from_str::<Holder>(&text).unwrap(), Holder(all));
        let unknown = r#"[["magic",null,["1"]]]"#;
        assert!(serde_json::from_str::<Holder>(unknown).is_err());
    }
}

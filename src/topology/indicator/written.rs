//! Indicators by the words that no other has, for whatever speaks serde.

use serde::de::Error as _;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use super::IndicatorKind;

impl Serialize for IndicatorKind {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        to.serialize_str(self.code())
    }
}

impl<'de> Deserialize<'de> for IndicatorKind {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        let code = String::deserialize(from)?;
        Self::of_code(&code)
            .ok_or_else(|| D::Error::custom(format_args!("`{code}` is no indicator")))
    }
}

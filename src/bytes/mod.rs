//! What a program keeps for itself, such as the state of unfinished work, as bytes and back, the same to the bit.
//! Tables and arrays that others read are written by [`run`](crate::run).

use std::sync::Arc;

use serde::de::DeserializeOwned;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

/// Bytes that are not what was written.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("the bytes are not what was written")]
pub(crate) struct NotWhatWasWritten;

/// A value as bytes. Lists know their lengths, so that nothing keeps them from being written.
pub(crate) fn to_bytes<T: Serialize + ?Sized>(value: &T) -> Vec<u8> {
    postcard::to_stdvec(value).unwrap_or_default()
}

/// What was written. Whatever the bytes are, no more memory is taken than they have.
///
/// # Errors
/// [`NotWhatWasWritten`].
pub(crate) fn from_bytes<T: DeserializeOwned>(bytes: &[u8]) -> Result<T, NotWhatWasWritten> {
    postcard::from_bytes(bytes).map_err(|_| NotWhatWasWritten)
}

/// Something shared that may be missing, by its content: for `#[serde(with = "crate::bytes")]`.
pub(crate) fn serialize<T: Serialize, S: Serializer>(
    shared: &Option<Arc<T>>,
    to: S,
) -> Result<S::Ok, S::Error> {
    shared.as_deref().serialize(to)
}

/// What was written.
pub(crate) fn deserialize<'de, T: Deserialize<'de>, D: Deserializer<'de>>(
    from: D,
) -> Result<Option<Arc<T>>, D::Error> {
    Ok(Option::deserialize(from)?.map(Arc::new))
}

//! The list of built-in models. A new model is one file beside this one and one line here.

use super::friction::{coulomb, dahl};
use super::{Model, SystemError, bistable, rayleigh};

/// Every built-in model, in the order in which they are listed.
pub static MODELS: &[&Model] = &[
    &coulomb::MODEL,
    &dahl::MODEL,
    &dahl::MODEL_EQ8,
    &rayleigh::MODEL,
    &bistable::MODEL,
];

/// The model of that name.
///
/// # Errors
/// [`SystemError::UnknownModel`].
pub fn find(name: &str) -> Result<&'static Model, SystemError> {
    MODELS
        .iter()
        .copied()
        .find(|model| model.name == name)
        .ok_or_else(|| SystemError::UnknownModel {
            name: name.to_owned(),
        })
}

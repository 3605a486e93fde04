//! The list of built-in models. A new model is one file beside this one and one line here.

use std::sync::{Arc, LazyLock};

use super::friction::{bliman_sorine, bouc_wen, coulomb, dahl, elasto_plastic, lugre, stribeck};
use super::{Model, SystemError, TypedModel, bistable, rayleigh};

static MODELS: LazyLock<Vec<Arc<Model>>> = LazyLock::new(|| {
    let models = typed().into_iter();
    models.filter_map(|model| model.build().ok()).collect()
});

/// The built-in models as their formulas; a test builds each.
fn typed() -> [TypedModel; 11] {
    [
        coulomb::model(),
        dahl::model(),
        dahl::model_eq8(),
        stribeck::model(),
        stribeck::model_cubic(),
        lugre::model(),
        elasto_plastic::model(),
        bouc_wen::model(),
        bliman_sorine::model(),
        rayleigh::model(),
        bistable::model(),
    ]
}

/// Every built-in model, in the order in which they are listed.
pub fn models() -> &'static [Arc<Model>] {
    &MODELS
}

/// The built-in model of that name.
///
/// # Errors
/// [`SystemError::UnknownModel`].
pub fn find(name: &str) -> Result<Arc<Model>, SystemError> {
    let mut models = models().iter();
    let found = models.find(|model| model.name == name).cloned();
    found.ok_or_else(|| SystemError::UnknownModel {
        name: name.to_owned(),
    })
}

#[cfg(test)]
mod tests {
    #[test]
    fn the_formulas_of_every_model_are_right() {
        for model in super::typed() {
            let built = model.build();
            assert!(built.is_ok(), "{}", built.unwrap_err());
        }
    }
}

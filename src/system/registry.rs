//! The list of built-in models. A new model is one file beside this one and one line here.

use std::sync::{Arc, LazyLock, Mutex, MutexGuard, PoisonError, Weak};

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

/// Models that somebody holds and sweep files may name.
static LENT: Mutex<Vec<Weak<Model>>> = Mutex::new(Vec::new());

/// The models that were lent and are still held, with the list in which they are.
fn lent() -> MutexGuard<'static, Vec<Weak<Model>>> {
    let mut lent = LENT.lock().unwrap_or_else(PoisonError::into_inner);
    lent.retain(|model| model.strong_count() > 0);
    lent
}

/// Lets sweep files of this process name a model that is not built in, for as long as it is held. The latest of a name
/// counts; a built-in model is not hidden by another of its name.
///
/// ```
/// use std::sync::Arc;
/// use pbif::system::{TypedModel, registry};
///
/// let typed = TypedModel::new("mine", "Mine", ["x"]).with_equation("x", "-x").with_noise("x", ["0.5"]);
/// let mine = Arc::new(typed.build()?);
/// registry::lend(&mine);
/// assert!(registry::find("mine").is_ok());
/// drop(mine);
/// assert!(registry::find("mine").is_err());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn lend(model: &Arc<Model>) {
    lent().push(Arc::downgrade(model));
}

/// The model of that name: built in, or [lent](lend).
///
/// # Errors
/// [`SystemError::UnknownModel`].
pub fn find(name: &str) -> Result<Arc<Model>, SystemError> {
    let mut models = models().iter();
    let found = models.find(|model| model.name == name).cloned();
    let of_others = || {
        let held = lent();
        let mut held = held.iter().rev().filter_map(Weak::upgrade);
        held.find(|model| model.name == name)
    };
    found
        .or_else(of_others)
        .ok_or_else(|| SystemError::UnknownModel {
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

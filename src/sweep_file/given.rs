//! The names that a sweep file gives, with their places.

use super::bins::quantity_place;
use super::diagnostic::Place;
use super::settings::Settings;
use super::value::Value;

impl Settings {
    /// Names of the parameters that are moved, of axes, of quantities and of passages, where the file gives them.
    pub(crate) fn given_names(&self) -> Vec<(String, Place)> {
        let root = &self.document.root;
        let sections = ["sweep", "map", "curve"].into_iter();
        let moved = sections.filter_map(|section| {
            let node = &root.find(&[section, "parameter"])?.node;
            match &node.value {
                Value::Text(name) => Some((name.clone(), node.place.clone())),
                _ => None,
            }
        });
        let equations = root.find(&["system", "equations"]).into_iter();
        let axes = equations.flat_map(|table| table.node.entries());
        let axes = axes.map(|entry| (entry.key.clone(), entry.key_place.clone()));
        let quantities = self.family.quantities().iter();
        let quantities = quantities
            .chain(&self.family.questions.averaged)
            .filter_map(|one| {
                let name = one.name();
                Some((name.to_owned(), quantity_place(&self.document, name)?))
            });
        let passages = root.find(&["passage"]).into_iter();
        let passages = passages.flat_map(|table| table.node.entries());
        let passages = passages.map(|entry| (entry.key.clone(), entry.key_place.clone()));
        moved
            .chain(axes)
            .chain(quantities)
            .chain(passages)
            .collect()
    }
}

//! The equations of a model, typeset.

use super::Model;
use crate::formula::mathml::{Element, stated};

impl Model {
    /// The lines of [`Model::equations`] as MathML: typed equations from their formulas, others as they are stated.
    ///
    /// ```
    /// let model = pbif::system::registry::find("coulomb")?;
    /// let first = model.typeset()[0].to_string();
    /// assert!(first.starts_with("<mrow><mover") && first.ends_with("<mo>=</mo><mi>y</mi></mrow>"), "{first}");
    /// # Ok::<(), pbif::system::SystemError>(())
    /// ```
    pub fn typeset(&self) -> Vec<Element> {
        let typed = self.typed().map(|typed| typed.source().typeset());
        let typed = typed.unwrap_or_default();
        let lines = self.equations.iter();
        let element = lines.map(|line| {
            let known = typed.iter().find(|(own, _)| own == line);
            known.map_or_else(|| stated(line), |(_, element)| element.clone())
        });
        element.collect()
    }
}

#[cfg(test)]
mod tests {
    use crate::formula::mathml::{Content, Element};
    use crate::system::registry::models;

    fn has_words(element: &Element, word: &str) -> bool {
        match &element.content {
            Content::Text(text) => element.tag == "mtext" && text.contains(word),
            Content::Elements(inner) => inner.iter().any(|one| has_words(one, word)),
        }
    }

    /// Signs of mathematics that are left as text were not understood.
    #[test]
    fn every_built_in_model_is_typeset_to_its_last_sign() {
        for model in models() {
            let laid = model.typeset();
            assert_eq!(laid.len(), model.equations.len());
            for (line, element) in model.equations.iter().zip(&laid) {
                for sign in ["=", "(", "|", "√", "+", "'"] {
                    assert!(
                        !has_words(element, sign),
                        "{}: {line}: {element}",
                        model.name
                    );
                }
            }
        }
    }
}

//! Values of expressions, by the expressions' numbers.

use super::Expression;

/// A value for each of some expressions.
#[derive(Debug, Clone)]
pub(crate) struct PartMap<T> {
    values: Vec<Option<T>>,
}

impl<T: Copy> PartMap<T> {
    /// The same value for each of `parts`.
    pub(crate) fn new(parts: &[Expression], value: T) -> Self {
        let mut map = Self { values: Vec::new() };
        map.values
            .resize(parts.last().map_or(0, |last| last.0 as usize + 1), None);
        for &part in parts {
            map.set(part, value);
        }
        map
    }

    /// The value of an expression, if it is one of them.
    pub(crate) fn get(&self, expression: Expression) -> Option<T> {
        self.values.get(expression.0 as usize).copied().flatten()
    }

    /// Sets the value of one of them.
    pub(crate) fn set(&mut self, expression: Expression, value: T) {
        if let Some(place) = self.values.get_mut(expression.0 as usize) {
            *place = Some(value);
        }
    }
}

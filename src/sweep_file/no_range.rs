//! What is said where free trajectories found no range: along which axis, at which value, and what helps.

use super::diagnostic::Diagnostic;
use super::settings::{Settings, at_cells};
use super::verify::short;
use crate::method::{RangeError, repeats_along};

impl Settings {
    /// Why no ranges were found: along which axis, at which value, and what helps.
    pub(super) fn no_range(&self, error: &RangeError) -> Diagnostic {
        let at = |system: &usize, axis: &usize| {
            let swept = self.family.parameter();
            let (model, corners) = (self.family.model(), self.corners());
            let place = model.parameters.iter().position(|one| one.name == swept);
            let value =
                place.and_then(|place| corners.get(*system)?.as_slice().get(place).copied());
            let value = value.map_or(String::new(), |value| {
                format!(" at {swept} = {}", short(value))
            });
            let remedy = self.remedy_of_range(*axis);
            (self.family.axis(*axis).to_owned(), value, remedy)
        };
        let found = |title: String, axis: &str, remedy: String| {
            let found = Diagnostic::new(title).remedy(remedy);
            match self.document.root.find(&["cells", axis]) {
                Some(entry) => found.at(&entry.key_place, "its range is left to the program"),
                None => at_cells(&self.document, found),
            }
        };
        match error {
            RangeError::RunsAway { system, axis } | RangeError::Turns { system, axis } => {
                let (axis, value, remedy) = at(system, axis);
                found(format!("{error} range of `{axis}`{value}"), &axis, remedy)
            }
            RangeError::TooLong {
                system, axis, last, ..
            } => {
                let (axis, value, remedy) = at(system, axis);
                let (from, to) = (short(last.0), short(last.1));
                let title =
                    format!("{error}{value}: whether {from} to {to} holds `{axis}` was still open");
                found(title, &axis, remedy)
            }
            RangeError::Cancelled(_) => Diagnostic::new(error.to_string()),
            RangeError::Space(_) => {
                let found = Diagnostic::new(error.to_string());
                let remedy = "give `from` and `to` instead of `range = \"auto\"`";
                at_cells(&self.document, found.remedy(remedy))
            }
        }
    }

    /// What helps where no range of an axis was found.
    fn remedy_of_range(&self, axis: usize) -> String {
        let (name, model) = (self.family.axis(axis), self.family.model());
        let ends = self.axes[axis].ends;
        let corners = self.corners();
        let repeats = |values| repeats_along(model.system(values).as_ref(), axis);
        if model.typed().is_some() && corners.first().is_some_and(repeats) {
            return format!(
                "every equation repeats itself with {name} + 2 pi, so {name} may be an angle: add [system.bounds] with \
                 `{name} = \"periodic\"` (docs/angles.md)"
            );
        }
        if ends == [None; 2] && self.positive(&[]).contains(&axis) {
            return format!(
                "no path crosses {name} = 0 downward, where its noise vanishes and its drift does not lead out: give \
                 `cells.{name}.from = 0`, and the other end is found"
            );
        }
        let is_unsaid = self.document.root.find(&["cells", name, "from"]).is_none();
        if ends == [Some(0.0), None] && is_unsaid {
            return format!(
                "{name} was looked at from 0 on, as no path crosses {name} = 0 downward: give `cells.{name}.to = 0` for \
                 the negative side, or `cells.{name}.to` with another end"
            );
        }
        let open = match ends {
            [Some(_), None] => "`to`".to_owned(),
            [None, Some(_)] => "`from`".to_owned(),
            _ => format!("`cells.{name}.from` and `to`"),
        };
        let bounds = match model.typed() {
            Some(_) => format!(
                "; where the equations themselves keep `{name}` inside ends, name these in [system.bounds]"
            ),
            None => String::new(),
        };
        format!("give {open}{bounds}")
    }
}

//! What is said of curves in their plane: the caption of the figure, and the table of its numbers.

use super::Scene;
use crate::continuation::curve::codimension_two;
use crate::figure::canvas::symbols;
use crate::figure::parts::caption;
use crate::figure::print::Print;

impl Scene<'_> {
    pub(super) fn caption(&self, print: &Print<'_>) -> String {
        let mut text = self.first_in_words();
        text += &self.stability.caption();
        text += &self.levels.caption();
        text += &self.crossed.caption();
        let [_, second] = self.plane.sides();
        // What is said of a fixed point alone follows from the equations.
        let solved_by = match (self.curves, self.levels.curves) {
            ([], []) => "",
            _ => &print.solved_by,
        };
        format!(
            "{text} {}\n",
            caption::of_plane(self.family, &second.parameter, solved_by)
        )
    }

    /// What the caption says of the first curve and of points of codimension two.
    fn first_in_words(&self) -> String {
        let sides = self.plane.sides();
        let [first, second] = sides
            .each_ref()
            .map(|side| caption::parameter_named(self.family, &side.parameter));
        // What is next to nothing in the box is zero but for rounding.
        let value = |value: f64, side: usize| match sides[side].length() {
            length if value.abs() < 1e-9 * length => 0.0,
            _ => symbols::rounded(value),
        };
        let Some(curve) = self.curves.first() else {
            let what = match self.levels.curves.first() {
                Some(curve) => format!("Where {}", caption::in_letters(&self.levels.words(curve))),
                None => "The fixed point".to_owned(),
            };
            return format!(
                "{what} in the plane of {first} and {second}, begun at {} at {first} = {}.",
                self.row.label,
                value(self.row.value, 0),
            );
        };
        let errors = curve.points.iter().map(|point| point.error);
        let largest = errors.fold(0.0, f64::max);
        let mut text = format!(
            "Where the {} of the steady-state density {} is zero, in the plane of {first} and {second}, \
             followed from {} at {first} = {}.",
            curve.kind.name(),
            caption::density(self.family, curve.observable),
            self.row.label,
            value(self.row.value, 0),
        );
        for end in &curve.ends {
            let reason = caption::end(self.family, &end.reason, &curve.plane);
            text += &format!(" {}: {reason}.", end.label);
        }
        for point in codimension_two(self.curves) {
            let [x, y] = [0, 1].map(|side| value(point.values[side], side));
            text += &format!(
                " {}: {}, at {first} = {x}, {second} = {y}.",
                point.label,
                point.kind.name()
            );
        }
        text += &format!(
            " The error across the curve is at most {largest:.1e} of the sides of the box."
        );
        text
    }

    pub(super) fn data(&self) -> String {
        let [first, second] = self.plane.sides();
        let mut text = format!(
            "curve,{},{},edge_{},edge_{},status\n",
            first.parameter, second.parameter, first.parameter, second.parameter
        );
        for (number, curve) in self.curves.iter().enumerate() {
            for point in &curve.points {
                let ([x, y], [dx, dy]) = (point.values, point.to_edge);
                let status = point.status().word();
                text += &format!("C{},{x},{y},{dx},{dy},{status}\n", number + 1);
            }
        }
        for (curve, [x, y]) in self.stability.data() {
            text += &format!("{},{x},{y},0,0,{}\n", curve.name, curve.kind.name());
        }
        for (name, _, point) in self.levels.data() {
            let ([x, y], [dx, dy]) = (point.values, point.to_edge);
            let status = point.status().word();
            text += &format!("{name},{x},{y},{dx},{dy},{status}\n");
        }
        for (row, [dx, dy], status) in self.crossed.data() {
            let ([x, y], label) = (row.values, &row.label);
            text += &format!("{label},{x},{y},{dx},{dy},{status}\n");
        }
        text
    }
}

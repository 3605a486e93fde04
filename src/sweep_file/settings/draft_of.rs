//! Settings back into what a file says of them.

use super::{AxisSettings, Grade, Settings};
use crate::density::Observable;
use crate::sweep_file::draft::{Auto, AxisDraft, Draft};

impl Settings {
    /// What a complete file says.
    pub(in crate::sweep_file) fn draft(&self) -> Draft {
        let model = self.family.model();
        let parameter = self.family.parameter();
        let (from, to) = self.family.ends();
        let parameters = self.family.fixed();
        let parameters = parameters.map(|(name, value)| (name.to_owned(), value));
        let axes = model.axes.iter().zip(&self.axes);
        Draft {
            title: Some(self.title.clone()),
            model: Some(model.clone()),
            parameters: parameters.collect(),
            parameter: Some(parameter.to_owned()),
            from: Some(from),
            to: Some(to),
            points: Some(self.points),
            axes: axes
                .map(|(known, axis)| axis_draft(&known.name, axis))
                .collect(),
            method: self.method.clone(),
            marginals: Some(self.marginals()),
            joint: Some(self.joint()),
            detect: self.detect.clone(),
            locate: self.locate.clone(),
            figures_at: Some(self.figures_at.clone()),
            figure_formats: self.figure_formats.clone(),
        }
    }

    /// Names of the axes whose marginals are watched.
    fn marginals(&self) -> Vec<String> {
        let observables = self.observables.iter();
        let names = observables.filter_map(|observable| match *observable {
            Observable::Marginal(axis) => Some(self.family.axis(axis).to_owned()),
            Observable::Joint(..) => None,
        });
        names.collect()
    }

    /// Names of the pairs of axes whose joint densities are watched.
    fn joint(&self) -> Vec<[String; 2]> {
        let observables = self.observables.iter();
        let names = observables.filter_map(|observable| match *observable {
            Observable::Marginal(_) => None,
            Observable::Joint(one, other) => {
                Some([one, other].map(|axis| self.family.axis(axis).to_owned()))
            }
        });
        names.collect()
    }
}

fn axis_draft(name: &str, axis: &AxisSettings) -> AxisDraft {
    let toward = match &axis.grade {
        Grade::Toward(grading) => Some(grading),
        Grade::Even | Grade::Auto => None,
    };
    AxisDraft {
        name: name.to_owned(),
        range: axis.range.is_none().then_some(Auto),
        from: axis.range.map(|range| range.0),
        to: axis.range.map(|range| range.1),
        count: Some(axis.count),
        grade: (axis.grade == Grade::Auto).then_some(Auto),
        grade_at: toward.map(|grading| grading.at.clone()),
        grade_smallest: toward.map(|grading| grading.smallest),
    }
}

//! The side of zero on which a state that cannot change its sign is looked at, where no end of its axis is given.

use std::sync::Arc;

use super::draft::MethodKind;
use super::settings::{Grade, Settings};
use super::verify::short;
use crate::method::pilot_box;
use crate::numerics::narrowed;
use crate::system::{System, natural_ends};

/// Parts of the sweep at whose ends an axis is looked at.
const PARTS: usize = 16;

/// Parts of a range in which a zero of a noise is looked for, and halvings that lead to neighbouring numbers.
const LOOKS: usize = 400;
const HALVINGS: usize = 80;
/// How often an end is looked for four times as far away.
const FARTHER: i32 = 6;

impl Settings {
    /// Gives axes of which no end is known, and whose zero no path crosses downward anywhere along the sweep, the end 0
    /// from below, and returns them. Populations, concentrations and intensities are positive: the other side has a
    /// steady state of its own, or is left for ever, or the equations have no value there. Steps of trajectories may
    /// overshoot such an end, so that the other methods are not given it.
    pub(super) fn keep_to_one_side(&mut self, corners: &[Arc<dyn System>]) -> Vec<usize> {
        if self.method.kind != MethodKind::Generator {
            return Vec::new();
        }
        let kept = self.positive(corners);
        for &axis in &kept {
            self.axes[axis].ends[0] = Some(0.0);
        }
        kept
    }

    /// The axes of which no end is known that stay positive, next to where trajectories start.
    pub(super) fn positive(&self, corners: &[Arc<dyn System>]) -> Vec<usize> {
        let open = (0..self.axes.len()).filter(|&axis| self.axes[axis].ends == [None; 2]);
        let known = self.axes.iter().map(|axis| pilot_box(axis.ends));
        positive_axes(
            &self.with_systems_between(corners),
            &known.collect::<Vec<_>>(),
            open.collect(),
        )
    }

    /// Opens the ends of those of the axes again that do not stay positive on the ranges that were found, and says
    /// whether there were any.
    pub(super) fn reopen(
        &mut self,
        kept: &mut Vec<usize>,
        corners: &[Arc<dyn System>],
        ranges: &[(f64, f64)],
    ) -> bool {
        let systems = self.with_systems_between(corners);
        let holds = |axis: &usize| {
            systems
                .iter()
                .all(|one| natural_ends(&**one, *axis, ranges)[0])
        };
        let (holding, wrong): (Vec<usize>, Vec<usize>) = kept.iter().partition(|axis| holds(axis));
        for &axis in &wrong {
            self.axes[axis].ends[0] = None;
        }
        *kept = holding;
        !wrong.is_empty()
    }

    /// Says which axes are looked at on one side of zero alone; cells narrow toward it, where nothing was said of them.
    pub(super) fn tell_of_one_side(&mut self, kept: &[usize]) {
        for &axis in kept {
            let name = self.family.axis(axis);
            let is_unsaid = self.document.root.find(&["cells", name, "grade"]).is_none();
            if self.axes[axis].grade == Grade::Even && is_unsaid {
                self.axes[axis].grade = Grade::Auto;
            }
            self.chosen.push(format!(
                "cells: {name} from 0, as no path crosses {name} = 0 downward, where its noise vanishes and its drift \
                 does not lead out; give `cells.{name}.from` or `to` for another side"
            ));
        }
    }

    /// The same before ranges are looked for, where the noise has no value beyond, as a root of what is negative there
    /// has none: trajectories could not start there.
    pub(super) fn end_where_noise_has_no_value(
        &mut self,
        kept: &[usize],
        corners: &[Arc<dyn System>],
    ) {
        let axes = self.axes.iter();
        let mut ranges: Vec<(f64, f64)> = axes.map(|axis| pilot_box(axis.ends)).collect();
        let upper: Vec<f64> = ranges.iter().map(|range| range.1).collect();
        let has_none = |&axis: &usize| {
            let mut noises = corners.iter().flat_map(|system| system.noises_on(axis));
            noises.any(|noise| !noise.at(0.0, &upper).is_finite())
        };
        let ended: Vec<usize> = kept.iter().copied().filter(has_none).collect();
        self.end_where_noise_dies(&ended, corners, &mut ranges);
        for axis in ended {
            let end = ranges[axis].1;
            self.axes[axis].ends[1] = Some(end).filter(|end| *end < upper[axis]);
        }
    }

    /// The same where no range was found, because paths from beyond an end at which the noise dies run away: says
    /// whether any range has an end now. Ends are looked for farther and farther away.
    pub(super) fn end_where_paths_ran_away(
        &mut self,
        kept: &[usize],
        corners: &[Arc<dyn System>],
    ) -> bool {
        let axes = self.axes.iter();
        let start: Vec<(f64, f64)> = axes.map(|axis| pilot_box(axis.ends)).collect();
        (0..FARTHER).any(|power| {
            let mut ranges = start.clone();
            for &axis in kept {
                ranges[axis].1 *= 4_f64.powi(power);
            }
            let before = ranges.clone();
            self.end_where_noise_dies(kept, corners, &mut ranges);
            let ended = kept.iter().filter(|&&axis| ranges[axis] != before[axis]);
            let ended: Vec<usize> = ended.copied().collect();
            for &axis in &ended {
                self.axes[axis].ends[1] = Some(ranges[axis].1);
            }
            !ended.is_empty()
        })
    }

    /// Ends ranges from zero on at the first value above it that no path crosses upward anywhere along the sweep, and
    /// says so: beyond it nothing comes to from below, as beyond a share of one.
    pub(super) fn end_where_noise_dies(
        &mut self,
        kept: &[usize],
        corners: &[Arc<dyn System>],
        ranges: &mut [(f64, f64)],
    ) {
        let systems = self.with_systems_between(corners);
        let open = kept
            .iter()
            .filter(|&&axis| self.axes[axis].ends[1].is_none());
        let mut told = Vec::new();
        for &axis in open {
            let Some(end) = first_zero_of_noise(&systems, axis, ranges) else {
                continue;
            };
            let mut ended = ranges.to_vec();
            ended[axis].1 = end;
            let mut all = systems.iter();
            if all.all(|one| natural_ends(&**one, axis, &ended)[1]) {
                ranges[axis].1 = end;
                let (name, end) = (self.family.axis(axis), short(end));
                told.push(format!(
                    "cells: {name} to {end}, as no path crosses {name} = {end} upward, where its noise vanishes and its \
                     drift does not lead out; give `cells.{name}.to` for another end"
                ));
            }
        }
        self.chosen.extend(told);
    }

    /// These systems, and others along the sweep.
    fn with_systems_between(&self, corners: &[Arc<dyn System>]) -> Vec<Arc<dyn System>> {
        let (from, to) = self.family.ends();
        let places = (0..=PARTS).map(|part| from + (to - from) * part as f64 / PARTS as f64);
        let between = places.filter_map(|place| self.family.at(place).ok());
        corners.iter().cloned().chain(between).collect()
    }
}

/// The first value inside the range of an axis at which the amplitude of its noise changes its sign, or from which on
/// it has no value, with the other axes in the middle of theirs; of one noise that is the same function of the axis but
/// for a factor, it is the same for all systems.
fn first_zero_of_noise(
    systems: &[Arc<dyn System>],
    axis: usize,
    ranges: &[(f64, f64)],
) -> Option<f64> {
    let system = systems.first()?;
    let mut state: Vec<f64> = ranges.iter().map(|(from, to)| 0.5 * (from + to)).collect();
    let mut noises = system.noises_on(axis);
    let (Some(noise), None) = (noises.next(), noises.next()) else {
        return None;
    };
    let mut amplitude = |place: f64| {
        state[axis] = place;
        noise.at(0.0, &state)
    };
    let (from, to) = ranges[axis];
    let at = |part: usize| from + (to - from) * part as f64 / LOOKS as f64;
    let keeps_sign = |here: f64, next: f64| here * next > 0.0;
    let part =
        (1..LOOKS).find(|&part| !keeps_sign(amplitude(at(part)), amplitude(at(part + 1))))?;
    let sign = amplitude(at(part)).signum();
    let ends = (at(part), at(part + 1));
    let (low, high) = narrowed(ends, HALVINGS, |middle| amplitude(middle) * sign > 0.0);
    [high, low].into_iter().find(|&end| amplitude(end) == 0.0)
}

/// Those of some axes that stay positive in all the systems while all of them do, on these ranges of the others.
fn positive_axes(
    systems: &[Arc<dyn System>],
    known: &[(f64, f64)],
    mut axes: Vec<usize>,
) -> Vec<usize> {
    loop {
        let stays = |axis: &usize| {
            let mut ranges = known.to_vec();
            for &positive in &axes {
                ranges[positive].0 = 0.0;
            }
            systems
                .iter()
                .all(|one| natural_ends(&**one, *axis, &ranges)[0])
        };
        let those: Vec<usize> = axes.iter().copied().filter(stays).collect();
        if those.len() == axes.len() {
            return axes;
        }
        axes = those;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::system::{Interpretation, TypedModel};

    const NONE: [usize; 0] = [];

    fn positive(equations: [&str; 2], noises: [&str; 2]) -> Vec<usize> {
        let typed = TypedModel::new("typed", "A typed system", ["x", "y"])
            .with_equation("x", equations[0])
            .with_equation("y", equations[1])
            .with_noise("x", [noises[0]])
            .with_noise("y", [noises[1]])
            .with_interpretation(Interpretation::Ito);
        let system = typed.build().unwrap().system_with(&[]).unwrap();
        positive_axes(&[system], &[pilot_box([None; 2]); 2], vec![0, 1])
    }

    #[test]
    fn populations_stay_positive_and_what_can_be_carried_across_zero_does_not() {
        let logistic = "x (1 - x) - x y/(1 + x)";
        assert_eq!(
            positive([logistic, "x y - 0.3 y"], ["0.1 x", "0.1 y"]),
            [0, 1]
        );
        // Intrinsic noise, as of a chemical Langevin equation; powers of y have a value where y is positive.
        let birth = "2/(1 + y^2.5) - x";
        let intrinsic = ["0.2 sqrt(x)", "0.2 sqrt(y)"];
        assert_eq!(positive([birth, "x - y"], intrinsic), [0, 1]);
        // Where y may be negative it carries x across zero, and there is no such power.
        assert_eq!(positive(["y - x", "x - y"], ["0.2 x", "0.1"]), NONE);
        assert_eq!(positive([birth, "x - y"], ["0.2 sqrt(x)", "0.1"]), NONE);
        // A force at zero carries paths across it, one way.
        assert_eq!(positive(["0.1 - x", "x - y"], ["0.2 x", "0.1"]), [0]);
        assert_eq!(positive(["-0.1 - x", "x - y"], ["0.2 x", "0.1"]), NONE);
    }
}

//! The side of zero on which a state that cannot change its sign is looked at, where no end of its axis is given.

use std::sync::Arc;

use super::settings::{Grade, Settings};
use crate::method::pilot_box;
use crate::system::{System, natural_ends};

impl Settings {
    /// Gives axes of which no end is known, and whose zero no path crosses downward in any of these systems, the end 0
    /// from below; cells narrow toward it, unless they are told how. Populations, concentrations and intensities are
    /// positive: the other side has a steady state of its own, or is left for ever, or the equations have no value there.
    pub(super) fn keep_to_one_side(&mut self, systems: &[Arc<dyn System>]) {
        let open = (0..self.axes.len()).filter(|&axis| self.axes[axis].ends == [None; 2]);
        for axis in positive_axes(systems, open.collect()) {
            let settings = &mut self.axes[axis];
            settings.ends[0] = Some(0.0);
            if settings.grade == Grade::Even {
                settings.grade = Grade::Auto;
            }
            let name = self.family.axis(axis);
            self.chosen.push(format!(
                "cells: {name} from 0, as no path crosses {name} = 0, where its noise vanishes and its drift does not \
                 lead out; give `cells.{name}.from` or `to` for another side"
            ));
        }
    }
}

/// Those of some axes that stay positive in all the systems while all of them do.
fn positive_axes(systems: &[Arc<dyn System>], mut axes: Vec<usize>) -> Vec<usize> {
    loop {
        let stays = |axis: &usize| {
            systems
                .iter()
                .all(|one| stays_positive(&**one, *axis, &axes))
        };
        let those: Vec<usize> = axes.iter().copied().filter(stays).collect();
        if those.len() == axes.len() {
            return axes;
        }
        axes = those;
    }
}

/// Whether zero of an axis is a natural end from above where these axes are positive. Nothing then comes back from the
/// positive side, whatever there is below.
fn stays_positive(system: &dyn System, axis: usize, positive: &[usize]) -> bool {
    let box_of = |other: usize| {
        let (low, high) = pilot_box([None; 2]);
        (if positive.contains(&other) { 0.0 } else { low }, high)
    };
    let mut ranges: Vec<(f64, f64)> = (0..system.dimension()).map(box_of).collect();
    ranges[axis].0 = 0.0;
    natural_ends(system, axis, &ranges)[0]
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
        positive_axes(&[system], vec![0, 1])
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

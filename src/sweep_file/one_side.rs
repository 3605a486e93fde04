//! The side of zero on which a state that cannot change its sign is looked at, where no end of its axis is given.

use std::sync::Arc;

use super::settings::{Grade, Settings};
use crate::method::pilot_box;
use crate::system::{System, natural_ends};

impl Settings {
    /// Gives axes of which no end is known, and whose zero no path crosses in any of these systems, the end 0 from
    /// below; cells narrow toward it, unless they are told how. Either side of zero has a steady state of its own there;
    /// populations, concentrations and intensities are positive.
    pub(super) fn keep_to_one_side(&mut self, systems: &[Arc<dyn System>]) {
        for (number, axis) in self.axes.iter_mut().enumerate() {
            let stands_still = |system: &Arc<dyn System>| stands_still_at_zero(&**system, number);
            if axis.ends != [None; 2] || !systems.iter().all(stands_still) {
                continue;
            }
            axis.ends[0] = Some(0.0);
            if axis.grade == Grade::Even {
                axis.grade = Grade::Auto;
            }
            let name = self.family.axis(number);
            self.chosen.push(format!(
                "cells: {name} from 0, as no path crosses {name} = 0, where its drift and noise vanish; \
                 `cells.{name}.to = 0` is for the other side"
            ));
        }
    }
}

/// Whether no path crosses zero of an axis, as that of a population: it is a natural end of either side.
fn stands_still_at_zero(system: &dyn System, axis: usize) -> bool {
    let mut ranges = vec![pilot_box([None; 2]); system.dimension()];
    let (low, high) = ranges[axis];
    ranges[axis] = (0.0, high);
    let above = natural_ends(system, axis, &ranges)[0];
    ranges[axis] = (low, 0.0);
    above && natural_ends(system, axis, &ranges)[1]
}

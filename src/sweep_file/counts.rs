//! Numbers of cells that are left to the program: two coarse grids tell how fast the error of the watched densities
//! falls, and with it how many cells they need.

use std::sync::Arc;

use super::diagnostic::Diagnostic;
use super::draft::MethodKind;
use super::report::Report;
use super::settings::{AxisSettings, Grade, Modes, ModesOf, Settings, cell_space};
use super::typed_noise::{better_written, is_noise_with_memory};
use crate::cancellation::Cancellation;
use crate::continuation::{DensitySource as _, SourceError};
use crate::density::{EstimatedDensity, Observable};
use crate::generator::automatic_grading;
use crate::method::{GeneratorMethodOptions, GeneratorSource, MethodOptions, Problem};
use crate::space::Grading;
use crate::system::System;

/// Cells an axis of the first coarse grid, by the number of axes that are cut into cells.
const COARSE: [usize; 4] = [100, 40, 14, 8];
/// Most cells an axis that are chosen, by the number of axes that are cut into cells, less where modes carry others:
/// what a sweep of some minutes can do.
const MOST: [usize; 4] = [2000, 240, 60, 20];
/// Cells an axis of the second coarse grid to those of the first.
const FINER: f64 = 1.5;
/// Most modes that are used while numbers of cells are tried. Angles keep their own number: with fewer, the error of
/// the modes would hide that of the cells.
pub(super) const TRIAL_MODES: usize = 4;
/// Modes along an angle where the method has none.
const TRIAL_HARMONICS: usize = 16;
/// Orders of convergence that are believed: a steeper fall is mostly luck.
const ORDERS: (f64, f64) = (1.0, 6.0);
/// The wanted error is divided by this, since what is seen at the ends may be exceeded between.
const CAUTION: f64 = 1.5;

impl Settings {
    /// Chooses the numbers of cells that are left open, the same for all axes. Ranges are known.
    ///
    /// # Errors
    /// A report when the cells cannot be laid out, or when cancelled.
    pub(super) fn find_counts(
        &mut self,
        ends: &[Arc<dyn System>],
        cancellation: &Cancellation,
    ) -> Result<(), Report> {
        let kind = self.method.kind;
        let is_open = |axis: &AxisSettings| axis.count.is_none() && axis.is_cut(kind);
        if !self.axes.iter().any(is_open) {
            return Ok(());
        }
        let carried = self.axes.iter().filter(|axis| !axis.is_cut(kind)).count();
        let place = (self.axes.len() - carried).clamp(1, COARSE.len()) - 1;
        let (first, most) = (COARSE[place], MOST[place] / (1 + carried));
        let second = even(first as f64 * FINER);
        let mut errors = Vec::new();
        for count in [first, second] {
            errors.push(self.error_with(count, ends, cancellation)?);
        }
        let (mut count, words) = match errors[..] {
            [Some(coarse), Some(fine)] => {
                let chosen = chosen((first, coarse), (second, fine), self.accuracy, most);
                let words = format!(
                    "with {first} and {second} cells an axis the watched densities are off by {coarse:.1e} and {fine:.1e} in total variation"
                );
                (chosen, words)
            }
            _ => {
                let words = "a coarse grid gave no density to judge by".to_owned();
                ((second, f64::NAN), words)
            }
        };
        while count.0 > first && self.needs_too_much(count.0, ends) {
            count.1 *= 1.2;
            count.0 = even(count.0 as f64 / 1.1).min(count.0 - 2);
        }
        self.set_counts(count.0, ends);
        let mut note = format!("cells: {} an axis are chosen; {words}", count.0);
        if count.1 > self.accuracy {
            note += &format!(
                "; {:.1e} is expected, more than `cells.accuracy` = {}: give counts for more cells",
                count.1, self.accuracy
            );
        }
        self.chosen.push(note);
        if place > 1 {
            self.tell_of_typed_noise(ends);
        }
        Ok(())
    }

    /// Says which of the states that are cut into cells modes would carry, were they written as noise.
    fn tell_of_typed_noise(&mut self, systems: &[Arc<dyn System>]) {
        let kind = self.method.kind;
        if self.family.model().noise_kind().is_coloured() {
            return;
        }
        for (axis, settings) in self.axes.iter().enumerate() {
            let is_noise = |system: &Arc<dyn System>| is_noise_with_memory(&**system, axis);
            if settings.is_cut(kind) && systems.iter().all(is_noise) {
                self.chosen
                    .push(format!("cells: {}", better_written(self.family.axis(axis))));
            }
        }
    }

    /// The same with the cells of the first coarse grid where their numbers are left open.
    pub(super) fn on_coarse_cells(&self, ends: &[Arc<dyn System>]) -> Self {
        let kind = self.method.kind;
        let cut = self.axes.iter().filter(|axis| axis.is_cut(kind)).count();
        let mut coarse = self.clone();
        coarse.set_counts(COARSE[cut.clamp(1, COARSE.len()) - 1], ends);
        coarse
    }

    /// Gives every open axis this many cells, and every axis its grading.
    fn set_counts(&mut self, count: usize, ends: &[Arc<dyn System>]) {
        let kind = self.method.kind;
        for axis in &mut self.axes {
            if axis.is_cut(kind) {
                axis.count.get_or_insert(count);
            }
        }
        self.find_gradings(ends);
    }

    /// Replaces gradings that are left to the program, where count and ranges are known.
    pub(super) fn find_gradings(&mut self, ends: &[Arc<dyn System>]) {
        let ranges: Option<Vec<(f64, f64)>> = self.axes.iter().map(AxisSettings::range).collect();
        let Some(ranges) = ranges else {
            return;
        };
        let kind = self.method.kind;
        for (index, axis) in self.axes.iter_mut().enumerate() {
            let (Grade::Auto, Some(count), None) = (&axis.grade, axis.count, axis.modes_by(kind))
            else {
                continue;
            };
            let finest = |system: &Arc<dyn System>| {
                automatic_grading(system.as_ref(), &ranges, index, count)
            };
            let gradings = ends.iter().filter_map(finest);
            let narrowest =
                gradings.min_by(|a: &Grading, b: &Grading| a.smallest.total_cmp(&b.smallest));
            axis.grade = narrowest.map_or(Grade::Even, Grade::Toward);
        }
    }

    /// Largest error of a watched density at both ends of the sweep, in total variation, with this many cells; `None`
    /// where there is no density.
    fn error_with(
        &self,
        count: usize,
        ends: &[Arc<dyn System>],
        cancellation: &Cancellation,
    ) -> Result<Option<f64>, Report> {
        let Some(problem) = self.problem_with(count, ends, TRIAL_MODES)? else {
            return Ok(None);
        };
        let Ok(source) = GeneratorSource::new(&problem, &self.method.generator) else {
            return Ok(None);
        };
        let mut session = source.open(cancellation);
        let (from, to) = self.family.ends();
        let mut largest: Option<f64> = None;
        for end in [from, to] {
            let solution = match session.solve(end) {
                Ok(solution) => solution,
                Err(SourceError::Interrupted) => {
                    return Err(self.refuse(Diagnostic::new(SourceError::Interrupted.to_string())));
                }
                Err(SourceError::Method(_)) => return Ok(None),
            };
            for density in &solution.densities {
                let error = error_of(density);
                largest = Some(largest.map_or(error, |largest| largest.max(error)));
            }
        }
        Ok(largest)
    }

    /// What would be solved with this many cells, and so many modes at most along axes that are no angles; `None` where
    /// the method refuses it.
    fn problem_with(
        &self,
        count: usize,
        ends: &[Arc<dyn System>],
        most_modes: usize,
    ) -> Result<Option<Problem>, Report> {
        let mut trial = self.clone();
        trial.set_counts(count, ends);
        // The generator judges, for which harmonics carry what closes on itself.
        let is_turn = |axis: &AxisSettings| axis.series == ModesOf::Turn;
        if trial.axes.iter().any(is_turn) {
            trial.method.kind = MethodKind::Generator;
            let turns = trial.axes.iter_mut().filter(|axis| is_turn(axis));
            turns.for_each(|axis| axis.modes = axis.modes.or(Some(Modes::Auto)));
        }
        let kind = trial.method.kind;
        for axis in &mut trial.axes {
            axis.modes = match (axis.modes_by(kind), is_turn(axis)) {
                (Some(Modes::Auto), true) => Some(Modes::Number(TRIAL_HARMONICS)),
                (Some(Modes::Auto), false) => Some(Modes::Number(TRIAL_MODES)),
                (Some(Modes::Number(given)), false) => Some(Modes::Number(given.min(most_modes))),
                _ => axis.modes,
            };
        }
        let space = cell_space(&trial.document, &trial.family, &trial.axes, kind)
            .map_err(|diagnostic| self.refuse(*diagnostic))?;
        // Quantities are looked at later, over bins that follow from these cells; where nothing else is watched, each
        // axis is.
        let axes = trial.axes.len();
        let of_axes = |one: &Observable| one.axes().into_iter().all(|axis| axis < axes);
        let mut observables = trial.observables;
        observables.retain(of_axes);
        if observables.is_empty() {
            let carried = |axis: &usize| trial.axes[*axis].modes_by(kind).is_none();
            observables = (0..axes)
                .filter(carried)
                .map(Observable::Marginal)
                .collect();
        }
        Ok(Problem::new(trial.family, space, observables).ok())
    }

    /// Whether the cells do not fit into the memory that the method may take.
    fn needs_too_much(&self, count: usize, ends: &[Arc<dyn System>]) -> bool {
        let options = MethodOptions::Generator(GeneratorMethodOptions {
            memory_limit: self.method.generator.memory_limit,
            ..GeneratorMethodOptions::default()
        });
        let problem = self.problem_with(count, ends, usize::MAX);
        let Ok(Some(problem)) = problem else {
            return false;
        };
        options.cost(problem.space()).is_err()
    }
}

/// Total variation between a density and the same by the second scheme; zero where there is none, as of systems with
/// one axis, whose densities have all digits.
fn error_of(density: &EstimatedDensity) -> f64 {
    let Some(second) = density.variants.second_scheme() else {
        return 0.0;
    };
    let volumes = density.density.volumes();
    let pairs = density.density.values.iter().zip(second);
    let differences = pairs
        .zip(&volumes)
        .map(|((p, q), volume)| (p - q).abs() * volume);
    0.5 * differences.sum::<f64>()
}

/// How many cells an axis the wanted accuracy takes, and the error that is expected with them.
fn chosen(
    (first, coarse): (usize, f64),
    (second, fine): (usize, f64),
    wanted: f64,
    most: usize,
) -> (usize, f64) {
    let step = (second as f64 / first as f64).ln();
    let order = (coarse / fine).ln() / step;
    // Of two errors that are zero no order can be told, and none is needed.
    let order = if order.is_finite() { order } else { ORDERS.1 };
    let order = order.clamp(ORDERS.0, ORDERS.1);
    let times = (CAUTION * fine / wanted).powf(1.0 / order);
    let least = first as f64;
    let count = even((second as f64 * times).clamp(least, most as f64));
    (count, fine * (second as f64 / count as f64).powf(order))
}

/// The even number at or above: an even count puts a face in the middle.
fn even(count: f64) -> usize {
    2 * (0.5 * count).ceil() as usize
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_follow_from_the_order_of_convergence() {
        // Second order: from 2e-2 with 60 cells to 1e-3/1.5 takes √30 times the cells.
        let (count, expected) = chosen((40, 4.5e-2), (60, 2e-2), 1e-3, 1000);
        assert_eq!(count, even(60.0 * 30_f64.sqrt()));
        assert!(expected < 1e-3);
        // What is fine already, what has no error, and what is too much.
        assert_eq!(chosen((40, 1e-5), (60, 1e-6), 1e-3, 1000).0, 40);
        assert_eq!(chosen((100, 0.0), (150, 0.0), 1e-3, 1000).0, 100);
        let (count, expected) = chosen((40, 0.3), (60, 0.25), 1e-3, 240);
        assert!(count == 240 && expected > 1e-3);
    }
}

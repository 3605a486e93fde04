//! The stage between checked settings and a sweep: what takes work. It asks whether the cells fit into the machine, and
//! finds by free trajectories what is left to the program.

use std::sync::Arc;

use super::counts::TRIAL_MODES;
use super::diagnostic::Diagnostic;
use super::report::Report;
use super::settings::{AxisSettings, Grade, Modes, ModesOf, Settings, at_cells, cell_space};
use super::sweep::Sweep;
use crate::cancellation::Cancellation;
use crate::method::{
    KnownEnds, Problem, RangeError, SgcmOptions, automatic_modes, automatic_ranges,
    change_by_more_modes, check_questions, check_sticking, highest_frequency, pilot_box,
};
use crate::space::{Axis, CellSpace};
use crate::system::{ParameterValues, System};

/// Harmonics along an angle that slow modes and spectra have at least: densities alone may need fewer.
const HARMONICS_OF_FLUCTUATIONS: usize = 8;

impl Settings {
    /// Finds the ranges and gradings that are left to the program, by free trajectories at both ends of the sweep, and
    /// asks whether a point fits into this machine's memory.
    ///
    /// # Errors
    /// A report where it does not fit, where no range holds the density, or when cancelled.
    pub fn prepare(self, cancellation: &Cancellation) -> Result<Sweep, Report> {
        self.prepare_telling(cancellation, &|_| ())
    }

    /// The same, telling of each part of the work when it begins.
    ///
    /// # Errors
    /// As [`Settings::prepare`].
    pub(crate) fn prepare_telling(
        mut self,
        cancellation: &Cancellation,
        tell: &dyn Fn(&str),
    ) -> Result<Sweep, Report> {
        self.check_memory()?;
        tell("looking for ranges by free trajectories");
        let ends = self.find_open_ranges(cancellation)?;
        tell("trying the equations on the domain");
        // Formulas that are not finite there would leave coarse grids without a density.
        self.check_equations()?;
        self.check_density()?;
        // Few harmonics of an angle would hide what cells are off by.
        tell("trying numbers of modes on coarse grids");
        let modes_were_given = !self.find_modes(&ends, cancellation)?;
        tell("trying numbers of cells on coarse grids");
        self.find_counts(&ends, cancellation)?;
        self.find_gradings(&ends);
        // Now of the cells that were found.
        self.check_memory()?;
        if modes_were_given {
            self.judge_modes(cancellation)?;
        }
        tell("looking for ranges of quantities");
        self.find_bins(cancellation)?;
        self.find_frequencies(cancellation)?;
        tell("laying out the cells");
        let sweep = self.fixed()?;
        check_questions(&sweep.problem)
            .map_err(|error| sweep.settings.refuse(Diagnostic::new(error.to_string())))?;
        sweep.settings.check_factors(&sweep)?;
        Ok(sweep)
    }

    /// The sweep whose cells are all given: for one that was prepared before, such as that of a stored run.
    ///
    /// # Errors
    /// A report where something is left to the program.
    pub fn fixed(self) -> Result<Sweep, Report> {
        let method = self.method.kind;
        let space = cell_space(&self.document, &self.family, &self.axes, method)
            .map_err(|diagnostic| self.refuse(*diagnostic))?;
        let bins = self
            .bin_axes(&space)
            .map_err(|diagnostic| self.refuse(*diagnostic))?;
        let problem = Problem::watching(self.family.clone(), space, self.observables.clone(), bins)
            .map(|problem| {
                let check = self.method.chosen().cell_check(&problem);
                let measures = self.measures.as_deref().unwrap_or_default();
                problem.measuring(measures).checked_by(check)
            })
            .map_err(|error| self.refuse(Diagnostic::new(error.to_string())))?;
        Ok(Sweep {
            settings: self,
            problem,
            own: None,
        })
    }

    /// The bins of all quantities.
    fn bin_axes(&self, space: &CellSpace) -> Result<Vec<Axis>, Box<Diagnostic>> {
        let named = self.family.quantities().iter().zip(&self.bins);
        let bins = named.map(|(quantity, bins)| {
            if let Some(at) = quantity.phase() {
                return Ok(space.axes()[at.axis].clone());
            }
            let name = quantity.name();
            let Some((from, to)) = bins.range else {
                let open = Diagnostic::new(format!("the bins of `{name}` have no range"));
                let remedy = format!("give `detect.bins.{name}.from` and `to`");
                return Err(Box::new(open.remedy(remedy)));
            };
            Axis::uniform(from, to, bins.count)
                .map_err(|error| Box::new(Diagnostic::new(error.to_string())))
        });
        bins.collect()
    }

    pub(super) fn refuse(&self, diagnostic: Diagnostic) -> Report {
        self.refuse_all(vec![diagnostic])
    }

    /// Findings at places of the file.
    pub(crate) fn refuse_all(&self, diagnostics: Vec<Diagnostic>) -> Report {
        Report::new(self.document.sources.clone(), diagnostics, 0)
    }

    pub(super) fn refuse_cells(&self, diagnostic: Diagnostic) -> Report {
        self.refuse(at_cells(&self.document, diagnostic))
    }

    /// Replaces ranges that are left to the program by numbers; the systems at both ends of the sweep.
    fn find_open_ranges(
        &mut self,
        cancellation: &Cancellation,
    ) -> Result<Vec<Arc<dyn System>>, Report> {
        let corners = self.corners().into_iter();
        let model = self.family.model().clone();
        let system = |values| self.family.framed(model.system(&values));
        let ends: Vec<Arc<dyn System>> = corners.map(system).collect();
        let mut kept = self.keep_to_one_side(&ends);
        self.end_where_noise_has_no_value(&kept, &ends);
        let mut ranges = match self.find_ranges(&ends, cancellation) {
            Err(_) if self.end_where_paths_ran_away(&kept, &ends) => {
                self.find_ranges(&ends, cancellation)?
            }
            found => found?,
        };
        while self.reopen(&mut kept, &ends, &ranges) {
            ranges = self.find_ranges(&ends, cancellation)?;
        }
        self.tell_of_one_side(&kept);
        self.end_where_noise_dies(&kept, &ends, &mut ranges);
        for (axis, range) in self.axes.iter_mut().zip(ranges) {
            axis.ends = [range.0, range.1].map(Some);
        }
        Ok(ends)
    }

    /// Refuses systems of which a part of the probability lies on a surface: known once there are ranges, and before
    /// anything is solved.
    fn check_density(&self) -> Result<(), Report> {
        let ranges: Option<Vec<(f64, f64)>> = self.axes.iter().map(AxisSettings::range).collect();
        let Some(ranges) = ranges else {
            return Ok(());
        };
        check_sticking(&self.family, &ranges).map_err(|error| {
            let found = Diagnostic::new(error.to_string()).remedy(
                "use a friction law with an internal state, such as `dahl` with a large `lambda`; or white noise; \
                 or a smooth force, such as `tanh(y/v)` for `sign(y)` in equations of your own",
            );
            let mut places = [&["system", "noise", "kind"][..], &["system", "noise"], &["system"]].into_iter();
            let entry = places.find_map(|path| self.document.root.find(path));
            self.refuse(match entry {
                Some(entry) => found.at(&entry.key_place, "no white noise acts where friction sticks"),
                None => found,
            })
        })
    }

    /// The parameters at both ends of the sweep, or at the corners of the map's box: what is chosen once is chosen for
    /// these.
    pub(super) fn corners(&self) -> Vec<ParameterValues> {
        let (from, to) = self.family.ends();
        let ends = [from, to].into_iter();
        let ends: Vec<ParameterValues> = ends
            .filter_map(|end| self.family.values_at(end).ok())
            .collect();
        let Some(map) = &self.map else {
            return ends;
        };
        let model = self.family.model();
        let with = |value: f64| {
            let ends = ends.iter();
            ends.filter_map(move |end| model.with(end, &map.parameter, value).ok())
        };
        with(map.from).chain(with(map.to)).collect()
    }

    fn find_ranges(
        &self,
        ends: &[Arc<dyn System>],
        cancellation: &Cancellation,
    ) -> Result<Vec<(f64, f64)>, Report> {
        if let Some(given) = self.axes.iter().map(AxisSettings::range).collect() {
            return Ok(given);
        }
        let known: Vec<KnownEnds> = self.axes.iter().map(|axis| axis.ends).collect();
        let found = automatic_ranges(ends, &known, SgcmOptions::default().seed, cancellation);
        if let (Err(RangeError::RunsAway { .. } | RangeError::TooLong { .. }), Some(typed)) =
            (&found, self.family.model().typed())
        {
            let start: Vec<(f64, f64)> = known.iter().copied().map(pilot_box).collect();
            self.check_finite(
                typed,
                &start,
                "where the trajectories that look for a range start",
            )?;
            // Paths that leave a bound that does not hold run away where the equations mean nothing.
            self.check_contract(&start)?;
        }
        found.map_err(|error| self.refuse(self.no_range(&error)))
    }

    /// Replaces numbers of modes that are left to the program, and says whether there are any. They are tried on cells
    /// of their own, whatever the numbers of cells will be.
    fn find_modes(
        &mut self,
        ends: &[Arc<dyn System>],
        cancellation: &Cancellation,
    ) -> Result<bool, Report> {
        let kind = self.method.kind;
        let open = self.axes.iter().enumerate();
        let open: Vec<usize> = open
            .filter(|(_, axis)| axis.modes_by(kind) == Some(Modes::Auto))
            .map(|(index, _)| index)
            .collect();
        if open.is_empty() {
            return Ok(false);
        }
        // With any number they make a space; the right one is then found.
        for &axis in &open {
            self.axes[axis].modes = Some(Modes::Number(TRIAL_MODES));
        }
        let mut coarse = self.on_coarse_cells(ends);
        coarse.find_bins(cancellation)?;
        let problem = coarse.fixed()?.problem;
        let found = automatic_modes(&problem, &open, &self.method.generator, cancellation);
        let mut found =
            found.map_err(|error| self.refuse_cells(Diagnostic::new(error.to_string())))?;
        let questions = &self.family.questions;
        let is_turn = |&axis: &usize| self.axes[axis].series == ModesOf::Turn;
        if (questions.slow_modes > 0 || questions.spectrum.is_some()) && open.iter().any(is_turn) {
            found.count = found.count.max(HARMONICS_OF_FLUCTUATIONS);
        }
        if !found.is_enough && self.cut_in_place_of_modes(&open, found.count) {
            return self.find_modes(ends, cancellation);
        }
        let names: Vec<&str> = open.iter().map(|&axis| self.family.axis(axis)).collect();
        let mut note = format!(
            "modes: {} are chosen for {}; {}",
            found.count,
            names.join(", "),
            change_in_words("more", found.change)
        );
        if !found.is_enough {
            note += if self.has_moving_bounds(&open) {
                ", which is much: bounds that move along the sweep suit no modes, give `count` for cells"
            } else {
                ", which is much: give `modes` for more, or `count` for cells"
            };
            self.method.generator.change_by_modes = Some(found.change);
        }
        self.chosen.push(note);
        for axis in open {
            self.axes[axis].modes = Some(Modes::Number(found.count));
        }
        Ok(true)
    }

    /// Cuts axes into cells of which so many modes do not do and nobody asked for them; whether there are any. Modes of
    /// the others are open again.
    fn cut_in_place_of_modes(&mut self, open: &[usize], count: usize) -> bool {
        let (cut, others): (Vec<usize>, Vec<usize>) =
            open.iter().partition(|&&axis| self.may_have_cells(axis));
        if cut.is_empty() {
            return false;
        }
        let names: Vec<&str> = cut.iter().map(|&axis| self.family.axis(axis)).collect();
        let names = names.join(", ");
        self.chosen.push(format!(
            "modes: {count} do not do for {names}, cut into cells"
        ));
        for axis in cut {
            self.axes[axis].modes = None;
            self.axes[axis].grade = Grade::Auto;
        }
        for axis in others {
            self.axes[axis].modes = Some(Modes::Auto);
        }
        true
    }

    /// Whether cells may take the place of modes that nobody asked for: along a state of hysteresis.
    fn may_have_cells(&self, axis: usize) -> bool {
        let path = ["cells", self.family.axis(axis), "modes"];
        let is_asked = self.document.root.find(&path).is_some();
        let is_typed = self.family.model().typed().is_some();
        is_typed && !is_asked && self.axes[axis].series == ModesOf::Bounded
    }

    /// Says what numbers of modes that are given leave out, where that is much.
    fn judge_modes(&mut self, cancellation: &Cancellation) -> Result<(), Report> {
        let kind = self.method.kind;
        let mut by_modes = self.axes.iter().filter_map(|axis| axis.modes_by(kind));
        if by_modes.next().is_none() {
            return Ok(());
        }
        let problem = self.clone().fixed()?.problem;
        let found = change_by_more_modes(&problem, &self.method.generator, cancellation);
        let found = found.map_err(|error| self.refuse_cells(Diagnostic::new(error.to_string())))?;
        let Some(change) = found else {
            return Ok(());
        };
        self.method.generator.change_by_modes = Some(change);
        self.chosen.push(format!(
            "modes: {}, which is much: give `modes` for more, or `count` for cells",
            change_in_words("more than are given", change)
        ));
        Ok(())
    }

    /// Replaces a highest frequency of spectra that is left to the program.
    fn find_frequencies(&mut self, cancellation: &Cancellation) -> Result<(), Report> {
        let question = self
            .family
            .questions
            .spectrum
            .as_ref()
            .filter(|one| one.band.to.is_none());
        let Some(mut question) = question.cloned() else {
            return Ok(());
        };
        let problem = self.clone().fixed()?.problem;
        let found = highest_frequency(&problem, &self.method.generator, cancellation);
        let found = found.map_err(|error| self.refuse(Diagnostic::new(error.to_string())))?;
        let Some(to) = found else {
            let title = "no frequency is known up to which spectra are of interest: there is no steady state at the ends of the sweep and in its middle";
            let remedy = "give `spectrum.to`";
            return Err(self.refuse(Diagnostic::new(title).remedy(remedy)));
        };
        // Three digits are enough, and are read easily.
        let digits = 10f64.powf(2.0 - to.log10().floor());
        let to = (to * digits).round() / digits;
        question.band.to = Some(to);
        self.chosen
            .push(format!("spectra: frequencies up to {to} are looked at"));
        self.family.questions.spectrum = Some(question);
        Ok(())
    }

    /// Whether the model's bounds of one of the axes are not the same at both ends of the sweep: the range of its modes
    /// is then too wide at one of them, where the density ends inside it.
    fn has_moving_bounds(&self, axes: &[usize]) -> bool {
        let (from, to) = self.family.ends();
        let (Ok(first), Ok(last)) = (self.family.at(from), self.family.at(to)) else {
            return false;
        };
        let mut axes = axes.iter();
        axes.any(|&axis| first.facts().bounds(axis) != last.facts().bounds(axis))
    }
}

/// What more modes change, infinite where no trial had a steady state.
fn change_in_words(more: &str, change: f64) -> String {
    if change.is_finite() {
        format!("{more} change the watched densities by {change:.1e} of their largest value")
    } else {
        format!(
            "what {more} change is not known, because trials on coarse grids have no steady state"
        )
    }
}

//! The sweep that the page was started with, bound to other values of its parameters.

use std::collections::BTreeMap;

use super::ask::{AskLocate, AskSolve};
use crate::sweep_file::{Settings, Sweep};
use crate::system::{Family, Path};

/// Cells an axis at least, on which a preview is solved. A density that fills a third of its window then has eight
/// cells across, enough to tell one peak from two; and 24 × 24 cells of `coulomb_fc` are solved in 3 ms, less than a
/// page takes to draw: fewer would save nothing that is felt.
const FEWEST: usize = 24;
/// Values at which a span is solved before its changes are narrowed.
const SPAN_POINTS: usize = 9;

/// The sweep as it was given.
#[derive(Debug)]
pub(super) struct Base {
    sweep: Sweep,
    /// Whether the range of an axis is that of the model's walls, and moves with them.
    walled: Vec<bool>,
}

/// What is to be solved: a sweep that moves one parameter, and the value of that.
#[derive(Debug)]
pub(super) struct Bound {
    pub(super) sweep: Sweep,
    pub(super) value: f64,
    /// The same for all values that one session can solve.
    pub(super) key: Vec<u64>,
}

impl Base {
    pub(super) fn new(sweep: &Sweep) -> Self {
        let settings = &sweep.settings;
        let axes = settings.axes.iter().enumerate();
        let walled = |(index, axis): (usize, &crate::sweep_file::AxisSettings)| {
            let walls = walls(&settings.family, index);
            walls.is_some() && walls == axis.range()
        };
        Self {
            walled: axes.map(walled).collect(),
            sweep: sweep.clone(),
        }
    }

    pub(super) fn sweep(&self) -> &Sweep {
        &self.sweep
    }

    /// Binds the values of a request.
    ///
    /// # Errors
    /// Why a value is not allowed, for people.
    pub(super) fn bind(&self, ask: &AskSolve) -> Result<Bound, String> {
        self.moved(&ask.moving, &ask.values, ask.preview)
    }

    /// Binds values among which that of the swept parameter is.
    ///
    /// # Errors
    /// Why a value is not allowed, for people.
    pub(super) fn bind_swept(&self, values: &BTreeMap<String, f64>) -> Result<Bound, String> {
        self.moved(self.sweep.settings.family.parameter(), values, false)
    }

    fn moved(
        &self,
        moving: &str,
        values: &BTreeMap<String, f64>,
        preview: bool,
    ) -> Result<Bound, String> {
        let family = &self.sweep.settings.family;
        let Some(&value) = values.get(moving) else {
            return Err(format!("no value is given for `{moving}`, which moves"));
        };
        let ends = if moving == family.parameter() {
            family.ends()
        } else {
            (value, value)
        };
        let moved = self.family(moving, ends, values)?;
        moved.values_at(value).map_err(|error| error.to_string())?;
        let mut settings = self.settings(moved);
        if preview {
            for axis in &mut settings.axes {
                axis.count = axis.count.map(|count| {
                    let half = count.div_ceil(4) * 2;
                    half.max(FEWEST).min(count)
                });
            }
        }
        let key = key(&settings);
        let mut sweep = fixed(settings)?;
        if !preview && !self.walled.contains(&true) {
            // A surface that moves with the parameter takes no faces along: what is shown stays on its cells.
            let cells = self.sweep.problem.space().clone();
            sweep.problem = (sweep.problem.on(cells)).map_err(|error| error.to_string())?;
        }
        Ok(Bound { key, sweep, value })
    }

    /// The sweep between two values.
    ///
    /// # Errors
    /// Why a value is not allowed, for people.
    pub(super) fn between(&self, ask: &AskLocate) -> Result<Sweep, String> {
        if !(ask.from < ask.to && ask.from.is_finite() && ask.to.is_finite()) {
            return Err("the span is empty or reversed".to_owned());
        }
        let swept = self.sweep.settings.family.parameter();
        let moved = self.family(swept, (ask.from, ask.to), &ask.values)?;
        let mut settings = self.settings(moved);
        settings.points = SPAN_POINTS;
        fixed(settings)
    }

    /// The sweep with other values of the parameters that are not swept, as a sweep file.
    ///
    /// # Errors
    /// Why a value is not allowed, for people.
    pub(super) fn sweep_file(&self, values: &BTreeMap<String, f64>) -> Result<String, String> {
        Ok(self.at(values)?.to_toml())
    }

    /// The sweep with other values of the parameters that are not swept.
    ///
    /// # Errors
    /// Why a value is not allowed, for people.
    pub(super) fn at(&self, values: &BTreeMap<String, f64>) -> Result<Sweep, String> {
        let family = &self.sweep.settings.family;
        let moved = self.family(family.parameter(), family.ends(), values)?;
        fixed(self.settings(moved))
    }

    /// The systems when one parameter moves between two ends and the others have these values.
    fn family(
        &self,
        moving: &str,
        ends: (f64, f64),
        values: &BTreeMap<String, f64>,
    ) -> Result<Family, String> {
        let base = &self.sweep.settings.family;
        let model = base.model();
        let known = |name: &str| {
            model
                .parameters
                .iter()
                .any(|parameter| parameter.name == name)
        };
        for name in values.keys().map(String::as_str).chain([moving]) {
            if !known(name) {
                return Err(format!("model `{}` has no parameter `{name}`", model.name));
            }
        }
        let mut fixed: BTreeMap<&str, f64> = base.fixed().collect();
        fixed.extend(values.iter().map(|(name, &value)| (name.as_str(), value)));
        fixed.remove(moving);
        let fixed: Vec<(&str, f64)> = fixed.into_iter().collect();
        base.along_path(&fixed, Path::parameter(moving, ends.0, ends.1))
            .map_err(|error| error.to_string())
    }

    /// The settings with these systems; axes that end at walls end where the walls are now.
    fn settings(&self, family: Family) -> Settings {
        let mut settings = self.sweep.settings.clone();
        for (index, axis) in settings.axes.iter_mut().enumerate() {
            let is_walled = self.walled.get(index) == Some(&true);
            if let Some((from, to)) = walls(&family, index).filter(|_| is_walled) {
                axis.ends = [Some(from), Some(to)];
            }
        }
        settings.family = family;
        settings
    }
}

/// The widest range that the walls of an axis take at the ends of a path.
fn walls(family: &Family, axis: usize) -> Option<(f64, f64)> {
    let (from, to) = family.ends();
    let at = |value: f64| family.at(value).ok()?.facts().bounds(axis);
    let (one, other) = (at(from)?, at(to)?);
    Some((one.0.min(other.0), one.1.max(other.1)))
}

fn fixed(settings: Settings) -> Result<Sweep, String> {
    settings.fixed().map_err(|report| report.render(false))
}

/// What must not change within a session: the parameter that moves, the values of the others, the cells.
fn key(settings: &Settings) -> Vec<u64> {
    let family = &settings.family;
    let parameters = &family.model().parameters;
    let moving = parameters
        .iter()
        .position(|parameter| parameter.name == family.parameter());
    let mut key = vec![moving.unwrap_or(usize::MAX) as u64];
    key.extend(family.fixed().map(|(_, value)| value.to_bits()));
    for axis in &settings.axes {
        let (from, to) = axis.range().unwrap_or_default();
        key.extend([axis.count.unwrap_or(0) as u64, from.to_bits(), to.to_bits()]);
    }
    key
}

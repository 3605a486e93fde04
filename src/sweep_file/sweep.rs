//! A sweep that is ready to run: settings with their cells.

use std::sync::Arc;

use super::draft::MethodKind;
use super::settings::Settings;
use crate::cancellation::Cancellation;
use crate::continuation::curve::{CurveOptions, Plane};
use crate::continuation::map::{
    MapLevels, MapMaker, MapObserver, PlaneState, RegimeMap, plane_states,
};
use crate::continuation::{DensitySource, Observer, SourceError, SweepError, SweepResult, sweep};
use crate::method::{MethodError, MethodSource, Problem, questions_about};
use crate::system::MeasureLevel;
use crate::topology::{Detector as _, PersistenceDetector};

/// Everything a sweep needs.
#[derive(Debug, Clone)]
pub struct Sweep {
    /// What is swept and how; nothing is left to the program.
    pub settings: Settings,
    /// What is solved: the systems, the cells that the axes of the settings make, and what is watched.
    pub problem: Problem,
    pub(super) own: Option<OwnMethod>,
}

/// A method of a library's user.
#[derive(Clone)]
pub(super) struct OwnMethod {
    method: &'static str,
    make: Arc<MakeSource>,
}

/// Makes the source of densities of a problem.
type MakeSource =
    dyn Fn(&Problem, &Cancellation) -> Result<Box<dyn DensitySource>, SourceError> + Send + Sync;

impl std::fmt::Debug for OwnMethod {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.method)
    }
}

/// What is made of a source before it is opened.
pub type WrapSource<'a> = dyn Fn(Box<dyn DensitySource>) -> Box<dyn DensitySource> + Sync + 'a;

/// Why a sweep gave no result.
#[derive(Debug, thiserror::Error)]
pub enum SolveError {
    /// The method refuses.
    #[error(transparent)]
    Source(#[from] SourceError),
    /// The sweep ended early.
    #[error(transparent)]
    Sweep(#[from] SweepError),
}

impl Sweep {
    /// The detector: its confidence holds for all densities of the sweep, or of the map's coarse grid, together.
    pub fn detector(&self) -> PersistenceDetector {
        let settings = &self.settings;
        let rows = settings.map.as_ref().map_or(1, |map| map.points);
        let looks = settings.points * rows * settings.observables.len();
        PersistenceDetector::new(settings.detect.clone(), looks)
    }

    /// With which confidence, between zero and one, errors of sampled numbers are told: `detect.confidence`.
    pub fn confidence(&self) -> f64 {
        self.detector().confidence()
    }

    /// How many sessions solve it side by side.
    pub(crate) fn sessions(&self) -> usize {
        match self.settings.map {
            Some(_) => 1,
            None => {
                let method = self.settings.method.chosen();
                method.segments(self.problem.space(), self.settings.points)
            }
        }
    }

    /// Bytes of the densities that are kept until the sweep ends; a map lets go of them before.
    pub(crate) fn kept_bytes(&self) -> f64 {
        if self.settings.map.is_some() {
            return 0.0;
        }
        let observables = self.problem.observables().iter();
        let bins = observables.map(|&observable| {
            let axes = self.problem.axes_of(observable);
            axes.iter().map(|axis| axis.count() as f64).product::<f64>()
        });
        self.settings.points as f64 * self.settings.method.chosen().kept_bytes(bins.sum())
    }

    /// The same sweep by a method of one's own, in the place of that of the sweep file: `method` is its name, as
    /// [`DensitySource::method`] gives it, and `make` its source for the systems, cells and observables of a problem.
    /// The sweep asks for one along its parameter, curves and maps for others along paths of theirs.
    ///
    /// ```
    /// use pbif::cancellation::Cancellation;
    /// use pbif::method::MethodSource;
    /// use pbif::sweep_file::SweepFile;
    ///
    /// # fn main() -> Result<(), Box<dyn std::error::Error>> {
    /// let mut file = SweepFile::parse("bistable.toml", include_str!("../../sweeps/bistable.toml"));
    /// file.set("sweep.points", "5").set("cells.x.count", "60");
    /// let never = Cancellation::new();
    /// let sweep = file.validate()?.prepare(&never)?;
    /// let options = sweep.settings.method.chosen();
    /// let sweep = sweep.by_method("generator", move |problem, cancellation| {
    ///     Ok(Box::new(MethodSource::new(problem, &options, cancellation)?))
    /// });
    /// let found = sweep.run(&never, &mut ())?;
    /// let first = found.bifurcations().next().map(|row| row.label.to_string());
    /// assert_eq!(first.as_deref(), Some("PB1"));
    /// # Ok(())
    /// # }
    /// ```
    #[must_use]
    pub fn by_method(
        self,
        method: &'static str,
        make: impl Fn(&Problem, &Cancellation) -> Result<Box<dyn DensitySource>, SourceError>
        + Send
        + Sync
        + 'static,
    ) -> Self {
        let make = Arc::new(make);
        Self {
            own: Some(OwnMethod { method, make }),
            ..self
        }
    }

    /// Names of the methods whose solves a run of this sweep may hold.
    pub(crate) fn methods(&self) -> Vec<&'static str> {
        match &self.own {
            Some(own) => vec![own.method],
            None => MethodKind::ALL.map(MethodKind::name).into(),
        }
    }

    /// The source of densities by the chosen method; what is left to it is chosen here.
    ///
    /// # Errors
    /// [`SourceError`] where the method refuses, or was interrupted.
    pub fn source(
        &self,
        cancellation: &Cancellation,
    ) -> Result<Box<dyn DensitySource>, SourceError> {
        Ok(self.described_source(cancellation)?.0)
    }

    /// The same with what a user may want to know of it before the first point.
    ///
    /// # Errors
    /// As [`Sweep::source`].
    pub(crate) fn described_source(
        &self,
        cancellation: &Cancellation,
    ) -> Result<(Box<dyn DensitySource>, String), SourceError> {
        self.source_of(&self.problem, cancellation)
    }

    fn source_of(
        &self,
        problem: &Problem,
        cancellation: &Cancellation,
    ) -> Result<(Box<dyn DensitySource>, String), SourceError> {
        if let Some(own) = &self.own {
            return Ok(((own.make)(problem, cancellation)?, own.method.to_owned()));
        }
        let source = MethodSource::new(problem, &self.settings.method.chosen(), cancellation)?;
        let words = source.describe();
        Ok((Box::new(source), words))
    }

    /// A source of densities by the same method on the same cells in a plane of two parameters, one of which is swept.
    ///
    /// # Errors
    /// [`SourceError::Method`] where the method refuses, for a parameter that the model does not have, and for a corner
    /// of the plane's box that it does not allow; [`SourceError::Interrupted`].
    pub fn source_in(
        &self,
        plane: &Plane,
        cancellation: &Cancellation,
    ) -> Result<Box<dyn DensitySource>, SourceError> {
        let problem = self.problem_in(plane)?.without_measures();
        Ok(self.source_of(&problem, cancellation)?.0)
    }

    /// The same of a source that works out the measures of some levels too, and no others that take solves of their
    /// own.
    ///
    /// # Errors
    /// As [`Sweep::source_in`].
    pub fn source_of_levels(
        &self,
        plane: &Plane,
        asked: &[MeasureLevel],
        cancellation: &Cancellation,
    ) -> Result<Box<dyn DensitySource>, SourceError> {
        let problem = self.problem_in(plane)?;
        let (mut family, space) = (problem.family().clone(), problem.space().clone());
        family.questions = questions_about(&family, asked);
        let (observables, bins) = (problem.observables().to_vec(), problem.bins().to_vec());
        let problem = Problem::watching(family, space, observables, bins)?;
        let measures = self.settings.measures.as_deref().unwrap_or_default();
        Ok(self
            .source_of(&problem.measuring(measures), cancellation)?
            .0)
    }

    /// What the sweep is of, in a plane of two parameters.
    fn problem_in(&self, plane: &Plane) -> Result<Problem, SourceError> {
        let (family, path) = (self.problem.family(), plane.path());
        let is_held = |(name, _): &(&str, f64)| path.moved().iter().all(|moved| moved != name);
        let swept = family.values_at(family.ends().0);
        let swept = swept.map_err(MethodError::from)?;
        let named = family.model().parameters.iter().zip(swept.as_slice());
        let values = named.map(|(parameter, &value)| (parameter.name.as_str(), value));
        let held: Vec<(&str, f64)> = values.filter(is_held).collect();
        let in_plane = family
            .along_path(&held, path.clone())
            .map_err(MethodError::from)?;
        let problem = &self.problem;
        let (space, observables) = (problem.space().clone(), problem.observables().to_vec());
        let bins = problem.bins().to_vec();
        Ok(Problem::watching(in_plane, space, observables, bins)?)
    }

    /// Solves along the parameter and locates the changes; `observer` sees every point as it is done, `()` looks away.
    ///
    /// # Errors
    /// [`SolveError`]; failed points are data.
    pub fn run(
        &self,
        cancellation: &Cancellation,
        observer: &mut dyn Observer,
    ) -> Result<SweepResult, SolveError> {
        let source = self.source(cancellation)?;
        let (detector, settings) = (self.detector(), &self.settings);
        let (points, locate) = (settings.points, &settings.locate);
        Ok(sweep(
            &source,
            &detector,
            points,
            locate,
            cancellation,
            observer,
        )?)
    }

    /// Makes the map of regimes that `[map]` asks for, `None` where it asks for none; `observer` is told how it goes.
    ///
    /// # Errors
    /// [`SourceError`] where the method refuses, or a corner of the box is not allowed.
    pub fn map(
        &self,
        cancellation: &Cancellation,
        observer: &MapObserver<'_>,
    ) -> Result<Option<RegimeMap>, SourceError> {
        self.make_map(&|source| source, cancellation, observer, |maker| {
            maker.whole().map(Some)
        })
    }

    /// The same of whatever is wanted of the map: all of it, a shard, or the map that shards make ([`MapMaker`]). Each
    /// of its sources is given to `wrap` first, which may write down what they solve.
    ///
    /// # Errors
    /// As [`Sweep::map`].
    pub fn make_map<T>(
        &self,
        wrap: &WrapSource<'_>,
        cancellation: &Cancellation,
        observer: &MapObserver<'_>,
        task: impl FnOnce(&MapMaker<'_>) -> Result<Option<T>, SourceError>,
    ) -> Result<Option<T>, SourceError> {
        let settings = &self.settings;
        let map = settings.map.as_ref();
        let Some((map, plane)) = map.and_then(|map| Some((map, map.plane(&settings.family)?)))
        else {
            return Ok(None);
        };
        let options = map.options(
            settings.points,
            self.curve_options(plane.sides()[0].length()),
        );
        let of_levels = |plane: &Plane, asked: &[MeasureLevel]| {
            Ok(wrap(self.source_of_levels(plane, asked, cancellation)?))
        };
        let asked = self.problem.family().questions.levels.as_slice();
        task(&MapMaker {
            source: &|plane: &Plane| Ok(wrap(self.source_in(plane, cancellation)?)),
            levels: (!asked.is_empty()).then_some(MapLevels {
                asked,
                source: &of_levels,
            }),
            plane: &plane,
            detector: &self.detector(),
            options: &options,
            cancellation,
            observer,
        })
    }

    /// The densities at all crossings of these values of both parameters of the map's box ([`plane_states`]), with what
    /// is found in them; `done` is told of each. `None` without `[map]`.
    ///
    /// # Errors
    /// [`SourceError`] where the box has a corner that is not allowed.
    pub(crate) fn plane_states(
        &self,
        values: [&[f64]; 2],
        cancellation: &Cancellation,
        done: &(dyn Fn() + Sync),
    ) -> Result<Option<Vec<PlaneState>>, SourceError> {
        let map = self.settings.map.as_ref();
        let plane = map.and_then(|map| map.plane(&self.settings.family));
        let states = plane.map(|plane| self.states_in(&plane, values, cancellation, done));
        states.transpose()
    }

    /// The same in the box of a plane of its own, of curves for example.
    ///
    /// # Errors
    /// As [`Sweep::plane_states`].
    pub(crate) fn states_in(
        &self,
        plane: &Plane,
        values: [&[f64]; 2],
        cancellation: &Cancellation,
        done: &(dyn Fn() + Sync),
    ) -> Result<Vec<PlaneState>, SourceError> {
        let source = |plane: &Plane| self.source_in(plane, cancellation);
        let detector = self.detector();
        plane_states(&source, plane, values, &detector, cancellation, done)
    }

    /// How `[locate]` wants curves, in a box whose first side is so long.
    pub(crate) fn curve_options(&self, first: f64) -> CurveOptions {
        let locate = &self.settings.locate;
        let usual = CurveOptions::default();
        CurveOptions {
            tolerance: match locate.tolerance {
                Some(tolerance) => tolerance / first,
                None => locate.relative_tolerance,
            },
            check_every: if locate.grid_check {
                usual.check_every
            } else {
                0
            },
            ..usual
        }
    }

    /// The sweep as a complete sweep file. Read again it gives the same sweep.
    pub fn to_toml(&self) -> String {
        self.settings.to_toml()
    }
}

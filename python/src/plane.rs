//! What was found in a plane of two parameters: curves, and a map of regimes.

use std::path::PathBuf;
use std::sync::Arc;

use numpy::{IntoPyArray, PyArrayMethods};
use pbif::cancellation::Cancellation;
use pbif::continuation::curve::{
    Curve, CurveEnd, CurveOrigin, CurvePoint, CurveTree, LevelCurve, codimension_two,
};
use pbif::continuation::map::RegimeMap;
use pbif::explore::StoredPage;
use pbif::figure::Figures;
use pbif::job::FirstRow;
use pbif::run::{StoredPlane, StoredPlaneContent};
use pbif::sweep_file::{Sweep, SweepFile};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::error;
use crate::figure::Figure;
use crate::home::Home;
use crate::watch::{Ear, Told, tell_words, watched};

/// Curves or a map.
#[pyclass(frozen, module = "pbif._pbif")]
pub(crate) struct Plane {
    sweep: Arc<Sweep>,
    plane: pbif::continuation::curve::Plane,
    content: StoredPlaneContent,
    home: Arc<Home>,
    /// A folder that must stay while this one does.
    holder: Option<Arc<Home>>,
}

impl Plane {
    pub(crate) fn of_map(sweep: &Arc<Sweep>, map: RegimeMap, home: Arc<Home>) -> Self {
        Self {
            sweep: Arc::clone(sweep),
            plane: map.plane.clone(),
            content: StoredPlaneContent::Map(Box::new(map)),
            home,
            holder: None,
        }
    }

    pub(crate) fn of_curves(
        sweep: &Arc<Sweep>,
        (plane, tree): (pbif::continuation::curve::Plane, CurveTree),
        row: FirstRow<'_>,
        home: Arc<Home>,
    ) -> Self {
        Self {
            sweep: Arc::clone(sweep),
            content: StoredPlaneContent::Curves(
                Box::new(plane.clone()),
                Box::new(tree),
                CurveOrigin::from(row),
            ),
            plane,
            home,
            holder: None,
        }
    }

    pub(crate) fn held_by(self, holder: Option<Arc<Home>>) -> Self {
        Self { holder, ..self }
    }

    fn curves_of(&self) -> &[Curve] {
        match &self.content {
            StoredPlaneContent::Map(map) => &map.curves,
            StoredPlaneContent::Curves(_, tree, _) => &tree.curves,
        }
    }

    fn levels_of(&self) -> &[LevelCurve] {
        match &self.content {
            StoredPlaneContent::Map(map) => &map.levels,
            StoredPlaneContent::Curves(_, tree, _) => &tree.levels,
        }
    }

    fn with_figures<T>(&self, of: impl FnOnce(&Figures<'_>) -> T) -> T {
        let settings = &self.sweep.settings;
        let (family, title) = (self.sweep.problem.family(), settings.title.as_str());
        let figures = match &self.content {
            StoredPlaneContent::Map(map) => Figures::of_map(map, &[], title),
            StoredPlaneContent::Curves(plane, tree, origin) => {
                Figures::of_curves((plane, tree), (origin, &[]), family, title)
            }
        };
        let axes = self.sweep.problem.space().axes();
        let figures = figures
            .solved_by(settings.method.kind.name(), self.sweep.problem.watched())
            .carried_by(family, axes);
        of(&figures.with_style(&settings.figures.style))
    }
}

/// Reads curves or a map from their folder.
pub(crate) fn stored_plane(py: Python<'_>, home: Arc<Home>) -> PyResult<Plane> {
    let stored = StoredPlane::open(home.path()).map_err(|error| error::run(py, &error))?;
    let folder = home.path().display().to_string();
    let none = || {
        error::other(
            py,
            format!("`{folder}` is not the folder of a map or of curves"),
        )
    };
    let stored = stored.ok_or_else(none)?;
    let sweep = SweepFile::parse("plane.json", stored.resolved()).validate();
    let sweep = sweep.and_then(|settings| settings.fixed());
    let sweep = sweep.map_err(|report| error::input(py, &report))?;
    let content = stored.content(&sweep.problem);
    Ok(Plane {
        plane: stored.plane().ok_or_else(none)?,
        content: content.map_err(|error| error::run(py, &error))?,
        sweep: Arc::new(sweep),
        home,
        holder: None,
    })
}

/// Opens the folder of curves or of a map.
#[pyfunction]
pub(crate) fn open_plane(py: Python<'_>, folder: PathBuf) -> PyResult<Plane> {
    stored_plane(py, Arc::new(Home::new(Some(folder))?))
}

#[pymethods]
impl Plane {
    #[getter]
    fn folder(&self) -> PathBuf {
        self.home.path().to_owned()
    }

    /// Keeps the folder for good.
    fn keep(&self) {
        self.home.keep();
        self.holder.iter().for_each(|home| home.keep());
    }

    #[getter]
    fn title(&self) -> &str {
        &self.sweep.settings.title
    }

    /// Both parameters, each with the ends of its side of the box.
    #[getter]
    fn sides(&self) -> Vec<(String, f64, f64)> {
        let sides = self.plane.sides().iter();
        sides
            .map(|side| (side.parameter.clone(), side.from, side.to))
            .collect()
    }

    #[getter]
    fn is_map(&self) -> bool {
        matches!(self.content, StoredPlaneContent::Map(_))
    }

    /// Every curve: what it is of, the indicator that is zero on it, its points (n × 2), the band's edge (n × 2), the
    /// status of each point, its ends in words. Those of levels come last; they are of no density, and their indicator
    /// is the number with its level.
    fn curves<'py>(&self, py: Python<'py>) -> PyResult<Vec<Bound<'py, PyDict>>> {
        let family = self.sweep.problem.family();
        let table = |of: &mut dyn Iterator<Item = [f64; 2]>| {
            let numbers: Vec<f64> = of.flatten().collect();
            let rows = numbers.len() / 2;
            numbers.into_pyarray(py).reshape([rows, 2])
        };
        let one = |names: [String; 2], points: &[CurvePoint], ends: &[CurveEnd]| {
            let row = PyDict::new(py);
            let [observable, indicator] = names;
            row.set_item("observable", observable)?;
            row.set_item("indicator", indicator)?;
            row.set_item("points", table(&mut points.iter().map(|one| one.values))?)?;
            row.set_item("to_edge", table(&mut points.iter().map(|one| one.to_edge))?)?;
            let statuses = points.iter().map(|one| one.status().word());
            row.set_item("status", statuses.collect::<Vec<_>>())?;
            let ends = ends.iter();
            let ends = ends.map(|end| (end.label.clone(), end.reason.words(&self.plane)));
            row.set_item("ends", ends.collect::<Vec<_>>())?;
            Ok(row)
        };
        let shape = |curve: &Curve| {
            let names = [curve.observable.name(family), curve.kind.name().to_owned()];
            one(names, &curve.points, &curve.ends)
        };
        let level =
            |curve: &LevelCurve| one([String::new(), curve.words()], &curve.points, &curve.ends);
        let shapes = self.curves_of().iter().map(shape);
        shapes.chain(self.levels_of().iter().map(level)).collect()
    }

    /// Points of codimension two: label, kind, both values, error, status.
    fn codimension_two(&self) -> Vec<(String, &'static str, [f64; 2], f64, &'static str)> {
        let found = codimension_two(self.curves_of()).into_iter();
        let row = found.map(|one| {
            let status = one.status().word();
            (one.label, one.kind.name(), one.values, one.error, status)
        });
        row.collect()
    }

    /// Solved places of a map: both values, status, the signature of every density.
    fn nodes(&self) -> Vec<([f64; 2], &'static str, Vec<String>)> {
        let StoredPlaneContent::Map(map) = &self.content else {
            return Vec::new();
        };
        let row = map.nodes.iter().map(|node| {
            let signatures = node.signatures.iter().map(ToString::to_string);
            (node.values, node.status.word(), signatures.collect())
        });
        row.collect()
    }

    #[getter]
    fn observables(&self) -> Vec<String> {
        let subject = self.sweep.problem.subject();
        let watched = subject.observables.iter();
        watched.map(|one| one.name(&subject.family)).collect()
    }

    /// Names of all figures.
    fn figure_names(&self) -> Vec<String> {
        self.with_figures(|figures| figures.names())
    }

    /// A figure by its name, the first page of one of several.
    fn figure(&self, py: Python<'_>, name: &str) -> PyResult<Option<Figure>> {
        let drawn = py.detach(|| self.with_figures(|figures| figures.draw(name)));
        let drawn = drawn.map_err(|error| error::other(py, error))?;
        Ok(drawn.into_iter().next().map(Figure))
    }

    /// The page of the explorer, as HTML; its densities are solved.
    fn page(&self, py: Python<'_>, tell: Option<Bound<'_, PyAny>>) -> PyResult<String> {
        let cancellation = Cancellation::new();
        let hear = |told| tell_words(tell.as_ref(), told);
        let ear: Option<Ear<'_>> = tell.is_some().then_some(&hear);
        let (page, raised) = watched(py, &cancellation, ear, None, |say| {
            let done = |done, wanted| {
                let words = "densities of the page".to_owned();
                say(Told::Words(words, Some((done, wanted))));
            };
            match &self.content {
                StoredPlaneContent::Map(map) => {
                    StoredPage::of_map(&self.sweep, map, &cancellation, &done)
                }
                StoredPlaneContent::Curves(_, tree, origin) => StoredPage::of_curves(
                    &self.sweep,
                    &self.plane,
                    (tree, &origin.label),
                    &cancellation,
                    &done,
                ),
            }
        });
        match raised {
            Some(raised) => Err(raised),
            None => page
                .map(|page| page.html().to_owned())
                .map_err(|error| error::other(py, error)),
        }
    }
}

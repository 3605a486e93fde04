//! A family of systems: a model with fixed values, and a path through its parameters. What is swept, said once.

mod deviations;

use std::collections::BTreeMap;
use std::sync::Arc;

use super::displaced::Displaced;
use super::{
    AtPhase, Enclosed, FieldQuestion, Model, ParameterValues, Path, Quantity, Questions, System,
    SystemError,
};

/// Systems along a path: one number in, a bound system out, with names and symbols for tables and figures.
///
/// ```
/// use pbif::system::{Family, Path, registry};
///
/// let model = registry::find("coulomb").unwrap();
/// let fixed = [("kappa", 0.01), ("mu", 0.01), ("sigma2", 0.01)];
/// let family = Family::new(model, &fixed, Path::parameter("f_c", -0.02, 0.01)).unwrap();
/// assert_eq!((family.parameter(), family.symbol()), ("f_c", "f_{c}"));
/// // At x = 0, y = 1: y' = -κ - f_c.
/// let system = family.at(0.005).unwrap();
/// assert!((system.drift_at(0.0, &[0.0, 1.0])[1] + 0.015).abs() < 1e-15);
/// ```
#[derive(Debug, Clone)]
pub struct Family {
    model: Arc<Model>,
    /// Those of the first end.
    values: ParameterValues,
    path: Path,
    walls: BTreeMap<usize, (f64, f64)>,
    origin: Option<MovingOrigin>,
    /// Numbered on from the axes.
    quantities: Vec<Arc<Quantity>>,
    /// What is asked of the systems beside their densities.
    pub questions: Questions,
}

/// What the coordinate of an axis is measured from.
#[derive(Debug, Clone, Copy)]
struct MovingOrigin {
    axis: usize,
    /// Where the first switching surface across the axis lies, in that coordinate.
    at: f64,
}

impl MovingOrigin {
    /// Where the origin lies for a system of the model.
    fn of(self, system: &dyn System) -> f64 {
        let surface = system.facts().surfaces_on(self.axis).next();
        surface.map_or(0.0, |at| at - self.at)
    }
}

impl Family {
    /// Values of the parameters that the path does not move, and the path. Both ends of the path and its middle must be
    /// allowed; the ends may be equal.
    ///
    /// # Errors
    /// [`SystemError::UnknownParameter`], [`SystemError::MissingParameter`], [`SystemError::OutOfRange`], and
    /// [`SystemError::Moved`] for a value that the path gives too.
    pub fn new(model: Arc<Model>, fixed: &[(&str, f64)], path: Path) -> Result<Self, SystemError> {
        let moves = |name: &str| path.moved().iter().any(|moved| moved == name);
        if let Some((name, _)) = fixed.iter().find(|(name, _)| moves(name)) {
            return Err(SystemError::Moved {
                parameter: (*name).to_owned(),
            });
        }
        let mut given = fixed.to_vec();
        given.extend(path.values(path.ends().0));
        let values = model.values(&given)?;
        let family = Self {
            model,
            values,
            path,
            walls: BTreeMap::new(),
            origin: None,
            quantities: Vec::new(),
            questions: Questions::default(),
        };
        family.along()?;
        Ok(family)
    }

    /// The family with quantities that can be watched like axes, as [`quantities`](super::quantities) reads them: they
    /// are numbered on from the axes of the state.
    #[must_use]
    pub fn with_quantities(mut self, quantities: Vec<Arc<Quantity>>) -> Self {
        self.quantities = quantities;
        self
    }

    /// The family between walls that reflect: axes with a lower and an upper wall, infinite where there is none. Noise
    /// acts on these axes, and cells and bins end at the walls.
    ///
    /// ```
    /// use pbif::system::{Family, Path, registry};
    ///
    /// let model = registry::find("bistable").unwrap();
    /// let path = Path::parameter("sigma2", 0.1, 0.2);
    /// let family = Family::new(model, &[("a", 1.0)], path).unwrap();
    /// let family = family.with_walls([(0, (0.0, f64::INFINITY))]);
    /// assert_eq!(family.at(0.1).unwrap().facts().reflecting[&0].0, 0.0);
    /// ```
    #[must_use]
    pub fn with_walls(mut self, walls: impl IntoIterator<Item = (usize, (f64, f64))>) -> Self {
        self.walls = walls.into_iter().collect();
        self
    }

    /// The walls that reflect, by axes: a lower and an upper one, infinite where there is none.
    pub(crate) fn walls(&self) -> &BTreeMap<usize, (f64, f64)> {
        &self.walls
    }

    /// The fields of all passages that are wanted.
    pub fn fields(&self) -> impl Iterator<Item = &FieldQuestion> {
        let passages = self.questions.passages.iter();
        passages.flat_map(|passage| &passage.fields)
    }

    /// The same model, walls, quantities and questions with other values, along another path.
    ///
    /// # Errors
    /// As [`Family::new`].
    pub(crate) fn along_path(
        &self,
        fixed: &[(&str, f64)],
        path: Path,
    ) -> Result<Self, SystemError> {
        let Self { values, path, .. } = Self::new(self.model.clone(), fixed, path)?;
        Ok(Self {
            values,
            path,
            ..self.clone()
        })
    }

    /// The quantities that can be watched.
    pub(crate) fn quantities(&self) -> &[Arc<Quantity>] {
        &self.quantities
    }

    /// Whether a quantity changes along the path.
    pub(crate) fn moves(&self, quantity: &Quantity) -> bool {
        quantity.depends_on(self.path.moved())
    }

    /// The quantity of a number among axes and quantities; `None` for an axis.
    pub(crate) fn quantity(&self, number: usize) -> Option<&Arc<Quantity>> {
        self.quantities
            .get(number.checked_sub(self.model.axes.len())?)
    }

    /// The axes of the state that an observable keeps at one phase of the forcing, and the phase in periods; `None` for
    /// any other observable.
    pub(crate) fn at_phase(&self, axes: &[usize]) -> Option<(Vec<usize>, f64)> {
        let at = |&axis: &usize| self.quantity(axis)?.phase();
        let all: Option<Vec<AtPhase>> = axes.iter().map(at).collect();
        let all = all?;
        let phase = all.first()?.phase;
        let is_one = all.iter().all(|one| one.phase == phase);
        is_one.then(|| (all.iter().map(|one| one.axis).collect(), phase))
    }

    /// The model.
    pub fn model(&self) -> &Arc<Model> {
        &self.model
    }

    /// The path.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The values that the path does not move, in the model's order of parameters.
    pub fn fixed(&self) -> impl Iterator<Item = (&str, f64)> {
        let parameters = self.model.parameters.iter().zip(self.values.as_slice());
        let moves = |name: &String| self.path.moved().contains(name);
        let fixed = parameters.filter(move |(parameter, _)| !moves(&parameter.name));
        fixed.map(|(parameter, &value)| (parameter.name.as_str(), value))
    }

    /// Name of the path's coordinate: that of the swept parameter, where it is one.
    pub fn parameter(&self) -> &str {
        self.path.name()
    }

    /// Symbol of the path's coordinate, with `_{}` and `^{}`.
    pub fn symbol(&self) -> &str {
        let of_parameter = || self.symbol_of(self.path.name());
        self.path.symbol().unwrap_or_else(of_parameter)
    }

    /// Symbol of a parameter, swept or not; its name where the model has none of that name.
    pub(crate) fn symbol_of<'n>(&'n self, name: &'n str) -> &'n str {
        let mut parameters = self.model.parameters.iter();
        let known = parameters.find(|parameter| parameter.name == name);
        known.map_or(name, |parameter| parameter.symbol.as_str())
    }

    /// First and last coordinate; the last may be below the first.
    pub fn ends(&self) -> (f64, f64) {
        self.path.ends()
    }

    /// The ends in ascending order.
    pub(crate) fn range(&self) -> (f64, f64) {
        let (from, to) = self.ends();
        (from.min(to), from.max(to))
    }

    /// Name of an axis of the state, for example `y`, or of the quantity of that number; `?` where there is none.
    pub fn axis(&self, axis: usize) -> &str {
        let known = self.model.axes.get(axis).map(|axis| axis.name.as_str());
        let quantity = || self.quantity(axis).map(|quantity| quantity.name());
        known.or_else(quantity).unwrap_or("?")
    }

    /// Symbol of an axis, with `_{}` and `^{}`, for example `ẋ`, or of the quantity of that number; `?` where there is
    /// none.
    pub(crate) fn axis_symbol(&self, axis: usize) -> &str {
        let known = self.model.axes.get(axis).map(|axis| axis.symbol.as_str());
        let quantity = || self.quantity(axis).map(|quantity| quantity.symbol());
        known.or_else(quantity).unwrap_or("?")
    }

    /// Names of what means are taken of: the axes of the state that are no angles, then the quantities that are
    /// averaged, then axes at phases of a forcing.
    pub(crate) fn averages(&self) -> impl Iterator<Item = &str> {
        let axes = self.states_on_lines().map(|(_, name)| name);
        let averaged = self.questions.averaged.iter().map(|one| one.name());
        axes.chain(averaged)
            .chain(self.at_phases().map(|(_, name)| name))
    }

    /// States at phases of the forcing that are watched and have a mean, which angles have not; with their names.
    pub(crate) fn at_phases(&self) -> impl Iterator<Item = (AtPhase, &str)> {
        let at = self.quantities.iter();
        let at = at.filter_map(|quantity| Some((quantity.phase()?, quantity.name())));
        at.filter(|(at, _)| !self.model.axes[at.axis].is_angle)
    }

    /// Axes that do not close on themselves, which angles and the phase of a forcing do, with their names.
    pub(crate) fn states_on_lines(&self) -> impl Iterator<Item = (usize, &str)> {
        let phase = self.model.phase_axis();
        let axes = self.model.axes.iter().enumerate();
        let lines = axes.filter(move |(index, axis)| !axis.is_angle && phase != Some(*index));
        lines.map(|(index, axis)| (index, axis.name.as_str()))
    }

    /// Axes of the state that are angles, with their names.
    pub(crate) fn angles(&self) -> impl Iterator<Item = (usize, &str)> {
        let axes = self.model.axes.iter().enumerate();
        let angles = axes.filter(|(_, axis)| axis.is_angle);
        angles.map(|(index, axis)| (index, axis.name.as_str()))
    }

    /// Values of all parameters at a coordinate, which may lie beyond the ends.
    ///
    /// # Errors
    /// [`SystemError::OutOfRange`].
    pub fn values_at(&self, coordinate: f64) -> Result<ParameterValues, SystemError> {
        let mut moved = self.path.values(coordinate).into_iter();
        moved.try_fold(self.values.clone(), |values, (name, value)| {
            self.model.with(&values, name, value)
        })
    }

    /// The system at a coordinate, which may lie beyond the ends.
    ///
    /// # Errors
    /// [`SystemError::OutOfRange`].
    pub fn at(&self, coordinate: f64) -> Result<Arc<dyn System>, SystemError> {
        Ok(self.framed(self.model.system(&self.values_at(coordinate)?)))
    }

    /// A system of the family's model, with the walls that reflect, seen from the family's origin.
    pub(crate) fn framed(&self, mut system: Arc<dyn System>) -> Arc<dyn System> {
        if !self.walls.is_empty() {
            system = Arc::new(Enclosed::reflecting(system, &self.walls));
        }
        let Some(origin) = self.origin else {
            return system;
        };
        let by = origin.of(system.as_ref());
        Arc::new(Displaced::new(system, origin.axis, by, origin.at))
    }

    /// The family in the coordinate of an axis in which the first switching surface across it stays where it is in the
    /// middle of the path: u = x - (s(θ) - s(middle)) with the place s of the surface.
    ///
    /// # Errors
    /// [`SystemError::OutOfRange`].
    pub(crate) fn following_surface(mut self, axis: usize) -> Result<Self, SystemError> {
        self.origin = None;
        let (from, to) = self.ends();
        let middle = self.at(0.5 * (from + to))?;
        let at = middle.facts().surfaces_on(axis).next();
        self.origin = at.map(|at| MovingOrigin { axis, at });
        Ok(self)
    }

    /// Whether the coordinate of an axis is measured from an origin that moves.
    pub(crate) fn has_moving_origin(&self) -> bool {
        self.origin.is_some()
    }

    /// The axis whose coordinate is measured from an origin that moves, and where the origin lies at a coordinate of
    /// the path; `None` where none moves.
    ///
    /// # Errors
    /// [`SystemError::OutOfRange`].
    pub(crate) fn origin_at(&self, coordinate: f64) -> Result<Option<(usize, f64)>, SystemError> {
        let Some(origin) = self.origin else {
            return Ok(None);
        };
        let system = self.model.system(&self.values_at(coordinate)?);
        Ok(Some((origin.axis, origin.of(system.as_ref()))))
    }

    /// The systems at both ends and in the middle: what is chosen once for a whole sweep is chosen for these.
    ///
    /// # Errors
    /// [`SystemError::OutOfRange`].
    pub(crate) fn along(&self) -> Result<Vec<Arc<dyn System>>, SystemError> {
        let (from, to) = self.ends();
        let middle = 0.5 * (from + to);
        let places = [from, middle, to].into_iter();
        places.map(|coordinate| self.at(coordinate)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::system::registry;

    const FIXED: [(&str, f64); 2] = [("kappa", 0.1), ("sigma2", 0.04)];

    #[test]
    fn a_parameter_moves_and_the_others_stay() {
        let model = registry::find("coulomb").unwrap();
        let path = Path::parameter("f_c", 0.5, -0.5);
        let family = Family::new(model, &FIXED, path).unwrap();
        assert_eq!(family.ends(), (0.5, -0.5));
        assert_eq!(family.range(), (-0.5, 0.5));
        assert_eq!(
            family.values_at(0.25).unwrap().as_slice(),
            [1.0, 0.1, 0.0, 0.25, 0.04]
        );
        // α x + κ y + f_c at x = y = 1.
        let forces = family.along().unwrap();
        let forces = forces
            .iter()
            .map(|system| -system.drift_at(0.0, &[1.0, 1.0])[1]);
        for (force, expected) in forces.zip([1.6, 1.1, 0.6]) {
            assert!((force - expected).abs() < 1e-15);
        }
        assert_eq!((family.axis(1), family.axis_symbol(1)), ("y", "ẋ"));
        assert_eq!((family.axis(7), family.axis_symbol(7)), ("?", "?"));
    }

    #[test]
    fn a_curve_moves_several_parameters_and_has_a_name_of_its_own() {
        let model = registry::find("coulomb").unwrap();
        let path = Path::curve("s", "s", ["f_c", "sigma2"], (0.0, 1.0), |s| {
            vec![0.1 * s, 0.01 + s * s]
        });
        let family = Family::new(model, &[("kappa", 0.1)], path).unwrap();
        assert_eq!((family.parameter(), family.symbol()), ("s", "s"));
        assert_eq!(
            family.values_at(0.5).unwrap().as_slice(),
            [1.0, 0.1, 0.0, 0.05, 0.26]
        );
    }

    #[test]
    fn what_does_not_fit_together_is_refused() {
        let new = |fixed: &[(&str, f64)], path: Path| {
            Family::new(registry::find("coulomb").unwrap(), fixed, path).unwrap_err()
        };
        let error = new(&FIXED, Path::parameter("kappa", 0.0, 1.0));
        assert!(matches!(error, SystemError::Moved { .. }), "{error}");
        let error = new(&FIXED, Path::parameter("friction", 0.0, 1.0));
        assert!(matches!(error, SystemError::UnknownParameter { .. }));
        // A `main` that returns it shows words.
        assert_eq!(
            format!("{error:?}"),
            "model `coulomb` has no parameter `friction`"
        );
        let error = new(&FIXED[..1], Path::parameter("f_c", 0.0, 1.0));
        assert!(matches!(error, SystemError::MissingParameter { .. }));
        let error = new(
            &[("kappa", 0.1), ("f_c", 0.0)],
            Path::parameter("sigma2", 1.0, -1.0),
        );
        assert!(matches!(error, SystemError::OutOfRange { .. }));
        let short = Path::curve("s", "s", ["f_c", "sigma2"], (0.0, 1.0), |s| vec![s]);
        let error = new(&[("kappa", 0.1)], short);
        assert!(matches!(error, SystemError::OutOfRange { .. }), "{error}");
    }
}

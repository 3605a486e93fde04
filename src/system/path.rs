//! A path through the parameters of a model: one number in, values of parameters out.

use std::sync::Arc;

/// Values of some parameters as functions of one number.
type Curve = dyn Fn(f64) -> Vec<f64> + Send + Sync;

/// A path through the parameters of a model, with its two ends.
///
/// The number that runs along it is its *coordinate*: the value of a parameter, or anything from which the values of
/// several parameters follow. The path itself ends nowhere; its ends say which part of it is of interest.
///
/// ```
/// use pbif::system::Path;
///
/// // The friction level, from feeding energy in to taking it out.
/// let friction = Path::parameter("f_c", -0.02, 0.01);
/// assert_eq!(friction.name(), "f_c");
///
/// // A circle in the plane of stiffness and noise, by its angle.
/// let circle = Path::curve("angle", "φ", ["alpha", "sigma2"], (0.0, 6.28), |angle| {
///     vec![1.0 + 0.2 * angle.cos(), 0.05 + 0.02 * angle.sin()]
/// });
/// assert_eq!(circle.ends(), (0.0, 6.28));
/// ```
#[derive(Clone)]
pub struct Path {
    name: String,
    /// `None`: that of the parameter.
    symbol: Option<String>,
    ends: (f64, f64),
    moved: Vec<String>,
    /// `None`: the coordinate is the value of the one parameter that is moved.
    curve: Option<Arc<Curve>>,
}

impl Path {
    /// The values of one parameter, from the first end to the last, which may be below the first.
    pub fn parameter(name: impl Into<String>, from: f64, to: f64) -> Self {
        let name = name.into();
        Self {
            moved: vec![name.clone()],
            name,
            symbol: None,
            ends: (from, to),
            curve: None,
        }
    }

    /// Any curve: `values` gives one value for each of the `moved` parameters, in their order. `name` and `symbol`
    /// (with `_{}` and `^{}`) are those of the coordinate.
    pub fn curve<S: Into<String>>(
        name: impl Into<String>,
        symbol: impl Into<String>,
        moved: impl IntoIterator<Item = S>,
        ends: (f64, f64),
        values: impl Fn(f64) -> Vec<f64> + Send + Sync + 'static,
    ) -> Self {
        Self {
            name: name.into(),
            symbol: Some(symbol.into()),
            ends,
            moved: moved.into_iter().map(Into::into).collect(),
            curve: Some(Arc::new(values)),
        }
    }

    /// Name of the coordinate, for files: that of the parameter, where there is one.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Symbol of the coordinate, with `_{}` and `^{}`; `None` where it is that of the parameter.
    pub(super) fn symbol(&self) -> Option<&str> {
        self.symbol.as_deref()
    }

    /// First and last coordinate.
    pub fn ends(&self) -> (f64, f64) {
        self.ends
    }

    /// Names of the parameters whose values the path gives.
    pub fn moved(&self) -> &[String] {
        &self.moved
    }

    /// Values of the moved parameters, in their order; NaN where the curve gives too few.
    pub(super) fn values(&self, coordinate: f64) -> Vec<(&str, f64)> {
        let values = match &self.curve {
            Some(curve) => curve(coordinate),
            None => vec![coordinate],
        };
        let names = self.moved.iter().map(String::as_str);
        names
            .zip(values.into_iter().chain(std::iter::repeat(f64::NAN)))
            .collect()
    }
}

impl std::fmt::Debug for Path {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Path")
            .field("name", &self.name)
            .field("ends", &self.ends)
            .field("moved", &self.moved)
            .finish_non_exhaustive()
    }
}

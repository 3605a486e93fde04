//! The seam of a sweep: whatever can give densities along a path.
//!
//! A [`DensitySource`] says what it gives densities of and is opened into sessions. A [`Session`] is a source at work:
//! it remembers what it solved, starts each solve from there, and owns everything that takes memory. Sessions of one
//! source know nothing of each other and may run side by side.

use super::{MeasureColumn, SolveReport};
#[cfg(feature = "serde")]
use crate::bytes::NotWhatWasWritten;
use crate::cancellation::{Cancellation, Cancelled};
use crate::density::{EstimatedDensity, Observable};
use crate::system::Family;

/// What a source gives densities of.
#[derive(Debug, Clone)]
pub struct Subject {
    /// Systems along a path; the ends of the path are those of a sweep.
    pub family: Family,
    /// The densities that are watched, in the order in which a source gives them.
    pub observables: Vec<Observable>,
    /// The derived measures that are asked for; those that every solve has are not among them.
    pub measures: Vec<MeasureColumn>,
    /// Whether what cells do to these densities can be checked.
    pub cell_check: CellCheck,
}

/// What is asked of a source that checks what another one found, of what that one gives.
#[derive(Debug, Clone, PartialEq)]
pub struct Want {
    /// The densities that are given; nothing is worked out for others.
    pub observables: Vec<Observable>,
    /// The derived measures that are given.
    pub measures: Vec<MeasureColumn>,
    /// Whether densities state the errors of their cells.
    pub errors: bool,
}

impl Want {
    /// Densities alone, which are compared with others and need state no error of their own.
    pub fn densities(observables: &[Observable]) -> Self {
        Self {
            observables: observables.to_vec(),
            measures: Vec::new(),
            errors: false,
        }
    }
}

/// Whether it can be checked what cells do to densities, beyond the errors that these state.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum CellCheck {
    /// By the same source on finer cells: [`DensitySource::finer`].
    OnFinerCells {
        /// Cells of an axis there over those here, above one; the smallest of all axes.
        ratio: f64,
        /// The axis along which they move with the places at which the drift jumps, which lie inside cells here.
        follows: Option<usize>,
    },
    /// It cannot: the cells move what is found, and finer ones would bring a noise of their own.
    Impossible,
    /// It need not: cells only count.
    Needless,
}

/// What a solve gives: a report with measures, densities, and how they answer to parameters.
pub struct Solution<'session> {
    /// How it went, and its measures.
    pub report: SolveReport,
    /// The watched densities, in the order of [`Subject::observables`]; empty without a density.
    pub densities: Vec<EstimatedDensity>,
    /// How the densities answer to parameters, from what the solve left in the session; `None` where the source cannot
    /// tell, or there is no density.
    pub sensitivity: Option<Box<dyn Sensitivity + 'session>>,
}

impl Solution<'_> {
    /// A solution without densities, for the reason that the report gives.
    pub fn without_density(report: SolveReport) -> Self {
        Self {
            report,
            densities: Vec::new(),
            sensitivity: None,
        }
    }

    /// The solution alone: the session is free again.
    pub fn detached(self) -> Solution<'static> {
        Solution {
            report: self.report,
            densities: self.densities,
            sensitivity: None,
        }
    }
}

impl std::fmt::Debug for Solution<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Solution")
            .field("report", &self.report)
            .field("densities", &self.densities.len())
            .field("has_sensitivity", &self.sensitivity.is_some())
            .finish()
    }
}

/// How the watched densities of a solved point change with parameters. It belongs to one [`Solution`], so that it
/// cannot be asked of another.
pub trait Sensitivity {
    /// dp/dθ of every watched density for a named parameter of the model, swept or not, all others held: one value a
    /// cell, in the order of [`Density::values`](crate::density::Density::values), ∫ = 0.
    ///
    /// # Errors
    /// [`SourceError::Method`] for a name that is no parameter, and when the solve does not converge;
    /// [`SourceError::Interrupted`].
    fn to_parameter(&mut self, name: &str) -> Result<Vec<Vec<f64>>, SourceError>;

    /// How the jumps that the equations imply at the kinks of every watched density change with a named parameter:
    /// those of its [`Structure::kinks`](crate::density::Structure::kinks), one after the other in their order; nothing
    /// where the source does not know.
    ///
    /// # Errors
    /// As [`Sensitivity::to_parameter`].
    fn jumps_to_parameter(&mut self, name: &str) -> Result<Vec<Vec<f64>>, SourceError> {
        let _ = name;
        Ok(Vec::new())
    }

    /// The same as [`Sensitivity::to_parameter`] for the coordinate of the path, which may move several parameters at
    /// once.
    ///
    /// # Errors
    /// As [`Sensitivity::to_parameter`].
    fn along_path(&mut self) -> Result<Vec<Vec<f64>>, SourceError>;
}

impl<S: DensitySource + ?Sized> DensitySource for Box<S> {
    fn method(&self) -> &'static str {
        self.as_ref().method()
    }

    fn subject(&self) -> &Subject {
        self.as_ref().subject()
    }

    fn open(&self, cancellation: &Cancellation) -> Box<dyn Session> {
        self.as_ref().open(cancellation)
    }

    fn segments(&self, values: usize) -> usize {
        self.as_ref().segments(values)
    }

    fn cells(&self) -> Option<usize> {
        self.as_ref().cells()
    }

    fn finer(&self, want: &Want) -> Result<Option<Box<dyn DensitySource>>, SourceError> {
        self.as_ref().finer(want)
    }

    fn enclosed(&self, want: &Want) -> Option<Box<dyn DensitySource>> {
        self.as_ref().enclosed(want)
    }
}

/// Why a source cannot give a solution at all. A failed solve is data, not an error: see
/// [`PointStatus`](super::PointStatus).
#[derive(Debug, thiserror::Error)]
pub enum SourceError {
    /// The source was asked to stop.
    #[error("interrupted")]
    Interrupted,
    /// The method refuses, for example because the parameter value is not allowed.
    #[error(transparent)]
    Method(#[from] Box<dyn std::error::Error + Send + Sync>),
}

#[cfg(feature = "serde")]
impl From<NotWhatWasWritten> for SourceError {
    fn from(error: NotWhatWasWritten) -> Self {
        Self::Method(Box::new(error))
    }
}

impl From<Cancelled> for SourceError {
    fn from(_: Cancelled) -> Self {
        Self::Interrupted
    }
}

/// A source of densities along a path through the parameters of a model.
///
/// # A source in full
///
/// The density of a particle in a quartic potential, from its formula. What is left of a solve is nothing, so a session
/// is a function.
///
/// ```
/// use pbif::cancellation::Cancellation;
/// use pbif::continuation::{CellCheck, DensitySource, Session, Solution, SolveReport, Subject};
/// use pbif::density::{Density, EstimatedDensity, Observable, Structure};
/// use pbif::space::Axis;
/// use pbif::system::{Family, Path, registry};
///
/// struct Quartic {
///     subject: Subject,
/// }
///
/// fn density(a: f64) -> EstimatedDensity {
///     let axis = Axis::uniform(-3.0, 3.0, 100).unwrap();
///     let value = |x: f64| (4.0 * (0.5 * a * x * x - 0.25 * x.powi(4))).exp();
///     let values: Vec<f64> = axis.centres().into_iter().map(value).collect();
///     let mass: f64 = values.iter().map(|value| value * axis.width(0)).sum();
///     let density = Density { axes: vec![axis], values: values.iter().map(|p| p / mass).collect() };
///     EstimatedDensity {
///         structure: Structure { centre: Some(vec![0.0]), ..Structure::default() },
///         negligible: 0.0,
///         ..EstimatedDensity::new(Observable::Marginal(0), density)
///     }
/// }
///
/// impl DensitySource for Quartic {
///     fn method(&self) -> &'static str {
///         "formula"
///     }
///     fn subject(&self) -> &Subject {
///         &self.subject
///     }
///     fn open(&self, _: &Cancellation) -> Box<dyn Session> {
///         Box::new(|a: f64| {
///             let mut solution = Solution::without_density(SolveReport::solved("formula"));
///             solution.densities = vec![density(a)];
///             Ok(solution)
///         })
///     }
/// }
///
/// let path = Path::parameter("a", -1.0, 1.0);
/// let family = Family::new(registry::find("bistable").unwrap(), &[("sigma2", 0.5)], path).unwrap();
/// let observables = vec![Observable::Marginal(0)];
/// let cell_check = CellCheck::Needless;
/// let source = Quartic { subject: Subject { family, observables, measures: Vec::new(), cell_check } };
/// let mut session = source.open(&Cancellation::new());
/// let solution = session.solve(0.3).unwrap();
/// assert!((solution.densities[0].density.masses().iter().sum::<f64>() - 1.0).abs() < 1e-12);
/// ```
pub trait DensitySource: Send + Sync {
    /// Name of the method in tables, for example `sgcm`.
    fn method(&self) -> &'static str;

    /// What it gives densities of.
    fn subject(&self) -> &Subject;

    /// Opens a session, which ends its work when `cancellation` is cancelled.
    fn open(&self, cancellation: &Cancellation) -> Box<dyn Session>;

    /// Into how many segments so many neighbouring values are best cut, each with a session of its own, all of them
    /// side by side: one where a solve has work for all cores, or lives on its neighbour's. It must not depend on the
    /// number of threads, because what is solved depends on it.
    fn segments(&self, values: usize) -> usize {
        let _ = values;
        1
    }

    /// How many cells a solve has; `None` where it has none.
    fn cells(&self) -> Option<usize> {
        None
    }

    /// The same source on finer cells, to check what was found; `None` where there is none, or it would say nothing
    /// (sampling errors differ from grid to grid). Its sessions solve only what is wanted.
    ///
    /// # Errors
    /// [`SourceError::Method`] when it cannot be made.
    fn finer(&self, want: &Want) -> Result<Option<Box<dyn DensitySource>>, SourceError> {
        let _ = want;
        Ok(None)
    }

    /// The same source with ends of Ω that let nothing out, to tell what the mass that leaves does; `None` where there
    /// is none. Its sessions solve only what is wanted.
    fn enclosed(&self, want: &Want) -> Option<Box<dyn DensitySource>> {
        let _ = want;
        None
    }
}

/// A source at work. It chooses its own start for every solve, from what it solved before: values are best asked for in
/// an order in which neighbours follow each other.
///
/// A function of a value is a session that remembers nothing.
pub trait Session: Send {
    /// The densities at a value of the path's coordinate, which may lie beyond its ends.
    ///
    /// # Errors
    /// [`SourceError`] when there is nothing to report; failed solves are reported in the solution. The session can be
    /// used on.
    fn solve(&mut self, value: f64) -> Result<Solution<'_>, SourceError>;

    /// Seconds that the last solution took when it was solved; `None` where that was just now.
    fn seconds(&self) -> Option<f64> {
        None
    }

    /// What the last solve has left in the session for later ones, so that [`Session::recall`] can bring another one
    /// there; nothing for sessions that remember nothing. Those of the methods tell with the feature `serde`.
    fn memory(&self) -> Vec<u8> {
        Vec::new()
    }

    /// Brings a fresh session of the same source to where another one was after its solves: `left` has the value of
    /// each, in their order, with the [`Session::memory`] after it. Whatever is solved then is the same to the bit as
    /// it would have been there.
    ///
    /// # Errors
    /// [`SourceError::Method`] when that is not what a session of this source has left; [`SourceError::Interrupted`].
    fn recall(&mut self, left: &[(f64, &[u8])]) -> Result<(), SourceError> {
        let _ = left;
        Ok(())
    }
}

impl<F> Session for F
where
    F: FnMut(f64) -> Result<Solution<'static>, SourceError> + Send,
{
    fn solve(&mut self, value: f64) -> Result<Solution<'_>, SourceError> {
        self(value)
    }
}

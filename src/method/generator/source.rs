//! The generator as a source of densities: what is prepared once for a sweep, and finer cells to check with.

use std::sync::Arc;

use super::GeneratorMethodOptions;
use super::options::{finer_axes, finer_factor, followed_surfaces};
use crate::cancellation::Cancellation;
use crate::continuation::Want;
use crate::generator::{
    AdvectiveScheme, Generator, GeneratorError, GeneratorOptions, LineRates, assemble,
    assemble_lines,
};
use crate::method::problem::Maps;
use crate::method::structure::{all_kinked_surfaces, closed_ends, fixed_surfaces, natural_ends};
use crate::method::watched::Masses;
use crate::method::{MethodError, Problem, has_densities};
use crate::space::{Axis, CellSpace};
use crate::stationary::generator::{RateOptions, RateSolver};
use crate::system::{Enclosed, Family, ParameterValues, SwitchingSurface, System, SystemError};

/// Name of the method in tables.
pub(super) const METHOD: &str = "generator";

/// By how much the solver's tolerance is smaller where low peaks decide.
pub(super) const SHARP: f64 = 1e-3;

/// Systems that differ in one parameter alone.
pub(super) struct Varied {
    family: Family,
    values: ParameterValues,
    name: String,
    /// The value of the parameter about which it is varied.
    pub(super) value: f64,
}

impl Varied {
    /// The system at a value of the parameter.
    pub(super) fn at(&self, value: f64) -> Result<Arc<dyn System>, SystemError> {
        let model = self.family.model();
        let values = model.with(&self.values, &self.name, value)?;
        Ok(self.family.framed(model.system(&values)))
    }
}

/// The unknowns of a steady state, and by how much those of another discretisation differ.
pub(super) type Known<'a> = (&'a [f64], &'a [f64]);

/// Densities along a path by the generator.
#[derive(Debug, Clone)]
pub struct GeneratorSource {
    pub(super) problem: Problem,
    pub(super) options: GeneratorMethodOptions,
    pub(super) closed_ends: Vec<[bool; 2]>,
    /// Ends of the axes of cells at which the noise dies somewhere along the path.
    pub(super) natural_ends: Vec<[bool; 2]>,
    pub(super) kinked: Vec<SwitchingSurface>,
    /// Whether nothing leaves Ω, whatever the system does there.
    pub(super) enclosed: bool,
    /// Whether densities are all that is asked for: a check compares them with what another source found, whose errors
    /// and relaxation are known.
    pub(super) checks: bool,
    /// Whether differences between schemes are worked out as well as the densities themselves: where errors are asked
    /// of finer cells, they decide on peaks that are many orders of magnitude lower than the highest.
    pub(super) sharp: bool,
}

impl GeneratorSource {
    /// What it gives densities of.
    pub(in crate::method) fn problem(&self) -> &Problem {
        &self.problem
    }

    /// Prepares a source.
    ///
    /// # Errors
    /// [`MethodError`].
    pub fn new(problem: &Problem, options: &GeneratorMethodOptions) -> Result<Self, MethodError> {
        let (systems, space) = (problem.family().along()?, problem.space());
        has_densities(problem)?;
        Ok(Self {
            problem: problem.checked_by(GeneratorMethodOptions::cell_check(problem)),
            options: options.clone(),
            closed_ends: closed_ends(&systems, space),
            natural_ends: natural_ends(&systems, space),
            kinked: all_kinked_surfaces(&systems, space),
            enclosed: false,
            checks: false,
            sharp: false,
        })
    }

    /// The system at a value of the path's coordinate.
    ///
    /// # Errors
    /// [`SystemError`].
    pub(super) fn system_at(&self, value: f64) -> Result<Arc<dyn System>, SystemError> {
        let system = self.open_at(value)?;
        if !self.enclosed {
            return Ok(system);
        }
        let ranges = self.problem.space().ranges();
        Ok(Arc::new(Enclosed::new(system, &ranges)))
    }

    /// The same without the ends that close the range for a check. Hardly anything is at such ends: a density between
    /// them is symmetric where its equations are, also where the ends are no mirror images of each other.
    pub(super) fn open_at(&self, value: f64) -> Result<Arc<dyn System>, SystemError> {
        self.problem.family().at(value)
    }

    /// The same on finer cells, which move with the places at which the drift is not smooth where densities of states
    /// are all that is wanted: what is not smooth inside a cell is not seen there, however small the cell.
    pub(super) fn refined(&self, want: &Want) -> Result<Self, MethodError> {
        let space = self.problem.space();
        let systems = self.problem.family().along()?;
        let finer = finer_axes(space).into_iter().enumerate();
        let finer =
            finer.map(|(axis, cells)| cells.with_faces_on(&fixed_surfaces(&systems, axis, space)));
        let mut finer: Vec<Axis> = finer.collect();
        let mut problem = self.problem.wanting(want);
        let followed = followed_surfaces(&self.problem).filter(|_| want.measures.is_empty());
        if let Some(surfaces) = followed {
            let cells = &mut finer[surfaces.axis];
            let [least, most] = surfaces.displacements;
            let range = (cells.from() - most, cells.to() - least);
            *cells = cells.about(range, &surfaces.places, &surfaces.left)?;
            problem = problem.following_surface(surfaces.axis)?;
        }
        let problem = problem.on(CellSpace::new(finer)?)?;
        let problem = problem.with_finer_bins(finer_factor(space));
        Ok(Self {
            checks: !want.errors,
            sharp: self.sharp || want.errors,
            ..Self::new(&problem, &self.options)?
        })
    }

    /// What turns masses into what is watched at a value of the path.
    pub(super) fn maps(&self, value: f64) -> Result<Arc<Maps>, MethodError> {
        self.problem.maps(value, &self.kinked, Masses::Exact)
    }

    /// The systems beside a value of the path that differ in a named parameter alone.
    pub(super) fn varied(&self, coordinate: f64, name: &str) -> Result<Varied, MethodError> {
        let family = self.problem.family();
        let model = family.model();
        let values = family.values_at(coordinate)?;
        Ok(Varied {
            value: values.as_slice()[model.parameter_index(name)?],
            name: name.to_owned(),
            family: family.clone(),
            values,
        })
    }

    /// The generator of a system by one of the schemes.
    pub(super) fn assemble(
        &self,
        system: &dyn System,
        scheme: AdvectiveScheme,
    ) -> Result<Generator, MethodError> {
        let options = GeneratorOptions { scheme };
        assemble(system, self.problem.space(), &options).map_err(|error| self.refused(error))
    }

    /// The generators of a system by some schemes, along the lines of the grid.
    pub(super) fn assemble_lines<const N: usize>(
        &self,
        system: &dyn System,
        schemes: [AdvectiveScheme; N],
    ) -> Result<[LineRates; N], MethodError> {
        let lines = assemble_lines(system, self.problem.space(), schemes);
        lines.map_err(|error| self.refused(error))
    }

    /// What could not be assembled, with the names of the axes.
    pub(super) fn refused(&self, error: GeneratorError) -> MethodError {
        let family = self.problem.family();
        let names: Vec<&str> = (0..self.problem.space().axes().len())
            .map(|axis| family.axis(axis))
            .collect();
        let words = error.with_names(&names);
        MethodError::Generator { error, words }
    }

    /// A solver without a factorisation yet.
    pub(super) fn solver(&self, cancellation: &Cancellation) -> RateSolver {
        let most = RateOptions::default().max_iterations;
        self.solver_within(most, cancellation)
    }

    /// A solver that gives up after so many iterations.
    pub(super) fn solver_within(
        &self,
        max_iterations: usize,
        cancellation: &Cancellation,
    ) -> RateSolver {
        let rates = RateOptions {
            max_iterations,
            tolerance: self.options.solver_tolerance * if self.sharp { SHARP } else { 1.0 },
            memory_limit_bytes: (self.options.memory_limit * 1e9) as u64,
            ..RateOptions::default()
        };
        RateSolver::new(self.problem.space().clone(), rates).cancelled_by(cancellation)
    }
}

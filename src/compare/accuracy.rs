//! Error against time: every method at one parameter value over a few grids or numbers of samples.

use super::observer::Steps;
use super::solve::{Sources, generator_on};
use super::{
    CompareError, ComparedValue, Distance, Method, PAPER_CELLS, Solved, Task, distances,
    exact_density, uniform_cells,
};
use crate::density::{EstimatedDensity, Observable};
use crate::space::CellSpace;

/// Cells an axis over those of the file, for the generator.
const GENERATOR_GRIDS: [f64; 2] = [0.5, 0.7];

/// Cells an axis of the finer grid that is the reference where no exact density is known; in more than two dimensions
/// the file's own grid is the finest that a short comparison can afford.
const REFERENCE_GRIDS: [Option<f64>; 2] = [Some(1.5), None];

/// Cells an axis over the paper's, for SGCM, in up to two dimensions and in more.
const SGCM_GRIDS: [&[f64]; 2] = [&[0.5, 2.0], &[0.5, 0.7]];

/// Shares of the time of the comparison's Monte Carlo; burn-in is not shortened.
const MONTE_CARLO_TIMES: [f64; 2] = [1.0 / 16.0, 1.0 / 4.0];

/// What errors are measured by.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Reference {
    /// The exact density.
    Exact,
    /// The generator on the finest grid, of which the cells are given.
    Generator(usize),
}

/// One method on one grid.
#[derive(Debug, Clone, PartialEq)]
pub struct AccuracyPoint {
    /// The method.
    pub method: Method,
    /// Cells of its grid.
    pub cells: usize,
    /// Samples a cell (SGCM), integrator steps (Monte Carlo) or 0.
    pub samples: u64,
    /// Seconds, preparation left out.
    pub seconds: f64,
    /// Total variation to the reference.
    pub error: Distance,
}

/// Error against time at one value.
#[derive(Debug, Clone, PartialEq)]
pub struct Accuracy {
    /// The parameter value.
    pub value: f64,
    /// The density that is compared.
    pub observable: Observable,
    /// What by.
    pub reference: Reference,
    /// The points, by method, and by time within one.
    pub points: Vec<AccuracyPoint>,
}

/// Measures at the first value with an exact density, else at the first at which all methods have one.
pub(super) fn measure(
    task: &Task<'_>,
    common: &CellSpace,
    sources: &Sources<'_>,
    values: &[ComparedValue],
    steps: &mut Steps<'_>,
) -> Result<Option<Accuracy>, CompareError> {
    let complete = |value: &&ComparedValue| {
        let mut all = value.solved.iter();
        all.all(|solved| solved.status.is_resolved())
    };
    let has_exact = |value: &&ComparedValue| value.pairs.iter().any(|pair| pair.second.is_none());
    let mut usable = values.iter().filter(complete);
    let Some(compared) = usable.clone().find(has_exact).or_else(|| usable.next()) else {
        return Ok(None);
    };
    let joint = |observable: &&Observable| matches!(observable, Observable::Joint(..));
    // The error of a quantity is not measured against the cells.
    let dimension = task.problem.space().dimension();
    let of_axes = |observable: &&Observable| {
        let axes = observable.axes();
        axes.into_iter().all(|axis| axis < dimension)
    };
    let watched = || task.problem.observables().iter().filter(of_axes);
    let Some(&observable) = watched().find(joint).or(watched().next()) else {
        return Ok(None);
    };
    let gauge = Gauge {
        task,
        common,
        compared,
        observable,
    };
    gauge.measure(sources, steps).map(Some)
}

/// The value, the density and the cells of a measurement.
struct Gauge<'a> {
    task: &'a Task<'a>,
    common: &'a CellSpace,
    compared: &'a ComparedValue,
    observable: Observable,
}

impl Gauge<'_> {
    fn measure(
        &self,
        sources: &Sources<'_>,
        steps: &mut Steps<'_>,
    ) -> Result<Accuracy, CompareError> {
        let value = self.compared.value;
        let many = usize::from(self.common.dimension() > 2);
        let mut runs: Vec<(CellSpace, Solved)> = Vec::new();
        for factor in GENERATOR_GRIDS {
            runs.extend(self.generator(factor, steps)?);
        }
        for &factor in SGCM_GRIDS[many] {
            let count = (PAPER_CELLS as f64 * factor).round() as usize;
            let space = uniform_cells(self.common, count)?;
            let both = steps.solved(&mut || sources.sgcm_on(&space, value))?;
            runs.extend(both.into_iter().map(|solved| (space.clone(), solved)));
        }
        for share in MONTE_CARLO_TIMES {
            let solved = steps.solved(&mut || Ok(vec![sources.monte_carlo_for(share, value)?]))?;
            runs.extend(solved.into_iter().map(|one| (self.common.clone(), one)));
        }
        for solved in &self.compared.solved {
            let space = match solved.method {
                Method::Generator => self.task.problem.space(),
                _ => self.common,
            };
            runs.push((space.clone(), solved.clone()));
        }
        let (reference, finest) = self.reference(many, steps)?;
        let mut points = Vec::new();
        for (space, solved) in &runs {
            let is_reference = matches!(reference, Reference::Generator(cells)
                if solved.method == Method::Generator && space.n_cells() == cells);
            if !is_reference {
                points.extend(self.point(space, solved, finest.as_ref())?);
            }
        }
        points.sort_by(|a, b| {
            let place = |method| Method::ALL.iter().position(|&one| one == method);
            let by_method = place(a.method).cmp(&place(b.method));
            by_method.then(a.seconds.total_cmp(&b.seconds))
        });
        Ok(Accuracy {
            value,
            observable: self.observable,
            reference,
            points,
        })
    }

    /// The generator on cells finer or coarser by a factor.
    fn generator(
        &self,
        factor: f64,
        steps: &mut Steps<'_>,
    ) -> Result<Option<(CellSpace, Solved)>, CompareError> {
        let axes = self.task.problem.space().axes().iter();
        let space = CellSpace::new(axes.map(|axis| axis.refined(factor)).collect())?;
        let (value, cancellation) = (self.compared.value, steps.cancellation);
        let solved = steps.solved(&mut || {
            let on = (&space, self.common);
            Ok(vec![generator_on(
                self.task,
                on.0,
                on.1,
                value,
                cancellation,
            )?])
        })?;
        Ok(solved.into_iter().next().map(|solved| (space, solved)))
    }

    /// What errors are measured by, with the density where it is not the exact one.
    fn reference(
        &self,
        many: usize,
        steps: &mut Steps<'_>,
    ) -> Result<(Reference, Option<EstimatedDensity>), CompareError> {
        if self.compared.pairs.iter().any(|pair| pair.second.is_none()) {
            return Ok((Reference::Exact, None));
        }
        if let Some(factor) = REFERENCE_GRIDS[many]
            && let Some((space, solved)) = self.generator(factor, steps)?
            && solved.status.is_resolved()
            && let Some(density) = self.density(&solved)
        {
            return Ok((Reference::Generator(space.n_cells()), Some(density.clone())));
        }
        let own = self
            .compared
            .density(Method::Generator, self.observable)
            .cloned();
        let cells = self.task.problem.space().n_cells();
        Ok((Reference::Generator(cells), own))
    }

    fn density<'b>(&self, solved: &'b Solved) -> Option<&'b EstimatedDensity> {
        let mut densities = solved.densities.iter();
        densities.find(|density| density.observable == self.observable)
    }

    /// The distance of a density to the reference; `None` where there is no density.
    fn point(
        &self,
        space: &CellSpace,
        solved: &Solved,
        finest: Option<&EstimatedDensity>,
    ) -> Result<Option<AccuracyPoint>, CompareError> {
        let Some(density) = self.density(solved) else {
            return Ok(None);
        };
        let exact = match finest {
            Some(_) => None,
            None => exact_density(
                self.task.problem.family(),
                self.compared.value,
                space,
                self.common,
                self.observable,
            )?,
        };
        let Some(reference) = finest.or(exact.as_ref()) else {
            return Ok(None);
        };
        let found = distances(density, reference, false)?;
        Ok(Some(AccuracyPoint {
            method: solved.method,
            cells: space.n_cells(),
            samples: match solved.method {
                Method::Generator => 0,
                Method::MonteCarlo => solved.work.steps,
                Method::Sgcm | Method::SgcmSlope => solved.work.samples as u64,
            },
            seconds: solved.work.seconds(),
            error: found.total_variation,
        }))
    }
}

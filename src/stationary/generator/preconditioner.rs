//! A factorisation of a generator with one cell held, and the choice of one that fits the memory.

mod whole;

use sprs::CsMat;

use super::RateError;
use super::dissection::Grid;
use super::harmonics::HarmonicFactors;
use super::modewise::{Layout, ModeFactors, has_phase, others};
use super::narrowing::narrow;
use super::prediction::{Prediction, predict};
use crate::cancellation::Cancellation;
use crate::space::CellSpace;
use whole::WholeFactors;

/// Largest leaf of the dissection, in cells; measured (`benches/rates.rs`): 60 to 200 make no difference.
const LEAF: usize = 70;

/// Bytes of factors beyond which memory bounds the iterations, so that single precision is faster; it has
/// needed as many iterations as double in every trial, because GMRES refines in double.
pub(super) const LARGE: u64 = 16 << 20;

/// How many times the work of factors mode by mode those of all modes together may take: these need fewer iterations,
/// and warm starts last longer with them. It is about four for two modes, and rises with the square of their number.
const MUCH_MORE: f64 = 4.0;

/// Operations of factors of all nodes of a phase together that are few, whatever its harmonics one by one would take:
/// a fraction of a second on two cores, and no forcing is too strong for them.
const FEW_OPERATIONS: f64 = 1e10;

/// Copies of a matrix that are made on the way to its factors: scaled, in the order of elimination, by fronts.
const COPIES: u64 = 4;

/// Bytes of copies of a matrix.
fn copies(matrix: &CsMat<f64>) -> u64 {
    COPIES * matrix.nnz() as u64 * (size_of::<f64>() + size_of::<usize>()) as u64
}

/// Asks the system for so many bytes and gives them back. A limit of the process (`ulimit -v`) shows here; in the
/// middle of a factorisation it would end the program.
fn check_room(needed: u64) -> Result<(), RateError> {
    // Nothing is written to it: only room among the addresses is asked for.
    let mut room = Vec::<u8>::new();
    match usize::try_from(needed).map(|bytes| room.try_reserve_exact(bytes)) {
        Ok(Ok(())) => Ok(()),
        _ => Err(RateError::NoRoom { needed }),
    }
}

/// The factorisation that solves or preconditions.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum RateMethod {
    /// LU of Q.
    Lu,
    /// LU of Q in single precision: half the memory, a few more iterations.
    LuSingle,
    /// LU of a matrix of reach one with the drift and diffusion of Q.
    NarrowLu,
    /// The same in single precision.
    NarrowLuSingle,
    /// LU of every Legendre mode by itself, in single precision, lower modes first: for many modes. Of a phase, LU of
    /// every harmonic by itself.
    Modewise,
}

impl RateMethod {
    /// All methods that any axes can have, most demanding first.
    pub const ALL: [Self; 4] = [
        Self::Lu,
        Self::LuSingle,
        Self::NarrowLu,
        Self::NarrowLuSingle,
    ];

    /// Name used in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Lu => "lu",
            Self::LuSingle => "lu-single",
            Self::NarrowLu => "narrow-lu",
            Self::NarrowLuSingle => "narrow-lu-single",
            Self::Modewise => "modewise-lu-single",
        }
    }

    pub(super) fn is_narrow(self) -> bool {
        matches!(self, Self::NarrowLu | Self::NarrowLuSingle)
    }

    /// Whether its factors are those of the matrix itself, to rounding.
    pub(super) fn is_exact(self) -> bool {
        matches!(self, Self::Lu | Self::LuSingle)
    }

    fn bytes_per_number(self) -> usize {
        match self {
            Self::Lu | Self::NarrowLu => size_of::<f64>(),
            Self::LuSingle | Self::NarrowLuSingle | Self::Modewise => size_of::<f32>(),
        }
    }
}

/// What a solve will take.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Estimate {
    /// The factorisation that will be used.
    pub method: RateMethod,
    /// Bytes of the factors.
    pub factor_bytes: u64,
    /// Bytes of factors and fronts at the peak.
    pub peak_bytes: u64,
    /// Floating-point operations of one factorisation.
    pub operations: f64,
    /// Floating-point operations of one iteration.
    pub iteration_operations: f64,
}

/// What is known of a matrix before its numbers.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Structure {
    /// Cells that the stencil reaches along each axis.
    pub(super) reach: Vec<usize>,
    /// Axis at whose lower end images of cells couple.
    pub(super) folded: Option<usize>,
}

/// The grid that a method dissects. Modes are all coupled, so that no cut runs across them: those of a place stay
/// together.
fn grid(space: &CellSpace, structure: &Structure, method: RateMethod) -> Grid {
    let reach = &structure.reach;
    let axes = space.axes().iter().enumerate();
    let reach: Vec<usize> = axes
        .map(
            |(index, axis)| match (axis.is_modes(), method.is_narrow()) {
                (true, _) => axis.count() - 1,
                (false, true) => 1,
                (false, false) => reach.get(index).copied().unwrap_or(1),
            },
        )
        .collect();
    Grid::new(&space.shape(), &reach, LEAF).fold_at(structure.folded)
}

/// The grid of factors of all cells together.
pub(super) fn whole_grid(space: &CellSpace, structure: &Structure) -> Grid {
    grid(space, structure, RateMethod::LuSingle)
}

/// The grid of the places at which modes stand that are taken one by one, that of all other axes; `None` where there
/// are none.
fn grid_of_places(space: &CellSpace, structure: &Structure) -> Option<Grid> {
    let (places, kept) = others(space)?;
    let reach = kept.iter().map(|&axis| structure.reach.get(axis).copied());
    let of_places = Structure {
        reach: reach.map(|reach| reach.unwrap_or(1)).collect(),
        folded: structure
            .folded
            .and_then(|folded| kept.iter().position(|&axis| axis == folded)),
    };
    Some(grid(&places, &of_places, RateMethod::Modewise))
}

/// Predicts what factors of every mode by itself take; `None` where there are no modes that can be taken so.
fn predict_modewise(space: &CellSpace, structure: &Structure) -> Option<Estimate> {
    let method = RateMethod::Modewise;
    let prediction = predict(&grid_of_places(space, structure)?);
    let places = others(space)?.0.n_cells() as f64;
    let modes = space.n_cells() as f64 / places;
    // The rates from lower modes into higher ones, and changing the basis there and back.
    let below = places * 0.5 * modes * (modes - 1.0);
    let number = method.bytes_per_number() as f64;
    let entries = modes * prediction.factor_entries + below;
    let change = places * modes.powi(2);
    // A harmonic is a complex number for two modes, and a product of two of those four products.
    let factorised = match has_phase(space) {
        true => 2.0 * modes - 1.0,
        false => modes,
    };
    Some(Estimate {
        method,
        factor_bytes: (entries * number) as u64,
        peak_bytes: (modes * prediction.bytes(method.bytes_per_number()) + below * number) as u64,
        operations: factorised * prediction.operations + 4.0 * change * modes,
        iteration_operations: 2.0 * entries + 4.0 * change,
    })
}

/// Predicts what one method takes.
fn predict_method(space: &CellSpace, structure: &Structure, method: RateMethod) -> Estimate {
    let prediction: Prediction = predict(&grid(space, structure, method));
    let number = method.bytes_per_number();
    Estimate {
        method,
        factor_bytes: (prediction.factor_entries * number as f64) as u64,
        peak_bytes: prediction.bytes(number) as u64,
        operations: prediction.operations,
        iteration_operations: 2.0 * prediction.factor_entries,
    }
}

/// Predicts memory and work for a stencil that reaches `reach` cells along each axis; `method` is the wanted
/// factorisation, `None` the first that fits.
///
/// # Errors
/// [`RateError::Memory`] when not even the smallest fits.
pub fn estimate(
    space: &CellSpace,
    reach: &[usize],
    memory_limit_bytes: u64,
    method: Option<RateMethod>,
) -> Result<Estimate, RateError> {
    let structure = Structure {
        reach: reach.to_vec(),
        folded: None,
    };
    estimate_of(space, &structure, memory_limit_bytes, method)
}

/// [`estimate`] for a matrix that may be folded.
pub(super) fn estimate_of(
    space: &CellSpace,
    structure: &Structure,
    memory_limit_bytes: u64,
    method: Option<RateMethod>,
) -> Result<Estimate, RateError> {
    let mut needed = 0;
    let modewise = predict_modewise(space, structure);
    let fits = |plan: &Estimate| plan.peak_bytes <= memory_limit_bytes;
    match (method, modewise.filter(fits)) {
        (Some(RateMethod::Modewise), Some(plan)) => return Ok(plan),
        (None, Some(plan)) => {
            let whole = predict_method(space, structure, RateMethod::LuSingle);
            let few = if has_phase(space) {
                FEW_OPERATIONS
            } else {
                0.0
            };
            let is_much = whole.operations > few.max(MUCH_MORE * plan.operations);
            if !fits(&whole) || is_much {
                return Ok(plan);
            }
        }
        _ => {}
    }
    for candidate in RateMethod::ALL {
        if method.is_some_and(|wanted| wanted != candidate) {
            continue;
        }
        let estimate = predict_method(space, structure, candidate);
        if method.is_none() && candidate == RateMethod::Lu && estimate.factor_bytes > LARGE {
            continue;
        }
        if estimate.peak_bytes <= memory_limit_bytes {
            return Ok(estimate);
        }
        needed = estimate.peak_bytes;
    }
    Err(RateError::Memory {
        needed,
        limit: memory_limit_bytes,
    })
}

/// In place of the number of the cell that is held: none is, which factors of all cells together can have.
pub(super) const NO_CELL: usize = usize::MAX;

/// M⁻¹ for M = Q (or its stand-in) with the row and column of one cell replaced by the identity's.
pub(super) struct Preconditioner {
    factors: AnyFactors,
    /// The cell held in the current factors, or [`NO_CELL`].
    pub(super) held: usize,
}

/// What is kept of a matrix.
enum AnyFactors {
    Whole(WholeFactors),
    Modes(Box<ModeFactors>),
    Harmonics(Box<HarmonicFactors>),
}

impl Preconditioner {
    /// Factorises; takes over the structure and memory of `old` when the pattern is the same. Factors mode by mode may
    /// hold another cell than the one asked for.
    ///
    /// # Errors
    /// [`RateError::NoRoom`], [`RateError::Cancelled`].
    pub(super) fn new(
        space: &CellSpace,
        structure: &Structure,
        method: RateMethod,
        matrix: &CsMat<f64>,
        held: usize,
        old: Option<Self>,
        cancellation: &Cancellation,
    ) -> Result<Self, RateError> {
        if old.is_none() {
            let plan = estimate_of(space, structure, u64::MAX, Some(method))?;
            check_room(plan.peak_bytes + copies(matrix))?;
        }
        if method == RateMethod::Modewise
            && let Some(grid) = grid_of_places(space, structure)
            && let Some(layout) = Layout::new(space, grid)
        {
            if has_phase(space) {
                let factors = HarmonicFactors::new(layout, matrix, held, cancellation)?;
                return Ok(Self {
                    held: factors.held,
                    factors: AnyFactors::Harmonics(Box::new(factors)),
                });
            }
            let factors = ModeFactors::new(layout, matrix, held, cancellation)?;
            return Ok(Self {
                held: factors.held,
                factors: AnyFactors::Modes(Box::new(factors)),
            });
        }
        let old = old.and_then(|old| match old.factors {
            AnyFactors::Whole(factors) => Some(factors),
            AnyFactors::Modes(_) | AnyFactors::Harmonics(_) => None,
        });
        let grid = || grid(space, structure, method);
        let narrowed = method.is_narrow().then(|| narrow(space, matrix));
        let matrix = narrowed.as_ref().unwrap_or(matrix);
        let factors = WholeFactors::new(grid, method, (matrix, held), old, cancellation)?;
        Ok(Self {
            factors: AnyFactors::Whole(factors),
            held,
        })
    }

    /// M⁻¹ r for each r, zero at the held cell, in one pass through the factors. To the bit what each gives by itself.
    pub(super) fn apply<const R: usize>(&self, residuals: [&[f64]; R]) -> [Vec<f64>; R] {
        match &self.factors {
            AnyFactors::Whole(factors) => factors.apply(residuals, self.held),
            AnyFactors::Modes(factors) => factors.apply(residuals),
            AnyFactors::Harmonics(factors) => factors.apply(residuals),
        }
    }

    /// M⁻¹ r, zero at the held cell.
    pub(super) fn apply_one(&self, residual: &[f64]) -> Vec<f64> {
        let [vector] = self.apply([residual]);
        vector
    }

    /// M⁻ᵀ r, zero at the held cell.
    pub(super) fn apply_transposed(&self, residual: &[f64]) -> Vec<f64> {
        match &self.factors {
            AnyFactors::Whole(factors) => factors.apply_transposed(residual, self.held),
            AnyFactors::Modes(factors) => factors.apply_transposed(residual),
            AnyFactors::Harmonics(factors) => factors.apply_transposed(residual),
        }
    }

    /// Bytes of the factors.
    pub(super) fn factor_bytes(&self) -> u64 {
        match &self.factors {
            AnyFactors::Whole(factors) => factors.bytes(),
            AnyFactors::Modes(factors) => factors.bytes(),
            AnyFactors::Harmonics(factors) => factors.bytes(),
        }
    }
}

//! Where a solver stands, as numbers: with the matrices that it holds on to, another one can be brought there.

use super::RateMethod;
use crate::bytes::{NotWhatWasWritten, Reader, Writer};

/// Most axes of a grid.
const MOST_AXES: usize = crate::MAX_DIMENSION;

/// Where a [`RateSolver`](super::RateSolver) stands.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SolverMemory {
    /// Reach of the stencil and method of later factorisations.
    pub(super) plan: Option<(Vec<usize>, RateMethod)>,
    /// The same of the last factorisation.
    pub(super) factorised: Option<(Vec<usize>, RateMethod)>,
    /// Whether all of it is of the solver on half of the cells.
    pub(super) folded: bool,
    /// The cell that it holds.
    pub(super) held: usize,
    pub(super) excess: usize,
    pub(super) baseline: usize,
}

impl SolverMemory {
    /// All of it as bytes.
    pub fn write(&self, writer: &mut Writer) {
        for chosen in [&self.plan, &self.factorised] {
            writer.flag(chosen.is_some());
            if let Some((reach, method)) = chosen {
                writer.count(reach.len()).text(method.name());
                for &cells in reach {
                    writer.count(cells);
                }
            }
        }
        writer.flag(self.folded);
        let Self {
            held,
            excess,
            baseline,
            ..
        } = *self;
        writer.count(held).count(excess).count(baseline);
    }

    /// What was written.
    ///
    /// # Errors
    /// [`NotWhatWasWritten`].
    pub fn read(reader: &mut Reader<'_>) -> Result<Self, NotWhatWasWritten> {
        Ok(Self {
            plan: read_chosen(reader)?,
            factorised: read_chosen(reader)?,
            folded: reader.flag()?,
            held: reader.count()?,
            excess: reader.count()?,
            baseline: reader.count()?,
        })
    }
}

fn read_chosen(
    reader: &mut Reader<'_>,
) -> Result<Option<(Vec<usize>, RateMethod)>, NotWhatWasWritten> {
    if !reader.flag()? {
        return Ok(None);
    }
    let axes = reader.count()?;
    let name = reader.text()?;
    let method = RateMethod::named(name);
    if axes > MOST_AXES {
        return Err(NotWhatWasWritten);
    }
    let reach: Result<Vec<usize>, _> = (0..axes).map(|_| reader.count()).collect();
    Ok(Some((reach?, method.ok_or(NotWhatWasWritten)?)))
}

//! How a matrix is made ready to be solved: whether a cell is held, and which.

use sprs::CsMat;

use super::super::balance::add_product;
use super::super::newton::{FirstPass, norm};
use super::super::preconditioner::NO_CELL;
use super::super::solver::{largest, shape};
use super::super::{RateError, RateMethod};
use super::{Absorbing, AbsorbingSolver, LIGHT, Visits, without};

/// Another cell is held where the one that is held is occupied for less than this share of the longest time.
const LEAST_HELD: f64 = 1e-3;

/// Cells that are tried.
const TRIED: usize = 3;

impl AbsorbingSolver<'_> {
    /// Makes ready to solve a matrix, `n × n` by columns, column j the rates out of cell j, summing to -`ends[j]`, and
    /// gives the times for a process that starts spread as `start`. The first matrix is factorised.
    ///
    /// # Errors
    /// [`RateError::Shape`], and any error of a factorisation or of [`AbsorbingSolver::times`].
    pub(crate) fn stage<'a>(
        &mut self,
        matrix: &'a CsMat<f64>,
        ends: &'a [f64],
        start: &[f64],
    ) -> Result<(Absorbing<'a>, Vec<f64>), RateError> {
        let cells = self.space.n_cells();
        shape(cells, "matrix", matrix.cols())?;
        shape(cells, "ends", ends.len())?;
        shape(cells, "start", start.len())?;
        let mut held = match &self.preconditioner {
            Some(kept) if kept.held == NO_CELL || is_alone(matrix, ends, kept.held) => {
                let stage = Absorbing {
                    matrix,
                    ends,
                    held: kept.held,
                    visits: None,
                };
                let times = self.times(&stage, start)?;
                return Ok((stage, times));
            }
            Some(kept) => kept.held,
            None => {
                if let Some(found) = self.without_held(matrix, ends, start)? {
                    return Ok(found);
                }
                // In double precision where single precision did not do.
                if std::mem::take(&mut self.is_light)
                    && let Some(found) = self.without_held(matrix, ends, start)?
                {
                    return Ok(found);
                }
                let structure = self.structure(matrix);
                self.factorise(matrix, &structure, largest(start).0)?
            }
        };
        let mut tried = 1;
        loop {
            let unit = self.unit(matrix, held)?;
            let mut stage = Absorbing {
                matrix,
                ends,
                held,
                visits: Some(Visits {
                    unit,
                    ended: Vec::new(),
                }),
            };
            let times = self.times(&stage, start)?;
            // The cell that is held may turn out to be occupied for a short time only.
            let (longest, time) = largest(&times);
            if times[held].abs() >= LEAST_HELD * time || tried == TRIED {
                let ended = self.reduced(matrix, held, &without(ends, held), true)?;
                if let Some(visits) = &mut stage.visits {
                    visits.ended = ended;
                }
                return Ok((stage, times));
            }
            held = self.factorise(matrix, &self.structure(matrix), longest)?;
            tried += 1;
        }
    }

    /// A stage at which no cell is held, or one that is coupled to none, with the times for a start; `None` where
    /// that may not be, factors are in single precision, or Q is too near to a singular matrix for one pass a solve.
    fn without_held<'a>(
        &mut self,
        matrix: &'a CsMat<f64>,
        ends: &'a [f64],
        start: &[f64],
    ) -> Result<Option<(Absorbing<'a>, Vec<f64>)>, RateError> {
        let alone = (0..ends.len()).find(|&cell| is_alone(matrix, ends, cell));
        let none = self.is_free.then_some(NO_CELL);
        let Some(held) = alone.or(none).filter(|_| self.is_rough) else {
            return Ok(None);
        };
        let structure = self.structure(matrix);
        if !self.is_light && self.method(&structure)? != RateMethod::Lu {
            return Ok(None);
        }
        self.factorise(matrix, &structure, held)?;
        let Some(kept) = &self.preconditioner else {
            return Ok(None);
        };
        let source: Vec<f64> = start.iter().map(|value| -value).collect();
        let mut times = kept.apply_one(&source);
        let mut rest = vec![0.0; source.len()];
        add_product(matrix, &times, &mut rest);
        let pairs = rest.iter_mut().zip(&source);
        pairs.for_each(|(product, source)| *product = source - *product);
        let correction = kept.apply_one(&rest);
        self.work.passes += 2;
        let first = FirstPass {
            contraction: norm(&correction) / norm(&times),
            left: norm(&rest) / norm(&source),
        };
        let is_enough = match self.is_light {
            true => first.contraction <= LIGHT,
            false => first.is_enough(0.0, self.options.tolerance),
        };
        if !is_enough {
            return Ok(None);
        }
        (self.first, self.is_unheld) = (Some(first), true);
        let pairs = times.iter_mut().zip(correction);
        pairs.for_each(|(value, correction)| *value += correction);
        let stage = Absorbing {
            matrix,
            ends,
            held,
            visits: None,
        };
        Ok(Some((stage, times)))
    }

    fn unit(&mut self, matrix: &CsMat<f64>, held: usize) -> Result<Vec<f64>, RateError> {
        let mut source = vec![0.0; self.space.n_cells()];
        if let Some(column) = matrix.outer_view(held) {
            for (row, rate) in column.iter() {
                source[row] = -rate;
            }
        }
        source[held] = 0.0;
        let mut unit = self.reduced(matrix, held, &source, false)?;
        unit[held] = 1.0;
        Ok(unit)
    }
}

/// Whether a cell is coupled to no other, and nothing ends there: one inside a target.
fn is_alone(matrix: &CsMat<f64>, ends: &[f64], cell: usize) -> bool {
    let column = matrix.outer_view(cell);
    ends[cell] == 0.0 && column.is_some_and(|column| column.nnz() == 1)
}

//! Where mass ends when several classes hold some: shares of the initial mass.

use super::chain::SoundMatrix;
use super::classes::ClassShare;
use crate::cancellation::{Cancellation, Cancelled};
use crate::space::CellSpace;

/// Transient mass that is left to be shared out in proportion to the latest flows.
const REMAINDER: f64 = 1e-6;

/// Steps after which the remainder is shared out anyway: its slowest mode then sets the proportions.
const MOST_STEPS: usize = 5_000;

/// A row of no class.
const TRANSIENT: usize = usize::MAX;

/// Pushes `initial` (mass of each row, Σ = 1) until it is absorbed by the classes or the sink. Returns the
/// classes with their shares, and the share of the sink.
pub(super) fn shares(
    matrix: &SoundMatrix<'_>,
    space: &CellSpace,
    classes: &[(f64, Vec<usize>)],
    initial: &[f64],
    cancellation: &Cancellation,
) -> Result<(Vec<ClassShare>, f64), Cancelled> {
    let mut class_of = vec![TRANSIENT; matrix.len()];
    for (class, (_, rows)) in classes.iter().enumerate() {
        rows.iter().for_each(|&row| class_of[row] = class);
    }
    let sink = classes.len();
    let mut absorbed = vec![0.0; sink + 1];
    let mut flow = vec![0.0; sink + 1];
    let mut transient = initial.to_vec();
    for (mass, &class) in transient.iter_mut().zip(&class_of) {
        if class != TRANSIENT {
            absorbed[class] += std::mem::take(mass);
        }
    }
    let mut left: f64 = transient.iter().sum();
    for _ in 0..MOST_STEPS {
        cancellation.check()?;
        if left < REMAINDER {
            break;
        }
        transient = step(matrix, &class_of, &transient, &mut flow);
        for (total, inflow) in absorbed.iter_mut().zip(&flow) {
            *total += inflow;
        }
        left = transient.iter().sum();
    }
    share_out(left, &flow, &mut absorbed);
    let describe = |(class, (leak, rows)): (usize, &(f64, Vec<usize>))| {
        describe(matrix, space, rows, absorbed[class], *leak)
    };
    let found = classes.iter().enumerate().map(describe).collect();
    Ok((found, absorbed[sink]))
}

/// One map step: the transient mass that is left, and in `flow` what the classes and, last, the sink absorb.
fn step(
    matrix: &SoundMatrix<'_>,
    class_of: &[usize],
    transient: &[f64],
    flow: &mut [f64],
) -> Vec<f64> {
    flow.fill(0.0);
    if let Some(sink) = flow.last_mut() {
        let leaving = matrix.escape.iter().zip(transient);
        *sink = leaving.map(|(escape, mass)| escape * mass).sum();
    }
    let mut next = vec![0.0; matrix.len()];
    for (row, (value, &class)) in next.iter_mut().zip(class_of).enumerate() {
        let entries = matrix.row(row);
        let inflow: f64 = entries.map(|(from, share)| share * transient[from]).sum();
        if class == TRANSIENT {
            *value = inflow;
        } else {
            flow[class] += inflow;
        }
    }
    next
}

/// Shares out what is left in the proportions of the latest flows.
fn share_out(left: f64, flow: &[f64], absorbed: &mut [f64]) {
    let flowing: f64 = flow.iter().sum();
    if flowing > 0.0 {
        for (total, inflow) in absorbed.iter_mut().zip(flow) {
            *total += left * inflow / flowing;
        }
    }
}

/// Size and place of a class.
fn describe(
    matrix: &SoundMatrix<'_>,
    space: &CellSpace,
    rows: &[usize],
    share: f64,
    leak: f64,
) -> ClassShare {
    let mut centre = vec![0.0; space.dimension()];
    for &row in rows {
        for (sum, coordinate) in centre.iter_mut().zip(space.centre(matrix.cells[row])) {
            *sum += coordinate / rows.len() as f64;
        }
    }
    // In widths of the cell, so that axes of different units weigh alike.
    let off_centre = |cell: usize| -> f64 {
        let axes = space.axes().iter().zip(&centre).enumerate();
        let offset = |(index, (axis, at)): (usize, (&crate::space::Axis, &f64))| {
            let position = space.position(cell, index);
            ((axis.centre(position) - at) / axis.width(position)).powi(2)
        };
        axes.map(offset).sum()
    };
    let cells = rows.iter().map(|&row| matrix.cells[row]);
    let nearest = cells.min_by(|&a, &b| off_centre(a).total_cmp(&off_centre(b)));
    ClassShare {
        cells: rows.len(),
        centre,
        representative: nearest.unwrap_or_default(),
        share,
        escape_per_step: leak,
    }
}

//! Generators to try solvers on: finite volumes on uniform boxes, 5th-order upwind-biased advection, central
//! diffusion. Knows nothing of the crate, so that the benches use it too.

#![allow(
    unreachable_pub,
    dead_code,
    reason = "shared by tests and benches, which use different parts"
)]

use std::collections::BTreeMap;

use sprs::CsMat;

/// One axis: range, cells, diffusion σ²/2, and whether its ends are walls (otherwise mass flows out).
#[derive(Clone, Copy)]
pub struct TestAxis {
    pub from: f64,
    pub to: f64,
    pub count: usize,
    pub diffusion: f64,
    pub walls: bool,
}

/// Weights of the cells around a face for a flow toward higher cells, offsets from the cell below the face:
/// 5th order, 3rd, 1st, whichever the ends allow.
const UPWIND: [&[(isize, f64)]; 3] = [
    &[
        (-2, 2.0 / 60.0),
        (-1, -13.0 / 60.0),
        (0, 47.0 / 60.0),
        (1, 27.0 / 60.0),
        (2, -3.0 / 60.0),
    ],
    &[(-1, -1.0 / 6.0), (0, 5.0 / 6.0), (1, 2.0 / 6.0)],
    &[(0, 1.0)],
];

/// Q by columns and the escape, for cells in C order; `drift(axis, state)`.
pub fn generator(
    lines: &[TestAxis],
    drift: impl Fn(usize, &[f64]) -> f64,
) -> (CsMat<f64>, Vec<f64>) {
    let n: usize = lines.iter().map(|line| line.count).product();
    let mut columns: Vec<BTreeMap<usize, f64>> = vec![BTreeMap::new(); n];
    let mut escape = vec![0.0; n];
    let width = |line: &TestAxis| (line.to - line.from) / line.count as f64;
    for axis in 0..lines.len() {
        let line = &lines[axis];
        let (h, count) = (width(line), line.count as isize);
        let stride: usize = lines[axis + 1..].iter().map(|line| line.count).product();
        for cell in 0..n {
            let place = (cell / stride % line.count) as isize;
            let mut state = Vec::new();
            let mut rest = cell;
            for line in lines.iter().rev() {
                let at = (rest % line.count) as f64 + 0.5;
                state.push(line.from + at * width(line));
                rest /= line.count;
            }
            state.reverse();
            // The face above the cell.
            state[axis] += 0.5 * h;
            let speed = drift(axis, &state) / h;
            if place + 1 == count {
                if !line.walls && speed > 0.0 {
                    *columns[cell].entry(cell).or_default() -= speed;
                    escape[cell] += speed;
                }
            } else {
                let at = |offset: isize| (cell as isize + offset * stride as isize) as usize;
                let mut flow = |offset: isize, rate: f64| {
                    *columns[at(offset)].entry(cell).or_default() -= rate;
                    *columns[at(offset)].entry(at(1)).or_default() += rate;
                };
                let side = |offset: isize| if speed > 0.0 { offset } else { 1 - offset };
                let inside = |weights: &&&[(isize, f64)]| {
                    let places = weights.iter().map(|weight| place + side(weight.0));
                    places.into_iter().all(|place| (0..count).contains(&place))
                };
                if let Some(weights) = UPWIND.iter().find(inside) {
                    for &(offset, weight) in *weights {
                        flow(side(offset), speed * weight);
                    }
                }
                let rate = line.diffusion / (h * h);
                flow(0, rate);
                flow(1, -rate);
            }
            if place == 0 && !line.walls {
                state[axis] -= h;
                let speed = -drift(axis, &state) / h;
                if speed > 0.0 {
                    *columns[cell].entry(cell).or_default() -= speed;
                    escape[cell] += speed;
                }
            }
        }
    }
    (compress(columns), escape)
}

fn compress(columns: Vec<BTreeMap<usize, f64>>) -> CsMat<f64> {
    let n = columns.len();
    let mut start = vec![0];
    let (mut rows, mut rates) = (Vec::new(), Vec::new());
    for column in columns {
        for (row, rate) in column {
            if rate != 0.0 {
                rows.push(row);
                rates.push(rate);
            }
        }
        start.push(rows.len());
    }
    CsMat::new_csc((n, n), start, rows, rates)
}

/// Duffing oscillator with friction, x' = y, y' = -κy - x - μx³ - f sgn(y) + ξ, on `count` × `count` cells.
pub fn oscillator(count: usize, friction: f64) -> (CsMat<f64>, Vec<f64>) {
    let line = |diffusion: f64| TestAxis {
        from: -4.0,
        to: 4.0,
        count,
        diffusion,
        walls: false,
    };
    generator(&[line(0.0), line(0.005)], |axis, state| {
        let (x, y) = (state[0], state[1]);
        if axis == 0 {
            y
        } else {
            let sign = if y == 0.0 { 0.0 } else { y.signum() };
            -0.01 * y - x - 0.01 * x.powi(3) - friction * sign
        }
    })
}

/// Duffing oscillator with Dahl friction at stiffness α, z' = y - (λ|y|/f_c) z between walls.
pub fn dahl(shape: [usize; 3], alpha: f64) -> (CsMat<f64>, Vec<f64>) {
    let (friction, lambda) = (0.05, 0.06);
    let line = |reach: f64, count: usize, diffusion: f64, walls: bool| TestAxis {
        from: -reach,
        to: reach,
        count,
        diffusion,
        walls,
    };
    let lines = [
        line(2.5, shape[0], 0.0, false),
        line(2.5, shape[1], 0.01, false),
        line(friction / lambda, shape[2], 0.0, true),
    ];
    generator(&lines, |axis, state| {
        let (x, y, z) = (state[0], state[1], state[2]);
        match axis {
            0 => y,
            1 => -0.02 * y - alpha * x - x.powi(3) - lambda * z,
            _ => y - lambda * y.abs() / friction * z,
        }
    })
}

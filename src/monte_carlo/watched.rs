//! Free trajectories that are watched in windows, and how what they show is correlated in time.

use super::autocorrelation::{Correlation, correlation};
use super::batch::{Batch, Limits, Purpose, key, random_point};
use crate::cancellation::Cancelled;
use crate::sampling::Stepper;
use crate::space::CellSpace;
use crate::system::{LANES, Lanes};

/// Means recorded of each trajectory in a window.
pub(super) const RECORDS: usize = 512;
/// Looks at the state that make one mean, and steps between looks, in the first window.
pub(super) const LOOKS: usize = 4;
/// Differences between numbers that are the same, relative to the largest of them.
const ROUNDING: f64 = 1e-12;

/// Series of one trajectory: means of x_i, and of x_i², an axis.
pub(super) struct Watched {
    pub(super) batch: Batch,
    /// `means[2·axis + power - 1][record]`, one value a lane.
    means: Vec<Vec<Lanes>>,
}

impl Watched {
    /// A batch of a number that starts at the middle of Ω, or all over it. Of a forced system all trajectories start at
    /// phase zero.
    pub(super) fn start(
        (space, phase): (&CellSpace, Option<usize>),
        seed: u64,
        (number, is_all_over): (u64, bool),
    ) -> Self {
        let dimension = space.dimension();
        let points: Vec<_> = (0..LANES as u64)
            .map(|lane| random_point(seed, number * LANES as u64 + lane, dimension))
            .collect();
        let of_axis = |(axis, edges): (usize, &crate::space::Axis)| {
            let mut lanes = [0.0; LANES];
            for (value, point) in lanes.iter_mut().zip(&points) {
                let share = if phase == Some(axis) {
                    0.0
                } else if is_all_over {
                    point[axis]
                } else {
                    0.5
                };
                *value = edges.from() + share * (edges.to() - edges.from());
            }
            lanes
        };
        let states: Vec<Lanes> = space.axes().iter().enumerate().map(of_axis).collect();
        Self {
            batch: Batch::new(states, key(seed, Purpose::Settle, number)),
            means: vec![Vec::new(); 2 * dimension],
        }
    }

    /// Records means over `LOOKS` looks, `stride` steps apart. What was recorded before is burn-in and forgotten.
    /// Means, not values: an oscillation that is faster than the records must not look slow.
    pub(super) fn window(
        &mut self,
        stepper: &Stepper<'_>,
        limits: &Limits,
        stride: usize,
    ) -> Result<(), Cancelled> {
        self.means.iter_mut().for_each(Vec::clear);
        for _ in 0..RECORDS {
            let mut sums = vec![[0.0; LANES]; self.means.len()];
            for _ in 0..LOOKS {
                self.batch.advance(stepper, stride)?;
                for (axis, lanes) in self.batch.states.iter().enumerate() {
                    for lane in 0..LANES {
                        sums[2 * axis][lane] += lanes[lane] / LOOKS as f64;
                        sums[2 * axis + 1][lane] += lanes[lane] * lanes[lane] / LOOKS as f64;
                    }
                }
            }
            self.batch.retire(limits);
            for (means, sums) in self.means.iter_mut().zip(sums) {
                means.push(sums);
            }
        }
        Ok(())
    }
}

/// One realisation a trajectory that has not run away, of whatever is made of its means.
fn series(
    watched: &[Watched],
    value: &(dyn Fn(&Watched, usize, usize) -> f64 + Sync),
) -> Vec<Vec<f64>> {
    let lanes = watched
        .iter()
        .flat_map(|one| (0..LANES).map(move |lane| (one, lane)));
    let alive = lanes.filter(|(one, lane)| one.batch.alive[*lane]);
    alive
        .map(|(one, lane)| {
            (0..RECORDS)
                .map(|record| value(one, record, lane))
                .collect()
        })
        .collect()
}

/// What the records of a window say of the axes, their squares and the energy.
pub(super) struct Correlations {
    pub(super) mean: Vec<f64>,
    pub(super) variance: Vec<f64>,
    /// As in [`Relaxation`].
    pub(super) averaging_time: Vec<f64>,
    /// Longest autocorrelation time, in records.
    pub(super) longest: f64,
}

/// How a number of all trajectories is correlated in time. Trajectories of a forced system have one phase, and what
/// moves with it never dies out: there deviations from the mean of all of them at each time count.
fn of_series(mut series: Vec<Vec<f64>>, forced: bool) -> Correlation {
    if !forced || series.is_empty() {
        return correlation(&series);
    }
    let count = series.len() as f64;
    let means: Vec<f64> = (0..series[0].len())
        .map(|record| series.iter().map(|one| one[record]).sum::<f64>() / count)
        .collect();
    let whole = means.iter().sum::<f64>() / means.len() as f64;
    let largest = means
        .iter()
        .fold(0.0_f64, |most, mean| most.max(mean.abs()));
    let mut apart = 0.0_f64;
    for one in &mut series {
        for (value, mean) in one.iter_mut().zip(&means) {
            apart = apart.max((*value - mean).abs());
            *value += whole - mean;
        }
    }
    // What is left of a number that is the same for all, as the phase itself is, is rounding.
    if apart <= ROUNDING * largest {
        return Correlation {
            mean: whole,
            time: 0.5,
            long_run_variance: 0.0,
        };
    }
    correlation(&series)
}

/// Σ (x_i - m_i(t))²/s_i² of every trajectory, with the means m(t) of all of them at each record and the variances
/// about these. An axis along which all are alike, as the phase, has no part.
fn about_moving_mean(watched: &[Watched], dimension: usize) -> Vec<Vec<f64>> {
    let mut sums: Vec<Vec<f64>> = Vec::new();
    for axis in 0..dimension {
        let mut values = series(watched, &|one, record, lane| {
            one.means[2 * axis][record][lane]
        });
        let count = values.len() as f64;
        let (mut variance, mut largest) = (0.0, 0.0_f64);
        for record in 0..RECORDS {
            let mean = values.iter().map(|one| one[record]).sum::<f64>() / count;
            largest = largest.max(mean.abs());
            for one in &mut values {
                one[record] = (one[record] - mean).powi(2);
                variance += one[record] / (count * RECORDS as f64);
            }
        }
        sums.resize(values.len(), vec![0.0; RECORDS]);
        if variance.sqrt() > ROUNDING * largest {
            for (sum, value) in sums.iter_mut().flatten().zip(values.iter().flatten()) {
                *sum += value / variance;
            }
        }
    }
    sums
}

/// Correlations of a window; `spacing` is the time of one record.
pub(super) fn correlations(
    watched: &[Watched],
    dimension: usize,
    forced: bool,
    spacing: f64,
) -> Correlations {
    let correlation = |series: Vec<Vec<f64>>| of_series(series, forced);
    let power = |place: usize| {
        move |one: &Watched, record: usize, lane: usize| one.means[place][record][lane]
    };
    let first: Vec<Correlation> = (0..dimension)
        .map(|axis| correlation(series(watched, &power(2 * axis))))
        .collect();
    let mean: Vec<f64> = first.iter().map(|found| found.mean).collect();
    let square = |axis: usize, one: &Watched, record: usize, lane: usize| {
        let of = |place: usize| one.means[place][record][lane];
        of(2 * axis + 1) - mean[axis] * (2.0 * of(2 * axis) - mean[axis])
    };
    let squares: Vec<Correlation> = (0..dimension)
        .map(|axis| {
            correlation(series(watched, &|one, record, lane| {
                square(axis, one, record, lane)
            }))
        })
        .collect();
    let variance: Vec<f64> = squares.iter().map(|found| found.mean).collect();
    let energy = correlation(series(watched, &|one, record, lane| {
        let part =
            |axis: usize| square(axis, one, record, lane) / variance[axis].max(f64::MIN_POSITIVE);
        (0..dimension).map(part).sum()
    }));
    let ratio = |found: &Correlation| {
        let relative = found.long_run_variance * spacing / (found.mean * found.mean);
        if relative.is_finite() { relative } else { 0.0 }
    };
    let averaged = || squares.iter().chain([&energy]);
    // The product of a deviation and the moving mean beats, and what beats looks forgotten long before it is.
    let about_mean = forced.then(|| correlation(about_moving_mean(watched, dimension)));
    let times = first.iter().chain(averaged()).chain(&about_mean);
    let times = times.map(|found| found.time);
    Correlations {
        averaging_time: averaged().map(ratio).collect(),
        longest: times.fold(0.5, f64::max),
        mean,
        variance,
    }
}

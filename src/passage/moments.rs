//! Moments, rate and shares of exits on one grid, with what other generators change of them to first order.

use super::density_start::DensityStart;
use super::exits::{Exits, rate_change as entry_change};
use super::quasi_stationary::{Given, QuasiStationary};
use super::{PassageError, dot};
use crate::generator::{AbsorbingGenerator, RateChange};
use crate::stationary::generator::{AbsorbingSolver, Expected};

/// Numbers of a passage: mean, standard deviation, the rate of the quasi-stationary density, the shares of exits; then
/// the probabilities at times and the quantiles that are asked for.
pub(super) struct Numbers {
    pub(super) values: Vec<f64>,
    /// Errors beside those of the cells: of the start, and of the models behind the last numbers.
    pub(super) errors: Vec<f64>,
    /// What a border of lower order changes of mean, standard deviation, rate and shares.
    pub(super) border: Vec<f64>,
    /// What of the mean's relative error comes from the density of the start, and from the border.
    pub(super) stretch: f64,
}

/// Mean, standard deviation and rate by a generator, and by another one to first order of what they differ by; what a
/// border of lower order changes of the first adds what it does to the errors. The start is given by many nodes and by
/// fewer, and may be spread as a density that has errors of its own. The density of the rate is given too; it is looked
/// for from `begun` on.
pub(super) fn moments(
    solver: &mut AbsorbingSolver<'_>,
    ([one, other], border, exits): ([&AbsorbingGenerator; 2], &RateChange, &Exits),
    [start, coarse]: [&[f64]; 2],
    spread_start: Option<&DensityStart<'_>>,
    begun: Option<Vec<f64>>,
) -> Result<([Numbers; 2], Vec<f64>), PassageError> {
    if one.ends.iter().all(|&rate| rate == 0.0) {
        return Err(PassageError::Never);
    }
    let matrix = one.matrix();
    let (stage, first) = solver.stage(&matrix, &one.ends, start)?;
    // A density from another grid is turned once toward this grid's by the pass that the second moment takes.
    let begun = begun.filter(|begun| dot(begun, begun) > 0.0);
    let (second, begun) = match begun {
        Some(begun) => {
            let [second, turned] = solver.times_of_both(&stage, [&first, &begun])?;
            (second, Some([begun, turned]))
        }
        None => (solver.times(&stage, &first)?, None),
    };
    let [weights, others] = &one.weights;
    let expected = solver.expected(&stage, weights)?;
    let again = solver.expected(&stage, &expected.values())?;
    // What the solves of either side leave is in both to first order, and in what both give together to second.
    let left_of = |source: &[f64], expected: &Expected, times: &[f64], balance: &[f64]| {
        expected.over(source) + stage.of_balance(balance, expected, times)
    };
    let [of_first, of_second] = [&first, &second].map(|times| stage.balance(times));
    let mean = dot(weights, &first) + left_of(start, &expected, &first, &of_first);
    let square = 2.0
        * (dot(weights, &second)
            + left_of(&first, &expected, &second, &of_second)
            + left_of(start, &again, &first, &of_first));
    let lasting = QuasiStationary::find(
        solver,
        &stage,
        other,
        Given {
            again: &again,
            second: &second,
            begun,
            mean,
        },
    )?;
    let by_other = |pairs: [(&Expected, &[f64]); 1]| -> f64 {
        let [through] = Expected::through(pairs, &other.rates, &other.ends);
        through
    };
    let parts = exits.rates(&one.endings);
    let entering = parts.iter().map(|rates| solver.expected(&stage, rates));
    let entering: Vec<Expected> = entering.collect::<Result<_, _>>()?;
    let into = parts.iter().zip(&entering);
    let shares: Vec<f64> = into
        .map(|(rates, share)| dot(rates, &first) + left_of(start, share, &first, &of_first))
        .collect();
    let others_parts = exits.rates(&other.endings);
    let pairs = parts.iter().zip(&others_parts).zip(&entering);
    let share_changes = pairs.map(|((own, others), share)| {
        entry_change(own, others, &first) + by_other([(share, first.as_slice())])
            - stage.of_balance(&of_first, share, &first)
    });
    let share_changes: Vec<f64> = share_changes.collect();
    // Of mean, mean square and rate, from what is w·Q' z by another generator.
    let pairs = [
        (&expected, first.as_slice()),
        (&expected, &second),
        (&again, &first),
    ];
    let changes = |[of_mean, of_second, of_again]: [f64; 3], of_rate: f64| {
        [of_mean, 2.0 * (of_second + of_again), of_rate]
    };
    let by_half = {
        let [mean, second_one, again_one] = Expected::through(pairs, &other.rates, &other.ends);
        let moments = [
            mean - stage.of_balance(&of_first, &expected, &first),
            second_one - stage.of_balance(&of_second, &expected, &second),
            again_one - stage.of_balance(&of_first, &again, &first),
        ];
        changes(moments, lasting.change)
    };
    let of_border = {
        let (left, density) = (&lasting.left, lasting.density.as_slice());
        let moments = Expected::through(pairs, &border.rates, &border.ends);
        let [of_rate] = Expected::through([(left, density)], &border.rates, &border.ends);
        changes(moments, -of_rate / left.over(density))
    };
    let border_parts = exits.rates(&border.endings);
    let border_shares = border_parts.iter().zip(&entering).map(|(rates, share)| {
        let pair = [(share, first.as_slice())];
        let [through] = Expected::through(pair, &border.rates, &border.ends);
        dot(rates, &first) + through
    });
    let spread = (square - mean * mean).max(f64::MIN_POSITIVE).sqrt();
    let [of_mean, of_square, of_rate] = of_border;
    let of_deviation = (0.5 * of_square - mean * of_mean) / spread;
    let mut border = [of_mean, of_deviation, of_rate].map(f64::abs).to_vec();
    border.extend(border_shares.map(f64::abs));
    // What fewer nodes change of the start, and another way to end sums at an oblique border.
    let of_start = expected.difference(start, coarse).abs();
    let of_sums = (dot(others, &first) - mean).abs();
    let squares: Vec<f64> = (again.beside().iter())
        .zip(expected.beside())
        .map(|(again, expected)| (again - mean * expected) / spread)
        .collect();
    let of_density = spread_start.map_or([0.0; 2], |start| {
        [start.error(expected.beside()), start.error(&squares)]
    });
    let mut errors = vec![
        of_start + of_sums + of_density[0],
        of_start + of_sums + of_density[1],
        0.0,
    ];
    errors.extend(entering.iter().map(|share| {
        let of_density = spread_start.map_or(0.0, |start| start.error(share.beside()));
        share.difference(start, coarse).abs() + of_density
    }));
    let numbers = |mean: f64, square: f64, rate: f64, shares: &[f64]| {
        let deviation = (square - mean * mean).max(0.0).sqrt();
        let values = [&[mean, deviation, rate], shares].concat();
        let is_finite = values.iter().all(|value| value.is_finite());
        is_finite.then(|| Numbers {
            values,
            errors: errors.clone(),
            border: border.clone(),
            stretch: (of_density[0] + border[0]) / mean,
        })
    };
    let [mean_change, square_change, rate_change] = by_half;
    let full = numbers(mean, square, lasting.rate, &shares);
    let half_shares: Vec<f64> = shares
        .iter()
        .zip(share_changes)
        .map(|(share, change)| share + change)
        .collect();
    let half = numbers(
        mean + mean_change,
        square + square_change,
        lasting.rate + rate_change,
        &half_shares,
    );
    match (full, half) {
        (Some(full), Some(half)) => Ok(([full, half], lasting.density)),
        _ => Err(PassageError::Rounding),
    }
}

//! First passages on one axis, from the chain that its motion is (`generator::chain`): a line with a place on every
//! border, on which mean times are exact but for the quadrature.

use super::bordered::{Bordered, Inside};
use super::{Passage, PassageError, Start, Timed, WithError, near_border, probability};
use crate::generator::{Chain, Reach, Reduced};
use crate::numerics::bisected;
use crate::stationary::generator::AbsorbingWork;
use crate::system::BoundQuantity;

/// Vectors of the model that tells probabilities at times.
const VECTORS: usize = 40;

/// Share of the vectors that tell by how much fewer would change a number.
const FEWER: f64 = 0.8;

/// Halvings of a bracket of a time.
const HALVINGS: usize = 200;

/// The numbers of a passage of a system on one axis; `None` where its line has no end.
///
/// # Errors
/// [`PassageError`].
pub(crate) fn timed_on_line(
    reach: &Reach<'_>,
    passage: &Passage,
) -> Option<Result<Timed, PassageError>> {
    let mut regions = vec![&passage.until];
    regions.extend(&passage.exits);
    let mut places = Vec::new();
    match &passage.start {
        Start::State(state) => places.extend(state.first()),
        Start::Density(region) => regions.extend(region),
    }
    let bordered = Bordered::new(reach, &regions, &places)?;
    Some(timed(&bordered, passage))
}

fn timed(bordered: &Bordered, passage: &Passage) -> Result<Timed, PassageError> {
    let line = &bordered.line;
    let until = bordered.target(&passage.until)?;
    let ends = until.places();
    let start = start(bordered, passage, &until)?;
    // Of what lies between other borders nothing comes to be known.
    let ends = unreached(&ends, &start);
    let exits = passage.exits.iter();
    let exits: Vec<Vec<bool>> = exits
        .map(|part| bordered.places_of_part(part, &until))
        .collect();
    let all = line.grids().map(|grid| {
        let own = OnGrid {
            chain: &grid.chain,
            ends: &grid.sampled(&ends),
            start: &grid.restricted(&start),
        };
        let exits: Vec<Vec<bool>> = exits.iter().map(|part| grid.sampled(part)).collect();
        own.numbers(passage, &exits)
    });
    let [whole, thinned, shorter] = &all;
    let mut known = (0..whole.len()).map(|number| {
        let (own, by_fewer) = whole[number];
        let (value, error) = line.extrapolated([own, thinned[number].0, shorter[number].0]);
        (value, error + by_fewer)
    });
    let mut next = || known.next().unwrap_or((f64::NAN, f64::NAN));
    let [mean, deviation, rate] = [next(), next(), next()];
    if !(mean.0 > mean.1 && deviation.0 > 0.0 && rate.0 > 0.0 && mean.0.is_finite()) {
        return Err(PassageError::Rounding);
    }
    Ok(Timed {
        mean,
        deviation,
        rate,
        shares: known
            .by_ref()
            .take(passage.exits.len())
            .map(probability)
            .collect(),
        survival: known
            .by_ref()
            .take(passage.times.len())
            .map(probability)
            .collect(),
        quantiles: known.collect(),
        work: AbsorbingWork::default(),
    })
}

/// The weights of the places at the start, Σ = 1.
fn start(bordered: &Bordered, passage: &Passage, until: &Inside) -> Result<Vec<f64>, PassageError> {
    let line = &bordered.line;
    let mut weights = match &passage.start {
        Start::State(state) => {
            let at = state.first().copied().ok_or(PassageError::Start)?;
            let away = |place: usize| (line.places[place] - at).abs();
            let ends = (line.places[0], line.places[line.places.len() - 1]);
            let nearest = (0..line.places.len()).min_by(|&a, &b| away(a).total_cmp(&away(b)));
            let is_on_line = ends.0 <= at && at <= ends.1;
            let place = nearest.filter(|_| is_on_line).ok_or(PassageError::Start)?;
            let mut weights = vec![0.0; line.places.len()];
            let is_outside = passage.until.at(state) >= 0.0 && !until.places()[place];
            weights[place] = f64::from(u8::from(is_outside));
            weights
        }
        Start::Density(region) => {
            let own = region.as_ref().map(|region| bordered.inside(region));
            let is_in = |element: usize| own.as_ref().is_none_or(|own| own.0[element]);
            line.load(|element| is_in(element) && !until.0[element], |_| 1.0)
        }
    };
    let whole: f64 = weights.iter().sum();
    if !(whole > f64::MIN_POSITIVE && whole.is_finite()) {
        return Err(PassageError::Start);
    }
    weights.iter_mut().for_each(|weight| *weight /= whole);
    Ok(weights)
}

/// The ends, and all places from which no process starts and to which none comes.
fn unreached(ends: &[bool], start: &[f64]) -> Vec<bool> {
    let mut all = vec![true; ends.len()];
    let mut first = 0;
    for place in 0..=ends.len() {
        if place == ends.len() || ends[place] {
            let run = first..place;
            if run.clone().any(|one| start[one] > 0.0) {
                run.for_each(|one| all[one] = false);
            }
            first = place + 1;
        }
    }
    all
}

/// A passage on one grid.
struct OnGrid<'a> {
    chain: &'a Chain,
    ends: &'a [bool],
    start: &'a [f64],
}

impl OnGrid<'_> {
    /// Mean, deviation, rate, shares of exits, probabilities at times and quantiles, each with what fewer vectors
    /// change.
    fn numbers(&self, passage: &Passage, exits: &[Vec<bool>]) -> Vec<(f64, f64)> {
        let ending = self.chain.until(self.ends);
        let times = ending.solve(&self.chain.masses, |_| 0.0);
        let again = ending.solve(&self.chain.weighted(&times), |_| 0.0);
        let mean = Chain::over(self.start, &times);
        let square = 2.0 * Chain::over(self.start, &again);
        let ones = self
            .ends
            .iter()
            .map(|is_end| if *is_end { 0.0 } else { 1.0 });
        let ones: Vec<f64> = ones.collect();
        let slow = ending.krylov(std::slice::from_ref(&ones), VECTORS);
        let known = slow.reduced(1.0, false).rates;
        let known = known.get(known.len() / 2).copied().unwrap_or(0.0);
        let rates = near_border::rates(known, self.shortest(passage, mean));
        let krylov = match rates.is_empty() {
            true => slow,
            false => ending.krylov_with(&ones, VECTORS, &rates),
        };
        let [all, fewer] =
            [1.0, FEWER].map(|share| Survival::new(self, &krylov.reduced(share, true)));
        let both = |of: &dyn Fn(&Survival) -> f64| {
            let (own, other) = (of(&all), of(&fewer));
            (own, (own - other).abs())
        };
        let mut numbers = vec![
            (mean, 0.0),
            ((square - mean * mean).max(0.0).sqrt(), 0.0),
            both(&|model| model.rates.first().copied().unwrap_or(f64::NAN)),
        ];
        let none = vec![0.0; self.ends.len()];
        for exit in exits {
            let share = ending.solve(&none, |place| f64::from(u8::from(exit[place])));
            numbers.push((Chain::over(self.start, &share), 0.0));
        }
        numbers.extend(
            passage
                .times
                .iter()
                .map(|&time| both(&|model| model.at(time))),
        );
        let quantiles = passage.quantiles.iter();
        numbers.extend(quantiles.map(|&share| both(&|model| model.time(1.0 - share, mean))));
        numbers
    }

    /// The shortest time of which anything is asked.
    fn shortest(&self, passage: &Passage, mean: f64) -> f64 {
        let least = passage.times.iter().copied().fold(mean, f64::min);
        match passage.quantiles.is_empty() {
            true => least,
            false => least.min(near_border::soonest(self.chain, self.ends, self.start)),
        }
    }
}

/// The probability that a process still goes on, as a sum of decays.
struct Survival {
    rates: Vec<f64>,
    weights: Vec<f64>,
}

impl Survival {
    fn new(grid: &OnGrid<'_>, modes: &Reduced) -> Self {
        let weight = |function: &Vec<f64>| {
            Chain::over(grid.start, function) * Chain::over(&grid.chain.masses, function)
        };
        Self {
            rates: modes.rates.clone(),
            weights: modes.functions.iter().map(weight).collect(),
        }
    }

    fn at(&self, time: f64) -> f64 {
        let decays = self.rates.iter().zip(&self.weights);
        let sum: f64 = decays
            .map(|(rate, weight)| weight * (-rate * time).exp())
            .sum();
        sum.clamp(0.0, 1.0)
    }

    /// The time at which it has fallen to a share.
    fn time(&self, share: f64, mean: f64) -> f64 {
        let (mut low, mut high) = (0.0, mean);
        for _ in 0..HALVINGS {
            if self.at(high) <= share {
                break;
            }
            (low, high) = (high, 2.0 * high);
        }
        bisected((low, high), HALVINGS, |middle| self.at(middle) > share)
    }
}

/// Transitions per unit of time from one region to another, the rate and the mean duration, as [`super::Reactive`] has
/// them; `None` where the line has no end.
///
/// # Errors
/// [`PassageError`].
pub(crate) fn transitions_on_line(
    reach: &Reach<'_>,
    [from, to]: [&BoundQuantity; 2],
) -> Option<Result<[WithError; 3], PassageError>> {
    let bordered = Bordered::new(reach, &[from, to], &[])?;
    let places = match bordered.apart([from, to]) {
        Ok(places) => places,
        Err(error) => return Some(Err(error)),
    };
    let all = bordered.line.grids().map(|grid| {
        let [from, to] = [0, 1].map(|region| grid.sampled(&places[region]));
        let ends: Vec<bool> = from
            .iter()
            .zip(&to)
            .map(|(one, other)| *one || *other)
            .collect();
        let chain = &grid.chain;
        let none = vec![0.0; ends.len()];
        let next = chain
            .until(&ends)
            .solve(&none, |place| f64::from(u8::from(to[place])));
        let steps = chain.conductances.iter().zip(next.windows(2));
        let flux: f64 = steps
            .map(|(way, pair)| way * (pair[1] - pair[0]).powi(2))
            .sum();
        let rest: Vec<f64> = next.iter().map(|next| 1.0 - next).collect();
        let last_in_first = Chain::over(&chain.masses, &rest);
        let on_way = Chain::over(&chain.weighted(&rest), &next);
        [flux, flux / last_in_first, on_way / flux]
    });
    let numbers = [0, 1, 2].map(|number| {
        bordered
            .line
            .extrapolated([0, 1, 2].map(|grid: usize| all[grid][number]))
    });
    match numbers
        .iter()
        .all(|(value, error)| *value > 0.0 && error.is_finite())
    {
        true => Some(Ok(numbers)),
        false => Some(Err(PassageError::Rounding)),
    }
}

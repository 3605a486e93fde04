//! The highest maximum of a power spectrum above zero, and its width.

use super::transfer::Transfer;

/// Frequencies at which maxima are looked for, beside those of the poles.
const LOOKED_AT: usize = 200;

/// Distances from the frequency of a pole at which maxima are looked for too, in its decay rates.
const BESIDE_POLE: [f64; 5] = [-2.0, -0.7, 0.0, 0.7, 2.0];

/// Halvings of a bracket.
const HALVINGS: usize = 60;

/// A maximum of a power spectrum.
#[derive(Debug, Clone, Copy)]
pub(super) struct Peak {
    /// Its angular frequency.
    pub(super) frequency: f64,
    height: f64,
    /// Full width at half of its height; `None` where the spectrum stays above that down to zero.
    pub(super) width: Option<f64>,
}

impl Peak {
    /// The highest maximum of an observable's power spectrum between zero and a frequency; `None` where there is none.
    pub(super) fn of(transfer: &Transfer, observable: usize, highest: f64) -> Option<Self> {
        let slope = |frequency: f64| transfer.power_and_slopes(frequency, observable)[1];
        let power = |frequency: f64| transfer.power(frequency, observable);
        let at = maxima(&slope, &shape_frequencies(transfer, highest)).into_iter();
        let heights = at.map(|frequency| (frequency, power(frequency)));
        let (frequency, height) = heights.max_by(|a, b| a.1.total_cmp(&b.1))?;
        let peak = Self {
            frequency,
            height,
            width: None,
        };
        Some(Self {
            width: peak.width(&power, highest / LOOKED_AT as f64),
            ..peak
        })
    }

    /// The distance between the places on either side at which the spectrum is half as high.
    fn width(&self, power: &dyn Fn(f64) -> f64, step: f64) -> Option<f64> {
        let over = |frequency: f64| power(frequency) - 0.5 * self.height;
        // Steps that grow, since a line may be far narrower than what is looked at.
        let side = |sign: f64| {
            let mut inside = 0.0;
            let mut away = 1e-6 * self.frequency.min(step);
            loop {
                let place = self.frequency + sign * away;
                if place < 0.0 || away > 1e3 * self.frequency {
                    return None;
                }
                if over(place) < 0.0 {
                    let from = |at: f64| over(self.frequency + sign * at);
                    return Some(bisection(&from, inside, away));
                }
                inside = away;
                away *= 1.3;
            }
        };
        Some(side(-1.0)? + side(1.0)?)
    }
}

/// The largest local maximum above zero of d ln S / d ln ω, how steeply an observable's power spectrum rises: above
/// zero where the spectrum has a maximum at a frequency above zero, and zero where one is born beside a minimum. `None`
/// where the slope only falls, as that of a Lorentzian does.
pub(super) fn steepest_rise(transfer: &Transfer, observable: usize, highest: f64) -> Option<f64> {
    let shape = |frequency: f64| {
        let [power, slope, bend] = transfer.power_and_slopes(frequency, observable);
        (slope / power, bend / power)
    };
    let rise = |frequency: f64| frequency * shape(frequency).0;
    let change = |frequency: f64| {
        let (slope, bend) = shape(frequency);
        slope + frequency * (bend - slope * slope)
    };
    let at = maxima(&change, &shape_frequencies(transfer, highest)).into_iter();
    at.map(rise).max_by(f64::total_cmp)
}

/// Frequencies at which shapes of spectra are looked at, ascending: even ones, and some beside each pole.
fn shape_frequencies(transfer: &Transfer, highest: f64) -> Vec<f64> {
    let step = highest / LOOKED_AT as f64;
    let mut places: Vec<f64> = (0..=LOOKED_AT)
        .map(|number| (number as f64 + 0.5) * step)
        .collect();
    let poles = transfer.poles();
    for pole in poles.filter(|pole| pole.im > 0.0 && pole.im <= highest) {
        places.extend(BESIDE_POLE.map(|times| pole.im + times * pole.re.abs()));
    }
    places.retain(|&place| place > 0.0 && place <= highest);
    places.sort_by(f64::total_cmp);
    places
}

/// Where a function has its maxima, by its derivative, between neighbouring places.
fn maxima(derivative: &dyn Fn(f64) -> f64, places: &[f64]) -> Vec<f64> {
    let slopes: Vec<f64> = places.iter().map(|&place| derivative(place)).collect();
    let is_top = |number: &usize| slopes[number - 1] > 0.0 && slopes[*number] <= 0.0;
    let tops = (1..places.len()).filter(is_top);
    tops.map(|number| bisection(derivative, places[number - 1], places[number]))
        .collect()
}

/// Where a function that is positive at `a` and not at `b` changes its sign.
fn bisection(function: &dyn Fn(f64) -> f64, mut a: f64, mut b: f64) -> f64 {
    for _ in 0..HALVINGS {
        let middle = 0.5 * (a + b);
        if function(middle) > 0.0 {
            a = middle
        } else {
            b = middle
        }
    }
    0.5 * (a + b)
}

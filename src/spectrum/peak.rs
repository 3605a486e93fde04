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
        let slope = |frequency: f64| transfer.power(frequency, observable)[1];
        let power = |frequency: f64| transfer.power(frequency, observable)[0];
        let step = highest / LOOKED_AT as f64;
        let mut places: Vec<f64> = (0..=LOOKED_AT)
            .map(|number| (number as f64 + 0.5) * step)
            .collect();
        for pole in transfer
            .poles()
            .filter(|pole| pole.im > 0.0 && pole.im <= highest)
        {
            places.extend(BESIDE_POLE.map(|times| pole.im + times * pole.re.abs()));
        }
        places.retain(|&place| place > 0.0 && place <= highest);
        places.sort_by(f64::total_cmp);
        let slopes: Vec<f64> = places.iter().map(|&place| slope(place)).collect();
        // Close to zero the slope is that of the curvature there.
        let rises = |number: usize| slopes[number] > 0.0;
        let tops = (1..places.len()).filter(|&number| rises(number - 1) && !rises(number));
        let at = tops.map(|number| halved(&slope, places[number - 1], places[number]));
        let heights = at.map(|frequency| (frequency, power(frequency)));
        let (frequency, height) = heights.max_by(|a, b| a.1.total_cmp(&b.1))?;
        let peak = Self {
            frequency,
            height,
            width: None,
        };
        Some(Self {
            width: peak.width(&power, step),
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
                    return Some(halved(&from, inside, away));
                }
                inside = away;
                away *= 1.3;
            }
        };
        Some(side(-1.0)? + side(1.0)?)
    }
}

/// Where a function that is positive at `a` and not at `b` changes its sign.
fn halved(function: &dyn Fn(f64) -> f64, mut a: f64, mut b: f64) -> f64 {
    for _ in 0..HALVINGS {
        let middle = 0.5 * (a + b);
        match function(middle) > 0.0 {
            true => a = middle,
            false => b = middle,
        }
    }
    0.5 * (a + b)
}

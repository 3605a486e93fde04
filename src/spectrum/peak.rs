//! The highest maximum of a power spectrum above zero, and its width.

use super::transfer::Transfer;

/// Frequencies at which maxima are looked for, beside those of the poles.
const LOOKED_AT: usize = 200;

/// Distances from the frequency of a pole at which maxima are looked for too, in its decay rates.
const BESIDE_POLE: [f64; 5] = [-2.0, -0.7, 0.0, 0.7, 2.0];

/// Poles with a decay rate above so many distances of these frequencies make no line that is missed between them.
const WIDE: f64 = 2.0;

/// Halvings of a bracket, at most, and its width, relative to its place, at which it is left.
const HALVINGS: usize = 60;
const WIDTH: f64 = 1e-13;

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
    pub(super) fn of(shape: &Shape<'_>) -> Option<Self> {
        let Shape {
            transfer,
            observable,
            highest,
            ..
        } = *shape;
        let slope = |[_, slope, _]: [f64; 3], _: f64| slope;
        let power = |frequency: f64| transfer.power(frequency, observable);
        let at = shape.maxima(&slope).into_iter();
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
/// zero where the spectrum has a maximum at a frequency above zero, and zero where one is born beside a minimum. A rise
/// that begins at zero counts as one. `None` where the slope only falls from zero on, as that of a Lorentzian does.
pub(super) fn steepest_rise(shape: &Shape<'_>) -> Option<f64> {
    let change = |[power, slope, bend]: [f64; 3], frequency: f64| {
        let (slope, bend) = (slope / power, bend / power);
        slope + frequency * (bend - slope * slope)
    };
    let at = shape.maxima(&change).into_iter();
    let rise = |frequency: f64| rise(shape.at(frequency), frequency);
    let from_zero = shape.rise_from_zero().map(|(limit, _)| limit);
    at.map(rise).chain(from_zero).max_by(f64::total_cmp)
}

/// d ln S / d ln ω of a spectrum with its slopes at a frequency.
fn rise([power, slope, _]: [f64; 3], frequency: f64) -> f64 {
    frequency * slope / power
}

/// How steeply a spectrum rises at the lowest frequency that is looked at.
#[derive(Debug, Clone, Copy)]
pub(super) struct Lowest {
    pub(super) frequency: f64,
    pub(super) steepness: f64,
}

/// The power spectrum of an observable with its slopes, at frequencies at which its shape is looked at.
pub(super) struct Shape<'a> {
    transfer: &'a Transfer,
    observable: usize,
    highest: f64,
    /// Ascending: even ones, and some beside each pole that makes a narrow line.
    places: Vec<f64>,
    values: Vec<[f64; 3]>,
}

impl<'a> Shape<'a> {
    /// Between zero and a frequency.
    pub(super) fn new(transfer: &'a Transfer, observable: usize, highest: f64) -> Self {
        let step = highest / LOOKED_AT as f64;
        let even = (0..=LOOKED_AT).map(|number| (number as f64 + 0.5) * step);
        let mut places: Vec<f64> = even.collect();
        let poles = transfer
            .poles()
            .filter(|pole| pole.im > 0.0 && pole.im <= highest);
        for pole in poles.filter(|pole| pole.re.abs() <= WIDE * step) {
            places.extend(BESIDE_POLE.map(|times| pole.im + times * pole.re.abs()));
        }
        places.retain(|&place| place > 0.0 && place <= highest);
        places.sort_by(f64::total_cmp);
        let at = |&place: &f64| transfer.power_and_slopes(place, observable);
        Self {
            values: places.iter().map(at).collect(),
            transfer,
            observable,
            highest,
            places,
        }
    }

    /// How steeply the spectrum rises from zero on, where it is less steep from there on, and what it is at the lowest
    /// frequency that is looked at. The spectrum of a velocity, which has no power at zero, rises so. A spectrum is an
    /// even function: it begins with an even power of the frequency, and the steepness is that power.
    pub(super) fn rise_from_zero(&self) -> Option<(f64, Lowest)> {
        let (&first, &lowest) = self.places.first().zip(self.values.first())?;
        let steepness = rise(lowest, first);
        let limit = 2.0 * (0.5 * steepness).round().max(1.0);
        (steepness > 0.0).then_some((
            limit,
            Lowest {
                frequency: first,
                steepness,
            },
        ))
    }

    fn at(&self, frequency: f64) -> [f64; 3] {
        self.transfer.power_and_slopes(frequency, self.observable)
    }

    /// Where a function of the spectrum has its maxima, by its derivative, a function of the spectrum, its two slopes
    /// and the frequency.
    fn maxima(&self, derivative: &dyn Fn([f64; 3], f64) -> f64) -> Vec<f64> {
        let known = self.values.iter().zip(&self.places);
        let slopes: Vec<f64> = known
            .map(|(&value, &place)| derivative(value, place))
            .collect();
        let is_top = |number: &usize| slopes[number - 1] > 0.0 && slopes[*number] <= 0.0;
        let tops = (1..slopes.len()).filter(is_top);
        let slope = |place: f64| derivative(self.at(place), place);
        let between =
            |number: usize| bisection(&slope, self.places[number - 1], self.places[number]);
        tops.map(between).collect()
    }
}

/// Where a function that is positive at `a` and not at `b` changes its sign.
fn bisection(function: &dyn Fn(f64) -> f64, mut a: f64, mut b: f64) -> f64 {
    for _ in 0..HALVINGS {
        let middle = 0.5 * (a + b);
        if (b - a).abs() <= WIDTH * middle.abs() {
            break;
        }
        if function(middle) > 0.0 {
            a = middle
        } else {
            b = middle
        }
    }
    0.5 * (a + b)
}

//! Extrema of the density of a system with one axis, and of the slope of its logarithm, from drift and noise.
//!
//! Without flux (log p)' = 2a/b² - (b²)'/b². On parts of the axis this is a polynomial to ten digits; its zeros are the
//! extrema of the density, however narrow, and its own extrema are where the next peak and valley are born.

use super::OneAxis;
use super::line::{Part, Partition, STEEPEST, SlopeAt, zero};
use crate::density::{Extremum, Profile, SlopeJump, Turn};
use crate::space::Axis;
use crate::system::System;

/// Differences of slopes that are a smaller share of the slopes are rounding.
const ROUNDING: f64 = 1e-11;
/// Slopes that are a smaller share of what they are the difference of are zero.
const NOTHING: f64 = 1e-13;
/// Differences of log p below this are rounding.
const LEVEL: f64 = 1e-11;

/// The profile of the density that [`super::one_axis`] found on the same axis; `centre` is that of a symmetry. `None`
/// where drift and noise do not allow it.
pub fn profile(
    system: &dyn System,
    axis: &Axis,
    found: &OneAxis,
    centre: Option<f64>,
) -> Option<Profile> {
    let line = Partition::new(system, axis, found.ends)?;
    let samples = line.samples();
    Some(Profile {
        extrema: line.extrema(&samples, found.log_integral),
        turns: turns(&samples),
        jumps: line.jumps(),
        curvature: centre.and_then(|centre| line.curvature(centre)),
        ends: found.ends,
    })
}

impl Partition {
    /// Peaks and valleys; `log_integral` is the logarithm of what the density is divided by.
    fn extrema(&self, samples: &[SlopeAt], log_integral: f64) -> Vec<Extremum> {
        let slope = |place: f64| self.part(place).map_or(0.0, |part| part.slope.at(place));
        let told = samples
            .iter()
            .filter(|one| one.slope.abs() > NOTHING * one.size);
        let told: Vec<&SlopeAt> = told.collect();
        let (Some(first), Some(last)) = (told.first(), told.last()) else {
            return Vec::new();
        };
        let ends = self.parts.first().zip(self.parts.last());
        let ends = ends.map(|(low, high)| (low.slope.from, high.slope.to));
        let (from, to) = ends.unwrap_or_default();
        let mut places: Vec<(f64, bool)> = Vec::new();
        places.extend((first.slope < 0.0).then_some((from, true)));
        for pair in told.windows(2) {
            let (a, b) = (pair[0], pair[1]);
            if (a.slope > 0.0) != (b.slope > 0.0) {
                let place = zero(slope, (a.place, b.place), b.slope > 0.0);
                places.push((place, a.slope > 0.0));
            }
        }
        places.extend((last.slope > 0.0).then_some((to, true)));
        let found = places.into_iter().filter_map(|(place, is_peak)| {
            let part = self.part(place)?;
            let exponent = part.exponent + part.rate.integral_to(place);
            Some((
                place,
                is_peak,
                exponent - part.level - part.log_noise.at(place) - log_integral,
                part,
            ))
        });
        let extrema = found.map(|(place, is_peak, logarithm, part)| {
            let gathered = part.gathered + part.error * (place - part.slope.from);
            (logarithm, (place, is_peak, gathered))
        });
        let at_end = |place: f64| match place {
            _ if place == from => self.ends.0,
            _ if place == to => self.ends.1,
            _ => place,
        };
        let kept = without_rounding(extrema.collect()).into_iter();
        kept.map(|(logarithm, (place, is_peak, gathered_error))| Extremum {
            place: at_end(place),
            is_peak,
            density: logarithm.exp(),
            log_density: logarithm,
            gathered_error,
        })
        .collect()
    }

    /// Where the slope jumps from one part to the next.
    fn jumps(&self) -> Vec<SlopeJump> {
        let pairs = self.parts.windows(2);
        let jumps = pairs.filter_map(|pair| {
            let place = pair[0].slope.to;
            let slopes = [0, 1].map(|side: usize| pair[side].slope.at(place));
            let (error, size) = (pair[0].error + pair[1].error, pair[0].size + pair[1].size);
            let is_jump = (slopes[1] - slopes[0]).abs() > JUMP * size + 10.0 * error;
            is_jump.then_some(SlopeJump {
                place,
                slopes,
                error: error + ROUNDING * size,
            })
        });
        jumps.collect()
    }

    /// p''/p at a place where the slope is smooth, with its error.
    fn curvature(&self, place: f64) -> Option<(f64, f64)> {
        let above = self.part(place)?;
        let below = self.parts.iter().rfind(|part| part.slope.from < place)?;
        let of = |part: &Part| part.slope.derivative().at(place) + part.slope.at(place).powi(2);
        let (low, high) = (of(below), of(above));
        let rounding = |part: &Part| {
            let steeper = 2.0 / (part.slope.to - part.slope.from);
            (part.error + NOTHING * part.size) * STEEPEST[0] * steeper
                + part.log_rounding * STEEPEST[1] * steeper * steeper
        };
        let error = 0.5 * (high - low).abs() + rounding(below) + rounding(above);
        Some((0.5 * (low + high), error))
    }
}

/// A smaller share of the slopes is no jump.
const JUMP: f64 = 1e-8;

/// The extrema of the slope, but for those at the ends and those that are rounding, or no more than errors: beside an
/// end where the noise dies, the distance to which has few digits, slopes go up and down.
fn turns(samples: &[SlopeAt]) -> Vec<Turn> {
    let mut turns = Vec::new();
    let Some(mut farthest) = samples.first() else {
        return turns;
    };
    let mut rising: Option<bool> = None;
    for sample in samples {
        let change = sample.slope - farthest.slope;
        let errors = sample.error + farthest.error;
        let goes_on = rising.is_some_and(|rising| (change > 0.0) == rising || change == 0.0);
        if goes_on {
            farthest = sample;
        } else if change.abs() > ROUNDING * (sample.size + farthest.size) + errors {
            turns.extend(rising.map(|is_largest| Turn {
                place: farthest.place,
                is_largest,
                slope: farthest.slope,
                error: farthest.error + ROUNDING * farthest.size,
            }));
            rising = Some(change > 0.0);
            farthest = sample;
        }
    }
    turns
}

/// Peaks and valleys without those pairs of neighbours between which the logarithm changes by no more than rounding.
fn without_rounding<T>(mut extrema: Vec<(f64, T)>) -> Vec<(f64, T)> {
    loop {
        let heights = extrema.windows(2).map(|pair| (pair[1].0 - pair[0].0).abs());
        let least = heights.enumerate().min_by(|a, b| a.1.total_cmp(&b.1));
        match least {
            // A peak at an end of the range goes alone with its valley: one extremum must stay.
            Some((place, height)) if height < LEVEL && extrema.len() > 2 => {
                extrema.drain(place..place + 2);
            }
            _ => return extrema,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::generator::one_axis;
    use crate::system::{Interpretation, TypedModel};

    fn found(drift: &str, noise: &str, centre: Option<f64>) -> Profile {
        let model = TypedModel::new("typed", "A typed system", ["x"])
            .with_equation("x", drift)
            .with_noise("x", [noise])
            .with_interpretation(Interpretation::Ito)
            .build()
            .unwrap();
        let system = model.system_with(&[]).unwrap();
        let axis = Axis::uniform(-4.0, 4.0, 60).unwrap();
        let masses = one_axis(system.as_ref(), &axis).unwrap();
        profile(system.as_ref(), &axis, &masses, centre).unwrap()
    }

    #[test]
    fn beside_an_end_where_places_have_few_digits_slopes_do_not_turn() {
        // p = x^(0.6/s - 1) (1 - x)^(1.4/s - 1): the slope of its logarithm falls where both powers are positive, and
        // is largest at the zero of -a/x² - b/(1 - x)² for powers a < 0 < b of the same size, at the middle.
        for (s, turn) in [(0.2, None), (1.0, Some(0.5))] {
            let noise = format!("sqrt({s} x (1 - x))");
            let model = TypedModel::new("jacobi", "Jacobi's process", ["x"])
                .with_equation("x", "0.3 - x")
                .with_noise("x", [noise.as_str()])
                .with_bounds("x", "0", "1")
                .with_interpretation(Interpretation::Ito)
                .build()
                .unwrap();
            let system = model.system_with(&[]).unwrap();
            let axis = Axis::uniform(0.0, 1.0, 100).unwrap();
            let masses = one_axis(system.as_ref(), &axis).unwrap();
            let profile = profile(system.as_ref(), &axis, &masses, None).unwrap();
            let places: Vec<f64> = profile.turns.iter().map(|one| one.place).collect();
            assert_eq!(places.len(), usize::from(turn.is_some()), "{places:?}");
            let off = places
                .first()
                .zip(turn)
                .map_or(0.0, |(place, turn)| place - turn);
            assert!(off.abs() < 1e-6, "{places:?}");
            // More parts than ten a cell are no more digits.
            let line = Partition::new(system.as_ref(), &axis, masses.ends).unwrap();
            assert!(line.parts.len() < 1000, "{}", line.parts.len());
        }
    }

    #[test]
    fn peaks_and_valleys_are_the_zeros_of_the_drift_however_close() {
        // Cells are 0.133 wide: three zeros lie within one.
        let zeros = [-1.0, 0.301, 0.31, 0.33, 1.2];
        let factors = zeros.map(|zero| format!("(x - {zero})"));
        let drift = format!("-{}", factors.join(" "));
        let profile = found(&drift, "0.8", None);
        assert_eq!(profile.extrema.len(), 5);
        for (one, zero) in profile.extrema.iter().zip(zeros) {
            assert!((one.place - zero).abs() < 1e-9, "{} {zero}", one.place);
        }
        let peaks: Vec<bool> = profile.extrema.iter().map(|one| one.is_peak).collect();
        assert_eq!(peaks, [true, false, true, false, true]);
        // The logarithm of the density between two of them is ∫ 2a/b², here by Simpson's rule, whose error is below
        // 1e-14.
        let a = |x: f64| -zeros.iter().map(|zero| x - zero).product::<f64>();
        let (from, to) = (0.31, 0.33);
        let h = (to - from) / 200.0;
        let weights = |i: i32| if i % 2 == 0 { 2.0 } else { 4.0 };
        let inner: f64 = (1..200)
            .map(|i| weights(i) * a(from + h * f64::from(i)))
            .sum();
        let rise = 2.0 / 0.64 * h / 3.0 * (a(from) + inner + a(to));
        let [valley, peak] = [&profile.extrema[3], &profile.extrema[2]];
        let (measured, error) = (
            valley.log_density - peak.log_density,
            valley.gathered_error - peak.gathered_error,
        );
        assert!((measured - rise).abs() < 1e-13 + error, "{measured} {rise}");
        assert!(error < 1e-11);
    }

    #[test]
    fn a_pair_is_born_where_an_extremum_of_the_slope_passes_zero() {
        // a = h - x³ + x has extrema ± 2/√27 + h at ± 1/√3.
        for (h, count) in [(0.3848, 3), (0.3850, 1)] {
            let profile = found(&format!("{h} - x^3 + x"), "1", None);
            assert_eq!(profile.extrema.len(), count);
            let [low, high] = profile.turns[..] else {
                panic!("two turns: {:?}", profile.turns);
            };
            let (place, slope) = (1.0 / 3f64.sqrt(), 2.0 / 27f64.sqrt());
            assert!(!low.is_largest && high.is_largest);
            assert!((high.place - place).abs() < 1e-7 && (low.place + place).abs() < 1e-7);
            assert!((high.slope - 2.0 * (h + slope)).abs() < high.error + 1e-14);
            assert!((low.slope - 2.0 * (h - slope)).abs() < low.error + 1e-14);
            assert!(low.error < 1e-9 && high.error < 1e-9);
        }
    }

    #[test]
    fn the_slope_of_the_noise_counts() {
        // (log p)' = (2 a x - 2 x³ - 0.6 x)/(1 + 0.3 x²) with b² = 1 + 0.3 x².
        let profile = found("0.5 x - x^3", "sqrt(1 + 0.3 x^2)", Some(0.0));
        let (curvature, error) = profile.curvature.unwrap();
        assert!(
            (curvature - 0.4).abs() < error && error < 1e-7,
            "{curvature} {error}"
        );
        let places: Vec<f64> = profile.extrema.iter().map(|one| one.place).collect();
        let exact = 0.2f64.sqrt();
        assert_eq!(places.len(), 3);
        assert!((places[0] + exact).abs() < 1e-9 && (places[2] - exact).abs() < 1e-9);
        assert!(places[1].abs() < 1e-9);
    }

    #[test]
    fn a_symmetric_split_is_seen_beyond_a_hundred_thousandth() {
        // At 0.455 · 0.4² the peaks lie on faces, at ± 0.4.
        for (theta, count) in [(-1e-6, 1), (1e-5, 3), (1e-4, 3), (0.0728, 3), (1.2, 3)] {
            let profile = found(&format!("{theta} x - 0.455 x^3"), "0.38", Some(0.0));
            let (curvature, error) = profile.curvature.unwrap();
            let exact = 2.0 * theta / 0.38 / 0.38;
            assert!(
                (curvature - exact).abs() <= error && error < 1e-6,
                "{curvature} {exact}"
            );
            assert_eq!(
                profile.extrema.len(),
                count,
                "{theta}: {:?}",
                profile.extrema
            );
            assert_eq!(
                profile.turns.len(),
                2 * usize::from(theta > 0.0),
                "{:?}",
                profile.turns
            );
            let peak: f64 = if theta > 0.0 {
                (theta / 0.455).sqrt()
            } else {
                0.0
            };
            let found = profile.extrema[count - 1];
            assert!((found.place - peak).abs() < 1e-5, "{theta}: {found:?}");
            let height = (found.density / profile.extrema[count / 2].density).ln();
            let exact = theta.max(0.0).powi(2) / (2.0 * 0.455 * 0.38 * 0.38);
            assert!((height - exact).abs() < 1e-11, "{height} {exact}");
        }
    }

    #[test]
    fn jumps_have_two_slopes_and_may_be_extrema_of_the_slope() {
        // Slope 2 (-x + 0.5 sign(x - 0.4)): -0.8 ∓ 1 beside the jump, a maximum above it and a minimum below.
        let profile = found("-x + 0.5 sign(x - 0.4)", "1", None);
        let [jump] = profile.jumps[..] else {
            panic!("one jump: {:?}", profile.jumps);
        };
        assert!((jump.place - 0.4).abs() < 1e-12);
        assert!((jump.slopes[0] + 1.8).abs() < 1e-9 && (jump.slopes[1] - 0.2).abs() < 1e-9);
        let [low, high] = profile.turns[..] else {
            panic!("two turns: {:?}", profile.turns);
        };
        assert!(low.place == jump.place && high.place == jump.place);
        assert!(!low.is_largest && high.is_largest);
        let places: Vec<f64> = profile.extrema.iter().map(|one| one.place).collect();
        for (place, exact) in places.iter().zip([-0.5, 0.4, 0.5]) {
            assert!((place - exact).abs() < 1e-9, "{places:?}");
        }
    }

    #[test]
    fn ends_are_peaks_where_the_density_falls_away_from_them_and_flat_densities_have_no_extrema() {
        let rising = found("0.3", "1", None);
        let [end] = rising.extrema[..] else {
            panic!("one peak: {:?}", rising.extrema);
        };
        assert!(end.is_peak && end.place == 4.0 && rising.turns.is_empty());
        let flat = found("0 x", "1", None);
        assert!(flat.extrema.is_empty() && flat.turns.is_empty() && flat.jumps.is_empty());
    }
}

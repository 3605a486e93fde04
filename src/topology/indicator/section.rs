//! Flanks of a joint density on a ray from its centre of symmetry: where a ring and the moat beside it are about to come or go.

use super::Flank;
use crate::density::EstimatedDensity;
use crate::topology::field::Field;

/// Density, as a share of the largest, below which the ray ends.
const FAINT: f64 = 1e-6;
/// Share of the density by which the second scheme may differ where the ray goes on.
const UNSURE: f64 = 0.1;

/// The extrema of the slope of log p outward along the first axis, on the upper side of the centre; none where a derivative of the density jumps, and
/// of sampled densities. They say where to look, and are read on the faces.
pub(crate) fn flanks_from_centre(estimated: &EstimatedDensity) -> Vec<Flank> {
    let [first, _] = estimated.density.axes.as_slice() else {
        return Vec::new();
    };
    let is_smooth = estimated.structure.kinks.iter().all(|kink| kink.is_bend());
    let centre = estimated.structure.centre.as_ref();
    let centre = centre.filter(|_| is_smooth && !estimated.is_noisy());
    let (Some(&[x, y]), Some(field)) = (centre.map(Vec::as_slice), Field::new(estimated)) else {
        return Vec::new();
    };
    let least = FAINT * estimated.density.maximum();
    let slope = |&at: &f64| -> Option<(f64, f64)> {
        let place = [at, y];
        let cell = field.cell_at(&place)?;
        let value = field.values()[cell];
        let second = field.second_scheme().map_or(value, |second| second[cell]);
        let jet = field.jet(&place)?;
        let is_sure = value > least && (second - value).abs() <= UNSURE * value;
        is_sure.then(|| (at, jet.first[0] / (field.unit(0) * jet.value)))
    };
    let outward = first.edges().iter().filter(|&&at| at > x);
    let slopes: Vec<(f64, f64)> = outward.map_while(slope).collect();
    let extrema = slopes.windows(3).filter_map(|triple| {
        let [(_, left), (place, here), (_, right)] = *triple else {
            return None;
        };
        let is_highest = here >= left && here > right;
        let is_lowest = here <= left && here < right;
        (is_highest || is_lowest).then(|| Flank {
            rising: is_highest,
            place,
            value: if is_highest { here } else { -here },
        })
    });
    extrema.collect()
}

#[cfg(test)]
mod tests {
    use super::flanks_from_centre;
    use crate::density::{Density, EstimatedDensity, Observable, Structure, Variants};
    use crate::space::Axis;

    /// log p = -∫ r (r² - 1) (r² - 2) (r² - s) dr: rings at 1 and √s, a moat between them at √2 for s above 2.
    #[test]
    fn the_flanks_of_a_moat_are_seen_while_it_stands_and_when_it_is_gone() {
        let flanks = |s: f64| {
            let axis = Axis::uniform(-2.5, 2.5, 80).unwrap();
            let log = |q: f64| {
                // In q = r²: the integral of (q - 1) (q - 2) (q - s)/2.
                let (a, b, c) = (3.0 + s, 2.0 + 3.0 * s, 2.0 * s);
                -0.5 * (q.powi(4) / 4.0 - a * q.powi(3) / 3.0 + b * q * q / 2.0 - c * q)
            };
            let centres = axis.centres();
            let rows = centres.iter();
            let values: Vec<f64> = rows
                .flat_map(|x| centres.iter().map(move |y| x * x + y * y))
                .map(|q| log(q).exp())
                .collect();
            let estimated = EstimatedDensity {
                observable: Observable::Joint(0, 1),
                standard_error: vec![0.0; values.len()],
                density: Density {
                    axes: vec![axis.clone(), axis],
                    values,
                },
                variants: Variants::None,
                structure: Structure {
                    centre: Some(vec![0.0; 2]),
                    kinks: Vec::new(),
                },
                negligible: 0.0,
            };
            flanks_from_centre(&estimated)
        };
        let outward = |s: f64| {
            let of = flanks(s);
            let mut values = of.iter().filter(|one| one.rising && one.place > 1.2);
            values.next().map(|one| one.value)
        };
        assert!(outward(3.0).unwrap() > 0.0);
        assert!(outward(2.2).unwrap() > 0.0);
        let falling = |s: f64| {
            let of = flanks(s);
            let mut values = of.iter().filter(|one| !one.rising);
            values.next().map(|one| one.value).unwrap()
        };
        assert!(falling(3.0) > 0.0);
    }
}

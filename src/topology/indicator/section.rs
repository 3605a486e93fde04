//! Flanks of a joint density on a ray from its centre of symmetry: where a ring and the moat beside it are about to
//! come or go.

use super::Flank;
use crate::density::EstimatedDensity;
use crate::topology::field::Field;

/// Density, as a share of the largest, below which the ray ends.
const FAINT: f64 = 1e-6;
/// Share of the density by which the second scheme may differ where the ray goes on.
const UNSURE: f64 = 0.1;

/// The extrema of the slope of log p outward along the first axis, on the upper side of the centre; none where a
/// derivative of the density jumps, and of sampled densities. They say where to look, and are read on the faces.
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
        let is_sure = value > least && jet.value > 0.0 && (second - value).abs() <= UNSURE * value;
        is_sure.then(|| (at, jet.first[0] / (field.unit(0) * jet.value)))
    };
    let outward = first.edges().iter().filter(|&&at| at > x);
    let slopes: Vec<(f64, f64)> = outward.map_while(slope).collect();
    let extrema = slopes.windows(3).filter_map(|triple| {
        let [(_, left), (place, here), (_, right)] = *triple else {
            return None;
        };
        Flank::between(place, [left, here, right])
    });
    extrema.collect()
}

#[cfg(test)]
mod tests {
    use super::flanks_from_centre;
    use crate::density::{Density, EstimatedDensity, Observable, Structure};
    use crate::space::Axis;

    /// log p = ∫ -(q - 1) ((q - 2)² - ε)/2 dq with q = r²: two rings with a moat between them for ε above zero, and one
    /// for ε below.
    #[test]
    fn the_slope_out_of_a_moat_passes_zero_with_it() {
        let flanks = |epsilon: f64| {
            let axis = Axis::uniform(-2.5, 2.5, 100).unwrap();
            let log = |q: f64| {
                let v = q - 2.0;
                -0.5 * (v.powi(4) / 4.0 + v.powi(3) / 3.0 - epsilon * (0.5 * v * v + v))
            };
            let centres = axis.centres();
            let rows = centres.iter();
            let values: Vec<f64> = rows
                .flat_map(|x| centres.iter().map(move |y| x * x + y * y))
                .map(|q| log(q).exp())
                .collect();
            let estimated = EstimatedDensity {
                structure: Structure {
                    centre: Some(vec![0.0; 2]),
                    ..Structure::default()
                },
                negligible: 0.0,
                ..EstimatedDensity::new(
                    Observable::Joint(0, 1),
                    Density {
                        axes: vec![axis.clone(), axis],
                        values,
                    },
                )
            };
            flanks_from_centre(&estimated)
        };
        // The slope at q = 2 is r (q - 1) ε there: a maximum near it.
        let slope = |epsilon: f64| {
            let near =
                |one: &&super::Flank| one.rising && (one.place - 2.0_f64.sqrt()).abs() < 0.15;
            flanks(epsilon).iter().find(near).unwrap().value
        };
        // The maximum itself is at q = 2 but for terms of ε². The nearest face may lie half a cell from the maximum:
        // the slope there is lower by r (2 r h/2)².
        let half_cell = 0.5 * 5.0 / 100.0;
        let lower = 2.0_f64.sqrt() * (2.0 * 2.0_f64.sqrt() * half_cell).powi(2);
        for epsilon in [-0.04, -0.02, 0.02, 0.04] {
            let (found, exact) = (slope(epsilon), 2.0_f64.sqrt() * epsilon);
            let is_near = found < exact + 0.5 * lower && found > exact - 1.5 * lower;
            assert!(is_near, "{epsilon}: {found} {exact}");
        }
    }
}

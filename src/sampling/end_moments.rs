//! Sums over the ends of trajectories that tell how much wider the cells make a density: of x and x² along a line, of
//! the first two harmonics along an angle, where a square of x would know of a seam.

use crate::MAX_DIMENSION;
use crate::space::Axis;

/// Functions of a coordinate of which there are sums: x and x², or cos φ, sin φ, cos 2φ and sin 2φ of an angle φ.
const FUNCTIONS: usize = 4;

/// Harmonics of an angle.
const HARMONICS: usize = FUNCTIONS / 2;

/// Power of the harmonics below which a density is so level around a turn that nothing makes it wider.
const LEVEL: f64 = 1e-3;

/// Sums over samples of one axis of functions of their end points, plain and times where they started: what is needed
/// to know their means one map step after any density that is linear in the cell.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct EndMoments {
    /// Σ f.
    plain: [f64; FUNCTIONS],
    /// Σ f u_b, u_b where the sample started along axis b.
    by_start: [[f64; FUNCTIONS]; MAX_DIMENSION],
    /// Σ 1.
    count: f64,
}

impl EndMoments {
    /// Adds samples that ended at places of an axis and started at `starts`, from -½ to ½ of their cell along each
    /// axis.
    pub(super) fn add(&mut self, axis: &Axis, ends: &[f64], starts: &[[f32; MAX_DIMENSION]]) {
        // Along a line there are half as many functions.
        match axis.is_closed() {
            true => self.add_functions::<FUNCTIONS>(axis, ends, starts),
            false => self.add_functions::<{ FUNCTIONS / 2 }>(axis, ends, starts),
        }
        self.count += ends.len() as f64;
    }

    fn add_functions<const COUNT: usize>(
        &mut self,
        axis: &Axis,
        ends: &[f64],
        starts: &[[f32; MAX_DIMENSION]],
    ) {
        let (mut plain, mut by_start) = ([0.0; COUNT], [[0.0; MAX_DIMENSION]; COUNT]);
        for function in 0..COUNT {
            plain[function] = self.plain[function];
            by_start[function] = self.by_start.map(|sums| sums[function]);
        }
        for (&x, start) in ends.iter().zip(starts) {
            let values = functions(axis, x);
            for function in 0..COUNT {
                plain[function] += values[function];
                for along in 0..MAX_DIMENSION {
                    by_start[function][along] += values[function] * f64::from(start[along]);
                }
            }
        }
        for function in 0..COUNT {
            self.plain[function] = plain[function];
            for (sums, sum) in self.by_start.iter_mut().zip(&by_start[function]) {
                sums[function] = *sum;
            }
        }
    }

    /// Adds to means what the cell's density, of a mass and with slopes inside the cell, makes of one of its
    /// `samples`.
    pub(super) fn add_to(&self, means: &mut Means, weight: f64, slopes: &[f64; MAX_DIMENSION]) {
        means.mass += weight * self.count;
        for (function, mean) in means.of.iter_mut().enumerate() {
            let by_start = self.by_start.iter().zip(slopes);
            let tilted: f64 = by_start.map(|(sums, slope)| sums[function] * slope).sum();
            *mean += weight * (self.plain[function] + tilted);
        }
    }
}

/// The functions at a place. Along a line two of them are zero.
#[inline(always)]
fn functions(axis: &Axis, x: f64) -> [f64; FUNCTIONS] {
    if !axis.is_closed() {
        return [x, x * x, 0.0, 0.0];
    }
    let (sine, cosine) = (angle(axis) * (x - axis.from())).sin_cos();
    [
        cosine,
        sine,
        cosine * cosine - sine * sine,
        2.0 * sine * cosine,
    ]
}

/// Radians in a unit of an axis that closes on itself.
fn angle(axis: &Axis) -> f64 {
    std::f64::consts::TAU / (axis.to() - axis.from())
}

/// Means of the functions, times the mass that they are of.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Means {
    mass: f64,
    of: [f64; FUNCTIONS],
}

impl Means {
    /// Adds a density 1 + s u inside a cell, u from -½ to ½ along the axis.
    pub(super) fn add_cell(&mut self, axis: &Axis, cell: usize, mass: f64, slope: f64) {
        let (centre, width) = (axis.centre(cell), axis.width(cell));
        self.mass += mass;
        if !axis.is_closed() {
            // ∫ u (1 + s u) du = s/12 and ∫ u² (1 + s u) du = 1/12 over the cell.
            let off = width * slope / 12.0;
            self.of[0] += mass * (centre + off);
            self.of[1] += mass * (centre * (centre + 2.0 * off) + width * width / 12.0);
            return;
        }
        for harmonic in 0..HARMONICS {
            let rate = (harmonic + 1) as f64 * angle(axis);
            let (sine, cosine) = (rate * (centre - axis.from())).sin_cos();
            let across = rate * width;
            let (half_sine, half_cosine) = (0.5 * across).sin_cos();
            // ∫ cos(a u) du and ∫ u sin(a u) du over the cell.
            let even = 2.0 * half_sine / across;
            let odd = slope * (2.0 * half_sine / across - half_cosine) / across;
            self.of[2 * harmonic] += mass * (cosine * even - sine * odd);
            self.of[2 * harmonic + 1] += mass * (sine * even + cosine * odd);
        }
    }

    /// The diffusion over a time, times that time, that leads from these means to others: half of what the variance
    /// grows by. On a turn it takes n²D of the harmonic of number n, of which the least squares' D is given.
    pub(super) fn diffusion_to(&self, other: &Self, axis: &Axis) -> f64 {
        let [before, after] = [self, other].map(|one| one.of.map(|sum| sum / one.mass));
        if !axis.is_closed() {
            let variance = |of: [f64; FUNCTIONS]| of[1] - of[0] * of[0];
            return 0.5 * (variance(after) - variance(before));
        }
        let (mut lost, mut power) = (0.0, 0.0);
        for harmonic in 0..HARMONICS {
            let square = ((harmonic + 1) * (harmonic + 1)) as f64;
            for part in [2 * harmonic, 2 * harmonic + 1] {
                lost += square * (before[part] - after[part]) * after[part];
                power += square * square * after[part] * after[part];
            }
        }
        if power < LEVEL {
            return 0.0;
        }
        lost / power / angle(axis).powi(2)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_density_on_a_circle_that_cells_spread_has_diffused_by_their_variance() {
        // Normal with the deviation 0.4, the seam at any place: flat cells widen it by h²/6, that is by D t = h²/12.
        for middle in [0.0, 3.1, -1.3] {
            let axis = Axis::turn(-3.0, 3.0, 60).unwrap();
            let none = [0.0_f32; MAX_DIMENSION];
            let (mut ends, mut means, mut cells) =
                (EndMoments::default(), Means::default(), Means::default());
            let mut mass = vec![0.0; 60];
            for place in 0..6000 {
                let x = -3.0 + (f64::from(place) + 0.5) * 1e-3;
                let weight = (-0.5 * (axis.apart(x, middle) / 0.4).powi(2)).exp();
                let mut one = EndMoments::default();
                one.add(&axis, &[x], &[none]);
                one.add_to(&mut means, weight, &[0.0; MAX_DIMENSION]);
                ends.add(&axis, &[x], &[none]);
                mass[axis.find(x).unwrap()] += weight;
            }
            for (cell, mass) in mass.iter().enumerate() {
                cells.add_cell(&axis, cell, *mass, 0.0);
            }
            let found = means.diffusion_to(&cells, &axis);
            assert!((found / (0.01 / 12.0) - 1.0).abs() < 5e-3, "{found}");
            // As many ends everywhere are level.
            let mut level = Means::default();
            ends.add_to(&mut level, 1.0, &[0.0; MAX_DIMENSION]);
            assert_eq!(level.diffusion_to(&level, &axis), 0.0);
        }
    }

    #[test]
    fn slopes_inside_cells_are_those_of_a_density_that_rises() {
        // A density 1 + s u in one cell of a turn against sums over its places.
        let axis = Axis::turn(0.0, 2.0, 7).unwrap();
        let (cell, slope) = (3, 0.8);
        let mut exact = Means::default();
        exact.add_cell(&axis, cell, 1.0, slope);
        let parts = 4000;
        let mut sums = [0.0; FUNCTIONS];
        for part in 0..parts {
            let u = (f64::from(part) + 0.5) / f64::from(parts) - 0.5;
            let values = functions(&axis, axis.centre(cell) + u * axis.width(cell));
            for (sum, value) in sums.iter_mut().zip(values) {
                *sum += value * (1.0 + slope * u) / f64::from(parts);
            }
        }
        for (sum, exact) in sums.iter().zip(exact.of) {
            assert!((sum - exact).abs() < 1e-8, "{sum} {exact}");
        }
    }
}

//! Axes that carry a series in place of cells: their nodes, their weights, and what is worked out in their modes.

use super::Axis;
use crate::space::SpaceError;
use crate::space::fourier::{cardinal, fourier_derivatives, fourier_integrals, waves};
use crate::space::hermite::{
    NORMAL_RANGE, gauss_hermite, hermite_integrals, hermite_values, normal_edges,
};
use crate::space::series::{
    MOST_MODES, Series, differentiation, gauss_legendre, legendre_integrals, legendre_values,
};

/// Standard deviations of the normal density from the middle to the ends of the range of a state that relaxes: ranges
/// that are found hold 6.5 of the state's own, so that the normal density is a third wider than the state's.
const DEVIATIONS_OF_A_RANGE: f64 = 5.0;

/// One mode of so many is left out, and at least one of each parity. What a last one alone carries passes through zero.
const MODES_A_MODE_LEFT_OUT: usize = 5;

/// Fewest modes of a series.
const LEAST_MODES: usize = 2;

impl Axis {
    /// An axis of `count` modes: the density along it is a polynomial of degree `count` - 1, given by its values at the
    /// nodes of Gauss's rule for Legendre polynomials. For internal states that stay in the range and have no noise.
    ///
    /// # Errors
    /// [`SpaceError::Range`] or [`SpaceError::Modes`].
    pub fn modes(from: f64, to: f64, count: usize) -> Result<Self, SpaceError> {
        Self::check(from, to, count.max(2))?;
        Self::check_modes(count)?;
        let rule = gauss_legendre(count);
        let (middle, half) = (0.5 * (from + to), 0.5 * (to - from));
        let mut edges = vec![from];
        // From the nearer end, so that mirrored cells are alike to the last bit.
        let mut sum = 0.0;
        for weight in &rule.weights[..count - 1] {
            sum += weight;
            edges.push(from + half * sum);
        }
        edges.push(to);
        for index in 1..=count / 2 {
            edges[count - index] = middle + (middle - edges[index]);
        }
        Ok(Self {
            edges,
            nodes: rule.nodes.iter().map(|s| middle + half * s).collect(),
            pieces: Vec::new(),
            series: Some(Series::Legendre),
            layout: 1.0,
            closes: false,
        })
    }

    /// An axis of `count` Hermite modes: the density along it is a normal density of this mean and standard deviation,
    /// times a polynomial of degree `count` - 1, given by its values at the nodes of Gauss's rule for the normal
    /// density. For white noise behind a linear filter. The range reaches at least six standard deviations to either
    /// side.
    ///
    /// # Errors
    /// [`SpaceError::Range`] where the deviation is not a positive number, or [`SpaceError::Modes`].
    pub fn hermite(mean: f64, deviation: f64, count: usize) -> Result<Self, SpaceError> {
        Self::check(mean - deviation, mean + deviation, count.max(2))?;
        Self::check_modes(count)?;
        let rule = gauss_hermite(count);
        let place = |s: f64| mean + deviation * s;
        Ok(Self {
            edges: normal_edges(&rule).into_iter().map(place).collect(),
            nodes: rule.nodes.into_iter().map(place).collect(),
            pieces: Vec::new(),
            series: Some(Series::Hermite { mean, deviation }),
            layout: 1.0,
            closes: false,
        })
    }

    /// As [`Axis::hermite`], of a state that a range holds nearly always: the range is five standard deviations of the
    /// normal density to either side of its mean. The density need not be normal. Modes are few where the state's own
    /// deviation is a half to one and a half of that of the normal density.
    ///
    /// # Errors
    /// [`SpaceError::Range`] or [`SpaceError::Modes`].
    pub(crate) fn hermite_over(from: f64, to: f64, count: usize) -> Result<Self, SpaceError> {
        Self::check(from, to, count.max(2))?;
        let (mean, half) = (0.5 * (from + to), 0.5 * (to - from));
        Self::hermite(mean, half / DEVIATIONS_OF_A_RANGE, count)
    }

    /// An axis that closes on itself: the density along it is a trigonometric polynomial with `harmonics` harmonics of
    /// the turn from `from` to `to`, given by its values at 2 `harmonics` + 1 places in the middle of equal cells. For
    /// angles, and for the phase of a forcing.
    ///
    /// # Errors
    /// [`SpaceError::Range`] or [`SpaceError::Modes`].
    pub fn fourier(from: f64, to: f64, harmonics: usize) -> Result<Self, SpaceError> {
        let most = MOST_MODES / 2 - 1;
        if !(1..=most).contains(&harmonics) {
            let count = harmonics;
            return Err(SpaceError::Harmonics { count, most });
        }
        let even = Self::uniform(from, to, 2 * harmonics + 1)?;
        Ok(Self {
            pieces: Vec::new(),
            series: Some(Series::Fourier),
            closes: true,
            ..even
        })
    }

    /// The same axis with another number of modes, of harmonics for an axis that closes on itself.
    ///
    /// # Errors
    /// [`SpaceError::Modes`], [`SpaceError::Harmonics`]; an axis of cells becomes one of Legendre modes.
    pub fn with_modes(&self, count: usize) -> Result<Self, SpaceError> {
        match self.series {
            Some(Series::Fourier) => Self::fourier(self.from(), self.to(), count),
            Some(Series::Hermite { mean, deviation }) => Self::hermite(mean, deviation, count),
            Some(Series::Legendre) | None => Self::modes(self.from(), self.to(), count),
        }
    }

    /// The number of modes as it is given: of an axis that closes on itself that of its harmonics.
    pub(crate) fn mode_number(&self) -> usize {
        match self.series {
            Some(Series::Fourier) => self.count() / 2,
            _ => self.count(),
        }
    }

    /// Modes, or harmonics, without the last ones, which tell what those that are not there may do.
    pub(crate) fn fewer_modes(&self) -> usize {
        let number = self.mode_number();
        let least = if self.is_closed() {
            1
        } else {
            LEAST_MODES.min(number)
        };
        let kept = number.saturating_sub((number / MODES_A_MODE_LEFT_OUT).max(2));
        kept.max(least)
    }

    /// The largest number of modes it may have.
    pub(in crate::space) fn most_modes(&self) -> usize {
        match self.series {
            Some(Series::Fourier) => MOST_MODES / 2 - 1,
            _ => MOST_MODES,
        }
    }

    /// Whether it closes on itself: see [`Axis::fourier`] and [`Axis::turn`].
    pub(crate) fn is_closed(&self) -> bool {
        self.closes
    }

    /// Whether it is the phase of a periodic forcing, which runs from 0 to 1 in periods: an angle has its zero in the
    /// middle of the turn.
    pub(crate) fn is_phase(&self) -> bool {
        self.series == Some(Series::Fourier) && self.from() == 0.0 && self.to() == 1.0
    }

    /// Whether it carries a series in place of cells: see [`Axis::modes`], [`Axis::hermite`] and [`Axis::fourier`].
    pub fn is_modes(&self) -> bool {
        self.series.is_some()
    }

    /// The series that it carries; `None` for cells.
    pub(crate) fn series(&self) -> Option<Series> {
        self.series
    }

    /// Of an axis of Hermite modes or of harmonics, what the masses at its nodes owe to the modes beyond the first
    /// `kept` (harmonics beyond that many): entry `node · count + other` is what the mass at the other node adds. Of
    /// other axes nothing.
    pub(crate) fn beyond_modes(&self, kept: usize) -> Vec<f64> {
        let count = self.count();
        let (mean, deviation) = match self.series {
            Some(Series::Hermite { mean, deviation }) => (mean, deviation),
            Some(Series::Fourier) => {
                let turn = |at: usize| (at / count) as f64 - (at % count) as f64;
                let owed = (0..count * count)
                    .map(|at| turn(at) / count as f64)
                    .map(|turn| cardinal(turn, self.mode_number()) - cardinal(turn, kept));
                return owed.map(|owed| owed / count as f64).collect();
            }
            _ => return vec![0.0; count * count],
        };
        let values = |x: &f64| hermite_values(count, (x - mean) / deviation);
        let nodes: Vec<Vec<f64>> = self.nodes.iter().map(values).collect();
        let mut owed = Vec::with_capacity(count * count);
        for own in &nodes {
            // The weight of a node: values times roots of weights are an orthogonal matrix.
            let weight = 1.0 / own.iter().map(|value| value * value).sum::<f64>();
            for other in &nodes {
                let products = own.iter().zip(other).skip(kept).map(|(a, b)| a * b);
                owed.push(weight * products.sum::<f64>());
            }
        }
        owed
    }

    /// Of an axis of modes, the integrals of the series over bins with these edges: entry `bin · count + node` is what
    /// the mass at a node adds to a bin, by the first `used` modes.
    pub(crate) fn series_weights(&self, edges: &[f64], used: usize) -> Vec<f64> {
        if self.is_closed() {
            let turn = |x: &f64| (x - self.from()) / (self.to() - self.from());
            let edges: Vec<f64> = edges.iter().map(turn).collect();
            let nodes: Vec<f64> = self.nodes.iter().map(turn).collect();
            return fourier_integrals(&nodes, &edges, used / 2);
        }
        let (middle, half, is_hermite) = match self.series {
            Some(Series::Hermite { mean, deviation }) => (mean, deviation, true),
            Some(Series::Legendre | Series::Fourier) | None => {
                let (from, to) = (self.from(), self.to());
                (0.5 * (from + to), 0.5 * (to - from), false)
            }
        };
        let place = |x: &f64| (x - middle) / half;
        let at = |s: f64| {
            if is_hermite {
                hermite_values(used, s)
            } else {
                legendre_values(used, s)
            }
        };
        let below = |s: f64| {
            if is_hermite {
                hermite_integrals(used, s)
            } else {
                legendre_integrals(used, s)
            }
        };
        let nodes: Vec<Vec<f64>> = self.nodes.iter().map(|x| at(place(x))).collect();
        let integrals: Vec<Vec<f64>> = edges.iter().map(|x| below(place(x))).collect();
        let mut weights = Vec::with_capacity(nodes.len() * integrals.len());
        for bin in integrals.windows(2) {
            for node in &nodes {
                let terms = node.iter().zip(&bin[0]).zip(&bin[1]);
                weights.push(terms.map(|((value, low), high)| value * (high - low)).sum());
            }
        }
        weights
    }

    /// The ends between which a series is laid out: those of the axis, but six deviations of a normal density.
    pub(crate) fn series_range(&self) -> (f64, f64) {
        match self.series {
            Some(Series::Hermite { mean, deviation }) => {
                let half = NORMAL_RANGE * deviation;
                (mean - half, mean + half)
            }
            Some(Series::Legendre | Series::Fourier) | None => (self.from(), self.to()),
        }
    }

    /// Of an axis that closes on itself, what the mass at each node adds to the density at a place, times the length of
    /// the turn, by so many harmonics.
    pub(crate) fn weights_at(&self, x: f64, harmonics: usize) -> Vec<f64> {
        let turn = |x: f64| (x - self.from()) / (self.to() - self.from());
        let nodes = self.nodes.iter();
        let weights = nodes.map(|&node| cardinal(turn(x) - turn(node), harmonics));
        weights.collect()
    }

    /// Of an axis of modes, what the value of a function at each node adds to that at a place, where the function is a
    /// polynomial, or trigonometric, of the degree that the nodes tell. Beyond the outermost nodes it is what it is at
    /// them.
    pub(crate) fn interpolation(&self, x: f64) -> Vec<f64> {
        let count = self.count();
        if self.is_closed() {
            let weights = self.weights_at(x, self.mode_number());
            return weights.into_iter().map(|one| one / count as f64).collect();
        }
        let nodes = &self.nodes;
        let x = x.clamp(nodes[0], nodes[count - 1]);
        let weight = |node: usize| -> f64 {
            let others = (0..count).filter(|&other| other != node);
            others
                .map(|other| (x - nodes[other]) / (nodes[node] - nodes[other]))
                .product()
        };
        (0..count).map(weight).collect()
    }

    /// So many bins, times what finer axes have more of them: those over which its series is laid out.
    pub(crate) fn laid_out(&self, bins: usize) -> usize {
        (bins as f64 * self.layout).round() as usize
    }

    fn check_modes(count: usize) -> Result<(), SpaceError> {
        if (2..=MOST_MODES).contains(&count) {
            Ok(())
        } else {
            Err(SpaceError::Modes {
                count,
                most: MOST_MODES,
            })
        }
    }

    /// Of an axis of Legendre modes, the orthonormal polynomials √(2m + 1) P_m at its nodes; of one that closes on
    /// itself 1, √2 cos 2πs, √2 sin 2πs, √2 cos 4πs, …, s in turns: entry `node · count + m`.
    pub(crate) fn orthonormal_values(&self) -> Vec<f64> {
        if self.is_closed() {
            let turn = self.to() - self.from();
            let of_node = |x: &f64| waves(self.count(), (x - self.from()) / turn);
            return self.nodes.iter().flat_map(of_node).collect();
        }
        let (middle, half) = (
            0.5 * (self.from() + self.to()),
            0.5 * (self.to() - self.from()),
        );
        let at = |x: &f64| {
            let values = legendre_values(self.count(), (x - middle) / half).into_iter();
            values
                .enumerate()
                .map(|(m, value)| (2.0 * m as f64 + 1.0).sqrt() * value)
        };
        self.nodes.iter().flat_map(at).collect()
    }

    /// Of an axis of modes, the derivatives of the polynomials (trigonometric ones, where it closes on itself) that are
    /// one at a node and zero at the others: entry `k · count + i` is
    /// ℓ_i'(node k).
    pub(crate) fn differentiation(&self) -> Vec<f64> {
        if self.is_closed() {
            return fourier_derivatives(self.count(), self.to() - self.from());
        }
        differentiation(&self.nodes)
    }
}

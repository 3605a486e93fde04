//! What is known of a density beside its values: its symmetry, its kinks, and other estimates of it.

use std::sync::Arc;

use super::Profile;

/// What a system's equations say of a density.
#[derive(Debug, Clone, PartialEq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Structure {
    /// Point of symmetry, one coordinate an axis: p(c + u) = p(c - u). `None` where the system declares none.
    pub centre: Option<Vec<f64>>,
    /// Planes on which a derivative of the density jumps.
    pub kinks: Vec<Kink>,
    /// Of the density of a system with one axis that is known by quadrature: its extrema, free of the cells.
    #[cfg_attr(feature = "serde", serde(with = "crate::bytes"))]
    pub profile: Option<Arc<Profile>>,
    /// Whether masses of cells are spread over bins of a formula, or carried to and fro by a periodic forcing: what
    /// that does to bins has no order in the cells, and differs from bin to bin, so that two grids may agree by chance.
    pub is_spread: bool,
    /// Of each axis whether its lower and its upper end are the system's own, as walls are, and the least value of a
    /// formula: nothing where none is, or none is known. Another end is only where somebody stopped looking.
    #[cfg_attr(feature = "serde", serde(default))]
    pub own_ends: Vec<[bool; 2]>,
}

impl Structure {
    /// The same with ends of axes that are the system's own.
    pub(crate) fn with_own_ends(self, ends: impl Iterator<Item = [bool; 2]>) -> Self {
        let ends: Vec<[bool; 2]> = ends.collect();
        let has_any = ends.iter().flatten().any(|is_own| *is_own);
        let own_ends = if has_any { ends } else { Vec::new() };
        Self { own_ends, ..self }
    }

    /// Whether an end of an axis is known to be the system's own.
    pub(crate) fn is_own_end(&self, axis: usize, is_upper: bool) -> bool {
        let ends = self.own_ends.get(axis);
        ends.is_some_and(|ends| ends[usize::from(is_upper)])
    }
}

/// A plane on which the derivative of the density jumps, or bends: drift or noise across it does, or a force along it
/// where states cross it without noise.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Kink {
    /// Axis of the density (0 or 1) on which the plane stands.
    pub axis: usize,
    /// Its coordinate there.
    pub at: f64,
    /// Jump of ∂(log p)/∂(axis) from below to above the plane: one value a cell of the other axis, a single one for a
    /// marginal; none where only higher derivatives jump, or nobody knows by how much. With drift a and noise amplitude
    /// b across the plane it is (2 Δa - Δ(b²)')/b²; without noise there, -∇·(Δf p)/(a p) for a jump Δf of the drift
    /// along it.
    pub jump: Vec<f64>,
}

impl Kink {
    /// Jump of the slope of log p, times the range of the axis across, that is rounding.
    pub(crate) const ROUNDING: f64 = 1e-7;

    /// Whether the derivative bends there, and does not jump: no polynomial follows the density across, yet its slope
    /// is one.
    pub(crate) fn is_bend(&self) -> bool {
        self.jump.is_empty()
    }

    /// The jump at a cell of the other axis (0 for a marginal).
    pub fn jump_at(&self, cell: usize) -> f64 {
        let last = self.jump.len().saturating_sub(1);
        self.jump.get(cell.min(last)).copied().unwrap_or(0.0)
    }
}

/// Other estimates of the same density: what is derived from a density has the error that it shows among them.
#[derive(Debug, Clone, PartialEq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Variants {
    /// None: the density is exact, or nothing is known.
    #[default]
    None,
    /// Estimates without one group of samples each (values, like the density's): Tukey's delete-a-group jackknife.
    Jackknife(Vec<Vec<f64>>),
    /// The estimate of a second discretisation (values): a systematic difference, not a random one.
    Scheme(Vec<f64>),
}

impl Variants {
    /// Jackknife standard error of a number derived from the density, given its values for the replicates; zero
    /// for other kinds.
    pub(crate) fn sampling_error(&self, derived: impl Fn(&[f64]) -> f64) -> f64 {
        let Self::Jackknife(replicates) = self else {
            return 0.0;
        };
        let groups = replicates.len() as f64;
        let values: Vec<f64> = replicates.iter().map(|one| derived(one)).collect();
        let mean = values.iter().sum::<f64>() / groups;
        let squares: f64 = values.iter().map(|value| (value - mean).powi(2)).sum();
        ((groups - 1.0) / groups * squares).sqrt()
    }

    /// Degrees of freedom of [`Variants::sampling_error`].
    pub(crate) fn degrees_of_freedom(&self) -> f64 {
        match self {
            Self::Jackknife(replicates) => replicates.len().saturating_sub(1).max(1) as f64,
            _ => f64::INFINITY,
        }
    }

    /// Values of the second discretisation.
    pub(crate) fn second_scheme(&self) -> Option<&[f64]> {
        match self {
            Self::Scheme(values) => Some(values),
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_jackknife_error_of_a_mean_is_that_of_the_mean() {
        // Four observations 1, 2, 3, 6: mean 3, s² = 14/3, standard error √(14/12).
        let observations = [1.0, 2.0, 3.0, 6.0];
        let without = |skipped: f64| vec![(12.0 - skipped) / 3.0];
        let variants = Variants::Jackknife(observations.map(without).to_vec());
        let error = variants.sampling_error(|values| values[0]);
        assert!((error - (14.0f64 / 12.0).sqrt()).abs() < 1e-14);
        assert_eq!(variants.degrees_of_freedom(), 3.0);
        assert_eq!(Variants::None.sampling_error(|_| 1.0), 0.0);
    }
}

//! How power spectra and slowest modes change along a sweep: each change is where one number of the steady state passes
//! zero.

use super::measure::{DECAY_DISCRIMINANT, MeasureKind, SPECTRAL_CURVATURE, SPECTRAL_RISE};

/// How the shape of a power spectrum changes, or the kind of the slowest deviations.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum SpectralChange {
    /// The maximum at frequency zero becomes a minimum, or a minimum a maximum.
    AtZero,
    /// A maximum at a frequency above zero is born beside a minimum, or vanishes with it.
    Fold,
    /// The two slowest modes become a pair that oscillates, or a pair becomes two that do not.
    Pair,
}

impl SpectralChange {
    /// All.
    pub(super) const ALL: [Self; 3] = [Self::AtZero, Self::Fold, Self::Pair];

    /// Those of a power spectrum.
    pub(super) const OF_POWER: [Self; 2] = [Self::AtZero, Self::Fold];

    /// The number that is zero there.
    pub(super) fn measure(self) -> MeasureKind {
        match self {
            Self::AtZero => SPECTRAL_CURVATURE,
            Self::Fold => SPECTRAL_RISE,
            Self::Pair => DECAY_DISCRIMINANT,
        }
    }

    /// What there is before and after where that number rises.
    pub(super) fn sides(self) -> [&'static str; 2] {
        match self {
            Self::AtZero => ["maximum at zero", "minimum at zero"],
            Self::Fold => ["falling", "maximum above zero"],
            Self::Pair => ["pair that oscillates", "two that decay"],
        }
    }

    /// What happens to a spectrum, or to deviations, where the number rises, and where it falls.
    pub(super) fn words(self, rises: bool) -> &'static str {
        match (self, rises) {
            (Self::AtZero, true) => "the spectrum's maximum leaves frequency zero",
            (Self::AtZero, false) => "the spectrum's maximum comes to frequency zero",
            (Self::Fold, true) => "maximum and minimum of the spectrum appear",
            (Self::Fold, false) => "maximum and minimum of the spectrum vanish",
            (Self::Pair, true) => "the slowest deviations stop oscillating",
            (Self::Pair, false) => "the slowest deviations begin to oscillate",
        }
    }
}

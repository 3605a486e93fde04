//! The methods that are set side by side.

/// One of the methods that are compared.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Method {
    /// The generator, on the cells of the file.
    Generator,
    /// Stochastic generalized cell mapping as the paper has it.
    Sgcm,
    /// The same samples with densities linear inside the cells.
    SgcmSlope,
    /// Free trajectories, averaged over time.
    MonteCarlo,
}

words! {
    Method, pub name:
    Generator: "generator",
    Sgcm: "sgcm",
    SgcmSlope: "sgcm-slope",
    MonteCarlo: "monte-carlo",
}

impl Method {
    /// Name of the source of its densities.
    pub(crate) fn source(self) -> &'static str {
        match self {
            Self::SgcmSlope => Self::Sgcm.name(),
            other => other.name(),
        }
    }

    /// Name used in figures.
    pub(crate) fn title(self) -> &'static str {
        match self {
            Self::Generator => "generator",
            Self::Sgcm => "SGCM",
            Self::SgcmSlope => "SGCM, slope-corrected",
            Self::MonteCarlo => "Monte Carlo",
        }
    }

    /// Whether two methods use the same random numbers, so that their errors are not independent.
    pub(super) fn shares_samples(self, other: Self) -> bool {
        let sgcm = |method| matches!(method, Self::Sgcm | Self::SgcmSlope);
        sgcm(self) && sgcm(other)
    }
}

//! What a user must know of a point: findings of its solve, each with its numbers.
//!
//! A finding is made by a method, stored in `points.csv` as a code with numbers, and put into a sentence where people
//! read it. Its code and its axis are its kind: findings of one kind at several points are told once.

mod parts;
#[cfg(feature = "serde")]
pub(crate) mod stored;

/// Share of a density's mass that may be negative where its shape is to be believed. What is negative must be positive
/// elsewhere, so that wiggles of this size hold as much mass as a small peak does.
pub(super) const MOST_NEGATIVE: f64 = 0.02;

/// Something that a user must know of a point. Shares are of the whole mass or of the whole time.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Finding {
    /// Mass leaves Ω: the densities are quasi-stationary, conditioned on staying.
    Escaping {
        /// Share of the mass that leaves within one relaxation time.
        share: f64,
        /// Share that leaves per unit time.
        rate: f64,
    },
    /// So much mass leaves that Ω holds no steady state.
    NoSteadyState {
        /// Share that leaves per unit time.
        rate: f64,
        /// The relaxation time.
        relaxation_time: f64,
        /// Share within one relaxation time from which there is said to be no steady state.
        limit: f64,
    },
    /// The noise dies at an end of an axis, and all mass ends there: there is no stationary density.
    Absorbed {
        /// The axis.
        axis: usize,
        /// Coordinate of the end.
        at: f64,
        /// Exponent of the density at the end, -1 or less: the density would grow like this power of the distance.
        exponent: f64,
    },
    /// Most of the mass leaves within one map step: Ω holds no steady state.
    LeavesAtOnce {
        /// Share that leaves per unit time.
        rate: f64,
    },
    /// Free trajectories run away or stay outside: Ω holds no steady state.
    NothingStays {
        /// Share of the trajectories that ran away.
        runaways: f64,
        /// Share of the time that the others spent outside Ω.
        outside: f64,
        /// Share from which there is said to be no steady state.
        limit: f64,
    },
    /// Free trajectories spend time outside Ω: the densities are conditioned on being inside.
    Outside {
        /// Share of the time.
        share: f64,
    },
    /// Several closed classes of cells: which steady state is reached depends on the start.
    SeveralClasses {
        /// The classes, longest-lived first.
        classes: Vec<SteadyClass>,
    },
    /// The solver stopped before its tolerance.
    NotConverged {
        /// L1 error of the masses that the solver estimates.
        error: f64,
    },
    /// The outermost cells of an axis hold too much mass: its range is too narrow.
    EdgeMass {
        /// The axis.
        axis: usize,
        /// Mass in the cells at both ends that are not walls.
        mass: f64,
        /// The axis' range.
        range: [f64; 2],
    },
    /// Noise along an axis dies at an end of its range, and the cells beside it hold too much mass: the density goes
    /// there like a power of the distance, which cells do not follow.
    NaturalEnd {
        /// The axis.
        axis: usize,
        /// Mass in the cells beside the end.
        mass: f64,
        /// Where the end is.
        at: f64,
    },
    /// The density falls along an axis as so small a power of the distance that its standard deviation rests on what
    /// is beyond the range, or does not exist.
    HeavyTail {
        /// The axis.
        axis: usize,
        /// The power with which the density falls at the end of the range.
        power: f64,
    },
    /// What a formula of the coordinate adds to its mean does not become less toward an end of the axis: the mean does
    /// not exist, or is not known to.
    EndlessMean {
        /// Which of the formulas that are averaged it is.
        average: usize,
    },
    /// A watched density is negative somewhere: it has wiggles that the cells do not resolve.
    NegativeDensity {
        /// Σ |min(mass, 0)| of the worst of the watched densities.
        mass: f64,
    },
    /// Single cells have negative mass, which the watched densities, sums over cells, hardly show.
    NegativeCells {
        /// Σ |min(mass, 0)| over the cells.
        mass: f64,
        /// The same of the worst of the watched densities.
        watched: f64,
    },
    /// The cells along a noisy axis are too wide for its noise.
    WideCells {
        /// The axis.
        axis: usize,
        /// Largest cell Péclet number of damping and friction.
        peclet: f64,
    },
    /// An oscillator's balance is broken: where the axis is a velocity, of power in and power out, where it is a
    /// displacement, of `E[y²]` and `-E[x y']`.
    BalanceBroken {
        /// The axis.
        axis: usize,
        /// What is left of the balance, relative.
        relative: f64,
        /// The error of that.
        error: f64,
    },
    /// The last modes of a series matter to the density along its axis.
    UnresolvedSeries {
        /// The axis.
        axis: usize,
        /// Total variation between the density by all modes and by all but the last two.
        change: f64,
    },
    /// Too few modes carry axes: with more of them watched densities change.
    FewModes {
        /// Largest change of a watched density on coarse cells, relative to its largest value, when more modes were
        /// tried.
        change: f64,
    },
    /// The cells at a switching surface are wider than the layer that holds the kink of the density.
    SmearedKink {
        /// The axis across the surface.
        axis: usize,
        /// Cell width over the thickness of the layer.
        widths: f64,
    },
    /// No face of the cells falls on a switching surface.
    SurfaceOffFaces {
        /// The axis across the surface.
        axis: usize,
        /// Where the surface is.
        at: f64,
    },
    /// The same of a surface across which the drift jumps along a noisy axis: the kink of the density lies inside
    /// cells.
    JumpInsideCells {
        /// The axis across the surface.
        axis: usize,
        /// Where the surface is.
        at: f64,
    },
    /// The cells diffuse as if there were more noise.
    NumericalDiffusion {
        /// Relative increase of the noise, each axis in units of its variance.
        share: f64,
    },
    /// The time step of the trajectories shifts a number of the steady state.
    StepBias {
        /// What it shifts.
        quantity: ShiftedQuantity,
        /// By how much, relative.
        relative: f64,
        /// Standard error of that.
        standard_error: f64,
        /// The time step.
        time_step: f64,
    },
    /// Trajectories forget their start too slowly for the time to be measured.
    UnresolvedRelaxation {
        /// Autocorrelation time, a lower bound.
        time: f64,
    },
    /// States are counted before the start is forgotten.
    ShortBurnIn {
        /// Time before states are counted.
        burn_in: f64,
        /// Autocorrelation time.
        time: f64,
    },
    /// The sampling error is unknown: leaving out a group of samples leaves no steady state.
    NoReplicates,
    /// The sampling error rests on fewer groups of samples than were asked for.
    FewReplicates {
        /// Groups that could be left out.
        usable: usize,
        /// Groups there are.
        wanted: usize,
    },
    /// A passage that was asked for has no numbers.
    NoPassage {
        /// Its number among those that were asked for.
        passage: usize,
        /// Why.
        fault: PassageFault,
    },
    /// How often a region is visited, that was asked for, has no number.
    NoVisits {
        /// Its number among those that were asked for.
        visits: usize,
        /// Whether noise acts across its border, so that there are infinitely many; else it is entered nowhere, or its
        /// numbers are not known to their own size.
        is_endless: bool,
    },
    /// Paths of a passage still went on when they were given up.
    PassageCut {
        /// Its number among those that were asked for.
        passage: usize,
        /// Share of the paths.
        share: f64,
        /// When they were given up.
        longest: f64,
    },
    /// The fixed point of which the exponent is wanted attracts almost every path beside it: no density was looked for.
    PointMass {
        /// Its largest Lyapunov exponent.
        exponent: f64,
        /// The exponent's error.
        error: f64,
    },
    /// The state of which the exponent is wanted is no fixed point at this value.
    NoFixedPoint {
        /// The axis along which it moves most.
        axis: usize,
        /// The drift there.
        drift: f64,
        /// The largest amplitude of a noise there.
        noise: f64,
    },
    /// There is no exponent: drift or noise has no derivative at the state, or the angle has no density.
    NoExponent,
    /// Fewer slow modes are known than are wanted.
    FewSlowModes {
        /// Modes that are known.
        known: usize,
        /// Modes that are wanted.
        wanted: usize,
    },
    /// Spectra that are asked for were not solved.
    NoSpectrum,
    /// A power spectrum is not known from a frequency on.
    SpectrumCut {
        /// The angular frequency.
        frequency: f64,
    },
    /// Sentences of a stored run that has no numbers for them.
    Told(String),
}

/// Why a passage has no numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum PassageFault {
    /// No cell is inside the region that is waited for.
    Nowhere,
    /// A part of that region lies between the nodes of the cells.
    Between,
    /// All cells are.
    Everywhere,
    /// The start is inside that region, outside of the cells, or never visited.
    Start,
    /// The start is weighted by a steady state, and there is none.
    NoDensity,
    /// The region is never entered.
    Never,
    /// The equations of the passage were not solved.
    Unsolved,
    /// Hardly a path entered the region in the time that it had.
    Rare,
    /// Paths run away without entering the region.
    RunsAway,
    /// The slowest mode is no exchange between the two regions.
    NoSwitching,
    /// A region is the basin of a peak, or of a ring, that the density does not have, or whose border was not found.
    NoPeak,
    /// The two regions of transitions have cells in common.
    Overlap,
    /// Cells and rounding leave an error as large as the mean time itself.
    Rounding,
}

/// A class of cells with a steady state of its own, beside others.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct SteadyClass {
    /// Number of its cells.
    pub cells: usize,
    /// Share of the initial mass that ends in it.
    pub share: f64,
    /// Centre of the cell in its middle, one coordinate an axis.
    pub centre: Vec<f64>,
}

/// A number of the steady state that a time step may shift.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum ShiftedQuantity {
    /// Variance of an axis.
    Variance(usize),
    /// Mean energy, as the sum of the variances, each relative to its own.
    Energy,
    /// Mass beside a switching surface across an axis.
    SurfaceMass(usize),
}

/// Error of a density whose solver stopped before its tolerance above which nothing is read from it: a tenth of what
/// cells are chosen for.
const MOST_ERROR: f64 = 1e-4;

impl Finding {
    /// Code and axis. Findings that share them say the same thing with other numbers, and are told once.
    pub(crate) fn kind(&self) -> (&'static str, Option<usize>) {
        let (code, axis, _) = self.parts();
        (code, axis)
    }

    /// Whether it says that cells are too wide to count by.
    pub(crate) fn is_of_wide_cells(&self) -> bool {
        matches!(self, Self::WideCells { .. })
    }

    /// Says of coordinates of an axis that are measured from another origin where they lie.
    pub(crate) fn displace(&mut self, moved: usize, by: f64) {
        match self {
            Self::EdgeMass { axis, range, .. } if *axis == moved => {
                range.iter_mut().for_each(|end| *end += by);
            }
            Self::SurfaceOffFaces { axis, at } | Self::JumpInsideCells { axis, at }
                if *axis == moved =>
            {
                *at += by;
            }
            _ => (),
        }
    }

    /// Whether the solver stopped so far from the density that peaks may be of what is left. An error that is not a
    /// number is no small one.
    pub(crate) fn is_too_far_to_count(&self) -> bool {
        matches!(self, Self::NotConverged { error } if error.is_nan() || *error > MOST_ERROR)
    }

    /// Whether the negative part of a watched density is too large for its shape to be read.
    pub(crate) fn is_too_negative(&self) -> bool {
        matches!(self, Self::NegativeDensity { mass } if *mass > MOST_NEGATIVE)
    }
}

#[cfg(test)]
pub(crate) mod tests;

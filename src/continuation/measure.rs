//! Numbers of a solved value: their names in tables, their units, and how well they are known.

/// A number of a solved value: a moment, a rate, a mass that should be zero.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Measure {
    /// Its column in tables: the word of its kind, and after `_` what it is of, for example `sd_x`.
    pub name: String,
    /// The number.
    pub value: f64,
    /// Its error; `None` where none is known.
    pub error: Option<f64>,
    /// Its unit, made of `t` (the time of the equations) and the names of axes and quantities.
    pub unit: String,
}

/// What measures of one kind have in common.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct MeasureKind {
    /// The word in tables.
    pub word: &'static str,
    /// Whether the name of what the number is of goes before the word, as that of a passage does: `exit_mean`.
    pub follows: bool,
    /// The unit; `{}` is the name of what the number is of.
    pub unit: &'static str,
    /// The column of `points.csv`, in words.
    pub meaning: &'static str,
}

/// A derived measure that is asked for, as tables have it before there is a value.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct MeasureColumn {
    /// Its kind.
    pub kind: MeasureKind,
    /// What it is of: an axis, a quantity or a density; empty where it is of all of them.
    pub of: String,
}

impl MeasureKind {
    /// Name of the number that is of an axis, a quantity or a density; of all of them where `of` is empty.
    pub(crate) fn name(&self, of: &str) -> String {
        match of {
            "" => self.word.to_owned(),
            of if self.follows => format!("{of}_{}", self.word),
            of => format!("{}_{of}", self.word),
        }
    }

    /// A number of this kind without a known error.
    pub(crate) fn measure(&self, of: &str, value: f64) -> Measure {
        Measure {
            name: self.name(of),
            value,
            error: None,
            unit: self.unit.replace("{}", of),
        }
    }

    /// Whether a measure is of this kind.
    pub(crate) fn has(&self, measure: &Measure) -> bool {
        if self.follows {
            let of = measure.name.strip_suffix(self.word);
            return of.is_some_and(|of| of.ends_with('_'));
        }
        let of = measure.name.strip_prefix(self.word);
        of.is_some_and(|of| of.is_empty() || of.starts_with('_'))
    }
}

const fn kind(word: &'static str, unit: &'static str, meaning: &'static str) -> MeasureKind {
    MeasureKind {
        word,
        follows: false,
        unit,
        meaning,
    }
}

const fn of_passage(word: &'static str, unit: &'static str, meaning: &'static str) -> MeasureKind {
    MeasureKind {
        follows: true,
        ..kind(word, unit, meaning)
    }
}

pub(crate) const PASSAGE_MEAN: MeasureKind = of_passage("mean", "t", "mean time of a passage");
pub(crate) const PASSAGE_DEVIATION: MeasureKind =
    of_passage("sd", "t", "standard deviation of the time of a passage");
pub(crate) const PASSAGE_SURVIVAL: MeasureKind = of_passage(
    "survival",
    "1",
    "probability that a passage still goes on at a time, which stands before the word",
);
pub(crate) const PASSAGE_SHARE: MeasureKind = of_passage(
    "share",
    "1",
    "share of the passages that end in one of several regions, which stands before the word",
);
pub(crate) const TIME_SHARE: MeasureKind =
    of_passage("time_share", "1", "share of the time spent in a region");
pub(crate) const VISITS: MeasureKind = of_passage(
    "visits",
    "1/t",
    "how often a region is entered per unit of time",
);
pub(crate) const SOJOURN: MeasureKind = of_passage(
    "sojourn",
    "t",
    "mean time from entering a region to leaving it",
);
pub(crate) const PASSAGE_THERE: MeasureKind = of_passage(
    "switching_rate",
    "1/t",
    "rate from the first to the second of two states, of the slowest mode",
);
pub(crate) const PASSAGE_BACK: MeasureKind =
    of_passage("return_rate", "1/t", "the rate back, of the slowest mode");
pub(crate) const TRANSITION_FLUX: MeasureKind = of_passage(
    "transition_flux",
    "1/t",
    "transitions from the first to the second of two regions per unit of time",
);
pub(crate) const TRANSITION_RATE: MeasureKind = of_passage(
    "transition_rate",
    "1/t",
    "the same for each unit of time that the first region was the last one of the two",
);
pub(crate) const TRANSITION_TIME: MeasureKind = of_passage(
    "transition_time",
    "t",
    "mean time on the way, from the last moment in the first region to the first one in the second",
);
pub(crate) const PASSAGE_KRAMERS: MeasureKind = of_passage(
    "kramers",
    "1/t",
    "rate from the first to the second of two states by Kramers' formula for moderate and strong damping",
);
pub(crate) const PASSAGE_MELNIKOV: MeasureKind = of_passage(
    "melnikov",
    "1/t",
    "the same with Mel'nikov and Meshkov's factor, for all damping",
);
pub(crate) const PASSAGE_QUANTILE: MeasureKind = of_passage(
    "quantile",
    "t",
    "time by which a share of the passages, which stands before the word, has ended",
);
pub(crate) const PASSAGE_RATE: MeasureKind = of_passage(
    "rate",
    "1/t",
    "probability per unit time that a passage ends which has lasted long",
);

pub(crate) const EXPONENT: MeasureKind = kind(
    "exponent",
    "1/t",
    "largest Lyapunov exponent, of a fixed point that multiplicative noise leaves alone or along the stationary density",
);
pub(crate) const DIVERGENCE: MeasureKind = kind(
    "divergence",
    "1/t",
    "sum of all Lyapunov exponents along the stationary density: mean divergence of drift and noise",
);
pub(crate) const VELOCITY: MeasureKind =
    kind("velocity", "{}/t", "mean rate at which an angle turns");
pub(crate) const TURN_DIFFUSION: MeasureKind = kind(
    "diffusion",
    "{}^2/t",
    "effective diffusion of an angle whose turns are counted: half the rate at which its variance grows",
);
pub(crate) const AMPLITUDE: MeasureKind = kind(
    "amplitude",
    "{}",
    "amplitude of the mean of a state at the frequency of the forcing",
);
pub(crate) const AMPLIFICATION: MeasureKind = kind(
    "amplification",
    "{}^2",
    "spectral amplification: the same over the amplitude of the forcing, squared",
);
pub(crate) const SIGNAL_TO_NOISE: MeasureKind = kind(
    "signal_to_noise",
    "1/t",
    "signal-to-noise ratio at the frequency of the forcing: π times the square of the amplitude of the mean, over the \
     power spectrum of the fluctuations about it",
);
pub(crate) const DECAY_RATE: MeasureKind = kind(
    "decay_rate",
    "1/t",
    "rate at which a slow mode, a deviation from the steady state, dies out",
);
pub(crate) const DECAY_FREQUENCY: MeasureKind = kind(
    "decay_frequency",
    "1/t",
    "angular frequency at which a slow mode oscillates; 0 where it does not",
);
pub(crate) const DECAY_DISCRIMINANT: MeasureKind = kind(
    "decay_discriminant",
    "1/t^2",
    "square of half of the difference of the two slowest modes: below zero where they are a pair that oscillates",
);
pub(crate) const SPECTRAL_PEAK: MeasureKind = kind(
    "spectral_peak",
    "1/t",
    "angular frequency of the highest maximum of a power spectrum above zero",
);
pub(crate) const SPECTRAL_WIDTH: MeasureKind = kind(
    "spectral_width",
    "1/t",
    "full width of that maximum at half of its height",
);
pub(crate) const CORRELATION_TIME: MeasureKind = kind(
    "correlation_time",
    "t",
    "integral of the correlation function from zero on, over the variance",
);
pub(crate) const SPECTRAL_CURVATURE: MeasureKind = kind(
    "spectral_curvature",
    "t^2",
    "second derivative of a power spectrum at zero over its value there: above zero where it rises from there",
);
pub(crate) const SPECTRAL_RISE: MeasureKind = kind(
    "spectral_rise",
    "1",
    "largest local maximum of the slope of a power spectrum in logarithms: above zero where it has a maximum above frequency zero",
);

pub(crate) const ESCAPE_RATE: MeasureKind =
    kind("escape_rate", "1/t", "mass that leaves Ω per unit time");
pub(crate) const NEGATIVE_MASS: MeasureKind = kind(
    "negative_mass",
    "1",
    "sum of the magnitudes of negative masses",
);
pub(crate) const EDGE_MASS: MeasureKind = kind(
    "edge_mass",
    "1",
    "mass in cells that touch an end of a range, walls that the model knows not counted: the largest over the axes",
);
pub(crate) const MEAN: MeasureKind = kind("mean", "{}", "mean of an axis or a quantity");
pub(crate) const DEVIATION: MeasureKind =
    kind("sd", "{}", "standard deviation of an axis or a quantity");
pub(crate) const MAP_STEP: MeasureKind = kind("map_step", "t", "time one transition spans");
pub(crate) const FACTORISATIONS: MeasureKind =
    kind("factorisations", "1", "factorisations made for this value");
pub(crate) const NUMERICAL_DIFFUSION: MeasureKind = kind(
    "numerical_diffusion",
    "{}^2/t",
    "diffusion that the cells add",
);
pub(crate) const TIME_STEP_BIAS: MeasureKind = kind(
    "time_step_bias",
    "1",
    "relative shift of the variances (or of the mass beside a switching surface) by the time step of trajectories",
);

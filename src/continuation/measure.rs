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

/// The kinds of measures: each with its word, its unit and its meaning.
macro_rules! kinds {
    ($follows:literal: $($kind:ident $word:literal $unit:literal $meaning:literal)+) => {$(
        pub(crate) const $kind: MeasureKind = MeasureKind {
            word: $word,
            follows: $follows,
            unit: $unit,
            meaning: $meaning,
        };
    )+};
}

// Of passages, regions and states, whose names go before the word.
kinds! { true:
    PASSAGE_MEAN "mean" "t" "mean time of a passage"
    PASSAGE_DEVIATION "sd" "t" "standard deviation of the time of a passage"
    PASSAGE_SURVIVAL "survival" "1" "probability that a passage still goes on at a time, which stands before the word"
    PASSAGE_SHARE "share" "1" "share of the passages that end in one of several regions, which stands before the word"
    TIME_SHARE "time_share" "1" "share of the time spent in a region"
    VISITS "visits" "1/t" "how often a region is entered per unit of time"
    SOJOURN "sojourn" "t" "mean time from entering a region to leaving it"
    PASSAGE_THERE "switching_rate" "1/t" "rate from the first to the second of two states, of the slowest mode"
    PASSAGE_BACK "return_rate" "1/t" "the rate back, of the slowest mode"
    TRANSITION_FLUX "transition_flux" "1/t" "transitions from the first to the second of two regions per unit of time"
    TRANSITION_RATE "transition_rate" "1/t"
        "the same for each unit of time that the first region was the last one of the two"
    TRANSITION_TIME "transition_time" "t"
        "mean time on the way, from the last moment in the first region to the first one in the second"
    PASSAGE_KRAMERS "kramers" "1/t"
        "rate from the first to the second of two states by Kramers' formula for moderate and strong damping"
    PASSAGE_MELNIKOV "melnikov" "1/t" "the same with Mel'nikov and Meshkov's factor, for all damping"
    PASSAGE_QUANTILE "quantile" "t" "time by which a share of the passages, which stands before the word, has ended"
    PASSAGE_RATE "rate" "1/t" "probability per unit time that a passage ends which has lasted long"
}

// Of axes, quantities, densities and what is solved.
kinds! { false:
    EXPONENT "exponent" "1/t"
        "largest Lyapunov exponent, of a fixed point that multiplicative noise leaves alone or along the stationary \
         density"
    DIVERGENCE "divergence" "1/t"
        "sum of all Lyapunov exponents along the stationary density: mean divergence of drift and noise"
    VELOCITY "velocity" "{}/t" "mean rate at which an angle turns"
    TURN_DIFFUSION "diffusion" "{}^2/t"
        "effective diffusion of an angle whose turns are counted: half the rate at which its variance grows"
    AMPLITUDE "amplitude" "{}" "amplitude of the mean of a state at the frequency of the forcing"
    AMPLIFICATION "amplification" "{}^2" "spectral amplification: the same over the amplitude of the forcing, squared"
    SIGNAL_TO_NOISE "signal_to_noise" "1/t"
        "signal-to-noise ratio at the frequency of the forcing: π times the square of the amplitude of the mean, over \
         the power spectrum of the fluctuations about it"
    DECAY_RATE "decay_rate" "1/t" "rate at which a slow mode, a deviation from the steady state, dies out"
    DECAY_FREQUENCY "decay_frequency" "1/t" "angular frequency at which a slow mode oscillates; 0 where it does not"
    DECAY_DISCRIMINANT "decay_discriminant" "1/t^2"
        "square of half of the difference of the two slowest modes: below zero where they are a pair that oscillates"
    SPECTRAL_PEAK "spectral_peak" "1/t" "angular frequency of the highest maximum of a power spectrum above zero"
    SPECTRAL_WIDTH "spectral_width" "1/t" "full width of that maximum at half of its height"
    CORRELATION_TIME "correlation_time" "t" "integral of the correlation function from zero on, over the variance"
    SPECTRAL_CURVATURE "spectral_curvature" "t^2"
        "second derivative of a power spectrum at zero over its value there: above zero where it rises from there"
    SPECTRAL_RISE "spectral_rise" "1"
        "largest local maximum of the slope of a power spectrum in logarithms: above zero where it has a maximum \
         above frequency zero"
    ESCAPE_RATE "escape_rate" "1/t" "mass that leaves Ω per unit time"
    NEGATIVE_MASS "negative_mass" "1" "sum of the magnitudes of negative masses"
    EDGE_MASS "edge_mass" "1"
        "mass in cells that touch an end of a range, walls that the model knows not counted: the largest over the axes"
    MEAN "mean" "{}" "mean of an axis or a quantity"
    DEVIATION "sd" "{}" "standard deviation of an axis or a quantity"
    MAP_STEP "map_step" "t" "time one transition spans"
    FACTORISATIONS "factorisations" "1" "factorisations made for this value"
    NUMERICAL_DIFFUSION "numerical_diffusion" "{}^2/t" "diffusion that the cells add"
    TIME_STEP_BIAS "time_step_bias" "1"
        "relative shift of the variances (or of the mass beside a switching surface) by the time step of trajectories"
}

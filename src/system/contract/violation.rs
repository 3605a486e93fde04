//! What a system or a model can break.

use std::fmt;

use super::super::SwitchingSurface;

/// A quantity of a system.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Quantity {
    /// The drift along an axis.
    Drift(usize),
    /// The noise intensity Σ b² on an axis.
    Noise(usize),
    /// The logarithm of the exact density.
    Density,
}

impl fmt::Display for Quantity {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Drift(axis) => write!(formatter, "the drift along axis {axis}"),
            Self::Noise(axis) => write!(formatter, "the noise intensity on axis {axis}"),
            Self::Density => write!(formatter, "the logarithm of the exact density"),
        }
    }
}

/// What does not hold, and where it shows. Axes and Wiener processes are counted from 0.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ContractViolation {
    /// No axis, or more than a cell space can have.
    #[error("the system has {dimension} axes; 1 to {most} are allowed", most = crate::MAX_DIMENSION)]
    Dimension {
        /// Dimension that the system gives.
        dimension: usize,
    },
    /// Not one range an axis was given to try the system on.
    #[error("{given} ranges are given for a system with {dimension} axes")]
    Ranges {
        /// Number of ranges.
        given: usize,
        /// Dimension of the system.
        dimension: usize,
    },
    /// A range that holds no state within the bounds of the system.
    #[error("there is no state of axis {axis} from {from} to {to}")]
    Range {
        /// The axis.
        axis: usize,
        /// Lower end.
        from: f64,
        /// Upper end.
        to: f64,
    },
    /// A model describes more or fewer axes than its systems have.
    #[error("the model describes {described} axes, its system has {dimension}")]
    AxesDescribed {
        /// Number of descriptions.
        described: usize,
        /// Dimension of the system.
        dimension: usize,
    },
    /// Two axes or parameters of a model have one name.
    #[error("the name `{name}` is used twice among axes and parameters")]
    NameTwice {
        /// The name.
        name: String,
    },
    /// The default of a parameter is not a value it may take.
    #[error("the default {value} of parameter `{parameter}` is outside its own range")]
    Default {
        /// The parameter.
        parameter: String,
        /// Its default.
        value: f64,
    },
    /// A Wiener process drives an axis that the system does not have.
    #[error("Wiener process {channel} drives axis {axis} of a system with {dimension} axes")]
    NoiseAxis {
        /// The process.
        channel: usize,
        /// The axis it names.
        axis: usize,
        /// Dimension of the system.
        dimension: usize,
    },
    /// Something is declared of an axis that the system does not have.
    #[error("something is declared of axis {axis} of a system with {dimension} axes")]
    Axis {
        /// The axis.
        axis: usize,
        /// Dimension of the system.
        dimension: usize,
    },
    /// A period that is not a positive number.
    #[error("the period {period} is not a finite number greater than zero")]
    Period {
        /// The period.
        period: f64,
    },
    /// Bounds that hold nothing.
    #[error("the bounds of axis {axis}, from {from} to {to}, hold no value")]
    Bounds {
        /// The axis.
        axis: usize,
        /// Lower bound.
        from: f64,
        /// Upper bound.
        to: f64,
    },
    /// A surface on an axis that the system does not have, or at no finite number.
    #[error("there is no switching surface at {at} on axis {axis} of a system with {dimension} axes",
        axis = surface.axis, at = surface.at)]
    Surface {
        /// The surface.
        surface: SwitchingSurface,
        /// Dimension of the system.
        dimension: usize,
    },
    /// A symmetry whose centre or reflected axes are not one an axis.
    #[error("the symmetry has {centre} coordinates and {reflected} axes, the system {dimension}")]
    SymmetryShape {
        /// Coordinates of the centre.
        centre: usize,
        /// Axes that it says to reflect or not.
        reflected: usize,
        /// Dimension of the system.
        dimension: usize,
    },
    /// A quantity that is not a finite number, or was not written at all.
    #[error("{quantity} is not finite at {state:?}, time {time}")]
    NotFinite {
        /// What.
        quantity: Quantity,
        /// Where.
        state: Vec<f64>,
        /// When.
        time: f64,
    },
    /// Noise amplitudes whose squares are too small to be numbers: the method would see no noise.
    #[error("the noise intensity on axis {axis} is zero, though its amplitude is not")]
    Vanishing {
        /// The axis.
        axis: usize,
    },
    /// A state in a batch of others has another drift or noise than alone.
    #[error(
        "{quantity} is {alone} at {state:?}, but {in_batch} where other states share its batch"
    )]
    BatchMixes {
        /// What.
        quantity: Quantity,
        /// Where.
        state: Vec<f64>,
        /// Value of a batch of this state only.
        alone: f64,
        /// Value among others.
        in_batch: f64,
    },
    /// A compiled drift that is not what the formulas say.
    #[error(
        "the compiled drift along axis {axis} is {found} at {state:?}, where its formula gives {expected}"
    )]
    Formula {
        /// The axis.
        axis: usize,
        /// Where.
        state: Vec<f64>,
        /// The compiled drift.
        found: f64,
        /// The drift by the formula.
        expected: f64,
    },
    /// A quantity that does not repeat after the period, or changes with time without one.
    #[error(
        "{quantity} at {state:?} changes from {first} at time {from} to {second} at time {to}; the period is {}",
        declared_period(period)
    )]
    Time {
        /// What.
        quantity: Quantity,
        /// Where.
        state: Vec<f64>,
        /// The two times.
        from: f64,
        /// The later time.
        to: f64,
        /// Value at the first time.
        first: f64,
        /// Value at the second time.
        second: f64,
        /// The declared period.
        period: Option<f64>,
    },
    /// A symmetry that is none: the image of a state has not the image of its drift, or another noise or density.
    #[error(
        "the declared symmetry does not hold: {quantity} is {found} at {image:?}, the image of {state:?}, \
             where {expected} should be"
    )]
    Asymmetric {
        /// What.
        quantity: Quantity,
        /// A state.
        state: Vec<f64>,
        /// Its image.
        image: Vec<f64>,
        /// Value at the image that the state implies.
        expected: f64,
        /// Value at the image.
        found: f64,
    },
    /// The drift leads out of a bound.
    #[error("the bound {bound} of axis {axis} is left with speed {speed} at {state:?}")]
    BoundLeft {
        /// The axis.
        axis: usize,
        /// The bound.
        bound: f64,
        /// A state on the bound.
        state: Vec<f64>,
        /// Drift outward there.
        speed: f64,
    },
    /// Noise acts across a bound.
    #[error(
        "noise of amplitude {amplitude} acts across the bound {bound} of axis {axis} at {state:?}"
    )]
    BoundNoise {
        /// The axis.
        axis: usize,
        /// The bound.
        bound: f64,
        /// A state on the bound.
        state: Vec<f64>,
        /// Amplitude of a Wiener process there.
        amplitude: f64,
    },
    /// A coordinate that is declared to be white noise behind a linear filter, and is not, or has another mean or
    /// deviation.
    #[error(
        "axis {axis} is declared to be filtered noise of mean {mean} and standard deviation {deviation}, which its drift and noise at \
         {state:?} do not fit"
    )]
    Filter {
        /// The axis.
        axis: usize,
        /// Declared mean.
        mean: f64,
        /// Declared standard deviation.
        deviation: f64,
        /// Where.
        state: Vec<f64>,
    },
    /// A coordinate does not relax as it is declared to.
    #[error(
        "axis {axis} is declared to relax linearly at the rate {rate}, which its drift or noise at {state:?} does not fit"
    )]
    Relaxation {
        /// The axis.
        axis: usize,
        /// Declared rate.
        rate: f64,
        /// Where.
        state: Vec<f64>,
    },
    /// The exact density does not solve the stationary Fokker-Planck equation.
    #[error(
        "the exact density is not stationary: the Fokker-Planck equation over p leaves {residual} at {state:?}, \
             where its terms are of size {terms}"
    )]
    NotStationary {
        /// Where.
        state: Vec<f64>,
        /// What the equation, divided by p, leaves.
        residual: f64,
        /// Sum of the magnitudes of its terms.
        terms: f64,
    },
    /// The drift is smooth across a declared surface.
    #[error("neither the drift nor its slope jumps at the declared switching surface at {at} on axis {axis}",
        axis = surface.axis, at = surface.at)]
    SmoothSurface {
        /// The surface.
        surface: SwitchingSurface,
    },
}

fn declared_period(period: &Option<f64>) -> String {
    period.map_or_else(|| "not declared".to_owned(), |period| period.to_string())
}

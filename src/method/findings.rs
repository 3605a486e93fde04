//! What a user must know of a point, in sentences: mass at the edge of Ω, escape, numerical diffusion,
//! non-convergence. Each limit stands here once.

use std::sync::Arc;

use crate::density::Moments;
use crate::generator::Resolution;
use crate::monte_carlo::{BiasedQuantity, StepBias, TOLERATED_BIAS};
use crate::space::CellSpace;
use crate::stationary::ClassShare;
use crate::system::{Model, System};

/// Negative mass (a sign of wiggles that the grid does not resolve) above which it is worth a word.
const NEGATIVE_MASS_LIMIT: f64 = 1e-3;

/// Mass in the cells at an end of a range above which the range is said to be too narrow.
const EDGE_MASS_LIMIT: f64 = 1e-3;

/// Relative increase of the noise by numerical diffusion above which it is worth a word.
const NUMERICAL_DIFFUSION_LIMIT: f64 = 0.1;

/// Share of the mass that may leave within one relaxation time without a word.
pub(super) const QUIET_ESCAPE: f64 = 1e-3;

/// Sentences in the making.
#[derive(Debug)]
pub(super) struct Findings<'a> {
    model: &'a Model,
    space: &'a CellSpace,
    sentences: Vec<String>,
}

impl<'a> Findings<'a> {
    pub(super) fn new(model: &'a Model, space: &'a CellSpace) -> Self {
        Self {
            model,
            space,
            sentences: Vec::new(),
        }
    }

    pub(super) fn into_sentences(self) -> Vec<String> {
        self.sentences
    }

    fn axis(&self, axis: usize) -> &'a str {
        self.model
            .axes
            .get(axis)
            .map_or("?", |axis| axis.name.as_str())
    }

    /// Mass in the cells at the ends of each axis that are not walls of the system, with a sentence where it is
    /// too much.
    pub(super) fn edge_mass(&mut self, mass: &[f64], closed: &[[bool; 2]]) -> Vec<f64> {
        let mut edges = vec![[0.0; 2]; self.space.dimension()];
        for (cell, &mass) in mass.iter().enumerate() {
            for (axis, ends) in edges.iter_mut().enumerate() {
                let position = self.space.position(cell, axis);
                let last = self.space.axes()[axis].count() - 1;
                if position == 0 && !closed[axis][0] {
                    ends[0] += mass;
                }
                if position == last && !closed[axis][1] {
                    ends[1] += mass;
                }
            }
        }
        for (axis, ends) in edges.iter().enumerate() {
            let total = ends[0] + ends[1];
            if total > EDGE_MASS_LIMIT {
                let cells = &self.space.axes()[axis];
                self.sentences.push(format!(
                    "{:.2} % of the mass lies in the outermost cells of {}: widen its range beyond [{}, {}]",
                    100.0 * total,
                    self.axis(axis),
                    cells.from(),
                    cells.to(),
                ));
            }
        }
        edges.iter().map(|ends| ends[0] + ends[1]).collect()
    }

    /// Negative mass of the cells, and the largest of the watched densities: wiggles along an axis that is summed
    /// over do not reach those.
    pub(super) fn negative_mass(&mut self, cells: f64, watched: f64) {
        if watched > NEGATIVE_MASS_LIMIT {
            self.sentences.push(format!(
                "{:.2} % of the mass of a watched density is negative: it has wiggles that the cells do not resolve; use more cells",
                100.0 * watched
            ));
        } else if cells > NEGATIVE_MASS_LIMIT {
            self.sentences.push(format!(
                "{:.1} % of the mass of single cells is negative: wiggles that the cells do not resolve; the watched densities \
                 have less than {watched:.0e} of it",
                100.0 * cells
            ));
        }
    }

    /// Whether the cells along a noisy axis are fine enough.
    pub(super) fn resolution(&mut self, judged: &Resolution) {
        let axis = self.axis(judged.axis);
        if judged.fitted_peclet > 1.0 {
            self.sentences.push(format!(
                "the cells of {axis} are too wide for the noise (cell Péclet number of damping and friction {:.1}): \
                 use more cells",
                judged.fitted_peclet
            ));
        }
        if let Some(layer) = judged.layer.filter(|&layer| layer > 1.0) {
            self.sentences.push(format!(
                "the cells of {axis} at the switching surface are {layer:.0} times as wide as the layer that holds the \
                 kink of the density, so the kink is smeared: grade = \"auto\" on {axis} resolves it"
            ));
        }
        for at in &judged.surfaces_off_faces {
            self.sentences.push(format!(
                "no face of {axis} falls on the switching surface at {at}: use an even count or grade the axis toward it"
            ));
        }
    }

    /// Compares the diffusion that the cells add with the noise, each axis in units of its variance.
    pub(super) fn numerical_diffusion(
        &mut self,
        diffusion: &[f64],
        noise: &[f64],
        moments: &[Moments],
    ) {
        let in_units_of_spread = |values: &[f64]| -> f64 {
            let pairs = values.iter().zip(moments);
            pairs
                .map(|(value, moment)| value / moment.standard_deviation.powi(2))
                .sum()
        };
        let ratio = in_units_of_spread(diffusion) / in_units_of_spread(noise);
        if ratio > NUMERICAL_DIFFUSION_LIMIT {
            self.sentences.push(format!(
                "the cells add {:.0} % to the noise (numerical diffusion): use more cells or a longer map step",
                100.0 * ratio
            ));
        }
    }

    pub(super) fn escaping(&mut self, rate: f64, share: f64) {
        self.sentences.push(format!(
            "mass leaves Ω at a rate of {rate:.3e} per unit time ({:.1} % within one relaxation time): the densities \
             are quasi-stationary, conditioned on staying; widen the ranges",
            100.0 * share
        ));
    }

    pub(super) fn no_steady_state(&mut self, rate: f64, relaxation_time: Option<f64>, limit: f64) {
        let why = match relaxation_time {
            Some(time) => format!(
                "{:.0} % of the mass leaves within one relaxation time ({time:.3}), the limit is {:.0} %",
                100.0 * rate * time,
                100.0 * limit
            ),
            None => "most of the mass leaves within one map step".to_owned(),
        };
        self.sentences.push(format!(
            "no steady state in Ω: mass leaves at a rate of {rate:.3e} per unit time; {why}"
        ));
    }

    pub(super) fn not_converged(&mut self, error: f64) {
        self.sentences.push(format!(
            "the solver stopped before its tolerance, with an estimated error of {error:.1e}"
        ));
    }

    pub(super) fn several_classes(&mut self, classes: &[ClassShare]) {
        let words: Vec<String> = classes
            .iter()
            .map(|class| {
                let centre = self.space.centre(class.representative);
                let place: Vec<String> = centre.iter().map(|x| format!("{x:.3}")).collect();
                format!(
                    "{} cells around ({}) holding {:.1} %",
                    class.cells,
                    place.join(", "),
                    100.0 * class.share
                )
            })
            .collect();
        self.sentences.push(format!(
            "{} separate steady states, so which one is reached depends on the start: {}",
            classes.len(),
            words.join("; ")
        ));
    }

    /// Says so when halving the time step shifts what it should not, beyond the sampling error or a stated share.
    pub(super) fn time_step(
        &mut self,
        time_step: f64,
        bias: Option<&StepBias>,
        sampling_error: f64,
    ) {
        let Some(bias) = bias.filter(|bias| bias.certain() > sampling_error.min(TOLERATED_BIAS))
        else {
            return;
        };
        let quantity = match bias.quantity {
            BiasedQuantity::Variance(axis) => format!("the variance of {}", self.axis(axis)),
            BiasedQuantity::Energy => "the mean energy".to_owned(),
            BiasedQuantity::SurfaceShare(axis) => {
                format!(
                    "the mass beside the switching surface of {}",
                    self.axis(axis)
                )
            }
        };
        self.sentences.push(format!(
            "the time step {time_step:.4} shifts {quantity} by about {:+.1} % (± {:.1} %; found by halving it on a sample): \
             use a shorter one, `time_step = \"auto\"`, or `integrator = \"heun\"`",
            100.0 * bias.relative,
            100.0 * bias.standard_error
        ));
    }

    pub(super) fn outside(&mut self, share: f64) {
        self.sentences.push(format!(
            "the trajectories spend {:.1} % of their time outside Ω: the densities are conditioned on being inside; widen the \
             ranges",
            100.0 * share
        ));
    }

    /// Free trajectories that do not stay: a share of them ran away, or a share of their time is spent outside.
    pub(super) fn nothing_stays(&mut self, runaways: f64, outside: f64, limit: f64) {
        self.sentences.push(format!(
            "no steady state in Ω: {:.0} % of the trajectories ran away, the others spent {:.0} % of their time outside; the \
             limit is {:.0} %",
            100.0 * runaways,
            100.0 * outside,
            100.0 * limit
        ));
    }

    pub(super) fn short_burn_in(&mut self, burn_in: f64, time: f64) {
        self.sentences.push(format!(
            "the burn-in of {burn_in:.3} is short against the autocorrelation time of {time:.3}: the start is not forgotten"
        ));
    }

    pub(super) fn unresolved_relaxation(&mut self, time: f64) {
        self.sentences.push(format!(
            "the autocorrelation time, {time:.1} or more, is too long to be measured: trajectories may not have found all \
             states, and errors may be too small"
        ));
    }

    pub(super) fn replicates(&mut self, usable: usize, wanted: usize) {
        if usable == 0 {
            self.sentences.push(
                "the sampling error could not be estimated: leaving out a group of samples leaves no steady state"
                    .to_owned(),
            );
        } else if usable < wanted {
            self.sentences.push(format!(
                "the sampling error rests on {usable} of {wanted} groups of samples"
            ));
        }
    }
}

/// Whether the lower and upper end of each axis is a wall that the system cannot pass, all along the sweep.
pub(super) fn closed_ends(systems: &[Arc<dyn System>], space: &CellSpace) -> Vec<[bool; 2]> {
    let axes = space.axes().iter().enumerate();
    axes.map(|(axis, cells)| {
        let bounds = || systems.iter().map(move |system| system.bounds(axis));
        [
            bounds().all(|b| b.is_some_and(|(lower, _)| cells.from() <= lower)),
            bounds().all(|b| b.is_some_and(|(_, upper)| cells.to() >= upper)),
        ]
    })
    .collect()
}

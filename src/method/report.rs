//! A report in the making: numbers of a solve, and findings by limits that are the same for all methods and stand here
//! once.

use super::Problem;
use super::ends::{self, AtEnds};
use super::measures::{Cells, broken, derive};
use super::tails::{self, Beyond};
use crate::continuation::measure::{
    DEVIATION, EDGE_MASS, ESCAPE_RATE, MEAN, NEGATIVE_MASS, NUMERICAL_DIFFUSION,
};
use crate::continuation::{
    Finding, Measure, PointStatus, ShiftedQuantity, Solution, SolveReport, SteadyClass,
};
use crate::density::{EstimatedDensity, EstimatedMoments, Moments};
use crate::generator::Resolution;
use crate::monte_carlo::{BiasedQuantity, StepBias, TOLERATED_BIAS};
use crate::space::CellSpace;
use crate::stationary::ClassShare;

/// Negative mass (a sign of wiggles that the grid does not resolve) above which it is worth a word.
const NEGATIVE_MASS_LIMIT: f64 = 1e-3;

/// Mass in the cells at an end of a range above which the range is said to be too narrow.
const EDGE_MASS_LIMIT: f64 = 1e-3;

/// Relative increase of the noise by numerical diffusion above which it is worth a word.
const NUMERICAL_DIFFUSION_LIMIT: f64 = 0.1;

/// Share of the mass that may leave within one relaxation time without a word.
pub(super) const QUIET_ESCAPE: f64 = 1e-3;

/// Change of a density along an axis of modes by its last modes, in total variation, above which it is worth a word.
const SERIES_LIMIT: f64 = 0.01;

/// A burn-in below this many autocorrelation times does not forget the start.
const SHORT_BURN_IN: f64 = 5.0;

/// A report in the making. Findings are told in the order in which they were looked for.
#[derive(Debug)]
pub(super) struct Reporter<'a> {
    problem: &'a Problem,
    /// What is known so far.
    pub(super) report: SolveReport,
    /// What is found at the ends of each axis.
    at_ends: AtEnds,
    /// Share of the mass that leaves within one relaxation time.
    leak: f64,
    /// The largest density at an open end, over the largest along the axis.
    level: f64,
}

/// Shares of the mass that a solution may lack.
#[derive(Debug, Clone, Copy)]
pub(super) struct Missing {
    /// What lies beyond the ends of the ranges.
    pub(super) beyond: f64,
    /// What leaves within one relaxation time.
    pub(super) leak: f64,
    /// The largest density at an open end, over the largest along the axis.
    pub(super) level: f64,
}

impl<'a> Reporter<'a> {
    /// The report of a solve by a method of this name, of which nothing is to be said yet.
    pub(super) fn new(method: &'static str, problem: &'a Problem) -> Self {
        Self {
            problem,
            report: SolveReport::solved(method),
            at_ends: AtEnds::default(),
            leak: 0.0,
            level: 0.0,
        }
    }

    /// Shares of the mass that the ends of the ranges may have cut off: what lies beyond them, and what leaves within
    /// one relaxation time, which is missing inside.
    pub(super) fn missing(&self) -> Missing {
        Missing {
            beyond: self
                .at_ends
                .beyond
                .iter()
                .flatten()
                .map(|end| end.mass)
                .sum(),
            leak: self.leak,
            level: self.level,
        }
    }

    pub(super) fn tell(&mut self, finding: Finding) {
        self.report.findings.push(finding);
    }

    fn space(&self) -> &'a CellSpace {
        self.problem.space()
    }

    fn escape_rate(&self) -> f64 {
        self.report.of(&ESCAPE_RATE, "").unwrap_or(0.0)
    }

    /// Means and standard deviations of the axes, of the quantities that are averaged, and of axes at phases of a
    /// forcing; those of angles and of a phase, which depend on where the turn is cut, are left out. What may lie
    /// beyond the ends of the ranges adds to their errors; where nothing bounds that, there is none.
    pub(super) fn moments(&mut self, estimated: &[EstimatedMoments]) {
        let ends = ends::beyond(self.space(), (&self.at_ends, self.leak), estimated);
        let family = self.problem.family();
        let axes = self.space().dimension();
        let lines: Vec<usize> = family.states_on_lines().map(|(index, _)| index).collect();
        let told = estimated.iter().enumerate();
        let told = told.filter(|(index, _)| *index >= axes || lines.contains(index));
        let averaged = axes + family.questions.averaged.len();
        let phases: Vec<usize> = family.at_phases().map(|(at, _)| at.axis).collect();
        for (name, (index, one)) in family.averages().zip(told) {
            let at_phase = index.checked_sub(averaged);
            let of = at_phase.and_then(|number| phases.get(number).copied());
            let beyond = ends.of(of.unwrap_or(index), &one.moments);
            let numbers = [
                (
                    &MEAN,
                    one.moments.mean,
                    one.errors.map(|errors| errors.mean + beyond.mean),
                ),
                (
                    &DEVIATION,
                    one.moments.standard_deviation,
                    // A variance that came out below zero tells no deviation.
                    one.errors
                        .filter(|_| one.moments.standard_deviation > 0.0)
                        .map(|errors| errors.standard_deviation + beyond.standard_deviation),
                ),
            ];
            for (kind, value, error) in numbers {
                self.report.put(Measure {
                    error: error.filter(|error| error.is_finite()),
                    ..kind.measure(name, value)
                });
            }
        }
    }

    /// By how much what may lie beyond the ends shifts the mean along each axis, from the moments of the axes.
    pub(super) fn shifts(&self, of_axes: &[EstimatedMoments]) -> Vec<f64> {
        let ends = ends::beyond(self.space(), (&self.at_ends, self.leak), of_axes);
        let axes = of_axes.iter().take(self.space().dimension()).enumerate();
        axes.map(|(axis, one)| ends.of(axis, &one.moments).mean)
            .collect()
    }

    /// Nothing lies beyond the ends for moments: they are those of the whole density.
    pub(super) fn is_whole(&mut self) {
        self.at_ends
            .beyond
            .iter_mut()
            .for_each(|ends| *ends = [Beyond::default(); 2]);
    }

    /// Says that the deviation along an axis rests on a tail, or does not exist, unless that is told already.
    pub(super) fn heavy_tail(&mut self, axis: usize, power: f64) {
        let is_told =
            |one: &Finding| matches!(one, Finding::HeavyTail { axis: other, .. } if *other == axis);
        if !self.report.findings.iter().any(is_told) {
            self.tell(Finding::HeavyTail { axis, power });
        }
    }

    /// The solution with these densities, and with the measures that are derived from them.
    pub(super) fn solution(
        mut self,
        densities: Vec<EstimatedDensity>,
        cells: Option<&Cells<'_>>,
    ) -> Solution<'static> {
        let measures = derive(self.problem.subject(), &densities, cells);
        self.report.measures.extend(measures);
        Solution {
            densities,
            ..Solution::without_density(self.report)
        }
    }

    /// Mass in the cells at the ends of each axis that are not walls of the system.
    pub(super) fn edge_mass(&mut self, mass: &[f64], closed: &[[bool; 2]]) {
        let tails = tails::tails(self.space(), mass, closed);
        let levels = tails.iter().flatten().map(|end| end.level);
        self.level = levels.fold(0.0, f64::max);
        self.at_ends = AtEnds::new(self.space(), mass, &tails);
        for (axis, ends) in tails.into_iter().enumerate() {
            let mass = ends[0].outer + ends[1].outer;
            let powers = ends.iter().filter_map(|end| end.beyond.heavy());
            if let Some(power) = powers.min_by(f64::total_cmp) {
                self.tell(Finding::HeavyTail { axis, power });
            }
            self.report
                .add(&EDGE_MASS, self.problem.family().axis(axis), mass);
            if mass > EDGE_MASS_LIMIT {
                let cells = &self.space().axes()[axis];
                let range = [cells.from(), cells.to()];
                self.tell(Finding::EdgeMass { axis, mass, range });
            }
        }
    }

    /// Negative mass of the cells, and the largest of the watched densities: wiggles along an axis that is summed
    /// over do not reach those.
    pub(super) fn negative_mass(&mut self, cells: f64, watched: f64) {
        self.report.add(&NEGATIVE_MASS, "", cells);
        if watched > NEGATIVE_MASS_LIMIT {
            self.tell(Finding::NegativeDensity { mass: watched });
        } else if cells > NEGATIVE_MASS_LIMIT {
            self.tell(Finding::NegativeCells {
                mass: cells,
                watched,
            });
        }
    }

    /// Densities along axes of modes, each with what its last modes change, in total variation.
    pub(super) fn series(&mut self, changes: &[(usize, f64)]) {
        for axis in 0..self.space().dimension() {
            let own = changes.iter().filter(|(changed, _)| *changed == axis);
            let change = own.map(|(_, change)| *change).fold(0.0, f64::max);
            if change > SERIES_LIMIT {
                self.tell(Finding::UnresolvedSeries { axis, change });
            }
        }
    }

    /// By how much more modes would change what is watched, where that is too much.
    pub(super) fn few_modes(&mut self, change: Option<f64>) {
        if let Some(change) = change {
            self.tell(Finding::FewModes { change });
        }
    }

    /// Whether the cells along a noisy axis are fine enough.
    pub(super) fn resolution(&mut self, judged: &Resolution) {
        let (axis, peclet) = (judged.axis, judged.fitted_peclet);
        if peclet > 1.0 {
            self.tell(Finding::WideCells { axis, peclet });
        }
        if let Some(widths) = judged.layer.filter(|&layer| layer > 1.0) {
            self.tell(Finding::SmearedKink { axis, widths });
        }
        for &at in &judged.surfaces_off_faces {
            self.tell(if judged.jumps_off_faces.contains(&at) {
                Finding::JumpInsideCells { axis, at }
            } else {
                Finding::SurfaceOffFaces { axis, at }
            });
        }
    }

    /// The diffusion that the cells add, compared with the noise, each axis in units of its variance: the relative
    /// increase of the noise.
    pub(super) fn numerical_diffusion(
        &mut self,
        diffusion: Vec<f64>,
        noise: &[f64],
        moments: &[Moments],
    ) -> f64 {
        let in_units_of_spread = |values: &[f64]| -> f64 {
            let pairs = values.iter().zip(moments);
            pairs
                .map(|(value, moment)| value / moment.standard_deviation.powi(2))
                .sum()
        };
        let share = in_units_of_spread(&diffusion) / in_units_of_spread(noise);
        for (axis, value) in diffusion.into_iter().enumerate() {
            let name = self.problem.family().axis(axis);
            self.report.add(&NUMERICAL_DIFFUSION, name, value);
        }
        if share > NUMERICAL_DIFFUSION_LIMIT {
            self.tell(Finding::NumericalDiffusion { share });
        }
        share
    }

    /// Balances of power that the masses break.
    pub(super) fn balances(&mut self, cells: &Cells<'_>) {
        self.report.findings.extend(broken(cells));
    }

    /// Says so when a share of the mass that is worth a word leaves within one relaxation time.
    pub(super) fn escaping(&mut self, share: f64) {
        self.leak = share;
        if share > QUIET_ESCAPE {
            self.leaks();
            let rate = self.escape_rate();
            self.tell(Finding::Escaping { share, rate });
        }
    }

    /// Says so when trajectories spend a share of their time outside Ω that is worth a word.
    pub(super) fn outside(&mut self, share: f64) {
        if share > QUIET_ESCAPE {
            self.leaks();
            self.tell(Finding::Outside { share });
        }
    }

    fn leaks(&mut self) {
        // A solve that failed is worse than a leak.
        if self.report.status == PointStatus::Solved {
            self.report.status = PointStatus::Escaping;
        }
    }

    /// The share of the mass that leaves within one relaxation time (none where that time is not known); `None` where
    /// it is more than `limit`, and there is no steady state.
    pub(super) fn escaping_share(
        &mut self,
        relaxation_time: Option<f64>,
        limit: f64,
    ) -> Option<f64> {
        let rate = self.escape_rate();
        let Some(relaxation_time) = relaxation_time else {
            return Some(0.0);
        };
        let share = rate * relaxation_time;
        if share > limit {
            self.no_steady_state(Finding::NoSteadyState {
                rate,
                relaxation_time,
                limit,
            });
            return None;
        }
        Some(share)
    }

    /// There is no steady state, for the reason that the finding gives.
    pub(super) fn no_steady_state(&mut self, why: Finding) {
        self.report.status = PointStatus::NoSteadyState;
        self.tell(why);
    }

    /// The solver stopped before its tolerance.
    pub(super) fn not_converged(&mut self, error: f64) {
        self.report.status = PointStatus::NotConverged;
        self.tell(Finding::NotConverged { error });
    }

    /// Several closed classes of cells.
    pub(super) fn several_classes(&mut self, classes: &[ClassShare]) {
        self.report.status = PointStatus::SeveralClasses;
        let class = |class: &ClassShare| SteadyClass {
            cells: class.cells,
            share: class.share,
            centre: self.space().centre(class.representative),
        };
        let classes = classes.iter().map(class).collect();
        self.tell(Finding::SeveralClasses { classes });
    }

    /// The bias of a time step. Says so when halving the step shifts what it should not, beyond the sampling error or a
    /// stated share.
    pub(super) fn time_step(
        &mut self,
        time_step: f64,
        bias: Option<&StepBias>,
        sampling_error: f64,
    ) {
        if let Some(bias) = bias.filter(|bias| bias.certain() > sampling_error.min(TOLERATED_BIAS))
        {
            self.tell(Finding::StepBias {
                quantity: match bias.quantity {
                    BiasedQuantity::Variance(axis) => ShiftedQuantity::Variance(axis),
                    BiasedQuantity::Energy => ShiftedQuantity::Energy,
                    BiasedQuantity::SurfaceShare(axis) => ShiftedQuantity::SurfaceMass(axis),
                },
                relative: bias.relative,
                standard_error: bias.standard_error,
                time_step,
            });
        }
    }

    /// How many groups of samples the sampling error rests on.
    pub(super) fn replicates(&mut self, usable: usize, wanted: usize) {
        if usable == 0 {
            self.tell(Finding::NoReplicates);
        } else if usable < wanted {
            self.tell(Finding::FewReplicates { usable, wanted });
        }
    }

    /// Whether trajectories forget their start in the time they have for it.
    pub(super) fn burn_in(&mut self, burn_in: f64, time: f64, is_resolved: bool) {
        if !is_resolved {
            self.tell(Finding::UnresolvedRelaxation { time });
        }
        if burn_in < SHORT_BURN_IN * time {
            self.tell(Finding::ShortBurnIn { burn_in, time });
        }
    }
}

/// Largest share of the mass that may leave Ω within one relaxation time, whatever the method.
pub(super) const ESCAPE_LIMIT: f64 = 0.5;

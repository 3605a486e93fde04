//! Findings in sentences, for the columns `warnings`, for `run.json` and for the terminal.

use super::number::format_with_error;
use super::passage_sentences::{passage_in_words, passage_name, visits_in_words};
use crate::continuation::{Finding, ShiftedQuantity, SteadyClass};
use crate::system::{ExponentMethod, Family};

/// Steady states that are named one by one.
const CLASSES_NAMED: usize = 4;

/// What a finding says, in a sentence without a full stop.
pub fn finding_in_words(family: &Family, finding: &Finding) -> String {
    escape_in_words(finding)
        .or_else(|| cells_in_words(family, finding))
        .unwrap_or_else(|| solve_in_words(family, finding))
}

/// All findings of a solve as one text.
pub(super) fn sentences(family: &Family, findings: &[Finding]) -> String {
    let sentences = findings
        .iter()
        .map(|finding| finding_in_words(family, finding));
    sentences.collect::<Vec<_>>().join("; ")
}

/// Whether mass stays in Ω.
fn escape_in_words(finding: &Finding) -> Option<String> {
    Some(match *finding {
        Finding::Escaping { share, rate } => format!(
            "mass leaves Ω at a rate of {rate:.3e} per unit time ({:.1} % within one relaxation time): the densities \
             are quasi-stationary, conditioned on staying; widen the ranges",
            100.0 * share
        ),
        Finding::NoSteadyState {
            rate,
            relaxation_time,
            limit,
        } => format!(
            "no steady state in Ω: mass leaves at a rate of {rate:.3e} per unit time; {} of the mass leaves within \
             one relaxation time ({relaxation_time:.3}), the limit is {:.0} %",
            // The product of rate and time is a share only while it is small.
            match rate * relaxation_time {
                share if share < 1.0 => format!("{:.0} %", 100.0 * share),
                _ => "nearly all".to_owned(),
            },
            100.0 * limit
        ),
        Finding::LeavesAtOnce { rate } => format!(
            "no steady state in Ω: mass leaves at a rate of {rate:.3e} per unit time; most of the mass leaves within one \
             map step"
        ),
        Finding::NothingStays {
            runaways,
            outside,
            limit,
        } => format!(
            "no steady state in Ω: {:.0} % of the trajectories ran away, the others spent {:.0} % of their time outside; the \
             limit is {:.0} %",
            100.0 * runaways,
            100.0 * outside,
            100.0 * limit
        ),
        Finding::Outside { share } => format!(
            "the trajectories spend {:.1} % of their time outside Ω: the densities are conditioned on being inside; widen the \
             ranges",
            100.0 * share
        ),
        _ => return None,
    })
}

/// Whether the cells are wide enough and fine enough.
fn cells_in_words(family: &Family, finding: &Finding) -> Option<String> {
    Some(match *finding {
        Finding::Absorbed { axis, at, exponent } => {
            let name = family.axis(axis);
            let power = if exponent.is_finite() {
                format!("like the power {exponent:.3} of the distance")
            } else {
                "faster than any power of the distance".to_owned()
            };
            format!(
                "no stationary density: the noise dies at {name} = {at}, where the density would grow {power}; all that \
                 comes near is absorbed there"
            )
        }
        Finding::EdgeMass { axis, mass, range } => format!(
            "{:.2} % of the mass lies in the outermost cells of {}: widen its range beyond [{}, {}]",
            100.0 * mass,
            family.axis(axis),
            range[0],
            range[1],
        ),
        Finding::NaturalEnd { axis, mass, at } => {
            let axis = family.axis(axis);
            format!(
                "{:.2} % of the mass lies in the cells beside {axis} = {at}, where the noise dies and the density goes \
                 like a power of the distance, which cells do not follow: narrow them toward it by \
                 `cells.{axis}.grade`, or take its logarithm as the state",
                100.0 * mass
            )
        }
        Finding::HeavyTail { axis, power } => {
            let axis = family.axis(axis);
            format!(
                "the density falls along {axis} like the power {power:.1} of the distance where its range ends: the \
                 standard deviation of {axis} rests on what is beyond, or does not exist, and has no error"
            )
        }
        Finding::EndlessMean { average } => {
            let name = family
                .questions
                .averaged
                .get(average)
                .map_or("", |one| one.name());
            format!(
                "the mean of {name} has no error: what {name} adds to it does not become less toward an end of the \
                 axis, so that it does not exist, or is not known to"
            )
        }
        Finding::NegativeDensity { mass } => format!(
            "{:.2} % of the mass of a watched density is negative: it has wiggles that the cells do not resolve; use more cells",
            100.0 * mass
        ),
        Finding::NegativeCells { mass, watched } => format!(
            "{:.1} % of the mass of single cells is negative: wiggles that the cells do not resolve; the watched densities \
             have less than {watched:.0e} of it",
            100.0 * mass
        ),
        Finding::WideCells { axis, peclet } => format!(
            "the cells of {} are too wide for the noise (cell Péclet number of damping and friction {}): \
             use more cells",
            family.axis(axis),
            if peclet < 1e5 {
                format!("{peclet:.1}")
            } else {
                format!("{peclet:.1e}")
            }
        ),
        Finding::BalanceBroken {
            axis,
            relative,
            error,
        } => format!(
            "a balance that the equations imply along {} is broken by {:.2} ± {:.2} % (of a velocity: power in and power out; of \
             a displacement x: E[x'^2] and -E[x x'']), so that densities and moments err by more than is stated: use more cells",
            family.axis(axis),
            100.0 * relative,
            100.0 * error
        ),
        Finding::UnresolvedSeries { axis, change } => {
            let axis = family.axis(axis);
            format!(
                "the density along {axis} has not converged in the modes: the last two of them change it by {change:.1e} in total variation, \
                 so that its details are not certain; give more `modes` along {axis}: steep edges take about a hundred"
            )
        }
        Finding::FewModes { change } => format!(
            "too few modes: with more of them a watched density changes by {change:.1e} of its largest value on coarse cells, so that its \
             peaks are not certain; give more `modes`, or `count` for cells"
        ),
        Finding::SmearedKink { axis, widths } => {
            let axis = family.axis(axis);
            format!(
                "the cells of {axis} at the switching surface are {widths:.0} times as wide as the layer that holds the \
                 kink of the density, so the kink is smeared: grade = \"auto\" on {axis} resolves it"
            )
        }
        Finding::JumpInsideCells { axis, at } => {
            let axis = family.axis(axis);
            format!(
                "the drift jumps at {axis} = {at}, inside cells, where the kink of the density is not seen: give an \
                 even count or grade {axis} toward it; where it moves along the sweep, take as {axis} the distance \
                 from it (for a belt, the velocity relative to it), so that it stands still"
            )
        }
        Finding::SurfaceOffFaces { axis, at } => format!(
            "no face of {} falls on the switching surface at {at}: use an even count or grade the axis toward it",
            family.axis(axis)
        ),
        Finding::NumericalDiffusion { share } => format!(
            "the cells add {:.0} % to the noise (numerical diffusion): use more cells or a longer map step",
            100.0 * share
        ),
        _ => return None,
    })
}

/// How the solver fared, and the trajectories.
fn solve_in_words(family: &Family, finding: &Finding) -> String {
    match *finding {
        Finding::NotConverged { error } => {
            let uncounted = if finding.is_too_far_to_count() {
                ": no peaks are counted in such a density"
            } else {
                ""
            };
            format!(
                "the solver stopped before its tolerance, with an estimated error of {error:.1e}{uncounted}"
            )
        }
        Finding::SeveralClasses { ref classes } => {
            let named = classes.iter().take(CLASSES_NAMED).map(class_in_words);
            let mut words = named.collect::<Vec<_>>().join("; ");
            if classes.len() > CLASSES_NAMED {
                words += &format!("; and {} others", classes.len() - CLASSES_NAMED);
            }
            format!(
                "{} separate steady states, so which one is reached depends on the start: {words}",
                classes.len(),
            )
        }
        Finding::StepBias {
            quantity,
            relative,
            standard_error,
            time_step,
        } => format!(
            "the time step {time_step:.4} shifts {} by about {:+.1} % (± {:.1} %; found by halving it on a sample): \
             use a shorter one, `time_step = \"auto\"`, or `integrator = \"heun\"`",
            quantity_in_words(family, quantity),
            100.0 * relative,
            100.0 * standard_error
        ),
        Finding::UnresolvedRelaxation { time } => format!(
            "the autocorrelation time, {time:.1} or more, is too long to be measured: trajectories may not have found all \
             states, and errors may be too small"
        ),
        Finding::ShortBurnIn { burn_in, time } => format!(
            "the burn-in of {burn_in:.3} is short against the autocorrelation time of {time:.3}: the start is not forgotten"
        ),
        Finding::NoReplicates => {
            "the sampling error could not be estimated: leaving out a group of samples leaves no steady state"
                .to_owned()
        }
        Finding::FewReplicates { usable, wanted } => {
            format!("the sampling error rests on {usable} of {wanted} groups of samples")
        }
        Finding::FewSlowModes { known, wanted } => format!(
            "{known} of {wanted} slow modes are known: finer cells, or wider ranges, know more"
        ),
        Finding::NoSpectrum => "spectra were not worked out".to_owned(),
        Finding::SpectrumCut { frequency } => format!(
            "a power spectrum is not known to a tenth from the frequency {frequency:.3} on: finer cells know more of it, or \
             `spectrum.to` leaves it out"
        ),
        Finding::NoVisits { visits, is_endless } => visits_in_words(family, visits, is_endless),
        Finding::NoPassage { passage, fault } => passage_in_words(family, passage, fault),
        Finding::PassageCut {
            passage,
            share,
            longest,
        } => {
            let name = passage_name(family, passage);
            format!(
                "passage `{name}`: {:.2} % of the paths still went on at {longest:.4}, when they were given up; what comes after is taken for exponential",
                100.0 * share
            )
        }
        Finding::PointMass { exponent, error } => {
            let (exponent, error) = format_with_error(exponent, error);
            format!(
                "the fixed point {} attracts almost every path beside it (largest Lyapunov exponent {exponent} ± {error}): the steady state \
                 is a point mass, and no density was looked for; one that lasts long elsewhere is found without `[exponent]`",
                fixed_point(family)
            )
        }
        Finding::NoFixedPoint { axis, drift, noise } => format!(
            "no Lyapunov exponent: {} is no fixed point, since along {} the drift is {drift:.3e} there and the noise {noise:.3e}",
            fixed_point(family),
            family.axis(axis)
        ),
        Finding::NoExponent => match fixed_point_in_words(family) {
            Some(point) => {
                format!("no Lyapunov exponent: drift or noise has no derivative at {point}")
            }
            None => match family.questions.largest_exponent {
                Some(ExponentMethod::Trajectories) => {
                    "no Lyapunov exponent: trajectories run away".to_owned()
                }
                _ => "no Lyapunov exponent: cells and harmonics do not resolve the directions in which deviations point; `exponent.method = \"trajectories\"` needs neither".to_owned(),
            },
        },
        Finding::Told(ref text) => text.clone(),
        // The others are worded above.
        _ => finding.kind().0.to_owned(),
    }
}

/// The state of which the exponent is wanted, such as `x = 0, y = 0`; `None` where none is.
pub(crate) fn fixed_point_in_words(family: &Family) -> Option<String> {
    let state = family.questions.fixed_point.as_deref()?.iter().enumerate();
    let named = state.map(|(axis, x)| format!("{} = {x}", family.axis(axis)));
    Some(named.collect::<Vec<_>>().join(", "))
}

fn fixed_point(family: &Family) -> String {
    fixed_point_in_words(family).unwrap_or_default()
}

fn class_in_words(class: &SteadyClass) -> String {
    let place: Vec<String> = class.centre.iter().map(|x| format!("{x:.3}")).collect();
    format!(
        "{} cells around ({}) holding {:.1} %",
        class.cells,
        place.join(", "),
        100.0 * class.share
    )
}

fn quantity_in_words(family: &Family, quantity: ShiftedQuantity) -> String {
    match quantity {
        ShiftedQuantity::Variance(axis) => format!("the variance of {}", family.axis(axis)),
        ShiftedQuantity::Energy => "the mean energy".to_owned(),
        ShiftedQuantity::SurfaceMass(axis) => {
            format!(
                "the mass beside the switching surface of {}",
                family.axis(axis)
            )
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::system::test_families::coulomb;

    #[test]
    fn many_steady_states_are_counted_and_the_first_named() {
        let class = SteadyClass {
            cells: 3,
            share: 0.001,
            centre: vec![0.5, -0.25],
        };
        let classes = vec![class; 900];
        let words = finding_in_words(&coulomb(), &Finding::SeveralClasses { classes });
        assert!(words.starts_with("900 separate steady states"));
        assert!(
            words.ends_with("; and 896 others") && words.len() < 400,
            "{words}"
        );
    }
}

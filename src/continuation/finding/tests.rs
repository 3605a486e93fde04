//! Every finding comes back from its parts.

use super::*;

/// One of every kind, for tests. The match makes a new kind appear here.
pub(crate) fn every_finding() -> Vec<Finding> {
    use Finding as F;
    let class = |share| SteadyClass {
        cells: 7,
        share,
        centre: vec![-1.5, 0.25],
    };
    let shifted = |quantity| F::StepBias {
        quantity,
        relative: -0.1 / 3.0,
        standard_error: 1e-5,
        time_step: 0.01,
    };
    let after = |finding: &F| match finding {
        F::Escaping { .. } => Some(F::NoSteadyState {
            rate: 0.1,
            relaxation_time: 20.0,
            limit: 0.5,
        }),
        F::NoSteadyState { .. } => Some(F::Absorbed {
            axis: 1,
            at: 0.0,
            exponent: f64::NEG_INFINITY,
        }),
        F::Absorbed { .. } => Some(F::LeavesAtOnce { rate: 3.0 }),
        F::LeavesAtOnce { .. } => Some(F::NothingStays {
            runaways: 0.7,
            outside: 0.1,
            limit: 0.5,
        }),
        F::NothingStays { .. } => Some(F::Outside { share: 0.02 }),
        F::Outside { .. } => Some(F::SeveralClasses {
            classes: vec![class(0.75), class(0.25)],
        }),
        F::SeveralClasses { .. } => Some(F::NotConverged {
            error: f64::INFINITY,
        }),
        F::NotConverged { .. } => Some(F::EdgeMass {
            axis: 1,
            mass: 0.003,
            range: [-8.0, 8.0],
        }),
        F::EdgeMass { .. } => Some(F::NaturalEnd {
            axis: 1,
            mass: 0.02,
            at: 0.0,
        }),
        F::NaturalEnd { .. } => Some(F::HeavyTail {
            axis: 1,
            power: 2.5,
        }),
        F::HeavyTail { .. } => Some(F::EndlessMean { average: 1 }),
        F::EndlessMean { .. } => Some(F::NegativeDensity { mass: 0.004 }),
        F::NegativeDensity { .. } => Some(F::NegativeCells {
            mass: 0.08,
            watched: 3e-8,
        }),
        F::NegativeCells { .. } => Some(F::WideCells {
            axis: 0,
            peclet: 1.25,
        }),
        F::WideCells { .. } => Some(F::SmearedKink {
            axis: 1,
            widths: 3.5,
        }),
        F::SmearedKink { .. } => Some(F::BalanceBroken {
            axis: 1,
            relative: -0.03,
            error: 0.002,
        }),
        F::BalanceBroken { .. } => Some(F::UnresolvedSeries {
            axis: 1,
            change: 0.03,
        }),
        F::UnresolvedSeries { .. } => Some(F::FewModes { change: 0.16 }),
        F::FewModes { .. } => Some(F::SurfaceOffFaces { axis: 1, at: 0.1 }),
        F::SurfaceOffFaces { .. } => Some(F::JumpInsideCells { axis: 1, at: 0.1 }),
        F::JumpInsideCells { .. } => Some(F::NumericalDiffusion { share: 0.2 }),
        F::NumericalDiffusion { .. } => Some(shifted(ShiftedQuantity::Variance(0))),
        F::StepBias { quantity, .. } => Some(match quantity {
            ShiftedQuantity::Variance(_) => shifted(ShiftedQuantity::Energy),
            ShiftedQuantity::Energy => shifted(ShiftedQuantity::SurfaceMass(1)),
            ShiftedQuantity::SurfaceMass(_) => F::UnresolvedRelaxation { time: 1e4 },
        }),
        F::UnresolvedRelaxation { .. } => Some(F::ShortBurnIn {
            burn_in: 1.0,
            time: 9.0,
        }),
        F::ShortBurnIn { .. } => Some(F::NoReplicates),
        F::NoReplicates => Some(F::FewReplicates {
            usable: 6,
            wanted: 8,
        }),
        F::FewReplicates { .. } => Some(F::FewSlowModes {
            known: 2,
            wanted: 6,
        }),
        F::FewSlowModes { .. } => Some(F::NoPassage {
            passage: 0,
            fault: PassageFault::Nowhere,
        }),
        F::NoPassage { fault, .. } => {
            let faults = PassageFault::CODES.into_iter().map(|(fault, _)| fault);
            let next = faults.skip_while(|one| *one != *fault).nth(1);
            Some(next.map_or_else(
                || F::NoVisits {
                    visits: 1,
                    is_endless: true,
                },
                |fault| F::NoPassage { passage: 1, fault },
            ))
        }
        F::NoVisits { .. } => Some(F::PassageCut {
            passage: 1,
            share: 0.25,
            longest: 1e4,
        }),
        F::PassageCut { .. } => Some(F::PointMass {
            exponent: -0.02,
            error: 1e-15,
        }),
        F::PointMass { .. } => Some(F::NoFixedPoint {
            axis: 1,
            drift: -0.5,
            noise: 0.1,
        }),
        F::NoFixedPoint { .. } => Some(F::NoExponent),
        F::NoExponent => Some(F::NoSpectrum),
        F::NoSpectrum => Some(F::SpectrumCut { frequency: 12.5 }),
        F::SpectrumCut { .. } => Some(F::Told("as it was told; twice".to_owned())),
        F::Told(_) => None,
    };
    let first = F::Escaping {
        share: 0.012,
        rate: 1e-4 / 3.0,
    };
    std::iter::successors(Some(first), after).collect()
}

#[test]
fn every_finding_but_sentences_comes_back_from_its_parts() {
    let mut kinds = Vec::new();
    for finding in every_finding() {
        let (code, axis, numbers) = finding.parts();
        let back = Finding::from_parts(code, axis, &numbers);
        match finding {
            Finding::Told(_) => assert_eq!(back, None),
            _ => assert_eq!(back, Some(finding)),
        }
        assert!(!kinds.contains(&(code, axis)), "{code} is two kinds");
        kinds.push((code, axis));
    }
}

#[test]
fn parts_of_no_finding_are_refused() {
    for (code, axis, numbers) in [
        ("escaping", None, vec![0.1]),
        ("escaping", Some(0), vec![0.1, 0.2]),
        ("edge-mass", None, vec![0.1, -1.0, 1.0]),
        ("several-classes", None, vec![2.0, 1.0, 1.0, 1.0]),
        ("several-classes", None, vec![f64::NAN]),
        ("magic", None, vec![1.0, 2.0, 3.0]),
    ] {
        assert_eq!(Finding::from_parts(code, axis, &numbers), None, "{code}");
    }
}

//! Findings as they are stored, a code with an axis and numbers, and back.

use super::{Finding, PassageFault, ShiftedQuantity, SteadyClass};

/// What is stored of a finding: its code, the axis it speaks of, and its numbers.
type Parts = (&'static str, Option<usize>, Vec<f64>);

/// Makes [`Finding::parts`] and [`Finding::from_parts`] of a line a finding: those that speak of a whole density, those
/// that speak of an axis, and those whose numbers are more than their fields, in both directions.
macro_rules! stored {
    (
        whole { $($whole:ident $code:literal ($($number:ident),*);)* }
        along { $($along:ident $along_code:literal ($($along_number:ident),*);)* }
        into { $($finding:pat => $parts:expr;)* }
        back { $($stored:pat => $back:expr;)* }
    ) => {
        impl Finding {
            /// What is stored of a finding: its code, the axis it speaks of, and its numbers, the one that matters most
            /// first.
            pub(crate) fn parts(&self) -> Parts {
                match *self {
                    $(Self::$whole { $($number),* } => ($code, None, vec![$($number),*]),)*
                    $(Self::$along { axis, $($along_number),* } => {
                        ($along_code, Some(axis), vec![$($along_number),*])
                    })*
                    $($finding => $parts,)*
                }
            }

            /// The finding of these [`Finding::parts`]; `None` where there is no such finding. Sentences have no parts
            /// that would bring them back.
            pub(crate) fn from_parts(
                code: &str,
                axis: Option<usize>,
                numbers: &[f64],
            ) -> Option<Self> {
                Some(match (code, axis, numbers) {
                    $(($code, None, &[$($number),*]) => Self::$whole { $($number),* },)*
                    $(($along_code, Some(axis), &[$($along_number),*]) => {
                        Self::$along { axis, $($along_number),* }
                    })*
                    $($stored => $back,)*
                    _ => return None,
                })
            }
        }
    };
}

stored! {
    whole {
        Escaping "escaping" (share, rate);
        NoSteadyState "no-steady-state" (rate, relaxation_time, limit);
        LeavesAtOnce "leaves-at-once" (rate);
        NothingStays "nothing-stays" (runaways, outside, limit);
        Outside "outside" (share);
        NotConverged "not-converged" (error);
        NegativeDensity "negative-density" (mass);
        NegativeCells "negative-cells" (mass, watched);
        FewModes "few-modes" (change);
        NumericalDiffusion "numerical-diffusion" (share);
        UnresolvedRelaxation "unresolved-relaxation" (time);
        ShortBurnIn "short-burn-in" (burn_in, time);
        NoReplicates "no-replicates" ();
        PointMass "point-mass" (exponent, error);
        NoExponent "no-exponent" ();
        NoSpectrum "no-spectrum" ();
        SpectrumCut "spectrum-cut" (frequency);
    }
    along {
        Absorbed "absorbed" (at, exponent);
        NaturalEnd "natural-end" (mass, at);
        HeavyTail "heavy-tail" (power);
        WideCells "wide-cells" (peclet);
        BalanceBroken "balance-broken" (relative, error);
        UnresolvedSeries "unresolved-series" (change);
        SmearedKink "smeared-kink" (widths);
        SurfaceOffFaces "surface-off-faces" (at);
        JumpInsideCells "jump-inside-cells" (at);
        NoFixedPoint "no-fixed-point" (drift, noise);
    }
    into {
        Self::SeveralClasses { ref classes } => ("several-classes", None, flat(classes));
        Self::EdgeMass { axis, mass, range: [from, to] } => ("edge-mass", Some(axis), vec![mass, from, to]);
        Self::StepBias { quantity, relative, standard_error, time_step } => {
            let (code, axis) = quantity.code();
            (code, axis, vec![relative, standard_error, time_step])
        };
        Self::FewReplicates { usable, wanted } => ("few-replicates", None, vec![usable as f64, wanted as f64]);
        Self::FewSlowModes { known, wanted } => ("few-slow-modes", None, vec![known as f64, wanted as f64]);
        Self::EndlessMean { average } => ("endless-mean", None, vec![average as f64]);
        Self::NoPassage { passage, fault } => (fault.code(), None, vec![passage as f64]);
        Self::NoVisits { visits, is_endless } => {
            ("no-visits", None, vec![visits as f64, f64::from(u8::from(is_endless))])
        };
        Self::PassageCut { passage, share, longest } => ("passage-cut", None, vec![passage as f64, share, longest]);
        Self::Told(_) => ("told", None, Vec::new());
    }
    back {
        ("several-classes", None, numbers) => Self::SeveralClasses { classes: unflat(numbers)? };
        ("edge-mass", Some(axis), &[mass, from, to]) => Self::EdgeMass { axis, mass, range: [from, to] };
        ("few-replicates", None, &[usable, wanted]) => Self::FewReplicates {
            usable: usable as usize,
            wanted: wanted as usize,
        };
        ("few-slow-modes", None, &[known, wanted]) => Self::FewSlowModes {
            known: known as usize,
            wanted: wanted as usize,
        };
        ("passage-cut", None, &[passage, share, longest]) => Self::PassageCut {
            passage: passage as usize,
            share,
            longest,
        };
        ("no-visits", None, &[visits, is_endless]) => Self::NoVisits {
            visits: visits as usize,
            is_endless: is_endless != 0.0,
        };
        ("endless-mean", None, &[average]) => Self::EndlessMean { average: average as usize };
        (code, None, &[passage]) => Self::NoPassage {
            passage: passage as usize,
            fault: PassageFault::of_code(code)?,
        };
        (code, axis, &[relative, standard_error, time_step]) => Self::StepBias {
            quantity: ShiftedQuantity::of_code(code, axis)?,
            relative,
            standard_error,
            time_step,
        };
    }
}

impl PassageFault {
    /// All of them, with their codes.
    pub(super) const CODES: [(Self, &'static str); 13] = [
        (Self::Nowhere, "passage-nowhere"),
        (Self::Between, "passage-between"),
        (Self::Everywhere, "passage-everywhere"),
        (Self::Start, "passage-start"),
        (Self::NoDensity, "passage-no-density"),
        (Self::Never, "passage-never"),
        (Self::Rounding, "passage-rounding"),
        (Self::Unsolved, "passage-unsolved"),
        (Self::Rare, "passage-rare"),
        (Self::RunsAway, "passage-runs-away"),
        (Self::NoSwitching, "passage-no-switching"),
        (Self::NoPeak, "passage-no-peak"),
        (Self::Overlap, "passage-overlap"),
    ];

    fn code(self) -> &'static str {
        let known = Self::CODES.into_iter().find(|(fault, _)| *fault == self);
        known.map_or("", |(_, code)| code)
    }

    fn of_code(code: &str) -> Option<Self> {
        let known = Self::CODES.into_iter().find(|(_, known)| *known == code);
        known.map(|(fault, _)| fault)
    }
}

impl ShiftedQuantity {
    fn code(self) -> (&'static str, Option<usize>) {
        match self {
            Self::Variance(axis) => ("step-bias-variance", Some(axis)),
            Self::Energy => ("step-bias-energy", None),
            Self::SurfaceMass(axis) => ("step-bias-surface", Some(axis)),
        }
    }

    fn of_code(code: &str, axis: Option<usize>) -> Option<Self> {
        let known = [Self::Energy].into_iter().chain(
            axis.into_iter()
                .flat_map(|axis| [Self::Variance(axis), Self::SurfaceMass(axis)]),
        );
        known
            .into_iter()
            .find(|quantity| quantity.code() == (code, axis))
    }
}

/// Classes as numbers: how many there are, then cells, share and centre of each.
fn flat(classes: &[SteadyClass]) -> Vec<f64> {
    let mut numbers = vec![classes.len() as f64];
    for class in classes {
        numbers.extend([class.cells as f64, class.share]);
        numbers.extend(&class.centre);
    }
    numbers
}

fn unflat(numbers: &[f64]) -> Option<Vec<SteadyClass>> {
    let (&count, rest) = numbers.split_first()?;
    let count = count as usize;
    let each = rest.len().checked_div(count)?;
    if each < 2 || each * count != rest.len() {
        return None;
    }
    let classes = rest.chunks_exact(each).map(|class| SteadyClass {
        cells: class[0] as usize,
        share: class[1],
        centre: class[2..].to_vec(),
    });
    Some(classes.collect())
}

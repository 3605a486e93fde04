//! Doubts in sentences, for the column `reason` and for the terminal.

use crate::continuation::{CheckedBy, Doubt, WiderRange};
use crate::system::Family;

/// What a doubt says, and what helps, in a sentence without a full stop.
pub fn doubt_in_words(family: &Family, doubt: &Doubt) -> String {
    match doubt {
        Doubt::NotOnFinerCells => "finer cells show no such change near it".to_owned(),
        Doubt::CheckFailed(CheckedBy::FinerCells(_), reason) => format!("on finer cells: {reason}"),
        Doubt::CheckFailed(CheckedBy::ClosedEnds, reason) => format!("with closed ends: {reason}"),
        Doubt::NotBetweenClosedEnds => {
            "with closed ends: no such indicator when nothing leaves".to_owned()
        }
        Doubt::OutwardDrift => "from there on the drift at an end of Ω points outward, and what is seen beside that \
             end changes: a wider range is needed"
            .to_owned(),
        Doubt::Jump => "the number that tells of it jumps there in place of passing zero or its level: a wider range or \
             more cells may show why"
            .to_owned(),
        Doubt::Unsound(status, None) => status.word().to_owned(),
        Doubt::Unsound(status, Some(wider)) => {
            format!("{}: {}", status.word(), wider_in_words(wider))
        }
        Doubt::NegativeDensity(share) => format!(
            "{:.0} % of the density there is negative: wiggles that the cells do not resolve",
            100.0 * share
        ),
        Doubt::FewModes(change) => {
            format!("more modes change the densities by {change:.1e}: more of them are needed")
        }
        Doubt::JumpInsideCells(axis, at) => {
            let axis = family.axis(*axis);
            format!(
                "the drift jumps at {axis} = {at:.4}, inside cells: a face there, or as {axis} the distance from it, \
                 would show the kink"
            )
        }
        Doubt::NaturalEnd(axis, at, mass) => {
            let axis = family.axis(*axis);
            format!(
                "{:.2} % of the mass lies in the cells beside {axis} = {at}, where the noise dies: narrow them toward it by \
                 `cells.{axis}.grade`",
                100.0 * mass
            )
        }
        Doubt::Leak(moves, wider) => {
            let wider = wider_in_words(wider);
            format!("what leaves Ω moves it by {moves:.1e}: {wider}")
        }
        Doubt::FewSamples(moves) => {
            format!("samples move it by {moves:.1e}: more of them are needed")
        }
        Doubt::UnevenFits(moves) => {
            format!("fits of other degrees move it by {moves:.1e}: more samples are needed")
        }
        Doubt::CoarseCells(moves, wanted) => {
            let wanted = wanted.map(|cells| format!(", about {cells:.0} an axis"));
            let wanted = wanted.unwrap_or_default();
            format!("finer cells move it by {moves:.1e}: more cells are needed{wanted}")
        }
        Doubt::SolverError(error) => {
            format!("errors of the solver and its bracket come to {error:.1e}")
        }
        Doubt::Extrapolated(error) => {
            format!("found from the points before it, it is uncertain by {error:.1e}")
        }
        Doubt::WideBracket(width) => format!("its bracket, {width:.1e} wide, was not narrowed"),
        Doubt::NumericalDiffusion => "the cells add diffusion of their own, and no finer cells tell how far it moves \
             the value"
            .to_owned(),
        Doubt::GridCheckOff => unchecked("locate.grid_check is \"off\""),
        Doubt::CheckMissing => unchecked("the sweep ended before, or holds no checks"),
        Doubt::AtRest(zero) => {
            let zero = zero.map(|zero| format!("; from infinite it becomes zero there at {}", seven_digits(zero)));
            let zero = zero.unwrap_or_default();
            format!(
                "it is read beside a fixed point that noise leaves alone, where the density goes like a power of the \
                 distance, which no cells follow{zero}"
            )
        }
        Doubt::IndicatorLost => {
            "there its slope can be followed no further: more cells may show it".to_owned()
        }
        Doubt::TooLow => "the density falls below its errors before the peak or crater vanishes, which may be anywhere \
             up to the end of the sweep: more cells may show it"
            .to_owned(),
        Doubt::BornBeyond => {
            "too low to be counted, it is there up to the end of the sweep".to_owned()
        }
        Doubt::NoIndicator | Doubt::FewCellsApart => "no slope or curvature tells of it: the band is from where it is \
             seen to where it is not, and more cells or samples narrow it"
            .to_owned(),
        Doubt::Flicker => "what is there at both ends cannot be told between them".to_owned(),
        Doubt::Stages => "the stages between cannot be told apart".to_owned(),
        Doubt::DoesNotContinue => "what is counted on one side of it is not what is counted beside the next change: a \
             change between them was missed, or one of the two is none; more cells may show which"
            .to_owned(),
        Doubt::NoCurve => "beside it there is no curve".to_owned(),
        Doubt::Stored(status) => status.word().to_owned(),
    }
}

fn unchecked(why: &str) -> String {
    format!("not checked on finer cells ({why}): its error lacks what the cells do to it")
}

fn wider_in_words(wider: &WiderRange) -> String {
    let name = &wider.axis;
    match wider.range {
        Some([from, to]) => {
            format!("a wider range of {name} (about {from:.2} to {to:.2}) is needed")
        }
        None => format!("a wider range of {name} is needed"),
    }
}

/// A number in at most seven digits.
fn seven_digits(value: f64) -> String {
    let rounded = format!("{value:.6e}").parse::<f64>();
    rounded.unwrap_or(value).to_string()
}

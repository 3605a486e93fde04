//! Why passages and visits have no numbers, as sentences for people.

use crate::continuation::PassageFault;
use crate::system::Family;

/// The name of a passage, by its number.
pub(super) fn passage_name(family: &Family, passage: usize) -> &str {
    family
        .questions
        .passages
        .get(passage)
        .map_or("", |one| &one.name)
}

/// Why the visits of a region have no numbers, and what to do.
pub(super) fn visits_in_words(family: &Family, visits: usize, is_endless: bool) -> String {
    let asked = family.questions.visits.get(visits);
    let name = asked.map_or("", |one| &one.name);
    let why = match is_endless {
        true => {
            "noise acts across its border, which is crossed infinitely often once it is met: ask for transitions between two regions that do not touch (`[passage]` with `transitions = \"on\"`)"
        }
        false => {
            "its border is met nowhere in the cells, or the rate of its visits is not known to its own size: move the border, widen the ranges or use more cells"
        }
    };
    format!("visits `{name}` have no numbers: {why}")
}

/// Why a passage has no numbers, and what to do.
pub(super) fn passage_in_words(family: &Family, passage: usize, fault: PassageFault) -> String {
    let name = passage_name(family, passage);
    let why = match fault {
        PassageFault::Nowhere => {
            "no cell is inside the region that is waited for: widen the ranges until it is, or use more cells, unless the region is empty at this value"
        }
        PassageFault::Between => {
            "a part of a region that ends it lies between the nodes of the cells, which would never meet it: use more cells, or ask Monte Carlo"
        }
        PassageFault::Everywhere => {
            "all cells are inside the region that is waited for, or inside the two of its transitions, which touch: there is nothing to wait for"
        }
        PassageFault::Start => {
            "it starts inside the region that is waited for or, on the fewest cells that errors are worked out on, within half a cell of it, or it starts outside of the cells, or where the steady state has no mass"
        }
        PassageFault::NoDensity => {
            "its start is spread as the steady state is, and there is none: give a state as its `start`"
        }
        PassageFault::Never => "the region that is waited for is never entered from its start",
        PassageFault::Rounding => {
            "its mean time is not known to its own size: finer cells and, by SGCM, more samples know more, unless it starts on the border, where the time is zero, or part of the paths never end, or it is so long beside the times in which states move that rounding decides (from about 1e13 times on)"
        }
        PassageFault::Unsolved => {
            "its equations were not solved: use more cells, above all where the border lies within a few cells of an end, or give it more memory (`method.memory_limit`), unless part of the paths never end or a formula has no number somewhere in the range"
        }
        PassageFault::Rare => {
            "hardly a path entered the region that is waited for, or came there from the one to start in: give them more time (`method.longest_passage`), or ask the generator"
        }
        PassageFault::RunsAway => {
            "paths run away without entering the region that is waited for, so that it has no mean time"
        }
        PassageFault::NoPeak => {
            "a region is the basin of a peak that the density does not have here, or is the only one, or of a ring that \
             is not there, or its border is no single line that can be followed from cell to cell"
        }
        PassageFault::Overlap => {
            return format!(
                "passage `{name}` has no transitions: its two regions have states in common: give regions that have none"
            );
        }
        PassageFault::NoSwitching => {
            return format!(
                "passage `{name}` has no rates from the slowest mode: that is no exchange between its two regions, or these cells do not tell it to a tenth: more of them may"
            );
        }
    };
    format!("passage `{name}` has no numbers: {why}")
}

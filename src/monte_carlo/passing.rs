//! Steps that pass through a region: outside at both ends, and inside between them.
//!
//! A Brownian bridge sees the nearest border as a plane, and a step that ends behind a strip as one that has not come
//! to it. Along the chord of such a step the level falls from its first end and rises to the other, and the tangents
//! at both ends meet below zero; where the level is negative at that place, the path has been inside. That holds of
//! regions of one coordinate: a path may go round a disc.

use super::walk::Border;
use crate::system::{LANES, Lanes};

/// Part of a chord over which the slope of a level is taken at either end.
const PART: f64 = 1e-6;

/// How a step passes through a region.
pub(super) struct Passing {
    /// The level at the end as the tangent at the beginning has it, and the one at the beginning as that at the end has
    /// it: both negative.
    pub(super) beyond: [f64; 2],
    /// A state inside, on the chord.
    pub(super) state: Vec<f64>,
}

impl Border<'_> {
    /// Which paths of a batch pass through the region in a step, of which states and levels at both ends are given.
    pub(super) fn passing(
        &self,
        [from, to]: [&[Lanes]; 2],
        [first, last]: [&Lanes; 2],
    ) -> [Option<Passing>; LANES] {
        if !self.is_of_one_axis {
            return [const { None }; LANES];
        }
        let between = |lane: usize, share: f64| -> Vec<f64> {
            let ends = from.iter().zip(to);
            ends.map(|(from, to)| from[lane] + share * (to[lane] - from[lane]))
                .collect()
        };
        let all = |share: f64| -> Vec<Lanes> {
            let axes = from.iter().zip(to);
            axes.map(|(from, to)| {
                std::array::from_fn(|lane| from[lane] + share * (to[lane] - from[lane]))
            })
            .collect()
        };
        let beside = [PART, 1.0 - PART].map(|share| self.until.values(&all(share)));
        std::array::from_fn(|lane| {
            let (first, last) = (first[lane], last[lane]);
            let falls = (beside[0][lane] - first) / PART;
            let rises = (last - beside[1][lane]) / PART;
            let beyond = [first + falls, last - rises];
            if !(first >= 0.0 && last >= 0.0 && beyond[0] < 0.0 && beyond[1] < 0.0) {
                return None;
            }
            let state = between(lane, (beyond[1] - first) / (falls - rises));
            (self.until.at(&state) < 0.0).then_some(Passing { beyond, state })
        })
    }
}

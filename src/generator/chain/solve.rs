//! L f = -g on a chain that ends in some of its places, by an elimination that adds and divides alone: every digit of
//! a time stands, however high the barriers.

use super::Chain;

/// A chain that ends in some places.
pub(crate) struct AbsorbingChain<'a> {
    pub(super) chain: &'a Chain,
    pub(super) ends: &'a [bool],
}

impl Chain {
    /// The chain that ends in the marked places.
    pub(crate) fn until<'a>(&'a self, ends: &'a [bool]) -> AbsorbingChain<'a> {
        AbsorbingChain { chain: self, ends }
    }

    /// ∫ g p f of the loads of g and the values of f.
    pub(crate) fn over(load: &[f64], values: &[f64]) -> f64 {
        load.iter()
            .zip(values)
            .map(|(one, other)| one * other)
            .sum()
    }

    /// Masses times values.
    pub(crate) fn weighted(&self, values: &[f64]) -> Vec<f64> {
        let pairs = self.masses.iter().zip(values);
        pairs.map(|(mass, value)| mass * value).collect()
    }
}

impl AbsorbingChain<'_> {
    /// f with L f = -g, of the loads ∫ φ g p, and with these values at the places where it ends. Infinite, or not a
    /// number, where no such place is reached.
    pub(crate) fn solve(&self, load: &[f64], at_ends: impl Fn(usize) -> f64) -> Vec<f64> {
        self.solve_at(0.0, load, at_ends)
    }

    /// f with (L - s) f = -g at a rate s of zero or more, likewise: processes end at that rate wherever they are.
    pub(super) fn solve_at(
        &self,
        rate: f64,
        load: &[f64],
        at_ends: impl Fn(usize) -> f64,
    ) -> Vec<f64> {
        let conductances = &self.chain.conductances;
        let count = self.ends.len();
        // What leaves each place but for the way up, and what it gains with what comes from below.
        let (mut leaks, mut gains) = (vec![0.0; count], vec![0.0; count]);
        let (mut leak_below, mut gain_below) = (0.0, 0.0);
        for place in 0..count {
            let way = conductances.get(place).copied();
            if self.ends[place] {
                leak_below = way.unwrap_or(0.0);
                gain_below = at_ends(place) * leak_below;
                continue;
            }
            let own = rate * self.chain.masses[place];
            let (mut leak, mut gain) = (leak_below + own, load[place] + gain_below);
            match way {
                Some(way) if self.ends[place + 1] => {
                    leak += way;
                    gain += at_ends(place + 1) * way;
                }
                Some(way) => {
                    let through = way / (leak + way);
                    (leak_below, gain_below) = (leak * through, gain * through);
                }
                None => {}
            }
            (leaks[place], gains[place]) = (leak, gain);
        }
        let mut values = vec![0.0; count];
        for place in (0..count).rev() {
            values[place] = match conductances.get(place) {
                _ if self.ends[place] => at_ends(place),
                Some(&way) if !self.ends[place + 1] => {
                    (gains[place] + way * values[place + 1]) / (leaks[place] + way)
                }
                _ => gains[place] / leaks[place],
            };
        }
        values
    }
}

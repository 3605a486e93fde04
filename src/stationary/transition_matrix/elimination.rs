//! Exact steady state of a small leaking chain by elimination without subtraction (Grassmann, Taksar and
//! Heyman, Oper. Res. 33, 1985): every mass comes out to nearly full relative accuracy.

/// A dense chain, eliminated: solves for steady states under any re-injection of what escapes.
pub(super) struct Eliminated {
    n: usize,
    /// Column-major. Above the diagonal (target < source): flow into the target per departure of the source.
    /// Below (target > source): flow into the target per visit of the source.
    rates: Vec<f64>,
    /// Probability to leave each state for a lower one or the sink, higher states eliminated.
    leaving: Vec<f64>,
}

/// Re-injections until the quasi-steady state stands.
const MOST_REINJECTIONS: usize = 500;

impl Eliminated {
    /// Eliminates the states from the last to the first. `rates[j * n + i]` is P_ij, i ≠ j (the diagonal is
    /// not read), `escape` the probability to go to the sink.
    pub(super) fn new(mut rates: Vec<f64>, mut escape: Vec<f64>) -> Self {
        let n = escape.len();
        let mut leaving = vec![0.0; n];
        for state in (0..n).rev() {
            let (before, column) = rates.split_at_mut(state * n);
            let column = &mut column[..state];
            let out = column.iter().sum::<f64>() + escape[state];
            leaving[state] = out;
            // State 0 of a chain without escape is left for nowhere; its mass sets the scale.
            let scale = 1.0 / out.max(f64::MIN_POSITIVE);
            column.iter_mut().for_each(|rate| *rate *= scale);
            let to_sink = escape[state] * scale;
            for (source, targets) in before.chunks_exact_mut(n).enumerate() {
                let visits = targets[state];
                if visits > 0.0 {
                    for (target, share) in targets[..state].iter_mut().zip(&*column) {
                        *target += visits * share;
                    }
                    escape[source] += visits * to_sink;
                }
            }
        }
        Self { n, rates, leaving }
    }

    /// Masses when everything that escapes comes back in proportion to `injected`: solves
    /// (1 - P) p ∝ injected, Σ p = 1; without escape `injected` does not matter.
    fn reinject(&self, injected: &[f64]) -> Vec<f64> {
        let n = self.n;
        let mut arriving = injected.to_vec();
        for state in (1..n).rev() {
            let (lower, rest) = arriving.split_at_mut(state);
            let column = &self.rates[state * n..state * n + state];
            for (target, share) in lower.iter_mut().zip(column) {
                *target += share * rest[0];
            }
        }
        // Relative to the mass of state 0, so that a rare escape cannot overflow.
        let scale = self.leaving[0] / arriving[0].max(f64::MIN_POSITIVE);
        let mut mass: Vec<f64> = arriving.iter().map(|flow| flow * scale).collect();
        mass[0] = 1.0;
        for state in 1..n {
            let from_lower: f64 = (0..state)
                .map(|source| self.rates[source * n + state] * mass[source])
                .sum();
            mass[state] = (mass[state] + from_lower) / self.leaving[state].max(f64::MIN_POSITIVE);
        }
        let total: f64 = mass.iter().sum();
        mass.iter_mut().for_each(|value| *value /= total);
        mass
    }

    /// The (quasi-)steady state, Σ = 1, starting the re-injection from `guess`: inverse iteration for the
    /// eigenvalue of P nearest to 1. Exact at once without escape.
    pub(super) fn steady(&self, guess: &[f64]) -> Vec<f64> {
        let mut mass = self.reinject(guess);
        if self.leaving[0] == 0.0 {
            return mass;
        }
        for _ in 0..MOST_REINJECTIONS {
            let next = self.reinject(&mass);
            let change = crate::numerics::distance(&next, &mass);
            mass = next;
            if change < 1e-15 * self.n as f64 {
                break;
            }
        }
        mass
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_states_balance() {
        // 0 → 1 with 0.3, 1 → 0 with 1e-12: p ∝ (1e-12, 0.3), to full relative accuracy.
        let mass = Eliminated::new(vec![0.0, 0.3, 1e-12, 0.0], vec![0.0; 2]).steady(&[0.5, 0.5]);
        assert!((mass[0] / mass[1] / (1e-12 / 0.3) - 1.0).abs() < 1e-14);
    }

    #[test]
    fn absorbing_walk_is_a_sine() {
        // Random walk on n sites with absorbing ends: λ = cos(π/(n+1)), p ∝ sin(π i/(n+1)).
        let n = 20;
        let mut rates = vec![0.0; n * n];
        let mut escape = vec![0.0; n];
        for site in 0..n {
            for target in [site.wrapping_sub(1), site + 1] {
                if target < n {
                    rates[site * n + target] = 0.5;
                } else {
                    escape[site] += 0.5;
                }
            }
        }
        let mass = Eliminated::new(rates, escape).steady(&vec![1.0 / n as f64; n]);
        let exact = |site: usize| (std::f64::consts::PI * (site + 1) as f64 / 21.0).sin();
        let total: f64 = (0..n).map(exact).sum();
        for (site, value) in mass.iter().enumerate() {
            assert!((value - exact(site) / total).abs() < 1e-13, "{site}");
        }
    }
}

//! Where the solver of a session stands on the path, and where to factorise next.

/// Values whose generators the solver holds on to.
#[derive(Debug, Clone, Copy, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Stand {
    /// The factorised one.
    pub(super) factorised: Option<f64>,
    /// The one solved last.
    pub(super) solved: Option<f64>,
}

/// How far ahead of a value is factorised, as a share of the distance that the old factors have served.
const LEAD: f64 = 0.6;

impl Stand {
    /// The value to factorise in place of one from which the sweep goes on between `ends` as it came; `None` where it
    /// turns.
    pub(super) fn ahead_of(self, value: f64, ends: (f64, f64)) -> Option<f64> {
        let served = value - self.factorised?;
        let step = value - self.solved?;
        let end = if step > 0.0 {
            ends.0.max(ends.1)
        } else {
            ends.0.min(ends.1)
        };
        let lead = (LEAD * served.abs()).min(0.5 * (end - value).abs());
        let goes_on = served * step > 0.0 && (end - value) * step > 0.0;
        (goes_on && lead > 0.0).then(|| value + lead.copysign(step))
    }
}

#[cfg(test)]
mod tests {
    use super::{LEAD, Stand};

    fn ahead(factorised: f64, solved: f64, value: f64) -> Option<f64> {
        let stand = Stand {
            factorised: Some(factorised),
            solved: Some(solved),
        };
        stand.ahead_of(value, (1.0, -1.0))
    }

    #[test]
    fn factors_are_made_ahead_where_the_sweep_goes_on() {
        let far = ahead(0.5, 0.2, 0.1).unwrap();
        assert!((far - (0.1 - LEAD * 0.4)).abs() < 1e-15, "{far}");
        // Near the end, in the middle of what is left.
        assert_eq!(ahead(0.0, -0.7, -0.8), Some(-0.9));
        assert_eq!(ahead(0.0, -0.9, -1.0), None);
        // Back toward the factorised value, and at a value that was just solved.
        assert_eq!(ahead(0.5, 0.1, 0.2), None);
        assert_eq!(ahead(0.5, 0.1, 0.1), None);
        assert_eq!(Stand::default().ahead_of(0.0, (1.0, -1.0)), None);
    }
}

//! Numbers that look random and are the same everywhere (splitmix64), and numbers with errors.

/// By its seed.
pub(crate) struct Numbers(pub(crate) u64);

impl Numbers {
    pub(crate) fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// A number between two others.
    pub(crate) fn between(&mut self, from: f64, to: f64) -> f64 {
        let unit = self.next() as f64 / u64::MAX as f64;
        from + unit * (to - from)
    }

    /// The same of three decimals, so that a case can be typed in by hand.
    pub(crate) fn rounded(&mut self, from: f64, to: f64) -> f64 {
        (self.between(from, to) * 1000.0).round() / 1000.0
    }

    /// A number below another, and 0 below 0.
    pub(crate) fn below(&mut self, end: usize) -> usize {
        (self.next() % end.max(1) as u64) as usize
    }
}

/// A number of the environment.
pub(crate) fn given(name: &str, otherwise: u64) -> u64 {
    let text = std::env::var(name).ok();
    text.and_then(|text| text.parse().ok()).unwrap_or(otherwise)
}

/// A number holds an exact one within its stated error, and this error is below `largest`.
#[track_caller]
pub(crate) fn assert_holds([value, error]: [f64; 2], exact: f64, largest: f64) {
    let off = (value - exact).abs();
    assert!(off <= error, "{value} ± {error:e}, exactly {exact}");
    assert!(
        error < largest,
        "{value} ± {error:e} instead of {largest:e}"
    );
}

/// F(1, -1/3; 7/6; z) by its series, 0 ≤ z < 1.
pub(crate) fn hypergeometric(z: f64) -> f64 {
    let (a, b, c) = (1.0, -1.0 / 3.0, 7.0 / 6.0);
    let terms = (0..20_000).scan(1.0, |term: &mut f64, n| {
        let n = f64::from(n);
        let now = *term;
        *term *= (a + n) * (b + n) / ((c + n) * (n + 1.0)) * z;
        Some(now)
    });
    terms.sum()
}

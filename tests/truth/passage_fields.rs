//! Fields of first passage over the state where a process starts, against closed forms, quadrature and paths.

use std::sync::Arc;

use pbif::cancellation::Cancellation;
use pbif::generator::GeneratorOptions;
use pbif::passage::{FieldTarget, PassageField, field};
use pbif::space::CellSpace;
use pbif::stationary::generator::RateOptions;
use pbif::system::{BoundQuantity, Model, regions};
use statrs::function::gamma::gamma;

use crate::common::steady::{even_cells, model};

/// A field with its cells.
struct Found {
    space: CellSpace,
    field: PassageField,
}

/// The mean time until any of several inequalities holds, or the probability that one of them is the first.
fn found(
    model: &Arc<Model>,
    parts: &[&str],
    part: Option<usize>,
    axes: &[(f64, f64, usize)],
) -> Found {
    let values = model.values(&[]).unwrap();
    let bound = |text: &str| -> BoundQuantity {
        let region = regions(model, &[("until", text)]).unwrap().remove(0);
        region.level().bind(&values).unwrap()
    };
    let either: Vec<String> = parts.iter().map(|part| format!("({part})")).collect();
    let target = FieldTarget {
        until: bound(&either.join(" or ")),
        exits: parts.iter().map(|part| bound(part)).collect(),
        part,
    };
    let space = even_cells(axes);
    let settings = (&GeneratorOptions::default(), &RateOptions::default());
    let system = model.system_with(&[]).unwrap();
    let never = Cancellation::new();
    let field = field(&system, &space, &target, settings, &never).unwrap();
    Found { space, field }
}

impl Found {
    /// Compares all states at which the exact value is known, and gives the largest share of its error that one is off
    /// by.
    fn holds(&self, what: &str, largest: f64, exact: impl Fn(&[f64]) -> Option<f64>) -> f64 {
        let (mut worst, mut off, mut stated, mut scale) = ((0.0_f64, Vec::new()), 0.0_f64, 0.0_f64, 0.0_f64);
        let mut shares = Vec::new();
        for cell in 0..self.space.n_cells() {
            let state = self.space.centre(cell);
            let Some(exact) = exact(&state) else { continue };
            let (value, error) = (self.field.values[cell], self.field.errors[cell]);
            let share = (value - exact).abs() / error.max(1e-300);
            if (value - exact).abs() > 0.0 {
                shares.push(share);
                if share > worst.0 {
                    worst = (share, state.clone());
                }
            }
            off = off.max((value - exact).abs());
            stated = stated.max(error);
            scale = scale.max(exact.abs());
        }
        shares.sort_by(f64::total_cmp);
        let median = shares.get(shares.len() / 2).copied().unwrap_or(0.0);
        println!(
            "{what}: {} states, off by {off:.1e} of {scale:.3} at most, stated {stated:.1e} at most; \
             largest share {:.2} at {:?}, median {median:.2}, {} above 1",
            shares.len(), worst.0, worst.1, shares.iter().filter(|s| **s > 1.0).count()
        );
        let _ = largest;
        worst.0
    }
}

fn integral(f: &dyn Fn(f64) -> f64, from: f64, to: f64) -> f64 {
    let n = 4000;
    let h = (to - from) / f64::from(n);
    (0..n)
        .map(|k| {
            let x = from + (f64::from(k) + 0.5) * h;
            let g = 0.5 * h / 3.0_f64.sqrt();
            0.5 * h * (f(x - g) + f(x + g))
        })
        .sum()
}

#[test]
fn probe() {
    // Double well, one axis, committor.
    let d = 0.1;
    let well = model(&[("x", "x - x^3")], &[("x", "sqrt(0.2)")]);
    let slope = move |x: f64| ((x.powi(4) / 4.0 - x * x / 2.0) / d).exp();
    let (a, b) = (-0.9, 0.83);
    let whole = integral(&slope, a, b);
    for n in [60, 100, 160] {
        let f = found(&well, &["x < -0.9", "x > 0.83"], Some(1), &[(-2.0, 2.0, n)]);
        f.holds(&format!("well committor {n}"), 1.0, |s| {
            Some(if s[0] < a { 0.0 } else if s[0] > b { 1.0 } else { integral(&slope, a, s[0]) / whole })
        });
    }
    // Ornstein-Uhlenbeck interval: T with s²=2 (D=1), x in (a,b).
    let ou = model(&[("x", "-x")], &[("x", "sqrt(2)")]);
    let (a, b) = (-1.2, 1.73);
    let s = |x: f64| (x * x / 2.0).exp();
    let m = |x: f64| integral(&|z| (-z * z / 2.0).exp(), 0.0, x);
    // T' s^-1 ... T(x) = c ∫_a^x s - ∫_a^x s m
    let inner = |x: f64| { let n = 400; let h = (x - a) / f64::from(n); (0..n).map(|k| { let y = a + (f64::from(k) + 0.5) * h; h * s(y) * m(y) }).sum::<f64>() };
    let _ = inner;
    let m_table: Vec<f64> = { let n = 4000; let h = (b - a) / n as f64; (0..n).map(|k| m(a + (k as f64 + 0.5) * h)).collect() };
    let upto = |x: f64| {
        let n = 4000; let h = (b - a) / n as f64;
        let mut i1 = 0.0; let mut i2 = 0.0;
        for (k, m) in m_table.iter().enumerate() {
            let from = a + k as f64 * h;
            let part = ((x - from) / h).clamp(0.0, 1.0);
            if part <= 0.0 { break; }
            let y = from + 0.5 * h;
            i1 += part * h * s(y); i2 += part * h * s(y) * m;
        }
        (i1, i2)
    };
    let (w1, w2) = upto(b);
    for n in [40, 80, 120, 160, 240, 320, 640] {
        let t = super::passages::passage(&ou, "x < -1.2 or x > 1.73", &[0.7421875], &[(-2.0, 2.5, n)]); println!("timed {n}: {:.3e} +- {:.1e}", t.mean.0 - 1.5021202072588888, t.mean.1);
        let f = found(&ou, &["x < -1.2", "x > 1.73"], None, &[(-2.0, 2.5, n)]);
        f.holds(&format!("ou interval {n}"), 1.0, |st| {
            let x = st[0];
            if x <= a || x >= b { return Some(0.0); }
            let (i1, i2) = upto(x);
            Some(w2 / w1 * i1 - i2)
        });
    }
    // Double well mean time from below 0.37
    let u = |x: f64| x.powi(4) / 4.0 - x * x / 2.0;
    let table = { // T(x)
        let low = -2.0; let end = 0.37; let n = 200_000; let h = (end - low) / n as f64;
        let mut inner = 0.0; let mut outer = vec![0.0; n];
        for k in 0..n { let z = low + (k as f64 + 0.5) * h; let w = (-u(z) / d).exp() * h; outer[k] = (u(z) / d).exp() / d * (inner + 0.5 * w) * h; inner += w; }
        let mut t = vec![0.0; n + 1];
        for k in (0..n).rev() { t[k] = t[k + 1] + outer[k]; }
        (low, h, t)
    };
    for n in [60, 100, 200] {
        let f = found(&well, &["x > 0.37"], None, &[(-2.0, 2.0, n)]);
        f.holds(&format!("well time {n}"), 1.0, |st| {
            if st[0] >= 0.37 { return Some(0.0); }
            let at = (st[0] - table.0) / table.1; let k = (at.floor() as usize).min(table.2.len() - 2); let p = at.fract();
            Some((1.0 - p) * table.2[k] + p * table.2[k + 1])
        });
    }
    // disc
    let two = [("x", "sqrt(2)"), ("y", "sqrt(2)")];
    let pair = model(&[("x", "-x"), ("y", "-y")], &two);
    let r2 = 1.5_f64;
    let series = |r: f64| (1..60).scan(1.0, |t, k| { *t *= r * r / (2.0 * f64::from(k)); Some(*t / (2.0 * f64::from(k))) }).sum::<f64>();
    for n in [30, 40, 60, 100] {
        let axis = (-2.0, 2.0, n);
        let f = found(&pair, &["x^2 + y^2 > 1.5^2"], None, &[axis, axis]);
        f.holds(&format!("disc {n}"), 1.0, |s| {
            let r = s[0].hypot(s[1]);
            Some(if r >= r2 { 0.0 } else { series(r2) - series(r) })
        });
    }
    // annulus committor of 2D Brownian: log r, outer 1.5 inner 0.4
    let free = model(&[("x", "0 x"), ("y", "0 y")], &two);
    for n in [30, 40, 60, 100] {
        let axis = (-2.0, 2.0, n);
        let f = found(&free, &["x^2 + y^2 > 1.5^2", "x^2 + y^2 < 0.4^2"], Some(0), &[axis, axis]);
        f.holds(&format!("ring {n}"), 1.0, |s| {
            let r = s[0].hypot(s[1]);
            Some(((r / 0.4).ln() / (1.5_f64 / 0.4).ln()).clamp(0.0, 1.0))
        });
    }
    // integrated Brownian
    let motion = model(&[("x", "v"), ("v", "0 v")], &[("v", "1")]);
    let exact = |x: f64| {
        let front = 2.0_f64.cbrt() * (4.0_f64 / 3.0).powf(1.0 / 6.0) / gamma(7.0 / 3.0);
        front * (x * (1.0 - x)).powf(1.0 / 6.0) * (hypergeometric(x) + hypergeometric(1.0 - x))
    };
    let fine = found(&motion, &["x < 0", "x > 1"], None, &[(-0.1, 1.1, 240), (-4.0, 4.0, 243)]);
    for n in [40, 60, 80] {
        let f = found(&motion, &["x < 0", "x > 1"], None, &[(-0.1, 1.1, n), (-4.0, 4.0, n + 1)]);
        f.holds(&format!("IBM {n}, v = 0"), 1.0, |s| (s[1].abs() < 1e-9 && s[0] > 0.0 && s[0] < 1.0).then(|| exact(s[0])));
    }
    let f = found(&motion, &["x < 0", "x > 1"], None, &[(-0.1, 1.1, 80), (-4.0, 4.0, 81)]);
    f.holds("IBM 80 against 240", 1.0, |s| {
        let cell = fine.space.find(s)?;
        let c = fine.space.centre(cell);
        (((c[0] - s[0]).abs() < 1e-9) && (c[1] - s[1]).abs() < 1e-9).then(|| fine.field.values[cell])
    });
}

/// F(1, -1/3; 7/6; z) by its series, 0 ≤ z < 1.
fn hypergeometric(z: f64) -> f64 {
    let (a, b, c) = (1.0, -1.0 / 3.0, 7.0 / 6.0);
    let terms = (0..20_000).scan(1.0, |term: &mut f64, n| {
        let n = f64::from(n);
        let now = *term;
        *term *= (a + n) * (b + n) / ((c + n) * (n + 1.0)) * z;
        Some(now)
    });
    terms.sum()
}

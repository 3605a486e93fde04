//! Random systems whose drift and noise are no polynomials: sines, exponentials, Hill's function, noise that grows by
//! orders along the axis, and densities that move through the range.
//!
//! With θ g(x) + e(x) the slope of the density but for a positive factor, its extrema lie where θ = -e(x)/g(x), and
//! they are born and vanish where this function of x turns.

use super::*;

/// A system of one axis by what its equation says and by what its density is.
pub(super) struct Formula {
    pub(super) family: &'static str,
    pub(super) drift: String,
    pub(super) noise: String,
    /// Drift less b b' at θ, and b².
    pub(super) slope: Box<dyn Fn(f64, f64) -> f64>,
    pub(super) intensity: Box<dyn Fn(f64) -> f64>,
    /// Parameter at which the slope is zero at a place, and how fast the place moves with it.
    pub(super) zero: Box<dyn Fn(f64) -> f64>,
    pub(super) speed: f64,
    pub(super) ends: (f64, f64),
    /// Places where the slope jumps.
    pub(super) breaks: Vec<f64>,
    /// Where to look for the density.
    pub(super) within: (f64, f64),
}

impl Formula {
    /// Values at which the zero turns, between the ends and in a range.
    fn turns(&self, (from, to): (f64, f64)) -> Vec<f64> {
        let n = 200_000;
        let (low, high) = self.within;
        let x = |i: usize| low + (high - low) * (i as f64 + 0.31) / f64::from(n);
        let rate = |x: f64| {
            let h = 1e-5 * (1.0 + x.abs());
            let near = 8.0 * ((self.zero)(x + h) - (self.zero)(x - h));
            (near - (self.zero)(x + 2.0 * h) + (self.zero)(x - 2.0 * h)) / (12.0 * h)
        };
        let mut values = Vec::new();
        for i in 1..n as usize {
            let (mut a, mut b) = (x(i - 1), x(i));
            // A pole turns the sign too, but not there.
            let is_near = |x: f64| self.ends.0 < (self.zero)(x) && (self.zero)(x) < self.ends.1;
            let rises = rate(a) > 0.0;
            let is_broken = self.breaks.iter().any(|at| (at - a).abs() < 1e-3);
            if is_broken || !is_near(a) || !is_near(b) || rises == (rate(b) > 0.0) {
                continue;
            }
            for _ in 0..50 {
                let middle = 0.5 * (a + b);
                match (rate(middle) > 0.0) == rises {
                    true => a = middle,
                    false => b = middle,
                }
            }
            // Where it bends, differences are off by their step.
            let reach = 4e-5 * (1.0 + a.abs());
            let (mut a, mut b) = (a - reach, b + reach);
            for _ in 0..80 {
                let (left, right) = (a + (b - a) / 3.0, b - (b - a) / 3.0);
                match ((self.zero)(left) < (self.zero)(right)) == rises {
                    true => a = left,
                    false => b = right,
                }
            }
            let value = (self.zero)(0.5 * (a + b));
            let place = a + self.speed * value;
            if from < place && place < to {
                values.push(value);
            }
        }
        values.extend(self.jumps());
        values.sort_by(f64::total_cmp);
        values
    }

    /// Values at which the slope is zero on one side of a place where it jumps, and the number of peaks changes.
    fn jumps(&self) -> Vec<f64> {
        let sides = || self.breaks.iter().flat_map(|at| [at - 1e-11, at + 1e-11]);
        let mut values: Vec<f64> = sides().map(|x| (self.zero)(x)).collect();
        let n = 100_000;
        let (low, high) = self.within;
        let at = |i: usize| low + (high - low) * (i as f64 + 0.31) / f64::from(n);
        let mut places: Vec<f64> = (0..n as usize).map(at).chain(sides()).collect();
        places.sort_by(f64::total_cmp);
        let zeros: Vec<f64> = places.into_iter().map(|x| (self.zero)(x)).collect();
        let peaks = |theta: f64| {
            let falls = |pair: &&[f64]| pair[0] < theta && pair[1] >= theta;
            zeros.windows(2).filter(falls).count()
        };
        // Both sides of a break are among the places, so that what is born beside it is told from what vanishes at it.
        let small = 1e-5 * (self.ends.1 - self.ends.0);
        values.retain(|one| self.ends.0 < *one && *one < self.ends.1);
        values.retain(|one| peaks(one - small) != peaks(one + small));
        values
    }

    /// The range that holds all but 1e-13 of the density at five values of the sweep.
    fn range(&self) -> (f64, f64) {
        let n = 8000;
        let step = (self.within.1 - self.within.0) / f64::from(n);
        let at = |i: usize| self.within.0 + step * i as f64;
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for share in [0.0, 0.25, 0.5, 0.75, 1.0] {
            let theta = self.ends.0 + share * (self.ends.1 - self.ends.0);
            let mut sum = 0.0;
            let logs: Vec<f64> = (0..n as usize)
                .map(|i| {
                    let x = at(i) + 0.5 * step;
                    sum += 2.0 * (self.slope)(x, theta) / (self.intensity)(x) * step;
                    sum
                })
                .collect();
            let top = logs.iter().copied().fold(f64::NEG_INFINITY, f64::max);
            let held = |i: &usize| logs[*i] > top - 32.0;
            low = low.min(at((0..n as usize).find(held).unwrap()));
            high = high.max(at((0..n as usize).rfind(held).unwrap()));
        }
        let pad = 0.03 * (high - low);
        let rounded = |x: f64| (x * 100.0).round() / 100.0;
        (
            rounded(low - pad).max(self.within.0),
            rounded(high + pad).min(self.within.1),
        )
    }

    /// The range of the density, and where it changes there.
    pub(super) fn range_and_turns(&self) -> ((f64, f64), Vec<f64>) {
        let range = self.range();
        (range, self.turns(range))
    }

    pub(super) fn case(self, cells: usize) -> Case {
        let ((from, to), truths) = self.range_and_turns();
        let model = TypedModel::new("random", "A random system", ["x"])
            .with_equation("x", &self.drift)
            .with_noise("x", [self.noise.clone()])
            .with_interpretation(Interpretation::Ito)
            .with_parameters(["theta"])
            .build()
            .unwrap();
        Case {
            family: self.family,
            words: format!(
                "x' = {} + {} ξ, x in [{from}, {to}], θ in {:?}",
                self.drift, self.noise, self.ends
            ),
            model,
            axes: vec![Axis::uniform(from, to, cells).unwrap()],
            ends: self.ends,
            points: 41,
            truths,
        }
    }
}

/// θ + A sin k x - c x.
fn sines(dice: &mut Dice) -> Formula {
    let (a, k) = (dice.between(0.5, 2.0), dice.between(1.5, 4.0));
    let (c, sigma) = (dice.between(0.3, 1.0), dice.between(0.5, 0.9));
    Formula {
        family: "sines",
        drift: format!("theta + {a} sin({k} x) - {c} x"),
        noise: format!("{sigma}"),
        slope: Box::new(move |x, theta| theta + a * (k * x).sin() - c * x),
        intensity: Box::new(move |_| sigma * sigma),
        zero: Box::new(move |x| c * x - a * (k * x).sin()),
        speed: 0.0,
        breaks: Vec::new(),
        ends: (-1.513, 1.487),
        within: (-12.0, 12.0),
    }
}

/// A bump of the drift, θ high.
fn bumps(dice: &mut Dice) -> Formula {
    let (m, w, sigma) = (
        dice.between(-1.0, 1.0),
        dice.between(0.5, 3.0),
        dice.between(0.3, 0.8),
    );
    let bump = move |x: f64| (x - m) * (-w * (x - m) * (x - m)).exp();
    Formula {
        family: "bumps",
        drift: format!("theta (x - {m}) exp(-{w} (x - {m})^2) - x"),
        noise: format!("{sigma}"),
        slope: Box::new(move |x, theta| theta * bump(x) - x),
        intensity: Box::new(move |_| sigma * sigma),
        zero: Box::new(move |x| x / bump(x)),
        speed: 0.0,
        breaks: Vec::new(),
        ends: (0.2, 8.0),
        within: (-8.0, 8.0),
    }
}

/// Noise that grows exponentially along the axis.
fn steep_noise(dice: &mut Dice) -> Formula {
    let (q, s, k) = (
        dice.between(0.3, 2.0),
        dice.between(0.1, 0.6),
        dice.between(0.5, 2.0),
    );
    let bb = move |x: f64| 0.5 * s * q * (q * x).exp();
    Formula {
        family: "noise that grows exponentially",
        drift: format!("theta + {k} x - x^5"),
        noise: format!("sqrt({s} exp({q} x))"),
        slope: Box::new(move |x, theta| theta + k * x - x.powi(5) - bb(x)),
        intensity: Box::new(move |x| s * (q * x).exp()),
        zero: Box::new(move |x| bb(x) + x.powi(5) - k * x),
        speed: 0.0,
        breaks: Vec::new(),
        ends: (-1.513, 1.487),
        within: (-4.0, 4.0),
    }
}

/// A gene that promotes itself.
fn genes(dice: &mut Dice) -> Formula {
    let (k, d) = (dice.between(2.0, 6.0), dice.between(0.01, 0.05));
    let hill = dice.one_of([2, 3, 4]) as i32;
    let made = move |x: f64| k * x.powi(hill) / (2f64.powi(hill) + x.powi(hill));
    Formula {
        family: "genes",
        drift: format!(
            "theta + {k} x^{hill}/({} + x^{hill}) - x",
            2i32.pow(hill as u32)
        ),
        noise: format!("sqrt({d} (0.2 + x))"),
        slope: Box::new(move |x, theta| theta + made(x) - x - 0.5 * d),
        intensity: Box::new(move |x| d * (0.2 + x)),
        zero: Box::new(move |x| 0.5 * d + x - made(x)),
        speed: 0.0,
        breaks: Vec::new(),
        ends: (0.05, 2.0),
        within: (0.0, 12.0),
    }
}

/// Two wells that move through the range, ten of their widths and more: u = x - v θ.
fn moving(dice: &mut Dice) -> Formula {
    let (v, k, sigma) = (
        dice.between(1.0, 8.0),
        dice.between(0.5, 1.2),
        dice.between(0.4, 0.7),
    );
    Formula {
        family: "densities that move",
        drift: format!("theta + {k} (x - {v} theta) - (x - {v} theta)^3"),
        noise: format!("{sigma}"),
        slope: Box::new(move |x, theta| {
            let u = x - v * theta;
            theta + k * u - u.powi(3)
        }),
        intensity: Box::new(move |_| sigma * sigma),
        // By the moving coordinate.
        zero: Box::new(move |u| u.powi(3) - k * u),
        speed: v,
        breaks: Vec::new(),
        ends: (-0.79, 0.81),
        within: (-12.0, 12.0),
    }
}

fn formula(seed: u64) -> Option<Case> {
    let mut dice = Dice::new(seed);
    let (of, cells): (fn(&mut Dice) -> Formula, usize) = match seed % 5 {
        0 => (sines, 200),
        1 => (bumps, 200),
        2 => (steep_noise, 200),
        3 => (genes, 200),
        _ => (moving, 300),
    };
    Some(of(&mut dice).case(cells))
}

#[test]
fn what_is_located_where_nothing_is_a_polynomial_holds_the_truth() {
    let scores = run(cases(formula, 3000..3010));
    print(&scores);
    for (name, score) in &scores {
        assert_eq!((score.missed, score.false_located), (0, 0), "{name}");
    }
}

#[test]
#[ignore = "prints the table of docs/location.md"]
fn formulas_in_full() {
    let scores = run(cases(formula, 3000..3100));
    print_true(&scores);
}

//! Oscillators with a Hertz contact, max(x - c, 0)^1.5: their density is exp(-(U + v²/2)/T), and what every scheme errs
//! beside the place where the contact begins is larger than what schemes differ by.

use pbif::continuation::Solution;

use crate::common::numbers::Numbers;
use crate::common::sweeps::{measure, solved};

/// x'' = -g x' - (x - m) - K max(x - c, 0)^1.5 + √(2 g T) ξ.
struct Contact {
    damping: f64,
    temperature: f64,
    middle: f64,
    stiffness: f64,
    at: f64,
}

/// Steps of quadrature.
const STEPS: usize = 200_000;

impl Contact {
    fn random(numbers: &mut Numbers) -> Self {
        Self {
            damping: numbers.rounded(0.3, 1.0),
            temperature: numbers.rounded(0.2, 0.5),
            middle: numbers.rounded(-0.3, 0.4),
            stiffness: numbers.rounded(2.0, 8.0),
            at: numbers.rounded(0.2, 0.9),
        }
    }

    /// States with their probabilities.
    fn shares(&self) -> Vec<(f64, f64)> {
        let step = 10.0 / STEPS as f64;
        let weight = |x: f64| {
            let contact = 0.4 * self.stiffness * (x - self.at).max(0.0).powf(2.5);
            let potential = 0.5 * (x - self.middle).powi(2) + contact;
            (-potential / self.temperature).exp()
        };
        let places = (0..STEPS).map(|number| -5.0 + (number as f64 + 0.5) * step);
        let weights: Vec<(f64, f64)> = places.map(|x| (x, weight(x))).collect();
        let whole: f64 = weights.iter().map(|(_, weight)| weight).sum();
        weights
            .into_iter()
            .map(|(x, weight)| (x, weight / whole))
            .collect()
    }

    fn solved(&self, (from, to): (f64, f64), region: f64, cells: usize) -> Solution<'static> {
        let Self {
            damping,
            temperature,
            middle,
            stiffness,
            at,
        } = self;
        let fastest = 6.2 * temperature.sqrt();
        let text = format!(
            "[system.equations]\nx = \"v\"\nv = \"-g v - (x - {middle}) - {stiffness}*max(x - {at}, 0)^1.5\"\n\
             [system.noise]\nv = \"sqrt(2*{temperature} g)\"\n[system.parameters]\ng = {damping}\n\
             [sweep]\nparameter = \"g\"\nfrom = {damping}\nto = {}\npoints = 2\n\
             [cells]\nx = {{ from = {from}, to = {to}, count = {cells} }}\n\
             v = {{ from = -{fastest}, to = {fastest}, count = {cells} }}\n[visits]\nfar = \"x > {region}\"\n",
            1.1 * damping
        );
        solved(&text, "", Some(*damping)).1
    }
}

#[test]
fn means_and_shares_of_oscillators_with_a_hertz_contact_hold() {
    let mut numbers = Numbers(31);
    let mut ratios = Vec::new();
    for cells in [80, 100, 120] {
        let contact = Contact::random(&mut numbers);
        let shares = contact.shares();
        let mut sum = 0.0;
        let mut below = |share: f64| {
            sum += share;
            sum
        };
        let reached: Vec<(f64, f64)> = shares.iter().map(|&(x, share)| (x, below(share))).collect();
        let place = |probability: f64| {
            let first = reached.iter().find(|(_, sum)| *sum >= probability);
            (first.unwrap().0 * 1e4).round() / 1e4
        };
        let mean: f64 = shares.iter().map(|(x, share)| x * share).sum();
        let square: f64 = shares
            .iter()
            .map(|(x, share)| (x - mean).powi(2) * share)
            .sum();
        let region = place(0.7);
        let far: f64 = shares
            .iter()
            .filter(|(x, _)| *x > region)
            .map(|(_, share)| share)
            .sum();
        let solution = contact.solved((place(1e-9), place(1.0 - 1e-9)), region, cells);
        for (name, exact) in [
            ("mean_x", mean),
            ("sd_x", square.sqrt()),
            ("far_time_share", far),
        ] {
            let (value, error) = measure(&solution, name);
            ratios.push((value - exact).abs() / error);
        }
    }
    println!("{ratios:.2?}");
    assert!(ratios.iter().all(|&ratio| ratio <= 1.0), "{ratios:?}");
    assert!(
        ratios.iter().any(|&ratio| ratio > 0.2),
        "errors are far too wide: {ratios:?}"
    );
}

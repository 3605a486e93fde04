//! Systems of one axis with random numbers, all of whose answers are closed forms or series of positive terms: decay
//! rates, spectra, times of passage, moments of the coordinate and of formulas, beside ends where noise dies and under
//! tails that fall like powers.

mod kinds;

use crate::common::numbers::{Numbers, given};
use crate::common::sweeps::solved;
use kinds::KINDS;

/// Frequencies at which spectra are looked at, from zero to 5.
const FREQUENCIES: usize = 11;

/// A system with what is exact of it.
struct Case {
    what: String,
    /// Equation, noise, bounds and cells.
    drift: String,
    noises: Vec<String>,
    rest: String,
    formulas: Vec<(&'static str, String)>,
    passage: Option<String>,
    modes: usize,
    measures: Vec<(String, f64)>,
    /// Variance and rate of a spectrum 2 v r/(r² + ω²) of x.
    spectrum: Option<(f64, f64)>,
}

impl Case {
    fn new(what: String, drift: String, noises: &[String]) -> Self {
        Self {
            what,
            drift,
            noises: noises.to_vec(),
            rest: String::new(),
            formulas: Vec::new(),
            passage: None,
            modes: 0,
            measures: Vec::new(),
            spectrum: None,
        }
    }

    fn moments(&mut self, mean: f64, variance: f64) {
        self.measures.push(("mean_x".into(), mean));
        self.measures.push(("sd_x".into(), variance.sqrt()));
    }

    fn mean(&mut self, name: &'static str, formula: &str, exact: f64) {
        self.formulas.push((name, formula.to_owned()));
        self.measures.push((format!("mean_{name}"), exact));
    }

    fn rates(&mut self, rates: &[f64]) {
        self.modes = rates.len();
        for (number, rate) in rates.iter().enumerate() {
            self.measures
                .push((format!("decay_rate_{}", number + 1), *rate));
        }
    }

    fn passage(&mut self, from: f64, until: String, exact: f64) {
        self.passage = Some(format!(
            "[passage]\nup = {{ start = {{ x = {from:?} }}, until = \"{until}\" }}\n"
        ));
        self.measures.push(("up_mean".into(), exact));
    }

    fn text(&self) -> String {
        let noises: Vec<String> = self.noises.iter().map(|one| format!("\"{one}\"")).collect();
        let mut text = format!(
            "[system.equations]\nx = \"w*({})\"\n[system.noise]\nx = [{}]\ninterpretation = \"ito\"\n\
             [system.parameters]\nw = 1.0\n{}[sweep]\nparameter = \"w\"\nfrom = 0.999\nto = 1.0\npoints = 2\n",
            self.drift,
            noises.join(", "),
            self.rest
        );
        if !self.formulas.is_empty() {
            text += "[watch]\n";
            for (name, formula) in &self.formulas {
                text += &format!("{name} = \"{formula}\"\n");
            }
        }
        text += self.passage.as_deref().unwrap_or("");
        if self.modes > 0 {
            text += &format!("[relaxation]\nmodes = {}\n", self.modes);
        }
        if self.spectrum.is_some() {
            text += &format!("[spectrum]\nof = [\"x\"]\nto = 5.0\npoints = {FREQUENCIES}\n");
        }
        text
    }

    /// |value - exact| over the stated error of every number, with the stated error over the size of the exact one.
    fn shares(&self) -> Vec<(String, f64, f64)> {
        let (_, point) = solved(&self.text(), "", Some(1.0));
        let mut all = Vec::new();
        let mut add = |name: String, value: f64, error: Option<f64>, exact: f64| {
            let error = error.unwrap_or_else(|| panic!("{}: {name} has no error", self.what));
            // What an exact number rounds by.
            let off = (value - exact).abs() / (error + 1e-13 * exact.abs());
            let size = if exact == 0.0 { 1.0 } else { exact.abs() };
            if off > 1.0 {
                println!("{}: {name} {value} ± {error:e}, exactly {exact}", self.what);
            }
            all.push((name, off, error / size));
        };
        for (name, exact) in &self.measures {
            let found = point.report.measures.iter().find(|one| one.name == *name);
            let found = found
                .unwrap_or_else(|| panic!("{}: no {name}, {:?}", self.what, point.report.findings));
            add(name.clone(), found.value, found.error, *exact);
        }
        if let Some((variance, rate)) = self.spectrum {
            let known = &point.report.fluctuations[0].power;
            for (number, (value, error)) in known.iter().enumerate() {
                let frequency = 5.0 * number as f64 / (FREQUENCIES - 1) as f64;
                let exact = 2.0 * variance * rate / (rate * rate + frequency * frequency);
                add(format!("spectrum {frequency}"), *value, Some(*error), exact);
            }
        }
        all
    }
}

/// What is said of `count` systems from a seed on, as rows of a table: numbers of a kind, how many of them are off by
/// more than a half and more than all of their errors, the largest share, the median and the largest relative error.
fn hold(seed: u64, count: usize) {
    let mut numbers = Numbers(seed);
    let mut all: Vec<(String, f64, f64)> = Vec::new();
    for number in 0..count {
        let case = KINDS[number % KINDS.len()](&mut numbers);
        all.extend(case.shares());
    }
    let kind = |name: &str| match name.split(['_', ' ']).next().unwrap() {
        "mean" if name == "mean_x" => "mean and deviation of x",
        "sd" => "mean and deviation of x",
        "mean" => "means of formulas",
        "decay" => "decay rates",
        "spectrum" => "spectra",
        _ => "mean times of passage",
    };
    for wanted in [
        "mean and deviation of x",
        "means of formulas",
        "decay rates",
        "spectra",
        "mean times of passage",
    ] {
        let own = all.iter().filter(|(name, ..)| kind(name) == wanted);
        let (mut shares, mut errors): (Vec<f64>, Vec<f64>) = own.map(|one| (one.1, one.2)).unzip();
        shares.sort_by(f64::total_cmp);
        errors.sort_by(f64::total_cmp);
        let above = |limit: f64| shares.iter().filter(|share| **share > limit).count();
        println!(
            "| {wanted} | {} | {} | {} | {:.2} | {:.1e} | {:.1e} |",
            shares.len(),
            above(0.5),
            above(1.0),
            shares[shares.len() - 1],
            errors[errors.len() / 2],
            errors[errors.len() - 1]
        );
    }
    let worst = all.iter().map(|(_, share, _)| *share).fold(0.0, f64::max);
    assert!(worst <= 1.0, "{worst}");
}

#[test]
fn random_systems_of_one_axis_hold_what_is_exact_of_them() {
    hold(11, 7);
}

#[test]
#[ignore = "takes half a minute: cargo test --release --test truth -- --ignored one_axis"]
fn random_systems_of_one_axis_hold_what_is_exact_of_them_at_length() {
    hold(given("SEED", 2024), given("COUNT", 63) as usize);
}

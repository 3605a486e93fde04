//! Random systems by stochastic generalized cell mapping with its defaults, each with a seed of its own: intervals must
//! hold the truth, or say that they do not know.

use pbif::method::{MethodOptions, MethodSource, SgcmOptions};

use super::*;

/// A system on one axis whose density splits at a centre, or is born in a fold.
struct Sampled {
    family: &'static str,
    drift: String,
    noise: String,
    bounds: Option<(f64, f64)>,
    within: (f64, f64),
    ends: (f64, f64),
    truths: Vec<f64>,
}

fn sampled(dice: &mut Dice, kind: u64) -> Sampled {
    let half = dice.between(0.8, 1.5);
    let shift = dice.between(-0.3, 0.3);
    match kind {
        0 => {
            let s = dice.between(0.1, 1.0);
            Sampled {
                family: "SGCM, additive noise",
                drift: "theta x - x^3".to_owned(),
                noise: format!("sqrt({s})"),
                bounds: None,
                within: (-2.5, 2.5),
                ends: (shift - half, shift + half),
                truths: vec![0.0],
            }
        }
        1 => {
            // Less b b' = s r x.
            let (s, r) = (dice.between(0.2, 1.0), dice.between(0.3, 1.0));
            let truth = s * r;
            Sampled {
                family: "SGCM, noise that grows with the square",
                drift: "theta x - x^3".to_owned(),
                noise: format!("sqrt({s} (1 + {r} x^2))"),
                bounds: None,
                within: (-3.5, 3.5),
                ends: (truth + shift - half, truth + shift + half),
                truths: vec![truth],
            }
        }
        2 => {
            // Of 1/2 - x and b = (s)^(1/2) x (1 - x): 1/2 splits at s = 2.
            let rate = dice.between(0.5, 2.0);
            Sampled {
                family: "SGCM, noise between two walls",
                drift: format!("{rate} (0.5 - x)"),
                noise: "sqrt(theta) x (1 - x)".to_owned(),
                bounds: Some((0.0, 1.0)),
                within: (0.0, 1.0),
                ends: (rate * 1.0, rate * 3.5),
                truths: vec![2.0 * rate],
            }
        }
        _ => {
            let s = dice.between(0.3, 1.0);
            Sampled {
                family: "SGCM, a tilted well",
                drift: "theta + x - x^3".to_owned(),
                noise: format!("sqrt({s})"),
                bounds: None,
                within: (-2.6, 2.6),
                ends: (-0.1, 0.9),
                truths: vec![0.384_900_2],
            }
        }
    }
}

/// The rows of one system.
fn solved(system: &Sampled, seed: u64, points: usize) -> Vec<Located> {
    let mut model = TypedModel::new("random", "A random system", ["x"])
        .with_equation("x", &system.drift)
        .with_noise("x", [system.noise.clone()])
        .with_interpretation(Interpretation::Ito)
        .with_parameters(["theta"]);
    if let Some((low, high)) = system.bounds {
        model = model.with_bounds("x", low.to_string(), high.to_string());
    }
    let path = Path::parameter("theta", system.ends.0, system.ends.1);
    let family = Family::new(model.build().unwrap(), &[], path).unwrap();
    let axis = Axis::uniform(system.within.0, system.within.1, 100).unwrap();
    let space = CellSpace::new(vec![axis]).unwrap();
    let problem = Problem::new(family, space, vec![Observable::Marginal(0)]).unwrap();
    let options = MethodOptions::Sgcm(SgcmOptions {
        seed,
        ..SgcmOptions::default()
    });
    let never = Cancellation::new();
    let source = MethodSource::new(&problem, &options, &never).unwrap();
    let detector = PersistenceDetector::new(DetectOptions::default(), points);
    let locate = LocateOptions::default();
    let found = sweep(&source, &detector, points, &locate, &never, &mut ()).unwrap();
    found.bifurcations().cloned().collect()
}

fn run_sampled(
    kinds: std::ops::Range<u64>,
    seeds: std::ops::Range<u64>,
) -> Vec<(&'static str, Score, Vec<f64>)> {
    let mut scores: Vec<(&'static str, Score, Vec<f64>)> = Vec::new();
    for kind in kinds {
        for seed in seeds.clone() {
            let system = sampled(&mut Dice::new(6000 + 100 * kind + seed), kind);
            let rows = solved(&system, seed, 21);
            let words = format!("x' = {} + {} ξ, seed {seed}", system.drift, system.noise);
            let found = Found {
                rows,
                failures: Vec::new(),
            };
            let score = Score::of(&system.truths, &found);
            println!("{}", told((&words, &system.truths), &found));
            let ratios = found
                .rows
                .iter()
                .map(|row| (row.value - system.truths[0]) / row.error);
            match scores.iter_mut().find(|one| one.0 == system.family) {
                Some(one) => {
                    one.1.add(&score);
                    one.2.extend(ratios);
                }
                None => scores.push((system.family, score, ratios.collect())),
            }
        }
    }
    for (name, score, ratios) in &scores {
        let square: f64 = ratios.iter().map(|one| one * one).sum();
        let square = (square / ratios.len().max(1) as f64).sqrt();
        println!("{} {square:.2}", score.row(name));
    }
    scores
}

#[test]
#[ignore = "prints the table of docs/location.md"]
fn sampled_in_full() {
    run_sampled(0..4, 0..20);
}

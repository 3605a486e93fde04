//! Sample paths of the live page.

use super::live::{Served, decoded};

/// Asks for paths at some values, from states with their seeds.
fn ask_paths(
    served: &Served,
    values: &str,
    starts: &[(Vec<f64>, u64)],
    turns: f64,
) -> serde_json::Value {
    static TICKET: std::sync::atomic::AtomicU64 = std::sync::atomic::AtomicU64::new(1);
    let ticket = TICKET.fetch_add(1, std::sync::atomic::Ordering::SeqCst);
    let start = |(state, seed): &(Vec<f64>, u64)| serde_json::json!({"state": state, "seed": seed});
    let starts: Vec<serde_json::Value> = starts.iter().map(start).collect();
    let starts = serde_json::Value::from(starts);
    let body = format!(
        r#"{{"lane":"paths","ticket":{ticket},"values":{values},"starts":{starts},"turns":{turns}}}"#
    );
    let (code, answer) = served.post("paths", &body);
    assert_eq!(code, 200, "{answer}");
    answer
}

/// The states of every path of an answer.
fn states(answer: &serde_json::Value) -> Vec<Vec<Vec<f64>>> {
    let done = &answer["done"];
    let dimension = done["dimension"].as_u64().unwrap() as usize;
    let path = |path: &serde_json::Value| {
        let bytes = decoded(&path["states"]);
        let numbers: Vec<f64> = (bytes.chunks_exact(4))
            .map(|four| f64::from(f32::from_le_bytes(four.try_into().unwrap())))
            .collect();
        numbers.chunks(dimension).map(<[f64]>::to_vec).collect()
    };
    let paths = done["paths"].as_array();
    assert!(paths.is_some(), "{answer}");
    paths.unwrap().iter().map(path).collect()
}

#[test]
fn sample_paths_are_the_same_again_and_bounded() {
    let served = Served::new();
    let starts = [(vec![0.3, -0.2], 1), (vec![0.0, 0.0], 2)];
    let first = ask_paths(&served, r#"{"f_c":0.0}"#, &starts, 2.0);
    let paths = states(&first);
    assert_eq!(paths.len(), 2);
    for (path, (start, _)) in paths.iter().zip(&starts) {
        assert!(path.len() > 100 && path.len() <= 3001, "{}", path.len());
        let near = |(a, b): (&f64, &f64)| (a - b).abs() < 1e-7;
        assert!(path[0].iter().zip(start).all(near));
    }
    assert_ne!(paths[0], paths[1]);
    let done = &first["done"];
    // Two periods of an oscillator of frequency near one.
    let periods = done["time"].as_f64().unwrap() / std::f64::consts::TAU;
    assert!((1.5..2.5).contains(&periods), "{first}");
    // The same request, alone or beside another, by this server or another one.
    let other = Served::new();
    for (served, starts) in [(&served, &starts[..]), (&other, &starts[..1])] {
        let again = states(&ask_paths(served, r#"{"f_c":0.0}"#, starts, 2.0));
        assert_eq!(again[..], paths[..starts.len()]);
    }
    // However long a path is asked for, it ends, and its states do not stand further apart for that.
    let long = ask_paths(&served, r#"{"f_c":0.0}"#, &starts[..1], 140.0);
    assert!(states(&long)[0].len() <= 3001);
    assert!(long["done"]["steps"].as_u64().unwrap() <= 200_000);
    let apart = long["done"]["time"].as_f64().unwrap() / states(&long)[0].len() as f64;
    assert!(apart < 0.4, "{apart}");
}

/// Mean of eight estimates and its error: Student's t of seven degrees of freedom exceeds 4.8 once in 500 times; the
/// streams are fixed.
fn of_eight(estimates: &[f64]) -> (f64, f64) {
    let mean = estimates.iter().sum::<f64>() / 8.0;
    let squares = estimates.iter().map(|one| (one - mean).powi(2));
    (mean, 4.8 * (squares.sum::<f64>() / 7.0 / 8.0).sqrt())
}

#[test]
fn sample_paths_go_where_the_density_is() {
    let served = Served::new();
    let body = r#"{"lane":"a","ticket":1,"moving":"f_c","values":{"f_c":0.002,"kappa":0.1}}"#;
    let (_, solved) = served.post("solve", body);
    let moments = &solved["done"]["frame"]["moments"];
    let starts: Vec<(Vec<f64>, u64)> = (1..=8).map(|seed| (vec![0.0, 0.0], seed)).collect();
    let found = states(&ask_paths(
        &served,
        r#"{"f_c":0.002,"kappa":0.1}"#,
        &starts,
        140.0,
    ));
    for axis in 0..2 {
        let moment = |k: usize| moments[axis][k].as_f64().unwrap();
        let expected = [moment(0), moment(0).powi(2) + moment(1).powi(2)];
        for (power, expected) in (1..).zip(expected) {
            // Each path is an estimate of its own once it has forgotten its start; their spread tells the error of
            // their mean.
            let means: Vec<f64> = (found.iter())
                .map(|path| {
                    let settled = &path[path.len() / 4..];
                    let sum: f64 = settled.iter().map(|state| state[axis].powi(power)).sum();
                    sum / settled.len() as f64
                })
                .collect();
            let (mean, error) = of_eight(&means);
            assert!(
                (mean - expected).abs() < error && error < 0.5 * moment(1).powi(power),
                "axis {axis}, power {power}: {mean} {expected} {error}"
            );
        }
    }
}

#[test]
fn sample_paths_follow_internal_states_and_the_memory_of_noise() {
    let dahl = include_str!("../../sweeps/dahl_alpha.toml");
    let served = Served::of(dahl, "cells.z.modes=6");
    let paths = states(&ask_paths(
        &served,
        r#"{"alpha":-0.5}"#,
        &[(vec![0.5, 0.0, 0.0], 1)],
        2.0,
    ));
    // Dahl's z stays between ±f_c/λ, to the error of a step.
    let bound = 0.05 / 0.06;
    assert!(paths[0].iter().all(|state| state[2].abs() < 1.01 * bound));
    assert!(paths[0].iter().any(|state| state[2].abs() > 0.1 * bound));

    let coloured = include_str!("../../sweeps/gallery/coloured_bistable.toml");
    let served = Served::of(coloured, "");
    let starts: Vec<(Vec<f64>, u64)> = (1..=8).map(|seed| (vec![0.0, 0.0], seed)).collect();
    let found = states(&ask_paths(&served, r#"{"tau":0.3}"#, &starts, 140.0));
    let squares: Vec<f64> = (found.iter())
        .map(|path| path.iter().map(|state| state[1].powi(2)).sum::<f64>() / path.len() as f64)
        .collect();
    // The filter's state has the variance one.
    let (mean, error) = of_eight(&squares);
    assert!((mean - 1.0).abs() < error && error < 0.5, "{mean} {error}");
}

#[test]
fn paths_that_cannot_be_followed_are_refused_in_words() {
    let served = Served::new();
    let refused = |values: &str, starts: &[(Vec<f64>, u64)], turns: f64| {
        let answer = ask_paths(&served, values, starts, turns);
        answer["refused"].as_str().unwrap_or_default().to_owned()
    };
    let here = r#"{"f_c":0.0}"#;
    let start = [(vec![0.0, 0.0], 1)];
    assert!(refused(here, &[], 2.0).contains("1 to 8"));
    assert!(refused(here, &vec![start[0].clone(); 9], 2.0).starts_with("9 paths"));
    assert!(refused(here, &[(vec![0.0], 1)], 2.0).contains("a state has 2"));
    let outside = refused(here, &[(vec![0.0, 0.0], 1), (vec![0.0, 77.0], 2)], 2.0);
    assert!(outside.starts_with("path 2 starts at y = 77"), "{outside}");
    for turns in [0.0, -1.0, 1e7] {
        assert!(refused(here, &start, turns).contains("turns"));
    }
    assert!(refused("{}", &start, 2.0).contains("`f_c`"));
    assert!(refused(r#"{"f_c":0.0,"friction":1}"#, &start, 2.0).contains("no parameter"));
    let negative = r#"{"f_c":0.0,"sigma2":-1.0}"#;
    assert!(refused(negative, &start, 2.0).contains("greater than zero"));
    // What is no request at all.
    let (_, answer) = served.post("paths", r#"{"lane":"a"}"#);
    assert!(
        answer["refused"]
            .as_str()
            .unwrap()
            .contains("missing field")
    );
}

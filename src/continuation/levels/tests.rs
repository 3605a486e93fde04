//! Roots of measures, and those that are none.

use super::*;

fn root_of(measure: impl Fn(f64) -> f64, at: &[f64]) -> Root {
    let sample = |&at: &f64| Excess {
        at,
        over: measure(at),
        error: 1e-9,
        is_judged: true,
        follows: true,
    };
    let samples: Vec<Excess> = at.iter().map(sample).collect();
    let mut found = roots(&samples);
    assert_eq!(found.len(), 1);
    found.remove(0)
}

#[test]
fn a_measure_that_jumps_over_its_level_has_no_root_there() {
    let near = [0.0, 0.3, 0.49, 0.51, 0.7, 1.0];
    let smooth = root_of(|at| (at - 0.5) * (2.0 + at), &near);
    assert!(!smooth.is_jump && (smooth.value - 0.5).abs() < 1e-9);
    // Another mode becomes the slowest: from above zero to far below, with slopes on either side.
    let other = |at: f64| if at < 0.5 { 0.2 - 0.1 * at } else { -1.0 - at };
    let jump = root_of(other, &near);
    assert!(jump.is_jump);
    let level = MeasureLevel {
        measure: DECAY_DISCRIMINANT.word.to_owned(),
        level: 0.0,
    };
    assert_eq!(row((&level, false), &jump, 0.1).doubts, [Doubt::Jump]);
    // A jump beside the first value, which happens to be near the level: one sample is asked for, and then tells.
    let few = [0.49, 0.51, 0.7, 1.0];
    let other = |at: f64| if at < 0.5 { 1e-5 } else { -1.0 - at };
    let one_sided = root_of(other, &few);
    assert!(one_sided.is_jump && one_sided.alone == Some(0.49));
    let more = [0.49, 0.5 * (0.49 + one_sided.value), 0.51, 0.7, 1.0];
    let jump = root_of(other, &more);
    assert!(jump.is_jump && jump.alone.is_none());
    // What goes to zero from one side needs no second sample on the other.
    let smooth = root_of(|at| (at - 0.495) * (2.0 + at), &few);
    assert!(!smooth.is_jump && smooth.alone.is_none());
}

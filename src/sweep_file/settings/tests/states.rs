//! Settings of internal states and of noise with memory: axes of modes, and where they cannot be.

use super::*;

#[test]
fn an_internal_state_is_carried_by_modes_unless_cells_are_given() {
    let modes = |sets: &[&str]| parse(DAHL, sets).unwrap().axes[2].modes;
    assert_eq!(modes(&[]), Some(Modes::Auto));
    assert_eq!(modes(&["cells.z.modes=5"]), Some(Modes::Number(5)));
    assert_eq!(modes(&["cells.z.count=8"]), None);
    // What is watched leaves the axis out.
    let spec = parse(DAHL, &["cells.z.modes=5"]).unwrap();
    assert_eq!(spec.observables.len(), 3);
    let sweep = spec.prepare(&Cancellation::new()).unwrap();
    assert_eq!(sweep.problem.space().shape(), [12, 12, 5]);
    let again = SweepFile::parse("a.toml", &sweep.to_toml())
        .validate()
        .unwrap();
    assert_eq!(again.axes, sweep.settings.axes);
    // Where it is asked for it is laid out over bins; quantities of the other axes are watched too.
    let asked = [
        "cells.z.modes=5",
        "detect.marginals=[\"z\"]",
        "detect.joint=[[\"y\", \"z\"]]",
        "watch.power=\"y^2\"",
    ];
    let sweep = parse(DAHL, &asked)
        .unwrap()
        .prepare(&Cancellation::new())
        .unwrap();
    let problem = &sweep.problem;
    let laid = |observable: &Observable| -> Vec<usize> {
        problem
            .axes_of(*observable)
            .iter()
            .map(|axis| axis.count())
            .collect()
    };
    let laid: Vec<Vec<usize>> = problem.observables().iter().map(laid).collect();
    assert_eq!(laid, [vec![60], vec![12, 60]]);
    // Methods that take no modes have cells there, as many as the program finds.
    let sampled = parse(DAHL, &["method.kind=sgcm"]).unwrap();
    assert_eq!((sampled.axes[2].count, sampled.axes[2].modes), (None, None));
    // Both may be given: the method decides.
    let both = ["cells.z={modes=5, count=8}", "method.kind=sgcm"];
    assert_eq!(
        parse(DAHL, &both)
            .unwrap()
            .fixed()
            .unwrap()
            .problem
            .space()
            .shape(),
        [12, 12, 8]
    );
}

#[test]
fn coloured_noise_adds_an_axis_and_a_parameter_and_is_written_down_again() {
    let sets = [&COLOURED[..], &["cells.z.modes=4", "cells.noise.modes=3"]].concat();
    let spec = parse(DAHL, &sets).unwrap();
    assert_eq!(spec.observables.len(), 3);
    assert_eq!(spec.axes[3].range(), Some((-6.0, 6.0)));
    let sweep = spec.prepare(&Cancellation::new()).unwrap();
    assert_eq!(sweep.problem.space().shape(), [12, 12, 4, 3]);
    let again = SweepFile::parse("a.toml", &sweep.to_toml())
        .validate()
        .unwrap();
    assert_eq!(again.axes, sweep.settings.axes);
    assert_eq!(again.to_toml(), sweep.to_toml());
    // Its modes are found where nothing is said.
    assert_eq!(
        parse(DAHL, &COLOURED).unwrap().axes[3].modes,
        Some(Modes::Auto)
    );
    let sampled = [&COLOURED[..], &["method.kind=sgcm"]].concat();
    let sampled = parse(DAHL, &sampled).unwrap();
    assert_eq!((sampled.axes[3].count, sampled.axes[3].modes), (None, None));
    // Its correlation time can be swept, of equations too.
    let typed = EQUATIONS.replace(
        "interpretation = \"ito\"\n",
        "kind = \"ornstein-uhlenbeck\"\n",
    );
    let typed = typed.replace("parameter = \"D\"", "parameter = \"tau\"");
    let spec = parse(&typed, &["system.parameters.D=0.1"]).unwrap();
    assert_eq!(spec.family.parameter(), "tau");
    let text = spec.to_toml();
    let again = SweepFile::parse("a.toml", &text).validate().unwrap();
    assert_eq!(again.to_toml(), text);
}

#[test]
fn coloured_noise_where_it_cannot_be_is_refused_with_the_remedy() {
    let kind = "system.noise.kind=ornstein-uhlenbeck";
    for (text, sets, words) in [
        (DAHL, &[kind][..], "model `dahl` needs parameter `tau`"),
        (
            DAHL,
            &[kind, "system.parameters.tau=0"],
            "a finite number greater than zero",
        ),
        (
            DAHL,
            &[
                COLOURED[0],
                COLOURED[1],
                "cells.noise={from=-1, to=1, modes=4}",
            ],
            "axis `noise` cannot have modes: the modes of noise have a range of their own",
        ),
        (
            EQUATIONS,
            &[kind, "system.parameters.tau=1"],
            "goes to white noise in Stratonovich's reading only",
        ),
    ] {
        let message = parse(text, sets).unwrap_err().to_string();
        assert!(message.contains(words), "{sets:?}: {message}");
    }
}

#[test]
fn friction_that_sticks_is_refused_before_anything_is_solved() {
    let sets = [COLOURED[0], COLOURED[1], "sweep.to=0.01"];
    let spec = parse(FILE, &sets).unwrap();
    let refused = spec.prepare(&Cancellation::new()).err().unwrap();
    let message = refused.to_string();
    assert!(
        message.contains("friction sticks: beside y = 0"),
        "{message}"
    );
    assert!(
        message.contains("= help: use a friction law with an internal state"),
        "{message}"
    );
}

#[test]
fn modes_where_they_cannot_be_are_refused_with_the_remedy() {
    let refusal = |sets: &[&str]| parse(DAHL, sets).unwrap_err().to_string();
    for (sets, words) in [
        (
            &["cells.y={from=-1, to=1, modes=4}"][..],
            "axis `y` cannot have modes: noise drives it",
        ),
        (
            &["cells.x={from=-1, to=1, modes=4}"],
            "axis `x` cannot have modes: the model knows no bounds",
        ),
        (
            &["cells.z={from=-0.1, to=0.1, modes=4}"],
            "axis `z` cannot have modes: the state may leave",
        ),
        (
            &["cells.z.modes=1"],
            "an integer from 2 to 128, or `\"auto\"`",
        ),
    ] {
        let message = refusal(sets);
        assert!(message.contains(words), "{sets:?}: {message}");
    }
}

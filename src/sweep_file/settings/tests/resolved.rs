//! The resolved file: it gives the same settings again, and holds every key.

use super::*;
use crate::method::MethodOptions;
use crate::sweep_file::keys;

#[test]
fn the_resolved_file_gives_the_same_sweep() {
    let sets: [&[&str]; 3] = [
        &[],
        &[
            "title=a \"quoted\" \\ title",
            "sweep.from=0.01",
            "sweep.to=-1e-300",
            "sweep.points=2",
            "system.parameters.kappa=0.1234567890123456789",
            "method.map_step=1",
            "method.time_step=1e-3",
            "method.seed=9223372036854775807",
            "method.integrator=euler-maruyama",
            "method.solver=power",
        ],
        &[
            "detect.marginals=[]",
            "detect.joint=[[\"y\", \"x\"]]",
            "figures.at=[]",
            "figures.formats=[\"png\"]",
            "cells.y={from=0, to=1, count=7}",
        ],
    ];
    for overrides in sets {
        let mut overrides = overrides.to_vec();
        // A title with quotes has to be TOML.
        if let Some(first) = overrides
            .first_mut()
            .filter(|first| first.starts_with("title"))
        {
            *first = r#"title="a \"quoted\" \\ title""#;
        }
        let spec = parse(FILE, &overrides).unwrap();
        let mut again = parse(&spec.to_toml(), &[]).unwrap();
        assert_eq!(spec.to_toml(), again.to_toml());
        // Settings of the methods that the sweep does not use are for `compare`, which reads the file itself.
        again.method = spec.method.clone();
        // They stand in other texts.
        again.document = spec.document.clone();
        // Debug output of numbers has every digit.
        assert_eq!(format!("{spec:?}"), format!("{again:?}"));
    }
}

#[test]
fn the_resolved_file_holds_every_key() {
    // Between them the resolved files of all methods, and of equations; `range` has become numbers.
    let texts = MethodOptions::KINDS.map(|kind| {
        let kind = format!("method.kind={kind}");
        parse(FILE, &[&kind, "locate.tolerance=1e-3"])
            .unwrap()
            .to_toml()
    });
    let [generator, sgcm, monte_carlo] = texts;
    let map = ["map.parameter=\"sigma2\"", "map.from=0.005", "map.to=0.02"];
    let curve = map.map(|set| set.replace("map", "curve"));
    let all = [
        "curve.first_from=-0.01",
        "curve.first_to=0.0",
        "curve.rows=[\"PB1\"]",
    ];
    let curve: Vec<&str> = curve.iter().map(String::as_str).chain(all).collect();
    let texts = [
        generator,
        sgcm,
        monte_carlo,
        parse(EQUATIONS, &[]).unwrap().to_toml(),
        parse(DAHL, &["cells.z.modes=5"]).unwrap().to_toml(),
        parse(&ANGLE.replace("phi", "y"), &[]).unwrap().to_toml(),
        parse(DAHL, &COLOURED).unwrap().to_toml(),
        parse(FILE, &map).unwrap().to_toml(),
        parse(FILE, &curve).unwrap().to_toml(),
    ];
    let text = texts.join("\n# next\n");
    let tables = texts.map(|text| text.parse::<toml::Table>().unwrap());
    let keys = keys::keys().iter();
    // Formulas of quantities and their bins are written where quantities are watched, which the tests of quantities do.
    // Sizes of print that follow from the width stay open.
    // Derived measures, regions, passages, visits, levels, exponents, slow modes and spectra are written where they are
    // asked for.
    let open = [
        "figures.style.text",
        "figures.style.line",
        "detect.measures",
    ];
    let written = |path: &str| {
        let asked = [
            "watch.",
            "regions.",
            "passage.",
            "visits.",
            "levels.",
            "exponent.",
            "relaxation.",
            "spectrum.",
        ];
        let of_quantity =
            path.contains("<quantity>") || asked.iter().any(|section| path.starts_with(section));
        !path.ends_with(".range") && !of_quantity && !open.contains(&path)
    };
    for key in keys.filter(|key| written(key.path())) {
        let named = key
            .path()
            .replace("<parameter>", "kappa")
            .replace(
                "<axis>",
                if key.path().ends_with(".modes") {
                    "z"
                } else {
                    "y"
                },
            )
            .replace("<name>", "force");
        let (first, rest) = named.split_once('.').unwrap_or((&named, ""));
        let found = tables.iter().any(|table| {
            let mut value = table.get(first);
            for part in rest.split('.').filter(|part| !part.is_empty()) {
                value = value.and_then(|value| value.get(part));
            }
            value.is_some()
        });
        assert!(found, "{named} not in\n{text}");
    }
}

#[test]
fn a_number_for_an_axis_is_its_count() {
    let [short, long] =
        ["cells.y=12", "cells.y={count=12}"].map(|set| parse(FILE, &[set]).unwrap());
    assert_eq!(short.to_toml(), long.to_toml());
    let words = parse(FILE, &["cells.y=1"]).unwrap_err().to_string();
    assert!(words.contains("`cells.y.count` cannot be `1`"), "{words}");
}

//! Maps of regimes over two parameters, against signatures and curves that are known exactly.

use std::sync::atomic::{AtomicUsize, Ordering};

use pbif::cancellation::Cancellation;
use pbif::continuation::BifurcationStatus;
use pbif::continuation::DensitySource;
use pbif::continuation::curve::CurvePoint;
use pbif::continuation::map::{MapProgress, RegimeMap};
use pbif::run::{Journal, JournalledSource};
use pbif::topology::Signature;

use super::support::{assert_on, mapped, off_the_fold};
use crate::common::room::Room;
use crate::common::sweeps::{prepared, settings};

/// Additive noise: peaks of the density are zeros of the drift, and there are two where 27 h² < 4 a³.
pub(super) const CUSP: &str = r#"
system.equations = { x = "h + a x - x^3" }
system.noise = { x = "sqrt(sigma2)" }
system.parameters = { a = 0.0, h = 0.0, sigma2 = 0.1 }
sweep = { parameter = "h", from = -0.5, to = 0.5, points = 11 }
map = { parameter = "a", from = -0.4, to = 1.0, depth = 1 }
cells.x = { from = -2.5, to = 2.5, count = 200 }
"#;

/// With damping -a + bH the crater opens at a = 0, and x splits at a = 0.540903 √(b σ²).
pub(super) const RAYLEIGH: &str = r#"
system.model = "rayleigh"
system.parameters = { b = 0.1 }
sweep = { parameter = "a", from = -0.02, to = 0.06, points = 5 }
map = { parameter = "sigma2", from = 0.01, to = 0.03, points = 4, depth = 1 }
cells.x = { from = -2.8, to = 2.8, count = 50 }
cells.y = { from = -2.8, to = 2.8, count = 50 }
detect = { marginals = ["x"], joint = [["x", "y"]] }
locate = { relative_tolerance = 1e-3 }
"#;

/// With nodes on f_c = 0, where y changes.
const COULOMB: &str = r#"
system.model = "coulomb"
system.parameters = { kappa = 0.05, mu = 0.05 }
sweep = { parameter = "f_c", from = -0.03, to = 0.03, points = 7 }
map = { parameter = "sigma2", from = 0.03, to = 0.07, points = 5, depth = 0 }
cells.x = { from = -4.0, to = 4.0, count = 40, grade = { at = [0.0], smallest = 0.08 } }
cells.y = { from = -4.0, to = 4.0, count = 40, grade = "auto" }
detect = { marginals = ["x", "y"], joint = [] }
locate = { relative_tolerance = 2e-3 }
"#;

/// Dahl's z lies within f_c/λ, which the second parameter moves.
const DAHL: &str = r#"
system.model = "dahl"
system.parameters = { kappa = 0.1, mu = 1.0, lambda = 0.1, sigma2 = 0.05 }
sweep = { parameter = "alpha", from = -0.2, to = 0.1, points = 2 }
map = { parameter = "f_c", from = 0.03, to = 0.08, points = 2, depth = 0, curves = "off" }
cells.x = { from = -2.0, to = 2.0, count = 24 }
cells.y = { from = -2.0, to = 2.0, count = 20 }
cells.z = { modes = 4 }
detect = { marginals = ["x"], joint = [] }
"#;

#[test]
fn a_tilted_double_well_has_two_peaks_within_the_cusp_and_one_outside() {
    let map = mapped(CUSP, "");
    let coarse = map.nodes.iter().filter(|node| node.level == 0).count();
    assert_eq!(coarse, 121);
    // Refined where the fold passes, and only there.
    assert!((150..300).contains(&map.nodes.len()), "{}", map.nodes.len());
    for node in &map.nodes {
        let [h, a] = node.values;
        let two = a > 0.0 && 27.0 * h * h < 4.0 * a.powi(3);
        // A shallow peak is counted a little after its birth.
        let late = a > -0.05 && off_the_fold(node.values, [1.0, 1.4]).abs() < 0.03;
        let peaks = if two { 2 } else { 1 };
        assert!(
            late || node.signatures == [Signature::of_peaks(peaks)],
            "{node:?}"
        );
    }
    // Both branches of the fold, each once, and nothing else.
    assert_eq!(map.curves.len(), 2, "{:?}", map.untraced);
    for curve in &map.curves {
        // In the cusp itself the distance is that of the point.
        let is_cusp = |[h, a]: [f64; 2]| a < 0.01 && h.abs() < 1e-3;
        assert_on(curve, 1e-4, |values| match is_cusp(values) {
            true => 0.0,
            false => off_the_fold(values, [1.0, 1.4]),
        });
        let highest = curve.points.iter().map(|point| point.values[0].abs());
        assert!((highest.fold(0.0, f64::max) - 0.3849).abs() < 1e-3);
        // All but perhaps the cusp.
        let located = |point: &&CurvePoint| point.status() == BifurcationStatus::Located;
        assert!(curve.points.iter().filter(located).count() + 1 >= curve.points.len());
    }
    let sides: f64 = map
        .curves
        .iter()
        .map(|curve| curve.points[curve.start].values[0].signum())
        .sum();
    assert_eq!(sides, 0.0);
    assert!(map.untraced.is_empty(), "{:?}", map.untraced);
    // They meet in one point.
    let cusps = map.codimension_two();
    assert_eq!(cusps.len(), 1, "{cusps:?}");
    let off = cusps[0].values[0].hypot(cusps[0].values[1] / 1.4);
    assert!(off <= cusps[0].error && off < 1e-3, "{:?}", cusps[0]);
    assert_eq!(
        (cusps[0].label.as_str(), cusps[0].curves.as_slice()),
        ("CP1", &[0, 1][..])
    );

    // ∫ 2 · 2 (a/3)^{3/2} da up to 1, over the box of 1 by 1.4.
    let exact = 1.6 / 3.0_f64.powf(1.5) / 1.4;
    let picture = map.regions(0, [280, 280]).unwrap();
    let two = picture
        .regions
        .iter()
        .filter(|one| one.signature == Some(Signature::of_peaks(2)));
    let two: Vec<_> = two.filter(|region| region.share > 1e-3).collect();
    assert_eq!(two.len(), 1);
    assert!(
        (two[0].share - exact).abs() < 0.01,
        "{} {exact}",
        two[0].share
    );
    let [h, a] = two[0].inside;
    assert!(27.0 * h * h < 4.0 * a.powi(3));

    // A density of each regime.
    let peaks = map.samples.iter().map(|sample| {
        let values = &sample.density.values;
        values
            .windows(3)
            .filter(|three| three[1] > three[0] && three[1] >= three[2])
            .count()
    });
    assert_eq!(peaks.collect::<Vec<_>>(), [1, 2]);
}

#[test]
fn a_map_is_the_same_on_any_number_of_threads() {
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap();
        pool.install(|| mapped(RAYLEIGH, "map.depth=0"))
    };
    let (one, three) = (on(1), on(3));
    assert_eq!(one.nodes, three.nodes);
    assert_eq!(one.curves.len(), three.curves.len());
    for (a, b) in one.curves.iter().zip(&three.curves) {
        assert_eq!(a.points, b.points);
    }
    assert_eq!(one.untraced, three.untraced);
}

#[test]
fn the_map_of_energy_dependent_damping_has_its_two_curves() {
    let map = mapped(RAYLEIGH, "");
    let of = |name: &'static str| {
        let family = &map.subject.family;
        let curves = map.curves.iter();
        let curves = curves.filter(|curve| curve.observable.name(family) == name);
        curves.collect::<Vec<_>>()
    };
    let (split, opens) = (of("x"), of("xy"));
    assert_eq!((split.len(), opens.len()), (1, 1), "{:?}", map.untraced);
    for point in &split[0].points {
        let [a, sigma2] = point.values;
        let off = (a - 0.540_903 * (0.1 * sigma2).sqrt()) / 0.08;
        assert!(off.abs() <= 2.0 * point.error, "{point:?}: {off:.1e}");
    }
    assert_on(opens[0], f64::INFINITY, |[a, _]| a / 0.08);
    let [a, b] = [0.01, 0.03].map(|sigma2: f64| 0.540_903 * (0.1 * sigma2).sqrt());
    let picture = map.regions(0, [200, 200]).unwrap();
    let one = picture
        .regions
        .iter()
        .find(|one| one.signature == Some(Signature::of_peaks(1)));
    // Nearly a trapezium.
    let share = (0.5 * (a + b) + 0.02) / 0.08;
    assert!(
        (one.unwrap().share - share).abs() < 0.02,
        "{} {share}",
        one.unwrap().share
    );
}

#[test]
fn every_curve_is_followed_once_and_its_work_is_as_it_was() {
    let map = mapped(COULOMB, "");
    let family = &map.subject.family;
    let told = map.curves.iter().map(|curve| {
        let observable = curve.observable.name(family);
        format!("{} of {observable}", curve.kind.name())
    });
    assert_eq!(
        told.collect::<Vec<_>>(),
        ["slope at the kink of y", "curvature at the centre of x"],
        "{:?}",
        map.untraced
    );
    // Whatever was followed is there: nothing twice.
    let solves = map
        .curves
        .iter()
        .map(|curve| curve.work.solves + curve.check_work.solves);
    assert_eq!(solves.sum::<usize>(), map.work.curves.solves);
    let told = [map.work.nodes, map.work.curves].map(|work| {
        let (solves, factorisations) = (work.solves, work.factorisations);
        format!("{solves} solves, {factorisations} + {}", work.iterations)
    });
    insta::assert_snapshot!(told.join("\n"), @r"
    35 solves, 15 + 335
    102 solves, 39 + 443
    ");
}

#[test]
fn an_axis_of_modes_holds_its_state_at_every_corner_of_a_map() {
    let map = mapped(DAHL, "");
    assert_eq!(map.nodes.len(), 4);
    assert!(
        map.nodes.iter().all(|node| node.status.is_resolved()),
        "{:?}",
        map.nodes
    );
    let sweep = prepared(DAHL, "");
    let z = &sweep.problem.space().axes()[2];
    assert!((z.from() + 0.8).abs() < 1e-12 && (z.to() - 0.8).abs() < 1e-12);
}

#[test]
fn a_cancelled_map_keeps_what_was_done_and_says_so() {
    let cancellation = Cancellation::new();
    let sweep = prepared(CUSP, "");
    let seen = AtomicUsize::new(0);
    let observer = |told: &MapProgress<'_>| {
        if let MapProgress::Solved { .. } = told
            && seen.fetch_add(1, Ordering::Relaxed) == 30
        {
            cancellation.cancel();
        }
    };
    let map = sweep.map(&cancellation, &observer).unwrap().unwrap();
    assert!(map.interrupted);
    assert!((30..100).contains(&map.nodes.len()), "{}", map.nodes.len());
    assert!(map.curves.is_empty() && map.untraced.is_empty());
    assert!(map.regions(0, [40, 40]).is_some());
}

#[test]
fn a_map_that_was_stopped_is_in_the_end_the_same_to_the_bit() {
    let sweep = prepared(CUSP, "");
    let told = |map: &RegimeMap| {
        let (nodes, samples) = (&map.nodes, &map.samples);
        let (curves, untraced) = (&map.curves, &map.untraced);
        format!(
            "{nodes:?} {curves:?} {untraced:?} {samples:?} {:?}",
            map.work
        )
    };
    let never = Cancellation::new();
    let whole = sweep.map(&never, &|_| ()).unwrap().unwrap();
    let room = Room::new();
    let path = room.path("map.part.bin");
    let journal = |goes_on: bool| {
        if goes_on {
            Journal::open(&path, "").unwrap()
        } else {
            Journal::create(&path, "").unwrap()
        }
    };
    // Among its nodes, twice, and on its curves.
    let mut solves = 0;
    for (turn, most) in [40, 160, whole.nodes.len() + 30].into_iter().enumerate() {
        let journal = journal(turn > 0);
        assert!(journal.solves() >= solves);
        solves = journal.solves();
        let cancellation = Cancellation::new();
        let seen = AtomicUsize::new(0);
        let observer = |_: &MapProgress<'_>| {
            if seen.fetch_add(1, Ordering::Relaxed) == most {
                cancellation.cancel();
            }
        };
        let wrap =
            |source| Box::new(JournalledSource::new(source, &journal)) as Box<dyn DensitySource>;
        let map = sweep.make_map(&wrap, &cancellation, &observer, |maker| {
            maker.whole().map(Some)
        });
        assert!(map.unwrap().unwrap().interrupted && journal.failure().is_none());
    }
    let journal = journal(true);
    assert!(journal.solves() > whole.nodes.len());
    let wrap = |source| Box::new(JournalledSource::new(source, &journal)) as Box<dyn DensitySource>;
    let map = sweep.make_map(&wrap, &never, &|_| (), |maker| maker.whole().map(Some));
    let map = map.unwrap().unwrap();
    assert!(told(&map) == told(&whole), "{map:?}\n{whole:?}");
}

#[test]
fn a_noise_that_one_corner_does_not_allow_is_refused_or_told() {
    // Noise of negative intensity at the lower end of the second parameter.
    let along_a = "parameter = \"a\", from = -0.4, to = 1.0";
    assert!(CUSP.contains(along_a));
    let text = CUSP.replace(along_a, "parameter = \"sigma2\", from = -0.1, to = 0.5");
    let report = settings(&text, "").prepare(&Cancellation::new());
    let report = report.unwrap_err().to_string();
    assert!(report.contains("sqrt"), "{report}");
}

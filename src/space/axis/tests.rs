//! Edges, grading, finding and refinement of one axis.

use super::*;
use proptest::prelude::*;

#[test]
fn uniform_edges_are_exact_at_the_ends_and_symmetric() {
    let axis = Axis::uniform(-3.0, 3.0, 50).unwrap();
    assert_eq!(axis.from(), -3.0);
    assert_eq!(axis.to(), 3.0);
    assert_eq!(axis.edges()[25], 0.0);
    assert!(axis.has_face_at(0.0));
    assert!(!Axis::uniform(-3.0, 3.0, 51).unwrap().has_face_at(0.0));
}

#[test]
fn grading_reaches_the_width_and_keeps_the_bulk() {
    let grading = Grading {
        at: vec![0.0],
        smallest: 0.002,
    };
    let axis = Axis::graded(-4.0, 4.0, 100, &grading).unwrap();
    let cell = axis.find(0.0).unwrap();
    assert!(axis.has_face_at(0.0));
    let narrowest = axis.width(cell);
    assert!((narrowest / 0.002 - 1.0).abs() < 0.15, "{narrowest}");
    let widest = (0..100).map(|i| axis.width(i)).fold(0.0, f64::max);
    assert!(widest <= 0.08 / BULK_SHARE, "{widest}");
}

#[test]
fn nodes_lie_inside_and_stretches_integrate_to_the_width() {
    let grading = Grading {
        at: vec![0.0],
        smallest: 0.01,
    };
    let axis = Axis::graded(-4.0, 4.0, 200, &grading).unwrap();
    for cell in 0..axis.count() {
        let (from, to) = (axis.edges()[cell], axis.edges()[cell + 1]);
        assert!(from < axis.nodes()[cell] && axis.nodes()[cell] < to);
        // Simpson's rule for the integral of dx/du over a cell.
        let ends = axis.edge_stretch(cell) + axis.edge_stretch(cell + 1);
        let width = (ends + 4.0 * axis.node_stretch(cell)) / 6.0;
        assert!(
            (width / axis.width(cell) - 1.0).abs() < 1e-5,
            "{cell}: {width}"
        );
    }
}

#[test]
fn faces_fall_on_several_graded_points() {
    let grading = Grading {
        at: vec![0.7, -1.3],
        smallest: 0.01,
    };
    let axis = Axis::graded(-2.0, 3.0, 64, &grading).unwrap();
    assert_eq!(axis.count(), 64);
    assert!(axis.has_face_at(0.7) && axis.has_face_at(-1.3));
}

#[test]
fn bad_axes_are_refused() {
    assert!(matches!(
        Axis::uniform(1.0, 1.0, 5),
        Err(SpaceError::Range { .. })
    ));
    assert!(matches!(
        Axis::uniform(0.0, f64::NAN, 5),
        Err(SpaceError::Range { .. })
    ));
    assert!(matches!(
        Axis::uniform(0.0, 1.0, 1),
        Err(SpaceError::Count { .. })
    ));
    let outside = Grading {
        at: vec![2.0],
        smallest: 0.01,
    };
    assert!(matches!(
        Axis::graded(0.0, 1.0, 10, &outside),
        Err(SpaceError::GradingPoint { .. })
    ));
    let wide = Grading {
        at: vec![0.5],
        smallest: 0.5,
    };
    assert!(matches!(
        Axis::graded(0.0, 1.0, 10, &wide),
        Err(SpaceError::GradingWidth { .. })
    ));
}

#[test]
fn cells_can_be_graded_toward_the_ends() {
    let grading = Grading {
        at: vec![-1.0, 1.0],
        smallest: 0.02,
    };
    let axis = Axis::graded(-1.0, 1.0, 20, &grading).unwrap();
    assert_eq!((axis.count(), axis.from(), axis.to()), (20, -1.0, 1.0));
    for (cell, mirrored) in (0..10).zip((10..20).rev()) {
        assert!((axis.width(cell) - axis.width(mirrored)).abs() < 1e-12);
        assert!(cell == 0 || axis.width(cell) > axis.width(cell - 1));
    }
    assert!(axis.width(0) < 0.03, "{}", axis.width(0));
}

proptest! {
    #[test]
    fn every_point_is_found_in_the_cell_whose_edges_hold_it(
        from in -10.0..0.0f64, length in 0.1..20.0f64, count in 4usize..200,
        place in 0.05..0.95f64, ratio in 0.01..0.9f64, inside in 0.0..1.0f64,
    ) {
        let to = from + length;
        let grading = Grading {
            at: vec![from + place * length],
            smallest: ratio * length / count as f64,
        };
        for axis in [Axis::uniform(from, to, count).unwrap(),
                     Axis::graded(from, to, count, &grading).unwrap()] {
            prop_assert_eq!(axis.count(), count);
            prop_assert!(axis.edges().windows(2).all(|pair| pair[0] < pair[1]));
            let x = from + inside * length;
            let cell = axis.find(x).unwrap();
            prop_assert!(axis.edges()[cell] <= x && x <= axis.edges()[cell + 1]);
            prop_assert_eq!(axis.find(to), Some(count - 1));
            prop_assert_eq!(axis.find(to + 1.0), None);
            prop_assert_eq!(axis.find(f64::NAN), None);
        }
    }
}

#[test]
fn a_refined_axis_keeps_its_grading_its_faces_and_its_middle() {
    let grading = Grading {
        at: vec![0.0],
        smallest: 0.01,
    };
    let graded = Axis::graded(-4.0, 4.0, 100, &grading).unwrap();
    let finer = graded.refined(1.5);
    // Each side of the graded point has 50 cells, and the even number next to 75.
    assert_eq!(finer.count(), 2 * 76);
    assert!(finer.has_face_at(0.0) && (finer.from(), finer.to()) == (-4.0, 4.0));
    for at in [-3.0, -0.5, 0.02, 2.0] {
        let width = |axis: &Axis| axis.width(axis.find(at).unwrap());
        assert!((width(&graded) / width(&finer) - 1.5).abs() < 0.1, "{at}");
    }
    // 50 × 1.5 = 75 would have no face in the middle.
    assert!(
        Axis::uniform(-1.0, 1.0, 50)
            .unwrap()
            .refined(1.5)
            .has_face_at(0.0)
    );
    assert_eq!(
        Axis::uniform(-1.0, 1.0, 51).unwrap().refined(1.5).count() % 2,
        1
    );
}

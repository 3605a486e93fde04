//! What the ends of the ranges have left of densities: in one array for all of them, and in those of earlier versions.

use std::path::Path;

use serde_json::Map;

use super::super::zarr::{self, Chunks, StoredArray};
use super::{Point, awkward, bits, point, read, write};
use crate::density::{Truncation, errors_by_schemes};

/// A point by two schemes whose densities, of y and of both axes, have such truncations.
fn truncated(value: f64, truncations: [Truncation; 2]) -> Point {
    let mut point = point(value, None, 0);
    for (one, truncation) in point.densities.iter_mut().zip(truncations) {
        one.truncation = truncation;
        // What is stored as the error has what the ends may have changed; the error without follows from the schemes.
        if let Some(second) = one.variants.second_scheme() {
            one.standard_error = errors_by_schemes(&one.density, second);
        }
    }
    point
}

fn truncation(share: f64, level: f64, cells: usize) -> Truncation {
    Truncation {
        share,
        level,
        change: awkward(3, cells),
    }
}

fn assert_read(folder: &Path, points: &[Point]) {
    let found = read(folder).unwrap();
    assert_eq!(found.len(), points.len());
    for (found, wanted) in found.iter().zip(points) {
        assert!(bits(found) == bits(wanted), "{}", wanted.value);
    }
}

#[test]
fn they_are_read_bit_for_bit_from_one_array_and_from_those_of_earlier_versions() {
    let none = Truncation::default;
    let points = [
        truncated(0.1, [truncation(0.1 + 0.2, 1e-300, 6), none()]),
        truncated(0.2, [none(), none()]),
        truncated(0.3, [none(), truncation(0.0, 1.0 / 3.0, 0)]),
        truncated(
            0.4,
            [truncation(1e-9, 0.0, 0), truncation(0.7, 2.0 / 3.0, 18)],
        ),
    ];
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), &points);
    assert_read(folder.path(), &points);
    let store = folder.path().join("densities.zarr");
    let together = StoredArray::open(&store.join("range_ends")).unwrap();
    assert_eq!(together.shape(), [4, 2, 2]);
    assert_eq!(
        together.attributes()["densities"],
        serde_json::json!(["p_y", "p_xy"])
    );
    let rows: Vec<Vec<f64>> = (0..4).map(|index| together.row(index).unwrap()).collect();
    assert!(rows[1].iter().all(|number| number.is_nan()), "{rows:?}");
    std::fs::remove_dir_all(store.join("range_ends")).unwrap();
    let names = [
        "p_y_truncated",
        "p_y_end_level",
        "p_xy_truncated",
        "p_xy_end_level",
    ];
    for (place, name) in names.into_iter().enumerate() {
        let numbers = rows.iter().map(|row| vec![vec![row[place]].into()]);
        let numbers: Vec<_> = numbers.collect();
        let dimensions = [("f_c".to_owned(), 4)];
        let array = (&numbers[..], Chunks::Few);
        zarr::write(&store.join(name), &dimensions, &Map::new(), array).unwrap();
    }
    assert_read(folder.path(), &points);
}

#[test]
fn rows_with_numbers_are_one_chunk_as_short_as_may_be() {
    for (filled, rows_of_chunk, number) in [
        (0..53, 53, 0),
        (25..31, 8, 3),
        (299..300, 1, 299),
        (0..300, 300, 0),
    ] {
        let row = |index: usize| match filled.contains(&index) {
            true => vec![vec![index as f64, -1.0].into()],
            false => Vec::new(),
        };
        let rows: Vec<_> = (0..300).map(row).collect();
        let folder = tempfile::tempdir().unwrap();
        let dimensions = [("f_c".to_owned(), 300), ("x".to_owned(), 2)];
        zarr::write(
            folder.path(),
            &dimensions,
            &Map::new(),
            (&rows, Chunks::Few),
        )
        .unwrap();
        let chunks = std::fs::read_dir(folder.path().join("c")).unwrap();
        let chunks: Vec<_> = chunks.map(|entry| entry.unwrap().file_name()).collect();
        assert_eq!(chunks, [number.to_string().as_str()], "{filled:?}");
        let chunk = folder.path().join(format!("c/{number}/0"));
        assert_eq!(chunk.metadata().unwrap().len(), 16 * rows_of_chunk);
        let array = StoredArray::open(folder.path()).unwrap();
        for index in 0..300 {
            let found = array.row(index as u64).unwrap();
            let found = found.into_iter().filter(|number| !number.is_nan());
            let wanted = filled.contains(&index).then_some([index as f64, -1.0]);
            let wanted = wanted.into_iter().flatten();
            assert!(found.eq(wanted), "{index} of {filled:?}");
        }
    }
}

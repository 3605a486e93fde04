//! How much memory the densities of an unfinished run need, which stand in its journal or in shards.

use super::super::holding_shard::HoldingShard;
use super::super::point_densities::PointDensities;
use super::{OBSERVABLES, Point, RESOLVED, point, space, subject, write};
use crate::continuation::Shard;
use crate::run::{Journal, checksums};
use crate::system::test_families::coulomb;

/// Densities of y and of both axes have 6 and 18 cells, and of each cell a value, an error and that by a second scheme;
/// the axes have 3 and 6 cells, of each of which six numbers are known.
const NUMBERS: usize = 3 * (6 + 18) + 6 * (6 + 3 + 6);

fn numbers(run: &std::path::Path, value: f64) -> usize {
    let (subject, space) = (subject(&OBSERVABLES), space());
    let opened = PointDensities::open(run, false, &subject, (&space, &[])).unwrap();
    opened.numbers(&[value]).unwrap()
}

#[test]
fn densities_in_a_journal_and_in_shards_are_counted_as_those_in_a_store() {
    let points: [Point; 2] = [point(0.1, None, 0), point(0.2, None, 0)];
    let folder = tempfile::tempdir().unwrap();
    let of = |name: &str| folder.path().join(name);
    for name in ["run", "shard", "merge"] {
        std::fs::create_dir(of(name)).unwrap();
    }
    let journal = Journal::create(&of("run/journal.bin"), RESOLVED).unwrap();
    for point in &points {
        journal.write_known(&coulomb(), point, None).unwrap();
    }
    drop(journal);
    assert_eq!(numbers(&of("run"), 0.2), NUMBERS);
    write(&of("shard"), &points);
    checksums::write(&of("shard"), &["densities.zarr"]).unwrap();
    assert_eq!(numbers(&of("shard"), 0.1), NUMBERS);
    let shard = HoldingShard::at(&of("shard"), Shard::new(1, 1).unwrap());
    assert!(shard.is_some());
    let journal = Journal::create(&of("merge/journal.bin"), RESOLVED).unwrap();
    journal.write_shards(&[shard]).unwrap();
    for point in &points {
        journal.write_known(&coulomb(), point, Some(0)).unwrap();
    }
    drop(journal);
    assert_eq!(numbers(&of("merge"), 0.1), NUMBERS);
}

#[test]
fn a_shard_is_checked_once_one_of_its_points_is_read() {
    let points = [point(0.1, None, 0)];
    let folder = tempfile::tempdir().unwrap();
    let of = |name: &str| folder.path().join(name);
    std::fs::create_dir_all(of("shard")).unwrap();
    std::fs::create_dir(of("merge")).unwrap();
    write(&of("shard"), &points);
    checksums::write(&of("shard"), &["densities.zarr"]).unwrap();
    let shard = HoldingShard::at(&of("shard"), Shard::new(1, 1).unwrap());
    let journal = Journal::create(&of("merge/journal.bin"), RESOLVED).unwrap();
    journal.write_shards(&[shard]).unwrap();
    journal
        .write_known(&coulomb(), &points[0], Some(0))
        .unwrap();
    drop(journal);
    let chunk = of("shard/densities.zarr/p_y/c/0/0");
    let mut bytes = std::fs::read(&chunk).unwrap();
    bytes[3] ^= 1;
    std::fs::write(&chunk, bytes).unwrap();
    let (subject, space) = (subject(&OBSERVABLES), space());
    let opened = PointDensities::open(&of("merge"), false, &subject, (&space, &[])).unwrap();
    opened.check_shards().unwrap();
    opened.read(&mut points[0].clone()).unwrap();
    let refused = opened.check_shards().unwrap_err().to_string();
    assert!(refused.contains("p_y"), "{refused}");
}

use super::super::placing::finish_after_kill;
use super::*;

const ENTRIES: &[&str] = &["table", "solved", "drawn"];

/// All files below a folder with their texts, sorted.
fn texts(folder: &Path) -> Vec<(String, String)> {
    let mut found = Vec::new();
    let mut open = vec![folder.to_owned()];
    while let Some(next) = open.pop() {
        for entry in std::fs::read_dir(next).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                open.push(path);
            } else {
                let name = path.strip_prefix(folder).unwrap().to_str().unwrap();
                found.push((name.to_owned(), std::fs::read_to_string(&path).unwrap()));
            }
        }
    }
    found.sort();
    found
}

fn write(folder: &Path, files: &[(&str, &str)]) {
    for (name, text) in files {
        std::fs::create_dir_all(folder.join(name).parent().unwrap()).unwrap();
        std::fs::write(folder.join(name), text).unwrap();
    }
}

fn assert_holds(folder: &Path, files: &[(&str, &str)]) {
    let owned = |(name, text): &(&str, &str)| (name.to_string(), text.to_string());
    assert_eq!(texts(folder), files.iter().map(owned).collect::<Vec<_>>());
}

#[test]
fn new_files_take_their_place_and_every_earlier_version_is_kept_whole() {
    let home = tempfile::tempdir().unwrap();
    let home = home.path();
    write(home, &[("notes", "mine"), ("previous/table", "0")]);
    write(home, &[("table", "1"), ("solved/a", "1"), ("drawn/a", "1")]);
    let staging = Staging::new(home, ENTRIES).unwrap();
    write(&staging.fresh(), &[("table", "2"), ("drawn/b", "2")]);
    let placed = staging.take_place(&["solved"], &[]).unwrap();
    assert_eq!(placed.files, [home.join("table"), home.join("drawn/b")]);
    assert_eq!(placed.kept, Some(home.join("previous/1")));
    drop(placed);
    let first = [
        ("previous/1/drawn/a", "1"),
        ("previous/1/solved/a", "1"),
        ("previous/1/table", "1"),
    ];
    let beside = [("notes", "mine")];
    let oldest = [("previous/table", "0")];
    let now = [
        &[("drawn/b", "2")][..],
        &beside,
        &first,
        &oldest,
        &[("solved/a", "1"), ("table", "2")],
    ];
    assert_holds(home, &now.concat());
    // Without new files everything moves away, and nothing that was kept is touched.
    let staging = Staging::new(home, ENTRIES).unwrap();
    assert!(staging.take_place(&[], &[]).unwrap().files.is_empty());
    let second = [
        ("previous/2/drawn/b", "2"),
        ("previous/2/solved/a", "1"),
        ("previous/2/table", "2"),
    ];
    assert_holds(home, &[&beside[..], &first, &second, &oldest].concat());
    // Where nothing was, nothing is kept.
    let staging = Staging::new(home, ENTRIES).unwrap();
    assert_eq!(staging.take_place(&[], &[]).unwrap().kept, None);
    assert_holds(home, &[&beside[..], &first, &second, &oldest].concat());
}

#[test]
fn work_about_the_files_moves_with_them() {
    let home = tempfile::tempdir().unwrap();
    let home = home.path();
    let staged = || Staging::new(home, ENTRIES).unwrap().with(&["about"]);
    write(home, &[("about/a/b", "mine")]);
    // Without files of an earlier version it is somebody else's.
    staged().unwrap().take_place(&[], &[]).unwrap();
    assert_holds(home, &[("about/a/b", "mine")]);
    write(home, &[("table", "1"), ("about/a/b", "1")]);
    let lock = FolderLock::take(&home.join("about/a")).unwrap();
    assert!(matches!(staged(), Err(RunError::InUse { .. })));
    drop(lock);
    staged().unwrap().take_place(&[], &[]).unwrap();
    let kept = [("previous/1/about/a/b", "1"), ("previous/1/table", "1")];
    assert_holds(home, &kept);
    // Where it stays it has a second place.
    write(home, &[("table", "2"), ("about/a/b", "2")]);
    staged().unwrap().take_place(&["about"], &[]).unwrap();
    let second = [("previous/2/about/a/b", "2"), ("previous/2/table", "2")];
    assert_holds(home, &[&[("about/a/b", "2")], &kept[..], &second].concat());
}

#[test]
fn what_a_kill_left_half_moved_is_not_kept_twice() {
    let home = tempfile::tempdir().unwrap();
    let home = home.path();
    write(home, &[("table", "1"), ("previous/1/table", "1")]);
    write(
        home,
        &[("previous/1/solved/a", "1"), (".pbif-x/gone/solved/a", "1")],
    );
    let staging = Staging::new(home, ENTRIES).unwrap();
    staging.take_place(&[], &[]).unwrap();
    let kept = [("previous/1/solved/a", "1"), ("previous/1/table", "1")];
    assert_holds(home, &kept);
}

/// A run that was there, and its successor.
const OLD: [(&str, &str); 4] = [
    ("about/a", "1"),
    ("drawn/a", "1"),
    ("solved/a", "1"),
    ("table", "1"),
];
const NEW: [(&str, &str); 2] = [("drawn/b", "2"), ("table", "2")];

/// The folder of a run whose successor was about to take its place when it was killed, with what was left to be moved.
fn killed_before_moves() -> (tempfile::TempDir, PathBuf, Vec<[PathBuf; 2]>) {
    let folder = tempfile::tempdir().unwrap();
    let home = folder.path().to_owned();
    write(&home, &OLD);
    write(&home, &[("part", "1")]);
    let staging = Staging::new(&home, ENTRIES).unwrap().with(&["about"]);
    let staging = staging.unwrap();
    write(&staging.fresh(), &NEW);
    let (moves, ..) = staging.begin(&["about"], &["part"]).unwrap();
    let room = staging.room.keep();
    let (gone, fresh) = (room.join(GONE), room.join(FRESH));
    let away = moves.away.iter();
    let away = away.map(|name| [home.join(name), gone.join(name)]);
    let into = moves.into.iter();
    let into = into.map(|name| [fresh.join(name), home.join(name)]);
    let all = away.chain(into).collect();
    (folder, room, all)
}

#[test]
fn what_a_kill_left_half_moved_is_moved_to_its_end() {
    let count = killed_before_moves().2.len();
    assert_eq!(count, 5);
    for done in 0..=count {
        let (folder, room, moves) = killed_before_moves();
        let home = folder.path();
        for [from, to] in &moves[..done] {
            std::fs::rename(from, to).unwrap();
        }
        // Another one who writes there may be at it.
        let lock = FolderLock::take(home).unwrap();
        finish_after_kill(home);
        assert!(room.exists(), "{done}");
        drop(lock);
        finish_after_kill(home);
        let kept = OLD.map(|(name, text)| (format!("previous/1/{name}"), text));
        let mut wanted = vec![OLD[0], NEW[0], NEW[1]];
        wanted.extend(kept.iter().map(|(name, text)| (name.as_str(), *text)));
        wanted.sort_unstable();
        assert_holds(home, &wanted);
        assert!(!room.exists(), "{done}");
    }
}

#[test]
fn what_is_not_ours_is_not_touched() {
    let home = tempfile::tempdir().unwrap();
    let mine = [("drawn/sketch", "mine")];
    write(home.path(), &mine);
    let error = Staging::new(home.path(), ENTRIES).unwrap_err();
    assert!(
        matches!(&error, RunError::NotOurs { path, mark: "table" }
        if *path == home.path().join("drawn")),
        "{error}"
    );
    assert_holds(home.path(), &mine);
}

#[cfg(unix)]
#[test]
fn a_version_that_cannot_be_moved_stays_where_it_is() {
    use std::os::unix::fs::PermissionsExt as _;
    let home = tempfile::tempdir().unwrap();
    let home = home.path();
    let files = [("solved/a", "1"), ("table", "1")];
    write(home, &files);
    let rights = |mode| std::fs::Permissions::from_mode(mode);
    std::fs::set_permissions(home.join("solved"), rights(0o555)).unwrap();
    let staging = Staging::new(home, ENTRIES).unwrap();
    let taken = staging.take_place(&[], &[]);
    // The superuser may move it all the same.
    if taken.is_err() {
        assert_holds(home, &files);
    }
    for place in [home.join("solved"), home.join("previous/1/solved")] {
        let _ = std::fs::set_permissions(place, rights(0o755));
    }
}

#[test]
fn new_files_that_are_given_up_leave_nothing() {
    let home = tempfile::tempdir().unwrap();
    write(home.path(), &[("table", "1")]);
    let staging = Staging::new(home.path(), ENTRIES).unwrap();
    write(&staging.fresh(), &[("table", "2")]);
    drop(staging);
    assert_holds(home.path(), &[("table", "1")]);
}

use super::*;

#[test]
fn what_is_not_a_runs_stays() {
    let home = tempfile::tempdir().unwrap();
    let run = home.path().join("previous/1");
    std::fs::create_dir_all(run.join("figures")).unwrap();
    std::fs::create_dir_all(run.join("densities.zarr/p_x/c/0")).unwrap();
    let left = [
        "run.json",
        "points.csv",
        "checks.csv",
        "figures/a.svg",
        "figures/b.svg",
    ];
    let store = ["densities.zarr/zarr.json", "densities.zarr/p_x/c/0/0"];
    for name in left.iter().chain(&store) {
        std::fs::write(run.join(name), name).unwrap();
    }
    checksums::write(&run, Layout::SWEEP.entries).unwrap();
    let changed = ["figures/a.svg", "points.csv"];
    let foreign = ["densities.zarr/notes.txt", "figures/mine.svg", "notes.txt"];
    for name in changed.iter().chain(&foreign) {
        std::fs::write(run.join(name), "mine").unwrap();
    }
    let removal = remove_run(&run).unwrap();
    let told = |(path, why): &(PathBuf, Stays)| {
        let name = path.strip_prefix(&run).unwrap().to_str().unwrap();
        (name.to_owned(), matches!(why, Stays::Changed))
    };
    let told: Vec<_> = removal.stays.iter().map(told).collect();
    let mut wanted: Vec<_> = changed
        .iter()
        .map(|name| (name.to_string(), true))
        .collect();
    wanted.extend(foreign.iter().map(|name| (name.to_string(), false)));
    wanted.sort();
    // Six files, one of them that of the checksums.
    assert_eq!((told, removal.files), (wanted, 6));
    let names = |folder: &Path| {
        let entries = std::fs::read_dir(folder).unwrap().flatten();
        let mut names: Vec<_> = entries.map(|entry| entry.file_name()).collect();
        names.sort();
        names
    };
    let all = ["densities.zarr", "figures", "notes.txt", "points.csv"];
    assert_eq!(names(&run), all);
    assert_eq!(names(&run.join("densities.zarr")), ["notes.txt"]);
    assert_eq!(names(&run.join("figures")), ["a.svg", "mine.svg"]);
    for name in ["figures", "densities.zarr"] {
        std::fs::remove_dir_all(run.join(name)).unwrap();
    }
    std::fs::remove_file(run.join("points.csv")).unwrap();
    assert!(matches!(remove_run(&run), Err(RunError::NotARun { .. })));
    // Without notes nothing is left of a run that was killed, the folder of earlier runs neither.
    for name in store
        .iter()
        .chain(&["points.csv", "densities.zarr/.pbif-x"])
    {
        std::fs::create_dir_all(run.join(name).parent().unwrap()).unwrap();
        std::fs::write(run.join(name), "").unwrap();
    }
    std::fs::remove_file(run.join("notes.txt")).unwrap();
    std::fs::write(run.join("run.json"), "{}").unwrap();
    remove_run(&run).unwrap();
    assert!(!home.path().join("previous").exists() && home.path().exists());
}

#[test]
fn the_curves_of_a_run_go_with_it_and_what_stands_beside_them_stays() {
    let home = tempfile::tempdir().unwrap();
    let run = home.path().join("run");
    let put = |name: &str| {
        let path = run.join(name);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, "{}").unwrap();
    };
    put("run.json");
    for name in ["PB1-a", "PB1-a/previous/1", "PB2-a"] {
        put(&format!("curves/{name}/curves.csv"));
        put(&format!("curves/{name}/curve.json"));
    }
    put("curves/PB3-a/curve.part.bin");
    let mine = ["curves/PB2-a/notes.txt", "curves/mine/curves.csv"];
    for name in mine {
        put(name);
    }
    remove_run(&run).unwrap();
    assert!(mine.iter().all(|name| run.join(name).is_file()));
    assert!(!run.join("run.json").exists() && !run.join("curves/PB2-a/curve.json").exists());
    assert!(!run.join("curves/PB1-a").exists() && !run.join("curves/PB3-a").exists());
}

#[test]
fn a_run_that_is_written_is_not_removed() {
    let home = tempfile::tempdir().unwrap();
    std::fs::write(home.path().join("run.json"), "{}").unwrap();
    let _lock = FolderLock::take(home.path()).unwrap();
    let error = remove_run(home.path()).unwrap_err();
    assert!(matches!(error, RunError::InUse { .. }));
    assert!(home.path().join("run.json").exists());
}

#[test]
fn a_table_without_a_checksum_stays_where_it_is_later_than_the_run() {
    let home = tempfile::tempdir().unwrap();
    let run = home.path().join("run");
    std::fs::create_dir_all(&run).unwrap();
    let table = run.join("points.csv");
    for name in ["points.csv", "features.csv", "journal.bin", "run.json"] {
        std::fs::write(run.join(name), name).unwrap();
    }
    let ended = written(&run.join("run.json")).unwrap();
    std::fs::write(&table, "by hand").unwrap();
    let file = std::fs::File::options().write(true).open(&table).unwrap();
    file.set_modified(ended + std::time::Duration::from_secs(60))
        .unwrap();
    let removal = remove_run(&run).unwrap();
    let later = |one: &&(PathBuf, Stays)| one.0 == table && matches!(one.1, Stays::Later);
    assert!(removal.stays.iter().any(|one| later(&one)));
    assert_eq!(std::fs::read_to_string(&table).unwrap(), "by hand");
    assert!(!run.join("features.csv").exists() && !run.join("run.json").exists());
}

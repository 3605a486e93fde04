//! What a run leaves on disk: tables, stored densities, manifest. Every file appears whole or not at all, and is read
//! back as it was.
//!
//! # Decisions
//!
//! **A run replaces nothing.** The files of an earlier run in the same folder are linked into `previous/1`, the next
//! free number, and only when they are whole there are they taken away (`run::staging`, `run::archive`). What was
//! followed from a run (`curves/`) goes with it, so that nothing beside a run is of another one. Files and the store of
//! densities are put in place by renaming: a killed run leaves whole files. A lock of the operating system keeps a
//! second writer away and cannot go stale (`run::lock`).
//!
//! **A job goes on to the same bytes.** A session's solve starts from what it solved before, so a job that goes on must
//! know what the first one knew. A session says after each solve what it has left for later ones (`Session::memory`:
//! trails and masses; of a factorisation only of which matrix it is), and a fresh one recalls it and factorises once.
//! What a solve gives depends on what its session was asked before it, in that order, and on nothing else.
//! `run::JournalledSource` wraps any source, with its finer and enclosed ones, and keeps every solve in the job's
//! `run::Journal` by the hash of all that its session was asked until then: kind of source, values with their
//! parameters, and what was asked of solutions. So a job of any kind repeats its decisions and knows nothing of
//! resuming; neither the order in which sessions are opened nor the number of threads matters, and what is asked
//! otherwise than before is solved from where an uninterrupted session would have stood. A comparison, which asks no
//! sessions, keeps its solves by their numbers in the same file. One file is waited for, once a second (fsync of the
//! journal); tables are made from it again. Its records are what serde derives of the types, in postcard's
//! format, bit for bit; sessions' memories are theirs alone. They are read when they are asked for, so that the journal
//! of a map may be larger than the memory.
//!
//! **Densities are stored at the end.** While a sweep goes on, its densities are in the journal, by which it goes on:
//! readers of an unfinished run find a point there by its value (`run::journal::solved`). A store that grew beside it
//! held them a second time, in a file a value and array, 3400 of them for `sweeps/coulomb_fc.toml`, which took as much
//! of the system's time as all else. The format of the files (`run::zarr`) is written out in two hundred lines: plain
//! numbers in a few large chunks need nothing of a library but its hundred crates.
//!
//! **A map keeps every solve while it is made.** Nodes beside changes decide where curves begin, from densities that
//! depend on all solves of their session; a map that kept signatures alone, as it did, solved those nodes again from
//! other starts and ended with other bytes. By the generator a solve takes 16 bytes a cell in the journal, and 24 a bin
//! of a watched density. A map of 10 000 nodes takes 1.6 GB of the disk while it is made on 100 × 100 cells that watch
//! marginals, and 4 GB where they watch a joint density: a few megabytes a second, beside solves that take a tenth of
//! one. The file is read one record at a time and removed when the map is complete; nodes in memory stay as few as they
//! were. A shard leaves nodes and changes all the same: its journal would have to be kept for weeks, and the merge
//! could not use it, since a node that is reached along another path of its plane differs by rounding.
//!
//! **Shards are the same sweep by an observer that knows more.** A shard runs `sweep_shard` over its values and is a
//! run like any other. The merge runs the whole sweep, whose observer knows the shards' points
//! (`continuation::Observer::known_points`): they are taken for solved, what is between them is solved, and there is
//! no second way to locate anything. A point comes with what its shard has detected (`run::kept_detections`), which is
//! used where the same build detects on the same instruction sets, since any other may differ in the last digits. The
//! journal of a merge names the shard that holds the densities of a point (`run::holding_shard`, by the SHA-256 of the
//! shard's checksums) in place of the densities, which would be written once more for a merge that is killed.
//!
//! **Detection is repeated from what is stored.** `run` reads a folder back to the same points bit for bit,
//! `continuation::detect_again` does what a sweep does after its last solve. What the finer grid showed is stored as
//! numbers (`checks.csv`), not as densities: the check needs no more. `run::arrays` holds names and meaning of the
//! arrays for writer and reader alike. The version before is linked into `previous/`, since no file is ever changed in
//! place.

mod archive;
mod arrays;
mod atomic;
mod bifurcations;
mod cell;
mod checks;
mod checksums;
mod clean;
mod codimension;
mod columns;
mod compare;
mod curve;
mod date;
mod doubts;
mod error;
mod export;
mod features_table;
mod findings;
mod folder;
mod growing;
mod holding_shard;
mod job_folder;
mod journal;
mod kept_detections;
mod latex;
mod layout;
mod levels_table;
mod lock;
mod looks;
mod manifest;
mod map;
mod map_shards;
mod names;
mod number;
mod passage_sentences;
mod place;
mod placing;
mod plane_file;
mod point_densities;
mod points_table;
mod provenance;
mod recompute;
mod reopen;
mod research_object;
mod sealing;
mod sentences;
mod settling;
mod shards;
mod spectra;
mod stability;
mod staged;
mod staging;
mod store;
mod stored_densities;
mod stored_fields;
mod stored_run;
#[cfg(test)]
mod stored_tests;
mod summary;
#[cfg(test)]
mod tests;
mod tree;
mod warnings;
mod zarr;

pub(crate) use atomic::write_anywhere;
pub(crate) use bifurcations::{
    bifurcations_csv, bifurcations_json, bifurcations_markdown, bifurcations_tex,
    miscounted_in_words,
};
pub(crate) use checksums::Checked;
pub(crate) use clean::{Removable, Stays, removable_runs, remove_run};
pub(crate) use codimension::curve_files;
pub(crate) use compare::ComparedRun;
pub(crate) use compare::{compare_files, compare_tables};
pub use curve::FOLDER as CURVES;
pub(crate) use curve::{curve_name, end_labels, point_labels};
pub(crate) use date::date_in_utc;
pub use doubts::doubt_in_words;
pub use error::{Damage, RunError};
pub use export::{Attribute, DataSet, ExportFormat, NamedArray, export};
pub(crate) use features_table::features_csv;
pub(crate) use folder::{RunFolder, sweep_files};
pub use job_folder::{JobFolder, check_folder};
pub(crate) use job_folder::{check_place, clear_after_kill};
pub use journal::{Journal, JournalledSource};
pub use layout::Layout;
pub(crate) use looks::looks_file;
pub(crate) use manifest::Ending;
pub(crate) use manifest::Manifest;
pub use manifest::PhaseSeconds;
pub(crate) use map::map_files;
pub(crate) use map_shards::{MapShards, map_shard_file};
pub use names::check_names;
pub(crate) use names::check_names_compared;
pub(crate) use number::{format_number, format_with_error};

pub(crate) use place::shard_folder;
pub use plane_file::{StoredPlane, StoredPlaneContent};
pub(crate) use points_table::points_csv;
pub(crate) use provenance::Provenance;
pub use sentences::finding_in_words;
#[cfg(feature = "cli")]
pub(crate) use sentences::fixed_point_in_words;
pub(crate) use shards::{Gathered, Shards};
pub(crate) use staged::StagedRun;
pub use stored_run::StoredRun;
pub(crate) use summary::find_runs;
pub use summary::{FoundRow, RunSummary};
pub(crate) use warnings::{warnings_of_comparison, warnings_of_nodes, warnings_of_points};

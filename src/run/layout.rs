//! Which files each kind of job leaves in its folder.

use std::path::Path;

use super::archive::Entries;
use super::journal::differences;
use super::place::read_text;
use super::placing::finish_after_kill;
use super::{
    RunError, checksums, curve, journal, kept_detections, levels_table, looks, plane_file,
    research_object, stability,
};

/// What a kind of job leaves in its folder.
#[derive(Debug, Clone, Copy)]
pub struct Layout {
    /// Files and folders by name, the manifest first: it marks the folder.
    pub(super) entries: Entries,
    /// Folders of work that is about the job: they go where its files go.
    pub(super) about: Entries,
    /// What an unfinished job has solved.
    pub(super) part: &'static str,
    /// Whether files grow in their place, so that a reader sees how far the job is; others are put there when all are
    /// whole.
    pub(super) grows: bool,
}

impl Layout {
    /// A sweep.
    pub(crate) const SWEEP: Self = Self {
        entries: &[
            "run.json",
            research_object::NAME,
            checksums::NAME,
            journal::NAME,
            "points.csv",
            "features.csv",
            "bifurcations.csv",
            "bifurcations.md",
            "bifurcations.tex",
            "bifurcations.json",
            "densities.zarr",
            "densities.zarr.new",
            "densities.zarr.old",
            "checks.csv",
            looks::NAME,
            kept_detections::NAME,
            "spectra.csv",
            "correlations.csv",
            "figures",
            "explorer.html",
        ],
        about: &[curve::FOLDER],
        part: journal::NAME,
        grows: true,
    };

    /// A map of regimes.
    pub(crate) const MAP: Self = Self {
        entries: &[
            "map.json",
            checksums::NAME,
            plane_file::NAME,
            "map.csv",
            "curves.csv",
            "codimension_two.csv",
            "codimension_two.tex",
            stability::NAME,
            levels_table::NAME,
            "densities",
            "figures",
        ],
        about: &[],
        part: "map.part.bin",
        grows: false,
    };

    /// A shard of a map.
    pub(crate) const MAP_SHARD: Self = Self {
        entries: &["map.shard.json", checksums::NAME],
        ..Self::MAP
    };

    /// The curves from a row of a sweep.
    pub(crate) const CURVES: Self = Self {
        entries: &[
            "curve.json",
            checksums::NAME,
            plane_file::NAME,
            "curves.csv",
            "codimension_two.csv",
            "codimension_two.tex",
            stability::NAME,
            levels_table::NAME,
            "figures",
        ],
        about: &[],
        part: "curve.part.bin",
        grows: false,
    };

    /// A comparison of methods.
    pub(crate) const COMPARISON: Self = Self {
        entries: &[
            "compare.json",
            checksums::NAME,
            "compare.csv",
            "compare.md",
            "compare.tex",
            "distances.csv",
            "agreement.csv",
            "measures.csv",
            "accuracy.csv",
            "densities.csv",
            "figures",
        ],
        about: &[],
        part: "compare.part.bin",
        grows: false,
    };

    /// That of the job whose files are in a folder.
    pub(super) fn of(folder: &Path) -> Option<Self> {
        let (sweep, comparison) = (Self::SWEEP, Self::COMPARISON);
        let all = [sweep, comparison, Self::CURVES, Self::MAP, Self::MAP_SHARD];
        let mut all = all.into_iter();
        all.find(|layout| folder.join(layout.manifest()).is_file())
    }

    /// The file that marks the folder.
    pub(super) fn manifest(&self) -> &'static str {
        self.entries.first().copied().unwrap_or_default()
    }

    /// Whether a folder holds what an unfinished job has solved; files that a kill left half moved are moved first.
    pub(crate) fn has_part(&self, folder: &Path) -> bool {
        finish_after_kill(folder);
        folder.join(self.part).is_file()
    }

    /// Whether a folder holds a job that came to its end, and is of what `of` describes as TOML.
    ///
    /// # Errors
    /// [`RunError::OtherSweep`], with every difference, where it is of something else; [`RunError::Json`];
    /// [`RunError::Damaged`] by its checksums.
    pub(crate) fn is_complete(&self, folder: &Path, of: &str) -> Result<bool, RunError> {
        let Ok(text) = read_text(&folder.join(self.manifest())) else {
            return Ok(false);
        };
        checksums::require(folder, &[self.manifest()])?;
        let there: serde_json::Value = serde_json::from_str(&text)?;
        let word = |key: &str| there[key].as_str();
        let made_of = word("made_of").or_else(|| word("sweep_file"));
        let version = word("version").unwrap_or_default();
        let differences = differences(version, made_of.unwrap_or_default(), of);
        RunError::check_same(folder, differences)?;
        // A shard of a map is written when it is complete, and does not say so.
        let ending = word("ending");
        Ok(ending.is_none_or(|ending| ending == "complete"))
    }
}

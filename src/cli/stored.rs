//! What `pbif detect` and `pbif plot` share: a stored run with its sweep, its points, and what is found in them.

use std::path::Path;

use super::{CommandError, tell};
use crate::continuation::SweepResult;
use crate::run::{RunError, StoredRun, check_names};
use crate::sweep_file::{Diagnostic, Report, Sweep, SweepFile, list};

/// An option of the command line, and the `KEY=VALUE` that it stands for.
pub(super) type Override = (&'static str, String);

/// What was given with `--set`.
pub(super) fn set(overrides: &[String]) -> Vec<Override> {
    let overrides = overrides.iter();
    overrides.map(|one| ("--set", one.clone())).collect()
}

/// A run that was read, and what is found in it.
pub(super) struct Stored {
    pub(super) run: StoredRun,
    pub(super) spec: Sweep,
    pub(super) result: SweepResult,
}

impl Stored {
    /// Reads a run, with overrides of the keys under `sections`, and detects and locates in all its points.
    ///
    /// # Errors
    /// [`CommandError::Input`] for overrides, [`CommandError::Run`] for the run's files.
    pub(super) fn read(
        path: &Path,
        overrides: &[Override],
        sections: &[&str],
        quiet: bool,
    ) -> Result<Self, CommandError> {
        Self::read_as(path, &mut |_| (), overrides, sections, quiet)
    }

    /// The same where the sweep file is prepared before overrides are set.
    ///
    /// # Errors
    /// As [`Stored::read`].
    pub(super) fn read_as(
        path: &Path,
        prepare: &mut dyn FnMut(&mut SweepFile),
        overrides: &[Override],
        sections: &[&str],
        quiet: bool,
    ) -> Result<Self, CommandError> {
        let run = StoredRun::open(path)?;
        check_overrides(overrides, sections)?;
        let mut file = run.sweep_file();
        prepare(&mut file);
        for (option, setting) in overrides {
            file.set_all(option, [setting]);
        }
        let settings = file.validate()?;
        check_names(&settings)?;
        let spec = settings.fixed()?;
        let result = run.detect(&spec)?;
        let stored = Self { run, spec, result };
        if !quiet {
            stored.say();
        }
        Ok(stored)
    }

    /// Says what was read, and what is missing of it.
    fn say(&self) {
        let points = &self.result.points;
        let with_density = points.iter().filter(|p| !p.densities.is_empty());
        let (points, densities) = (points.len(), with_density.count());
        let mut text = format!("{points} points read, {densities} of them with densities\n");
        if self.result.interrupted {
            let given = self.spec.settings.points;
            text += &format!(
                "the run was interrupted: of its {given} given values, and those that refine brackets, there are {points} points\n"
            );
        }
        tell(false, &text);
    }
}

/// Refuses overrides of keys that a finished run has used up.
pub(super) fn check_overrides(overrides: &[Override], sections: &[&str]) -> Result<(), Report> {
    for (_, argument) in overrides {
        let key = argument.split('=').next().unwrap_or_default().trim();
        let section = key.split('.').next().unwrap_or_default().trim();
        if !sections.contains(&section) {
            let title = format!("`{key}` cannot be set for a stored run");
            let keys: Vec<String> = sections.iter().map(|name| format!("{name}.…")).collect();
            return Err(Diagnostic::new(title)
                .allowed(format!("keys under {}", list(&keys)))
                .remedy("its densities stay as they are; `pbif sweep FILE --set …` solves with other settings")
                .into());
        }
    }
    Ok(())
}

/// What a user is told of a run's files that cannot be written or read.
pub(super) fn diagnostic(error: &RunError) -> Diagnostic {
    let finding = Diagnostic::new(error.to_string());
    let solve = "`pbif sweep FILE` makes a run anew";
    match error {
        RunError::NotARun { .. } => {
            finding.remedy("give the folder that `pbif sweep` wrote, such as `output/coulomb_fc`")
        }
        RunError::InUse { .. } => {
            finding.remedy("wait until it has ended, or give another folder with `--out DIR`")
        }
        RunError::NotOurs { .. } | RunError::Elsewhere { .. } => {
            finding.remedy("give another folder with `--out DIR`")
        }
        RunError::Place { .. } => {
            finding.remedy("give another folder with `--out DIR`, or rename the one that is read")
        }
        RunError::NoJournal { .. } | RunError::Journal { .. } => {
            finding.remedy("leave `--resume` out: the run begins anew, and what is there is kept in its folder previous/")
        }
        RunError::OtherSweep { .. } => finding
            .remedy("give the settings of that run, or leave `--resume` out: it is then kept in the folder previous/"),
        RunError::NoShards { path } => finding.remedy(format!(
            "`pbif sweep FILE --shard 1/4 --out {}` makes the first of four",
            path.display()
        )),
        RunError::MixedShards { .. } => {
            finding.remedy("move the shards that are not meant out of that folder")
        }
        RunError::MissingShards { path, missing, .. } => {
            let shards = missing.iter().map(|(shard, _)| shard.to_string());
            let first = shards.take(1).collect::<String>();
            finding.remedy(format!(
                "`pbif sweep FILE --shard {first} --out {} --resume` computes it, and so each of them; `pbif merge --partial` takes what is there",
                path.display()
            ))
        }
        RunError::BeingMerged { path } => finding.remedy(format!(
            "`pbif merge {}` goes on with it",
            path.display()
        )),
        RunError::OtherShard { .. } => {
            finding.remedy("move it out of the folder of the shards, and compute that shard again")
        }
        RunError::NotStored { stored, .. } => finding
            .allowed(format!("observables of {}", list(stored)))
            .remedy("`pbif sweep FILE --set detect.marginals=…` or `detect.joint=…` solves and stores more"),
        RunError::OtherFormula { .. } => finding
            .remedy("give the quantity another name; `pbif sweep FILE` solves and stores its density"),
        RunError::Memory { .. } => {
            finding.remedy("a higher limit (`ulimit -v`, or that of the batch job)")
        }
        RunError::Version { .. } => {
            finding.remedy(format!("use the version that made the run, or {solve}"))
        }
        RunError::Read { .. }
        | RunError::Manifest { .. }
        | RunError::Hash { .. }
        | RunError::Column { .. }
        | RunError::Row { .. }
        | RunError::ReadStore { .. }
        | RunError::Cells { .. }
        | RunError::NoDensity { .. }
        | RunError::Plane { .. }
        | RunError::Checksums { .. }
        | RunError::Damaged { .. }
        | RunError::Rows { .. }
        | RunError::NotFinite { .. } => {
            finding.remedy(format!("the run was changed or is not complete; {solve}"))
        }
        _ => finding,
    }
}

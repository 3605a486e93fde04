//! By what a run was made: the build of the program, the machine, and when.

use std::time::SystemTime;

use serde::Serialize;

use super::date_in_utc;

/// What made a run. Results do not depend on it; whoever wants to know why two machines took different times does.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct Provenance {
    /// When the process began that wrote it, in UTC (ISO 8601).
    pub started: String,
    /// When the run ended; `None` before.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub ended: Option<String>,
    /// The commit that the program was built from, with `-dirty` where files were changed since: of the repository, of
    /// the package, or what `PBIF_COMMIT` said at its build; `None` where nothing tells.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub commit: Option<&'static str>,
    /// The compiler with its version.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub compiler: Option<&'static str>,
    /// What the program was compiled for, such as `x86_64-unknown-linux-gnu`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub target: Option<&'static str>,
    /// Instruction sets that all of the program was compiled for, which every processor must have that runs it.
    pub target_features: Vec<&'static str>,
    /// Level of optimisation that the program was compiled with, such as `3`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub optimisation: Option<&'static str>,
    /// Operating system.
    pub system: &'static str,
    /// Kind of processor.
    pub architecture: &'static str,
    /// Of the instruction sets for which loops are compiled apart, those that this processor has.
    pub instruction_sets: Vec<&'static str>,
}

impl Provenance {
    /// Of this process.
    pub(crate) fn of_this_process() -> Self {
        Self {
            started: date_in_utc(SystemTime::now()),
            ended: None,
            commit: non_empty(option_env!("PBIF_COMMIT")),
            compiler: non_empty(option_env!("PBIF_COMPILER")),
            target: non_empty(option_env!("PBIF_TARGET")),
            target_features: non_empty(option_env!("PBIF_TARGET_FEATURES"))
                .map_or_else(Vec::new, |features| features.split(',').collect()),
            optimisation: non_empty(option_env!("PBIF_OPTIMISATION")),
            system: std::env::consts::OS,
            architecture: std::env::consts::ARCH,
            instruction_sets: instruction_sets(),
        }
    }

    /// All on which the last digits of a result depend beside what was computed: the program, how it was compiled, and
    /// the instruction sets of this processor. Of a program that no commit tells, its file stands for it; `None` where
    /// that cannot be read.
    pub(crate) fn of_arithmetic() -> Option<String> {
        let made = Self::of_this_process();
        let is_known = |commit: &&str| !commit.ends_with("-dirty");
        let file = match made.commit.filter(is_known) {
            Some(_) => None,
            None => {
                let file = std::env::current_exe().and_then(std::fs::metadata).ok()?;
                Some((file.len(), file.modified().ok()?))
            }
        };
        let program = (env!("CARGO_PKG_VERSION"), made.commit, file);
        let compiled = (made.compiler, made.target, made.target_features);
        let machine = (made.optimisation, made.architecture, made.instruction_sets);
        Some(format!("{program:?} {compiled:?} {machine:?}"))
    }

    /// Now it has ended.
    pub(crate) fn end(&mut self) {
        self.ended = Some(date_in_utc(SystemTime::now()));
    }
}

/// What the build could not find out is empty.
fn non_empty(text: Option<&'static str>) -> Option<&'static str> {
    text.filter(|text| !text.is_empty())
}

#[cfg(target_arch = "x86_64")]
fn instruction_sets() -> Vec<&'static str> {
    let all = [
        ("sse4.2", std::is_x86_feature_detected!("sse4.2")),
        ("avx", std::is_x86_feature_detected!("avx")),
        ("avx2", std::is_x86_feature_detected!("avx2")),
        ("fma", std::is_x86_feature_detected!("fma")),
        ("avx512f", std::is_x86_feature_detected!("avx512f")),
    ];
    let there = all.into_iter().filter(|(_, is_there)| *is_there);
    there.map(|(name, _)| name).collect()
}

#[cfg(not(target_arch = "x86_64"))]
fn instruction_sets() -> Vec<&'static str> {
    Vec::new()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_process_computes_in_one_way() {
        let words = Provenance::of_arithmetic().unwrap();
        assert_eq!(Some(&words), Provenance::of_arithmetic().as_ref());
        assert!(words.contains(env!("CARGO_PKG_VERSION")), "{words}");
    }

    #[test]
    fn the_build_says_by_what_it_was_made() {
        let made = Provenance::of_this_process();
        assert!(made.compiler.unwrap().starts_with("rustc "), "{made:?}");
        assert!(made.target.unwrap().contains(made.architecture), "{made:?}");
        assert!(["0", "1", "2", "3", "s", "z"].contains(&made.optimisation.unwrap()));
        if let Some(commit) = made.commit {
            let digits = commit.trim_end_matches("-dirty");
            assert!(
                digits.len() >= 7 && digits.bytes().all(|byte| byte.is_ascii_hexdigit()),
                "{commit}"
            );
        }
    }
}

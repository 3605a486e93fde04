//! By what a run was made: the build of the program, the machine, and when.

use std::time::SystemTime;

use serde::Serialize;

use super::date_in_utc;

/// What made a run. Results do not depend on it; whoever wants to know why two machines took different times does.
#[derive(Debug, Clone, Serialize)]
pub struct Provenance {
    /// When the process began that wrote it, in UTC (ISO 8601).
    pub started: String,
    /// When the run ended; `None` before.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub ended: Option<String>,
    /// The commit that the program was built from, with `-dirty` where files were changed: what `PBIF_COMMIT` said at its build; `None` where it was not
    /// given.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub commit: Option<&'static str>,
    /// Operating system.
    pub system: &'static str,
    /// Kind of processor.
    pub architecture: &'static str,
    /// Of the instruction sets for which loops are compiled apart, those that this processor has.
    pub instruction_sets: Vec<&'static str>,
}

impl Provenance {
    /// Of this process.
    pub fn of_this_process() -> Self {
        Self {
            started: date_in_utc(SystemTime::now()),
            ended: None,
            commit: option_env!("PBIF_COMMIT").filter(|commit| !commit.is_empty()),
            system: std::env::consts::OS,
            architecture: std::env::consts::ARCH,
            instruction_sets: instruction_sets(),
        }
    }

    /// Now it has ended.
    pub fn end(&mut self) {
        self.ended = Some(date_in_utc(SystemTime::now()));
    }
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

//! The machine's memory, and bytes as people write them.

/// Memory of the machine, or of the group of processes where that is limited; `None` if unknown.
pub(crate) fn machine_memory() -> Option<f64> {
    let mut system = sysinfo::System::new().ok()?;
    system.refresh_memory();
    let limit = system.cgroup_limits().map(|limits| limits.total_memory);
    let total = system.total_memory();
    let memory = limit
        .filter(|&limit| limit > 0)
        .map_or(total, |limit| limit.min(total));
    (memory > 0).then_some(memory as f64)
}

/// Whether the system gives this process so many bytes beside what it has: a limit (`ulimit -v`) shows when memory is
/// asked for, and in the middle of something it ends the program. Nothing is written to them: only room among the
/// addresses is asked for.
pub(crate) fn has_room(bytes: f64) -> bool {
    let mut room = Vec::<u8>::new();
    room.try_reserve_exact(bytes as usize).is_ok()
}

/// A number of bytes as people write it.
pub(crate) fn bytes_in_words(bytes: f64) -> String {
    let units = ["kB", "MB", "GB", "TB", "PB"];
    let mut value = bytes / 1e3;
    let mut unit = 0;
    while value >= 1e3 && unit + 1 < units.len() {
        value /= 1e3;
        unit += 1;
    }
    format!("{value:.1} {}", units[unit])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bytes_are_written_with_a_unit() {
        assert_eq!(bytes_in_words(1.5e9), "1.5 GB");
        assert_eq!(bytes_in_words(2.0e21), "2000000.0 PB");
        assert_eq!(bytes_in_words(12.0), "0.0 kB");
    }
}

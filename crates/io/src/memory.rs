//! How much memory there is, and how much of it an array may take.

use std::sync::LazyLock;

use sysinfo::{MemoryRefreshKind, RefreshKind, System};

/// The most bytes that an array made from a table may take.
pub(crate) const SIZE_LIMIT: u64 = 2_000_000_000;

/// Memory of the machine in bytes, or of the part of it that this process may use; `None` where that is not known.
pub fn machine_memory() -> Option<u64> {
    static MEMORY: LazyLock<Option<u64>> = LazyLock::new(|| {
        let what = RefreshKind::nothing().with_memory(MemoryRefreshKind::nothing().with_ram());
        let system = System::new_with_specifics(what).ok()?;
        let group = system.cgroup_limits().map(|limits| limits.total_memory);
        let machine = system.total_memory();
        Some(group.unwrap_or(machine).min(machine)).filter(|bytes| *bytes > 0)
    });
    *MEMORY
}

//! What this process runs on.

use pyo3::prelude::*;

/// The instructions beyond the baseline that this processor has and octray may use.
#[pyfunction]
pub(crate) fn cpu_features() -> Vec<&'static str> {
    #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
    {
        [
            ("sse4.2", is_x86_feature_detected!("sse4.2")),
            ("avx", is_x86_feature_detected!("avx")),
            ("avx2", is_x86_feature_detected!("avx2")),
            ("fma", is_x86_feature_detected!("fma")),
            ("avx512f", is_x86_feature_detected!("avx512f")),
        ]
        .into_iter()
        .filter_map(|(name, there)| there.then_some(name))
        .collect()
    }
    #[cfg(target_arch = "aarch64")]
    {
        vec!["neon"]
    }
    #[cfg(not(any(target_arch = "x86", target_arch = "x86_64", target_arch = "aarch64")))]
    {
        Vec::new()
    }
}

/// How many threads are used when nothing is said.
#[pyfunction]
pub(crate) fn default_threads() -> usize {
    crate::pool::default_threads()
}

/// Bytes that data of this process may still take: seven eighths of what is free in the machine, in
/// its control group or under its limit of address space, whichever is least; `None` where the
/// system does not say.
///
/// Read from `/proc` and `/sys/fs/cgroup` (proc(5), cgroups(7)).
pub(crate) fn available_memory() -> Option<u64> {
    let read = |path: &str| std::fs::read_to_string(path).ok();
    let number = |path: &str| read(path)?.trim().parse::<u64>().ok();
    let free = || kibibytes(&read("/proc/meminfo")?, "MemAvailable:");
    let address_space = || {
        let limits = read("/proc/self/limits")?;
        let line = limits
            .lines()
            .find_map(|l| l.strip_prefix("Max address space"))?;
        let limit = line.split_whitespace().next()?.parse::<u64>().ok()?;
        let taken = kibibytes(&read("/proc/self/status")?, "VmSize:")?;
        // Half of it, as allocators reserve 64 MiB for each thread (malloc(3), `M_ARENA_MAX`).
        Some(limit.saturating_sub(taken) / 2)
    };
    let control_group =
        |limit: &str, used: &str| Some(number(limit)?.saturating_sub(number(used)?));
    [
        free(),
        address_space(),
        control_group("/sys/fs/cgroup/memory.max", "/sys/fs/cgroup/memory.current"),
        control_group(
            "/sys/fs/cgroup/memory/memory.limit_in_bytes",
            "/sys/fs/cgroup/memory/memory.usage_in_bytes",
        ),
    ]
    .into_iter()
    .flatten()
    .min()
    .map(|bytes| bytes - bytes / 8)
}

/// The number of a line `NAME: 123 kB`, in bytes.
fn kibibytes(text: &str, name: &str) -> Option<u64> {
    field(text, name)?.checked_mul(1024)
}

/// The number of a line that begins with this name.
fn field(text: &str, name: &str) -> Option<u64> {
    let line = text.lines().find_map(|line| line.strip_prefix(name))?;
    line.split_whitespace().next()?.parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_of_the_system_is_a_number_of_bytes() {
        let text = "MemTotal:  24 kB\nMemAvailable:   20152 kB\n";
        assert_eq!(kibibytes(text, "MemAvailable:"), Some(20_152 << 10));
        assert_eq!(kibibytes(text, "SwapFree:"), None);
        assert_eq!(kibibytes("A: x kB", "A:"), None);
    }
}

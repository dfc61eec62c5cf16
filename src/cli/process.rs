//! What the process has used, and may use.

use std::path::Path;

/// CPU seconds of all threads so far, where the system tells.
pub fn cpu_seconds() -> Option<f64> {
    #[cfg(unix)]
    {
        let time = rustix::time::clock_gettime(rustix::time::ClockId::ProcessCPUTime);
        Some(time.tv_sec as f64 + 1e-9 * time.tv_nsec as f64)
    }
    #[cfg(not(unix))]
    None
}

/// The most memory that was resident at one time, in bytes; Linux tells it in `/proc`.
pub fn peak_resident_bytes() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let kibibytes = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?.trim().strip_suffix("kB")?.trim();
    Some(kibibytes.parse::<u64>().ok()? * 1024)
}

/// Bytes of memory that the system would give without swapping, or the limit of a control group of the process (of its container, say) if
/// that is less; Linux tells it.
pub fn available_memory_bytes() -> Option<u64> {
    let meminfo = std::fs::read_to_string("/proc/meminfo").ok()?;
    let kibibytes = meminfo.lines().find_map(|line| line.strip_prefix("MemAvailable:"))?.trim().strip_suffix("kB")?.trim();
    let available = kibibytes.parse::<u64>().ok()? * 1024;
    Some(control_group_limit_bytes().map_or(available, |limit| limit.min(available)))
}

/// The least limit of the process's control group (version 2) and of those above it, where there is one.
fn control_group_limit_bytes() -> Option<u64> {
    let groups = std::fs::read_to_string("/proc/self/cgroup").ok()?;
    let group = Path::new(groups.lines().find_map(|line| line.strip_prefix("0::/"))?);
    let limit_of = |group: &Path| {
        let text = std::fs::read_to_string(Path::new("/sys/fs/cgroup").join(group).join("memory.max")).ok()?;
        text.trim().parse::<u64>().ok() // "max" is no limit
    };
    group.ancestors().filter_map(limit_of).min()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[cfg(target_os = "linux")]
    #[test]
    fn linux_tells_all() {
        let before = cpu_seconds().unwrap();
        let busy: f64 = std::hint::black_box((0..2_000_000).map(|k| f64::from(k).sqrt()).sum());
        assert!(busy > 0.0 && cpu_seconds().unwrap() > before);
        assert!(peak_resident_bytes().unwrap() > 100_000);
        // More than nothing, and less than any machine has.
        assert!((1 << 20..1 << 60).contains(&available_memory_bytes().unwrap()));
    }
}

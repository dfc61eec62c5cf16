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

/// CPU seconds of the calling thread so far, where the system tells.
pub fn thread_cpu_seconds() -> Option<f64> {
    #[cfg(unix)]
    {
        let time = rustix::time::clock_gettime(rustix::time::ClockId::ThreadCPUTime);
        Some(time.tv_sec as f64 + 1e-9 * time.tv_nsec as f64)
    }
    #[cfg(not(unix))]
    None
}

/// The most memory that was resident at one time, in bytes; Linux tells it in `/proc`.
pub fn peak_resident_bytes() -> Option<u64> {
    status_bytes("VmHWM:")
}

/// A number of `/proc/self/status`, in bytes.
fn status_bytes(name: &str) -> Option<u64> {
    kibibytes_of(&std::fs::read_to_string("/proc/self/status").ok()?, name)
}

/// The number of this name in a list of names and kibibytes, in bytes.
fn kibibytes_of(list: &str, name: &str) -> Option<u64> {
    let kibibytes = list.lines().find_map(|line| line.strip_prefix(name))?.trim().strip_suffix("kB")?.trim();
    Some(kibibytes.parse::<u64>().ok()? * 1024)
}

/// What the process takes of something, and the most that it could have of it by now, in bytes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Share {
    /// Of what, in words.
    pub of: &'static str,
    /// What is taken.
    pub taken: u64,
    /// What could be.
    pub most: u64,
}

/// Memory and address space, each if there is a limit and the system tells it; Linux does.
pub fn memory_shares() -> Vec<Share> {
    let (Some(resident), Some(size)) = (status_bytes("VmRSS:"), status_bytes("VmSize:")) else { return Vec::new() };
    let memory = memory_left_bytes().map(|left| Share { of: "the memory", taken: resident, most: resident.saturating_add(left) });
    let space = address_space_limit_bytes().map(|most| Share { of: "the address space (ulimit -v)", taken: size, most });
    memory.into_iter().chain(space).collect()
}

/// What the system would still give without swapping, or a control group of the process (of its container, say) if that is less.
fn memory_left_bytes() -> Option<u64> {
    let available = kibibytes_of(&std::fs::read_to_string("/proc/meminfo").ok()?, "MemAvailable:")?;
    Some(control_group_left_bytes().map_or(available, |left| left.min(available)))
}

/// What is left of the least limit of the process's control group (version 2) and of those above it, where there is one. Files that the
/// system keeps in memory make room.
fn control_group_left_bytes() -> Option<u64> {
    let groups = std::fs::read_to_string("/proc/self/cgroup").ok()?;
    let group = Path::new(groups.lines().find_map(|line| line.strip_prefix("0::/"))?);
    let left_of = |group: &Path| {
        let read = |name: &str| std::fs::read_to_string(Path::new("/sys/fs/cgroup").join(group).join(name)).ok();
        let limit = read("memory.max")?.trim().parse::<u64>().ok()?; // "max" is no limit
        let current = read("memory.current")?.trim().parse::<u64>().ok()?;
        let stat = read("memory.stat").unwrap_or_default();
        let files = stat.lines().find_map(|line| line.strip_prefix("inactive_file ")?.trim().parse::<u64>().ok());
        Some(limit.saturating_sub(current.saturating_sub(files.unwrap_or(0))))
    };
    group.ancestors().filter_map(left_of).min()
}

/// The limit of the address space, where there is one.
fn address_space_limit_bytes() -> Option<u64> {
    let limits = std::fs::read_to_string("/proc/self/limits").ok()?;
    let line = limits.lines().find_map(|line| line.strip_prefix("Max address space"))?;
    line.split_whitespace().next()?.parse().ok() // "unlimited" is no limit
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
        let memory = memory_shares()[0];
        assert!(memory.taken > 1 << 20 && memory.taken < memory.most && memory.most < 1 << 60, "{memory:?}");
    }
}

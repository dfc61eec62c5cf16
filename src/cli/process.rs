//! What the process has used.

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

#[cfg(test)]
mod tests {
    use super::*;

    #[cfg(target_os = "linux")]
    #[test]
    fn linux_tells_both() {
        let before = cpu_seconds().unwrap();
        let busy: f64 = std::hint::black_box((0..2_000_000).map(|k| f64::from(k).sqrt()).sum());
        assert!(busy > 0.0 && cpu_seconds().unwrap() > before);
        assert!(peak_resident_bytes().unwrap() > 100_000);
    }
}

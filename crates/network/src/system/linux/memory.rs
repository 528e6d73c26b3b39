//! Memory that is free, by the files of the kernel.

use std::fs::read_to_string;

/// Where a group of processes with a limit of its own finds that limit and what it uses.
const LIMIT: &str = "/sys/fs/cgroup/memory.max";
const USED: &str = "/sys/fs/cgroup/memory.current";

/// Returns the octets of memory that programs can still use; `None` where the kernel does not report that.
#[must_use]
pub fn free_memory() -> Option<u64> {
    let system = available(&read_to_string("/proc/meminfo").ok()?)?;
    let number = |file| read_to_string(file).ok()?.trim().parse::<u64>().ok();
    let group = number(LIMIT).zip(number(USED));
    Some(group.map_or(system, |(limit, used)| system.min(limit.saturating_sub(used))))
}

/// Reads `MemAvailable:   12345 kB`.
fn available(text: &str) -> Option<u64> {
    let line = text.lines().find_map(|line| line.strip_prefix("MemAvailable:"))?;
    let kilobytes: u64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    kilobytes.checked_mul(1024)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_line_of_the_kernel_is_read() {
        let text = "MemTotal:       16384 kB\nMemFree:  1 kB\nMemAvailable:    2048 kB\n";
        assert_eq!(available(text), Some(2 << 20));
        assert_eq!(available("MemAvailable: many kB"), None);
        assert!(free_memory().is_some_and(|free| free > 0));
    }
}

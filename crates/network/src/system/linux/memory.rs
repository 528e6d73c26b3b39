//! Memory that is free, by the files of the kernel.

use std::fs::read_to_string;
use std::path::{Component, Path};

/// Where the kernel shows groups of processes with limits of their own.
const GROUPS: &str = "/sys/fs/cgroup";

/// Returns the octets of memory that this program can still use; `None` where the kernel does not report that.
#[must_use]
pub fn free_memory() -> Option<u64> {
    let system = available(&read_to_string("/proc/meminfo").ok()?)?;
    let own = read_to_string("/proc/self/cgroup").unwrap_or_default();
    let limits = left_in_groups(Path::new(GROUPS), group(&own));
    Some(limits.map_or(system, |left| system.min(left)))
}

/// Reads `MemAvailable:   12345 kB`.
fn available(text: &str) -> Option<u64> {
    let line = text.lines().find_map(|line| line.strip_prefix("MemAvailable:"))?;
    let kilobytes: u64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    kilobytes.checked_mul(1024)
}

/// Reads the group of this process: `0::/system.slice/drives.service`.
fn group(text: &str) -> &Path {
    let path = text.lines().find_map(|line| line.strip_prefix("0::"));
    Path::new(path.unwrap_or("/"))
}

/// Returns what the limits of a group and of all groups above it leave; `None` without a limit. A container may see the folder
/// of its own group at the root, and then its name leads nowhere.
fn left_in_groups(root: &Path, own: &Path) -> Option<u64> {
    let mut folder = root.to_path_buf();
    let mut least = left(&folder);
    for part in own.components() {
        match part {
            Component::Normal(name) => folder.push(name),
            Component::RootDir | Component::CurDir => continue,
            // a group outside of what this process can see
            Component::ParentDir | Component::Prefix(_) => break,
        }
        least = [least, left(&folder)].into_iter().flatten().min();
    }
    least
}

/// Returns what the limit of one group leaves. The kernel takes back the memory with copies of files when a program needs
/// it, as far as they are the same as on the disk.
fn left(folder: &Path) -> Option<u64> {
    let text = |name| read_to_string(folder.join(name)).ok();
    let number = |name| text(name)?.trim().parse::<u64>().ok();
    let (limit, used) = (number("memory.max")?, number("memory.current")?);
    let stat = text("memory.stat").unwrap_or_default();
    let of = |name: &str| -> u64 {
        let value = |line: &str| line.strip_prefix(name)?.strip_prefix(' ')?.trim().parse().ok();
        stat.lines().find_map(value).unwrap_or_default()
    };
    let files = of("inactive_file").saturating_add(of("active_file"));
    let unsaved = of("file_dirty").saturating_add(of("file_writeback"));
    let needed = used.saturating_sub(files.saturating_sub(unsaved));
    Some(limit.saturating_sub(needed))
}

#[cfg(test)]
mod tests {
    use std::fs::{create_dir_all, remove_dir_all, write};

    use super::*;

    #[test]
    fn the_line_of_the_kernel_is_read() {
        let text = "MemTotal:       16384 kB\nMemFree:  1 kB\nMemAvailable:    2048 kB\n";
        assert_eq!(available(text), Some(2 << 20));
        assert_eq!(available("MemAvailable: many kB"), None);
        assert!(free_memory().is_some_and(|free| free > 0));
        let own = "4:cpu:/x\n0::/system.slice/drives.service\n";
        assert_eq!(group(own), Path::new("/system.slice/drives.service"));
        assert_eq!(group(""), Path::new("/"));
    }

    #[test]
    fn the_lowest_limit_of_a_group_and_those_above_it_counts_without_copies_of_files() {
        let root = std::env::temp_dir().join(format!("profidrive-groups-{}", std::process::id()));
        let service = root.join("system.slice/drives.service");
        create_dir_all(&service).unwrap();
        let put = |folder: &Path, limit: &str, used: &str, stat: &str| {
            for (name, text) in [
                ("memory.max", limit),
                ("memory.current", used),
                ("memory.stat", stat),
            ] {
                write(folder.join(name), format!("{text}\n")).unwrap();
            }
        };
        let own = Path::new("/system.slice/drives.service");
        assert_eq!(left_in_groups(&root, own), None, "no limits");
        let stat = "anon 200\nfile 700\ninactive_file 500\nactive_file 150\nfile_dirty 40\nfile_writeback 10";
        put(&service, "1000", "900", stat);
        assert_eq!(left_in_groups(&root, own), Some(700));
        put(&root.join("system.slice"), "2000", "1900", "anon 1900");
        assert_eq!(left_in_groups(&root, own), Some(100));
        assert_eq!(left_in_groups(&root, Path::new("/elsewhere")), None);
        assert_eq!(left_in_groups(&root, Path::new("/../system.slice")), None);
        put(&service, "max", "900", stat);
        put(&root.join("system.slice"), "max", "1900", "");
        // a container sees its own group at the root
        put(&root, "1000", "1200", "");
        assert_eq!(left_in_groups(&root, own), Some(0));
        assert_eq!(left_in_groups(&root, Path::new("/docker/0123")), Some(0));
        remove_dir_all(&root).unwrap();
    }
}

//! The table of neighbours, by the files of the kernel.

use std::fs::read_to_string;

use crate::system::NeighbourTable;

/// Returns the table of IPv4; `None` where the kernel does not report it.
#[must_use]
pub fn neighbour_table() -> Option<NeighbourTable> {
    let most = read_to_string("/proc/sys/net/ipv4/neigh/default/gc_thresh3").ok()?;
    Some(NeighbourTable {
        held: read_to_string("/proc/net/stat/arp_cache")
            .ok()
            .and_then(|text| entries(&text))
            .unwrap_or_default(),
        most: most.trim().parse().ok()?,
    })
}

/// Reads the first column of the statistics, in hexadecimal digits; each processor has a line with the same number of entries.
fn entries(text: &str) -> Option<usize> {
    let line = text.lines().nth(1)?;
    usize::from_str_radix(line.split_ascii_whitespace().next()?, 16).ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_statistics_of_the_kernel_are_read() {
        let text = "entries  allocs   destroys\n00000400  0000ffff 00000000\n00000400  00000001 00000000\n";
        assert_eq!(entries(text), Some(1024));
        assert_eq!(entries("entries allocs\n"), None);
        assert_eq!(entries("entries\nmany\n"), None);
    }
}

//! The table in which the kernel remembers the Ethernet addresses of stations.

/// From this share on the table counts as full: the kernel discards entries in steps.
const FULL: f64 = 0.95;
/// The setting of the kernel.
const SETTING: &str = "net.ipv4.neigh.default.gc_thresh3";

/// How many Ethernet addresses of IPv4 stations the kernel remembers. One table serves all network namespaces. A datagram to
/// a station whose address finds no room there is discarded.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct NeighbourTable {
    /// Addresses that it has now.
    pub held: usize,
    /// Addresses that it has at most.
    pub most: usize,
}

impl NeighbourTable {
    /// Returns the table of this computer; `None` where the system does not report it.
    #[must_use]
    pub fn of_kernel() -> Option<Self> {
        super::os::neighbour_table()
    }

    /// Returns true where there is hardly room for another station.
    #[must_use]
    pub fn is_full(&self) -> bool {
        self.held as f64 >= self.most as f64 * FULL
    }

    /// Returns the command that makes room for so many stations.
    #[must_use]
    pub fn enlarged_for(&self, stations: usize) -> String {
        let wanted = stations.max(self.most).saturating_mul(2);
        let room = wanted.checked_next_power_of_two().unwrap_or(wanted);
        format!("sysctl -w {SETTING}={room}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_larger_table_has_room_for_twice_the_stations() {
        let table = NeighbourTable {
            held: 1000,
            most: 1024,
        };
        assert!(table.is_full());
        assert!(!NeighbourTable { held: 900, ..table }.is_full());
        assert_eq!(
            table.enlarged_for(40),
            "sysctl -w net.ipv4.neigh.default.gc_thresh3=2048"
        );
        assert!(table.enlarged_for(5000).ends_with("=16384"));
        assert!(table.enlarged_for(usize::MAX).contains(SETTING));
    }
}

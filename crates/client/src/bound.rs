//! Highest speeds that a machine permits its drives.

use profinet::MacAddress;

use crate::{Drive, Session};

/// Highest speed of a motion of a drive on its machine.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SpeedBound {
    /// The speed, rpm.
    pub rpm: f64,
    /// Line of the machine file, from 1.
    pub line: usize,
}

/// A drive of a machine with its highest speed.
#[derive(Debug, Clone, PartialEq)]
pub struct BoundedDrive {
    /// Name of the station.
    pub name: String,
    /// Ethernet address; `None` where the machine does not know it.
    pub mac: Option<MacAddress>,
    /// The highest speed.
    pub bound: SpeedBound,
}

impl Session {
    /// Sets the highest speeds of drives on their machine, in place of those that were set. They hold for every motion of this session
    /// and of the clones that are made of it from now on.
    pub fn bound_speeds(&mut self, bounds: Vec<BoundedDrive>) {
        self.bounds = bounds.into();
    }

    /// Returns the highest speed of a drive on its machine: that of its name or of its Ethernet address, the lower one.
    #[must_use]
    pub fn speed_bound(&self, drive: &Drive) -> Option<SpeedBound> {
        let station = &drive.station;
        let means = |one: &&BoundedDrive| one.name == station.name || one.mac == Some(station.mac);
        let bounds = self.bounds.iter().filter(means).map(|one| one.bound);
        bounds.min_by(|a, b| a.rpm.total_cmp(&b.rpm))
    }
}

//! The time of day of what happens on a network.

use std::time::{Duration, SystemTime};

use crate::open::{Caller, Transport};

/// The time of day on a network. A plant in memory has none: its time is virtual.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct WallClock {
    is_real: bool,
}

impl WallClock {
    /// For times that have no time of day.
    pub const NONE: Self = Self { is_real: false };

    /// Returns the time of day of what happened so long ago; `None` in virtual time.
    #[must_use]
    pub fn before(self, ago: Duration) -> Option<SystemTime> {
        self.is_real.then(|| SystemTime::now().checked_sub(ago)).flatten()
    }
}

impl Caller {
    /// Returns the clock that gives the time of day of what happens on this network.
    #[must_use]
    pub const fn wall_clock(&self) -> WallClock {
        WallClock {
            is_real: match self.transport() {
                Transport::Packet(_) | Transport::Udp | Transport::Serial => true,
                #[cfg(feature = "simulate")]
                Transport::Plant(_) => false,
            },
        }
    }
}

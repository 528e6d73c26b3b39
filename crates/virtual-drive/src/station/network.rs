//! Name, address and I&M data on their way to non-volatile memory, which the owner of the station writes.

use profile::parameter::SaveId;
use profinet::{Instant, IpSuite};

use super::{Station, StationEvent};

/// Saves of the network data.
#[derive(Debug, Default)]
pub(super) struct NetworkSaves {
    /// The owner reports what became of every save; otherwise a save counts as done at once.
    pub confirmed: bool,
    /// Number of the newest save.
    issued: u64,
    /// A Set by DCP that waits for the save of this number.
    waiting: Option<(u64, Before)>,
}

/// What a Set by DCP has changed, to be put back when it cannot be stored.
#[derive(Debug, Clone)]
pub(super) struct Before {
    name: String,
    ip: IpSuite,
    finding: bool,
    /// The Set overrules the switches: IP.MODE shows this once it is stored.
    pub overruled: bool,
}

impl Station {
    /// Network data as it is now.
    pub(super) fn before(&self) -> Before {
        Before {
            name: self.config.network.name.clone(),
            ip: self.config.network.ip,
            finding: self.finding,
            overruled: false,
        }
    }

    /// Lets the owner store the network data.
    pub(super) fn store_network(&mut self) {
        self.network_saves.issued += 1;
        self.emit(StationEvent::PersistNetwork {
            network: self.config.network.clone(),
            save: SaveId(self.network_saves.issued),
        });
    }

    /// Lets the owner store what a Set has changed since `before`.
    pub(super) fn store_set(&mut self, before: Before) {
        self.store_network();
        if !self.network_saves.confirmed {
            if before.overruled {
                self.drive.address_set();
            }
            return;
        }
        let saves = &mut self.network_saves;
        // one Set may change both: the first change has seen what was before
        let overruled = before.overruled;
        let (waits, first) = saves.waiting.get_or_insert((0, before));
        *waits = saves.issued;
        first.overruled |= overruled;
    }

    /// Lets the answers of the device wait where the owner reports its saves.
    pub(super) fn confirm_stores(&mut self) {
        self.network_saves.waiting = None;
        if self.network_saves.confirmed {
            self.device.confirm_stores();
        }
    }

    /// Reports that the data of a [`StationEvent::PersistNetwork`] is stored, or that it could not be; the report counts for
    /// every earlier save too. A name or address by DCP is answered then; one that is not stored is refused, and the one
    /// before counts again.
    pub fn report_network(&mut self, now: Instant, SaveId(number): SaveId, stored: bool) {
        let waiting = self.network_saves.waiting.take_if(|(waits, _)| *waits <= number);
        let Some((_, before)) = waiting else { return };
        if !stored {
            self.config.network.name = before.name;
            self.config.network.ip = before.ip;
            self.finding = before.finding;
        } else if before.overruled {
            self.drive.address_set();
        }
        self.device.answer_set(now, stored);
        self.settle(now);
    }
}

//! Where the drive has its address from (IP.MODE and the rotary switches), and how both are reset.
//!
//! Source: AKD PROFINET manual 3.4.1 and 3.4.2; the numbers of IP.MODE other than 1 are from memory of the AKD User Guide.

use std::net::Ipv4Addr;

use profile::catalogue::Part;
use profinet::IpSuite;

use super::{Drive, Event};
use crate::store::Values;

/// IP.MODE: the rotary switches; DHCP and AutoIP when they are 0.
const ROTARY: i64 = 0;
/// IP.MODE: the stored address, which DCP overwrites.
const STORED: i64 = 1;

/// For so long button B1 is held to reset the address settings, s.
const HELD: f64 = 5.0;

/// Where a drive has its address from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum AddressSource {
    /// Set by DCP and stored.
    Stored,
    /// This one, from the rotary switches.
    Switches(IpSuite),
    /// A DHCP server, else a link-local one (AutoIP).
    Found,
}

impl Drive {
    /// Turns the rotary switches, 0 to 99 (DIN.ROTARY); the address follows at the next power-on. They give the address of
    /// a drive as delivered (IP.MODE 0); without this call that is the stored one (IP.MODE 1).
    pub const fn set_rotary(&mut self, number: u8) {
        self.rotary = Some(number);
    }

    /// Returns the position of the rotary switches.
    pub(super) fn rotary(&self) -> u8 {
        self.rotary.unwrap_or_default()
    }

    /// Values as delivered, with the address set by the switches.
    pub(super) fn delivered(&self) -> Values {
        let mut values = Values::new(self.model.catalogue);
        if let Some(pnu) = self
            .model
            .number(Part::AddressMode)
            .filter(|_| self.rotary.is_some())
        {
            values.set(pnu, ROTARY);
        }
        values
    }

    /// Makes the rotary switches count, as they do after a reset of the address settings (manual 3.4.2), unless saved
    /// parameters override it.
    pub fn follow_switches(&mut self) {
        let never_saved = self.saving.newest().is_none();
        if let Some(pnu) = self.model.number(Part::AddressMode).filter(|_| never_saved) {
            self.values.set(pnu, ROTARY);
        }
    }

    /// Returns the source of the address by IP.MODE and the rotary switches.
    #[must_use]
    pub fn address_source(&self) -> AddressSource {
        let mode = self
            .model
            .number(Part::AddressMode)
            .map(|pnu| self.values.get(pnu));
        match (mode, self.rotary()) {
            (None | Some(STORED), _) => AddressSource::Stored,
            (Some(ROTARY), 1..) => AddressSource::Switches(IpSuite {
                address: Ipv4Addr::new(192, 168, 0, self.rotary()),
                mask: Ipv4Addr::new(255, 255, 255, 0),
                gateway: Ipv4Addr::UNSPECIFIED,
            }),
            _ => AddressSource::Found,
        }
    }

    /// DCP has set the address for good: the IP parameters of the drive are overwritten, in its memory too, and IP.MODE
    /// says so. Other parameters that were changed and not saved stay as they are. Source: AKD PROFINET manual 3.4.1.
    pub fn address_set(&mut self) {
        self.keep_address_mode(STORED);
    }

    /// Button B1 was held for so many seconds: with the rotary switches at 0 and from 5 s on, the address settings are
    /// those of the delivery at the next power-on. Source: AKD PROFINET manual 3.4.2.
    pub(super) fn hold_button(&mut self, seconds: f64) {
        if seconds >= HELD && self.rotary() == 0 && self.model.number(Part::AddressMode).is_some() {
            self.keep_address_mode(ROTARY);
            self.emit(Event::AddressReset);
        }
    }
}

//! What is known about each drive of a capture, by its address.

use std::borrow::Cow;
use std::collections::HashMap;
use std::net::Ipv4Addr;

use profile::model::Model;
use profinet::wire::Uuid;

use crate::job::JobDrive;

/// Maximum number of drives whose identity is stored.
const MAX_DRIVES: usize = 1024;

/// The drives of a capture.
#[derive(Debug, Default)]
pub struct Drives {
    known: HashMap<Ipv4Addr, JobDrive>,
    /// Model assumed for a drive whose capture does not identify it.
    model: Option<Model>,
    /// Entry without data, shared by all drives beyond the maximum.
    other: JobDrive,
}

impl Drives {
    /// Model assumed for drives that the capture does not identify.
    pub fn new(model: Option<Model>) -> Self {
        Self {
            model,
            ..Self::default()
        }
    }

    /// Returns the drive at an address.
    pub fn at(&mut self, ip: Ipv4Addr) -> &mut JobDrive {
        let model = self.model;
        let fresh = || model.map_or_else(JobDrive::default, JobDrive::new);
        if self.known.len() >= MAX_DRIVES && !self.known.contains_key(&ip) {
            self.other = fresh();
            return &mut self.other;
        }
        self.known.entry(ip).or_insert_with(fresh)
    }

    /// Returns what is known of the drive at an address.
    pub fn known(&self, ip: Ipv4Addr) -> Cow<'_, JobDrive> {
        match self.known.get(&ip) {
            Some(drive) => Cow::Borrowed(drive),
            None => Cow::Owned(self.model.map_or_else(JobDrive::default, JobDrive::new)),
        }
    }

    /// Records from the object of a call which vendor and device use an address.
    pub fn called(&mut self, ip: Ipv4Addr, object: &Uuid) {
        if let Some(reported) = JobDrive::of_object(object) {
            self.take(ip, reported);
        }
    }

    /// Records address, vendor and device of a station.
    pub fn discovered(&mut self, ip: Ipv4Addr, vendor: u16, device: u16) {
        if !ip.is_unspecified() && vendor != 0 {
            self.take(ip, JobDrive::of(vendor, device));
        }
    }

    fn take(&mut self, ip: Ipv4Addr, reported: JobDrive) {
        let known = self.at(ip);
        if !known.is_like(&reported) {
            *known = reported;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn identity_decides_and_memory_is_bounded() {
        let mut drives = Drives::default();
        let ip = Ipv4Addr::new(10, 0, 0, 2);
        assert_eq!(drives.at(ip).name(), "AKD");
        drives.called(ip, &Uuid::object(1, 1, 0x0080));
        assert_eq!(drives.at(ip).name(), "VLT");
        drives.discovered(ip, 0x01BA, 0x0100);
        assert_eq!(drives.at(ip).name(), "VACON");
        drives.called(ip, &Uuid::NIL);
        assert_eq!(drives.at(ip).name(), "VACON");
        for number in 0..5000_u32 {
            drives.at(Ipv4Addr::from(number));
        }
        assert_eq!(drives.known.len(), MAX_DRIVES);
        let mut named = Drives::new(Model::by_name("vlt"));
        assert_eq!(named.at(ip).name(), "VLT");
    }
}

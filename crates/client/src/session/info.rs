//! Who a drive is.

use profile::catalogue::Part;
use profile::parameter::pnu;
use profile::telegram::signal;
use profinet::MacAddress;
use profinet::controller::{RecordAddress, ServiceError};
use profinet::wire::record::{IdentifiedModule, Im0, ImText, PortPeer, PortReal, decode_ar_list, index};
use profinet::wire::{DecodeError, Reader, Uuid};

use super::Session;
use super::readings::places;
use crate::{Drive, Error, Identity, Refusal, Route};
use profile::value::{Reading, Selection};

/// Subslot of the first port, in slot 0.
const FIRST_PORT: u16 = 0x8001;
/// Index of I&M0; I&M1 to 3 follow.
const IM0: u16 = 0xAFF0;
/// Parameters that identify a drive: identification, profile, object, telegram, mode, words, faults.
const PAGE: [u16; 8] = [
    pnu::IDENTIFICATION,
    pnu::PROFILE,
    pnu::DRIVE_OBJECT,
    pnu::TELEGRAM,
    pnu::OPERATING_MODE,
    signal::STW1,
    signal::ZSW1,
    pnu::FAULT_COUNTER,
];

/// A station at the other end of a drive's cable.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Peer {
    /// The drive's own port.
    pub own_port: String,
    /// The port of the neighbour.
    pub port: String,
    /// Name of the neighbour, empty where it has none.
    pub station: String,
    /// Its Ethernet address.
    pub mac: MacAddress,
}

/// Everything that `info` reports about a drive.
#[derive(Debug, Clone)]
pub struct Info {
    /// I&M0 to 3; `None` when the device has no I&M0.
    pub identity: Option<Identity>,
    /// Name of the controller that has the cyclic connection: `Some(None)` without a controller, `None` when the device
    /// does not report it.
    pub controller: Option<Option<String>>,
    /// Stations at the other end of its first cable; empty when it does not report them.
    pub peers: Vec<Peer>,
    /// The modules that are plugged; empty when the device does not report them.
    pub modules: Vec<IdentifiedModule>,
    /// The way on which its records were read; `None` when no record was.
    pub route: Option<Route>,
    /// Records and parameters the device refused, with its reason.
    pub refused: Vec<String>,
    /// What was requested and not answered in time; it is among `refused` too.
    pub unanswered: Vec<String>,
    /// The page of identifying parameters, refused ones left out.
    pub readings: Vec<Reading>,
}

impl Session {
    /// Reads who a device is and in which state. A device that does not have something of it does not fail for that:
    /// one that is not a drive, or whose parameters cannot be reached now, still has its identity and its modules.
    ///
    /// # Errors
    /// When the device cannot be reached.
    pub async fn info(&mut self, drive: &mut Drive) -> Result<Info, Error> {
        let mut info = Info {
            identity: None,
            controller: None,
            peers: Vec::new(),
            modules: Vec::new(),
            route: None,
            refused: Vec::new(),
            unanswered: Vec::new(),
            readings: Vec::new(),
        };
        match self.read_records(drive, &mut info).await {
            Err(error @ Error::NoRoute { .. }) => info.refused.push(error.to_string()),
            other => other?,
        }
        info.route = self.route(drive);
        if !info.is_drive(drive) {
            let error = Error::NotADrive { drive: drive.label() };
            info.refused.push(error.to_string());
            return Ok(info);
        }
        let readings = match self.read_page(drive).await {
            Ok(readings) => readings,
            // a device without a parameter channel still has its identity
            Err(Error::Record { what, error, .. }) => {
                info.miss(&what, &error);
                Vec::new()
            }
            Err(
                error @ (Error::NoRoute { .. } | Error::ParametersOwned { .. } | Error::NotADrive { .. }),
            ) => {
                let message = error.to_string();
                if !info.refused.contains(&message) {
                    info.refused.push(message);
                }
                Vec::new()
            }
            Err(error) => return Err(error),
        };
        for reading in readings {
            match reading {
                Ok(reading) => info.readings.push(reading),
                Err(refusal) => info.refused.push(Refusal::to_string(&refusal)),
            }
        }
        Ok(info)
    }

    /// What stands in records, which need no parameters.
    async fn read_records(&mut self, drive: &Drive, info: &mut Info) -> Result<(), Error> {
        let records = if drive.is_on_line() { 0 } else { 4_u8 };
        for number in 0..records {
            let at = RecordAddress {
                api: 0,
                slot: 0,
                subslot: 1,
                index: IM0 + u16::from(number),
            };
            match self.read_record(drive, at).await {
                Ok(data) => {
                    if let Err(error) = take_im(&mut info.identity, number, &data) {
                        info.refused.push(format!("I&M{number}: {error}"));
                    }
                }
                Err(Error::Record { error, .. }) => info.miss(&format!("I&M{number}"), &error),
                Err(error) => return Err(error),
            }
        }
        info.controller = self.owner(drive).await?;
        info.peers = self.peers(drive).await?;
        info.modules = self.modules(drive).await?;
        Ok(())
    }

    async fn read_page(&mut self, drive: &mut Drive) -> Result<Vec<Result<Reading, Refusal>>, Error> {
        let page = self.page(drive).await?;
        self.read(drive, &page).await
    }

    /// Returns the parameters that identify a drive: from its tables, else the numbers of the profile that it has.
    async fn page(&mut self, drive: &Drive) -> Result<Vec<Selection>, Error> {
        let own: Vec<Selection> = places(drive, Part::Page)
            .into_iter()
            .map(|(_, place)| place)
            .collect();
        if own.is_empty() {
            self.whole(drive, &PAGE).await
        } else {
            Ok(own)
        }
    }

    /// Returns the identification of a drive from I&M0; `None` when it has no such record.
    ///
    /// # Errors
    /// When the drive cannot be reached.
    pub async fn identity(&mut self, drive: &Drive) -> Result<Option<Identity>, Error> {
        let at = RecordAddress {
            api: 0,
            slot: 0,
            subslot: 1,
            index: IM0,
        };
        let mut identity = None;
        match self.read_record(drive, at).await {
            // a record that cannot be decoded is ignored
            Ok(data) => Ok(take_im(&mut identity, 0, &data).ok().and(identity)),
            Err(Error::Record { .. } | Error::NotOnLine { .. }) => Ok(None),
            Err(error) => Err(error),
        }
    }

    /// Returns the name of the controller that has the cyclic connection of a drive: `Some(None)` without a controller,
    /// `None` when the device does not report it.
    ///
    /// # Errors
    /// When the drive cannot be reached.
    pub async fn owner(&mut self, drive: &Drive) -> Result<Option<Option<String>>, Error> {
        let at = RecordAddress {
            api: 0,
            slot: 0,
            subslot: 1,
            index: index::AR_DATA,
        };
        match self.read_record(drive, at).await {
            Ok(data) => {
                let own = self.record_ars(drive);
                Ok(controller_of(&data, &own))
            }
            // many devices do not report it
            Err(Error::Record { .. } | Error::NotOnLine { .. }) => Ok(None),
            Err(error) => Err(error),
        }
    }
}

impl Session {
    /// Returns the stations at the other end of the first cable of a drive; empty when the device does not report them.
    ///
    /// # Errors
    /// When the drive cannot be reached.
    pub async fn peers(&mut self, drive: &Drive) -> Result<Vec<Peer>, Error> {
        let at = RecordAddress {
            api: 0,
            slot: 0,
            subslot: FIRST_PORT,
            index: index::PORT_REAL,
        };
        match self.read_record(drive, at).await {
            Ok(data) => {
                Ok(PortReal::decode(Reader::new(&data)).map_or_else(|_| Vec::new(), |port| peers(&port)))
            }
            Err(Error::Record { .. } | Error::NotOnLine { .. }) => Ok(Vec::new()),
            Err(error) => Err(error),
        }
    }
}

fn peers(port: &PortReal<'_>) -> Vec<Peer> {
    let peer = |peer: &PortPeer<'_>| Peer {
        own_port: text(port.name),
        port: text(peer.port),
        station: text(peer.station),
        mac: peer.mac,
    };
    port.peers.iter().map(peer).collect()
}

impl Info {
    /// Returns false for a device that reports its modules and has none of the drive profile.
    #[must_use]
    pub fn is_drive(&self, drive: &Drive) -> bool {
        let mut modules = self.modules.iter();
        self.modules.is_empty() || modules.any(|module| module.api == drive.model.channel.api)
    }

    /// Returns the first value of a parameter.
    #[must_use]
    pub fn raw(&self, pnu: u16) -> Option<i64> {
        self.readings.iter().find(|reading| reading.pnu == pnu)?.raw()
    }

    /// Notes a record that was not read.
    fn miss(&mut self, what: &str, error: &ServiceError) {
        let missing = format!("{what}: {error}");
        if matches!(error, ServiceError::Timeout { .. }) {
            self.unanswered.push(missing.clone());
        }
        self.refused.push(missing);
    }
}

/// Returns the one relation that is not a parameter tool, our `own` connections for records left out; `None` when the
/// record has another form.
pub(super) fn controller_of(data: &[u8], own: &[Uuid]) -> Option<Option<String>> {
    const DEVICE_ACCESS: u16 = 6;
    let ars = decode_ar_list(&mut Reader::new(data)).ok()??;
    let owner = ars
        .iter()
        .find(|ar| ar.ar_type != DEVICE_ACCESS && !own.contains(&ar.ar_uuid));
    Some(owner.map(|ar| text(ar.station_name)))
}

fn take_im(identity: &mut Option<Identity>, number: u8, data: &[u8]) -> Result<(), DecodeError> {
    let reader = Reader::new(data);
    if number == 0 {
        let im0 = Im0::decode(reader)?;
        let [major, minor, fix] = im0.software_revision;
        let identity = identity.get_or_insert_default();
        identity.vendor_id = im0.vendor_id;
        identity.order_id = text(&im0.order_id);
        identity.serial_number = text(&im0.serial_number);
        identity.hardware_revision = im0.hardware_revision;
        identity.software_revision = format!("{}{major}.{minor}.{fix}", text(&[im0.software_prefix]));
        identity.profile_id = im0.profile_id;
        identity.profile_type = im0.profile_specific_type;
        return Ok(());
    }
    let record = ImText::decode(reader, number)?;
    let identity = identity.get_or_insert_default();
    match number {
        1 => {
            identity.function = text(record.tag_function());
            identity.location = text(record.tag_location());
        }
        2 => identity.installed = text(record.body),
        _ => identity.descriptor = text(record.body),
    }
    Ok(())
}

fn text(octets: &[u8]) -> String {
    String::from_utf8_lossy(octets)
        .trim_matches(['\0', ' '])
        .to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn im0_and_im1() {
        let mut identity = None;
        let mut im0 = vec![0, 0x20, 0, 0x38, 1, 0, 1, 5];
        im0.extend(format!("{:<20}{:<16}", "AKD-P00306", "42").bytes());
        im0.extend([0, 3, b'V', 1, 17, 0, 0, 0, 0x3A, 0, 0, 1, 1, 1, 0, 0x1E]);
        take_im(&mut identity, 0, &im0).unwrap();
        let mut im1 = vec![0, 0x21, 0, 0x38, 1, 0];
        im1.extend(format!("{:<32}{:<22}", "feed axis", "hall 3").bytes());
        take_im(&mut identity, 1, &im1).unwrap();
        let identity = identity.unwrap();
        assert_eq!(
            (identity.order_id.as_str(), identity.serial_number.as_str()),
            ("AKD-P00306", "42")
        );
        assert_eq!(
            (identity.software_revision.as_str(), identity.profile_id),
            ("V1.17.0", 0x3A00)
        );
        assert_eq!(
            (identity.function.as_str(), identity.location.as_str()),
            ("feed axis", "hall 3")
        );
        for length in 0..im0.len() {
            assert!(take_im(&mut None, 0, &im0[..length]).is_err(), "{length}");
        }
    }
}

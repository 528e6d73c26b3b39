//! Which drives of a network a person means: one, a list, all that fit a pattern, all of a model or a vendor.

use std::fmt;
use std::str::FromStr;

use client::{DriveAddress, DriveAddressError};
use profile::catalogue::vendor_name;
use profile::model::Model;
use profile::notation::wildcard_fits;
use profinet::controller::Station;
use profinet::wire::dcp::role;

use crate::machine::{Machine, MachineDrive, UnknownGroup};

/// Which drives are meant, as a person writes it: terms separated by commas.
///
/// | term | means |
/// |---|---|
/// | `akd-1`, `10.0.0.2`, `02:50:4e:00:00:01` | the drive with this station name, IP address or MAC address |
/// | `akd-*`, `line?-feed` | the stations whose names fit; `*` is any part, `?` any character |
/// | `model=vlt` | the stations of this model |
/// | `vendor=danfoss` | the stations of this vendor: the beginning of its name, or its VendorID |
/// | `all` | all stations that are no controllers; with a machine file its drives too, whether they answer or not |
/// | `@line1` | the drives of a group of the machine file: see [`Selector::of`] |
/// | `fc:PORT/ADDRESS`, `uss:PORT/ADDRESS` | a drive at a serial line, never with another term |
///
/// ```
/// use profidrive::Selector;
/// let one: Selector = "akd-1".parse()?;
/// assert!(one.single().is_some());
/// let many: Selector = "akd-*,model=vlt,10.0.0.7".parse()?;
/// assert!(many.single().is_none());
/// # Ok::<(), profidrive::SelectorError>(())
/// ```
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Selector {
    terms: Vec<Term>,
}

/// One of the terms.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum Term {
    Address(DriveAddress),
    Group(Group),
}

/// A term that may mean any number of stations.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum Group {
    All,
    Name(String),
    /// By its key.
    Model(&'static str),
    Vendor(Vendor),
}

#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum Vendor {
    Id(u16),
    Name(String),
}

/// Why a text selects no drives.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum SelectorError {
    /// A term is not the address of a drive.
    #[error(transparent)]
    Address(#[from] DriveAddressError),
    /// Nothing stands between two commas, or there is nothing at all.
    #[error("`{text}` has an empty part")]
    Empty {
        /// The whole text.
        text: String,
    },
    /// Too many terms, or a pattern that is too long or has too many stars.
    #[error("`{term}` is too long: {limit}")]
    TooLong {
        /// The term, or the beginning of the text.
        term: String,
        /// What is allowed.
        limit: &'static str,
    },
    /// There is no model of this name.
    #[error("`{term}`: no model of this name; there are {models}")]
    UnknownModel {
        /// The term.
        term: String,
        /// The names that there are.
        models: String,
    },
    /// No such kind of selection.
    #[error("`{term}`: drives are selected by model= or vendor=, not by `{key}=`")]
    UnknownKey {
        /// The term.
        term: String,
        /// What stands before the equals sign.
        key: String,
    },
    /// A group without a machine file.
    #[error("`{term}` is a group of a machine file, and there is none")]
    NoMachine {
        /// The term.
        term: String,
    },
    /// A group that the machine file does not have.
    #[error(transparent)]
    UnknownGroup(#[from] UnknownGroup),
    /// A drive at a serial line beside others.
    #[error("`{line}` is at a serial line: it is selected alone")]
    Line {
        /// The drive.
        line: String,
    },
}

/// Terms of a selector at most.
const MAX_TERMS: usize = 1000;
/// Characters of a pattern at most.
const MAX_PATTERN: usize = 240;
/// Stars of a pattern at most: each costs time.
const MAX_STARS: usize = 8;

impl Selector {
    /// Returns the address of the one drive that is meant; `None` where there may be none, or more than one.
    #[must_use]
    pub fn single(&self) -> Option<&DriveAddress> {
        match self.terms.as_slice() {
            [Term::Address(address)] => Some(address),
            _ => None,
        }
    }

    /// Returns all stations that are no controllers.
    #[must_use]
    pub fn all() -> Self {
        Self {
            terms: vec![Term::Group(Group::All)],
        }
    }

    /// Returns true for a drive of a machine file that this means: by its name, its address, its model or its vendor.
    #[must_use]
    pub fn means(&self, drive: &MachineDrive) -> bool {
        let tables = drive.model.catalogue;
        let station = Station {
            name: drive.name.clone(),
            vendor_id: tables.map_or(0, |tables| tables.device.vendor_id),
            device_id: tables.map_or(0, |tables| tables.device.device_id),
            role: role::DEVICE,
            ..Station::default()
        };
        self.terms.iter().any(|term| match term {
            Term::Group(group) => group.means(&station),
            Term::Address(DriveAddress::Name(name)) => *name == drive.name,
            Term::Address(DriveAddress::Ip(ip)) => drive.ip.is_some_and(|own| own.address == *ip),
            Term::Address(DriveAddress::Mac(mac)) => drive.mac == Some(*mac),
            Term::Address(DriveAddress::Line(_)) => false,
        })
    }

    /// Returns true for a station that answered and is meant.
    pub(crate) fn means_station(&self, station: &Station) -> bool {
        self.terms.iter().any(|term| term.means(station))
    }

    /// Returns the terms that mean none of these stations.
    pub(crate) fn without(&self, stations: &[Station]) -> Vec<String> {
        let means = |term: &&Term| stations.iter().any(|station| term.means(station));
        let without = self.terms.iter().filter(|term| !means(term));
        without.map(ToString::to_string).collect()
    }

    /// Returns true where all drives are given by their IP addresses: UDP alone is enough for their records.
    pub(crate) fn is_by_ip(&self) -> bool {
        let by_ip = |term: &Term| matches!(term, Term::Address(DriveAddress::Ip(_)));
        self.terms.iter().all(by_ip)
    }

    pub(crate) fn terms(&self) -> &[Term] {
        &self.terms
    }
}

impl From<DriveAddress> for Selector {
    fn from(address: DriveAddress) -> Self {
        Self {
            terms: vec![Term::Address(address)],
        }
    }
}

impl Term {
    /// Returns the group that it is.
    pub(crate) const fn group(&self) -> Option<&Group> {
        match self {
            Self::Group(group) => Some(group),
            Self::Address(_) => None,
        }
    }

    /// Returns true for a station that answered and is meant.
    pub(crate) fn means(&self, station: &Station) -> bool {
        match self {
            Self::Group(group) => group.means(station),
            Self::Address(DriveAddress::Name(name)) => station.name == *name,
            Self::Address(DriveAddress::Ip(ip)) => station.ip.address == *ip,
            Self::Address(DriveAddress::Mac(mac)) => station.mac == *mac,
            Self::Address(DriveAddress::Line(_)) => false,
        }
    }
}

impl Group {
    /// Returns true for the stations that this means.
    pub(crate) fn means(&self, station: &Station) -> bool {
        let model = || Model::of(station.vendor_id, station.device_id);
        match self {
            // a device that is a controller too is still a device
            Self::All => {
                station.role & role::DEVICE != 0 || station.role & (role::CONTROLLER | role::SUPERVISOR) == 0
            }
            Self::Name(pattern) => wildcard_fits(pattern, &station.name),
            Self::Model(key) => model().catalogue.is_some() && model().key == *key,
            Self::Vendor(Vendor::Id(id)) => station.vendor_id == *id,
            Self::Vendor(Vendor::Name(name)) => vendor_name(station.vendor_id).is_some_and(|vendor| {
                vendor
                    .get(..name.len())
                    .is_some_and(|start| start.eq_ignore_ascii_case(name))
            }),
        }
    }
}

impl FromStr for Selector {
    type Err = SelectorError;

    fn from_str(text: &str) -> Result<Self, SelectorError> {
        Self::of(text, None)
    }
}

impl Selector {
    /// Reads a selector whose groups (`@line1`) are those of a machine file. A group stands for the names of its drives. With a
    /// machine file `all` also means each of its drives by name, so that one that does not answer is not overlooked.
    ///
    /// ```
    /// use profidrive::Selector;
    /// use profidrive::machine::Machine;
    /// let machine: Machine = "[[drive]]\nname = \"feed\"\nmodel = \"akd\"\ngroups = [\"line1\"]".parse()?;
    /// assert_eq!(Selector::of("@line1,vlt-*", Some(&machine))?.to_string(), "feed,vlt-*");
    /// assert_eq!(Selector::of("all", Some(&machine))?.to_string(), "feed,all");
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// When a term is not valid, or names a group that does not exist.
    pub fn of(text: &str, machine: Option<&Machine>) -> Result<Self, SelectorError> {
        // a line has its settings behind commas
        if let Ok(line @ DriveAddress::Line(_)) = text.parse::<DriveAddress>() {
            return Ok(line.into());
        }
        let shown = |text: &str| text.chars().take(40).collect();
        if text.split(',').count() > MAX_TERMS {
            return Err(SelectorError::TooLong {
                term: shown(text),
                limit: "at most 1000 parts",
            });
        }
        let mut terms = Vec::new();
        for part in text.split(',').map(str::trim) {
            if part.is_empty() && text.contains(',') {
                return Err(SelectorError::Empty { text: shown(text) });
            }
            let mut by_name = |name: &str| {
                let term = Term::Address(DriveAddress::Name(name.to_owned()));
                if !terms.contains(&term) {
                    terms.push(term);
                }
            };
            if let Some(group) = part.strip_prefix('@') {
                let term = || part.chars().take(40).collect();
                let machine = machine.ok_or_else(|| SelectorError::NoMachine { term: term() })?;
                machine.group(group)?.into_iter().for_each(by_name);
                continue;
            }
            let term = Term::parse(part)?;
            if let (Term::Group(Group::All), Some(machine)) = (&term, machine) {
                machine.drives.iter().for_each(|drive| by_name(&drive.name));
            }
            if let Term::Address(DriveAddress::Line(line)) = &term {
                return Err(SelectorError::Line {
                    line: line.to_string(),
                });
            }
            if !terms.contains(&term) {
                terms.push(term);
            }
        }
        Ok(Self { terms })
    }
}

impl Term {
    fn parse(text: &str) -> Result<Self, SelectorError> {
        if text.eq_ignore_ascii_case("all") {
            return Ok(Self::Group(Group::All));
        }
        if let Some((key, value)) = text.split_once('=')
            // that of a line has its own settings
            && !text.contains(':')
        {
            return Group::of(text, key, value.trim()).map(Self::Group);
        }
        if !text.contains(['*', '?']) {
            return Ok(Self::Address(text.parse()?));
        }
        if text.len() > MAX_PATTERN || text.matches('*').count() > MAX_STARS {
            return Err(SelectorError::TooLong {
                term: text.chars().take(40).collect(),
                limit: "a pattern has at most 240 characters and 8 stars",
            });
        }
        // the rest must be able to be a name
        let name = text.replace(['*', '?'], "x").parse::<DriveAddress>();
        name.map_err(|error| DriveAddressError {
            text: text.to_owned(),
            ..error
        })?;
        Ok(Self::Group(Group::Name(text.to_ascii_lowercase())))
    }
}

impl Group {
    fn of(term: &str, key: &str, value: &str) -> Result<Self, SelectorError> {
        match key.trim().to_ascii_lowercase().as_str() {
            "model" => {
                let known = Model::by_name(value).filter(|model| model.catalogue.is_some());
                known.map(|model| Self::Model(model.key)).ok_or_else(|| {
                    let keys = profile::model::ALL.map(|model| model.key);
                    SelectorError::UnknownModel {
                        term: term.to_owned(),
                        models: keys.join(", "),
                    }
                })
            }
            "vendor" if value.is_empty() => Err(SelectorError::Empty {
                text: term.to_owned(),
            }),
            "vendor" => {
                let digits = value.strip_prefix("0x").or_else(|| value.strip_prefix("0X"));
                let id = match digits {
                    Some(digits) => u16::from_str_radix(digits, 16).ok(),
                    None => value.parse().ok(),
                };
                Ok(Self::Vendor(
                    id.map_or_else(|| Vendor::Name(value.to_owned()), Vendor::Id),
                ))
            }
            _ => Err(SelectorError::UnknownKey {
                term: term.to_owned(),
                key: key.trim().to_owned(),
            }),
        }
    }
}

impl fmt::Display for Selector {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (number, term) in self.terms.iter().enumerate() {
            if number > 0 {
                f.write_str(",")?;
            }
            term.fmt(f)?;
        }
        Ok(())
    }
}

impl fmt::Display for Term {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Address(address) => address.fmt(f),
            Self::Group(group) => group.fmt(f),
        }
    }
}

impl fmt::Display for Group {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::All => f.write_str("all"),
            Self::Name(pattern) => f.write_str(pattern),
            Self::Model(key) => write!(f, "model={key}"),
            Self::Vendor(Vendor::Id(id)) => write!(f, "vendor=0x{id:04X}"),
            Self::Vendor(Vendor::Name(name)) => write!(f, "vendor={name}"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn station(name: &str, vendor_id: u16, device_id: u16, role: u8) -> Station {
        Station {
            name: name.to_owned(),
            vendor_id,
            device_id,
            role,
            ..Station::default()
        }
    }

    fn group(text: &str) -> Group {
        let selector: Selector = text.parse().unwrap();
        match selector.terms.as_slice() {
            [Term::Group(group)] => group.clone(),
            other => panic!("{text}: {other:?}"),
        }
    }

    #[test]
    fn terms_mean_what_the_table_says() {
        let akd = station("akd-1", 0x0105, 0x0001, role::DEVICE);
        let vlt = station("vlt-1", 0x0080, 0x0001, role::DEVICE);
        let plc = station("plc", 0x002A, 0x0001, role::CONTROLLER);
        let nameless = station("", 0x0105, 0x0001, role::DEVICE);
        for (text, means) in [
            ("all", [true, true, false, true]),
            ("akd-*", [true, false, false, false]),
            ("AKD-?", [true, false, false, false]),
            ("*", [true, true, true, true]),
            ("model=VLT", [false, true, false, false]),
            ("vendor=danfoss", [false, true, false, false]),
            ("vendor=koll", [true, false, false, true]),
            ("vendor=0x002A", [false, false, true, false]),
            ("vendor=128", [false, true, false, false]),
            ("vendor=unknown", [false, false, false, false]),
        ] {
            let found = [&akd, &vlt, &plc, &nameless].map(|station| group(text).means(station));
            assert_eq!(found, means, "{text}");
        }
    }

    #[test]
    fn lists_are_read_and_written() {
        let text = "akd-1,all,akd-*,model=vlt,vendor=0x0105,10.0.0.7";
        let selector: Selector = text.parse().unwrap();
        assert_eq!(selector.to_string(), text);
        assert_eq!(" AKD-1 , akd-1".parse::<Selector>().unwrap().to_string(), "akd-1");
        let line: Selector = "fc:/dev/ttyUSB0/1,baud=19200".parse().unwrap();
        assert!(matches!(line.single(), Some(DriveAddress::Line(_))));
    }

    #[test]
    fn what_selects_nothing_is_said() {
        for (text, message) in [
            (
                "",
                "`` names no drive: write a station name (akd-1), an IP address (10.0.0.2) or a MAC address",
            ),
            ("akd-1,", "`akd-1,` has an empty part"),
            ("akd_*", "`akd_*` names no drive: a station name has"),
            (
                "model=akdd",
                "`model=akdd`: no model of this name; there are akd, vlt, vacon",
            ),
            ("model=standard", "`model=standard`: no model"),
            ("vendor=", "`vendor=` has an empty part"),
            (
                "group=a",
                "`group=a`: drives are selected by model= or vendor=, not by `group=`",
            ),
            (
                "akd-1,fc:ttyS0/1",
                "`fc:/dev/ttyS0/1` is at a serial line: it is selected alone",
            ),
            (
                "a*b*c*d*e*f*g*h*i*j",
                "`a*b*c*d*e*f*g*h*i*j` is too long: a pattern has",
            ),
            ("akd_1", "`akd_1` names no drive: a station name has"),
        ] {
            let error = text.parse::<Selector>().unwrap_err().to_string();
            assert!(error.starts_with(message), "{text}: {error}");
        }
        let long = vec!["akd-1"; 1001].join(",");
        assert!(matches!(
            long.parse::<Selector>(),
            Err(SelectorError::TooLong { .. })
        ));
    }
}

//! A new name, a new IP address, factory values: with every check that has to come before.
//!
//! A name or an address that is taken already makes two stations unreachable, and either change ends the connection of a
//! controller, and with it the motion of its axis.
//!
//! ```
//! # #[cfg(feature = "simulate")] {
//! use profidrive::Wait;
//! use profidrive::addressing::{AddressingError, NewName, set_name};
//!
//! let plant = r#"
//!     [[drive]]
//!     name = "akd-1"
//!     [[drive]]
//!     name = "akd-2"
//! "#;
//! let mut network = profidrive::open_plan(plant.parse()?)?;
//! let drive = network.find(&"akd-1".parse()?).wait()?;
//!
//! let taken = set_name(&mut network, &drive, &NewName::new("akd-2")).wait();
//! assert!(matches!(taken, Err(AddressingError::NameTaken { .. })));
//!
//! let report = set_name(&mut network, &drive, &NewName::new("press-1")).wait()?;
//! assert_eq!((report.old.as_deref(), report.name.as_deref()), (Some("akd-1"), Some("press-1")));
//! # }
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use std::net::Ipv4Addr;
use std::time::Duration;

use client::{Drive, DriveAddress, Error, ErrorKind, Session, describe};
use network::system::{Error as SystemError, InterfaceInfo};
use profinet::IpSuite;
use profinet::controller::Misuse;
use profinet::wire::dcp::{check_ip, check_name, legal_name};

use crate::report::{BlinkReport, IpReport, NameReport, ResetReport};

/// Why a station was not named, addressed or reset.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum AddressingError {
    /// The name breaks a rule for names of stations.
    #[error("`{name}` is not a valid station name: {rule}")]
    BadName {
        /// The name.
        name: String,
        /// The rule.
        rule: String,
        /// A valid name that resembles it, where there is one.
        legal: Option<String>,
    },
    /// Another station has the name.
    #[error("the name {name} is taken already: {other}")]
    NameTaken {
        /// The name.
        name: String,
        /// The other station.
        other: String,
    },
    /// Another station has the address.
    #[error("the address {address} is taken already: {other}")]
    AddressTaken {
        /// The address.
        address: Ipv4Addr,
        /// The other station.
        other: String,
    },
    /// This computer has the address: both would be unreachable.
    #[error("the address {address} is this machine's own, on {interface}")]
    OwnAddress {
        /// The address.
        address: Ipv4Addr,
        /// The interface that has it.
        interface: String,
    },
    /// The interfaces of this computer cannot be listed.
    #[error(transparent)]
    Interfaces(#[from] SystemError),
    /// The drive is at work, or did not do it.
    #[error(transparent)]
    Client(#[from] Error),
}

impl AddressingError {
    /// The kind of the error.
    #[must_use]
    pub fn kind(&self) -> ErrorKind {
        match self {
            Self::BadName { .. } => ErrorKind::Usage,
            Self::NameTaken { .. } | Self::AddressTaken { .. } | Self::OwnAddress { .. } => {
                ErrorKind::Refused
            }
            Self::Interfaces(_) => ErrorKind::Unreachable,
            Self::Client(error) => error.kind(),
        }
    }
}

/// A name that a station is to get.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct NewName {
    /// The name; empty to take it away.
    pub name: String,
    /// It is kept over power-off. A temporary name deletes the permanent one.
    pub permanent: bool,
    /// Whether a controller is connected is not checked: it loses the drive then.
    pub force: bool,
    /// Everything is checked, nothing is changed.
    pub dry_run: bool,
}

impl NewName {
    /// A permanent name, given with all checks.
    #[must_use]
    pub fn new(name: &str) -> Self {
        Self {
            name: name.to_owned(),
            permanent: true,
            force: false,
            dry_run: false,
        }
    }
}

/// An IP address that a station is to get.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct NewAddress {
    /// Address, mask and gateway; the gateway 0.0.0.0 for none.
    pub ip: IpSuite,
    /// It is kept over power-off. A temporary address deletes the permanent one.
    pub permanent: bool,
    /// Whether a controller is connected is not checked: it loses the drive then.
    pub force: bool,
    /// Everything is checked, nothing is changed.
    pub dry_run: bool,
}

impl NewAddress {
    /// A permanent address, given with all checks.
    #[must_use]
    pub const fn new(ip: IpSuite) -> Self {
        Self {
            ip,
            permanent: true,
            force: false,
            dry_run: false,
        }
    }
}

/// What a reset takes back to factory values (DCP ResetToFactory).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FactoryReset {
    /// Application data: parameters, I&M records.
    Application,
    /// Communication data: name, IP address.
    Communication,
    /// Engineering data.
    Engineering,
    /// All stored data.
    All,
    /// The whole device.
    Device,
}

impl FactoryReset {
    /// Every reset with its number (ResetToFactoryModes) and what it takes back.
    const ALL: [(Self, u8, &'static str); 5] = [
        (Self::Application, 1, "application data (parameters, I&M records)"),
        (Self::Communication, 2, "communication data (name, IP address)"),
        (Self::Engineering, 3, "engineering data"),
        (Self::All, 4, "all stored data"),
        (Self::Device, 8, "the whole device"),
    ];

    const fn row(self) -> (Self, u8, &'static str) {
        match self {
            Self::Application => Self::ALL[0],
            Self::Communication => Self::ALL[1],
            Self::Engineering => Self::ALL[2],
            Self::All => Self::ALL[3],
            Self::Device => Self::ALL[4],
        }
    }

    /// Number of the reset (ResetToFactoryModes).
    #[must_use]
    pub const fn number(self) -> u8 {
        self.row().1
    }

    /// What is taken back, in words.
    #[must_use]
    pub const fn what(self) -> &'static str {
        self.row().2
    }
}

/// Checks a name by the rules for names of stations; an empty one stands for none.
///
/// # Errors
/// [`AddressingError::BadName`]
pub fn check_station_name(name: &str) -> Result<(), AddressingError> {
    let Err(rule) = check_name(name.as_bytes()) else {
        return Ok(());
    };
    if name.is_empty() {
        return Ok(());
    }
    Err(AddressingError::BadName {
        name: name.to_owned(),
        rule: rule.to_string(),
        legal: Some(legal_name(name)).filter(|legal| !legal.is_empty()),
    })
}

/// Gives a station its name, when no other station has it and no controller is connected.
///
/// # Errors
/// What speaks against it, and what the station answers.
pub async fn set_name(
    session: &mut Session,
    drive: &Drive,
    wanted: &NewName,
) -> Result<NameReport, AddressingError> {
    check_station_name(&wanted.name)?;
    if !wanted.name.is_empty()
        && let Some(other) = other(session, drive, DriveAddress::Name(wanted.name.clone())).await?
    {
        let name = wanted.name.clone();
        return Err(AddressingError::NameTaken { name, other });
    }
    check(session, drive, wanted.force, async |session| {
        session.check_unowned(drive, "named").await
    })
    .await?;
    if !wanted.dry_run {
        session.set_name(drive, &wanted.name, wanted.permanent).await?;
    }
    Ok(NameReport::new(&drive.station, wanted))
}

/// Gives a station its IP address, when neither another station nor this computer has it and no controller is connected.
///
/// # Errors
/// What speaks against it, and what the station answers.
pub async fn set_ip(
    session: &mut Session,
    drive: &Drive,
    wanted: &NewAddress,
) -> Result<IpReport, AddressingError> {
    let address = wanted.ip.address;
    check_ip(&wanted.ip).map_err(|rule| Error::from(Misuse::from(rule)))?;
    let interfaces = interfaces(session)?;
    if let Some(own) = interfaces.into_iter().find(|info| info.owns(address)) {
        let interface = own.name;
        return Err(AddressingError::OwnAddress { address, interface });
    }
    if let Some(other) = other(session, drive, DriveAddress::Ip(address)).await? {
        return Err(AddressingError::AddressTaken { address, other });
    }
    check(session, drive, wanted.force, async |session| {
        session.check_idle(&mut drive.clone(), "addressed").await
    })
    .await?;
    if !wanted.dry_run {
        session.set_ip(drive, wanted.ip, wanted.permanent).await?;
    }
    Ok(IpReport::new(
        &drive.station,
        wanted.ip,
        wanted.permanent,
        wanted.dry_run,
    ))
}

/// How long a station blinks for one signal.
const BLINK: Duration = Duration::from_secs(3);

/// Lets a station blink for at least `time`, by one signal after the other. `confirmed` is called once, when the station has
/// answered the first one. A caller who requests a stop ends it early; that is no error.
///
/// # Errors
/// When the station does not answer.
pub async fn blink(
    session: &mut Session,
    drive: &Drive,
    time: Duration,
    confirmed: impl FnOnce(),
) -> Result<BlinkReport, AddressingError> {
    let report = BlinkReport {
        mac: drive.station.mac.to_string(),
    };
    let end = session.now() + time;
    session.blink(drive).await?;
    confirmed();
    loop {
        let next = (session.now() + BLINK).min(end);
        match session.pass(next - session.now()).await {
            Err(Error::Interrupted) => return Ok(report),
            passed => passed?,
        }
        if session.now() >= end {
            return Ok(report);
        }
        session.blink(drive).await?;
    }
}

/// Checks whether a station may be reset, which makes sense before a person is asked: its axis is at rest, its power stage
/// off, and no controller is connected.
///
/// # Errors
/// [`Error::AtWork`], and when the drive cannot be reached.
pub async fn check_reset(session: &mut Session, drive: &mut Drive) -> Result<(), AddressingError> {
    if in_reach(session, drive)? {
        session.check_idle(drive, "reset").await?;
    }
    Ok(())
}

/// Takes a station back to factory values. With `force` whatever it is doing: a motor that turns coasts.
///
/// # Errors
/// As [`check_reset`], and what the station answers.
pub async fn reset(
    session: &mut Session,
    drive: &mut Drive,
    what: FactoryReset,
    force: bool,
) -> Result<ResetReport, AddressingError> {
    if !force && in_reach(session, drive)? {
        session.reset(drive, what.number()).await?;
    } else {
        session.reset_at_work(drive, what.number()).await?;
    }
    Ok(ResetReport {
        mac: drive.station.mac.to_string(),
        mode: what.number(),
        what: what.what(),
    })
}

/// Another name or address ends the connection of a controller, and with it the motion; and an axis that turns is stopped at the
/// address that it has.
async fn check(
    session: &mut Session,
    drive: &Drive,
    force: bool,
    at_work: impl AsyncFnOnce(&mut Session) -> Result<(), Error>,
) -> Result<(), AddressingError> {
    if force || !in_reach(session, drive)? {
        return Ok(());
    }
    at_work(session).await?;
    // the connection of the request is not to be cut by what follows
    Ok(session.close_to(drive).await?)
}

/// Returns the station that has this name or address, if it is not the drive itself.
async fn other(
    session: &mut Session,
    drive: &Drive,
    address: DriveAddress,
) -> Result<Option<String>, AddressingError> {
    match session.find(&address).await {
        Ok(other) if other.station.mac == drive.station.mac => Ok(None),
        Ok(other) => Ok(Some(describe(&other.station))),
        Err(Error::NotFound { .. }) => Ok(None),
        Err(error) => Err(error.into()),
    }
}

/// Returns whether records can be read from a drive: not where no answer can come.
fn in_reach(session: &Session, drive: &Drive) -> Result<bool, AddressingError> {
    let ip = drive.station.ip;
    let reached = || -> Result<bool, AddressingError> {
        let interfaces = interfaces(session)?;
        Ok(interfaces
            .iter()
            .any(|info| info.ip_towards(ip.address).is_some()))
    };
    Ok(ip.is_set() && (session.engine().is_simulated() || reached()?))
}

/// Returns the interfaces of this computer, which a plant in memory has nothing to do with.
fn interfaces(session: &Session) -> Result<Vec<InterfaceInfo>, AddressingError> {
    if session.engine().is_simulated() {
        return Ok(Vec::new());
    }
    Ok(InterfaceInfo::list()?)
}

//! From the address of a drive to the drive: finds it, sets its model, and reads the parameters of a drive without a catalogue.

use client::{Drive, DriveAddress, DriveAddressError, Error, ErrorKind, Session};
use network::system::InterfaceInfo;
use profinet::IpSuite;
use serde::{Serialize, Serializer};

use crate::open::{Access, Caller, Network, OpenError, Opening, Place, Transport, open_line};
use crate::reach::{OtherSubnet, Reach, far, reach};

/// A step of opening and finding a drive.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(tag = "event", content = "is", rename_all = "snake_case")]
#[non_exhaustive]
pub enum FindEvent<'a> {
    /// The named interface cannot be opened for raw frames: UDP alone carries the records.
    UdpAlone,
    /// The drive is being looked for.
    LookingFor(#[serde(serialize_with = "as_text")] &'a DriveAddress),
    /// It answered.
    Found,
    /// A router must be between the drive and this computer: what their addresses are, in words.
    Routed(&'a str),
    /// The parameters of a drive without a built-in catalogue are being read.
    Learning {
        /// Parameters read so far.
        done: usize,
        /// All of them; 0 while that is not known.
        all: usize,
    },
}

fn as_text<S: Serializer>(address: &&DriveAddress, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_str(address)
}

/// Why a drive cannot be worked with.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum DriveError {
    /// The text is not the address of a drive.
    #[error(transparent)]
    Address(#[from] DriveAddressError),
    /// The network or the serial line cannot be opened.
    #[error(transparent)]
    Open(#[from] OpenError),
    /// The drive is not there, or cannot be read.
    #[error(transparent)]
    Client(#[from] Error),
    /// No answer from an address that is in no subnet of this computer.
    #[error("{error}")]
    Far {
        /// What failed.
        #[source]
        error: Box<Error>,
        /// The address and the subnets of this computer, in words.
        subnets: String,
    },
    /// No station fits a part of a selector.
    #[error("`{term}` fits none of the stations that answered{}", names(.answered))]
    NoneFits {
        /// The part: a pattern, a model, a vendor or `all`.
        term: String,
        /// Who answered, by name or address.
        answered: Vec<String>,
    },
    /// More stations answered than one search takes: drives that a part of a selector means may be among those that are not
    /// known.
    #[error(
        "more than {taken} stations answered, and one search takes no more: `{term}` may mean drives that were not found"
    )]
    MoreStations {
        /// The parts: patterns, models, vendors or `all`.
        term: String,
        /// Stations that were taken.
        taken: usize,
    },
    /// A station without an IP address: it has a name and can be given an address, no more.
    #[error("{drive} has no IP address")]
    NoAddress {
        /// The station.
        drive: String,
    },
    /// The drive is in another subnet and cannot answer.
    #[error(transparent)]
    Subnet(#[from] OtherSubnet),
    /// The device description does not fit the drive.
    #[cfg(feature = "gsdml")]
    #[error(transparent)]
    Description(#[from] crate::description::DescriptionError),
}

impl DriveError {
    /// What kind of error it is.
    #[must_use]
    pub fn kind(&self) -> ErrorKind {
        match self {
            Self::Address(_) => ErrorKind::Usage,
            Self::Open(error) => error.kind(),
            Self::Client(error) => error.kind(),
            Self::Far { error, .. } => error.kind(),
            Self::MoreStations { .. } => ErrorKind::Partial,
            Self::Subnet(_) | Self::NoneFits { .. } | Self::NoAddress { .. } => ErrorKind::Unreachable,
            #[cfg(feature = "gsdml")]
            Self::Description(error) => error.kind(),
        }
    }
}

/// `: akd-1, vlt-1 and 3 more`
fn names(answered: &[String]) -> String {
    const SHOWN: usize = 8;
    if answered.is_empty() {
        return ": there was none".to_owned();
    }
    let shown = answered
        .iter()
        .take(SHOWN)
        .map(String::as_str)
        .collect::<Vec<_>>();
    match answered.len() - shown.len() {
        0 => format!(": {}", shown.join(", ")),
        more => format!(": {} and {more} more", shown.join(", ")),
    }
}

/// Called with each step of opening and finding a drive.
pub type FindObserver<'o> = dyn FnMut(FindEvent<'_>) + Send + 'o;

impl Opening {
    /// Opens the network or the serial line of a drive and finds the drive. The address is a station name, an IP address, a MAC address, or that of a drive
    /// at a serial line (`fc:PORT/ADDRESS`, `uss:PORT/ADDRESS`).
    ///
    /// ```no_run
    /// use profidrive::{Access, Opening, Wait};
    ///
    /// let (mut network, mut drive) = Opening::new(Access::Cyclic).drive("akd-1", &mut |_| {}).wait()?;
    /// println!("{}", network.status(&mut drive).wait()?.drive);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// When the text is not an address, and as [`open_to`](Self::open_to) and [`find`](Self::find).
    pub async fn drive(
        &self,
        text: &str,
        observer: &mut FindObserver<'_>,
    ) -> Result<(Network, Drive), DriveError> {
        let address = text.parse()?;
        let mut network = self.open_to(&address)?;
        let drive = self.find(&mut network, &address, observer).await?;
        Ok((network, drive))
    }

    /// Opens the network of a drive: the plant that was given, its serial line, or a network interface. UDP alone is enough for
    /// the records of a drive that is given by its IP address.
    ///
    /// # Errors
    /// As [`open`](Self::open) and [`open_line`].
    pub fn open_to(&self, address: &DriveAddress) -> Result<Network, OpenError> {
        #[cfg(feature = "simulate")]
        if matches!(self.place, Place::Plant(_)) {
            return self.clone().open();
        }
        match address {
            DriveAddress::Line(at) => open_line(at, self.stop.clone()),
            DriveAddress::Ip(_) => {
                let records = !matches!(self.access, Access::Discovery | Access::Cyclic);
                self.clone().by_ip(records).open()
            }
            _ => self.clone().by_ip(false).open(),
        }
    }

    /// Finds a drive on its network, takes it as the model that it is to be, applies the device description and checks that
    /// both sides can reach each other. The parameters of a drive without a built-in catalogue are read from it.
    ///
    /// [`Access::Stop`] tolerates parameters that are not answered, [`Access::Identity`] a device that has none.
    ///
    /// # Errors
    /// When the drive does not answer, is in another subnet, is not a drive, or the description is not one of it.
    pub async fn find(
        &self,
        network: &mut Caller,
        address: &DriveAddress,
        observer: &mut FindObserver<'_>,
    ) -> Result<Drive, DriveError> {
        let transport = network.transport().clone();
        self.find_over(network, &transport, address, observer).await
    }

    pub(crate) async fn find_over(
        &self,
        session: &mut Session,
        transport: &Transport,
        address: &DriveAddress,
        observer: &mut FindObserver<'_>,
    ) -> Result<Drive, DriveError> {
        if let (DriveAddress::Line(at), Access::Discovery) = (address, self.access) {
            let (drive, what) = (at.to_string(), "station name, IP address or signal");
            return Err(Error::NotOnLine { drive, what }.into());
        }
        if matches!(transport, Transport::Udp) && matches!(self.place, Place::Interface(Some(_))) {
            observer(FindEvent::UdpAlone);
        }
        if self.access == Access::Stop {
            session.tolerate_unread();
        }
        observer(FindEvent::LookingFor(address));
        let found = session.find(address).await;
        let drive = found.map_err(|error| not_found(error, transport, address))?;
        observer(FindEvent::Found);
        self.ready(session, transport, drive, observer).await
    }

    /// Takes a drive that was found as the model that it is to be, and reads the parameters of one without a catalogue.
    pub(crate) async fn ready(
        &self,
        session: &mut Session,
        transport: &Transport,
        drive: Drive,
        observer: &mut FindObserver<'_>,
    ) -> Result<Drive, DriveError> {
        let mut drive = match self.model {
            Some(model) => drive.as_model(model),
            None => drive,
        };
        if drive.is_on_line() {
            return Ok(drive);
        }
        #[cfg(feature = "gsdml")]
        if let Some(description) = &self.description {
            crate::description::describe(description, &mut drive)?;
        }
        if self.access == Access::Discovery {
            return Ok(drive);
        }
        if let Some((name, own)) = transport.place()
            && let Reach::Routed(words) = reach(name, own, &drive.label(), drive.station.ip)?
        {
            observer(FindEvent::Routed(&words));
        }
        match self.learn(session, &mut drive, observer).await {
            // a device without parameters still has its identity
            Err(Error::NotADrive { .. } | Error::NoRoute { .. } | Error::ParametersOwned { .. })
                if self.access == Access::Identity => {}
            // a stop goes on without parameters
            _ if self.access == Access::Stop && session.unread().is_some() => {}
            other => other?,
        }
        Ok(drive)
    }

    /// Reads what the parameters of a foreign drive are.
    async fn learn(
        &self,
        session: &mut Session,
        drive: &mut Drive,
        observer: &mut FindObserver<'_>,
    ) -> Result<(), Error> {
        if drive.model.catalogue.is_some() {
            return Ok(());
        }
        if self.model.is_some() {
            // without tables only the drive has the number of its axis
            return session.find_channel(drive).await;
        }
        observer(FindEvent::Learning { done: 0, all: 0 });
        let mut progress = |done, all| observer(FindEvent::Learning { done, all });
        session.recognise(drive, &mut progress).await
    }
}

/// Without discovery the address may be the cause.
fn not_found(error: Error, transport: &Transport, address: &DriveAddress) -> DriveError {
    if let (Transport::Udp, DriveAddress::Ip(ip), ErrorKind::Unreachable) = (transport, address, error.kind())
    {
        let own = InterfaceInfo::list().unwrap_or_default();
        let own: Vec<IpSuite> = own.into_iter().flat_map(|info| info.addresses).collect();
        if let Some(subnets) = far(&own, *ip) {
            let error = Box::new(error);
            return DriveError::Far { error, subnets };
        }
    }
    error.into()
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use client::Wait;
    use network::host::{Host, StationId};
    use network::segment::{Pace, Segment, SegmentMedium};
    use profinet::MacAddress;
    use profinet::controller::ControllerConfig;
    use profinet::device::Stored;
    use virtual_drive::model;
    use virtual_drive::station::{Station, StationConfig};

    use super::*;

    const fn ip(last: u8) -> IpSuite {
        IpSuite {
            address: std::net::Ipv4Addr::new(10, 0, 0, last),
            mask: std::net::Ipv4Addr::new(255, 255, 255, 0),
            gateway: std::net::Ipv4Addr::UNSPECIFIED,
        }
    }

    /// An AKD that identifies itself as a device of an unknown vendor.
    fn foreign() -> (
        client::Network,
        std::sync::Arc<client::World<SegmentMedium>>,
        StationId,
    ) {
        let mut config = StationConfig::new(&model::AKD, MacAddress([2, 0, 0, 0, 0, 1]));
        config.network = Stored {
            name: "drive-1".into(),
            ip: ip(1),
            ..Stored::default()
        };
        config.description.identity.vendor_id = 0x7777;
        let mut segment = Segment::new(7);
        let station = segment.attach(Box::new(Host::new(Station::new(config))));
        let own = ControllerConfig::new(MacAddress([2, 0, 0, 0, 0, 99]), ip(99), "test", 1);
        let (network, world) = client::Network::on(SegmentMedium::new(segment, Pace::Virtual), own);
        (network, world, station)
    }

    fn transport() -> Transport {
        Transport::Packet(InterfaceInfo {
            name: "eth7".into(),
            index: 7,
            mac: None,
            addresses: vec![ip(99)],
            up: true,
            loopback: false,
        })
    }

    fn found(opening: &Opening, network: &mut Session) -> (Result<Drive, DriveError>, Vec<String>) {
        let mut events = Vec::new();
        let address = "drive-1".parse().unwrap();
        let mut observer = |event: FindEvent<'_>| events.push(format!("{event:?}"));
        let drive = opening
            .find_over(network, &transport(), &address, &mut observer)
            .wait();
        (drive, events)
    }

    #[test]
    fn parameters_of_a_foreign_drive_are_learned_and_reported() {
        let (mut network, _world, _) = foreign();
        let (drive, events) = found(&Opening::new(Access::Records), &mut network);
        assert!(drive.unwrap().model.learned);
        assert!(
            events[0].starts_with("LookingFor") && events[1] == "Found",
            "{events:?}"
        );
        assert_eq!(events[2], "Learning { done: 0, all: 0 }");
        assert!(events.len() > 3, "progress");
    }

    #[test]
    fn a_drive_is_taken_as_the_model_that_was_named() {
        let (mut network, _world, _) = foreign();
        let opening = Opening::new(Access::Records).as_model(*model::AKD.known);
        let (drive, events) = found(&opening, &mut network);
        let drive = drive.unwrap();
        assert!(!drive.model.learned && drive.select("DRV.ACC").is_ok());
        assert_eq!(events.len(), 2, "{events:?}");
    }

    #[test]
    fn a_drive_at_a_line_cannot_be_discovered() {
        let line = "fc:ttyS7/1".parse::<DriveAddress>().unwrap();
        let (mut network, _world, _) = foreign();
        let discovery = Opening::new(Access::Discovery);
        let at_line = discovery
            .find_over(&mut network, &Transport::Serial, &line, &mut |_| {})
            .wait();
        assert_eq!(at_line.unwrap_err().kind(), ErrorKind::Usage);
        // on a network nothing but the station is needed
        let (drive, events) = found(&discovery, &mut network);
        assert!(drive.unwrap().model.catalogue.is_none());
        assert_eq!(events.len(), 2, "{events:?}");
    }
}

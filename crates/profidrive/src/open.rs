//! From an interface or a port to a session.

use std::net::Ipv4Addr;
use std::ops::{Deref, DerefMut};
use std::time::{SystemTime, UNIX_EPOCH};

use client::{BoundedDrive, Client, ErrorKind, LineAddress, LineConfig, Session};
use network::ethernet::{self, Capture, PacketMedium};
use network::serial::{self, Line, Port};
use network::system::{Error as NetworkError, InterfaceInfo, ServerPort, Stop, StopRequests, UdpMedium};
use profile::model::Model;
use profinet::controller::ControllerConfig;
use profinet::{IpSuite, MacAddress};

use crate::carrier::{Carrier, serial_settings};
use crate::driver::Threaded;
use crate::machine::Machine;
use crate::traffic::Traffic;

/// The drives of a real network, of a serial line or of a plant in memory, with what carries the bytes to them: a thread of
/// its own, or the calls that wait for a plant in virtual time.
///
/// Dropping it, by an error or a panic too, brings every axis under control to rest and closes the connections. Its calls are
/// those of its [`Caller`].
#[derive(Debug)]
pub struct Network {
    network: client::Network,
    caller: Caller,
}

/// The calls of one caller on a [`Network`], which goes on for the others. A server gives a clone to each of its clients.
///
/// It does not keep the network open: when that is left, calls end with [`Error::Closed`](client::Error::Closed).
#[derive(Debug, Clone)]
pub struct Caller {
    session: Session,
    transport: Transport,
}

/// What carries a network.
#[derive(Debug, Clone)]
pub enum Transport {
    /// A network interface with permission for raw frames, as it was when opened: everything.
    Packet(InterfaceInfo),
    /// UDP alone: records only.
    Udp,
    /// A serial port.
    Serial,
    /// A plant in memory.
    #[cfg(feature = "simulate")]
    Plant(crate::simulate::Joined),
}

impl Transport {
    /// What this computer is called there, and its addresses.
    pub(crate) fn place(&self) -> Option<(&str, &[IpSuite])> {
        match self {
            Self::Packet(info) => Some((&info.name, &info.addresses)),
            Self::Udp | Self::Serial => None,
            #[cfg(feature = "simulate")]
            Self::Plant(plant) => Some(("this program", std::slice::from_ref(&plant.ip))),
        }
    }
}

impl Network {
    fn start(
        client: Client,
        carrier: Carrier,
        transport: Transport,
        stop: Option<Stop>,
    ) -> Result<Self, OpenError> {
        let flag = stop.clone();
        let start = |engine| Threaded::start(engine, carrier, flag).map_err(OpenError::Thread);
        let network = client::Network::driven(client, start)?;
        Ok(Self::new(network, transport, stop))
    }

    pub(crate) fn new(mut network: client::Network, transport: Transport, stop: Option<Stop>) -> Self {
        if let Some(stop) = stop {
            let urgent = stop.clone();
            network.interrupt_with(move || stop.is_stopped());
            network.hurry_with(move || urgent.is_urgent());
        }
        let session = Session::clone(&network);
        let caller = Caller { session, transport };
        Self { network, caller }
    }

    fn with_calls(self, receives_calls: bool) -> Self {
        if receives_calls {
            return self;
        }
        Self {
            network: self.network.without_calls(),
            caller: self.caller,
        }
    }
}

impl Caller {
    /// Lets requests to stop end the calls of this caller and of the clones that are made of it from now on, and make the stop of
    /// an axis a quick one.
    pub fn obey(&mut self, requests: &StopRequests) {
        let (flag, urgent) = (requests.clone(), requests.clone());
        self.interrupt_with(move || flag.is_stopped());
        self.hurry_with(move || urgent.is_urgent());
    }

    /// Returns what carries the network.
    #[must_use]
    pub const fn transport(&self) -> &Transport {
        &self.transport
    }
}

impl Deref for Network {
    type Target = Caller;

    fn deref(&self) -> &Caller {
        &self.caller
    }
}

impl DerefMut for Network {
    fn deref_mut(&mut self) -> &mut Caller {
        &mut self.caller
    }
}

impl Deref for Caller {
    type Target = Session;

    fn deref(&self) -> &Session {
        &self.session
    }
}

impl DerefMut for Caller {
    fn deref_mut(&mut self) -> &mut Session {
        &mut self.session
    }
}

/// What a session is opened for: decides which addresses and ports it takes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Access {
    /// Discovery and addressing. Needs no IP address.
    Discovery,
    /// Records too. The controller's port is used where it is free.
    Records,
    /// Records of a device that need not be a drive.
    Identity,
    /// Cyclic data too: devices call back on the controller's port when a connection becomes ready.
    #[default]
    Cyclic,
    /// Records, and cyclic data where a drive has no other means to be stopped; the port of the controller is shared with
    /// a client of this computer that holds it.
    Stop,
}

/// Why a network or a line could not be opened.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum OpenError {
    /// The network interface.
    #[error(transparent)]
    Network(#[from] NetworkError),
    /// The serial port.
    #[error(transparent)]
    Serial(#[from] serial::Error),
    /// No interface was given, and there is not exactly one that can be taken without asking.
    #[error("which network interface?")]
    NoInterface {
        /// The names there are, apart from loopback; those that are down are marked.
        existing: Vec<String>,
    },
    /// The operating system has no thread or descriptor left.
    #[error("no thread for the network: {0}")]
    Thread(std::io::Error),
    /// The plant file cannot be used.
    #[cfg(feature = "simulate")]
    #[error(transparent)]
    PlantFile(#[from] plant::PlantFileError),
    /// The plant cannot be made.
    #[cfg(feature = "simulate")]
    #[error("the plant cannot start: {0}")]
    Plant(#[from] plant::WorldError),
    /// A plant is not started in the place of another one: this program would need another address in it.
    #[cfg(feature = "simulate")]
    #[error(
        "this plant needs a network of its own: this program has the address {now}, and would need {then}"
    )]
    OtherAddress {
        /// The address that it has.
        now: Ipv4Addr,
        /// The one that it would need.
        then: Ipv4Addr,
    },
}

impl OpenError {
    /// What kind of error it is.
    #[must_use]
    pub fn kind(&self) -> ErrorKind {
        match self {
            Self::NoInterface { .. } => ErrorKind::Usage,
            #[cfg(feature = "simulate")]
            Self::PlantFile(error) => crate::simulate::kind(error),
            #[cfg(feature = "simulate")]
            Self::Plant(_) | Self::OtherAddress { .. } => ErrorKind::Usage,
            _ => ErrorKind::Unreachable,
        }
    }

    /// That there is no interface to take without asking, with those that there are.
    #[must_use]
    pub fn no_interface() -> Self {
        if !ethernet::AVAILABLE {
            return NetworkError::NoRawEthernet.into();
        }
        let all = InterfaceInfo::list().unwrap_or_default();
        let real = all.into_iter().filter(|info| !info.loopback);
        let names = real.map(|info| match info.up {
            true => info.name,
            false => format!("{} (down)", info.name),
        });
        Self::NoInterface {
            existing: names.collect(),
        }
    }
}

/// Opens a network interface for everything: discovery, records and cyclic data. Needs permission for raw sockets (CAP_NET_RAW).
///
/// # Errors
/// When there is no such interface, it is down, has no address, or the permission is missing.
pub fn open(interface: &str) -> Result<Network, OpenError> {
    Opening::new(Access::default()).on(interface).open()
}

/// Returns the interface to use where none is given: the only one that is up. `None` where there are several or none.
///
/// # Errors
/// When the interfaces cannot be listed.
pub fn interface() -> Result<Option<String>, OpenError> {
    let all = InterfaceInfo::list()?.into_iter();
    let usable = all.filter(|info| !info.loopback && info.usable().is_ok());
    let only = <[InterfaceInfo; 1]>::try_from(usable.collect::<Vec<_>>());
    Ok(only.ok().map(|[only]| only.name))
}

/// How a network is opened.
#[derive(Debug, Clone)]
pub struct Opening {
    pub(crate) access: Access,
    pub(crate) place: Place,
    by_ip: bool,
    pub(crate) stop: Option<Stop>,
    pub(crate) model: Option<Model>,
    bounds: Vec<BoundedDrive>,
    pub(crate) traffic: Option<Traffic>,
    #[cfg(feature = "simulate")]
    pub(crate) real_time: bool,
    #[cfg(feature = "gsdml")]
    pub(crate) description: Option<std::sync::Arc<gsdml::Gsdml>>,
}

/// Where a network is.
#[derive(Debug, Clone)]
pub(crate) enum Place {
    /// This network interface, or the only one that is up.
    Interface(Option<String>),
    /// A plant in memory.
    #[cfg(feature = "simulate")]
    Plant(std::sync::Arc<plant::PlantPlan>),
}

impl Opening {
    /// For this access, on the only interface that is up.
    #[must_use]
    pub const fn new(access: Access) -> Self {
        Self {
            access,
            place: Place::Interface(None),
            by_ip: false,
            stop: None,
            model: None,
            bounds: Vec::new(),
            traffic: None,
            #[cfg(feature = "simulate")]
            real_time: false,
            #[cfg(feature = "gsdml")]
            description: None,
        }
    }

    /// On this interface.
    #[must_use]
    pub fn on(mut self, interface: impl Into<String>) -> Self {
        self.place = Place::Interface(Some(interface.into()));
        self
    }

    /// Sets whether drives are given by their IP address: without permission for raw sockets, or without an interface,
    /// UDP alone is enough for everything but discovery and cyclic data.
    #[must_use]
    pub const fn by_ip(mut self, by_ip: bool) -> Self {
        self.by_ip = by_ip;
        self
    }

    /// Takes the drive as this model, whatever it identifies itself as: see [`find`](Self::find).
    #[must_use]
    pub const fn as_model(mut self, model: Model) -> Self {
        self.model = Some(model);
        self
    }

    /// Takes modules and timings from the device description of the vendor: see [`find`](Self::find).
    #[cfg(feature = "gsdml")]
    #[must_use]
    pub fn described_by(mut self, description: gsdml::Gsdml) -> Self {
        self.description = Some(std::sync::Arc::new(description));
        self
    }

    /// Calls end with [`client::Error::Interrupted`] once `stop` is raised. An axis is brought to rest anyway; once
    /// `stop` is urgent, by its quick stop (OFF3). [`Session::interrupt_with`] and [`Session::hurry_with`] replace this.
    #[must_use]
    pub fn stopped_by(mut self, stop: Stop) -> Self {
        self.stop = Some(stop);
        self
    }

    /// The drives of this machine: no motion is faster than its limits permit.
    #[must_use]
    pub fn on_machine(mut self, machine: &Machine) -> Self {
        self.bounds = machine.bounds();
        self
    }

    /// Keeps the frames of the last minute there: those of a plant, or of an interface that is opened with permission for raw
    /// frames. UDP alone shows no frames.
    #[must_use]
    pub fn kept_in(mut self, traffic: &Traffic) -> Self {
        self.traffic = Some(traffic.clone());
        self
    }

    /// Opens it, a plant where one was given. That UDP alone had to be enough shows in its [`Caller::transport`].
    ///
    /// # Errors
    /// When there is no such interface, it is down, has no address, or the permission is missing.
    pub fn open(mut self) -> Result<Network, OpenError> {
        let bounds = std::mem::take(&mut self.bounds);
        let mut network = self.open_place()?;
        network.bound_speeds(bounds);
        Ok(network)
    }

    fn open_place(self) -> Result<Network, OpenError> {
        let name = match &self.place {
            #[cfg(feature = "simulate")]
            Place::Plant(plant) => return crate::simulate::join(plant, &self),
            Place::Interface(Some(name)) => Some(name.clone()),
            Place::Interface(None) => interface()?,
        };
        let Some(name) = name else {
            return if self.by_ip {
                self.udp()
            } else {
                Err(OpenError::no_interface())
            };
        };
        match PacketMedium::open(&name, server_port(self.access)) {
            Err(NetworkError::NoPermission { .. } | NetworkError::NoRawEthernet) if self.by_ip => self.udp(),
            medium => self.packet(medium?),
        }
    }

    fn packet(self, mut medium: PacketMedium) -> Result<Network, OpenError> {
        let info = medium.interface().clone();
        if self.access != Access::Discovery && !info.ip().is_set() {
            return Err(NetworkError::NoAddress { interface: info.name }.into());
        }
        if let Some(stop) = &self.stop {
            medium.set_stop(stop.clone());
        }
        if let Some(traffic) = &self.traffic {
            let stop = Stop::new().map_err(OpenError::Thread)?;
            let capture = Capture::open(&info.name, stop)?;
            traffic.receive(capture).map_err(OpenError::Thread)?;
        }
        let client = Client::new(config(info.usable()?, info.ip()));
        let receives_calls = medium.receives_calls();
        let carrier = Carrier::Packet(Box::new(medium));
        let network = Network::start(client, carrier, Transport::Packet(info), self.stop)?;
        Ok(network.with_calls(receives_calls))
    }

    fn udp(self) -> Result<Network, OpenError> {
        let mut medium = UdpMedium::open(Ipv4Addr::UNSPECIFIED, server_port(self.access))?;
        if let Some(stop) = &self.stop {
            medium.set_stop(stop.clone());
        }
        let up = |info: InterfaceInfo| if info.up && !info.loopback { info.mac } else { None };
        let all = InterfaceInfo::list().unwrap_or_default();
        let mac = all.into_iter().find_map(up);
        let config = config(mac.unwrap_or(MacAddress([2, 0, 0, 0, 0, 1])), IpSuite::NONE);
        let receives_calls = medium.receives_calls();
        let carrier = Carrier::Udp(Box::new(medium));
        let network = Network::start(Client::new(config), carrier, Transport::Udp, self.stop)?;
        let network = Network {
            network: network.network.without_discovery(),
            caller: network.caller,
        };
        Ok(network.with_calls(receives_calls))
    }
}

/// Opens the serial line of a drive.
///
/// # Errors
/// When there is no such port, another program has it, or the permission is missing.
pub fn open_line(at: &LineAddress, stop: Option<Stop>) -> Result<Network, OpenError> {
    let mut line = Line::new(Port::open(&at.port, serial_settings(at.baud, at.parity))?);
    if let Some(stop) = &stop {
        line.set_stop(stop.clone());
    }
    let client = Client::on_line(LineConfig::new(at.protocol, at.baud));
    let carrier = Carrier::Serial(Box::new(line));
    Network::start(client, carrier, Transport::Serial, stop)
}

const fn server_port(access: Access) -> ServerPort {
    match access {
        Access::Cyclic => ServerPort::Required,
        Access::Records | Access::Identity => ServerPort::IfFree,
        Access::Stop => ServerPort::Shared,
        // left to a controller that starts meanwhile
        Access::Discovery => ServerPort::None,
    }
}

fn config(mac: MacAddress, ip: IpSuite) -> ControllerConfig {
    let seed = seed();
    let mut config = ControllerConfig::new(mac, ip, "profidrive", seed);
    // several programs may run side by side
    config.client_port = 0xC000 | u16::try_from(seed >> 17 & 0x3FFF).unwrap_or(0);
    config
}

/// Differs from one session to the next.
fn seed() -> u64 {
    let time = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
    let nanos = u64::try_from(time.as_nanos() & u128::from(u64::MAX)).unwrap_or_default();
    (nanos ^ u64::from(std::process::id()).rotate_left(40)).wrapping_mul(0x9E37_79B9_7F4A_7C15)
}

#[cfg(test)]
mod tests {
    use client::Wait;

    use super::*;

    #[test]
    fn only_cyclic_data_needs_the_port_of_the_controller() {
        assert_eq!(server_port(Access::Discovery), ServerPort::None);
        assert_eq!(server_port(Access::Records), ServerPort::IfFree);
        // a client on this computer that runs a drive must not keep it from being stopped
        assert_eq!(server_port(Access::Stop), ServerPort::Shared);
        assert_eq!(server_port(Access::Cyclic), ServerPort::Required);
    }

    #[test]
    fn a_raised_stop_ends_a_call_that_waits() {
        let stop = Stop::new().unwrap();
        let opening = Opening::new(Access::Discovery).stopped_by(stop.clone());
        let mut network = opening.udp().unwrap();
        let waiting = std::thread::spawn(move || network.pass(std::time::Duration::from_secs(60)).wait());
        stop.stop();
        let ended = waiting.join().unwrap();
        assert!(matches!(ended, Err(client::Error::Interrupted)), "{ended:?}");
    }

    #[cfg(not(all(feature = "raw-ethernet", target_os = "linux")))]
    #[test]
    fn without_raw_ethernet_a_drive_given_by_its_ip_address_is_left() {
        for opening in [
            Opening::new(Access::Records),
            Opening::new(Access::Cyclic).on("eth0"),
        ] {
            let error = opening.clone().open().unwrap_err();
            assert!(
                matches!(error, OpenError::Network(NetworkError::NoRawEthernet)),
                "{error}"
            );
            let network = opening.by_ip(true).open().unwrap();
            assert!(matches!(network.transport(), Transport::Udp));
        }
    }

    #[cfg(all(feature = "raw-ethernet", target_os = "linux"))]
    #[test]
    fn an_interface_that_does_not_exist_is_reported_with_those_that_do() {
        let error = open("no-such-interface").unwrap_err();
        assert!(
            matches!(&error, OpenError::Network(NetworkError::NoSuchInterface { existing, .. })
                if existing.iter().any(|name| name == "lo")),
            "{error}"
        );
    }
}

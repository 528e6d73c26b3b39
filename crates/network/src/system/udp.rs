//! Kernel UDP sockets for the local ports an endpoint uses.

use std::io;
use std::net::{Ipv4Addr, SocketAddr, SocketAddrV4, UdpSocket};

use profinet::{IpSuite, RPC_PORT};
use socket2::{Domain, Protocol, Socket, Type};

use super::error::Error;
use super::interface::towards;
use super::medium::ServerPort;
use super::os::{self, Claim};

/// Most local ports open at once beside those of the server; the one unused for longest makes room.
const MAX_PORTS: usize = 32;

/// Octets that wait to be read, with what the kernel needs for each datagram.
const RECEIVE_BUFFER: usize = 1 << 20;

#[derive(Debug)]
struct Port {
    address: Ipv4Addr,
    number: u16,
    socket: UdpSocket,
    /// Keeps other programs of this library from requiring the port too.
    _claim: Option<Claim>,
    used: u64,
}

/// The sockets of all local addresses, made when first needed.
///
/// A datagram leaves from the address in whose subnet its receiver is: a station answers, and calls back, where it was
/// spoken to from.
#[derive(Debug)]
pub(crate) struct Ports {
    own: Vec<IpSuite>,
    server: ServerPort,
    open: Vec<Port>,
    uses: u64,
    unsent: u64,
}

impl Ports {
    pub(crate) fn new(own: Vec<IpSuite>, server: ServerPort) -> Self {
        Self {
            own,
            server,
            open: Vec::new(),
            uses: 0,
            unsent: 0,
        }
    }

    /// Opens the server port of every address where it is free or shared, if requested.
    ///
    /// # Errors
    /// [`Error::PortOccupied`] where it is required and free at no address. Where it is free at some, an occupied one
    /// is an error only once a datagram is to leave from there.
    pub(crate) fn listen(&mut self) -> Result<(), Error> {
        if self.server == ServerPort::None {
            return Ok(());
        }
        let mut occupied = None;
        for index in 0..self.own.len() {
            let Some(own) = self.own.get(index) else { break };
            match self.open(own.address, RPC_PORT) {
                Err(error @ Error::PortOccupied { .. }) => occupied = occupied.or(Some(error)),
                other => other?,
            }
        }
        match occupied {
            Some(error) if self.server == ServerPort::Required && self.open.is_empty() => Err(error),
            _ => Ok(()),
        }
    }

    fn open(&mut self, address: Ipv4Addr, number: u16) -> Result<(), Error> {
        self.find_or_open(address, number).map(|_| ())
    }

    /// Sends one datagram. What the network does not take is counted, as any datagram may be lost.
    pub(crate) fn send(
        &mut self,
        source_port: u16,
        destination: SocketAddrV4,
        payload: &[u8],
    ) -> Result<(), Error> {
        let address = self.source(destination);
        if self.server == ServerPort::Required {
            // a peer may call back
            self.open(address, RPC_PORT)?;
        }
        let port = self.find_or_open(address, source_port)?;
        if port.socket.send_to(payload, destination).is_err() {
            self.unsent += 1;
        }
        Ok(())
    }

    /// Returns the own address a datagram leaves from: of the receiver's subnet, else the one the kernel's routes lead
    /// through.
    fn source(&self, destination: SocketAddrV4) -> Ipv4Addr {
        let first = || self.own.first().map_or(Ipv4Addr::UNSPECIFIED, |own| own.address);
        match (towards(&self.own, *destination.ip()), self.own.len()) {
            (Some(own), _) => own.address,
            (None, 0 | 1) => first(),
            (None, _) => routed(destination)
                .filter(|address| self.own.iter().any(|own| own.address == *address))
                .unwrap_or_else(first),
        }
    }

    /// Datagrams the network did not take: no route, queue full.
    pub(crate) fn unsent(&self) -> u64 {
        self.unsent
    }

    /// Devices can call here: the server port is open.
    pub(crate) fn receives_calls(&self) -> bool {
        self.open.iter().any(|port| port.number == RPC_PORT)
    }

    pub(crate) fn len(&self) -> usize {
        self.open.len()
    }

    #[cfg(target_os = "linux")]
    pub(crate) fn sockets(&self) -> impl Iterator<Item = &UdpSocket> {
        self.open.iter().map(|port| &port.socket)
    }

    /// One datagram from the socket at `index`, if there is one.
    pub(crate) fn receive(&mut self, index: usize, buffer: &mut [u8]) -> Option<(SocketAddrV4, u16, usize)> {
        let port = self.open.get(index)?;
        match port.socket.recv_from(buffer) {
            Ok((length, SocketAddr::V4(from))) => Some((from, port.number, length)),
            // Errors of a datagram socket concern earlier datagrams; continuing loses nothing.
            Ok(_) | Err(_) => None,
        }
    }

    fn find_or_open(&mut self, address: Ipv4Addr, number: u16) -> Result<&Port, Error> {
        self.uses += 1;
        let found = self
            .open
            .iter()
            .position(|port| port.number == number && port.address == address);
        let index = match found {
            Some(index) => index,
            None => {
                let server = number == RPC_PORT;
                let claim = (server && self.server == ServerPort::Required)
                    .then(|| claim(address))
                    .transpose()?;
                let shares = matches!(self.server, ServerPort::Required | ServerPort::Shared);
                let socket = bind(address, number, server && shares)?;
                self.make_room();
                self.open.push(Port {
                    address,
                    number,
                    socket,
                    _claim: claim,
                    used: 0,
                });
                self.open.len() - 1
            }
        };
        let uses = self.uses;
        match self.open.get_mut(index) {
            Some(port) => {
                port.used = uses;
                Ok(port)
            }
            None => Err(Error::PortOccupied {
                address,
                port: number,
            }),
        }
    }

    fn make_room(&mut self) {
        let clients = || {
            self.open
                .iter()
                .enumerate()
                .filter(|(_, port)| port.number != RPC_PORT)
        };
        if clients().count() < MAX_PORTS {
            return;
        }
        if let Some((index, _)) = clients().min_by_key(|(_, port)| port.used) {
            self.open.swap_remove(index);
        }
    }
}

/// Returns the address the kernel would send from; nothing is sent to find out.
fn routed(destination: SocketAddrV4) -> Option<Ipv4Addr> {
    let socket = UdpSocket::bind((Ipv4Addr::UNSPECIFIED, 0)).ok()?;
    socket.connect(destination).ok()?;
    match socket.local_addr().ok()? {
        SocketAddr::V4(own) => Some(*own.ip()),
        SocketAddr::V6(_) => None,
    }
}

/// Claims the server port of an address.
fn claim(address: Ipv4Addr) -> Result<Claim, Error> {
    os::claim(address, RPC_PORT).map_err(|source| match source.kind() {
        io::ErrorKind::AddrInUse => Error::PortOccupied {
            address,
            port: RPC_PORT,
        },
        _ => Error::System {
            action: "cannot claim a UDP port",
            source,
        },
    })
}

/// Binds a UDP socket. With `share` it gets the datagrams of a port that another program of this library has.
fn bind(address: Ipv4Addr, number: u16, share: bool) -> Result<UdpSocket, Error> {
    let system = |source| Error::System {
        action: "cannot open a UDP port",
        source,
    };
    let socket = Socket::new(Domain::IPV4, Type::DGRAM, Some(Protocol::UDP)).map_err(system)?;
    if share && os::PORTS_ARE_SHARED {
        socket.set_reuse_address(true).map_err(system)?;
    }
    socket
        .bind(&SocketAddrV4::new(address, number).into())
        .map_err(|source| match source.kind() {
            io::ErrorKind::AddrInUse => Error::PortOccupied {
                address,
                port: number,
            },
            io::ErrorKind::AddrNotAvailable => Error::NotOurAddress { address },
            _ => system(source),
        })?;
    if number == RPC_PORT && os::PORTS_ARE_SHARED {
        // Only after bind: the port stays refused to those who do not share it. The kernel hands datagrams to the socket
        // that was bound last.
        socket.set_reuse_address(true).map_err(system)?;
    }
    socket.set_nonblocking(true).map_err(system)?;
    // As much as the system gives: many stations may answer while this program is not running.
    let _ = socket.set_recv_buffer_size(RECEIVE_BUFFER);
    // Only needed for broadcasts; a failure is ignored.
    let _ = socket.set_broadcast(true);
    Ok(socket.into())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ports(address: Ipv4Addr, server: ServerPort) -> Ports {
        let mask = Ipv4Addr::UNSPECIFIED;
        let own = IpSuite {
            address,
            mask,
            ..IpSuite::NONE
        };
        Ports::new(vec![own], server)
    }

    #[test]
    fn an_occupied_port_is_reported_by_number() {
        let taken = UdpSocket::bind((Ipv4Addr::LOCALHOST, 0)).unwrap();
        let number = taken.local_addr().unwrap().port();
        let home = Ipv4Addr::LOCALHOST;
        let error = ports(home, ServerPort::None).open(home, number).unwrap_err();
        assert!(matches!(error, Error::PortOccupied { port, .. } if port == number));
        let foreign = Ipv4Addr::new(203, 0, 113, 9);
        let error = ports(foreign, ServerPort::None).open(foreign, 0).unwrap_err();
        assert!(matches!(error, Error::NotOurAddress { address } if address == foreign));
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn the_port_of_the_controller_is_shared_with_those_who_ask_for_it_only() {
        // an address of its own: the port is the same in every test
        let address = Ipv4Addr::new(127, 34, 96, 4);
        let mut suspended = ports(address, ServerPort::Required);
        suspended.listen().unwrap();
        let refused = ports(address, ServerPort::Required).listen();
        assert!(matches!(refused, Err(Error::PortOccupied { .. })), "{refused:?}");
        let mut later = ports(address, ServerPort::Shared);
        later.listen().unwrap();
        let peer = UdpSocket::bind((address, 0)).unwrap();
        let mut buffer = [0; 8];
        peer.send_to(b"ready", (address, RPC_PORT)).unwrap();
        let received = later.receive(0, &mut buffer).map(|(.., length)| length);
        assert_eq!(received, Some(5));
        assert!(suspended.receive(0, &mut buffer).is_none());
        drop(later);
        peer.send_to(b"ready", (address, RPC_PORT)).unwrap();
        assert!(suspended.receive(0, &mut buffer).is_some());
    }

    #[cfg(target_os = "linux")]
    /// A command that only reads takes the port where it is free, and may be there first.
    #[test]
    fn a_controller_shares_its_port_with_who_reads_and_not_with_others() {
        let address = Ipv4Addr::new(127, 34, 96, 5);
        let mut reads = ports(address, ServerPort::IfFree);
        reads.listen().unwrap();
        let mut controls = ports(address, ServerPort::Required);
        controls.listen().unwrap();
        let peer = UdpSocket::bind((address, 0)).unwrap();
        let mut buffer = [0; 8];
        peer.send_to(b"ready", (address, RPC_PORT)).unwrap();
        assert!(
            controls.receive(0, &mut buffer).is_some(),
            "the call is for the controller"
        );
        let mut later = ports(address, ServerPort::IfFree);
        later.listen().unwrap();
        assert!(!later.receives_calls() && controls.receives_calls());
        let second = ports(address, ServerPort::Required).listen();
        assert!(matches!(second, Err(Error::PortOccupied { .. })), "{second:?}");
        drop((reads, controls));
        let foreign = UdpSocket::bind((address, RPC_PORT)).unwrap();
        for server in [ServerPort::Required, ServerPort::Shared] {
            let mut refused = ports(address, server);
            let listens = refused.listen();
            assert_eq!(listens.is_ok(), server == ServerPort::Shared, "{listens:?}");
            assert!(!refused.receives_calls(), "{server:?}");
        }
        drop(foreign);
    }

    #[test]
    fn the_number_of_open_ports_is_bounded() {
        let mut ports = ports(Ipv4Addr::LOCALHOST, ServerPort::None);
        let mut opened = 0;
        for number in 50_000..50_200 {
            opened += usize::from(ports.open(Ipv4Addr::LOCALHOST, number).is_ok());
        }
        assert!(opened > MAX_PORTS);
        assert_eq!(ports.len(), MAX_PORTS);
    }
}

//! Kernel UDP sockets for the local ports an endpoint uses.

use std::io;
use std::net::{Ipv4Addr, SocketAddr, SocketAddrV4, UdpSocket};
use std::os::fd::{AsRawFd, RawFd};

use profinet::RPC_PORT;

use super::error::Error;

/// Most local ports open at once; the one unused for longest makes room.
const MAX_PORTS: usize = 32;

#[derive(Debug)]
struct Port {
    number: u16,
    socket: UdpSocket,
    used: u64,
}

/// The sockets of one local address, made when first needed.
#[derive(Debug)]
pub(super) struct Ports {
    address: Ipv4Addr,
    open: Vec<Port>,
    uses: u64,
    unsent: u64,
}

impl Ports {
    pub(super) fn new(address: Ipv4Addr) -> Self {
        Self {
            address,
            open: Vec::new(),
            uses: 0,
            unsent: 0,
        }
    }

    /// Opens a port now, to receive on it.
    pub(super) fn open(&mut self, number: u16) -> Result<(), Error> {
        self.find_or_open(number).map(|_| ())
    }

    /// Sends one datagram. What the network does not take is counted, as any datagram may be lost.
    pub(super) fn send(
        &mut self,
        source_port: u16,
        destination: SocketAddrV4,
        payload: &[u8],
    ) -> Result<(), Error> {
        let port = self.find_or_open(source_port)?;
        if port.socket.send_to(payload, destination).is_err() {
            self.unsent += 1;
        }
        Ok(())
    }

    /// Datagrams the network did not take: no route, queue full.
    pub(super) fn unsent(&self) -> u64 {
        self.unsent
    }

    pub(super) fn len(&self) -> usize {
        self.open.len()
    }

    pub(super) fn fds(&self) -> impl Iterator<Item = RawFd> {
        self.open.iter().map(|port| port.socket.as_raw_fd())
    }

    /// One datagram from the socket at `index`, if there is one.
    pub(super) fn receive(&mut self, index: usize, buffer: &mut [u8]) -> Option<(SocketAddrV4, u16, usize)> {
        let port = self.open.get(index)?;
        match port.socket.recv_from(buffer) {
            Ok((length, SocketAddr::V4(from))) => Some((from, port.number, length)),
            // Errors of a datagram socket tell of earlier datagrams; nothing is lost by going on.
            Ok(_) | Err(_) => None,
        }
    }

    fn find_or_open(&mut self, number: u16) -> Result<&Port, Error> {
        self.uses += 1;
        let index = match self.open.iter().position(|port| port.number == number) {
            Some(index) => index,
            None => {
                self.make_room();
                let socket = bind(self.address, number)?;
                self.open.push(Port {
                    number,
                    socket,
                    used: 0,
                });
                self.open.len() - 1
            }
        };
        let (address, uses) = (self.address, self.uses);
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
        if self.open.len() < MAX_PORTS {
            return;
        }
        let oldest = self
            .open
            .iter()
            .enumerate()
            .filter(|(_, port)| port.number != RPC_PORT)
            .min_by_key(|(_, port)| port.used);
        if let Some((index, _)) = oldest {
            self.open.swap_remove(index);
        }
    }
}

fn bind(address: Ipv4Addr, number: u16) -> Result<UdpSocket, Error> {
    let socket =
        UdpSocket::bind(SocketAddrV4::new(address, number)).map_err(|source| match source.kind() {
            io::ErrorKind::AddrInUse => Error::PortOccupied {
                address,
                port: number,
            },
            io::ErrorKind::AddrNotAvailable => Error::NotOurAddress { address },
            _ => Error::System {
                action: "cannot open a UDP port",
                source,
            },
        })?;
    socket
        .set_nonblocking(true)
        .map_err(Error::system("cannot open a UDP port"))?;
    // Only needed for datagrams to everybody; no failure otherwise.
    let _ = socket.set_broadcast(true);
    Ok(socket)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_occupied_port_is_told_by_number() {
        let taken = UdpSocket::bind((Ipv4Addr::LOCALHOST, 0)).unwrap();
        let number = taken.local_addr().unwrap().port();
        let error = Ports::new(Ipv4Addr::LOCALHOST).open(number).unwrap_err();
        assert!(matches!(error, Error::PortOccupied { port, .. } if port == number));
        let foreign = Ipv4Addr::new(203, 0, 113, 9);
        assert!(
            matches!(Ports::new(foreign).open(0), Err(Error::NotOurAddress { address }) if address == foreign)
        );
    }

    #[test]
    fn the_number_of_open_ports_is_bounded() {
        let mut ports = Ports::new(Ipv4Addr::LOCALHOST);
        let mut opened = 0;
        for number in 50_000..50_200 {
            opened += usize::from(ports.open(number).is_ok());
        }
        assert!(opened > MAX_PORTS);
        assert_eq!(ports.len(), MAX_PORTS);
    }
}

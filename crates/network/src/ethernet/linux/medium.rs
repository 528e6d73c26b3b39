//! The caller's own endpoint on a real network, with the host's own addresses.

use std::os::fd::RawFd;

use profinet::{Endpoint, Instant, Medium, Transmit};

use super::filter::Wanted;
use super::packet::PacketSocket;
use crate::ethernet::PacketStatistics;
use crate::segment::{Tap, finish_all};
use crate::system::medium::{Common, MAX_BURST, with_server};
use crate::system::udp::Ports;
use crate::system::{Bell, Error, InterfaceInfo, ServerPort, Stop, now};

/// The system ignores it where it waits.
const NO_SOCKET: RawFd = -1;
/// Most frames handled before datagrams and deadlines get their turn.
const MAX_INPUTS: usize = 64;

/// Carries an endpoint on an Ethernet interface: PROFINET frames through a raw socket, datagrams through the
/// kernel's UDP from the interface's own address in the subnet of the receiver.
///
/// The endpoint must use the interface's Ethernet address: see [`InterfaceInfo`].
///
/// ```no_run
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// use profidrive_network::ethernet::PacketMedium;
/// use profidrive_network::system::ServerPort;
/// use profinet::Medium;
/// let medium = PacketMedium::open("eth0", ServerPort::Required)?;
/// println!("{} {}", medium.interface().name, medium.now().as_millis());
/// # Ok(()) }
/// ```
#[derive(Debug)]
pub struct PacketMedium {
    packet: PacketSocket,
    udp: Option<Ports>,
    common: Common,
    taps: Taps,
    /// Not before this time are there frames and deadlines again.
    next_batch: Instant,
}

/// Those who see every frame.
#[derive(Default)]
struct Taps(Vec<Box<dyn Tap>>);

impl Taps {
    fn frame(&mut self, at: Instant, frame: &[u8]) {
        self.0.iter_mut().for_each(|tap| tap.frame(at, frame));
    }
}

impl std::fmt::Debug for Taps {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{} taps", self.0.len())
    }
}

impl PacketMedium {
    /// Opens an interface.
    ///
    /// # Errors
    /// No such interface, interface down, no right to raw sockets, UDP port in use.
    pub fn open(interface: &str, server: ServerPort) -> Result<Self, Error> {
        Self::open_for(interface, server, 1)
    }

    /// Opens an interface for a controller of so many devices: the receive ring has room for what they send while this
    /// process does not run.
    ///
    /// # Errors
    /// As [`open`](Self::open).
    pub fn open_for(interface: &str, server: ServerPort, devices: usize) -> Result<Self, Error> {
        let mut packet = PacketSocket::open(interface, Wanted::Profinet, devices)?;
        let mac = packet.interface().usable()?;
        packet.add_address(mac)?;
        let own = packet.interface().addresses.clone();
        let udp = (!own.is_empty()).then(|| with_server(own, server)).transpose()?;
        Ok(Self {
            packet,
            udp,
            common: Common::new(),
            taps: Taps::default(),
            next_batch: Instant::ZERO,
        })
    }

    /// Returns the interface as it was when opened.
    #[must_use]
    pub fn interface(&self) -> &InterfaceInfo {
        self.packet.interface()
    }

    /// Returns the counters of the raw socket.
    #[must_use]
    pub fn statistics(&mut self) -> PacketStatistics {
        self.packet.statistics()
    }

    /// Datagrams the kernel did not take: no route, queue full.
    #[must_use]
    pub fn unsent_datagrams(&self) -> u64 {
        self.udp.as_ref().map_or(0, Ports::unsent)
    }

    /// Returns true while devices can call their controller here, on UDP port 34964.
    #[must_use]
    pub fn receives_calls(&self) -> bool {
        self.udp.as_ref().is_some_and(Ports::receives_calls)
    }

    /// Lets this flag end a step early, once.
    pub fn set_stop(&mut self, stop: Stop) {
        self.common.calls.stop = Some(stop);
    }

    /// Lets this bell end a step early whenever it rings.
    pub fn set_bell(&mut self, bell: Bell) {
        self.common.calls.bell = Some(bell);
    }

    /// Lets `tap` see every PROFINET frame received and sent; datagrams are the kernel's and not seen.
    pub fn add_tap(&mut self, tap: Box<dyn Tap>) {
        self.taps.0.push(tap);
    }

    /// Ends all taps: buffers are flushed and the first failure is reported.
    ///
    /// # Errors
    /// When a tap could not write what it saw.
    pub fn finish_taps(&mut self) -> std::io::Result<()> {
        finish_all(&mut self.taps.0)
    }

    fn drain(&mut self, endpoint: &mut dyn Endpoint) -> Result<(), Error> {
        let Self {
            packet,
            udp,
            common,
            taps,
            ..
        } = self;
        for _ in 0..MAX_BURST {
            let at = now();
            match endpoint.poll_transmit(at, &mut common.output) {
                Some(Transmit::Frame { length }) => {
                    let frame = common.output.get(..length).unwrap_or_default();
                    taps.frame(at, frame);
                    packet.queue(frame)?;
                }
                Some(Transmit::Datagram {
                    destination,
                    source_port,
                    length,
                }) => {
                    let no_address = || Error::NoAddress {
                        interface: packet.interface().name.clone(),
                    };
                    let ports = udp.as_mut().ok_or_else(no_address)?;
                    ports.send(
                        source_port,
                        destination,
                        common.output.get(..length).unwrap_or_default(),
                    )?;
                }
                None => break,
            }
        }
        packet.flush()
    }

    /// Passes on the waiting frames, and the deadline if it is due; does not wait.
    fn work(&mut self, endpoint: &mut dyn Endpoint) -> Result<bool, Error> {
        let begin = now();
        let mut inputs = 0;
        while inputs < MAX_INPUTS {
            let at = now();
            let Some((received, frame)) = self.packet.peek() else {
                break;
            };
            if !self.taps.0.is_empty() {
                let whole = received.on_the_wire(frame, &mut self.common.input);
                self.taps.frame(at, whole);
            }
            endpoint.handle_frame(at, frame);
            self.packet.release();
            inputs += 1;
            self.drain(endpoint)?;
        }
        let is_due = endpoint.poll_timeout().is_some_and(|due| due <= now());
        if is_due {
            endpoint.handle_timeout(now());
            self.drain(endpoint)?;
        }
        let worked = is_due || inputs > 0;
        // with more waiting frames there is no rest
        if worked && inputs < MAX_INPUTS {
            self.next_batch = begin + endpoint.may_wait();
        }
        Ok(worked)
    }
}

impl Medium for PacketMedium {
    type Error = Error;

    fn now(&self) -> Instant {
        now()
    }

    fn step(&mut self, endpoint: &mut dyn Endpoint, until: Instant) -> Result<(), Error> {
        self.drain(endpoint)?;
        loop {
            let rests = now() < self.next_batch;
            if (!rests && self.work(endpoint)?) || now() >= until {
                return Ok(());
            }
            let due = if rests {
                Some(self.next_batch)
            } else {
                endpoint.poll_timeout()
            };
            let wake = due.map_or(until, |due| due.min(until));
            let packet = if rests { NO_SOCKET } else { self.packet.fd() };
            let Common { waiting, calls, .. } = &mut self.common;
            waiting.wait_beside(packet, self.udp.as_ref(), calls, wake)?;
            self.packet.check(self.common.waiting.packet())?;
            let mut worked = self.common.waiting.called(&self.common.calls);
            for index in 0..self.udp.as_ref().map_or(0, Ports::len) {
                if self.common.receive(self.udp.as_mut(), index, endpoint) {
                    worked = true;
                    self.drain(endpoint)?;
                }
            }
            if worked {
                return Ok(());
            }
        }
    }
}

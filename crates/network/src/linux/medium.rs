//! The caller's own endpoint on a real network, with the host's own addresses.

use std::net::Ipv4Addr;

use profinet::{Endpoint, Instant, IpSuite, MAX_FRAME, Medium, Transmit};

use super::error::Error;
use super::filter::Wanted;
use super::interface::InterfaceInfo;
use super::packet::{PacketSocket, PacketStatistics};
use super::poll::{now, readable, sharpen_timers, wait};
use super::stop::Stop;
use super::udp::Ports;
use crate::segment::{Tap, finish_all};

/// Most frames handled before datagrams and deadlines get their turn.
const MAX_INPUTS: usize = 64;
/// Most outputs taken in one drain; what is left follows in the next step.
const MAX_BURST: usize = 256;
/// Places of the packet socket and the stop flag among the descriptors; the UDP sockets follow.
const PACKET: usize = 0;
const STOP: usize = 1;
const UDP: usize = 2;

/// Whether the medium receives on UDP port 34964, where devices call their controller.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ServerPort {
    /// Yes, and it is an error if another program has it: for a controller with cyclic data. With a program of this library
    /// that has it by [`IfFree`](Self::IfFree) it is shared.
    Required,
    /// If it is free: beside a controller that runs already.
    IfFree,
    /// If it is free or a program of this library has it, whose datagrams then come here: for a connection that has to be
    /// made though that program runs on another drive, or does not run at all (stopped by SIGSTOP or in a debugger).
    Shared,
    /// No.
    None,
}

/// Carries an endpoint on an Ethernet interface: PROFINET frames through a raw socket, datagrams through the
/// kernel's UDP from the interface's own address in the subnet of the receiver.
///
/// The endpoint must use the interface's Ethernet address: see [`InterfaceInfo`].
///
/// ```no_run
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// use profidrive_network::linux::{PacketMedium, ServerPort};
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
}

/// Carries an endpoint by UDP alone, which needs no right: records are read and written, nothing is discovered and
/// nothing is cyclic. PROFINET frames of the endpoint are dropped.
///
/// ```
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// use std::net::Ipv4Addr;
/// use profidrive_network::linux::{ServerPort, UdpMedium};
/// let medium = UdpMedium::open(Ipv4Addr::LOCALHOST, ServerPort::None)?;
/// assert_eq!(medium.dropped_frames(), 0);
/// # Ok(()) }
/// ```
#[derive(Debug)]
pub struct UdpMedium {
    udp: Option<Ports>,
    common: Common,
    dropped: u64,
}

impl PacketMedium {
    /// Opens an interface.
    ///
    /// # Errors
    /// No such interface, interface down, no right to raw sockets, UDP port in use.
    pub fn open(interface: &str, server: ServerPort) -> Result<Self, Error> {
        let mut packet = PacketSocket::open(interface, Wanted::Profinet)?;
        let mac = packet.interface().usable()?;
        packet.add_address(mac)?;
        let own = packet.interface().addresses.clone();
        let udp = (!own.is_empty()).then(|| with_server(own, server)).transpose()?;
        Ok(Self {
            packet,
            udp,
            common: Common::new(),
        })
    }

    /// The interface as it was when opened.
    #[must_use]
    pub fn interface(&self) -> &InterfaceInfo {
        self.packet.interface()
    }

    /// What the raw socket has counted.
    #[must_use]
    pub fn statistics(&mut self) -> PacketStatistics {
        self.packet.statistics()
    }

    /// Datagrams the kernel did not take: no route, queue full.
    #[must_use]
    pub fn unsent_datagrams(&self) -> u64 {
        self.udp.as_ref().map_or(0, Ports::unsent)
    }

    /// True while devices can call their controller here, on UDP port 34964.
    #[must_use]
    pub fn hears_calls(&self) -> bool {
        self.udp.as_ref().is_some_and(Ports::hears_calls)
    }

    /// Lets this flag end a step early, once.
    pub fn set_stop(&mut self, stop: Stop) {
        self.common.stop = Some(stop);
    }

    /// Lets `tap` see every PROFINET frame received and sent; datagrams are the kernel's and not seen.
    pub fn add_tap(&mut self, tap: Box<dyn Tap>) {
        self.common.taps.push(tap);
    }

    /// Ends all taps: buffers are flushed and the first failure is told.
    ///
    /// # Errors
    /// When a tap could not write what it saw.
    pub fn finish_taps(&mut self) -> std::io::Result<()> {
        finish_all(&mut self.common.taps)
    }

    fn drain(&mut self, endpoint: &mut dyn Endpoint) -> Result<(), Error> {
        let Self { packet, udp, common } = self;
        for _ in 0..MAX_BURST {
            let at = now();
            match endpoint.poll_transmit(at, &mut common.output) {
                Some(Transmit::Frame { length }) => {
                    let frame = common.output.get(..length).unwrap_or_default();
                    common.taps.iter_mut().for_each(|tap| tap.frame(at, frame));
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

    /// Hands over the frames that are there, and the deadline if it is due; does not wait.
    fn work(&mut self, endpoint: &mut dyn Endpoint) -> Result<bool, Error> {
        let mut worked = false;
        for _ in 0..MAX_INPUTS {
            let at = now();
            let Some((received, frame)) = self.packet.peek() else {
                break;
            };
            if !self.common.taps.is_empty() {
                let whole = received.on_the_wire(frame, &mut self.common.input);
                self.common.taps.iter_mut().for_each(|tap| tap.frame(at, whole));
            }
            endpoint.handle_frame(at, frame);
            self.packet.release();
            worked = true;
            self.drain(endpoint)?;
        }
        if endpoint.poll_timeout().is_some_and(|due| due <= now()) {
            endpoint.handle_timeout(now());
            worked = true;
            self.drain(endpoint)?;
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
            if self.work(endpoint)? || now() >= until {
                return Ok(());
            }
            let wake = endpoint.poll_timeout().map_or(until, |due| due.min(until));
            self.common.wait(self.packet.fd(), self.udp.as_ref(), wake)?;
            self.packet.check(self.common.revents(PACKET))?;
            let mut worked = self.common.revents(STOP) != 0;
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

impl UdpMedium {
    /// Uses the local address `address`; 0.0.0.0 lets the kernel choose.
    ///
    /// # Errors
    /// The address is not ours, the UDP port is in use.
    pub fn open(address: Ipv4Addr, server: ServerPort) -> Result<Self, Error> {
        let everywhere = IpSuite {
            address,
            ..IpSuite::NONE
        };
        Ok(Self {
            udp: Some(with_server(vec![everywhere], server)?),
            common: Common::new(),
            dropped: 0,
        })
    }

    /// PROFINET frames of the endpoint that could not be sent this way.
    #[must_use]
    pub fn dropped_frames(&self) -> u64 {
        self.dropped
    }

    /// Datagrams the kernel did not take: no route, queue full.
    #[must_use]
    pub fn unsent_datagrams(&self) -> u64 {
        self.udp.as_ref().map_or(0, Ports::unsent)
    }

    /// Lets this flag end a step early, once.
    pub fn set_stop(&mut self, stop: Stop) {
        self.common.stop = Some(stop);
    }

    /// True while devices can call their controller here, on UDP port 34964.
    #[must_use]
    pub fn hears_calls(&self) -> bool {
        self.udp.as_ref().is_some_and(Ports::hears_calls)
    }

    fn drain(&mut self, endpoint: &mut dyn Endpoint) -> Result<(), Error> {
        for _ in 0..MAX_BURST {
            match endpoint.poll_transmit(now(), &mut self.common.output) {
                Some(Transmit::Frame { .. }) => self.dropped += 1,
                Some(Transmit::Datagram {
                    destination,
                    source_port,
                    length,
                }) => {
                    let payload = self.common.output.get(..length).unwrap_or_default();
                    if let Some(ports) = &mut self.udp {
                        ports.send(source_port, destination, payload)?;
                    }
                }
                None => break,
            }
        }
        Ok(())
    }
}

impl Medium for UdpMedium {
    type Error = Error;

    fn now(&self) -> Instant {
        now()
    }

    fn step(&mut self, endpoint: &mut dyn Endpoint, until: Instant) -> Result<(), Error> {
        self.drain(endpoint)?;
        loop {
            if endpoint.poll_timeout().is_some_and(|due| due <= now()) {
                endpoint.handle_timeout(now());
                return self.drain(endpoint);
            }
            if now() >= until {
                return Ok(());
            }
            let wake = endpoint.poll_timeout().map_or(until, |due| due.min(until));
            self.common.wait(-1, self.udp.as_ref(), wake)?;
            let mut worked = self.common.revents(STOP) != 0;
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

/// What both media need.
struct Common {
    input: Box<[u8]>,
    output: Box<[u8]>,
    fds: Vec<libc::pollfd>,
    taps: Vec<Box<dyn Tap>>,
    stop: Option<Stop>,
    sharpened: bool,
}

impl std::fmt::Debug for Common {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Common")
            .field("taps", &self.taps.len())
            .finish_non_exhaustive()
    }
}

impl Common {
    fn new() -> Self {
        let buffer = || vec![0; 2 * MAX_FRAME].into_boxed_slice();
        Self {
            input: buffer(),
            output: buffer(),
            fds: Vec::new(),
            taps: Vec::new(),
            stop: None,
            sharpened: false,
        }
    }

    /// Waits until a socket has something, the stop flag is set, or `until`.
    fn wait(&mut self, packet: i32, udp: Option<&Ports>, until: Instant) -> Result<(), Error> {
        if !self.sharpened {
            sharpen_timers();
            self.sharpened = true;
        }
        // A flag that is set already wakes no more: the owner may have things to bring to an end.
        let stop = self
            .stop
            .as_ref()
            .filter(|stop| !stop.is_stopped())
            .map_or(-1, Stop::fd);
        self.fds.clear();
        self.fds.extend([readable(packet), readable(stop)]);
        self.fds
            .extend(udp.into_iter().flat_map(Ports::fds).map(readable));
        wait(&mut self.fds, until - now()).map_err(Error::system("cannot wait for frames"))
    }

    fn revents(&self, index: usize) -> libc::c_short {
        self.fds.get(index).map_or(0, |fd| fd.revents)
    }

    /// Hands one datagram of a socket that has some to the endpoint; the next wait tells of more.
    fn receive(&mut self, udp: Option<&mut Ports>, index: usize, endpoint: &mut dyn Endpoint) -> bool {
        if self.revents(UDP + index) == 0 {
            return false;
        }
        let Some((source, port, length)) = udp.and_then(|ports| ports.receive(index, &mut self.input)) else {
            return false;
        };
        endpoint.handle_datagram(now(), source, port, self.input.get(..length).unwrap_or_default());
        true
    }
}

/// The sockets of the own addresses, the server ports among them if wanted.
fn with_server(own: Vec<IpSuite>, server: ServerPort) -> Result<Ports, Error> {
    let mut ports = Ports::new(own, server);
    ports.listen()?;
    Ok(ports)
}

//! The caller's own endpoint over the UDP of this computer.

use std::net::Ipv4Addr;

use profinet::{Endpoint, Instant, IpSuite, MAX_FRAME, Medium, Transmit};

use super::error::Error;
use super::os::{Waiting, now};
use super::stop::{Bell, Calls, Stop};
use super::udp::Ports;

/// Most outputs taken in one drain; what is left follows in the next step.
pub(crate) const MAX_BURST: usize = 256;

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

/// Carries an endpoint by UDP alone, which needs no permission: records are read and written, nothing is discovered and
/// nothing is cyclic. PROFINET frames of the endpoint are dropped.
///
/// ```
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// use std::net::Ipv4Addr;
/// use profidrive_network::system::{ServerPort, UdpMedium};
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
        self.common.calls.stop = Some(stop);
    }

    /// Lets this bell end a step early whenever it rings.
    pub fn set_bell(&mut self, bell: Bell) {
        self.common.calls.bell = Some(bell);
    }

    /// Returns true while devices can call their controller here, on UDP port 34964.
    #[must_use]
    pub fn receives_calls(&self) -> bool {
        self.udp.as_ref().is_some_and(Ports::receives_calls)
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
            let Common { waiting, calls, .. } = &mut self.common;
            waiting.wait(self.udp.as_ref(), calls, wake)?;
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

/// What a medium needs.
#[derive(Debug)]
pub(crate) struct Common {
    pub input: Box<[u8]>,
    pub output: Box<[u8]>,
    pub waiting: Waiting,
    pub calls: Calls,
}

impl Common {
    pub fn new() -> Self {
        let buffer = || vec![0; 2 * MAX_FRAME].into_boxed_slice();
        Self {
            input: buffer(),
            output: buffer(),
            waiting: Waiting::default(),
            calls: Calls::default(),
        }
    }

    /// Passes one datagram of a socket to the endpoint; the next wait reports further ones.
    pub fn receive(&mut self, udp: Option<&mut Ports>, index: usize, endpoint: &mut dyn Endpoint) -> bool {
        if !self.waiting.has(index) {
            return false;
        }
        let Some((source, port, length)) = udp.and_then(|ports| ports.receive(index, &mut self.input)) else {
            return false;
        };
        endpoint.handle_datagram(now(), source, port, self.input.get(..length).unwrap_or_default());
        true
    }
}

/// Returns the sockets of the own addresses, with the server ports if requested.
pub(crate) fn with_server(own: Vec<IpSuite>, server: ServerPort) -> Result<Ports, Error> {
    let mut ports = Ports::new(own, server);
    ports.listen()?;
    Ok(ports)
}

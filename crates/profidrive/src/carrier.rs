//! What carries a session: a network interface, UDP alone, or a serial line.

use std::error::Error;
use std::fmt;

use client::{Engine, Parity, Wire};
use network::ethernet::PacketMedium;
use network::serial::{self, Line, Settings, Talker};
use network::system::{Bell, Error as NetworkError, UdpMedium};
use profinet::{Instant, Medium};

/// A way to drives.
#[derive(Debug)]
pub enum Carrier {
    /// A network interface with permission for raw frames: everything.
    Packet(Box<PacketMedium>),
    /// Records only.
    Udp(Box<UdpMedium>),
    /// Drives at a serial port.
    Serial(Box<Line>),
}

/// Why a way failed.
#[derive(Debug)]
pub enum CarrierError {
    /// The network.
    Network(NetworkError),
    /// The serial port.
    Serial(serial::Error),
}

impl fmt::Display for CarrierError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Network(error) => error.fmt(f),
            Self::Serial(error) => error.fmt(f),
        }
    }
}

impl Error for CarrierError {}

impl CarrierError {
    /// Returns the remedy, where one is known.
    #[must_use]
    pub fn hint(&self) -> Option<String> {
        match self {
            Self::Network(error) => error.hint(),
            Self::Serial(error) => error.hint(),
        }
    }
}

impl Carrier {
    /// Lets this bell end a step early whenever it rings.
    pub(crate) fn set_bell(&mut self, bell: Bell) {
        match self {
            Self::Packet(medium) => medium.set_bell(bell),
            Self::Udp(medium) => medium.set_bell(bell),
            Self::Serial(line) => line.set_bell(bell),
        }
    }
}

impl Wire for Carrier {
    type Error = CarrierError;

    fn now(&self) -> Instant {
        match self {
            Self::Packet(medium) => Medium::now(medium.as_ref()),
            Self::Udp(medium) => Medium::now(medium.as_ref()),
            Self::Serial(_) => network::system::now(),
        }
    }

    fn step(&mut self, engine: &mut Engine, until: Instant) -> Result<(), CarrierError> {
        match self {
            Self::Packet(medium) => {
                Medium::step(medium.as_mut(), engine, until).map_err(CarrierError::Network)
            }
            Self::Udp(medium) => Medium::step(medium.as_mut(), engine, until).map_err(CarrierError::Network),
            Self::Serial(line) => line
                .step(&mut Speaker(engine), until)
                .map_err(CarrierError::Serial),
        }
    }
}

/// An engine at a serial line.
struct Speaker<'a>(&'a mut Engine);

impl Talker for Speaker<'_> {
    fn handle_octets(&mut self, now: Instant, octets: &[u8]) {
        self.0.handle_octets(now, octets);
    }

    fn handle_timeout(&mut self, now: Instant) {
        self.0.handle_line_timeout(now);
    }

    fn poll_transmit(&mut self, now: Instant, buffer: &mut [u8]) -> Option<usize> {
        self.0.poll_octets(now, buffer)
    }

    fn poll_timeout(&self) -> Option<Instant> {
        self.0.poll_line_timeout()
    }
}

/// Speed and parity as the port takes them.
#[must_use]
pub const fn serial_settings(baud: u32, parity: Parity) -> Settings {
    Settings {
        baud,
        parity: match parity {
            Parity::Even => serial::Parity::Even,
            Parity::Odd => serial::Parity::Odd,
            Parity::None => serial::Parity::None,
        },
    }
}

//! Raw Ethernet where there is none: the same types, which cannot be opened, so that whoever uses them needs no second version.

use std::io;
use std::time::Duration;

use profinet::{Endpoint, Instant, Medium};

use super::{Captured, Lateness, PacketStatistics, Turn};
use crate::host::{Station, StationId};
use crate::segment::Tap;
use crate::system::{Bell, Error, InterfaceInfo, ServerPort, Stop};

/// There is no value of this type.
#[derive(Debug)]
enum Never {}

/// Carries an endpoint on an Ethernet interface; cannot be opened here.
#[derive(Debug)]
pub struct PacketMedium(Never);

impl PacketMedium {
    /// Opens an interface.
    ///
    /// # Errors
    /// [`Error::NoRawEthernet`], always.
    pub fn open(_interface: &str, _server: ServerPort) -> Result<Self, Error> {
        Err(Error::NoRawEthernet)
    }

    /// Opens an interface for a controller of many devices.
    ///
    /// # Errors
    /// [`Error::NoRawEthernet`], always.
    pub fn open_for(_interface: &str, _server: ServerPort, _devices: usize) -> Result<Self, Error> {
        Err(Error::NoRawEthernet)
    }

    /// Returns the interface.
    #[must_use]
    pub fn interface(&self) -> &InterfaceInfo {
        match self.0 {}
    }

    /// Returns the counters of the raw socket.
    #[must_use]
    pub fn statistics(&mut self) -> PacketStatistics {
        match self.0 {}
    }

    /// Datagrams that were not sent.
    #[must_use]
    pub fn unsent_datagrams(&self) -> u64 {
        match self.0 {}
    }

    /// Returns whether devices can call their controller here.
    #[must_use]
    pub fn receives_calls(&self) -> bool {
        match self.0 {}
    }

    /// Lets this flag end a step early.
    pub fn set_stop(&mut self, _stop: Stop) {
        match self.0 {}
    }

    /// Lets this bell end a step early.
    pub fn set_bell(&mut self, _bell: Bell) {
        match self.0 {}
    }

    /// Lets `tap` see every PROFINET frame.
    pub fn add_tap(&mut self, _tap: Box<dyn Tap>) {
        match self.0 {}
    }

    /// Ends all taps.
    ///
    /// # Errors
    /// None.
    pub fn finish_taps(&mut self) -> io::Result<()> {
        match self.0 {}
    }
}

impl Medium for PacketMedium {
    type Error = Error;

    fn now(&self) -> Instant {
        match self.0 {}
    }

    fn step(&mut self, _endpoint: &mut dyn Endpoint, _until: Instant) -> Result<(), Error> {
        match self.0 {}
    }
}

/// Stations on an interface; cannot be opened here.
#[derive(Debug)]
pub struct Runner(Never);

impl Runner {
    /// Opens an interface.
    ///
    /// # Errors
    /// [`Error::NoRawEthernet`], always.
    pub fn open(_interface: &str) -> Result<Self, Error> {
        Err(Error::NoRawEthernet)
    }

    /// Opens an interface for many stations.
    ///
    /// # Errors
    /// [`Error::NoRawEthernet`], always.
    pub fn open_for(_interface: &str, _stations: usize) -> Result<Self, Error> {
        Err(Error::NoRawEthernet)
    }

    /// Opens the interface once more.
    ///
    /// # Errors
    /// None.
    pub fn reopen(&mut self) -> Result<(), Error> {
        match self.0 {}
    }

    /// Returns the interface.
    #[must_use]
    pub fn interface(&self) -> &InterfaceInfo {
        match self.0 {}
    }

    /// Returns how late it did what was due.
    #[must_use]
    pub const fn lateness(&self) -> Lateness {
        match self.0 {}
    }

    /// Returns the counters of the socket.
    #[must_use]
    pub fn statistics(&mut self) -> PacketStatistics {
        match self.0 {}
    }

    /// Adds a station.
    ///
    /// # Errors
    /// None.
    pub fn attach(&mut self, _station: Box<dyn Station>) -> Result<StationId, Error> {
        match self.0 {}
    }

    /// Takes a station away.
    pub fn detach(&mut self, _id: StationId) -> Option<Box<dyn Station>> {
        match self.0 {}
    }

    /// Returns the station in its own type.
    #[must_use]
    pub fn station<T: Station>(&self, _id: StationId) -> Option<&T> {
        match self.0 {}
    }

    /// Returns the station in its own type.
    #[must_use]
    pub fn station_mut<T: Station>(&mut self, _id: StationId) -> Option<&mut T> {
        match self.0 {}
    }

    /// Returns the stations that handled something.
    #[must_use]
    pub fn touched(&self) -> &[StationId] {
        match self.0 {}
    }

    /// Lets this flag end a step early.
    ///
    /// # Errors
    /// None.
    pub fn set_stop(&mut self, _stop: Stop) -> Result<(), Error> {
        match self.0 {}
    }

    /// Lets this bell end a step.
    ///
    /// # Errors
    /// None.
    pub fn set_bell(&mut self, _bell: Bell) -> Result<(), Error> {
        match self.0 {}
    }

    /// Lets `tap` see every frame.
    pub fn add_tap(&mut self, _tap: Box<dyn Tap>) {
        match self.0 {}
    }

    /// Ends all taps.
    ///
    /// # Errors
    /// None.
    pub fn finish_taps(&mut self) -> io::Result<()> {
        match self.0 {}
    }

    /// Works until something happened.
    ///
    /// # Errors
    /// None.
    pub fn step(&mut self, _until: Instant) -> Result<Turn, Error> {
        match self.0 {}
    }
}

/// Every frame on an interface; cannot be opened here.
#[derive(Debug)]
pub struct Capture(Never);

impl Capture {
    /// Opens an interface.
    ///
    /// # Errors
    /// [`Error::NoRawEthernet`], always.
    pub fn open(_interface: &str, _stop: Stop) -> Result<Self, Error> {
        Err(Error::NoRawEthernet)
    }

    /// Returns the next frame.
    ///
    /// # Errors
    /// None.
    pub fn next(&mut self, _timeout: Duration) -> Result<Option<Captured<'_>>, Error> {
        match self.0 {}
    }

    /// Frames lost because they were not read in time.
    #[must_use]
    pub fn missed(&mut self) -> u64 {
        match self.0 {}
    }
}

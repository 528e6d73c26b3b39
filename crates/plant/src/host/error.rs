//! Why a simulation cannot start or go on.

use std::io;
use std::path::PathBuf;

use network::files::StateFileError;
use network::system::LockError;
use profinet::controller::Misuse;

use super::fleet::FleetError;
use crate::plan::WorldError;

/// Why a simulation cannot start or go on.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum HostError {
    /// The network interface.
    #[error(transparent)]
    Network(#[from] network::system::Error),
    /// The serial port.
    #[error(transparent)]
    Serial(#[from] network::serial::Error),
    /// There can be no such drives.
    #[error(transparent)]
    Fleet(#[from] FleetError),
    /// The drives need more memory than is free.
    #[error("{wanted} drives need about {} MB of memory and {} MB are free: {fit} drives would fit", megabytes(*needed), megabytes(*free))]
    Memory {
        /// Drives there are to be.
        wanted: usize,
        /// Octets that they need.
        needed: u64,
        /// Octets that are free.
        free: u64,
        /// Drives there is room for.
        fit: u64,
    },
    /// No drive can have this address on a serial line.
    #[error("no drive can have the address {number}: {lowest} to {highest} are possible")]
    LineAddress {
        /// The address.
        number: u16,
        /// The lowest of the protocol.
        lowest: u8,
        /// The highest of the protocol.
        highest: u8,
    },
    /// A station on the segment has the MAC address of a drive.
    #[error("the MAC address of {drive} is in use on this segment: {other}")]
    MacInUse {
        /// Name of the drive in this simulation.
        drive: String,
        /// The other station in words.
        other: String,
    },
    /// The state folder is in use, or cannot be used.
    #[error("{0}")]
    StateFolder(LockError),
    /// A file of the state folder cannot be read or written.
    #[error(transparent)]
    StateFile(#[from] StateFileError),
    /// A drive cannot be set up.
    #[error(transparent)]
    Drive(#[from] WorldError),
    /// The segment cannot be searched.
    #[error(transparent)]
    Search(#[from] Misuse),
    /// The operating system has no event to wait for.
    #[error("cannot wait for requests: {0}")]
    Bell(io::Error),
    /// The capture file cannot be made.
    #[error(transparent)]
    CreateCapture(StateFileError),
    /// The capture file cannot be written.
    #[error("cannot write {}: {source}", path.display())]
    WriteCapture {
        /// The file.
        path: PathBuf,
        /// Why.
        source: io::Error,
    },
    /// The end of the capture file was not written.
    #[error("the capture is not complete: {0}")]
    IncompleteCapture(io::Error),
}

const fn megabytes(octets: u64) -> u64 {
    octets / 1_000_000
}

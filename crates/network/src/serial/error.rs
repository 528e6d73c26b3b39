//! What can be wrong with a serial port, in words for people.

use std::io;

/// Why a serial port cannot be used (on).
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// There is no such port.
    #[error("there is no serial port {port}")]
    NoSuchPort {
        /// As it was named.
        port: String,
        /// Ports there are.
        existing: Vec<String>,
    },
    /// The program may not open it.
    #[error("not allowed to open the serial port {port}")]
    NoPermission {
        /// The port.
        port: String,
    },
    /// Another program has it.
    #[error("the serial port {port} is in use by {}", by(holders))]
    Busy {
        /// The port.
        port: String,
        /// The other processes, as far as the system shows them.
        holders: Vec<Holder>,
    },
    /// It is something else than a serial port.
    #[error("{port} is not a serial port")]
    NotSerial {
        /// The file.
        port: String,
    },
    /// The port has no such speed.
    #[error("the serial port {port} does not take these settings: {reason}")]
    Settings {
        /// The port.
        port: String,
        /// Error text of the operating system.
        reason: String,
    },
    /// It no longer exists: unplugged.
    #[error("the serial port {port} went away")]
    Gone {
        /// The port.
        port: String,
    },
    /// It takes no more octets.
    #[error("the serial port {port} does not send")]
    Stuck {
        /// The port.
        port: String,
    },
    /// Anything else the operating system refuses.
    #[error("serial port {port}: {source}")]
    System {
        /// The port.
        port: String,
        /// Why it failed.
        source: io::Error,
    },
}

/// A process that has a port open.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Holder {
    /// Number of the process.
    pub number: u32,
    /// Name of its program.
    pub program: String,
}

/// `process 4711 (profidrive)`
fn by(holders: &[Holder]) -> String {
    let each = holders
        .iter()
        .map(|Holder { number, program }| format!("process {number} ({program})"));
    let all: Vec<String> = each.collect();
    if all.is_empty() {
        "another program".to_owned()
    } else {
        all.join(" and ")
    }
}

impl Error {
    /// Returns the remedy, where one is known.
    #[must_use]
    pub fn hint(&self) -> Option<String> {
        match self {
            Self::NoSuchPort { existing, .. } if existing.is_empty() => {
                Some("there is none; is the adapter plugged?".to_owned())
            }
            Self::NoSuchPort { existing, .. } => Some(format!("there are: {}", existing.join(", "))),
            Self::NoPermission { .. } => Some(
                "the group of the port is usually dialout: sudo usermod -a -G dialout $USER, then log in again".to_owned(),
            ),
            Self::Busy { holders, .. } if !holders.is_empty() => {
                let numbers: Vec<String> = holders.iter().map(|holder| holder.number.to_string()).collect();
                let numbers = numbers.join(" ");
                Some(format!(
                    "one program at a time has a line: end that process: kill {numbers}; kill -KILL {numbers} where it does not end"
                ))
            }
            Self::Busy { port, .. } => Some(format!(
                "one program at a time has a line: find that process (as root: fuser -v {port}) and end it"
            )),
            Self::Gone { .. } => Some("plug the adapter in again".to_owned()),
            Self::Stuck { .. } => Some("the adapter hangs: unplug it and plug it in again".to_owned()),
            _ => None,
        }
    }
}

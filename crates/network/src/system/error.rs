//! What can be wrong with an interface or a socket, in words for people.

use std::io;
use std::net::Ipv4Addr;

/// Why the network cannot be used (on).
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// Raw sockets require a capability (CAP_NET_RAW) that the program does not have.
    #[error("not allowed to open a raw socket on `{interface}`")]
    NoPermission {
        /// The interface requested.
        interface: String,
    },
    /// This build of the library, or this system, has no raw Ethernet.
    #[error("no raw Ethernet in this program: it was not built for Linux with the feature raw-ethernet")]
    NoRawEthernet,
    /// There is no interface of this name.
    #[error("there is no network interface `{interface}`")]
    NoSuchInterface {
        /// The name requested.
        interface: String,
        /// The names there are.
        existing: Vec<String>,
    },
    /// The interface is there but switched off.
    #[error("network interface `{interface}` is down")]
    InterfaceDown {
        /// Its name.
        interface: String,
    },
    /// The interface no longer exists.
    #[error("network interface `{interface}` went away")]
    InterfaceGone {
        /// Its name.
        interface: String,
    },
    /// The interface has no Ethernet addresses.
    #[error("network interface `{interface}` is not an Ethernet interface")]
    NotEthernet {
        /// Its name.
        interface: String,
    },
    /// The interface has no IPv4 address to send datagrams from.
    #[error("network interface `{interface}` has no IPv4 address")]
    NoAddress {
        /// Its name.
        interface: String,
    },
    /// Another program receives on this port.
    #[error("UDP port {port} of {address} is in use by another program")]
    PortOccupied {
        /// The local address.
        address: Ipv4Addr,
        /// The port.
        port: u16,
    },
    /// The local address belongs to no interface.
    #[error("{address} is not an address of this computer")]
    NotOurAddress {
        /// The address requested.
        address: Ipv4Addr,
    },
    /// Anything else the operating system refuses.
    #[error("{action}: {source}")]
    System {
        /// What was tried.
        action: &'static str,
        /// Why it failed.
        source: io::Error,
    },
}

/// Returns the command that permits raw Ethernet to this program, and threads that run before others
/// ([`First`](super::First)).
#[must_use]
pub fn grant_raw_ethernet() -> String {
    let program = std::env::current_exe().map(|path| path.display().to_string());
    let program = program.unwrap_or_else(|_| "PROGRAM".to_owned());
    format!("sudo setcap cap_net_raw,cap_sys_nice+ep {program}")
}

impl Error {
    /// Returns the remedy, where one is known.
    #[must_use]
    pub fn hint(&self) -> Option<String> {
        match self {
            Self::NoPermission { .. } => Some(format!(
                "run as root, or grant the capability once: {}; without a real network: unshare -rn",
                grant_raw_ethernet()
            )),
            Self::NoRawEthernet => Some(
                "drives given by their IP address can be read, written and stopped; drives at serial lines need no network"
                    .to_owned(),
            ),
            Self::NoSuchInterface { existing, .. } if existing.is_empty() => {
                Some("there is no interface at all".to_owned())
            }
            Self::NoSuchInterface { existing, .. } => Some(format!("there are: {}", existing.join(", "))),
            Self::InterfaceDown { interface } => Some(format!("ip link set {interface} up")),
            Self::NoAddress { interface } => Some(format!(
                "give it one in the network of the drives: ip address add A.B.C.D/NN dev {interface}"
            )),
            Self::PortOccupied { port, .. } => Some(format!(
                "another controller or engineering tool is probably running; see: ss -ulpn sport = :{port}"
            )),
            _ => None,
        }
    }

    #[cfg(target_os = "linux")]
    pub(crate) fn system(action: &'static str) -> impl FnOnce(io::Error) -> Self {
        move |source| Self::System { action, source }
    }
}

//! What a server serves, and where.

use std::net::{IpAddr, Ipv4Addr, SocketAddr};
use std::path::PathBuf;

use profidrive::plant::{PlantError, PlantSource};
use profidrive::{Access, Opening, state_folder};

/// The plant of [`Source::Demo`].
const DEMO: &str = include_str!("../assets/demo.toml");

/// The port where none is given.
const PORT: u16 = 8934;

/// Where the drives of a server are. A server has one source, so that no screen mixes a simulation with a machine.
#[derive(Debug, Clone)]
pub enum Source {
    /// The virtual drives of the built-in plant, in memory.
    Demo,
    /// The virtual drives of a plant, in memory.
    Plant(Box<PlantSource>),
    /// The drives on a network interface.
    Interface(String),
    /// Drives by their addresses, for their parameters only.
    Addresses(Vec<Ipv4Addr>),
}

impl Source {
    /// Returns whether the drives are virtual.
    #[must_use]
    pub const fn is_simulation(&self) -> bool {
        matches!(self, Self::Demo | Self::Plant(_))
    }

    /// Returns its stable name: `demo`, `plant`, `interface` or `addresses`.
    #[must_use]
    pub const fn id(&self) -> &'static str {
        match self {
            Self::Demo => "demo",
            Self::Plant(_) => "plant",
            Self::Interface(_) => "interface",
            Self::Addresses(_) => "addresses",
        }
    }

    /// Returns the plant of virtual drives; `None` of real ones.
    pub(crate) fn plant(&self) -> Result<Option<PlantSource>, PlantError> {
        Ok(match self {
            Self::Demo => Some(DEMO.parse()?),
            Self::Plant(plant) => Some((**plant).clone()),
            Self::Interface(_) | Self::Addresses(_) => None,
        })
    }

    /// Returns how the network of these drives is opened.
    pub(crate) fn opening(&self) -> Result<Opening, PlantError> {
        let opening = Opening::new(Access::Records);
        Ok(match (self, self.plant()?) {
            (_, Some(plant)) => opening.in_plant(plant.plan().clone()).in_real_time(),
            (Self::Interface(name), None) => opening.on(name),
            _ => opening.by_ip(true),
        })
    }
}

/// What encrypts the connections of a server.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Certificate {
    /// A certificate that the server makes itself. Browsers warn of it until it is accepted.
    SelfSigned,
    /// A certificate with those between it and a known authority, and its key, as files of PEM.
    Files {
        /// The certificates.
        certificate: PathBuf,
        /// The key.
        key: PathBuf,
    },
}

/// How a server is started.
#[derive(Debug, Clone)]
pub struct Settings {
    /// Where its drives are.
    pub source: Source,
    /// The address and port to listen on; port 0 takes a free one.
    pub listen: SocketAddr,
    /// What encrypts connections. Without it the server is for this computer alone.
    pub tls: Option<Certificate>,
    /// The address that leads here from elsewhere, by a proxy or another name: `https://line3.example`.
    pub public_url: Option<String>,
    /// Whether pages on other computers may control axes too. Whoever moves a machine has to see it.
    pub moves_remotely: bool,
    /// What people call this server: `line 3`.
    pub name: Option<String>,
    /// Whether no address of this server allows more than to look and to stop.
    pub read_only: bool,
    /// The folder with the log of what people did; `None` where there is none, and then nothing is changed.
    pub log: Option<PathBuf>,
}

impl Settings {
    /// Returns the settings of a server on its usual port of this computer.
    #[must_use]
    pub fn new(source: Source) -> Self {
        Self {
            source,
            listen: SocketAddr::new(IpAddr::V4(Ipv4Addr::LOCALHOST), PORT),
            tls: None,
            public_url: None,
            moves_remotely: false,
            name: None,
            read_only: false,
            log: state_folder().map(|folder| folder.join("workbench")),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_plant_of_the_demo_is_valid() {
        let plant: PlantSource = DEMO.parse().unwrap();
        let plan = plant.plan();
        assert_eq!((plan.seed, plan.drives.len(), plan.controllers.len()), (7, 6, 1));
    }
}

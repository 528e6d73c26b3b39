//! Services of stations, drives or not: discovery, name, address, signal, reset.

use std::net::Ipv4Addr;
use std::time::Duration;

use clap::{Args, ValueEnum};

use super::duration;

#[derive(Debug, Args)]
pub struct Scan {
    /// How long to listen for answers
    #[arg(long = "for", value_name = "TIME", default_value = "1s", value_parser = duration)]
    pub time: Duration,
    /// Only what discovery reports; firmware, serial number, state, controller and neighbours are not read
    #[arg(long)]
    pub quick: bool,
    /// Print all that is known as CSV, with a line of headings
    #[arg(long, conflicts_with = "watch")]
    pub csv: bool,
    /// Go on until Ctrl-C, and print who comes, goes or changes its name or address
    #[arg(long, conflicts_with = "quick")]
    pub watch: bool,
}

#[derive(Debug, Args)]
pub struct Name {
    /// The station, best by its MAC address
    pub drive: String,
    /// The new name: lower case letters, digits, hyphens and dots; "" takes the name away
    pub name: String,
    /// Keep it only until the next power-on; after it the drive has no name at all
    #[arg(long)]
    pub temporary: bool,
    /// Also when a controller is running the drive: its axis then loses the controller
    #[arg(long)]
    pub force: bool,
    /// Check and show, but change nothing
    #[arg(long)]
    pub dry_run: bool,
}

#[derive(Debug, Args)]
pub struct Ip {
    /// Station name, IP address or MAC address
    pub drive: String,
    /// Address and prefix length, for example 10.0.0.2/24
    pub address: Network,
    /// Gateway; none when left out
    #[arg(long, value_name = "A.B.C.D")]
    pub gateway: Option<Ipv4Addr>,
    /// Keep it only until the next power-on; after it the drive has no address at all
    #[arg(long)]
    pub temporary: bool,
    /// Also when a controller is running the drive: its axis then loses the controller
    #[arg(long)]
    pub force: bool,
    /// Check and show, but change nothing
    #[arg(long)]
    pub dry_run: bool,
}

#[derive(Debug, Args)]
pub struct Blink {
    /// Station name, IP address or MAC address
    pub drive: String,
    /// How long to repeat the signal (one signal lasts about 3 s)
    #[arg(long = "for", value_name = "TIME", default_value = "3s", value_parser = duration)]
    pub time: Duration,
}

#[derive(Debug, Args)]
pub struct Reset {
    /// Station name, IP address or MAC address
    pub drive: String,
    /// What to reset
    #[arg(long, value_enum)]
    pub mode: ResetMode,
    /// Do not ask
    #[arg(long)]
    pub yes: bool,
    /// Also when the axis turns, the power stage is on or a controller is connected: a motor that turns then coasts
    #[arg(long)]
    pub force: bool,
}

/// What a reset takes back to factory values (DCP ResetToFactory).
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum ResetMode {
    /// Application data: parameters, I&M records
    Application,
    /// Communication data: name, IP address
    Communication,
    /// Engineering data
    Engineering,
    /// All stored data
    All,
    /// The device as it left the factory
    Device,
}

/// An IPv4 address with its prefix length.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Network {
    /// Address.
    pub address: Ipv4Addr,
    /// Length of the network part in bits, 1 to 32.
    pub prefix: u8,
}

impl Network {
    /// Returns the subnet mask.
    pub const fn mask(self) -> Ipv4Addr {
        Ipv4Addr::from_bits(match self.prefix {
            0 => 0,
            prefix => u32::MAX << (32 - prefix as u32),
        })
    }
}

impl std::str::FromStr for Network {
    type Err = String;
    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let form = || format!("`{text}`: write address and prefix length, for example 10.0.0.2/24");
        let (address, prefix) = text.split_once('/').ok_or_else(form)?;
        let address: Ipv4Addr = address.parse().map_err(|_| form())?;
        let prefix: u8 = prefix
            .parse()
            .ok()
            .filter(|prefix| (1..=32).contains(prefix))
            .ok_or_else(form)?;
        if address.is_unspecified()
            || address.is_multicast()
            || address.is_loopback()
            || address.is_broadcast()
        {
            return Err(format!("`{text}`: not a valid address of a station"));
        }
        Ok(Self { address, prefix })
    }
}

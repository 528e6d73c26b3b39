//! Virtual drives: on a network, and the demonstration.

use std::net::SocketAddr;
use std::path::PathBuf;
use std::time::Duration;

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use clap::{Args, ValueEnum};
use client::Parity;
use virtual_drive::model::{self, Model};

use super::{Network, duration};

// Where an option needs another one, the parser forgets so as soon as what was given excludes that other one: each of them excludes
// the same by itself, or it would be ignored without a word.

/// What describes drives without a plant file.
const OF_A_FLEET: [&str; 8] = [
    "name",
    "count",
    "ip",
    "mac",
    "model",
    "min_cycle",
    "rotary",
    "serial",
];
/// What no slave of a serial line has.
const OF_A_NETWORK: [&str; 7] = ["plant", "virtual_time", "gsdml", "ip", "mac", "min_cycle", "pcap"];

#[derive(Debug, Args)]
pub struct Simulate {
    /// Plant file: drives, what happens to them and when; instead of the options that describe drives
    #[arg(value_name = "PLANT.toml", conflicts_with_all = OF_A_FLEET)]
    pub plant: Option<PathBuf>,
    /// Runs the plant in virtual time, as fast as possible, without a network; the trace goes to stdout
    #[arg(long, requires = "plant", conflicts_with = "state", conflicts_with_all = OF_A_FLEET)]
    pub virtual_time: bool,
    /// File with expectations of the drives; a lost expectation ends with exit code 5. In virtual time it is beside those of
    /// the plant file. On an interface times count from the first connection of a controller
    #[arg(long, value_name = "FILE", requires = "plant", conflicts_with_all = OF_A_FLEET)]
    pub expect: Option<PathBuf>,
    /// Write the results of the expectations to this file, as a JUnit report
    #[arg(long, value_name = "FILE", requires = "plant", conflicts_with_all = OF_A_FLEET)]
    pub junit: Option<PathBuf>,
    /// Write the events to this file, a JSON document a line
    #[arg(long, value_name = "FILE", requires = "virtual_time", conflicts_with = "state", conflicts_with_all = OF_A_FLEET)]
    pub trace: Option<PathBuf>,
    /// Ends after this time; else the `duration` of the plant file, or Ctrl-C
    #[arg(long = "for", value_name = "TIME", value_parser = duration)]
    pub time: Option<Duration>,
    /// Drive model; default: that of the vendor of the given device description, else akd
    #[arg(long, value_parser = simulated(), value_name = "MODEL")]
    pub model: Option<&'static Model>,
    /// Device description (GSDML) of the vendor: source of identity, modules and ident numbers. In a plant it
    /// applies to this vendor's drives. A vendor without a built-in model requires --model for the behaviour of the
    /// drive. Not in virtual time, where the controllers of the plant use the modules of the model
    #[arg(long, value_name = "FILE", conflicts_with = "virtual_time")]
    pub gsdml: Option<PathBuf>,
    /// Only this access point of the device description; all of them when left out
    #[arg(long, value_name = "ID", requires = "gsdml", conflicts_with_all = ["virtual_time", "serial"])]
    pub access_point: Option<String>,
    /// Station name; with --count the names end in -1, -2, ..; without it the drive waits to be named
    #[arg(long, value_name = "NAME")]
    pub name: Option<String>,
    /// How many drives
    #[arg(long, default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..))]
    pub count: u32,
    /// Address of the (first) drive; without it the drive waits for its address
    #[arg(long, value_name = "A.B.C.D/NN")]
    pub ip: Option<Network>,
    /// Rotary switches of the AKD, 0 to 99: address 192.168.0.NUMBER/24; with 0 the drive finds one by DHCP, else AutoIP.
    /// An address set by DCP overrules them
    #[arg(long, value_name = "NUMBER", conflicts_with = "ip", value_parser = clap::value_parser!(u8).range(0..=99))]
    pub rotary: Option<u8>,
    /// Folder that keeps name, address and saved parameters over a restart
    #[arg(long, value_name = "DIR")]
    pub state: Option<PathBuf>,
    /// Whether a drive takes another name or a reset by DCP while its motor runs under a controller, which ends the
    /// connection
    #[arg(long, value_enum, value_name = "refuse|accept", default_value = "refuse")]
    pub dcp_in_operation: DcpInOperation,
    /// Ethernet address: derived from the name when left out, `host` for the interface's own (one drive only)
    #[arg(long, value_name = "host|MAC")]
    pub mac: Option<String>,
    /// Fastest update time offered: 1, 2, 4, 8 .. 512 ms; that of the drive (AKD: 16 ms) or of its device description
    /// when left out
    #[arg(long, value_name = "TIME", value_parser = duration)]
    pub min_cycle: Option<Duration>,
    /// Write the traffic of the drives to this file
    #[arg(long, value_name = "FILE")]
    pub pcap: Option<PathBuf>,
    /// Serve what the drives do to Prometheus, at http://ADDRESS:PORT/metrics
    #[arg(long, value_name = "ADDRESS:PORT", conflicts_with_all = ["virtual_time", "serial"])]
    pub metrics: Option<SocketAddr>,
    #[command(flatten)]
    pub line: SerialOptions,
}

/// What a drive does with DCP while it operates.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum DcpInOperation {
    /// Refuse name and reset
    Refuse,
    /// Accept them
    Accept,
}

/// Takes the name of a model that can be simulated.
pub fn simulated() -> impl TypedValueParser<Value = &'static Model> {
    let values = model::ALL
        .into_iter()
        .map(|model| PossibleValue::new(model.known.key).help(model.known.title));
    PossibleValuesParser::new(values).try_map(|name| model::by_name(&name).ok_or("no such model"))
}

#[derive(Debug, Args)]
pub struct Demo {
    /// Write the traffic of the in-memory network to this file
    #[arg(long, value_name = "FILE")]
    pub pcap: Option<PathBuf>,
    /// As fast as the machine allows, in virtual time
    #[arg(long)]
    pub fast: bool,
}

/// Drives at a serial line instead of a network.
#[derive(Debug, Args)]
pub struct SerialOptions {
    /// Serial port: the drives are slaves of a serial line instead of stations on a network
    #[arg(long, value_name = "PORT", conflicts_with_all = OF_A_NETWORK)]
    pub serial: Option<String>,
    /// Protocol of the line
    #[arg(long, value_enum, default_value = "fc", requires = "serial", conflicts_with_all = OF_A_NETWORK)]
    pub protocol: Protocol,
    /// Address of the (first) drive: 1 to 126, USS 0 to 31
    #[arg(long, value_name = "N", default_value_t = 1, requires = "serial", conflicts_with_all = OF_A_NETWORK)]
    pub address: u8,
    /// Bits per second
    #[arg(long, default_value_t = 9600, requires = "serial", conflicts_with_all = OF_A_NETWORK)]
    pub baud: u32,
    /// Parity
    #[arg(long, value_name = "even|odd|none", default_value = "even", value_parser = parity, requires = "serial",
        conflicts_with_all = OF_A_NETWORK)]
    pub parity: Parity,
}

/// Protocols of a serial line.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Protocol {
    /// Danfoss FC protocol
    Fc,
    /// USS
    Uss,
}

fn parity(text: &str) -> Result<Parity, &'static str> {
    let known = Parity::ALL.into_iter().find(|parity| parity.name() == text);
    known.ok_or("even, odd or none")
}

/// What to inject into which virtual drive.
#[derive(Debug, Args)]
pub struct Inject {
    /// Station name, IP address, MAC address, or fc:PORT/ADDRESS or uss:PORT/ADDRESS of a drive that `profidrive simulate` runs on this computer
    pub drive: Option<String>,
    /// What is to happen, in this order; without any: what can happen
    #[arg(value_name = "KEY=VALUE")]
    pub events: Vec<String>,
    /// Ends it again after this time
    #[arg(long = "for", value_name = "TIME", value_parser = duration)]
    pub lasts: Option<Duration>,
}

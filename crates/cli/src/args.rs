//! The command line: types and help texts only, no behaviour.

// help texts are printed as they stand: `947[0..7]` is no link
#![allow(rustdoc::broken_intra_doc_links)]

use std::ffi::OsString;
use std::net::Ipv4Addr;
use std::path::PathBuf;
use std::time::Duration;

use clap::{Args, CommandFactory, FromArgMatches, Parser, Subcommand, ValueEnum};
use profidrive::notation::Quantity;

use crate::commands::{
    Backup, Diff, Faults, Gsdml, Home, Inject, Jog, Move, Restore, Run, Status, Stop, Task,
};

/// PROFIdrive and PROFINET drives: find, address, read, write, run, simulate, explain.
#[derive(Debug, Parser)]
#[command(
    name = "profidrive",
    version,
    propagate_version = true,
    arg_required_else_help = true
)]
#[command(
    after_help = "DRIVE is a station name (akd-1), an IP address (10.0.0.2) or a MAC address.\n\
    PARAM is a name (DRV.ACC) or a number (930, p930, r947[0], 947[0..7], 0x3A2), as the maker writes it \
    (VLT: 1-20, Vacon: ID103).\n\
    Exit codes: 0 ok, 1 failed, 2 usage, 3 refused by the drive, 4 not reachable, 5 difference found, \
    6 stopped by a safety rule."
)]
pub struct Cli {
    #[command(flatten)]
    pub interface: Interface,
    #[command(flatten)]
    pub global: Global,
    #[command(subcommand)]
    pub command: Command,
}

impl Cli {
    /// The command line, or what is wrong with it.
    pub fn read<T: Into<OsString> + Clone>(line: impl IntoIterator<Item = T>) -> Result<Self, clap::Error> {
        let matches = with_signs(Self::command()).try_get_matches_from(line)?;
        Self::from_arg_matches(&matches)
    }
}

/// A time with a sign is told as a wrong time, not as an unknown option.
fn with_signs(command: clap::Command) -> clap::Command {
    let is_time = |argument: &clap::Arg| {
        let names = argument.get_value_names().unwrap_or_default();
        names.iter().any(|name| name.as_str() == "TIME")
    };
    command
        .mut_args(|argument| {
            if is_time(&argument) {
                argument.allow_hyphen_values(true)
            } else {
                argument
            }
        })
        .mut_subcommands(with_signs)
}

/// The network to use.
#[derive(Debug, Clone, Default, Args)]
pub struct Interface {
    /// Network interface towards the drives; else that of the variable PROFIDRIVE_INTERFACE, else the only one
    #[arg(short, long, value_name = "IFACE")]
    pub interface: Option<String>,
    /// What the drive is to be taken for, where the person said so
    #[arg(skip)]
    pub model: Option<drive_client::Model>,
}

/// What a drive is taken for.
#[derive(Debug, Clone, Default, Args)]
pub struct Kind {
    /// Takes the drive for an `akd`, `vlt` or `vacon` whatever it says it is, or by the profile alone: `standard`
    #[arg(long, value_name = "MODEL", value_parser = model)]
    pub model: Option<drive_client::Model>,
}

/// A command that speaks to a drive.
#[derive(Debug, Args)]
pub struct OnDrive<T: Args> {
    #[command(flatten)]
    pub args: T,
    #[command(flatten)]
    pub interface: Interface,
    #[command(flatten)]
    pub kind: Kind,
}

/// A command that uses the network.
#[derive(Debug, Args)]
pub struct OnNetwork<T: Args> {
    #[command(flatten)]
    pub args: T,
    #[command(flatten)]
    pub interface: Interface,
}

/// Options of every command.
#[derive(Debug, Clone, Args)]
pub struct Global {
    /// Print data as JSON ("schema": "profidrive/1")
    #[arg(long, global = true)]
    pub json: bool,
    /// Print data only, no talk
    #[arg(short, long, global = true)]
    pub quiet: bool,
}

#[derive(Debug, Subcommand)]
pub enum Command {
    /// List the stations that answer on the network; exit code 4 when there is none
    Scan(OnNetwork<Scan>),
    /// Give a station its name; `blink` first shows which one it is
    Name(OnNetwork<Name>),
    /// Give a station its IP address; `blink` first shows which one it is
    Ip(OnNetwork<Ip>),
    /// Let a station blink, to be sure which one it is
    Blink(OnNetwork<Blink>),
    /// Reset a station to factory values (asks first); `blink` first shows which one it is
    Reset(OnNetwork<Reset>),
    /// Show who a drive is and in which state
    Info(OnDrive<Drive>),
    /// Read parameters
    Read(OnDrive<Read>),
    /// Write parameters: limits first, then old and new value, then read back
    Write(OnDrive<Write>),
    /// List the parameters of a drive
    List(OnDrive<List>),
    /// Describe one parameter: unit, limits, default, access
    Describe(OnDrive<Describe>),
    /// Turn the motor at a speed for a time, then stop it (moves the axis)
    Run(OnDrive<Run>),
    /// Turn the motor at a jog speed for a time, then stop it (moves the axis)
    Jog(OnDrive<Jog>),
    /// Move the axis to a position or by a distance, then stop it (moves the axis)
    Move(OnDrive<Move>),
    /// Carry out a motion task of the drive's own table, then stop the axis (moves the axis)
    Task(OnDrive<Task>),
    /// Set the home position by the procedure the drive is set up for (moves the axis)
    Home(OnDrive<Home>),
    /// Stop a drive that somebody else commands: DRV.STOP, or DRV.DIS with --disable
    Stop(OnDrive<Stop>),
    /// Say in one sentence why a drive does not run; reads only (exit code 5 when something keeps it)
    Status(OnDrive<Status>),
    /// Acknowledge the fault of a drive (STW1 bit 7, as its controller for a moment)
    Ack(OnDrive<Ack>),
    /// Watch a drive beside its controller; reads only
    Monitor(OnDrive<Monitor>),
    /// Show the faults and warnings of a drive, what they mean and what to do
    Faults(OnDrive<Faults>),
    /// Save the settings of a drive as text, one parameter a line
    Backup(OnDrive<Backup>),
    /// Compare the settings of two files, two drives, or a file and a drive
    Diff(OnDrive<Diff>),
    /// Bring saved settings back: shows its plan, writes a way back first, reads back
    Restore(OnDrive<Restore>),
    /// Say in words what a number means
    Explain(Explain),
    /// Say in words what a parameter job or a capture file contains
    Decode(Decode),
    /// Device descriptions (GSDML): write that of a virtual drive, show one, check one
    Gsdml(Gsdml),
    /// Let something happen to a drive that `simulate` runs: a fault, a load, a pulled cable
    Inject(Inject),
    /// Put virtual drives on a network
    Simulate(OnNetwork<Simulate>),
    /// Run a virtual drive and a controller on an in-memory network
    Demo(Demo),
    /// Write the completion script of a shell
    Completions(Completions),
}

#[derive(Debug, Args)]
pub struct Drive {
    /// Station name, IP address, MAC address, or fc:PORT/ADDRESS or uss:PORT/ADDRESS
    pub drive: String,
}

#[derive(Debug, Args)]
pub struct Scan {
    /// How long to listen for answers
    #[arg(long = "for", value_name = "TIME", default_value = "1s", value_parser = duration)]
    pub time: Duration,
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
    /// Also when a controller is running the drive: its axis then loses the controller
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

#[derive(Debug, Args)]
pub struct Read {
    /// Station name, IP address, MAC address, or fc:PORT/ADDRESS or uss:PORT/ADDRESS
    pub drive: String,
    /// Parameters: DRV.ACC, 930, p930, r947[0], 947[0..7], 0x3A2; of a VLT 1-20, of a Vacon ID103
    #[arg(required = true, value_name = "PARAM")]
    pub parameters: Vec<String>,
    /// Also show the raw value in hexadecimal
    #[arg(long)]
    pub raw: bool,
}

#[derive(Debug, Args)]
pub struct Write {
    /// Station name, IP address, MAC address, or fc:PORT/ADDRESS or uss:PORT/ADDRESS
    pub drive: String,
    /// Assignments: DRV.ACC=5000rpm/s, 930=1, p930=0x0001; of a VLT 3-41=5s, of a Vacon ID103=5s
    #[arg(required = true, value_name = "PARAM=VALUE")]
    pub assignments: Vec<String>,
    /// Check and show, but write nothing
    #[arg(long)]
    pub dry_run: bool,
    /// Let the drive keep the values over a power cycle (AKD: DRV.NVSAVE saves all it has; VLT: these values)
    #[arg(long, conflicts_with = "dry_run")]
    pub save: bool,
}

#[derive(Debug, Args)]
pub struct List {
    /// Station name, IP address, MAC address, or fc:PORT/ADDRESS or uss:PORT/ADDRESS
    pub drive: String,
    /// Only parameters with this text in name, number or description
    #[arg(long, value_name = "TEXT")]
    pub filter: Option<String>,
    /// Read and show the values too
    #[arg(long)]
    pub values: bool,
    /// Also show the raw value in hexadecimal
    #[arg(long, requires = "values")]
    pub raw: bool,
}

#[derive(Debug, Args)]
pub struct Describe {
    /// Station name, IP address, MAC address, or fc:PORT/ADDRESS or uss:PORT/ADDRESS
    pub drive: String,
    /// Parameter: DRV.ACC, 930, p930, 0x3A2; of a VLT 1-20, of a Vacon ID103
    #[arg(value_name = "PARAM")]
    pub parameter: String,
}

#[derive(Debug, Args)]
pub struct Cyclic {
    /// Update time of the cyclic connection; the fastest the drive allows when left out
    #[arg(long, value_name = "TIME", value_parser = duration)]
    pub cycle: Option<Duration>,
    /// Update times without data after which both sides stop
    #[arg(long, value_name = "COUNT", default_value_t = 3, value_parser = clap::value_parser!(u16).range(1..=255))]
    pub watchdog: u16,
}

#[derive(Debug, Args)]
pub struct Ack {
    /// Station name, IP address, MAC address, or fc:PORT/ADDRESS or uss:PORT/ADDRESS
    pub drive: String,
    /// By a parameter (DRV.CLRFAULTS) instead of the control word: takes no control, works beside a controller
    #[arg(long, conflicts_with_all = ["cycle", "watchdog"])]
    pub by_parameter: bool,
    #[command(flatten)]
    pub cyclic: Cyclic,
}

#[derive(Debug, Args)]
pub struct Monitor {
    /// Station name, IP address, MAC address, or fc:PORT/ADDRESS or uss:PORT/ADDRESS
    pub drive: String,
    /// Parameters to watch besides the state
    #[arg(value_name = "PARAM")]
    pub parameters: Vec<String>,
    /// Time between two readings
    #[arg(long, value_name = "TIME", default_value = "500ms", value_parser = duration)]
    pub every: Duration,
    /// How long to watch; until Ctrl-C when left out
    #[arg(long = "for", value_name = "TIME", value_parser = duration)]
    pub time: Option<Duration>,
    /// Also show the raw value in hexadecimal
    #[arg(long)]
    pub raw: bool,
}

#[derive(Debug, Args)]
pub struct Explain {
    /// The number: 0x047F, 1151, 0b0000_0100_0111_1111, DE80B500
    #[arg(allow_negative_numbers = true)]
    pub value: String,
    /// What the number is
    #[arg(
        long = "as",
        value_enum,
        value_name = "stw1|zsw1|state|fault|error|format|pnio|ctw-fc|stw-fc|ctw-vlt|stw-vlt|ctw-vlt2800|stw-vlt2800|ctw-vacon|stw-vacon|pke|alarm-word|alarm-word2|warning-word|warning-word2"
    )]
    pub kind: What,
    #[command(flatten)]
    pub model: Kind,
}

/// What a number to explain is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum What {
    /// Control word 1
    Stw1,
    /// Status word 1
    Zsw1,
    /// State of the drive, from status word 1
    State,
    /// Fault number (PNU 947) of the model, an AKD where none is given
    Fault,
    /// Error number of a refused parameter
    Error,
    /// Format code of a parameter value
    Format,
    /// PNIO status: ErrorCode, ErrorDecode, ErrorCode1, ErrorCode2
    Pnio,
    /// Control word of a VLT with FC profile (8-10)
    CtwFc,
    /// Status word of a VLT with FC profile
    StwFc,
    /// Control word of a VLT with PROFIdrive profile
    CtwVlt,
    /// Status word of a VLT with PROFIdrive profile
    StwVlt,
    /// Control word of a VLT 2800 or FCD 300 with PROFIdrive profile
    CtwVlt2800,
    /// Status word of a VLT 2800 or FCD 300 with PROFIdrive profile
    StwVlt2800,
    /// Control word of a Vacon in telegrams 148 to 150
    CtwVacon,
    /// Status word of a Vacon in telegrams 148 to 150
    StwVacon,
    /// PKE of a parameter channel: request or reply, and parameter number
    Pke,
    /// Alarm word of a VLT (16-90)
    AlarmWord,
    /// Alarm word 2 of a VLT (16-91)
    AlarmWord2,
    /// Warning word of a VLT (16-92)
    WarningWord,
    /// Warning word 2 of a VLT (16-93)
    WarningWord2,
}

#[derive(Debug, Args)]
pub struct Decode {
    /// Capture file, pcap or pcapng
    #[arg(value_name = "FILE", required_unless_present = "hex", conflicts_with = "hex")]
    pub file: Option<PathBuf>,
    /// Octets in hexadecimal: a parameter job, or what --as or --telegram says
    #[arg(long, value_name = "BYTES")]
    pub hex: Option<String>,
    /// What the octets are; without it the side of a parameter job is guessed
    #[arg(long = "as", value_enum, value_name = "WHAT", requires = "hex")]
    pub octets: Option<Octets>,
    /// The octets are cyclic data of this telegram: 1, 9 .., 101 to 108 (PPO types 1 to 8 of a VLT), 148 to 150 (Vacon)
    #[arg(long, value_name = "NUMBER", requires = "hex", conflicts_with_all = ["octets", "request"])]
    pub telegram: Option<u16>,
    /// Who sent it, for words and telegrams that look the same from both; without it both are told
    #[arg(long, value_enum, value_name = "WHO", requires = "hex")]
    pub from: Option<Sender>,
    /// The request that belongs to a response, in hexadecimal
    #[arg(long, value_name = "BYTES", requires = "hex")]
    pub request: Option<String>,
    #[command(flatten)]
    pub model: Kind,
}

/// What octets can be.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Octets {
    /// Parameter job from the controller to the drive
    Request,
    /// Parameter job from the drive to the controller
    Response,
    /// The eight octets of the parameter channel in a PPO
    Pkw,
    /// The same in the Danfoss FC protocol, where the index stands elsewhere
    PkwFc,
    /// The same in USS
    PkwUss,
    /// Telegram of the Danfoss FC protocol
    Fc,
    /// USS telegram
    Uss,
}

/// Direction of a parameter job.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Side {
    /// From the controller to the drive
    Request,
    /// From the drive to the controller
    Response,
}

/// Who sends.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Sender {
    /// Controller or master
    Controller,
    /// Drive or slave
    Drive,
}

#[derive(Debug, Args)]
pub struct Simulate {
    /// Scenario file: drives, what happens to them and when; instead of the options that describe drives
    #[arg(value_name = "PLANT.toml", conflicts_with_all = ["name", "count", "ip", "mac", "model", "min_cycle"])]
    pub plant: Option<PathBuf>,
    /// Plays the scenario in virtual time, as fast as possible, without a network; the trace goes to stdout
    #[arg(long, requires = "plant", conflicts_with = "state")]
    pub virtual_time: bool,
    /// Ends after this time; else the `duration` of the scenario, or Ctrl-C
    #[arg(long = "for", value_name = "TIME", value_parser = duration)]
    pub time: Option<Duration>,
    /// Drive model
    #[arg(long, value_enum, default_value = "akd")]
    pub model: Model,
    /// Device description (GSDML) of the maker: identity, modules and ident numbers are taken from it; not in virtual
    /// time, where the controllers of the scenario know the model's own
    #[arg(long, value_name = "FILE", conflicts_with = "virtual_time")]
    pub gsdml: Option<PathBuf>,
    /// Only this access point of the device description; all of them when left out
    #[arg(long, value_name = "ID", requires = "gsdml")]
    pub access_point: Option<String>,
    /// Station name; with --count the names end in -1, -2, ..; without it the drive waits to be named
    #[arg(long, value_name = "NAME")]
    pub name: Option<String>,
    /// How many drives
    #[arg(long, default_value_t = 1, value_parser = clap::value_parser!(u16).range(1..=256))]
    pub count: u16,
    /// Address of the (first) drive; without it the drive waits for its address
    #[arg(long, value_name = "A.B.C.D/NN")]
    pub ip: Option<Network>,
    /// Folder that keeps name, address and saved parameters over a restart
    #[arg(long, value_name = "DIR")]
    pub state: Option<PathBuf>,
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
    #[command(flatten)]
    pub line: crate::commands::SerialOptions,
}

/// The drive models there are.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Model {
    /// Kollmorgen AKD
    Akd,
    /// Danfoss VLT FC 302
    Vlt,
    /// Vacon 100
    Vacon,
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

#[derive(Debug, Args)]
pub struct Completions {
    /// The shell
    pub shell: clap_complete::Shell,
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
    /// The subnet mask.
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
            return Err(format!("`{text}`: this is no address for a station"));
        }
        Ok(Self { address, prefix })
    }
}

/// A model by the name that a person gives it.
fn model(text: &str) -> Result<drive_client::Model, String> {
    drive_client::Model::by_name(text)
        .ok_or_else(|| format!("there are {}", drive_client::Model::NAMES.join(", ")))
}

/// A time with its unit (`5s`, `16ms`, `2min`); a bare number is in seconds.
pub(crate) fn duration(text: &str) -> Result<Duration, String> {
    let quantity: Quantity = text.parse().map_err(|error| format!("{error}"))?;
    let seconds = quantity.in_unit("s").map_err(|error| error.to_string())?;
    if seconds < 0.0 {
        return Err("a time is 0 or longer".into());
    }
    Duration::try_from_secs_f64(seconds).map_err(|_| format!("`{text}` is no time"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_argument_tree_is_consistent() {
        Cli::command().debug_assert();
    }

    #[test]
    fn networks_and_times() {
        let network: Network = "10.0.0.2/24".parse().unwrap();
        assert_eq!(network.mask(), Ipv4Addr::new(255, 255, 255, 0));
        for wrong in [
            "10.0.0.2",
            "10.0.0.2/33",
            "10.0.0.2/0",
            "0.0.0.0/8",
            "224.0.0.1/4",
            "x/24",
        ] {
            assert!(wrong.parse::<Network>().is_err(), "{wrong}");
        }
        assert_eq!(duration("16ms"), Ok(Duration::from_millis(16)));
        assert_eq!(duration("2"), Ok(Duration::from_secs(2)));
        assert!(duration("5rpm").unwrap_err().contains("accepted: s, ms"));
        assert_eq!(duration("-1s"), Err("a time is 0 or longer".into()));
        for line in [
            "profidrive run akd-1 --velocity 60rpm --for -1s",
            "profidrive monitor akd-1 --every -1s",
            "profidrive simulate --for -1s",
        ] {
            let told = Cli::read(line.split(' ')).unwrap_err().to_string();
            assert!(
                told.contains("a time is 0 or longer") && !told.contains("tip:"),
                "{told}"
            );
        }
    }

    #[test]
    fn verbs_take_what_the_manual_says() {
        for line in [
            "profidrive scan -i eth0",
            "profidrive name 02:00:00:00:00:01 akd-1",
            "profidrive ip akd-1 10.0.0.2/24 --gateway 10.0.0.1 --temporary",
            "profidrive reset akd-1 --mode communication --yes",
            "profidrive read akd-1 DRV.ACC p930 r947[0..7] --json",
            "profidrive write akd-1 DRV.ACC=5000rpm/s --dry-run",
            "profidrive run akd-1 --velocity -60rpm --for 5s --cycle 16ms",
            "profidrive move akd-1 --to -10rev --velocity 300rpm --acceleration 3000rpm/s",
            "profidrive move akd-1 --to 655360 --relative --velocity 300 --dry-run --set-mode --timeout 5s",
            "profidrive home akd-1 --timeout 2min",
            "profidrive task akd-1 128 --cycle 4ms",
            "profidrive stop akd-1 --disable",
            "profidrive status akd-1 --short --json",
            "profidrive explain 0x047F --as stw1",
            "profidrive decode trace.pcapng",
            "profidrive decode trace.pcapng --model vlt",
            "profidrive decode --hex 15FA000100000000 --as pkw-fc --model vlt --from controller",
            "profidrive decode --hex 0206 --as fc",
            "profidrive decode --hex 047F0000 --telegram 148 --model vacon",
            "profidrive explain 0x047C --as ctw-fc",
            "profidrive explain 0x40 --as alarm-word2",
            "profidrive read vlt-1 1-20 p120 15-30[1] --model vlt",
            "profidrive write vacon-1 ID103=5s 104=5s --save --model Vacon -i v0",
            "profidrive explain 13 --as fault --model vlt",
            "profidrive simulate --model akd --name akd-1 -i v0 --count 4 --ip 10.0.0.2/24 --mac host",
            "profidrive simulate --gsdml GSDML-V2.3-Maker-Drive-20200101.xml --access-point DAP_1",
            "profidrive gsdml export --model akd -o folder",
            "profidrive gsdml show file.xml --texts --language de",
            "profidrive gsdml check file.xml --json",
            "profidrive simulate plant.toml --virtual-time --for 1h",
            "profidrive simulate plant.toml -i v0 --state folder",
            "profidrive inject akd-1 fault=439 limit+=on --for 2s",
            "profidrive inject",
            "profidrive demo --pcap out.pcapng",
        ] {
            assert!(Cli::try_parse_from(line.split(' ')).is_ok(), "{line}");
        }
        assert!(Cli::try_parse_from(["profidrive", "decode"]).is_err());
        for line in ["task akd-1 0", "task akd-1 129", "move akd-1 --to 5rev"] {
            let line = format!("profidrive {line}");
            assert!(Cli::try_parse_from(line.split(' ')).is_err(), "{line}");
        }
        assert!(Cli::try_parse_from("profidrive read d 930 --model toy".split(' ')).is_err());
        assert!(Cli::try_parse_from("profidrive -i eth0 scan".split(' ')).is_ok());
        for line in ["decode f", "explain 1 --as stw1", "demo", "completions bash"] {
            let line = format!("profidrive {line} -i eth0");
            assert!(Cli::try_parse_from(line.split(' ')).is_err(), "{line}");
        }
        assert!(Cli::try_parse_from(["profidrive", "decode", "f", "--hex", "00"]).is_err());
    }
}

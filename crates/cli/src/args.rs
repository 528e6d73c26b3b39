//! The command line: types and help texts only, no behaviour.

// help texts are printed as they stand: `947[0..7]` is not a link
#![allow(rustdoc::broken_intra_doc_links)]

mod doctor;
mod drives;
mod examples;
mod explain;
mod gsdml;
mod machine;
mod motion;
mod parameters;
mod record;
#[cfg(feature = "serve")]
mod serve;
mod simulate;
mod stations;

use std::ffi::OsString;
use std::path::PathBuf;
use std::time::Duration;

use clap::builder::{PossibleValue, StyledStr};
use clap::error::{ContextKind, ContextValue, ErrorKind};
use clap::{ArgMatches, Args, CommandFactory, FromArgMatches, Parser, Subcommand};
use profile::notation::Quantity;

pub use doctor::{Bundle, Doctor, Report};
pub use drives::{Backup, Diff, Faults, Restore, Status};
pub use explain::{Decode, Explain, Octets, Only, Sender};
pub use gsdml::{Gsdml, GsdmlCheck, GsdmlCommand, GsdmlExport, GsdmlShow};
pub use machine::{Commission, Replace};
pub use motion::{Ack, Cyclic, Enabling, Home, InMode, Jog, Move, Run, Stop, Task};
pub use parameters::{Describe, List, Read, Write};
pub use record::{Every, Record, Step};
#[cfg(feature = "serve")]
pub use serve::{Serve, Tls};
pub use simulate::{DcpInOperation, Demo, Inject, Protocol, Simulate, simulated};
pub use stations::{Blink, Ip, Name, Network, Reset, ResetMode, Scan};

/// PROFIdrive and PROFINET drives: find, address, read, write, run, simulate, explain.
#[derive(Debug, Parser)]
#[command(
    name = "profidrive",
    version,
    propagate_version = true,
    arg_required_else_help = true
)]
#[command(
    after_help = "DRIVE is a station name (akd-1), an IP address (10.0.0.2) or a MAC address. Where several drives are possible \
    it is also a list (akd-1,akd-2), a pattern (akd-*), model=vlt, vendor=danfoss, a group of the machine file (@line1), or all.\n\
    PARAM is a name (DRV.ACC) or a number (930, p930, r947[0], 947[0..7], 0x3A2), as the vendor writes it \
    (VLT: 1-20, Vacon: ID103).\n\
    Exit codes: 0 ok, 1 failed (also an incomplete backup), 2 usage, 3 refused, 4 not reachable, \
    5 difference found, 6 stopped by a safety rule."
)]
pub struct Cli {
    #[command(flatten)]
    pub interface: Interface,
    #[command(flatten)]
    pub global: Global,
    #[command(subcommand)]
    pub command: Command,
    /// The words of the command: `read`, `gsdml show`
    #[arg(skip)]
    pub name: String,
    /// `--verbose` was given before the command or after it
    #[arg(skip)]
    pub verbose: bool,
    /// The drive of the command, as the user called it
    #[arg(skip)]
    pub drive: Option<String>,
}

impl Cli {
    /// The command line, or what is wrong with it.
    pub fn read<T: Into<OsString> + Clone>(line: impl IntoIterator<Item = T>) -> Result<Self, clap::Error> {
        let line: Vec<OsString> = line.into_iter().map(Into::into).collect();
        let mut command = with_signs(command());
        let matches = command.try_get_matches_from_mut(&line);
        let matches = matches.map_err(|error| with_choices(error, &command, &named(line)))?;
        let cli = Self::from_arg_matches(&matches)?;
        let (words, innermost) = innermost(&matches);
        let drive = innermost.try_get_one::<String>("drive").ok().flatten();
        let own = innermost.try_get_one::<bool>("verbose").ok().flatten();
        if own.is_none() && cli.interface.verbose {
            let message = format!(
                "`{}` reaches no drive: --verbose has no meaning for it",
                words.join(" ")
            );
            return Err(command.error(ErrorKind::UnknownArgument, message));
        }
        Ok(Self {
            verbose: cli.interface.verbose || own == Some(&true),
            name: words.join(" "),
            drive: drive.cloned(),
            ..cli
        })
    }
}

/// Returns the whole command line, with examples.
pub fn command() -> clap::Command {
    examples::completed(Cli::command())
}

/// Returns the words of the command in a line, wrong or not: `read`, `gsdml show`; empty where there is none.
pub fn named(line: impl IntoIterator<Item = OsString>) -> String {
    let matches = Cli::command().ignore_errors(true).try_get_matches_from(line);
    matches.map_or_else(|_| String::new(), |matches| innermost(&matches).0.join(" "))
}

/// Returns the words of the command, and the arguments of its last word.
fn innermost(matches: &ArgMatches) -> (Vec<&str>, &ArgMatches) {
    let mut words = Vec::new();
    let mut innermost = matches;
    while let Some((name, inner)) = innermost.subcommand() {
        words.push(name);
        innermost = inner;
    }
    (words, innermost)
}

/// Adds the choices of missing arguments to the error, one tip for each argument.
fn with_choices(mut error: clap::Error, command: &clap::Command, name: &str) -> clap::Error {
    let Some(ContextValue::Strings(missing)) = error.get(ContextKind::InvalidArg) else {
        return error;
    };
    let command = name
        .split_whitespace()
        .try_fold(command, |command, word| command.find_subcommand(word));
    let choices = command
        .into_iter()
        .flat_map(clap::Command::get_arguments)
        .filter_map(|argument| {
            let choices = argument.get_possible_values();
            let choices: Vec<&str> = choices.iter().map(PossibleValue::get_name).collect();
            let is_missing = !choices.is_empty() && missing.contains(&argument.to_string());
            is_missing.then(|| StyledStr::from(format!("{argument} is one of {}", choices.join(", "))))
        });
    let choices: Vec<StyledStr> = choices.collect();
    if error.kind() == ErrorKind::MissingRequiredArgument && !choices.is_empty() {
        error.insert(ContextKind::Suggested, ContextValue::StyledStrs(choices));
    }
    error
}

/// Reports a time with a sign as an invalid time, not as an unknown option.
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
    /// Network interface towards the drives; else that of the variable PROFIDRIVE_INTERFACE, else that of the configuration file,
    /// else the only one
    #[arg(short, long, value_name = "IFACE")]
    pub interface: Option<String>,
    /// Also print how the drive is reached: which connection it accepts and which it refuses
    #[arg(short, long, conflicts_with = "quiet")]
    pub verbose: bool,
    /// The interface of the configuration file, where neither the option nor the variable names one
    #[arg(skip)]
    pub configured: Option<String>,
}

impl Interface {
    /// Returns the drive on this interface, as the model that it identifies itself as.
    pub fn target(&self, drive: &str) -> Target {
        let kind = Kind::default();
        let interface = self.clone();
        let options = DriveOptions {
            interface,
            kind,
            machine: None,
        };
        options.target(drive)
    }
}

/// What a drive is taken for.
#[derive(Debug, Clone, Default, Args)]
pub struct Kind {
    /// Treat the drive as an `akd`, `vlt` or `vacon` whatever it identifies itself as, or by the profile alone: `standard`
    #[arg(long, value_name = "MODEL", value_parser = model)]
    pub model: Option<profile::model::Model>,
    /// Device description of the vendor: ident numbers of modules that are not in the tables, and whether the drive accepts
    /// connections for records
    #[arg(long, value_name = "FILE")]
    pub gsdml: Option<PathBuf>,
}

/// The interface towards a drive, and what the drive is taken for.
#[derive(Debug, Clone, Default, Args)]
pub struct DriveOptions {
    #[command(flatten)]
    pub interface: Interface,
    #[command(flatten)]
    pub kind: Kind,
    /// Machine file: groups of drives (@line1) and limits of this machine; else that of the variable PROFIDRIVE_MACHINE, else
    /// machine.toml in the current folder
    #[arg(long, value_name = "FILE")]
    pub machine: Option<PathBuf>,
}

impl DriveOptions {
    /// Returns this drive with these options.
    pub fn target(&self, drive: &str) -> Target {
        Target {
            drive: drive.to_owned(),
            options: self.clone(),
        }
    }
}

/// The drive of a command, and how to reach and treat it.
#[derive(Debug)]
pub struct Target {
    /// The drive as the user called it.
    pub drive: String,
    pub options: DriveOptions,
}

/// A command for one drive.
#[derive(Debug, Args)]
pub struct OnDrive<T: Args> {
    /// Station name, IP address, MAC address, or fc:PORT/ADDRESS or uss:PORT/ADDRESS
    pub drive: String,
    #[command(flatten)]
    pub args: T,
    #[command(flatten)]
    pub options: DriveOptions,
}

/// A command for one drive or many.
#[derive(Debug, Args)]
pub struct OnSelected<T: Args> {
    /// A drive as for all commands, a list (akd-1,akd-2), a pattern (akd-*), model=vlt, vendor=danfoss, @line1 of
    /// the machine file, or all
    pub drive: String,
    #[command(flatten)]
    pub args: T,
    #[command(flatten)]
    pub options: DriveOptions,
}

/// A command that has several drives, or files in their place, among its arguments.
#[derive(Debug, Args)]
pub struct OnDrives<T: Args> {
    #[command(flatten)]
    pub args: T,
    #[command(flatten)]
    pub options: DriveOptions,
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
    /// Print data only, without messages
    #[arg(short, long, global = true)]
    pub quiet: bool,
}

#[derive(Debug, Subcommand)]
pub enum Command {
    /// List the stations that answer on the network; exit code 4 when there is none
    Scan(OnNetwork<Scan>),
    /// Set the name of a station; `blink` shows which one it is
    Name(OnNetwork<Name>),
    /// Set the IP address of a station; `blink` shows which one it is
    Ip(OnNetwork<Ip>),
    /// Make the LED of a station blink, to identify it
    Blink(OnNetwork<Blink>),
    /// Reset a station to factory values, after a confirmation; `blink` shows which one it is
    Reset(OnNetwork<Reset>),
    /// Show the identity and the state of a drive
    Info(OnSelected<NoArguments>),
    /// Read parameters
    Read(OnSelected<Read>),
    /// Write parameters: check limits, print old and new value, write, verify
    Write(OnSelected<Write>),
    /// List the parameters of a drive
    List(OnDrive<List>),
    /// Describe one parameter: unit, limits, default, access
    Describe(OnDrive<Describe>),
    /// Turn the motor at a speed for a time, then stop it (moves the axis)
    #[command(after_help = CYCLIC)]
    Run(OnDrive<Run>),
    /// Step the speed of the motor, record each cycle and show rise time, overshoot and settling time (moves the axis)
    #[command(after_help = CYCLIC)]
    Step(OnDrive<Step>),
    /// Turn the motor at a jog speed for a time, then stop it (moves the axis)
    #[command(after_help = CYCLIC)]
    Jog(OnDrive<Jog>),
    /// Move the axis to a position or by a distance, then stop it (moves the axis)
    #[command(after_help = CYCLIC)]
    Move(OnDrive<Move>),
    /// Carry out a motion task of the drive's own table, then stop the axis (moves the axis)
    #[command(after_help = CYCLIC)]
    Task(OnDrive<Task>),
    /// Set the home position by the procedure the drive is set up for (moves the axis)
    #[command(after_help = CYCLIC)]
    Home(OnDrive<Home>),
    /// Bring a drive to rest: by its stop parameter, or by its control word where no controller has it
    Stop(OnSelected<Stop>),
    /// Show the status of a drive and why it does not run; reads only (exit code 5 when something keeps it from running)
    #[command(mut_arg("drive", |drive| drive.required(false).default_value("all")))]
    Status(OnSelected<Status>),
    /// Examine this computer, its network interface and the way to each drive: permissions, loss, duplicates; reads only
    Doctor(OnDrives<Doctor>),
    /// Collect all that describes a machine and its state in a zip file: scan, status, faults, settings, what `doctor` finds
    #[command(mut_arg("drive", |drive| drive.required(false).default_value("all")))]
    Bundle(OnSelected<Bundle>),
    /// Write a page about a machine for its documentation: one HTML file
    #[command(mut_arg("drive", |drive| drive.required(false).default_value("all")))]
    Report(OnSelected<Report>),
    /// Acknowledge the fault of a drive (STW1 bit 7, as its controller for a moment)
    Ack(OnSelected<Ack>),
    /// Watch a drive beside its controller; reads only
    Monitor(OnSelected<Monitor>),
    /// Record signals of drives: parameters at an interval, or every cyclic signal with each cycle
    Record(OnSelected<Record>),
    /// Show the faults and warnings of a drive, what they mean and what to do
    Faults(OnSelected<Faults>),
    /// Save the settings of a drive as text, one parameter a line
    Backup(OnSelected<Backup>),
    /// Compare the settings of two files, two drives, a file and a drive, or a folder of backups and its drives
    Diff(OnDrives<Diff>),
    /// Restore saved settings: prints a plan, saves the present values first, writes, verifies
    Restore(OnDrive<Restore>),
    /// Configure the drives of a machine as in the machine file: names, addresses, settings; prints a plan and asks for confirmation
    Commission(OnDrives<Commission>),
    /// Configure a new drive as the replacement of an old one: name, address, settings; prints a plan and asks for confirmation
    Replace(OnDrives<Replace>),
    /// Explain what a number means
    Explain(Explain),
    /// Explain what a parameter job or a capture file contains
    Decode(Decode),
    /// Device descriptions (GSDML): write that of a virtual drive, show one, check one
    Gsdml(Gsdml),
    /// Inject an event into a drive that `simulate` runs: a fault, a load, a pulled cable
    Inject(Inject),
    /// Put virtual drives on a network
    Simulate(OnNetwork<Simulate>),
    /// Show drives in the browser: identity, state, and why they do not run
    #[cfg(feature = "serve")]
    Serve(OnNetwork<Serve>),
    /// Run a virtual drive and a controller on an in-memory network
    Demo(Demo),
    /// Write the completion script of a shell
    Completions(Completions),
    /// Write the manual pages of all commands
    #[command(hide = true)]
    Manual(Manual),
    /// Print the JSON schemas of all commands
    #[command(hide = true)]
    Schema,
}

/// A command that needs its drive and nothing else.
#[derive(Debug, Args)]
pub struct NoArguments {}

/// What every command says that takes the axis.
const CYCLIC: &str = "It takes the one cyclic connection of the drive, as a controller does: while a controller has it the \
drive refuses, and only one program on a computer can have such connections (UDP port 34964). `read`, `write`, `status`, \
`monitor` and `stop` work beside it. A serial line is different: one program at a time has it, so nothing works beside \
this command there; end it first (Ctrl-C), then `stop`.";

#[derive(Debug, Args)]
pub struct Monitor {
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
pub struct Completions {
    /// The shell
    pub shell: clap_complete::Shell,
}

#[derive(Debug, Args)]
pub struct Manual {
    /// Folder for the pages; it is made where it does not exist
    pub folder: PathBuf,
}

/// A model by the name that a person gives it.
fn model(text: &str) -> Result<profile::model::Model, String> {
    profile::model::Model::by_name(text).ok_or_else(|| {
        let names: Vec<&str> = profile::model::Model::names().collect();
        format!("there are {}", names.join(", "))
    })
}

/// The option that takes a drive as a model with built-in tables: `--model akd|..`.
pub(crate) fn model_option() -> String {
    let names = profile::model::ALL.map(|model| model.key);
    format!("--model {}", names.join("|"))
}

/// A time with its unit (`5s`, `16ms`, `2min`); a bare number is in seconds.
pub(crate) fn duration(text: &str) -> Result<Duration, String> {
    let quantity: Quantity = text.parse().map_err(|error| format!("{error}"))?;
    let seconds = quantity.in_unit("s").map_err(|error| error.to_string())?;
    if seconds < 0.0 {
        return Err("a time is 0 or longer".into());
    }
    Duration::try_from_secs_f64(seconds).map_err(|_| format!("`{text}` is not a time"))
}

#[cfg(test)]
mod tests {
    use std::net::Ipv4Addr;

    use super::*;

    #[test]
    fn the_argument_tree_is_consistent() {
        Cli::command().debug_assert();
    }

    #[test]
    fn an_option_whose_other_option_is_excluded_is_refused_and_not_ignored() {
        for (lines, others) in [
            (
                "simulate --name a;simulate --count 3;simulate --model akd;simulate --mac host;simulate --min-cycle 2ms\
                 ;simulate --ip 10.0.0.1/24;simulate --rotary 3;simulate --serial /dev/null",
                "--virtual-time;--expect f;--junit f;--trace f",
            ),
            ("simulate --state d p.toml", "--trace f"),
            (
                "simulate --ip 10.0.0.1/24;simulate p.toml;simulate --mac host;simulate --gsdml f;simulate --pcap f",
                "--protocol uss;--address 3;--baud 19200;--parity odd",
            ),
            (
                "simulate --virtual-time p.toml;simulate --serial /dev/null",
                "--access-point A",
            ),
            (
                "decode f;decode -i eth0;decode --frame 3 f;decode --drive a f",
                "--as pkw;--telegram 9;--from drive;--request 00",
            ),
            (
                "commission f --only a;commission f --dry-run;commission f --yes",
                "--force",
            ),
            ("serve --demo --tls self-signed", "--key f;--cert f"),
            ("jog a --jog 1", "--real-time"),
        ] {
            for (line, other) in lines
                .split(';')
                .flat_map(|line| others.split(';').map(move |other| (line, other)))
            {
                let whole = format!("profidrive {line} {other}");
                let wrong = Cli::try_parse_from(whole.split(' ')).expect_err(&whole);
                let kinds = [ErrorKind::ArgumentConflict, ErrorKind::MissingRequiredArgument];
                assert!(kinds.contains(&wrong.kind()), "{whole}: {wrong}");
            }
        }
    }

    #[test]
    fn a_line_has_the_name_of_its_command_and_not_of_a_value() {
        for (line, name) in [
            ("profidrive -i scan read akd-1 930", "read"),
            ("profidrive -i stop decode --hex 00", "decode"),
            ("profidrive read --json", "read"),
            ("profidrive gsdml show --wrong", "gsdml show"),
            ("profidrive raed akd-1", ""),
        ] {
            assert_eq!(named(line.split(' ').map(OsString::from)), name, "{line}");
        }
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
            let message = Cli::read(line.split(' ')).unwrap_err().to_string();
            assert!(
                message.contains("a time is 0 or longer") && !message.contains("tip:"),
                "{message}"
            );
        }
    }

    #[test]
    fn verbs_accept_the_arguments_of_the_manual() {
        for line in [
            "profidrive scan -i eth0",
            "profidrive name 02:00:00:00:00:01 akd-1",
            "profidrive ip akd-1 10.0.0.2/24 --gateway 10.0.0.1 --temporary",
            "profidrive reset akd-1 --mode communication --yes",
            "profidrive read akd-1 DRV.ACC p930 r947[0..7] --json",
            "profidrive read akd-1 DRV.ACC -v --gsdml GSDML-V2.3-Vendor-Drive-20200101.xml",
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
            "profidrive decode - --drive akd-1 --only trouble --since 1.5s --until 2min",
            "profidrive decode -i eth0",
            "profidrive -i eth0 decode",
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
            "profidrive simulate --gsdml GSDML-V2.3-Vendor-Drive-20200101.xml --access-point DAP_1",
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
        assert!(Cli::try_parse_from(["profidrive", "decode", "f", "-i", "eth0"]).is_err());
    }
}

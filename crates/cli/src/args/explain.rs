//! Numbers, octets and captures, explained without any drive.

use std::path::PathBuf;
use std::time::Duration;

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use clap::{Args, ValueEnum};
use dissect::explain::{KINDS, Kind, MODES};
use profile::state::Mode;

use super::{Kind as ModelKind, duration};

/// Takes the names of a table of a library, with what each is as its help.
fn named<T: Copy + Send + Sync + 'static>(
    table: &'static [(&'static str, &'static str, T)],
) -> impl TypedValueParser<Value = T> {
    let values = table
        .iter()
        .map(|(name, help, _)| PossibleValue::new(*name).help(*help));
    PossibleValuesParser::new(values).try_map(move |given| {
        let row = table.iter().find(|(name, ..)| *name == given);
        row.map(|(.., value)| *value).ok_or("no such name")
    })
}

#[derive(Debug, Args)]
pub struct Explain {
    /// The number: 0x047F, 1151, 0b0000_0100_0111_1111, DE80B500; a state also by its name, S1 to S5; a fault also as the drive
    /// displays it: F439, n602, A13, W34
    #[arg(allow_negative_numbers = true)]
    pub value: String,
    /// What the number is; can be left out for the name of a state and for a fault with its letter
    #[arg(long = "as", value_parser = named(&KINDS), value_name = "KIND")]
    pub kind: Option<Kind>,
    /// Mode of the drive, for stw1 and zsw1; without it both modes are shown
    #[arg(long, value_parser = named(&MODES), value_name = "MODE")]
    pub mode: Option<Mode>,
    #[command(flatten)]
    pub model: ModelKind,
}

/// Of a capture: what says something about octets is refused beside it, and not ignored.
const OF_A_CAPTURE: [&str; 8] = [
    "file",
    "interface",
    "keep",
    "station",
    "only",
    "since",
    "until",
    "frame",
];

#[derive(Debug, Args)]
pub struct Decode {
    /// Capture file, pcap or pcapng; `-` is standard input
    #[arg(value_name = "FILE", conflicts_with = "hex")]
    pub file: Option<PathBuf>,
    /// Captures on this network interface instead, until Ctrl-C
    #[arg(short, long, value_name = "IFACE", conflicts_with_all = ["file", "hex"])]
    pub interface: Option<String>,
    /// Also keep the last frames of the interface, for this time, where `bundle` finds them
    #[arg(long, value_name = "TIME", value_parser = duration, conflicts_with_all = ["file", "hex"])]
    pub keep: Option<Duration>,
    /// Prints only what is from, to or about this station: its name, IP address or Ethernet address
    #[arg(long = "drive", value_name = "DRIVE", conflicts_with = "hex")]
    pub station: Option<String>,
    /// Prints only what points to a fault
    #[arg(long, value_enum, value_name = "WHAT", conflicts_with = "hex")]
    pub only: Option<Only>,
    /// Leaves out what is before this time of the capture; the summary is about what follows
    #[arg(long, value_name = "TIME", value_parser = duration, conflicts_with = "hex")]
    pub since: Option<Duration>,
    /// Ends at this time of the capture
    #[arg(long, value_name = "TIME", value_parser = duration, conflicts_with = "hex")]
    pub until: Option<Duration>,
    /// Prints one frame, numbered from 1 as in Wireshark: what happened in it, and each field with its octets
    #[arg(long, value_name = "NUMBER", value_parser = clap::value_parser!(u64).range(1..),
        conflicts_with_all = ["hex", "interface", "keep", "station", "only", "since", "until"])]
    pub frame: Option<u64>,
    /// Octets in hexadecimal: a parameter job, or what --as or --telegram says
    #[arg(long, value_name = "BYTES")]
    pub hex: Option<String>,
    /// What the octets are; without it the side of a parameter job is guessed
    #[arg(long = "as", value_enum, value_name = "WHAT", requires = "hex", conflicts_with_all = OF_A_CAPTURE)]
    pub octets: Option<Octets>,
    /// The octets are cyclic data of this telegram: 1, 9 .., 101 to 108 (PPO types 1 to 8 of a VLT), 148 to 150 (Vacon)
    #[arg(long, value_name = "NUMBER", requires = "hex", conflicts_with_all = ["octets", "request"],
        conflicts_with_all = OF_A_CAPTURE)]
    pub telegram: Option<u16>,
    /// Who sent it, for words and telegrams that look the same from both; without it both are reported
    #[arg(long, value_enum, value_name = "WHO", requires = "hex", conflicts_with_all = OF_A_CAPTURE)]
    pub from: Option<Sender>,
    /// The request that belongs to a response, in hexadecimal
    #[arg(long, value_name = "BYTES", requires = "hex", conflicts_with_all = OF_A_CAPTURE)]
    pub request: Option<String>,
    #[command(flatten)]
    pub model: ModelKind,
}

/// Which events are printed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Only {
    /// Warnings, errors, and what is without an answer, missing or in conflict
    Trouble,
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
    /// The same in the Danfoss FC protocol, where the index stands elsewhere; with the characters of a text (AK 15)
    PkwFc,
    /// The same in USS
    PkwUss,
    /// Telegram of the Danfoss FC protocol
    Fc,
    /// USS telegram
    Uss,
}

/// Who sends.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Sender {
    /// Controller or master
    Controller,
    /// Drive or slave
    Drive,
}

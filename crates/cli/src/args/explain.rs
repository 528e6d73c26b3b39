//! Numbers, octets and captures, explained without any drive.

use std::path::PathBuf;
use std::time::Duration;

use clap::{Args, ValueEnum};

use super::{Kind, duration};

#[derive(Debug, Args)]
pub struct Explain {
    /// The number: 0x047F, 1151, 0b0000_0100_0111_1111, DE80B500; a state also by its name, S1 to S5
    #[arg(allow_negative_numbers = true)]
    pub value: String,
    /// What the number is
    #[arg(
        long = "as",
        value_enum,
        value_name = "stw1|zsw1|state|fault|error|format|pnio|ctw-fc|stw-fc|ctw-vlt|stw-vlt|ctw-vlt2800|stw-vlt2800|ctw-vacon|stw-vacon|pke|alarm-word|alarm-word2|warning-word|warning-word2"
    )]
    pub kind: What,
    /// Mode of the drive, for stw1 and zsw1; without it both modes are shown
    #[arg(long, value_enum, value_name = "MODE")]
    pub mode: Option<WordMode>,
    #[command(flatten)]
    pub model: Kind,
}

/// Mode that decides over the bits of STW1 and ZSW1.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum WordMode {
    /// Velocity mode (PNU 930 = 1)
    Velocity,
    /// Position mode (PNU 930 = 2)
    Position,
}

/// What a number to explain is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum What {
    /// Control word 1
    Stw1,
    /// Status word 1
    Zsw1,
    /// State of the drive, from status word 1 or by its name
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
    /// Capture file, pcap or pcapng; `-` is standard input
    #[arg(value_name = "FILE", conflicts_with = "hex")]
    pub file: Option<PathBuf>,
    /// Captures on this network interface instead, until Ctrl-C
    #[arg(short, long, value_name = "IFACE", conflicts_with_all = ["file", "hex"])]
    pub interface: Option<String>,
    /// Prints only what is from, to or about this station: its name, IP address or Ethernet address
    #[arg(long, value_name = "DRIVE", conflicts_with = "hex")]
    pub drive: Option<String>,
    /// Prints only what points to a fault
    #[arg(long, value_enum, value_name = "WHAT", conflicts_with = "hex")]
    pub only: Option<Only>,
    /// Leaves out what is before this time of the capture; the summary is about what follows
    #[arg(long, value_name = "TIME", value_parser = duration, conflicts_with = "hex")]
    pub since: Option<Duration>,
    /// Ends at this time of the capture
    #[arg(long, value_name = "TIME", value_parser = duration, conflicts_with = "hex")]
    pub until: Option<Duration>,
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

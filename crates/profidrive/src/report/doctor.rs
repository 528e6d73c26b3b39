//! What an examination of this computer and its network found.

use client::Advice;
use serde::Serialize;

use super::{Action, Wording};

/// What was found, in the order of the checks: this computer first, then the network.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct DoctorReport {
    /// The network interface; null where there is none to take, and in a plant in memory.
    pub interface: Option<String>,
    /// The findings.
    pub findings: Vec<Finding>,
    /// How late the timers of this computer are; null where this was not measured.
    pub timers: Option<TimerReport>,
    /// What was measured of the way to each station.
    pub links: Vec<LinkReport>,
}

/// A finding.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Finding {
    /// What was checked.
    pub check: Check,
    /// How serious it is.
    pub severity: Severity,
    /// The drive, where it is about one.
    pub drive: Option<String>,
    /// What was measured or found.
    pub found: String,
    /// Why it matters.
    pub why: Option<&'static str>,
    /// What to do.
    pub remedy: Option<String>,
    /// The actions in it.
    pub actions: Vec<Action>,
}

impl Finding {
    /// Returns a finding without a remedy.
    #[must_use]
    pub fn new(check: Check, severity: Severity, found: impl Into<String>) -> Self {
        Self {
            check,
            severity,
            drive: None,
            found: found.into(),
            why: None,
            remedy: None,
            actions: Vec::new(),
        }
    }

    /// Returns the same about a drive.
    #[must_use]
    pub fn about(mut self, drive: impl Into<String>) -> Self {
        self.drive = Some(drive.into());
        self
    }

    /// Returns the same with the reason why it matters.
    #[must_use]
    pub const fn because(mut self, why: &'static str) -> Self {
        self.why = Some(why);
        self
    }

    /// Returns the same with what to do, in the words of a front end.
    #[must_use]
    pub fn remedied(mut self, advice: &Advice, wording: &dyn Wording) -> Self {
        if !advice.is_empty() {
            self.remedy = Some(wording.advice(advice));
            self.actions = Action::all(advice, wording);
        }
        self
    }
}

/// What is checked.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Check {
    /// The permission for raw Ethernet.
    Permission,
    /// The network interface is there and switched on.
    Interface,
    /// A cable with something alive at its other end.
    Carrier,
    /// Speed and duplex of the interface.
    Speed,
    /// Largest packet of the interface.
    Mtu,
    /// The IP address of this computer.
    Address,
    /// Room of the kernel for the Ethernet addresses of stations.
    ArpTable,
    /// UDP port 34964, on which devices call their controller.
    Port,
    /// What the interface and the kernel do with received frames before a program gets them.
    Offload,
    /// How late the timers of this computer are.
    Timers,
    /// Which stations answer.
    Stations,
    /// Names and addresses that more than one station has.
    Duplicates,
    /// Stations that cannot answer: another subnet, no address, no name.
    Reach,
    /// Requests without an answer.
    Loss,
    /// Records of a station.
    Records,
    /// Who is at the other end of the cables (LLDP).
    Neighbours,
}

impl Check {
    /// Its name for people.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Permission => "permission",
            Self::Interface => "interface",
            Self::Carrier => "carrier",
            Self::Speed => "speed",
            Self::Mtu => "MTU",
            Self::Address => "address",
            Self::ArpTable => "ARP table",
            Self::Port => "UDP port",
            Self::Offload => "offload",
            Self::Timers => "timers",
            Self::Stations => "stations",
            Self::Duplicates => "duplicates",
            Self::Reach => "reach",
            Self::Loss => "loss",
            Self::Records => "records",
            Self::Neighbours => "neighbours",
        }
    }
}

/// How serious a finding is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Severity {
    /// As it should be.
    Ok,
    /// Worth knowing.
    Note,
    /// Could not be checked.
    Unchecked,
    /// Works, but badly or not always.
    Warning,
    /// Does not work.
    Error,
}

/// How late the timers of this computer are, in seconds.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct TimerReport {
    /// Time between two timers.
    pub period: f64,
    /// How many were measured.
    pub count: usize,
    /// The most punctual one.
    pub min: f64,
    /// Half of them were not later than this.
    pub median: f64,
    /// 99 of 100 were not later than this.
    pub p99: f64,
    /// The latest one.
    pub max: f64,
}

/// What was measured of the way to a station. Times are in seconds, from the request to its answer.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct LinkReport {
    /// The station: its name, else its IP address, else its Ethernet address.
    pub drive: String,
    /// Its Ethernet address; null where it was reached by UDP alone.
    pub mac: Option<String>,
    /// Requests that were sent, each once.
    pub requests: usize,
    /// Requests that were answered.
    pub answers: usize,
    /// Half of the answers took no longer than this; null without an answer.
    pub median: Option<f64>,
    /// The slowest answer.
    pub max: Option<f64>,
}

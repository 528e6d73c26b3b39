//! What the verbs report that look at drives.

use std::time::SystemTime;

use client::{Action, Advice, Drive, FaultEntry, FaultReport, Info, LoggedFault, Snapshot};
use profile::fault::Counting;
use profile::state::Zsw1;
use profile::value::Reading;
use serde::Serialize;

use crate::monitor::Observation;

use super::{
    Controller, DriveWords, Fault, Parameter, ProfileIdentity, Quantity, Station, Warning, Wording, parameter,
};

/// Who a drive is and in which state.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct InfoReport {
    /// The drive as it was called.
    pub drive: String,
    /// Name of its model.
    pub model: &'static str,
    /// Whether it is a drive.
    pub is_drive: bool,
    /// How it answers to discovery.
    pub station: Station,
    /// Its identification records (I&M0 to I&M3).
    pub identity: Option<Identity>,
    /// Its state and words.
    #[serde(flatten)]
    pub words: DriveWords,
    /// Who has its cyclic connection; null where it does not report that.
    pub controller: Option<Controller>,
    /// Who is at the other end of its cables.
    pub neighbours: Vec<Neighbour>,
    /// The modules that are plugged.
    pub modules: Vec<Module>,
    /// How its records were read: `device access`, `implicit reads`, `connection as IO controller`.
    pub route: Option<&'static str>,
    /// What its identification parameters (PNU 964, 965 and 975) say.
    pub identification: ProfileIdentity,
    /// The parameters that identify it.
    pub parameters: Vec<Parameter>,
    /// Its fault buffer.
    pub faults: Vec<Fault>,
    /// Records and parameters that it refused, with its reason.
    pub refused: Vec<String>,
}

/// Identification and maintenance records.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Identity {
    /// Vendor.
    pub vendor_id: u16,
    /// Order number.
    pub order_id: String,
    /// Serial number.
    pub serial_number: String,
    /// Hardware revision.
    pub hardware_revision: u16,
    /// Software revision.
    pub software_revision: String,
    /// Profile, 0x3A00 for PROFIdrive.
    pub profile_id: u16,
    /// Type within the profile.
    pub profile_type: u16,
    /// Function (I&M1).
    pub function: String,
    /// Location (I&M1).
    pub location: String,
    /// Installation date (I&M2).
    pub installed: String,
    /// Descriptor (I&M3).
    pub descriptor: String,
}

/// A station at the other end of a cable.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Neighbour {
    /// The drive's own port.
    pub own_port: String,
    /// The port of the neighbour.
    pub port: String,
    /// Name of the neighbour.
    pub station: Option<String>,
    /// Its Ethernet address.
    pub mac: String,
}

/// A module that is plugged.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Module {
    /// API.
    pub api: u32,
    /// Slot.
    pub slot: u16,
    /// Ident number.
    pub ident: u32,
    /// Its submodules.
    pub submodules: Vec<Submodule>,
}

/// A submodule that is plugged.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Submodule {
    /// Subslot.
    pub subslot: u16,
    /// Ident number.
    pub ident: u32,
}

impl InfoReport {
    /// Returns the report on a drive.
    #[must_use]
    pub fn new(drive: &Drive, info: &Info, snapshot: Option<&Snapshot>, faults: &[FaultEntry]) -> Self {
        let identity = info.identity.as_ref().map(|identity| Identity {
            vendor_id: identity.vendor_id,
            order_id: identity.order_id.clone(),
            serial_number: identity.serial_number.clone(),
            hardware_revision: identity.hardware_revision,
            software_revision: identity.software_revision.clone(),
            profile_id: identity.profile_id,
            profile_type: identity.profile_type,
            function: identity.function.clone(),
            location: identity.location.clone(),
            installed: identity.installed.clone(),
            descriptor: identity.descriptor.clone(),
        });
        let neighbours = info.peers.iter().map(|peer| Neighbour {
            own_port: peer.own_port.clone(),
            port: peer.port.clone(),
            station: Some(peer.station.clone()).filter(|name| !name.is_empty()),
            mac: peer.mac.to_string(),
        });
        let modules = info.modules.iter().map(|module| Module {
            api: module.api,
            slot: module.slot,
            ident: module.ident,
            submodules: module
                .submodules
                .iter()
                .map(|submodule| Submodule {
                    subslot: submodule.subslot,
                    ident: submodule.ident,
                })
                .collect(),
        });
        Self {
            drive: drive.label(),
            model: drive.model.name,
            is_drive: info.is_drive(drive),
            station: Station::from(&drive.station),
            identity,
            words: snapshot.map_or_else(DriveWords::unknown, DriveWords::from),
            controller: Controller::of(info.controller.as_ref()),
            neighbours: neighbours.collect(),
            modules: modules.collect(),
            route: info.route.map(client::Route::name),
            identification: ProfileIdentity::of(&info.readings),
            parameters: info.readings.iter().map(Parameter::from).collect(),
            faults: faults.iter().map(Fault::from).collect(),
            refused: info.refused.clone(),
        }
    }
}

/// What is wrong with a drive, and what was.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct FaultsReport {
    /// The drive.
    pub drive: String,
    /// Fault message counter (PNU 944).
    pub counter: u16,
    /// What that counts: `changes` of the fault buffer or fault `situations`.
    pub counts: &'static str,
    /// Fault situations that the drive has counted (PNU 952); null where it has no such counter.
    pub situation_counter: Option<u16>,
    /// Situations of the fault buffer.
    pub situations: u8,
    /// Faults of a situation.
    pub faults_per_situation: u8,
    /// Whether the status word reports a fault.
    pub fault_bit: Option<bool>,
    /// Whether the status word reports a warning.
    pub warning_bit: Option<bool>,
    /// The faults that are present, and with the history those that were acknowledged.
    pub faults: Vec<Fault>,
    /// Faults that were acknowledged before.
    pub acknowledged: usize,
    /// The warnings that are present.
    pub warnings: Vec<Warning>,
    /// The log that the drive keeps beside the fault buffer, the newest first; empty without the history.
    pub log: Vec<LogEntry>,
    /// Whether the history is a part of this report.
    pub history: bool,
}

/// An entry of the log of a drive.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct LogEntry {
    /// The vendor's number.
    pub number: u16,
    /// What it means.
    pub meaning: Option<String>,
    /// What the drive noted with it.
    pub value: Option<i64>,
    /// When it came, in the drive's own time.
    pub time: Option<i64>,
}

impl From<&LoggedFault> for LogEntry {
    fn from(entry: &LoggedFault) -> Self {
        Self {
            number: entry.number,
            meaning: entry.meaning.map(str::to_owned),
            value: entry.value,
            time: entry.time,
        }
    }
}

impl FaultsReport {
    /// Returns the faults that a drive reports, acknowledged ones only with `history`.
    #[must_use]
    pub fn new(drive: impl Into<String>, report: &FaultReport, history: bool) -> Self {
        let flag = |bit: Zsw1| report.zsw1.map(|word| Zsw1(word).has(bit));
        let shown = report
            .faults
            .iter()
            .filter(|fault| history || fault.situation == 0);
        Self {
            drive: drive.into(),
            counter: report.counter,
            counts: match report.counting {
                Counting::Changes => "changes",
                Counting::Situations => "situations",
            },
            situation_counter: report.situations,
            situations: report.shape.situations,
            faults_per_situation: report.shape.faults,
            fault_bit: flag(Zsw1::FAULT),
            warning_bit: flag(Zsw1::WARNING),
            faults: shown.map(Fault::from).collect(),
            acknowledged: report.faults.iter().filter(|fault| fault.situation > 0).count(),
            warnings: report.warnings.iter().flatten().map(Warning::from).collect(),
            log: report
                .log
                .iter()
                .filter(|_| history)
                .map(LogEntry::from)
                .collect(),
            history,
        }
    }

    /// Returns the faults that are not acknowledged.
    pub fn present(&self) -> impl Iterator<Item = &Fault> {
        self.faults.iter().filter(|fault| !fault.acknowledged)
    }

    /// Returns what ends the faults that are present: what only a restart clears is not to be acknowledged. Empty without a
    /// fault.
    #[must_use]
    pub fn advice(&self) -> Advice {
        let is_restart = |fault: &Fault| fault.needs_restart == Some(true);
        let acknowledge = || Advice::from(Action::Acknowledge).and(" acknowledges once the cause is gone");
        match (
            self.present().any(is_restart),
            self.present().any(|fault| !is_restart(fault)),
        ) {
            (false, false) => Advice::default(),
            (true, false) => Advice::from(format!(
                "{} has to be switched off and on once the cause is gone: no command clears it",
                self.drive
            )),
            (false, true) => acknowledge(),
            (true, true) => acknowledge().and("; what only a restart clears takes a power cycle"),
        }
    }
}

/// A drive at one moment, read beside its controller.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct MonitorReading {
    /// The drive.
    pub drive: String,
    /// Seconds from the arrival of the first reading to that of this one.
    pub time: f64,
    /// The time of day at which this reading arrived, in seconds since 1970-01-01 UTC; null in virtual time.
    pub wall: Option<f64>,
    /// Seconds for which the drive had not answered before this reading; null where it answered in time.
    pub outage: Option<f64>,
    /// Seconds from the request to the answer: long after an outage.
    pub answer_time: f64,
    /// State of the drive and its words.
    #[serde(flatten)]
    pub words: DriveWords,
    /// Speed that is commanded.
    pub speed_set: Option<Quantity>,
    /// Speed of the motor.
    pub speed_actual: Option<Quantity>,
    /// Position, in position mode.
    pub position: Option<Quantity>,
    /// Fault message counter (PNU 944).
    pub fault_counter: Option<u16>,
    /// The parameters that were requested.
    pub parameters: Vec<Parameter>,
}

/// A drive that is watched and does not answer. Its next reading says how long that lasted.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct MonitorSilence {
    /// The drive.
    pub drive: String,
    /// True: the drive does not answer.
    pub silent: bool,
    /// Seconds from the arrival of the first reading to the request that is not answered; null before the first reading.
    pub time: Option<f64>,
}

/// Returns seconds since 1970-01-01 UTC.
pub(crate) fn since_1970(time: SystemTime) -> Option<f64> {
    let time = time.duration_since(SystemTime::UNIX_EPOCH).ok()?;
    Some(time.as_secs_f64())
}

impl MonitorReading {
    /// Returns the values that a drive reported.
    #[must_use]
    pub fn new(drive: &str, seen: &Observation, wording: &dyn Wording) -> Self {
        let snapshot = &seen.snapshot;
        let quantity = |reading: &Option<Reading>| reading.as_ref().and_then(Quantity::of);
        Self {
            drive: drive.to_owned(),
            time: seen.time.as_secs_f64(),
            wall: seen.wall.and_then(since_1970),
            outage: seen.outage().map(|time| time.as_secs_f64()),
            answer_time: seen.answer_time.as_secs_f64(),
            words: DriveWords::from(snapshot),
            speed_set: quantity(&snapshot.speed_set),
            speed_actual: quantity(&snapshot.speed_actual),
            position: quantity(&snapshot.position),
            fault_counter: snapshot.fault_counter,
            parameters: snapshot
                .readings
                .iter()
                .map(|reading| parameter(reading, wording))
                .collect(),
        }
    }
}

/// Values of parameters.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ParametersReport {
    /// The drive.
    pub drive: String,
    /// The values, in the order of the request.
    pub parameters: Vec<Parameter>,
}

#[cfg(test)]
mod tests {
    use super::*;
    use profile::catalogue::Cleared;
    use profile::fault::Shape;

    #[test]
    fn what_only_a_restart_clears_is_not_to_be_acknowledged() {
        let advice = |cleared: &[Cleared]| {
            let entry = |&cleared: &Cleared| FaultEntry {
                number: 8,
                cleared: Some(cleared),
                ..FaultEntry::default()
            };
            let report = FaultReport {
                counting: Counting::Changes,
                counter: 1,
                situations: None,
                shape: Shape::EIGHT_BY_EIGHT,
                faults: cleared.iter().map(entry).collect(),
                warnings: None,
                zsw1: None,
                log: Vec::new(),
            };
            FaultsReport::new("d", &report, false).advice()
        };
        let acknowledges = |advice: &Advice| advice.actions().any(|one| *one == Action::Acknowledge);
        assert!(advice(&[]).is_empty());
        let restart = advice(&[Cleared::Restart]);
        assert!(
            restart.to_string().contains("off and on") && !acknowledges(&restart),
            "{restart}"
        );
        assert!(acknowledges(&advice(&[Cleared::Acknowledge])));
        let both = advice(&[Cleared::Restart, Cleared::Acknowledge]);
        assert!(
            acknowledges(&both) && both.to_string().contains("power cycle"),
            "{both}"
        );
    }
}

//! Why a drive runs, waits or is held.

use client::LocalControl;
use client::status::{Diagnosis, DriveStatus};
use dissect::hex16;
use profile::catalogue::{Catalogue, Part};
use profile::state::{Mode, Profile, Zsw1};
use serde::Serialize;

use crate::machine::UserUnit;

use super::{Action, Controller, DriveWords, Fault, LossReaction, Quantity, Warning, Word, Wording};

/// How a drive is, and in one sentence why it does not run.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct StatusReport {
    /// The drive.
    pub drive: String,
    /// `runs`, `waits` (nothing is wrong) or `held`.
    pub verdict: String,
    /// Stable name of the cause.
    pub cause: &'static str,
    /// The cause in one sentence.
    pub sentence: String,
    /// What to do next.
    pub next: Option<String>,
    /// The actions in it.
    pub actions: Vec<Action>,
    /// What else stands in the way.
    pub notes: Vec<StatusNote>,
    /// State of the drive and its words.
    #[serde(flatten)]
    pub words: DriveWords,
    /// The state in words.
    pub state_text: Option<String>,
    /// Who has its cyclic connection; null where it does not report that.
    pub controller: Option<Controller>,
    /// Telegram that is selected (PNU 922).
    pub telegram: Option<u16>,
    /// Operating mode (PNU 930): 1 speed control, 2 positioning.
    pub operating_mode: Option<u16>,
    /// Where the setpoints come from; `meaning` is what that source is called.
    pub command_source: Option<Word>,
    /// What keeps the power stage off.
    pub disable_sources: Option<Word>,
    /// What keeps the axis from moving.
    pub motion_disable_sources: Option<Word>,
    /// Status of the motion.
    pub motion_status: Option<Word>,
    /// False for safe torque off.
    pub torque_allowed: Option<bool>,
    /// Whether the axis has its home position; null in velocity mode.
    pub homed: Option<bool>,
    /// Whether the limit switch at the negative end is hit.
    pub negative_switch: Option<bool>,
    /// Whether the limit switch at the positive end is hit.
    pub positive_switch: Option<bool>,
    /// Software limits that are reached: bits 0 and 1.
    pub software_limits: Option<u16>,
    /// Voltage of the DC bus.
    pub bus_voltage: Option<Quantity>,
    /// Current of the motor.
    pub current: Option<Quantity>,
    /// Torque of the motor; in `%` of its nominal torque where the drive does not report it in `Nm`.
    pub torque: Option<Quantity>,
    /// Temperature of the power stage, at the hottest of its sensors.
    pub temperature: Option<Quantity>,
    /// Temperature of the motor.
    pub motor_temperature: Option<Quantity>,
    /// Speed that is commanded.
    pub speed_set: Option<Quantity>,
    /// Speed of the motor; in `%` of the reference where it is not known in `rpm`.
    pub speed_actual: Option<Quantity>,
    /// Position.
    pub position: Option<Quantity>,
    /// Commanded position minus position.
    pub following_error: Option<Quantity>,
    /// The same of the load, where the machine file has its unit.
    pub load: Option<LoadStatus>,
    /// What the drive does when its controller is lost.
    pub on_loss: Option<LossReaction>,
    /// The faults that are present.
    pub faults: Vec<Fault>,
    /// The warnings that are present.
    pub warnings: Vec<Warning>,
    /// Who commands the drive at the drive itself, where it requests no control by the field bus (ZSW1 bit 9 is 0); the cause, or a note
    /// beside another cause, says the same in words.
    #[serde(skip)]
    pub local: Option<LocalControl>,
}

/// Where the load of a drive is and how fast it goes, in the unit that the machine file has for it.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct LoadStatus {
    /// Its position, counted from position 0 of the motor.
    pub position: Option<Quantity>,
    /// Its speed.
    pub speed: Option<Quantity>,
    /// Commanded position minus position.
    pub following_error: Option<Quantity>,
}

/// Something else that stands in the way.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct StatusNote {
    /// Stable name of the cause.
    pub cause: &'static str,
    /// The cause in one sentence.
    pub sentence: String,
    /// What to do about it.
    pub next: Option<String>,
}

impl StatusReport {
    /// Returns the status of a drive.
    #[must_use]
    pub fn new(
        status: &DriveStatus,
        diagnosis: &Diagnosis,
        tables: Option<&Catalogue>,
        wording: &dyn Wording,
    ) -> Self {
        let word =
            |part, word: Option<u16>| word.map(|word| part_word(tables, part, word.into(), hex16(word)));
        let notes = diagnosis.notes.iter().map(|note| StatusNote {
            cause: note.id,
            sentence: note.sentence.clone(),
            next: note.next.as_ref().map(|next| wording.advice(next)),
        });
        let rpm = status.speed_actual.map(Quantity::rpm);
        let torque = status.torque.map(|torque| Quantity::new(torque, "Nm"));
        let torque_percent = status.torque_percent.map(|share| Quantity::new(share, "%"));
        let percent = status.speed_percent.map(|value| Quantity::new(value, "%"));
        Self {
            drive: status.drive.clone(),
            verdict: diagnosis.verdict.to_string(),
            cause: diagnosis.cause.id(),
            sentence: diagnosis.sentence.clone(),
            next: diagnosis.next.as_ref().map(|next| wording.advice(next)),
            actions: diagnosis
                .next
                .as_ref()
                .map_or_else(Vec::new, |next| Action::all(next, wording)),
            notes: notes.collect(),
            words: DriveWords::of(
                status.profile,
                status.word_mode,
                status.control_word,
                status.status_word,
            ),
            state_text: status.state().map(|state| state.to_string()),
            controller: Controller::of(status.controller.as_ref()),
            telegram: status.telegram,
            operating_mode: status.mode,
            command_source: word(Part::CommandSource, status.command_source).map(|word| Word {
                meaning: status.command_source_text.map(str::to_owned),
                ..word
            }),
            disable_sources: word(Part::DisableSources, status.disable_sources),
            motion_disable_sources: word(Part::MotionDisableSources, status.motion_disable_sources),
            motion_status: status
                .motion
                .map(|word| part_word(tables, Part::MotionStatus, word.into(), format!("0x{word:08X}"))),
            torque_allowed: status.torque_allowed,
            homed: status
                .zsw1
                .filter(|_| status.word_mode == Mode::Position)
                .map(|word| word.has(Zsw1::HOMED)),
            negative_switch: status.negative_switch,
            positive_switch: status.positive_switch,
            software_limits: status.software_limits,
            bus_voltage: status.bus_voltage.map(|volts| Quantity::new(volts, "V")),
            current: status.current.map(|amperes| Quantity::new(amperes, "A")),
            torque: torque.or(torque_percent),
            temperature: status.temperature.map(|degrees| Quantity::new(degrees, "degC")),
            motor_temperature: status
                .motor_temperature
                .map(|degrees| Quantity::new(degrees, "degC")),
            speed_set: status.speed_set.map(Quantity::rpm),
            speed_actual: rpm.or(percent),
            position: status.position.map(Quantity::turns),
            following_error: status.following_error.map(Quantity::turns),
            load: None,
            on_loss: status.loss.as_ref().map(LossReaction::from),
            faults: status.faults.iter().map(Fault::from).collect(),
            warnings: status.warnings.iter().map(Warning::from).collect(),
            local: status.local.clone(),
        }
    }
}

impl StatusReport {
    /// Returns the status with that of the load, in this unit.
    #[must_use]
    pub fn of_load(self, unit: Option<&UserUnit>) -> Self {
        let Some(unit) = unit else { return self };
        let of = |quantity: &Option<Quantity>| unit.of_motor(quantity.as_ref()?);
        let load = LoadStatus {
            position: of(&self.position),
            speed: of(&self.speed_actual),
            following_error: of(&self.following_error),
        };
        Self {
            load: Some(load),
            ..self
        }
    }
}

/// A word whose bits the tables of a drive name.
fn part_word(tables: Option<&Catalogue>, part: Part, number: u64, hex: String) -> Word {
    let known = tables.and_then(|tables| {
        let parameter = tables.part(part)?;
        tables.word_at(parameter.pnu, parameter.base)
    });
    Word {
        number,
        hex,
        bits: known.map_or_else(Vec::new, |known| {
            known.describe(number, Profile::default(), Mode::default())
        }),
        meaning: None,
    }
}

//! Reads all values that explain why a drive does not run, in as few jobs as possible. Reads only.

use profile::catalogue::Part;
use profile::parameter::pnu;
use profile::state::{Mode, State, Zsw1};
use profile::telegram::{Telegram, signal};

use super::{Session, loss};
use crate::axis::Wiring;
use crate::status::DriveStatus;
use crate::{Drive, Error};
use profile::value::Reading;

/// Parameters read from every drive by number.
const PROFILE: [u16; 4] = [
    pnu::TELEGRAM,
    pnu::SETPOINT_SIGNALS,
    pnu::ACTUAL_SIGNALS,
    pnu::OPERATING_MODE,
];
/// Parameters read by role.
const PARTS: [Part; 26] = [
    Part::ControlWord,
    Part::StatusWord,
    Part::SpeedSetpoint,
    Part::SpeedActual,
    Part::ControlProfile,
    Part::Position,
    Part::CommandSource,
    Part::DisableSources,
    Part::MotionStatus,
    Part::Feedrate,
    Part::NegativeSwitch,
    Part::PositiveSwitch,
    Part::FollowingError,
    Part::TorqueAllowed,
    Part::SoftwareLimitState,
    Part::Speed,
    Part::MotionDisableSources,
    Part::Current,
    Part::Torque,
    Part::TorquePercent,
    Part::PowerStageTemperature,
    Part::MotorTemperature,
    Part::BusVoltage,
    Part::BusLowest,
    Part::Brake,
    Part::BrakeReleased,
];

impl Session {
    /// Reads the status of a drive; [`diagnose`](crate::status::diagnose) evaluates it. Refused values are left out.
    ///
    /// # Errors
    /// When the drive cannot be reached.
    pub async fn status(&mut self, drive: &mut Drive) -> Result<DriveStatus, Error> {
        let controller = self.owner(drive).await?;
        let profile_values = self.read_numbers(drive, &PROFILE).await?;
        let parts = self.ask(drive, &[&PARTS[..], &loss::PARTS[..]].concat()).await?;
        let word = |pnu| {
            let found = profile_values.iter().find(|reading| reading.pnu == pnu);
            let raw = found.and_then(Reading::raw);
            raw.and_then(|raw| u16::try_from(raw & 0xFFFF).ok())
        };
        let telegram = drive.telegram_in_use(word(pnu::TELEGRAM));
        let profile = parts.profile(drive, telegram);
        let (control, status) = (parts.word(Part::ControlWord), parts.word(Part::StatusWord));
        let zsw1 = status.map(|status| profile.zsw1(status, control.unwrap_or_default()));
        // a serial line has one master, and this one commands nothing
        let controller = controller.or(drive.is_on_line().then_some(None));
        let runs = zsw1.is_some_and(|zsw1| zsw1.has(Zsw1::READY_TO_OPERATE));
        let state = if runs { State::S4 } else { State::S2 };
        let (faults, warnings) = match self.fault_report(drive).await {
            Ok(report) => (
                report.present().cloned().collect(),
                report.warnings.unwrap_or_default(),
            ),
            Err(Error::Refused { .. } | Error::Changing { .. }) => (Vec::new(), Vec::new()),
            Err(error) => return Err(error),
        };
        let local = match zsw1.filter(|word| !word.has(Zsw1::CONTROL_REQUESTED)) {
            Some(word) => Some(self.local_control(drive, word).await?),
            None => None,
        };
        let wiring = wiring(drive, &profile_values);
        let carries = |signal| wiring.as_ref().map(|wiring| wiring.commands(signal));
        let turns = |part: Part| {
            let raw = parts.raw(part)?;
            Some(f64::from(raw as i32) / drive.counts_per_turn())
        };
        let mode = match word(pnu::OPERATING_MODE) {
            Some(1) => Some(Mode::Velocity),
            Some(2) => Some(Mode::Position),
            _ => None,
        };
        // a power stage may have several sensors
        let hottest = parts
            .all(Part::PowerStageTemperature)
            .filter_map(Reading::number)
            .reduce(f64::max);
        let speed_actual = parts.rpm(Part::Speed).or_else(|| parts.rpm(Part::SpeedActual));
        Ok(DriveStatus {
            drive: drive.label(),
            model: drive.model.name,
            profile,
            word_mode: drive.word_mode(word(pnu::OPERATING_MODE).map(i64::from), telegram),
            control_word: control,
            status_word: status,
            controller,
            stw1: control.map(|control| profile.orders(control, state).stw1),
            zsw1,
            local,
            telegram,
            carries_speed: carries(signal::NSOLL_A),
            carries_tasks: carries(signal::SATZANW),
            mode: word(pnu::OPERATING_MODE),
            motions: drive.motions(mode, zsw1.is_some_and(|word| word.has(Zsw1::HOMED)), profile),
            command_source: parts.word(Part::CommandSource),
            command_source_text: parts.find(Part::CommandSource).and_then(|reading| reading.choice),
            disable_sources: parts.word(Part::DisableSources),
            motion_disable_sources: parts.word(Part::MotionDisableSources),
            feedrate: parts.number(Part::Feedrate),
            motion: parts.double_word(Part::MotionStatus),
            torque_allowed: parts.flag(Part::TorqueAllowed),
            negative_switch: parts.flag(Part::NegativeSwitch),
            positive_switch: parts.flag(Part::PositiveSwitch),
            software_limits: parts.word(Part::SoftwareLimitState),
            bus_voltage: parts.number(Part::BusVoltage),
            bus_lowest: parts.number(Part::BusLowest),
            current: parts.number(Part::Current),
            torque: parts.number(Part::Torque),
            torque_percent: parts.number(Part::TorquePercent),
            temperature: hottest,
            motor_temperature: parts.number(Part::MotorTemperature),
            brake_fitted: parts.flag(Part::Brake),
            brake_released: parts.flag(Part::BrakeReleased),
            faults,
            warnings,
            speed_set: parts
                .rpm(Part::SpeedSetpoint)
                .filter(|_| carries(signal::NSOLL_A) == Some(true)),
            speed_actual,
            speed_percent: parts
                .percent(Part::SpeedActual)
                .filter(|_| speed_actual.is_none()),
            loss: drive
                .model
                .catalogue
                .map(|tables| loss::reaction(tables, drive, &parts)),
            position: turns(Part::Position),
            following_error: turns(Part::FollowingError),
        })
    }
}

/// Returns the telegram in use, from the signals that the drive reports.
fn wiring(drive: &Drive, parts: &[Reading]) -> Option<Wiring> {
    let words = |pnu| {
        parts
            .iter()
            .filter(move |reading| reading.pnu == pnu)
            .filter_map(|reading| reading.raw())
            .filter_map(|raw| u16::try_from(raw & 0xFFFF).ok())
    };
    let number = words(pnu::TELEGRAM).next()?;
    // the signals of a fixed telegram are known; those of a free one are read from the drive
    let vendor = drive.station.vendor_id;
    if let Some(fixed) = Telegram::find(number, vendor).filter(|telegram| !telegram.free) {
        return Wiring::of(fixed, vendor).ok();
    }
    Wiring::new(
        number,
        words(pnu::SETPOINT_SIGNALS),
        words(pnu::ACTUAL_SIGNALS),
        drive.station.vendor_id,
    )
    .ok()
}

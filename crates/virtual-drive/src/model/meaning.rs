//! What the drive shows and does at a parameter, by the part that the parameter has.

use profile::catalogue::{Access, Parameter, Part, PartRow};
use profile::parameter::pnu;
use profile::telegram::{Direction, Signal, signal};

use super::live::{Action, Bit, Live, Place, Quantity, Sensor, Table};
use super::process::Signals;
use super::{Derived, Model, numbered};

/// The lists of numbers (PNU 980 and on), which do not list themselves.
const LISTS: core::ops::RangeInclusive<u16> = 980..=989;

impl Model {
    /// Returns what a parameter is beyond its stored number, by position in the catalogue.
    #[must_use]
    pub fn live_by_position(&self) -> &[Live] {
        &self.derived().live
    }

    /// Returns every number, ascending, without those of the lists of numbers.
    pub(crate) fn listed_numbers(&self) -> &[u16] {
        &self.derived().numbers
    }

    fn derived(&self) -> &Derived {
        self.derived.get_or_init(|| Derived {
            live: self.make_live(),
            numbers: self
                .catalogue
                .numbers()
                .filter(|pnu| !LISTS.contains(pnu))
                .collect(),
        })
    }

    /// A parameter with several parts is what the last of them says that makes more of it than a stored number.
    fn make_live(&self) -> Box<[Live]> {
        let tables = self.catalogue;
        let mut table: Box<[Live]> = tables
            .parameters
            .iter()
            .map(|parameter| self.by_number(parameter).unwrap_or(Live::Stored))
            .collect();
        for (index, row) in tables.parts.iter().enumerate() {
            let before = tables.parts.iter().take(index);
            let place = before.filter(|other| other.part == row.part).count();
            if let Some(live) = self.by_part(row, place)
                && let Some(position) = numbered(tables, row.number())
                && let Some(slot) = table.get_mut(position)
            {
                *slot = live;
            }
        }
        table
    }

    /// Numbers that the profile gives, and signals where those are parameters of their own.
    fn by_number(&self, parameter: &Parameter) -> Option<Live> {
        Some(match parameter.pnu {
            pnu::SETPOINT_SIGNALS => Live::Array(Table::SetpointSignals),
            pnu::ACTUAL_SIGNALS => Live::Array(Table::ActualSignals),
            pnu::TELEGRAM => Live::Telegram,
            923 => Live::Array(Table::SignalParameters),
            pnu::OPERATING_MODE => Live::OperatingMode,
            pnu::FAULT_COUNTER => Live::FaultCounter,
            945 | pnu::FAULT_NUMBERS => Live::Array(Table::FaultNumbers),
            952 => Live::FaultSituations,
            pnu::IDENTIFICATION => Live::Array(Table::Identification),
            pnu::PROFILE => Live::Profile,
            pnu::DRIVE_OBJECT => Live::Array(Table::DriveObject),
            list @ 980..=989 => Live::Array(Table::Numbers((list - 980) as u8)),
            list @ 990..=999 => Live::Array(Table::Changed((list - 990) as u8)),
            number if self.process.signals == Signals::Numbers => {
                let signal = Signal::find(number, self.catalogue.device.vendor_id)?;
                let is_set = signal.direction == Direction::Setpoint && parameter.access == Access::ReadWrite;
                is_set.then_some(Live::Setpoint)?
            }
            _ => return None,
        })
    }

    /// `place` counts the rows of the part, from 0.
    fn by_part(&self, row: &PartRow, place: usize) -> Option<Live> {
        let nth = u8::try_from(place).unwrap_or(u8::MAX);
        let command = |action| match row.values {
            [] => Live::Do(action),
            values => Live::Choose(values, action),
        };
        let same = |part| self.numbers.get(part).map(Live::Same);
        let through = |part| self.numbers.get(part).map(Live::Through);
        let word = |actual| Live::Word { actual, number: nth };
        Some(match row.part {
            Part::ControlWord | Part::ControlWordCopy => Live::ControlWord,
            Part::StatusWord | Part::StatusWordCopy => Live::StatusWord,
            Part::SpeedSetpointSignal => Live::Signal(signal::NSOLL_A),
            Part::SpeedReference => Live::SpeedReference,
            Part::ChosenSetpoints => Live::Array(Table::SetpointWords),
            Part::ChosenActuals => Live::Array(Table::ActualWords),
            Part::ReceivedWord => word(false),
            Part::SentWord | Part::SentWordCopy => word(true),
            Part::WideWords => Live::Array(Table::WideWords),
            Part::TelegramCopy => Live::Telegram,
            Part::ParameterNumbers => Live::Array(Table::Numbers(nth)),
            Part::ChangedParameters => Live::Array(Table::Changed(nth)),
            Part::Watchdog => Live::Watchdog,
            Part::RotarySwitches => Live::Rotary,
            Part::Active => Live::Active,
            Part::ControlMode => Live::Mode,
            Part::DisableSources => Live::DisableSources,
            Part::TorqueAllowed => Live::TorqueAllowed,
            Part::NegativeSwitch => Live::LimitSwitch { positive: false },
            Part::PositiveSwitch => Live::LimitSwitch { positive: true },
            Part::SoftwareLimitState => Live::SoftwareLimits,
            Part::DriveInputs => Live::Bits(DRIVE_INPUTS),
            Part::InputState => Live::Input { number: nth + 1 },
            Part::MotionStatus | Part::MotionStatusCopy => Live::MotionStatus,
            Part::RunningTask => Live::RunningTask,
            Part::ClearTask => Live::ClearTask,
            Part::StartTask => Live::StartTask,
            Part::Fault | Part::FaultCopy => Live::Fault(nth),
            Part::Warning => Live::Warning(nth),
            Part::AlarmWord => Live::AlarmWord(32 * nth),
            Part::WarningWord => Live::WarningWord(32 * nth),
            Part::ExtendedStatus => Live::ExtendedStatus,
            Part::FaultLog => Live::Array(Table::LogCodes),
            Part::FaultLogTime => Live::Array(Table::LogTimes),
            Part::HistoryEvents => Live::Array(Table::HistoryEvents),
            Part::HistoryValues => Live::Array(Table::HistoryValues),
            Part::HistoryTimes => Live::Array(Table::HistoryTimes),
            Part::EditedSetUps => Live::EditedSetUps,
            Part::CopySetUp => Live::CopySetUp,
            Part::HomeModeCopy => same(Part::HomeMode)?,
            Part::FoldbackFaultCopy => same(Part::FoldbackFault)?,
            Part::AccelerationScalingCopy => same(Part::AccelerationScaling)?,
            Part::VelocityScalingCopy => same(Part::VelocityScaling)?,
            Part::HomeModeSignal => through(Part::HomeMode)?,
            Part::HomeDistanceSignal => through(Part::HomeDistance)?,
            Part::AccelerationSignal => through(Part::Acceleration)?,
            Part::DecelerationSignal => through(Part::Deceleration)?,
            Part::Enable => command(Action::Enable),
            Part::Disable => command(Action::Disable),
            Part::Stop => command(Action::Stop),
            Part::SetTask => command(Action::SetTask),
            Part::LoadTask => command(Action::LoadTask),
            Part::ContinueTask => command(Action::ContinueTask),
            Part::Home => command(Action::Home),
            Part::SetHome => command(Action::SetHome),
            Part::ClearFaults => command(Action::ClearFaults),
            Part::Save => command(Action::Save),
            Part::Load => command(Action::Load),
            Part::Defaults => command(Action::Defaults),
            Part::ResetEnergy => command(Action::ResetEnergy),
            Part::ResetRunningTime => command(Action::ResetRunningTime),
            Part::Blink => command(Action::Blink),
            Part::Restart => command(Action::Restart),
            Part::ApplyAddress => command(Action::ApplyAddress),
            Part::WithoutEffect => command(Action::Nothing),
            Part::AbsentProcedure => Live::Absent,
            part => measured(part)?,
        })
    }
}

/// What is measured or computed.
const fn measured(part: Part) -> Option<Live> {
    Some(Live::Measured(match part {
        Part::Position => return Some(Live::Place(Place::Singleturn)),
        Part::FollowingError => return Some(Live::Place(Place::FollowingSingleturn)),
        Part::PositionActual => return Some(Live::Place(Place::Actual)),
        Part::PositionCommand => return Some(Live::Place(Place::Command)),
        Part::PositionError => return Some(Live::Place(Place::Following)),
        Part::FeedbackPosition => return Some(Live::Place(Place::Feedback)),
        Part::FeedbackAngle => return Some(Live::Place(Place::Angle)),
        Part::Speed | Part::SpeedCopy => Quantity::Speed,
        Part::SpeedFiltered => Quantity::SpeedFiltered,
        Part::SpeedCommand => Quantity::SpeedCommand,
        Part::SpeedError => Quantity::SpeedError,
        Part::SpeedPercent => Quantity::SpeedPart,
        Part::SpeedOfRange => Quantity::SpeedOfRange,
        Part::ReferenceSpeed => Quantity::Reference,
        Part::ReferenceFrequency => Quantity::ReferenceFrequency,
        Part::ReferencePercent => Quantity::ReferencePart,
        Part::TaskSpeed => Quantity::TaskSpeed,
        Part::Frequency => Quantity::Frequency,
        Part::FrequencyPercent => Quantity::FrequencyPart,
        Part::OutputVoltage => Quantity::MotorVoltage,
        Part::BusVoltage => Quantity::BusVoltage,
        Part::Current | Part::CurrentCopy => Quantity::Current,
        Part::CurrentCommand => Quantity::CurrentCommand,
        Part::Power => Quantity::Power,
        Part::Horsepower => Quantity::Horsepower,
        Part::PowerPercent => Quantity::PowerPart,
        Part::Torque => Quantity::Torque,
        Part::TorquePercent => Quantity::TorquePart,
        Part::MotorLoad => Quantity::MotorLoad,
        Part::InverterLoad => Quantity::InverterLoad,
        Part::BrakePower => Quantity::BrakePower,
        Part::RegeneratedPower => Quantity::RegenPower,
        Part::Foldback => Quantity::Foldback,
        Part::DriveFoldback => Quantity::DriveFoldback,
        Part::MotorFoldback => Quantity::MotorFoldback,
        Part::MotorSensor => Quantity::MotorSensor,
        Part::ControlTemperature => Quantity::Temperature(Sensor::Control),
        Part::PowerStageTemperature => Quantity::Temperature(Sensor::PowerStage),
        Part::MotorTemperature => Quantity::Temperature(Sensor::Motor),
        Part::PowerTime => Quantity::PowerTime,
        Part::RunningTime => Quantity::RunningTime,
        Part::Energy => Quantity::Energy,
        Part::PowerUps => Quantity::PowerUps,
        Part::OverTemperatures => Quantity::OverTemperatures,
        Part::OverVoltages => Quantity::OverVoltages,
        _ => return None,
    }))
}

/// Source: AKD PROFINET manual 5.8.1.
const DRIVE_INPUTS: &[Bit] = &[
    input(0, Part::SoftwareLimitState, 0),
    input(1, Part::SoftwareLimitState, 1),
    input(2, Part::NegativeSwitch, 0),
    input(3, Part::PositiveSwitch, 0),
    input(4, Part::DisableSources, 2),
    input(5, Part::DisableSources, 5),
    input(6, Part::TorqueAllowed, 0),
];

const fn input(bit: u8, part: Part, of: u8) -> Bit {
    Bit { bit, part, of }
}

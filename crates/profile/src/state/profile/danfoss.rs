//! The words of Danfoss VLT drives, as tables. The bits are in `data/vlt/words.csv`.
//!
//! Source: FC design guides MG33B3 and MG11B2 (RS-485 chapters), MCA 101 manual MG33C4 p. 31 to 38, MCA 120 manual
//! MG90U3 6.5 and 6.6; VLT 2800 and FCD 300: MG04B7 p. 85 and 104.

mod generated_bits;

use super::{
    Extras, Facts, FromWord, NO_EXTRAS, SpeedCommand, SpeedRule, Start, StatusBit, Stw1, ToWord, Zsw1,
};
use crate::state::Setpoint;

const fn on(number: u8) -> u16 {
    1 << number
}

const fn from_word(stw1: Stw1, all: u16, one_of: u16) -> FromWord {
    FromWord { stw1, all, one_of }
}

const fn to_word(stw1: Stw1, word: u16) -> ToWord {
    ToWord { word, stw1 }
}

const fn speed(mask: u16, value: u16, speed: SpeedCommand) -> SpeedRule {
    SpeedRule { mask, value, speed }
}

const FREEZE: SpeedCommand = SpeedCommand::Channel(Setpoint::Freeze);
const ZERO: SpeedCommand = SpeedCommand::Channel(Setpoint::ZeroAtLimits);
const RAMP_TO_ZERO: SpeedCommand = SpeedCommand::Channel(Setpoint::RampToZero);
const FOLLOW: SpeedCommand = SpeedCommand::Channel(Setpoint::Follow);

/// FC profile. A stop by bit 4 is the quick stop of the state machine and runs to its end; jog starts by itself. Both are
/// ours, the sources are silent. While bit 5 holds the output, bits 4 and 6 do not stop (MG11B2).
pub(super) static FC: Facts = Facts {
    key: "fc",
    name: "Danfoss FC",
    control: [&generated_bits::FC_CONTROL; 2],
    status: [&generated_bits::FC_STATUS; 2],
    start: Start::ByLevel,
    quick_stop_on_ramp: false,
    zero_on_quick_ramp: true,
    from_word: Some(&[
        from_word(Stw1::ON, on(2), on(6) | on(8)),
        from_word(Stw1::NO_COAST_STOP, on(3), 0),
        from_word(Stw1::NO_QUICK_STOP, on(4), 0),
        from_word(Stw1::ENABLE_OPERATION, 0, 0),
        from_word(Stw1::ENABLE_RAMP, 0, 0),
        from_word(Stw1::UNFREEZE_RAMP, on(5), 0),
        from_word(Stw1::ENABLE_SETPOINT, 0, 0),
        from_word(Stw1::ACKNOWLEDGE_FAULT, on(7), 0),
        from_word(Stw1::JOG_1, on(8), 0),
        from_word(Stw1::CONTROL_BY_PLC, on(10), 0),
    ]),
    to_word: &[
        to_word(Stw1(0), on(2)),
        to_word(Stw1(Stw1::NO_COAST_STOP.0 | Stw1::ENABLE_OPERATION.0), on(3)),
        to_word(Stw1::NO_QUICK_STOP, on(4)),
        to_word(Stw1::UNFREEZE_RAMP, on(5)),
        to_word(Stw1::JOG_1, on(5)),
        to_word(
            Stw1(Stw1::ON.0 | Stw1::ENABLE_RAMP.0 | Stw1::ENABLE_SETPOINT.0),
            on(6),
        ),
        to_word(Stw1::ACKNOWLEDGE_FAULT, on(7)),
        to_word(Stw1(Stw1::ON.0 | Stw1::JOG_1.0), on(8)),
        to_word(Stw1::CONTROL_BY_PLC, on(10)),
    ],
    speeds: &[
        speed(on(5), 0, FREEZE),
        speed(on(8), on(8), SpeedCommand::Jog1),
        speed(0, 0, FOLLOW),
    ],
    extras: Extras {
        dc_brake: on(2),
        second_ramp: on(9),
        preset: Some(0),
        set_up: Some((13, 2)),
        reverse: on(15),
        relays: Some(11),
        holds: on(5),
        ..NO_EXTRAS
    },
    status_bits: Some(&[
        StatusBit::ControlReady,
        StatusBit::DriveReady,
        StatusBit::Enabled,
        StatusBit::Same(Zsw1::FAULT),
        StatusBit::ErrorWithoutTrip,
        StatusBit::Nothing,
        StatusBit::TripLocked,
        StatusBit::Warning,
        StatusBit::AtReference,
        StatusBit::Same(Zsw1::CONTROL_REQUESTED),
        StatusBit::WithinFrequencyLimits,
        StatusBit::Running,
        StatusBit::StoppedAutoStart,
        StatusBit::VoltageExceeded,
        StatusBit::TorqueExceeded,
        StatusBit::TimerExceeded,
    ]),
};

static PROFIDRIVE_SAYS: [StatusBit; 16] = [
    StatusBit::Same(Zsw1::READY_TO_SWITCH_ON),
    StatusBit::Same(Zsw1::READY_TO_OPERATE),
    StatusBit::Same(Zsw1::OPERATION_ENABLED),
    StatusBit::Same(Zsw1::FAULT),
    StatusBit::Same(Zsw1::NO_COAST_STOP),
    StatusBit::Same(Zsw1::NO_QUICK_STOP),
    StatusBit::Same(Zsw1::INHIBITED),
    StatusBit::Warning,
    StatusBit::AtReference,
    StatusBit::Same(Zsw1::CONTROL_REQUESTED),
    StatusBit::WithinFrequencyLimits,
    StatusBit::Running,
    StatusBit::StoppedAutoStart,
    StatusBit::VoltageExceeded,
    StatusBit::TorqueExceeded,
    StatusBit::TimerExceeded,
];

static VLT_2800_SAYS: [StatusBit; 16] = [
    StatusBit::Same(Zsw1::READY_TO_SWITCH_ON),
    StatusBit::Same(Zsw1::READY_TO_OPERATE),
    StatusBit::Same(Zsw1::OPERATION_ENABLED),
    StatusBit::Same(Zsw1::FAULT),
    StatusBit::Opposite(Zsw1::NO_COAST_STOP),
    StatusBit::Opposite(Zsw1::NO_QUICK_STOP),
    StatusBit::Same(Zsw1::INHIBITED),
    StatusBit::Warning,
    StatusBit::AtReference,
    StatusBit::Same(Zsw1::CONTROL_REQUESTED),
    StatusBit::WithinFrequencyLimits,
    StatusBit::Running,
    StatusBit::Nothing,
    StatusBit::VoltageExceeded,
    StatusBit::TorqueExceeded,
    StatusBit::TimerExceeded,
];

/// Bits 0 to 10 are those of STW1.
static SAME_GIVES: [FromWord; 11] = {
    let mut rows = [from_word(Stw1(0), 0, 0); 11];
    let mut number = 0;
    while number < 11 {
        rows[number] = from_word(Stw1(1 << number), 1 << number, 0);
        number += 1;
    }
    rows
};

static SAME_ASKS: [ToWord; 11] = {
    let mut rows = [to_word(Stw1(0), 0); 11];
    let mut number = 0;
    while number < 11 {
        rows[number] = to_word(Stw1(1 << number), 1 << number);
        number += 1;
    }
    rows
};

/// Jog only with bit 4 = 0 (MG90U3 6.5.1), standing or not; both jogs are none. Then as the setpoint channel.
static PROFIDRIVE_SPEEDS: [SpeedRule; 6] = [
    speed(on(4) | on(8) | on(9), on(8), SpeedCommand::Jog1),
    speed(on(4) | on(8) | on(9), on(9), SpeedCommand::Jog2),
    speed(on(4), 0, ZERO),
    speed(on(5), 0, FREEZE),
    speed(on(6), 0, RAMP_TO_ZERO),
    speed(0, 0, FOLLOW),
];

const SHARED: Facts = Facts {
    key: "danfoss",
    name: "Danfoss PROFIdrive",
    control: [&generated_bits::PROFIDRIVE_CONTROL; 2],
    status: [&generated_bits::PROFIDRIVE_STATUS; 2],
    start: Start::AfterOff,
    quick_stop_on_ramp: false,
    zero_on_quick_ramp: true,
    from_word: Some(&SAME_GIVES),
    to_word: &SAME_ASKS,
    speeds: &PROFIDRIVE_SPEEDS,
    extras: Extras {
        set_up: Some((13, 2)),
        reverse: on(15),
        slow_down: on(11),
        catch_up: on(12),
        ..NO_EXTRAS
    },
    status_bits: Some(&PROFIDRIVE_SAYS),
};

/// PROFIdrive profile of FC 300 and its sisters.
pub(super) static PROFIDRIVE: Facts = SHARED;

/// PROFIdrive profile of VLT 2800 and FCD 300.
pub(super) static VLT_2800: Facts = Facts {
    key: "vlt2800",
    name: "Danfoss VLT 2800 PROFIdrive",
    status: [&generated_bits::VLT_2800_STATUS; 2],
    status_bits: Some(&VLT_2800_SAYS),
    ..SHARED
};

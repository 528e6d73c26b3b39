//! The words of Danfoss VLT drives, as tables. The bits are in `data/vlt/words.csv`.
//!
//! Source: FC design guides MG33B3 and MG11B2 (RS-485 chapters), MCA 101 manual MG33C4 p. 31 to 38, MCA 120 manual
//! MG90U3 6.5 and 6.6; VLT 2800 and FCD 300: MG04B7 p. 85 and 104.

mod generated_bits;

use super::{Asks, Extras, Facts, Gives, NO_EXTRAS, Says, SpeedCommand, SpeedRule, Start, Stw1, Zsw1};
use crate::state::Setpoint;

const fn on(number: u8) -> u16 {
    1 << number
}

const fn gives(stw1: Stw1, all: u16, one_of: u16) -> Gives {
    Gives { stw1, all, one_of }
}

const fn asks(stw1: Stw1, word: u16) -> Asks {
    Asks { word, stw1 }
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
    gives: Some(&[
        gives(Stw1::ON, on(2), on(6) | on(8)),
        gives(Stw1::NO_COAST_STOP, on(3), 0),
        gives(Stw1::NO_QUICK_STOP, on(4), 0),
        gives(Stw1::ENABLE_OPERATION, 0, 0),
        gives(Stw1::ENABLE_RAMP, 0, 0),
        gives(Stw1::UNFREEZE_RAMP, on(5), 0),
        gives(Stw1::ENABLE_SETPOINT, 0, 0),
        gives(Stw1::ACKNOWLEDGE_FAULT, on(7), 0),
        gives(Stw1::JOG_1, on(8), 0),
        gives(Stw1::CONTROL_BY_PLC, on(10), 0),
    ]),
    asks: &[
        asks(Stw1(0), on(2)),
        asks(Stw1(Stw1::NO_COAST_STOP.0 | Stw1::ENABLE_OPERATION.0), on(3)),
        asks(Stw1::NO_QUICK_STOP, on(4)),
        asks(Stw1::UNFREEZE_RAMP, on(5)),
        asks(Stw1::JOG_1, on(5)),
        asks(
            Stw1(Stw1::ON.0 | Stw1::ENABLE_RAMP.0 | Stw1::ENABLE_SETPOINT.0),
            on(6),
        ),
        asks(Stw1::ACKNOWLEDGE_FAULT, on(7)),
        asks(Stw1(Stw1::ON.0 | Stw1::JOG_1.0), on(8)),
        asks(Stw1::CONTROL_BY_PLC, on(10)),
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
    says: Some(&[
        Says::ControlReady,
        Says::DriveReady,
        Says::Enabled,
        Says::Same(Zsw1::FAULT),
        Says::ErrorWithoutTrip,
        Says::Nothing,
        Says::TripLocked,
        Says::Warning,
        Says::AtReference,
        Says::Same(Zsw1::CONTROL_REQUESTED),
        Says::WithinFrequencyLimits,
        Says::Running,
        Says::StoppedAutoStart,
        Says::VoltageExceeded,
        Says::TorqueExceeded,
        Says::TimerExceeded,
    ]),
};

static PROFIDRIVE_SAYS: [Says; 16] = [
    Says::Same(Zsw1::READY_TO_SWITCH_ON),
    Says::Same(Zsw1::READY_TO_OPERATE),
    Says::Same(Zsw1::OPERATION_ENABLED),
    Says::Same(Zsw1::FAULT),
    Says::Same(Zsw1::NO_COAST_STOP),
    Says::Same(Zsw1::NO_QUICK_STOP),
    Says::Same(Zsw1::INHIBITED),
    Says::Warning,
    Says::AtReference,
    Says::Same(Zsw1::CONTROL_REQUESTED),
    Says::WithinFrequencyLimits,
    Says::Running,
    Says::StoppedAutoStart,
    Says::VoltageExceeded,
    Says::TorqueExceeded,
    Says::TimerExceeded,
];

static VLT_2800_SAYS: [Says; 16] = [
    Says::Same(Zsw1::READY_TO_SWITCH_ON),
    Says::Same(Zsw1::READY_TO_OPERATE),
    Says::Same(Zsw1::OPERATION_ENABLED),
    Says::Same(Zsw1::FAULT),
    Says::Opposite(Zsw1::NO_COAST_STOP),
    Says::Opposite(Zsw1::NO_QUICK_STOP),
    Says::Same(Zsw1::INHIBITED),
    Says::Warning,
    Says::AtReference,
    Says::Same(Zsw1::CONTROL_REQUESTED),
    Says::WithinFrequencyLimits,
    Says::Running,
    Says::Nothing,
    Says::VoltageExceeded,
    Says::TorqueExceeded,
    Says::TimerExceeded,
];

/// Bits 0 to 10 are those of STW1.
static SAME_GIVES: [Gives; 11] = {
    let mut rows = [gives(Stw1(0), 0, 0); 11];
    let mut number = 0;
    while number < 11 {
        rows[number] = gives(Stw1(1 << number), 1 << number, 0);
        number += 1;
    }
    rows
};

static SAME_ASKS: [Asks; 11] = {
    let mut rows = [asks(Stw1(0), 0); 11];
    let mut number = 0;
    while number < 11 {
        rows[number] = asks(Stw1(1 << number), 1 << number);
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
    gives: Some(&SAME_GIVES),
    asks: &SAME_ASKS,
    speeds: &PROFIDRIVE_SPEEDS,
    extras: Extras {
        set_up: Some((13, 2)),
        reverse: on(15),
        slow_down: on(11),
        catch_up: on(12),
        ..NO_EXTRAS
    },
    says: Some(&PROFIDRIVE_SAYS),
};

/// PROFIdrive profile of FC 300 and its sisters.
pub(super) static PROFIDRIVE: Facts = SHARED;

/// PROFIdrive profile of VLT 2800 and FCD 300.
pub(super) static VLT_2800: Facts = Facts {
    key: "vlt2800",
    name: "Danfoss VLT 2800 PROFIdrive",
    status: [&generated_bits::VLT_2800_STATUS; 2],
    says: Some(&VLT_2800_SAYS),
    ..SHARED
};

//! The words of Danfoss VLT drives, as tables.
//!
//! Source: FC design guides MG33B3 and MG11B2 (RS-485 chapters), MCA 101 manual MG33C4 p. 31 to 38, MCA 120 manual
//! MG90U3 6.5 and 6.6; VLT 2800 and FCD 300: MG04B7 p. 85 and 104.

use super::{Asks, Bit, Extras, Facts, Gives, NO_EXTRAS, Says, SpeedCommand, SpeedRule, Start, Stw1, Zsw1};
use crate::state::Setpoint;
use crate::state::bits::{bit, inverse};

const RESET: Bit = bit(7, "RESET", "reset (the 0 to 1 edge counts)", "no reset");
const DATA_VALID: Bit = bit(
    10,
    "DATA_VALID",
    "data valid",
    "data not valid, the drive ignores the word and the reference",
);
const NO_COASTING: Bit = inverse(3, "COAST", "no coasting", "coasting: pulses off at once");
const QUICK_STOP: Bit = inverse(4, "QUICK_STOP", "ramp", "quick stop on the ramp of 3-81");
const HOLD: Bit = inverse(5, "HOLD", "use ramp", "hold output frequency");
const START: Bit = bit(6, "START", "start", "ramp stop");
const SET_UP_LSB: Bit = bit(13, "SETUP_LSB", "set-up 2 or 4", "set-up 1 or 3");
const SET_UP_MSB: Bit = bit(14, "SETUP_MSB", "set-up 3 or 4", "set-up 1 or 2");
const REVERSE: Bit = bit(15, "REVERSE", "reverse", "forward");

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

/// Control word of the FC profile.
static FC_CONTROL: [Bit; 16] = [
    bit(
        0,
        "PRESET_LSB",
        "preset reference 1 or 3",
        "preset reference 0 or 2",
    ),
    bit(
        1,
        "PRESET_MSB",
        "preset reference 2 or 3",
        "preset reference 0 or 1",
    ),
    inverse(2, "DC_BRAKE", "ramp", "DC brake (2-01, 2-02), then stop"),
    NO_COASTING,
    QUICK_STOP,
    HOLD,
    START,
    RESET,
    bit(8, "JOG", "jog at 3-19", "no jog"),
    bit(9, "RAMP_2", "ramp 2", "ramp 1"),
    DATA_VALID,
    bit(11, "RELAY_1", "relay 1 on", "relay 1 off"),
    bit(12, "RELAY_2", "relay 2 on (older drives: relay 4)", "relay 2 off"),
    SET_UP_LSB,
    SET_UP_MSB,
    REVERSE,
];

const WARNING: Bit = bit(7, "WARNING", "warning", "no warning");
const AT_REFERENCE: Bit = bit(8, "AT_REF", "speed = reference", "speed is not the reference");
const BUS_CONTROL: Bit = bit(9, "BUS_CTRL", "bus control", "local operation");
const FREQUENCY: Bit = bit(
    10,
    "FREQ_OK",
    "within the frequency limits",
    "at a frequency limit (4-12, 4-14)",
);
const IN_OPERATION: Bit = bit(11, "RUNNING", "in operation", "no operation");
const AUTO_START: Bit = bit(
    12,
    "AUTO_START",
    "stopped by temperature, starts again by itself",
    "not stopped by temperature",
);
const VOLTAGE: Bit = bit(13, "VOLTAGE", "DC bus voltage exceeded", "voltage fine");
const TORQUE: Bit = bit(14, "TORQUE", "current or torque limit exceeded", "torque fine");
const TIMER: Bit = bit(15, "TIMER", "thermal timer exceeded", "timers fine");
const TRIP: Bit = bit(3, "TRIP", "trip", "no trip");

/// Status word of the FC profile.
static FC_STATUS: [Bit; 16] = [
    bit(0, "CTRL_READY", "control ready", "control not ready (trip)"),
    bit(1, "DRIVE_READY", "drive ready", "drive not ready"),
    bit(2, "ENABLE", "enabled: starts when told", "coasting"),
    TRIP,
    bit(4, "ERROR", "error without trip", "no error"),
    bit(5, "BIT5", "reserved", "-"),
    bit(
        6,
        "TRIP_LOCK",
        "trip lock: reset by the mains only",
        "no trip lock",
    ),
    WARNING,
    AT_REFERENCE,
    BUS_CONTROL,
    FREQUENCY,
    IN_OPERATION,
    AUTO_START,
    VOLTAGE,
    TORQUE,
    TIMER,
];

/// FC profile. A stop by bit 4 is the quick stop of the state machine and runs to its end; jog starts by itself. Both are
/// ours, the sources are silent. While bit 5 holds the output, bits 4 and 6 do not stop (MG11B2).
pub(super) static FC: Facts = Facts {
    key: "fc",
    name: "Danfoss FC",
    control: [&FC_CONTROL; 2],
    status: [&FC_STATUS; 2],
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

/// Control word of the PROFIdrive profile in Danfoss drives.
static PROFIDRIVE_CONTROL: [Bit; 16] = [
    bit(0, "ON1", "ON 1", "OFF 1: ramp stop"),
    inverse(1, "OFF2", "ON 2", "OFF 2: coasting, pulses off at once"),
    inverse(2, "OFF3", "ON 3", "OFF 3: quick stop on the ramp of 3-81"),
    NO_COASTING,
    QUICK_STOP,
    HOLD,
    START,
    RESET,
    bit(8, "JOG1", "jog 1 at 8-90 (with bit 4 = 0)", "no jog 1"),
    bit(9, "JOG2", "jog 2 at 8-91 (with bit 4 = 0)", "no jog 2"),
    DATA_VALID,
    bit(11, "SLOW_DOWN", "reference less 3-12", "no slow down"),
    bit(12, "CATCH_UP", "reference plus 3-12", "no catch up"),
    SET_UP_LSB,
    SET_UP_MSB,
    REVERSE,
];

const START_INHIBIT: Bit = bit(
    6,
    "NO_START",
    "start not possible: OFF first, then ON",
    "start possible",
);
const ENABLE: Bit = bit(2, "ENABLE", "enabled", "coasting, or OFF given");
const READY: Bit = bit(0, "CTRL_READY", "control ready", "control not ready");
const DRIVE_READY: Bit = bit(1, "DRIVE_READY", "drive ready", "drive not ready");

/// Status word of the PROFIdrive profile in Danfoss drives.
static PROFIDRIVE_STATUS: [Bit; 16] = [
    READY,
    DRIVE_READY,
    ENABLE,
    TRIP,
    inverse(4, "OFF2", "ON 2", "OFF 2"),
    inverse(5, "OFF3", "ON 3", "OFF 3"),
    START_INHIBIT,
    WARNING,
    AT_REFERENCE,
    BUS_CONTROL,
    FREQUENCY,
    IN_OPERATION,
    AUTO_START,
    VOLTAGE,
    TORQUE,
    TIMER,
];

/// The same in VLT 2800 and FCD 300.
static VLT_2800_STATUS: [Bit; 16] = [
    READY,
    DRIVE_READY,
    ENABLE,
    TRIP,
    bit(4, "OFF2", "OFF 2", "ON 2"),
    bit(5, "OFF3", "OFF 3", "ON 3"),
    START_INHIBIT,
    WARNING,
    AT_REFERENCE,
    BUS_CONTROL,
    FREQUENCY,
    IN_OPERATION,
    bit(12, "BIT12", "not used", "-"),
    VOLTAGE,
    bit(14, "CURRENT", "current limit", "current fine"),
    bit(15, "THERMAL", "thermal warning", "temperature fine"),
];

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
    control: [&PROFIDRIVE_CONTROL; 2],
    status: [&PROFIDRIVE_STATUS; 2],
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
    status: [&VLT_2800_STATUS; 2],
    says: Some(&VLT_2800_SAYS),
    ..SHARED
};

// Generated from data/profile/words.csv by `cargo run -p xtask -- gen`.

use crate::state::bits::Bit;

#[rustfmt::skip]
pub static STW1_VELOCITY: [Bit; 16] = [
Bit { number: 0, name: "ON", on: "ON", off: "OFF (OFF1): ramp stop, then S2", inverse: false },
Bit { number: 1, name: "OFF2", on: "OFF2 not active", off: "OFF2: coast stop, pulses off at once", inverse: true },
Bit { number: 2, name: "OFF3", on: "OFF3 not active", off: "OFF3: quick stop", inverse: true },
Bit { number: 3, name: "EN_OP", on: "operation enabled", off: "operation disabled", inverse: false },
Bit { number: 4, name: "EN_RAMP", on: "ramp generator enabled", off: "ramp generator output forced to 0", inverse: false },
Bit { number: 5, name: "UNFREEZE", on: "ramp generator runs", off: "ramp generator frozen", inverse: false },
Bit { number: 6, name: "EN_SETPOINT", on: "setpoint enabled", off: "setpoint 0: brakes along the ramp", inverse: false },
Bit { number: 7, name: "ACK", on: "acknowledge fault (the 0 to 1 edge counts)", off: "no acknowledge", inverse: false },
Bit { number: 8, name: "JOG1", on: "jog 1", off: "no jog 1", inverse: false },
Bit { number: 9, name: "JOG2", on: "jog 2", off: "no jog 2", inverse: false },
Bit { number: 10, name: "CTRL_PLC", on: "control by PLC: process data valid", off: "process data not valid, the drive ignores them", inverse: false },
Bit { number: 11, name: "BIT11", on: "device specific", off: "-", inverse: false },
Bit { number: 12, name: "BIT12", on: "device specific", off: "-", inverse: false },
Bit { number: 13, name: "BIT13", on: "device specific", off: "-", inverse: false },
Bit { number: 14, name: "BIT14", on: "device specific", off: "-", inverse: false },
Bit { number: 15, name: "BIT15", on: "device specific", off: "-", inverse: false },
];

#[rustfmt::skip]
pub static STW1_POSITION: [Bit; 16] = [
Bit { number: 0, name: "ON", on: "ON", off: "OFF (OFF1): ramp stop, then S2", inverse: false },
Bit { number: 1, name: "OFF2", on: "OFF2 not active", off: "OFF2: coast stop, pulses off at once", inverse: true },
Bit { number: 2, name: "OFF3", on: "OFF3 not active", off: "OFF3: quick stop", inverse: true },
Bit { number: 3, name: "EN_OP", on: "operation enabled", off: "operation disabled", inverse: false },
Bit { number: 4, name: "NO_REJECT", on: "traversing task not rejected", off: "reject traversing task: brakes with maximum deceleration, task lost", inverse: false },
Bit { number: 5, name: "NO_INT_STOP", on: "no intermediate stop", off: "intermediate stop: brakes along the ramp, task stays", inverse: false },
Bit { number: 6, name: "START_TASK", on: "activate traversing task (the 0 to 1 edge counts)", off: "no new traversing task", inverse: false },
Bit { number: 7, name: "ACK", on: "acknowledge fault (the 0 to 1 edge counts)", off: "no acknowledge", inverse: false },
Bit { number: 8, name: "JOG1", on: "jog 1", off: "no jog 1", inverse: false },
Bit { number: 9, name: "JOG2", on: "jog 2", off: "no jog 2", inverse: false },
Bit { number: 10, name: "CTRL_PLC", on: "control by PLC: process data valid", off: "process data not valid, the drive ignores them", inverse: false },
Bit { number: 11, name: "HOMING", on: "start homing", off: "no homing: a running one stops", inverse: false },
Bit { number: 12, name: "RT_JOG", on: "real-time jogging with the MDI values (AKD)", off: "no real-time jogging", inverse: false },
Bit { number: 13, name: "RT_JOG_CCW", on: "real-time jogging counter-clockwise (AKD)", off: "real-time jogging clockwise", inverse: false },
Bit { number: 14, name: "BIT14", on: "device specific", off: "-", inverse: false },
Bit { number: 15, name: "BIT15", on: "device specific", off: "-", inverse: false },
];

#[rustfmt::skip]
pub static ZSW1_VELOCITY: [Bit; 16] = [
Bit { number: 0, name: "READY_ON", on: "ready for switching on", off: "not ready for switching on", inverse: false },
Bit { number: 1, name: "READY_OP", on: "ready for operation", off: "not ready for operation", inverse: false },
Bit { number: 2, name: "OPERATION", on: "operation enabled, the drive follows the setpoint", off: "operation disabled", inverse: false },
Bit { number: 3, name: "FAULT", on: "fault present", off: "no fault", inverse: false },
Bit { number: 4, name: "OFF2", on: "OFF2 not active", off: "OFF2 active: coast stop", inverse: true },
Bit { number: 5, name: "OFF3", on: "OFF3 not active", off: "OFF3 active: quick stop", inverse: true },
Bit { number: 6, name: "INHIBIT", on: "switching on inhibited: OFF first, then ON", off: "switching on not inhibited", inverse: false },
Bit { number: 7, name: "WARNING", on: "warning present", off: "no warning", inverse: false },
Bit { number: 8, name: "IN_TOLERANCE", on: "speed error within tolerance", off: "speed error out of tolerance", inverse: false },
Bit { number: 9, name: "CTRL_REQ", on: "control requested from the PLC", off: "no control requested: local operation", inverse: false },
Bit { number: 10, name: "REACHED", on: "comparison speed reached", off: "comparison speed not reached", inverse: false },
Bit { number: 11, name: "BIT11", on: "device specific", off: "-", inverse: false },
Bit { number: 12, name: "BIT12", on: "device specific", off: "-", inverse: false },
Bit { number: 13, name: "BIT13", on: "device specific", off: "-", inverse: false },
Bit { number: 14, name: "BIT14", on: "device specific", off: "-", inverse: false },
Bit { number: 15, name: "BIT15", on: "device specific", off: "-", inverse: false },
];

#[rustfmt::skip]
pub static ZSW1_POSITION: [Bit; 16] = [
Bit { number: 0, name: "READY_ON", on: "ready for switching on", off: "not ready for switching on", inverse: false },
Bit { number: 1, name: "READY_OP", on: "ready for operation", off: "not ready for operation", inverse: false },
Bit { number: 2, name: "OPERATION", on: "operation enabled, the drive follows the setpoint", off: "operation disabled", inverse: false },
Bit { number: 3, name: "FAULT", on: "fault present", off: "no fault", inverse: false },
Bit { number: 4, name: "OFF2", on: "OFF2 not active", off: "OFF2 active: coast stop", inverse: true },
Bit { number: 5, name: "OFF3", on: "OFF3 not active", off: "OFF3 active: quick stop", inverse: true },
Bit { number: 6, name: "INHIBIT", on: "switching on inhibited: OFF first, then ON", off: "switching on not inhibited", inverse: false },
Bit { number: 7, name: "WARNING", on: "warning present", off: "no warning", inverse: false },
Bit { number: 8, name: "IN_TOLERANCE", on: "following error in the window", off: "following error out of the window", inverse: false },
Bit { number: 9, name: "CTRL_REQ", on: "control requested from the PLC", off: "no control requested: local operation", inverse: false },
Bit { number: 10, name: "REACHED", on: "target position reached", off: "target position not reached", inverse: false },
Bit { number: 11, name: "HOMED", on: "home position set", off: "home position not set", inverse: false },
Bit { number: 12, name: "TASK_ACK", on: "traversing task acknowledged", off: "no traversing task acknowledged", inverse: false },
Bit { number: 13, name: "STOPPED", on: "axis stands still", off: "axis moves", inverse: false },
Bit { number: 14, name: "TASK_ACTIVE", on: "motion task active (AKD)", off: "no motion task active", inverse: false },
Bit { number: 15, name: "BIT15", on: "device specific", off: "-", inverse: false },
];

// Generated from data/vlt/words.csv by `cargo run -p xtask -- gen`.

use crate::state::bits::Bit;

#[rustfmt::skip]
pub static FC_CONTROL: [Bit; 16] = [
Bit { number: 0, name: "PRESET_LSB", on: "preset reference 1 or 3", off: "preset reference 0 or 2", inverse: false },
Bit { number: 1, name: "PRESET_MSB", on: "preset reference 2 or 3", off: "preset reference 0 or 1", inverse: false },
Bit { number: 2, name: "DC_BRAKE", on: "ramp", off: "DC brake (2-01, 2-02), then stop", inverse: true },
Bit { number: 3, name: "COAST", on: "no coasting", off: "coasting: pulses off at once", inverse: true },
Bit { number: 4, name: "QUICK_STOP", on: "ramp", off: "quick stop on the ramp of 3-81", inverse: true },
Bit { number: 5, name: "HOLD", on: "use ramp", off: "hold output frequency", inverse: true },
Bit { number: 6, name: "START", on: "start", off: "ramp stop", inverse: false },
Bit { number: 7, name: "RESET", on: "reset (the 0 to 1 edge counts)", off: "no reset", inverse: false },
Bit { number: 8, name: "JOG", on: "jog at 3-19", off: "no jog", inverse: false },
Bit { number: 9, name: "RAMP_2", on: "ramp 2", off: "ramp 1", inverse: false },
Bit { number: 10, name: "DATA_VALID", on: "data valid", off: "data not valid, the drive ignores the word and the reference", inverse: false },
Bit { number: 11, name: "RELAY_1", on: "relay 1 on", off: "relay 1 off", inverse: false },
Bit { number: 12, name: "RELAY_2", on: "relay 2 on (older drives: relay 4)", off: "relay 2 off", inverse: false },
Bit { number: 13, name: "SETUP_LSB", on: "set-up 2 or 4", off: "set-up 1 or 3", inverse: false },
Bit { number: 14, name: "SETUP_MSB", on: "set-up 3 or 4", off: "set-up 1 or 2", inverse: false },
Bit { number: 15, name: "REVERSE", on: "reverse", off: "forward", inverse: false },
];

#[rustfmt::skip]
pub static PROFIDRIVE_CONTROL: [Bit; 16] = [
Bit { number: 0, name: "ON1", on: "ON 1", off: "OFF 1: ramp stop", inverse: false },
Bit { number: 1, name: "OFF2", on: "ON 2", off: "OFF 2: coasting, pulses off at once", inverse: true },
Bit { number: 2, name: "OFF3", on: "ON 3", off: "OFF 3: quick stop on the ramp of 3-81", inverse: true },
Bit { number: 3, name: "COAST", on: "no coasting", off: "coasting: pulses off at once", inverse: true },
Bit { number: 4, name: "QUICK_STOP", on: "ramp", off: "quick stop on the ramp of 3-81", inverse: true },
Bit { number: 5, name: "HOLD", on: "use ramp", off: "hold output frequency", inverse: true },
Bit { number: 6, name: "START", on: "start", off: "ramp stop", inverse: false },
Bit { number: 7, name: "RESET", on: "reset (the 0 to 1 edge counts)", off: "no reset", inverse: false },
Bit { number: 8, name: "JOG1", on: "jog 1 at 8-90 (with bit 4 = 0)", off: "no jog 1", inverse: false },
Bit { number: 9, name: "JOG2", on: "jog 2 at 8-91 (with bit 4 = 0)", off: "no jog 2", inverse: false },
Bit { number: 10, name: "DATA_VALID", on: "data valid", off: "data not valid, the drive ignores the word and the reference", inverse: false },
Bit { number: 11, name: "SLOW_DOWN", on: "reference less 3-12", off: "no slow down", inverse: false },
Bit { number: 12, name: "CATCH_UP", on: "reference plus 3-12", off: "no catch up", inverse: false },
Bit { number: 13, name: "SETUP_LSB", on: "set-up 2 or 4", off: "set-up 1 or 3", inverse: false },
Bit { number: 14, name: "SETUP_MSB", on: "set-up 3 or 4", off: "set-up 1 or 2", inverse: false },
Bit { number: 15, name: "REVERSE", on: "reverse", off: "forward", inverse: false },
];

#[rustfmt::skip]
pub static FC_STATUS: [Bit; 16] = [
Bit { number: 0, name: "CTRL_READY", on: "control ready", off: "control not ready (trip)", inverse: false },
Bit { number: 1, name: "DRIVE_READY", on: "drive ready", off: "drive not ready", inverse: false },
Bit { number: 2, name: "ENABLE", on: "enabled: starts on command", off: "coasting", inverse: false },
Bit { number: 3, name: "TRIP", on: "trip", off: "no trip", inverse: false },
Bit { number: 4, name: "ERROR", on: "error without trip", off: "no error", inverse: false },
Bit { number: 5, name: "BIT5", on: "reserved", off: "-", inverse: false },
Bit { number: 6, name: "TRIP_LOCK", on: "trip lock: reset by the mains only", off: "no trip lock", inverse: false },
Bit { number: 7, name: "WARNING", on: "warning", off: "no warning", inverse: false },
Bit { number: 8, name: "AT_REF", on: "speed = reference", off: "speed is not the reference", inverse: false },
Bit { number: 9, name: "BUS_CTRL", on: "bus control", off: "local operation", inverse: false },
Bit { number: 10, name: "FREQ_OK", on: "within the frequency limits", off: "at a frequency limit (4-12, 4-14)", inverse: false },
Bit { number: 11, name: "RUNNING", on: "in operation", off: "no operation", inverse: false },
Bit { number: 12, name: "AUTO_START", on: "stopped by temperature, starts again by itself", off: "not stopped by temperature", inverse: false },
Bit { number: 13, name: "VOLTAGE", on: "DC bus voltage exceeded", off: "voltage fine", inverse: false },
Bit { number: 14, name: "TORQUE", on: "current or torque limit exceeded", off: "torque fine", inverse: false },
Bit { number: 15, name: "TIMER", on: "thermal timer exceeded", off: "timers fine", inverse: false },
];

#[rustfmt::skip]
pub static PROFIDRIVE_STATUS: [Bit; 16] = [
Bit { number: 0, name: "CTRL_READY", on: "control ready", off: "control not ready", inverse: false },
Bit { number: 1, name: "DRIVE_READY", on: "drive ready", off: "drive not ready", inverse: false },
Bit { number: 2, name: "ENABLE", on: "enabled", off: "coasting, or OFF commanded", inverse: false },
Bit { number: 3, name: "TRIP", on: "trip", off: "no trip", inverse: false },
Bit { number: 4, name: "OFF2", on: "ON 2", off: "OFF 2", inverse: true },
Bit { number: 5, name: "OFF3", on: "ON 3", off: "OFF 3", inverse: true },
Bit { number: 6, name: "NO_START", on: "start not possible: OFF first, then ON", off: "start possible", inverse: false },
Bit { number: 7, name: "WARNING", on: "warning", off: "no warning", inverse: false },
Bit { number: 8, name: "AT_REF", on: "speed = reference", off: "speed is not the reference", inverse: false },
Bit { number: 9, name: "BUS_CTRL", on: "bus control", off: "local operation", inverse: false },
Bit { number: 10, name: "FREQ_OK", on: "within the frequency limits", off: "at a frequency limit (4-12, 4-14)", inverse: false },
Bit { number: 11, name: "RUNNING", on: "in operation", off: "no operation", inverse: false },
Bit { number: 12, name: "AUTO_START", on: "stopped by temperature, starts again by itself", off: "not stopped by temperature", inverse: false },
Bit { number: 13, name: "VOLTAGE", on: "DC bus voltage exceeded", off: "voltage fine", inverse: false },
Bit { number: 14, name: "TORQUE", on: "current or torque limit exceeded", off: "torque fine", inverse: false },
Bit { number: 15, name: "TIMER", on: "thermal timer exceeded", off: "timers fine", inverse: false },
];

#[rustfmt::skip]
pub static VLT_2800_STATUS: [Bit; 16] = [
Bit { number: 0, name: "CTRL_READY", on: "control ready", off: "control not ready", inverse: false },
Bit { number: 1, name: "DRIVE_READY", on: "drive ready", off: "drive not ready", inverse: false },
Bit { number: 2, name: "ENABLE", on: "enabled", off: "coasting, or OFF commanded", inverse: false },
Bit { number: 3, name: "TRIP", on: "trip", off: "no trip", inverse: false },
Bit { number: 4, name: "OFF2", on: "OFF 2", off: "ON 2", inverse: false },
Bit { number: 5, name: "OFF3", on: "OFF 3", off: "ON 3", inverse: false },
Bit { number: 6, name: "NO_START", on: "start not possible: OFF first, then ON", off: "start possible", inverse: false },
Bit { number: 7, name: "WARNING", on: "warning", off: "no warning", inverse: false },
Bit { number: 8, name: "AT_REF", on: "speed = reference", off: "speed is not the reference", inverse: false },
Bit { number: 9, name: "BUS_CTRL", on: "bus control", off: "local operation", inverse: false },
Bit { number: 10, name: "FREQ_OK", on: "within the frequency limits", off: "at a frequency limit (4-12, 4-14)", inverse: false },
Bit { number: 11, name: "RUNNING", on: "in operation", off: "no operation", inverse: false },
Bit { number: 12, name: "BIT12", on: "not used", off: "-", inverse: false },
Bit { number: 13, name: "VOLTAGE", on: "DC bus voltage exceeded", off: "voltage fine", inverse: false },
Bit { number: 14, name: "CURRENT", on: "current limit", off: "current fine", inverse: false },
Bit { number: 15, name: "THERMAL", on: "thermal warning", off: "temperature fine", inverse: false },
];

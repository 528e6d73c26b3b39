// Generated from data/vacon/words.csv by `cargo run -p xtask -- gen`.

use crate::state::bits::Bit;

#[rustfmt::skip]
pub static PPO_CONTROL: [Bit; 16] = [
Bit { number: 0, name: "ON1", on: "ON 1", off: "stop 1: by ramp", inverse: false },
Bit { number: 1, name: "STOP2", on: "ON 2", off: "stop 2: coasting, pulses off at once", inverse: true },
Bit { number: 2, name: "STOP3", on: "ON 3", off: "stop 3: by ramp, then start inhibited", inverse: true },
Bit { number: 3, name: "RUN_EN", on: "run enabled", off: "run disabled", inverse: false },
Bit { number: 4, name: "START_4", on: "start (with bits 5 and 6)", off: "no start", inverse: false },
Bit { number: 5, name: "START_5", on: "start (with bits 4 and 6)", off: "no start", inverse: false },
Bit { number: 6, name: "START_6", on: "start (with bits 4 and 5)", off: "no start", inverse: false },
Bit { number: 7, name: "RESET", on: "fault reset (the 0 to 1 edge counts)", off: "no reset", inverse: false },
Bit { number: 8, name: "BIT8", on: "not used", off: "-", inverse: false },
Bit { number: 9, name: "BIT9", on: "not used", off: "-", inverse: false },
Bit { number: 10, name: "FB_CTRL", on: "field bus control enabled", off: "field bus control disabled: the drive ignores the word and the reference", inverse: false },
Bit { number: 11, name: "FB_DIN1", on: "field bus input 1 on", off: "field bus input 1 off", inverse: false },
Bit { number: 12, name: "FB_DIN2", on: "field bus input 2 on", off: "field bus input 2 off", inverse: false },
Bit { number: 13, name: "FB_DIN3", on: "field bus input 3 on", off: "field bus input 3 off", inverse: false },
Bit { number: 14, name: "FB_DIN4", on: "field bus input 4 on", off: "field bus input 4 off", inverse: false },
Bit { number: 15, name: "FB_DIN5", on: "field bus input 5 on", off: "field bus input 5 off", inverse: false },
];

#[rustfmt::skip]
pub static PPO_STATUS: [Bit; 16] = [
Bit { number: 0, name: "READY_1", on: "ready 1", off: "not ready", inverse: false },
Bit { number: 1, name: "READY_2", on: "ready 2", off: "not ready", inverse: false },
Bit { number: 2, name: "ENABLED", on: "enabled", off: "disabled", inverse: false },
Bit { number: 3, name: "FAULT", on: "fault active", off: "no fault", inverse: false },
Bit { number: 4, name: "STOP2", on: "no stop 2", off: "stop 2: coasting", inverse: true },
Bit { number: 5, name: "STOP3", on: "no stop 3", off: "stop 3", inverse: true },
Bit { number: 6, name: "NO_START", on: "start disabled: bit 0 = 0 first, then 1", off: "start enabled", inverse: false },
Bit { number: 7, name: "WARNING", on: "warning", off: "no warning", inverse: false },
Bit { number: 8, name: "AT_REF", on: "reference = actual value", off: "reference is not the actual value", inverse: false },
Bit { number: 9, name: "FB_CTRL", on: "field bus control on", off: "field bus control off", inverse: false },
Bit { number: 10, name: "BIT10", on: "not used", off: "-", inverse: false },
Bit { number: 11, name: "BIT11", on: "not used", off: "-", inverse: false },
Bit { number: 12, name: "RUNNING", on: "running", off: "stopped", inverse: false },
Bit { number: 13, name: "READY", on: "drive ready", off: "drive not ready", inverse: false },
Bit { number: 14, name: "BIT14", on: "not used", off: "-", inverse: false },
Bit { number: 15, name: "BIT15", on: "not used", off: "-", inverse: false },
];

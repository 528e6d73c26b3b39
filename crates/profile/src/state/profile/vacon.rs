//! The words of the vendor telegrams 148 to 150 of Vacon drives, as tables.
//!
//! Source: OPTEA manual p. 103 and 104; OPTCP manual 5.1.1 and 5.1.2. The state machine behind them is that of PROFIdrive
//! 2.0: bit 6 of the status word is its inhibit, which bit 0 = 0 of the control word ends (CX Profibus manual p. 16).

use super::{Asks, Bit, Extras, Facts, Gives, NO_EXTRAS, Says, SpeedCommand, SpeedRule, Start, Stw1, Zsw1};
use crate::state::Setpoint;
use crate::state::bits::{bit, inverse};

static CONTROL: [Bit; 16] = [
    bit(0, "ON1", "ON 1", "stop 1: by ramp"),
    inverse(1, "STOP2", "ON 2", "stop 2: coasting, pulses off at once"),
    inverse(2, "STOP3", "ON 3", "stop 3: by ramp, then start inhibited"),
    bit(3, "RUN_EN", "run enabled", "run disabled"),
    bit(4, "START_4", "start (with bits 5 and 6)", "no start"),
    bit(5, "START_5", "start (with bits 4 and 6)", "no start"),
    bit(6, "START_6", "start (with bits 4 and 5)", "no start"),
    bit(7, "RESET", "fault reset (the 0 to 1 edge counts)", "no reset"),
    bit(8, "BIT8", "not used", "-"),
    bit(9, "BIT9", "not used", "-"),
    bit(
        10,
        "FB_CTRL",
        "field bus control enabled",
        "field bus control disabled: the drive ignores the word and the reference",
    ),
    bit(11, "FB_DIN1", "field bus input 1 on", "field bus input 1 off"),
    bit(12, "FB_DIN2", "field bus input 2 on", "field bus input 2 off"),
    bit(13, "FB_DIN3", "field bus input 3 on", "field bus input 3 off"),
    bit(14, "FB_DIN4", "field bus input 4 on", "field bus input 4 off"),
    bit(15, "FB_DIN5", "field bus input 5 on", "field bus input 5 off"),
];

static STATUS: [Bit; 16] = [
    bit(0, "READY_1", "ready 1", "not ready"),
    bit(1, "READY_2", "ready 2", "not ready"),
    bit(2, "ENABLED", "enabled", "disabled"),
    bit(3, "FAULT", "fault active", "no fault"),
    inverse(4, "STOP2", "no stop 2", "stop 2: coasting"),
    inverse(5, "STOP3", "no stop 3", "stop 3"),
    bit(
        6,
        "NO_START",
        "start disabled: bit 0 = 0 first, then 1",
        "start enabled",
    ),
    bit(7, "WARNING", "warning", "no warning"),
    bit(
        8,
        "AT_REF",
        "reference = actual value",
        "reference is not the actual value",
    ),
    bit(9, "FB_CTRL", "field bus control on", "field bus control off"),
    bit(10, "BIT10", "not used", "-"),
    bit(11, "BIT11", "not used", "-"),
    bit(12, "RUNNING", "running", "stopped"),
    bit(13, "READY", "drive ready", "drive not ready"),
    bit(14, "BIT14", "not used", "-"),
    bit(15, "BIT15", "not used", "-"),
];

/// Bits 4, 5 and 6: only all of them start.
const START_BITS: u16 = 0x70;
const CHANNEL: Stw1 = Stw1(START_BITS);

const fn same(number: u8) -> Gives {
    Gives {
        stw1: Stw1(1 << number),
        all: 1 << number,
        one_of: 0,
    }
}

const fn ask(number: u8) -> Asks {
    Asks {
        word: 1 << number,
        stw1: Stw1(1 << number),
    }
}

/// Vendor telegrams. Without all of the start bits the motor ramps to standstill; ours, the source says "no action".
pub(super) static PPO: Facts = Facts {
    key: "vacon",
    name: "Vacon vendor PPO",
    control: [&CONTROL; 2],
    status: [&STATUS; 2],
    start: Start::AfterOff,
    quick_stop_on_ramp: true,
    zero_on_quick_ramp: false,
    gives: Some(&[
        same(0),
        same(1),
        same(2),
        same(3),
        Gives {
            stw1: CHANNEL,
            all: START_BITS,
            one_of: 0,
        },
        Gives {
            stw1: Stw1(Stw1::ENABLE_RAMP.0 | Stw1::UNFREEZE_RAMP.0),
            all: 0,
            one_of: 0,
        },
        same(7),
        same(10),
    ]),
    asks: &[
        ask(0),
        ask(1),
        ask(2),
        ask(3),
        Asks {
            word: START_BITS,
            stw1: CHANNEL,
        },
        ask(7),
        ask(10),
    ],
    speeds: &[
        SpeedRule {
            mask: START_BITS,
            value: START_BITS,
            speed: SpeedCommand::Channel(Setpoint::Follow),
        },
        SpeedRule {
            mask: 0,
            value: 0,
            speed: SpeedCommand::Channel(Setpoint::RampToZero),
        },
    ],
    extras: Extras {
        digital_inputs: Some(11),
        ..NO_EXTRAS
    },
    says: Some(&[
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
        Says::Nothing,
        Says::Nothing,
        Says::Running,
        Says::DriveReady,
        Says::Nothing,
        Says::Nothing,
    ]),
};

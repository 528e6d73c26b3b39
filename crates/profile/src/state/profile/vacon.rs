//! The words of the vendor telegrams 148 to 150 of Vacon drives, as tables. The bits are in `data/vacon/words.csv`.
//!
//! Source: OPTEA manual p. 103 and 104; OPTCP manual 5.1.1 and 5.1.2. The state machine behind them is that of PROFIdrive
//! 2.0: bit 6 of the status word is its inhibit, which bit 0 = 0 of the control word ends (CX Profibus manual p. 16).

mod generated_bits;

use super::{
    Extras, Facts, FromWord, NO_EXTRAS, SpeedCommand, SpeedRule, Start, StatusBit, Stw1, ToWord, Zsw1,
};
use crate::state::Setpoint;

/// Bits 4, 5 and 6: only all of them start.
const START_BITS: u16 = 0x70;
const CHANNEL: Stw1 = Stw1(START_BITS);

const fn same(number: u8) -> FromWord {
    FromWord {
        stw1: Stw1(1 << number),
        all: 1 << number,
        one_of: 0,
    }
}

const fn ask(number: u8) -> ToWord {
    ToWord {
        word: 1 << number,
        stw1: Stw1(1 << number),
    }
}

/// Vendor telegrams. Without all of the start bits the motor ramps to standstill; own choice, the source states "no
/// action".
pub(super) static PPO: Facts = Facts {
    key: "vacon",
    name: "Vacon vendor PPO",
    control: [&generated_bits::PPO_CONTROL; 2],
    status: [&generated_bits::PPO_STATUS; 2],
    start: Start::AfterOff,
    quick_stop_on_ramp: true,
    zero_on_quick_ramp: false,
    from_word: Some(&[
        same(0),
        same(1),
        same(2),
        same(3),
        FromWord {
            stw1: CHANNEL,
            all: START_BITS,
            one_of: 0,
        },
        FromWord {
            stw1: Stw1(Stw1::ENABLE_RAMP.0 | Stw1::UNFREEZE_RAMP.0),
            all: 0,
            one_of: 0,
        },
        same(7),
        same(10),
    ]),
    to_word: &[
        ask(0),
        ask(1),
        ask(2),
        ask(3),
        ToWord {
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
    status_bits: Some(&[
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
        StatusBit::Nothing,
        StatusBit::Nothing,
        StatusBit::Running,
        StatusBit::DriveReady,
        StatusBit::Nothing,
        StatusBit::Nothing,
    ]),
};

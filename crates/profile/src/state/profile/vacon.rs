//! The words of the vendor telegrams 148 to 150 of Vacon drives, as tables. The bits are in `data/vacon/words.csv`.
//!
//! Source: OPTEA manual p. 103 and 104; OPTCP manual 5.1.1 and 5.1.2. The state machine behind them is that of PROFIdrive
//! 2.0: bit 6 of the status word is its inhibit, which bit 0 = 0 of the control word ends (CX Profibus manual p. 16).

mod generated_bits;

use super::{Asks, Extras, Facts, Gives, NO_EXTRAS, Says, SpeedCommand, SpeedRule, Start, Stw1, Zsw1};
use crate::state::Setpoint;

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

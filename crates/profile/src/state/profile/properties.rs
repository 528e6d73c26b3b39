//! What holds whatever is sent, with faults and the drive's own stops in between.

use proptest::prelude::*;

use super::*;
use crate::state::FaultReaction;

/// Words as a controller sends them, with a bit flipped now and then, or any word.
fn words() -> impl Strategy<Value = u16> {
    let usual = prop_oneof![
        Just(Stw1::READY.0),
        Just(Stw1::RUN.0),
        Just(Stw1::ACKNOWLEDGE.0),
        Just(Stw1::COAST_STOP.0),
        Just(Stw1::QUICK_STOP.0),
        Just(0x043C),
        Just(0x047C),
        Just(0x04FC),
    ];
    prop_oneof![
        4 => usual.clone(),
        2 => (usual, 0..16_u32).prop_map(|(word, bit)| word ^ (1 << bit)),
        1 => any::<u16>(),
    ]
}

fn faults() -> impl Strategy<Value = Option<FaultReaction>> {
    prop_oneof![
        20 => Just(None),
        1 => Just(Some(FaultReaction::Coast)),
        1 => Just(Some(FaultReaction::QuickStop)),
        1 => Just(Some(FaultReaction::RampStop)),
    ]
}

proptest! {
    #[test]
    fn the_words_say_what_the_machine_does(
        profile in proptest::sample::select(Profile::ALL.to_vec()),
        cycles in proptest::collection::vec(
            (words(), any::<bool>(), faults(), proptest::bool::weighted(0.1), proptest::bool::weighted(0.1)),
            1..60,
        ),
    ) {
        let mut machine = Machine::new();
        for (word, standstill, fault, coast_stop, quick_stop) in cycles {
            let from = machine.state();
            let orders = profile.orders(word, from);
            let output = profile.step(&mut machine, &Inputs {
                stw1: orders.stw1,
                standstill,
                fault,
                coast_stop,
                quick_stop,
                ..Inputs::default()
            });
            prop_assert_eq!(output.state, machine.state());
            let mut at = from;
            for row in output.path.iter() {
                prop_assert_eq!(row.from, at);
                at = row.to;
            }
            prop_assert_eq!(at, output.state);

            let status = profile.status(output.state, output.zsw1, &Conditions::default());
            let has = |bit: u16| status & (1 << bit) != 0;
            let general = profile.zsw1(status, if output.accepted { word } else { 0 });
            prop_assert_eq!(has(3), machine.fault());
            prop_assert_eq!(general.has(Zsw1::FAULT), machine.fault());
            prop_assert!(has(9) && general.has(Zsw1::CONTROL_REQUESTED));
            match profile {
                Profile::Profidrive => prop_assert_eq!(status, output.zsw1.0),
                Profile::DanfossProfidrive => {
                    prop_assert_eq!(status & 0x7F, output.zsw1.0 & 0x7F);
                    prop_assert_eq!(has(11), output.state.pulses());
                }
                Profile::Vlt2800Profidrive => prop_assert_eq!((status ^ 0x30) & 0x7F, output.zsw1.0 & 0x7F),
                Profile::VaconPpo => {
                    prop_assert_eq!(status & 0x7F, output.zsw1.0 & 0x7F);
                    prop_assert_eq!(has(12), output.state.pulses());
                }
                Profile::DanfossFc => {
                    prop_assert_eq!(has(11), output.state.pulses());
                    prop_assert_eq!(has(0), !machine.fault());
                    prop_assert!(has(2) || output.state == State::S1 || machine.fault());
                    // By level: what is asked for and nothing stands against happens in the same cycle.
                    let run = orders.stw1.has(Stw1(0x040F)) && !machine.fault() && !coast_stop && !quick_stop;
                    prop_assert!(!run || output.state.pulses(), "{:?} {:04X}", from, word);
                }
            }
            // The drive's own stops and a fault win over every word.
            if coast_stop || fault == Some(FaultReaction::Coast) {
                prop_assert_eq!(output.state, State::S1);
            }
            if output.state == State::S4 {
                prop_assert!(!machine.fault() && !quick_stop);
            }
        }
    }

    /// OFF before the word: it starts from wherever it stands, and only if nothing stands against it.
    #[test]
    fn rearmed_it_starts(cycles in proptest::collection::vec((words(), any::<bool>(), faults()), 0..20)) {
        let mut machine = Machine::new();
        for (word, standstill, fault) in cycles {
            machine.step(&Inputs { stw1: Stw1(word), standstill, fault, ..Inputs::default() });
        }
        let inputs = Inputs { local: Some(Stw1::RUN), standstill: true, ..Inputs::default() };
        machine.rearm(&inputs);
        let output = machine.step(&inputs);
        prop_assert_eq!(output.state, if machine.fault() { State::S1 } else { State::S4 });
    }
}

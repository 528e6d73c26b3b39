//! Every control word in every state, for every profile.

use super::*;

const CONDITIONS: [bool; 2] = [false, true];

/// The machine in a state, as far as words lead there, with the profile's own words.
fn reach(profile: Profile, state: State) -> Option<Machine> {
    let words: &[Stw1] = match state {
        State::S1 => &[Stw1::COAST_STOP],
        State::S2 => &[Stw1::READY],
        State::S3 => &[Stw1::READY, Stw1(0x0477)],
        State::S4 => &[Stw1::READY, Stw1::RUN],
        State::S5Ramp => &[Stw1::READY, Stw1::RUN, Stw1::READY],
        State::S5Quick => &[Stw1::READY, Stw1::RUN, Stw1::QUICK_STOP],
    };
    let mut machine = Machine::new();
    for stw1 in words {
        let word = profile.control(*stw1);
        let inputs = Inputs {
            stw1: profile.orders(word, machine.state()).stw1,
            ..Inputs::default()
        };
        profile.step(&mut machine, &inputs);
    }
    (machine.state() == state).then_some(machine)
}

#[test]
fn the_status_word_never_disagrees_with_the_state() {
    for profile in Profile::ALL {
        let mut reached = 0;
        for from in State::ALL {
            let Some(start) = reach(profile, from) else {
                assert_eq!(
                    (profile, from),
                    (Profile::DanfossFc, State::S3),
                    "cannot be reached"
                );
                continue;
            };
            reached += 1;
            for word in 0..=u16::MAX {
                for standstill in CONDITIONS {
                    let mut machine = start.clone();
                    let orders = profile.orders(word, from);
                    let inputs = Inputs {
                        stw1: orders.stw1,
                        standstill,
                        ..Inputs::default()
                    };
                    let output = profile.step(&mut machine, &inputs);
                    let at = || alloc::format!("{profile:?} {from:?} {word:04X} {standstill}");
                    // Whole steps only, joined.
                    let mut state = from;
                    for row in output.path.iter() {
                        assert_eq!(row.from, state, "{}", at());
                        state = row.to;
                    }
                    assert_eq!(state, output.state, "{}", at());
                    let status = profile.status(output.state, output.zsw1, &Conditions::default());
                    // A word that was not accepted is not the one in force.
                    if output.accepted {
                        let decoded = profile.state(status, word);
                        // A quick stop that runs to its end looks like operation in an FC word.
                        let hidden = profile == Profile::DanfossFc && output.state == State::S5Quick;
                        let same = decoded == Some(output.state);
                        let fits = same || (hidden && decoded.is_some_and(State::pulses));
                        assert!(fits, "{} {status:04X} {decoded:?}", at());
                    }
                    // Only the requested bits start it.
                    if output.state == State::S4 && from != State::S4 {
                        assert!(orders.stw1.has(Stw1(0x000F)) || !output.accepted, "{}", at());
                    }
                }
            }
        }
        assert_eq!(reached, if profile == Profile::DanfossFc { 5 } else { 6 });
    }
}

#[test]
fn profidrive_is_the_general_machine() {
    for from in State::ALL {
        let start = reach(Profile::Profidrive, from).unwrap();
        for word in 0..=u16::MAX {
            let orders = Profile::Profidrive.orders(word, from);
            assert_eq!(
                orders,
                Orders {
                    stw1: Stw1(word),
                    ..Orders::default()
                }
            );
            let inputs = Inputs {
                stw1: Stw1(word),
                status: Zsw1(0xFFFF),
                ..Inputs::default()
            };
            let (mut machine, mut plain) = (start.clone(), start.clone());
            let output = Profile::Profidrive.step(&mut machine, &inputs);
            assert_eq!(output, plain.step(&inputs));
            assert_eq!(machine, plain);
            let status = Profile::Profidrive.status(output.state, output.zsw1, &Conditions::default());
            assert_eq!(status, output.zsw1.0);
            assert_eq!(Profile::Profidrive.control(Stw1(word)), word);
        }
    }
}

#[test]
fn commands_decode_as_encoded() {
    // Bits 4, 5 and 6 of STW1 go by what they let through.
    for profile in Profile::ALL {
        for bits in 0..=u16::MAX {
            let asked = Stw1(bits);
            let word = profile.control(asked);
            let understood = profile.orders(word, State::S2).stw1;
            let mask = match profile {
                // Without operation it coasts, jog is a start of its own, without the setpoint it is not started.
                Profile::DanfossFc if bits & 0x58 != 0x58 => Stw1(0x0484),
                _ => Stw1(0x048F),
            };
            assert_eq!(
                understood & mask,
                asked & mask,
                "{profile:?} {bits:04X} {word:04X}"
            );
        }
    }
}

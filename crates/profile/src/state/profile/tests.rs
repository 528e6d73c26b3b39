//! Words of the manuals, and the starts and stops of each profile.

use alloc::vec::Vec;

use super::*;
use crate::state::FaultReaction;

/// A drive that follows a command at once or, while `turning`, with a delay.
struct Drive {
    profile: Profile,
    machine: Machine,
    orders: Orders,
    turning: bool,
    conditions: Conditions,
    fault: Option<FaultReaction>,
    local: Option<Stw1>,
}

impl Drive {
    fn new(profile: Profile) -> Self {
        Self {
            profile,
            machine: Machine::new(),
            orders: Orders::default(),
            turning: false,
            conditions: Conditions {
                within_frequency_limits: true,
                at_reference: true,
                ..Conditions::default()
            },
            fault: None,
            local: None,
        }
    }

    fn send(&mut self, word: u16) -> (State, u16) {
        let orders = self.profile.orders(word, self.machine.state());
        let output = self.profile.step(
            &mut self.machine,
            &Inputs {
                stw1: orders.stw1,
                standstill: !self.turning,
                fault: self.fault.take(),
                local: self.local,
                ..Inputs::default()
            },
        );
        if output.accepted {
            self.orders = orders;
        }
        let status = self.profile.status(output.state, output.zsw1, &self.conditions);
        (output.state, status)
    }

    fn state(&mut self, word: u16) -> State {
        self.send(word).0
    }

    fn status(&mut self, word: u16) -> u16 {
        self.send(word).1
    }
}

const FC: Profile = Profile::DanfossFc;
const DANFOSS: Profile = Profile::DanfossProfidrive;
const PPO: Profile = Profile::VaconPpo;

#[test]
fn fc_words_of_the_references() {
    let mut drive = Drive::new(FC);
    // Coasting, nothing sent yet: ready, bus control, frequency fine.
    assert_eq!(drive.send(0x0000), (State::S1, 0x0603));
    // Ramp stop: enabled, not running.
    assert_eq!(drive.send(0x043C), (State::S2, 0x0607));
    // Start: running at the reference.
    assert_eq!(drive.send(0x047C), (State::S4, 0x0F07));
    drive.conditions.at_reference = false;
    drive.turning = true;
    assert_eq!(drive.send(0x047C), (State::S4, 0x0E07));
    assert_eq!(drive.send(0x043C), (State::S5Ramp, 0x0E07));
    drive.turning = false;
    assert_eq!(drive.send(0x043C), (State::S2, 0x0607));
    assert_eq!(FC.control(Stw1::RUN), 0x047C);
    assert_eq!(FC.control(Stw1::READY), 0x043C);
    assert_eq!(FC.control(Stw1::QUICK_STOP), 0x046C);
    assert_eq!(FC.control(Stw1::COAST_STOP), 0x0474);
    assert_eq!(FC.control(Stw1::ACKNOWLEDGE), 0x04BC);
    assert_eq!(FC.control(Stw1(0x050F)), 0x053C);
}

#[test]
fn fc_starts_by_level_from_power_on_after_coast_quick_stop_and_reset() {
    let mut drive = Drive::new(FC);
    assert_eq!(drive.state(0x047C), State::S4);
    drive.turning = true;
    assert_eq!(drive.state(0x0474), State::S1);
    assert_eq!(drive.state(0x047C), State::S4);
    // The quick stop goes to its end, then the start counts again.
    assert_eq!(drive.state(0x046C), State::S5Quick);
    assert_eq!(drive.state(0x047C), State::S5Quick);
    drive.turning = false;
    assert_eq!(drive.state(0x046C), State::S1);
    assert_eq!(drive.state(0x046C), State::S1);
    assert_eq!(drive.state(0x047C), State::S4);
    // Trip and reset.
    drive.fault = Some(FaultReaction::Coast);
    assert_eq!(drive.send(0x047C), (State::S1, 0x0608));
    assert_eq!(drive.send(0x047C), (State::S1, 0x0608));
    drive.conditions.trip_locked = true;
    assert_eq!(drive.status(0x047C), 0x0648);
    drive.conditions.trip_locked = false;
    assert_eq!(drive.state(0x04BC), State::S2);
    drive.fault = Some(FaultReaction::Coast);
    drive.send(0x047C);
    let orders = FC.orders(0x04FC, State::S1);
    let output = FC.step(
        &mut drive.machine,
        &Inputs {
            stw1: orders.stw1,
            standstill: true,
            ..Inputs::default()
        },
    );
    assert!(output.acknowledged);
    assert_eq!(output.state, State::S4);
    let states: Vec<_> = output.path.iter().map(|row| row.to).collect();
    assert_eq!(states, [State::S2, State::S3, State::S4]);
}

#[test]
fn fc_without_valid_data_keeps_the_last_word() {
    let mut drive = Drive::new(FC);
    assert_eq!(drive.state(0x007C), State::S1);
    drive.state(0x847C);
    assert_eq!(drive.state(0x0000), State::S4);
    assert!(drive.orders.reverse);
}

#[test]
fn fc_orders_beside_the_state_machine() {
    let of = |word| FC.orders(word, State::S2);
    let speed = |word| of(word).speed.unwrap();
    assert_eq!(speed(0x047C), SpeedCommand::Channel(Setpoint::Follow));
    assert_eq!(speed(0x057C), SpeedCommand::Jog1);
    assert_eq!(speed(0x045C), SpeedCommand::Channel(Setpoint::Freeze));
    for preset in 0..4_u8 {
        let orders = of(0x047C | u16::from(preset) | u16::from(preset) << 13);
        assert_eq!((orders.preset, orders.set_up), (Some(preset), Some(preset)));
        assert_eq!(orders.relays, Some([false; 2]));
    }
    assert!(of(0x067C).second_ramp && !of(0x047C).second_ramp);
    assert!(of(0x847C).reverse && !of(0x047C).reverse);
    assert_eq!(of(0x0C7C).relays, Some([true, false]));
    assert_eq!(of(0x147C).relays, Some([false, true]));
    // DC brake: no ON, so the motor is switched off when it has stopped.
    let brake = of(0x0478);
    assert!(brake.dc_brake && !brake.stw1.has(Stw1::ON) && !of(0x047C).dc_brake);
    // Jog starts by itself and stops with its bit.
    let mut drive = Drive::new(FC);
    assert_eq!(drive.state(0x053C), State::S4);
    drive.turning = true;
    assert_eq!(drive.state(0x043C), State::S5Ramp);
}

#[test]
fn fc_hold_is_ended_by_coast_and_dc_brake_only() {
    let mut drive = Drive::new(FC);
    drive.state(0x047C);
    drive.turning = true;
    for word in [0x045C, 0x041C, 0x044C, 0x040C] {
        assert_eq!(drive.state(word), State::S4, "{word:04X}");
        assert_eq!(drive.orders.speed, Some(SpeedCommand::Channel(Setpoint::Freeze)));
    }
    assert_eq!(drive.state(0x0418), State::S5Ramp);
    assert!(drive.orders.dc_brake);
    drive.state(0x047C);
    assert_eq!(drive.state(0x0454), State::S1);
    // At standstill it starts nothing.
    assert_eq!(drive.state(0x041C), State::S2);
}

/// Profile statements 76 to 97, for the words that share bits 0 to 10 with STW1.
#[test]
fn statements_of_the_state_machine() {
    for profile in [Profile::Profidrive, DANFOSS, PPO] {
        let new = || Drive::new(profile);
        // 76: S1 to S2.
        for ready in [0x0476, 0x047E] {
            assert_eq!(new().status(ready) & 0x77, 0x31, "{profile:?}");
        }
        // 79: no start without an edge.
        let mut drive = new();
        for _ in 0..3 {
            let (state, status) = drive.send(0x047F);
            assert_eq!((state, status & 0x40), (State::S1, 0x40));
        }
        // 82: ramp stop.
        let mut drive = new();
        drive.send(0x047E);
        assert_eq!(drive.status(0x047F) & 0x77, 0x37);
        drive.turning = true;
        let (state, status) = drive.send(0x047E);
        assert_eq!((state, status & 0x42), (State::S5Ramp, 0x02));
        drive.turning = false;
        assert_eq!(drive.status(0x047E) & 0x77, 0x31);
        // 85: a quick stop is not taken back.
        drive.send(0x047F);
        drive.turning = true;
        drive.send(0x047B);
        assert_eq!(drive.state(0x047F), State::S5Quick);
        drive.turning = false;
        assert_eq!(drive.state(0x047F), State::S1);
        // 88: the inhibit is kept until OFF.
        drive.send(0x047E);
        drive.send(0x047F);
        drive.send(0x047D);
        assert_eq!(drive.status(0x047F) & 0x77, 0x70);
        assert_eq!(drive.state(0x047E), State::S2);
        // 91: control by PLC.
        assert_eq!(drive.state(0x007F), State::S2);
        assert_eq!(drive.state(0x047F), State::S4);
        // 94: acknowledge.
        drive.fault = Some(FaultReaction::Coast);
        assert_eq!(drive.status(0x047F) & 0x08, 0x08);
        drive.send(0x047E);
        assert_eq!(drive.status(0x04FE) & 0x08, 0);
        assert_eq!(drive.status(0x047E) & 0x77, 0x31);
        // 97: local operation.
        drive.local = Some(Stw1(0x047E));
        assert_eq!(drive.status(0x047E) & 0x0200, 0);
        assert_eq!(drive.status(0x047F) & 0x0277, 0x31);
        drive.local = None;
        assert_eq!(drive.status(0x047E) & 0x0200, 0x0200);
    }
}

#[test]
fn danfoss_profidrive_words() {
    let mut drive = Drive::new(DANFOSS);
    assert_eq!(drive.send(0x0000), (State::S1, 0x0640));
    assert_eq!(drive.send(0x0476), (State::S2, 0x0631));
    assert_eq!(drive.send(0x047F), (State::S4, 0x0F37));
    let speed = |word| DANFOSS.orders(word, State::S4).speed.unwrap();
    assert_eq!(speed(0x047F), SpeedCommand::Channel(Setpoint::Follow));
    assert_eq!(speed(0x046F), SpeedCommand::Channel(Setpoint::ZeroAtLimits));
    assert_eq!(speed(0x045F), SpeedCommand::Channel(Setpoint::Freeze));
    assert_eq!(speed(0x043F), SpeedCommand::Channel(Setpoint::RampToZero));
    assert_eq!(speed(0x056F), SpeedCommand::Jog1);
    assert_eq!(speed(0x066F), SpeedCommand::Jog2);
    assert_eq!(speed(0x057F), SpeedCommand::Channel(Setpoint::Follow));
    assert!(DANFOSS.zero_on_quick_ramp());
    let of = |word| DANFOSS.orders(word, State::S4);
    assert_eq!(of(0x0C7F).correction, Correction::SlowDown);
    assert_eq!(of(0x147F).correction, Correction::CatchUp);
    assert_eq!(of(0x1C7F).correction, Correction::SlowDown);
    assert_eq!(of(0x047F).correction, Correction::None);
    assert!(of(0x847F).reverse && of(0x647F).set_up == Some(3) && of(0x047F).preset.is_none());
    assert_eq!(of(0xFFFF).stw1, Stw1(0x07FF));
}

#[test]
fn vlt_2800_inverts_bits_4_and_5() {
    for words in [
        [0x0000_u16, 0x0476, 0x047F],
        [0x047E, 0x047F, 0x047B],
        [0x047E, 0x047F, 0x047D],
    ] {
        let (mut new, mut old) = (Drive::new(DANFOSS), Drive::new(Profile::Vlt2800Profidrive));
        for word in words {
            let (state, status) = new.send(word);
            let (same, inverted) = old.send(word);
            assert_eq!((state, status ^ 0x0030), (same, inverted));
            let profile = Profile::Vlt2800Profidrive;
            assert_eq!(profile.zsw1(inverted, word), DANFOSS.zsw1(status, word));
        }
    }
}

#[test]
fn vacon_vendor_words() {
    let mut drive = Drive::new(PPO);
    assert_eq!(drive.send(0x0000), (State::S1, 0x2240));
    assert_eq!(drive.send(0x047E), (State::S2, 0x2231));
    assert_eq!(drive.send(0x047F), (State::S4, 0x3337));
    assert_eq!(drive.orders.digital_inputs, 0);
    // All three start bits.
    for word in [0x046F, 0x045F, 0x043F, 0x040F] {
        let orders = PPO.orders(word, State::S4);
        assert_eq!(orders.speed, Some(SpeedCommand::Channel(Setpoint::RampToZero)));
        assert!(!orders.stw1.has(Stw1::ENABLE_SETPOINT));
    }
    assert_eq!(PPO.orders(0xAC7F, State::S4).digital_inputs, 0b10101);
    assert!(PPO.quick_stop_on_ramp());
    drive.conditions.unpowered = true;
    assert_eq!(drive.status(0x047F), 0x1337);
    // Bits 8 and 9 do nothing.
    assert_eq!(PPO.orders(0x077F, State::S4), PPO.orders(0x047F, State::S4));
}

#[test]
fn tables_are_whole_and_names_lead_back() {
    for profile in Profile::ALL {
        assert_eq!(Profile::by_key(profile.key()), Some(profile));
        for mode in [Mode::Velocity, Mode::Position] {
            for table in [profile.control_bits(mode), profile.status_bits(mode)] {
                for (number, bit) in table.iter().enumerate() {
                    assert_eq!(usize::from(bit.number), number, "{profile:?}");
                    assert!(!bit.on.is_empty() && !bit.off.is_empty());
                    assert_eq!(table.iter().filter(|other| other.name == bit.name).count(), 1);
                }
            }
        }
    }
    assert_eq!(Profile::by_key("FC"), Some(FC));
    assert_eq!(Profile::by_key("nothing"), None);
    let meaning = |number| {
        let mut bits = FC.describe_control(0x043C, Mode::Velocity);
        bits.nth(number).unwrap().meaning
    };
    assert_eq!((meaning(6), meaning(2)), ("ramp stop", "ramp"));
}

//! Commands of the AKD that restart it, and those that a virtual drive cannot do (AKD PROFINET manual 5.6), and the enable
//! sequence of the sample project (7.1.4), through the network.

use std::time::Duration;

use profinet::Endpoint;
use system_tests::bus::{Bus, DRIVE};
use virtual_drive::station::StationEvent;

/// Returns a change of one parameter; the error number where it is refused.
fn write(bus: &mut Bus, pnu: u16, format: u8, value: u32) -> Option<u8> {
    let [high, low] = pnu.to_be_bytes();
    let mut request = vec![1, 2, 0, 1, 0x10, 1, high, low, 0, 0, format, 1];
    let octets = value.to_be_bytes();
    match format {
        0x41 => request.extend([octets[3], 0]),
        0x42 => request.extend(&octets[2..]),
        _ => request.extend(octets),
    }
    let answer = bus.job(&request);
    (answer[1] == 0x82).then(|| answer[7])
}

fn events(bus: &mut Bus) -> Vec<StationEvent> {
    let station = bus.station();
    std::iter::from_fn(|| station.poll_event()).collect()
}

/// DRV.REBOOT (3013): the connection is lost, values are as saved, the command is not stored.
#[test]
fn reboot_restarts_the_drive_with_its_saved_values() {
    let mut bus = Bus::new();
    bus.connect(1);
    assert_eq!(write(&mut bus, 2108, 0x43, 4_000_000), None); // DRV.ACC
    assert_eq!(write(&mut bus, 2469, 0x42, 1), None); // DRV.NVSAVE
    assert_eq!(write(&mut bus, 2108, 0x43, 5_000_000), None);
    assert_eq!(write(&mut bus, 2497, 0x43, 7), None); // USER.INT1, not saved
    bus.send(&[0x04, 0x7E, 0, 0], 5);
    bus.send(&[0x04, 0x7F, 0x10, 0], 60);
    let turned = bus.station().drive().axis().position();
    assert!(turned > 1 << 30, "{turned}");
    events(&mut bus);
    assert_eq!(
        write(&mut bus, 3013, 0x43, 1),
        None,
        "answered before it restarts"
    );
    bus.run(Duration::from_secs(3));
    assert!(!bus.station().device().is_exchanging(), "the connection is lost");
    assert!(!bus.station().drive().is_enabled());
    assert!(events(&mut bus).contains(&StationEvent::Restarting));
    let position = bus.station().drive().axis().position();
    assert!(position >= turned, "the shaft is where it ran out to: {position}");

    assert_eq!(bus.station().mac(), DRIVE);
    bus.connect(1);
    assert_eq!((bus.read(2108, 0), bus.read(2497, 0)), (4_000_000, 0));
    assert_eq!(bus.read(3013, 0), 0);
    let saved = |bus: &mut Bus| {
        assert_eq!(write(bus, 2469, 0x42, 1), None);
        let saved = events(bus).into_iter().find_map(|event| match event {
            StationEvent::PersistParameters { text, .. } => Some(text),
            _ => None,
        });
        saved.expect("saved")
    };
    assert!(!saved(&mut bus).contains("REBOOT"));
}

/// 5.8 and 5.11.9: DRV_ACC of telegram 354 outside the limits of DRV.ACC.
#[test]
fn an_out_of_range_setpoint_is_ignored_and_reported() {
    let mut bus = Bus::new();
    bus.connect(354);
    bus.send(&[0x04, 0x06, 0, 0, 0, 4, 0, 4], 4);
    events(&mut bus);
    bus.send(&[0x04, 0x06, 0, 0, 0xFF, 0xFF, 0, 4], 4);
    let events = events(&mut bus);
    assert_eq!(
        events,
        [StationEvent::SetpointIgnored {
            pnu: 108,
            raw: 0xFFFF
        }]
    );
    let words = events[0].words(bus.station().drive().model().catalogue).unwrap();
    assert!(
        words.starts_with("setpoint DRV_ACC (108) = 65535 ignored"),
        "{words}"
    );
    assert_eq!(bus.read(108, 0), 4);
}

/// What a virtual drive has not is refused with 0x11 and reported; what has nothing to do is done.
#[test]
fn commands_that_a_virtual_drive_cannot_do_are_refused() {
    let mut bus = Bus::new();
    bus.connect(1);
    events(&mut bus);
    // AIN.ZERO, GEAR.MOVE, REC.TRIG, SM.MOVE, WS.ARM, AIN2.ZERO, SD.LOAD, SD.SAVE, MODBUS.CLRERRORS, SFD.SECTORERASE
    for pnu in [2008, 2189, 2360, 2376, 2445, 2629, 2842, 2843, 2879, 2951] {
        assert_eq!(write(&mut bus, pnu, 0x42, 1), Some(0x11), "{pnu}");
        let events = events(&mut bus);
        assert_eq!(events, [StationEvent::Unable { pnu }], "{pnu}");
        let words = events[0].words(bus.station().drive().model().catalogue).unwrap();
        assert!(words.contains(&format!("({pnu}) refused")), "{words}");
        let advice = bus.station().drive().model().catalogue.not_now(pnu);
        assert!(
            advice.is_some_and(|advice| advice.contains("virtual drive")),
            "{pnu}"
        );
    }
    // BODE.MODE, CAP0.EN, CAP1.EN, DRV.ZERO, FB1.PFIND, PLS.RESET, CMP0.ARM, CMP1.ARM: procedures that end by themselves
    for (pnu, format) in [2023, 2028, 2041, 2139, 2149, 2914, 2915]
        .map(|pnu| (pnu, 0x41))
        .into_iter()
        .chain([(2327, 0x42)])
    {
        assert_eq!(write(&mut bus, pnu, format, 1), Some(0x11), "{pnu}");
        assert_eq!(events(&mut bus), [StationEvent::Unable { pnu }], "{pnu}");
        assert_eq!(write(&mut bus, pnu, format, 0), None, "{pnu}");
        let written = events(&mut bus);
        assert!(
            matches!(&written[..], [StationEvent::Written(written)] if written.pnu == pnu),
            "{written:?}"
        );
        let advice = bus.station().drive().model().catalogue.not_now(pnu);
        assert!(
            advice.is_some_and(|advice| advice.contains("virtual drive")),
            "{pnu}"
        );
    }
    // REC.OFF, DRV.CLRCRASHDUMP, WS.DISARM
    for pnu in [2358, 2785, 2847] {
        assert_eq!(write(&mut bus, pnu, 0x42, 1), None, "{pnu}");
    }
    // IP.RESET while a controller is connected
    assert_eq!(write(&mut bus, 2836, 0x42, 1), Some(0x11));
    let advice = bus.station().drive().model().catalogue.not_now(2836);
    assert!(advice.is_some_and(|advice| advice.contains("stop it first")));
}

/// 7.1.4: the manual calls 0x040E `Go to S3`; bit 0 is 0 there, and the drive stays in S2 as the profile has it.
#[test]
fn the_third_word_of_the_sample_project_leaves_the_drive_in_s2() {
    let mut bus = Bus::new();
    bus.connect(1);
    let mut state = |low: u8| bus.send(&[0x04, low, 0, 0], 5)[1] & 0x77;
    assert_eq!([0x00, 0x06, 0x0E, 0x0F].map(&mut state), [0x40, 0x31, 0x31, 0x37]);
}

/// 5.12.2: a position signal has 32 bits, so that a revolution has 1 to 32 of them.
#[test]
fn singleturn_bits_are_limited_to_those_of_a_signal() {
    let mut bus = Bus::new();
    bus.connect(1);
    for (bits, answer) in [(0, Some(2)), (1, None), (32, None), (33, Some(2)), (16, None)] {
        assert_eq!(write(&mut bus, 1002, 0x42, bits), answer, "{bits}");
    }
}

/// AOUT2.VALUE is written as AOUT.VALUE is.
#[test]
fn both_analog_outputs_can_be_written() {
    let mut bus = Bus::new();
    bus.connect(1);
    for pnu in [2014, 2642] {
        assert_eq!(write(&mut bus, pnu, 0x43, 1500), None, "{pnu}");
        assert_eq!(bus.read(pnu, 0), 1500, "{pnu}");
    }
}

/// 5.4: the manual does not say what bit 12 does beside bit 8 or 9; two commands to jog at once move nothing.
#[test]
fn real_time_jogging_beside_a_jog_moves_nothing() {
    let mut bus = Bus::new();
    bus.connect(9);
    assert_eq!(write(&mut bus, 930, 0x42, 2), None);
    let mut words = [0; 20];
    words[10..14].copy_from_slice(&(1_u32 << 26).to_be_bytes()); // 187.5 rpm
    words[14..18].copy_from_slice(&[0, 20, 0, 20]);
    let mut send = |bus: &mut Bus, control: u16| {
        words[..2].copy_from_slice(&control.to_be_bytes());
        bus.send(&words, 30);
        f64::from(bus.read(2425, 0) as i32) / 1000.0
    };
    for control in [0x0430, 0x0436, 0x0437, 0x043F] {
        send(&mut bus, control);
    }
    for both in [0x153F, 0x163F, 0x150F] {
        assert_eq!(send(&mut bus, both), 0.0, "{both:#06X}");
        send(&mut bus, 0x043F);
    }
    assert!((send(&mut bus, 0x143F) - 187.5).abs() < 0.1);
    assert!(send(&mut bus, 0x153F).abs() < 1.0, "jog 1 in addition stops");
}

/// 6.1: the ranges of a jog ramp begin at one step. 0 would be a jog that never begins (1006) or never ends (1007).
#[test]
fn a_jog_ramp_is_at_least_one_step() {
    let mut bus = Bus::new();
    bus.connect(9);
    for mode in [1, 2] {
        assert_eq!(write(&mut bus, 930, 0x42, mode), None);
        for scaling in [1, 14_648, 763] {
            assert_eq!(write(&mut bus, 1008, 0x42, scaling), None);
            for ramp in [1006, 1007] {
                for (steps, answer) in [(1, None), (0xFFFF, None), (4, None), (0, Some(0x02))] {
                    assert_eq!(write(&mut bus, ramp, 0x42, steps), answer, "{ramp} = {steps}");
                }
                assert_eq!(bus.read(ramp, 0), 4);
            }
        }
    }
}

/// 5.4: bits 11 to 15 have no function in velocity mode, though the sample project calls bit 11 "StartHoming" (7.1.4).
#[test]
fn bit_11_does_nothing_in_velocity_mode() {
    let mut bus = Bus::new();
    bus.connect(1);
    bus.send(&[0x04, 0x7E, 0, 0], 5);
    bus.send(&[0x04, 0x7F, 0, 0xA3], 40);
    let before = bus.read(2425, 0); // VL.CMD
    let homed = bus.read(2134, 0); // DRV.MOTIONSTAT
    let answer = bus.send(&[0x0C, 0x7F, 0, 0xA3], 40);
    assert_eq!((answer[0] & 0xF8, answer[1]), (0, 0x37), "{answer:02X?}");
    assert_eq!((bus.read(2425, 0), bus.read(2134, 0)), (before, homed));
}

/// 5.8: signal 107 is reserved. Its parameter is a word of 0 that cannot be written, and PNU 923 does not list it.
#[test]
fn the_reserved_signal_reads_0() {
    let mut bus = Bus::new();
    bus.connect(1);
    let answer = bus.job(&[1, 1, 0, 1, 0x10, 1, 0, 107, 0, 0]);
    assert_eq!(answer, [1, 1, 0, 1, 0x42, 1, 0, 0]);
    assert_eq!(bus.read(923, 107), 0);
    assert_eq!(write(&mut bus, 107, 0x42, 0), Some(0x01));
}

/// 5.6: DRV.TYPE, FBUS.TYPE and DRV.NVCHECK_32 are names and sizes only. They read 0 and cannot be written.
#[test]
fn codes_without_values_read_0() {
    let mut bus = Bus::new();
    bus.connect(1);
    for (pnu, format) in [(2138, 0x41), (2182, 0x41), (2521, 0x43)] {
        assert_eq!(bus.read(pnu, 0), 0, "{pnu}");
        assert_eq!(write(&mut bus, pnu, format, 0), Some(0x01), "{pnu}");
    }
}

/// 5.11.9: the third and fourth actual word of telegram 354 are printed as "-". The drive sends two words.
#[test]
fn telegram_354_has_two_actual_words() {
    let mut bus = Bus::new();
    bus.connect(354);
    assert_eq!(bus.send(&[0x04, 0x06, 0, 0, 0, 4, 0, 4], 4).len(), 4);
    let answer = bus.job(&[1, 1, 0, 1, 0x10, 4, 0x03, 0x94, 0, 0]);
    assert_eq!(answer[6..], [0, 2, 0, 6, 0, 0, 0, 0]);
}

/// 5.6: a number that the manual leaves out behind a double word is the high half of a 64-bit value. It reads as any
/// other, and the lists of numbers have it.
#[test]
fn the_numbers_that_the_manual_leaves_out_are_high_halves() {
    let mut bus = Bus::new();
    bus.connect(1);
    let mut listed = Vec::new();
    for list in 980..=989_u16 {
        let [high, low] = list.to_be_bytes();
        let answer = bus.job(&[1, 1, 0, 1, 0x10, 117, high, low, 0, 0]);
        let numbers = answer[6..]
            .chunks(2)
            .map(|word| u16::from_be_bytes([word[0], word[1]]));
        listed.extend(numbers.take_while(|number| *number != 0));
    }
    let rows = virtual_drive::model::AKD.catalogue.parameters;
    let halves: Vec<u16> = rows
        .iter()
        .filter_map(profile::catalogue::Parameter::high)
        .collect();
    assert_eq!(halves.len(), 121);
    for half in halves {
        assert!(listed.contains(&half), "{half}");
        assert!(rows.iter().all(|row| row.pnu != half), "{half}");
        let [high, low] = half.to_be_bytes();
        let answer = bus.job(&[1, 1, 0, 1, 0x10, 1, high, low, 0, 0]);
        assert_eq!((answer[1], answer[4], answer.len()), (1, 0x43, 10), "{half}");
    }
}

/// 5.6 lists the formats 0x41 to 0x43. A change in an integer type of the profile is accepted too.
#[test]
fn a_change_may_have_an_integer_format() {
    let mut bus = Bus::new();
    bus.connect(1);
    for format in [0x42, 0x06, 0x03] {
        for mode in [2, 1] {
            let request = [1, 2, 0, 1, 0x10, 1, 0x03, 0xA2, 0, 0, format, 1, 0, mode];
            assert_eq!(bus.job(&request), [1, 2, 0, 1, 0, 0], "{format:#04X}");
            let answer = bus.job(&[1, 1, 0, 1, 0x10, 1, 0x03, 0xA2, 0, 0]);
            assert_eq!(answer, [1, 1, 0, 1, 0x42, 1, 0, mode], "{format:#04X}");
        }
    }
}

/// 3.6: what the table of a request does not allow, and what the drive answers.
#[test]
fn what_the_table_of_a_request_does_not_allow() {
    let mut bus = Bus::new();
    bus.connect(1);
    for (request, error) in [
        ([1, 1, 1, 1, 0x10, 1, 0x03, 0xA2, 0, 0], 0x19), // another axis
        ([1, 1, 0, 1, 0x00, 1, 0x03, 0xA2, 0, 0], 0x16), // attribute 0x00
        ([1, 1, 0, 1, 0x30, 1, 0x03, 0xA2, 0, 0], 0x0F), // texts
        ([1, 1, 0, 1, 0x10, 1, 0x00, 0x00, 0, 0], 0x00), // PNU 0
        ([1, 1, 0, 1, 0x10, 1, 0x03, 0xB3, 0xFF, 0xFF], 0x03), // subindex 0xFFFF of 947
    ] {
        let answer = bus.job(&request);
        assert_eq!(
            (answer[1], answer[4], answer[7]),
            (0x81, 0x44, error),
            "{request:02X?}"
        );
    }
}

/// 5.6: 930 shows the operating mode, whatever chose it. 0 and 3 are no modes of the profile.
#[test]
fn the_operating_mode_is_1_2_or_that_of_the_manufacturer() {
    let mut bus = Bus::new();
    bus.connect(1);
    assert_eq!(write(&mut bus, 2135, 0x41, 0), None); // DRV.OPMODE, current
    assert_eq!(bus.read(930, 0), 0x8000);
    for (mode, answer) in [
        (0, Some(0x14)),
        (3, Some(0x14)),
        (1, None),
        (2, None),
        (0x8000, None),
    ] {
        assert_eq!(write(&mut bus, 930, 0x42, mode), answer, "{mode}");
    }
    assert_eq!(bus.read(2135, 0), 0);
}

/// 5.7: the reserved bits of MDI_MOD are taken and do nothing, in a telegram as by a write.
#[test]
fn the_reserved_bits_of_mdi_mod_are_ignored() {
    let mut bus = Bus::new();
    bus.connect(1);
    assert_eq!(write(&mut bus, 38, 0x42, 0x8001), None);
    assert_eq!(bus.read(38, 0), 0x8001);
    bus.release();
    bus.connect(9);
    let mut words = [0; 20];
    words[..2].copy_from_slice(&[0x04, 0x3E]);
    words[18..].copy_from_slice(&[0x80, 0x01]);
    bus.send(&words, 5);
    assert_eq!(bus.read(38, 0), 0x8001);
}

/// 5.8: the parameter behind a signal of the telegram is written, and the next cycle has the signal again.
#[test]
fn the_parameter_behind_a_signal_is_overwritten_by_the_telegram() {
    let mut bus = Bus::new();
    bus.connect(354);
    let words = [0x04, 0x7E, 0, 0, 0, 4, 0, 4];
    bus.send(&words, 5);
    let scaled = bus.read(2108, 0);
    assert_eq!(scaled, 4 * 763 * 1000, "DRV.ACC");
    assert_eq!(write(&mut bus, 108, 0x42, 8), Some(0x11), "the signal");
    assert_eq!(write(&mut bus, 2108, 0x43, 5_000_000), None, "its parameter");
    bus.send(&words, 5);
    assert_eq!((bus.read(2108, 0), bus.read(108, 0)), (scaled, 4));
}

/// 5.6: behind nine double words more than one number is left out; they have 32 bits.
#[test]
fn where_several_numbers_are_left_out_the_value_has_32_bits() {
    let mut bus = Bus::new();
    bus.connect(1);
    let rows = virtual_drive::model::AKD.catalogue;
    for pnu in [2163, 2626, 2793, 2802, 2839, 2851, 2868, 2896, 2963] {
        assert_eq!(
            rows.by_pnu(pnu).and_then(profile::catalogue::Parameter::high),
            None,
            "{pnu}"
        );
        bus.read(pnu, 0);
        let [high, low] = (pnu + 1).to_be_bytes();
        let answer = bus.job(&[1, 1, 0, 1, 0x10, 1, high, low, 0, 0]);
        assert_eq!((answer[1], answer[7]), (0x81, 0), "{pnu}");
    }
    let high = rows.by_pnu(2646).and_then(profile::catalogue::Parameter::high);
    assert_eq!(
        high,
        Some(2647),
        "AOUT2.VSCALE, of which AIN2.VSCALE (2626) is the counterpart"
    );
}

/// 6.4 prints a Modbus index of PN.TIMEOUTFTHRESH that is the PNU of another parameter.
#[test]
fn the_modbus_index_of_6_4_is_no_number_of_profinet() {
    let rows = virtual_drive::model::AKD.catalogue;
    assert_eq!(rows.by_pnu(3022).map(|row| row.name), Some("PN.TIMEOUTFTHRESH"));
    assert_eq!(rows.by_pnu(2860).map(|row| row.name), Some("WS.TSTANDSTILL"));
}

//! The fault message counter of the AKD PROFINET manual (5.14), through the network.

use profile::parameter::pnu;
use profinet::wire::ethernet::FrameId;
use system_tests::bus::Bus;
use system_tests::traffic::{Content, content};
use virtual_drive::drive::Injection;

/// Each fault situation counts once: neither its further faults nor its acknowledge.
#[test]
fn the_fault_message_counter_counts_situations() {
    let mut bus = Bus::new();
    bus.connect(1);
    let stop = [0x04, 0x7E, 0, 0];
    bus.send(&stop, 5);
    for situation in 1..=3 {
        for number in [301, 304, 439] {
            let fault = Injection::Fault {
                number,
                lasting: false,
            };
            bus.station().drive_mut().inject(fault);
            bus.send(&stop, 5);
            assert_eq!(bus.read(pnu::FAULT_COUNTER, 0), situation, "F{number}");
        }
        assert_eq!(bus.read(pnu::FAULT_NUMBERS, 2), 439);
        bus.send(&[0x04, 0xFE, 0, 0], 5);
        bus.send(&stop, 5);
        assert_eq!(bus.read(pnu::FAULT_COUNTER, 0), situation, "acknowledged");
        assert_eq!(
            (bus.read(pnu::FAULT_NUMBERS, 0), bus.read(pnu::FAULT_NUMBERS, 8)),
            (0, 301)
        );
    }
}

/// Manual 5.2 and 5.13: there is no alarm queue. A fault is in the status word and in the fault buffer.
#[test]
fn a_fault_sends_no_alarm() {
    let mut bus = Bus::new();
    bus.connect(1);
    bus.send(&[0x04, 0x7E, 0, 0], 5);
    let fault = Injection::Fault {
        number: 301,
        lasting: false,
    };
    bus.station().drive_mut().inject(fault);
    let answer = bus.send(&[0x04, 0x7E, 0, 0], 20);
    assert_eq!(answer[1] & 0x08, 0x08, "fault present");
    assert_eq!(bus.read(pnu::FAULT_NUMBERS, 0), 301);
    let alarms = [FrameId::ALARM_HIGH, FrameId::ALARM_LOW];
    for bytes in bus.frames() {
        if let Content::Profinet(frame) = content(&bytes) {
            assert!(!alarms.contains(&frame.frame_id), "{bytes:02X?}");
        }
    }
}

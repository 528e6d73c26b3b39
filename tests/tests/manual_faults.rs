//! The fault message counter of the AKD PROFINET manual (5.14), through the network.

use profidrive::parameter::pnu;
use system_tests::bus::Bus;
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

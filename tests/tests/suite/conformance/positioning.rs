//! Section F: positioning of an AKD, with telegram 9 (MDI).

use std::time::Duration;

use super::bench::{AKD, Bench, CYCLES};

/// Bits 0 to 5 and 10, and with the edge of bit 6.
const IDLE: u16 = 0x043F;
const EDGE: u16 = 0x047F;
/// Position mode is chosen, nothing requested.
const NOTHING: u16 = 0x0400;

/// Acknowledge of a task, stands still, a task is active.
const ACKNOWLEDGED: u16 = 0x1000;
const STANDS: u16 = 0x2000;
const ACTIVE: u16 = 0x4000;

pub const LINES: [(u16, fn()); 3] = [
    (103, the_acknowledge_follows_the_request),
    (106, a_rejected_task_is_gone),
    (109, no_edge_counts_outside_of_operation),
];

/// Telegram 9 with a relative move of 50 revolutions at 300 rpm.
fn outputs(stw1: u16) -> [u8; 20] {
    let mut octets = [0; 20];
    octets[..2].copy_from_slice(&stw1.to_be_bytes());
    octets[2..4].copy_from_slice(&0x8000_u16.to_be_bytes());
    octets[6..10].copy_from_slice(&(50_i32 << 16).to_be_bytes());
    octets[10..14].copy_from_slice(&107_374_182_u32.to_be_bytes());
    octets[14..16].copy_from_slice(&4_u16.to_be_bytes());
    octets[16..18].copy_from_slice(&4_u16.to_be_bytes());
    octets
}

fn send(bench: &mut Bench, stw1: u16, time: Duration) -> u16 {
    let inputs = bench.plc.exchange(&outputs(stw1), time);
    u16::from_be_bytes([inputs[0], inputs[1]])
}

/// In position mode, homed where it stands, with a telegram of positioning.
fn bench() -> Bench {
    let mut bench = Bench::sending(&AKD, 9, &outputs(NOTHING));
    let mode = [0x46, 2, 0, 1, 0x10, 1, 0x03, 0xA2, 0, 0, 0x42, 1, 0, 2];
    assert_eq!(bench.job(&mode)[1], 2);
    for stw1 in [0x0430, 0x0436, 0x0437, IDLE] {
        send(&mut bench, stw1, CYCLES);
    }
    let zsw1 = send(&mut bench, 0x0C3F, 10 * CYCLES);
    assert_eq!(zsw1 & 0x0800, 0x0800, "homed: {zsw1:04X}");
    send(&mut bench, IDLE, CYCLES);
    bench
}

fn the_acknowledge_follows_the_request() {
    let mut bench = bench();
    assert_eq!(
        send(&mut bench, EDGE, CYCLES) & (ACKNOWLEDGED | STANDS),
        ACKNOWLEDGED
    );
    assert_eq!(send(&mut bench, IDLE, CYCLES) & (ACKNOWLEDGED | STANDS), 0);
}

fn a_rejected_task_is_gone() {
    let mut bench = bench();
    assert_eq!(send(&mut bench, EDGE, Duration::from_secs(1)) & STANDS, 0);
    let position = |bench: &mut Bench, stw1| {
        let inputs = bench.plc.exchange(&outputs(stw1), Duration::from_secs(1));
        i32::from_be_bytes(inputs[6..10].try_into().unwrap())
    };
    let reject = EDGE & !0x0010;
    let stopped = position(&mut bench, reject);
    assert_eq!(send(&mut bench, reject, CYCLES) & STANDS, STANDS);
    let after = position(&mut bench, EDGE);
    assert!((after - stopped).abs() < 200, "{stopped} {after}");
    // the acknowledge follows bit 6, which is still there
    assert_eq!(send(&mut bench, EDGE, CYCLES) & (ACTIVE | STANDS), STANDS);
}

fn no_edge_counts_outside_of_operation() {
    let mut bench = bench();
    // S3: operation not enabled
    let ready = IDLE & !0x0008;
    assert_eq!(send(&mut bench, ready, CYCLES) & 0x0007, 0x0003);
    assert_eq!(send(&mut bench, ready | 0x0040, CYCLES) & ACKNOWLEDGED, 0);
    let zsw1 = send(&mut bench, EDGE, Duration::from_secs(1));
    assert_eq!(
        zsw1 & (ACKNOWLEDGED | STANDS | 0x0007),
        STANDS | 0x0007,
        "{zsw1:04X}"
    );
    // a new edge in S4 does
    send(&mut bench, IDLE, CYCLES);
    assert_eq!(
        send(&mut bench, EDGE, CYCLES) & (ACKNOWLEDGED | STANDS),
        ACKNOWLEDGED
    );
}

//! Byte examples of the manuals, damage, and whole lines in virtual time.

mod golden;
mod line;
mod receiver;
mod slave;

use alloc::vec::Vec;
use core::time::Duration;

use super::*;

fn hex(text: &str) -> Vec<u8> {
    text.split_whitespace()
        .map(|octet| u8::from_str_radix(octet, 16).unwrap())
        .collect()
}

fn telegram(address: Address, data: &[u8]) -> Vec<u8> {
    let mut out = [0; MAX_TELEGRAM];
    let length = Telegram { address, data }.encode(&mut out).unwrap();
    out[..length].to_vec()
}

/// Feeds octets at the pace of the line; gives the time of the last and everything received, silence behind included.
fn feed(
    receiver: &mut Receiver,
    timing: &Timing,
    start: Duration,
    octets: &[u8],
) -> (Duration, Vec<Vec<u8>>) {
    let mut now = start;
    let mut found = Vec::new();
    for &octet in octets {
        now += timing.character;
        receiver.handle_octet(now, octet);
        found.extend(receiver.take().map(|telegram| telegram.data.to_vec()));
    }
    while let Some(due) = receiver.poll_timeout() {
        now = now.max(due);
        receiver.handle_timeout(due);
        found.extend(receiver.take().map(|telegram| telegram.data.to_vec()));
    }
    (now, found)
}

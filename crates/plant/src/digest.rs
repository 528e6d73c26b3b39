//! A number of a run, by which another run is known to be the same.

use std::io::{self, Write};
use std::time::Duration;

use crate::trace::{Event, EventKind, Sample};

/// The hash of what has happened (FNV-1a: no collision by an opponent is to be feared).
#[derive(Debug, Clone, Copy)]
pub(crate) struct Digest(u64);

impl Default for Digest {
    fn default() -> Self {
        Self(0xCBF2_9CE4_8422_2325)
    }
}

impl Digest {
    pub fn octets(&mut self, octets: &[u8]) {
        for octet in octets {
            self.0 = (self.0 ^ u64::from(*octet)).wrapping_mul(0x0100_0000_01B3);
        }
    }

    pub fn number(&mut self, number: u64) {
        self.octets(&number.to_be_bytes());
    }

    pub fn time(&mut self, time: Duration) {
        self.number(u64::try_from(time.as_nanos()).unwrap_or(u64::MAX));
    }

    /// Takes an event of the drive of that number.
    pub fn event(&mut self, drive: usize, event: &Event) {
        self.number(event.time_ns);
        self.number(drive as u64);
        if let EventKind::Sample(sample) = &event.kind {
            // many runs have more of them than of all others
            self.sample(sample);
        } else if let Err(error) = serde_json::to_writer(&mut *self, &event.kind) {
            // numbers and texts always serialise
            debug_assert!(false, "{error}");
        }
    }

    fn sample(&mut self, sample: &Sample) {
        let Sample {
            stw1,
            zsw1,
            speed,
            position,
            current,
        } = sample;
        self.number(u64::from(*stw1) << 16 | u64::from(*zsw1));
        for quantity in [speed, position, current] {
            self.number(quantity.to_bits());
        }
    }

    /// Returns the hash.
    pub const fn value(self) -> u64 {
        self.0
    }
}

impl Write for Digest {
    fn write(&mut self, octets: &[u8]) -> io::Result<usize> {
        self.octets(octets);
        Ok(octets.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

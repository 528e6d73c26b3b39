//! Section G: the parameter channel in PPO 1 of a VLT on the network, and the same drive at a serial line with the Danfoss
//! FC protocol. Telegrams are octets as on the wire; the timing of the line is that of virtual time.

use std::time::Duration;

use profinet::Instant;
use uss::SlaveConfig;
use virtual_drive::model;
use virtual_drive::serial::{SerialConfig, SerialStation};

use super::bench::{Bench, CYCLES, VLT};

pub const LINES: [(u16, fn()); 7] = [
    (112, no_such_parameter_in_a_ppo),
    (112, no_such_parameter_at_the_line),
    (115, a_standing_request_follows_the_value_in_a_ppo),
    (115, a_standing_request_follows_the_value_at_the_line),
    (118, the_exact_frame),
    (121, a_broadcast),
    (124, a_text),
];

/// Longest time until a slave answers.
const ANSWER: Duration = Duration::from_millis(50);

/// A PPO 1: parameter channel, control word and reference.
fn ppo(bench: &mut Bench, channel: [u8; 8], control: u16, reference: u16, time: Duration) -> Vec<u8> {
    let [a, b] = control.to_be_bytes();
    let [c, d] = reference.to_be_bytes();
    let outputs = [&channel[..], &[a, b, c, d]].concat();
    bench.plc.exchange(&outputs, time)
}

fn no_such_parameter_in_a_ppo() {
    let mut bench = Bench::sending(&VLT, 101, &[0; 12]);
    // 2-07 is not in this drive
    let inputs = ppo(&mut bench, [0x10, 0xCF, 0, 0, 0, 0, 0, 0], 0x043C, 0, CYCLES);
    assert_eq!(inputs[..8], [0x70, 0xCF, 0, 0, 0, 0, 0, 0]);
}

fn a_standing_request_follows_the_value_in_a_ppo() {
    let mut bench = Bench::sending(&VLT, 101, &[0; 12]);
    // 16-13, output frequency in tenths of Hz
    let read = [0x16, 0x4D, 0, 0, 0, 0, 0, 0];
    let mut last = 0;
    ppo(&mut bench, read, 0x043C, 0, CYCLES);
    for _ in 0..8 {
        let inputs = ppo(&mut bench, read, 0x047C, 0x4000, Duration::from_millis(250));
        assert_eq!(inputs[..6], [0x16, 0x4D, 0, 0, 0, 0]);
        let value = u16::from_be_bytes([inputs[6], inputs[7]]);
        assert!(value > last, "{value} {last}");
        last = value;
    }
}

/// A VLT with address 1 at a line.
pub struct Line {
    now: Instant,
    /// Octet of the address.
    address: u8,
    pub station: SerialStation,
}

impl Line {
    pub fn new() -> Self {
        Self::with(SlaveConfig::fc(1, 9600), 0x81)
    }

    pub fn uss() -> Self {
        Self::with(SlaveConfig::uss(1, 9600), 1)
    }

    fn with(slave: SlaveConfig, address: u8) -> Self {
        Self {
            now: Instant::from_millis(1000),
            address,
            station: SerialStation::new(SerialConfig::new(&model::VLT, slave)),
        }
    }

    /// Lets the line be silent for a while; what the drive sends, and how long after the beginning of the silence.
    fn silence(&mut self, time: Duration) -> Option<(Vec<u8>, Duration)> {
        let (begin, end) = (self.now, self.now + time);
        let mut buffer = [0; uss::MAX_TELEGRAM];
        let mut sent = None;
        while self.now < end {
            self.now += Duration::from_millis(1);
            self.station.handle_timeout(self.now);
            if let Some(length) = self.station.poll_transmit(self.now, &mut buffer) {
                assert!(sent.is_none(), "one answer");
                sent = Some((buffer[..length].to_vec(), self.now - begin));
            }
        }
        sent
    }

    /// Sends a telegram and takes the answer apart: the octets between address and check octet.
    fn ask(&mut self, telegram: &[u8]) -> Option<Vec<u8>> {
        self.station.handle_octets(self.now, telegram);
        let (answer, after) = self.silence(Duration::from_millis(200))?;
        assert!(after <= ANSWER, "{after:?}");
        let (check, rest) = answer.split_last().unwrap();
        assert_eq!(*check, rest.iter().fold(0, |all, octet| all ^ octet));
        assert_eq!((answer[0], usize::from(answer[1])), (0x02, answer.len() - 2));
        assert_eq!(answer[2], telegram[2]);
        Some(rest[3..].to_vec())
    }

    /// A telegram with a parameter block: the data of its answer.
    pub fn channel(&mut self, channel: [u8; 8], control: u16, reference: u16) -> Vec<u8> {
        let telegram = parameter_telegram(self.address, channel, control, reference);
        self.ask(&telegram).unwrap()
    }
}

fn closed(mut telegram: Vec<u8>) -> Vec<u8> {
    let check = telegram.iter().fold(0, |all, octet| all ^ octet);
    telegram.push(check);
    telegram
}

fn parameter_telegram(address: u8, channel: [u8; 8], control: u16, reference: u16) -> Vec<u8> {
    let mut telegram = vec![0x02, 0x0E, address];
    telegram.extend(channel);
    telegram.extend(control.to_be_bytes());
    telegram.extend(reference.to_be_bytes());
    closed(telegram)
}

fn no_such_parameter_at_the_line() {
    let data = Line::new().channel([0x10, 0xCF, 0, 0, 0, 0, 0, 0], 0, 0);
    assert_eq!(data[..8], [0x70, 0xCF, 0, 0, 0, 0, 0, 0]);
}

fn a_standing_request_follows_the_value_at_the_line() {
    let mut line = Line::new();
    let mut last = 0;
    for _ in 0..8 {
        let data = line.channel([0x16, 0x4D, 0, 0, 0, 0, 0, 0], 0x047C, 0x4000);
        assert_eq!(data[..6], [0x16, 0x4D, 0, 0, 0, 0]);
        let value = u16::from_be_bytes([data[6], data[7]]);
        assert!(value > last || last == 0, "{value} {last}");
        last = value;
    }
    assert!(last > 50, "{last}");
}

fn the_exact_frame() {
    let request = [
        0x02, 0x0E, 0x81, 0x15, 0xFA, 0, 0x01, 0, 0, 0, 0, 0, 0, 0, 0, 0x63,
    ];
    assert_eq!(
        parameter_telegram(0x81, [0x15, 0xFA, 0, 0x01, 0, 0, 0, 0], 0, 0),
        request
    );
    let mut line = Line::new();
    line.station.drive_mut().inject_fault(9, false);
    line.station.drive_mut().inject_fault(12, false);
    let data = line.ask(&request).unwrap();
    assert_eq!(data.len(), 12);
    // the second one from the top of the log
    assert_eq!(data[..8], [0x15, 0xFA, 0, 0x01, 0, 0, 0, 9]);
}

fn a_broadcast() {
    for address in [0x80, 0x20] {
        let mut line = Line::new();
        let telegram = closed(vec![0x02, 0x06, address, 0x04, 0x7C, 0x20, 0x00]);
        assert_eq!(line.ask(&telegram), None);
        assert!(line.station.drive().is_enabled(), "{address:02X}");
    }
}

fn a_text() {
    // 15-40
    let data = Line::new().channel([0xF6, 0x04, 0x04, 0, 0, 0, 0, 0], 0, 0);
    assert_eq!(data.len() + 2, 10 + 6, "length octet");
    assert_eq!(data[..4], [0xF6, 0x04, 0x04, 0]);
    assert_eq!(&data[4..10], b"FC-302");
}

//! One virtual drive of each dut and our controller, with raw requests and frames.

use std::cell::RefCell;
use std::sync::{Arc, Mutex};
use std::time::Duration;

use profinet::Instant;
use system_tests::memory::Traffic;
use system_tests::{judge, memory};
use testbench::plc::{DRIVE, Plc};
use virtual_drive::drive::Injection;
use virtual_drive::model::{self, Model};

/// Who a line is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Vendor {
    Akd,
    Vlt,
    Vacon,
}

/// What differs between the makes in the stimuli.
pub struct DeviceUnderTest {
    pub vendor: Vendor,
    pub model: &'static Model,
    /// Axis number of a request.
    pub axis: u8,
    /// Both records of the parameter channel.
    pub records: [u16; 2],
    /// Address of a parameter that can be written: PNU and subindex.
    pub writable: [u8; 4],
    /// A value block for it.
    pub block: &'static [u8],
    /// A fault to inject.
    pub fault: u16,
}

pub static AKD: DeviceUnderTest = DeviceUnderTest {
    vendor: Vendor::Akd,
    model: &model::AKD,
    axis: 0,
    records: [0xB02F, 47],
    // 930, speed mode
    writable: [0x03, 0xA2, 0, 0],
    block: &[0x42, 1, 0, 1],
    fault: 301,
};
pub static VLT: DeviceUnderTest = DeviceUnderTest {
    vendor: Vendor::Vlt,
    model: &model::VLT,
    axis: 0,
    records: [0xB02E, 0xB02F],
    // 3-41, Unsigned32 (7 in the older numbers), 2.00 s
    writable: [0x01, 0x55, 0, 0],
    block: &[7, 1, 0, 0, 0, 200],
    // inverter overloaded: a trip that a reset ends, no trip lock
    fault: 9,
};
pub static VACON: DeviceUnderTest = DeviceUnderTest {
    vendor: Vendor::Vacon,
    model: &model::VACON,
    axis: 1,
    records: [0xB02E, 0xB02F],
    // ID 103, 2.0 s
    writable: [0x27, 0x11, 0, 103],
    block: &[0x42, 1, 0, 20],
    fault: 1,
};

/// One drive and one controller on a segment.
pub struct Bench {
    pub dut: &'static DeviceUnderTest,
    pub plc: Plc,
    traffic: Arc<Mutex<Traffic>>,
}

thread_local! {
    /// What all benches of this thread have sent.
    static ALL: RefCell<Traffic> = const { RefCell::new(Vec::new()) };
}

/// The frames of one line follow those of the line before.
impl Drop for Bench {
    fn drop(&mut self) {
        ALL.with_borrow_mut(|all| {
            let before = all.last().map_or(Duration::ZERO, |last| last.0 - Instant::ZERO);
            let later = |(at, frame): (Instant, Vec<u8>)| (at + before + Duration::from_secs(1), frame);
            all.extend(
                std::mem::take(&mut *self.traffic.lock().unwrap())
                    .into_iter()
                    .map(later),
            );
        });
    }
}

/// The dissector has nothing against any frame of the drives of this thread. What is sent to them is as wrong as the lines
/// want it.
#[track_caller]
pub fn judged(name: &str) {
    let file = memory::save(&format!("conformance-{name}.pcapng"), &ALL.take());
    let verdict = judge::judge_of(&file, DRIVE);
    verdict.clean().saw("pn_io", 200).saw("pn_rt", 1000);
}

impl Bench {
    /// Connected with telegram 1.
    pub fn new(dut: &'static DeviceUnderTest) -> Self {
        Self::sending(dut, 1, &[0x04, 0x7E, 0, 0])
    }

    /// Connected with this telegram; the controller sends these outputs from its first frame on.
    pub fn sending(dut: &'static DeviceUnderTest, telegram: u16, outputs: &[u8]) -> Self {
        let mut traffic = None;
        let plc = Plc::connected(dut.model, telegram, outputs, |segment| {
            traffic = Some(memory::listen(segment));
        });
        Self {
            dut,
            plc,
            traffic: traffic.unwrap(),
        }
    }

    pub fn job(&mut self, request: &[u8]) -> Vec<u8> {
        self.plc.job(self.dut.records[0], request).unwrap()
    }

    /// A request with `DD` for the axis.
    pub fn hex(&self, text: &str) -> Vec<u8> {
        text.split_whitespace()
            .map(|octet| match octet {
                "DD" => self.dut.axis,
                octet => u8::from_str_radix(octet, 16).unwrap(),
            })
            .collect()
    }

    pub fn ask(&mut self, request: &str) -> Vec<u8> {
        let request = self.hex(request);
        self.job(&request)
    }

    /// The error number of an answer with one refused parameter.
    #[track_caller]
    pub fn error(&mut self, request: &str) -> u16 {
        let answer = self.ask(request);
        let [_, id, _, 1, 0x44, 1 | 2, high, low, ..] = answer[..] else {
            panic!("{request}: {answer:02X?}");
        };
        assert!(id & 0x80 != 0, "{answer:02X?}");
        u16::from_be_bytes([high, low])
    }

    /// A word that a read brings.
    #[track_caller]
    pub fn words(&mut self, pnu: u16, first: u16, count: u8) -> Vec<u16> {
        let ([a, b], [c, d]) = (pnu.to_be_bytes(), first.to_be_bytes());
        let answer = self.job(&[0x31, 1, self.dut.axis, 1, 0x10, count, a, b, c, d]);
        let [0x31, 1, _, 1, format, found, values @ ..] = &answer[..] else {
            panic!("{pnu}: {answer:02X?}");
        };
        assert_eq!(*found, count);
        assert!(
            matches!(format, 0x42 | 0x06 | 0x05 | 0x0A | 0x36 | 0x1F | 0x41),
            "{answer:02X?}"
        );
        let width = if matches!(format, 5 | 0x0A | 0x41) { 1 } else { 2 };
        values
            .chunks_exact(width)
            .take(count.into())
            .map(|octets| octets.iter().fold(0, |word, octet| word << 8 | u16::from(*octet)))
            .collect()
    }

    /// A change of the writable parameter with these octets behind its address.
    pub fn change(&mut self, id: u8, block: &[u8]) -> Vec<u8> {
        let mut request = vec![0x19, id, self.dut.axis, 1, 0x10, 1];
        request.extend(self.dut.writable);
        request.extend(block);
        self.job(&request)
    }

    /// Sends a control word and setpoint for a while; status word and actual value at its end.
    pub fn send(&mut self, stw1: u16, setpoint: u16, time: Duration) -> (u16, i16) {
        let ([a, b], [c, d]) = (stw1.to_be_bytes(), setpoint.to_be_bytes());
        let data = self.plc.exchange(&[a, b, c, d], time);
        let [a, b, c, d] = data.try_into().unwrap();
        (u16::from_be_bytes([a, b]), i16::from_be_bytes([c, d]))
    }

    /// A few cycles of a control word: status word under the mask of the checklist.
    pub fn word(&mut self, stw1: u16) -> u16 {
        self.send(stw1, 0, CYCLES).0 & 0x0077
    }

    /// Runs at 20 % of the reference.
    pub fn run(&mut self) {
        self.word(0x047E);
        let (zsw1, speed) = self.send(0x047F, 0x0CCD, Duration::from_secs(6));
        assert_eq!(zsw1 & 0x0077, 0x0037, "{zsw1:04X}");
        assert!((0x0B00..=0x0E00).contains(&speed), "{speed:04X}");
    }

    pub fn inject_fault(&mut self) {
        self.inject(Injection::Fault {
            number: self.dut.fault,
            lasting: false,
        });
    }

    pub fn inject(&mut self, injection: Injection) {
        self.plc.drive_mut().inject(injection);
    }
}

pub const CYCLES: Duration = Duration::from_millis(160);

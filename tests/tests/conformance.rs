//! The conformance checklist of the drive profile, sections A to E and H, every line that concerns a VLT or a Vacon:
//! our controller's raw requests and frames on a segment with the virtual drive. (Section G is about parameter channel
//! and serial line: `crates/profidrive/src/pkw/tests`, `crates/uss/src/tests`, `crates/virtual-drive/src/serial`.)

use std::net::Ipv4Addr;
use std::time::Duration;

use network::host::{Host, StationId};
use network::segment::{Pace, Segment, SegmentMedium};
use profidrive::catalogue::Device;
use profinet::controller::{
    ArId, ConnectConfig, Controller, ControllerConfig, Event, ModuleConfig, RecordAddress, Resolve,
    ServiceError, SubmoduleConfig, Target,
};
use profinet::cyclic::Timing;
use profinet::device::Stored;
use profinet::{IpSuite, MacAddress, Medium};
use virtual_drive::model::{self, Model};
use virtual_drive::station::{Station, StationConfig};

const LOCAL: u16 = 0xB02E;
const GLOBAL: u16 = 0xB02F;

/// What differs between the two in the stimuli.
struct Make {
    model: &'static Model,
    /// Axis number of a request.
    axis: u8,
    /// Address of a parameter that can be written: PNU and subindex.
    writable: [u8; 4],
    /// A value block for it.
    block: &'static [u8],
    /// A fault to inject.
    fault: u16,
}

static VLT: Make = Make {
    model: &model::VLT,
    axis: 0,
    // 3-41, Unsigned32 (7 in the older numbers), 2.00 s
    writable: [0x01, 0x55, 0, 0],
    block: &[7, 1, 0, 0, 0, 200],
    // inverter overloaded: a trip that a reset ends, no trip lock
    fault: 9,
};
static VACON: Make = Make {
    model: &model::VACON,
    axis: 1,
    // ID 103, 2.0 s
    writable: [0x27, 0x11, 0, 103],
    block: &[0x42, 1, 0, 20],
    fault: 1,
};

/// One drive and one controller on a segment, connected with telegram 1.
struct Bench {
    make: &'static Make,
    medium: SegmentMedium,
    controller: Controller,
    ar: ArId,
    station: StationId,
}

impl Bench {
    fn new(make: &'static Make) -> Self {
        Self::sending(make, [0x04, 0x7E, 0, 0])
    }

    /// The controller sends these outputs from its first frame on.
    fn sending(make: &'static Make, outputs: [u8; 4]) -> Self {
        let ip = |last| IpSuite {
            address: Ipv4Addr::new(10, 0, 0, last),
            mask: Ipv4Addr::new(255, 255, 255, 0),
            gateway: Ipv4Addr::UNSPECIFIED,
        };
        let device = &make.model.catalogue.device;
        let mut segment = Segment::new(1);
        let drive_mac = MacAddress([2, 0x50, 0x4E, 0, 0, 1]);
        let mut config = StationConfig::new(make.model, drive_mac);
        config.network = Stored {
            name: "drive-1".into(),
            ip: ip(2),
            ..Stored::default()
        };
        let station = segment.attach(Box::new(Host::new(Station::new(config))));
        let medium = SegmentMedium::new(segment, Pace::Virtual);
        let config = ControllerConfig::new(MacAddress([2, 0x50, 0x4E, 0, 0, 0xC0]), ip(1), "controller", 1);
        let mut controller = Controller::new(config);
        let target = Target {
            name: "drive-1".into(),
            mac: Some(drive_mac),
            ip: ip(2),
            vendor_id: device.vendor_id,
            device_id: device.device_id,
            instance: 1,
        };
        let timing = Timing::for_interval(Duration::from_millis(16)).unwrap();
        let mut config = ConnectConfig::new(modules(device), timing);
        config.resolve = Resolve::Trust;
        let ar = controller.connect(medium.now(), target, config).unwrap();
        let mut bench = Self {
            make,
            medium,
            controller,
            ar,
            station,
        };
        let (mut ready, mut running) = (false, false);
        bench.until(Duration::from_secs(5), |bench, event| {
            match event {
                Some(Event::Connected { .. }) => bench.output(outputs),
                Some(Event::Ready { diff, .. }) => {
                    assert!(diff.is_none_or(|diff| {
                        diff.modules
                            .iter()
                            .all(|module| module.submodules.iter().all(|submodule| submodule.ident != 0))
                    }));
                    ready = true;
                }
                Some(Event::Running { .. }) => running = true,
                Some(Event::Lost { cause, .. }) => panic!("{cause}"),
                _ => {}
            }
            ready && running
        });
        bench
    }

    fn output(&mut self, outputs: [u8; 4]) {
        let subslot = self.make.model.catalogue.device.layout.telegram;
        self.controller.set_output(self.ar, 1, subslot, &outputs).unwrap();
    }

    fn until(&mut self, limit: Duration, mut done: impl FnMut(&mut Self, Option<Event>) -> bool) {
        let end = self.medium.now() + limit;
        loop {
            assert!(self.medium.now() < end, "not within {limit:?}");
            self.medium.step(&mut self.controller, end).unwrap();
            while let Some(event) = self.controller.poll_event() {
                if done(self, Some(event)) {
                    return;
                }
            }
            if done(self, None) {
                return;
            }
        }
    }

    /// One job through a record: the answer, or why the write was refused.
    fn job_at(&mut self, index: u16, request: &[u8]) -> Result<Vec<u8>, ServiceError> {
        let device = &self.make.model.catalogue.device;
        let at = RecordAddress {
            api: device.api.into(),
            slot: 1,
            subslot: device.layout.parameters.subslot,
            index,
        };
        let now = self.medium.now();
        let call = self.controller.parameter_job(now, self.ar, at, request).unwrap();
        let mut answer = None;
        self.until(Duration::from_secs(10), |_, event| {
            if let Some(Event::RecordDone { call: done, result }) = event
                && done == call
            {
                answer = Some(result);
            }
            answer.is_some()
        });
        answer.unwrap()
    }

    fn job(&mut self, request: &[u8]) -> Vec<u8> {
        self.job_at(LOCAL, request).unwrap()
    }

    /// A request with `DD` for the axis.
    fn hex(&self, text: &str) -> Vec<u8> {
        text.split_whitespace()
            .map(|octet| match octet {
                "DD" => self.make.axis,
                octet => u8::from_str_radix(octet, 16).unwrap(),
            })
            .collect()
    }

    fn ask(&mut self, request: &str) -> Vec<u8> {
        let request = self.hex(request);
        self.job(&request)
    }

    /// The error number of an answer with one refused parameter.
    #[track_caller]
    fn error(&mut self, request: &str) -> u16 {
        let answer = self.ask(request);
        let [_, id, _, 1, 0x44, 1 | 2, high, low, ..] = answer[..] else {
            panic!("{request}: {answer:02X?}");
        };
        assert!(id & 0x80 != 0, "{answer:02X?}");
        u16::from_be_bytes([high, low])
    }

    /// A word that a read brings.
    #[track_caller]
    fn words(&mut self, pnu: u16, first: u16, count: u8) -> Vec<u16> {
        let ([a, b], [c, d]) = (pnu.to_be_bytes(), first.to_be_bytes());
        let answer = self.job(&[0x31, 1, self.make.axis, 1, 0x10, count, a, b, c, d]);
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
    fn change(&mut self, id: u8, block: &[u8]) -> Vec<u8> {
        let mut request = vec![0x19, id, self.make.axis, 1, 0x10, 1];
        request.extend(self.make.writable);
        request.extend(block);
        self.job(&request)
    }

    /// Sends a control word and setpoint for a while; status word and actual value at its end.
    fn send(&mut self, stw1: u16, setpoint: u16, time: Duration) -> (u16, i16) {
        let ([a, b], [c, d]) = (stw1.to_be_bytes(), setpoint.to_be_bytes());
        self.output([a, b, c, d]);
        let end = self.medium.now() + time;
        while self.medium.now() < end {
            self.medium.step(&mut self.controller, end).unwrap();
            while let Some(event) = self.controller.poll_event() {
                assert!(!matches!(event, Event::Lost { .. }), "{event:?}");
            }
        }
        let subslot = self.make.model.catalogue.device.layout.telegram;
        let (data, iops) = self.controller.input(self.ar, 1, subslot).unwrap();
        assert!(iops.is_good());
        let [a, b, c, d] = data.try_into().unwrap();
        (u16::from_be_bytes([a, b]), i16::from_be_bytes([c, d]))
    }

    /// A few cycles of a control word: status word under the mask of the checklist.
    fn word(&mut self, stw1: u16) -> u16 {
        self.send(stw1, 0, CYCLES).0 & 0x0077
    }

    /// Runs at 20 % of the reference.
    fn run(&mut self) {
        self.word(0x047E);
        let (zsw1, speed) = self.send(0x047F, 0x0CCD, Duration::from_secs(6));
        assert_eq!(zsw1 & 0x0077, 0x0037, "{zsw1:04X}");
        assert!((0x0B00..=0x0E00).contains(&speed), "{speed:04X}");
    }

    fn inject_fault(&mut self) {
        let fault = self.make.fault;
        let segment = self.medium.segment_mut();
        let host = segment.station_mut::<Host<Station>>(self.station).unwrap();
        host.endpoint_mut().drive_mut().inject_fault(fault, false);
    }
}

const CYCLES: Duration = Duration::from_millis(160);

fn modules(device: &Device) -> Vec<ModuleConfig> {
    let submodule = |subslot, ident, input_length, output_length| SubmoduleConfig {
        subslot,
        ident,
        input_length,
        output_length,
    };
    let telegram = device.telegram(1).unwrap();
    let access_point = device
        .access_point()
        .map(|(subslot, ident)| submodule(subslot, ident, 0, 0))
        .collect();
    let parameters = &device.layout.parameters;
    let mut drive: Vec<SubmoduleConfig> = parameters
        .submodule
        .map(|ident| submodule(parameters.subslot, ident, 0, 0))
        .into_iter()
        .collect();
    let (inputs, outputs) = (telegram.inputs, telegram.outputs);
    drive.push(submodule(
        device.layout.telegram,
        telegram.submodule,
        inputs,
        outputs,
    ));
    vec![
        ModuleConfig {
            api: 0,
            slot: 0,
            ident: device.access_point_module,
            submodules: access_point,
        },
        ModuleConfig {
            api: device.api.into(),
            slot: 1,
            ident: telegram.module,
            submodules: drive,
        },
    ]
}

/// One line of the checklist: its number, and for whom it is.
struct Line {
    number: u16,
    vlt: bool,
    vacon: bool,
    check: fn(&mut Bench),
}

const fn both(number: u16, check: fn(&mut Bench)) -> Line {
    Line {
        number,
        vlt: true,
        vacon: true,
        check,
    }
}

const fn vacon(number: u16, check: fn(&mut Bench)) -> Line {
    Line {
        vlt: false,
        ..both(number, check)
    }
}

const fn vlt(number: u16, check: fn(&mut Bench)) -> Line {
    Line {
        vacon: false,
        ..both(number, check)
    }
}

/// Answer to line 1: 922 of the VLT is an octet, of the Vacon a word.
fn telegram_block(bench: &Bench) -> Vec<u8> {
    if bench.make.axis == 0 {
        bench.hex("05 01 01 00")
    } else {
        bench.hex("42 01 00 01")
    }
}

static LINES: &[Line] = &[
    // A. Parameter access
    both(1, |bench| {
        let expected = [bench.hex("01 01 DD 01"), telegram_block(bench)].concat();
        assert_eq!(bench.ask("01 01 DD 01 10 01 03 9A 00 00"), expected);
    }),
    both(4, |bench| {
        let answer = bench.ask("01 01 DD 01 10 01 03 9A 00 00");
        assert_eq!(answer[2..4], [bench.make.axis, 1]);
    }),
    both(7, |bench| {
        assert_eq!(bench.error("07 01 DD 01 10 01 03 9A 00 05"), 4)
    }),
    both(10, |bench| {
        let expected = if bench.make.axis == 0 { 0x16 } else { 0x69 };
        assert_eq!(bench.error("0A 01 DD 01 50 01 03 9A 00 00"), expected);
    }),
    vacon(13, |bench| {
        let mut request = vec![0x0D, 1, 1, 40];
        (0..40).for_each(|_| request.extend([0x10, 1, 0x03, 0x9A, 0, 0]));
        let answer = bench.job(&request);
        assert_eq!(answer[..2], [0x0D, 0x81], "{answer:02X?}");
        assert_eq!(answer[4..], [0x44, 1, 0, 0x68]);
    }),
    both(16, |bench| {
        let expected = [
            bench.hex("10 81 DD 02"),
            telegram_block(bench),
            bench.hex("44 01 00 00"),
        ]
        .concat();
        let answer = bench.ask("10 01 DD 02 10 01 03 9A 00 00 10 01 FF FE 00 00");
        assert_eq!(answer, expected);
    }),
    both(19, |bench| {
        let count = bench.make.model.dialect.max_parameters;
        let mut request = vec![0x13, 1, bench.make.axis, count];
        (0..count).for_each(|_| request.extend([0x10, 8, 0x03, 0xB3, 0, 0]));
        let answer = bench.job(&request);
        assert!(answer.len() <= 240 && answer[1] == 0x81, "{answer:02X?}");
        let too_long = |block: &[u8]| block == [0x44, 1, 0, 0x15];
        assert!(answer.windows(4).any(too_long), "{answer:02X?}");
    }),
    both(22, |bench| {
        let block = bench.make.block;
        assert_eq!(bench.change(2, block), [0x19, 2, bench.make.axis, 1]);
    }),
    both(25, |bench| {
        let mut block = bench.make.block.to_vec();
        block[0] = 0x50;
        let answer = bench.change(2, &block);
        assert_eq!(answer[1], 0x82);
        assert!(matches!(answer[4..], [0x44, _, 0, 0x17 | 5, ..]), "{answer:02X?}");
    }),
    vacon(28, |bench| {
        assert_eq!(bench.change(2, &[0x42, 1, 0, 30])[..2], [0x19, 2]);
        assert_eq!(bench.words(10001, 103, 1), [30]);
    }),
    both(34, |bench| {
        let (address, block) = (bench.make.writable, bench.make.block);
        let mut request = vec![0x22, 2, bench.make.axis, 2];
        for _ in 0..2 {
            request.extend([0x10, 1]);
            request.extend(address);
            request.extend(block);
        }
        match bench.job_at(LOCAL, &request) {
            Err(_) => {}
            Ok(answer) => {
                assert_eq!(answer[1], 0x82, "{answer:02X?}");
                let refused = |block: &[u8]| matches!(block, [0x44, 1 | 2, 0, 0x16..=0x18 | 0x65..=0x6D]);
                assert!(answer.windows(4).any(refused), "{answer:02X?}");
            }
        }
    }),
    vacon(37, |bench| {
        assert_eq!(bench.error("00 01 DD 01 10 01 03 9A 00 00"), 0x65)
    }),
    // B. Transport
    both(40, |bench| {
        let before = bench.medium.now();
        bench.ask("01 01 DD 01 10 01 03 9A 00 00");
        assert!(bench.medium.now() - before < Duration::from_secs(1));
    }),
    vacon(43, |bench| {
        let request = bench.hex("01 01 DD 01 10 01 03 9A 00 00");
        let local = bench.job_at(LOCAL, &request).unwrap();
        assert_eq!(bench.job_at(GLOBAL, &request).unwrap(), local);
    }),
    // C. Description and text
    both(46, |bench| {
        let answer = bench.ask("2E 01 DD 01 20 01 03 9A 00 00");
        assert_eq!(answer[1], 1, "{answer:02X?}");
        assert_eq!((answer[4..6].to_vec(), answer.len()), (vec![0x0A, 46], 52));
    }),
    vlt(49, |bench| {
        let [a, b, ..] = bench.make.writable;
        let mut limit = |element| {
            let answer = bench.job(&[0x2F, 1, 0, 1, 0x20, 1, a, b, 0, element]);
            assert_eq!(answer[..6], [0x2F, 1, 0, 1, 0x0A, 4], "{answer:02X?}");
            u32::from_be_bytes(answer[6..10].try_into().unwrap())
        };
        let (low, high) = (limit(7), limit(8));
        let block = |raw: u32| [&[7, 1][..], &raw.to_be_bytes()].concat();
        assert_eq!(bench.change(2, &block(low))[1], 2);
        assert_eq!(bench.change(2, &block(high))[1], 2);
        let answer = bench.change(2, &block(high + 1));
        assert!(matches!(answer[4..], [0x44, _, 0, 2, ..]), "{answer:02X?}");
        bench.change(2, bench.make.block);
    }),
    vacon(52, |bench| {
        let error = bench.error("34 01 DD 01 30 01 03 9A 00 00");
        assert!(matches!(error, 0x0F | 0x16 | 0x69), "{error:02X}");
    }),
    // D. Profile parameters
    both(55, |bench| {
        let answer = bench.ask("37 01 DD 01 10 02 03 C5 00 00");
        let single = bench.ask("37 01 DD 01 10 01 03 C5 00 00");
        let number = |answer: &[u8]| answer.windows(2).any(|pair| matches!(pair, [3, 0x29 | 0x2A]));
        assert!(
            number(&answer[4..]) || number(&single[4..]),
            "{answer:02X?} {single:02X?}"
        );
    }),
    both(58, |bench| {
        // each list ends with 0 or its last element; the next one goes on where it is not empty
        let mut list = Vec::new();
        for pnu in 980..=989_u16 {
            let [high, low] = pnu.to_be_bytes();
            let answer = bench.job(&[0x3A, 1, bench.make.axis, 1, 0x20, 1, high, low, 0, 0]);
            if answer[1] != 1 {
                break;
            }
            assert_eq!(answer[4..6], [0x0A, 46], "{pnu}: {answer:02X?}");
            let elements = u16::from_be_bytes([answer[8], answer[9]]).max(1);
            let most = bench.make.model.dialect.max_values.min(100);
            let before = list.len();
            let mut first = 0;
            while first < elements {
                let count = (elements - first).min(most);
                let some = bench.words(pnu, first, count as u8);
                let end = some.iter().position(|number| *number == 0);
                list.extend(&some[..end.unwrap_or(some.len())]);
                first = if end.is_some() { elements } else { first + count };
            }
            if list.len() == before {
                break;
            }
        }
        assert!(list.len() > 8, "{list:?}");
        assert!(list.windows(2).all(|pair| pair[0] < pair[1]), "{list:?}");
        assert!(list.iter().all(|pnu| !(980..=989).contains(pnu)), "{list:?}");
        assert!(list.contains(&922), "{list:?}");
    }),
    both(61, |bench| {
        assert_eq!(bench.words(922, 0, 1), [1]);
        if bench.make.axis == 1 {
            assert_eq!(bench.words(915, 0, 2), [1, 5]);
            assert_eq!(bench.words(916, 0, 2), [2, 6]);
        } else {
            // 9-15 and 9-16 of a VLT hold parameter numbers for the words behind; its 9-23 tells those of the signals
            assert_eq!(bench.words(923, 1, 2), [1680, 1603]);
            assert_eq!(bench.words(923, 5, 2), [1682, 1605]);
        }
    }),
    vacon(67, |bench| {
        let before = bench.words(944, 0, 1)[0];
        bench.inject_fault();
        bench.word(0x047E);
        assert_eq!(bench.words(944, 0, 1)[0], before.wrapping_add(1));
        bench.word(0x04FE);
        bench.word(0x047E);
    }),
    vacon(73, |bench| {
        let answer = bench.ask("49 01 DD 01 20 01 03 B3 00 02");
        assert!(answer.ends_with(&[0, 8]), "{answer:02X?}");
        bench.inject_fault();
        bench.word(0x047E);
        let active = bench.words(947, 0, 8);
        assert!(active[0] != 0, "{active:?}");
        bench.word(0x04FE);
        bench.word(0x047E);
        let acknowledged = bench.words(947, 0, 8);
        assert_eq!(
            (acknowledged[0], acknowledged[1]),
            (0, active[0]),
            "{acknowledged:?}"
        );
    }),
    // E. State machine
    both(76, |bench| assert_eq!(bench.word(0x047E), 0x0031)),
    both(79, |bench| {
        let mut fresh = Bench::sending(bench.make, [0x04, 0x7F, 0, 0]);
        for _ in 0..5 {
            let zsw1 = fresh.word(0x047F);
            assert_eq!(zsw1 & 0x0046, 0x0040, "{zsw1:04X}");
        }
    }),
    both(82, |bench| {
        bench.run();
        let (zsw1, speed) = bench.send(0x047E, 0x0CCD, Duration::from_millis(200));
        assert!(speed > 0x0100, "{speed}");
        assert_eq!(zsw1 & 0x0042, 0x0002, "{zsw1:04X}");
        let (zsw1, speed) = bench.send(0x047E, 0x0CCD, Duration::from_secs(6));
        assert_eq!(
            (zsw1 & 0x0077, speed.abs() < 16),
            (0x0031, true),
            "{zsw1:04X} {speed}"
        );
    }),
    both(85, |bench| {
        bench.run();
        let (_, speed) = bench.send(0x047B, 0x0CCD, Duration::from_millis(48));
        assert!(speed > 0x0100, "{speed}");
        let mut back = false;
        for _ in 0..60 {
            let (zsw1, _) = bench.send(0x047F, 0x0CCD, Duration::from_millis(100));
            back |= zsw1 & 0x0077 == 0x0037;
        }
        let zsw1 = bench.word(0x047F);
        assert_eq!((back, zsw1 & 0x0046), (false, 0x0040), "{zsw1:04X}");
        assert_eq!(bench.word(0x047E), 0x0031);
    }),
    both(88, |bench| {
        bench.run();
        bench.send(0x047D, 0x0CCD, Duration::from_secs(8));
        for _ in 0..5 {
            let (zsw1, _) = bench.send(0x047F, 0, CYCLES);
            assert_eq!(zsw1 & 0x0077, 0x0070, "{zsw1:04X}");
        }
        assert_eq!(bench.word(0x047E), 0x0031);
    }),
    both(91, |bench| {
        assert_eq!(bench.word(0x047E), 0x0031);
        assert_eq!(bench.word(0x007F), 0x0031);
        assert_eq!(bench.word(0x047F), 0x0037);
        bench.word(0x047E);
    }),
    both(94, |bench| {
        bench.run();
        bench.inject_fault();
        let (zsw1, _) = bench.send(0x047E, 0, Duration::from_secs(8));
        assert_eq!(zsw1 & 0x0008, 0x0008, "{zsw1:04X}");
        bench.word(0x04FE);
        let (zsw1, _) = bench.send(0x047E, 0, CYCLES);
        assert_eq!((zsw1 & 0x0008, zsw1 & 0x0077), (0, 0x0031), "{zsw1:04X}");
    }),
    both(100, |bench| {
        bench.word(0x047E);
        let (zsw1, speed) = bench.send(0x047F, 0x4000, Duration::from_secs(30));
        assert_eq!(zsw1 & 0x0077, 0x0037, "{zsw1:04X}");
        // a motor without speed sensor: its slip is missing in the actual speed
        assert!((0x4000 - speed).abs() <= 0x0380, "{speed:04X}");
        bench.send(0x047E, 0, Duration::from_secs(30));
    }),
    // H. Dialects
    vacon(127, |bench| {
        for id in [1_u16, 2, 101, 103, 104, 1424] {
            let [high, low] = id.to_be_bytes();
            let answer = bench.job(&[0x7F, 1, 1, 1, 0x10, 1, 0x27, 0x11, high, low]);
            assert!(
                matches!(answer[1..6], [1, 1, 1, 0x42, 1]) || answer[1] == 0x81,
                "ID {id}: {answer:02X?}"
            );
        }
    }),
    vlt(130, |bench| {
        let answer = bench.ask("02 01 DD 01 10 01 05 FA 00 00");
        assert_eq!(answer[1], 1, "{answer:02X?}");
        assert_eq!(bench.error("02 01 DD 01 10 01 05 FA 03 E7"), 3);
    }),
];

/// The lines of the sample, sections A to E and H, that name a VLT or all drives. 97 (local operation) is not among them:
/// the virtual converters have no panel; the machine behind is tested for it in `profidrive::state`.
const FOR_VLT: [u16; 24] = [
    1, 4, 7, 10, 16, 19, 22, 25, 34, 40, 46, 49, 55, 58, 61, 76, 79, 82, 85, 88, 91, 94, 100, 130,
];
/// The same of a Vacon.
const FOR_VACON: [u16; 30] = [
    1, 4, 7, 10, 13, 16, 19, 22, 25, 28, 34, 37, 40, 43, 46, 52, 55, 58, 61, 67, 73, 76, 79, 82, 85, 88, 91,
    94, 100, 127,
];

fn walk(make: &'static Make, mine: fn(&Line) -> bool) -> Vec<u16> {
    let lines = LINES.iter().filter(|line| mine(line));
    let mut failed = Vec::new();
    let mut numbers = Vec::new();
    for line in lines {
        numbers.push(line.number);
        let check = || (line.check)(&mut Bench::new(make));
        if std::panic::catch_unwind(check).is_err() {
            failed.push(line.number);
        }
    }
    assert!(
        failed.is_empty(),
        "{}: lines {failed:?}",
        make.model.catalogue.model
    );
    numbers
}

#[test]
fn the_vlt_keeps_every_line() {
    let numbers = walk(&VLT, |line| line.vlt);
    assert_eq!(numbers, FOR_VLT);
}

#[test]
fn the_vacon_keeps_every_line() {
    assert_eq!(walk(&VACON, |line| line.vacon), FOR_VACON);
}

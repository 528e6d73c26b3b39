//! The PKW channel on the serial line: a drive behind a slave, a client behind a master, octets as printed.

#![allow(clippy::unwrap_used)] // the helpers of a test report by panicking

use std::time::Duration;

use profidrive_uss::{
    Address, Event, Layout, MAX_DATA, MAX_TELEGRAM, Master, MasterConfig, Parts, Slave, SlaveConfig,
};
use profile::parameter::{Attributes, ErrorNumber, Format, Keep, ParameterAccess};
use profile::pkw::{
    Answer, Client, ClientTiming, Job, JobError, MAX_BLOCK, Memory, Outcome, PkwDialect, PkwErrorNumber,
    PkwValue, Server,
};

fn hex(text: &str) -> Vec<u8> {
    text.split_whitespace()
        .map(|octet| u8::from_str_radix(octet, 16).unwrap())
        .collect()
}

/// 4-14, 15-30 with ten elements, 15-40 and an actual value.
struct Vlt {
    limit: u16,
    actual: u16,
    kept: bool,
}

impl ParameterAccess for Vlt {
    fn attributes(&self, pnu: u16, _: u16) -> Option<Attributes> {
        let (format, octets, elements, writable) = match pnu {
            414 => (Format::UNSIGNED16, 2, 0, true),
            1530 => (Format::UNSIGNED8, 1, 10, false),
            1540 => (Format::VISIBLE_STRING, 1, 20, false),
            1613 => (Format::UNSIGNED16, 2, 0, false),
            _ => return None,
        };
        Some(Attributes {
            elements,
            ..Attributes::simple(format, octets, writable)
        })
    }

    fn read(&mut self, pnu: u16, subindex: u16) -> Result<u64, ErrorNumber> {
        Ok(match pnu {
            414 => self.limit.into(),
            1530 => u64::from(subindex) * 13,
            1540 => b"FC-302              "[usize::from(subindex)].into(),
            _ => self.actual.into(),
        })
    }

    fn write(&mut self, _: u16, _: u16, raw: u64, keep: Keep) -> Result<(), ErrorNumber> {
        self.kept = keep == Keep::Permanent;
        self.limit = u16::try_from(raw).unwrap();
        Ok(())
    }
}

/// A drive at the line.
struct Station {
    slave: Slave,
    server: Server,
    drive: Vlt,
    status: [u8; 4],
    control: Vec<u8>,
}

impl Station {
    fn new() -> Self {
        Self {
            slave: Slave::new(SlaveConfig::fc(1, 9600)),
            server: Server::new(PkwDialect::DANFOSS_FC),
            drive: Vlt {
                limit: 1500,
                actual: 7,
                kept: false,
            },
            status: [0; 4],
            control: Vec::new(),
        }
    }

    /// Octets in at the pace of the line, the reply out, and the time from the end of one to the beginning of the other.
    fn exchange(&mut self, start: Duration, octets: &[u8]) -> Option<(Vec<u8>, Duration)> {
        let mut now = start;
        for &octet in octets {
            now += self.slave.config().timing.character;
            self.slave.handle_octets(now, &[octet]);
        }
        let end = now;
        now = self.slave.poll_timeout()?;
        self.slave.handle_timeout(now);
        let request = self.slave.poll_request()?;
        let parts = Layout::FC.split(request.data).unwrap();
        self.control = parts.pzd.to_vec();
        let (mut pkw, mut data) = ([0; MAX_BLOCK], [0; MAX_DATA]);
        let mut length = 0;
        if !parts.pkw.is_empty() {
            length = self
                .server
                .handle_block(parts.pkw, &mut self.drive, &mut pkw)
                .ok()?;
        }
        let parts = Parts {
            pkw: &pkw[..length],
            pzd: &self.status,
        };
        let length = Layout::FC.join(parts, &mut data).unwrap();
        self.slave.respond(&data[..length]).unwrap();
        let mut out = [0; MAX_TELEGRAM];
        let length = self.slave.poll_transmit(now, &mut out)?;
        Some((out[..length].to_vec(), now - end))
    }

    fn answers(&mut self, octets: &str) -> Vec<u8> {
        let (reply, delay) = self.exchange(Duration::from_secs(1), &hex(octets)).unwrap();
        assert!(delay <= Duration::from_millis(50), "{delay:?}");
        reply
    }
}

/// The worked frames of the FC protocol, whole, with their check octets.
#[test]
fn frames_as_printed() {
    // read 15-30 index 1, in both forms of the address
    let mut drive = Station::new();
    let reply = drive.answers("02 0E 81 15 FA 00 01 00 00 00 00 00 00 00 00 63");
    assert_eq!(reply, hex("02 0E 81 15 FA 00 01 00 00 00 0D 00 00 00 00 6E"));
    let reply = Station::new().answers("02 0E 01 15 FA 00 01 00 00 00 00 00 00 00 00 E3");
    assert_eq!(reply[2], 0x01);
    // 4-14 := 1000 in RAM and EEPROM
    let mut drive = Station::new();
    let reply = drive.answers("02 0E 81 E1 9E 00 00 00 00 03 E8 00 00 00 00 19");
    assert_eq!(reply[3..11], hex("11 9E 00 00 00 00 03 E8"));
    assert_eq!((drive.drive.limit, drive.drive.kept), (1000, true));
    // a parameter that is not there, status word 0603: the printed rejection, but for its parameter number
    let mut drive = Station::new();
    drive.status = [0x06, 0x03, 0, 0];
    let reply = drive.answers("02 0E 81 15 FB 00 01 00 00 00 00 00 00 00 00 62");
    assert_eq!(reply, hex("02 0E 81 75 FB 00 01 00 00 00 00 06 03 00 00 07"));
    // the text 15-40: LGE is 10 and its six characters
    let reply = drive.answers("02 0E 81 F6 04 04 00 00 00 00 00 04 7C 00 00 03");
    assert_eq!(
        reply,
        hex("02 10 81 F6 04 04 00 46 43 2D 33 30 32 06 03 00 00 79")
    );
    // process data alone
    let reply = drive.answers("02 06 81 04 7C 20 00 DD");
    assert_eq!(reply, hex("02 06 81 06 03 00 00 80"));
    assert_eq!(drive.control, hex("04 7C 20 00"));
}

/// To all: taken, and not answered.
#[test]
fn a_broadcast_is_executed_without_answer() {
    for octets in ["02 06 80 04 3C 00 00 BC", "02 06 20 04 3C 00 00 1C"] {
        let mut drive = Station::new();
        assert_eq!(drive.exchange(Duration::from_secs(1), &hex(octets)), None);
        assert_eq!(drive.control, hex("04 3C 00 00"), "{octets}");
    }
}

/// A read that stands is answered with the present value in every telegram.
#[test]
fn a_reply_is_refreshed() {
    let mut drive = Station::new();
    let mut start = Duration::from_secs(1);
    for actual in [5, 600, 0xFFFF] {
        drive.drive.actual = actual;
        let mut request = hex("02 0E 81 16 4D 00 00 00 00 00 00 00 00 00 00");
        request.push(profidrive_uss::bcc(&request));
        let (reply, _) = drive.exchange(start, &request).unwrap();
        assert_eq!(reply[3..9], hex("16 4D 00 00 00 00"));
        assert_eq!(reply[9..11], actual.to_be_bytes());
        start += Duration::from_millis(100);
    }
}

/// Jobs of a client through master, line and slave; some telegrams are lost on the way.
#[test]
fn a_client_behind_a_master() {
    let mut drive = Station::new();
    let mut master = Master::new(MasterConfig::fc(9600));
    let mut client = Client::new(PkwDialect::DANFOSS_FC, ClientTiming::SERIAL);
    let id = master.add(Address::fc(1).unwrap(), &[0; 12]).unwrap();
    let mut now = Duration::from_secs(1);
    let read = |pnu, element| Job::Read { pnu, element };
    let value = |word| Ok(Answer::Value(PkwValue::Word(word)));
    let jobs: [(Job<'_>, Outcome); 7] = [
        (read(414, None), value(1500)),
        (
            Job::Change {
                pnu: 414,
                element: None,
                value: PkwValue::Word(900),
                memory: Memory::Ram,
            },
            value(900),
        ),
        (read(414, None), value(900)),
        (read(1530, Some(3)), value(39)),
        (
            read(1530, Some(10)),
            Err(JobError::Refused(PkwErrorNumber::SUBINDEX)),
        ),
        (Job::ReadText { pnu: 1540, index: 0 }, Ok(Answer::Text)),
        (
            read(99, None),
            Err(JobError::Refused(PkwErrorNumber::UNKNOWN_PARAMETER)),
        ),
    ];
    let mut sent = 0;
    for (job, expected) in jobs {
        client.start(now, job).unwrap();
        let mut outcome = None;
        for _ in 0..200 {
            let mut data = [0; MAX_DATA];
            let parts = Parts {
                pkw: client.request(now),
                pzd: &[0x04, 0x7C, 0, 0],
            };
            let length = Layout::FC.join(parts, &mut data).unwrap();
            master.set_data(id, &data[..length]).unwrap();
            let mut out = [0; MAX_TELEGRAM];
            if let Some(length) = master.poll_transmit(now, &mut out) {
                sent += 1;
                // each third telegram is lost
                let carried = if sent % 3 == 0 { 0 } else { length };
                if let Some((reply, delay)) = drive.exchange(now, &out[..carried]) {
                    let timing = drive.slave.config().timing;
                    let mut at = now + timing.telegram(carried) + delay;
                    for octet in reply {
                        at += timing.character;
                        master.handle_octets(at, &[octet]);
                    }
                }
            }
            now = master.poll_timeout().unwrap().max(now);
            master.handle_timeout(now);
            outcome = client.handle_timeout(now);
            if master.poll_event() == Some(Event::Reply(id)) {
                let pkw = Layout::FC.split(master.reply(id)).unwrap().pkw;
                outcome = client.handle(now, pkw);
            }
            if outcome.is_some() {
                break;
            }
        }
        assert_eq!(outcome, Some(expected), "{job:?}");
        if expected == Ok(Answer::Text) {
            assert_eq!(client.text(), b"FC-302");
        }
    }
    assert!(master.statistics(id).repeated > 0);
}

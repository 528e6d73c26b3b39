//! The older parameter channel, and the serial line that carries it.

use std::time::Duration;

use profile::parameter::{Attributes, ErrorNumber, Format, Keep, ParameterAccess};
use profile::pkw::{
    Client, ClientTiming, Job, MAX_BLOCK, Memory, PKW_LEN, Pkw, PkwDialect, PkwValue, RequestCode, Server,
};
use uss::{
    Address, Event, Layout, MAX_TELEGRAM, Master, MasterConfig, Receiver, Slave, SlaveConfig, Telegram,
    Timing,
};

use super::steps::{Step, Steps};

const DIALECTS: [PkwDialect; 5] = [
    PkwDialect::STANDARD,
    PkwDialect::DANFOSS_FC,
    PkwDialect::DANFOSS_PPO,
    PkwDialect::SIEMENS_PPO,
    PkwDialect::SIEMENS_USS,
];

/// The parameter channel: frames are request blocks for a drive, datagrams reply blocks for a client. The first octet
/// chooses the dialect.
pub fn pkw(data: &[u8]) {
    let Some((choice, data)) = data.split_first() else {
        return;
    };
    let dialect = DIALECTS[usize::from(*choice) % DIALECTS.len()];
    let mut drive = AnyDrive::default();
    let mut server = Server::new(dialect);
    let mut client = Client::new(dialect, ClientTiming::CYCLIC);
    let mut now = Duration::ZERO;
    let mut begun = now;
    for (number, step) in Steps(data).enumerate() {
        match step {
            Step::Frame(block) => served(&mut server, &mut drive, block),
            Step::Datagram(block) => {
                if client.handle(now, block).is_none() && !client.is_busy() {
                    let pnu = u16::from(block.first().copied().unwrap_or(0));
                    let _ = client.start(now, job(number, pnu, block));
                    begun = now;
                }
            }
            Step::Wait(time) => now += time,
        }
        let _ = client.handle_timeout(now);
        let longest = 2 * (ClientTiming::CYCLIC.reply + ClientTiming::CYCLIC.round_trip);
        assert!(
            !client.is_busy() || now - begun < longest,
            "a job hangs in {}",
            dialect.name
        );
        let request = client.request(now).to_vec();
        served(&mut server, &mut drive, &request);
    }
}

fn job(number: usize, pnu: u16, text: &[u8]) -> Job<'_> {
    let element = (number & 8 != 0).then_some(1);
    match number % 7 {
        0 => Job::Read { pnu, element },
        1 => Job::Change {
            pnu,
            element,
            value: PkwValue::Word(7),
            memory: Memory::Ram,
        },
        2 => Job::Change {
            pnu,
            element,
            value: PkwValue::DoubleWord(7),
            memory: Memory::Eeprom,
        },
        3 => Job::CountElements { pnu },
        4 => Job::Description { pnu, element: 1 },
        5 => Job::ReadText { pnu, index: 0 },
        _ => Job::ChangeText { pnu, index: 0, text },
    }
}

/// Whatever is asked, the reply mirrors it, has an AK of the dialect, and nothing is written when it is asked again.
fn served(server: &mut Server, drive: &mut AnyDrive, block: &[u8]) {
    let dialect = *server.dialect();
    let mut out = [0; MAX_BLOCK];
    let Ok(length) = server.handle_block(block, drive, &mut out) else {
        return;
    };
    let written = drive.writes;
    let mut again = [0; MAX_BLOCK];
    assert_eq!(server.handle_block(block, drive, &mut again), Ok(length));
    assert_eq!((again, drive.writes), (out, written), "{block:02x?}");
    let head = |block: &[u8]| {
        let mut octets = [0; PKW_LEN];
        octets[..4].copy_from_slice(&block[..4]);
        Pkw::from_octets(octets)
    };
    let (request, reply) = (head(block), head(&out));
    assert!(
        dialect.replies_with(reply.reply_code()),
        "{} {block:02x?}",
        dialect.name
    );
    if request.request_code() == RequestCode::NONE {
        assert!(out[..length].iter().all(|octet| *octet == 0));
    } else {
        assert_eq!(request.address(&dialect), reply.address(&dialect));
    }
    let _ = (
        request.words(&dialect).request().to_string(),
        reply.words(&dialect).reply().to_string(),
    );
}

/// Octets of a line, with pauses: frames go to the receiver, a slave and a master, datagrams only to the master. The
/// first octet chooses FC or USS.
pub fn serial(data: &[u8]) {
    let Some((choice, data)) = data.split_first() else {
        return;
    };
    let fc = choice & 1 == 0;
    let (timing, layout) = if fc {
        (Timing::fc(19_200), Layout::FC)
    } else {
        (Timing::uss(19_200), Layout::USS)
    };
    let (slave, master, address) = if fc {
        (
            SlaveConfig::fc(1, 19_200),
            MasterConfig::fc(19_200),
            Address(0x81),
        )
    } else {
        (
            SlaveConfig::uss(1, 19_200),
            MasterConfig::uss(19_200),
            Address(0x01),
        )
    };
    let mut receiver = Receiver::new(timing, layout);
    let mut slave = Slave::new(slave);
    let mut master = Master::new(master);
    let id = master.add(address, &[0x11; 12]).unwrap();
    let mut now = Duration::from_secs(1);
    let mut out = [0; MAX_TELEGRAM];
    for step in Steps(data) {
        match step {
            Step::Wait(time) => now += time,
            Step::Frame(octets) | Step::Datagram(octets) => {
                for &octet in octets {
                    now += timing.character;
                    receiver.handle_octet(now, octet);
                    check(&mut receiver, layout);
                    if matches!(step, Step::Frame(_)) {
                        slave.handle_octets(now, &[octet]);
                    }
                    master.handle_octets(now, &[octet]);
                }
            }
        }
        receiver.handle_timeout(now);
        check(&mut receiver, layout);
        slave.handle_timeout(now);
        master.handle_timeout(now);
        if let Some(request) = slave.poll_request() {
            assert!(layout.split(request.data).is_some());
            slave.respond(&[0x22; 12]).unwrap();
        }
        for length in [
            slave.poll_transmit(now, &mut out),
            master.poll_transmit(now, &mut out),
        ]
        .into_iter()
        .flatten()
        {
            assert!(length <= MAX_TELEGRAM);
        }
        assert!(
            master.poll_timeout().is_some(),
            "the master stands still: {:?}",
            master.line()
        );
        while let Some(event) = master.poll_event() {
            assert!(matches!(event, Event::Reply(slave) | Event::Lost(slave) if slave == id));
            assert!(master.reply(id).is_empty() || layout.split(master.reply(id)).is_some());
        }
    }
    if let Ok(telegram) = Telegram::decode(data) {
        let length = telegram.encode(&mut out).unwrap();
        assert_eq!(&out[..length], data);
    }
}

fn check(receiver: &mut Receiver, layout: Layout) {
    if let Some(telegram) = receiver.take() {
        assert!(layout.split(telegram.data).is_some());
    }
}

/// A drive that has a parameter of each kind under many numbers.
#[derive(Default)]
struct AnyDrive {
    value: u64,
    writes: u32,
}

impl ParameterAccess for AnyDrive {
    fn attributes(&self, pnu: u16, _: u16) -> Option<Attributes> {
        let (format, octets, elements) = match pnu % 8 {
            0 => (Format::UNSIGNED8, 1, 0),
            1 => (Format::INTEGER8, 1, 3),
            2 => (Format::INTEGER16, 2, 0),
            3 => (Format::UNSIGNED32, 4, 300),
            4 => (Format::VISIBLE_STRING, 1, pnu >> 3),
            5 => (Format::OCTET_STRING, 1, 9),
            6 => (Format(0xFF), 8, 0),
            _ => return None,
        };
        Some(Attributes {
            elements,
            ..Attributes::simple(format, octets, pnu & 16 == 0)
        })
    }

    fn read(&mut self, pnu: u16, _: u16) -> Result<u64, ErrorNumber> {
        if pnu & 32 == 0 {
            Ok(self.value)
        } else {
            Err(ErrorNumber(pnu >> 5))
        }
    }

    fn write(&mut self, _: u16, _: u16, raw: u64, _: Keep) -> Result<(), ErrorNumber> {
        self.writes += 1;
        self.value = raw;
        Ok(())
    }

    fn may_change(&self, pnu: u16) -> bool {
        pnu & 64 == 0
    }
}

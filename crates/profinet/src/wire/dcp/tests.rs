use super::*;
use crate::IpSuite;
use crate::wire::SliceWriter;
use alloc::vec;
use alloc::vec::Vec;
use proptest::prelude::*;

fn hex(text: &str) -> Vec<u8> {
    let digits: Vec<u32> = text.chars().filter_map(|c| c.to_digit(16)).collect();
    digits
        .chunks(2)
        .map(|p| u8::try_from(p[0] * 16 + p[1]).unwrap())
        .collect()
}

fn suite(address: [u8; 4], mask: [u8; 4], gateway: [u8; 4]) -> IpSuite {
    IpSuite {
        address: address.into(),
        mask: mask.into(),
        gateway: gateway.into(),
    }
}

fn write(
    service: ServiceId,
    kind: ServiceType,
    xid: u32,
    delay: u16,
    fill: impl FnOnce(&mut PduWriter<'_, Vec<u8>>),
) -> Vec<u8> {
    let mut out = vec![];
    let mut pdu = PduWriter::new(&mut out, service, kind, xid, delay);
    fill(&mut pdu);
    pdu.finish();
    out
}

#[test]
fn identify_by_name() {
    let golden = hex("05 00 00 00 00 02 00 01 00 0c 02 02 00 07 64 72 69 76 65 2d 31 00");
    let built = write(ServiceId::Identify, ServiceType::Request, 2, 1, |p| {
        p.filter(&Value::Name(b"drive-1"))
    });
    assert_eq!(built, golden);
    let pdu = Pdu::parse(&golden).unwrap();
    assert_eq!(
        (pdu.service, pdu.kind, pdu.xid, pdu.delay_factor),
        (ServiceId::Identify, ServiceType::Request, 2, 1)
    );
    let blocks: Vec<_> = pdu.blocks().map(|b| b.unwrap().filter().unwrap()).collect();
    assert_eq!(blocks, [Value::Name(b"drive-1")]);
}

#[test]
fn set_ip_of_an_s7_and_its_answer() {
    let golden = hex("04 00 03 00 01 2d 00 00 00 12 01 02 00 0e 00 00 ac 10 02 0a ff ff ff 00 ac 10 02 0a");
    let ip = suite([172, 16, 2, 10], [255, 255, 255, 0], [172, 16, 2, 10]);
    let built = write(ServiceId::Set, ServiceType::Request, 0x0300_012D, 0, |p| {
        p.set(Qualifier::TEMPORARY, &Value::Ip(ip));
    });
    assert_eq!(built, golden);
    let pdu = Pdu::parse(&golden).unwrap();
    let block = pdu.blocks().next().unwrap().unwrap();
    assert_eq!(block.set(), Ok((Qualifier::TEMPORARY, Value::Ip(ip))));

    let golden = hex("04 01 03 00 01 2d 00 00 00 08 05 04 00 03 01 02 00 00");
    let built = write(ServiceId::Set, ServiceType::Success, 0x0300_012D, 0, |p| {
        p.result(DcpOption::IP, BlockError::Ok);
    });
    assert_eq!(built, golden);
    let block = Pdu::parse(&golden).unwrap().blocks().next().unwrap().unwrap();
    assert_eq!(block.result(), Ok((DcpOption::IP, BlockError::Ok)));
}

#[test]
fn captured_set_name_and_signal() {
    let golden = hex("04 00 f2 a5 16 1a 00 00 00 10 02 02 00 0b 00 00 64 72 69 76 65 2d 6f 6e 65 00");
    let built = write(ServiceId::Set, ServiceType::Request, 0xF2A5_161A, 0, |p| {
        p.set(Qualifier::TEMPORARY, &Value::Name(b"drive-one"));
    });
    assert_eq!(
        built, golden,
        "the pad octet of an odd name is in DCPDataLength, not in the block"
    );
    let golden = hex("04 00 7f 80 cf 90 00 00 00 08 05 03 00 04 00 00 01 00");
    let built = write(ServiceId::Set, ServiceType::Request, 0x7F80_CF90, 0, |p| {
        p.set(Qualifier::TEMPORARY, &Value::FLASH);
    });
    assert_eq!(built, golden);
}

// the answer of the p-net sample application to Identify-All
const P_NET: &str = "05 01 77 00 02 31 00 00 00 76 01 02 00 0e 00 00 00 00 00 00 00 00 00 00 00 00 00 00 02 01 00 1a
    00 00 50 2d 4e 65 74 20 53 61 6d 70 6c 65 20 41 70 70 6c 69 63 61 74 69 6f 6e 02 02 00 0d 00 00 72 74 2d 6c 61
    62 73 2d 64 65 76 00 02 03 00 06 00 00 04 93 00 02 02 04 00 04 00 00 01 01 02 05 00 1e 00 00 01 02 01 01 02 01
    02 02 02 03 02 04 02 05 02 06 05 01 05 02 05 03 05 05 05 06 ff ff";

#[test]
fn captured_identify_answer() {
    let bytes = hex(P_NET);
    let pdu = Pdu::parse(&bytes).unwrap();
    assert_eq!((pdu.kind, pdu.xid), (ServiceType::Success, 0x7700_0231));
    let values: Vec<_> = pdu
        .blocks()
        .map(|b| b.unwrap())
        .map(|b| {
            // p-net puts 1 into the reserved octet of the role; it is not evaluated
            b.info().unwrap()
        })
        .collect();
    assert_eq!(values[0], (BlockInfo::NONE, Value::Ip(IpSuite::NONE)));
    assert_eq!(values[1].1, Value::StationType(b"P-Net Sample Application"));
    assert_eq!(values[2].1, Value::Name(b"rt-labs-dev"));
    assert_eq!(
        values[3].1,
        Value::DeviceId {
            vendor: 0x0493,
            device: 2
        }
    );
    assert_eq!(values[4].1, Value::Role(role::DEVICE));
    assert!(matches!(values[5].1, Value::Options(list) if list.len() == 28));
    assert_eq!(values.len(), 6);
    let built = write(ServiceId::Identify, ServiceType::Success, 0x7700_0231, 0, |p| {
        for (info, value) in &values {
            p.info(*info, value);
        }
    });
    let mut expected = bytes.clone();
    let role = bytes.windows(4).position(|w| w == [0, 4, 0, 0]).unwrap() + 5;
    expected[role] = 0;
    assert_eq!(built, expected);
}

#[test]
fn captured_hello() {
    let bytes = hex(
        "06 00 00 00 00 01 00 00 00 40 02 02 00 0d 00 00 72 74 2d 6c 61 62 73 2d 64 65 76 00 01 02 00 0e 00 00 c0 a8
         4d 0a ff ff ff 00 c0 a8 4d 01 02 03 00 06 00 00 04 93 00 02 02 08 00 06 00 00 ca fe ee 02 06 01 00 04 00 00
         00 01",
    );
    let pdu = Pdu::parse(&bytes).unwrap();
    assert_eq!(pdu.service, ServiceId::Hello);
    let values: Vec<_> = pdu.blocks().map(|b| b.unwrap().info().unwrap()).collect();
    let built = write(ServiceId::Hello, ServiceType::Request, 1, 0, |p| {
        for (info, value) in &values {
            p.info(*info, value);
        }
    });
    assert_eq!(built, bytes);
    assert_eq!(
        values[3].1,
        Value::OemDeviceId {
            vendor: 0xCAFE,
            device: 0xEE02
        }
    );
    assert_eq!(values[4].1, Value::Initiative(1));
}

#[test]
fn get_lists_pairs() {
    let built = write(ServiceId::Get, ServiceType::Request, 7, 0, |p| {
        p.request(DcpOption::NAME);
        p.request(DcpOption::IP);
    });
    assert_eq!(built, hex("03 00 00 00 00 07 00 00 00 04 02 02 01 02"));
    let pdu = Pdu::parse(&built).unwrap();
    let asked: Vec<_> = pdu.requested().map(Result::unwrap).collect();
    assert_eq!(asked, [DcpOption::NAME, DcpOption::IP]);
    let odd = hex("03 00 00 00 00 07 00 00 00 03 02 02 01");
    let asked: Vec<_> = Pdu::parse(&odd).unwrap().requested().collect();
    assert_eq!(asked.len(), 2);
    assert_eq!(asked[1].unwrap_err().offset, 12);
}

#[test]
fn reset_qualifiers() {
    assert_eq!(Qualifier::reset(2), Qualifier(4));
    assert_eq!(Qualifier(5).reset_mode(), 2);
    assert_eq!(Qualifier(0x13).reset_mode(), 9);
    assert!(Qualifier::PERMANENT.is_permanent() && !Qualifier::TEMPORARY.is_permanent());
}

#[test]
fn wrong_lengths_are_reported_with_their_offset() {
    let bytes = hex("04 00 00 00 00 01 00 00 00 08 01 02 00 04 00 01 c0 a8");
    let block = Pdu::parse(&bytes).unwrap().blocks().next().unwrap().unwrap();
    let error = block.set().unwrap_err();
    assert_eq!((error.what, error.offset), ("DCP IP address", 16));
    let long = Block {
        option: DcpOption::ROLE,
        body: &[0, 0, 1, 0, 9],
        offset: 14,
    };
    assert_eq!(long.info().unwrap_err().problem, Problem::Trailing { count: 1 });
    assert!(long.result().is_err());
    let all = Block {
        option: DcpOption::ALL,
        body: &[0, 0],
        offset: 14,
    };
    assert_eq!(all.filter(), Ok(Value::ALL), "some testers send two octets");
}

#[test]
fn padding_at_the_very_end_may_be_missing() {
    let bytes = hex("05 00 00 00 00 02 00 01 00 0b 02 02 00 07 64 72 69 76 65 2d 31");
    let blocks: Vec<_> = Pdu::parse(&bytes).unwrap().blocks().collect();
    assert_eq!(blocks[0].unwrap().filter(), Ok(Value::Name(b"drive-1")));
    assert_eq!(blocks.len(), 1);
}

#[test]
fn every_cut_is_an_error_or_ends_early() {
    let bytes = hex(P_NET);
    for cut in 0..bytes.len() {
        assert!(Pdu::parse(&bytes[..cut]).is_err(), "{cut}");
    }
    // the same with a length that fits the cut
    for cut in HEADER..bytes.len() {
        let mut cut_bytes = bytes[..cut].to_vec();
        let length = u16::try_from(cut - HEADER).unwrap();
        cut_bytes[8..10].copy_from_slice(&length.to_be_bytes());
        let pdu = Pdu::parse(&cut_bytes).unwrap();
        let count = pdu.blocks().count();
        assert!(count <= 6);
    }
}

#[test]
fn delay_is_spread_by_mac() {
    let mac = MacAddress([2, 0, 0, 0, 0x01, 0x02]);
    assert_eq!(response_delay(mac, 1), Duration::ZERO);
    assert_eq!(response_delay(mac, 0), Duration::ZERO);
    assert_eq!(response_delay(mac, 100), Duration::from_millis(580));
    assert_eq!(response_delay(mac, 6400), Duration::from_millis(2580));
    assert_eq!(response_delay(mac, 6401), Duration::ZERO);
}

#[test]
fn a_fixed_buffer_takes_a_pdu_too() {
    let mut buffer = [0xA5; 64];
    let mut out = SliceWriter::new(&mut buffer);
    let mut pdu = PduWriter::new(&mut out, ServiceId::Identify, ServiceType::Request, 9, 5);
    pdu.filter(&Value::ALL);
    pdu.finish();
    let n = out.finish().unwrap();
    assert_eq!(buffer[..n], hex("05 00 00 00 00 09 00 05 00 04 ff ff 00 00"));
    assert_eq!(buffer[n], 0xA5);
}

fn value<'a>(kind: u8, n: [u8; 28], text: &'a [u8]) -> Value<'a> {
    let ip = suite(
        [n[0], n[1], n[2], n[3]],
        [n[4], n[5], n[6], n[7]],
        [n[8], n[9], n[10], n[11]],
    );
    let word = u16::from_be_bytes([n[0], n[1]]);
    let other = u16::from_be_bytes([n[2], n[3]]);
    match kind % 16 {
        0 => Value::Mac(MacAddress([n[0], n[1], n[2], n[3], n[4], n[5]])),
        1 => Value::Ip(ip),
        2 => Value::FullIp {
            suite: ip,
            dns: [[n[12], n[13], n[14], n[15]].into(); 4],
        },
        3 => Value::StationType(text),
        4 => Value::Name(text),
        5 => Value::DeviceId {
            vendor: word,
            device: other,
        },
        6 => Value::Role(n[0]),
        7 => Value::Options(&text[..text.len() / 2 * 2]),
        8 => Value::Alias(text),
        9 => Value::Instance(word),
        10 => Value::OemDeviceId {
            vendor: word,
            device: other,
        },
        11 => Value::Signal(word),
        12 => Value::Initiative(word),
        13 => Value::ALL,
        14 => Value::Empty(DcpOption::RESET_TO_FACTORY),
        _ => Value::Other(DcpOption::new(3, 61), text),
    }
}

proptest! {
    #[test]
    fn round_trip(kinds in proptest::collection::vec(any::<u8>(), 0..8), n: [u8; 28], prefix: u16,
                  text in proptest::collection::vec(any::<u8>(), 0..40), xid: u32) {
        let values: Vec<_> = kinds.iter().map(|k| value(*k, n, &text)).collect();
        let filters = write(ServiceId::Identify, ServiceType::Request, xid, 1, |p| {
            for v in &values { p.filter(v); }
        });
        let pdu = Pdu::parse(&filters).unwrap();
        let read: Vec<_> = pdu.blocks().map(|b| b.unwrap().filter().unwrap()).collect();
        prop_assert_eq!(&read, &values);
        let sets = write(ServiceId::Set, ServiceType::Request, xid, 0, |p| {
            for v in &values { p.set(Qualifier(prefix), v); }
        });
        let pdu = Pdu::parse(&sets).unwrap();
        for (block, v) in pdu.blocks().zip(&values) {
            prop_assert_eq!(block.unwrap().set(), Ok((Qualifier(prefix), *v)));
            prop_assert_eq!(block.unwrap().info(), Ok((BlockInfo(prefix), *v)));
        }
    }

    #[test]
    fn any_octets_are_read_without_panic(bytes in proptest::collection::vec(any::<u8>(), 0..120)) {
        judge(&bytes);
    }

    #[test]
    fn flipped_bits_are_read_without_panic(flips in proptest::collection::vec((0usize..128, 0u8..8), 1..6)) {
        let mut bytes = hex(P_NET);
        for (at, bit) in flips {
            let at = at % bytes.len();
            bytes[at] ^= 1 << bit;
        }
        judge(&bytes);
    }

    #[test]
    fn codes_keep_their_number(n: u8) {
        prop_assert_eq!(u8::from(ServiceId::from(n)), n);
        prop_assert_eq!(u8::from(ServiceType::from(n)), n);
        prop_assert_eq!(u8::from(BlockError::from(n)), n);
    }
}

fn judge(bytes: &[u8]) {
    if let Ok(pdu) = Pdu::parse(bytes) {
        assert!(pdu.blocks().count() <= bytes.len());
        for block in pdu.blocks().flatten() {
            let _ = (block.filter(), block.info(), block.set(), block.result());
        }
        assert!(pdu.requested().count() <= bytes.len());
    }
}

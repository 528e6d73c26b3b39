use super::*;
use alloc::borrow::Cow;
use alloc::string::ToString;
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

// p-net sample application, button pressed: notification, acknowledgements both ways
const PROCESS: &str =
    "00 01 00 01 11 11 ff ff ff fe 00 1d 00 01 00 19 01 00 00 02 00 00 00 00 00 01 00 01 00 00 00 30
    00 00 01 30 00 00 00 10 01";
const PROCESS_ACK: &str =
    "00 01 00 01 11 11 ff ff ff ff 00 16 80 01 00 12 01 00 00 02 00 00 00 00 00 01 00 01 00 00 00 00 00 00";
const DIAGNOSIS: &str =
    "00 01 00 01 11 11 ff ff ff fe 00 28 00 02 00 24 01 00 00 01 00 00 00 00 00 01 00 01 00 00 00
    30 00 00 01 30 a8 00 80 02 00 04 28 01 00 01 00 00 00 00 00 00";
const ERR: &str = "00 01 00 01 14 01 00 00 ff fe 00 04 cf 81 fd 00";

fn encode(pdu: &RtaPdu<'_>) -> Vec<u8> {
    let mut out = vec![];
    pdu.encode(&mut out);
    out
}

#[test]
fn captured_process_alarm() {
    let bytes = hex(PROCESS);
    let pdu = RtaPdu::parse(&bytes).unwrap();
    assert_eq!(
        (pdu.kind, pdu.version, pdu.flags),
        (RtaType::Data, 1, RtaPdu::FLAGS_DATA)
    );
    assert_eq!((pdu.send_sequence, pdu.ack_sequence), (0xFFFF, 0xFFFE));
    let Alarm::Notification(alarm) = pdu.alarm().unwrap() else {
        panic!("notification")
    };
    let expected = Notification {
        priority: Priority::High,
        alarm_type: AlarmType::PROCESS,
        api: 0,
        slot: 1,
        subslot: 1,
        module_ident: 0x30,
        submodule_ident: 0x130,
        specifier: AlarmSpecifier(0),
        usi: Some(0x10),
        data: Cow::Borrowed(&[1]),
    };
    assert_eq!(alarm, expected);
    assert_eq!(
        alarm.items().next(),
        Some(Ok(DiagnosisItem::Other {
            usi: 0x10,
            data: &[1]
        }))
    );
    let mut block = vec![];
    alarm.encode(&mut block);
    assert_eq!(block.len(), alarm.len());
    assert_eq!(encode(&RtaPdu { data: &block, ..pdu }), bytes);

    let bytes = hex(PROCESS_ACK);
    let pdu = RtaPdu::parse(&bytes).unwrap();
    let ack = AlarmAck::to(&expected, PnioStatus::OK);
    assert_eq!(pdu.alarm(), Ok(Alarm::Ack(ack)));
    let mut block = vec![];
    ack.encode(&mut block);
    assert_eq!(encode(&RtaPdu { data: &block, ..pdu }), bytes);
}

#[test]
fn captured_diagnosis_alarm() {
    let bytes = hex(DIAGNOSIS);
    let pdu = RtaPdu::parse(&bytes).unwrap();
    let Alarm::Notification(alarm) = pdu.alarm().unwrap() else {
        panic!("notification")
    };
    assert_eq!(
        (alarm.priority, alarm.alarm_type),
        (Priority::Low, AlarmType::DIAGNOSIS)
    );
    assert_eq!(
        alarm.specifier.0,
        AlarmSpecifier::CONNECTION | AlarmSpecifier::SUBMODULE | AlarmSpecifier::CHANNEL
    );
    let items: Vec<_> = alarm.items().map(Result::unwrap).collect();
    let [DiagnosisItem::Channel(channel)] = items[..] else {
        panic!("one channel")
    };
    assert_eq!((channel.channel, channel.properties), (4, 0x2801));
    assert_eq!(
        (channel.severity(), channel.specifier()),
        (Severity::Fault, Specifier::Appears)
    );
    assert_eq!(channel.error_words(), Some("short circuit"));
    assert_eq!((channel.extended, channel.usi()), (Some((0, 0)), 0x8002));
    let owned = alarm.clone().into_owned();
    assert_eq!(owned, alarm);
}

#[test]
fn maintenance_in_front_of_a_diagnosis() {
    let data = hex(
        "0f 00 00 08 01 00 00 00 00 00 00 01 80 00 80 00 0a 00 00 05 80 03 00 01 08 00 00 09 00 02 00 00
        00 07 00 00 00 10",
    );
    let items: Vec<_> = DiagnosisItems::new(Some(0x8100), &data)
        .map(Result::unwrap)
        .collect();
    assert_eq!(items.len(), 3);
    assert_eq!(items[0], DiagnosisItem::Maintenance(1));
    let DiagnosisItem::Channel(second) = items[1] else {
        panic!()
    };
    assert_eq!(
        (second.channel, second.severity(), second.usi()),
        (0x8000, Severity::MaintenanceRequired, 0x8000)
    );
    let DiagnosisItem::Channel(third) = items[2] else {
        panic!()
    };
    assert_eq!((third.extended, third.qualifier), (Some((2, 7)), Some(0x10)));
    let mut out = vec![];
    third.encode(&mut out);
    assert_eq!(out, data[data.len() - 16..]);
    assert!(
        DiagnosisItems::new(Some(0x8100), &[0; 12])
            .next()
            .unwrap()
            .is_err()
    );
}

#[test]
fn captured_err() {
    let bytes = hex(ERR);
    let pdu = RtaPdu::parse(&bytes).unwrap();
    assert_eq!(pdu.error(), Ok(PnioStatus::aborted(0)));
    assert_eq!(encode(&pdu), bytes);
    assert!(
        RtaPdu {
            kind: RtaType::Ack,
            ..pdu
        }
        .error()
        .is_err()
    );
    assert!(
        RtaPdu {
            data: &[0xCF, 0x81, 0xFD],
            ..pdu
        }
        .error()
        .is_err()
    );
}

#[test]
fn wrong_blocks_say_where() {
    let mut bytes = hex(PROCESS);
    bytes[16] = 2;
    let error = RtaPdu::parse(&bytes).unwrap().alarm().unwrap_err();
    assert_eq!((error.what, error.offset), ("alarm BlockVersion", 16));
    let mut bytes = hex(PROCESS);
    bytes[12] = 7;
    let error = RtaPdu::parse(&bytes).unwrap().alarm().unwrap_err();
    assert_eq!((error.what, error.offset), ("alarm BlockType", 12));
}

#[test]
fn every_cut_is_an_error() {
    for golden in [PROCESS, PROCESS_ACK, DIAGNOSIS, ERR] {
        let bytes = hex(golden);
        for cut in 0..bytes.len() {
            assert!(RtaPdu::parse(&bytes[..cut]).is_err());
        }
        for cut in 0..bytes.len() - HEADER {
            assert!(Alarm::decode(Reader::new(&bytes[HEADER..HEADER + cut])).is_err());
        }
        let mut padded = bytes.clone();
        padded.resize(60, 0);
        assert_eq!(RtaPdu::parse(&padded), RtaPdu::parse(&bytes));
    }
}

#[test]
fn words_and_numbers() {
    assert_eq!(AlarmType(0x0A).to_string(), "plug wrong submodule");
    assert_eq!(AlarmType(0x77).to_string(), "alarm type 0x0077");
    assert_eq!(AlarmSpecifier(0xA800).with_sequence(2049), AlarmSpecifier(0xA801));
    for n in 0..=255u8 {
        assert_eq!(u8::from(RtaType::from(n)), n);
    }
}

proptest! {
    #[test]
    fn round_trip(high: bool, kind: u16, place: (u32, u16, u16), idents: (u32, u32), specifier: u16,
                  usi: Option<u16>, data in proptest::collection::vec(any::<u8>(), 0..60), sequence: (u16, u16)) {
        let alarm = Notification {
            priority: if high { Priority::High } else { Priority::Low },
            alarm_type: AlarmType(kind), api: place.0, slot: place.1, subslot: place.2,
            module_ident: idents.0, submodule_ident: idents.1, specifier: AlarmSpecifier(specifier), usi,
            data: if usi.is_some() { Cow::Owned(data) } else { Cow::Owned(vec![]) },
        };
        for alarm in [Alarm::Ack(AlarmAck::to(&alarm, PnioStatus::from_u32(idents.0))), Alarm::Notification(alarm)] {
            let mut block = vec![];
            alarm.encode(&mut block);
            let pdu = RtaPdu { destination: 1, source: 2, kind: RtaType::Data, version: 1, flags: 0x11,
                send_sequence: sequence.0, ack_sequence: sequence.1, data: &block };
            let bytes = encode(&pdu);
            prop_assert_eq!(RtaPdu::parse(&bytes), Ok(pdu));
            prop_assert_eq!(pdu.alarm(), Ok(alarm));
        }
    }

    #[test]
    fn any_octets_are_read_without_panic(bytes in proptest::collection::vec(any::<u8>(), 0..80)) {
        judge(&bytes);
    }

    #[test]
    fn flipped_bits_are_read_without_panic(which in 0usize..4, flips in proptest::collection::vec((0usize..64, 0u8..8), 1..5)) {
        let mut bytes = hex([PROCESS, PROCESS_ACK, DIAGNOSIS, ERR][which]);
        for (at, bit) in flips {
            let at = at % bytes.len();
            bytes[at] ^= 1 << bit;
        }
        judge(&bytes);
    }
}

fn judge(bytes: &[u8]) {
    let Ok(pdu) = RtaPdu::parse(bytes) else { return };
    let _ = pdu.error();
    if let Ok(Alarm::Notification(alarm)) = pdu.alarm() {
        assert!(alarm.items().count() <= bytes.len());
    }
}

use alloc::vec::Vec;

use proptest::collection::vec;
use proptest::prelude::*;

use super::*;
use crate::wire::block::BlockType;
use crate::wire::{PnioStatus, Reader, Uuid};
use crate::{IpSuite, MacAddress};

fn modules() -> impl Strategy<Value = Identification> {
    let submodule = any::<(u16, u32)>().prop_map(|(subslot, ident)| IdentifiedSubmodule { subslot, ident });
    let module = (0u32..2, any::<u16>(), any::<u32>(), vec(submodule, 0..4)).prop_map(
        |(api, slot, ident, submodules)| IdentifiedModule {
            api,
            slot,
            ident,
            submodules,
        },
    );
    vec(module, 0..4).prop_map(|modules| Identification { modules })
}

/// Every truncation is an error, every flipped bit is survived.
fn damage<T>(record: &[u8], at: u16, bit: u8, decode: impl Fn(&[u8]) -> Result<T, crate::wire::DecodeError>) {
    for end in 0..record.len() {
        assert!(decode(&record[..end]).is_err());
    }
    let mut record = record.to_vec();
    let at = usize::from(at) % record.len();
    record[at] ^= 1 << bit;
    let _ = decode(&record);
}

proptest! {
    #[test]
    fn identifications_survive(identification in modules(), at: u16, bit in 0u8..8) {
        let kind = BlockType::REAL_IDENTIFICATION;
        let mut out = Vec::new();
        identification.encode(kind, 1, &mut out);
        prop_assert_eq!(Identification::decode(&mut Reader::new(&out), kind), Ok(identification));
        damage(&out, at, bit, |record| Identification::decode(&mut Reader::new(record), kind));
    }

    #[test]
    fn logs_survive(entries in vec(any::<(u64, [u8; 16], u32, u32)>(), 0..5), time: u64, at: u16, bit in 0u8..8) {
        let entries = entries.into_iter().map(|(time, uuid, status, detail)| LogEntry {
            time, ar_uuid: Uuid(uuid), status: PnioStatus::from_u32(status), detail,
        });
        let log = LogData { time, entries: entries.collect() };
        let mut out = Vec::new();
        log.encode(&mut out);
        prop_assert_eq!(LogData::decode(Reader::new(&out)), Ok(log));
        damage(&out, at, bit, |record| LogData::decode(Reader::new(record)));
    }

    #[test]
    fn apis_survive(apis in vec(any::<u32>(), 0..5), at: u16, bit in 0u8..8) {
        let mut out = Vec::new();
        encode_apis(&apis, &mut out);
        prop_assert_eq!(decode_apis(Reader::new(&out)), Ok(apis));
        damage(&out, at, bit, |record| decode_apis(Reader::new(record)));
    }

    #[test]
    fn im_records_survive(body: [u8; 54], vendor_id: u16, supported: u16, at: u16, bit in 0u8..8) {
        let im0 = Im0 { vendor_id, supported, ..Im0::default() };
        let mut out = Vec::new();
        im0.encode(&mut out);
        prop_assert_eq!(out.len(), 60);
        prop_assert_eq!(Im0::decode(Reader::new(&out)), Ok(im0));
        damage(&out, at, bit, |record| Im0::decode(Reader::new(record)));
        for number in 1..=4 {
            let body = if number == 2 { &body[..16] } else { &body[..] };
            let mut out = Vec::new();
            encode_im(number, body, &mut out);
            prop_assert_eq!(ImText::decode(Reader::new(&out), number), Ok(ImText { number, body }));
            damage(&out, at, bit, |record| ImText::decode(Reader::new(record), number).map(|_| ()));
            out.push(0);
            prop_assert!(ImText::decode(Reader::new(&out), number).is_err());
        }
    }

    #[test]
    fn interfaces_survive(name in "[a-z]{0,20}", mac: [u8; 6], at: u16, bit in 0u8..8) {
        let real = InterfaceReal { name: name.as_bytes(), mac: MacAddress(mac), ip: IpSuite::NONE };
        let mut out = Vec::new();
        real.encode(&mut out);
        prop_assert_eq!(out.len() % 4, 0);
        prop_assert_eq!(InterfaceReal::decode(Reader::new(&out)), Ok(real));
        damage(&out, at, bit, |record| InterfaceReal::decode(Reader::new(record)).map(|_| ()));
    }

    #[test]
    fn live_inputs_survive(data in vec(any::<u8>(), 0..20), iocs: u8, iops: u8, at: u16, bit in 0u8..8) {
        let live = RecordInput { iocs, iops, data: &data };
        let mut out = Vec::new();
        live.encode(&mut out);
        prop_assert_eq!(RecordInput::decode(Reader::new(&out)), Ok(live));
        damage(&out, at, bit, |record| RecordInput::decode(Reader::new(record)).map(|_| ()));
    }
}

#[test]
fn identification_of_version_1_0_has_no_api_level() {
    let record = b"\x00\x13\x00\x12\x01\x00\x00\x01\x00\x01\x00\x00\x00\x30\x00\x01\x00\x01\x00\x00\x00\x31";
    let decoded = Identification::decode(&mut Reader::new(record), BlockType::REAL_IDENTIFICATION).unwrap();
    assert_eq!(decoded.modules.len(), 1);
    assert_eq!(decoded.modules[0].submodules[0].ident, 0x31);
}

#[test]
fn ar_data_round_trips_and_truncated_records_are_errors() {
    let ar = |ar_type, station_name, apis| ArData {
        ar_uuid: Uuid::NIL,
        initiator_object: Uuid::NIL,
        properties: 0x4000_0011,
        ar_type,
        alarm_cr_type: 1,
        alarm_references: (1, 2),
        station_name,
        iocrs: alloc::vec![
            ArDataIocr {
                properties: 2,
                iocr_type: 1,
                frame_id: 0x8000,
                apdu_status: [0; 4],
            };
            2
        ],
        apis,
    };
    let mut record = Vec::new();
    encode_ar_data(
        &[
            ar(1, b"plc-1", alloc::vec![0, 0x3A00]),
            ar(6, b"tool", alloc::vec![]),
        ],
        &mut record,
    );
    let ars = decode_ar_list(&mut Reader::new(&record)).unwrap().unwrap();
    let seen: Vec<_> = ars.iter().map(|ar| (ar.ar_type, ar.station_name)).collect();
    assert_eq!(seen, [(1, &b"plc-1"[..]), (6, &b"tool"[..])]);
    for cut in 0..record.len() {
        assert!(decode_ar_list(&mut Reader::new(&record[..cut])).is_err(), "{cut}");
    }
}

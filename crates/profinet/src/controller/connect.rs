//! The connect request, built from a configuration, and the check of its answer.

use alloc::vec::Vec;

use super::config::{ConnectConfig, ModuleConfig, RtClass, StartUp};
use super::error::{Misuse, ServiceError};
use super::record::{malformed, matching, open};
use crate::MacAddress;
use crate::cyclic::{Layout, MAX_FACTOR, pack};
use crate::rpc::{CallError, Reply};
use crate::wire::Uuid;
use crate::wire::block::{
    AlarmCrRequest, ArProperties, ArRequest, ArType, ConnectResponse, ExpectedModule, ExpectedSubmodule,
    FrameObject, IocrApi, IocrRequest, IocrType, ModuleDiff,
};
use crate::wire::ethernet::{ETHERTYPE, FrameId, Tag};

/// IOCRReference of the input connection.
const INPUT: u16 = 1;
/// IOCRReference of the output connection.
const OUTPUT: u16 = 2;
/// Smallest MaxAlarmDataLength.
const MIN_ALARM: u16 = 200;

/// What names a connection in its request.
#[derive(Debug, Clone)]
pub(super) struct ArIdentity {
    pub ar_uuid: Uuid,
    pub session_key: u16,
    pub mac: MacAddress,
    pub object: Uuid,
    pub station_name: Vec<u8>,
}

/// Input and output layout of a checked configuration.
pub(super) fn check_config(config: &ConnectConfig) -> Result<(Layout, Layout), Misuse> {
    if config.start_up == StartUp::Advanced && config.rt_class == RtClass::Class1 {
        return Err(Misuse::ClassAndStartUp);
    }
    config
        .timing
        .check(config.watchdog_factor, config.data_hold_factor, 0)?;
    let in_range = [
        (
            (1..=1000).contains(&config.activity_timeout_factor),
            "activity time-out factor",
        ),
        (
            (1..=100).contains(&config.rta_timeout_factor),
            "RTA time-out factor",
        ),
        ((3..=15).contains(&config.rta_retries), "RTA retries"),
        ((200..=1432).contains(&config.max_alarm_length), "alarm length"),
        (
            !config.modules.is_empty() && config.modules.len() <= 1024,
            "number of modules",
        ),
        (
            config.modules.iter().all(|m| !m.submodules.is_empty()),
            "number of submodules",
        ),
        (config.modules.iter().all(|m| m.ident != 0), "module ident number"),
        (config.records.len() <= 4096, "number of records"),
        (config.watchdog_factor <= MAX_FACTOR, "watchdog factor"),
    ];
    if let Some((_, what)) = in_range.iter().find(|rule| !rule.0) {
        return Err(Misuse::Range(what));
    }
    let sizes: Vec<_> = config.sizes().collect();
    let mut places: Vec<_> = sizes.iter().map(|s| (s.slot, s.subslot)).collect();
    places.sort_unstable();
    if places.windows(2).any(|pair| pair.first() == pair.last()) {
        return Err(Misuse::Range("subslot, which appears twice"));
    }
    Ok(pack(&sizes)?)
}

/// FrameID of the input frames of the connection in place `slot`.
pub(super) const fn input_frame_id(class: RtClass, slot: u16) -> FrameId {
    let base = match class {
        RtClass::Class1 => 0xC000,
        RtClass::Class2 => 0x8000,
    };
    FrameId(base + (slot & 0x0FFF))
}

/// Place of the connection an input FrameID belongs to.
pub(super) fn slot_of(id: FrameId) -> usize {
    usize::from(id.0 & 0x0FFF)
}

fn ar_request(identity: &ArIdentity, ar_type: ArType, properties: u32, factor: u16) -> ArRequest {
    ArRequest {
        ar_type,
        ar_uuid: identity.ar_uuid,
        session_key: identity.session_key,
        initiator_mac: identity.mac,
        initiator_object: identity.object,
        properties: ArProperties(properties),
        activity_timeout_factor: factor,
        udp_rt_port: ETHERTYPE,
        station_name_length: u16::try_from(identity.station_name.len()).unwrap_or(u16::MAX),
        station_name: identity.station_name.clone(),
    }
}

/// Blocks of a device-access connect: only the AR block.
pub(super) fn access_request(identity: &ArIdentity, factor: u16) -> Vec<u8> {
    let properties =
        ArProperties::ACTIVE | ArProperties::PARAMETERIZED_BY_INITIATOR | ArProperties::DEVICE_ACCESS;
    let mut out = Vec::new();
    ar_request(identity, ArType::SUPERVISOR, properties, factor).encode(&mut out);
    out
}

/// Lists of one direction, grouped by API in order of appearance.
fn apis(layout: &Layout) -> Vec<IocrApi> {
    let mut apis: Vec<IocrApi> = Vec::new();
    fn of(apis: &mut Vec<IocrApi>, api: u32) -> Option<&mut IocrApi> {
        if !apis.iter().any(|a| a.api == api) {
            apis.push(IocrApi {
                api,
                data: Vec::new(),
                status: Vec::new(),
            });
        }
        apis.iter_mut().find(|a| a.api == api)
    }
    for d in layout.data_objects() {
        if let Some(group) = of(&mut apis, d.api) {
            group.data.push(FrameObject {
                slot: d.slot,
                subslot: d.subslot,
                offset: d.offset,
            });
        }
    }
    for s in layout.status_objects() {
        if let Some(group) = of(&mut apis, s.api) {
            group.status.push(FrameObject {
                slot: s.slot,
                subslot: s.subslot,
                offset: s.offset,
            });
        }
    }
    apis
}

fn iocr(config: &ConnectConfig, layout: &Layout, kind: IocrType, reference: u16, id: FrameId) -> IocrRequest {
    IocrRequest {
        iocr_type: kind,
        reference,
        lt: ETHERTYPE,
        properties: match config.rt_class {
            RtClass::Class1 => 1,
            RtClass::Class2 => 2,
        },
        data_length: layout.data_length(),
        frame_id: id.0,
        send_clock_factor: config.timing.send_clock_factor,
        reduction_ratio: config.timing.reduction_ratio,
        phase: config.timing.phase,
        sequence: 0,
        frame_send_offset: 0xFFFF_FFFF,
        watchdog_factor: config.watchdog_factor,
        data_hold_factor: config.data_hold_factor,
        tag_header: Tag::PRIORITY_6.0,
        multicast: MacAddress::default(),
        apis: apis(layout),
    }
}

fn expected(module: &ModuleConfig) -> ExpectedModule {
    ExpectedModule {
        api: module.api,
        slot: module.slot,
        ident: module.ident,
        properties: 0,
        submodules: module
            .submodules
            .iter()
            .map(|s| ExpectedSubmodule::new(s.subslot, s.ident, s.input_length, s.output_length))
            .collect(),
    }
}

/// Blocks of a cyclic connect in the order of an S7-1500: AR, both IOCR, one block per slot, AlarmCR.
pub(super) fn request(
    identity: &ArIdentity,
    config: &ConnectConfig,
    layouts: (&Layout, &Layout),
    input_id: FrameId,
    alarm_reference: u16,
) -> Vec<u8> {
    let mut properties = ArProperties::ACTIVE | ArProperties::PARAMETERIZED_BY_INITIATOR;
    if config.start_up == StartUp::Advanced {
        properties |= ArProperties::ADVANCED;
    }
    let mut out = Vec::new();
    ar_request(
        identity,
        ArType::IO_CONTROLLER,
        properties,
        config.activity_timeout_factor,
    )
    .encode(&mut out);
    iocr(config, layouts.0, IocrType::INPUT, INPUT, input_id).encode(&mut out);
    iocr(config, layouts.1, IocrType::OUTPUT, OUTPUT, FrameId::CHOOSE).encode(&mut out);
    for module in &config.modules {
        ExpectedModule::encode_block(&[expected(module)], &mut out);
    }
    AlarmCrRequest {
        alarm_cr_type: 1,
        lt: ETHERTYPE,
        properties: 0,
        rta_timeout_factor: config.rta_timeout_factor,
        rta_retries: config.rta_retries,
        local_alarm_reference: alarm_reference,
        max_alarm_data_length: config.max_alarm_length,
        tag_high: Tag::PRIORITY_6.0,
        tag_low: Tag::PRIORITY_5.0,
    }
    .encode(&mut out);
    out
}

/// What a device agreed to.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Agreement {
    pub mac: MacAddress,
    pub output_id: FrameId,
    pub alarm_reference: u16,
    pub max_alarm_length: u16,
    pub diff: Option<ModuleDiff>,
}

const CONNECT: &str = "connect";

fn answer(
    reply: &Result<Reply, CallError>,
    identity: &ArIdentity,
    ar_type: ArType,
    mac: Option<MacAddress>,
) -> Result<ConnectResponse, ServiceError> {
    let reader = open(CONNECT, reply)?;
    let response = ConnectResponse::decode(reader).map_err(malformed(CONNECT))?;
    let ar = &response.ar;
    matching(
        CONNECT,
        &[
            (ar.ar_type == ar_type, "ARType"),
            (ar.ar_uuid == identity.ar_uuid, "ARUUID"),
            (ar.session_key == identity.session_key, "session key"),
            (!ar.responder_mac.is_multicast(), "CMResponderMacAdd"),
            (mac.is_none_or(|mac| mac == ar.responder_mac), "CMResponderMacAdd"),
        ],
    )?;
    Ok(response)
}

/// Checks the answer to a device-access connect; gives the device's address.
pub(super) fn check_access(
    reply: &Result<Reply, CallError>,
    identity: &ArIdentity,
    mac: Option<MacAddress>,
) -> Result<MacAddress, ServiceError> {
    answer(reply, identity, ArType::SUPERVISOR, mac).map(|response| response.ar.responder_mac)
}

/// Checks the answer to a cyclic connect.
pub(super) fn check_response(
    reply: &Result<Reply, CallError>,
    identity: &ArIdentity,
    config: &ConnectConfig,
    mac: Option<MacAddress>,
    input_id: FrameId,
) -> Result<Agreement, ServiceError> {
    let response = answer(reply, identity, ArType::IO_CONTROLLER, mac)?;
    let one = |kind, reference| {
        let mut found = response
            .iocrs
            .iter()
            .filter(|i| i.iocr_type == kind && i.reference == reference);
        found.next().filter(|_| found.next().is_none())
    };
    let missing = |field| ServiceError::Mismatch { what: CONNECT, field };
    let input = one(IocrType::INPUT, INPUT).ok_or(missing("input IOCR"))?;
    let output = one(IocrType::OUTPUT, OUTPUT).ok_or(missing("output IOCR"))?;
    let alarm = response.alarm_cr.ok_or(missing("AlarmCR"))?;
    let output_id = FrameId(output.frame_id);
    matching(
        CONNECT,
        &[
            (response.iocrs.len() == 2, "number of IOCRs"),
            (input.frame_id == input_id.0, "FrameID of the input"),
            (output_id.is_cyclic(), "FrameID of the output"),
            (alarm.alarm_cr_type == 1, "AlarmCRType"),
        ],
    )?;
    let max_alarm_length = alarm
        .max_alarm_data_length
        .max(MIN_ALARM)
        .min(config.max_alarm_length);
    Ok(Agreement {
        mac: response.ar.responder_mac,
        output_id,
        alarm_reference: alarm.local_alarm_reference,
        max_alarm_length,
        diff: response.diff,
    })
}

/// Room offered for the answer: module differences may be long.
pub(super) fn stub(blocks: &[u8]) -> Vec<u8> {
    super::record::stub(32 * 1024, blocks)
}

#[cfg(test)]
mod tests {
    use super::super::config::SubmoduleConfig;
    use super::*;
    use crate::cyclic::Timing;
    use crate::wire::rpc::HEADER_LENGTH;
    use crate::wire::{ByteOrder, Reader};
    use alloc::vec;
    use proptest::prelude::*;

    fn hex(text: &str) -> Vec<u8> {
        let digits: Vec<u32> = text.chars().filter_map(|c| c.to_digit(16)).collect();
        digits
            .chunks(2)
            .map(|p| u8::try_from(p[0] * 16 + p[1]).unwrap())
            .collect()
    }

    // both IOCR blocks of a recorded connect (profinet-py to the p-net sample application, 32 ms)
    const INPUT_BLOCK: &str = "0102006801000001000188920000000100 28c0010020002000010000ffffffff000a000ac000
        0000000000000001000000000006000000010000000080000001000080010002000100010003000300010006000400010009
        0003000200010005000300010008000400010012";
    const OUTPUT_BLOCK: &str = "010200680100000200028892000000010028ffff0020002000010000ffffffff000a000ac000
        0000000000000001000000000003000200010004000300010007000400 01000a0006000000010000000080000001000080
        0100020001000100030003000100060004000100 09";
    // answers of p-net and of pnio behind the RPC header
    const P_NET: &str =
        "00000000000000460000 0fa000000000000000468101001e01000001ff22fb8075848cb3eb6d6e2549f1b98f
        f26d02504e000001889281020008010000010001c00181020008010000020002c0008103000801000001000100c8";
    const PNIO: &str =
        "000000000000005600000fa000000000000000568101001e010000016870878f4b38ebefd3453d43b36389c2
        3ccb02504e00000188928102000801000001000180018102000801000002000280028103000801000001000000c881 06000c
        01000008706e696f2d646576";

    fn module(slot: u16, submodules: &[(u16, u16, u16)]) -> ModuleConfig {
        let submodules = submodules
            .iter()
            .map(|(subslot, input_length, output_length)| SubmoduleConfig {
                subslot: *subslot,
                ident: 1,
                input_length: *input_length,
                output_length: *output_length,
            });
        ModuleConfig {
            api: 0,
            slot,
            ident: 1,
            submodules: submodules.collect(),
        }
    }

    fn config() -> ConnectConfig {
        let modules = vec![
            module(0, &[(1, 0, 0), (0x8000, 0, 0), (0x8001, 0, 0)]),
            module(1, &[(1, 1, 0)]),
            module(2, &[(1, 0, 1)]),
            module(3, &[(1, 1, 1)]),
            module(4, &[(1, 8, 8)]),
        ];
        let timing = Timing {
            send_clock_factor: 32,
            reduction_ratio: 32,
            phase: 1,
        };
        let mut config = ConnectConfig::legacy(modules, timing);
        config.watchdog_factor = 10;
        config.data_hold_factor = 10;
        config
    }

    fn identity(ar_uuid: &str, session_key: u16) -> ArIdentity {
        let mut uuid = [0; 16];
        uuid.copy_from_slice(&hex(ar_uuid));
        ArIdentity {
            ar_uuid: Uuid(uuid),
            session_key,
            mac: MacAddress([2, 0x50, 0x4e, 0, 0, 2]),
            object: Uuid::object(1, 1, 1),
            station_name: b"plc".to_vec(),
        }
    }

    fn reply(text: &str) -> Result<Reply, CallError> {
        Ok(Reply {
            order: ByteOrder::Big,
            stub: hex(text),
        })
    }

    #[test]
    fn iocr_blocks_equal_the_capture() {
        let config = config();
        let (input, output) = check_config(&config).unwrap();
        let id = input_frame_id(config.rt_class, 1);
        assert_eq!((id, slot_of(id)), (FrameId(0xC001), 1));
        let mut out = vec![];
        iocr(&config, &input, IocrType::INPUT, INPUT, id).encode(&mut out);
        assert_eq!(out, hex(INPUT_BLOCK));
        out.clear();
        iocr(&config, &output, IocrType::OUTPUT, OUTPUT, FrameId::CHOOSE).encode(&mut out);
        assert_eq!(out, hex(OUTPUT_BLOCK));
    }

    #[test]
    fn captured_answers_decode() {
        let who = identity("ff22fb8075848cb3eb6d6e2549f1b98f", 0xF26D);
        let mac = MacAddress([2, 0x50, 0x4e, 0, 0, 1]);
        let agreement = check_response(&reply(P_NET), &who, &config(), Some(mac), FrameId(0xC001)).unwrap();
        let expected = Agreement {
            mac,
            output_id: FrameId(0xC000),
            alarm_reference: 1,
            max_alarm_length: 200,
            diff: None,
        };
        assert_eq!(agreement, expected);
        let who = identity("6870878f4b38ebefd3453d43b36389c2", 0x3CCB);
        let agreement = check_response(&reply(PNIO), &who, &config(), None, FrameId(0x8001)).unwrap();
        assert_eq!(
            (agreement.output_id, agreement.alarm_reference),
            (FrameId(0x8002), 0)
        );
        let error = check_response(&reply(PNIO), &who, &config(), None, FrameId(0x8000)).unwrap_err();
        assert_eq!(
            error,
            ServiceError::Mismatch {
                what: "connect",
                field: "FrameID of the input"
            }
        );
        let other = Some(MacAddress([2, 9, 9, 9, 9, 9]));
        let error = check_response(&reply(PNIO), &who, &config(), other, FrameId(0x8001)).unwrap_err();
        assert_eq!(
            error,
            ServiceError::Mismatch {
                what: "connect",
                field: "CMResponderMacAdd"
            }
        );
        assert!(
            check_access(&reply(PNIO), &who, None).is_err(),
            "another kind of connection"
        );
    }

    #[test]
    fn every_cut_and_every_changed_octet_is_an_error_or_harmless() {
        let who = identity("ff22fb8075848cb3eb6d6e2549f1b98f", 0xF26D);
        let bytes = hex(P_NET);
        for cut in 0..bytes.len() {
            let reply = Ok(Reply {
                order: ByteOrder::Big,
                stub: bytes[..cut].to_vec(),
            });
            assert!(check_response(&reply, &who, &config(), None, FrameId(0xC001)).is_err());
        }
        let body = 20;
        let mut harmless = vec![];
        for at in body..bytes.len() {
            let mut stub = bytes.clone();
            stub[at] ^= 0x80;
            let reply = Ok(Reply {
                order: ByteOrder::Big,
                stub,
            });
            if check_response(&reply, &who, &config(), None, FrameId(0xC001)).is_ok() {
                harmless.push(at - body);
            }
        }
        // versions low, own address (not given here), ports, FrameID of the output, alarm reference and length
        assert!(harmless.len() < 24, "{harmless:?}");
        assert!(
            !harmless.iter().any(|at| (8..26).contains(at)),
            "ARUUID and session key are checked"
        );
    }

    #[test]
    fn configurations_that_cannot_be() {
        let change = |f: &dyn Fn(&mut ConnectConfig)| {
            let mut config = config();
            f(&mut config);
            check_config(&config).unwrap_err()
        };
        assert_eq!(
            change(&|c| c.start_up = StartUp::Advanced),
            Misuse::ClassAndStartUp
        );
        assert!(matches!(change(&|c| c.timing.phase = 0), Misuse::Cyclic(_)));
        assert!(matches!(
            change(&|c| c.modules[4] = module(4, &[(1, 1440, 0)])),
            Misuse::Cyclic(_)
        ));
        for wrong in [
            change(&|c| c.modules.clear()),
            change(&|c| c.modules[1].submodules.clear()),
            change(&|c| c.modules[1].ident = 0),
            change(&|c| c.modules[1].slot = 2),
            change(&|c| c.rta_retries = 2),
            change(&|c| c.rta_timeout_factor = 101),
            change(&|c| c.max_alarm_length = 199),
            change(&|c| c.activity_timeout_factor = 0),
        ] {
            assert!(matches!(wrong, Misuse::Range(_)), "{wrong}");
        }
    }

    #[test]
    fn a_device_access_request_is_one_block() {
        let blocks = access_request(&identity("6870878f4b38ebefd3453d43b36389c2", 1), 100);
        assert_eq!(blocks.len(), 58 + 3);
        assert_eq!(blocks[6..8], [0, 6]);
        assert_eq!(blocks[48..54], [0, 0, 1, 0x11, 0, 100]);
        let mut reader = Reader::with_base(&blocks, HEADER_LENGTH);
        assert!(reader.bytes(blocks.len(), "block").is_ok());
    }

    proptest! {
        #[test]
        fn hostile_answers_end_in_an_error_or_an_agreement(
            flips in proptest::collection::vec((0usize..256, any::<u8>()), 1..8), tail in proptest::collection::vec(any::<u8>(), 0..40)
        ) {
            let who = identity("6870878f4b38ebefd3453d43b36389c2", 0x3CCB);
            let mut stub = hex(PNIO);
            for (at, value) in flips {
                let at = at % stub.len();
                stub[at] = value;
            }
            stub.extend(tail);
            let reply = Ok(Reply { order: ByteOrder::Big, stub });
            let _ = check_response(&reply, &who, &config(), None, FrameId(0x8001));
            let _ = check_access(&reply, &who, None);
        }
    }
}

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

/// Blocks of a device-access connect: the AR block alone.
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

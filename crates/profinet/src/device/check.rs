//! What a connect request may request: every rule with the error it is refused with.

use alloc::collections::BTreeSet;
use alloc::vec::Vec;

use crate::cyclic::{Direction, IocrError, Layout, ObjectPlace, SubmoduleSize, Timing};
use crate::wire::block::{
    AlarmCrRequest, ArRequest, ArType, Block, BlockType, ExpectedModule, ExpectedSubmodule, IocrRequest,
    IocrType,
};
use crate::wire::ethernet::ETHERTYPE;
use crate::wire::{PnioStatus, Reader};

/// ErrorCode1: faulty ARBlockReq.
pub(super) const AR: u8 = 0x01;
/// ErrorCode1: faulty IOCRBlockReq.
const IOCR: u8 = 0x02;
/// ErrorCode1: faulty ExpectedSubmoduleBlockReq.
const EXPECTED: u8 = 0x03;
/// ErrorCode1: faulty AlarmCRBlockReq.
const ALARM_CR: u8 = 0x04;
/// ErrorCode1: context management over RPC.
pub(super) const RPC: u8 = 0x40;
/// ErrorCode2 of [`RPC`]: unknown blocks.
pub(super) const UNKNOWN_BLOCKS: u8 = 1;
/// ErrorCode2 of [`RPC`]: out of provider, consumer or alarm resources.
const OUT_OF_RESOURCES: u8 = 7;
/// ErrorCode2 of [`RPC`]: out of memory.
const OUT_OF_MEMORY: u8 = 8;

// The following limits bound the work of a request, so that no connect delays the cyclic data of the controller.
/// Maximum number of blocks of a request; controllers send one per slot and a few more.
const MAX_BLOCKS: usize = 512;
/// Most submodules that may be expected, many times what a drive has. The octets of 1440 submodules fill a frame.
const MAX_SUBMODULES: usize = 256;
/// Octets of the longest block that expects so many: each in a module of its own, with data both ways.
const MAX_EXPECTED: usize = 2 + MAX_SUBMODULES * (14 + 8 + 12);
/// Octets of the longest IOCR block that gives the places of so many: each with data and status in an API of its own.
const MAX_IOCR: usize = 40 + MAX_SUBMODULES * (8 + 6 + 6);
/// Most IOCR blocks that are looked at; two are served.
const MAX_IOCRS: usize = 4;

/// One direction of cyclic data as requested by the controller.
#[derive(Debug)]
pub(super) struct CheckedIocr {
    pub(super) request: IocrRequest,
    pub(super) timing: Timing,
    pub(super) layout: Layout,
}

/// Parts of an AR with cyclic data in addition to the ARBlockReq.
#[derive(Debug)]
pub(super) struct CheckedCyclic {
    /// In the order of the request.
    pub(super) iocrs: Vec<CheckedIocr>,
    pub(super) alarm_cr: AlarmCrRequest,
    pub(super) expected: Vec<ExpectedModule>,
}

/// A valid connect request.
#[derive(Debug)]
pub(super) struct CheckedConnect {
    pub(super) ar: ArRequest,
    /// `None` for an AR for record access.
    pub(super) cyclic: Option<CheckedCyclic>,
    /// APStructureIdentifier and API of the vendor blocks, to be echoed.
    pub(super) vendor: Vec<(u16, u32)>,
}

impl CheckedCyclic {
    pub(super) fn direction(&self, direction: IocrType) -> Option<&CheckedIocr> {
        self.iocrs.iter().find(|iocr| iocr.request.iocr_type == direction)
    }
}

fn refuse(code1: u8, code2: u8) -> PnioStatus {
    PnioStatus::connect(code1, code2)
}

/// ErrorCode1 of a request block that has one.
fn block_code(block_type: BlockType) -> Option<u8> {
    Some(match block_type {
        BlockType::AR_REQUEST => AR,
        BlockType::IOCR_REQUEST => IOCR,
        BlockType::EXPECTED_SUBMODULE => EXPECTED,
        BlockType::ALARM_CR_REQUEST => ALARM_CR,
        _ => return None,
    })
}

/// Reads the blocks of a connect request and checks each of them and their combination.
pub(super) fn check(mut reader: Reader<'_>, min_device_interval: u16) -> Result<CheckedConnect, PnioStatus> {
    let mut ar = None;
    let mut iocrs: Vec<IocrRequest> = Vec::new();
    let mut alarm_crs: Vec<AlarmCrRequest> = Vec::new();
    let mut expected: Vec<ExpectedModule> = Vec::new();
    let mut vendor = Vec::new();
    let (mut blocks, mut submodules) = (0, 0);
    while !reader.is_empty() {
        blocks += 1;
        if blocks > MAX_BLOCKS {
            return Err(refuse(RPC, OUT_OF_MEMORY));
        }
        let announced = BlockType(
            reader
                .peek_rest()
                .first_chunk()
                .map_or(0, |b| u16::from_be_bytes(*b)),
        );
        let code1 = block_code(announced);
        if ar.is_none() && announced != BlockType::AR_REQUEST {
            return Err(refuse(AR, 0));
        }
        let malformed = code1.map_or(refuse(RPC, 0), |code1| refuse(code1, 1));
        let block = Block::decode(&mut reader).map_err(|_| malformed)?;
        if let Some(code1) = code1 {
            match block.version {
                (1, 0) => {}
                (1, _) => return Err(refuse(code1, 3)),
                _ => return Err(refuse(code1, 2)),
            }
        }
        match block.block_type {
            BlockType::AR_REQUEST if ar.is_some() => return Err(refuse(AR, 0)),
            BlockType::AR_REQUEST => {
                let request = ArRequest::decode(block.body).map_err(|_| malformed)?;
                check_ar(&request)?;
                ar = Some(request);
            }
            BlockType::IOCR_REQUEST => {
                if iocrs.len() >= MAX_IOCRS || block.body.remaining() > MAX_IOCR {
                    return Err(refuse(RPC, OUT_OF_RESOURCES));
                }
                iocrs.push(IocrRequest::decode(block.body).map_err(|_| malformed)?);
            }
            BlockType::ALARM_CR_REQUEST => {
                alarm_crs.push(AlarmCrRequest::decode(block.body).map_err(|_| malformed)?);
            }
            BlockType::EXPECTED_SUBMODULE if block.body.remaining() > MAX_EXPECTED => {
                return Err(refuse(RPC, OUT_OF_MEMORY));
            }
            BlockType::EXPECTED_SUBMODULE => {
                let modules = ExpectedModule::decode_block(block.body).map_err(|_| malformed)?;
                if modules.is_empty() {
                    return Err(refuse(EXPECTED, 4));
                }
                submodules += modules
                    .iter()
                    .map(|module| module.submodules.len())
                    .sum::<usize>();
                if submodules.max(expected.len() + modules.len()) > MAX_SUBMODULES {
                    return Err(refuse(RPC, OUT_OF_MEMORY));
                }
                expected.extend(modules);
            }
            BlockType::AR_VENDOR_REQUEST => {
                let mut body = block.body;
                let identifier = body.u16("APStructureIdentifier").map_err(|_| refuse(0x0C, 1))?;
                vendor.push((identifier, body.u32("API").map_err(|_| refuse(0x0C, 1))?));
            }
            BlockType::AR_FSU | BlockType::RS_INFO => {}
            _ => return Err(refuse(RPC, UNKNOWN_BLOCKS)),
        }
    }
    let ar = ar.ok_or(refuse(AR, 0))?;
    if ar.properties.device_access() {
        if !(iocrs.is_empty() && alarm_crs.is_empty() && expected.is_empty()) {
            return Err(refuse(RPC, UNKNOWN_BLOCKS));
        }
        return Ok(CheckedConnect {
            ar,
            cyclic: None,
            vendor,
        });
    }
    let sizes = check_expected(&expected)?;
    let iocrs = check_iocrs(&ar, iocrs, &sizes, min_device_interval)?;
    let mut used = BTreeSet::new();
    for CheckedIocr { layout, .. } in &iocrs {
        used.extend(layout.data_objects().iter().map(|d| (d.slot, d.subslot)));
        used.extend(layout.status_objects().iter().map(|s| (s.slot, s.subslot)));
    }
    if !sizes.iter().all(|size| used.contains(&(size.slot, size.subslot))) {
        return Err(refuse(EXPECTED, 10));
    }
    let [alarm_cr] = alarm_crs[..] else {
        return Err(refuse(RPC, 3));
    };
    check_alarm_cr(&alarm_cr)?;
    Ok(CheckedConnect {
        ar,
        cyclic: Some(CheckedCyclic {
            iocrs,
            alarm_cr,
            expected,
        }),
        vendor,
    })
}

fn check_ar(ar: &ArRequest) -> Result<(), PnioStatus> {
    let name = ar.station_name.as_slice();
    let properties = ar.properties;
    let device_access = properties.device_access();
    let rules = [
        (
            ar.ar_type == ArType::IO_CONTROLLER || (ar.ar_type == ArType::SUPERVISOR && device_access),
            4,
        ),
        (!ar.ar_uuid.is_nil(), 5),
        (!ar.initiator_mac.is_multicast(), 7),
        (ar.initiator_object.object_parts().is_some(), 8),
        (
            properties.state() == 1
                && properties.parameterized_by_initiator()
                && properties.0 & 0xE0 == 0
                && properties.companion() == 0
                && (!device_access || ar.ar_type == ArType::SUPERVISOR),
            9,
        ),
        ((1..=1000).contains(&ar.activity_timeout_factor), 10),
        ((1..=240).contains(&ar.station_name_length), 12),
        (usize::from(ar.station_name_length) == name.len(), 1),
        (name.iter().all(u8::is_ascii_graphic), 13),
    ];
    first_broken(AR, &rules)
}

/// Refuses with the ErrorCode2 of the first violated rule.
fn first_broken(code1: u8, rules: &[(bool, u8)]) -> Result<(), PnioStatus> {
    match rules.iter().find(|rule| !rule.0) {
        Some((_, code2)) => Err(refuse(code1, *code2)),
        None => Ok(()),
    }
}

fn check_alarm_cr(alarm_cr: &AlarmCrRequest) -> Result<(), PnioStatus> {
    first_broken(
        ALARM_CR,
        &[
            (alarm_cr.alarm_cr_type == 1, 4),
            (alarm_cr.lt == ETHERTYPE, 5),
            // alarms over UDP and reserved bits are refused
            (alarm_cr.properties & !1 == 0, 6),
            ((1..=100).contains(&alarm_cr.rta_timeout_factor), 7),
            ((3..=15).contains(&alarm_cr.rta_retries), 8),
            ((200..=1432).contains(&alarm_cr.max_alarm_data_length), 10),
            (alarm_cr.tag_high == 0xC000, 11),
            (alarm_cr.tag_low == 0xA000, 12),
        ],
    )
}

fn check_expected(modules: &[ExpectedModule]) -> Result<Vec<SubmoduleSize>, PnioStatus> {
    let mut sizes: Vec<SubmoduleSize> = Vec::new();
    let (mut slots, mut subslots) = (BTreeSet::new(), BTreeSet::new());
    for module in modules {
        let twice = !slots.insert((module.api, module.slot));
        first_broken(
            EXPECTED,
            &[
                (module.slot <= 0x7FFF && !twice, 6),
                (module.ident != 0, 7),
                (module.properties == 0, 8),
                (!module.submodules.is_empty(), 9),
            ],
        )?;
        for submodule in &module.submodules {
            let subslot = submodule.subslot;
            let twice = !subslots.insert((module.slot, subslot));
            check_submodule(submodule, twice || (subslot >= 0x8000 && module.api != 0))?;
            let size = SubmoduleSize::new(
                module.api,
                module.slot,
                subslot,
                submodule.input_length(),
                submodule.output_length(),
            );
            sizes.push(size);
        }
    }
    Ok(sizes)
}

fn check_submodule(submodule: &ExpectedSubmodule, misplaced: bool) -> Result<(), PnioStatus> {
    let kind = submodule.properties & 3;
    let directions: &[u16] = match kind {
        0 | 1 => &[1],
        2 => &[2],
        _ => &[1, 2],
    };
    let found = submodule.data.iter().map(|data| data.direction);
    let lengths_fit = submodule.data.iter().all(|data| match kind {
        0 => data.length == 0,
        _ => (1..=1439).contains(&data.length),
    });
    first_broken(
        EXPECTED,
        &[
            ((1..=0x9FFF).contains(&submodule.subslot) && !misplaced, 10),
            // reduced lengths, discarded status and reserved bits are not served; shared input is harmless
            (submodule.properties & !7 == 0, 12),
            (found.eq(directions.iter().copied()), 13),
            (lengths_fit, 14),
            (submodule.data.iter().all(|data| data.iops_length == 1), 15),
            (submodule.data.iter().all(|data| data.iocs_length == 1), 16),
        ],
    )
}

fn check_iocrs(
    ar: &ArRequest,
    requests: Vec<IocrRequest>,
    sizes: &[SubmoduleSize],
    min_device_interval: u16,
) -> Result<Vec<CheckedIocr>, PnioStatus> {
    let mut checked: Vec<CheckedIocr> = Vec::new();
    for request in requests {
        let reference_used = checked
            .iter()
            .any(|iocr| iocr.request.reference == request.reference);
        let class = request.rt_class();
        let class_fits = match class {
            1 => !ar.properties.advanced(),
            2 => true,
            _ => false,
        };
        let in_class = match class {
            1 => (0xC000..=0xF7FF).contains(&request.frame_id),
            _ => (0x8000..=0xBBFF).contains(&request.frame_id),
        };
        let output = request.iocr_type == IocrType::OUTPUT;
        let offset = request.frame_send_offset;
        let clock = u32::from(request.send_clock_factor) * 31_250;
        first_broken(
            IOCR,
            &[
                (output || request.iocr_type == IocrType::INPUT, 4),
                (!reference_used, 5),
                (request.lt == ETHERTYPE, 6),
                (class_fits && request.properties & !0x80F == 0, 7),
                ((40..=1440).contains(&request.data_length), 8),
                (in_class || (output && request.frame_id == 0xFFFF), 9),
            ],
        )?;
        let timing = Timing {
            send_clock_factor: request.send_clock_factor,
            reduction_ratio: request.reduction_ratio,
            phase: request.phase,
        };
        let faulty = |error: IocrError| refuse(IOCR, error.code2());
        timing
            .check(
                request.watchdog_factor,
                request.data_hold_factor,
                min_device_interval,
            )
            .map_err(faulty)?;
        first_broken(
            IOCR,
            &[
                (offset == u32::MAX || (offset < clock && offset < 0x003D_0900), 14),
                (request.tag_header == 0xC000, 17),
                (request.multicast.0 == [0; 6], 18),
                (!request.apis.is_empty(), 19),
            ],
        )?;
        let mut data = Vec::new();
        let mut status = Vec::new();
        let mut apis = BTreeSet::new();
        for api in &request.apis {
            let twice = !apis.insert(api.api);
            first_broken(
                IOCR,
                &[
                    (!twice, 20),
                    (!(api.data.is_empty() && api.status.is_empty()), 21),
                ],
            )?;
            let place = |object: &crate::wire::block::FrameObject| ObjectPlace {
                api: api.api,
                slot: object.slot,
                subslot: object.subslot,
                offset: object.offset,
            };
            data.extend(api.data.iter().map(place));
            status.extend(api.status.iter().map(place));
        }
        let direction = if output {
            Direction::Output
        } else {
            Direction::Input
        };
        let layout = Layout::new(direction, request.data_length, &data, &status, sizes).map_err(faulty)?;
        checked.push(CheckedIocr {
            request,
            timing,
            layout,
        });
    }
    let count = |kind| {
        checked
            .iter()
            .filter(|iocr| iocr.request.iocr_type == kind)
            .count()
    };
    match (count(IocrType::INPUT), count(IocrType::OUTPUT)) {
        (1, 1) => Ok(checked),
        (0, _) | (_, 0) => Err(refuse(RPC, 2)),
        _ => Err(refuse(RPC, 7)),
    }
}

//! The records the engine itself has: what they hold and what may be written.

use alloc::vec::Vec;

use super::Device;
use super::event::Event;
use super::history::Pending;
use super::port::{MAU_TYPE, port_name};
use super::records::Owner;
use crate::Instant;
use crate::wire::block::{Block, BlockType, ReadRequest, WriteRequest};
use crate::wire::record::{
    ArData, ArDataIocr, Identification, Im0, ImText, InterfaceReal, PortPeer, PortReal, PortStatistic,
    RecordInput, encode_apis, encode_ar_data, encode_filter, encode_im, encode_multiple,
    encode_record_output, index,
};
use crate::wire::rt::Iops;
use crate::wire::status::record;
use crate::wire::{Reader, Uuid, Writer};

/// Interface submodule of the only interface.
const INTERFACE: u16 = 0x8000;
/// I&M1 to I&M4 are supported.
const IM_SUPPORTED: u16 = 0x001E;
/// Longest PDPortDataCheck and PDPortDataAdjust that is stored.
const MAX_PORT_RECORD: usize = 512;

/// What an index addresses.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Scope {
    Subslot,
    Slot,
    Ar,
    Api,
    Device,
}

/// A record of the engine.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Known {
    Expected,
    Real,
    Diff,
    Diagnosis,
    Maintenance,
    RecordInput,
    RecordOutput,
    PortReal,
    PortStatistic,
    InterfaceReal,
    InterfaceAdjust,
    PortCheck,
    PortAdjust,
    Im(u8),
    ArData,
    Apis,
    Log,
    ImFilter,
    PdReal,
    PdExpected,
    KeepAlive,
}

/// Every record of the engine: first and last index, what it addresses, what it is.
const RECORDS: &[(u16, u16, Scope, Known)] = &[
    (0x8000, 0x8000, Scope::Subslot, Known::Expected),
    (0xC000, 0xC000, Scope::Slot, Known::Expected),
    (0xE000, 0xE000, Scope::Ar, Known::Expected),
    (0x8001, 0x8001, Scope::Subslot, Known::Real),
    (0xC001, 0xC001, Scope::Slot, Known::Real),
    (0xE001, 0xE001, Scope::Ar, Known::Real),
    (0xF000, 0xF000, Scope::Api, Known::Real),
    (0xE002, 0xE002, Scope::Ar, Known::Diff),
    (0x800A, 0x800C, Scope::Subslot, Known::Diagnosis),
    (0xC00A, 0xC00C, Scope::Slot, Known::Diagnosis),
    (0xE00A, 0xE00C, Scope::Ar, Known::Diagnosis),
    (0xF00A, 0xF00C, Scope::Api, Known::Diagnosis),
    (0xF80C, 0xF80C, Scope::Device, Known::Diagnosis),
    (0x8010, 0x8013, Scope::Subslot, Known::Maintenance),
    (0xC010, 0xC013, Scope::Slot, Known::Maintenance),
    (0xE010, 0xE013, Scope::Ar, Known::Maintenance),
    (0xF010, 0xF013, Scope::Api, Known::Maintenance),
    (
        index::RECORD_INPUT,
        index::RECORD_INPUT,
        Scope::Subslot,
        Known::RecordInput,
    ),
    (
        index::RECORD_OUTPUT,
        index::RECORD_OUTPUT,
        Scope::Subslot,
        Known::RecordOutput,
    ),
    (
        index::PORT_REAL,
        index::PORT_REAL,
        Scope::Subslot,
        Known::PortReal,
    ),
    (
        index::PORT_CHECK,
        index::PORT_CHECK,
        Scope::Subslot,
        Known::PortCheck,
    ),
    (
        index::PORT_ADJUST,
        index::PORT_ADJUST,
        Scope::Subslot,
        Known::PortAdjust,
    ),
    (
        index::INTERFACE_ADJUST,
        index::INTERFACE_ADJUST,
        Scope::Subslot,
        Known::InterfaceAdjust,
    ),
    (
        index::PORT_STATISTIC,
        index::PORT_STATISTIC,
        Scope::Subslot,
        Known::PortStatistic,
    ),
    (
        index::INTERFACE_REAL,
        index::INTERFACE_REAL,
        Scope::Subslot,
        Known::InterfaceReal,
    ),
    (0xAFF0, 0xAFF0, Scope::Subslot, Known::Im(0)),
    (0xAFF1, 0xAFF1, Scope::Subslot, Known::Im(1)),
    (0xAFF2, 0xAFF2, Scope::Subslot, Known::Im(2)),
    (0xAFF3, 0xAFF3, Scope::Subslot, Known::Im(3)),
    (0xAFF4, 0xAFF4, Scope::Subslot, Known::Im(4)),
    (index::AR_DATA_API, index::AR_DATA_API, Scope::Api, Known::ArData),
    (index::AR_DATA, index::AR_DATA, Scope::Device, Known::ArData),
    (index::API_DATA, index::API_DATA, Scope::Device, Known::Apis),
    (index::LOG, index::LOG, Scope::Device, Known::Log),
    (
        index::IM0_FILTER,
        index::IM0_FILTER,
        Scope::Device,
        Known::ImFilter,
    ),
    (index::PD_REAL, index::PD_REAL, Scope::Device, Known::PdReal),
    (
        index::PD_EXPECTED,
        index::PD_EXPECTED,
        Scope::Device,
        Known::PdExpected,
    ),
    (
        index::KEEP_ALIVE,
        index::KEEP_ALIVE,
        Scope::Device,
        Known::KeepAlive,
    ),
];

fn known(index: u16) -> Option<(Scope, Known)> {
    RECORDS
        .iter()
        .find(|row| (row.0..=row.1).contains(&index))
        .map(|row| (row.2, row.3))
}

fn padded<const N: usize>(text: &str) -> [u8; N] {
    let mut field = [b' '; N];
    for (place, byte) in field.iter_mut().zip(text.bytes()) {
        *place = byte;
    }
    field
}

/// A written PDPortDataCheck or PDPortDataAdjust.
#[derive(Debug)]
pub(super) struct PortRecord {
    subslot: u16,
    index: u16,
    data: Vec<u8>,
}

impl Device {
    /// Writes the content of a record, or returns that the application has it.
    ///
    /// # Errors
    /// ErrorCode1.
    pub(super) fn content(
        &self,
        now: Instant,
        target: Uuid,
        request: &ReadRequest,
        out: &mut Vec<u8>,
    ) -> Result<Owner, u8> {
        let ReadRequest {
            api,
            slot,
            subslot,
            index,
            ..
        } = *request;
        let Some((scope, known)) = known(index) else {
            return self.other_record(api, slot, subslot, index);
        };
        let catalogue = &self.config.modules;
        match scope {
            Scope::Subslot => self.check_subslot(api, slot, subslot)?,
            Scope::Slot if !self.slots.apis(catalogue).contains(&api) => return Err(record::INVALID_AREA),
            Scope::Slot if self.slots.module(catalogue, slot).is_none() => return Err(record::INVALID_SLOT),
            Scope::Api if !self.slots.apis(catalogue).contains(&api) => return Err(record::INVALID_AREA),
            _ => {}
        }
        let here = |a: u32, s: u16, sub: u16| match scope {
            Scope::Subslot => (a, s, sub) == (api, slot, subslot),
            Scope::Slot => (a, s) == (api, slot),
            Scope::Api => a == api,
            Scope::Ar | Scope::Device => true,
        };
        match known {
            Known::Expected => {
                let io = self.controller.as_ref();
                let io = io.filter(|io| scope != Scope::Ar || io.request.ar_uuid == target);
                if let Some(io) = io {
                    let mut expected = io.expected.clone();
                    for module in &mut expected.modules {
                        let (a, s) = (module.api, module.slot);
                        module
                            .submodules
                            .retain(|submodule| here(a, s, submodule.subslot));
                    }
                    expected.modules.retain(|module| !module.submodules.is_empty());
                    expected.encode(BlockType::EXPECTED_IDENTIFICATION, 1, out);
                }
            }
            Known::Real => {
                let io = self.controller.as_ref().filter(|io| io.request.ar_uuid == target);
                let in_ar = |s: u16, sub: u16| {
                    io.is_some_and(|io| {
                        let same = |m: &&crate::wire::record::IdentifiedModule| m.slot == s;
                        let mut modules = io.expected.modules.iter().filter(same);
                        modules.any(|m| m.submodules.iter().any(|x| x.subslot == sub))
                    })
                };
                let real = self.slots.identification(catalogue, |s, submodule| {
                    here(submodule.api, s, submodule.subslot)
                        && (scope != Scope::Ar || in_ar(s, submodule.subslot))
                });
                real.encode(BlockType::REAL_IDENTIFICATION, 1, out);
            }
            Known::Diff => {
                let diff = self.diff_of(target).filter(|diff| !diff.modules.is_empty());
                if let Some(diff) = diff {
                    diff.encode(out);
                }
            }
            Known::Diagnosis => self
                .diagnoses
                .encode(out, |p: &Pending| here(p.api, p.slot, p.subslot)),
            Known::Maintenance | Known::KeepAlive => {}
            Known::RecordInput => self.live_input(slot, subslot, out)?,
            Known::RecordOutput => self.live_output(slot, subslot, out)?,
            Known::PortReal if subslot > INTERFACE => self.port_real(slot, subslot, out),
            Known::PortStatistic if subslot >= INTERFACE => self.port_statistic().encode(out),
            Known::InterfaceReal if subslot == INTERFACE => self.interface_real(out),
            Known::InterfaceAdjust if subslot == INTERFACE => out.bytes(&self.interface_adjust),
            Known::PortCheck | Known::PortAdjust if subslot > INTERFACE => {
                let stored = |p: &&PortRecord| (p.subslot, p.index) == (subslot, index);
                if let Some(stored) = self.port_records.iter().find(stored) {
                    out.bytes(&stored.data);
                }
            }
            Known::PortReal
            | Known::PortStatistic
            | Known::InterfaceReal
            | Known::InterfaceAdjust
            | Known::PortCheck
            | Known::PortAdjust => return Err(record::INVALID_INDEX),
            Known::Im(0) => self.im0(slot).encode(out),
            Known::Im(number) => {
                if slot != 0 {
                    return Err(record::INVALID_INDEX);
                }
                let im = &self.im;
                let body: &[u8] = match number {
                    1 => &im.im1,
                    2 => &im.im2,
                    3 => &im.im3,
                    _ => &im.im4,
                };
                encode_im(number, body, out);
            }
            Known::ArData => self.ar_data(scope == Scope::Api, api, out),
            Known::Apis => encode_apis(&self.slots.apis(catalogue), out),
            Known::Log => self.log.record(now).encode(out),
            Known::ImFilter => {
                let all = self
                    .slots
                    .identification(catalogue, |_, submodule| submodule.subslot < INTERFACE);
                let device = self
                    .slots
                    .identification(catalogue, |slot, submodule| (slot, submodule.subslot) == (0, 1));
                encode_filter(&all, &device, out);
            }
            Known::PdReal => self.pd_real(out),
            Known::PdExpected => {
                for stored in &self.port_records {
                    encode_multiple(out, 0, 0, stored.subslot, |out| out.bytes(&stored.data));
                }
            }
        }
        Ok(Owner::Engine)
    }

    /// Reads the content of a written record, or returns that the application handles it.
    ///
    /// # Errors
    /// ErrorCode1.
    pub(super) fn store(&mut self, request: &WriteRequest, data: &[u8]) -> Result<Owner, u8> {
        let WriteRequest {
            api,
            slot,
            subslot,
            index,
            ..
        } = *request;
        let Some((scope, known)) = known(index) else {
            return self.other_record(api, slot, subslot, index);
        };
        if scope == Scope::Subslot {
            self.check_subslot(api, slot, subslot)?;
        }
        match known {
            Known::Im(number @ 1..=4) => {
                if slot != 0 {
                    return Err(record::INVALID_INDEX);
                }
                let length = if number == 2 { 22 } else { 60 };
                if data.len() != length {
                    return Err(record::LENGTH);
                }
                let text =
                    ImText::decode(Reader::new(data), number).map_err(|_| record::INVALID_PARAMETER)?;
                let im = &mut self.im;
                let place: &mut [u8] = match number {
                    1 => &mut im.im1,
                    2 => &mut im.im2,
                    3 => &mut im.im3,
                    _ => &mut im.im4,
                };
                if place != text.body {
                    place.copy_from_slice(text.body);
                    let im = *im;
                    self.event(Event::ImChanged(im));
                }
            }
            Known::InterfaceAdjust if subslot == INTERFACE => {
                check_block(data, BlockType::PD_INTERFACE_ADJUST)?;
                if data.len() != 12 {
                    return Err(record::LENGTH);
                }
                self.interface_adjust = data.to_vec();
                self.port.announce();
            }
            Known::PortCheck | Known::PortAdjust if subslot > INTERFACE => {
                if data.len() > MAX_PORT_RECORD {
                    return Err(record::LENGTH);
                }
                let block = if known == Known::PortCheck {
                    BlockType::PD_PORT_CHECK
                } else {
                    BlockType::PD_PORT_ADJUST
                };
                check_block(data, block)?;
                self.port_records
                    .retain(|p| (p.subslot, p.index) != (subslot, index));
                self.port_records.push(PortRecord {
                    subslot,
                    index,
                    data: data.to_vec(),
                });
            }
            _ => return Err(record::ACCESS_DENIED),
        }
        Ok(Owner::Engine)
    }

    fn im0(&self, slot: u16) -> Im0 {
        let identity = &self.config.identity;
        Im0 {
            vendor_id: identity.vendor_id,
            order_id: padded(&identity.order_id),
            serial_number: padded(&identity.serial_number),
            hardware_revision: identity.hardware_revision,
            software_prefix: u8::try_from(identity.software_prefix).unwrap_or(b'V'),
            software_revision: identity.software_revision,
            revision_counter: 0,
            profile_id: identity.profile_id,
            profile_specific_type: identity.profile_specific_type,
            version: (1, 1),
            supported: if slot == 0 { IM_SUPPORTED } else { 0 },
        }
    }

    fn live_input(&self, slot: u16, subslot: u16, out: &mut Vec<u8>) -> Result<(), u8> {
        let io = self.controller.as_ref().ok_or(record::STATE_CONFLICT)?;
        let (data, iops) = io.provider.data(slot, subslot).ok_or(record::INVALID_INDEX)?;
        let iocs = io.consumer.iocs(slot, subslot).unwrap_or(Iops::BAD_SUBSLOT);
        RecordInput {
            iocs: iocs.0,
            iops: iops.0,
            data,
        }
        .encode(out);
        Ok(())
    }

    fn live_output(&self, slot: u16, subslot: u16, out: &mut Vec<u8>) -> Result<(), u8> {
        let io = self.controller.as_ref().ok_or(record::STATE_CONFLICT)?;
        let (data, iops) = io.consumer.data(slot, subslot).ok_or(record::INVALID_INDEX)?;
        let usable = !super::slots::differs(&io.diff, slot, subslot);
        let iocs = if usable { Iops::GOOD } else { Iops::BAD_SUBSLOT };
        let substitute = !(iops.is_good() && io.run == Some(true));
        encode_record_output(substitute, iocs.0, iops.0, data, out);
        Ok(())
    }

    fn port_real(&self, slot: u16, subslot: u16, out: &mut Vec<u8>) {
        let peers = self
            .port
            .neighbours
            .iter()
            .filter(|_| subslot == self.port_subslot());
        let peers: Vec<PortPeer<'_>> = peers
            .filter_map(|neighbour| {
                let (port, station) = neighbour.lldpdu()?.profinet_names();
                Some(PortPeer {
                    port,
                    station,
                    line_delay: 0,
                    mac: neighbour.mac(),
                })
            })
            .collect();
        PortReal {
            slot,
            subslot,
            name: port_name(subslot).as_bytes(),
            peers,
            mau_type: MAU_TYPE,
            link_up: true,
        }
        .encode(out);
    }

    /// Returns the counters of the port; counters of 32 bits start again at 0.
    fn port_statistic(&self) -> PortStatistic {
        let low = |octets: u64| (octets & u64::from(u32::MAX)) as u32;
        let (received, sent) = self.traffic();
        PortStatistic {
            octets: (low(received.octets), low(sent.octets)),
            ..PortStatistic::default()
        }
    }

    fn interface_real(&self, out: &mut Vec<u8>) {
        let name = self.name.as_bytes();
        InterfaceReal {
            name,
            mac: self.config.mac,
            ip: self.ip,
        }
        .encode(out);
    }

    fn pd_real(&self, out: &mut Vec<u8>) {
        let keep = |_: u16, submodule: &super::config::SubmoduleDescription| submodule.subslot >= INTERFACE;
        let Identification { modules } = self.slots.identification(&self.config.modules, keep);
        for module in modules {
            for submodule in module.submodules {
                let subslot = submodule.subslot;
                encode_multiple(out, module.api, module.slot, subslot, |out| {
                    if subslot == INTERFACE {
                        self.interface_real(out);
                    } else {
                        self.port_real(module.slot, subslot, out);
                        self.port_statistic().encode(out);
                    }
                });
            }
        }
    }

    fn ar_data(&self, by_api: bool, api: u32, out: &mut Vec<u8>) {
        let mut ars = Vec::new();
        if let Some(io) = &self.controller {
            let mut apis: Vec<u32> = io.expected.modules.iter().map(|module| module.api).collect();
            apis.dedup();
            let counter = io.consumer.cycle_counter().to_be_bytes();
            let input = ArDataIocr {
                properties: io.input.properties,
                iocr_type: io.input.iocr_type.0,
                frame_id: io.input.frame_id,
                apdu_status: [0, 0, io.provider.status().0, 0],
            };
            let output = ArDataIocr {
                properties: io.output.properties,
                iocr_type: io.output.iocr_type.0,
                frame_id: io.consumer.frame_id().0,
                apdu_status: [counter[0], counter[1], io.consumer.status().0, 0],
            };
            if !by_api || apis.contains(&api) {
                ars.push(ArData {
                    ar_uuid: io.request.ar_uuid,
                    initiator_object: io.request.initiator_object,
                    properties: io.request.properties.0,
                    ar_type: io.request.ar_type.0,
                    alarm_cr_type: 1,
                    alarm_references: {
                        let config = io.alarms.config();
                        (config.local_reference, config.peer_reference)
                    },
                    station_name: &io.request.station_name,
                    iocrs: alloc::vec![input, output],
                    apis,
                });
            }
        }
        let tools = if by_api { &[][..] } else { &self.tools[..] };
        for tool in tools {
            ars.push(ArData {
                ar_uuid: tool.request.ar_uuid,
                initiator_object: tool.request.initiator_object,
                properties: tool.request.properties.0,
                ar_type: tool.request.ar_type.0,
                alarm_cr_type: 0,
                alarm_references: (0, 0),
                station_name: &tool.request.station_name,
                iocrs: Vec::new(),
                apis: Vec::new(),
            });
        }
        encode_ar_data(&ars, out);
    }
}

/// Checks that a written record is one block of this type.
fn check_block(data: &[u8], block_type: BlockType) -> Result<(), u8> {
    let mut reader = Reader::new(data);
    let block = Block::decode(&mut reader).map_err(|_| record::LENGTH)?;
    if block.block_type != block_type {
        return Err(record::INVALID_PARAMETER);
    }
    if block.version.0 != 1 {
        return Err(record::VERSION_CONFLICT);
    }
    reader.finish("record").map_err(|_| record::LENGTH)
}

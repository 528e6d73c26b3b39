//! Context management: connect, control, release, and how ARs end.

use alloc::string::String;
use alloc::vec;
use alloc::vec::Vec;
use core::net::SocketAddrV4;
use core::time::Duration;

use super::Device;
use super::ar::{AccessAr, Activity, IoAr, Phase, Trigger};
use super::check::{AR, CheckedConnect, CheckedCyclic, RPC, UNKNOWN_BLOCKS, check};
use super::event::{ArKey, ArKind, Event};
use super::slots::differs;
use crate::alarm::{AlarmConfig, Alarms, emit_error};
use crate::cyclic::{Consumer, Provider, ProviderConfig};
use crate::rpc::{Call, CallError, Reply};
use crate::wire::block::{
    AlarmCrResponse, ArRequest, ArResponse, ArServer, Block, BlockType, ControlBlock, ControlCommand,
    IocrResponse, IocrType, ModuleDiff, write_block,
};
use crate::wire::ethernet::{ETHERTYPE, FrameId, Tag};
use crate::wire::record::{Identification, IdentifiedModule, IdentifiedSubmodule};
use crate::wire::rpc::{Header, NdrRequest, NdrResponse, operation};
use crate::wire::rt::Iops;
use crate::wire::status::abort;
use crate::wire::{PnioStatus, Reader, Uuid, Writer};
use crate::{Instant, MAX_FRAME, RPC_PORT};

/// An AR for record access that was silent for so long gives way to a new one of its own initiator.
const ABANDONED: Duration = Duration::from_secs(2);

fn same_initiator(a: &ArRequest, b: &ArRequest) -> bool {
    a.initiator_mac == b.initiator_mac && a.initiator_object == b.initiator_object
}

fn text(name: &[u8]) -> String {
    String::from_utf8_lossy(name).into_owned()
}

/// Refuses a connect whose answer does not fit what the initiator allows.
fn check_room(blocks: &[u8], room: u32) -> Result<(), PnioStatus> {
    match u32::try_from(blocks.len()) {
        Ok(length) if length <= room => Ok(()),
        _ => Err(PnioStatus::connect(RPC, 0)),
    }
}

impl Device {
    /// Executes Connect; gives the blocks of the answer.
    pub(super) fn connect(
        &mut self,
        now: Instant,
        source: SocketAddrV4,
        room: u32,
        reader: Reader<'_>,
    ) -> Result<Vec<u8>, PnioStatus> {
        let checked = check(reader, self.config.min_device_interval)?;
        let refusals = &self.config.refusals;
        let refused = match checked.cyclic {
            None if self.config.max_device_access == 0 => {
                refusals.device_access.or(Some(PnioStatus::connect(AR, 4)))
            }
            None => refusals.device_access,
            Some(_) => refusals.controller,
        };
        if let Some(status) = refused {
            return Err(status);
        }
        let in_use = |request: &ArRequest| request.ar_uuid == checked.ar.ar_uuid;
        let own = self.controller.as_ref().is_some_and(|ar| in_use(&ar.request));
        if own || self.tools.iter().any(|ar| in_use(&ar.request)) {
            // a new call with an old ARUUID: its owner has lost count, so the old AR is worth nothing
            if let Some(ar) = &self.controller
                && own
                && same_initiator(&ar.request, &checked.ar)
                && ar.host == *source.ip()
            {
                self.close_controller(now, PnioStatus::aborted(abort::RERUN), true);
            }
            return Err(PnioStatus::connect(0x3D, 0));
        }
        let CheckedConnect { ar, cyclic, vendor } = checked;
        match cyclic {
            None => self.connect_tool(now, source, room, ar, &vendor),
            Some(cyclic) => self.connect_controller(now, source, room, ar, cyclic, &vendor),
        }
    }

    fn new_key(&mut self) -> ArKey {
        self.next_ar = self.next_ar.wrapping_add(1);
        ArKey(self.next_ar)
    }

    fn ar_response(&self, ar: &ArRequest) -> ArResponse {
        ArResponse {
            ar_type: ar.ar_type,
            ar_uuid: ar.ar_uuid,
            session_key: ar.session_key,
            responder_mac: self.config.mac,
            udp_rt_port: ETHERTYPE,
        }
    }

    fn finish_response(&self, ar: &ArRequest, vendor: &[(u16, u32)], out: &mut Vec<u8>) {
        for (identifier, api) in vendor {
            write_block(out, BlockType::AR_VENDOR_RESPONSE, 0, |out| {
                out.u16(*identifier);
                out.u32(*api);
            });
        }
        if ar.properties.advanced() {
            ArServer {
                station_name: self.name.as_bytes().to_vec(),
            }
            .encode(out);
        }
    }

    fn connect_tool(
        &mut self,
        now: Instant,
        source: SocketAddrV4,
        room: u32,
        ar: ArRequest,
        vendor: &[(u16, u32)],
    ) -> Result<Vec<u8>, PnioStatus> {
        let mut out = Vec::new();
        self.ar_response(&ar).encode(&mut out);
        self.finish_response(&ar, vendor, &mut out);
        check_room(&out, room)?;
        if self.tools.len() >= self.config.max_device_access {
            let (evictable, cause) = self
                .evictable(now, source, &ar)
                .ok_or(PnioStatus::connect(RPC, 4))?;
            self.abort(now, evictable, cause);
        }
        let key = self.new_key();
        let station = text(&ar.station_name);
        self.event(Event::Connected {
            ar: key,
            kind: ArKind::DeviceAccess,
            station,
        });
        let activity = Activity::new(now, ar.activity_timeout_factor);
        self.tools.push(AccessAr {
            key,
            request: ar,
            host: *source.ip(),
            activity,
        });
        Ok(out)
    }

    /// Selects the AR for record access to end when all are in use, and returns the cause.
    ///
    /// The standard leaves the choice to the device. A tool that crashed keeps its AR until the activity time is over,
    /// which may be 100 s; after a restart its former ARs must not lock it out. So the AR that has been silent
    /// for longest ends if it is the same initiator's (address, MAC address, object and station name) and was silent
    /// for [`ABANDONED`], else if it was silent for more than half of its activity time. An AR whose record is being
    /// worked on stays in any case.
    fn evictable(&self, now: Instant, source: SocketAddrV4, ar: &ArRequest) -> Option<(ArKey, u8)> {
        let silent = |tool: &&AccessAr| !self.has_job(tool.key);
        let longest = |tool: &&AccessAr| tool.activity.idle(now);
        let same = |tool: &&AccessAr| {
            same_initiator(&tool.request, ar)
                && tool.request.station_name == ar.station_name
                && tool.host == *source.ip()
                && tool.activity.idle(now).is_some_and(|idle| idle >= ABANDONED)
        };
        let silent = || self.tools.iter().filter(silent);
        let own = silent().filter(same).max_by_key(longest);
        if let Some(own) = own {
            return Some((own.key, abort::RERUN));
        }
        let others = silent().filter(|tool| tool.activity.is_half_over(now));
        others
            .max_by_key(longest)
            .map(|tool| (tool.key, abort::ACTIVITY_TIMEOUT))
    }

    fn connect_controller(
        &mut self,
        now: Instant,
        source: SocketAddrV4,
        room: u32,
        ar: ArRequest,
        cyclic: CheckedCyclic,
        vendor: &[(u16, u32)],
    ) -> Result<Vec<u8>, PnioStatus> {
        if let Some(old) = &self.controller {
            if !(same_initiator(&old.request, &ar) && old.host == *source.ip()) {
                return Err(PnioStatus::connect(RPC, 4));
            }
            self.close_controller(now, PnioStatus::aborted(abort::RERUN), true);
        }
        let (Some(input), Some(output)) = (
            cyclic.direction(IocrType::INPUT),
            cyclic.direction(IocrType::OUTPUT),
        ) else {
            return Err(PnioStatus::connect(RPC, 2));
        };
        let diff = self
            .slots
            .adapt(&self.config.modules, &cyclic.expected, &self.config.always_listed);
        let key = self.new_key();
        let [class_1, class_2] = self.config.output_frame_ids;
        let output_frame = match output.request.frame_id {
            0xFFFF if output.request.rt_class() == 1 => class_1,
            0xFFFF => class_2,
            chosen => chosen,
        };
        let config = ProviderConfig {
            destination: ar.initiator_mac,
            source: self.config.mac,
            tag: Some(Tag::PRIORITY_6),
            frame_id: FrameId(input.request.frame_id),
            timing: input.timing,
            origin: now,
        };
        let mut provider = Provider::new(config, input.layout.clone(), now);
        for object in input.layout.data_objects() {
            // submodules without data are good once they are the right ones; the others when the application reports it
            if object.length == 0 && !differs(&diff, object.slot, object.subslot) {
                provider.set_iops(object.slot, object.subslot, Iops::GOOD);
            }
        }
        for object in input.layout.status_objects() {
            if !differs(&diff, object.slot, object.subslot) {
                provider.set_iocs(object.slot, object.subslot, Iops::GOOD);
            }
        }
        let consumer = Consumer::new(
            ar.initiator_mac,
            FrameId(output_frame),
            output.timing,
            output.request.data_hold_factor,
            output.layout.clone(),
        );
        let alarm_cr = cyclic.alarm_cr;
        let local_reference = (key.0 & 0x7FFF) as u16;
        let alarms = Alarms::new(AlarmConfig {
            local: self.config.mac,
            peer: ar.initiator_mac,
            local_reference,
            peer_reference: alarm_cr.local_alarm_reference,
            timeout: Duration::from_millis(u64::from(alarm_cr.rta_timeout_factor) * 100),
            retries: alarm_cr.rta_retries,
            tag_high: Tag(alarm_cr.tag_high),
            tag_low: Tag(alarm_cr.tag_low),
            max_length: alarm_cr.max_alarm_data_length.min(self.config.max_alarm_data),
            low_only: alarm_cr.properties & 1 != 0,
        });

        let mut out = Vec::new();
        self.ar_response(&ar).encode(&mut out);
        for iocr in &cyclic.iocrs {
            let iocr_type = iocr.request.iocr_type;
            let frame_id = if iocr_type == IocrType::OUTPUT {
                output_frame
            } else {
                iocr.request.frame_id
            };
            IocrResponse {
                iocr_type,
                reference: iocr.request.reference,
                frame_id,
            }
            .encode(&mut out);
        }
        AlarmCrResponse {
            alarm_cr_type: 1,
            local_alarm_reference: local_reference,
            max_alarm_data_length: self.config.max_alarm_data,
        }
        .encode(&mut out);
        if !diff.modules.is_empty() {
            diff.encode(&mut out);
        }
        self.finish_response(&ar, vendor, &mut out);
        check_room(&out, room)?;

        let expected = cyclic.expected.iter().map(|module| IdentifiedModule {
            api: module.api,
            slot: module.slot,
            ident: module.ident,
            submodules: module
                .submodules
                .iter()
                .map(|s| IdentifiedSubmodule {
                    subslot: s.subslot,
                    ident: s.ident,
                })
                .collect(),
        });
        let mut expected = Identification {
            modules: expected.collect(),
        };
        expected.modules.sort_by_key(|module| (module.api, module.slot));
        let station = text(&ar.station_name);
        self.event(Event::Connected {
            ar: key,
            kind: ArKind::IoController,
            station,
        });
        let io = IoAr {
            key,
            host: *source.ip(),
            phase: Phase::Parameters,
            activity: Activity::new(now, ar.activity_timeout_factor),
            input: input.request.clone(),
            output: output.request.clone(),
            request: ar,
            provider,
            same_interval: input.timing.interval() == output.timing.interval(),
            consumer,
            alarms,
            diff,
            expected,
            ready_call: None,
            run: None,
        };
        self.controller = Some(io);
        self.update_station_problem();
        Ok(out)
    }

    /// Executes Control; gives the blocks of the answer.
    pub(super) fn control(
        &mut self,
        now: Instant,
        call: &Call,
        mut reader: Reader<'_>,
    ) -> Result<Vec<u8>, PnioStatus> {
        let refuse = PnioStatus::control;
        let block = Block::decode(&mut reader).map_err(|_| refuse(0x14, 1))?;
        let code1 = match block.block_type {
            BlockType::PRM_END => 0x14,
            BlockType::PRM_END_PLUG => 0x15,
            _ => return Err(refuse(RPC, UNKNOWN_BLOCKS)),
        };
        if block.version != (1, 0) {
            return Err(refuse(code1, if block.version.0 == 1 { 3 } else { 2 }));
        }
        let control = ControlBlock::decode(block.block_type, block.body).map_err(|_| refuse(code1, 1))?;
        if self.tool(control.ar_uuid, call).is_some() {
            return Err(refuse(0x3D, 0));
        }
        let Some(ar) = self.io_ar(control.ar_uuid, call) else {
            return Err(refuse(RPC, 5));
        };
        if control.session_key != ar.request.session_key {
            return Err(refuse(code1, 6));
        }
        if control.command != ControlCommand::PRM_END {
            return Err(refuse(code1, 8));
        }
        let next = ar.phase.after(Trigger::ParameterEnd);
        let Some(next) = next.filter(|_| block.block_type == BlockType::PRM_END) else {
            return Err(refuse(0x3D, 0));
        };
        ar.phase = next;
        ar.activity.restart(now);
        let key = ar.key;
        self.event(Event::ParameterEnd { ar: key });
        let mut out = Vec::new();
        control.done().encode(&mut out);
        Ok(out)
    }

    /// Executes Release; gives the blocks of the answer.
    pub(super) fn release(
        &mut self,
        now: Instant,
        call: &Call,
        mut reader: Reader<'_>,
    ) -> Result<Vec<u8>, PnioStatus> {
        let refuse = PnioStatus::release;
        let block = Block::decode(&mut reader).map_err(|_| refuse(0x28, 1))?;
        if block.block_type != BlockType::RELEASE {
            return Err(refuse(0x28, 0));
        }
        if block.version.0 != 1 {
            return Err(refuse(0x28, 2));
        }
        let control = ControlBlock::decode(block.block_type, block.body).map_err(|_| refuse(0x28, 1))?;
        let request = match self.tool(control.ar_uuid, call) {
            Some(tool) => Some(tool.request.session_key),
            None => self.io_ar(control.ar_uuid, call).map(|ar| ar.request.session_key),
        };
        let Some(session_key) = request else {
            return Err(refuse(RPC, 5));
        };
        if control.session_key != session_key {
            return Err(refuse(0x28, 6));
        }
        if control.command != ControlCommand::RELEASE {
            return Err(refuse(0x28, 8));
        }
        let status = PnioStatus::aborted(abort::RELEASED);
        if let Some(index) = self
            .tools
            .iter()
            .position(|tool| tool.request.ar_uuid == control.ar_uuid)
        {
            let tool = self.tools.swap_remove(index);
            self.ended(now, tool.key, tool.request.ar_uuid, status);
        } else {
            self.close_controller(now, status, false);
        }
        let mut out = Vec::new();
        control.done().encode(&mut out);
        Ok(out)
    }

    /// Returns the AR with cyclic data if the call may act for it.
    pub(super) fn io_ar(&mut self, ar_uuid: Uuid, call: &Call) -> Option<&mut IoAr> {
        self.controller
            .as_mut()
            .filter(|ar| ar.request.ar_uuid == ar_uuid && ar.host == *call.source.ip())
    }

    /// Returns the AR for record access if the call may act for it.
    pub(super) fn tool(&mut self, ar_uuid: Uuid, call: &Call) -> Option<&mut AccessAr> {
        self.tools
            .iter_mut()
            .find(|ar| ar.request.ar_uuid == ar_uuid && ar.host == *call.source.ip())
    }

    fn ended(&mut self, now: Instant, ar: ArKey, ar_uuid: Uuid, cause: PnioStatus) {
        self.log.note(now, ar_uuid, cause);
        self.event(Event::Disconnected { ar, cause });
    }

    /// Ends the AR with cyclic data, with or without a last word to the controller.
    pub(super) fn close_controller(&mut self, now: Instant, cause: PnioStatus, notify: bool) {
        let Some(ar) = self.controller.take() else { return };
        if let Some(call) = ar.ready_call {
            self.client.cancel(call);
        }
        if notify {
            let mut frame = vec![0; MAX_FRAME];
            if let Some(length) = emit_error(&mut frame, ar.alarms.config(), cause) {
                frame.truncate(length);
                self.send_frame(frame);
            }
        }
        self.ended(now, ar.key, ar.request.ar_uuid, cause);
    }

    /// Ends every AR.
    pub(super) fn close_all(&mut self, now: Instant, cause: PnioStatus) {
        self.close_controller(now, cause, true);
        for tool in core::mem::take(&mut self.tools) {
            self.ended(now, tool.key, tool.request.ar_uuid, cause);
        }
    }

    /// Ends an AR for a reason of the application; see [`abort`] for the causes.
    pub fn abort(&mut self, now: Instant, ar: ArKey, cause: u8) {
        self.quiet_until = None;
        let cause = PnioStatus::aborted(cause);
        if self.controller.as_ref().is_some_and(|io| io.key == ar) {
            self.close_controller(now, cause, true);
        } else if let Some(index) = self.tools.iter().position(|tool| tool.key == ar) {
            let tool = self.tools.swap_remove(index);
            self.ended(now, tool.key, tool.request.ar_uuid, cause);
        }
    }

    /// Reports to the controller that inputs are set and the application runs. Returns false if `ar` does not wait for
    /// this (only once after [`Event::ParameterEnd`]).
    pub fn application_ready(&mut self, now: Instant, ar: ArKey) -> bool {
        self.quiet_until = None;
        let Some(io) = self.controller.as_mut().filter(|io| io.key == ar) else {
            return false;
        };
        let Some(next) = io.phase.after(Trigger::ApplicationReady) else {
            return false;
        };
        io.phase = next;
        // a device that starts again with the same seed must not repeat the activities of its former life
        self.uuids.stir(&io.request.ar_uuid);
        let activity = self.uuids.uuid();
        let header = Header {
            order: self.config.ready_order,
            ..Header::request(
                io.request.initiator_object,
                Uuid::CONTROLLER_INTERFACE,
                activity,
                0,
                operation::CONTROL,
            )
        };
        let mut blocks = Vec::new();
        ControlBlock::new(
            BlockType::APPLICATION_READY,
            io.request.ar_uuid,
            io.request.session_key,
            ControlCommand::APPLICATION_READY,
        )
        .encode(&mut blocks);
        if !io.diff.modules.is_empty() {
            io.diff.encode(&mut blocks);
        }
        let mut stub = Vec::new();
        let args_length = u32::try_from(blocks.len()).unwrap_or(u32::MAX);
        NdrRequest {
            args_maximum: self.config.ready_arguments.max(args_length),
            args_length,
        }
        .encode(&mut stub, header.order);
        stub.extend_from_slice(&blocks);
        let server = SocketAddrV4::new(io.host, RPC_PORT);
        io.ready_call = Some(self.client.call(now, server, header, stub));
        true
    }

    /// Takes the end of the ApplicationReady call.
    pub(super) fn ready_answered(&mut self, now: Instant, result: Result<Reply, CallError>) {
        let Some(io) = self.controller.as_mut() else {
            return;
        };
        io.ready_call = None;
        let confirmed = result.is_ok_and(|reply| confirms(&reply, io.request.ar_uuid));
        match io.phase.after(Trigger::Confirmed) {
            Some(next) if confirmed => {
                io.phase = next;
                io.activity.restart(now);
            }
            _ => self.close_controller(now, PnioStatus::aborted(abort::CONTROL_ERROR), true),
        }
    }

    /// Difference between expected and plugged of the AR with this UUID.
    pub(super) fn diff_of(&self, ar_uuid: Uuid) -> Option<&ModuleDiff> {
        self.controller
            .as_ref()
            .filter(|io| io.request.ar_uuid == ar_uuid)
            .map(|io| &io.diff)
    }
}

/// Returns true if the answer to ApplicationReady is Done for this AR.
fn confirms(reply: &Reply, ar_uuid: Uuid) -> bool {
    let mut reader = Reader::new(&reply.stub);
    let Ok(ndr) = NdrResponse::decode(&mut reader, reply.order) else {
        return false;
    };
    let Ok(block) = Block::decode(&mut reader) else {
        return false;
    };
    let control = ControlBlock::decode(block.block_type, block.body);
    ndr.status.is_ok()
        && block.block_type == BlockType::APPLICATION_READY_DONE
        && control.is_ok_and(|c| c.ar_uuid == ar_uuid && c.command == ControlCommand::DONE)
}

//! The device side of DCP: being found, named, addressed, made to blink, reset.

use alloc::string::String;
use alloc::vec;
use alloc::vec::Vec;
use core::net::Ipv4Addr;
use core::time::Duration;

use super::Device;
use super::config::{ImRecords, ResetMode};
use super::event::{Event, SetRefusal};
use super::limit::{Allowance, SourceLimit};
use crate::wire::PnioStatus;
use crate::wire::dcp::{
    Block, BlockError, BlockInfo, DcpOption, Pdu, PduWriter, Qualifier, ServiceId, ServiceType, Value,
    check_ip, check_name, response_delay, role,
};
use crate::wire::ethernet::{self, DCP_IDENTIFY, Frame, FrameId};
use crate::wire::status::abort;
use crate::{Instant, IpSuite, MAX_FRAME, MacAddress};

/// For so long only the client that was served last is served.
const CLIENT_HOLD: Duration = Duration::from_secs(3);
/// How long a signal blinks; another one meanwhile changes nothing.
const BLINK: Duration = Duration::from_secs(3);
/// Delayed Identify answers that may wait; more requests for one are ignored.
const WAITING: usize = 8;

/// Maximum number of answered blocks of one request. The answer must fit a frame.
const MAX_BLOCKS: usize = 64;

/// Options reported by 2/5, ascending.
const OPTIONS: &[DcpOption] = &[
    DcpOption::IP,
    DcpOption::FULL_IP,
    DcpOption::STATION_TYPE,
    DcpOption::NAME,
    DcpOption::DEVICE_ID,
    DcpOption::ROLE,
    DcpOption::OPTIONS,
    DcpOption::ALIAS,
    DcpOption::INSTANCE,
    DcpOption::START,
    DcpOption::END,
    DcpOption::SIGNAL,
    DcpOption::RESPONSE,
    DcpOption::FACTORY_RESET,
    DcpOption::RESET_TO_FACTORY,
];

/// What an Identify answer holds.
const IDENTIFY_ANSWER: &[DcpOption] = &[
    DcpOption::STATION_TYPE,
    DcpOption::NAME,
    DcpOption::DEVICE_ID,
    DcpOption::ROLE,
    DcpOption::OPTIONS,
    DcpOption::INSTANCE,
    DcpOption::IP,
];

/// Who is served, and whether the light blinks.
#[derive(Debug, Default)]
pub(super) struct DcpState {
    held: Option<(MacAddress, Instant)>,
    blinking: Option<Instant>,
    limit: SourceLimit,
    /// The application reports whether a name or address is stored, and the answer to a Set waits for that.
    confirmed: bool,
    /// The Set being executed has changed what is stored.
    changed: bool,
    waiting: Option<WaitingSet>,
}

/// A Set whose answer waits until the application has stored what it changed.
#[derive(Debug)]
struct WaitingSet {
    answer: SetAnswer,
    /// Name and address before, each with whether it is permanent.
    name: (String, bool),
    ip: (IpSuite, bool),
}

/// What is answered to a Set.
#[derive(Debug)]
struct SetAnswer {
    source: MacAddress,
    xid: u32,
    results: Vec<(DcpOption, BlockError)>,
    reset: Option<ResetMode>,
}

impl Device {
    /// Takes a frame with a DCP FrameID that is for this station or for all.
    pub(super) fn handle_dcp(&mut self, now: Instant, frame: &Frame<'_>) {
        let Ok(pdu) = Pdu::parse(frame.payload) else {
            return;
        };
        if pdu.kind != ServiceType::Request || frame.source.is_multicast() {
            return;
        }
        let unicast = frame.destination == self.config.mac;
        match (frame.frame_id, pdu.service) {
            (FrameId::DCP_IDENTIFY_REQUEST, ServiceId::Identify)
                if unicast || frame.destination == DCP_IDENTIFY =>
            {
                self.identify(now, frame.source, &pdu);
            }
            (FrameId::DCP_GET_SET, service) if unicast => {
                let held = self
                    .dcp
                    .held
                    .is_some_and(|(mac, until)| mac != frame.source && now < until);
                if held {
                    return;
                }
                let served = match service {
                    ServiceId::Get => self.get(now, frame.source, &pdu),
                    ServiceId::Set => self.may_change(now, frame.source) && self.set(now, frame.source, &pdu),
                    ServiceId::Identify | ServiceId::Hello => false,
                    ServiceId::Other(_) => {
                        self.not_supported(now, frame.source, &pdu);
                        false
                    }
                };
                if served {
                    self.dcp.held = Some((frame.source, now + CLIENT_HOLD));
                }
            }
            _ => {}
        }
    }

    /// Returns false for a source that requests too many changes; its requests are ignored.
    fn may_change(&mut self, now: Instant, source: MacAddress) -> bool {
        let allowance = self.dcp.limit.count(now, source);
        if allowance == Allowance::Exceeded {
            let refusal = SetRefusal::TooMany;
            self.event(Event::SetRefused { source, refusal });
        }
        allowance == Allowance::Granted
    }

    /// Answers a service that does not exist: the header back, "not supported", no blocks.
    fn not_supported(&mut self, now: Instant, source: MacAddress, pdu: &Pdu<'_>) {
        let mut payload = Vec::new();
        PduWriter::new(&mut payload, pdu.service, ServiceType::NotSupported, pdu.xid, 0).finish();
        self.send_dcp(now, now, source, FrameId::DCP_GET_SET, &payload);
    }

    fn send_dcp(&mut self, now: Instant, due: Instant, to: MacAddress, id: FrameId, payload: &[u8]) {
        let mut frame = vec![0; MAX_FRAME];
        if let Some(length) = ethernet::emit(&mut frame, to, self.config.mac, None, id, payload) {
            self.quiet_until = None;
            frame.truncate(length);
            if due > now {
                let at = self.delayed.partition_point(|(other, _)| *other <= due);
                self.delayed.insert(at, (due, frame));
            } else {
                self.send_frame(frame);
            }
        }
    }

    /// Gives the value of an option to `write`; false if there is none.
    fn with_value(&self, option: DcpOption, write: impl FnOnce(BlockInfo, &Value<'_>)) -> bool {
        let identity = &self.config.identity;
        let (vendor, device) = (identity.vendor_id, identity.device_id);
        let ip_info = if self.ip.is_set() {
            BlockInfo::IP_SET
        } else {
            BlockInfo::NONE
        };
        let none = BlockInfo::NONE;
        match option {
            DcpOption::MAC => write(none, &Value::Mac(self.config.mac)),
            DcpOption::IP => write(ip_info, &Value::Ip(self.ip)),
            DcpOption::FULL_IP => {
                write(
                    ip_info,
                    &Value::FullIp {
                        suite: self.ip,
                        dns: [Ipv4Addr::UNSPECIFIED; 4],
                    },
                );
            }
            DcpOption::STATION_TYPE => write(none, &Value::StationType(identity.station_type.as_bytes())),
            DcpOption::NAME => write(none, &Value::Name(self.name.as_bytes())),
            DcpOption::DEVICE_ID => write(none, &Value::DeviceId { vendor, device }),
            DcpOption::ROLE => write(none, &Value::Role(role::DEVICE)),
            DcpOption::OPTIONS => {
                let list: Vec<u8> = OPTIONS
                    .iter()
                    .flat_map(|option| option.number().to_be_bytes())
                    .collect();
                write(none, &Value::Options(&list));
            }
            DcpOption::INSTANCE => write(none, &Value::Instance(identity.instance)),
            _ => return false,
        }
        true
    }

    fn identify(&mut self, now: Instant, source: MacAddress, pdu: &Pdu<'_>) {
        let due = now + response_delay(self.config.mac, pdu.delay_factor);
        // waiting answers must not keep a controller from finding its device
        if (due > now && self.delayed.len() >= WAITING) || !self.is_meant(pdu) {
            return;
        }
        let mut payload = Vec::new();
        let mut answer = PduWriter::new(
            &mut payload,
            ServiceId::Identify,
            ServiceType::Success,
            pdu.xid,
            0,
        );
        for option in IDENTIFY_ANSWER {
            self.with_value(*option, |info, value| answer.info(info, value));
        }
        // a station that requests the neighbour's name gets it back
        for block in pdu.blocks().flatten().take(1) {
            if let Ok(alias @ Value::Alias(_)) = block.filter() {
                answer.info(BlockInfo::NONE, &alias);
            }
        }
        answer.finish();
        self.send_dcp(now, due, source, FrameId::DCP_IDENTIFY_RESPONSE, &payload);
    }

    /// Returns true if every filter fits; a malformed or unknown one never does.
    fn is_meant(&self, pdu: &Pdu<'_>) -> bool {
        let mut filters = 0;
        for block in pdu.blocks() {
            let Ok(block) = block else { return false };
            filters += 1;
            if block.option == DcpOption::ALL {
                // some testers put two octets into this block
                return filters == 1 && block.body.len() <= 2 && pdu.blocks().count() == 1;
            }
            if !self.fits(&block) {
                return false;
            }
        }
        filters > 0
    }

    fn fits(&self, block: &Block<'_>) -> bool {
        let Ok(wanted) = block.filter() else { return false };
        if matches!(wanted, Value::Name(name) if name.is_empty()) {
            return self.name.is_empty();
        }
        if let Value::Alias(alias) = wanted {
            return self.has_alias(alias);
        }
        let mut same = false;
        self.with_value(block.option, |_, value| same = *value == wanted);
        same
    }

    /// Returns true if a neighbour gives this station that name: port and name of the neighbour, `port-001.plc1`.
    fn has_alias(&self, alias: &[u8]) -> bool {
        let mut neighbours = self.port.neighbours.iter();
        neighbours.any(|neighbour| neighbour.alias().is_some_and(|own| own.as_bytes() == alias))
    }

    /// Answers a Get; false if it was malformed.
    fn get(&mut self, now: Instant, source: MacAddress, pdu: &Pdu<'_>) -> bool {
        let mut payload = Vec::new();
        let mut answer = PduWriter::new(&mut payload, ServiceId::Get, ServiceType::Success, pdu.xid, 0);
        // each option once, so that the answer fits one frame
        let mut answered: Vec<DcpOption> = Vec::new();
        for option in pdu.requested() {
            let Ok(option) = option else { return false };
            if answered.contains(&option) || answered.len() >= MAX_BLOCKS {
                continue;
            }
            answered.push(option);
            if !self.with_value(option, |info, value| answer.info(info, value)) {
                answer.result(option, option.unsupported());
            }
        }
        answer.finish();
        self.send_dcp(now, now, source, FrameId::DCP_GET_SET, &payload);
        true
    }

    /// Makes the answer to a Set of the name or the address wait for [`answer_set`](Self::answer_set). Without this call it
    /// is sent at once.
    pub fn confirm_stores(&mut self) {
        self.dcp.confirmed = true;
    }

    /// Reports that the name and the address of the last [`Event::NameChanged`] and [`Event::IpChanged`] are stored, or that
    /// they could not be: then those before count again and the answer is a resource error.
    pub fn answer_set(&mut self, now: Instant, stored: bool) {
        self.quiet_until = None;
        let Some(WaitingSet { mut answer, name, ip }) = self.dcp.waiting.take() else {
            return;
        };
        if !stored {
            if self.name != name.0 {
                self.close_all(now, PnioStatus::aborted(abort::NAME_CHANGED));
            }
            if self.ip != ip.0 {
                self.close_all(now, PnioStatus::aborted(abort::CLOSED));
            }
            (self.name, self.name_permanent) = name;
            (self.ip, self.ip_permanent) = ip;
            self.port.announce();
            for (option, error) in &mut answer.results {
                let stores = matches!(*option, DcpOption::NAME | DcpOption::IP | DcpOption::FULL_IP);
                if stores && *error == BlockError::Ok {
                    *error = BlockError::Resource;
                }
            }
        }
        self.send_set_answer(now, &answer);
    }

    fn send_set_answer(&mut self, now: Instant, answer: &SetAnswer) {
        let mut payload = Vec::new();
        let mut pdu = PduWriter::new(&mut payload, ServiceId::Set, ServiceType::Success, answer.xid, 0);
        for (option, error) in &answer.results {
            pdu.result(*option, *error);
        }
        pdu.finish();
        self.send_dcp(now, now, answer.source, FrameId::DCP_GET_SET, &payload);
        if let Some(mode) = answer.reset {
            self.reset(now, mode);
        }
    }

    /// Executes a Set; false if it was malformed, or the Set before is not answered yet.
    fn set(&mut self, now: Instant, source: MacAddress, pdu: &Pdu<'_>) -> bool {
        if self.dcp.waiting.is_some() {
            return false;
        }
        let mut blocks = Vec::new();
        for block in pdu.blocks() {
            // a request that is cut off is not half executed
            let Ok(block) = block else { return false };
            blocks.push(block);
        }
        if blocks.len() > MAX_BLOCKS {
            return false;
        }
        let (name, ip) = (
            (self.name.clone(), self.name_permanent),
            (self.ip, self.ip_permanent),
        );
        self.dcp.changed = false;
        let (mut reset, mut results) = (None, Vec::new());
        for block in &blocks {
            let error = if self.is_kept_from(block) {
                let refusal = SetRefusal::InOperation(block.option);
                self.event(Event::SetRefused { source, refusal });
                BlockError::InOperation
            } else {
                let error = self.set_block(now, block, &mut reset);
                if error == BlockError::InOperation {
                    // an IO connection keeps its address
                    let refusal = SetRefusal::Connected(block.option);
                    self.event(Event::SetRefused { source, refusal });
                }
                error
            };
            results.push((block.option, error));
        }
        let answer = SetAnswer {
            source,
            xid: pdu.xid,
            results,
            reset,
        };
        if self.dcp.confirmed && self.dcp.changed {
            self.dcp.waiting = Some(WaitingSet { answer, name, ip });
        } else {
            self.send_set_answer(now, &answer);
        }
        true
    }

    /// Returns true for requests that would end the connection of a controller that is moving something: another name,
    /// a reset.
    fn is_kept_from(&self, block: &Block<'_>) -> bool {
        if !(self.config.refuses_in_operation && self.operating && self.controller.is_some()) {
            return false;
        }
        match block.option {
            DcpOption::FACTORY_RESET | DcpOption::RESET_TO_FACTORY => true,
            DcpOption::NAME => {
                matches!(block.set(), Ok((_, Value::Name(name))) if name != self.name.as_bytes())
            }
            _ => false,
        }
    }

    fn set_block(&mut self, now: Instant, block: &Block<'_>, reset: &mut Option<ResetMode>) -> BlockError {
        let settable = matches!(
            block.option,
            DcpOption::IP
                | DcpOption::FULL_IP
                | DcpOption::NAME
                | DcpOption::START
                | DcpOption::END
                | DcpOption::SIGNAL
                | DcpOption::FACTORY_RESET
                | DcpOption::RESET_TO_FACTORY
        );
        if !settable {
            return block.option.unsupported();
        }
        let Ok((qualifier, value)) = block.set() else {
            return BlockError::NotSet;
        };
        match (block.option, value) {
            (_, Value::Name(name)) => self.set_name(now, name, qualifier),
            (_, Value::Ip(suite) | Value::FullIp { suite, .. }) => self.set_ip(now, suite, qualifier),
            (_, Value::Signal(_)) => {
                if self.dcp.blinking.is_none_or(|until| now >= until) {
                    self.dcp.blinking = Some(now + BLINK);
                    self.event(Event::Signal);
                }
                BlockError::Ok
            }
            (DcpOption::FACTORY_RESET, _) => {
                *reset = Some(ResetMode::Device);
                BlockError::Ok
            }
            (DcpOption::RESET_TO_FACTORY, _) => {
                let mode = ResetMode::from_number(qualifier.reset_mode());
                match mode.filter(|mode| self.config.reset_modes.contains(mode)) {
                    Some(mode) => {
                        *reset = Some(mode);
                        BlockError::Ok
                    }
                    None => BlockError::SuboptionUnsupported,
                }
            }
            (DcpOption::START | DcpOption::END, _) => BlockError::Ok,
            _ => BlockError::NotSet,
        }
    }

    fn set_name(&mut self, now: Instant, name: &[u8], qualifier: Qualifier) -> BlockError {
        let Ok(name) = core::str::from_utf8(name) else {
            return BlockError::NotSet;
        };
        if !name.is_empty() && check_name(name.as_bytes()).is_err() {
            return BlockError::NotSet;
        }
        let permanent = qualifier.is_permanent();
        let changed = self.name != name;
        if changed {
            self.close_all(now, PnioStatus::aborted(abort::NAME_CHANGED));
            self.name = String::from(name);
            self.port.announce();
        }
        if changed || self.name_permanent != permanent {
            self.name_permanent = permanent;
            self.dcp.changed = true;
            self.event(Event::NameChanged {
                name: String::from(name),
                permanent,
            });
        }
        BlockError::Ok
    }

    /// Sets the address. An IO connection keeps it; parameter tools are disconnected. Source: AKD PROFINET manual 3.4.
    fn set_ip(&mut self, now: Instant, suite: IpSuite, qualifier: Qualifier) -> BlockError {
        if check_ip(&suite).is_err() {
            return BlockError::NotSet;
        }
        let permanent = qualifier.is_permanent();
        let changed = self.ip != suite;
        if changed && self.controller.is_some() {
            return BlockError::InOperation;
        }
        if changed {
            // tools that read and write parameters connect again at the new address
            self.close_all(now, PnioStatus::aborted(abort::CLOSED));
        }
        self.ip = suite;
        if changed {
            self.port.announce();
        }
        if changed || self.ip_permanent != permanent {
            self.ip_permanent = permanent;
            self.dcp.changed = true;
            self.event(Event::IpChanged { suite, permanent });
        }
        BlockError::Ok
    }

    fn reset(&mut self, now: Instant, mode: ResetMode) {
        self.close_all(now, PnioStatus::aborted(abort::FACTORY_RESET));
        if mode.clears_address() {
            self.name.clear();
            self.ip = IpSuite::NONE;
            self.name_permanent = true;
            self.ip_permanent = true;
            // what a controller wrote about ports and interface belongs to the network it was in
            self.interface_adjust.clear();
            self.port_records.clear();
            self.port.announce();
        }
        if mode.clears_im() {
            self.im = ImRecords::default();
        }
        self.event(Event::FactoryReset { mode });
    }
}

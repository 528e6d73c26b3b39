//! Requesting side of discovery and basic configuration: windows, repetitions, answers.

use alloc::collections::{BTreeSet, VecDeque};
use alloc::string::String;
use alloc::vec::Vec;
use core::time::Duration;

use super::config::Timeouts;
use super::error::DcpError;
use super::event::{DcpId, DcpReply, Station};
use crate::wire::dcp::{
    BlockError, BlockInfo, DcpOption, MAX_DELAY_FACTOR, Pdu, PduWriter, Qualifier, ServiceId, ServiceType,
    Value,
};
use crate::wire::ethernet::{self, Frame, FrameId, FrameKind};
use crate::wire::{SliceWriter, Writer};
use crate::{Instant, IpSuite, MacAddress};

/// Stations taken per Identify request at most.
const MAX_STATIONS: usize = 4096;
/// Requests open at once at most.
const MAX_REQUESTS: usize = 1024;

/// Filter of an Identify request. A station answers if all given values match; without values every station answers.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Filter {
    /// Name of station, exactly.
    pub name: Option<String>,
    /// Alias, `port.station` of a neighbour.
    pub alias: Option<String>,
    /// Type of station, exactly.
    pub station_type: Option<String>,
    /// Vendor and device.
    pub device: Option<(u16, u16)>,
    /// Role bits.
    pub role: Option<u8>,
    /// IP configuration.
    pub ip: Option<IpSuite>,
    /// Ethernet address.
    pub mac: Option<MacAddress>,
    /// Instance.
    pub instance: Option<u16>,
}

impl Filter {
    /// Returns all stations.
    #[must_use]
    pub fn all() -> Self {
        Self::default()
    }

    /// One name.
    #[must_use]
    pub fn name(name: &str) -> Self {
        Self {
            name: Some(name.into()),
            ..Self::default()
        }
    }

    fn write<W: Writer>(&self, pdu: &mut PduWriter<'_, W>) {
        // name and alias first: some devices insist
        let values = [
            self.name.as_ref().map(|t| Value::Name(t.as_bytes())),
            self.alias.as_ref().map(|t| Value::Alias(t.as_bytes())),
            self.station_type
                .as_ref()
                .map(|t| Value::StationType(t.as_bytes())),
            self.device
                .map(|(vendor, device)| Value::DeviceId { vendor, device }),
            self.role.map(Value::Role),
            self.ip.map(Value::Ip),
            self.mac.map(Value::Mac),
            self.instance.map(Value::Instance),
        ];
        if values.iter().all(Option::is_none) {
            pdu.filter(&Value::ALL);
        }
        for value in values.iter().flatten() {
            pdu.filter(value);
        }
    }
}

/// How long an Identify request collects answers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct IdentifyOptions {
    /// ResponseDelayFactor, 1 to 6400: devices spread their answers over this many times 10 ms.
    pub delay_factor: u16,
    /// Time added to that.
    pub margin: Duration,
    /// How often the request is sent within the window; answers count once.
    pub sends: u8,
}

impl IdentifyOptions {
    /// For one name: answers come at once.
    pub const ONE: Self = Self {
        delay_factor: 1,
        margin: Duration::from_millis(390),
        sends: 2,
    };
    /// For all stations: answers spread over 640 ms.
    pub const MANY: Self = Self {
        delay_factor: 64,
        margin: Duration::from_millis(360),
        sends: 2,
    };

    fn window(&self) -> Duration {
        Duration::from_millis(10) * u32::from(self.delay_factor) + self.margin
    }
}

/// What came out of a frame or a deadline.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum DcpEvent {
    /// With the requests sent so far, where it answers them at once: what was sent before the last one is lost, or its answer.
    Identified(DcpId, Station, Option<u8>),
    /// With the number of stations, and whether more answered than are taken.
    IdentifyDone(DcpId, usize, bool),
    Hello(Station),
    Done(DcpId, Result<DcpReply, DcpError>),
}

#[derive(Debug)]
enum Kind {
    Identify {
        filter: Filter,
        factor: u16,
        seen: BTreeSet<MacAddress>,
        /// A station answered that was not taken.
        more: bool,
        end: Instant,
        every: Duration,
    },
    Get {
        mac: MacAddress,
        options: Vec<DcpOption>,
    },
    Set {
        mac: MacAddress,
        name: Option<String>,
        block: Setting,
    },
}

/// A change made by DCP Set.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Setting {
    Name(Qualifier),
    Ip(Qualifier, IpSuite),
    Signal,
    Reset(Qualifier),
    LegacyReset,
}

impl Setting {
    const fn option(self) -> DcpOption {
        match self {
            Self::Name(_) => DcpOption::NAME,
            Self::Ip(..) => DcpOption::IP,
            Self::Signal => DcpOption::SIGNAL,
            Self::Reset(_) => DcpOption::RESET_TO_FACTORY,
            Self::LegacyReset => DcpOption::FACTORY_RESET,
        }
    }
}

#[derive(Debug)]
struct Request {
    id: DcpId,
    xid: u32,
    kind: Kind,
    send: bool,
    sends: u8,
    due: Instant,
}

/// All DCP requests of a controller.
#[derive(Debug)]
pub(super) struct DcpClient {
    requests: Vec<Request>,
    events: VecDeque<DcpEvent>,
    timeouts: Timeouts,
    xid: u32,
    next: u32,
}

impl DcpClient {
    pub(super) const fn new(timeouts: Timeouts, xid: u32) -> Self {
        Self {
            requests: Vec::new(),
            events: VecDeque::new(),
            timeouts,
            xid,
            next: 0,
        }
    }

    fn start(&mut self, kind: Kind, due: Instant) -> Option<DcpId> {
        if self.requests.len() >= MAX_REQUESTS {
            return None;
        }
        self.next = self.next.wrapping_add(1);
        self.xid = self.xid.wrapping_add(1);
        let id = DcpId(self.next);
        self.requests.push(Request {
            id,
            xid: self.xid,
            kind,
            send: true,
            sends: 0,
            due,
        });
        Some(id)
    }

    pub(super) fn identify(
        &mut self,
        now: Instant,
        filter: Filter,
        options: IdentifyOptions,
    ) -> Option<DcpId> {
        let factor = options.delay_factor.clamp(1, MAX_DELAY_FACTOR);
        let options = IdentifyOptions {
            delay_factor: factor,
            ..options
        };
        let end = now + options.window();
        let every = options.window() / u32::from(options.sends.max(1));
        self.start(
            Kind::Identify {
                filter,
                factor,
                seen: BTreeSet::new(),
                more: false,
                end,
                every,
            },
            now + every,
        )
    }

    pub(super) fn get(&mut self, now: Instant, mac: MacAddress, options: Vec<DcpOption>) -> Option<DcpId> {
        self.start(Kind::Get { mac, options }, now + self.timeouts.dcp)
    }

    pub(super) fn set(
        &mut self,
        now: Instant,
        mac: MacAddress,
        block: Setting,
        name: Option<String>,
    ) -> Option<DcpId> {
        self.start(Kind::Set { mac, name, block }, now + self.timeouts.dcp)
    }

    /// Cancels a request; no event follows.
    pub(super) fn cancel(&mut self, id: DcpId) {
        self.requests.retain(|request| request.id != id);
    }

    pub(super) fn poll_event(&mut self) -> Option<DcpEvent> {
        self.events.pop_front()
    }

    pub(super) fn handle_frame(&mut self, frame: &Frame<'_>) {
        let Ok(pdu) = Pdu::parse(frame.payload) else {
            return;
        };
        match (frame.frame_id.kind(), pdu.service) {
            (FrameKind::DcpHello, ServiceId::Hello) if pdu.kind == ServiceType::Request => {
                if let Ok(station) = station(frame.source, &pdu) {
                    self.events.push_back(DcpEvent::Hello(station));
                }
            }
            (FrameKind::DcpIdentifyResponse, ServiceId::Identify) => self.identified(frame.source, &pdu),
            (FrameKind::DcpGetSet, ServiceId::Get | ServiceId::Set) if pdu.kind != ServiceType::Request => {
                self.answered(frame.source, &pdu);
            }
            _ => {}
        }
    }

    fn identified(&mut self, source: MacAddress, pdu: &Pdu<'_>) {
        if pdu.kind != ServiceType::Success || source.is_multicast() {
            return;
        }
        for request in &mut self.requests {
            if request.xid != pdu.xid {
                continue;
            }
            if let Kind::Identify {
                seen,
                more,
                factor,
                every,
                ..
            } = &mut request.kind
            {
                // a malformed answer does not count as one
                let Ok(station) = station(source, pdu) else { return };
                if seen.len() >= MAX_STATIONS {
                    *more |= !seen.contains(&source);
                } else if seen.insert(source) {
                    let at_once = Duration::from_millis(10) * u32::from(*factor) < *every;
                    let sends = at_once.then_some(request.sends);
                    self.events
                        .push_back(DcpEvent::Identified(request.id, station, sends));
                }
            }
            return;
        }
    }

    fn answered(&mut self, source: MacAddress, pdu: &Pdu<'_>) {
        let found = self.requests.iter().position(|request| {
            let (mac, service) = match &request.kind {
                Kind::Identify { .. } => return false,
                Kind::Get { mac, .. } => (*mac, ServiceId::Get),
                Kind::Set { mac, .. } => (*mac, ServiceId::Set),
            };
            (request.xid, mac, service) == (pdu.xid, source, pdu.service)
        });
        let Some(index) = found else { return };
        let request = self.requests.swap_remove(index);
        let result = match (&request.kind, pdu.kind) {
            (_, ServiceType::NotSupported) => Err(DcpError::NotSupported),
            (Kind::Set { block, .. }, _) => set_result(pdu, block.option()).map(|()| DcpReply::Done),
            (Kind::Get { options, .. }, _) => get_result(source, pdu, options).map(DcpReply::Values),
            (Kind::Identify { .. }, _) => return,
        };
        self.events.push_back(DcpEvent::Done(request.id, result));
    }

    pub(super) fn handle_timeout(&mut self, now: Instant) {
        let timeouts = self.timeouts;
        let events = &mut self.events;
        self.requests.retain_mut(|request| {
            if now < request.due {
                return true;
            }
            match &request.kind {
                Kind::Identify {
                    end,
                    every,
                    seen,
                    more,
                    ..
                } => {
                    if now >= *end {
                        events.push_back(DcpEvent::IdentifyDone(request.id, seen.len(), *more));
                        return false;
                    }
                    request.send = true;
                    request.due = (request.due + *every)
                        .min(*end)
                        .max(now + Duration::from_millis(1));
                }
                Kind::Get { mac, .. } | Kind::Set { mac, .. } => {
                    if request.sends >= timeouts.dcp_sends {
                        let error = DcpError::Timeout {
                            mac: *mac,
                            sends: request.sends,
                        };
                        events.push_back(DcpEvent::Done(request.id, Err(error)));
                        return false;
                    }
                    request.send = true;
                    request.due = now + timeouts.dcp;
                }
            }
            true
        });
    }

    pub(super) fn poll_timeout(&self) -> Option<Instant> {
        self.requests.iter().map(|request| request.due).min()
    }

    /// Writes the next request as a whole frame.
    pub(super) fn poll_transmit(
        &mut self,
        now: Instant,
        local: MacAddress,
        buffer: &mut [u8],
    ) -> Option<usize> {
        let request = self.requests.iter_mut().find(|request| request.send)?;
        request.send = false;
        request.sends = request.sends.saturating_add(1);
        let (destination, id) = match &request.kind {
            Kind::Identify { .. } => (ethernet::DCP_IDENTIFY, FrameId::DCP_IDENTIFY_REQUEST),
            Kind::Get { mac, .. } | Kind::Set { mac, .. } => {
                request.due = now + self.timeouts.dcp;
                (*mac, FrameId::DCP_GET_SET)
            }
        };
        let header = ethernet::emit_header(buffer, destination, local, None, id)?;
        let mut out = SliceWriter::new(buffer.get_mut(header..)?);
        write_request(&mut out, request);
        let length = header + out.finish().ok()?;
        Some(ethernet::pad(buffer, length))
    }
}

fn write_request(out: &mut SliceWriter<'_>, request: &Request) {
    let kind = ServiceType::Request;
    match &request.kind {
        Kind::Identify { filter, factor, .. } => {
            let mut pdu = PduWriter::new(out, ServiceId::Identify, kind, request.xid, *factor);
            filter.write(&mut pdu);
            pdu.finish();
        }
        Kind::Get { options, .. } => {
            let mut pdu = PduWriter::new(out, ServiceId::Get, kind, request.xid, 0);
            for option in options {
                pdu.request(*option);
            }
            pdu.finish();
        }
        Kind::Set { name, block, .. } => {
            let mut pdu = PduWriter::new(out, ServiceId::Set, kind, request.xid, 0);
            let name = name.as_deref().unwrap_or_default().as_bytes();
            match *block {
                Setting::Name(qualifier) => pdu.set(qualifier, &Value::Name(name)),
                Setting::Ip(qualifier, suite) => pdu.set(qualifier, &Value::Ip(suite)),
                Setting::Signal => pdu.set(Qualifier::TEMPORARY, &Value::FLASH),
                Setting::Reset(qualifier) => pdu.set(qualifier, &Value::Empty(DcpOption::RESET_TO_FACTORY)),
                Setting::LegacyReset => {
                    pdu.set(Qualifier::TEMPORARY, &Value::Empty(DcpOption::FACTORY_RESET));
                }
            }
            pdu.finish();
        }
    }
}

/// Combines all blocks of an Identify or Get answer or of a Hello.
fn station(mac: MacAddress, pdu: &Pdu<'_>) -> Result<Station, crate::wire::DecodeError> {
    let mut station = Station {
        mac,
        ..Station::default()
    };
    for block in pdu.blocks() {
        let block = block?;
        if block.option == DcpOption::RESPONSE {
            continue;
        }
        let (info, value) = block.info()?;
        take(&mut station, info, value);
    }
    Ok(station)
}

fn take(station: &mut Station, info: BlockInfo, value: Value<'_>) {
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    match value {
        Value::Ip(suite) | Value::FullIp { suite, .. } => {
            station.ip = suite;
            station.ip_conflict = info.has_conflict();
            station.ip_by_dhcp = info.0 & 0x7F == BlockInfo::IP_BY_DHCP.0;
        }
        Value::StationType(bytes) => {
            // some stations fill this text with zeros
            let end = bytes.iter().rposition(|b| *b != 0).map_or(0, |last| last + 1);
            station.station_type = text(bytes.get(..end).unwrap_or_default());
        }
        Value::Name(bytes) => station.name = text(bytes),
        Value::DeviceId { vendor, device } => {
            station.vendor_id = vendor;
            station.device_id = device;
        }
        Value::Role(role) => station.role = role,
        Value::Options(list) => {
            let (pairs, _) = list.as_chunks::<2>();
            station.options = pairs.iter().map(|[a, b]| DcpOption::new(*a, *b)).collect();
        }
        Value::Alias(bytes) => station.alias = text(bytes),
        Value::Instance(instance) => station.instance = instance,
        Value::OemDeviceId { vendor, device } => station.oem = Some((vendor, device)),
        Value::Mac(_) | Value::Signal(_) | Value::Initiative(_) | Value::Empty(_) | Value::Other(..) => {}
    }
}

/// Looks for the result of a Set of `option`.
fn set_result(pdu: &Pdu<'_>, option: DcpOption) -> Result<(), DcpError> {
    for block in pdu.blocks() {
        let (about, error) = block?.result()?;
        if about == option {
            return if error == BlockError::Ok {
                Ok(())
            } else {
                Err(DcpError::Refused { option, error })
            };
        }
    }
    Err(DcpError::Missing(option))
}

/// Returns what a station has of `options`; the first error where it has none of them.
fn get_result(mac: MacAddress, pdu: &Pdu<'_>, options: &[DcpOption]) -> Result<Station, DcpError> {
    let mut refused = None;
    let mut present = false;
    for block in pdu.blocks() {
        let block = block?;
        if block.option == DcpOption::RESPONSE {
            let (option, error) = block.result()?;
            refused = refused.or(Some(DcpError::Refused { option, error }));
        } else {
            present |= options.contains(&block.option);
        }
    }
    if !present {
        let missing = options.first().copied().map(DcpError::Missing);
        return Err(refused.or(missing).unwrap_or(DcpError::NotSupported));
    }
    Ok(station(mac, pdu)?)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn answers_of_ever_new_stations_are_bounded() {
        let mut client = DcpClient::new(Timeouts::default(), 1);
        let id = client.identify(Instant::ZERO, Filter::all(), IdentifyOptions::ONE);
        let mut payload = Vec::new();
        let (identify, success) = (ServiceId::Identify, ServiceType::Success);
        PduWriter::new(&mut payload, identify, success, client.xid, 0).finish();
        let own = MacAddress([2, 0, 0, 0, 0, 1]);
        let mut buffer = [0; 1518];
        for number in 0..5000_u32 {
            let [a, b, c, d] = number.to_be_bytes();
            let source = MacAddress([2, 1, a, b, c, d]);
            let frame_id = FrameId::DCP_IDENTIFY_RESPONSE;
            let length = ethernet::emit(&mut buffer, own, source, None, frame_id, &payload).unwrap();
            client.handle_frame(&Frame::parse(&buffer[..length]).unwrap());
        }
        let events: Vec<DcpEvent> = core::iter::from_fn(|| client.poll_event()).collect();
        let identified = |event: &&DcpEvent| matches!(event, DcpEvent::Identified(of, ..) if Some(*of) == id);
        assert_eq!(events.iter().filter(identified).count(), MAX_STATIONS);
        client.handle_timeout(Instant::ZERO + Duration::from_secs(1));
        let done = DcpEvent::IdentifyDone(id.unwrap(), MAX_STATIONS, true);
        assert_eq!(client.poll_event(), Some(done));
    }

    #[test]
    fn a_search_that_is_exactly_full_is_complete() {
        let mut client = DcpClient::new(Timeouts::default(), 1);
        let id = client.identify(Instant::ZERO, Filter::all(), IdentifyOptions::ONE);
        let mut payload = Vec::new();
        let (identify, success) = (ServiceId::Identify, ServiceType::Success);
        PduWriter::new(&mut payload, identify, success, client.xid, 0).finish();
        let pdu = Pdu::parse(&payload).unwrap();
        let stations = u16::try_from(MAX_STATIONS).unwrap();
        // each answers to both requests of the search
        for number in (0..stations).chain(0..stations) {
            let [a, b] = number.to_be_bytes();
            client.identified(MacAddress([2, 0, 0, 0, a, b]), &pdu);
        }
        client.handle_timeout(Instant::ZERO + Duration::from_secs(1));
        let last = core::iter::from_fn(|| client.poll_event()).last();
        assert_eq!(last, id.map(|id| DcpEvent::IdentifyDone(id, MAX_STATIONS, false)));
    }
}

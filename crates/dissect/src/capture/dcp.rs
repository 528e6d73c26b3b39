//! Discovery and addressing: services in words, answers matched with their requests.

use std::collections::HashSet;
use std::net::Ipv4Addr;
use std::time::Duration;

use profinet::MacAddress;
use profinet::wire::DecodeError;
use profinet::wire::dcp::{BlockError, DcpOption, Pdu, Qualifier, ServiceId, ServiceType, Value, role};
use profinet::wire::ethernet::Frame;

use super::event::{Dcp, DcpResult, Detail, Origin, Sink, Trouble};
use super::names::{Names, seconds};
use super::pending::{CUT_OFF, Pending};
use crate::Weight;

/// Topic of the events.
const TOPIC: &str = "DCP";
/// Time for an answer beyond the delay that an Identify request allows.
const TIMEOUT: Duration = Duration::from_secs(1);
/// Unit of the ResponseDelayFactor.
const DELAY: Duration = Duration::from_millis(10);
/// Maximum number of unanswered stored Identify requests.
const MAX_SILENT: usize = 1024;

/// Requester, transaction and, unless multicast, the station.
type Key = (MacAddress, u32, Option<MacAddress>);

/// The services of a capture that may still be answered.
#[derive(Debug, Default)]
pub struct Services {
    open: Pending<Key, Service>,
    /// Unanswered Identify requests, with their requester: a controller repeats them every second.
    silent: HashSet<(MacAddress, String)>,
}

/// A request.
#[derive(Debug, Default)]
struct Service {
    origin: Origin,
    /// The request in words.
    what: String,
    /// Sent as multicast, so any number of stations answers.
    identify: bool,
    answered: bool,
    sent: u32,
    /// What a Set request changes.
    change: Change,
}

/// Name and address in a Set request: they count once the station confirms them.
#[derive(Debug, Default)]
struct Change {
    name: Option<Vec<u8>>,
    ip: Option<Ipv4Addr>,
}

impl Services {
    /// Looks at one PDU.
    pub fn pdu(
        &mut self,
        frame: &Frame<'_>,
        names: &mut Names,
        sink: &mut Sink<'_>,
    ) -> Result<(), DecodeError> {
        let pdu = Pdu::parse(frame.payload)?;
        match (pdu.service, pdu.kind) {
            (ServiceId::Identify, ServiceType::Request) => {
                let mut detail = detail("identify", &pdu);
                let filters = list(pdu.blocks().map(|block| {
                    let filter = block?.filter()?;
                    note_value(&mut detail, &filter);
                    Ok(value(&filter))
                }))?;
                let text = format!("who is {filters}?");
                let timeout = DELAY * u32::from(pdu.delay_factor) + TIMEOUT;
                self.asked(frame, &pdu, &text, timeout, Change::default(), sink);
                sink.report(Weight::Normal, TOPIC, text, Detail::Dcp(detail));
            }
            (ServiceId::Get, ServiceType::Request) => {
                let wanted = list(pdu.requested().map(|option| Ok(option?.to_string())))?;
                let text = format!("get {wanted}");
                self.asked(frame, &pdu, &text, TIMEOUT, Change::default(), sink);
                sink.report(Weight::Normal, TOPIC, text, Detail::Dcp(detail("get", &pdu)));
            }
            (ServiceId::Set, ServiceType::Request) => self.set(frame, &pdu, sink)?,
            (ServiceId::Set, ServiceType::Success) => self.results(frame, &pdu, names, sink)?,
            (_, ServiceType::Success) | (ServiceId::Hello, _) => self.answer(frame, &pdu, names, sink)?,
            (service, ServiceType::NotSupported) => {
                self.answered(frame, &pdu, sink);
                let text = format!("{service:?} is not supported");
                sink.report(Weight::Error, TOPIC, text, Detail::Dcp(detail("", &pdu)));
            }
            (service, kind) => {
                let text = format!("unknown service {service:?}, type {kind:?}");
                let trouble = Trouble::Unknown {
                    service: u8::from(service).into(),
                };
                sink.report(Weight::Warning, TOPIC, text, Detail::Trouble(trouble));
            }
        }
        Ok(())
    }

    /// Reports the requests unanswered until `now`; with the largest time all, as at the end of a capture.
    pub fn give_up(&mut self, now: Duration, sink: &mut Sink<'_>) {
        while let Some((deadline, service)) = self.open.due(now) {
            let waited = deadline.min(sink.at).saturating_sub(service.origin.at);
            if service.answered || waited < CUT_OFF {
                continue;
            }
            if service.identify {
                let known = (
                    service.origin.source.mac.unwrap_or_default(),
                    service.what.clone(),
                );
                if self.silent.len() >= MAX_SILENT || !self.silent.insert(known) {
                    continue;
                }
            }
            let text = format!("no answer to \"{}\" within {}", service.what, seconds(waited));
            let trouble = Trouble::Unanswered {
                what: service.what,
                sent: service.sent,
                waited,
            };
            sink.report_of(
                service.origin,
                Weight::Warning,
                TOPIC,
                text,
                Detail::Trouble(trouble),
            );
        }
    }

    /// Stores a request until it is answered.
    fn asked(
        &mut self,
        frame: &Frame<'_>,
        pdu: &Pdu<'_>,
        what: &str,
        timeout: Duration,
        change: Change,
        sink: &Sink<'_>,
    ) {
        let station = Some(frame.destination).filter(|mac| !mac.is_multicast());
        let key = (frame.source, pdu.xid, station);
        let deadline = sink.at + timeout;
        if let Some(service) = self.open.get_mut(&key)
            && !service.answered
            && service.what == what
        {
            service.sent += 1;
            self.open.postpone(&key, deadline);
            return;
        }
        let service = Service {
            origin: sink.origin(),
            what: what.to_owned(),
            identify: pdu.service == ServiceId::Identify,
            answered: false,
            sent: 1,
            change,
        };
        self.open.insert(key, deadline, service);
    }

    /// Finds the request of an answer. Reports an answer without one.
    fn answered(&mut self, frame: &Frame<'_>, pdu: &Pdu<'_>, sink: &mut Sink<'_>) -> Option<Change> {
        let to_one = (frame.destination, pdu.xid, Some(frame.source));
        let to_all = (frame.destination, pdu.xid, None);
        let key = if self.open.get_mut(&to_one).is_some() {
            to_one
        } else {
            to_all
        };
        let Some(service) = self.open.get_mut(&key) else {
            let what = format!("{:?}", pdu.service).to_lowercase();
            let text = format!("answer to a DCP {what} that is not in the capture");
            let trouble = Trouble::Unasked {
                what: format!("DCP {what}"),
            };
            sink.report(Weight::Warning, TOPIC, text, Detail::Trouble(trouble));
            return None;
        };
        service.answered = true;
        let change = std::mem::take(&mut service.change);
        if service.identify {
            let known = (frame.destination, service.what.clone());
            self.silent.remove(&known);
        }
        Some(change)
    }

    fn set(&mut self, frame: &Frame<'_>, pdu: &Pdu<'_>, sink: &mut Sink<'_>) -> Result<(), DecodeError> {
        let mut change = Change::default();
        let mut detail = detail("set", pdu);
        let settings = list(pdu.blocks().map(|block| {
            let block = block?;
            let (qualifier, set) = block.set()?;
            note_value(&mut detail, &set);
            match set {
                Value::Name(name) => change.name = Some(name.to_vec()),
                Value::Ip(suite) | Value::FullIp { suite, .. } => change.ip = Some(suite.address),
                _ => {}
            }
            Ok(setting(block.option, qualifier, &set))
        }))?;
        let text = format!("set {settings}");
        self.asked(frame, pdu, &text, TIMEOUT, change, sink);
        sink.report(Weight::Normal, TOPIC, text, Detail::Dcp(detail));
        Ok(())
    }

    /// What a station made of a Set request. Only what it confirms is its name and address from now on.
    fn results(
        &mut self,
        frame: &Frame<'_>,
        pdu: &Pdu<'_>,
        names: &mut Names,
        sink: &mut Sink<'_>,
    ) -> Result<(), DecodeError> {
        let change = self.answered(frame, pdu, sink).unwrap_or_default();
        for block in pdu.blocks() {
            let block = block?;
            if block.option != DcpOption::RESPONSE {
                continue;
            }
            let (option, error) = block.result()?;
            let weight = if error == BlockError::Ok {
                Weight::Normal
            } else {
                Weight::Error
            };
            if error == BlockError::Ok {
                match (option, &change) {
                    (DcpOption::NAME, Change { name: Some(name), .. }) => {
                        names.renamed(frame.source, name, sink.at);
                    }
                    (DcpOption::IP | DcpOption::FULL_IP, Change { ip: Some(ip), .. }) => {
                        names.readdressed(frame.source, *ip, sink.at);
                    }
                    _ => {}
                }
            }
            let mut detail = detail("set", pdu);
            detail.results.push(DcpResult {
                option: option.option,
                suboption: option.suboption,
                error: error.into(),
            });
            let text = format!("set {option}: {}", block_error(error));
            sink.report(weight, TOPIC, text, Detail::Dcp(detail));
        }
        Ok(())
    }

    /// What a station reports of itself.
    fn answer(
        &mut self,
        frame: &Frame<'_>,
        pdu: &Pdu<'_>,
        names: &mut Names,
        sink: &mut Sink<'_>,
    ) -> Result<(), DecodeError> {
        let (service, verb) = match pdu.service {
            ServiceId::Hello => ("hello", "hello"),
            ServiceId::Identify => ("identify", "here"),
            _ => ("get", "answer"),
        };
        if pdu.service != ServiceId::Hello {
            self.answered(frame, pdu, sink);
        }
        let mut detail = detail(service, pdu);
        let (mut name, mut ip, mut identity, mut conflict) = (None, None, None, false);
        let answers = list(pdu.blocks().map(|block| {
            let block = block?;
            if block.option == DcpOption::RESPONSE {
                let (option, error) = block.result()?;
                return Ok(format!("{option}: {}", block_error(error)));
            }
            let (info, answer) = block.info()?;
            note_value(&mut detail, &answer);
            match answer {
                Value::Name(text) => name = Some(text),
                Value::Ip(suite) | Value::FullIp { suite, .. } => {
                    ip = Some(suite.address);
                    conflict |= info.has_conflict();
                }
                Value::DeviceId { vendor, device } => identity = Some((vendor, device)),
                Value::Options(_) => return Ok(String::new()),
                _ => {}
            }
            Ok(value(&answer))
        }))?;
        sink.report(
            Weight::Normal,
            TOPIC,
            format!("{verb}: {answers}"),
            Detail::Dcp(detail),
        );
        names.seen(frame.source, ip, name, sink);
        if let (Some(ip), Some((vendor, device))) = (ip, identity) {
            names.drives.discovered(ip, vendor, device);
        }
        if let Some(ip) = ip.filter(|_| conflict) {
            let text = format!("reports that another station uses its IP address {ip}");
            let trouble = Trouble::DuplicateAddress {
                ip,
                mac: frame.source,
                other: None,
            };
            sink.report(Weight::Error, "conflict", text, Detail::Trouble(trouble));
        }
        Ok(())
    }
}

/// Returns a service without what is in its blocks.
fn detail(service: &'static str, pdu: &Pdu<'_>) -> Dcp {
    Dcp {
        service,
        response: pdu.kind != ServiceType::Request,
        xid: pdu.xid,
        ..Dcp::default()
    }
}

/// Adds the value of a block to the description of a service.
fn note_value(detail: &mut Dcp, value: &Value<'_>) {
    match value {
        Value::Name(name) => detail.name = Some(String::from_utf8_lossy(name).into_owned()),
        Value::Ip(suite) | Value::FullIp { suite, .. } => {
            detail.ip = Some(suite.address);
            detail.prefix = Some(u32::from(suite.mask).leading_ones());
        }
        Value::DeviceId { vendor, device } => {
            detail.vendor = Some(*vendor);
            detail.device = Some(*device);
        }
        _ => {}
    }
}

/// One block of a Set request in words.
fn setting(option: DcpOption, qualifier: Qualifier, set: &Value<'_>) -> String {
    match option {
        DcpOption::SIGNAL => "blink".into(),
        DcpOption::START | DcpOption::END => option.to_string(),
        DcpOption::RESET_TO_FACTORY => format!("reset to factory, mode {}", qualifier.reset_mode()),
        DcpOption::FACTORY_RESET => "factory reset".into(),
        _ => {
            let kept = if qualifier.is_permanent() {
                "permanent"
            } else {
                "temporary"
            };
            format!("{} ({kept})", value(set))
        }
    }
}

fn list(items: impl Iterator<Item = Result<String, DecodeError>>) -> Result<String, DecodeError> {
    let mut texts = items.collect::<Result<Vec<_>, _>>()?;
    texts.retain(|text| !text.is_empty());
    Ok(texts.join(", "))
}

/// Returns a DCP value in words.
pub fn value(value: &Value<'_>) -> String {
    let text = |octets: &[u8]| String::from_utf8_lossy(octets).into_owned();
    match value {
        Value::Mac(mac) => mac.to_string(),
        Value::Ip(suite) | Value::FullIp { suite, .. } if !suite.is_set() => "no IP address".into(),
        Value::Ip(suite) | Value::FullIp { suite, .. } => {
            let prefix = u32::from(suite.mask).leading_ones();
            let gateway = if suite.gateway.is_unspecified() {
                String::new()
            } else {
                format!(" gateway {}", suite.gateway)
            };
            format!("{}/{prefix}{gateway}", suite.address)
        }
        Value::StationType(octets) => format!("type \"{}\"", text(octets)),
        Value::Name([]) => "no name".into(),
        Value::Name(octets) => format!("name {}", text(octets)),
        Value::DeviceId { vendor, device } => format!("vendor 0x{vendor:04X} device 0x{device:04X}"),
        Value::OemDeviceId { vendor, device } => format!("OEM vendor 0x{vendor:04X} device 0x{device:04X}"),
        Value::Role(bits) => roles(*bits),
        Value::Options(pairs) => format!("{} options", pairs.len() / 2),
        Value::Alias(octets) => format!("alias {}", text(octets)),
        Value::Instance(number) => format!("instance {number}"),
        Value::Signal(_) => "blink".into(),
        Value::Initiative(number) => format!("initiative {number}"),
        Value::Empty(DcpOption::ALL) => "there".into(),
        Value::Empty(option) => option.to_string(),
        Value::Other(option, octets) => format!("{option} ({} octets)", octets.len()),
    }
}

fn roles(bits: u8) -> String {
    let names = [
        (role::DEVICE, "IO device"),
        (role::CONTROLLER, "IO controller"),
        (role::MULTIDEVICE, "IO multidevice"),
        (role::SUPERVISOR, "IO supervisor"),
    ];
    let set: Vec<_> = names
        .iter()
        .filter(|(bit, _)| bits & bit != 0)
        .map(|&(_, name)| name)
        .collect();
    if set.is_empty() {
        "no role".into()
    } else {
        set.join(" and ")
    }
}

fn block_error(error: BlockError) -> String {
    match error {
        BlockError::Ok => "ok".into(),
        BlockError::OptionUnsupported => "refused, option not supported".into(),
        BlockError::SuboptionUnsupported => "refused, suboption not supported".into(),
        BlockError::NotSet => "refused, value wrong or not set".into(),
        BlockError::Resource => "refused, resource error".into(),
        BlockError::LocalReasons => "refused for local reasons".into(),
        BlockError::InOperation => "refused, in operation".into(),
        BlockError::Other(code) => format!("refused, error {code}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::capture::Walker;
    use profinet::wire::dcp::{BlockInfo, PduWriter, Qualifier};
    use profinet::wire::ethernet::{self, FrameId};
    use profinet::{IpSuite, MacAddress};
    use std::time::Duration;

    fn notes(frame_id: FrameId, build: impl FnOnce(&mut Vec<u8>)) -> Vec<String> {
        let (to, from) = (MacAddress([2, 0, 0, 0, 0, 1]), MacAddress([2, 0, 0, 0, 0, 2]));
        let events = Walker::default().frame(Duration::ZERO, &pdu(to, from, frame_id, build));
        let events = events
            .into_iter()
            .filter(|event| !matches!(event.detail, Detail::Trouble(_)));
        events
            .map(|event| format!("{}: {}", event.from, event.text))
            .collect()
    }

    /// Returns a DCP frame.
    fn pdu(to: MacAddress, from: MacAddress, frame_id: FrameId, build: impl FnOnce(&mut Vec<u8>)) -> Vec<u8> {
        let mut payload = Vec::new();
        build(&mut payload);
        let mut buffer = [0; 1500];
        let length = ethernet::emit(&mut buffer, to, from, None, frame_id, &payload).unwrap();
        buffer[..length].to_vec()
    }

    #[test]
    fn discovery_in_words() {
        let lines = notes(FrameId::DCP_IDENTIFY_REQUEST, |out| {
            let mut pdu = PduWriter::new(out, ServiceId::Identify, ServiceType::Request, 2, 1);
            pdu.filter(&Value::Name(b"akd-1"));
            pdu.finish();
        });
        assert_eq!(lines, ["02:00:00:00:00:02: who is name akd-1?"]);
        let lines = notes(FrameId::DCP_IDENTIFY_RESPONSE, |out| {
            let suite = IpSuite {
                address: [10, 0, 0, 2].into(),
                mask: [255, 255, 255, 0].into(),
                gateway: [0, 0, 0, 0].into(),
            };
            let mut pdu = PduWriter::new(out, ServiceId::Identify, ServiceType::Success, 2, 0);
            pdu.info(BlockInfo::NONE, &Value::Name(b"akd-1"));
            pdu.info(BlockInfo::IP_SET, &Value::Ip(suite));
            pdu.info(
                BlockInfo::NONE,
                &Value::DeviceId {
                    vendor: 0x0105,
                    device: 1,
                },
            );
            pdu.info(BlockInfo::NONE, &Value::Role(1));
            pdu.finish();
        });
        assert_eq!(
            lines,
            ["akd-1: here: name akd-1, 10.0.0.2/24, vendor 0x0105 device 0x0001, IO device"]
        );
    }

    #[test]
    fn settings_and_their_end() {
        let lines = notes(FrameId::DCP_GET_SET, |out| {
            let mut pdu = PduWriter::new(out, ServiceId::Set, ServiceType::Request, 3, 0);
            pdu.set(Qualifier::PERMANENT, &Value::Name(b"akd-2"));
            pdu.set(Qualifier::TEMPORARY, &Value::FLASH);
            pdu.finish();
        });
        assert_eq!(lines, ["02:00:00:00:00:02: set name akd-2 (permanent), blink"]);
        let lines = notes(FrameId::DCP_GET_SET, |out| {
            let mut pdu = PduWriter::new(out, ServiceId::Set, ServiceType::Success, 3, 0);
            pdu.result(DcpOption::NAME, BlockError::InOperation);
            pdu.finish();
        });
        assert_eq!(
            lines,
            ["02:00:00:00:00:02: set 2/2 name of station: refused, in operation"]
        );
    }
}

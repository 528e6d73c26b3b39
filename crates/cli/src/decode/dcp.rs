//! Discovery and addressing in words.

use profinet::wire::DecodeError;
use profinet::wire::dcp::{BlockError, DcpOption, Pdu, ServiceId, ServiceType, Value, role};
use profinet::wire::ethernet::Frame;

use super::names::Names;
use super::{Sink, Weight};
use crate::render::table::clean;

pub fn pdu(frame: &Frame<'_>, names: &mut Names, sink: &mut Sink<'_>) -> Result<(), DecodeError> {
    let pdu = Pdu::parse(frame.payload)?;
    let topic = "DCP";
    match (pdu.service, pdu.kind) {
        (ServiceId::Identify, ServiceType::Request) => {
            let filters = list(pdu.blocks().map(|block| Ok(value(&block?.filter()?))))?;
            sink.note(Weight::Normal, topic, format!("who is {filters}?"));
        }
        (ServiceId::Get, ServiceType::Request) => {
            let wanted = list(pdu.requested().map(|option| Ok(option?.to_string())))?;
            sink.note(Weight::Normal, topic, format!("get {wanted}"));
        }
        (ServiceId::Set, ServiceType::Request) => {
            let settings = list(pdu.blocks().map(|block| {
                let block = block?;
                let (qualifier, set) = block.set()?;
                if let Value::Name(name) = set {
                    names.learn(Some(frame.destination), None, name);
                }
                Ok(match block.option {
                    DcpOption::SIGNAL => "blink".into(),
                    DcpOption::START | DcpOption::END => block.option.to_string(),
                    DcpOption::RESET_TO_FACTORY => {
                        format!("reset to factory, mode {}", qualifier.reset_mode())
                    }
                    DcpOption::FACTORY_RESET => "factory reset".into(),
                    _ => {
                        let kept = if qualifier.is_permanent() {
                            "permanent"
                        } else {
                            "temporary"
                        };
                        format!("{} ({kept})", value(&set))
                    }
                })
            }))?;
            sink.note(Weight::Normal, topic, format!("set {settings}"));
        }
        (ServiceId::Set, ServiceType::Success) => results(&pdu, sink)?,
        (_, ServiceType::Success) | (ServiceId::Hello, _) => {
            let (mut name, mut ip, mut identity) = (None, None, None);
            let answers = list(pdu.blocks().map(|block| {
                let block = block?;
                if block.option == DcpOption::RESPONSE {
                    let (option, error) = block.result()?;
                    return Ok(format!("{option}: {}", block_error(error)));
                }
                let (info, answer) = block.info()?;
                match answer {
                    Value::Name(text) => name = Some(text),
                    Value::Ip(suite) | Value::FullIp { suite, .. } => ip = Some(suite.address),
                    Value::DeviceId { vendor, device } => identity = Some((vendor, device)),
                    Value::Options(_) => return Ok(String::new()),
                    _ => {}
                }
                let conflict = if info.has_conflict() {
                    " (address conflict!)"
                } else {
                    ""
                };
                Ok(format!("{}{conflict}", value(&answer)))
            }))?;
            names.learn(Some(frame.source), ip, name.unwrap_or_default());
            if let (Some(ip), Some((vendor, device))) = (ip, identity) {
                names.drives.discovered(ip, vendor, device);
            }
            sink.from = names.mac(frame.source);
            let verb = match pdu.service {
                ServiceId::Hello => "hello",
                ServiceId::Identify => "here",
                _ => "answer",
            };
            sink.note(Weight::Normal, topic, format!("{verb}: {answers}"));
        }
        (service, ServiceType::NotSupported) => {
            sink.note(Weight::Error, topic, format!("{service:?} is not supported"));
        }
        (service, kind) => sink.note(
            Weight::Warning,
            topic,
            format!("unknown service {service:?}, type {kind:?}"),
        ),
    }
    Ok(())
}

fn results(pdu: &Pdu<'_>, sink: &mut Sink<'_>) -> Result<(), DecodeError> {
    for block in pdu.blocks() {
        let block = block?;
        if block.option == DcpOption::RESPONSE {
            let (option, error) = block.result()?;
            let weight = if error == BlockError::Ok {
                Weight::Normal
            } else {
                Weight::Error
            };
            sink.note(weight, "DCP", format!("set {option}: {}", block_error(error)));
        }
    }
    Ok(())
}

fn list(items: impl Iterator<Item = Result<String, DecodeError>>) -> Result<String, DecodeError> {
    let mut texts = items.collect::<Result<Vec<_>, _>>()?;
    texts.retain(|text| !text.is_empty());
    Ok(texts.join(", "))
}

/// A DCP value in words.
pub fn value(value: &Value<'_>) -> String {
    let text = |octets: &[u8]| clean(&String::from_utf8_lossy(octets));
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
    use profinet::wire::dcp::{BlockInfo, PduWriter, Qualifier};
    use profinet::wire::ethernet::{self, FrameId};
    use profinet::{IpSuite, MacAddress};
    use std::time::Duration;

    fn notes(frame_id: FrameId, build: impl FnOnce(&mut Vec<u8>)) -> Vec<String> {
        let mut payload = Vec::new();
        build(&mut payload);
        let mut buffer = [0; 1500];
        let (to, from) = (MacAddress([2, 0, 0, 0, 0, 1]), MacAddress([2, 0, 0, 0, 0, 2]));
        let length = ethernet::emit(&mut buffer, to, from, None, frame_id, &payload).unwrap();
        let mut walker = crate::decode::Walker::default();
        let notes = walker.frame(Duration::ZERO, &buffer[..length]);
        notes
            .into_iter()
            .map(|note| format!("{}: {}", note.from, note.text))
            .collect()
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

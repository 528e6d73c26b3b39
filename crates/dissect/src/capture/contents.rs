//! Records of a known layout, in words and in numbers.

use profinet::wire::alarm::DiagnosisItems;
use profinet::wire::block::{Block, BlockType, ModuleDiff};
use profinet::wire::record::{
    DiagnosisHeader, Identification, Im0, ImText, InterfaceReal, LogData, PortReal, RecordInput, decode_apis,
    decode_ar_list,
};
use profinet::wire::{DecodeError, Reader};
use serde_json::{Value, json};

use super::event::Diagnosis;
use super::{diagnosis, diff, records};
use crate::Weight;
use crate::hex_bytes;

/// What is in a record.
#[derive(Debug)]
pub struct Content {
    pub text: String,
    pub weight: Weight,
    pub fields: Value,
}

/// Returns the content of a record; `None` where its layout is not known here.
pub fn describe(index: u16, reader: Reader<'_>) -> Option<Content> {
    let data = reader.peek_rest();
    let decoded = match index {
        0xAFF0 => im0(reader),
        0xAFF1..=0xAFF4 => im_text(u8::try_from(index - 0xAFF0).unwrap_or(0), reader),
        _ if is_diagnosis(index) => diagnoses(reader),
        _ if data.is_empty() => return None,
        0x8000 | 0xC000 | 0xE000 => identification(BlockType::EXPECTED_IDENTIFICATION, reader),
        0x8001 | 0xC001 | 0xE001 | 0xF000 => identification(BlockType::REAL_IDENTIFICATION, reader),
        0xE002 => module_diff(reader),
        0x8028 => input(reader),
        0x802A | 0x8080 | 0xF831 | 0xF841 => ports(reader),
        0xF020 | 0xF820 => ar_list(reader),
        0xF821 => apis(reader),
        0xF830 => log(reader),
        0xF840 => filter(reader),
        _ => return None,
    };
    Some(decoded.unwrap_or_else(|error| Content {
        text: format!("malformed ({error}): {}", records::content(data)),
        weight: Weight::Warning,
        fields: json!({ "malformed": error.to_string() }),
    }))
}

/// Diagnosis and maintenance of a subslot, a slot, a connection, an API or the device.
const fn is_diagnosis(index: u16) -> bool {
    let scope = matches!(index & 0xFF00, 0x8000 | 0xC000 | 0xE000 | 0xF000);
    index == 0xF80C || (scope && matches!(index & 0xFF, 0x0A..=0x0C | 0x10..=0x13))
}

const fn normal(text: String, fields: Value) -> Content {
    Content {
        text,
        weight: Weight::Normal,
        fields,
    }
}

/// Text without the blanks and zeros that fill its field.
fn padded(octets: &[u8]) -> String {
    let text = String::from_utf8_lossy(octets);
    text.trim_end_matches(['\0', ' ']).to_owned()
}

fn im0(reader: Reader<'_>) -> Result<Content, DecodeError> {
    let im = Im0::decode(reader)?;
    let [functional, fix, internal] = im.software_revision;
    let prefix = char::from(im.software_prefix).to_string();
    let software = format!("{prefix}{functional}.{fix}.{internal}");
    let (order, serial) = (padded(&im.order_id), padded(&im.serial_number));
    let text = format!(
        "vendor 0x{:04X}, order number {order}, serial number {serial}, hardware {}, software {software}, \
         profile 0x{:04X}/0x{:04X}, I&M supported 0x{:04X}",
        im.vendor_id, im.hardware_revision, im.profile_id, im.profile_specific_type, im.supported
    );
    let fields = json!({
        "vendor": im.vendor_id, "order": order, "serial": serial, "hardware": im.hardware_revision,
        "software": software, "revision_counter": im.revision_counter, "profile": im.profile_id,
        "profile_type": im.profile_specific_type, "supported": im.supported,
    });
    Ok(normal(text, fields))
}

fn im_text(number: u8, reader: Reader<'_>) -> Result<Content, DecodeError> {
    let im = ImText::decode(reader, number)?;
    let (text, fields) = match number {
        1 => {
            let (function, location) = (padded(im.tag_function()), padded(im.tag_location()));
            (
                format!("function \"{function}\", location \"{location}\""),
                json!({ "function": function, "location": location }),
            )
        }
        4 => {
            let octets = im.body.iter().rposition(|octet| *octet != 0);
            let signature = hex_bytes(
                im.body
                    .get(..octets.map_or(0, |last| last + 1))
                    .unwrap_or_default(),
            );
            (
                format!("signature {signature}"),
                json!({ "signature": signature }),
            )
        }
        _ => {
            let name = if number == 2 { "date" } else { "descriptor" };
            let words = padded(im.body);
            (format!("{name} \"{words}\""), json!({ name: words }))
        }
    };
    Ok(normal(text, fields))
}

fn diagnoses(mut reader: Reader<'_>) -> Result<Content, DecodeError> {
    let (mut texts, mut rows, mut weight) = (Vec::new(), Vec::new(), Weight::Normal);
    while !reader.is_empty() {
        let (header, items) = DiagnosisHeader::decode(&mut reader)?;
        let place = records::place(header.api, header.slot, header.subslot);
        let mut found: Vec<Diagnosis> = Vec::new();
        for item in repeated(header.usi, items) {
            let item = diagnosis::item(&item?);
            texts.push(format!("{place} {}", item.text));
            weight = weight.max(item.weight);
            found.extend(item.numbers);
        }
        rows.push(json!({
            "api": header.api, "slot": header.slot, "subslot": header.subslot, "usi": header.usi, "diagnosis": found,
        }));
    }
    let text = if texts.is_empty() {
        "nothing pending".to_owned()
    } else {
        texts.join("; ")
    };
    Ok(Content {
        text,
        weight,
        fields: json!({ "places": rows }),
    })
}

/// Returns the items of a diagnosis block: the UserStructureIdentifier stands once, for all of them.
fn repeated(
    usi: u16,
    mut data: &[u8],
) -> impl Iterator<Item = Result<profinet::wire::alarm::DiagnosisItem<'_>, DecodeError>> {
    use profinet::wire::alarm::ChannelDiagnosis;
    let size = match usi {
        ChannelDiagnosis::USI => 6,
        ChannelDiagnosis::USI_EXTENDED => 12,
        ChannelDiagnosis::USI_QUALIFIED => 16,
        _ => usize::MAX,
    };
    std::iter::from_fn(move || {
        if data.is_empty() {
            return None;
        }
        let (item, rest) = data.split_at(size.min(data.len()));
        data = rest;
        DiagnosisItems::new(Some(usi), item).next()
    })
}

fn identification(block: BlockType, mut reader: Reader<'_>) -> Result<Content, DecodeError> {
    let found = Identification::decode(&mut reader, block)?;
    Ok(normal(plugged(&found), plugged_json(&found)))
}

fn plugged(found: &Identification) -> String {
    let modules = found.modules.iter().map(|module| {
        let submodules = module.submodules.iter();
        let submodules: Vec<String> = submodules
            .map(|submodule| format!("{} 0x{:X}", diff::subslot(submodule.subslot), submodule.ident))
            .collect();
        format!(
            "slot {}{} 0x{:08X} (subslot {})",
            module.slot,
            records::api_text(module.api),
            module.ident,
            submodules.join(", ")
        )
    });
    let modules: Vec<String> = modules.collect();
    if modules.is_empty() {
        "no modules".into()
    } else {
        modules.join("; ")
    }
}

fn plugged_json(found: &Identification) -> Value {
    let modules = found.modules.iter().map(|module| {
        let submodules = module.submodules.iter();
        let submodules: Vec<Value> = submodules
            .map(|submodule| json!({ "subslot": submodule.subslot, "ident": submodule.ident }))
            .collect();
        json!({ "api": module.api, "slot": module.slot, "ident": module.ident, "submodules": submodules })
    });
    json!({ "modules": modules.collect::<Vec<_>>() })
}

fn module_diff(mut reader: Reader<'_>) -> Result<Content, DecodeError> {
    let body = Block::expect(&mut reader, BlockType::MODULE_DIFF)?;
    let lines = diff::lines(&ModuleDiff::decode(body)?);
    let weight = lines.iter().map(|line| line.0).max().unwrap_or(Weight::Normal);
    let texts: Vec<&str> = lines.iter().map(|line| line.1.as_str()).collect();
    let text = if texts.is_empty() {
        "nothing differs".to_owned()
    } else {
        texts.join("; ")
    };
    let fields = json!({ "modules": lines.iter().map(|line| json!(line.2)).collect::<Vec<_>>() });
    Ok(Content { text, weight, fields })
}

fn input(reader: Reader<'_>) -> Result<Content, DecodeError> {
    let found = RecordInput::decode(reader)?;
    let text = format!(
        "IOPS 0x{:02X}, IOCS 0x{:02X}, {}",
        found.iops,
        found.iocs,
        records::content(found.data)
    );
    let fields = json!({ "iops": found.iops, "iocs": found.iocs, "hex": hex_bytes(found.data) });
    Ok(normal(text, fields))
}

/// Blocks of ports and interface, alone or each in a MultipleBlockHeader.
fn ports(mut reader: Reader<'_>) -> Result<Content, DecodeError> {
    let (mut texts, mut rows) = (Vec::new(), Vec::new());
    while !reader.is_empty() {
        let here = reader;
        let block = Block::decode(&mut reader)?;
        if block.block_type == BlockType::MULTIPLE_BLOCK {
            let mut inner = block.body;
            inner.skip(2 + 4 + 2 + 2, "MultipleBlockHeader")?;
            while !inner.is_empty() {
                let here = inner;
                let block = Block::decode(&mut inner)?;
                port_block(here, &block, &mut texts, &mut rows)?;
            }
        } else {
            port_block(here, &block, &mut texts, &mut rows)?;
        }
    }
    Ok(normal(texts.join("; "), json!({ "blocks": rows })))
}

fn port_block(
    here: Reader<'_>,
    block: &Block<'_>,
    texts: &mut Vec<String>,
    rows: &mut Vec<Value>,
) -> Result<(), DecodeError> {
    match block.block_type {
        BlockType::PD_INTERFACE_REAL => {
            let found = InterfaceReal::decode(here)?;
            let name = padded(found.name);
            let prefix = u32::from(found.ip.mask).leading_ones();
            texts.push(format!(
                "interface {name}, {}, {}/{prefix}",
                found.mac, found.ip.address
            ));
            rows.push(json!({
                "block": "interface", "name": name, "mac": found.mac.to_string(), "ip": found.ip.address,
                "prefix": prefix, "gateway": found.ip.gateway,
            }));
        }
        BlockType::PD_PORT_REAL => {
            let found = PortReal::decode(here)?;
            let name = padded(found.name);
            let link = if found.link_up { "up" } else { "down" };
            let mau = match found.mau_type {
                16 => "100 Mbit/s full duplex".to_owned(),
                30 => "1 Gbit/s full duplex".to_owned(),
                other => format!("MAU type {other}"),
            };
            let mut text = format!("{name} link {link}, {mau}");
            let mut peers = Vec::new();
            for peer in &found.peers {
                let (port, station) = (padded(peer.port), padded(peer.station));
                text = format!("{text}, neighbour {port} of {station} ({})", peer.mac);
                peers.push(json!({
                    "port": port, "station": station, "mac": peer.mac.to_string(), "line_delay": peer.line_delay,
                }));
            }
            texts.push(text);
            rows.push(json!({
                "block": "port", "slot": found.slot, "subslot": found.subslot, "name": name, "link_up": found.link_up,
                "mau_type": found.mau_type, "peers": peers,
            }));
        }
        BlockType::PD_PORT_STATISTIC => {
            let mut body = block.body;
            body.skip(2, "padding")?;
            let mut next = || body.u32("PDPortStatistic");
            let row = [next()?, next()?, next()?, next()?, next()?, next()?];
            let [
                octets_in,
                octets_out,
                discards_in,
                discards_out,
                errors_in,
                errors_out,
            ] = row;
            texts.push(format!(
                "{octets_in} octets in, {octets_out} out, {discards_in} and {discards_out} discarded, {errors_in} and \
                 {errors_out} errors"
            ));
            rows.push(json!({
                "block": "statistic", "octets_in": octets_in, "octets_out": octets_out, "discards_in": discards_in,
                "discards_out": discards_out, "errors_in": errors_in, "errors_out": errors_out,
            }));
        }
        other => {
            let name = other
                .name()
                .map_or_else(|| format!("block 0x{:04X}", other.0), str::to_owned);
            texts.push(name.clone());
            rows.push(json!({ "block": name }));
        }
    }
    Ok(())
}

fn ar_list(mut reader: Reader<'_>) -> Result<Content, DecodeError> {
    let Some(found) = decode_ar_list(&mut reader)? else {
        let text = "connections in another version of the record".to_owned();
        return Ok(normal(text, json!({ "connections": null })));
    };
    let texts: Vec<String> = found
        .iter()
        .map(|ar| format!("AR type {} of {}", ar.ar_type, padded(ar.station_name)))
        .collect();
    let text = if texts.is_empty() {
        "no connection".to_owned()
    } else {
        texts.join(", ")
    };
    let rows: Vec<Value> = found
        .iter()
        .map(|ar| json!({ "ar_type": ar.ar_type, "name": padded(ar.station_name) }))
        .collect();
    Ok(normal(text, json!({ "connections": rows })))
}

fn apis(reader: Reader<'_>) -> Result<Content, DecodeError> {
    let found = decode_apis(reader)?;
    let texts: Vec<String> = found.iter().map(|api| format!("0x{api:04X}")).collect();
    Ok(normal(
        format!("APIs {}", texts.join(", ")),
        json!({ "apis": found }),
    ))
}

fn log(reader: Reader<'_>) -> Result<Content, DecodeError> {
    let found = LogData::decode(reader)?;
    let rows: Vec<Value> = found
        .entries
        .iter()
        .map(|entry| {
            json!({
                "time": entry.time, "ar_uuid": entry.ar_uuid.to_string(),
                "status": records::number(entry.status), "detail": entry.detail,
            })
        })
        .collect();
    let latest = found
        .entries
        .last()
        .map_or_else(String::new, |entry| format!(", latest: {}", entry.status));
    let text = format!("{} entries{latest}", found.entries.len());
    Ok(normal(text, json!({ "time": found.time, "entries": rows })))
}

fn filter(mut reader: Reader<'_>) -> Result<Content, DecodeError> {
    let (mut texts, mut rows) = (Vec::new(), Vec::new());
    while !reader.is_empty() {
        let block = Block::decode(&mut { reader })?.block_type;
        let found = Identification::decode(&mut reader, block)?;
        let what = match block {
            BlockType::IM0_FILTER_SUBMODULE => "I&M0 of submodules",
            BlockType::IM0_FILTER_DEVICE => "of the device",
            _ => "of modules",
        };
        texts.push(format!("{what}: {}", plugged(&found)));
        rows.push(json!({ "block": block.0, "plugged": plugged_json(&found) }));
    }
    Ok(normal(texts.join("; "), json!({ "blocks": rows })))
}

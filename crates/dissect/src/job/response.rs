//! What a response answers, and what it tells about the drive.

use profile::parameter::{Attribute, CodeSpace, ErrorNumber, Format, ParameterAddress, Request, ValueBlock};
use serde_json::{Map, Value, json};

use super::{
    ADDRESS, Decoded, HEADER, JobDrive, address_json, block_json, block_text, plural, prefix, raw_text,
};
use crate::Weight;
use crate::fields;

/// What a response says, with the request it answers where that is known; what it tells of the drive is taken over.
pub fn decode_response(drive: &mut JobDrive, data: &[u8], request: Option<&[u8]>) -> Result<Decoded, String> {
    let &[reference, id, axis, count, ref rest @ ..] = data else {
        return Err(format!("{} octets are no header", data.len()));
    };
    let job = request
        .map(|bytes| Request::parse(bytes, drive.code_space()))
        .transpose()
        .map_err(|error| error.to_string())?;
    let mut warnings = Vec::new();
    if let Some(job) = &job {
        if job.reference() != reference {
            warnings.push(format!("answers request {reference}, not {}", job.reference()));
        }
        if !job.id().is_answered_by(id) && !job.id().is_refused_by(id) {
            warnings.push("answers another kind of request".to_owned());
        }
    }
    let mut addresses: Vec<Option<ParameterAddress>> = match &job {
        Some(job) => job.addresses().map(Some).collect(),
        None => vec![None; count.into()],
    };
    addresses.resize(count.into(), None);
    let kind = match id {
        0x01 => "read response",
        0x02 => "change response",
        0x81 => "read response with refusals",
        0x82 => "change response with refusals",
        0x80 => "refusal of the request",
        _ => "response of an unknown kind",
    };
    let head = format!(
        "{kind} {reference}, axis {axis}, {}",
        plural(count.into(), "parameter")
    );
    let mut lines = vec![(Weight::Normal, head)];
    let mut parameters = Vec::new();
    if id == 0x02 && matches!(rest, [] | [0, 0]) {
        if let Some(job) = job.as_ref().filter(|_| warnings.is_empty()) {
            learn_written(drive, job, |_| true);
        }
        for address in &addresses {
            lines.push((
                Weight::Normal,
                format!("  {}written", prefix(drive, *address, ": ")),
            ));
            let mut fields = address
                .map(|address| address_json(drive, address))
                .unwrap_or_default();
            fields.insert("written".into(), true.into());
            parameters.push(Value::Object(fields));
        }
    } else {
        let blocks = blocks(data, &mut addresses, drive.code_space())?;
        // all of it is of one moment: what it tells about scales counts for its own values too
        if warnings.is_empty() {
            match &job {
                Some(job) if id & 0x7F == 0x02 => {
                    let written =
                        |at: usize| blocks.get(at).is_some_and(|block| block.format == Format::ZERO);
                    learn_written(drive, job, written);
                }
                _ => learn_read(drive, &addresses, &blocks),
            }
        }
        for (address, block) in addresses.iter().zip(&blocks) {
            let mut fields = address
                .map(|address| address_json(drive, address))
                .unwrap_or_default();
            lines.push(answer(drive, *address, block, &mut fields));
            parameters.push(Value::Object(fields));
        }
    }
    for warning in &warnings {
        lines.push((Weight::Warning, format!("  ! {warning}")));
    }
    let fields = fields! {
        "side": "response", "reference": reference, "id": id, "axis": axis, "parameters": parameters,
        "warnings": warnings,
    };
    Ok(Decoded { lines, fields })
}

/// What was written counts once the drive says so.
fn learn_written(drive: &mut JobDrive, job: &Request<'_>, written: impl Fn(usize) -> bool) {
    if !job.id().is_change() {
        return;
    }
    for (at, (address, block)) in job.addresses().zip(job.values()).enumerate() {
        if let Ok(block) = block
            && written(at)
            && address.attribute == Attribute::Value
        {
            drive.learn(address, &block);
        }
    }
}

fn learn_read(drive: &mut JobDrive, addresses: &[Option<ParameterAddress>], blocks: &[ValueBlock<'_>]) {
    for (address, block) in addresses.iter().zip(blocks) {
        if let Some(address) = address
            && address.attribute == Attribute::Value
            && !matches!(block.format, Format::ERROR | Format::ZERO)
        {
            drive.learn(*address, block);
        }
    }
}

/// The blocks of a response; some drives repeat the addresses in front of them, which names them.
fn blocks<'a>(
    data: &'a [u8],
    addresses: &mut [Option<ParameterAddress>],
    space: CodeSpace,
) -> Result<Vec<ValueBlock<'a>>, String> {
    let walk = |mut offset: usize| {
        let mut blocks = Vec::new();
        for _ in 0..addresses.len() {
            let (block, used) = ValueBlock::parse(data, offset, space).map_err(|error| error.to_string())?;
            offset += used;
            blocks.push(block);
        }
        if offset < data.len() {
            return Err(format!(
                "{} octets are left over at octet {offset}",
                data.len() - offset
            ));
        }
        Ok(blocks)
    };
    let plain = walk(HEADER);
    if plain.is_ok() {
        return plain;
    }
    let Ok(repeated) = walk(HEADER + ADDRESS * addresses.len()) else {
        return plain;
    };
    for (address, octets) in addresses
        .iter_mut()
        .zip(data.get(HEADER..).unwrap_or_default().chunks_exact(ADDRESS))
    {
        if let Ok(octets) = octets.try_into() {
            *address = Some(ParameterAddress::from_octets(octets));
        }
    }
    Ok(repeated)
}

fn answer(
    drive: &JobDrive,
    address: Option<ParameterAddress>,
    block: &ValueBlock<'_>,
    fields: &mut Map<String, Value>,
) -> (Weight, String) {
    let said = prefix(drive, address, ": ");
    match block.format {
        Format::ERROR => {
            let number = ErrorNumber(
                block
                    .raw(0)
                    .and_then(|raw| u16::try_from(raw).ok())
                    .unwrap_or(u16::MAX),
            );
            let information = block.raw(1);
            let mut text = format!("  {said}refused: {}", number.words(drive.error_names()));
            if let Some(information) = information {
                text = format!("{text}, information {information}");
            }
            if let Some(info) = number.info(drive.error_names()) {
                text = format!("{text}; {}", info.remedy);
            }
            fields.insert(
                "error".into(),
                json!({
                    "number": number.0, "meaning": number.words(drive.error_names()), "information": information,
                }),
            );
            (Weight::Error, text)
        }
        Format::ZERO => {
            fields.insert("written".into(), true.into());
            (Weight::Normal, format!("  {said}written"))
        }
        _ => {
            fields.extend(block_json(drive, address, block));
            let text = format!(
                "  {}{}   [{}]",
                prefix(drive, address, " = "),
                block_text(drive, address, block),
                raw_text(drive, block)
            );
            (Weight::Normal, text)
        }
    }
}

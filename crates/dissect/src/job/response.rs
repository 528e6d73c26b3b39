//! Decodes a response: the request it answers, and the values it contains.

use profile::parameter::{
    Attribute, DecodeError, ErrorNumber, Forbidden, Format, ParameterAddress, Request, RequestId, ValueBlock,
    repeats_addresses,
};
use profile::value::Interpretation;
use serde_json::{Map, Value, json};

use super::{
    ADDRESS, Decoded, HEADER, JobDrive, RefusedParameter, address_json, block_json, block_text, format_name,
    label, plural, prefix, raw_text,
};
use crate::Weight;
use crate::fields;

/// Octet of the number of parameters in a header.
const COUNT: usize = 3;

/// Decodes a response, with the request it answers where that is known, and learns the values of the drive.
pub fn decode_response(drive: &mut JobDrive, data: &[u8], request: Option<&[u8]>) -> Result<Decoded, String> {
    let &[reference, id, axis, count, ref rest @ ..] = data else {
        return Err(format!("{} octets are not a header", data.len()));
    };
    let job = request.and_then(|bytes| Request::parse(bytes, drive.code_space()).ok());
    let mut warnings = header_problems(drive, [reference, id, axis, count]);
    if let Some(request) = request {
        warnings.extend(mismatches(request, reference, id, axis)?);
    }
    let requested: Vec<ParameterAddress> = job.iter().flat_map(Request::addresses).collect();
    let mut addresses: Vec<Option<ParameterAddress>> = requested.iter().copied().map(Some).collect();
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
    let mut refused = Vec::new();
    let asked = request.and_then(|request| request.get(COUNT)).copied();
    let is_change = RequestId::from_octet(id & 0x7F).is_change();
    if id == 0x02 && matches!(rest, [] | [0, 0]) {
        warnings.extend(count_mismatch(asked, count));
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
        let (blocks, behind) = blocks(drive, data, &mut addresses)?;
        let whole_refusal = matches!(blocks.as_slice(), [one] if one.format == Format::ERROR);
        if !whole_refusal {
            warnings.extend(count_mismatch(asked, count));
        }
        for (found, asked) in addresses.iter().flatten().zip(&requested) {
            if found != asked {
                let (found, asked) = (label(drive, *found), label(drive, *asked));
                warnings.push(format!("answers {found}, requested was {asked}"));
            }
        }
        if !is_change {
            let wide = job.as_ref().is_some_and(|job| job.id() == RequestId::ReadWide);
            let answered = addresses.iter().zip(&blocks);
            warnings.extend(
                answered.filter_map(|(address, block)| block_problem(drive, (*address)?, block, wide)),
            );
        }
        // all values are from one moment: scalings in them apply to the other values too
        if warnings.is_empty() {
            match &job {
                Some(job) if is_change => {
                    let written = |at: usize| blocks.get(at).is_some_and(is_written);
                    learn_written(drive, job, written);
                }
                _ => learn_read(drive, &addresses, &blocks),
            }
        }
        for (address, block) in addresses.iter().zip(&blocks) {
            let mut fields = address
                .map(|address| address_json(drive, address))
                .unwrap_or_default();
            if let (Some(address), Some(error)) = (address, error_number(block)) {
                let pnu = address.pnu;
                refused.push((lines.len(), RefusedParameter { pnu, error }));
            }
            lines.push(answer(drive, *address, block, is_change, &mut fields));
            parameters.push(Value::Object(fields));
        }
        if behind > 0 {
            warnings.push(format!("{behind} zero octets behind the last value"));
        }
    }
    for warning in &warnings {
        lines.push((Weight::Warning, format!("  ! {warning}")));
    }
    let fields = fields! {
        "side": "response", "reference": reference, "id": id, "axis": axis, "parameters": parameters,
        "warnings": warnings,
    };
    Ok(Decoded {
        lines,
        fields,
        refused,
    })
}

/// Returns the error number of a refusal; the highest one for a refusal without one.
fn error_number(block: &ValueBlock<'_>) -> Option<ErrorNumber> {
    let number = || block.raw(0).and_then(|raw| u16::try_from(raw).ok());
    (block.format == Format::ERROR).then(|| ErrorNumber(number().unwrap_or(u16::MAX)))
}

/// A written value takes effect when the drive confirms it.
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

/// A block without data: the parameter was changed.
fn is_written(block: &ValueBlock<'_>) -> bool {
    matches!(block.format, Format::ZERO | Format::RESERVED) && block.count == 0
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

/// What no response of this drive has in its header. A refusal mirrors what was wrong with its request.
fn header_problems(drive: &JobDrive, [reference, id, axis, count]: [u8; HEADER]) -> Vec<String> {
    let dialect = drive.dialect();
    if id & 0x80 != 0 {
        return Vec::new();
    }
    let (found, allowed) = (axis, dialect.axis);
    let problems = [
        (reference == 0, Forbidden::Reference),
        (
            dialect.axis_checked && found != allowed,
            Forbidden::Axis { found, allowed },
        ),
        (
            !(1..=dialect.max_parameters).contains(&count),
            Forbidden::Parameters {
                found: count,
                allowed: dialect.max_parameters,
            },
        ),
    ];
    let problems = problems.into_iter().filter(|(applies, _)| *applies);
    problems.map(|(_, problem)| problem.to_string()).collect()
}

/// Returns the places where a response does not answer this request. A request that is cut off or has too many
/// parameters is answered too.
fn mismatches(request: &[u8], reference: u8, id: u8, axis: u8) -> Result<Vec<String>, String> {
    let &[asked, asked_id, asked_axis, _] = request
        .first_chunk::<HEADER>()
        .ok_or_else(|| format!("its request has {} octets, a header has {HEADER}", request.len()))?;
    let asked_id = RequestId::from_octet(asked_id);
    let mut warnings = Vec::new();
    if asked != reference {
        warnings.push(format!("answers request {reference}, not {asked}"));
    }
    if !asked_id.is_answered_by(id) && !asked_id.is_refused_by(id) {
        warnings.push("answers another kind of request".to_owned());
    }
    if asked_axis != axis {
        warnings.push(format!("answers axis {axis}, requested was axis {asked_axis}"));
    }
    Ok(warnings)
}

/// Another number of parameters than the request has.
fn count_mismatch(asked: Option<u8>, found: u8) -> Option<String> {
    let asked = asked.filter(|asked| *asked != found)?;
    let answered = plural(found.into(), "parameter");
    Some(format!("answers {answered}, requested were {asked}"))
}

/// A value that this parameter of this drive does not have.
fn block_problem(
    drive: &JobDrive,
    address: ParameterAddress,
    block: &ValueBlock<'_>,
    wide: bool,
) -> Option<String> {
    let no_value = matches!(block.format, Format::ERROR | Format::ZERO | Format::RESERVED);
    let interpretation = Interpretation::of(block.format, drive.code_space());
    if no_value
        || address.attribute != Attribute::Value
        || matches!(interpretation, Interpretation::Text | Interpretation::Octets)
    {
        return None;
    }
    let of = label(drive, address);
    let elements = address.elements.max(1);
    if block.count != elements {
        return Some(format!(
            "{of}: {} answered, requested were {elements}",
            plural(block.count.into(), "value")
        ));
    }
    let format = format_name(drive, block.format);
    if drive.dialect().substitution_only && Format::for_octets(block.width()) != Some(block.format) {
        return Some(format!(
            "{of}: {format}, this drive answers Byte, Word and Double word only"
        ));
    }
    let row = drive
        .select(address)
        .parameter
        .filter(|row| row.length == 0 && !wide)?;
    let octets = row.size.octets();
    (block.width() != octets)
        .then(|| format!("{of}: {format}, the parameter has {}", plural(octets, "octet")))
}

/// Returns the blocks of a response, and the number of zeros behind them. Without a request the addresses that a drive
/// repeats in front of the blocks name them.
pub(super) fn blocks<'a>(
    drive: &JobDrive,
    data: &'a [u8],
    addresses: &mut Vec<Option<ParameterAddress>>,
) -> Result<(Vec<ValueBlock<'a>>, usize), String> {
    let walk = |mut offset: usize| {
        let mut blocks = Vec::new();
        for _ in 0..addresses.len() {
            let (block, used) = ValueBlock::parse(data, offset, drive.code_space())?;
            offset += used;
            blocks.push(block);
        }
        Ok((blocks, offset))
    };
    let plain = walk(HEADER).map_err(|error: DecodeError| error.to_string());
    if let Ok((blocks, end)) = &plain
        && *end == data.len()
    {
        return Ok((blocks.clone(), 0));
    }
    // those of the request, or others, which then answer another parameter
    let requested: Option<Vec<_>> = addresses.iter().copied().collect();
    let requested = requested.filter(|requested| repeats_addresses(data, requested));
    let repeated = requested.or_else(|| addresses_in(drive, data, addresses.len()));
    if let Some(repeated) = repeated
        && let Ok((blocks, end)) = walk(HEADER + ADDRESS * repeated.len())
        && end == data.len()
    {
        *addresses = repeated.into_iter().map(Some).collect();
        return Ok((blocks, 0));
    }
    let (blocks, end) = plain?;
    let behind = data.get(end..).unwrap_or_default();
    if behind.iter().any(|octet| *octet != 0) {
        return Err(format!("{} octets are left over at octet {end}", behind.len()));
    }
    Ok((blocks, behind.len()))
}

/// Returns the octets behind the header as addresses, where the drive can repeat them and their attributes exist.
fn addresses_in(drive: &JobDrive, data: &[u8], count: usize) -> Option<Vec<ParameterAddress>> {
    let (octets, _) = data.get(HEADER..)?.as_chunks();
    let address = |octets: &[u8; ADDRESS]| {
        let address = ParameterAddress::from_octets(*octets);
        (!matches!(address.attribute, Attribute::Other(_))).then_some(address)
    };
    let found = octets.get(..count)?.iter().map(address).collect();
    drive.dialect().repeats_addresses.then_some(found)?
}

pub(super) fn answer(
    drive: &JobDrive,
    address: Option<ParameterAddress>,
    block: &ValueBlock<'_>,
    is_change: bool,
    fields: &mut Map<String, Value>,
) -> (Weight, String) {
    let said = prefix(drive, address, ": ");
    match error_number(block) {
        Some(number) => {
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
        _ if block.format == Format::ZERO || (is_change && is_written(block)) => {
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

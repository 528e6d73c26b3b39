//! Parameter jobs in words: what a request asks, what a response answers.

use drive_client::parameter::{Interpretation, Parameters, Reading, Selection};
use profidrive::catalogue::{AKD, Scaling};
use profidrive::notation::{Elements, ParameterReference, Target};
use profidrive::parameter::{
    Attribute, CodeSpace, Description, ErrorNames, ErrorNumber, Format, ParameterAddress, Request, RequestId,
    ValueBlock,
};
use serde_json::{Map, Value, json};

use crate::args::Side;
use crate::decode::Weight;
use crate::failure::{Exit, Failure};
use crate::fields;
use crate::render::{hex_bytes, hex16, value, words};

/// Values and names are shown as an AKD means them: its tables are the only ones there are.
const TABLES: Parameters = Parameters {
    catalogue: Some(&AKD),
    scaling: Scaling {
        velocity: 1638,
        acceleration: 763,
        position: 1000,
        peak_current: 9.0,
        singleturn_bits: 16,
    },
};
/// Control and status word as parameters.
const STW1: u16 = 1;
const ZSW1: u16 = 2;
/// Octets in front of the addresses or blocks.
const HEADER: usize = 4;
/// Octets of an address.
const ADDRESS: usize = 6;

/// A job in words and for programs.
#[derive(Debug)]
pub struct Decoded {
    /// In words; the first line says what it is.
    pub lines: Vec<(Weight, String)>,
    /// For programs.
    pub fields: Map<String, Value>,
}

/// Decodes one job; guesses its direction when `side` is not given.
pub fn decode(data: &[u8], side: Option<Side>, request: Option<&[u8]>) -> Result<Decoded, Failure> {
    let side = side.unwrap_or_else(|| {
        if request.is_some() {
            Side::Response
        } else {
            guess(data)
        }
    });
    match side {
        Side::Request => decode_request(data),
        Side::Response => decode_response(data, request),
    }
    .map_err(|reason| {
        let what = if side == Side::Request {
            "request"
        } else {
            "response"
        };
        Failure::new(Exit::Failed, format!("this is no parameter {what}: {reason}"))
            .hint("--as request or --as response says which side it is from")
    })
}

/// Request or response? A response never carries addresses, a read request nothing else.
fn guess(data: &[u8]) -> Side {
    let id = data.get(1).copied().unwrap_or(0);
    let addresses = HEADER + ADDRESS * usize::from(data.get(3).copied().unwrap_or(0));
    match id {
        1 if data.len() == addresses => Side::Request,
        // the head alone, padded or not: a change that was carried out
        2 if matches!(data.get(HEADER..), Some([] | [0, 0])) => Side::Response,
        2 if data.len() > HEADER + 2
            && Request::parse(data, CodeSpace::V4).is_ok_and(|job| values_fit(&job)) =>
        {
            Side::Request
        }
        // too short for its addresses and no value block: a request that was cut off
        1 | 2 if data.len() < addresses && !looks_like_values(data) => Side::Request,
        3..0x80 => Side::Request,
        _ => Side::Response,
    }
}

/// True where a response would have its first format code: no attribute is one.
fn looks_like_values(data: &[u8]) -> bool {
    !matches!(data.get(HEADER), None | Some(0x10 | 0x20 | 0x30))
}

fn values_fit(job: &Request<'_>) -> bool {
    job.values().all(|block| block.is_ok())
}

/// The selection an address means.
fn select(address: ParameterAddress) -> Selection {
    let known = AKD
        .by_pnu(address.pnu)
        .is_some_and(|parameter| parameter.elements > 1);
    let elements = (known || address.subindex > 0 || address.elements > 1).then(|| Elements {
        first: address.subindex,
        count: u16::from(address.elements.max(1)),
    });
    let reference = ParameterReference {
        target: Target::Number(address.pnu),
        elements,
        prefix: None,
    };
    let plain = Selection {
        pnu: address.pnu,
        first: address.subindex,
        count: u16::from(address.elements.max(1)),
        indexed: elements.is_some(),
        parameter: AKD.by_pnu(address.pnu),
    };
    TABLES.select(&reference).unwrap_or(plain)
}

fn label(address: ParameterAddress) -> String {
    let text = select(address).label();
    match address.attribute {
        Attribute::Value => text,
        Attribute::Description => format!("description of {text}"),
        Attribute::Text => format!("texts of {text}"),
        Attribute::Other(code) => format!("attribute 0x{code:02X} of {text}"),
    }
}

fn address_json(address: ParameterAddress) -> Map<String, Value> {
    fields! {
        "pnu": address.pnu, "index": address.subindex, "elements": address.elements,
        "attribute": address.attribute.octet(), "name": AKD.by_pnu(address.pnu).map(|parameter| parameter.name),
    }
}

fn format_name(format: Format) -> String {
    format
        .info(CodeSpace::V4)
        .map_or_else(|| format!("format 0x{:02X}", format.0), |row| row.name.to_owned())
}

/// The values of a block as readings.
fn readings(address: Option<ParameterAddress>, block: &ValueBlock<'_>) -> Vec<Reading> {
    let selection = address.map_or(
        Selection {
            pnu: 0,
            first: 0,
            count: 1,
            indexed: false,
            parameter: None,
        },
        select,
    );
    let interpretation = Interpretation::of(block.format, CodeSpace::V4);
    if matches!(interpretation, Interpretation::Text | Interpretation::Octets) {
        return vec![TABLES.reading(&selection, 0, block.format.0, interpretation, block.data)];
    }
    (0..block.count)
        .filter_map(|at| {
            let octets = block.octets(at.into())?;
            Some(TABLES.reading(&selection, at.into(), block.format.0, interpretation, octets))
        })
        .collect()
}

fn block_text(address: Option<ParameterAddress>, block: &ValueBlock<'_>) -> String {
    if address.is_some_and(|address| address.attribute == Attribute::Description)
        && let Some(description) = Description::decode(block.data)
    {
        return format!("\"{}\"", description.name().collect::<String>().trim_end());
    }
    let readings = readings(address, block);
    let texts: Vec<String> = match readings.as_slice() {
        [one] if matches!(one.pnu, STW1 | ZSW1) => vec![state_word(one)],
        [one] => vec![value::full(one)],
        many => many.iter().map(value::value).collect(),
    };
    let unit = readings
        .first()
        .filter(|_| readings.len() > 1)
        .map_or("", |reading| reading.unit);
    format!("{} {unit}", texts.join(", ")).trim_end().to_owned()
}

/// The two words as an engineer reads them.
fn state_word(reading: &Reading) -> String {
    let word = reading
        .raw()
        .and_then(|raw| u16::try_from(raw & 0xFFFF).ok())
        .unwrap_or(0);
    let meaning = if reading.pnu == STW1 {
        words::stw1_meaning(word).to_owned()
    } else {
        words::state(word, None)
    };
    format!("{} {meaning}", hex16(word))
}

fn block_json(address: Option<ParameterAddress>, block: &ValueBlock<'_>) -> Map<String, Value> {
    let values: Vec<Value> = readings(address, block).iter().map(value::json).collect();
    fields! {
        "format": block.format.0, "format_name": format_name(block.format), "count": block.count,
        "hex": hex_bytes(block.data), "values": values,
    }
}

fn raw_text(block: &ValueBlock<'_>) -> String {
    const SHOWN: usize = 16;
    let (start, more) = block
        .data
        .split_at_checked(SHOWN)
        .map_or((block.data, ""), |(start, rest)| {
            (start, if rest.is_empty() { "" } else { " .." })
        });
    format!("{} {}{more}", format_name(block.format), hex_bytes(start))
}

const fn verb(id: RequestId) -> &'static str {
    match id {
        RequestId::Read => "read request",
        RequestId::Change => "change request",
        RequestId::Other(_) => "request of an unknown kind",
    }
}

fn decode_request(data: &[u8]) -> Result<Decoded, String> {
    let job = Request::parse(data, CodeSpace::V4).map_err(|error| error.to_string())?;
    let head = format!(
        "{} {}, axis {}, {}",
        verb(job.id()),
        job.reference(),
        job.axis(),
        plural(job.parameters().into(), "parameter")
    );
    let mut lines = vec![(Weight::Normal, head)];
    let mut parameters = Vec::new();
    let mut values = job.values();
    for address in job.addresses() {
        let mut fields = address_json(address);
        let mut text = label(address);
        if job.id() == RequestId::Change {
            match values.next() {
                Some(Ok(block)) => {
                    text = format!(
                        "{text} = {}   [{}]",
                        block_text(Some(address), &block),
                        raw_text(&block)
                    );
                    fields.extend(block_json(Some(address), &block));
                }
                Some(Err(error)) => return Err(error.to_string()),
                None => text.push_str(" = (no value)"),
            }
        }
        lines.push((Weight::Normal, format!("  {text}")));
        parameters.push(Value::Object(fields));
    }
    let fields = fields! {
        "side": "request", "reference": job.reference(), "id": job.id().octet(), "axis": job.axis(),
        "parameters": parameters,
    };
    Ok(Decoded { lines, fields })
}

fn decode_response(data: &[u8], request: Option<&[u8]>) -> Result<Decoded, String> {
    let &[reference, id, axis, count, ref rest @ ..] = data else {
        return Err(format!("{} octets are no header", data.len()));
    };
    let job = request
        .map(|bytes| Request::parse(bytes, CodeSpace::V4))
        .transpose()
        .map_err(|error| error.to_string())?;
    let mut warnings = Vec::new();
    if let Some(job) = &job {
        if job.reference() != reference {
            warnings.push(format!("answers request {reference}, not {}", job.reference()));
        }
        if job.id().octet() != id & 0x7F {
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
        _ => "response of an unknown kind",
    };
    let head = format!(
        "{kind} {reference}, axis {axis}, {}",
        plural(count.into(), "parameter")
    );
    let mut lines = vec![(Weight::Normal, head)];
    let mut parameters = Vec::new();
    if id == 0x02 && matches!(rest, [] | [0, 0]) {
        for address in &addresses {
            lines.push((Weight::Normal, format!("  {}written", prefix(*address, ": "))));
            let mut fields = address.map(address_json).unwrap_or_default();
            fields.insert("written".into(), true.into());
            parameters.push(Value::Object(fields));
        }
    } else {
        let blocks = blocks(data, &mut addresses)?;
        for (address, block) in addresses.iter().zip(&blocks) {
            let mut fields = address.map(address_json).unwrap_or_default();
            lines.push(answer(*address, block, &mut fields));
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

/// The blocks of a response; some drives repeat the addresses in front of them, which names them.
fn blocks<'a>(
    data: &'a [u8],
    addresses: &mut [Option<ParameterAddress>],
) -> Result<Vec<ValueBlock<'a>>, String> {
    let walk = |mut offset: usize| {
        let mut blocks = Vec::new();
        for _ in 0..addresses.len() {
            let (block, used) =
                ValueBlock::parse(data, offset, CodeSpace::V4).map_err(|error| error.to_string())?;
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
    address: Option<ParameterAddress>,
    block: &ValueBlock<'_>,
    fields: &mut Map<String, Value>,
) -> (Weight, String) {
    let said = prefix(address, ": ");
    match block.format {
        Format::ERROR => {
            let number = ErrorNumber(
                block
                    .raw(0)
                    .and_then(|raw| u16::try_from(raw).ok())
                    .unwrap_or(u16::MAX),
            );
            let information = block.raw(1);
            let mut text = format!("  {said}refused: {number}");
            if let Some(information) = information {
                text = format!("{text}, information {information}");
            }
            if let Some(info) = number.info(ErrorNames::Profile) {
                text = format!("{text}; {}", info.remedy);
            }
            fields.insert(
                "error".into(),
                json!({
                    "number": number.0, "meaning": number.to_string(), "information": information,
                }),
            );
            (Weight::Error, text)
        }
        Format::ZERO => {
            fields.insert("written".into(), true.into());
            (Weight::Normal, format!("  {said}written"))
        }
        _ => {
            fields.extend(block_json(address, block));
            let text = format!(
                "  {}{}   [{}]",
                prefix(address, " = "),
                block_text(address, block),
                raw_text(block)
            );
            (Weight::Normal, text)
        }
    }
}

fn prefix(address: Option<ParameterAddress>, link: &str) -> String {
    address.map_or_else(String::new, |address| label(address) + link)
}

fn plural(count: usize, what: &str) -> String {
    if count == 1 {
        format!("1 {what}")
    } else {
        format!("{count} {what}s")
    }
}

/// A request in a few words, for the line of a capture.
pub fn request_lines(data: &[u8]) -> Vec<(Weight, String)> {
    joined(decode_request(data), data)
}

/// A response in a few words, with the request it answers where that is known.
pub fn response_lines(data: &[u8], request: Option<&[u8]>) -> Vec<(Weight, String)> {
    joined(
        decode_response(data, request).or_else(|_| decode_response(data, None)),
        data,
    )
}

/// One parameter on the line of the head, several below it.
fn joined(decoded: Result<Decoded, String>, data: &[u8]) -> Vec<(Weight, String)> {
    match decoded {
        Err(reason) => vec![(
            Weight::Error,
            format!("malformed job ({reason}): {}", hex_bytes(data)),
        )],
        Ok(decoded) => match decoded.lines.as_slice() {
            [(_, head), (weight, only)] => vec![(*weight, format!("{head}: {}", only.trim_start()))],
            _ => decoded.lines,
        },
    }
}

/// An error number of the parameter manager in words.
pub fn explain_error(number: u16, output: &mut Vec<String>) -> Map<String, Value> {
    let error = ErrorNumber(number);
    output.push(format!("parameter error {error}"));
    let mut fields = fields! { "as": "error", "raw": number, "meaning": error.to_string() };
    if let Some(info) = error.info(ErrorNames::Profile) {
        output.push(format!("  do     {}", info.remedy));
        fields.insert("remedy".into(), info.remedy.into());
    }
    let makers: Vec<(&str, &str)> = [("Danfoss", ErrorNames::Danfoss), ("Vacon", ErrorNames::Vacon)]
        .into_iter()
        .filter(|_| number >= 0x65)
        .filter_map(|(maker, names)| Some((maker, error.info(names)?.meaning)))
        .collect();
    for (maker, meaning) in makers {
        output.push(format!("  {maker:<6} {meaning}"));
        fields.insert(maker.to_lowercase(), meaning.into());
    }
    fields
}

/// A format code in words.
pub fn explain_format(code: u8, output: &mut Vec<String>) -> Map<String, Value> {
    let name = |space| Format(code).info(space).map(|row| row.name);
    let (v4, v3) = (name(CodeSpace::V4), name(CodeSpace::V3));
    output.push(format!(
        "format 0x{code:02X}: {}",
        v4.unwrap_or("reserved or unknown")
    ));
    if v3 != v4 {
        output.push(format!(
            "  in PROFIdrive V2/V3 and Danfoss drives: {}",
            v3.unwrap_or("unknown")
        ));
    }
    fields! { "as": "format", "raw": code, "v4": v4, "v3": v3 }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn words(hex: &str, request: Option<&str>) -> Vec<String> {
        let bytes = |text: &str| -> Vec<u8> {
            text.split(' ')
                .map(|octet| u8::from_str_radix(octet, 16).unwrap())
                .collect()
        };
        let request = request.map(bytes);
        let decoded = decode(&bytes(hex), None, request.as_deref()).unwrap();
        decoded.lines.into_iter().map(|(_, line)| line).collect()
    }

    #[test]
    fn the_worked_examples() {
        let lines = words("05 02 00 01 10 01 03 A2 00 00 42 01 00 02", None);
        assert_eq!(lines[0], "change request 5, axis 0, 1 parameter");
        assert!(lines[1].starts_with("  Operating mode (p0930) = 2"), "{lines:?}");
        assert!(lines[1].ends_with("[Word 00 02]"), "{lines:?}");
        let lines = words("02 01 01 01 10 06 03 C4 00 00", None);
        assert_eq!(lines[0], "read request 2, axis 1, 1 parameter");
        let lines = words("05 02 00 01 00 00", None);
        assert_eq!(lines, ["change response 5, axis 0, 1 parameter", "  written"]);
        let lines = words("01 02 01 01", None);
        assert_eq!(lines, ["change response 1, axis 1, 1 parameter", "  written"]);
        let lines = words("01 82 01 01 44 01 00 01", None);
        assert!(
            lines[1].starts_with("  refused: 0x01 parameter value cannot be changed"),
            "{lines:?}"
        );
    }

    #[test]
    fn a_request_cut_off_is_called_a_request() {
        for hex in [[5, 2, 0, 1, 0x10, 1, 3], [5, 1, 0, 1, 0x10, 1, 3]] {
            let failure = decode(&hex, None, None).err().unwrap();
            assert!(failure.message.contains("no parameter request"), "{failure}");
        }
    }

    #[test]
    fn responses_with_their_request() {
        let request = "07 01 00 02 10 01 08 3C 00 00 10 01 FF FE 00 00";
        let lines = words("07 81 00 02 43 01 00 2D C6 C0 44 01 00 00", Some(request));
        assert_eq!(
            lines[1],
            "  DRV.ACC (p2108) = 3000 rpm/s   [Double word 00 2D C6 C0]"
        );
        assert!(
            lines[2].starts_with("  65534: refused: 0x00 impermissible parameter number"),
            "{lines:?}"
        );
        let lines = words("08 01 00 01 42 01 00 02", Some(request));
        assert!(
            lines.iter().any(|line| line.contains("answers request 8, not 7")),
            "{lines:?}"
        );
    }

    #[test]
    fn a_response_that_repeats_the_address() {
        let lines = words("05 01 00 01 10 01 03 A2 00 00 42 01 00 02", None);
        assert!(lines[0].starts_with("read response 5"), "{lines:?}");
        assert!(lines[1].starts_with("  Operating mode (p0930) = 2"), "{lines:?}");
    }

    #[test]
    fn nonsense_is_told_as_such() {
        for bytes in [&[][..], &[1], &[1, 1, 0, 5, 0x42], &[1, 1, 0, 1, 0x42, 9, 1]] {
            assert_eq!(decode(bytes, None, None).unwrap_err().exit, Exit::Failed);
        }
    }

    proptest::proptest! {
        #[test]
        fn any_bytes_give_an_answer(
            data in proptest::collection::vec(proptest::prelude::any::<u8>(), 0..120),
            request in proptest::option::of(proptest::collection::vec(proptest::prelude::any::<u8>(), 0..60)),
        ) {
            let _ = decode(&data, None, request.as_deref());
            let _ = decode(&data, Some(Side::Request), None);
            let _ = response_lines(&data, request.as_deref());
        }
    }
}

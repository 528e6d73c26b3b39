//! Parameter jobs in words: what a request asks, what a response answers.

mod drive;
mod explain;

use drive_client::parameter::Reading;
use profidrive::catalogue::WordKind;
use profidrive::parameter::{
    Attribute, CodeSpace, Description, ErrorNumber, Format, ParameterAddress, Request, RequestId, ValueBlock,
};
use serde_json::{Map, Value, json};

use crate::args::Side;
use crate::decode::Weight;
use crate::failure::{Exit, Failure};
use crate::fields;
use crate::render::{hex_bytes, value, words};

pub use drive::JobDrive;
pub use explain::{explain_error, explain_format};

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
pub fn decode(
    drive: &mut JobDrive,
    data: &[u8],
    side: Option<Side>,
    request: Option<&[u8]>,
) -> Result<Decoded, Failure> {
    let side = side.unwrap_or_else(|| {
        if request.is_some() {
            Side::Response
        } else {
            guess(data, drive.code_space())
        }
    });
    match side {
        Side::Request => decode_request(drive, data),
        Side::Response => decode_response(drive, data, request),
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
fn guess(data: &[u8], space: CodeSpace) -> Side {
    let id = data.get(1).copied().unwrap_or(0);
    let addresses = HEADER + ADDRESS * usize::from(data.get(3).copied().unwrap_or(0));
    match id {
        // as long as a read request, but what would be its attribute is a format code
        1 if data.len() == addresses && !looks_like_values(data) => Side::Request,
        // the head alone, padded or not: a change that was carried out
        2 if matches!(data.get(HEADER..), Some([] | [0, 0])) => Side::Response,
        2 if data.len() > HEADER + 2 && Request::parse(data, space).is_ok_and(|job| values_fit(&job)) => {
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
    !matches!(data.get(HEADER), None | Some(0x10 | 0x20 | 0x30 | 0x80..))
}

fn values_fit(job: &Request<'_>) -> bool {
    job.values().all(|block| block.is_ok())
}

fn label(drive: &JobDrive, address: ParameterAddress) -> String {
    let text = drive.label(address);
    match address.attribute {
        Attribute::Value => text,
        Attribute::Description => format!("description of {text}"),
        Attribute::Text => format!("texts of {text}"),
        Attribute::Other(code) => format!("attribute 0x{code:02X} of {text}"),
    }
}

fn address_json(drive: &JobDrive, address: ParameterAddress) -> Map<String, Value> {
    let name = drive.select(address).parameter.map(|parameter| parameter.name);
    let whole = drive.tables().and_then(|tables| tables.by_high(address.pnu));
    let mut fields = fields! {
        "pnu": address.pnu, "index": address.subindex, "elements": address.elements,
        "attribute": address.attribute.octet(), "name": name,
    };
    if let Some(whole) = whole {
        fields.insert("high_half_of".into(), whole.name.into());
    }
    fields
}

fn format_name(drive: &JobDrive, format: Format) -> String {
    format
        .info(drive.code_space())
        .map_or_else(|| format!("format 0x{:02X}", format.0), |row| row.name.to_owned())
}

fn block_text(drive: &JobDrive, address: Option<ParameterAddress>, block: &ValueBlock<'_>) -> String {
    if address.is_some_and(|address| address.attribute == Attribute::Description)
        && let Some(description) = Description::decode(block.data)
    {
        return format!("\"{}\"", description.name().collect::<String>().trim_end());
    }
    let readings = drive.readings(address, block);
    let assumed = address.and_then(|address| drive.assumption(address.pnu));
    if let ([one], Some(assumed)) = (readings.as_slice(), &assumed) {
        let raw = one.raw().map_or_else(String::new, |raw| format!("raw {raw}, "));
        return format!("{raw}{} if {assumed}", value::full(one));
    }
    let texts: Vec<String> = match readings.as_slice() {
        [one] => vec![format!("{} {}", value::full(one), state(drive, one))],
        many => many.iter().map(value::value).collect(),
    };
    let unit = readings
        .first()
        .filter(|_| readings.len() > 1)
        .map_or("", |reading| reading.unit);
    let condition = assumed.map_or_else(String::new, |assumed| format!(" if {assumed}"));
    format!("{} {unit}", texts.join(", ")).trim_end().to_owned() + &condition
}

/// What a control or status word comes to as a whole.
fn state(drive: &JobDrive, reading: &Reading) -> String {
    let kind = drive
        .tables()
        .and_then(|tables| tables.word(reading.pnu))
        .map(|word| word.kind);
    let word = reading.raw().and_then(|raw| u16::try_from(raw & 0xFFFF).ok());
    match (kind, word) {
        (Some(WordKind::Control), Some(word)) => words::stw1_meaning_in(drive.mode(), word).to_owned(),
        (Some(WordKind::Status), Some(word)) => words::state(word, None),
        _ => String::new(),
    }
}

fn block_json(
    drive: &JobDrive,
    address: Option<ParameterAddress>,
    block: &ValueBlock<'_>,
) -> Map<String, Value> {
    let values: Vec<Value> = drive.readings(address, block).iter().map(value::json).collect();
    let mut fields = fields! {
        "format": block.format.0, "format_name": format_name(drive, block.format), "count": block.count,
        "hex": hex_bytes(block.data), "values": values,
    };
    if let Some(assumed) = address.and_then(|address| drive.assumption(address.pnu)) {
        fields.insert("assumed".into(), assumed.into());
    }
    fields
}

fn raw_text(drive: &JobDrive, block: &ValueBlock<'_>) -> String {
    const SHOWN: usize = 16;
    let (start, more) = block
        .data
        .split_at_checked(SHOWN)
        .map_or((block.data, ""), |(start, rest)| {
            (start, if rest.is_empty() { "" } else { " .." })
        });
    format!("{} {}{more}", format_name(drive, block.format), hex_bytes(start))
}

const fn verb(id: RequestId) -> &'static str {
    match id {
        RequestId::Read => "read request",
        RequestId::Change => "change request",
        RequestId::ChangePermanent => "change request (kept)",
        RequestId::ReadWide => "read request (double words)",
        RequestId::ChangeWide => "change request (double words)",
        RequestId::Other(_) => "request of an unknown kind",
    }
}

fn decode_request(drive: &JobDrive, data: &[u8]) -> Result<Decoded, String> {
    let job = Request::parse(data, drive.code_space()).map_err(|error| error.to_string())?;
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
        let mut fields = address_json(drive, address);
        let mut text = label(drive, address);
        if job.id().is_change() {
            match values.next() {
                Some(Ok(block)) => {
                    text = format!(
                        "{text} = {}   [{}]",
                        block_text(drive, Some(address), &block),
                        raw_text(drive, &block)
                    );
                    fields.extend(block_json(drive, Some(address), &block));
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

fn decode_response(drive: &mut JobDrive, data: &[u8], request: Option<&[u8]>) -> Result<Decoded, String> {
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
        if !job.id().is_answered_by(id) {
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
            let mut text = format!("  {said}refused: {number}");
            if let Some(information) = information {
                text = format!("{text}, information {information}");
            }
            if let Some(info) = number.info(drive.error_names()) {
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

fn prefix(drive: &JobDrive, address: Option<ParameterAddress>, link: &str) -> String {
    address.map_or_else(String::new, |address| label(drive, address) + link)
}

fn plural(count: usize, what: &str) -> String {
    if count == 1 {
        format!("1 {what}")
    } else {
        format!("{count} {what}s")
    }
}

/// A request in a few words, for the line of a capture.
pub fn request_lines(drive: &JobDrive, data: &[u8]) -> Vec<(Weight, String)> {
    joined(decode_request(drive, data), data)
}

/// A response in a few words, with the request it answers where that is known. What it tells about the drive is taken
/// over.
pub fn response_lines(drive: &mut JobDrive, data: &[u8], request: Option<&[u8]>) -> Vec<(Weight, String)> {
    joined(
        decode_response(drive, data, request).or_else(|_| decode_response(drive, data, None)),
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
        let decoded = decode(&mut JobDrive::default(), &bytes(hex), None, request.as_deref()).unwrap();
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

    /// Each worked example of requests and responses of the profile, with what it is.
    #[test]
    fn every_example_of_the_profile() {
        for (hex, head, rest) in [
            (
                "02 01 01 01 10 06 03 C4 00 00",
                "read request 2, axis 1",
                "(r0964[0..5])",
            ),
            (
                "03 01 01 01 10 01 27 11 00 67",
                "read request 3, axis 1",
                "10001[103]",
            ),
            (
                "05 02 00 01 10 01 03 A2 00 00 42 01 00 02",
                "change request 5, axis 0",
                "(p0930) = 2",
            ),
            (
                "01 02 01 01 10 01 03 9F 00 00 06 01 00 00",
                "change request 1, axis 1",
                "0927 = 0",
            ),
            (
                "80 02 01 01 10 01 04 61 00 00 08 01 41 42 66 66",
                "change request 128, axis 1",
                "1121 = 12.15   [Float32 41 42 66 66]",
            ),
            (
                "02 01 01 01 42 06 01 BA 00 02 00 64 07 DE 00 65 00 01",
                "read response 2, axis 1",
                "442, 2, 100, 2014, 101, 1   [",
            ),
            (
                "0B 01 01 01 42 01 0C 05",
                "read response 11, axis 1",
                "3077   [Word 0C 05]",
            ),
            (
                "17 01 00 01 43 01 00 00 00 2B",
                "read response 23, axis 0",
                "43   [Double word 00 00 00 2B]",
            ),
            (
                "17 81 00 01 44 01 00 11",
                "read response with refusals 23, axis 0",
                "refused: 0x11 not executable",
            ),
            ("01 02 01 01", "change response 1, axis 1", "written"),
            (
                "01 82 01 01 44 01 00 01",
                "change response with refusals 1, axis 1",
                "refused: 0x01 ",
            ),
            ("05 02 00 01 00 00", "change response 5, axis 0", "written"),
            (
                "07 81 00 02 42 01 00 02 44 01 00 00",
                "read response with refusals 7, axis 0, 2 parameters",
                "refused: 0x00 impermissible parameter number",
            ),
            (
                "08 82 00 02 40 00 44 02 00 01 00 00",
                "change response with refusals 8, axis 0, 2 parameters",
                "refused: 0x01 parameter value cannot be changed, information 0",
            ),
        ] {
            let lines = words(hex, None);
            assert!(lines[0].starts_with(head), "{hex}: {lines:?}");
            assert!(
                lines[1..].iter().any(|line| line.contains(rest)),
                "{hex}: {lines:?}"
            );
            assert!(!lines.iter().any(|line| line.contains('!')), "{hex}: {lines:?}");
        }
    }

    fn octets(hex: &str) -> Vec<u8> {
        hex.split(' ')
            .map(|octet| u8::from_str_radix(octet, 16).unwrap())
            .collect()
    }

    /// What the drive answers to a request, in one line.
    fn answered(drive: &mut JobDrive, request: &str, response: &str) -> String {
        let lines = response_lines(drive, &octets(response), Some(&octets(request)));
        lines.into_iter().map(|(_, line)| line).collect()
    }

    #[test]
    fn scales_are_taken_from_what_is_read_and_written() {
        let mut drive = JobDrive::default();
        let speed = ("01 01 00 01 10 01 00 05 00 00", "01 01 00 01 42 01 05 3E");
        let text = answered(&mut drive, speed.0, speed.1);
        assert!(
            text.contains("NSOLL_A (p0005) = raw 1342, 491.335 rpm if PN.VELSCALING 1638   [Word 05 3E]"),
            "{text}"
        );
        // PN.VELSCALING is read
        let text = answered(
            &mut drive,
            "02 01 00 01 10 01 0B F8 00 00",
            "02 01 00 01 42 01 00 C8",
        );
        assert!(text.contains("PN.VELSCALING (p3064) = 200"), "{text}");
        let text = answered(&mut drive, speed.0, speed.1);
        assert!(text.contains("NSOLL_A (p0005) = 59.992 rpm   ["), "{text}");
        // its mirror is written, first refused, then accepted
        let change = "03 02 00 01 10 01 03 F1 00 00 42 01 03 E8";
        let refused = answered(&mut drive, change, "03 82 00 01 44 01 00 11");
        assert!(refused.contains("refused"), "{refused}");
        let text = answered(&mut drive, speed.0, speed.1);
        assert!(text.contains("59.992 rpm"), "{text}");
        for written in ["03 02 00 01", "03 02 00 01 00 00"] {
            let mut drive = drive.clone();
            answered(&mut drive, change, written);
            let text = answered(&mut drive, speed.0, speed.1);
            assert!(text.contains("299.96 rpm"), "{text}");
        }
        // an answer to something else tells nothing
        let text = answered(
            &mut drive,
            "04 01 00 01 10 01 0B F8 00 00",
            "09 01 00 01 42 01 00 01",
        );
        assert!(text.contains("answers request 9, not 4"), "{text}");
        let text = answered(&mut drive, speed.0, speed.1);
        assert!(text.contains("59.992 rpm"), "{text}");
        // each scale of its own: the position is not known yet
        let text = answered(
            &mut drive,
            "05 01 00 01 10 01 08 F6 00 00",
            "05 01 00 01 43 01 00 00 00 05",
        );
        assert!(
            text.contains("PL.FB (r2294) = raw 5, 5 counts if PN.POSSCALE 1000   ["),
            "{text}"
        );
    }

    #[test]
    fn another_makers_drive_has_other_parameters() {
        let mut drive = JobDrive::of(0x0002, 0x0001);
        let text = answered(
            &mut drive,
            "01 01 01 01 10 01 08 3C 00 00",
            "01 01 01 01 43 01 00 2D C6 C0",
        );
        assert!(text.contains("2108 = 3000000   ["), "{text}");
    }

    #[test]
    fn words_by_name_and_high_halves() {
        let mut drive = JobDrive::default();
        let text = answered(
            &mut drive,
            "01 01 00 02 10 01 00 02 00 00 10 01 08 3D 00 00",
            "01 01 00 02 42 01 02 70 43 01 00 00 00 00",
        );
        assert!(
            text.contains("ZSW1 (r0002) = 0x0270 [INHIBIT, CTRL_REQ] S1 switching on inhibited   ["),
            "{text}"
        );
        assert!(text.contains("high half of DRV.ACC (2109) = 0"), "{text}");
    }

    #[test]
    fn a_request_cut_off_is_called_a_request() {
        for hex in [[5, 2, 0, 1, 0x10, 1, 3], [5, 1, 0, 1, 0x10, 1, 3]] {
            let failure = decode(&mut JobDrive::default(), &hex, None, None).err().unwrap();
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
            assert_eq!(
                decode(&mut JobDrive::default(), bytes, None, None)
                    .unwrap_err()
                    .exit,
                Exit::Failed
            );
        }
    }

    proptest::proptest! {
        #[test]
        fn any_bytes_give_an_answer(
            data in proptest::collection::vec(proptest::prelude::any::<u8>(), 0..120),
            request in proptest::option::of(proptest::collection::vec(proptest::prelude::any::<u8>(), 0..60)),
        ) {
            let mut drive = JobDrive::default();
            let _ = decode(&mut drive, &data, None, request.as_deref());
            let _ = decode(&mut drive, &data, Some(Side::Request), None);
            let _ = response_lines(&mut drive, &data, request.as_deref());
        }
    }
}

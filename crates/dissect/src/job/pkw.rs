//! The PKW channel in words: requests and replies with the names, values and units of the drive.

use profile::parameter::{Attribute, Identifier, ParameterAddress};
use profile::pkw::{
    Action, MAX_BLOCK, PKW_LEN, Pkw, PkwDialect, PkwErrorNumber, ReplyCode, RequestCode, TEXT_AT, TEXT_READ,
    TEXT_WRITE, Width,
};
use profile::value::Reading;
use serde_json::Value;
use uss::Protocol;

use super::{Decoded, JobDrive, description};
use crate::Weight;
use crate::fields;
use crate::meaning::Meaning;
use crate::value;

/// PKE, IND and PWE of a parameter block, as far as it has them, and the characters of a text block (AK 15), which stand in
/// the place of PWE.
pub fn block<'a>(dialect: &PkwDialect, part: &'a [u8]) -> Option<(Pkw, Option<&'a [u8]>)> {
    let (_, behind) = part.split_at_checked(TEXT_AT)?;
    let mut octets = [0; PKW_LEN];
    for (place, octet) in octets.iter_mut().zip(part) {
        *place = *octet;
    }
    let pkw = Pkw::from_octets(octets);
    let is_text = pkw.request_code() == RequestCode::TEXT && dialect.has_text();
    Some((pkw, is_text.then_some(behind)))
}

/// Returns a block of the channel: eight octets, or a text block. Without a direction both are reported.
pub fn decode(
    drive: &JobDrive,
    dialect: &PkwDialect,
    data: &[u8],
    output: Option<bool>,
) -> Result<Decoded, String> {
    let fits = |text: Option<&[u8]>| match text {
        Some(_) => data.len() <= MAX_BLOCK,
        None => data.len() == PKW_LEN,
    };
    let (pkw, characters) = block(dialect, data)
        .filter(|(_, text)| fits(*text))
        .ok_or_else(|| {
            let text = if dialect.has_text() {
                format!(" or {TEXT_AT} to {MAX_BLOCK} for a text (AK 15)")
            } else {
                String::new()
            };
            format!(
                "the parameter channel has {PKW_LEN} octets{text}, there are {}",
                data.len()
            )
        })?;
    let mut lines = Vec::new();
    let mut sides = Vec::new();
    for side in [true, false] {
        if output.is_some_and(|wanted| wanted != side) {
            continue;
        }
        let (weight, text) = if side {
            request(drive, dialect, pkw, characters)
        } else {
            reply(drive, dialect, pkw, characters)
        };
        let who = if side { "request" } else { "reply" };
        let mut entry = fields! { "side": who, "text": text.as_str() };
        if !side {
            entry.extend(refusal_json(dialect, pkw));
        }
        sides.push(Value::Object(entry));
        lines.push((weight, format!("as a {who:<8} {text}")));
    }
    let fields = fields! {
        "dialect": dialect.name, "model": drive.name(), "pke": pkw.pke, "ind": pkw.ind, "pwe": characters.is_none().then_some(pkw.pwe),
        "ak": pkw.ak(), "pnu": pkw.address(dialect).map(|address| address.pnu),
        "subindex": pkw.address(dialect).map(|address| address.subindex), "sides": sides,
    };
    Ok(Decoded {
        lines,
        fields,
        refused: Vec::new(),
    })
}

/// Returns a description of a request. `text` is what stands in the place of PWE in a text block.
pub fn request(drive: &JobDrive, dialect: &PkwDialect, pkw: Pkw, text: Option<&[u8]>) -> (Weight, String) {
    let code = pkw.request_code();
    let info = code.info();
    if info.action == Action::Nothing {
        return (Weight::Normal, "no request".into());
    }
    let mut line = format!("{}: {}", info.name, label(drive, dialect, pkw, info.array));
    match (info.action, info.width) {
        (Action::Change, Some(width)) => {
            line = format!("{line} = {}", number(drive, dialect, pkw, width));
        }
        (Action::ReadDescription | Action::ChangeDescription, _) => {
            let element = description::element(subindex(dialect, pkw));
            line = format!("{}: {element} of {}", info.name, whole(drive, dialect, pkw));
        }
        (Action::Text, _) => {
            let code = pkw.address(dialect).map_or(0, |address| address.text);
            let writes = code == TEXT_WRITE;
            let verb = match code {
                TEXT_READ => "read text",
                TEXT_WRITE => "change text",
                _ => info.name,
            };
            line = format!("{verb} of {}", label(drive, dialect, pkw, false));
            if let Some(text) = text.filter(|text| writes && !text.is_empty()) {
                line = format!("{line} = {}", quoted(text));
            }
        }
        _ => {}
    }
    if pkw.is_request_of(dialect) {
        return match drive.pkw_refusal(dialect, pkw, text) {
            None => (Weight::Normal, line),
            Some(number) => {
                let words = number.words(dialect.error_names);
                (
                    Weight::Error,
                    format!("{line} (not allowed: refused with {words})"),
                )
            }
        };
    }
    let ind = if dialect.knows(code) {
        format!(" with IND 0x{:04X}", pkw.ind)
    } else {
        String::new()
    };
    (
        Weight::Warning,
        format!(
            "{line} (no request of {}: AK {}{ind}, refused with {})",
            dialect.name, code.0, dialect.unknown_request.0
        ),
    )
}

/// Returns a description of a reply.
pub fn reply(drive: &JobDrive, dialect: &PkwDialect, pkw: Pkw, text: Option<&[u8]>) -> (Weight, String) {
    let code = pkw.reply_code();
    let info = code.info();
    let normal = |text: String| (Weight::Normal, text);
    if code == ReplyCode::NONE {
        return normal("no reply".into());
    }
    let label = label(drive, dialect, pkw, info.array);
    if let Some(width) = info.width {
        let number = number(drive, dialect, pkw, width);
        let spontaneous = if info.spontaneous { "spontaneous: " } else { "" };
        return normal(format!("{spontaneous}{label} = {number}"));
    }
    match code {
        ReplyCode::REFUSED => {
            let number = PkwErrorNumber(pkw.pwe_low());
            let row = number.info(dialect.error_names);
            let what = number.words(dialect.error_names);
            let remedy = row.map_or_else(String::new, |row| format!("; {}", row.remedy));
            let who = if pkw.pke & dialect.pnu_mask() == 0 {
                String::new()
            } else {
                format!("{label}: ")
            };
            (Weight::Error, format!("{who}refused: {what}{remedy}"))
        }
        ReplyCode::NO_RIGHTS => (Weight::Error, format!("{label}: refused: {}", info.name)),
        ReplyCode::DESCRIPTION => {
            let number = subindex(dialect, pkw);
            let mut line = format!(
                "{} of {} = 0x{:X}",
                description::element(number),
                whole(drive, dialect, pkw),
                pkw.pwe
            );
            if number == 1 {
                let words = description::identifier(Identifier(pkw.pwe_low()), drive.code_space());
                line = format!("{line} ({words})");
            }
            normal(line)
        }
        ReplyCode::ELEMENTS => normal(format!(
            "{} has {} elements",
            whole(drive, dialect, pkw),
            pkw.pwe_low()
        )),
        ReplyCode::TEXT => normal(match text {
            Some(text) => format!("text of {label} = {}", quoted(text)),
            None => format!("text of {label}"),
        }),
        _ => (Weight::Warning, format!("{label}: AK {} {}", code.0, info.name)),
    }
}

/// Returns the `error` of a refusal: its number, its meaning and what to do; of a refusal without a number its meaning.
pub fn refusal_json(dialect: &PkwDialect, pkw: Pkw) -> Option<(String, Value)> {
    let error = match pkw.reply_code() {
        ReplyCode::REFUSED => {
            let number = PkwErrorNumber(pkw.pwe_low());
            let remedy = number.info(dialect.error_names).map(|row| row.remedy);
            fields! {
                "number": number.0, "meaning": number.words(dialect.error_names), "remedy": remedy,
            }
        }
        ReplyCode::NO_RIGHTS => fields! { "number": (), "meaning": ReplyCode::NO_RIGHTS.info().name },
        _ => return None,
    };
    Some(("error".into(), Value::Object(error)))
}

/// Returns true when this is, or may be, what a drive answers to that request.
pub fn answers(dialect: &PkwDialect, request: Pkw, reply: Pkw) -> bool {
    let info = request.request_code().info();
    let code = reply.reply_code();
    let number = |pkw: Pkw| pkw.pke & dialect.pnu_mask();
    if info.refusals.contains(&code) {
        return number(reply) == number(request) || (number(reply) == 0 && !dialect.refusal_names_pnu);
    }
    info.replies.contains(&code) && number(reply) == number(request) && reply.ind == request.ind
}

/// Returns the value that a reply carries, from which scalings are derived.
pub fn reading(drive: &JobDrive, dialect: &PkwDialect, pkw: Pkw) -> Option<Reading> {
    let width = pkw.reply_code().info().width?;
    let address = address(dialect, pkw)?;
    Some(drive.number(address, octets(pkw, width, &mut [0; 4])))
}

fn address(dialect: &PkwDialect, pkw: Pkw) -> Option<ParameterAddress> {
    let address = pkw.address(dialect)?;
    Some(ParameterAddress::value(address.pnu, address.subindex.into()))
}

fn subindex(dialect: &PkwDialect, pkw: Pkw) -> u16 {
    pkw.address(dialect).map_or(0, |address| address.subindex.into())
}

/// Returns the number and name of a parameter with its element.
fn label(drive: &JobDrive, dialect: &PkwDialect, pkw: Pkw, array: bool) -> String {
    let Some(address) = address(dialect, pkw) else {
        let number = pkw.pke & dialect.pnu_mask();
        return format!("PNU {number} of an unknown page (IND 0x{:04X})", pkw.ind);
    };
    let plain = drive
        .parameter(address)
        .is_some_and(|parameter| !parameter.is_array());
    if plain && address.subindex == 0 && !array {
        return whole(drive, dialect, pkw);
    }
    drive.label(address)
}

/// Returns the number and name of a parameter without an element.
fn whole(drive: &JobDrive, dialect: &PkwDialect, pkw: Pkw) -> String {
    let Some(address) = address(dialect, pkw) else {
        return label(drive, dialect, pkw, false);
    };
    drive.whole_label(address.pnu)
}

fn octets(pkw: Pkw, width: Width, buffer: &mut [u8; 4]) -> &[u8] {
    *buffer = pkw.pwe.to_be_bytes();
    match (width, &*buffer) {
        (Width::Word, [_, _, word @ ..]) => word,
        (_, all) => all,
    }
}

fn number(drive: &JobDrive, dialect: &PkwDialect, pkw: Pkw, width: Width) -> String {
    let mut buffer = [0; 4];
    let octets = octets(pkw, width, &mut buffer);
    let raw = crate::hex_bytes(octets);
    let name = match width {
        Width::Word => "word",
        Width::DoubleWord => "double word",
    };
    let Some(address) = address(dialect, pkw) else {
        return format!("{}   [{name} {raw}]", pkw.value(width));
    };
    let reading = drive.number(address, octets);
    let condition = drive
        .assumption(ParameterAddress {
            attribute: Attribute::Value,
            ..address
        })
        .map_or_else(String::new, |assumed| format!(" if {assumed}"));
    format!("{}{condition}   [{name} {raw}]", value::full(&reading))
}

/// Characters of a text block.
fn quoted(text: &[u8]) -> String {
    let text = String::from_utf8_lossy(text);
    format!("\"{}\"", text.trim_end_matches(['\0', ' ']))
}

/// AK and parameter number of a PKE, as both sides may mean it. With bit 11 set the carrier decides over the number.
pub fn pke(drive: &JobDrive, pke: u16) -> (Vec<String>, Meaning) {
    let pkw = Pkw { pke, ind: 0, pwe: 0 };
    let [high, _] = pke.to_be_bytes();
    let ak = high >> 4;
    let (line, ppo) = (drive.line(Protocol::Fc), drive.ppo());
    let number = |dialect: &PkwDialect| pke & dialect.pnu_mask();
    let mut texts = vec![format!("PKE {}   {}", crate::hex16(pke), crate::nibbles(pke))];
    if pkw.spm(ppo) {
        let named = |dialect| format!("{} (PNU {})", whole(drive, dialect, pkw), number(dialect));
        texts.push(format!("  parameter  {} over the FC protocol and over USS of a Danfoss drive: bit 11 is part of the number", named(&line)));
        texts.push(format!("             {} in a PPO: bit 11 is that of spontaneous messages, and in no use in Danfoss drives", named(ppo)));
    } else {
        texts.push(format!("  parameter  {}", whole(drive, &line, pkw)));
    }
    texts.push(format!("  request    {}", RequestCode(ak)));
    texts.push(format!("  reply      {}", ReplyCode(ak)));
    let meaning = Meaning::Pke {
        r#as: "pke",
        raw: pke,
        ak,
        pnu: number(&line),
        pnu_ppo: number(ppo),
        request: RequestCode(ak).info().name,
        reply: ReplyCode(ak).info().name,
    };
    (texts, meaning)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn vlt() -> JobDrive {
        JobDrive::of(0x0080, 1)
    }

    fn pkw(octets: [u8; 8]) -> Pkw {
        Pkw::from_octets(octets)
    }

    #[test]
    fn the_examples_of_the_fc_protocol() {
        let decoded = |octets| request(&vlt(), &PkwDialect::DANFOSS_FC, pkw(octets), None);
        let (_, text) = decoded([0x15, 0xFA, 0, 1, 0, 0, 0, 0]);
        assert_eq!(text, "request value: Fault Log: Error Code (15-30[1])");
        let (_, text) = decoded([0xE1, 0x9E, 0, 0, 0, 0, 0x03, 0xE8]);
        assert!(
            text.starts_with(
                "change value (word) in RAM and EEPROM: Motor Speed High Limit [Hz] (4-14) = 100 Hz"
            ),
            "{text}"
        );
        let (_, text) = decoded([0xF6, 0x04, 0x04, 0, 0, 0, 0, 0]);
        assert!(
            text.starts_with("read text of ") && text.contains("(15-40"),
            "{text}"
        );
        let (weight, text) = decoded([0x61, 0x9E, 0, 0, 0, 0, 0, 0]);
        assert_eq!(weight, Weight::Warning);
        assert!(
            text.contains("no request of Danfoss FC protocol: AK 6, refused with 253"),
            "{text}"
        );
        // IND of AK 15 is 0x0400 or 0x0500
        for ind in [0, 6] {
            let (weight, text) = decoded([0xF0, 0x25, ind, 0, 0, 0, 0, 0]);
            assert_eq!(weight, Weight::Warning, "{text}");
            let refused = format!("AK 15 with IND 0x{ind:02X}00, refused with 253");
            assert!(
                text.starts_with("read or write text of ") && text.contains(&refused),
                "{text}"
            );
        }
        let decoded = |octets| reply(&vlt(), &PkwDialect::DANFOSS_FC, pkw(octets), None);
        let (weight, text) = decoded([0x75, 0xFA, 0, 1, 0, 0, 0, 0x11]);
        assert_eq!(weight, Weight::Error);
        assert!(
            text.starts_with(
                "Fault Log: Error Code (15-30[1]): refused: 17 not possible in the present mode"
            ),
            "{text}"
        );
        let (_, text) = decoded([0x30, 0x01, 0, 1, 0, 0, 0x04, 0x05]);
        assert_eq!(
            text,
            "description element 1 (identifier) of Language (0-01) = 0x405 (Unsigned8, has texts)"
        );
    }

    /// What the drive refuses by its tables, as of a request in a record.
    #[test]
    fn a_request_of_another_size_is_not_allowed() {
        for (octets, refused) in [
            // a word for the double word 3-41, a double word for the octet 0-01
            ([0x21, 0x55, 0, 0, 0, 0, 0x01, 0xF4], Some("5 ")),
            ([0x30, 0x01, 0, 0, 0, 1, 0, 1], Some("5 ")),
            ([0x31, 0x55, 0, 0, 0, 0, 0x01, 0xF4], None),
            ([0x20, 0x01, 0, 0, 0, 0, 0, 1], None),
            ([0x11, 0x55, 0, 0, 0, 0, 0, 0], None),
            // a reading, and the second element of a parameter without elements
            ([0x26, 0x51, 0, 0, 0, 0, 0, 1], Some("1 ")),
            ([0x11, 0x55, 0, 2, 0, 0, 0, 0], Some("4 ")),
            // a drive can have more than the tables
            ([0x2F, 0xFE, 0, 0, 0, 0, 0, 1], None),
        ] {
            let (weight, text) = request(&vlt(), &PkwDialect::DANFOSS_FC, pkw(octets), None);
            let marked = text.split_once("(not allowed: refused with ");
            assert_eq!(marked.is_some(), refused.is_some(), "{text}");
            assert_eq!(weight == Weight::Error, refused.is_some(), "{text}");
            if let (Some((_, number)), Some(expected)) = (marked, refused) {
                assert!(number.starts_with(expected), "{text}");
            }
            // of a drive that is only assumed nothing is refused
            let (_, text) = request(&JobDrive::default(), &PkwDialect::DANFOSS_FC, pkw(octets), None);
            assert!(!text.contains("not allowed"), "{text}");
        }
        // 0-37 takes 25 characters: those of the text count, and not the octets in the place of PWE
        let write_text = |text: &[u8]| {
            let head = pkw([0xF0, 0x25, 5, 0, 0, 0, 0, 0]);
            request(&vlt(), &PkwDialect::DANFOSS_FC, head, Some(text)).1
        };
        assert!(!write_text(&[b'A'; 25]).contains("not allowed"));
        assert!(write_text(&[b'A'; 26]).contains("not allowed"));
    }

    #[test]
    fn a_text_block_has_characters_in_the_place_of_pwe() {
        let text_of = |octets: &[u8], from_controller| {
            let decoded = decode(&vlt(), &PkwDialect::DANFOSS_FC, octets, Some(from_controller)).unwrap();
            assert!(decoded.fields["pwe"].is_null(), "{octets:02X?}");
            decoded.lines[0].1.clone()
        };
        for (octets, from_controller, words) in [
            (
                &b"\xF0\x25\x04\0ABCD"[..],
                false,
                "as a reply    text of 0-37 = \"ABCD\"",
            ),
            (
                b"\xF0\x25\x05\0ABCD",
                true,
                "as a request  change text of 0-37 = \"ABCD\"",
            ),
            (
                b"\xF0\x25\x05\0abc",
                true,
                "as a request  change text of 0-37 = \"abc\"",
            ),
            (b"\xF0\x25\x04\0", true, "as a request  read text of 0-37"),
        ] {
            let text = text_of(octets, from_controller);
            let text = text.replace("Display Text 1 (0-37)", "0-37");
            assert_eq!(text, words, "{octets:02X?}");
        }
        // no text, too short or too long, and a channel without texts
        let long = [&[0xF0, 0x25, 5, 0][..], &[b'a'; MAX_BLOCK]].concat();
        for octets in [&[0x10, 0x25, 5, 0, 1, 2, 3][..], &[0xF0, 0x25, 5], &long] {
            let error = decode(&vlt(), &PkwDialect::DANFOSS_FC, octets, None).unwrap_err();
            let words = "the parameter channel has 8 octets or 4 to 252 for a text (AK 15), there are ";
            assert_eq!(error, format!("{words}{}", octets.len()));
        }
        let error = decode(&vlt(), &PkwDialect::DANFOSS_PPO, &[0xF0, 0x25, 5, 0, 1], None).unwrap_err();
        assert_eq!(error, "the parameter channel has 8 octets, there are 5");
    }

    #[test]
    fn the_same_index_stands_elsewhere_in_a_ppo() {
        let drive = vlt();
        let (_, text) = request(&drive, drive.ppo(), pkw([0x65, 0xFA, 1, 0, 0, 0, 0, 0]), None);
        assert_eq!(text, "request value (array): Fault Log: Error Code (15-30[1])");
        let (_, text) = reply(&drive, drive.ppo(), pkw([0x65, 0xFA, 0, 0, 0, 0, 0, 10]), None);
        assert_eq!(text, "Fault Log: Error Code (15-30) has 10 elements");
        let (_, text) = reply(&drive, drive.ppo(), pkw([0x70, 0, 0, 0, 0, 0, 0, 2]), None);
        assert!(text.starts_with("refused: 2 value exceeds the limits"), "{text}");
    }

    #[test]
    fn replies_belong_to_their_request() {
        let dialect = PkwDialect::DANFOSS_PPO;
        let read = pkw([0x11, 0x9E, 0, 0, 0, 0, 0, 0]);
        for (octets, fits) in [
            ([0x11, 0x9E, 0, 0, 0, 0, 0x03, 0xE8], true),
            ([0x21, 0x9E, 0, 0, 0, 0, 0x03, 0xE8], true),
            ([0x71, 0x9E, 0, 0, 0, 0, 0, 2], true),
            ([0x70, 0x00, 0, 0, 0, 0, 0, 2], true),
            ([0x11, 0x9F, 0, 0, 0, 0, 0x03, 0xE8], false),
            ([0x11, 0x9E, 1, 0, 0, 0, 0x03, 0xE8], false),
            ([0x31, 0x9E, 0, 0, 0, 0, 0, 0], false),
            ([0x00, 0x00, 0, 0, 0, 0, 0, 0], false),
        ] {
            assert_eq!(answers(&dialect, read, pkw(octets)), fits, "{octets:02X?}");
        }
    }

    fn pke_text(drive: &JobDrive, word: u16) -> String {
        let (lines, _) = pke(drive, word);
        lines.into_iter().map(|line| line + "\n").collect()
    }

    /// Bit 11 of PKE is part of the number over FC and USS, and not in the words of a PPO.
    #[test]
    fn a_pke_with_bit_11_is_of_two_parameters() {
        let text = pke_text(&vlt(), 0x1D55);
        assert!(
            text.contains("34-13 (PNU 3413) over the FC protocol and over USS"),
            "{text}"
        );
        assert!(text.contains("13-65 (PNU 1365) in a PPO"), "{text}");
        let (_, meaning) = pke(&vlt(), 0x1D55);
        let numbers = (3413, 1365);
        assert!(matches!(meaning, Meaning::Pke { pnu, pnu_ppo, .. } if (pnu, pnu_ppo) == numbers));
        assert!(!pke_text(&vlt(), 0x1555).contains("PPO"));
    }

    #[test]
    fn a_pke_of_both_sides() {
        let lines = pke_text(&vlt(), 0x15FA);
        assert!(lines.contains("Fault Log: Error Code (15-30)"), "{lines}");
        assert!(lines.contains("request    AK 1 request value"), "{lines}");
        assert!(lines.contains("reply      AK 1 value (word)"), "{lines}");
    }

    proptest::proptest! {
        #[test]
        fn any_octets_are_decoded(octets: [u8; 8], text in proptest::option::of(proptest::collection::vec(proptest::prelude::any::<u8>(), 0..40))) {
            for drive in [vlt(), JobDrive::default(), JobDrive::of(0, 0)] {
                for dialect in [&PkwDialect::DANFOSS_FC, &PkwDialect::DANFOSS_PPO, &PkwDialect::SIEMENS_USS, &PkwDialect::STANDARD] {
                    request(&drive, dialect, pkw(octets), text.as_deref());
                    reply(&drive, dialect, pkw(octets), text.as_deref());
                }
            }
        }
    }
}

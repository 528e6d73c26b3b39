//! `profidrive decode --hex "05 02 .."`, and captures.

mod capture;

use profidrive::model::Model;
use profidrive::pkw::PkwDialect;
use uss::Protocol;

use crate::args::{Decode, Octets, Sender, Side};
use crate::decode::Weight;
use crate::failure::{Exit, Failure};
use crate::job::{self, Decoded, JobDrive};
use crate::output::{Colour, Output};

/// Decodes octets, a capture file, or what is on `interface`.
pub fn run(args: &Decode, interface: Option<&str>, output: &Output) -> Result<(), Failure> {
    if let (Some(since), Some(until)) = (args.since, args.until)
        && since > until
    {
        return Err(Failure::usage(
            "--since is later than --until: no frame is between them",
        ));
    }
    match (&args.file, &args.hex) {
        (Some(file), _) => capture::file(file, args, output),
        (None, Some(hex)) => {
            let decoded = octets(&parse_hex(hex)?, args)?;
            if output.json() {
                output.document("decode", decoded.fields);
            } else {
                for (weight, line) in decoded.lines {
                    output.line(&painted(weight, &line, output));
                }
            }
            Ok(())
        }
        (None, None) => match interface {
            Some(interface) => capture::live(interface, args, output),
            None => Err(Failure::usage("there is nothing to decode").hint(
                "give a capture file, `-` for standard input, -i IFACE to capture, or bytes with --hex",
            )),
        },
    }
}

/// The drive that octets are from: the one named, else `otherwise`.
fn drive(args: &Decode, otherwise: &str) -> JobDrive {
    args.model
        .model
        .or_else(|| Model::by_name(otherwise))
        .map_or_else(JobDrive::default, JobDrive::new)
}

/// The model that a telegram can only be from; an AKD where it is one of the profile or of several makers.
fn model_with(telegram: u16) -> &'static str {
    let has = |name: &&&str| {
        let model = Model::by_name(name).map(JobDrive::new);
        model.is_some_and(|model| model.telegram(telegram).is_some())
    };
    let mut having = Model::NAMES.iter().filter(has);
    match (having.next(), having.next()) {
        (Some(only), None) => only,
        _ => "akd",
    }
}

fn octets(data: &[u8], args: &Decode) -> Result<Decoded, Failure> {
    let request = args.request.as_deref().map(parse_hex).transpose()?;
    let output = args.from.map(|sender| sender == Sender::Controller);
    let job = |side| job::decode(&mut drive(args, "akd"), data, side, request.as_deref());
    let none = |reason: String| Failure::new(Exit::Failed, format!("this is no such telegram: {reason}"));
    let serial = |otherwise, protocol| {
        job::serial::decode(&drive(args, otherwise), protocol, data, output).map_err(none)
    };
    let words = |otherwise, dialect: Option<&PkwDialect>| {
        let drive = drive(args, otherwise);
        let output = output.or(request.as_ref().map(|_| false));
        job::pkw::decode(&drive, dialect.unwrap_or(drive.ppo()), data, output).map_err(none)
    };
    match args.octets {
        Some(Octets::Request) => job(Some(Side::Request)),
        Some(Octets::Response) => job(Some(Side::Response)),
        Some(Octets::Pkw) => words("standard", None),
        Some(Octets::PkwFc) => words("vlt", Some(&PkwDialect::DANFOSS_FC)),
        Some(Octets::PkwUss) => words("standard", Some(&PkwDialect::SIEMENS_USS)),
        Some(Octets::Fc) => serial("vlt", Protocol::Fc),
        Some(Octets::Uss) => serial("standard", Protocol::Uss),
        None => match args.telegram {
            Some(number) => {
                let drive = drive(args, model_with(number));
                job::telegram::decode(&drive, number, data, output).map_err(none)
            }
            None => job(match args.from {
                Some(Sender::Controller) => Some(Side::Request),
                Some(Sender::Drive) => Some(Side::Response),
                None => None,
            }),
        },
    }
}

/// Octets from text: `05 02`, `0502`, `05:02`, `0x05, 0x02`.
fn parse_hex(text: &str) -> Result<Vec<u8>, Failure> {
    let wrong = |part: &str| {
        Failure::usage(format!("`{part}` is no octet in hexadecimal"))
            .hint("write them as \"05 02 00 01\" or 05020001")
    };
    let mut octets = Vec::new();
    for part in text
        .split(|c: char| c.is_whitespace() || matches!(c, ',' | ':' | '-'))
        .filter(|part| !part.is_empty())
    {
        let digits = part
            .strip_prefix("0x")
            .or_else(|| part.strip_prefix("0X"))
            .unwrap_or(part);
        if digits.is_empty() || digits.len() % 2 == 1 || !digits.is_ascii() {
            return Err(wrong(part));
        }
        for at in (0..digits.len()).step_by(2) {
            let octet = digits
                .get(at..at + 2)
                .and_then(|pair| u8::from_str_radix(pair, 16).ok());
            octets.push(octet.ok_or_else(|| wrong(part))?);
        }
    }
    if octets.is_empty() {
        Err(Failure::usage("there are no octets"))
    } else {
        Ok(octets)
    }
}

fn painted(weight: Weight, text: &str, output: &Output) -> String {
    match weight {
        Weight::Normal => text.to_owned(),
        Weight::Warning => output.paint(Colour::Warning, text),
        Weight::Error => output.paint(Colour::Fault, text),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn octets_in_every_spelling() {
        for text in ["05 02 A0", "0502a0", "05:02:A0", "0x05, 0x02, 0xA0", "05-02-A0"] {
            assert_eq!(parse_hex(text), Ok(vec![5, 2, 0xA0]), "{text}");
        }
        for text in ["", "5", "05 0", "xy", "é0"] {
            assert!(parse_hex(text).is_err(), "{text}");
        }
    }
}

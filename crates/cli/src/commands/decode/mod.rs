//! `profidrive decode --hex "05 02 .."`, and captures.

mod capture;

use client::ErrorKind;
use dissect::Weight;
use dissect::job::{Decoded, Side};
use dissect::octets::{self, Kind, NotDecoded};
use dissect::report::DecodeReport;
use uss::Protocol;

use crate::args::{Decode, Octets, Sender};
use crate::failure::Failure;
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
            output.json_report(&DecodeReport::Octets(&decoded.fields));
            if !output.json() {
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

fn octets(data: &[u8], args: &Decode) -> Result<Decoded, Failure> {
    let request = args.request.as_deref().map(parse_hex).transpose()?;
    let from_controller = args.from.map(|sender| sender == Sender::Controller);
    let kind = match (args.octets, args.telegram) {
        (Some(Octets::Request), _) => Kind::Job(Some(Side::Request)),
        (Some(Octets::Response), _) => Kind::Job(Some(Side::Response)),
        (Some(Octets::Pkw), _) => Kind::Pkw,
        (Some(Octets::PkwFc), _) => Kind::PkwFc,
        (Some(Octets::PkwUss), _) => Kind::PkwUss,
        (Some(Octets::Fc), _) => Kind::Serial(Protocol::Fc),
        (Some(Octets::Uss), _) => Kind::Serial(Protocol::Uss),
        (None, Some(number)) => Kind::Telegram(number),
        (None, None) => Kind::Job(args.from.map(|sender| match sender {
            Sender::Controller => Side::Request,
            Sender::Drive => Side::Response,
        })),
    };
    octets::decode(kind, data, args.model.model, from_controller, request.as_deref()).map_err(|error| {
        let failure = Failure::new(ErrorKind::Local, error.to_string());
        match error {
            NotDecoded::Job(_) if args.octets.is_none() => {
                failure.hint("--as request or --as response says which side it is from")
            }
            _ => failure,
        }
    })
}

/// Octets from text: `05 02`, `0502`, `05:02`, `0x05, 0x02`.
fn parse_hex(text: &str) -> Result<Vec<u8>, Failure> {
    let wrong = |part: &str| {
        Failure::usage(format!("`{part}` is not a hexadecimal octet"))
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

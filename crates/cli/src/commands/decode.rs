//! `profidrive decode --hex "05 02 .."` and `profidrive decode FILE.pcapng`

use std::fs::File;
use std::path::Path;
use std::time::Duration;

use drive_client::Model;
use indicatif::{ProgressBar, ProgressStyle};
use network::pcap::Reader;
use profidrive::pkw::PkwDialect;
use serde_json::Value;
use uss::Protocol;

use crate::args::{Decode, Octets, Sender, Side};
use crate::decode::{Counts, Note, Walker, Weight};
use crate::failure::{Exit, Failure};
use crate::fields;
use crate::job::{self, Decoded, JobDrive};
use crate::output::{Colour, Output};

pub fn run(args: &Decode, output: &Output) -> Result<(), Failure> {
    match (&args.file, &args.hex) {
        (Some(file), _) => capture(file, args.model.model, output),
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
        (None, None) => Err(Failure::usage("give a capture file, or bytes with --hex")),
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

fn capture(path: &Path, model: Option<Model>, output: &Output) -> Result<(), Failure> {
    let shown = path.display();
    let unreadable =
        |error: &dyn std::fmt::Display| Failure::new(Exit::Failed, format!("cannot read {shown}: {error}"));
    let file = File::open(path).map_err(|error| unreadable(&error))?;
    let size = file.metadata().map_or(0, |data| data.len());
    let reader = Reader::new(file).map_err(|error| unreadable(&error))?;
    let bar = progress(size, output);
    let mut walker = Walker::new(model);
    let mut start = None;
    let mut damage = None;
    for captured in reader {
        let captured = match captured {
            Ok(captured) => captured,
            Err(error) => {
                damage = Some(error.to_string());
                break;
            }
        };
        bar.inc(captured.frame.len() as u64 + 32);
        let start = *start.get_or_insert(captured.time);
        let at = captured.time.saturating_sub(start);
        for note in walker.frame(at, &captured.frame) {
            bar.suspend(|| print(&note, output));
        }
    }
    bar.finish_and_clear();
    let counts = walker.counts();
    if output.json() {
        let mut fields = fields! { "end": true };
        fields.extend(counts_json(counts));
        if let Some(damage) = &damage {
            fields.insert("damage".into(), damage.as_str().into());
        }
        output.event("decode", fields);
    } else {
        output.say(&summary(counts));
    }
    match damage {
        Some(damage) => Err(Failure::new(Exit::Failed, format!("{shown}: {damage}"))
            .hint("what is printed above comes from the sound part before it")),
        None => Ok(()),
    }
}

fn progress(size: u64, output: &Output) -> ProgressBar {
    // a terminal that shows the notes needs no bar between them
    if size < 4_000_000 || !output.progress() || output.live() {
        return ProgressBar::hidden();
    }
    let style = ProgressStyle::with_template("{bar:30} {percent:>3}% {bytes}/{total_bytes}");
    ProgressBar::new(size).with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()))
}

fn print(note: &Note, output: &Output) {
    if output.json() {
        let fields = fields! {
            "time": note.at.as_secs_f64(), "from": note.from.as_str(), "to": note.to.as_str(),
            "topic": note.topic, "text": note.text.as_str(), "weight": weight_word(note.weight),
        };
        output.event("decode", fields);
    } else {
        output.line(&line(note, output));
    }
}

const fn weight_word(weight: Weight) -> &'static str {
    match weight {
        Weight::Normal => "normal",
        Weight::Warning => "warning",
        Weight::Error => "error",
    }
}

fn line(note: &Note, output: &Output) -> String {
    let who = if note.to.is_empty() {
        note.from.clone()
    } else {
        format!("{} > {}", note.from, note.to)
    };
    let mark = match note.weight {
        Weight::Normal => " ",
        Weight::Warning => "!",
        Weight::Error => "#",
    };
    let text = painted(
        note.weight,
        &format!("{mark} {:<9} {}", note.topic, note.text),
        output,
    );
    format!("{:>12} {who:<40} {text}", time(note.at))
}

fn painted(weight: Weight, text: &str, output: &Output) -> String {
    match weight {
        Weight::Normal => text.to_owned(),
        Weight::Warning => output.paint(Colour::Warning, text),
        Weight::Error => output.paint(Colour::Fault, text),
    }
}

fn time(at: Duration) -> String {
    format!("{}.{:06}", at.as_secs(), at.subsec_micros())
}

fn summary(counts: Counts) -> String {
    let mut text = format!(
        "{} frames: {} cyclic, {} DCP, {} RPC packets, {} alarm frames",
        counts.frames,
        counts.cyclic + counts.cyclic_unknown,
        counts.dcp,
        counts.rpc,
        counts.alarms
    );
    if counts.cyclic_unknown > 0 {
        text = format!(
            "{text}; {} cyclic frames of connections that began earlier",
            counts.cyclic_unknown
        );
    }
    if counts.malformed > 0 {
        text = format!("{text}; {} malformed", counts.malformed);
    }
    text
}

fn counts_json(counts: Counts) -> serde_json::Map<String, Value> {
    fields! {
        "frames": counts.frames, "cyclic": counts.cyclic, "cyclic_unknown": counts.cyclic_unknown,
        "dcp": counts.dcp, "rpc": counts.rpc, "alarms": counts.alarms, "malformed": counts.malformed,
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

    #[test]
    fn times_have_microseconds() {
        assert_eq!(time(Duration::from_micros(1_000_031)), "1.000031");
    }
}

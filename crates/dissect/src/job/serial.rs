//! Telegrams of serial lines in words: Danfoss FC protocol and USS.

use profile::pkw::{PKW_LEN, Pkw, PkwDialect, TEXT_AT};
use profile::state::Profile;
use serde_json::{Map, Value};
use uss::{Addressee, Layout, Protocol, Telegram};

use super::telegram::Half;
use super::{Decoded, JobDrive, pkw};
use crate::Weight;
use crate::fields;
use crate::{hex_bytes, hex16, words};

/// What a protocol carries.
struct Carrier {
    name: &'static str,
    layout: Layout,
}

const fn carrier(protocol: Protocol) -> Carrier {
    match protocol {
        Protocol::Fc => Carrier {
            name: "FC",
            layout: Layout::FC,
        },
        Protocol::Uss => Carrier {
            name: "USS",
            layout: Layout::USS,
        },
    }
}

/// Returns a whole telegram. Without a direction both are reported.
pub fn decode(
    drive: &JobDrive,
    protocol: Protocol,
    octets: &[u8],
    output: Option<bool>,
) -> Result<Decoded, String> {
    let carrier = carrier(protocol);
    let dialect = drive.line(protocol);
    let telegram = Telegram::decode(octets).map_err(|error| error.to_string())?;
    let whom = match telegram.address.addressee(protocol) {
        Addressee::Slave(number) => format!("slave {number}"),
        Addressee::Mirror(number) => format!("slave {number}, to be mirrored"),
        Addressee::Broadcast => "all slaves".into(),
        Addressee::Special => "a special telegram".into(),
        Addressee::Invalid => "no slave can have this address".into(),
    };
    let check = octets.last().copied().unwrap_or_default();
    let head = format!(
        "{} telegram, address {} ({whom}), {} octets of data, check octet {check:02X} is right",
        carrier.name,
        telegram.address,
        telegram.data.len()
    );
    let mut lines = vec![(Weight::Normal, head)];
    let mut sides = Vec::new();
    let parts = carrier.layout.split(telegram.data).ok_or_else(|| {
        format!(
            "{} octets of data cannot be divided into parameter and process part",
            telegram.data.len()
        )
    })?;
    for side in [true, false] {
        if output.is_some_and(|wanted| wanted != side) {
            continue;
        }
        let channel = pkw::block(&dialect, parts.pkw);
        let mut parts_lines = Vec::new();
        parts_lines.extend(channel.map(|block| parameter(drive, &dialect, parts.pkw, block, side)));
        parts_lines.extend(process(drive, parts.pzd, side));
        let who = if side { "controller" } else { "drive" };
        if output.is_none() {
            lines.push((Weight::Normal, format!("  if from the {who}")));
        }
        let mut fields = fields! {
            "from": who, "lines": parts_lines.iter().map(|(_, line)| line.trim_start()).collect::<Vec<_>>(),
        };
        let reply = channel.filter(|_| !side);
        fields.extend(reply.and_then(|(pkw, _)| pkw::refusal_json(&dialect, pkw)));
        sides.push(Value::Object(fields));
        lines.extend(parts_lines);
    }
    let fields: Map<String, Value> = fields! {
        "protocol": carrier.name.to_ascii_lowercase(), "model": drive.name(), "address": telegram.address.0,
        "addressee": whom, "data": hex_bytes(telegram.data), "check": check, "sides": sides,
    };
    Ok(Decoded {
        lines,
        fields,
        refused: Vec::new(),
    })
}

fn row(name: &str, text: &str) -> String {
    format!("  {name:<8} {text}")
}

/// Returns the parameter part: PKE, IND and PWE, or a text in its place.
fn parameter(
    drive: &JobDrive,
    dialect: &PkwDialect,
    part: &[u8],
    (pkw, text): (Pkw, Option<&[u8]>),
    output: bool,
) -> (Weight, String) {
    let (weight, line) = if output {
        pkw::request(drive, dialect, pkw, text)
    } else {
        pkw::reply(drive, dialect, pkw, text)
    };
    let short = text.is_none() && part.len() != PKW_LEN;
    let note = if short {
        let head = part.get(..TEXT_AT).unwrap_or(part);
        format!(" (parameter part of {} octets: {})", part.len(), hex_bytes(head))
    } else {
        String::new()
    };
    (weight, row("PKW", &format!("{line}{note}")))
}

/// Control or status word and speed, then further words.
fn process(drive: &JobDrive, part: &[u8], output: bool) -> Vec<(Weight, String)> {
    let half = Half {
        drive,
        telegram: drive.telegram(103),
        output,
    };
    // the words of telegram 103 (PPO 3) are those of the serial process part
    if half.telegram.is_some() && part.len() == 4 {
        return half.lines(part);
    }
    let profile = Profile::Profidrive;
    let mode = drive.mode();
    part.chunks_exact(2)
        .enumerate()
        .filter_map(|(at, octets)| {
            let word = u16::from_be_bytes(octets.try_into().ok()?);
            let name = format!("PZD {}", at + 1);
            let text = match (at, output) {
                (0, true) => format!(
                    " {} {}",
                    words::control_meaning(profile, mode, word),
                    words::set(profile.control_bits(mode), word)
                ),
                (0, false) => format!(
                    " {} {}",
                    words::status_meaning(profile, word, None),
                    words::set(profile.status_bits(mode), word)
                ),
                _ => String::new(),
            };
            Some((Weight::Normal, row(&name, &format!("{}{text}", hex16(word)))))
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn octets(text: &str) -> Vec<u8> {
        text.split(' ')
            .map(|octet| u8::from_str_radix(octet, 16).unwrap())
            .collect()
    }

    fn decoded(protocol: Protocol, text: &str, output: Option<bool>) -> String {
        let drive = match protocol {
            Protocol::Fc => JobDrive::of(0x0080, 1),
            Protocol::Uss => JobDrive::of(0, 0),
        };
        let decoded = decode(&drive, protocol, &octets(text), output).unwrap();
        decoded.lines.into_iter().map(|(_, line)| line + "\n").collect()
    }

    #[test]
    fn the_worked_examples_of_the_fc_protocol() {
        let text = decoded(Protocol::Fc, "02 06 81 04 7C 20 00 DD", Some(true));
        assert!(
            text.starts_with(
                "FC telegram, address 0x81 (slave 1), 4 octets of data, check octet DD is right\n"
            ),
            "{text}"
        );
        assert!(
            text.contains("CTW      0x047C run: follows the setpoint ["),
            "{text}"
        );
        assert!(
            text.contains("MRV      50 %, 750 rpm if a reference of 1500 rpm"),
            "{text}"
        );
        let read = "02 0E 81 15 FA 00 01 00 00 00 00 00 00 00 00 63";
        let text = decoded(Protocol::Fc, read, Some(true));
        assert!(
            text.contains("PKW      request value: Fault Log: Error Code (15-30[1])"),
            "{text}"
        );
        let write = "02 0E 81 E1 9E 00 00 00 00 03 E8 00 00 00 00 19";
        let text = decoded(Protocol::Fc, write, Some(true));
        assert!(text.contains("(4-14) = 100 Hz"), "{text}");
        let refused = "02 0E 81 75 FA 00 01 00 00 00 00 06 03 00 00 06";
        let text = decoded(Protocol::Fc, refused, None);
        assert!(
            text.contains("if from the controller") && text.contains("if from the drive"),
            "{text}"
        );
        assert!(
            text.contains("refused: 0 parameter number does not exist"),
            "{text}"
        );
    }

    #[test]
    fn text_blocks_have_characters() {
        let mut telegram = [0; 32];
        let mut data = vec![0xF6, 0x04, 0x04, 0x00];
        data.extend(b"FC-302");
        data.extend([0x06, 0x03, 0, 0]);
        let length = Telegram {
            address: uss::Address(0x81),
            data: &data,
        }
        .encode(&mut telegram)
        .unwrap();
        let decoded = decode(
            &JobDrive::of(0x0080, 1),
            Protocol::Fc,
            &telegram[..length],
            Some(false),
        )
        .unwrap();
        let text: String = decoded.lines.into_iter().map(|(_, line)| line + "\n").collect();
        assert!(text.contains("(15-40") && text.contains("= \"FC-302\""), "{text}");
    }

    #[test]
    fn uss_of_a_drive_without_tables() {
        let mut telegram = [0; 32];
        let data = [0x12, 0xBC, 0, 2, 0, 0, 0, 0, 0x04, 0x7F, 0x40, 0];
        let length = Telegram {
            address: uss::Address(3),
            data: &data,
        }
        .encode(&mut telegram)
        .unwrap();
        let decoded = decode(
            &JobDrive::of(0, 0),
            Protocol::Uss,
            &telegram[..length],
            Some(true),
        )
        .unwrap();
        let text: String = decoded.lines.into_iter().map(|(_, line)| line + "\n").collect();
        assert!(text.contains("slave 3"), "{text}");
        assert!(text.contains("request value: 0700[2]"), "{text}");
        assert!(
            text.contains("PZD 1    0x047F run: follows the setpoint"),
            "{text}"
        );
    }

    #[test]
    fn damage_is_reported_with_its_position() {
        let drive = JobDrive::of(0x0080, 1);
        let error = |text| decode(&drive, Protocol::Fc, &octets(text), None).unwrap_err();
        assert_eq!(
            error("02 06 81 04 7C 20 00 DC"),
            "BCC at offset 7 is 0xDC, expected 0xDD"
        );
        assert!(error("02 07 81 04 7C 20 00 DC").contains("LGE at offset 1 says 9 octets"));
        assert!(error("03 06 81 04 7C 20 00 DC").contains("expected STX"));
    }

    proptest::proptest! {
        #[test]
        fn any_telegram_gives_an_answer(data in proptest::collection::vec(proptest::prelude::any::<u8>(), 0..60), address: u8) {
            let mut telegram = [0; 80];
            let length = Telegram { address: uss::Address(address), data: &data }.encode(&mut telegram).unwrap();
            for protocol in [Protocol::Fc, Protocol::Uss] {
                for drive in [JobDrive::default(), JobDrive::of(0x0080, 1), JobDrive::of(0, 0)] {
                    let _ = decode(&drive, protocol, &telegram[..length], None);
                    let _ = decode(&drive, protocol, &data, None);
                }
            }
        }
    }
}

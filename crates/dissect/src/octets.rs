//! Decodes octets without their frame: type and contents.

use profile::model::Model;
use profinet::wire::Reader;
use uss::Protocol;

use crate::capture::contents;
use crate::job::{self, Decoded, JobDrive, NoJob, Side};

/// What octets are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// A parameter job (base mode parameter access); without a side it is guessed.
    Job(Option<Side>),
    /// The eight octets of the parameter channel in a PPO.
    Pkw,
    /// The parameter channel of the Danfoss FC protocol, where the index stands elsewhere and a text (AK 15) in the
    /// place of PWE.
    PkwFc,
    /// The parameter channel of USS.
    PkwUss,
    /// A telegram of a serial line.
    Serial(Protocol),
    /// Cyclic data of the telegram with this number.
    Telegram(u16),
}

/// Returns what is in a record of this index, in words; `None` where its layout is not known here.
///
/// ```
/// use profidrive_dissect::octets::record;
/// assert!(record(0xAFF0, &[0]).unwrap().starts_with("malformed"));
/// assert_eq!(record(0x1234, &[0]), None);
/// ```
#[must_use]
pub fn record(index: u16, data: &[u8]) -> Option<String> {
    contents::describe(index, Reader::new(data)).map(|content| content.text)
}

/// Octets that are not what they were taken for.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum NotDecoded {
    /// No parameter job.
    #[error(transparent)]
    Job(#[from] NoJob),
    /// No such telegram or parameter channel.
    #[error("not a valid telegram: {0}")]
    Telegram(String),
}

/// Decodes octets of a drive of this model; without a model those of the drive that usually sends them. `from_controller`
/// says who sent them, where that is known; `request` is what a response answers.
///
/// ```
/// use profidrive_dissect::octets::{self, Kind};
/// let decoded = octets::decode(Kind::Serial(uss::Protocol::Fc), &[0x02, 0x06, 0x81, 0x04, 0x7C, 0x20, 0x00, 0xDD], None, None, None)?;
/// assert!(decoded.lines[0].1.starts_with("FC telegram, address 0x81"));
/// # Ok::<(), octets::NotDecoded>(())
/// ```
///
/// # Errors
/// When the octets are not valid for this type.
pub fn decode(
    kind: Kind,
    octets: &[u8],
    model: Option<Model>,
    from_controller: Option<bool>,
    request: Option<&[u8]>,
) -> Result<Decoded, NotDecoded> {
    let drive = |usual: &str| {
        model
            .or_else(|| Model::by_name(usual))
            .map_or_else(JobDrive::default, JobDrive::new)
    };
    let channel = |usual, line: Option<Protocol>| {
        let drive = drive(usual);
        let from_controller = from_controller.or(request.map(|_| false));
        let dialect = line.map_or(*drive.ppo(), |protocol| drive.line(protocol));
        job::pkw::decode(&drive, &dialect, octets, from_controller)
    };
    let decoded = match kind {
        Kind::Job(side) => return Ok(job::decode(&mut drive("akd"), octets, side, request)?),
        Kind::Pkw => channel("standard", None),
        Kind::PkwFc => channel("vlt", Some(Protocol::Fc)),
        Kind::PkwUss => channel("standard", Some(Protocol::Uss)),
        Kind::Serial(protocol) => {
            let usual = match protocol {
                Protocol::Fc => "vlt",
                Protocol::Uss => "standard",
            };
            job::serial::decode(&drive(usual), protocol, octets, from_controller)
        }
        Kind::Telegram(number) => {
            job::telegram::decode(&drive(model_with(number)), number, octets, from_controller)
        }
    };
    decoded.map_err(NotDecoded::Telegram)
}

/// Returns the model that a telegram can only be from; an AKD where it is one of the profile or of several vendors.
fn model_with(telegram: u16) -> &'static str {
    let has = |name: &&str| {
        let model = Model::by_name(name).map(JobDrive::new);
        model.is_some_and(|model| model.telegram(telegram).is_some())
    };
    let mut having = Model::names().filter(has);
    match (having.next(), having.next()) {
        (Some(only), None) => only,
        _ => "akd",
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::Value;

    fn decoded(kind: Kind, model: &str, hex: &str) -> Decoded {
        let octets = hex.split(' ').map(|octet| u8::from_str_radix(octet, 16).unwrap());
        let octets: Vec<u8> = octets.collect();
        decode(kind, &octets, Model::by_name(model), Some(false), None).unwrap()
    }

    /// The list of the Danfoss parameter block holds over USS too, and every kind has it for programs.
    #[test]
    fn a_refusal_has_its_number_meaning_and_remedy_on_every_carrier() {
        let fc =
            |number: &str, check: &str| format!("02 0E 01 71 55 00 00 00 00 00 {number} 06 03 00 00 {check}");
        let number = |number: &str| format!("71 55 00 00 00 00 00 {number}");
        let of_side: fn(&Value) -> &Value = |fields| &fields["sides"][0]["error"];
        for (kind, hex, error) in [
            (Kind::Serial(Protocol::Uss), fc("83", "AF"), of_side),
            (Kind::Serial(Protocol::Fc), fc("83", "AF"), of_side),
            (Kind::PkwUss, number("83"), of_side),
            (Kind::PkwFc, number("83"), of_side),
            (Kind::Pkw, number("83"), of_side),
            (
                Kind::Telegram(101),
                format!("{} 06 03 00 00", number("83")),
                |fields| &fields["halves"][0]["error"],
            ),
        ] {
            let decoded = decoded(kind, "vlt", &hex);
            let meaning = "131 change not possible, the factory setup is selected";
            let named = decoded.lines.iter().any(|(weight, line)| {
                *weight == crate::Weight::Error && line.contains(&format!("refused: {meaning}; "))
            });
            assert!(named, "{kind:?}: {:?}", decoded.lines);
            let fields = Value::Object(decoded.fields);
            let error = error(&fields);
            assert_eq!(
                (&error["number"], &error["meaning"]),
                (&131.into(), &meaning.into()),
                "{kind:?}"
            );
            assert!(error["remedy"].is_string(), "{kind:?}: {error}");
        }
        for (code, words) in [("82", "130 no bus access"), ("FD", "253 ")] {
            let decoded = decoded(Kind::PkwUss, "vlt", &number(code));
            assert!(decoded.lines[0].1.contains(words) && !decoded.lines[0].1.contains("own number"));
        }
        // a value and a request of the controller are not refusals
        let value = decoded(Kind::PkwUss, "vlt", "21 55 00 00 00 00 00 83");
        assert!(value.fields["sides"][0]["error"].is_null());
        // the numbers of the others are not Danfoss'
        let other = decoded(Kind::PkwUss, "standard", &number("83"));
        assert!(
            other.lines[0].1.contains("(vendor-specific number)"),
            "{:?}",
            other.lines
        );
    }
}

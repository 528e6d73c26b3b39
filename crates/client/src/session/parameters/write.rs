//! Writing parameters in few requests, and new values as they travel.

use profile::parameter::{
    Answer, Format, NewValue, ParameterAddress, RequestId, Response, ResponseError, encode_change_as,
    plan_changes,
};

use super::{MAX_REQUEST, malformed, refusal};
use crate::change::{Change, Outgoing};
use crate::session::Session;
use crate::wide::halves;
use crate::{Drive, Error, Refusal};
use profile::value::{CheckedValue, Interpretation, ParameterProblem, Reading, Selection};

/// A piece of a new value: all of it, or one half of a 64-bit value.
struct Part<'a> {
    /// Which of the new values.
    at: usize,
    address: ParameterAddress,
    octets: Vec<u8>,
    value: &'a Outgoing,
}

impl Session {
    /// Writes values with one request; they must fit into one ([`plan_changes`]). One answer for each.
    pub(in crate::session) async fn change(
        &mut self,
        drive: &Drive,
        outgoing: &[Outgoing],
    ) -> Result<Vec<Result<(), Refusal>>, Error> {
        self.change_as(RequestId::Change, drive, outgoing).await
    }

    /// The same with a request of this ID.
    pub(in crate::session) async fn change_as(
        &mut self,
        id: RequestId,
        drive: &Drive,
        outgoing: &[Outgoing],
    ) -> Result<Vec<Result<(), Refusal>>, Error> {
        let mut parts = Vec::new();
        for (at, value) in outgoing.iter().enumerate() {
            let pieces = halves(&value.selection, value.octets.clone());
            parts.extend(pieces.into_iter().map(|(address, octets)| Part {
                at,
                address,
                octets,
                value,
            }));
        }
        let mut answers = vec![Ok(()); outgoing.len()];
        // The caller has seen to the size of the request; only values of two numbers make it longer.
        let sizes: Vec<usize> = parts.iter().map(|part| part.octets.len()).collect();
        for group in plan_changes(&sizes, drive.model.dialect) {
            self.change_parts(id, drive, parts.get(group).unwrap_or_default(), &mut answers)
                .await?;
        }
        Ok(answers)
    }

    async fn change_parts(
        &mut self,
        id: RequestId,
        drive: &Drive,
        parts: &[Part<'_>],
        answers: &mut [Result<(), Refusal>],
    ) -> Result<(), Error> {
        let dialect = drive.model.dialect;
        let values: Vec<NewValue<'_>> = parts
            .iter()
            .map(|part| NewValue {
                address: part.address,
                format: part.value.format,
                count: part.value.count,
                data: &part.octets,
            })
            .collect();
        let addresses: Vec<ParameterAddress> = values.iter().map(|value| value.address).collect();
        let mut buffer = [0; MAX_REQUEST];
        let reference = self.next_reference();
        let length = encode_change_as(id, reference, dialect, &values, &mut buffer)
            .map_err(|error| malformed(drive, &error))?;
        let answered = self.job(drive, buffer.get(..length).unwrap_or_default()).await?;
        let response = Response::parse(&answered.octets, id, reference, &addresses, dialect).map_err(
            |error| match error {
                ResponseError::Refused(error) if error.number == dialect.bad_request.1 => {
                    Error::UnknownRequest {
                        drive: drive.label(),
                        id: id.octet(),
                        words: error.number.words(dialect.error_names),
                    }
                }
                error => malformed(drive, &error),
            },
        )?;
        for ((at, part), answer) in parts.iter().enumerate().zip(response.answers()) {
            if let (Answer::Error(error), Some(place)) = (answer, answers.get_mut(part.at)) {
                let selection = &part.value.selection;
                let channel = self.channel_refusal(answered.cause(at));
                *place = Err(refusal(drive, selection, 0, true, error, channel));
            }
        }
        Ok(())
    }
}

/// A new value, checked against the tables.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::session) enum NewContent {
    /// A number.
    Number(CheckedValue),
    /// Characters of a string; blanks fill the rest.
    Text(String),
}

/// The change to a new value, as the drive takes it, from the old one.
///
/// # Errors
/// When the number does not fit, or the drive did not report in which size it takes the value.
pub(in crate::session) fn planned(
    drive: &Drive,
    selection: Selection,
    content: NewContent,
    old: Option<Result<Reading, Refusal>>,
) -> Result<Change, Error> {
    let (format, octets, rounding) = match content {
        NewContent::Number(value) => {
            let (format, octets) = encode(drive, &selection, value, old.as_ref())?;
            (format, octets, Some(value))
        }
        NewContent::Text(text) => {
            let length = selection.parameter.map_or(0, |parameter| parameter.length);
            let mut octets = text.into_bytes();
            octets.resize(length.into(), b' ');
            (Format::VISIBLE_STRING, octets, None)
        }
    };
    let interpretation = Interpretation::of(format, drive.model.dialect.code_space);
    let new = drive
        .parameters
        .reading(&selection, 0, format.0, interpretation, &octets);
    let mut change = Change::new(&drive.parameters, selection, new);
    (change.old, change.rounding) = (old, rounding);
    Ok(change)
}

/// Format and octets of a number: by the table, else as the drive sent the old one.
fn encode(
    drive: &Drive,
    selection: &Selection,
    value: CheckedValue,
    old: Option<&Result<Reading, Refusal>>,
) -> Result<(Format, Vec<u8>), Error> {
    let CheckedValue { raw, engineering, .. } = value;
    let model = &drive.model;
    let (format, width) = match (selection.parameter, old) {
        // a description does not define in which format the drive takes the value
        (Some(_), Some(Ok(old))) if model.learned => (Format(old.format), old.octets.len()),
        (Some(parameter), _) => (parameter.format_in(model.dialect), parameter.octets()),
        (None, Some(Ok(old))) => (Format(old.format), old.octets.len()),
        (None, Some(Err(refusal))) => {
            return Err(Error::Refused {
                drive: drive.label(),
                refusal: *refusal,
            });
        }
        (None, None) => (Format::WORD, 2),
    };
    if format == Format::FLOAT32 {
        #[expect(clippy::cast_possible_truncation, reason = "the drive holds a single")]
        let single = engineering as f32;
        return Ok((format, single.to_be_bytes().to_vec()));
    }
    let bits = 8 * u32::try_from(width).unwrap_or(8);
    let fits = width <= 8 && (bits >= 64 || (-(1_i64 << (bits - 1)) <= raw && raw < 1_i64 << bits));
    if !fits || width == 0 {
        return Err(ParameterProblem::RawSize {
            parameter: selection.label(),
            raw: raw.cast_unsigned(),
            octets: width,
        }
        .into());
    }
    let octets = raw.to_be_bytes();
    Ok((
        format,
        octets.get(octets.len() - width..).unwrap_or_default().to_vec(),
    ))
}

#[cfg(test)]
mod tests {
    use super::*;
    use profile::catalogue::{Scaling, VLT};
    use profile::model::Model;
    use profile::value::{Assignment, Parameters};
    use profinet::controller::Station;

    /// A value on its way to a drive of this model.
    fn sent(model: &str, text: &str) -> (Format, Vec<u8>) {
        let drive = Drive::new(Station::default()).as_model(Model::by_name(model).unwrap());
        let assignment: Assignment = text.parse().unwrap();
        let tables = &drive.parameters;
        let selection = tables.select(&assignment.reference).unwrap();
        let content = match tables.check_text(&selection, &assignment.value).unwrap() {
            Some(text) => NewContent::Text(text),
            None => NewContent::Number(tables.check(&selection, &assignment.value).unwrap()),
        };
        let new = planned(&drive, selection, content, None).unwrap().new;
        (Format(new.format), new.octets)
    }

    #[test]
    fn values_travel_in_the_size_of_their_parameter() {
        assert_eq!(sent("akd", "930=2"), (Format::WORD, vec![0, 2]));
        assert_eq!(sent("akd", "DRV.OPMODE=1"), (Format::BYTE, vec![1]));
        assert_eq!(
            sent("akd", "DRV.ACC=5000"),
            (Format::DOUBLE_WORD, vec![0, 0, 0, 0, 0, 0x4C, 0x4B, 0x40])
        );
        assert_eq!(sent("akd", "1004=-60").1, [0xFF, 0x5C]);
    }

    #[test]
    fn values_are_sent_in_the_formats_of_their_vendor() {
        let vlt = |text: &str| sent("vlt", text);
        assert_eq!(vlt("3-41=5s"), (Format::UNSIGNED32, vec![0, 0, 0x01, 0xF4]));
        assert_eq!(vlt("8-10=1"), (Format::UNSIGNED8, vec![1]));
        assert_eq!(
            vlt("0-37=HELLO WORLD"),
            (Format::VISIBLE_STRING, b"HELLO WORLD              ".to_vec())
        );
        assert_eq!(vlt("0-37=\"\"").1, [b' '; 25]);
        assert_eq!(vlt("1-20=0.75kW"), (Format::UNSIGNED32, vec![0, 0, 0, 75]));
        let vacon = |text: &str| sent("vacon", text);
        assert_eq!(vacon("ID103=5s"), (Format::WORD, vec![0, 50]));
        assert_eq!(vacon("102=50Hz"), (Format::WORD, vec![0x13, 0x88]));
        let error = |text: &str| {
            let tables = Parameters {
                catalogue: Some(&VLT),
                scaling: Scaling::default(),
            };
            let assignment: Assignment = text.parse().unwrap();
            let selection = tables.select(&assignment.reference).unwrap();
            let text = tables.check_text(&selection, &assignment.value);
            let problem = text.and_then(|_| tables.check(&selection, &assignment.value));
            problem.unwrap_err().to_string()
        };
        assert!(error("0-37=Grüße").contains("'ü' is not a printable ASCII character"));
        assert!(error("0-37=12345678901234567890123456").contains("holds 25 characters, not 26"));
        assert!(error("15-41=x").contains("is read-only"));
        assert!(
            error("15-40=1").contains("(15-40) is read-only"),
            "{}",
            error("15-40=1")
        );
        assert!(
            error("3-41=5A").contains("unit of current"),
            "{}",
            error("3-41=5A")
        );
        assert!(
            error("14-21=601s").contains("outside 0 to 600 s"),
            "{}",
            error("14-21=601s")
        );
    }
}

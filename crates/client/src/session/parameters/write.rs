//! Writing parameters: values checked first, in few requests, read back after.

use profile::catalogue::{Access, Parameter, Phase, Role};
use profile::parameter::{
    Answer, Format, Keep, NewValue, ParameterAddress, RequestId, Response, ResponseError, Saving,
    encode_change_as, plan_changes, pnu,
};

use super::{MAX_REQUEST, malformed, needs_scaling, refusal};
use crate::session::Session;
use crate::wide::halves;
use crate::{Drive, Error, Refusal};
use profile::model::Model;
use profile::value::{Assignment, CheckedValue, Content, ParameterProblem, Reading, Selection, is_scaling};

/// Write, or only check and show.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum WriteMode {
    /// Nothing is sent but reads.
    DryRun,
    /// Values are written and read back.
    Write,
    /// The same, and the drive is told to keep them over a power cycle.
    Save,
}

/// A change that was checked against the tables and compared with the present value.
#[derive(Debug, Clone)]
pub struct PlannedChange {
    /// Where to.
    pub selection: Selection,
    /// What.
    pub value: PlannedValue,
}

/// A new value.
#[derive(Debug, Clone, PartialEq)]
pub enum PlannedValue {
    /// A number.
    Number(CheckedValue),
    /// Characters of a string; blanks fill the rest.
    Text(String),
}

impl PlannedValue {
    /// The number; `None` for a string.
    #[must_use]
    pub const fn number(&self) -> Option<CheckedValue> {
        match self {
            Self::Number(value) => Some(*value),
            Self::Text(_) => None,
        }
    }

    /// True when a drive that reads like this has the value.
    fn is_in(&self, content: &Content) -> bool {
        match (self, content) {
            (Self::Number(value), Content::Number { raw, .. }) => *raw == i128::from(value.raw),
            (Self::Number(value), Content::Float(read)) => {
                (read - value.engineering).abs() <= read.abs() * 1e-6
            }
            (Self::Text(text), Content::Text(read)) => read.trim_end() == text.trim_end(),
            _ => false,
        }
    }
}

/// What became of a change.
#[derive(Debug, Clone)]
pub struct ChangeOutcome {
    /// Where to and what.
    pub change: PlannedChange,
    /// The value before; `None` for a command, which has none.
    pub old: Option<Result<Reading, Refusal>>,
    /// How the write ended; `None` where nothing was sent: in a dry run, and for the command that saves where a value was
    /// refused.
    pub written: Option<Result<(), Refusal>>,
    /// The value read back; `None` for a command, a dry run or a refused write.
    pub new: Option<Result<Reading, Refusal>>,
    /// Writing it does something (MT.CLEAR, MT.MOVE): what it reads as afterwards says nothing about success.
    pub acts: bool,
}

impl ChangeOutcome {
    /// True when the drive had this value before.
    #[must_use]
    pub fn is_same(&self) -> bool {
        let old = self.old.as_ref().and_then(|old| old.as_ref().ok());
        !self.acts && old.is_some_and(|old| self.change.value.is_in(&old.content))
    }

    /// True when the value read back is another one than written; never for something that acts.
    #[must_use]
    pub fn differs(&self) -> bool {
        if self.acts {
            return false;
        }
        let Some(Ok(new)) = &self.new else { return false };
        !self.change.value.is_in(&new.content)
    }
}

/// One value on its way to a drive.
#[derive(Debug, Clone)]
pub struct Outgoing {
    pub selection: Selection,
    pub format: Format,
    /// Number of values; of octets for a string.
    pub count: u8,
    pub octets: Vec<u8>,
}

/// A piece of a new value: all of it, or one half of a 64-bit value.
struct Part<'a> {
    /// Which of the new values.
    at: usize,
    address: ParameterAddress,
    octets: Vec<u8>,
    value: &'a Outgoing,
}

impl Session {
    /// Checks all assignments against the tables, reads the present values, and, unless it is a dry run, writes and
    /// reads back. Nothing is written when one of them is wrong.
    ///
    /// Returns one outcome for each assignment. With [`WriteMode::Save`], the command that saves follows as one more where the
    /// drive needs a command; it is not sent where a value was refused.
    ///
    /// # Errors
    /// A wrong assignment, a unit or scaling while the power stage is on, or a drive that cannot be reached. A refused write is told in the outcome.
    pub async fn write(
        &mut self,
        drive: &mut Drive,
        assignments: &[Assignment],
        mode: WriteMode,
    ) -> Result<Vec<ChangeOutcome>, Error> {
        let dialect = drive.model.dialect;
        let command = match (mode, dialect.saving) {
            (WriteMode::Save, Saving::Command) => Some(save_command(drive)?),
            _ => None,
        };
        let mut changes = Vec::new();
        for assignment in assignments {
            let selection = drive.parameters.select(&assignment.reference)?;
            if needs_scaling(&selection) {
                self.read_scaling(drive).await?;
            }
            let value = match drive.parameters.check_text(&selection, &assignment.value)? {
                Some(text) => PlannedValue::Text(text),
                None => PlannedValue::Number(drive.parameters.check(&selection, &assignment.value)?),
            };
            if changes.iter().any(|other: &PlannedChange| {
                (other.selection.pnu, other.selection.first) == (selection.pnu, selection.first)
            }) {
                return Err(ParameterProblem::Twice {
                    parameter: selection.label(),
                }
                .into());
            }
            changes.push(PlannedChange { selection, value });
        }
        let scales = |change: &PlannedChange| scales_setpoints(drive, &change.selection);
        if mode != WriteMode::DryRun
            && changes.iter().any(scales)
            && self.is_enabled(drive).await? == Some(true)
        {
            return Err(Error::NotAtRest {
                drive: drive.label(),
                what: "the power stage is on and another scale would give its setpoints another meaning",
            });
        }
        let readable: Vec<Selection> = changes
            .iter()
            .map(|change| change.selection)
            .filter(|selection| !is_command(selection))
            .collect();
        let mut old = self.read(drive, &readable).await?.into_iter();
        let mut outcomes: Vec<ChangeOutcome> = changes
            .into_iter()
            .map(|change| {
                let command = is_command(&change.selection);
                let old = if command { None } else { old.next() };
                let pnu = change.selection.pnu;
                let base = change.selection.parameter.and_then(|parameter| parameter.base);
                let role = drive
                    .model
                    .catalogue
                    .map(|tables| tables.backup_rule_at(pnu, base).role);
                ChangeOutcome {
                    change,
                    old,
                    written: None,
                    new: None,
                    acts: command || matches!(role, Some(Role::Action | Role::Save | Role::ClearFaults)),
                }
            })
            .collect();
        if mode == WriteMode::DryRun {
            return Ok(outcomes);
        }
        let id = match mode {
            WriteMode::Save => dialect.change_id(Keep::Permanent),
            WriteMode::Write | WriteMode::DryRun => None,
        };
        let mut command = command;
        match id.filter(|id| *id != RequestId::Change) {
            Some(id) if !self.takes_request(drive, &mut outcomes, id).await? => {
                // the drive has no request that saves: its command does, where it has one
                command = Some(save_command(drive)?);
                self.write_outcomes(drive, &mut outcomes, RequestId::Change)
                    .await?;
            }
            Some(_) => {}
            None => {
                self.write_outcomes(drive, &mut outcomes, RequestId::Change)
                    .await?
            }
        }
        let mut back: Vec<Selection> = Vec::new();
        for outcome in &outcomes {
            if matches!(outcome.written, Some(Ok(()))) && !is_command(&outcome.change.selection) {
                back.push(outcome.change.selection);
            }
        }
        // a change of a value that scales others counts from here on
        let scales = |selection: &Selection| {
            let known = selection.parameter.zip(drive.model.catalogue);
            known.is_some_and(|(parameter, tables)| is_scaling(tables, parameter))
        };
        drive.scaled &= !back.iter().any(scales);
        let mut new = self.read(drive, &back).await?.into_iter();
        for outcome in &mut outcomes {
            if matches!(outcome.written, Some(Ok(()))) && !is_command(&outcome.change.selection) {
                outcome.new = new.next();
            }
        }
        let done = outcomes
            .iter()
            .all(|outcome| matches!(outcome.written, Some(Ok(()))));
        if let Some(mut command) = command {
            // what was refused is not kept by halves
            if done {
                self.write_outcomes(drive, std::slice::from_mut(&mut command), RequestId::Change)
                    .await?;
            }
            outcomes.push(command);
        }
        Ok(outcomes)
    }

    /// Writes with a request of the vendor's own; false where the drive does not know that request, and nothing is
    /// written.
    async fn takes_request(
        &mut self,
        drive: &Drive,
        outcomes: &mut [ChangeOutcome],
        id: RequestId,
    ) -> Result<bool, Error> {
        match self.write_outcomes(drive, outcomes, id).await {
            Err(Error::UnknownRequest { .. }) => Ok(false),
            other => other.map(|()| true),
        }
    }

    async fn write_outcomes(
        &mut self,
        drive: &Drive,
        outcomes: &mut [ChangeOutcome],
        id: RequestId,
    ) -> Result<(), Error> {
        let mut encoded = Vec::new();
        for outcome in outcomes.iter() {
            encoded.push(outgoing(outcome, &drive.model)?);
        }
        let sizes: Vec<usize> = encoded.iter().map(|value| value.octets.len()).collect();
        for group in plan_changes(&sizes, drive.model.dialect) {
            let answers = self
                .change_as(id, drive, encoded.get(group.clone()).unwrap_or_default())
                .await?;
            for (at, answer) in group.zip(answers) {
                if let Some(outcome) = outcomes.get_mut(at) {
                    outcome.written = Some(answer);
                }
            }
        }
        Ok(())
    }

    /// Writes values with one request; they must fit into one ([`plan_changes`]). One answer for each.
    pub(in crate::session) async fn change(
        &mut self,
        drive: &Drive,
        outgoing: &[Outgoing],
    ) -> Result<Vec<Result<(), Refusal>>, Error> {
        self.change_as(RequestId::Change, drive, outgoing).await
    }

    async fn change_as(
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

/// The command that lets a drive keep its values, as a change; 1 executes it in every make.
fn save_command(drive: &Drive) -> Result<ChangeOutcome, Error> {
    let parameter = saver(drive)?;
    let selection = Selection::of(parameter, drive.parameters.notation());
    let value = PlannedValue::Number(CheckedValue {
        raw: 1,
        engineering: 1.0,
        asked: 1.0,
        unit: "",
    });
    Ok(ChangeOutcome {
        change: PlannedChange { selection, value },
        old: None,
        written: None,
        new: None,
        acts: true,
    })
}

/// The parameter that saves all settings: the maker's, else that of the profile.
pub(in crate::session) fn saver(drive: &Drive) -> Result<&'static Parameter, Error> {
    let tables = drive.model.catalogue;
    tables
        .and_then(|tables| tables.with_role(Role::Save).or_else(|| tables.by_pnu(pnu::SAVE)))
        .ok_or_else(|| Error::UnknownModel {
            drive: drive.label(),
            what: "how to save its parameters",
            vendor_id: drive.station.vendor_id,
            device_id: drive.station.device_id,
        })
}

/// Units and scalings decide what setpoints mean, also those of an axis that runs.
fn scales_setpoints(drive: &Drive, selection: &Selection) -> bool {
    let (Some(tables), Some(parameter)) = (drive.model.catalogue, selection.parameter) else {
        return false;
    };
    let rule = tables.backup_rule_at(parameter.pnu, parameter.base);
    // the profile has numbers of its own for some of them
    rule.phase == Phase::Scaling || (matches!(rule.role, Role::Alias { .. }) && is_scaling(tables, parameter))
}

fn is_command(selection: &Selection) -> bool {
    selection
        .parameter
        .is_some_and(|parameter| parameter.access == Access::WriteOnly)
}

/// A new value as it is sent.
fn outgoing(outcome: &ChangeOutcome, model: &Model) -> Result<Outgoing, Error> {
    let selection = outcome.change.selection;
    let (format, count, octets) = match &outcome.change.value {
        PlannedValue::Number(value) => {
            let (format, octets) = encode(outcome, *value, model)?;
            (format, 1, octets)
        }
        PlannedValue::Text(text) => {
            let length = selection.parameter.map_or(0, |parameter| parameter.length);
            let mut octets = text.clone().into_bytes();
            octets.resize(length.into(), b' ');
            let count = u8::try_from(octets.len()).unwrap_or(u8::MAX);
            (Format::VISIBLE_STRING, count, octets)
        }
    };
    Ok(Outgoing {
        selection,
        format,
        count,
        octets,
    })
}

/// Format and octets of a number: by the table, else as the drive sent the old one.
fn encode(outcome: &ChangeOutcome, value: CheckedValue, model: &Model) -> Result<(Format, Vec<u8>), Error> {
    let CheckedValue { raw, engineering, .. } = value;
    let (format, width) = match (outcome.change.selection.parameter, &outcome.old) {
        // a description does not say in which format the drive takes the value
        (Some(_), Some(Ok(old))) if model.learned => (Format(old.format), old.octets.len()),
        (Some(parameter), _) => (parameter.format_in(model.dialect), parameter.octets()),
        (None, Some(Ok(old))) => (Format(old.format), old.octets.len()),
        (None, Some(Err(refusal))) => {
            return Err(Error::Refused {
                drive: outcome.change.selection.label(),
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
        let parameter = outcome.change.selection.label();
        return Err(ParameterProblem::RawSize {
            parameter,
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
    use profile::catalogue::{AKD, Catalogue, Scaling, VACON, VLT};
    use profile::value::Parameters;

    fn akd() -> Model {
        Model::by_name("akd").unwrap()
    }

    fn sent(outcome: &ChangeOutcome, model: &Model) -> (Format, Vec<u8>) {
        let value = outgoing(outcome, model).unwrap();
        (value.format, value.octets)
    }

    fn outcome(text: &str) -> ChangeOutcome {
        outcome_of(&AKD, text)
    }

    fn outcome_of(catalogue: &'static Catalogue, text: &str) -> ChangeOutcome {
        let tables = Parameters {
            catalogue: Some(catalogue),
            scaling: Scaling::default(),
        };
        let assignment: Assignment = text.parse().unwrap();
        let selection = tables.select(&assignment.reference).unwrap();
        let value = match tables.check_text(&selection, &assignment.value).unwrap() {
            Some(text) => PlannedValue::Text(text),
            None => PlannedValue::Number(tables.check(&selection, &assignment.value).unwrap()),
        };
        ChangeOutcome {
            change: PlannedChange { selection, value },
            old: None,
            written: None,
            new: None,
            acts: false,
        }
    }

    #[test]
    fn values_travel_in_the_size_of_their_parameter() {
        assert_eq!(sent(&outcome("930=2"), &akd()), (Format::WORD, vec![0, 2]));
        assert_eq!(sent(&outcome("DRV.OPMODE=1"), &akd()), (Format::BYTE, vec![1]));
        assert_eq!(
            sent(&outcome("DRV.ACC=5000"), &akd()),
            (Format::DOUBLE_WORD, vec![0, 0, 0, 0, 0, 0x4C, 0x4B, 0x40])
        );
        assert_eq!(sent(&outcome("1004=-60"), &akd()).1, [0xFF, 0x5C]);
    }

    #[test]
    fn values_are_sent_in_the_formats_of_their_vendor() {
        let vlt = |text: &str| sent(&outcome_of(&VLT, text), &Model::by_name("vlt").unwrap());
        assert_eq!(vlt("3-41=5s"), (Format::UNSIGNED32, vec![0, 0, 0x01, 0xF4]));
        assert_eq!(vlt("8-10=1"), (Format::UNSIGNED8, vec![1]));
        assert_eq!(
            vlt("0-37=HELLO WORLD"),
            (Format::VISIBLE_STRING, b"HELLO WORLD              ".to_vec())
        );
        assert_eq!(vlt("0-37=\"\"").1, [b' '; 25]);
        assert_eq!(vlt("1-20=0.75kW"), (Format::UNSIGNED32, vec![0, 0, 0, 75]));
        let vacon = |text: &str| sent(&outcome_of(&VACON, text), &Model::by_name("vacon").unwrap());
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

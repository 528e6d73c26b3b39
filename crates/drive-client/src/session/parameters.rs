//! Reading and writing parameters: many in few requests, values checked first, read back after.

use std::ops::Range;

use profidrive::catalogue::{Role, Size};
use profidrive::notation::Shown;
use profidrive::parameter::{
    Answer, Description, ErrorNumber, Format, NewValue, ParameterAddress, RequestId, Response, encode_change,
    encode_read, plan_changes, plan_reads, split_array,
};
use profinet::Medium;

use super::Session;
use super::scaling::is_scaling;
use crate::parameter::{
    Assignment, CheckedValue, Content, Interpretation, ParameterProblem, Reading, Selection, halves, join,
    split,
};
use crate::{Drive, Error, Refusal};

/// Octets of the largest request any dialect allows.
const MAX_REQUEST: usize = 1024;

/// Write, or only check and show.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum WriteMode {
    /// Nothing is sent but reads.
    DryRun,
    /// Values are written and read back.
    Write,
}

/// A change that was checked against the tables and compared with the present value.
#[derive(Debug, Clone)]
pub struct PlannedChange {
    /// Where to.
    pub selection: Selection,
    /// What.
    pub value: CheckedValue,
}

/// What became of a change.
#[derive(Debug, Clone)]
pub struct ChangeOutcome {
    /// Where to and what.
    pub change: PlannedChange,
    /// The value before; `None` for a command, which has none.
    pub old: Option<Result<Reading, Refusal>>,
    /// How the write ended; `None` for a dry run.
    pub written: Option<Result<(), Refusal>>,
    /// The value read back; `None` for a command, a dry run or a refused write.
    pub new: Option<Result<Reading, Refusal>>,
    /// Writing it does something (MT.CLEAR, MT.MOVE): what it reads as afterwards says nothing about success.
    pub acts: bool,
}

impl ChangeOutcome {
    /// True when the value read back is another one than written; never for something that acts.
    #[must_use]
    pub fn differs(&self) -> bool {
        if self.acts {
            return false;
        }
        let Some(Ok(new)) = &self.new else { return false };
        match new.content {
            Content::Number { raw, .. } => raw != self.change.value.raw,
            Content::Float(value) => (value - self.change.value.engineering).abs() > value.abs() * 1e-6,
            Content::Text(_) | Content::Octets => true,
        }
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

/// One address of a read, and which selection it belongs to.
#[derive(Debug, Clone, Copy)]
struct Item {
    selection: usize,
    /// First element within the selection.
    offset: u16,
    address: ParameterAddress,
    octets: Option<usize>,
}

impl<M: Medium> Session<M>
where
    M::Error: Send + Sync + 'static,
{
    /// Reads every element of every selection, in order, in as few requests as the drive's limits allow. A refused
    /// parameter does not disturb the others.
    ///
    /// # Errors
    /// When the drive cannot be reached, or its answer makes no sense.
    pub fn read(
        &mut self,
        drive: &mut Drive,
        selections: &[Selection],
    ) -> Result<Vec<Result<Reading, Refusal>>, Error> {
        if selections.iter().any(needs_scaling) {
            self.read_scaling(drive)?;
        }
        let readings = self.read_plain(drive, &split(selections))?;
        Ok(join(&drive.parameters, selections, readings))
    }

    /// The same without looking at the values that scale others first.
    pub(super) fn read_plain(
        &mut self,
        drive: &Drive,
        selections: &[Selection],
    ) -> Result<Vec<Result<Reading, Refusal>>, Error> {
        let items: Vec<Item> = selections
            .iter()
            .enumerate()
            .flat_map(|(at, selection)| items(at, selection, drive))
            .collect();
        let planned: Vec<_> = items.iter().map(|item| (item.address, item.octets)).collect();
        let mut results = Vec::new();
        for group in plan_reads(&planned, drive.model.dialect) {
            self.read_group(drive, selections, &items, group, &mut results)?;
        }
        Ok(results)
    }

    fn read_group(
        &mut self,
        drive: &Drive,
        selections: &[Selection],
        items: &[Item],
        group: Range<usize>,
        results: &mut Vec<Result<Reading, Refusal>>,
    ) -> Result<(), Error> {
        let part = items.get(group).unwrap_or_default();
        let addresses: Vec<ParameterAddress> = part.iter().map(|item| item.address).collect();
        let dialect = drive.model.dialect;
        let mut buffer = [0; MAX_REQUEST];
        let reference = self.next_reference();
        let length = encode_read(reference, dialect, &addresses, &mut buffer)
            .map_err(|error| malformed(drive, &error))?;
        let answer = self.job(drive, buffer.get(..length).unwrap_or_default())?;
        let response = Response::parse(&answer, RequestId::Read, reference, &addresses, dialect)
            .map_err(|error| malformed(drive, &error))?;
        for (item, answer) in part.iter().zip(response.answers()) {
            let Some(selection) = selections.get(item.selection) else {
                continue;
            };
            match answer {
                Answer::Values(block) => {
                    let interpretation = Interpretation::of(block.format, dialect.code_space);
                    if matches!(interpretation, Interpretation::Text | Interpretation::Octets) {
                        results.push(Ok(drive.parameters.reading(
                            selection,
                            item.offset,
                            block.format.0,
                            interpretation,
                            block.data,
                        )));
                        continue;
                    }
                    for at in 0..block.count {
                        let octets = block.octets(at.into()).unwrap_or_default();
                        let offset = item.offset + u16::from(at);
                        let format = block.format.0;
                        results.push(Ok(drive.parameters.reading(
                            selection,
                            offset,
                            format,
                            interpretation,
                            octets,
                        )));
                    }
                }
                // sizes nobody knew made the answer too long: this one again, alone
                Answer::Error(error) if error.number == ErrorNumber(0x15) && part.len() > 1 => {
                    let alone = [*item];
                    self.read_group(drive, selections, &alone, 0..1, results)?;
                }
                Answer::Error(error) => {
                    results.push(Err(refusal(
                        drive,
                        selection,
                        item.offset,
                        false,
                        error.number,
                        error.info,
                    )));
                }
                Answer::Written => {
                    let reason = "a read was answered like a write".to_owned();
                    return Err(Error::Malformed {
                        drive: drive.label(),
                        reason,
                    });
                }
            }
        }
        Ok(())
    }

    /// Reads one value that must be there.
    ///
    /// # Errors
    /// When the drive cannot be reached or refuses.
    pub fn read_one(&mut self, drive: &mut Drive, selection: &Selection) -> Result<Reading, Error> {
        let first = self
            .read(drive, std::slice::from_ref(selection))?
            .into_iter()
            .next();
        match first {
            Some(Ok(reading)) => Ok(reading),
            Some(Err(refusal)) => Err(Error::Refused {
                drive: drive.label(),
                refusal,
            }),
            None => Err(Error::Malformed {
                drive: drive.label(),
                reason: "no value came back".to_owned(),
            }),
        }
    }

    /// Checks all assignments against the tables, reads the present values, and, unless it is a dry run, writes and
    /// reads back. Nothing is written when one of them is wrong.
    ///
    /// # Errors
    /// A wrong assignment, or a drive that cannot be reached. A refused write is told in the outcome.
    pub fn write(
        &mut self,
        drive: &mut Drive,
        assignments: &[Assignment],
        mode: WriteMode,
    ) -> Result<Vec<ChangeOutcome>, Error> {
        let mut changes = Vec::new();
        for assignment in assignments {
            let selection = drive.parameters.select(&assignment.reference)?;
            if needs_scaling(&selection) {
                self.read_scaling(drive)?;
            }
            let value = drive.parameters.check(&selection, &assignment.quantity)?;
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
        let readable: Vec<Selection> = changes
            .iter()
            .map(|change| change.selection)
            .filter(|selection| !is_command(selection))
            .collect();
        let mut old = self.read(drive, &readable)?.into_iter();
        let mut outcomes: Vec<ChangeOutcome> = changes
            .into_iter()
            .map(|change| {
                let old = if is_command(&change.selection) {
                    None
                } else {
                    old.next()
                };
                let pnu = change.selection.pnu;
                let role = drive.model.catalogue.map(|tables| tables.backup_rule(pnu).role);
                ChangeOutcome {
                    change,
                    old,
                    written: None,
                    new: None,
                    acts: matches!(role, Some(Role::Action | Role::Save | Role::ClearFaults)),
                }
            })
            .collect();
        if mode == WriteMode::DryRun {
            return Ok(outcomes);
        }
        self.write_outcomes(drive, &mut outcomes)?;
        let mut back: Vec<Selection> = Vec::new();
        for outcome in &outcomes {
            if matches!(outcome.written, Some(Ok(()))) && !is_command(&outcome.change.selection) {
                back.push(outcome.change.selection);
            }
        }
        // a change of a value that scales others counts from here on
        drive.scaled &= !back
            .iter()
            .any(|selection| selection.parameter.is_some_and(is_scaling));
        let mut new = self.read(drive, &back)?.into_iter();
        for outcome in &mut outcomes {
            if matches!(outcome.written, Some(Ok(()))) && !is_command(&outcome.change.selection) {
                outcome.new = new.next();
            }
        }
        Ok(outcomes)
    }

    fn write_outcomes(&mut self, drive: &Drive, outcomes: &mut [ChangeOutcome]) -> Result<(), Error> {
        let mut encoded = Vec::new();
        for outcome in outcomes.iter() {
            let (format, octets) = encode(outcome)?;
            encoded.push(Outgoing {
                selection: outcome.change.selection,
                format,
                count: 1,
                octets,
            });
        }
        let sizes: Vec<usize> = encoded.iter().map(|value| value.octets.len()).collect();
        for group in plan_changes(&sizes, drive.model.dialect) {
            let answers = self.change(drive, encoded.get(group.clone()).unwrap_or_default())?;
            for (at, answer) in group.zip(answers) {
                if let Some(outcome) = outcomes.get_mut(at) {
                    outcome.written = Some(answer);
                }
            }
        }
        Ok(())
    }

    /// Writes values with one request; they must fit into one ([`plan_changes`]). One answer for each.
    pub(super) fn change(
        &mut self,
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
            self.change_parts(drive, parts.get(group).unwrap_or_default(), &mut answers)?;
        }
        Ok(answers)
    }

    fn change_parts(
        &mut self,
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
        let length = encode_change(reference, dialect, &values, &mut buffer)
            .map_err(|error| malformed(drive, &error))?;
        let answer = self.job(drive, buffer.get(..length).unwrap_or_default())?;
        let response = Response::parse(&answer, RequestId::Change, reference, &addresses, dialect)
            .map_err(|error| malformed(drive, &error))?;
        for (part, answer) in parts.iter().zip(response.answers()) {
            if let (Answer::Error(error), Some(place)) = (answer, answers.get_mut(part.at)) {
                let selection = &part.value.selection;
                *place = Err(refusal(drive, selection, 0, true, error.number, error.info));
            }
        }
        Ok(())
    }

    /// Descriptions of parameters (attribute 0x20), `None` where the drive has none.
    pub(super) fn descriptions(
        &mut self,
        drive: &Drive,
        pnus: &[u16],
    ) -> Result<Vec<Option<Description>>, Error> {
        let planned: Vec<_> = pnus
            .iter()
            .map(|&pnu| (ParameterAddress::description(pnu), None))
            .collect();
        let dialect = drive.model.dialect;
        let mut descriptions = Vec::new();
        for group in plan_reads(&planned, dialect) {
            let part = planned.get(group).unwrap_or_default();
            let addresses: Vec<ParameterAddress> = part.iter().map(|(address, _)| *address).collect();
            let mut buffer = [0; MAX_REQUEST];
            let reference = self.next_reference();
            let length = encode_read(reference, dialect, &addresses, &mut buffer)
                .map_err(|error| malformed(drive, &error))?;
            let answer = self.job(drive, buffer.get(..length).unwrap_or_default())?;
            let response = Response::parse(&answer, RequestId::Read, reference, &addresses, dialect)
                .map_err(|error| malformed(drive, &error))?;
            descriptions.extend(response.answers().map(|answer| match answer {
                Answer::Values(block) => Description::decode(block.data),
                Answer::Error(_) | Answer::Written => None,
            }));
        }
        Ok(descriptions)
    }

    /// References run from 1 to 255: 0 is reserved.
    fn next_reference(&mut self) -> u8 {
        self.reference = self.reference.checked_add(1).unwrap_or(1);
        self.reference
    }
}

fn needs_scaling(selection: &Selection) -> bool {
    selection
        .parameter
        .is_some_and(|parameter| parameter.user_unit || !parameter.scale.is_fixed())
}

fn is_command(selection: &Selection) -> bool {
    selection
        .parameter
        .is_some_and(|parameter| parameter.size == Size::Command)
}

/// The addresses of one selection.
fn items(at: usize, selection: &Selection, drive: &Drive) -> Vec<Item> {
    let octets = selection.parameter.map(|parameter| parameter.size.octets());
    let dialect = drive.model.dialect;
    let parts = split_array(
        selection.pnu,
        selection.first,
        selection.count,
        octets.unwrap_or(4),
        dialect,
    );
    parts
        .into_iter()
        .map(|address| Item {
            selection: at,
            offset: address.subindex - selection.first,
            address,
            octets,
        })
        .collect()
}

fn refusal(
    drive: &Drive,
    selection: &Selection,
    offset: u16,
    write: bool,
    number: ErrorNumber,
    information: Option<u16>,
) -> Refusal {
    let shown: Shown = selection.shown(offset);
    let name = selection.parameter.map(|parameter| parameter.name);
    let tables = drive
        .model
        .catalogue
        .filter(|_| write && number == ErrorNumber::NOT_NOW);
    Refusal {
        shown,
        name,
        write,
        number,
        information,
        advice: tables.and_then(|tables| tables.not_now(selection.pnu)),
    }
}

fn malformed(drive: &Drive, error: &dyn std::fmt::Display) -> Error {
    Error::Malformed {
        drive: drive.label(),
        reason: error.to_string(),
    }
}

/// Format and octets of a value: by the table, else as the drive sent the old one.
fn encode(outcome: &ChangeOutcome) -> Result<(Format, Vec<u8>), Error> {
    let CheckedValue { raw, engineering, .. } = outcome.change.value;
    let (format, width) = match (outcome.change.selection.parameter, &outcome.old) {
        (Some(parameter), _) => (Format(parameter.size.format_code()), parameter.octets()),
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
    use crate::parameter::Parameters;
    use profidrive::catalogue::{AKD, Scaling};

    fn outcome(text: &str) -> ChangeOutcome {
        let tables = Parameters {
            catalogue: Some(&AKD),
            scaling: Scaling::default(),
        };
        let assignment: Assignment = text.parse().unwrap();
        let selection = tables.select(&assignment.reference).unwrap();
        let value = tables.check(&selection, &assignment.quantity).unwrap();
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
        assert_eq!(encode(&outcome("930=2")).unwrap(), (Format::WORD, vec![0, 2]));
        assert_eq!(encode(&outcome("DRV.OPMODE=1")).unwrap(), (Format::BYTE, vec![1]));
        assert_eq!(
            encode(&outcome("DRV.ACC=5000")).unwrap(),
            (Format::DOUBLE_WORD, vec![0, 0, 0, 0, 0, 0x4C, 0x4B, 0x40])
        );
        assert_eq!(encode(&outcome("1004=-1")).unwrap().1.len(), 2);
    }
}

//! The drives of a recording, each ready to be recorded: what its signals are.

use std::time::Duration;

use client::axis::{AxisSignal, Purpose, SignalScale};
use client::{Axis, AxisSettings, Drive, Session};
use profile::notation::ParameterReference;
use profile::value::{Content, Reading, Selection};

use super::error::RecordingError;
use super::producer::present_faults;
use super::table::{Column, Kind, Table, Value};
use super::{Every, Request};
use crate::fleet::{self, Member, Selected};
use crate::monitor::{SHORTEST_INTERVAL, TooFast};

/// Means every signal of the telegram.
pub(super) const ALL: &str = "all";

/// A drive that is ready to be recorded. Nothing of it is recorded yet.
#[derive(Debug)]
pub struct Source {
    pub(super) name: String,
    pub(super) drive: Drive,
    pub(super) columns: Vec<Column>,
    pub(super) origin: Origin,
    /// Numbers of the faults that were present.
    pub(super) faults: Vec<u16>,
}

/// Where the values of a drive come from.
#[derive(Debug)]
pub(super) enum Origin {
    /// Parameters that are read.
    Parameters(Vec<Selection>),
    /// The cyclic data of a connection that commands nothing.
    Cyclic(Box<Observed>),
}

/// A cyclic connection that commands nothing.
#[derive(Debug)]
pub(super) struct Observed {
    pub axis: Axis,
    /// The signals in the order of the columns.
    pub signals: Vec<AxisSignal>,
    pub settings: AxisSettings,
}

impl Source {
    /// Returns the update time and the telegram of a cyclic connection; `None` where parameters are read.
    #[must_use]
    pub fn cyclic(&self) -> Option<(Duration, u16)> {
        match &self.origin {
            Origin::Parameters(_) => None,
            Origin::Cyclic(observed) => Some((observed.axis.cycle(), observed.axis.telegram())),
        }
    }
}

/// Gets drives ready to be recorded, side by side. Parameters are read once. A cyclic connection is opened to drives without
/// a controller whose power stage is off; it commands nothing, and is closed when the source is dropped.
pub async fn prepare(
    session: &Session,
    members: Vec<Selected>,
    request: &Request,
) -> Vec<Member<Result<Source, RecordingError>>> {
    fleet::each(session, members, async |session, drive| {
        let (columns, origin) = match &request.every {
            Every::Interval(_) => parameters(session, drive, &request.signals).await?,
            Every::Cycle { cycle, watchdog } => {
                let settings = AxisSettings {
                    cycle: *cycle,
                    watchdog: *watchdog,
                    ..AxisSettings::for_purpose(Purpose::Observe)
                };
                observed(session, drive, settings, &request.signals).await?
            }
        };
        let faults = present_faults(session, drive).await;
        Ok(Source {
            name: drive.label(),
            drive: drive.clone(),
            columns,
            origin,
            faults: faults.iter().map(|fault| fault.number).collect(),
        })
    })
    .await
}

/// Checks what is wrong whatever the drives are like.
pub(super) fn check(request: &Request) -> Result<(), RecordingError> {
    if request.signals.is_empty() {
        return Err(RecordingError::NoSignal);
    }
    for (at, name) in request.signals.iter().enumerate() {
        let same = |other: &String| other.eq_ignore_ascii_case(name);
        if request.signals.iter().take(at).any(same) {
            return Err(RecordingError::Twice { name: name.clone() });
        }
    }
    if request.time.is_some_and(|time| time.is_zero()) {
        return Err(RecordingError::NoTime);
    }
    match request.every {
        Every::Interval(interval) if interval < SHORTEST_INTERVAL => Err(TooFast.into()),
        _ => Ok(()),
    }
}

async fn parameters(
    session: &mut Session,
    drive: &mut Drive,
    names: &[String],
) -> Result<(Vec<Column>, Origin), RecordingError> {
    let label = drive.label();
    let mut selections = Vec::new();
    for name in names {
        let problem = |problem| RecordingError::Parameter {
            drive: label.clone(),
            problem,
        };
        let reference: ParameterReference = name.parse().map_err(|error| problem(error_of(error)))?;
        selections.push(drive.parameters.select(&reference).map_err(problem)?);
    }
    let readings = session.read(drive, &selections).await?;
    let mut readings = readings.into_iter();
    let mut columns = Vec::new();
    for (name, selection) in names.iter().zip(&selections) {
        for offset in 0..selection.count {
            let reading = readings.next();
            let element = if selection.count > 1 {
                format!("{name}[{offset}]")
            } else {
                name.clone()
            };
            let reading = match reading {
                Some(Ok(reading)) => reading,
                Some(Err(refusal)) => {
                    return Err(client::Error::Refused {
                        drive: label,
                        refusal,
                    }
                    .into());
                }
                None => {
                    return Err(RecordingError::NotANumber {
                        drive: label,
                        name: element,
                    });
                }
            };
            let Some(kind) = kind_of(&reading) else {
                return Err(RecordingError::NotANumber {
                    drive: label,
                    name: element,
                });
            };
            columns.push(Column {
                name: element,
                kind,
                unit: reading.unit.to_owned(),
                parameter: selection.label(),
                scaling: if kind == Kind::Number {
                    format!("{} decimals", reading.decimals)
                } else {
                    String::new()
                },
            });
        }
    }
    Ok((columns, Origin::Parameters(selections)))
}

fn error_of(error: profile::notation::ReferenceError) -> profile::value::ParameterProblem {
    error.into()
}

/// Returns what the values of a parameter are; `None` for text and octets.
fn kind_of(reading: &Reading) -> Option<Kind> {
    match &reading.content {
        Content::Number { .. } if reading.word.is_some() && reading.octets.len() == 2 => Some(Kind::Word),
        Content::Number { .. } if reading.unit.is_empty() && reading.decimals == 0 => Some(Kind::Integer),
        Content::Number { .. } | Content::Float(_) => Some(Kind::Number),
        Content::Text(_) | Content::Octets => None,
    }
}

/// Returns the value of a reading in its column.
pub(super) fn value_of(reading: &Reading, kind: Kind) -> Option<Value> {
    match kind {
        Kind::Number => reading.number().map(Value::Number),
        _ => kind.of(Value::Integer(reading.raw()?)),
    }
}

async fn observed(
    session: &mut Session,
    drive: &mut Drive,
    settings: AxisSettings,
    names: &[String],
) -> Result<(Vec<Column>, Origin), RecordingError> {
    let axis = session.take_axis(drive, settings).await?;
    match chosen(&axis, names) {
        Ok(found) => {
            let (columns, signals) = found.into_iter().unzip();
            let observed = Observed {
                axis,
                signals,
                settings,
            };
            Ok((columns, Origin::Cyclic(Box::new(observed))))
        }
        Err(error) => {
            let _ = axis.release().await;
            Err(error)
        }
    }
}

/// Whether a name means a signal: its own, or its common one.
fn means(name: &str, signal: &AxisSignal) -> bool {
    let signal = signal.field.signal;
    let own = [signal.name, signal.common].into_iter();
    own.filter(|own| !own.is_empty())
        .any(|own| own.eq_ignore_ascii_case(name))
}

/// Returns the signals of an axis that names mean, with their columns. A column has the name that was given.
fn chosen(axis: &Axis, names: &[String]) -> Result<Vec<(Column, AxisSignal)>, RecordingError> {
    let there = axis.signals();
    let mut chosen: Vec<(Column, AxisSignal)> = Vec::new();
    for name in names {
        let is_all = name.eq_ignore_ascii_case(ALL);
        let found = there.iter().filter(|signal| is_all || means(name, signal));
        let mut is_there = false;
        for signal in found {
            is_there = true;
            let mut column = column_of(signal);
            if !is_all && !signal.field.signal.name.eq_ignore_ascii_case(name) {
                column.name.clone_from(name);
            }
            if chosen.iter().all(|(_, other)| other != signal) {
                chosen.push((column, *signal));
            }
        }
        if !is_there {
            return Err(RecordingError::NoSuchSignal {
                drive: axis.drive().label(),
                telegram: axis.telegram(),
                name: name.clone(),
                signals: there
                    .iter()
                    .map(|signal| signal.field.signal.name.to_owned())
                    .collect(),
            });
        }
    }
    Ok(chosen)
}

/// Returns the signals of an axis whose columns are these, in the same order: the drive may have another telegram than before.
///
/// # Errors
/// [`RecordingError::Changed`] where one is missing or its values have another unit or kind.
pub(super) fn same_signals(axis: &Axis, columns: &[Column]) -> Result<Vec<AxisSignal>, RecordingError> {
    let there = axis.signals();
    let find = |column: &Column| {
        let same = |signal: &&AxisSignal| {
            let now = column_of(signal);
            means(&column.name, signal) && now.unit == column.unit && now.kind == column.kind
        };
        there
            .iter()
            .find(same)
            .copied()
            .ok_or_else(|| RecordingError::Changed {
                drive: axis.drive().label(),
                telegram: axis.telegram(),
                name: column.name.clone(),
                unit: column.unit.clone(),
            })
    };
    columns.iter().map(find).collect()
}

/// Returns the column of a signal.
pub(super) fn column_of(signal: &AxisSignal) -> Column {
    let of = signal.field.signal;
    let kind = match signal.scale {
        SignalScale::Raw if of.bits == 16 && !of.signed => Kind::Word,
        SignalScale::Raw => Kind::Integer,
        SignalScale::Speed(_) | SignalScale::Turns(_) => Kind::Number,
    };
    let scaling = match signal.scale {
        SignalScale::Raw => String::new(),
        SignalScale::Speed(scale) => format!("{} {} is 0x4000", scale.speed(0x4000), scale.unit().symbol()),
        SignalScale::Turns(counts) => format!("1 rev is {counts}"),
    };
    Column {
        name: of.name.to_owned(),
        kind,
        unit: signal.unit().to_owned(),
        parameter: format!("signal {}", of.number),
        scaling,
    }
}

/// Returns the columns that drives have together. A signal that has other units on other drives has a column for each of them.
pub(super) fn together<'s>(sources: impl IntoIterator<Item = (&'s str, &'s [Column])>) -> Table {
    let mut table = Table {
        drives: Vec::new(),
        columns: Vec::new(),
        facts: Vec::new(),
    };
    for (name, columns) in sources {
        table.drives.push(name.to_owned());
        for column in columns {
            if let Some(other) = table.columns.iter_mut().find(|other| column.belongs_to(other)) {
                other.kind = other.kind.with(column.kind);
                continue;
            }
            let mut new = column.clone();
            if table.columns.iter().any(|other| other.name == column.name) {
                new.name = column.name_with_unit();
            }
            table.columns.push(new);
        }
    }
    table
}

#[cfg(test)]
mod tests {
    use super::*;

    fn column(name: &str, unit: &str) -> Column {
        Column {
            name: name.to_owned(),
            kind: Kind::Number,
            unit: unit.to_owned(),
            parameter: String::new(),
            scaling: String::new(),
        }
    }

    #[test]
    fn a_signal_has_a_column_for_each_of_its_units() {
        let (servo, converter) = (
            [column("current", "Arms"), column("speed", "rpm")],
            [column("current", "A"), column("speed", "rpm")],
        );
        let table = together([
            ("akd-1", &servo[..]),
            ("vlt-1", &converter),
            ("vac-1", &converter),
        ]);
        let names: Vec<&str> = table.columns.iter().map(|column| column.name.as_str()).collect();
        assert_eq!(names, ["current", "speed", "current (A)"]);
        let of = |own: &[Column; 2]| -> Vec<Option<usize>> {
            let place = |column: &Column| own.iter().position(|own| own.belongs_to(column));
            table.columns.iter().map(place).collect()
        };
        assert_eq!(of(&servo), [Some(0), Some(1), None]);
        assert_eq!(of(&converter), [None, Some(1), Some(0)]);
    }
}

//! `profidrive read`, and what it shares with `profidrive write`, `list` and `describe`

mod describe;
mod limits;
mod list;
mod write;

use client::Refusal;
use client::Wait;
use profidrive::report::{ParametersReport, parameter};
use profile::catalogue::{Access, Catalogue, Parameter, Part};
use profile::notation::{ParameterReference, Shown};
use profile::parameter::pnu;
use profile::state::Mode;
use profile::telegram::Telegram;
use profile::value::{ParameterProblem, Parameters, Reading, Selection};
use serde_json::{Map, Value};

use crate::advice::Commands;
use crate::args::{Interface, Read};
use crate::connect::{self, Need};
use crate::failure::Failure;
use crate::fields;
use crate::output::{Output, members};
use crate::render::Page;
use crate::render::table::Table;

pub use describe::describe;
pub use list::list;
pub use write::write;

pub fn read(args: &Read, interface: &Interface, output: &Output) -> Result<(), Failure> {
    let references = parse_all(&args.parameters)?;
    let (mut session, mut drive) = connect::drive(interface, Need::Records, &args.drive, output)?;
    let mut selections = Vec::new();
    let mut problems: Vec<Failure> = Vec::new();
    // one unknown name does not break the whole page
    for reference in &references {
        match drive.parameters.select(reference) {
            Ok(selection) => selections.push(selection),
            Err(problem) => problems.push(problem.into()),
        }
    }
    let mut readings = session.read(&mut drive, &selections).wait()?;
    name_bits(&mut session, &mut drive, &mut readings)?;
    session.close().wait()?;
    print_readings(&drive.label(), &readings, args.raw, output);
    let refused = readings.iter().filter_map(|reading| reading.as_ref().err());
    problems.extend(refused.map(|refusal| refused_failure(&drive.label(), refusal)));
    last_failure(problems, output)
}

/// What the bits of control and status words are called depends on telegram, profile and mode, which only the drive knows.
fn name_bits(
    session: &mut connect::Live,
    drive: &mut client::Drive,
    readings: &mut [Result<Reading, Refusal>],
) -> Result<(), Failure> {
    let depends = |reading: &Reading| drive.parameters.is_word_of_state(reading);
    if !readings.iter().flatten().any(depends) {
        return Ok(());
    }
    let chooser = drive
        .model
        .catalogue
        .and_then(|tables| tables.part(Part::ControlProfile));
    let chooser = chooser.map(|parameter| parameter.pnu);
    let asked = [Some(pnu::OPERATING_MODE), Some(pnu::TELEGRAM), chooser];
    let selections: Vec<_> = asked
        .into_iter()
        .flatten()
        .map(|pnu| Selection::number(pnu, drive.parameters.notation()))
        .collect();
    let answers = session.read(drive, &selections).wait()?;
    let raw = |pnu: u16| {
        let found = answers.iter().flatten().find(|reading| reading.pnu == pnu);
        found.and_then(Reading::raw)
    };
    let telegram = raw(pnu::TELEGRAM).and_then(|number| u16::try_from(number).ok());
    let telegram = telegram.and_then(|number| Telegram::find(number, drive.station.vendor_id));
    let profile = drive.model.words.of(telegram, chooser.and_then(raw));
    let mode = Mode::of(raw(pnu::OPERATING_MODE), telegram);
    for reading in readings.iter_mut().flatten() {
        *reading = drive.parameters.in_words(reading.clone(), Some(profile), mode);
    }
    Ok(())
}

/// Prints all but the last failure at once; the last one ends the command.
fn last_failure(mut problems: Vec<Failure>, output: &Output) -> Result<(), Failure> {
    let last = problems.pop();
    for problem in problems {
        output.problem(&problem);
    }
    last.map_or(Ok(()), Err)
}

fn refused_failure(drive: &str, refusal: &Refusal) -> Failure {
    client::Error::Refused {
        drive: drive.to_owned(),
        refusal: *refusal,
    }
    .into()
}

fn parse_all(texts: &[String]) -> Result<Vec<ParameterReference>, Failure> {
    let parse = |text: &String| {
        text.parse()
            .map_err(|error| Failure::from(ParameterProblem::from(error)))
    };
    texts.iter().map(parse).collect()
}

/// Prints readings; the raw values only with `raw`.
fn print_readings(drive: &str, readings: &[Result<Reading, Refusal>], raw: bool, output: &Output) {
    let wording = Commands::any();
    let parameters = readings.iter().map(|reading| parameter(reading, &wording));
    let report = ParametersReport {
        drive: drive.to_owned(),
        parameters: parameters.collect(),
    };
    if output.json() {
        output.report(&report);
    } else {
        output.table(&table(&report, raw));
    }
}

impl Page for ParametersReport {
    fn print(&self, output: &Output) {
        output.table(&table(self, false));
    }
}

fn table(report: &ParametersReport, raw: bool) -> Table {
    let mut table = Table::new(&[
        "name",
        "number",
        ">value",
        "unit",
        "meaning",
        if raw { "raw" } else { "" },
    ]);
    for parameter in report.parameters.iter().filter(|one| one.error.is_none()) {
        table.row([
            parameter.name.clone().unwrap_or_default(),
            parameter.number.clone(),
            parameter.text.clone().unwrap_or_default(),
            parameter.unit.clone(),
            parameter.meaning.clone().unwrap_or_default(),
            if raw { parameter.octets() } else { String::new() },
        ]);
    }
    table
}

fn reading_json(reading: &Result<Reading, Refusal>) -> Value {
    Value::Object(members(&parameter(reading, &Commands::any())))
}

pub fn refusal_json(refusal: &Refusal) -> Map<String, Value> {
    members(&parameter(&Err(*refusal), &Commands::any()))
}

const fn access_word(access: Access) -> &'static str {
    match access {
        Access::ReadOnly => "read",
        Access::ReadWrite => "read, write",
        Access::WriteOnly => "command",
    }
}

fn number_of(tables: &Catalogue, parameter: &Parameter) -> String {
    let writable = Some(parameter.access != Access::ReadOnly);
    Shown {
        pnu: parameter.pnu,
        index: parameter.base,
        writable,
        notation: tables.notation,
    }
    .to_string()
}

/// Limits as the tables have them; null where only the size limits.
fn parameter_json(tables: &Catalogue, parameter: &Parameter, drive: &Parameters) -> Map<String, Value> {
    let limits = drive.limits(parameter);
    let meanings = |list: &[profile::catalogue::Meaning]| -> Vec<Value> {
        list.iter()
            .map(|row| Value::Object(fields! { "value": row.value, "text": row.text }))
            .collect()
    };
    fields! {
        "pnu": parameter.pnu, "index": parameter.base, "number": number_of(tables, parameter), "name": parameter.name, "description": parameter.description, "unit": parameter.unit_in(&drive.scaling),
        "access": access_word(parameter.access), "elements": parameter.elements, "octets": parameter.size.octets(),
        "signed": parameter.signed, "high": parameter.high(), "saved": tables.is_kept(parameter), "minimum": parameter.minimum.map(|_| limits.0),
        "maximum": parameter.maximum.map(|_| limits.1), "default": parameter.default_in(&drive.scaling), "choices": meanings(parameter.choices),
        "bits": meanings(parameter.bits), "source": parameter.source,
    }
}

//! `profidrive read`, and what it shares with `profidrive write`, `list` and `describe`

mod describe;
mod limits;
mod list;
mod write;

use client::Refusal;
use client::Wait;
use profidrive::report::{Parameter as ParameterValue, ParametersReport, parameter};
use profile::catalogue::Part;
use profile::notation::ParameterReference;
use profile::parameter::pnu;
use profile::state::Mode;
use profile::telegram::Telegram;
use profile::value::{ParameterProblem, Reading, Selection};

use crate::advice::Commands;
use crate::args::{Read, Target};
use crate::connect::{self, Need};
use crate::failure::Failure;
use crate::output::Output;
use crate::render::table::Table;

pub use describe::describe;
pub use list::list;
pub use write::write;

pub fn read(args: &Read, target: &Target, output: &Output) -> Result<(), Failure> {
    let references = parse_all(&args.parameters)?;
    let (mut session, mut drive) = connect::drive(target, Need::Records, output)?;
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

/// What the bits of control and status words are called depends on telegram, profile and mode, which only the drive reports.
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
    let values = readings.iter().map(|reading| parameter(reading, &wording));
    let report = ParametersReport {
        drive: drive.to_owned(),
        parameters: values.collect(),
    };
    output.json_report(&report);
    if !output.json() {
        output.table(&values_table(&report.parameters, raw));
    }
}

fn values_table(values: &[ParameterValue], raw: bool) -> Table {
    let mut table = Table::new(&[
        "name",
        "number",
        ">value",
        "unit",
        "meaning",
        if raw { "raw" } else { "" },
    ]);
    for value in values.iter().filter(|one| one.error.is_none()) {
        table.row([
            value.name.clone().unwrap_or_default(),
            value.number.clone(),
            value.text.clone().unwrap_or_default(),
            value.unit.clone(),
            value.meaning.clone().unwrap_or_default(),
            if raw { value.octets() } else { String::new() },
        ]);
    }
    table
}

//! `profidrive read`, and what it shares with `profidrive write`, `list` and `describe`

mod describe;
mod limits;
mod list;
mod write;

use client::Wait;
use profidrive::parameters::{self, ParameterError};
use profidrive::report::Parameter as ParameterValue;
use profile::notation::ParameterReference;
use profile::value::ParameterProblem;

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
    let values = parameters::read(&mut session, &mut drive, &references).wait()?;
    session.close().wait()?;
    let report = values.report(&drive, &Commands::any());
    output.json_report(&report);
    if !output.json() {
        output.table(&values_table(&report.parameters, args.raw));
    }
    let problems = values.problems(&drive.label());
    last_failure(problems, output)
}

/// Prints all but the last failure at once; the last one ends the command.
fn last_failure<E: Into<Failure>>(problems: Vec<E>, output: &Output) -> Result<(), Failure> {
    let mut problems: Vec<Failure> = problems.into_iter().map(E::into).collect();
    let last = problems.pop();
    for problem in problems {
        output.problem(&problem);
    }
    last.map_or(Ok(()), Err)
}

impl From<ParameterError> for Failure {
    fn from(error: ParameterError) -> Self {
        match error {
            ParameterError::Client(error) => error.into(),
            error => Self::new(error.kind(), error.to_string()).hint(error.advice()),
        }
    }
}

fn parse_all(texts: &[String]) -> Result<Vec<ParameterReference>, Failure> {
    let parse = |text: &String| {
        text.parse()
            .map_err(|error| Failure::from(ParameterProblem::from(error)))
    };
    texts.iter().map(parse).collect()
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

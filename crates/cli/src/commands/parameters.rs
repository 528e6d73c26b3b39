//! `profidrive read`, and what it shares with `profidrive write`, `list` and `describe`

mod describe;
mod limits;
mod list;
mod write;

use client::{Drive, Session};
use profidrive::parameters::{self, Values};
use profidrive::report::{Parameter as ParameterValue, ParametersReport};
use profile::notation::ParameterReference;
use profile::value::ParameterProblem;

use super::each::{self, Each, Progress, Shown};
use crate::advice::Commands;
use crate::args::{Read, Target};
use crate::failure::Failure;
use crate::output::Output;
use crate::render::table::Table;

pub use describe::describe;
pub use list::list;
pub use write::write;

pub fn read(args: &Read, target: &Target, output: &Output) -> Result<(), Failure> {
    let references = parse_all(&args.parameters)?;
    let raw = args.raw;
    each::run(&Reading { references, raw }, target, output)
}

/// Parameters to read.
struct Reading {
    references: Vec<ParameterReference>,
    raw: bool,
}

impl Each for Reading {
    const DOING: &'static str = "reading";

    async fn work(
        &self,
        session: &mut Session,
        drive: &mut Drive,
        _: &mut Progress<'_>,
    ) -> Result<Values, Failure> {
        Ok(parameters::read(session, drive, &self.references).await?)
    }
}

impl Shown for Reading {
    type Done = Values;
    type Report = ParametersReport;
    const COLUMNS: &'static [&'static str] = &VALUE_COLUMNS;

    fn report(&self, done: &Values, drive: &Drive) -> ParametersReport {
        done.report(drive, &Commands::any())
    }

    fn show(&self, done: &Values, drive: &Drive, output: &Output) {
        let report = self.report(done, drive);
        output.table(&values_table(&report.parameters, self.raw));
    }

    fn rows(&self, done: &Values, drive: &Drive) -> Vec<Vec<String>> {
        value_rows(&self.report(done, drive).parameters, self.raw).collect()
    }

    fn problems(&self, done: &Values, drive: &Drive) -> Vec<Failure> {
        let problems = done.problems(&drive.label());
        problems.into_iter().map(Failure::from).collect()
    }
}

fn parse_all(texts: &[String]) -> Result<Vec<ParameterReference>, Failure> {
    let parse = |text: &String| {
        text.parse()
            .map_err(|error| Failure::from(ParameterProblem::from(error)))
    };
    texts.iter().map(parse).collect()
}

/// The columns of values; that of raw values stays empty unless it was requested.
const VALUE_COLUMNS: [&str; 6] = ["name", "number", ">value", "unit", "meaning", "raw"];

fn values_table(values: &[ParameterValue], raw: bool) -> Table {
    let mut table = Table::new(&VALUE_COLUMNS);
    for row in value_rows(values, raw) {
        table.row(row);
    }
    table
}

fn value_rows(values: &[ParameterValue], raw: bool) -> impl Iterator<Item = Vec<String>> {
    values.iter().filter(|one| one.error.is_none()).map(move |value| {
        vec![
            value.name.clone().unwrap_or_default(),
            value.number.clone(),
            value.text.clone().unwrap_or_default(),
            value.unit.clone(),
            value.meaning.clone().unwrap_or_default(),
            if raw { value.octets() } else { String::new() },
        ]
    })
}

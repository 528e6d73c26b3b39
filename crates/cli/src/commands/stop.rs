//! `profidrive stop`

use client::{StopWay, Wait};
use profidrive::fleet::{self, StopError};
use profidrive::motion::{self, StopReport};
use profidrive::report::Drives;

use super::axis;
use super::each;
use crate::args::{Stop, Target};
use crate::connect::{self, Need};
use crate::failure::Failure;
use crate::output::Output;
use crate::render::table::{Table, clean};

pub fn run(args: &Stop, target: &Target, output: &Output) -> Result<(), Failure> {
    let way = if args.disable {
        StopWay::Disable
    } else {
        StopWay::Stop
    };
    if connect::selector(target, output)?.single().is_none() {
        return many(way, args, target, output);
    }
    let report = axis::with_drive(target, Need::Stop, output, |session, drive| {
        motion::stop(session, drive, way, args.timeout).wait()
    })?;
    if output.json() {
        output.json_report(&report);
    } else {
        output.line(&report.to_string());
    }
    remarks(&report, output);
    Ok(report.check()?)
}

/// What is to be known beside how a drive was stopped.
fn remarks(report: &StopReport, output: &Output) {
    let label = &report.drive;
    if let Some(cause) = &report.unread {
        output.warn(&format!(
            "parameters of {label} cannot be read ({}): what they say was not taken into account",
            clean(cause)
        ));
    }
    let controller = report.controller.as_ref().filter(|one| one.connected);
    if let Some(controller) = controller.filter(|_| report.sent.is_some()) {
        output.warn(&format!(
            "controller \"{}\" goes on commanding {label}: what it sends next may move the axis again",
            clean(controller.name.as_deref().unwrap_or_default())
        ));
    }
}

fn many(way: StopWay, args: &Stop, target: &Target, output: &Output) -> Result<(), Failure> {
    let selector = connect::selector(target, output)?;
    let (opening, mut session) = connect::network(target, &selector, Need::Stop, output)?;
    let stopped = fleet::stop(&opening, &mut session, &selector, way, args.timeout).wait();
    let stopped = stopped.map_err(Failure::from)?;
    let closed = session.close().wait();
    let problems = |report: &StopReport| report.check().err().map(Failure::from).into_iter().collect();
    let rows = stopped.into_iter();
    let rows: Vec<each::Row<StopReport>> = rows
        .map(|member| each::Row::new(member, |report, _| problems(report)))
        .collect();
    output.json_report(&Drives {
        drives: rows
            .iter()
            .map(|row| row.entry(|report, _| report.clone()))
            .collect(),
        left_out: Vec::new(),
    });
    if !output.json() {
        let mut table = Table::new(&["drive", "at rest", "what was done"]);
        for row in &rows {
            let report = row.done.as_ref();
            let at_rest = report.map_or("not known", |report| if report.at_rest { "yes" } else { "no" });
            let done = report.map_or_else(String::new, StopReport::to_string);
            table.row([row.name.clone(), at_rest.to_owned(), done]);
        }
        output.table(&table);
    }
    for report in rows.iter().filter_map(|row| row.done.as_ref()) {
        remarks(report, output);
    }
    each::ended(&rows, None, output)?;
    Ok(closed?)
}

impl From<StopError> for Failure {
    fn from(error: StopError) -> Self {
        match error {
            StopError::Drive(error) => error.into(),
            StopError::Motion(error) => error.into(),
        }
    }
}

//! `profidrive stop`

use client::{Drive, StopWay, Wait};
use profidrive::fleet::{self, StopError};
use profidrive::motion::{self, StopReport};

use super::axis;
use super::each::{self, Row, Shown};
use super::remark;
use crate::args::{Stop, Target};
use crate::connect::{self, Need};
use crate::failure::Failure;
use crate::output::Output;

pub fn run(args: &Stop, target: &Target, output: &Output) -> Result<(), Failure> {
    let way = if args.disable {
        StopWay::Disable
    } else {
        StopWay::Stop
    };
    if connect::selector(target, output)?.single().is_none() {
        return many(way, args, target, output);
    }
    let (report, drive) = axis::with_drive(target, Need::Stop, output, |session, drive| {
        let report = motion::stop(session, drive, way, args.timeout).wait()?;
        Ok((report, drive.clone()))
    })?;
    each::shown_alone(args, &report, &drive, output)
}

impl Shown for Stop {
    type Done = StopReport;
    type Report = StopReport;
    const COLUMNS: &'static [&'static str] = &["at rest", "what was done"];

    fn report(&self, done: &StopReport, _: &Drive) -> StopReport {
        done.clone()
    }

    fn show(&self, done: &StopReport, _: &Drive, output: &Output) {
        output.line(&done.to_string());
    }

    fn remark(&self, done: &StopReport, _: &Drive, output: &Output) {
        remarks(done, output);
    }

    fn remark_on_all(&self, rows: &[Row<StopReport>], output: &Output) {
        for report in rows.iter().filter_map(|row| row.done.as_ref()) {
            remarks(report, output);
        }
    }

    fn rows(&self, done: &StopReport, _: &Drive) -> Vec<Vec<String>> {
        let at_rest = if done.at_rest { "yes" } else { "no" };
        vec![vec![at_rest.to_owned(), done.to_string()]]
    }

    fn missing_row(&self, _: bool) -> Option<Vec<String>> {
        Some(vec!["not known".to_owned(), String::new()])
    }

    fn problems(&self, done: &StopReport, _: &Drive) -> Vec<Failure> {
        done.check().err().map(Failure::from).into_iter().collect()
    }
}

/// What is to be known beside how a drive was stopped.
fn remarks(report: &StopReport, output: &Output) {
    for remark in report.remarks() {
        remark::print(&remark, "", output);
    }
}

fn many(way: StopWay, args: &Stop, target: &Target, output: &Output) -> Result<(), Failure> {
    let selector = connect::selector(target, output)?;
    let (opening, mut session) = connect::network(target, &selector, Need::Stop, output)?;
    let stopped = fleet::stop(&opening, &mut session, &selector, way, args.timeout).wait();
    let stopped = stopped.map_err(Failure::from)?;
    let closed = session.close().wait();
    each::shown(args, stopped, Vec::new(), output)?;
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

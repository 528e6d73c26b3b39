//! `profidrive gsdml check FILE`

use client::ErrorKind;
use profidrive::device_description::{self, UnreadError};
use profidrive::report::GsdmlProblem;
use profidrive::{Outcome, Reported};

use crate::args::GsdmlCheck;
use crate::failure::Failure;
use crate::output::{Colour, Output};
use crate::render::table::clean;

pub fn run(args: &GsdmlCheck, output: &Output) -> Result<(), Failure> {
    let path = &args.file;
    let unread = |error: UnreadError| Failure::new(ErrorKind::Local, error.to_string());
    let Reported { report, outcome } = device_description::check(path).map_err(unread)?;
    output.json_report(&report);
    if !output.json() {
        for problem in &report.problems {
            output.line(&format!(
                "{}:{}:{}: {} {} [{}]",
                path.display(),
                problem.line,
                problem.column,
                output.paint(colour(problem), &format!("{}:", problem.severity)),
                clean(&problem.message),
                problem.rule,
            ));
        }
        for words in &report.pictures {
            let warning = output.paint(Colour::Warning, "warning:");
            output.line(&format!(
                "{}: {warning} {} [picture]",
                path.display(),
                clean(words)
            ));
        }
        if report.left_out > 0 {
            output.line(&format!("and {} more", report.left_out));
        }
    }
    let warnings = report
        .problems
        .iter()
        .filter(|problem| problem.is_warning())
        .count();
    let errors = report.problems.len() - warnings + report.left_out;
    if outcome == Outcome::Complete {
        let also = match warnings + report.pictures.len() {
            0 => String::new(),
            1 => ", 1 warning".to_owned(),
            more => format!(", {more} warnings"),
        };
        output.say(&format!("{}: nothing against the rules{also}", path.display()));
        return Ok(());
    }
    let what = if report.usable {
        "the file can be used here, other tools may refuse it"
    } else {
        "the file cannot be used"
    };
    let count = if errors == 1 {
        "1 error".to_owned()
    } else {
        format!("{errors} errors")
    };
    Err(Failure::new(
        ErrorKind::Difference,
        format!("{}: {count}; {what}", path.display()),
    ))
}

fn colour(problem: &GsdmlProblem) -> Colour {
    if problem.is_warning() {
        Colour::Warning
    } else {
        Colour::Fault
    }
}

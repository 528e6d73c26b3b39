//! `profidrive doctor [DRIVE]`

use client::{ErrorKind, Wait};
use profidrive::report::{DoctorReport, Finding, Severity};
use profidrive::{Reported, doctor};

use crate::advice::Commands;
use crate::args::{Doctor, DriveOptions};
use crate::connect::{self, Need};
use crate::failure::Failure;
use crate::output::{Colour, Output};
use crate::render::Page;

pub fn run(args: &Doctor, options: &DriveOptions, output: &Output) -> Result<(), Failure> {
    let target = options.target(&args.drive);
    let selector = connect::selector(&target, output)?;
    let selector = (args.drive != "all").then_some(selector);
    let opening = connect::unopened(&target, Need::Identity)?;
    let mut steps = connect::steps(output);
    let wording = Commands(&args.drive);
    let examined = doctor::examine(&opening, selector.as_ref(), &wording, &mut |step| {
        steps.show(&step)
    })
    .wait();
    drop(steps);
    let Reported { report, outcome } = examined?;
    output.report(&report);
    outcome.kind().map_or(Ok(()), |kind| Err(ended(kind, &report)))
}

fn ended(kind: ErrorKind, report: &DoctorReport) -> Failure {
    let of_errors = report
        .findings
        .iter()
        .filter(|one| one.severity == Severity::Error);
    let mut names: Vec<&str> = of_errors.map(|one| one.check.name()).collect();
    names.dedup();
    Failure::new(kind, format!("problems found: {}", profidrive::listed(&names)))
}

impl Page for DoctorReport {
    fn print(&self, output: &Output) {
        for finding in &self.findings {
            print(finding, output);
        }
    }
}

/// `error    loss       akd-1: packet loss: ..`, and below it why that matters and what to do.
fn print(finding: &Finding, output: &Output) {
    let (colour, word) = match finding.severity {
        Severity::Ok => (Colour::Normal, "ok"),
        Severity::Note => (Colour::Action, "note"),
        Severity::Unchecked => (Colour::Faint, "unchecked"),
        Severity::Warning => (Colour::Warning, "warning"),
        Severity::Error => (Colour::Fault, "error"),
    };
    let drive = finding
        .drive
        .as_ref()
        .map_or_else(String::new, |drive| format!("{drive}: "));
    let word = output.paint(colour, &format!("{word:<9}"));
    output.line(&format!(
        "{word}  {:<10}  {drive}{}",
        finding.check.name(),
        finding.found
    ));
    let more = [("why", finding.why), ("remedy", finding.remedy.as_deref())];
    for (name, text) in more {
        if let Some(text) = text.filter(|_| finding.severity != Severity::Ok) {
            output.line(&format!("{:23}{name}: {text}", ""));
        }
    }
}

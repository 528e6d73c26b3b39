//! `profidrive doctor [DRIVE]`

use client::{ErrorKind, Wait};
use profidrive::report::{Check, DoctorReport, Finding, Severity};
use profidrive::{Reported, doctor};

use crate::advice::Commands;
use crate::args::{Doctor, DriveOptions};
use crate::connect::{self, Need};
use crate::failure::Failure;
use crate::output::{Colour, Output};
use crate::render::Page;

/// So many drives that are well share a line.
const MANY: usize = 17;

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
        let mut gathered = Vec::new();
        for finding in &self.findings {
            let check = finding.check;
            let well = self
                .findings
                .iter()
                .filter(|other| other.check == check && is_well(other));
            let count = well.count();
            if output.verbose() || !is_well(finding) || count < MANY {
                print(finding, output);
            } else if !gathered.contains(&check) {
                gathered.push(check);
                print(&together(self, check, count), output);
            }
        }
    }
}

/// Whether a finding is about a drive that is as it should be.
fn is_well(finding: &Finding) -> bool {
    finding.severity == Severity::Ok && finding.drive.is_some()
}

/// Returns one finding for many drives that are well.
fn together(report: &DoctorReport, check: Check, count: usize) -> Finding {
    let found = match check {
        Check::Loss => {
            let complete = report.links.iter().filter(|link| link.answers == link.requests);
            let slowest = complete.filter_map(|link| link.max).fold(0.0, f64::max);
            format!(
                "{count} drives: no request lost, answers after {:.1} ms at most",
                slowest * 1e3
            )
        }
        Check::Neighbours => format!("{count} drives report their neighbours"),
        _ => format!("{count} drives are as they should be"),
    };
    Finding::new(check, Severity::Ok, found)
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

#[cfg(test)]
mod tests {
    use profidrive::report::LinkReport;

    use super::*;

    #[test]
    fn many_drives_that_are_well_share_a_line() {
        let link = |max| LinkReport {
            drive: "akd-1".into(),
            mac: None,
            requests: 40,
            answers: 40,
            median: Some(0.001),
            max: Some(max),
        };
        let report = DoctorReport {
            interface: None,
            findings: Vec::new(),
            timers: None,
            links: vec![
                link(0.002),
                link(0.0125),
                LinkReport {
                    answers: 39,
                    ..link(0.09)
                },
            ],
        };
        let found = |check| together(&report, check, 299).found;
        assert_eq!(
            found(Check::Loss),
            "299 drives: no request lost, answers after 12.5 ms at most"
        );
        assert_eq!(found(Check::Neighbours), "299 drives report their neighbours");
        assert!(!is_well(&Finding::new(
            Check::Stations,
            Severity::Ok,
            "299 stations answered"
        )));
    }
}

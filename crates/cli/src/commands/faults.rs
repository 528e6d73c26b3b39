//! `profidrive faults DRIVE`, and the acknowledge that needs no control

use std::time::Duration;

use client::status::{Cause, Note, diagnose};
use client::{Drive, FaultEntry, FaultReport, LoggedFault, Wait, WarningEntry, WriteMode};
use profile::catalogue::{Cleared, Role};
use profile::fault::Counting;
use profile::value::Assignment;
use serde_json::{Map, Value};

use crate::advice;
use crate::args::Interface;
use crate::connect::{self, Need};
use crate::failure::{Exit, Failure};
use crate::fields;
use crate::output::{Colour, Output};
use crate::render::words;

/// How long a drive may take to clear its faults, and how often that is looked at.
const CLEAR_TIMEOUT: Duration = Duration::from_secs(1);
const GLANCE: Duration = Duration::from_millis(50);

/// Arguments of `faults`.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// Station name, IP address, MAC address, or fc:PORT/ADDRESS or uss:PORT/ADDRESS
    pub drive: String,
    /// Also the faults that were acknowledged, situation by situation
    #[arg(long)]
    pub history: bool,
}

pub fn run(args: &Args, interface: &Interface, output: &Output) -> Result<(), Failure> {
    let (mut session, mut drive) = connect::drive(interface, Need::Records, &args.drive, output)?;
    let report = session.fault_report(&mut drive).wait()?;
    session.close().wait()?;
    if output.json() {
        output.document("faults", json(&drive, &report, args.history));
        return Ok(());
    }
    for line in lines(&report, args.history) {
        match line {
            Line::Fault(text) => output.line(&output.paint(Colour::Fault, &text)),
            Line::Warning(text) => output.line(&output.paint(Colour::Warning, &text)),
            Line::Normal(text) => output.line(&output.paint(Colour::Normal, &text)),
            Line::Plain(text) => output.line(&text),
        }
    }
    let before = report.faults.iter().filter(|fault| fault.situation > 0).count();
    if before > 0 && !args.history {
        output.say(&format!("{before} acknowledged before, --history shows them"));
    }
    if let Some(advice) = advice(&report, &drive.label()) {
        output.say(&advice);
    }
    Ok(())
}

/// What ends the faults that are present: what only a restart clears is not to be acknowledged.
fn advice(report: &FaultReport, drive: &str) -> Option<String> {
    let mut restart = report
        .present()
        .map(|fault| fault.cleared == Some(Cleared::Restart));
    let first = restart.next()?;
    Some(match (first, restart.all(|one| one == first)) {
        (true, true) => {
            format!("{drive} has to be switched off and on once the cause is gone: no command clears it")
        }
        (false, true) => format!("`profidrive ack {drive}` acknowledges once the cause is gone"),
        (_, false) => format!(
            "`profidrive ack {drive}` acknowledges once the cause is gone; what only a restart clears takes a power cycle"
        ),
    })
}

#[derive(Debug, PartialEq, Eq)]
enum Line {
    Fault(String),
    Warning(String),
    Normal(String),
    Plain(String),
}

fn lines(report: &FaultReport, history: bool) -> Vec<Line> {
    let mut lines = Vec::new();
    let detail = |lines: &mut Vec<Line>, name: &str, text: &str| {
        if !text.is_empty() {
            lines.push(Line::Plain(format!("  {name:<9} {text}")));
        }
    };
    for fault in report.present() {
        lines.push(Line::Fault(title(fault)));
        describe(fault, &mut |name, text| detail(&mut lines, name, text));
    }
    let flags = report.zsw1.unwrap_or(0);
    if report.present().next().is_none() {
        lines.push(if words::has_fault(flags) {
            Line::Fault("ZSW1 bit 3 tells a fault, the fault buffer has none".into())
        } else {
            Line::Normal("no fault is present".into())
        });
    }
    for warning in report.warnings.iter().flatten() {
        let meaning = warning.meaning.unwrap_or("not in the tables");
        lines.push(Line::Warning(format!("n{} {meaning}", warning.number)));
        detail(&mut lines, "remedy", warning.remedy.unwrap_or_default());
    }
    if words::has_warning(flags) && report.warnings.iter().flatten().next().is_none() {
        lines.push(Line::Warning(
            "ZSW1 bit 7 tells a warning, the drive has no number for it".into(),
        ));
    }
    if history {
        let mut last = 0;
        for fault in report.faults.iter().filter(|fault| fault.situation > 0) {
            if fault.situation != last {
                last = fault.situation;
                lines.push(Line::Plain(format!("situation {last} (acknowledged)")));
            }
            lines.push(Line::Plain(format!("  {}", title(fault))));
            describe(fault, &mut |name, text| {
                if !text.is_empty() {
                    lines.push(Line::Plain(format!("    {name:<9} {text}")));
                }
            });
        }
        if !report.log.is_empty() {
            lines.push(Line::Plain("log of the drive, the newest first".into()));
        }
        for fault in &report.log {
            lines.push(Line::Plain(logged(fault)));
        }
        let counter = report.counter;
        let counted = match report.counting {
            Counting::Changes => "changes of the fault buffer",
            Counting::Situations => "fault situations",
        };
        lines.push(Line::Plain(format!("{counter} {counted} so far (PNU 944)")));
    }
    lines
}

/// `F702 Fieldbus communication lost`
fn title(fault: &FaultEntry) -> String {
    format!(
        "F{} {}",
        fault.number,
        fault.meaning.unwrap_or("not in the tables")
    )
}

/// `  F14 Earth fault, value 3, time 120`
fn logged(fault: &LoggedFault) -> String {
    let meaning = fault.meaning.unwrap_or("not in the tables");
    let part =
        |name: &str, value: Option<i64>| value.map_or_else(String::new, |value| format!(", {name} {value}"));
    format!(
        "  F{} {meaning}{}{}",
        fault.number,
        part("value", fault.value),
        part("time", fault.time)
    )
}

fn describe(fault: &FaultEntry, line: &mut dyn FnMut(&str, &str)) {
    line("reaction", fault.reaction.map_or("", |reaction| reaction.text()));
    line("remedy", fault.remedy.unwrap_or_default());
    line("cleared", fault.clearing.as_deref().unwrap_or_default());
    let number = |value: Option<i64>| value.map_or_else(String::new, |value| value.to_string());
    line("time", &number(fault.time));
    line("value", &number(fault.value));
}

fn json(drive: &Drive, report: &FaultReport, history: bool) -> Map<String, Value> {
    let faults: Vec<Value> = report
        .faults
        .iter()
        .filter(|fault| history || fault.situation == 0)
        .map(|fault| Value::Object(fault_json(fault)))
        .collect();
    let warnings = report.warnings.as_ref().map(|warnings| {
        let list = warnings.iter().map(warning_json);
        list.map(Value::Object).collect::<Vec<Value>>()
    });
    let logged = |fault: &LoggedFault| {
        Value::Object(fields! {
            "number": fault.number, "meaning": fault.meaning, "value": fault.value, "time": fault.time,
        })
    };
    let log: Vec<Value> = report.log.iter().filter(|_| history).map(logged).collect();
    fields! {
        "log": log, "drive": drive.label(), "counter": report.counter, "situations": report.shape.situations,
        "faults_per_situation": report.shape.faults, "fault_bit": report.zsw1.map(words::has_fault),
        "warning_bit": report.zsw1.map(words::has_warning), "faults": faults, "warnings": warnings,
    }
}

fn fault_json(fault: &FaultEntry) -> Map<String, Value> {
    fields! {
        "number": fault.number, "situation": fault.situation, "position": fault.position,
        "acknowledged": fault.situation > 0, "meaning": fault.meaning,
        "reaction": fault.reaction.map(|reaction| reaction.text()), "remedy": fault.remedy,
        "cleared": fault.clearing.as_deref(), "time": fault.time, "value": fault.value,
    }
}

pub fn warning_json(warning: &WarningEntry) -> Map<String, Value> {
    fields! { "number": warning.number, "meaning": warning.meaning, "remedy": warning.remedy }
}

/// Clears the faults by parameter (DRV.CLRFAULTS), beside whoever has control.
pub fn clear(drive: &str, interface: &Interface, output: &Output) -> Result<(), Failure> {
    let (mut session, mut drive) = connect::drive(interface, Need::Records, drive, output)?;
    let command = drive
        .model
        .catalogue
        .and_then(|tables| tables.with_role(Role::ClearFaults))
        .ok_or_else(|| {
            let message = format!(
                "{}: model {} has no parameter that clears its faults",
                drive.label(),
                drive.model.name
            );
            Failure::new(Exit::Failed, message)
                .hint("without --by-parameter control is taken and STW1 bit 7 does it")
        })?;
    let before = session.faults(&mut drive).wait()?;
    for fault in before.iter().filter(|fault| fault.situation == 0) {
        output.say(&title(fault));
    }
    output.say(&format!("acknowledging with {} (p{})", command.name, command.pnu));
    let assignment = Assignment::of(command, 1);
    let outcomes = session
        .write(&mut drive, &[assignment], WriteMode::Write)
        .wait()?;
    if let Some(Err(refusal)) = outcomes.into_iter().find_map(|outcome| outcome.written) {
        let drive = drive.label();
        return Err(client::Error::Refused { drive, refusal }.into());
    }
    // the drive takes the command in its own time
    let end = session.now() + CLEAR_TIMEOUT;
    let report = loop {
        let report = session.fault_report(&mut drive).wait()?;
        if report.present().next().is_none() || session.now() >= end {
            break report;
        }
        session.pass(GLANCE).wait()?;
    };
    let mut left: Vec<String> = report.present().map(title).collect();
    let mut hint = "remove the cause, then acknowledge again".to_owned();
    if !left.is_empty() {
        let status = session.status(&mut drive).wait()?;
        let turns = |note: &Note| note.id == Cause::MovedExternally.id();
        if let Some(moved) = diagnose(&status).notes.into_iter().find(turns) {
            left.push(moved.sentence);
            hint = moved
                .next
                .map_or(hint, |next| advice::text(&next, &drive.label()));
        }
    }
    session.close().wait()?;
    if output.json() {
        output.document("ack", json(&drive, &report, false));
    }
    if left.is_empty() {
        output.say("no fault is present");
        return Ok(());
    }
    let message = format!("{}: the fault stays: {}", drive.label(), left.join("; "));
    Err(Failure::new(Exit::Refused, message).hint(hint))
}

#[cfg(test)]
mod tests {
    use dissect::explain::Kind;

    use super::*;
    use client::status::DriveStatus;
    use profile::catalogue::{AKD, Catalogue, VACON, VLT};
    use profile::fault::Shape;
    use profile::notation::ParameterReference;
    use profile::state::Zsw1;

    fn fault(number: u16, situation: u8) -> FaultEntry {
        FaultEntry {
            situation,
            ..FaultEntry::of(number, Some(&AKD))
        }
    }

    fn report(faults: Vec<FaultEntry>, zsw1: u16) -> FaultReport {
        FaultReport {
            counting: Counting::Changes,
            counter: 3,
            shape: Shape::EIGHT_BY_EIGHT,
            faults,
            warnings: Some(Vec::new()),
            zsw1: Some(zsw1),
            log: Vec::new(),
        }
    }

    #[test]
    fn what_only_a_restart_clears_is_not_to_be_acknowledged() {
        let report = |cleared: &[Cleared]| FaultReport {
            counting: Counting::Changes,
            counter: 1,
            shape: Shape::EIGHT_BY_EIGHT,
            faults: cleared
                .iter()
                .map(|&cleared| FaultEntry {
                    number: 8,
                    cleared: Some(cleared),
                    ..FaultEntry::default()
                })
                .collect(),
            warnings: None,
            zsw1: None,
            log: Vec::new(),
        };
        let advice_for = |cleared: &[Cleared]| advice(&report(cleared), "d").unwrap_or_default();
        assert_eq!(advice_for(&[]), "");
        assert!(
            advice_for(&[Cleared::Restart]).contains("off and on")
                && !advice_for(&[Cleared::Restart]).contains(" ack ")
        );
        assert!(advice_for(&[Cleared::Acknowledge]).starts_with("`profidrive ack d`"));
        assert!(advice_for(&[Cleared::Restart, Cleared::Acknowledge]).contains("power cycle"));
    }

    /// Everything in a text that looks like a parameter of any vendor: `DRV.CLRFAULTS`, `14-20`, `ID 607`.
    fn named(text: &str) -> Vec<String> {
        let all = |text: &str, is: fn(char) -> bool| !text.is_empty() && text.chars().all(is);
        let upper = |text: &str| all(text, |c| c.is_ascii_uppercase() || c.is_ascii_digit());
        let digits = |text: &str| all(text, |c| c.is_ascii_digit());
        let words: Vec<&str> = text
            .split(|c: char| !(c.is_ascii_alphanumeric() || matches!(c, '.' | '-')))
            .map(|word| word.trim_matches('.'))
            .collect();
        let akd = |word: &str| {
            word.split_once('.')
                .is_some_and(|(group, name)| upper(group) && upper(name) && !digits(group))
        };
        let vlt = |word: &str| {
            word.split_once('-')
                .is_some_and(|(group, number)| digits(group) && digits(number))
        };
        let single = words
            .iter()
            .filter(|word| akd(word) || vlt(word))
            .map(|word| (*word).to_owned());
        let ids = words.windows(2).filter(|pair| pair[0] == "ID" && digits(pair[1]));
        single.chain(ids.map(|pair| pair.join(" "))).collect()
    }

    /// `status`, `faults` and `explain` say the same about each fault of each vendor, with parameters of that vendor.
    #[test]
    fn remedies_agree_and_name_the_vendor_s_own_parameters() {
        let mut names = 0;
        for tables in [&AKD, &VLT, &VACON] as [&'static Catalogue; 3] {
            let model = tables.model;
            for row in tables.faults.iter().filter(|row| !row.warning) {
                let entry = FaultEntry::of(row.number, Some(tables));
                let status = DriveStatus {
                    drive: "d".into(),
                    model,
                    zsw1: Some(Zsw1(0x0208)),
                    faults: vec![entry.clone()],
                    ..DriveStatus::default()
                };
                let next = diagnose(&status).next.unwrap_or_default();
                let next = advice::text(&next, "d");
                let report = report(vec![entry], 8);
                let listed = format!("{:?}", lines(&report, false));
                let ends = advice(&report, "d").unwrap_or_default();
                let number = row.number.to_string();
                let known = profile::model::Model::by_name(tables.model);
                let explained = dissect::explain::explain(&number, Kind::Fault, None, known).unwrap();
                let explained = explained.lines.join("\n");
                let place = format!(
                    "{model} F{}: {next} / {listed} / {ends} / {explained}",
                    row.number
                );
                let clearing = tables.clearing(row.cleared);
                for text in [&listed, &explained] {
                    assert!(text.contains(row.remedy) && text.contains(&clearing), "{place}");
                }
                assert!(next.contains(row.remedy), "{place}");
                for text in [&next, &ends] {
                    let restart = row.cleared == Cleared::Restart;
                    assert_eq!(text.contains("off and on"), restart, "{place}");
                    assert_eq!(text.contains("`profidrive ack d`"), !restart, "{place}");
                }
                let shown = format!("{next} {} {clearing} {ends}", row.remedy);
                for name in named(&shown) {
                    let reference: ParameterReference = name.parse().unwrap();
                    let parameters = profile::value::Parameters {
                        catalogue: Some(tables),
                        scaling: tables.scaling,
                    };
                    let found = parameters.select(&reference).ok();
                    let own = found.is_some_and(|found| found.parameter.is_some());
                    assert!(own, "{name} is not of this vendor: {place}");
                    names += 1;
                }
            }
        }
        assert!(names > 20, "{names}");
    }

    #[test]
    fn what_is_present_stands_first_and_history_on_demand() {
        let both = report(vec![fault(702, 0), fault(439, 1)], 0x0008);
        let short = lines(&both, false);
        assert!(
            matches!(&short[0], Line::Fault(text) if text.starts_with("F702 ")),
            "{short:?}"
        );
        assert!(
            short.contains(&Line::Plain("  reaction  quick stop".into())),
            "{short:?}"
        );
        assert!(!format!("{short:?}").contains("F439"));
        let long = format!("{:?}", lines(&both, true));
        assert!(
            long.contains("situation 1 (acknowledged)") && long.contains("F439 "),
            "{long}"
        );
    }

    #[test]
    fn a_fault_bit_without_a_number_is_reported() {
        assert_eq!(
            lines(&report(Vec::new(), 0), false),
            [Line::Normal("no fault is present".into())]
        );
        let text = format!("{:?}", lines(&report(Vec::new(), 0x0088), false));
        assert!(
            text.contains("ZSW1 bit 3 tells a fault") && text.contains("ZSW1 bit 7 tells a warning"),
            "{text}"
        );
        let unknown = lines(&report(vec![fault(9999, 0)], 8), false);
        assert_eq!(unknown, [Line::Fault("F9999 not in the tables".into())]);
    }
}

//! `profidrive faults DRIVE`

use client::{Drive, Session};
use profidrive::inspection;
use profidrive::report::{Fault, FaultsReport, LogEntry, Warning};

use super::each::{self, Each, Progress, Shown};
use crate::advice;
use crate::args::{Faults, Target};
use crate::failure::Failure;
use crate::output::{Colour, Output};
use crate::render::Page;

pub fn run(args: &Faults, target: &Target, output: &Output) -> Result<(), Failure> {
    each::run(args, target, output)
}

impl Each for Faults {
    const DOING: &'static str = "reading the faults";

    async fn work(
        &self,
        session: &mut Session,
        drive: &mut Drive,
        _: &mut Progress<'_>,
    ) -> Result<FaultsReport, Failure> {
        Ok(inspection::faults(session, drive, self.history).await?)
    }
}

impl Shown for Faults {
    type Done = FaultsReport;
    type Report = FaultsReport;
    const COLUMNS: &'static [&'static str] = &["number", "meaning", "remedy"];

    fn report(&self, done: &FaultsReport, _: &Drive) -> FaultsReport {
        done.clone()
    }

    fn show(&self, done: &FaultsReport, _: &Drive, output: &Output) {
        done.print(output);
    }

    fn rows(&self, done: &FaultsReport, _: &Drive) -> Vec<Vec<String>> {
        let texts = |meaning: &Option<String>, remedy: &Option<String>| {
            [
                meaning.clone().unwrap_or_else(|| "not in the tables".to_owned()),
                remedy.clone().unwrap_or_default(),
            ]
        };
        let row = |number: String, [meaning, remedy]: [String; 2]| vec![number, meaning, remedy];
        let fault = |fault: &Fault| {
            let before = if fault.acknowledged { " (acknowledged)" } else { "" };
            let number = format!("F{}{before}", fault.number);
            row(number, texts(&fault.meaning, &fault.remedy))
        };
        let warning = |warning: &Warning| {
            row(
                format!("n{}", warning.number),
                texts(&warning.meaning, &warning.remedy),
            )
        };
        let faults = done.faults.iter().map(fault);
        let rows: Vec<Vec<String>> = faults.chain(done.warnings.iter().map(warning)).collect();
        if rows.is_empty() {
            return vec![vec![
                "-".to_owned(),
                "no fault is present".to_owned(),
                String::new(),
            ]];
        }
        rows
    }

    fn urgency(&self, done: &FaultsReport) -> u8 {
        u8::from(done.present().next().is_some()) * 2 + u8::from(!done.warnings.is_empty())
    }
}

impl Page for FaultsReport {
    fn print(&self, output: &Output) {
        for line in lines(self) {
            match line {
                Line::Fault(text) => output.line(&output.paint(Colour::Fault, &text)),
                Line::Warning(text) => output.line(&output.paint(Colour::Warning, &text)),
                Line::Normal(text) => output.line(&output.paint(Colour::Normal, &text)),
                Line::Plain(text) => output.line(&text),
            }
        }
        if self.acknowledged > 0 && !self.history {
            output.say(&format!(
                "{} acknowledged before, --history shows them",
                self.acknowledged
            ));
        }
        let advice = self.advice();
        if !advice.is_empty() {
            output.say(&advice::text(&advice, &self.drive));
        }
    }
}

#[derive(Debug, PartialEq, Eq)]
enum Line {
    Fault(String),
    Warning(String),
    Normal(String),
    Plain(String),
}

fn lines(report: &FaultsReport) -> Vec<Line> {
    let mut lines = Vec::new();
    for fault in report.present() {
        lines.push(Line::Fault(title(fault.number, fault.meaning.as_deref())));
        lines.extend(described(fault, "  "));
    }
    if report.present().next().is_none() {
        lines.push(if report.fault_bit == Some(true) {
            Line::Fault("ZSW1 bit 3 reports a fault, the fault buffer has none".into())
        } else {
            Line::Normal("no fault is present".into())
        });
    }
    for warning in &report.warnings {
        let meaning = warning.meaning.as_deref().unwrap_or("not in the tables");
        lines.push(Line::Warning(format!("n{} {meaning}", warning.number)));
        lines.extend(detail("  ", "remedy", warning.remedy.clone()));
    }
    if report.warning_bit == Some(true) && report.warnings.is_empty() {
        lines.push(Line::Warning(
            "ZSW1 bit 7 reports a warning, the drive has no number for it".into(),
        ));
    }
    if report.history {
        let mut last = 0;
        for fault in report.faults.iter().filter(|fault| fault.acknowledged) {
            if fault.situation != last {
                last = fault.situation;
                lines.push(Line::Plain(format!("situation {last} (acknowledged)")));
            }
            let title = title(fault.number, fault.meaning.as_deref());
            lines.push(Line::Plain(format!("  {title}")));
            lines.extend(described(fault, "    "));
        }
        if !report.log.is_empty() {
            lines.push(Line::Plain("log of the drive, the newest first".into()));
        }
        for entry in &report.log {
            lines.push(Line::Plain(logged(entry)));
        }
        let counted = match report.counts {
            "changes" => "changes of the fault buffer",
            _ => "fault situations",
        };
        lines.push(Line::Plain(format!(
            "{counted} counted by the drive: {} (PNU 944)",
            report.counter
        )));
        if let Some(situations) = report.situation_counter {
            lines.push(Line::Plain(format!(
                "fault situations counted by the drive: {situations} (PNU 952)"
            )));
        }
    }
    lines
}

/// `F702 Fieldbus communication lost`
fn title(number: u16, meaning: Option<&str>) -> String {
    format!("F{number} {}", meaning.unwrap_or("not in the tables"))
}

/// `  F14 Earth fault, value 3, time 120`
fn logged(entry: &LogEntry) -> String {
    let part =
        |name: &str, value: Option<i64>| value.map_or_else(String::new, |value| format!(", {name} {value}"));
    format!(
        "  {}{}{}",
        title(entry.number, entry.meaning.as_deref()),
        part("value", entry.value),
        part("time", entry.time)
    )
}

fn described(fault: &Fault, indent: &str) -> impl Iterator<Item = Line> {
    let number = |value: Option<i64>| value.map(|value| value.to_string());
    [
        ("reaction", fault.reaction.clone()),
        ("remedy", fault.remedy.clone()),
        ("cleared", fault.cleared.clone()),
        ("time", number(fault.time)),
        ("value", number(fault.value)),
    ]
    .into_iter()
    .filter_map(|(name, text)| detail(indent, name, text))
}

fn detail(indent: &str, name: &str, text: Option<String>) -> Option<Line> {
    let text = text.filter(|text| !text.is_empty())?;
    Some(Line::Plain(format!("{indent}{name:<9} {text}")))
}

#[cfg(test)]
mod tests {
    use dissect::explain::Kind;

    use super::*;
    use client::status::{DriveStatus, diagnose};
    use client::{FaultEntry, FaultReport};
    use profile::catalogue::{AKD, Catalogue, Cleared, VACON, VLT};
    use profile::fault::{Counting, Shape};
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
            situations: Some(2),
            shape: Shape::EIGHT_BY_EIGHT,
            faults,
            warnings: Some(Vec::new()),
            zsw1: Some(zsw1),
            log: Vec::new(),
        }
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

    /// `status`, `faults` and `explain` describe each fault of each vendor alike, with parameters of that vendor.
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
                let report = FaultsReport::new("d", &report(vec![entry], 8), false);
                let listed = format!("{:?}", lines(&report));
                let ends = advice::text(&report.advice(), "d");
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
        let lines_of = |history| lines(&FaultsReport::new("d", &both, history));
        let short = lines_of(false);
        assert!(
            matches!(&short[0], Line::Fault(text) if text.starts_with("F702 ")),
            "{short:?}"
        );
        assert!(
            short.contains(&Line::Plain("  reaction  quick stop".into())),
            "{short:?}"
        );
        assert!(!format!("{short:?}").contains("F439"));
        let long = format!("{:?}", lines_of(true));
        assert!(
            long.contains("situation 1 (acknowledged)") && long.contains("F439 "),
            "{long}"
        );
    }

    #[test]
    fn a_fault_bit_without_a_number_is_reported() {
        let lines_of = |faults, zsw1| lines(&FaultsReport::new("d", &report(faults, zsw1), false));
        assert_eq!(
            lines_of(Vec::new(), 0),
            [Line::Normal("no fault is present".into())]
        );
        let text = format!("{:?}", lines_of(Vec::new(), 0x0088));
        assert!(
            text.contains("ZSW1 bit 3 reports a fault") && text.contains("ZSW1 bit 7 reports a warning"),
            "{text}"
        );
        let unknown = lines_of(vec![fault(9999, 0)], 8);
        assert_eq!(unknown, [Line::Fault("F9999 not in the tables".into())]);
    }
}

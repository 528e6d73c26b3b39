//! A backup as text: one parameter a line, by number, the same settings always the same text.

use std::fmt::{self, Write as _};

use profile::catalogue::{Parameter, Scaling};
use profile::notation::Quantity;
use profile::notation::setting::{Form, is_unsafe};
use profile::parameter::{CodeSpace, Format};

use super::nearest::nearest;
use super::task::Name;
use super::{Backup, selection};
use profile::value::{Content, Parameters, Reading};

/// The text of a backup. People edit it, so it has no checksum.
pub(crate) const FORM: Form = Form {
    kind: "backup",
    oldest: 1,
    version: 1,
    sealed: false,
    comment_column: 40,
    comment_gap: 2,
};
/// Longest decimal text that is printed where a shorter one and the raw number would do.
const SHORT: usize = 10;

impl fmt::Display for Backup {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let text = self.text(&FORM, &[], &|reading| comment(self, reading), &|_| String::new());
        f.write_str(&text)
    }
}

impl Backup {
    /// Returns the text, with remarks under the header, a comment behind each value, and a note for each task.
    pub(crate) fn text(
        &self,
        form: &Form,
        remarks: &[String],
        comment: &dyn Fn(&Reading) -> String,
        task_note: &dyn Fn(u16) -> String,
    ) -> String {
        let mut text = form.begin(form.version);
        let scaling = self.parameters.catalogue.map(|_| &self.parameters.scaling);
        self.header.write(&mut text, scaling);
        for remark in remarks {
            text.comment(remark);
        }
        text.blank();
        for reading in &self.readings {
            let value = value(&self.parameters, reading);
            text.setting(&name(self, reading), &value, &comment(reading));
        }
        for (number, task) in &self.tasks {
            let values = task.text(&self.parameters);
            text.setting(&Name(*number).to_string(), &values, &task_note(*number));
        }
        for refusal in &self.refused {
            text.comment(&refusal.to_string());
        }
        text.finish()
    }
}

/// `p2108 DRV.ACC`
fn name(backup: &Backup, reading: &Reading) -> String {
    let shown = selection(&backup.parameters, reading).shown(0);
    match reading.name {
        Some(name) => format!("{shown} {}", plain(name)),
        None => shown.to_string(),
    }
}

/// A name without what has a meaning in the text of a backup.
pub(super) fn plain(name: &str) -> String {
    let kept = name
        .chars()
        .filter(|&c| !matches!(c, '#' | '=' | ':') && !is_unsafe(c));
    kept.collect()
}

/// A value in its unit as it is read back.
pub(crate) fn value(parameters: &Parameters, reading: &Reading) -> String {
    let parameter = parameters.at(reading.pnu, reading.index.unwrap_or(0));
    match (reading.raw(), parameter) {
        (Some(raw), Some(parameter)) => number(parameter, raw, &reading.octets, &parameters.scaling),
        _ => hex(&reading.octets),
    }
}

/// A number in its unit; the raw number too where the text does not say it exactly.
fn number(parameter: &Parameter, raw: i64, octets: &[u8], scaling: &Scaling) -> String {
    if !parameter.bits.is_empty() {
        return hex(octets);
    }
    let exact = parameter.engineering(raw, scaling);
    let text = decimal(exact, parameter.decimals());
    let unit = unit(parameter.unit_in(scaling));
    let says = |text: &str, exactly: bool| {
        let value = text.parse::<Quantity>().map(|one| one.number.as_f64());
        value.is_ok_and(|value| (!exactly || value == exact) && nearest(value, parameter, scaling) == Ok(raw))
    };
    if says(&text, true) {
        return format!("{text}{unit}");
    }
    let whole = format!("{exact}");
    if says(&whole, true) && (whole.len() <= SHORT || !says(&text, false)) {
        return format!("{whole}{unit}");
    }
    if says(&text, false) {
        return format!("{text}{unit} (raw {})", hex(octets));
    }
    // more digits than a decimal number of a program has
    hex(octets)
}

/// The unit behind a value; one that starts with a number would be read as a part of it.
fn unit(unit: &str) -> String {
    match unit.chars().next() {
        Some(first) if !first.is_ascii_digit() => format!(" {unit}"),
        _ => String::new(),
    }
}

fn decimal(value: f64, decimals: u8) -> String {
    let text = format!("{value:.*}", usize::from(decimals));
    if text.contains('.') {
        text.trim_end_matches('0').trim_end_matches('.').to_owned()
    } else {
        text
    }
}

fn hex(octets: &[u8]) -> String {
    let mut text = String::from("0x");
    for octet in octets {
        let _ = write!(text, "{octet:02X}");
    }
    text
}

/// What a person wants to know behind the value.
fn comment(backup: &Backup, reading: &Reading) -> String {
    let parameter = backup.parameters.at(reading.pnu, reading.index.unwrap_or(0));
    let Some(parameter) = parameter else {
        let format = Format(reading.format);
        let kind = format.info(CodeSpace::V4).map_or("", |info| info.name);
        return match &reading.content {
            Content::Number { raw, .. } => format!("{raw} {kind}"),
            Content::Float(value) => format!("{value} {kind}"),
            Content::Text(text) => format!("\"{text}\" {kind}"),
            Content::Octets => kind.to_owned(),
        };
    };
    let meaning = match reading.choice {
        Some(choice) => choice.to_owned(),
        None => reading
            .word
            .as_ref()
            .map_or_else(String::new, |task_note| task_note.join(", ")),
    };
    let steps = if unit(parameter.unit).is_empty() && !parameter.unit.is_empty() {
        format!("in steps of {}", parameter.unit)
    } else {
        String::new()
    };
    let kept = if parameter.saved {
        ""
    } else {
        "not saved by the drive"
    };
    let parts = [meaning.as_str(), parameter.description, steps.as_str(), kept];
    let parts: Vec<&str> = parts.into_iter().filter(|part| !part.is_empty()).collect();
    parts.join("; ")
}

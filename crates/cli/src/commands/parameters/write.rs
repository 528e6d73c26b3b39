//! `profidrive write`

use client::Wait;
use client::change::{Change, Persistence, Step};
use profidrive::parameters::{self, Write as Wanted, Written};
use profile::value::{Assignment, Content};

use super::last_failure;
use crate::advice::Commands;
use crate::args::{Target, Write};
use crate::connect::{self, Need};
use crate::failure::Failure;
use crate::output::Output;
use crate::render::table::{Table, clean};
use crate::render::{number, value};

pub fn write(args: &Write, target: &Target, output: &Output) -> Result<(), Failure> {
    let assignments: Vec<Assignment> = args
        .assignments
        .iter()
        .map(|text| text.parse().map_err(Failure::from))
        .collect::<Result<_, _>>()?;
    let (mut session, mut drive) = connect::drive(target, Need::Records, output)?;
    let wanted = Wanted {
        save: args.save,
        dry_run: args.dry_run,
    };
    let written = parameters::write(&mut session, &mut drive, &assignments, wanted).wait()?;
    session.close().wait()?;
    let label = drive.label();
    if let Some(name) = written.affected_controller() {
        output.warn(&format!(
            "controller \"{}\" runs {label}: what was written counts for its motion at once",
            clean(name),
        ));
    }
    output.json_report(&written.report(&drive, &Commands::any()));
    if !output.json() {
        for (assignment, change) in assignments.iter().zip(written.set.changes()) {
            let remark = raw_note(assignment, change)
                .or_else(|| rounded(assignment, change))
                .or_else(|| blanks_lost(assignment, change));
            if let Some(remark) = remark {
                output.say(&remark);
            }
        }
        let mut table = Table::new(&["name", "number", ">old", "", ">new", "unit", "result"]);
        for change in written.changes() {
            table.row(row(change, args.dry_run));
        }
        for line in table.lines() {
            output.line(&line);
        }
        if args.dry_run {
            output.say("dry run: nothing was written");
        } else {
            report_saved(&written, output);
        }
    }
    last_failure(written.problems(&label), output)
}

/// Reports which of the new values outlive the power of the drive, and which do not.
fn report_saved(written: &Written, output: &Output) {
    let kept = written.set.kept();
    let names =
        |changes: &[&Change]| -> Vec<String> { changes.iter().map(|change| change.label()).collect() };
    let (as_written, by_itself, lost) = (names(&kept.with_set), names(&kept.by_itself), names(&kept.lost));
    let only = by_itself.is_empty() && lost.is_empty();
    if !as_written.is_empty() {
        match kept.persistence {
            Persistence::Refused(_) => output.warn(&unsaved_words("the drive refused to save", &as_written)),
            Persistence::NotAsPlanned => {
                let why = "the save command was not sent because a value was refused";
                output.warn(&unsaved_words(why, &as_written));
            }
            Persistence::InDoubt => output.warn(&format!(
                "it is not known whether the drive saved {}: asked for, not answered",
                listed(&as_written)
            )),
            saved => output.say(&kept_words(saved, if only { &[] } else { &as_written })),
        }
    }
    if !by_itself.is_empty() {
        let which = listed(&by_itself);
        output.say(&format!(
            "saved in the drive: {which} (at a serial line it saves text with every write)"
        ));
    }
    if !lost.is_empty() {
        let words = lost_words(&lost);
        if written.wanted.save {
            output.warn(&words);
        } else {
            output.say(&words);
        }
    }
}

/// What becomes of new values that were to be saved and were not.
fn unsaved_words(why: &str, which: &[String]) -> String {
    format!(
        "not saved: {why}, {} lost at the next power cycle",
        listed_with_verb(which)
    )
}

/// What becomes of new values that the drive can save; `which` is empty for all of them.
fn kept_words(persistence: Persistence, which: &[String]) -> String {
    let named = match which {
        [] => String::new(),
        names => format!(": {}", listed(names)),
    };
    match persistence {
        Persistence::EveryWrite => format!("saved in the drive{named} (it saves every write)"),
        Persistence::Saved { by_command: true } => {
            format!("saved in the drive{named}, with everything else that it can save")
        }
        Persistence::Saved { by_command: false } => format!("saved in the drive{named}"),
        _ if which.is_empty() => "not saved: lost at the next power cycle (use --save)".to_owned(),
        _ => format!(
            "not saved: {} lost at the next power cycle (use --save)",
            listed_with_verb(which)
        ),
    }
}

/// `DRV.ACC is`, `DRV.ACC and DRV.DEC are`.
fn listed_with_verb(names: &[String]) -> String {
    let verb = if names.len() == 1 { "is" } else { "are" };
    format!("{} {verb}", listed(names))
}

/// What becomes of values that the drive has no place for.
fn lost_words(lost: &[String]) -> String {
    let which = if lost.len() == 1 { "it" } else { "them" };
    format!(
        "not saved: {} lost at the next power cycle, the drive cannot save {which}",
        listed_with_verb(lost)
    )
}

/// `922`, `922 and HOME.V`, `922, 930 and HOME.V`
fn listed(names: &[String]) -> String {
    match names {
        [] => String::new(),
        [one] => one.clone(),
        [first @ .., last] => format!("{} and {last}", first.join(", ")),
    }
}

/// A number in hexadecimal is the one on the wire: what that is in the unit of the parameter.
fn raw_note(assignment: &Assignment, change: &Change) -> Option<String> {
    let raw = assignment.value.raw()?;
    let unit = change.rounding?.unit;
    (!unit.is_empty()).then(|| {
        let (label, value) = (change.label(), value::value(&change.new));
        format!("{label}: 0x{raw:04X} is the raw value, that is {value} {unit}")
    })
}

/// That a text is written without the blanks in front of it, and how to write them.
fn blanks_lost(assignment: &Assignment, change: &Change) -> Option<String> {
    let Content::Text(text) = &change.new.content else {
        return None;
    };
    assignment.value.has_lost_blanks().then(|| {
        let label = change.label();
        let text = clean(text);
        format!(
            "{label}: blanks before the text are left out; to write them use quotation marks: \" {text}\""
        )
    })
}

/// What becomes of a value between two that the drive can hold.
fn rounded(assignment: &Assignment, change: &Change) -> Option<String> {
    let value = change.rounding?;
    let asked = assignment.value.number()?;
    let unit = asked.unit.as_deref().unwrap_or(value.unit);
    let (asked, written) = (number(asked.number.as_f64()), value::value(&change.new));
    let shown = unit != value.unit || asked != written;
    (value.is_rounded() && shown).then(|| {
        let label = change.label();
        let line = format!("{label}: {asked} {unit} -> {written} {}", value.unit);
        format!("{}, rounded to the nearest representable value", line.trim_end())
    })
}

fn row(change: &Change, dry_run: bool) -> [String; 7] {
    let new = value::value(&change.new);
    let old = match &change.old {
        Some(Ok(reading)) => with_text(value::value(reading), reading.choice),
        Some(Err(refusal)) => format!("({})", refusal.words()),
        None => "-".into(),
    };
    let result = match (change.step, &change.read_back) {
        (Step::Same, _) => format!("already {new}"),
        (Step::NotWritten, _) if dry_run => "would be written".into(),
        (Step::NotWritten, _) => "not sent".into(),
        (Step::Refused(refusal), _) => refusal.outcome(),
        (Step::Written, None) => "executed".into(),
        (Step::Written, _) if change.acts => "executed".into(),
        (Step::Written, Some(Err(refusal))) => format!("written, not readable: {}", refusal.words()),
        (Step::Differs, Some(Ok(back))) => format!("written, but reads back {}", value::full(back)),
        (step, _) => step.to_string(),
    };
    let name = change.selection.parameter.map(|parameter| parameter.name);
    [
        name.unwrap_or_default().to_owned(),
        change.selection.shown(0).to_string(),
        old,
        "->".into(),
        with_text(new, change.new.choice),
        change.new.unit.to_owned(),
        result,
    ]
}

/// `1 (PROFIdrive profile)`
fn with_text(value: String, text: Option<&str>) -> String {
    match text {
        Some(text) => format!("{value} ({text})"),
        None => value,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unsaved_values_are_reported() {
        let names = ["922".to_owned(), "HOME.V".to_owned()];
        assert_eq!(
            lost_words(&names),
            "not saved: 922 and HOME.V are lost at the next power cycle, the drive cannot save them"
        );
        assert!(lost_words(&names[..1]).starts_with("not saved: 922 is lost"));
    }
}

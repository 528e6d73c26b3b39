//! `profidrive write`

use client::{ChangeOutcome, Drive, PlannedValue, Wait, WriteMode};
use profile::catalogue::Role;
use profile::parameter::Saving;
use profile::value::Assignment;
use serde_json::{Map, Value};

use super::{last_failure, reading_json, refusal_json, refused_failure};
use crate::args::{Interface, Write};
use crate::connect::{self, Need};
use crate::failure::{Exit, Failure};
use crate::fields;
use crate::output::Output;
use crate::render::table::{Table, clean};
use crate::render::{number, value};

pub fn write(args: &Write, interface: &Interface, output: &Output) -> Result<(), Failure> {
    let assignments: Vec<Assignment> = args
        .assignments
        .iter()
        .map(|text| text.parse().map_err(Failure::from))
        .collect::<Result<_, _>>()?;
    let (mut session, mut drive) = connect::drive(interface, Need::Records, &args.drive, output)?;
    let mode = match (args.dry_run, args.save) {
        (true, _) => WriteMode::DryRun,
        (false, true) => WriteMode::Save,
        (false, false) => WriteMode::Write,
    };
    let controller = session.owner(&drive).wait()?.flatten();
    let (outcomes, same) = write_new(&mut session, &mut drive, &assignments, mode)?;
    session.close().wait()?;
    let save = Save::of(&drive, &outcomes, assignments.len(), args.save);
    if let Some(name) = &controller
        && outcomes.iter().any(is_written)
    {
        output.warn(&format!(
            "controller \"{}\" runs {}: what was written counts for its motion at once",
            clean(name),
            drive.label()
        ));
    }
    if output.json() {
        let changes: Vec<Value> = outcomes
            .iter()
            .zip(&same)
            .map(|(outcome, same)| {
                let mut fields = outcome_json(outcome);
                fields.insert("same".into(), (*same).into());
                fields.insert("can_be_kept".into(), can_keep(&drive, outcome).into());
                fields.insert("saved".into(), is_saved(&drive, outcome, save).into());
                Value::Object(fields)
            })
            .collect();
        output.document(
            "write",
            fields! {
                "drive": drive.label(), "dry_run": args.dry_run, "changes": changes, "controller": controller,
            },
        );
    } else {
        let mut table = Table::new(&["name", "number", ">old", "", ">new", "unit", "result"]);
        for (outcome, same) in outcomes.iter().zip(&same) {
            let mut row = outcome_row(outcome);
            if *same {
                row[RESULT] = format!("already {}", wanted(outcome));
            } else if outcome.written.is_none() && !args.dry_run {
                row[RESULT] = "not sent".to_owned();
            }
            table.row(row);
        }
        for (assignment, outcome) in assignments.iter().zip(&outcomes) {
            let note = raw_note(assignment, outcome)
                .or_else(|| rounded(assignment, outcome))
                .or_else(|| blanks_lost(assignment, outcome));
            if let Some(note) = note {
                output.say(&note);
            }
        }
        for line in table.lines() {
            output.line(&line);
        }
        if args.dry_run {
            output.say("dry run: nothing was written");
        } else {
            report_saved(&drive, &outcomes, save, output);
        }
    }
    let mut problems: Vec<Failure> = Vec::new();
    for outcome in &outcomes {
        if let Some(Err(refusal)) = &outcome.written {
            problems.push(refused_failure(&drive.label(), refusal));
        } else if outcome.differs() {
            let label = outcome.change.selection.label();
            let message = format!(
                "{}: {label} reads back another value than was written",
                drive.label()
            );
            problems.push(
                Failure::new(Exit::Difference, message)
                    .hint("the drive may round, limit or change it by itself; read it again"),
            );
        }
    }
    last_failure(problems, output)
}

/// True for what the drive has taken.
const fn is_written(outcome: &ChangeOutcome) -> bool {
    matches!(outcome.written, Some(Ok(())))
}

/// True for what was sent to the drive.
fn is_sent(outcome: &ChangeOutcome) -> bool {
    match &outcome.written {
        None => false,
        Some(Ok(())) => true,
        Some(Err(refusal)) => !refusal.is_unsent(),
    }
}

/// Writes what is new for the drive; one outcome for each assignment, and whether the drive had its value already. All of
/// it is written where it is to be kept, as a value that is there may not be kept yet.
fn write_new(
    session: &mut connect::Live,
    drive: &mut Drive,
    assignments: &[Assignment],
    mode: WriteMode,
) -> Result<(Vec<ChangeOutcome>, Vec<bool>), Failure> {
    if mode == WriteMode::Save {
        let outcomes = session.write(drive, assignments, mode).wait()?;
        let same = vec![false; outcomes.len()];
        return Ok((outcomes, same));
    }
    let mut outcomes = session.write(drive, assignments, WriteMode::DryRun).wait()?;
    let same = already_so(drive, &outcomes);
    let new: Vec<Assignment> = assignments
        .iter()
        .zip(&same)
        .filter(|(_, same)| !**same)
        .map(|(assignment, _)| assignment.clone())
        .collect();
    if mode == WriteMode::Write && !new.is_empty() {
        let mut written = session.write(drive, &new, mode).wait()?.into_iter();
        for (outcome, _) in outcomes.iter_mut().zip(&same).filter(|(_, same)| !**same) {
            if let Some(written) = written.next() {
                *outcome = written;
            }
        }
    }
    Ok((outcomes, same))
}

/// Column of the result of a write.
const RESULT: usize = 6;

/// Which settings have the value already and are left alone. What acts is carried out each time; so is everything behind
/// something that is no plain setting, as that may change what follows it.
fn already_so(drive: &Drive, outcomes: &[ChangeOutcome]) -> Vec<bool> {
    let mut plain = true;
    let tables = drive.model.catalogue;
    outcomes
        .iter()
        .map(|outcome| {
            let selection = &outcome.change.selection;
            let base = selection.parameter.and_then(|parameter| parameter.base);
            let role = tables.map(|tables| tables.backup_rule_at(selection.pnu, base).role);
            let same = outcome.is_same();
            plain &= is_plain(role, same);
            // a write saves it too, and whether that was done the value does not say
            let saves = selection
                .parameter
                .is_some_and(|parameter| drive.saving(parameter) == Saving::Always);
            plain && same && !saves
        })
        .collect()
}

/// True for what does nothing but hold a value, and changes nothing that follows it.
const fn is_plain(role: Option<Role>, same: bool) -> bool {
    match role {
        // another name for a setting is that setting
        Some(Role::Setting | Role::Alias { .. }) => true,
        // changed, the telegram brings its own mapping with it
        Some(Role::Network) => same,
        _ => false,
    }
}

/// A value that the drive has now; a command leaves none behind.
fn keeps(outcome: &ChangeOutcome) -> bool {
    matches!(outcome.written, Some(Ok(()))) && !outcome.acts
}

/// Whether the drive has a place for a value that outlives its power; `None` where no table says so.
fn can_keep(drive: &Drive, outcome: &ChangeOutcome) -> Option<bool> {
    let parameter = outcome.change.selection.parameter?;
    drive.model.catalogue.map(|tables| tables.is_kept(parameter))
}

/// How a drive saved the new values that it does not save with every write.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Save {
    /// Not requested.
    No,
    /// Saved, in this way.
    Done(Saving),
    /// The drive refused the command that saves.
    Refused,
    /// The command that saves was not sent, as a value was refused.
    NotSent,
}

impl Save {
    /// The command that saves, where one is necessary, is the outcome behind those of the assignments.
    fn of(drive: &Drive, outcomes: &[ChangeOutcome], assignments: usize, requested: bool) -> Self {
        let own = drive.model.dialect.saving;
        match outcomes.get(assignments) {
            _ if !requested => Self::No,
            Some(command) if is_written(command) => Self::Done(Saving::Command),
            Some(command) if command.written.is_none() => Self::NotSent,
            None if own != Saving::Command => Self::Done(own),
            _ => Self::Refused,
        }
    }
}

/// When the drive saves a new value; one without a description is saved as most are.
fn saving_of(drive: &Drive, outcome: &ChangeOutcome) -> Saving {
    let parameter = outcome.change.selection.parameter;
    parameter.map_or(drive.model.dialect.saving, |parameter| drive.saving(parameter))
}

/// True for a new value that outlives the power of the drive.
fn is_saved(drive: &Drive, outcome: &ChangeOutcome, save: Save) -> bool {
    let saved = matches!(save, Save::Done(_)) || saving_of(drive, outcome) == Saving::Always;
    saved && keeps(outcome) && can_keep(drive, outcome) != Some(false)
}

/// Reports which of the new values outlive the power of the drive, and which do not.
fn report_saved(drive: &Drive, outcomes: &[ChangeOutcome], save: Save, output: &Output) {
    let new = outcomes.iter().filter(|outcome| keeps(outcome));
    let (kept, lost): (Vec<_>, Vec<_>) = new.partition(|outcome| can_keep(drive, outcome) != Some(false));
    let names = |outcomes: &[&ChangeOutcome]| -> Vec<String> {
        let labels = outcomes.iter().map(|outcome| outcome.change.selection.label());
        labels.collect()
    };
    let own = drive.model.dialect.saving;
    let (as_written, by_itself): (Vec<_>, Vec<_>) = kept
        .into_iter()
        .partition(|outcome| saving_of(drive, outcome) == own);
    let (as_written, by_itself, lost) = (names(&as_written), names(&by_itself), names(&lost));
    let all = by_itself.is_empty() && lost.is_empty();
    if !as_written.is_empty() {
        match save {
            Save::Refused => output.warn(&unsaved_words("the drive refused to save", &as_written)),
            Save::NotSent => {
                let why = "the save command was not sent because a value was refused";
                output.warn(&unsaved_words(why, &as_written));
            }
            Save::No | Save::Done(_) => {
                output.say(&kept_words(own, save, if all { &[] } else { &as_written }));
            }
        }
    }
    if !by_itself.is_empty() {
        let which = listed(&by_itself);
        output.say(&format!(
            "saved in the drive: {which} (at a serial line it saves text with every write)"
        ));
    }
    if !lost.is_empty() {
        let note = lost_words(&lost);
        if save == Save::No {
            output.say(&note);
        } else {
            output.warn(&note);
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
fn kept_words(own: Saving, save: Save, which: &[String]) -> String {
    let named = match which {
        [] => String::new(),
        names => format!(": {}", listed(names)),
    };
    match (own, save) {
        (Saving::Always, _) => format!("saved in the drive{named} (it saves every write)"),
        (_, Save::Done(Saving::Command)) => {
            format!("saved in the drive{named}, with everything else that it can save")
        }
        (_, Save::Done(_)) => format!("saved in the drive{named}"),
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
fn raw_note(assignment: &Assignment, outcome: &ChangeOutcome) -> Option<String> {
    let raw = assignment.value.raw()?;
    let value = outcome.change.value.number()?;
    (!value.unit.is_empty()).then(|| {
        let label = outcome.change.selection.label();
        format!(
            "{label}: 0x{raw:04X} is the raw value, that is {} {}",
            wanted(outcome),
            value.unit
        )
    })
}

/// That a text is written without the blanks in front of it, and how to write them.
fn blanks_lost(assignment: &Assignment, outcome: &ChangeOutcome) -> Option<String> {
    let PlannedValue::Text(text) = &outcome.change.value else {
        return None;
    };
    assignment.value.has_lost_blanks().then(|| {
        let label = outcome.change.selection.label();
        let text = clean(text);
        format!(
            "{label}: blanks before the text are left out; to write them use quotation marks: \" {text}\""
        )
    })
}

/// What becomes of a value between two that the drive can hold.
fn rounded(assignment: &Assignment, outcome: &ChangeOutcome) -> Option<String> {
    let value = outcome.change.value.number()?;
    let asked = assignment.value.number()?;
    let unit = asked.unit.as_deref().unwrap_or(value.unit);
    let (asked, written) = (number(asked.number.as_f64()), wanted(outcome));
    let shown = unit != value.unit || asked != written;
    (value.is_rounded() && shown).then(|| {
        let label = outcome.change.selection.label();
        let line = format!("{label}: {asked} {unit} -> {written} {}", value.unit);
        format!("{}, rounded to the nearest representable value", line.trim_end())
    })
}

fn outcome_row(outcome: &ChangeOutcome) -> [String; 7] {
    let selection = &outcome.change.selection;
    let old = match &outcome.old {
        Some(Ok(reading)) => with_text(value::value(reading), reading.choice),
        Some(Err(refusal)) => format!("({})", refusal.words()),
        None => "-".into(),
    };
    let parameter = selection.parameter;
    let number = outcome.change.value.number();
    let text = number.and_then(|value| parameter?.choice(value.raw));
    let result = match (&outcome.written, &outcome.new) {
        (None, _) => "would be written".into(),
        (Some(Err(refusal)), _) => refusal.outcome(),
        (Some(Ok(())), None) => "executed".into(),
        (Some(Ok(())), Some(_)) if outcome.acts => "executed".into(),
        (Some(Ok(())), Some(Ok(_))) if !outcome.differs() => "written, read back".into(),
        (Some(Ok(())), Some(Ok(back))) => format!("written, but reads back {}", value::full(back)),
        (Some(Ok(())), Some(Err(refusal))) => format!("written, not readable: {}", refusal.words()),
    };
    [
        selection
            .parameter
            .map_or_else(String::new, |parameter| parameter.name.to_owned()),
        selection.shown(0).to_string(),
        old,
        "->".into(),
        with_text(wanted(outcome), text),
        number.map_or_else(String::new, |value| value.unit.to_owned()),
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

/// The new value as the drive will show it: rounded to its own steps.
fn wanted(outcome: &ChangeOutcome) -> String {
    let value = match &outcome.change.value {
        PlannedValue::Number(value) => value.engineering,
        PlannedValue::Text(text) => return text.clone(),
    };
    match outcome.change.selection.parameter {
        Some(parameter) => {
            let text = format!("{value:.*}", usize::from(parameter.decimals()));
            if text.contains('.') {
                text.trim_end_matches('0').trim_end_matches('.').to_owned()
            } else {
                text
            }
        }
        None => number(value),
    }
}

fn outcome_json(outcome: &ChangeOutcome) -> Map<String, Value> {
    let selection = &outcome.change.selection;
    let mut fields = fields! {
        "pnu": selection.pnu, "index": selection.shown(0).index,
        "name": selection.parameter.map(|parameter| parameter.name),
        "sent": is_sent(outcome), "written": is_written(outcome), "differs": outcome.differs(),
    };
    fields.extend(match &outcome.change.value {
        PlannedValue::Number(value) => fields! {
            "value": value.engineering, "asked": value.asked, "rounded": value.is_rounded(), "raw": value.raw,
            "unit": value.unit,
        },
        PlannedValue::Text(text) => fields! { "value": text.as_str(), "asked": text.as_str() },
    });
    if let Some(old) = &outcome.old {
        fields.insert("old".into(), reading_json(old));
    }
    if let Some(new) = &outcome.new {
        fields.insert("new".into(), reading_json(new));
    }
    if let Some(Err(refusal)) = &outcome.written {
        fields.insert("error".into(), Value::Object(refusal_json(refusal)));
    }
    fields
}

#[cfg(test)]
mod tests {
    use super::*;
    use client::Refusal;
    use profile::catalogue::{AKD, Scaling};
    use profile::model::Model;
    use profile::parameter::ErrorNumber;
    use profile::value::Parameters;
    use profinet::controller::Station;

    fn drive(model: &str) -> Drive {
        Drive::new(Station::default()).as_model(Model::by_name(model).unwrap())
    }

    fn outcome(drive: &Drive, text: &str, written: Result<(), ErrorNumber>) -> ChangeOutcome {
        let assignment: Assignment = text.parse().unwrap();
        let selection = drive.parameters.select(&assignment.reference).unwrap();
        let refusal = |number| Refusal {
            shown: selection.shown(0),
            name: None,
            write: true,
            number,
            names: drive.model.dialect.error_names,
            information: None,
            advice: None,
            channel: None,
        };
        let value = drive.parameters.check(&selection, &assignment.value).unwrap();
        let tables = drive.model.catalogue.unwrap();
        ChangeOutcome {
            change: client::PlannedChange {
                selection,
                value: PlannedValue::Number(value),
            },
            old: None,
            written: Some(written.map_err(refusal)),
            new: None,
            acts: matches!(tables.backup_rule(selection.pnu).role, Role::Action | Role::Save),
        }
    }

    /// A VLT without request 0x42 is told to save by 9-71.
    #[test]
    fn a_value_is_saved_only_where_the_command_that_saves_was_carried_out() {
        let drive = drive("vlt");
        let value = outcome(&drive, "3-41=5s", Ok(()));
        let of = |command: Option<Result<(), ErrorNumber>>, requested| {
            let mut outcomes = vec![value.clone()];
            outcomes.extend(command.map(|written| outcome(&drive, "9-71=1", written)));
            let save = Save::of(&drive, &outcomes, 1, requested);
            assert!(
                outcomes
                    .iter()
                    .skip(1)
                    .all(|command| !is_saved(&drive, command, save))
            );
            (save, is_saved(&drive, &outcomes[0], save))
        };
        assert_eq!(of(None, false), (Save::No, false));
        assert_eq!(of(None, true), (Save::Done(Saving::Request), true));
        assert_eq!(of(Some(Ok(())), true), (Save::Done(Saving::Command), true));
        assert_eq!(
            of(Some(Err(ErrorNumber::NOT_CHANGEABLE)), true),
            (Save::Refused, false)
        );
        let refused = outcome(&drive, "3-41=5s", Err(ErrorNumber::NOT_CHANGEABLE));
        assert!(!is_saved(&drive, &refused, Save::Done(Saving::Request)));
        let mut unsent = outcome(&drive, "9-71=1", Ok(()));
        unsent.written = None;
        let save = Save::of(&drive, &[value.clone(), unsent], 1, true);
        assert_eq!(save, Save::NotSent);
        assert!(!is_saved(&drive, &value, save));
    }

    #[test]
    fn a_vacon_saves_each_value_without_a_request() {
        let drive = drive("vacon");
        let value = outcome(&drive, "ID103=5s", Ok(()));
        assert!(is_saved(&drive, &value, Save::No));
    }

    #[test]
    fn a_command_leaves_no_value_behind() {
        let tables = Parameters {
            catalogue: Some(&AKD),
            scaling: Scaling::default(),
        };
        for (text, left) in [("DRV.DIS=1", false), ("DRV.ACC=5000", true)] {
            let assignment: Assignment = text.parse().unwrap();
            let selection = tables.select(&assignment.reference).unwrap();
            let value = tables.check(&selection, &assignment.value).unwrap();
            let value = PlannedValue::Number(value);
            let outcome = ChangeOutcome {
                change: client::PlannedChange { selection, value },
                old: None,
                written: Some(Ok(())),
                new: None,
                acts: !left,
            };
            assert_eq!(keeps(&outcome), left, "{text}");
        }
    }

    #[test]
    fn mode_and_telegram_already_set_are_not_written() {
        let role = |pnu| Some(AKD.backup_rule(pnu).role);
        assert!(is_plain(role(930), true) && is_plain(role(930), false));
        assert!(is_plain(role(922), true) && !is_plain(role(922), false));
        assert!(!is_plain(
            AKD.by_name("DRV.NVSAVE").and_then(|save| role(save.pnu)),
            true
        ));
        assert!(!is_plain(None, true));
    }

    #[test]
    fn unsaved_values_are_reported() {
        let names = ["922".to_owned(), "HOME.V".to_owned()];
        assert_eq!(
            lost_words(&names),
            "not saved: 922 and HOME.V are lost at the next power cycle, the drive cannot save them"
        );
        assert!(lost_words(&names[..1]).starts_with("not saved: 922 is lost"));
        assert_eq!(
            kept_words(Saving::Request, Save::Done(Saving::Command), &names),
            "saved in the drive: 922 and HOME.V, with everything else that it can save"
        );
    }
}

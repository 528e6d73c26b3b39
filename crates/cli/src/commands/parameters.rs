//! `profidrive read`, `profidrive write`, `profidrive list`, `profidrive describe`

use drive_client::parameter::{Assignment, ParameterProblem, Parameters, Reading, Selection};
use drive_client::{ChangeOutcome, Refusal, WriteMode};
use profidrive::catalogue::{Access, Catalogue, Parameter, Role, Scaling, Size, Word, WordKind};
use profidrive::notation::{Notation, ParameterReference, Shown, Target};
use profidrive::parameter::Saving;
use profidrive::state::Mode;
use serde_json::{Map, Value};

use crate::args::{Describe, Interface, List, Read, Write};
use crate::connect::{self, Need};
use crate::failure::{Exit, Failure};
use crate::fields;
use crate::output::{Colour, Output};
use crate::render::table::Table;
use crate::render::{number, value};

pub fn read(args: &Read, interface: &Interface, output: &Output) -> Result<(), Failure> {
    let references = parse_all(&args.parameters)?;
    let (mut session, mut drive) = connect::drive(interface, Need::Records, &args.drive, output)?;
    let mut selections = Vec::new();
    let mut problems: Vec<Failure> = Vec::new();
    // one unknown name does not break the whole page
    for reference in &references {
        match drive.parameters.select(reference) {
            Ok(selection) => selections.push(selection),
            Err(problem) => problems.push(problem.into()),
        }
    }
    let mut readings = session.read(&mut drive, &selections)?;
    name_bits(&mut session, &mut drive, &mut readings)?;
    session.close()?;
    print_readings("read", &drive.label(), &readings, args.raw, output);
    let refused = readings.iter().filter_map(|reading| reading.as_ref().err());
    problems.extend(refused.map(|refusal| refused_failure(&drive.label(), refusal)));
    last_failure(problems, output)
}

/// Some bits of STW1 and ZSW1 are called by the mode, which only the drive knows.
fn name_bits(
    session: &mut connect::Live,
    drive: &mut drive_client::Drive,
    readings: &mut [Result<Reading, Refusal>],
) -> Result<(), Failure> {
    let depends = |reading: &Reading| {
        let parameter = drive.parameters.at(reading.pnu, reading.index.unwrap_or(0));
        let word = parameter.zip(drive.model.catalogue);
        let word = word.and_then(|(found, tables)| tables.word_at(found.pnu, found.base));
        word.is_some_and(|word| word.kind != WordKind::Own)
    };
    if !readings.iter().flatten().any(depends) {
        return Ok(());
    }
    let selection = drive
        .parameters
        .select(&ParameterReference::number(OPERATING_MODE))?;
    let answers = session.read(drive, &[selection])?;
    let position = answers.iter().flatten().any(|reading| reading.raw() == Some(2));
    if position {
        for reading in readings.iter_mut().flatten() {
            *reading = drive.parameters.in_mode(reading.clone(), Mode::Position);
        }
    }
    Ok(())
}

/// Operating mode: 1 speed control, 2 positioning.
const OPERATING_MODE: u16 = 930;

/// All but the last failure are told at once; the last ends the command.
fn last_failure(mut problems: Vec<Failure>, output: &Output) -> Result<(), Failure> {
    let last = problems.pop();
    for problem in problems {
        output.problem(&problem);
    }
    last.map_or(Ok(()), Err)
}

fn refused_failure(drive: &str, refusal: &Refusal) -> Failure {
    drive_client::Error::Refused {
        drive: drive.to_owned(),
        refusal: *refusal,
    }
    .into()
}

fn parse_all(texts: &[String]) -> Result<Vec<ParameterReference>, Failure> {
    let parse = |text: &String| {
        text.parse()
            .map_err(|error| Failure::from(ParameterProblem::from(error)))
    };
    texts.iter().map(parse).collect()
}

/// Readings as a table, or as one document.
fn print_readings(
    command: &str,
    drive: &str,
    readings: &[Result<Reading, Refusal>],
    raw: bool,
    output: &Output,
) {
    if output.json() {
        let values: Vec<Value> = readings.iter().map(reading_json).collect();
        output.document(command, fields! { "drive": drive, "parameters": values });
        return;
    }
    let mut table = Table::new(&[
        "name",
        "number",
        ">value",
        "unit",
        "meaning",
        if raw { "raw" } else { "" },
    ]);
    for reading in readings.iter().flatten() {
        table.row([
            reading.name.unwrap_or_default().to_owned(),
            reading.shown().to_string(),
            value::value(reading),
            reading.unit.to_owned(),
            value::meaning(reading),
            if raw { value::raw(reading) } else { String::new() },
        ]);
    }
    if !table.is_empty() {
        for line in table.lines() {
            output.line(&line);
        }
    }
}

fn reading_json(reading: &Result<Reading, Refusal>) -> Value {
    match reading {
        Ok(reading) => value::json(reading),
        Err(refusal) => Value::Object(refusal_json(refusal)),
    }
}

pub fn refusal_json(refusal: &Refusal) -> Map<String, Value> {
    let error = fields! {
        "number": refusal.number.0, "meaning": refusal.words(), "information": refusal.information,
        "remedy": refusal.remedy(),
    };
    fields! { "pnu": refusal.shown.pnu, "index": refusal.shown.index, "name": refusal.name, "error": error }
}

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
    let (outcomes, same) = write_new(&mut session, &mut drive, &assignments, mode)?;
    session.close()?;
    if output.json() {
        let changes: Vec<Value> = outcomes
            .iter()
            .zip(&same)
            .map(|(outcome, same)| {
                let mut fields = outcome_json(outcome);
                fields.insert("same".into(), (*same).into());
                Value::Object(fields)
            })
            .collect();
        output.document(
            "write",
            fields! { "drive": drive.label(), "dry_run": args.dry_run, "changes": changes },
        );
    } else {
        let mut table = Table::new(&["name", "number", ">old", "", ">new", "unit", "result"]);
        for (outcome, same) in outcomes.iter().zip(&same) {
            let mut row = outcome_row(outcome);
            if *same {
                row[RESULT] = format!("already {}", wanted(outcome));
            }
            table.row(row);
        }
        for (assignment, outcome) in assignments.iter().zip(&outcomes) {
            if let Some(told) = raw_told(assignment, outcome) {
                output.say(&told);
            }
        }
        for line in table.lines() {
            output.line(&line);
        }
        let taken = outcomes.iter().any(keeps);
        if args.dry_run {
            output.say("dry run: nothing was written");
        } else if taken {
            output.say(kept(drive.model.dialect.saving, args.save));
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

/// Writes what is new for the drive; one outcome for each assignment, and whether the drive had its value already. All of
/// it is written where it is to be kept, as a value that is there may not be kept yet.
fn write_new(
    session: &mut connect::Live,
    drive: &mut drive_client::Drive,
    assignments: &[Assignment],
    mode: WriteMode,
) -> Result<(Vec<ChangeOutcome>, Vec<bool>), Failure> {
    if mode == WriteMode::Save {
        let outcomes = session.write(drive, assignments, mode)?;
        let same = vec![false; outcomes.len()];
        return Ok((outcomes, same));
    }
    let mut outcomes = session.write(drive, assignments, WriteMode::DryRun)?;
    let same = already_so(drive, &outcomes);
    let new: Vec<Assignment> = assignments
        .iter()
        .zip(&same)
        .filter(|(_, same)| !**same)
        .map(|(assignment, _)| assignment.clone())
        .collect();
    if mode == WriteMode::Write && !new.is_empty() {
        let mut written = session.write(drive, &new, mode)?.into_iter();
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
fn already_so(drive: &drive_client::Drive, outcomes: &[ChangeOutcome]) -> Vec<bool> {
    let mut plain = true;
    let tables = drive.model.catalogue;
    outcomes
        .iter()
        .map(|outcome| {
            let selection = &outcome.change.selection;
            let base = selection.parameter.and_then(|parameter| parameter.base);
            let role = tables.map(|tables| tables.backup_rule_at(selection.pnu, base).role);
            plain &= role == Some(Role::Setting);
            plain && outcome.is_same()
        })
        .collect()
}

/// A value that the drive has now; a command leaves none behind.
fn keeps(outcome: &ChangeOutcome) -> bool {
    let command = outcome.change.selection.parameter;
    let command = command.is_some_and(|parameter| parameter.size == Size::Command);
    matches!(outcome.written, Some(Ok(()))) && !command && !outcome.acts
}

/// What becomes of the new values when the drive loses its power.
const fn kept(saving: Saving, save: bool) -> &'static str {
    match (saving, save) {
        (Saving::Always, _) => "the drive keeps them over a power cycle: it saves every write",
        (Saving::Request, true) => "the drive keeps them over a power cycle",
        (Saving::Command, true) => "the drive was told to keep all its values over a power cycle",
        (_, false) => "until the next power cycle; with --save the drive keeps them",
    }
}

/// A number in hexadecimal is the one on the wire: what that is in the unit of the parameter.
fn raw_told(assignment: &Assignment, outcome: &ChangeOutcome) -> Option<String> {
    let raw = assignment.quantity.raw()?;
    let value = outcome.change.value;
    (!value.unit.is_empty()).then(|| {
        let label = outcome.change.selection.label();
        format!(
            "{label}: 0x{raw:04X} is the raw value, that is {} {}",
            wanted(outcome),
            value.unit
        )
    })
}

fn outcome_row(outcome: &ChangeOutcome) -> [String; 7] {
    let selection = &outcome.change.selection;
    let old = match &outcome.old {
        Some(Ok(reading)) => value::value(reading),
        Some(Err(refusal)) => format!("({})", refusal.words()),
        None => "-".into(),
    };
    let result = match (&outcome.written, &outcome.new) {
        (None, _) => "would be written".into(),
        (Some(Err(refusal)), _) => format!("refused: {}", refusal.words()),
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
        wanted(outcome),
        outcome.change.value.unit.to_owned(),
        result,
    ]
}

/// The new value as the drive will show it: rounded to its own steps.
fn wanted(outcome: &ChangeOutcome) -> String {
    let value = outcome.change.value.engineering;
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
        "value": outcome.change.value.engineering, "raw": outcome.change.value.raw, "unit": outcome.change.value.unit,
        "written": matches!(outcome.written, Some(Ok(()))), "differs": outcome.differs(),
    };
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

pub fn list(args: &List, interface: &Interface, output: &Output) -> Result<(), Failure> {
    let (mut session, mut drive) = connect::drive(interface, Need::Records, &args.drive, output)?;
    let Some(tables) = drive.model.catalogue else {
        return list_numbers(&mut session, &mut drive, output);
    };
    let parameters: Vec<&'static Parameter> = match &args.filter {
        Some(text) => filtered(&drive.parameters, tables, text),
        None => tables.parameters.iter().collect(),
    };
    if parameters.is_empty() {
        let text = args.filter.as_deref().unwrap_or_default();
        return Err(Failure::new(
            Exit::Failed,
            format!("no parameter of the {} matches `{text}`", tables.model),
        ));
    }
    if args.values {
        let selections: Vec<Selection> = parameters
            .iter()
            .map(|&parameter| Selection::of(parameter, tables.notation))
            .collect();
        let bar = connect::bar(output, selections.len(), "reading");
        let mut readings = Vec::new();
        for part in selections.chunks(64) {
            readings.extend(session.read(&mut drive, part)?);
            bar.inc(part.len() as u64);
        }
        bar.finish_and_clear();
        name_bits(&mut session, &mut drive, &mut readings)?;
        session.close()?;
        print_readings("list", &drive.label(), &readings, args.raw, output);
        let refused = readings.iter().filter(|reading| reading.is_err()).count();
        if refused > 0 {
            output.say(&format!("{refused} of {} could not be read", readings.len()));
        }
        return Ok(());
    }
    if output.json() {
        let list: Vec<Value> = parameters
            .iter()
            .map(|parameter| Value::Object(parameter_json(tables, parameter, &drive.parameters)))
            .collect();
        output.document(
            "list",
            fields! { "drive": drive.label(), "model": tables.model, "parameters": list },
        );
        return Ok(());
    }
    let mut table = Table::new(&["name", "number", "access", "unit", "description"]);
    for parameter in &parameters {
        table.row([
            parameter.name.to_owned(),
            number_of(tables, parameter),
            access_word(parameter.access).to_owned(),
            parameter.unit.to_owned(),
            parameter.description.to_owned(),
        ]);
    }
    for line in table.lines() {
        output.line(&line);
    }
    let wide = parameters.iter().filter(|parameter| parameter.wide).count();
    let also = if wide > 0 {
        format!("; {wide} of them have 64 bits and take the next number too")
    } else {
        String::new()
    };
    output.say(&format!("{} parameters{also}", parameters.len()));
    Ok(())
}

/// Text in name or description, or the number itself.
fn filtered(parameters: &Parameters, tables: &'static Catalogue, text: &str) -> Vec<&'static Parameter> {
    let by_number = text
        .parse::<ParameterReference>()
        .ok()
        .filter(|reference| matches!(reference.target, Target::Number(_)))
        .and_then(|reference| parameters.select(&reference).ok()?.parameter);
    let mut found: Vec<_> = tables.filter(text).collect();
    if let Some(exact) = by_number.filter(|exact| {
        found
            .iter()
            .all(|other| (other.pnu, other.base) != (exact.pnu, exact.base))
    }) {
        found.insert(0, exact);
    }
    found
}

/// A drive without tables lists its numbers itself (PNU 980 and following).
fn list_numbers(
    session: &mut connect::Live,
    drive: &mut drive_client::Drive,
    output: &Output,
) -> Result<(), Failure> {
    let numbers = session.numbers(drive)?;
    session.close()?;
    if output.json() {
        let list: Vec<Value> = numbers
            .iter()
            .map(|&pnu| Value::Object(fields! { "pnu": pnu }))
            .collect();
        output.document(
            "list",
            fields! { "drive": drive.label(), "model": drive.model.name, "parameters": list },
        );
    } else {
        for pnu in &numbers {
            output.line(
                &Shown {
                    pnu: *pnu,
                    index: None,
                    writable: None,
                    notation: Notation::Name,
                }
                .to_string(),
            );
        }
        output.say(&format!(
            "{} parameters; no names are known for this drive",
            numbers.len()
        ));
    }
    Ok(())
}

pub fn describe(args: &Describe, interface: &Interface, output: &Output) -> Result<(), Failure> {
    let reference = parse_all(std::slice::from_ref(&args.parameter))?.remove(0);
    let (mut session, mut drive) = connect::drive(interface, Need::Records, &args.drive, output)?;
    let selection = drive.parameters.select(&reference)?;
    let (Some(parameter), Some(tables)) = (selection.parameter, drive.model.catalogue) else {
        if let Some(whole) = drive
            .model
            .catalogue
            .and_then(|tables| tables.by_high(selection.pnu))
        {
            let message = format!("{} is the high half of {}", selection.label(), whole.name);
            let hint = format!("`profidrive describe {} {}`", drive.label(), whole.name);
            return Err(Failure::new(Exit::Failed, message).hint(hint));
        }
        return Err(Failure::new(
            Exit::Failed,
            format!("{} is in no table of the {}", selection.label(), drive.model.name),
        )
        .hint("`profidrive read` may read it all the same"));
    };
    let mut readings = session.read(&mut drive, &[selection])?;
    name_bits(&mut session, &mut drive, &mut readings)?;
    session.close()?;
    if output.json() {
        let mut fields = fields! { "drive": drive.label(), "model": drive.model.name };
        fields.extend(parameter_json(tables, parameter, &drive.parameters));
        fields.insert("scaling".into(), parameter.rule(&drive.parameters.scaling).into());
        let values: Vec<Value> = readings.iter().map(reading_json).collect();
        fields.insert("values".into(), values.into());
        output.document("describe", fields);
        return Ok(());
    }
    let limits = drive.parameters.limits(parameter);
    output.line(&output.paint(
        Colour::Strong,
        &format!("{} ({})", parameter.name, number_of(tables, parameter)),
    ));
    let scaling = &drive.parameters.scaling;
    let word = tables.word_at(parameter.pnu, parameter.base);
    let saved = saved_words(&drive.model, parameter);
    for line in description_lines(parameter, scaling, limits, &readings, (word, &saved)) {
        output.line(&line);
    }
    Ok(())
}

fn description_lines(
    parameter: &Parameter,
    scaling: &Scaling,
    (low, high): (f64, f64),
    readings: &[Result<Reading, Refusal>],
    (word, saved): (Option<&Word>, &str),
) -> Vec<String> {
    let unit = parameter.unit_in(scaling);
    let with_unit = |value: f64| format!("{} {unit}", number(value)).trim_end().to_owned();
    let mut lines = Vec::new();
    let mut line = |name: &str, text: String| {
        if !text.is_empty() {
            lines.push(format!("  {name:<10} {text}"));
        }
    };
    line("meaning", parameter.description.to_owned());
    match readings {
        [Ok(reading)] => line("value", value::full(reading)),
        [Err(refusal)] => line("value", format!("not readable now: {}", refusal.words())),
        several => {
            let values: Vec<String> = several.iter().flatten().take(16).map(value::value).collect();
            let more = if several.len() > 16 { " .." } else { "" };
            line("values", format!("{}{more}", values.join(", ")));
        }
    }
    line(
        "unit",
        if unit.is_empty() {
            "none".into()
        } else {
            unit.to_owned()
        },
    );
    if parameter.length == 0 {
        let limits = format!("{} to {}{}", with_unit(low), with_unit(high), known(parameter));
        line("limits", limits);
    }
    let default = match parameter.text {
        "" => parameter
            .default_in(scaling)
            .map_or_else(|| "unknown".into(), with_unit),
        text => format!("\"{text}\""),
    };
    line("default", default);
    line("access", access_word(parameter.access).to_owned());
    line("size", size_words(parameter));
    if parameter.length == 0 {
        line("scaling", parameter.rule(scaling));
    }
    line("saved", saved.to_owned());
    for choice in parameter.choices {
        line("choice", format!("{} {}", choice.value, choice.text));
    }
    for bit in parameter.bits {
        line("bit", format!("{} {}", bit.value, bit.text));
    }
    for field in word.into_iter().flat_map(|word| word.fields) {
        line(
            "bits",
            format!("{} to {} {}", field.first, field.last, field.name),
        );
        for choice in field.choices {
            line("", format!("  {} {}", choice.value, choice.text));
        }
    }
    let lead = if parameter.recalled { " (a lead only)" } else { "" };
    line("source", format!("{}{lead}", parameter.source));
    lines
}

/// Whether the drive keeps the value over a power cycle, and what lets it do so.
fn saved_words(model: &drive_client::Model, parameter: &Parameter) -> String {
    let command = model.catalogue.and_then(|tables| tables.with_role(Role::Save));
    match (parameter.saved, model.dialect.saving) {
        (false, _) => "no".into(),
        (true, Saving::Always) => "with every write".into(),
        (true, Saving::Request) => "when it is written with --save".into(),
        (true, Saving::Command) => {
            command.map_or_else(|| "yes".into(), |command| format!("by {}", command.name))
        }
    }
}

const fn known(parameter: &Parameter) -> &'static str {
    match (parameter.minimum, parameter.maximum) {
        (Some(_), Some(_)) => "",
        (None, None) => " (what fits the size; the drive may take less)",
        _ => " (one of them is only what fits the size)",
    }
}

fn size_words(parameter: &Parameter) -> String {
    let sign = match (parameter.is_text(), parameter.length, parameter.signed) {
        (true, ..) => "text",
        (false, 1.., _) => "octets without a number",
        (false, 0, true) => "signed",
        (false, 0, false) => "unsigned",
    };
    let octets = match parameter.length {
        0 => parameter.size.octets(),
        length => usize::from(length),
    };
    let plural = if octets == 1 { "" } else { "s" };
    let elements = match parameter.elements {
        0 | 1 => String::new(),
        count => format!(", {count} elements"),
    };
    let halves = match parameter.high() {
        Some(high) => format!(
            ", 64 bits in two numbers: low half here, high half in {}",
            Shown {
                pnu: high,
                index: None,
                writable: Some(parameter.access != Access::ReadOnly),
                notation: Notation::Name,
            }
        ),
        None => String::new(),
    };
    format!("{octets} octet{plural}, {sign}{elements}{halves}")
}

const fn access_word(access: Access) -> &'static str {
    match access {
        Access::ReadOnly => "read",
        Access::ReadWrite => "read, write",
        Access::WriteOnly => "command",
    }
}

fn number_of(tables: &Catalogue, parameter: &Parameter) -> String {
    let writable = Some(parameter.access != Access::ReadOnly);
    Shown {
        pnu: parameter.pnu,
        index: parameter.base,
        writable,
        notation: tables.notation,
    }
    .to_string()
}

/// Limits as `describe` shows them; null where only the size limits.
fn parameter_json(tables: &Catalogue, parameter: &Parameter, drive: &Parameters) -> Map<String, Value> {
    let limits = drive.limits(parameter);
    let meanings = |list: &[profidrive::catalogue::Meaning]| -> Vec<Value> {
        list.iter()
            .map(|row| Value::Object(fields! { "value": row.value, "text": row.text }))
            .collect()
    };
    fields! {
        "pnu": parameter.pnu, "index": parameter.base, "number": number_of(tables, parameter), "name": parameter.name, "description": parameter.description, "unit": parameter.unit_in(&drive.scaling),
        "access": access_word(parameter.access), "elements": parameter.elements, "octets": parameter.size.octets(),
        "signed": parameter.signed, "high": parameter.high(), "saved": parameter.saved, "minimum": parameter.minimum.map(|_| limits.0),
        "maximum": parameter.maximum.map(|_| limits.1), "default": parameter.default_in(&drive.scaling), "choices": meanings(parameter.choices),
        "bits": meanings(parameter.bits), "source": parameter.source,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use profidrive::catalogue::AKD;

    #[test]
    fn a_description_says_unit_and_limits() {
        let parameter = AKD.by_name("DRV.ACC").unwrap();
        let drive = Parameters {
            catalogue: Some(&AKD),
            scaling: Scaling::default(),
        };
        let describe = |scaling: &Scaling| {
            description_lines(parameter, scaling, drive.limits(parameter), &[], (None, "")).join("\n")
        };
        let text = describe(&Scaling::default());
        assert!(text.contains("limits     1.86 rpm/s to 50000000 rpm/s"), "{text}");
        assert!(text.contains("scaling    raw 1000 = 1 rpm/s\n"), "{text}");
        assert!(text.contains("low half here, high half in p2109"), "{text}");
        assert!(text.contains("default    3000 rpm/s"), "{text}");
        assert!(text.contains("access     read, write"), "{text}");
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
            let value = tables.check(&selection, &assignment.quantity).unwrap();
            let outcome = ChangeOutcome {
                change: drive_client::PlannedChange { selection, value },
                old: None,
                written: Some(Ok(())),
                new: None,
                acts: false,
            };
            assert_eq!(keeps(&outcome), left, "{text}");
        }
    }

    #[test]
    fn a_description_names_bits_and_fields() {
        let parameter = AKD.by_name("MT.CNTL").unwrap();
        let word = AKD.word(parameter.pnu);
        let text = description_lines(parameter, &Scaling::default(), (0.0, 1.0), &[], (word, "")).join("\n");
        assert!(
            text.contains("bit        4 A following task is executed"),
            "{text}"
        );
        assert!(text.contains("bits       0 to 3 Task type\n"), "{text}");
        assert!(text.contains("  1 Relative to PL.CMD\n"), "{text}");
    }

    #[test]
    fn filters_find_names_words_and_numbers() {
        let known = Parameters {
            catalogue: Some(&AKD),
            scaling: Scaling::default(),
        };
        assert!(
            filtered(&known, &AKD, "drv.acc")
                .iter()
                .any(|parameter| parameter.pnu == 2108)
        );
        assert_eq!(
            filtered(&known, &AKD, "p930")
                .first()
                .map(|parameter| parameter.pnu),
            Some(930)
        );
        assert!(filtered(&known, &AKD, "nothing like it").is_empty());
    }
}

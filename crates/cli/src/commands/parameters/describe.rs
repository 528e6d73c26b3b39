//! `profidrive describe`

use client::change::SavedBy;
use client::{Described, Wait};
use profidrive::parameters::{self, Description, Limits};
use profidrive::report::{access, number as number_as_written};
use profile::catalogue::{Access, Parameter, Scaling, Word};
use profile::notation::{Notation, Shown};
use profile::value::Selection;

use super::{limits, parse_all};
use crate::advice::Commands;
use crate::args::{Describe, Target};
use crate::connect::{self, Need};
use crate::failure::Failure;
use crate::output::{Colour, Output};
use crate::render::{number, value};

pub fn describe(args: &Describe, target: &Target, output: &Output) -> Result<(), Failure> {
    let reference = parse_all(std::slice::from_ref(&args.parameter))?.remove(0);
    let (mut session, mut drive) = connect::drive(target, Need::Records, output)?;
    let known = parameters::describe(&mut session, &mut drive, &reference).wait()?;
    session.close().wait()?;
    output.json_report(&known.report(&drive, &Commands::any()));
    if output.json() {
        return Ok(());
    }
    let Some((tables, parameter)) = known.row else {
        let described = known.described.iter();
        let limits = known.limits(&drive);
        described.for_each(|described| in_no_table(&known.selection, described, &limits, output));
        return Ok(());
    };
    output.line(&output.paint(
        Colour::Strong,
        &format!("{} ({})", parameter.name, number_as_written(tables, parameter)),
    ));
    let scaling = &drive.parameters.scaling;
    let word = tables.word_at(parameter.pnu, parameter.base);
    let saved = known.saved_by(&drive).map(saved_words).unwrap_or_default();
    let limits = known.limits(&drive);
    let common: Vec<&str> = tables.common_names(parameter).map(|common| common.name).collect();
    if !common.is_empty() {
        output.line(&format!("  {:<10} {}", "also", common.join(", ")));
    }
    for line in description_lines(parameter, scaling, &limits, &known, (word, &saved)) {
        output.line(&line);
    }
    Ok(())
}

/// A parameter that only the drive describes.
fn in_no_table(selection: &Selection, described: &Described, limits: &Limits, output: &Output) {
    let title = format!("{} ({})", described.name, selection.label());
    output.line(&output.paint(Colour::Strong, title.trim_start()));
    for line in reported_lines(described, limits) {
        output.line(&line);
    }
}

fn reported_lines(description: &Described, limits: &Limits) -> Vec<String> {
    let line = |name: &str, text: &str| format!("  {name:<10} {text}");
    let unit = if description.unit.is_empty() {
        "none"
    } else {
        description.unit
    };
    let access = if description.read_only {
        "read"
    } else {
        "read, write"
    };
    let size = match description.elements {
        1 => description.data_type.unwrap_or("unknown").to_owned(),
        count => format!("{}, {count} elements", description.data_type.unwrap_or("unknown")),
    };
    let mut lines = vec![
        line("unit", unit),
        line("limits", &limits::words(limits, description.unit)),
        line("access", access),
        line("size", &size),
    ];
    let texts = description.texts.iter();
    lines.extend(texts.map(|(value, text)| line("choice", &format!("{value} {text}"))));
    lines.push(line("source", "description that the drive gives of itself"));
    lines
}

fn description_lines(
    parameter: &Parameter,
    scaling: &Scaling,
    limits: &Limits,
    known: &Description,
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
    match known.readings.as_slice() {
        [Ok(reading)] => line("value", value::full(reading)),
        [Err(refusal)] if refusal.is_unsent() => line("value", refusal.words()),
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
        line("limits", limits::words(limits, unit));
    }
    let default = match parameter.text {
        "" => parameter
            .default_in(scaling)
            .map_or_else(|| "unknown".into(), with_unit),
        text => format!("\"{text}\""),
    };
    line("default", default);
    line("access", access(parameter.access).to_owned());
    line("size", size_words(parameter));
    if parameter.length == 0 {
        line("scaling", parameter.rule(scaling));
    }
    line("saved", saved.to_owned());
    for choice in parameter.choices {
        line("choice", format!("{} {}", choice.value, choice.text));
    }
    for (value, text) in known.other_texts() {
        line("choice", format!("{value} {text} (reported by the drive)"));
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
fn saved_words(saved_by: SavedBy) -> String {
    match saved_by {
        SavedBy::Nothing => "no".into(),
        SavedBy::EveryWrite => "with every write".into(),
        SavedBy::Request => "when it is written with --save".into(),
        SavedBy::Command(command) => {
            command.map_or_else(|| "yes".into(), |command| format!("by {}", command.name))
        }
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

#[cfg(test)]
mod tests {
    use super::*;
    use profile::catalogue::AKD;
    use profile::value::Parameters;

    /// What is known without a drive.
    fn of_tables(name: &str) -> Description {
        let drive = Parameters {
            catalogue: Some(&AKD),
            scaling: Scaling::default(),
        };
        let parameter = AKD.by_name(name).unwrap();
        Description {
            selection: drive.element(parameter.pnu, None),
            row: Some((&AKD, parameter)),
            described: None,
            readings: Vec::new(),
        }
    }

    #[test]
    fn a_description_has_unit_and_limits() {
        let parameter = AKD.by_name("DRV.ACC").unwrap();
        let drive = Parameters {
            catalogue: Some(&AKD),
            scaling: Scaling::default(),
        };
        let limits = Limits::of(&drive, parameter, None);
        let known = of_tables("DRV.ACC");
        let text = description_lines(parameter, &drive.scaling, &limits, &known, (None, "")).join("\n");
        assert!(text.contains("limits     1.86 rpm/s to 50000000 rpm/s"), "{text}");
        assert!(text.contains("scaling    raw 1000 = 1 rpm/s\n"), "{text}");
        assert!(text.contains("low half here, high half in p2109"), "{text}");
        assert!(text.contains("default    3000 rpm/s"), "{text}");
        assert!(text.contains("access     read, write"), "{text}");
    }

    #[test]
    fn a_description_names_bits_and_fields() {
        let parameter = AKD.by_name("MT.CNTL").unwrap();
        let word = AKD.word(parameter.pnu);
        let drive = Parameters {
            catalogue: Some(&AKD),
            scaling: Scaling::default(),
        };
        let limits = Limits::of(&drive, parameter, None);
        let text = description_lines(
            parameter,
            &drive.scaling,
            &limits,
            &of_tables("MT.CNTL"),
            (word, ""),
        )
        .join("\n");
        assert!(
            text.contains("bit        4 A following task is executed"),
            "{text}"
        );
        assert!(text.contains("bits       0 to 3 Task type\n"), "{text}");
        assert!(text.contains("  1 Relative to PL.CMD\n"), "{text}");
    }
}

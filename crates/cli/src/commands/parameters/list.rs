//! `profidrive list`

use client::{Drive, ErrorKind, Wait};
use profidrive::report::{ListReport, ParameterDescription, number, parameter};
use profile::catalogue::{Catalogue, Parameter};
use profile::notation::{self, Notation, ParameterReference, Shown};
use profile::value::{Parameters, Selection};

use super::{name_bits, values_table};
use crate::advice::Commands;
use crate::args::{List, Target};
use crate::connect::{self, Need};
use crate::failure::Failure;
use crate::output::Output;
use crate::render::Page;
use crate::render::table::Table;

pub fn list(args: &List, target: &Target, output: &Output) -> Result<(), Failure> {
    let (mut session, mut drive) = connect::drive(target, Need::Records, output)?;
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
            ErrorKind::Unsupported,
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
            readings.extend(session.read(&mut drive, part).wait()?);
            bar.inc(part.len() as u64);
        }
        bar.finish_and_clear();
        name_bits(&mut session, &mut drive, &mut readings)?;
        session.close().wait()?;
        let wording = Commands::any();
        let values = readings.iter().map(|reading| parameter(reading, &wording));
        let report = ListReport {
            values: values.collect(),
            ..empty(&drive)
        };
        output.json_report(&report);
        if !output.json() {
            output.table(&values_table(&report.values, args.raw));
        }
        let refused = readings.iter().filter(|reading| reading.is_err()).count();
        if refused > 0 {
            output.say(&format!("{refused} of {} could not be read", readings.len()));
        }
        return Ok(());
    }
    let rows = parameters.iter();
    output.report(&ListReport {
        parameters: rows
            .map(|parameter| ParameterDescription::new(tables, parameter, &drive.parameters))
            .collect(),
        ..empty(&drive)
    });
    if output.json() {
        return Ok(());
    }
    let wide = parameters.iter().filter(|parameter| parameter.wide).count();
    let also = match wide {
        0 => String::new(),
        1 => "; 1 of them has 64 bits and takes the next number too".to_owned(),
        _ => format!("; {wide} of them have 64 bits and take the next number too"),
    };
    output.say(&format!("{}{also}", counted(parameters.len())));
    Ok(())
}

fn empty(drive: &Drive) -> ListReport {
    ListReport {
        drive: drive.label(),
        model: drive.model.name,
        ..ListReport::default()
    }
}

impl Page for ListReport {
    fn print(&self, output: &Output) {
        let mut table = Table::new(&["name", "number", "access", "unit", "description"]);
        for parameter in &self.parameters {
            table.row([
                parameter.name.to_owned(),
                parameter.number.clone(),
                parameter.access.to_owned(),
                parameter.unit.to_owned(),
                parameter.description.to_owned(),
            ]);
        }
        output.table(&table);
        for pnu in &self.numbers {
            let shown = Shown {
                pnu: *pnu,
                index: None,
                writable: None,
                notation: Notation::Name,
            };
            output.line(&shown.to_string());
        }
    }
}

fn counted(count: usize) -> String {
    match count {
        1 => "1 parameter".into(),
        _ => format!("{count} parameters"),
    }
}

/// Text in name or description, the number itself, then numbers with the text in them.
fn filtered(parameters: &Parameters, tables: &'static Catalogue, text: &str) -> Vec<&'static Parameter> {
    let by_number = text
        .parse::<ParameterReference>()
        .ok()
        .filter(|reference| matches!(reference.target, notation::Target::Number(_)))
        .and_then(|reference| parameters.select(&reference).ok()?.parameter);
    let mut found: Vec<_> = tables.filter(text).collect();
    if let Some(exact) = by_number.filter(|exact| {
        found
            .iter()
            .all(|other| (other.pnu, other.base) != (exact.pnu, exact.base))
    }) {
        found.insert(0, exact);
    }
    let wanted = text.to_ascii_lowercase();
    let digits = wanted.contains(|c: char| c.is_ascii_digit());
    let of_number = tables.parameters.iter().filter(|parameter| {
        let same = |other: &&Parameter| (other.pnu, other.base) == (parameter.pnu, parameter.base);
        digits && number(tables, parameter).to_ascii_lowercase().contains(&wanted) && !found.iter().any(same)
    });
    let of_number: Vec<_> = of_number.collect();
    found.extend(of_number);
    found
}

/// A drive without tables lists its numbers itself (PNU 980 and following).
fn list_numbers(session: &mut connect::Live, drive: &mut Drive, output: &Output) -> Result<(), Failure> {
    let numbers = session.numbers(drive).wait()?;
    session.close().wait()?;
    let count = counted(numbers.len());
    output.report(&ListReport {
        numbers,
        ..empty(drive)
    });
    if !output.json() {
        output.say(&format!("{count}; no names are known for this drive"));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use profile::catalogue::{AKD, Scaling, VACON, VLT};

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
        let numbers = |tables: &'static Catalogue, text: &str| -> Vec<String> {
            let known = Parameters {
                catalogue: Some(tables),
                scaling: tables.scaling,
            };
            let found = filtered(&known, tables, text);
            found.iter().map(|parameter| number(tables, parameter)).collect()
        };
        // the number itself stands first
        assert_eq!(numbers(&VLT, "3-4"), ["3-04", "3-40", "3-41", "3-42"]);
        assert!(numbers(&AKD, "210").contains(&"p2108".into()));
        assert!(
            numbers(&VACON, "id 10").contains(&"ID 103".into()),
            "{:?}",
            numbers(&VACON, "id 10")
        );
    }
}

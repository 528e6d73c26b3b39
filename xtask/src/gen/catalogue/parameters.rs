//! Every parameter: `parameters.csv` of a model.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use super::meanings::Meanings;
use crate::Outcome;
use crate::table::{Row, Table};

/// Numbers and names in the order of the table.
pub fn numbers(parameters: &Table) -> Outcome<Vec<(u16, String)>> {
    let mut numbers: Vec<(u16, String)> = Vec::new();
    for row in parameters.rows() {
        let pnu: u16 = row.number("pnu")?;
        if numbers.last().is_some_and(|(last, _)| *last >= pnu) {
            return Err(format!("{}: PNU {pnu} is not in ascending order", row.place()).into());
        }
        numbers.push((pnu, row.text("name")?.to_owned()));
    }
    Ok(numbers)
}

/// The table as Rust. `values` (out of `device.toml`) take the place of the column `default`; used ones
/// are taken out.
pub fn render(
    parameters: &Table,
    meanings: &Meanings,
    values: &mut BTreeMap<String, f64>,
) -> Outcome<String> {
    let mut sources: Vec<String> = Vec::new();
    let mut rows = String::new();
    for row in parameters.rows() {
        rows.push_str(&render_parameter(row, meanings, values, &mut sources)?);
    }
    let mut text = String::from(
        "use super::meanings::*;\nuse crate::catalogue::{Access::*, Parameter, Scale::*, Size::*};\n\n",
    );
    writeln!(
        text,
        "#[rustfmt::skip]\npub static PARAMETERS: &[Parameter] = &[\n{rows}];\n"
    )?;
    writeln!(
        text,
        "/// Sources, each once.\n#[rustfmt::skip]\nstatic SOURCES: &[&str] = &{sources:#?};"
    )?;
    Ok(text)
}

fn render_parameter(
    row: Row<'_>,
    meanings: &Meanings,
    values: &mut BTreeMap<String, f64>,
    sources: &mut Vec<String>,
) -> Outcome<String> {
    let name = row.text("name")?;
    let word = |column: &str, words: &[(&str, &'static str)]| -> Outcome<&'static str> {
        let text = row.text(column)?;
        let found = words.iter().find(|(key, _)| *key == text);
        found
            .map(|(_, value)| *value)
            .ok_or_else(|| format!("{}: {column} {text:?}", row.place()).into())
    };
    let yes = |column: &str| word(column, &[("yes", "true"), ("no", "false"), ("", "false")]);
    let number = |column: &str| -> Outcome<String> {
        Ok(row
            .optional::<f64>(column)?
            .map_or("None".to_owned(), |value| format!("Some({value:?})")))
    };
    let size = word(
        "size",
        &[
            ("byte", "Byte"),
            ("word", "Word"),
            ("dword", "Dword"),
            ("command", "Command"),
        ],
    )?;
    let access = word(
        "access",
        &[("ro", "ReadOnly"), ("rw", "ReadWrite"), ("command", "Command")],
    )?;
    // `Command` is both a size and an access: the access keeps the long name.
    let access = if access == "Command" { "WriteOnly" } else { access };
    let scale = word(
        "scale",
        &[
            ("raw", "Raw"),
            ("milli", "Milli"),
            ("position", "Position"),
            ("velocity", "Velocity"),
            ("acceleration", "Acceleration"),
            ("current", "Current"),
            ("singleturn", "Singleturn"),
            ("mdi-velocity", "MdiVelocity"),
        ],
    )?;
    let default = match values.remove(name) {
        Some(value) => format!("Some({value:?})"),
        None => number("default")?,
    };
    let source = row.text("source")?;
    let source = sources
        .iter()
        .position(|known| known == source)
        .unwrap_or_else(|| {
            sources.push(source.to_owned());
            sources.len() - 1
        });
    let (choices, bits) = meanings.names(name);
    Ok(format!(
        "    Parameter {{ pnu: {}, name: {name:?}, size: {size}, elements: {}, signed: {}, access: {access}, saved: {}, \
         wide: {}, unit: {:?}, user_unit: {}, scale: {scale}, minimum: {}, maximum: {}, default: {default}, choices: {choices}, \
         bits: {bits}, description: {:?}, source: SOURCES[{source}] }},\n",
        row.number::<u16>("pnu")?,
        row.number::<u16>("elements")?,
        yes("signed")?,
        yes("nv")?,
        yes("wide")?,
        row.text("unit")?,
        yes("user_unit")?,
        number("minimum")?,
        number("maximum")?,
        row.text("description")?,
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_number_out_of_order_is_refused() {
        let numbers = |rows: &str| numbers(&Table::parse("p", &format!("pnu,name\n{rows}")).unwrap());
        assert_eq!(numbers("1,A\n3,B\n").unwrap().len(), 2);
        assert!(
            numbers("3,A\n3,B\n")
                .unwrap_err()
                .to_string()
                .starts_with("p:3: PNU 3")
        );
    }
}

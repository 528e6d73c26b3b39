//! Every parameter: `parameters.csv` of a model.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use super::meanings::Meanings;
use crate::Outcome;
use crate::r#gen::parameter::{Format, Formats};
use crate::table::{Row, Table};

/// Where a parameter is on the wire, and its name.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Number {
    /// Parameter number.
    pub pnu: u16,
    /// Subindex of an element of a collecting number.
    pub base: Option<u16>,
    /// The vendor's name.
    pub name: String,
}

impl Number {
    fn of(row: Row<'_>) -> Outcome<Self> {
        Ok(Self {
            pnu: row.number("pnu")?,
            base: row.maybe_number("base")?,
            name: row.text("name")?.to_owned(),
        })
    }

    /// Returns the spelling of the other tables of the model: `p120`, `id103`.
    pub fn key(&self) -> String {
        match self.base {
            Some(id) => format!("id{id}"),
            None => format!("p{}", self.pnu),
        }
    }
}

/// Numbers and names in the order of the table, which ascends by number and element.
pub fn numbers(parameters: &Table) -> Outcome<Vec<Number>> {
    let mut numbers: Vec<Number> = Vec::new();
    for row in parameters.rows() {
        let number = Number::of(row)?;
        let last = numbers.last().map(|last| (last.pnu, last.base));
        if last.is_some_and(|last| last >= (number.pnu, number.base)) {
            return Err(format!("{}: PNU {} is not in ascending order", row.place(), number.pnu).into());
        }
        if last.is_some_and(|(pnu, base)| pnu == number.pnu && base.is_none()) {
            return Err(format!(
                "{}: PNU {} has a row of its own and elements",
                row.place(),
                number.pnu
            )
            .into());
        }
        numbers.push(number);
    }
    Ok(numbers)
}

/// Returns the table as Rust. `values` (out of `device.toml`) take the place of the column `default`; used ones are
/// taken out.
pub fn render(
    parameters: &Table,
    meanings: &Meanings,
    formats: &Formats,
    values: &mut BTreeMap<String, f64>,
) -> Outcome<String> {
    let mut sources: Vec<String> = Vec::new();
    let mut rows = String::new();
    for row in parameters.rows() {
        rows.push_str(&render_parameter(row, meanings, formats, values, &mut sources)?);
    }
    let index = if rows.contains("ConversionIndex") {
        "ConversionIndex, "
    } else {
        ""
    };
    let mut text = format!(
        "use super::meanings::*;\nuse crate::catalogue::{{Access::*, Parameter, Scale::*, Size::*}};\n\
         use crate::parameter::Format;\nuse crate::unit::{{{index}Variable}};\n\n",
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
    formats: &Formats,
    values: &mut BTreeMap<String, f64>,
    sources: &mut Vec<String>,
) -> Outcome<String> {
    let Number { pnu, base, name } = &Number::of(row)?;
    let key = Number::of(row)?.key();
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
    let value = match row.maybe("format") {
        "" => ValueType::of_size(
            word(
                "size",
                &[
                    ("byte", "Byte"),
                    ("word", "Word"),
                    ("dword", "Dword"),
                    ("command", "Command"),
                ],
            )?,
            yes("signed")? == "true",
        ),
        format => {
            let length = row.maybe_number("length")?.unwrap_or(0);
            formats
                .named(format)
                .and_then(|format| ValueType::of_format(format, length))
                .map_err(|error| format!("{}: {error}", row.place()))?
        }
    };
    let access = word(
        "access",
        &[("ro", "ReadOnly"), ("rw", "ReadWrite"), ("command", "Command")],
    )?;
    // `Command` is both a size and an access: the access keeps the long name.
    let access = if access == "Command" { "WriteOnly" } else { access };
    let scale = match row.text("scale")?.strip_prefix("10^") {
        Some(exponent) => match exponent.parse::<i8>() {
            Ok(exponent) if exponent != 0 => format!("Decimal({exponent})"),
            _ => return Err(format!("{}: 10^{exponent} is not a scale", row.place()).into()),
        },
        None => word(
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
                ("nominal-velocity", "NominalVelocity"),
                ("percent", "Percent"),
            ],
        )?
        .to_owned(),
    };
    let variable = match (
        row.maybe_number::<u8>("quantity")?,
        row.maybe_number::<i8>("conversion")?,
    ) {
        (None, None) => "Variable::NONE".to_owned(),
        (size, index) => format!(
            "Variable {{ size: {}, conversion: ConversionIndex({}) }}",
            size.unwrap_or(0),
            index.unwrap_or(0)
        ),
    };
    let recalled = match row.maybe("confidence") {
        "" | "read" | "partly read" => false,
        "recalled" => true,
        other => return Err(format!("{}: confidence {other:?}", row.place()).into()),
    };
    let default = match values.remove(&key).or_else(|| values.remove(name)) {
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
    let (choices, bits) = meanings.names(name, &key);
    Ok(format!(
        "    Parameter {{ pnu: {pnu}, base: {base:?}, name: {name:?}, size: {}, format: Format({:#04x}), length: {}, \
         elements: {}, signed: {}, access: {access}, saved: {}, wide: {}, unit: {:?}, user_unit: {}, scale: {scale}, \
         variable: {variable}, minimum: {}, maximum: {}, default: {default}, text: {:?}, choices: {choices}, bits: {bits}, \
         description: {:?}, recalled: {recalled}, source: SOURCES[{source}] }},\n",
        value.size,
        value.format,
        value.length,
        row.number::<u16>("elements")?,
        value.signed,
        yes("nv")?,
        if row.maybe("wide").is_empty() {
            "false"
        } else {
            yes("wide")?
        },
        row.text("unit")?,
        if row.maybe("user_unit").is_empty() {
            "false"
        } else {
            yes("user_unit")?
        },
        number("minimum")?,
        number("maximum")?,
        row.maybe("text"),
        row.text("description")?,
    ))
}

/// Type of one value.
#[derive(Debug, PartialEq, Eq)]
struct ValueType {
    size: &'static str,
    signed: bool,
    format: u8,
    length: u16,
}

impl ValueType {
    /// Creates a table that has only sizes.
    fn of_size(size: &'static str, signed: bool) -> Self {
        let format = match (size, signed) {
            ("Byte", true) => 0x02,
            ("Word" | "Command", true) => 0x03,
            ("Dword", true) => 0x04,
            ("Byte", false) => 0x05,
            ("Word" | "Command", false) => 0x06,
            _ => 0x07,
        };
        Self {
            size,
            signed,
            format,
            length: 0,
        }
    }

    /// Returns a table that has the true type.
    fn of_format(format: Format, length: u16) -> Outcome<Self> {
        let octets = match format.octets {
            Some(octets) if length == 0 => u16::from(octets),
            None if length > 0 => length,
            _ => return Err(format!("length {length} is none of {}", format.name).into()),
        };
        let size = match octets {
            _ if format.text => "Byte",
            1 => "Byte",
            2 => "Word",
            4 => "Dword",
            _ => return Err(format!("{octets} octets of {} are not a number", format.name).into()),
        };
        Ok(Self {
            size,
            signed: format.signed,
            format: format.code,
            length,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_number_out_of_order_is_refused() {
        let numbers = |rows: &str| numbers(&Table::parse("p", &format!("pnu,base,name\n{rows}")).unwrap());
        assert_eq!(numbers("1,,A\n3,,B\n").unwrap().len(), 2);
        assert_eq!(numbers("1,5,A\n1,7,B\n").unwrap()[1].key(), "id7");
        for rows in ["3,,A\n3,,B\n", "3,2,A\n3,2,B\n", "3,,A\n3,2,B\n"] {
            let error = numbers(rows).unwrap_err().to_string();
            assert!(error.starts_with("p:3: PNU 3"), "{error}");
        }
    }

    #[test]
    fn types_by_size_and_by_name() {
        let formats = Formats::read(&crate::root()).unwrap();
        let of = |name: &str, length| ValueType::of_format(formats.named(name)?, length);
        assert_eq!(of("Integer16", 0).unwrap(), ValueType::of_size("Word", true));
        assert_eq!(of("Unsigned32", 0).unwrap(), ValueType::of_size("Dword", false));
        let text = of("VisibleString", 20).unwrap();
        assert_eq!((text.size, text.length, text.format), ("Byte", 20, 9));
        assert_eq!(of("N2", 0).unwrap().format, 0x71);
        assert!(of("Integer16", 2).is_err() && of("VisibleString", 0).is_err());
        assert!(of("Integer64", 0).is_err() && of("Integer17", 0).is_err());
    }
}

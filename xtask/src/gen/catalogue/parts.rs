//! What parameters are to drive and client: the parts in `profile/parts.csv`, and which parameters of a model have them in
//! its `parts.csv`.

use std::fmt::Write as _;

use super::backup::{Known, names};
use crate::Outcome;
use crate::table::Table;

/// The type of parts as Rust.
pub fn render_type(parts: &Table) -> Outcome<String> {
    let mut variants = String::new();
    let mut all = String::new();
    for row in parts.rows() {
        let (part, about) = (row.text("part")?, row.text("about")?);
        let name = variant(part);
        writeln!(variants, "/// {about}\n{name},")?;
        writeln!(all, "Self::{name},")?;
    }
    Ok(format!(
        "/// What a parameter is to drive and client. A model without such a parameter has no row of the part.\n\
         #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]\n#[non_exhaustive]\n\
         pub enum Part {{\n{variants}}}\n\n\
         impl Part {{\n/// Every part.\npub const ALL: &'static [Self] = &[{all}];\n}}\n"
    ))
}

/// The rows of a model as Rust, in their order. Each names one parameter, and after `=` the values that the part is about.
/// `names_of_parts` has the parts that exist.
pub fn render(parts: &Table, names_of_parts: &Table, known: &[Known]) -> Outcome<String> {
    let exist: Result<Vec<&str>, _> = names_of_parts.rows().map(|row| row.text("part")).collect();
    let exist = exist?;
    let mut text = String::from(
        "use crate::catalogue::{Part, PartRow};\n\n\
         #[rustfmt::skip]\npub static PARTS: &[PartRow] = &[\n",
    );
    for row in parts.rows() {
        let place = row.place();
        let (part, cell) = (row.text("part")?, row.text("parameter")?);
        if !exist.contains(&part) {
            return Err(format!("{place}: {part:?} is not a part of profile/parts.csv").into());
        }
        let (pattern, values) = cell.split_once('=').unwrap_or((cell, ""));
        let values: Result<Vec<i64>, _> = values.split_whitespace().map(str::parse).collect();
        let values = values.map_err(|_| format!("{place}: {cell:?} has a value that is not a number"))?;
        let mut found = known.iter().filter(|one| names(pattern, one));
        let (Some(parameter), None) = (found.next(), found.next()) else {
            return Err(format!("{place}: {pattern:?} is not the name of one parameter").into());
        };
        writeln!(
            text,
            "    PartRow {{ part: Part::{}, pnu: {}, base: {:?}, values: &{values:?} }},",
            variant(part),
            parameter.pnu,
            parameter.base
        )?;
    }
    text.push_str("];\n");
    Ok(text)
}

/// `speed-actual` is `SpeedActual`.
pub fn variant(key: &str) -> String {
    let capital = |word: &str| {
        let mut letters = word.chars();
        let first = letters.next().map(|first| first.to_ascii_uppercase());
        first.into_iter().chain(letters).collect::<String>()
    };
    key.split('-').map(capital).collect()
}

#[cfg(test)]
mod tests {
    use super::super::backup::known;
    use super::*;

    #[test]
    fn each_row_names_one_parameter() {
        let rows = "pnu,base,name,access\n2,,A,ro\n10001,103,B,rw\n10002,,B,rw\n";
        let known = known(&Table::parse("p", rows).unwrap()).unwrap();
        let names = Table::parse("n", "part,about\nstatus-word,-\nramp-up-time,-\nspeed,-\n").unwrap();
        let parts = |rows: &str| {
            let rows = Table::parse("r", &format!("part,parameter\n{rows}\n")).unwrap();
            render(&rows, &names, &known)
        };
        let text = parts("status-word,A\nramp-up-time,id103").unwrap();
        assert!(
            text.contains("PartRow { part: Part::StatusWord, pnu: 2, base: None, values: &[] },"),
            "{text}"
        );
        assert!(
            text.contains("Part::RampUpTime, pnu: 10001, base: Some(103)"),
            "{text}"
        );
        assert!(
            parts("speed,A=2 5")
                .unwrap()
                .contains("base: None, values: &[2, 5] }")
        );
        for wrong in ["speed,C", "speed,B", "speed,A=x", "sped,A"] {
            assert!(parts(wrong).is_err(), "{wrong}");
        }
    }
}

//! Bits of control and status words: `words.csv` of the profile and of each vendor that has words of its own.

use std::fmt::Write as _;
use std::path::Path;

use super::Generated;
use crate::Outcome;
use crate::table::{Row, Table};

/// Bits of one word.
const BITS: usize = 16;

/// The generated file of each table, below `crates/profile/src/state/`.
const FILES: &[(&str, &str)] = &[
    ("data/profile/words.csv", "generated_bits.rs"),
    ("data/vlt/words.csv", "profile/danfoss/generated_bits.rs"),
    ("data/vacon/words.csv", "profile/vacon/generated_bits.rs"),
];

/// The generated file of the Python package, and its table.
const PYTHON: (&str, &str) = ("data/profile/words.csv", "python/profidrive/words.py");

/// The generated files.
pub fn files(root: &Path) -> Outcome<Vec<Generated>> {
    let file = |(from, path): &(&str, &str)| -> Outcome<Generated> {
        Ok(Generated {
            path: format!("crates/profile/src/state/{path}"),
            from: (*from).to_owned(),
            text: render(from, &Table::read(root, from)?)?,
        })
    };
    let mut files: Vec<Generated> = FILES.iter().map(file).collect::<Outcome<_>>()?;
    let (from, path) = PYTHON;
    files.push(Generated {
        path: path.to_owned(),
        from: from.to_owned(),
        text: render_python(&Table::read(root, from)?)?,
    });
    Ok(files)
}

/// The words as flags of Python. A bit with two meanings has two names, that of velocity mode first; one that is device specific in
/// one mode has its other name.
fn render_python(table: &Table) -> Outcome<String> {
    let mut text = String::from(
        "\"\"\"Control and status words of PROFIdrive as flags.\"\"\"\n\nfrom __future__ import annotations\n\nfrom enum import IntFlag\n",
    );
    for (word, class, doc) in [
        ("stw1", "Stw1", "Control word 1: what a controller commands."),
        ("zsw1", "Zsw1", "Status word 1: what a drive reports."),
    ] {
        writeln!(
            text,
            "\n\nclass {class}(IntFlag):\n    \"\"\"{doc} `NO_` is of a bit whose 1 is the quiet state.\"\"\"\n"
        )?;
        for number in 0..BITS {
            let mut bits = Vec::new();
            for row in table.rows() {
                let of_word = row
                    .text("words")?
                    .split_whitespace()
                    .any(|name| name.starts_with(word));
                if of_word && row.number::<usize>("bit")? == number {
                    bits.push(row);
                }
            }
            let is_named = |row: &Row<'_>| row.text("name").is_ok_and(|name| !name.starts_with("BIT"));
            if bits.iter().any(is_named) {
                bits.retain(is_named);
            }
            let mut names: Vec<String> = Vec::new();
            for row in bits {
                let quiet = if row.text("inverse")?.is_empty() {
                    ""
                } else {
                    "NO_"
                };
                let name = format!("{quiet}{}", row.text("name")?);
                if names.contains(&name) {
                    continue;
                }
                let meaning = row.text("on")?;
                writeln!(
                    text,
                    "    {name} = 0x{:04X}\n    \"\"\"Bit {number}: {meaning}.\"\"\"",
                    1 << number
                )?;
                names.push(name);
            }
        }
    }
    text.push_str("\n\n__all__ = [\"Stw1\", \"Zsw1\"]\n");
    Ok(text)
}

/// One table of 16 bits for each word, in the order of the rows.
fn render(file: &str, table: &Table) -> Outcome<String> {
    let mut words: Vec<(&str, Vec<Row<'_>>)> = Vec::new();
    for row in table.rows() {
        if row.text("source")?.is_empty() {
            return Err(format!("{}: no source", row.place()).into());
        }
        for name in row.text("words")?.split_whitespace() {
            match words.iter_mut().find(|(known, _)| *known == name) {
                Some((_, rows)) => rows.push(row),
                None => words.push((name, vec![row])),
            }
        }
    }
    let mut text = String::from("use crate::state::bits::Bit;\n");
    for (word, rows) in &words {
        let mut names = Vec::new();
        let mut bits = String::new();
        for (number, row) in rows.iter().enumerate() {
            let (name, place) = (row.text("name")?, row.place());
            if row.number::<usize>("bit")? != number || number >= BITS {
                return Err(format!("{place}: {word} has no bit {number} before this row").into());
            }
            if names.contains(&name) {
                return Err(format!("{place}: {word} has two bits {name}").into());
            }
            names.push(name);
            let (on, off, inverse) = (
                row.text("on")?,
                row.text("off")?,
                !row.text("inverse")?.is_empty(),
            );
            writeln!(
                bits,
                "Bit {{ number: {number}, name: {name:?}, on: {on:?}, off: {off:?}, inverse: {inverse} }},"
            )?;
        }
        if rows.len() != BITS {
            return Err(format!("{file}: {word} has {} bits", rows.len()).into());
        }
        let name = word.replace('-', "_").to_ascii_uppercase();
        writeln!(
            text,
            "\n#[rustfmt::skip]\npub static {name}: [Bit; {BITS}] = [\n{bits}];"
        )?;
    }
    Ok(text)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table(rows: impl Iterator<Item = (usize, &'static str)>) -> Outcome<String> {
        let rows: Vec<String> = rows
            .map(|(bit, name)| format!("a b,{bit},{name}{bit},\"on, {bit}\",off,yes,manual\n"))
            .collect();
        let text = format!("words,bit,name,on,off,inverse,source\n{}", rows.concat());
        render("t", &Table::parse("t", &text)?)
    }

    #[test]
    fn each_word_has_each_bit_once() {
        let all = || (0..BITS).map(|bit| (bit, "X"));
        let text = table(all()).unwrap();
        assert!(text.contains("pub static A: [Bit; 16]"), "{text}");
        assert!(
            text.contains(r#"Bit { number: 3, name: "X3", on: "on, 3", off: "off", inverse: true }"#),
            "{text}"
        );
        assert!(table(all().skip(1)).is_err());
        assert!(table(all().take(15)).is_err());
        assert!(table(all().chain([(16, "X")])).is_err());
        assert!(table(all().map(|(bit, _)| (bit.min(7), "X"))).is_err());
    }
}

//! Texts of enumeration values, bits and fields of bits: `meanings.csv` of a model.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;
use std::path::Path;

use super::parameters::Number;
use crate::Outcome;
use crate::table::Table;

/// Texts by parameter or family.
pub struct Meanings {
    /// Texts by parameter and kind: `choice`, `bit`, `choice 0-3`.
    tables: BTreeMap<(String, String), Vec<(i32, String)>>,
    /// Bits that are one number, with its name.
    fields: BTreeMap<String, Vec<(u8, u8, String)>>,
    /// Words of which no bit has a text here, and the profile's own.
    words: BTreeMap<String, &'static str>,
    /// Parameters with the meanings of another one.
    same: BTreeMap<String, String>,
    /// What to do when the present state forbids a write.
    not_now: BTreeMap<String, String>,
}

impl Meanings {
    /// Reads `root/file`.
    pub fn read(root: &Path, file: &str) -> Outcome<Self> {
        let mut meanings = Self {
            tables: BTreeMap::new(),
            fields: BTreeMap::new(),
            words: BTreeMap::new(),
            same: BTreeMap::new(),
            not_now: BTreeMap::new(),
        };
        for row in Table::read(root, file)?.rows() {
            let wrong = |what: &str| format!("{}: {what}", row.place());
            let (parameter, text) = (row.text("parameter")?.to_owned(), row.text("text")?.to_owned());
            match row.text("kind")? {
                "word" => {
                    let kind = match text.as_str() {
                        "STW1" => "Control",
                        "ZSW1" => "Status",
                        "" => "Own",
                        other => return Err(wrong(&format!("word {other:?}")).into()),
                    };
                    meanings.words.insert(parameter, kind);
                }
                "not-now" => {
                    meanings.not_now.insert(parameter, text);
                }
                "same" => {
                    meanings.same.insert(parameter, text);
                }
                "field" => {
                    let (first, last) = bits(row.text("value")?).ok_or_else(|| wrong("bits as 0-3"))?;
                    meanings
                        .fields
                        .entry(parameter)
                        .or_default()
                        .push((first, last, text));
                }
                kind => {
                    let known = match kind.strip_prefix("choice ") {
                        Some(range) => {
                            let known = meanings.fields.get(&parameter);
                            bits(range).is_some_and(|(first, last)| {
                                known.is_some_and(|fields| {
                                    fields.iter().any(|field| (field.0, field.1) == (first, last))
                                })
                            })
                        }
                        None => matches!(kind, "choice" | "bit"),
                    };
                    if !known {
                        return Err(wrong(&format!("kind {kind:?}")).into());
                    }
                    let table = meanings.tables.entry((parameter, kind.to_owned())).or_default();
                    table.push((row.number("value")?, text));
                }
            }
        }
        Ok(meanings)
    }

    /// Texts of the bits of a parameter that are faults.
    pub fn bits_of_faults(&mut self, parameter: &str, bits: &[(u8, String)]) -> Outcome<()> {
        if bits.is_empty() {
            return Ok(());
        }
        let texts = bits
            .iter()
            .map(|(bit, text)| (i32::from(*bit), text.clone()))
            .collect();
        match self
            .tables
            .insert((parameter.to_owned(), "bit".to_owned()), texts)
        {
            Some(_) => Err(format!("meanings: the bits of {parameter} are those of the faults").into()),
            None => Ok(()),
        }
    }

    /// Returns the texts as Rust, a table for each parameter or family that has some.
    pub fn render(&self) -> String {
        let mut text = String::from("use crate::catalogue::Meaning;\n\n");
        for ((parameter, kind), meanings) in &self.tables {
            text.push_str(&format!(
                "#[rustfmt::skip]\npub static {}: &[Meaning] = &[\n",
                identifier(parameter, kind)
            ));
            for (value, words) in meanings {
                text.push_str(&format!("    Meaning {{ value: {value}, text: {words:?} }},\n"));
            }
            text.push_str("];\n\n");
        }
        text
    }

    /// Returns the table of words, ascending by number.
    pub fn render_words(&self, numbers: &[Number]) -> Outcome<String> {
        let mut used = BTreeSet::new();
        let mut text = String::new();
        for number in numbers {
            let key = number.key();
            let (_, bits) = self.names(&number.name, &key);
            let source = self.source(&number.name, &key);
            let kind = self.words.get(source).copied();
            let fields = self.fields.get(source);
            if bits == NONE && kind.is_none() && fields.is_none() {
                continue;
            }
            used.insert(source.to_owned());
            write!(
                text,
                "    Word {{ pnu: {}, base: {:?}, kind: WordKind::{}, bits: {bits}, fields: &[",
                number.pnu,
                number.base,
                kind.unwrap_or("Own")
            )?;
            for (first, last, name) in fields.into_iter().flatten() {
                let kind = format!("choice {first}-{last}");
                let key = (source.to_owned(), kind.clone());
                let choices = if self.tables.contains_key(&key) {
                    identifier(source, &kind)
                } else {
                    NONE.to_owned()
                };
                write!(
                    text,
                    "Field {{ first: {first}, last: {last}, name: {name:?}, choices: {choices} }}, "
                )?;
            }
            text.push_str("] },\n");
        }
        let used_here = |what: &str, import: &'static str| if text.contains(what) { import } else { "" };
        let header = format!(
            "{}use crate::catalogue::{{{}Word{}}};\n\n#[rustfmt::skip]\npub static WORDS: &[Word] = &[\n",
            used_here("_", "use super::meanings::*;\n"),
            used_here("Field {", "Field, "),
            used_here("WordKind", ", WordKind"),
        );
        text = format!("{header}{text}];\n\n");
        text.push_str("#[rustfmt::skip]\npub static NOT_NOW: &[(u16, &str)] = &[\n");
        for number in numbers.iter().filter(|number| number.base.is_none()) {
            let key = number.key();
            for name in [number.name.as_str(), key.as_str()] {
                if let Some(remedy) = self.not_now.get(name) {
                    used.insert(name.to_owned());
                    writeln!(text, "    ({}, {remedy:?}),", number.pnu)?;
                }
            }
        }
        text.push_str("];\n\n");
        match self
            .words
            .keys()
            .chain(self.fields.keys())
            .chain(self.not_now.keys())
            .find(|name| !used.contains(*name))
        {
            Some(name) => Err(format!("meanings: {name} is not a parameter").into()),
            None => Ok(text),
        }
    }

    /// Returns the parameter whose texts this one has: the one in the row `same`, else itself, by its number where the
    /// table has that and not the name.
    fn source<'a>(&'a self, parameter: &'a str, key: &'a str) -> &'a str {
        let has = |name: &str| {
            self.words.contains_key(name)
                || self.fields.contains_key(name)
                || self.tables.keys().any(|(known, _)| known == name)
        };
        match self.same.get(parameter).or_else(|| self.same.get(key)) {
            Some(other) => other,
            None if has(key) && !has(parameter) => key,
            None => parameter,
        }
    }

    /// Returns the expressions for `choices` and `bits` of a parameter. By its name, by that of its family, or by its
    /// number as [`Number::key`] writes it.
    pub fn names(&self, parameter: &str, key: &str) -> (String, String) {
        let parameter = self.source(parameter, key);
        let family = family(parameter);
        let one = |kind: &str| {
            [parameter, family.as_str()]
                .iter()
                .find(|name| self.tables.contains_key(&((**name).to_owned(), kind.to_owned())))
                .map_or(NONE.to_owned(), |name| identifier(name, kind))
        };
        (one("choice"), one("bit"))
    }
}

/// No texts.
const NONE: &str = "&[]";

/// `0-3` as first and last bit.
fn bits(range: &str) -> Option<(u8, u8)> {
    let (first, last) = range.split_once('-')?;
    let (first, last) = (first.parse().ok()?, last.parse().ok()?);
    (first <= last && last < 64).then_some((first, last))
}

/// `DIN21.MODE` is of the family `DINx.MODE`.
fn family(parameter: &str) -> String {
    match parameter.split_once('.') {
        Some((group, rest)) => format!("{}x.{rest}", group.trim_end_matches(|c: char| c.is_ascii_digit())),
        None => parameter.to_owned(),
    }
}

fn identifier(parameter: &str, kind: &str) -> String {
    let kind = match kind {
        "bit" => "BITS".to_owned(),
        "choice" => "CHOICES".to_owned(),
        other => other.to_ascii_uppercase().replace([' ', '-'], "_"),
    };
    format!(
        "{}_{kind}",
        parameter.to_ascii_uppercase().replace(['.', ' '], "_")
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn families_and_identifiers() {
        assert_eq!(family("DIN21.MODE"), "DINx.MODE");
        assert_eq!(family("STW1"), "STW1");
        assert_eq!(identifier("DRV.OPMODE", "choice"), "DRV_OPMODE_CHOICES");
        assert_eq!(identifier("MT.CNTL", "choice 0-3"), "MT_CNTL_CHOICE_0_3");
        assert_eq!(bits("5-9"), Some((5, 9)));
        assert_eq!((bits("9-5"), bits("5"), bits("0-64")), (None, None, None));
    }
}

//! Texts of enumeration values and bits: `meanings.csv` of a model.

use std::collections::BTreeMap;
use std::path::Path;

use crate::Outcome;
use crate::table::Table;

/// Texts of enumeration values and bits by parameter.
pub struct Meanings {
    tables: BTreeMap<(String, String), Vec<(i32, String)>>,
}

impl Meanings {
    /// Reads `root/file`.
    pub fn read(root: &Path, file: &str) -> Outcome<Self> {
        let mut tables: BTreeMap<_, Vec<_>> = BTreeMap::new();
        for row in Table::read(root, file)?.rows() {
            let kind = row.text("kind")?;
            if !matches!(kind, "choice" | "bit") {
                return Err(format!("{}: kind {kind:?}", row.place()).into());
            }
            let key = (row.text("parameter")?.to_owned(), kind.to_owned());
            tables
                .entry(key)
                .or_default()
                .push((row.number("value")?, row.text("text")?.to_owned()));
        }
        Ok(Self { tables })
    }

    /// The texts as Rust, a table for each parameter or family that has some.
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

    /// The expressions for `choices` and `bits` of a parameter.
    pub fn names(&self, parameter: &str) -> (String, String) {
        let family = family(parameter);
        let one = |kind: &str| {
            [parameter, family.as_str()]
                .iter()
                .find(|name| self.tables.contains_key(&((**name).to_owned(), kind.to_owned())))
                .map_or("&[]".to_owned(), |name| identifier(name, kind))
        };
        (one("choice"), one("bit"))
    }
}

/// `DIN21.MODE` is of the family `DINx.MODE`.
fn family(parameter: &str) -> String {
    match parameter.split_once('.') {
        Some((group, rest)) => format!("{}x.{rest}", group.trim_end_matches(|c: char| c.is_ascii_digit())),
        None => parameter.to_owned(),
    }
}

fn identifier(parameter: &str, kind: &str) -> String {
    let kind = if kind == "bit" { "BITS" } else { "CHOICES" };
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
    }
}

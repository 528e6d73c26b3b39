//! Why a drive does not run: the causes in `profile/causes.csv`, and what a vendor has of its own about them in
//! `advice.csv` of a model.
//!
//! A row of `advice.csv` is one of these `kind`s:
//! - `cause`: what to do about the cause `about` with the parameters of this model, in place of the general advice;
//! - `warning`: the causes that the warning with the number `about` reports;
//! - `disable`: the remedy after a write of the parameter `about`, which switches the drive off.

use std::fmt::Write as _;
use std::path::Path;

use super::Generated;
use super::catalogue::{Known, MODELS, known_parameters, warnings};
use crate::Outcome;
use crate::table::{Row, Table};

const CAUSES: &str = "data/profile/causes.csv";

/// The generated file.
pub fn files(root: &Path) -> Outcome<Vec<Generated>> {
    let causes = Table::read(root, CAUSES)?;
    let mut advice = Tables::default();
    for model in MODELS {
        let rows = Table::read(root, &format!("data/{}/advice.csv", model.folder))?;
        let parameters = known_parameters(root, model)?;
        advice.add(model.name, &rows, &causes, &parameters, &warnings(root, model)?)?;
    }
    Ok(vec![Generated {
        path: "crates/client/src/status/generated.rs".into(),
        from: CAUSES.into(),
        text: format!("{}\n{}", render_causes(&causes)?, advice.render()),
    }])
}

/// The type of causes with what each row has.
fn render_causes(causes: &Table) -> Outcome<String> {
    let [mut variants, mut all, mut ids, mut verdicts, mut advice] = [const { String::new() }; 5];
    for row in causes.rows() {
        let (name, id, verdict) = (row.text("name")?, row.text("id")?, row.text("verdict")?);
        if !matches!(verdict, "Runs" | "Waits" | "Held") {
            return Err(format!("{}: verdict {verdict:?}", row.place()).into());
        }
        writeln!(variants, "/// {}\n{name},", row.text("about")?)?;
        writeln!(all, "Self::{name},")?;
        writeln!(ids, "Self::{name} => {id:?},")?;
        writeln!(verdicts, "Self::{name} => Verdict::{verdict},")?;
        writeln!(advice, "Self::{name} => {:?},", row.text("advice")?)?;
    }
    Ok(format!(
        "use super::Verdict;\n\n\
         /// What keeps a drive from running, or that nothing does. In the order of their weight.\n\
         #[derive(Debug, Clone, Copy, PartialEq, Eq)]\n#[non_exhaustive]\npub enum Cause {{\n{variants}}}\n\n\
         impl Cause {{\n\
         /// Every cause, the most important first.\npub const ALL: &'static [Self] = &[{all}];\n\n\
         /// Stable name for programs.\n#[must_use]\n#[rustfmt::skip]\n\
         pub const fn id(self) -> &'static str {{ match self {{ {ids} }} }}\n\n\
         #[rustfmt::skip]\npub(super) const fn verdict(self) -> Verdict {{ match self {{ {verdicts} }} }}\n\n\
         /// What to do, whatever the model is; empty where nothing is to be done.\n#[rustfmt::skip]\n\
         pub(super) const fn advice(self) -> &'static str {{ match self {{ {advice} }} }}\n}}\n"
    ))
}

/// The rows of the vendors.
#[derive(Default)]
struct Tables {
    advice: String,
    warnings: String,
    disables: String,
}

impl Tables {
    fn add(
        &mut self,
        model: &str,
        rows: &Table,
        causes: &Table,
        parameters: &[Known],
        warnings: &[u16],
    ) -> Outcome<()> {
        for row in rows.rows() {
            let (place, about, advice) = (row.place(), row.text("about")?, row.text("advice")?);
            if row.text("source")?.is_empty() {
                return Err(format!("{place}: no source").into());
            }
            let check = || check_names(&row, advice, parameters);
            match row.text("kind")? {
                "cause" => {
                    check()?;
                    let cause = cause(&row, about, causes)?;
                    writeln!(self.advice, "({model:?}, Cause::{cause}, {advice:?}),")?;
                }
                "disable" => {
                    check()?;
                    check_names(&row, about, parameters)?;
                    writeln!(self.disables, "({model:?}, {about:?}, {advice:?}),")?;
                }
                "warning" => {
                    let number: u16 = row.number("about")?;
                    if !warnings.contains(&number) {
                        return Err(format!("{place}: the model has no warning {number}").into());
                    }
                    let named: Outcome<Vec<String>> = advice
                        .split_whitespace()
                        .map(|id| Ok(format!("Cause::{}", cause(&row, id, causes)?)))
                        .collect();
                    writeln!(self.warnings, "({model:?}, {number}, &[{}]),", named?.join(", "))?;
                }
                other => return Err(format!("{place}: kind {other:?}").into()),
            }
        }
        Ok(())
    }

    fn render(&self) -> String {
        format!(
            "/// What to do about a cause with the parameters of a model, actions in braces.\n#[rustfmt::skip]\n\
             pub(super) static ADVICE: &[(&str, Cause, &str)] = &[\n{}];\n\n\
             /// Causes that a warning reports.\n#[rustfmt::skip]\n\
             pub(super) static WARNINGS: &[(&str, u32, &[Cause])] = &[\n{}];\n\n\
             /// The parameter that switches a drive off beside its controller, and what to do about it.\n#[rustfmt::skip]\n\
             pub(super) static DISABLES: &[(&str, &str, &str)] = &[\n{}];\n",
            self.advice, self.warnings, self.disables
        )
    }
}

/// The name of the cause with this id.
fn cause<'a>(row: &Row<'_>, id: &str, causes: &'a Table) -> Outcome<&'a str> {
    for cause in causes.rows() {
        if cause.text("id")? == id {
            return cause.text("name");
        }
    }
    Err(format!("{}: {id:?} is not a cause of {CAUSES}", row.place()).into())
}

/// Every parameter that a text names exists: what an action in braces reads or writes, and each word of the form
/// `GROUP.NAME`.
fn check_names(row: &Row<'_>, text: &str, parameters: &[Known]) -> Outcome<()> {
    let mut named = Vec::new();
    for action in text.split('{').skip(1) {
        let (action, _) = action
            .split_once('}')
            .ok_or_else(|| format!("{}: a brace without end", row.place()))?;
        let mut words = action.split_whitespace();
        if matches!(words.next(), Some("read" | "write" | "describe")) {
            named.extend(words.map(|word| word.split_once('=').map_or(word, |(name, _)| name)));
        }
    }
    let upper = |text: &str| {
        let mut letters = text.chars();
        letters.next().is_some_and(|first| first.is_ascii_uppercase())
            && letters.all(|letter| letter.is_ascii_uppercase() || letter.is_ascii_digit())
    };
    let words = text.split(|letter: char| !(letter.is_ascii_alphanumeric() || letter == '.'));
    named.extend(words.filter(|word| {
        let parts = word.split_once('.');
        parts.is_some_and(|(group, name)| upper(group) && upper(name))
    }));
    for name in named {
        if !parameters.iter().any(|parameter| is_called(parameter, name)) {
            return Err(format!("{}: the model has no parameter {name:?}", row.place()).into());
        }
    }
    Ok(())
}

/// A parameter by its name, also without the `_32` of a value cut to 32 bits, its number, its group and index (`16-30`) or
/// its application id (`ID7`).
fn is_called(parameter: &Known, name: &str) -> bool {
    let number = |text: &str| text.parse::<u16>().ok();
    let by_index = || {
        let (group, index) = name.split_once('-')?;
        Some(100 * number(group)? + number(index)?)
    };
    if let Some(id) = name.strip_prefix("ID").and_then(number) {
        return parameter.base == Some(id);
    }
    parameter.name == name
        || parameter.name.strip_suffix("_32") == Some(name)
        || parameter.base.is_none() && number(name).or_else(by_index) == Some(parameter.pnu)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn causes_warnings_and_parameters_of_a_row_exist() {
        let causes = "id,name,verdict,about,advice\nsto,Sto,Held,a,b\nno-power,NoPower,Held,a,b\n";
        let causes = Table::parse("c", causes).unwrap();
        let parameter = |pnu, base, name: &str| Known {
            pnu,
            base,
            name: name.to_owned(),
            writable: true,
        };
        let parameters = [
            parameter(1630, None, "DC Link Voltage"),
            parameter(10001, Some(7), "x"),
            parameter(2403, None, "VBUS.VALUE"),
            parameter(2439, None, "VL.LIMITP_32"),
        ];
        let made = |row: &str| {
            let rows = Table::parse("r", &format!("kind,about,advice,source\n{row}\n")).unwrap();
            let mut tables = Tables::default();
            let added = tables.add("M", &rows, &causes, &parameters, &[68]);
            added.map(|()| tables.render()).map_err(|error| error.to_string())
        };
        let text = made("cause,no-power,{read 16-30 ID7 VL.LIMITP 1630} and VBUS.VALUE,s").unwrap();
        assert!(text.contains("(\"M\", Cause::NoPower, \"{read 16-30"), "{text}");
        let text = made("warning,68,sto no-power,s").unwrap();
        assert!(
            text.contains("(\"M\", 68, &[Cause::Sto, Cause::NoPower])"),
            "{text}"
        );
        assert!(made("disable,VBUS.VALUE,look,s").is_ok());
        for (row, problem) in [
            ("cause,nothing,look,s", "not a cause"),
            ("cause,sto,{read 16-31},s", "no parameter \"16-31\""),
            ("cause,sto,{write ID8=1},s", "no parameter \"ID8\""),
            ("cause,sto,see VBUS.VALU,s", "no parameter \"VBUS.VALU\""),
            ("cause,sto,{read 16-30,s", "brace"),
            ("cause,sto,look,", "no source"),
            ("warning,69,sto,s", "no warning 69"),
            ("warning,68,st,s", "not a cause"),
            ("disable,DRV.DIS,look,s", "no parameter \"DRV.DIS\""),
            ("other,sto,look,s", "kind"),
        ] {
            let error = made(row).unwrap_err();
            assert!(error.contains(problem), "{row}: {error}");
        }
    }
}

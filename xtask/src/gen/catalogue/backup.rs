//! What each parameter is to a tool that saves and restores: `backup.csv` of a model.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use crate::Outcome;
use crate::table::Table;

/// A parameter that rules can name.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Known {
    /// Its number.
    pub pnu: u16,
    /// Its subindex where it is an element of a collecting number.
    pub base: Option<u16>,
    /// Its name.
    pub name: String,
    /// True when it can be read and written.
    pub writable: bool,
}

/// Every parameter of a table.
pub fn known(parameters: &Table) -> Outcome<Vec<Known>> {
    parameters
        .rows()
        .map(|row| {
            Ok(Known {
                pnu: row.number("pnu")?,
                base: row.maybe_number("base")?,
                name: row.text("name")?.to_owned(),
                writable: row.text("access")? == "rw",
            })
        })
        .collect()
}

/// Returns the rules as Rust. The first row that names a parameter counts; a pattern names only what can be written.
pub fn render(rules: &Table, known: &[Known]) -> Outcome<String> {
    let mut found: BTreeMap<(u16, Option<u16>), String> = BTreeMap::new();
    for row in rules.rows() {
        let place = row.place();
        let pattern = row.text("pattern")?;
        let of = row.text("of")?;
        let role = match row.text("role")? {
            "setting" => "Role::Setting".to_owned(),
            "network" => "Role::Network".to_owned(),
            "setpoint" => "Role::Setpoint".to_owned(),
            "action" => "Role::Action".to_owned(),
            "window" => "Role::Window".to_owned(),
            "state" => "Role::State".to_owned(),
            "save" => "Role::Save".to_owned(),
            "clear-faults" => "Role::ClearFaults".to_owned(),
            "active" => "Role::Active".to_owned(),
            // of two parameters with one name, the one of the drive's own range
            "alias" => known
                .iter()
                .rev()
                .find(|other| other.base.is_none() && other.name == of)
                .map(|other| format!("Role::Alias {{ of: {} }}", other.pnu))
                .ok_or_else(|| format!("{place}: there is no {of:?}"))?,
            other => return Err(format!("{place}: role {other:?}").into()),
        };
        let phase = match row.text("phase")? {
            "scaling" => "Scaling",
            "mode" => "Mode",
            "motor" => "Motor",
            "limit" => "Limit",
            "" => "Value",
            "enable" => "Enable",
            other => return Err(format!("{place}: phase {other:?}").into()),
        };
        let before = found.len();
        for parameter in known.iter().filter(|one| names(pattern, one)) {
            found.entry((parameter.pnu, parameter.base)).or_insert(format!(
                "    BackupRule {{ pnu: {}, base: {:?}, role: {role}, phase: Phase::{phase}, why: {:?} }},",
                parameter.pnu,
                parameter.base,
                row.text("why")?
            ));
        }
        if found.len() == before {
            return Err(format!("{place}: {pattern:?} names nothing that no row before it names").into());
        }
    }
    let mut text = String::from(
        "use crate::catalogue::{BackupRule, Phase, Role};\n\n\
         #[rustfmt::skip]\npub static BACKUP: &[BackupRule] = &[\n",
    );
    for rule in found.values() {
        writeln!(text, "{rule}")?;
    }
    text.push_str("];\n");
    Ok(text)
}

/// Returns true when the pattern is the number (`p922`), the application id (`id103`), the name, or a name with `*` for
/// any part and the parameter can be written.
pub fn names(pattern: &str, parameter: &Known) -> bool {
    if let Some(pnu) = pattern
        .strip_prefix('p')
        .and_then(|number| number.parse::<u16>().ok())
    {
        return pnu == parameter.pnu && parameter.base.is_none();
    }
    if let Some(id) = pattern
        .strip_prefix("id")
        .and_then(|number| number.parse::<u16>().ok())
    {
        return Some(id) == parameter.base;
    }
    pattern == parameter.name
        || (parameter.writable && pattern.contains('*') && fits(pattern, &parameter.name))
}

fn fits(pattern: &str, text: &str) -> bool {
    match pattern.split_once('*') {
        None => pattern == text,
        Some((start, rest)) => text.strip_prefix(start).is_some_and(|tail| {
            (0..=tail.len()).any(|skip| tail.get(skip..).is_some_and(|end| fits(rest, end)))
        }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parameters() -> Vec<Known> {
        known(
            &Table::parse(
                "p",
                "pnu,name,access\n922,Telegram,rw\n2000,A.EN,rw\n2001,A.FB,ro\n2002,B.EN,rw\n",
            )
            .unwrap(),
        )
        .unwrap()
    }

    #[test]
    fn the_first_row_counts_and_patterns_leave_out_what_is_read_only() {
        let rules = "pattern,role,phase,of,why\nA.EN,alias,,B.EN,\nA.FB,active,,,\np922,network,,,w\n*.EN,setting,enable,,\n";
        let text = render(&Table::parse("r", rules).unwrap(), &parameters()).unwrap();
        let lines: Vec<&str> = text.lines().skip(4).map(str::trim).collect();
        assert_eq!(
            lines,
            [
                "BackupRule { pnu: 922, base: None, role: Role::Network, phase: Phase::Value, why: \"w\" },",
                "BackupRule { pnu: 2000, base: None, role: Role::Alias { of: 2002 }, phase: Phase::Value, why: \"\" },",
                "BackupRule { pnu: 2001, base: None, role: Role::Active, phase: Phase::Value, why: \"\" },",
                "BackupRule { pnu: 2002, base: None, role: Role::Setting, phase: Phase::Enable, why: \"\" },",
                "];",
            ]
        );
    }

    #[test]
    fn an_application_id_is_no_number_of_its_own() {
        let rows = "pnu,base,name,access\n103,,A,rw\n10001,103,B,rw\n10001,104,C,rw\n";
        let known = known(&Table::parse("p", rows).unwrap()).unwrap();
        let rules = "pattern,role,phase,of,why\nid103,network,,,\np103,state,,,\n";
        let text = render(&Table::parse("r", rules).unwrap(), &known).unwrap();
        assert!(text.contains("pnu: 103, base: None, role: Role::State"), "{text}");
        assert!(
            text.contains("pnu: 10001, base: Some(103), role: Role::Network"),
            "{text}"
        );
        assert!(!text.contains("Some(104)"), "{text}");
    }

    #[test]
    fn a_row_that_names_nothing_is_a_mistake() {
        for rules in [
            "C.*,setting,,,",
            "A.*,alias,,C,",
            "A.*,setting,soon,,",
            "A.*,toy,,,",
        ] {
            let table = Table::parse("r", &format!("pattern,role,phase,of,why\n{rules}\n")).unwrap();
            assert!(render(&table, &parameters()).is_err(), "{rules}");
        }
    }
}

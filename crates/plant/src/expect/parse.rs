//! Expectations as TOML.

use std::ops::Range;
use std::time::Duration;

use profile::catalogue::{Parameter, Scaling};
use profile::notation::wildcard_fits;
use profile::value::Parameters;
use toml::Spanned;
use toml::de::{DeTable, DeValue};
use virtual_drive::drive::Drive;

use super::condition::{Bounds, Condition, Flag, Quantity, Source, Test};
use super::expectation::{After, Expectation, Rule, Target};
use super::goal::Goal;
use super::value::{
    Value, duration, entries, get, number, numbers, states, table, text, tolerance, word, wrong,
};
use crate::located::{Located, PlantError, line_of};
use crate::plan::DrivePlan;
use crate::text::time;

/// Most expectations of one list, and most pairs of an expectation and a drive.
const MOST: usize = 10_000;

/// Longest text, in octets.
const LONGEST: usize = 1 << 20;

/// The drives that an expectation may name.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Scope<'a> {
    pub drives: &'a [DrivePlan],
}

/// Keys of conditions, beside quantities and flags.
const CONDITIONS: [&str; 7] = ["state", "fault", "warning", "zsw1", "stw1", "load", "parameter"];

/// Reads a text: a file with the key `expect`, or one inline table.
pub(crate) fn read_all(text: &str, scope: Scope<'_>) -> Result<Vec<Expectation>, PlantError> {
    if text.len() > LONGEST {
        return Err(PlantError {
            line: 1,
            message: format!("the text is longer than {LONGEST} octets"),
        });
    }
    let inline = text.trim_start().starts_with('{');
    let text = if inline {
        format!("expect = [{text}\n]")
    } else {
        text.to_owned()
    };
    let table = DeTable::parse(&text).map_err(|error| PlantError {
        line: line_of(&text, error.span().map_or(0, |span| span.start)),
        message: error.message().to_owned(),
    })?;
    let mut found = Vec::new();
    for (key, value) in table.get_ref() {
        if key.get_ref() != "expect" {
            return Err(PlantError {
                line: line_of(&text, key.span().start),
                message: format!("unknown key `{}`, expected `expect`", key.get_ref()),
            });
        }
        found = read_list(value, scope, &text).map_err(|Located(span, message)| PlantError {
            line: line_of(&text, span.start),
            message,
        })?;
    }
    Ok(found)
}

/// Reads the conditions of a run that waits for them, one inline table.
pub(crate) fn read_goal(text: &str, scope: Scope<'_>) -> Result<Goal, PlantError> {
    let error = |message: String| PlantError { line: 1, message };
    if text.len() > LONGEST {
        return Err(error(format!("the text is longer than {LONGEST} octets")));
    }
    let whole = format!("goal = {text}");
    let wrong_text = |Located(span, message): Located| PlantError {
        line: line_of(&whole, span.start),
        message,
    };
    let parsed = DeTable::parse(&whole).map_err(|wrong| error(wrong.message().to_owned()))?;
    let mut entries_of_text = parsed.get_ref().iter();
    let (Some((_, value)), None) = (entries_of_text.next(), entries_of_text.next()) else {
        return Err(error("a goal is one table: { drive = .., CONDITION .. }".into()));
    };
    let table = table(value).map_err(wrong_text)?;
    check_keys(table, &["drive", "for"]).map_err(wrong_text)?;
    let rule = Rule::At(Duration::ZERO);
    let expectation = conditions(table, &value.span(), scope, rule).map_err(wrong_text)?;
    let several = || error("this concerns one drive: name it with `drive`".into());
    Goal::of(Expectation {
        name: "goal".into(),
        line: 1,
        ..expectation
    })
    .ok_or_else(several)
}

/// Reads the value of the key `expect`.
pub(crate) fn read_list(
    value: &Value<'_>,
    scope: Scope<'_>,
    text: &str,
) -> Result<Vec<Expectation>, Located> {
    let DeValue::Array(list) = value.get_ref() else {
        return Err(wrong(
            value,
            "expectations are a list of tables, [{ .. }, { .. }]",
        ));
    };
    let mut found: Vec<Expectation> = Vec::new();
    let mut checks = 0;
    for value in list {
        let table = table(value)?;
        let expectation = read(table, &value.span(), scope, text, found.len() + 1)?;
        checks += expectation.targets.len();
        if checks > MOST {
            return Err(wrong(
                value,
                &format!("more than {MOST} pairs of an expectation and a drive"),
            ));
        }
        if found.iter().any(|other| other.name == expectation.name) {
            return Err(wrong(
                value,
                &format!("the name `{}` stands there twice", expectation.name),
            ));
        }
        found.push(expectation);
    }
    Ok(found)
}

/// Fails for a key that is neither one of `own` nor that of a condition.
fn check_keys(table: &DeTable<'_>, own: &[&'static str]) -> Result<(), Located> {
    for key in table.keys() {
        let key_text: &str = key.get_ref();
        let known = condition_keys().chain(own.iter().copied());
        if !known.clone().any(|known| known == key_text) {
            let list: Vec<_> = known.map(|key| format!("`{key}`")).collect();
            return Err(Located(
                key.span(),
                format!("unknown key `{key_text}`, expected one of {}", list.join(", ")),
            ));
        }
    }
    Ok(())
}

/// Keys of conditions and the one of their tolerance.
fn condition_keys() -> impl Iterator<Item = &'static str> + Clone {
    let quantities = Quantity::ALL.into_iter().map(|(_, key)| key);
    let quantities = quantities.filter(|key| !key.starts_with("load."));
    let flags = Flag::ALL.into_iter().map(|(_, key)| key);
    CONDITIONS
        .into_iter()
        .chain(flags)
        .chain(quantities)
        .chain(["tolerance"])
}

fn read(
    table: &DeTable<'_>,
    span: &Range<usize>,
    scope: Scope<'_>,
    whole: &str,
    number: usize,
) -> Result<Expectation, Located> {
    check_keys(
        table,
        &["name", "at", "within", "after", "always", "never", "drive", "for"],
    )?;
    let rule = rule(table, span, scope)?;
    let name = match get(table, "name") {
        Some(value) => text(value)?.to_owned(),
        None => format!("expectation {number}"),
    };
    Ok(Expectation {
        name,
        line: line_of(whole, span.start),
        ..conditions(table, span, scope, rule)?
    })
}

/// Reads what each expectation has, beside its name and its place.
fn conditions(
    table: &DeTable<'_>,
    span: &Range<usize>,
    scope: Scope<'_>,
    rule: Rule,
) -> Result<Expectation, Located> {
    let lasts = match get(table, "for") {
        Some(value) if matches!(rule, Rule::Whole { .. }) => {
            return Err(wrong(
                value,
                "`for` belongs to `at` and `within`; `always` and `never` have a range",
            ));
        }
        value => value.map(duration).transpose()?.unwrap_or_default(),
    };
    let drives = match get(table, "drive") {
        None => (0..scope.drives.len()).collect(),
        Some(value) => drives(value, scope)?,
    };
    Ok(Expectation {
        file: None,
        name: String::new(),
        line: 1,
        rule,
        lasts,
        targets: targets(table, span, scope, &drives)?,
        source: entries(table, "name").join(", "),
    })
}

fn rule(table: &DeTable<'_>, span: &Range<usize>, scope: Scope<'_>) -> Result<Rule, Located> {
    let after = get(table, "after");
    let kinds = ["at", "within", "always", "never"];
    let mut given = kinds
        .into_iter()
        .filter_map(|kind| Some((kind, get(table, kind)?)));
    let (Some((kind, value)), None) = (given.next(), given.next()) else {
        return Err(Located(
            span.clone(),
            "an expectation has exactly one of `at`, `within`, `always` and `never`".into(),
        ));
    };
    if let Some(after) = after.filter(|_| kind != "within") {
        return Err(wrong(after, "`after` belongs to `within`"));
    }
    Ok(match kind {
        "at" => Rule::At(duration(value)?),
        "within" => Rule::Within {
            span: duration(value)?,
            after: after.map_or(Ok(After::Time(Duration::ZERO)), |after| read_after(after, scope))?,
        },
        _ => {
            let (from, to) = range(value)?;
            Rule::Whole {
                holds: kind == "always",
                from,
                to,
            }
        }
    })
}

fn read_after(value: &Value<'_>, scope: Scope<'_>) -> Result<After, Located> {
    let DeValue::Table(table) = value.get_ref() else {
        return Ok(After::Time(duration(value)?));
    };
    check_keys(table, &["drive"])?;
    let drive =
        get(table, "drive").ok_or_else(|| wrong(value, "`after` with conditions names its `drive`"))?;
    let drives = drives(drive, scope)?;
    Ok(After::Condition(targets(table, &value.span(), scope, &drives)?))
}

const RANGE: &str = "a range of time is \"2s..5s\", \"2s..\", \"..5s\" or true";

/// `"2s..5s"`, `"2s.."`, `"..5s"` or true.
fn range(value: &Value<'_>) -> Result<(Duration, Option<Duration>), Located> {
    if matches!(value.get_ref(), DeValue::Boolean(true)) {
        return Ok((Duration::ZERO, None));
    }
    let DeValue::String(written) = value.get_ref() else {
        return Err(wrong(value, RANGE));
    };
    range_of(written).map_err(|message| wrong(value, &message))
}

/// `2s..5s`, `2s..` or `..5s`.
pub(super) fn range_of(written: &str) -> Result<(Duration, Option<Duration>), String> {
    let form = || RANGE.to_owned();
    let (from, to) = written.split_once("..").ok_or_else(form)?;
    let end = |text: &str| {
        let text = text.trim();
        (!text.is_empty()).then(|| time(text)).transpose()
    };
    let (from, to) = (end(from)?, end(to)?);
    if from.is_none() && to.is_none() || to.is_some_and(|to| to < from.unwrap_or_default()) {
        return Err(form());
    }
    Ok((from.unwrap_or_default(), to))
}

/// Returns the numbers of the drives that a name, a pattern or a list of them means.
fn drives(value: &Value<'_>, scope: Scope<'_>) -> Result<Vec<usize>, Located> {
    let one = std::slice::from_ref(value);
    let list: &[Value<'_>] = match value.get_ref() {
        DeValue::Array(list) if !list.is_empty() => list,
        DeValue::Array(_) => return Err(wrong(value, "a list of drives has at least one")),
        _ => one,
    };
    let mut chosen = Vec::new();
    for pattern in list {
        let wanted = text(pattern)?;
        let before = chosen.len();
        let mut fits = false;
        for (number, drive) in scope.drives.iter().enumerate() {
            if wildcard_fits(wanted, &drive.name) {
                fits = true;
                if !chosen.contains(&number) {
                    chosen.push(number);
                }
            }
        }
        if !fits && before == chosen.len() {
            let names: Vec<_> = scope
                .drives
                .iter()
                .take(16)
                .map(|drive| drive.name.as_str())
                .collect();
            return Err(wrong(
                pattern,
                &format!(
                    "no drive `{wanted}` in this plant; there are: {}",
                    names.join(", ")
                ),
            ));
        }
    }
    chosen.sort_unstable();
    Ok(chosen)
}

/// Reads the conditions of a table for each of the drives.
fn targets(
    table: &DeTable<'_>,
    span: &Range<usize>,
    scope: Scope<'_>,
    drives: &[usize],
) -> Result<Vec<Target>, Located> {
    let tolerance = get(table, "tolerance");
    let mut written_order: Vec<_> = table.iter().collect();
    written_order.sort_by_key(|(key, _)| key.span().start);
    let mut reader = Reader {
        tolerance,
        tolerance_used: false,
    };
    let mut targets = Vec::new();
    for &number in drives {
        let Some(drive) = scope.drives.get(number) else {
            continue;
        };
        let mut conditions = Vec::new();
        for (key, value) in &written_order {
            reader.condition(key.get_ref(), value, drive, &mut conditions)?;
        }
        if conditions.is_empty() {
            return Err(Located(
                span.clone(),
                "no condition: write what must hold, such as state = \"S4\" or speed = \"118rpm..122rpm\""
                    .into(),
            ));
        }
        targets.push(Target {
            drive: number,
            conditions,
        });
    }
    match tolerance {
        Some(value) if !reader.tolerance_used => Err(wrong(
            value,
            "`tolerance` belongs to a quantity with a single value",
        )),
        _ => Ok(targets),
    }
}

/// Reads the conditions of one table.
struct Reader<'a, 'b> {
    tolerance: Option<&'b Value<'a>>,
    tolerance_used: bool,
}

impl Reader<'_, '_> {
    fn condition(
        &mut self,
        key: &str,
        value: &Value<'_>,
        drive: &DrivePlan,
        conditions: &mut Vec<Condition>,
    ) -> Result<(), Located> {
        let test = match key {
            "state" => Test::State(states(value)?),
            "fault" | "warning" => Test::Messages {
                warnings: key == "warning",
                numbers: numbers(value, key == "warning", drive)?,
            },
            "zsw1" | "stw1" => word(value, key == "zsw1")?,
            "load" => {
                for (inner, value) in table(value)? {
                    let name = format!("load.{}", inner.get_ref());
                    let quantity = Quantity::ALL.into_iter().find(|(_, key)| *key == name);
                    let (quantity, _) = quantity.ok_or_else(|| {
                        Located(
                            inner.span(),
                            format!("unknown key `{name}`, expected `load.speed` or `load.position`"),
                        )
                    })?;
                    conditions.push(self.quantity(&name, value, quantity)?);
                }
                return Ok(());
            }
            "parameter" => {
                for (name, value) in table(value)? {
                    conditions.push(self.parameter(name, value, drive)?);
                }
                return Ok(());
            }
            _ => {
                let flag = Flag::ALL.into_iter().find(|(_, name)| *name == key);
                let quantity = Quantity::ALL.into_iter().find(|(_, name)| *name == key);
                match (flag, quantity) {
                    (Some((flag, _)), _) => match value.get_ref() {
                        DeValue::Boolean(wanted) => Test::Flag(flag, *wanted),
                        _ => return Err(wrong(value, &format!("`{key}` is true or false"))),
                    },
                    (_, Some((quantity, _))) => {
                        conditions.push(self.quantity(key, value, quantity)?);
                        return Ok(());
                    }
                    // not a condition: a time, a name, a drive
                    _ => return Ok(()),
                }
            }
        };
        conditions.push(Condition {
            key: key.to_owned(),
            test,
        });
        Ok(())
    }

    fn quantity(&mut self, key: &str, value: &Value<'_>, quantity: Quantity) -> Result<Condition, Located> {
        let unit = quantity.unit();
        let test = Test::Number {
            source: Source::Quantity(quantity),
            unit,
            bounds: self.bounds(key, value, unit, false)?,
        };
        Ok(Condition {
            key: key.to_owned(),
            test,
        })
    }

    fn parameter(
        &mut self,
        name: &Spanned<std::borrow::Cow<'_, str>>,
        value: &Value<'_>,
        drive: &DrivePlan,
    ) -> Result<Condition, Located> {
        let at = |message: String| Located(name.span(), message);
        if matches!(value.get_ref(), DeValue::Table(_)) {
            return Err(at(
                "the name of a parameter stands in quotation marks: { \"DRV.ACC\" = \"..\" }".into(),
            ));
        }
        let scaling = Scaling::default();
        let table = Parameters {
            catalogue: Some(drive.model.catalogue),
            scaling,
        };
        let reference = name.get_ref().parse().map_err(|error| at(format!("{error}")))?;
        let selection = table.select(&reference).map_err(|problem| {
            let hint = problem.hint().map_or(String::new(), |hint| format!(" ({hint})"));
            at(format!("{}: {problem}{hint}", drive.name))
        })?;
        let element = selection
            .parameter
            .map_or(0, |row| selection.first.saturating_sub(row.subindex(0)));
        let readable = |row: &&'static Parameter| Drive::new(drive.model).reported(row, element).is_some();
        let row = selection.parameter.filter(|row| !row.is_text()).filter(readable);
        let row = row.ok_or_else(|| {
            at(format!(
                "{}: `{}` is not a number that can be read",
                drive.name,
                name.get_ref()
            ))
        })?;
        let unit = row.unit_in(&scaling);
        let whole = unit.is_empty() && row.engineering(1, &scaling) == 1.0;
        let key = name.get_ref().clone().into_owned();
        let bounds = self.bounds(&key, value, unit, whole)?;
        let source = Source::Parameter(row, element);
        Ok(Condition {
            key,
            test: Test::Number { source, unit, bounds },
        })
    }

    /// Reads where a number must be; a single value needs a tolerance, unless the number is `whole`.
    fn bounds(&mut self, key: &str, value: &Value<'_>, unit: &str, whole: bool) -> Result<Bounds, Located> {
        let bare;
        let written = match value.get_ref() {
            DeValue::String(text) => &**text,
            DeValue::Integer(number) => {
                bare = number.to_string();
                &bare
            }
            DeValue::Float(number) => {
                bare = number.to_string();
                &bare
            }
            _ => return Err(wrong(value, "a value is a text with its unit")),
        };
        let number =
            |text: &str| number(text, unit).map_err(|message| wrong(value, &format!("{key}: {message}")));
        let open = |low, high| Bounds { low, high };
        let free = (f64::NEG_INFINITY, f64::INFINITY);
        for (sign, inside, below) in [
            ("<=", true, true),
            (">=", true, false),
            ("<", false, true),
            (">", false, false),
        ] {
            if let Some(rest) = written.trim_start().strip_prefix(sign) {
                let limit = (number(rest)?, inside);
                return Ok(if below {
                    open((free.0, true), limit)
                } else {
                    open(limit, (free.1, true))
                });
            }
        }
        if let Some((low, high)) = written.split_once("..") {
            let (low, high) = (number(low)?, number(high)?);
            if low > high {
                return Err(wrong(
                    value,
                    &format!("{key}: the range `{written}` begins behind its end"),
                ));
            }
            return Ok(open((low, true), (high, true)));
        }
        let target = number(written)?;
        let tolerance = match self.tolerance {
            Some(given) => {
                self.tolerance_used = true;
                tolerance(given, target, unit)?
            }
            None if whole => 0.0,
            None => {
                return Err(wrong(
                    value,
                    &format!(
                        "{key}: a measured value is never met exactly; add `tolerance`, or write a range (\"118rpm..122rpm\") or a limit (\"<=125rpm\")"
                    ),
                ));
            }
        };
        Ok(open((target - tolerance, true), (target + tolerance, true)))
    }
}

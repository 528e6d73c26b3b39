//! The text of a plant, and changes of it.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::str::FromStr;
use std::time::Duration;

use toml_edit::{Array, DocumentMut, InlineTable, Item, TableLike, Value};
use virtual_drive::model;

use crate::event::PlantEvent;
use crate::file::{PlantFileError, read_text};
use crate::located::PlantError;
use crate::plan::PlantPlan;

/// Longest path of a change, in octets.
const LONGEST_PATH: usize = 256;

/// Most drives of a plant that is made of models.
const MOST_DRIVES: usize = 1000;

/// Tables whose keys are names of others, which may have dots in them.
const OF_NAMES: [&str; 2] = ["parameters", "send"];

/// A plant with the text that it was read from, which can be changed and written.
///
/// ```
/// use profidrive_plant::PlantSource;
/// let press: PlantSource = "[[drive]]\nname = \"press-1\" # the large one".parse()?;
/// let stiff = press.with_changes([("drive.press-1.load.friction", 0.4.into())])?;
/// assert_eq!(stiff.plan().drives[0].plant.coulomb_friction, 0.4);
/// assert!(stiff.as_toml().contains("# the large one"));
/// let error = press.with_changes([("drive.press-2.load.friction", 0.4.into())]).unwrap_err();
/// assert_eq!(error.to_string(), "drive.press-2.load.friction: no `press-2`; there are: press-1");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct PlantSource {
    text: String,
    /// The file that it was read from.
    file: Option<PathBuf>,
    plan: PlantPlan,
}

/// A change of a plant that cannot be made.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{path}: {why}")]
pub struct ChangeError {
    /// The path of the change; of several when only all of them together can be wrong.
    pub path: String,
    /// What is wrong with the path or the value.
    pub why: String,
}

/// Something that happened to a drive of a plant.
#[derive(Debug, Clone, PartialEq)]
pub struct Happened {
    /// The name of the drive.
    pub drive: String,
    /// Time of the plant.
    pub at: Duration,
    /// What happened.
    pub event: PlantEvent,
    /// After which time it ended; `None` where it has no end, or was to last.
    pub lasts: Option<Duration>,
}

/// Models of which no plant can be made.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum ModelsError {
    /// No model was given.
    #[error("a plant has at least one drive: give a model, such as akd")]
    None,
    /// There is no such model.
    #[error("no model `{0}`; there are: {models}", models = models())]
    Unknown(String),
    /// More drives than a plant of models has.
    #[error("a plant of models has at most {MOST_DRIVES} drives")]
    TooMany,
}

fn models() -> String {
    model::ALL.map(|model| model.known.key).join(", ")
}

impl PlantSource {
    /// Reads a plant file.
    ///
    /// # Errors
    /// When it cannot be read, or when something in it is not valid.
    pub fn read(path: &Path) -> Result<Self, PlantFileError> {
        let text = read_text(path)?;
        Ok(Self {
            plan: PlantPlan::of_text(&text, Some(path)).map_err(|error| PlantFileError::PlantPlan {
                path: path.to_owned(),
                error,
            })?,
            text,
            file: Some(path.to_owned()),
        })
    }

    /// Returns a plant of drives of these models as they are delivered: `akd`, `vlt` and `akd` are the drives `akd-1`, `vlt-1` and
    /// `akd-2`, each with an IP address.
    ///
    /// ```
    /// let plant = profidrive_plant::PlantSource::of(["akd", "vlt", "akd"])?;
    /// let names: Vec<_> = plant.plan().drives.iter().map(|drive| drive.name.as_str()).collect();
    /// assert_eq!(names, ["akd-1", "vlt-1", "akd-2"]);
    /// # Ok::<(), profidrive_plant::ModelsError>(())
    /// ```
    ///
    /// # Errors
    /// For no model at all, one that does not exist, and more drives than a plant of models has.
    pub fn of<'a>(models: impl IntoIterator<Item = &'a str>) -> Result<Self, ModelsError> {
        let mut text = String::new();
        let mut numbers: BTreeMap<&str, usize> = BTreeMap::new();
        for (place, key) in models.into_iter().enumerate() {
            let model = model::by_name(key).ok_or_else(|| ModelsError::Unknown(key.to_owned()))?;
            let key = model.known.key;
            if place == MOST_DRIVES {
                return Err(ModelsError::TooMany);
            }
            let number = numbers.entry(key).or_default();
            *number += 1;
            let [.., high, low] = (place + 11).to_be_bytes();
            text.push_str(&format!(
                "[[drive]]\nname = \"{key}-{number}\"\nmodel = \"{key}\"\nip = \"192.168.{high}.{low}/16\"\n\n"
            ));
        }
        // names and addresses differ and the models exist
        text.parse().map_err(|_| ModelsError::None)
    }

    /// Returns the plant.
    #[must_use]
    pub const fn plan(&self) -> &PlantPlan {
        &self.plan
    }

    /// Returns the text of a plant file of this plant.
    #[must_use]
    pub fn as_toml(&self) -> &str {
        &self.text
    }

    /// Returns the plant with other values at these paths, all of them at once. Comments of the file stay.
    ///
    /// A path has the keys of the plant file with dots between: `seed`, `drive.press-1.load.friction`,
    /// `drive.press-1.parameters.DRV.ACC`, `controller.press-1.step.2.at`, `expect.reaches speed.within`. Entries of a list
    /// are meant by their `name`, or by their `drive`, or by their number from 1. A key that the plant file may have but
    /// has not is added.
    ///
    /// # Errors
    /// For a path that leads nowhere, and for a value that does not fit, with the path.
    pub fn with_changes<'a>(
        &self,
        changes: impl IntoIterator<Item = (&'a str, toml::Value)>,
    ) -> Result<Self, ChangeError> {
        let error = |path: &str, why: String| ChangeError {
            path: path.to_owned(),
            why,
        };
        let mut document = self.document().map_err(|why| error("", why))?;
        let mut paths = Vec::new();
        for (path, value) in changes {
            change(&mut document, path, &value).map_err(|why| error(path, why))?;
            paths.push(path);
        }
        // the line of a mistake is one of a text that the caller has not seen
        let made = self.of_document(&document);
        made.map_err(|PlantError { message, .. }| error(&paths.join(", "), message))
    }

    /// Returns the plant with further events, each at the end of those that its drive has in the text. So what happened to the
    /// drives of a plant that runs becomes a plant file in which it happens again.
    ///
    /// ```
    /// use std::time::Duration;
    /// use profidrive_plant::{Happened, PlantSource};
    /// let press: PlantSource = "[[drive]]\nname = \"press-1\" # the large one".parse()?;
    /// let pulled = Happened {
    ///     drive: "press-1".into(),
    ///     at: Duration::from_millis(2500),
    ///     event: "cable=pulled".parse()?,
    ///     lasts: Some(Duration::from_secs(1)),
    /// };
    /// let again = press.with_events([&pulled])?;
    /// assert!(again.as_toml().contains(r#"{ at = "2.5s", do = "cable=pulled", for = "1s" }"#));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// For more events than a plant file may have, and a drive that it does not have.
    pub fn with_events<'a>(
        &self,
        events: impl IntoIterator<Item = &'a Happened>,
    ) -> Result<Self, PlantError> {
        let mut missing = None;
        let made = self.edited(|document| {
            for happened in events {
                if !add_event(document, happened) {
                    missing = Some(happened.drive.clone());
                }
            }
        })?;
        match missing {
            Some(drive) => Err(PlantError {
                line: 1,
                message: format!("no drive `{drive}` with a list of events"),
            }),
            None => Ok(made),
        }
    }

    /// Returns the plant with a text that was edited.
    pub(crate) fn edited(&self, edit: impl FnOnce(&mut DocumentMut)) -> Result<Self, PlantError> {
        let mut document = self
            .document()
            .map_err(|message| PlantError { line: 1, message })?;
        edit(&mut document);
        self.of_document(&document)
    }

    fn document(&self) -> Result<DocumentMut, String> {
        self.text.parse().map_err(message)
    }

    fn of_document(&self, document: &DocumentMut) -> Result<Self, PlantError> {
        let text = document.to_string();
        Ok(Self {
            plan: PlantPlan::of_text(&text, self.file.as_deref())?,
            text,
            file: self.file.clone(),
        })
    }
}

/// Adds an event to its drive. False when the text has no such drive.
fn add_event(document: &mut DocumentMut, happened: &Happened) -> bool {
    let drives = document.get_mut("drive").and_then(Item::as_array_of_tables_mut);
    let named = |table: &&mut toml_edit::Table| {
        table.get("name").and_then(Item::as_str) == Some(happened.drive.as_str())
    };
    let Some(drive) = drives.and_then(|drives| drives.iter_mut().find(named)) else {
        return false;
    };
    let seconds = |time: Duration| format!("{}s", time.as_secs_f64());
    let mut values = vec![("at", seconds(happened.at)), ("do", happened.event.to_string())];
    values.extend(happened.lasts.map(|lasts| ("for", seconds(lasts))));
    match drive
        .entry("event")
        .or_insert(Item::Value(Value::Array(Array::new())))
    {
        Item::Value(Value::Array(list)) => list.push(InlineTable::from_iter(values)),
        Item::ArrayOfTables(list) => {
            let rows = values
                .into_iter()
                .map(|(key, text)| (key, toml_edit::value(text)));
            list.push(rows.collect());
        }
        _ => return false,
    }
    true
}

fn change(document: &mut DocumentMut, path: &str, value: &toml::Value) -> Result<(), String> {
    if path.len() > LONGEST_PATH {
        return Err(format!("a path has at most {LONGEST_PATH} octets"));
    }
    if path.split('.').any(str::is_empty) {
        return Err("a path is keys with dots between, such as drive.press-1.load.friction".into());
    }
    let value: Value = value.to_string().parse().map_err(message)?;
    set_in_table(document.as_table_mut(), path, "", value)
}

fn message(error: toml_edit::TomlError) -> String {
    error.message().to_owned()
}

/// Sets the value at a path that begins in a table; `own` is the key of the table itself.
fn set_in_table(table: &mut dyn TableLike, path: &str, own: &str, value: Value) -> Result<(), String> {
    let keys = table.iter().map(|(key, _)| key);
    if let Some((key, rest)) = longest(keys, path) {
        let (key, rest) = (key.to_owned(), rest.to_owned());
        let item = table.get_mut(&key).ok_or("no such key")?;
        return set_in_item(item, &rest, &key, value);
    }
    match path.split_once('.').filter(|_| !OF_NAMES.contains(&own)) {
        None => table.insert(path, Item::Value(value)),
        Some((key, rest)) => {
            let mut inner = InlineTable::new();
            set_in_table(&mut inner, rest, key, value)?;
            table.insert(key, Item::Value(inner.into()))
        }
    };
    Ok(())
}

fn set_in_item(item: &mut Item, path: &str, own: &str, value: Value) -> Result<(), String> {
    match item {
        Item::Value(found) => set_in_value(found, path, own, value),
        _ if path.is_empty() => Err("a table or a list; a path ends at one value".into()),
        Item::ArrayOfTables(list) => {
            let (number, rest) = entry(&list.iter().map(|table| name_of(table)).collect::<Vec<_>>(), path)?;
            let found = list.get_mut(number).ok_or("no such entry")?;
            if rest.is_empty() {
                return Err("a table; a path ends at one value".into());
            }
            set_in_table(found, rest, own, value)
        }
        Item::Table(table) => set_in_table(table, path, own, value),
        Item::None => Err("nothing is there".into()),
    }
}

fn set_in_value(found: &mut Value, path: &str, own: &str, mut value: Value) -> Result<(), String> {
    if path.is_empty() {
        // comments and blanks around it
        *value.decor_mut() = found.decor().clone();
        *found = value;
        return Ok(());
    }
    match found {
        Value::InlineTable(table) => set_in_table(table, path, own, value),
        Value::Array(list) => {
            let names: Vec<_> = list
                .iter()
                .map(|entry| name_of(entry.as_inline_table()?))
                .collect();
            let (number, rest) = entry(&names, path)?;
            let found = list.get_mut(number).ok_or("no such entry")?;
            set_in_value(found, rest, own, value)
        }
        _ => Err(format!("`{own}` is one value and has no `{path}`")),
    }
}

/// Returns the number of the entry of a list that a path begins with, and the rest of the path.
fn entry<'p>(names: &[Option<&str>], path: &'p str) -> Result<(usize, &'p str), String> {
    if let Some((name, rest)) = longest(names.iter().copied().flatten(), path)
        && let Some(number) = names.iter().position(|other| *other == Some(name))
    {
        return Ok((number, rest));
    }
    let (first, rest) = path.split_once('.').unwrap_or((path, ""));
    let all = names.len();
    let number: Option<usize> = first.parse().ok().filter(|number| (1..=all).contains(number));
    let unknown = || {
        let names: Vec<_> = names.iter().copied().flatten().take(16).collect();
        if names.is_empty() {
            format!("no `{first}`; the entries are 1 to {all}")
        } else {
            format!("no `{first}`; there are: {}", names.join(", "))
        }
    };
    Ok((number.ok_or_else(unknown)? - 1, rest))
}

/// Returns the name of an entry of a list, or the drive that it belongs to.
fn name_of(table: &dyn TableLike) -> Option<&str> {
    let name = table.get("name").or_else(|| table.get("drive"));
    name.and_then(Item::as_str)
}

/// Returns the longest of the names that a path begins with, and what is behind it.
fn longest<'a, 'p>(names: impl Iterator<Item = &'a str>, path: &'p str) -> Option<(&'a str, &'p str)> {
    let fits = names.filter_map(|name| {
        let rest = path.strip_prefix(name)?;
        let rest = if rest.is_empty() {
            rest
        } else {
            rest.strip_prefix('.')?
        };
        Some((name, rest))
    });
    fits.max_by_key(|(name, _)| name.len())
}

impl FromStr for PlantSource {
    type Err = PlantError;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        Ok(Self {
            plan: text.parse()?,
            text: text.to_owned(),
            file: None,
        })
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use std::time::Duration;

    use proptest::prelude::*;
    use toml::Value;

    use super::*;
    use crate::plan::Trigger;

    const PRESS: &str = include_str!("../../../examples/plants/press.toml");

    fn press() -> PlantSource {
        PRESS.parse().unwrap()
    }

    fn changed(path: &str, value: impl Into<Value>) -> Result<PlantPlan, ChangeError> {
        press()
            .with_changes([(path, value.into())])
            .map(|changed| changed.plan().clone())
    }

    #[test]
    fn each_kind_of_path_reaches_its_value() {
        assert_eq!(changed("seed", 8).unwrap().seed, 8);
        let friction = changed("drive.press-1.load.friction", 0.25).unwrap();
        assert_eq!(friction.drives[0].plant.coulomb_friction, 0.25);
        // the feeder has neither yet
        let friction = changed("drive.feeder-1.load.friction", 0.25).unwrap();
        assert_eq!(friction.drives[1].plant.coulomb_friction, 0.25);
        let both = [
            ("drive.feeder-1.model", "vlt".into()),
            ("controller.feeder-1.telegram", 1.into()),
        ];
        let vlt = press().with_changes(both).unwrap().plan().clone();
        assert_eq!(vlt.drives[1].model.known.key, "vlt");
        let by_number = changed("drive.2.event.1.at", "4s").unwrap();
        let at = |plan: &PlantPlan| plan.drives[1].cues[0].trigger;
        assert_eq!(at(&by_number), Trigger::Time(Duration::from_secs(4)));
        let first = changed("drive.press-1.parameters.DRV.ACC", "4000rpm/s").unwrap();
        let new = changed("drive.feeder-1.parameters.DRV.ACC", "4000rpm/s").unwrap();
        assert_eq!(
            (first.drives[0].parameters.len(), new.drives[1].parameters.len()),
            (2, 1)
        );
        let switch = changed("drive.press-1.travel.home-switch.2", "0.5rev").unwrap();
        assert_ne!(format!("{switch:?}"), format!("{:?}", press().plan()));
        let cycle = changed("controller.press-1.watchdog", 7).unwrap();
        assert_eq!(cycle.controllers[0].watchdog, 7);
        let step = changed("controller.1.step.2.send.NSOLL_A", "60rpm").unwrap();
        assert_ne!(
            step.controllers[0].steps[1],
            press().plan().controllers[0].steps[1]
        );
        let expected = changed("expect.reaches speed.within", "1s").unwrap();
        assert!(expected.expectations[0].to_string().contains("within = \"1s\""));
    }

    #[test]
    fn models_make_a_plant() {
        let plant = PlantSource::of(std::iter::repeat_n("AKD", 300)).unwrap();
        let last = &plant.plan().drives[299];
        assert_eq!(
            (last.name.as_str(), last.ip.address),
            ("akd-300", [192, 168, 1, 54].into())
        );
        assert!(plant.plan().client_address().is_ok());
        assert_eq!(PlantSource::of([]).unwrap_err(), ModelsError::None);
        let unknown = PlantSource::of(["akd", "x\"y"]).unwrap_err().to_string();
        assert_eq!(unknown, "no model `x\"y`; there are: akd, vlt, vacon");
        let many = PlantSource::of(std::iter::repeat_n("akd", 1001));
        assert_eq!(many.unwrap_err(), ModelsError::TooMany);
    }

    #[test]
    fn comments_and_the_rest_of_the_text_stay() {
        let one = press()
            .with_changes([("drive.press-1.load.friction", 0.25.into())])
            .unwrap();
        let same = PRESS.replacen("friction = 0.1 }", "friction = 0.25 }", 1);
        assert_eq!(one.as_toml(), same);
        let back = one
            .with_changes([("drive.press-1.load.friction", 0.1.into())])
            .unwrap();
        assert_eq!(back.as_toml(), PRESS);
    }

    #[test]
    fn what_does_not_exist_is_an_error_with_the_path() {
        for (path, value, why) in [
            (
                "drive.press-9.load.friction",
                Value::from(0.1),
                "no `press-9`; there are: press-1, feeder-1",
            ),
            (
                "drive.3.model",
                "akd".into(),
                "no `3`; there are: press-1, feeder-1",
            ),
            (
                "drive.press-1.load.frictoin",
                0.1.into(),
                "unknown field `frictoin`",
            ),
            ("drive.press-1.laod.friction", 0.1.into(), "unknown field `laod`"),
            ("drive.press-1", 1.into(), "a path ends at one value"),
            ("drive", 1.into(), "a path ends at one value"),
            (
                "drive.press-1.event.9.at",
                "1s".into(),
                "no `9`; the entries are 1 to 3",
            ),
            (
                "drive.press-1.name.first",
                1.into(),
                "`name` is one value and has no `first`",
            ),
            (
                "drive.press-1.load.friction",
                "much".into(),
                "does not start with a number",
            ),
            ("drive.press-1.load.friction", true.into(), "a text with its unit"),
            ("drive.press-1.load.friction", (-1.0).into(), "0"),
            (
                "drive.press-1.name",
                "feeder-1".into(),
                "belongs to another drive",
            ),
            ("sede", 1.into(), "unknown field `sede`"),
            ("", 1.into(), "keys with dots"),
            ("drive..load", 1.into(), "keys with dots"),
            (&"a.".repeat(200), 1.into(), "at most 256"),
        ] {
            let error = changed(path, value).unwrap_err();
            assert_eq!(error.path, path);
            assert!(error.why.contains(why), "{error}");
        }
    }

    proptest! {
        #[test]
        fn no_path_makes_a_change_panic(
            path in prop_oneof!["\\PC*", "(drive|controller|expect|event|press-1|load|step|1|2|send|name|\\.){1,12}"],
            text in "\\PC*",
            number in any::<i64>(),
        ) {
            for value in [Value::from(text), Value::from(number), Value::Array(vec![number.into()])] {
                if let Ok(changed) = press().with_changes([(path.as_str(), value)]) {
                    let again: PlantPlan = changed.as_toml().parse().unwrap();
                    prop_assert_eq!(format!("{again:?}"), format!("{:?}", changed.plan()));
                }
            }
        }
    }
}

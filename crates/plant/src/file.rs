//! The plant file.

use std::collections::{BTreeMap, HashMap};
use std::fs::File;
use std::io::{self, Read as _};
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use profile::catalogue::Scaling;
use profile::notation::Quantity;
use profile::value::{Assignment, Parameters};
use profinet::wire::dcp::check_name;
use profinet::{IpSuite, MacAddress};
use serde::Deserialize;
use toml::Spanned;
use toml::de::DeTable;
use virtual_drive::axis::{Plant, Travel};
use virtual_drive::model::{self, Model};
use virtual_drive::station::{Station, StationConfig};

use crate::digest::Digest;
use crate::event::PlantEvent;
use crate::expect::{Expectation, Goal, Measure, Scope, read_all, read_goal, read_list};
use crate::located::{Located, PlantError, line_of, located};
use crate::plan::{Cue, DrivePlan, PlantPlan, Trigger, set};
use crate::program::RawController;
use crate::text::{derived_mac, free_mac, place, suite, time};

/// Longest file, in octets.
const LONGEST_FILE: usize = 1 << 20;
/// Octets of a file that are read at most.
const MAX_READ: u64 = 4 << 20;
/// Most cues of one drive.
const MOST_CUES: usize = 10_000;

/// Why a plant file cannot be used.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PlantFileError {
    /// It cannot be read.
    #[error("cannot read {}: {source}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// Why.
        source: io::Error,
    },
    /// It is longer than a plant file can be, or no text.
    #[error("{}: {why}", path.display())]
    NoPlant {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        why: String,
    },
    /// Something in it is not valid.
    #[error("{}, {error}", path.display())]
    PlantPlan {
        /// The file.
        path: PathBuf,
        /// What, and where.
        error: PlantError,
    },
}

impl PlantPlan {
    /// Reads a plant file, not more of it than one may have.
    ///
    /// # Errors
    /// When it cannot be read, or when something in it is not valid.
    pub fn read(path: &Path) -> Result<Self, PlantFileError> {
        let text = read_text(path)?;
        Self::of_text(&text, Some(path)).map_err(|error| PlantFileError::PlantPlan {
            path: path.to_owned(),
            error,
        })
    }

    /// Reads the text of a plant file; its expectations are those of `file`.
    pub(crate) fn of_text(text: &str, file: Option<&Path>) -> Result<Self, PlantError> {
        let mut plant: Self = text.parse()?;
        if let Some(file) = file {
            set_file(&mut plant.expectations, file);
        }
        Ok(plant)
    }

    /// Returns what is expected of the drives by a text: a file with the key `expect`, or one inline table.
    ///
    /// ```
    /// let plant: profidrive_plant::PlantPlan = "[[drive]]\nname = \"akd-1\"".parse()?;
    /// let still = plant.expectations_of(r#"{ always = true, speed = "-1rpm..1rpm" }"#)?;
    /// assert_eq!(still[0].name(), "expectation 1");
    /// let error = plant.expectations_of(r#"{ at = "2s", speed = "120rpm" }"#).unwrap_err();
    /// assert!(error.to_string().contains("tolerance"));
    /// # Ok::<(), profidrive_plant::PlantError>(())
    /// ```
    ///
    /// # Errors
    /// What is wrong, with its line.
    pub fn expectations_of(&self, text: &str) -> Result<Vec<Expectation>, PlantError> {
        let drives = &self.drives;
        read_all(text, Scope { drives })
    }

    /// Returns what a run is to wait for ([`World::run_until_met`](crate::World::run_until_met)) from a text: one inline table
    /// with the keys of conditions and, where needed, `drive` and `for`.
    ///
    /// # Errors
    /// What is wrong with it; for example that it is for more than one drive.
    pub fn goal(&self, text: &str) -> Result<Goal, PlantError> {
        let drives = &self.drives;
        read_goal(text, Scope { drives })
    }

    /// Returns what is to be measured of runs, from a text: see [`Measure`].
    ///
    /// # Errors
    /// What is wrong with it.
    pub fn measure(&self, text: &str) -> Result<Measure, PlantError> {
        let drives = &self.drives;
        Measure::read(text, Scope { drives })
    }

    /// Returns a hash of the content of the plant: the same for files that differ in comments, the order of keys or the seed alone.
    #[must_use]
    pub fn fingerprint(&self) -> u64 {
        let mut hash = Digest::default();
        // it was read before
        let mut content: toml::Table = self.text.parse().unwrap_or_default();
        content.remove("seed");
        hash.octets(content.to_string().as_bytes());
        hash.value()
    }

    /// Reads a file with more expectations, see [`expectations_of`](Self::expectations_of).
    ///
    /// # Errors
    /// When it cannot be read, or when something in it is not valid.
    pub fn read_expectations(&self, path: &Path) -> Result<Vec<Expectation>, PlantFileError> {
        let text = read_text(path)?;
        let mut found = self
            .expectations_of(&text)
            .map_err(|error| PlantFileError::PlantPlan {
                path: path.to_owned(),
                error,
            })?;
        set_file(&mut found, path);
        Ok(found)
    }
}

fn set_file(expectations: &mut [Expectation], path: &Path) {
    for expectation in expectations {
        expectation.file = Some(path.display().to_string());
    }
}

/// Reads a text file, not more of it than one may have.
pub(crate) fn read_text(path: &Path) -> Result<String, PlantFileError> {
    let mut octets = Vec::new();
    // one more than is used, so that a longer file is recognized
    File::open(path)
        .and_then(|file| file.take(MAX_READ + 1).read_to_end(&mut octets))
        .map_err(|source| PlantFileError::Read {
            path: path.to_owned(),
            source,
        })?;
    let no_plant = |why: String| PlantFileError::NoPlant {
        path: path.to_owned(),
        why,
    };
    if octets.len() as u64 > MAX_READ {
        return Err(no_plant(format!(
            "longer than {MAX_READ} octets, not a plant file"
        )));
    }
    String::from_utf8(octets).map_err(|_| no_plant("not UTF-8 text".to_owned()))
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
struct RawPlant {
    #[serde(default = "first_seed")]
    seed: u64,
    duration: Option<Spanned<String>>,
    sample: Option<Spanned<String>>,
    #[serde(default)]
    drive: Vec<RawDrive>,
    #[serde(default)]
    controller: Vec<RawController>,
    /// Read apart: each value in it needs its place.
    expect: Option<serde::de::IgnoredAny>,
}

const fn first_seed() -> u64 {
    1
}

/// `NAME = VALUE` pairs in the order of the file.
pub(crate) type RawValues = BTreeMap<Spanned<String>, Spanned<toml::Value>>;

#[derive(Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
struct RawDrive {
    name: Spanned<String>,
    #[serde(default)]
    unnamed: bool,
    model: Option<Spanned<String>>,
    mac: Option<Spanned<String>>,
    ip: Option<Spanned<String>>,
    min_cycle: Option<Spanned<String>>,
    #[serde(default)]
    motor: RawMotor,
    #[serde(default)]
    load: RawLoad,
    travel: Option<RawTravel>,
    #[serde(default)]
    parameters: RawValues,
    #[serde(default)]
    event: Vec<Spanned<RawEvent>>,
}

/// SI units: kg m^2, Nm/A, Nm.
#[derive(Default, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
struct RawMotor {
    inertia: Option<Spanned<RawNumber>>,
    torque_constant: Option<Spanned<RawNumber>>,
    cogging: Option<Spanned<RawNumber>>,
}

/// SI units: kg m^2, Nm, Nm/(rad/s).
#[derive(Default, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
struct RawLoad {
    inertia: Option<Spanned<RawNumber>>,
    friction: Option<Spanned<RawNumber>>,
    viscous_friction: Option<Spanned<RawNumber>>,
    torque: Option<Spanned<RawNumber>>,
}

/// A number in the SI unit, or a text with a unit.
#[derive(Deserialize)]
#[serde(
    untagged,
    expecting = "a number is expected, or a text with its unit, such as \"0.2Nm\""
)]
enum RawNumber {
    Number(f64),
    Text(String),
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
struct RawTravel {
    negative_stop: Option<Spanned<String>>,
    positive_stop: Option<Spanned<String>>,
    negative_switch: Option<Spanned<String>>,
    positive_switch: Option<Spanned<String>>,
    home_switch: Option<[Spanned<String>; 2]>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
struct RawEvent {
    at: Option<Spanned<String>>,
    position: Option<Spanned<String>>,
    #[serde(rename = "for")]
    lasts: Option<Spanned<String>>,
    #[serde(rename = "do")]
    what: Spanned<String>,
}

impl std::str::FromStr for PlantPlan {
    type Err = PlantError;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        if text.len() > LONGEST_FILE {
            return Err(PlantError {
                line: 1,
                message: format!("the file is longer than {LONGEST_FILE} octets"),
            });
        }
        let raw: RawPlant = toml::from_str(text).map_err(|error| PlantError {
            line: line_of(text, error.span().map_or(0, |span| span.start)),
            message: error.message().to_owned(),
        })?;
        let mut plant = read(&raw).map_err(|Located(span, message)| PlantError {
            line: line_of(text, span.start),
            message,
        })?;
        plant.text = text.into();
        if raw.expect.is_some() {
            plant.expectations = expectations(text, &plant.drives)?;
        }
        Ok(plant)
    }
}

/// Reads the expectations of a plant file.
fn expectations(text: &str, drives: &[DrivePlan]) -> Result<Vec<Expectation>, PlantError> {
    let error = |span: Option<Range<usize>>, message: String| PlantError {
        line: line_of(text, span.map_or(0, |span| span.start)),
        message,
    };
    let table = DeTable::parse(text).map_err(|wrong| error(wrong.span(), wrong.message().to_owned()))?;
    let entry = table.get_ref().iter().find(|(key, _)| key.get_ref() == "expect");
    entry.map_or(Ok(Vec::new()), |(_, value)| {
        read_list(value, Scope { drives }, text).map_err(|Located(span, message)| error(Some(span), message))
    })
}

fn read(raw: &RawPlant) -> Result<PlantPlan, Located> {
    let duration = raw.duration.as_ref().map(|text| located(text, |text| time(text)));
    let sample = raw.sample.as_ref().map(|text| {
        located(text, |text| {
            let sample = time(text)?;
            if sample.is_zero() {
                return Err("samples need a time between them".to_owned());
            }
            Ok(sample)
        })
    });
    if raw.drive.is_empty() {
        return Err(Located(
            0..0,
            "a plant has at least one drive ([[drive]])".to_owned(),
        ));
    }
    let mut drives: Vec<DrivePlan> = Vec::new();
    let mut taken: HashMap<String, usize> = HashMap::new();
    for drive in &raw.drive {
        let mut plan = read_drive(drive)?;
        let key_of = |mac| format!("the MAC address {mac}");
        if drive.mac.is_none() {
            plan.mac = free_mac(&plan.name, |mac| taken.contains_key(&key_of(mac)));
        }
        let keys = [
            format!("the name {}", plan.name),
            key_of(plan.mac),
            format!("the address {}", plan.ip.address),
        ];
        for (key, given) in keys.into_iter().zip([true, true, plan.ip.is_set()]) {
            if given && taken.insert(key.clone(), drives.len()).is_some() {
                return Err(Located(
                    drive.name.span(),
                    format!("{key} belongs to another drive already"),
                ));
            }
        }
        drives.push(plan);
    }
    let controllers = raw.controller.iter().map(|controller| controller.read(&drives));
    Ok(PlantPlan {
        seed: raw.seed,
        duration: duration.transpose()?,
        sample: sample.transpose()?,
        controllers: controllers.collect::<Result<_, _>>()?,
        expectations: Vec::new(),
        drives,
        text: Arc::default(),
    })
}

fn read_drive(raw: &RawDrive) -> Result<DrivePlan, Located> {
    let name = located(&raw.name, |name| {
        check_name(name.as_bytes())
            .map_err(|rule| format!("`{name}` is not a valid station name: {rule}"))?;
        Ok::<_, String>(name.clone())
    })?;
    let model = match &raw.model {
        None => &model::AKD,
        Some(text) => located(text, |text| {
            model::by_name(text).ok_or_else(|| {
                let names = model::ALL.map(|model| model.known.key);
                format!("no model `{text}`; there are: {}", names.join(", "))
            })
        })?,
    };
    let mac = match &raw.mac {
        None => derived_mac(&name),
        Some(text) => located(text, |text| {
            let mac: MacAddress = text.parse().map_err(|error| format!("`{text}`: {error}"))?;
            if mac.is_multicast() || mac == MacAddress::default() {
                return Err(format!("`{text}` belongs to no single station"));
            }
            Ok(mac)
        })?,
    };
    let ip = match &raw.ip {
        None => IpSuite::NONE,
        Some(text) => located(text, |text| suite(text))?,
    };
    let min_device_interval = match &raw.min_cycle {
        None => None,
        Some(text) => Some(located(text, |text| {
            let ticks = time(text)?.as_nanos() / 31_250;
            let fits = time(text)?.as_nanos() % 31_250 == 0
                && (32..=16_384).contains(&ticks)
                && ticks.is_power_of_two();
            u16::try_from(ticks)
                .ok()
                .filter(|_| fits)
                .ok_or_else(|| format!("`{text}`: update times are 1, 2, 4, 8 .. 512 ms"))
        })?),
    };
    let parameters = assignments(&raw.parameters)?;
    let table = Parameters {
        catalogue: Some(model.catalogue),
        scaling: Scaling::default(),
    };
    for (span, assignment) in &parameters {
        let checked = table.select(&assignment.reference).and_then(|selection| {
            match table.check_text(&selection, &assignment.value)? {
                Some(_) => Ok(()),
                None => table.check(&selection, &assignment.value).map(|_| ()),
            }
        });
        if let Err(problem) = checked {
            let hint = problem.hint().map_or(String::new(), |hint| format!(" ({hint})"));
            return Err(Located(span.clone(), format!("{problem}{hint}")));
        }
    }
    // what the drive itself refuses is reported with its place, too
    let mut station = Station::new(StationConfig::new(model, mac));
    for (span, assignment) in &parameters {
        set(&mut station, model, &name, assignment)
            .map_err(|error| Located(span.clone(), error.to_string()))?;
    }
    if raw.event.len() > MOST_CUES {
        return Err(Located(raw.name.span(), format!("more than {MOST_CUES} events")));
    }
    Ok(DrivePlan {
        plant: read_plant(raw, model)?,
        load: raw
            .load
            .torque
            .as_ref()
            .map_or(Ok(0.0), |value| number(value, "Nm", -1e4..=1e4))?,
        parameters: parameters.into_iter().map(|(_, assignment)| assignment).collect(),
        cues: raw
            .event
            .iter()
            .map(|raw| read_cue(raw, model))
            .collect::<Result<_, _>>()?,
        name,
        unnamed: raw.unnamed,
        model,
        mac,
        ip,
        min_device_interval,
    })
}

/// `NAME = VALUE` pairs as texts, in the order of the file.
fn pairs(raw: &RawValues) -> Result<Vec<(Range<usize>, String, String)>, Located> {
    let mut pairs = Vec::new();
    for (key, value) in raw {
        let text = match value.get_ref() {
            toml::Value::String(text) => text.clone(),
            toml::Value::Integer(number) => number.to_string(),
            toml::Value::Float(number) => number.to_string(),
            _ => {
                return Err(Located(
                    value.span(),
                    "a value is a number or a text with its unit".into(),
                ));
            }
        };
        pairs.push((key.span(), key.get_ref().clone(), text));
    }
    pairs.sort_by_key(|(span, ..)| span.start);
    Ok(pairs)
}

/// Parameters and their values as the command line would take them.
fn assignments(raw: &RawValues) -> Result<Vec<(Range<usize>, Assignment)>, Located> {
    let read = |(span, name, text): (Range<usize>, String, String)| {
        let assignment = format!("{name}={text}").parse::<Assignment>();
        match assignment {
            Ok(assignment) => Ok((span, assignment)),
            Err(problem) => Err(Located(span, problem.to_string())),
        }
    };
    pairs(raw)?.into_iter().map(read).collect()
}

/// Signals and their values.
pub(crate) fn assignments_of_signals(
    raw: &RawValues,
) -> Result<Vec<(Range<usize>, String, Quantity)>, Located> {
    let read = |(span, name, text): (Range<usize>, String, String)| match text.parse::<Quantity>() {
        Ok(quantity) => Ok((span, name, quantity)),
        Err(problem) => Err(Located(span, format!("{name}: {problem}"))),
    };
    pairs(raw)?.into_iter().map(read).collect()
}

/// Returns a number in `unit`, which one without a unit has.
fn number(
    value: &Spanned<RawNumber>,
    unit: &str,
    range: std::ops::RangeInclusive<f64>,
) -> Result<f64, Located> {
    let wrong = |message: String| Located(value.span(), message);
    let number = match value.get_ref() {
        RawNumber::Number(number) => *number,
        RawNumber::Text(text) => {
            let quantity: Quantity = text.parse().map_err(|error| wrong(format!("{error}")))?;
            quantity.in_unit(unit).map_err(|error| wrong(error.to_string()))?
        }
    };
    let inside = range.contains(&number).then_some(number);
    inside.ok_or_else(|| {
        wrong(format!(
            "{number} {unit} is outside {} to {} {unit}",
            range.start(),
            range.end()
        ))
    })
}

fn read_plant(raw: &RawDrive, model: &Model) -> Result<Plant, Located> {
    let mut plant = model.plant;
    let set = |place: &mut f64, value: &Option<Spanned<RawNumber>>, unit, range| -> Result<(), Located> {
        if let Some(value) = value {
            *place = number(value, unit, range)?;
        }
        Ok(())
    };
    let inertia = 1e-7..=1e3;
    set(
        &mut plant.motor_inertia,
        &raw.motor.inertia,
        "kgm^2",
        inertia.clone(),
    )?;
    set(
        &mut plant.torque_constant,
        &raw.motor.torque_constant,
        "Nm/A",
        1e-3..=1e3,
    )?;
    set(&mut plant.cogging, &raw.motor.cogging, "Nm", 0.0..=1e3)?;
    set(
        &mut plant.load_inertia,
        &raw.load.inertia,
        "kgm^2",
        0.0..=*inertia.end(),
    )?;
    set(&mut plant.coulomb_friction, &raw.load.friction, "Nm", 0.0..=1e4)?;
    set(
        &mut plant.viscous_friction,
        &raw.load.viscous_friction,
        "Nm/(rad/s)",
        0.0..=1e3,
    )?;
    if let Some(raw) = &raw.travel {
        plant.travel = Some(read_travel(raw)?);
    }
    Ok(plant)
}

fn read_travel(raw: &RawTravel) -> Result<Travel, Located> {
    let mut travel = Travel::FREE;
    let set = |to: &mut i64, text: &Option<Spanned<String>>| -> Result<(), Located> {
        if let Some(text) = text {
            *to = located(text, |text| place(text))?;
        }
        Ok(())
    };
    set(&mut travel.negative_stop, &raw.negative_stop)?;
    set(&mut travel.positive_stop, &raw.positive_stop)?;
    set(&mut travel.negative_switch, &raw.negative_switch)?;
    set(&mut travel.positive_switch, &raw.positive_switch)?;
    if let Some([from, to]) = &raw.home_switch {
        let ends = (
            located(from, |text| place(text))?,
            located(to, |text| place(text))?,
        );
        if ends.0 > ends.1 {
            return Err(Located(
                from.span(),
                "the home switch begins behind its end".into(),
            ));
        }
        travel.home_switch = Some(ends);
    }
    if travel.negative_stop > 0 || travel.positive_stop < 0 {
        let text = raw.negative_stop.as_ref().or(raw.positive_stop.as_ref());
        let span = text.map_or(0..0, Spanned::span);
        return Err(Located(
            span,
            "the axis starts at 0rev, which must be between its stops".into(),
        ));
    }
    Ok(travel)
}

fn read_cue(raw: &Spanned<RawEvent>, model: &Model) -> Result<Cue, Located> {
    let event = raw.get_ref();
    let trigger = match (&event.at, &event.position) {
        (Some(at), None) => Trigger::Time(located(at, |text| time(text))?),
        (None, Some(at)) => Trigger::Place(located(at, |text| place(text))?),
        _ => {
            return Err(Located(
                raw.span(),
                "an event has either `at` (a time) or `position` (a place)".into(),
            ));
        }
    };
    let what: PlantEvent = located(&event.what, |text| {
        let what = text.parse::<PlantEvent>()?;
        what.fits(model).map(|()| what)
    })?;
    let lasts = match &event.lasts {
        None => None,
        Some(text) if what.undo().is_none() => {
            return Err(Located(
                text.span(),
                format!("`{what}` has no end of its own, so `for` means nothing here"),
            ));
        }
        Some(text) => Some(located(text, |text| time(text))?),
    };
    Ok(Cue { trigger, what, lasts })
}

#[cfg(test)]
mod tests;

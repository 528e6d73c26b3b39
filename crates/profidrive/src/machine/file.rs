//! The text of a machine file.

use std::collections::BTreeMap;
use std::net::Ipv4Addr;
use std::ops::Range;
use std::path::PathBuf;

use profile::model::{self, Model};
use profile::notation::Quantity;
use profile::value::{Assignment, ParameterProblem, Parameters};
use profinet::wire::dcp::check_name;
use profinet::{IpSuite, MacAddress};
use serde::Deserialize;
use toml::Spanned;

use super::{LONGEST_FILE, MOST_DRIVES, Machine, MachineDrive, MachineProblem, SpeedBound, UserUnit};

/// The format that this version reads. A later one that older programs cannot read has a higher number.
const FORMAT: i64 = 1;
/// Settings of one drive at most.
const MOST_PARAMETERS: usize = 4096;
/// Groups of one drive at most.
const MOST_GROUPS: usize = 64;

/// A message with its place in the text.
struct Located(Range<usize>, String);

#[derive(Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
struct RawMachine {
    format: Option<Spanned<i64>>,
    title: Option<String>,
    #[serde(default)]
    group: BTreeMap<Spanned<String>, RawGroup>,
    #[serde(default)]
    drive: Vec<RawDrive>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
struct RawGroup {
    max_speed: Option<Spanned<String>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
struct RawDrive {
    name: Spanned<String>,
    model: Spanned<String>,
    mac: Option<Spanned<String>>,
    ip: Option<Spanned<String>>,
    gateway: Option<Spanned<String>>,
    telegram: Option<Spanned<u16>>,
    #[serde(default)]
    groups: Vec<Spanned<String>>,
    max_speed: Option<Spanned<String>>,
    pitch: Option<Spanned<String>>,
    gear: Option<Spanned<String>>,
    backup: Option<Spanned<String>>,
    #[serde(default)]
    parameters: BTreeMap<Spanned<String>, Spanned<toml::Value>>,
}

impl std::str::FromStr for Machine {
    type Err = MachineProblem;

    fn from_str(text: &str) -> Result<Self, MachineProblem> {
        let at = |place: usize, message: String| MachineProblem {
            line: 1 + text.bytes().take(place).filter(|octet| *octet == b'\n').count(),
            message,
        };
        if text.len() > LONGEST_FILE {
            return Err(at(0, format!("the file is longer than {LONGEST_FILE} octets")));
        }
        let raw: RawMachine = toml::from_str(text).map_err(|error| {
            let span = error.span().unwrap_or(0..0);
            at(span.start, error.message().to_owned())
        })?;
        let line = |place: usize| at(place, String::new()).line;
        read(&raw, &line).map_err(|Located(span, message)| at(span.start, message))
    }
}

fn read(raw: &RawMachine, line: &dyn Fn(usize) -> usize) -> Result<Machine, Located> {
    if let Some(format) = raw.format.as_ref().filter(|format| *format.get_ref() != FORMAT) {
        let message = format!(
            "format {} is not known; this version reads format {FORMAT}",
            format.get_ref()
        );
        return Err(Located(format.span(), message));
    }
    if raw.drive.is_empty() {
        return Err(Located(
            0..0,
            "a machine has at least one drive ([[drive]])".to_owned(),
        ));
    }
    if let Some(drive) = raw.drive.get(MOST_DRIVES) {
        return Err(Located(
            drive.name.span(),
            format!("a machine has at most {MOST_DRIVES} drives"),
        ));
    }
    let mut machine = Machine {
        title: raw.title.clone(),
        ..Machine::default()
    };
    // what only one drive can have, and the line of the drive that has it
    let mut taken: BTreeMap<String, usize> = BTreeMap::new();
    for raw in &raw.drive {
        let drive = read_drive(raw, line)?;
        let mac = drive.mac.map(|mac| format!("the MAC address {mac}"));
        let ip = drive.ip.map(|ip| format!("the address {}", ip.address));
        for key in [Some(format!("the name {}", drive.name)), mac, ip]
            .into_iter()
            .flatten()
        {
            if let Some(first) = taken.insert(key.clone(), drive.line) {
                let message = format!("{key} belongs to the drive in line {first} already");
                return Err(Located(raw.name.span(), message));
            }
        }
        machine.drives.push(drive);
    }
    let groups = machine.groups();
    for (name, group) in &raw.group {
        if !groups.contains(name.get_ref()) {
            let message = format!("no drive is in the group `{}`", name.get_ref());
            return Err(Located(name.span(), message));
        }
        if let Some(speed) = &group.max_speed {
            machine.limits.push((name.get_ref().clone(), bound(speed, line)?));
        }
    }
    Ok(machine)
}

/// Adds the place in the text to the message about a value.
fn located<T, U>(value: &Spanned<T>, read: impl FnOnce(&T) -> Result<U, String>) -> Result<U, Located> {
    read(value.get_ref()).map_err(|message| Located(value.span(), message))
}

fn read_drive(raw: &RawDrive, line: &dyn Fn(usize) -> usize) -> Result<MachineDrive, Located> {
    let name = located(&raw.name, |name| station_name(name))?;
    let model = located(&raw.model, |text| known_model(text))?;
    let mac = raw.mac.as_ref().map(|text| located(text, |text| mac(text)));
    let mut ip = raw
        .ip
        .as_ref()
        .map(|text| located(text, |text| suite(text)))
        .transpose()?;
    if let Some(text) = &raw.gateway {
        let Some(ip) = &mut ip else {
            return Err(Located(
                text.span(),
                "a gateway needs an address: ip = \"A.B.C.D/NN\"".to_owned(),
            ));
        };
        ip.gateway = located(text, |text| gateway(text, ip))?;
    }
    if let Some(group) = raw.groups.get(MOST_GROUPS) {
        return Err(Located(
            group.span(),
            format!("a drive is in at most {MOST_GROUPS} groups"),
        ));
    }
    let groups = raw
        .groups
        .iter()
        .map(|text| located(text, |text| group_name(text)));
    let backup = raw.backup.as_ref().map(|text| {
        located(text, |text| match text.as_str() {
            "" => Err("a backup is a file; leave it out where there is none".to_owned()),
            text => Ok(PathBuf::from(text)),
        })
    });
    Ok(MachineDrive {
        name,
        line: line(raw.name.span().start),
        model,
        mac: mac.transpose()?,
        ip,
        telegram: raw
            .telegram
            .as_ref()
            .map(|number| located(number, |number| telegram(*number, &model)))
            .transpose()?,
        groups: groups.collect::<Result<_, _>>()?,
        max_speed: raw.max_speed.as_ref().map(|text| bound(text, line)).transpose()?,
        user_unit: user_unit(raw)?,
        backup: backup.transpose()?,
        parameters: parameters(raw, &model, line)?,
    })
}

fn station_name(name: &str) -> Result<String, String> {
    match check_name(name.as_bytes()) {
        Ok(_) => Ok(name.to_owned()),
        Err(rule) => Err(format!("`{name}` is not a valid station name: {rule}")),
    }
}

fn known_model(text: &str) -> Result<Model, String> {
    let known = Model::by_name(text).filter(|model| model.catalogue.is_some());
    known.ok_or_else(|| {
        let names = model::ALL.map(|model| model.key);
        format!("no model `{text}`; there are {}", names.join(", "))
    })
}

fn telegram(number: u16, model: &Model) -> Result<u16, String> {
    let known = model.catalogue.map_or(&[][..], |tables| tables.device.telegrams);
    if known.iter().any(|module| module.telegram == number) {
        return Ok(number);
    }
    let numbers: Vec<String> = known.iter().map(|module| module.telegram.to_string()).collect();
    Err(format!(
        "{} has no telegram {number}; it has {}",
        model.name,
        numbers.join(", ")
    ))
}

fn mac(text: &str) -> Result<MacAddress, String> {
    let mac: MacAddress = text.parse().map_err(|error| format!("`{text}`: {error}"))?;
    if mac.is_multicast() || mac == MacAddress::default() {
        return Err(format!("`{text}` belongs to no single station"));
    }
    Ok(mac)
}

/// `192.168.0.11/24`
fn suite(text: &str) -> Result<IpSuite, String> {
    let wrong = || format!("`{text}`: an address is written as 192.168.0.11/24");
    let (address, prefix) = text.split_once('/').ok_or_else(wrong)?;
    let address: Ipv4Addr = address.parse().map_err(|_| wrong())?;
    let prefix = prefix.parse().ok().filter(|prefix| (1..=30).contains(prefix));
    let prefix: u32 = prefix.ok_or_else(wrong)?;
    let mask = u32::MAX << (32 - prefix);
    let host = u32::from(address) & !mask;
    if address.is_unspecified()
        || address.is_loopback()
        || address.is_multicast()
        || host == 0
        || host == !mask
    {
        return Err(format!("`{text}` is not the address of a station"));
    }
    Ok(IpSuite {
        address,
        mask: mask.into(),
        gateway: Ipv4Addr::UNSPECIFIED,
    })
}

fn gateway(text: &str, ip: &IpSuite) -> Result<Ipv4Addr, String> {
    let gateway: Ipv4Addr = text
        .parse()
        .map_err(|_| format!("`{text}` is not an address such as 192.168.0.1"))?;
    let mask = u32::from(ip.mask);
    if u32::from(gateway) & mask != u32::from(ip.address) & mask || gateway == ip.address {
        return Err(format!(
            "the gateway {gateway} is not another station in the subnet of {}",
            ip.address
        ));
    }
    Ok(gateway)
}

fn group_name(text: &str) -> Result<String, String> {
    let fits = |c: char| c.is_ascii_alphanumeric() || "-_.".contains(c);
    if text.is_empty() || text.len() > 64 || !text.chars().all(fits) {
        return Err(format!(
            "`{text}` is not a group: use letters, digits, `-`, `_` and `.`, at most 64"
        ));
    }
    Ok(text.to_owned())
}

fn bound(text: &Spanned<String>, line: &dyn Fn(usize) -> usize) -> Result<SpeedBound, Located> {
    let rpm = located(text, |text| {
        let speed: Quantity = text.parse().map_err(|error| format!("{error}"))?;
        if speed.unit.is_none() {
            return Err(format!("`{text}`: a speed needs its unit (1500rpm, 25rps)"));
        }
        let rpm = speed.in_unit("rpm").map_err(|error| error.to_string())?;
        if !rpm.is_finite() || rpm <= 0.0 {
            return Err(format!("`{text}`: a speed limit is above 0"));
        }
        Ok(rpm)
    })?;
    Ok(SpeedBound {
        rpm,
        line: line(text.span().start),
    })
}

/// `pitch = "10mm"` for a turn of the load, `gear = "5:1"` turns of the motor to turns of the load.
fn user_unit(raw: &RawDrive) -> Result<Option<UserUnit>, Located> {
    let Some(pitch) = &raw.pitch else {
        return match &raw.gear {
            Some(gear) => Err(Located(
                gear.span(),
                "a gear needs the travel for a turn of its load: pitch = \"10mm\"".to_owned(),
            )),
            None => Ok(None),
        };
    };
    let gear = match &raw.gear {
        Some(gear) => located(gear, |text| ratio(text))?,
        None => 1.0,
    };
    located(pitch, |text| {
        let pitch: Quantity = text.parse().map_err(|error| format!("{error}"))?;
        let travel = pitch.number.as_f64();
        if !(travel.is_finite() && travel != 0.0) {
            return Err(format!("`{text}`: the travel for a turn is not 0"));
        }
        match pitch.unit.as_deref() {
            Some(unit) if pitch.position().is_err() && fits(unit) => {
                Ok(Some(UserUnit::new(unit, travel, gear)))
            }
            Some(unit) if !fits(unit) => Err(format!("`{unit}` is not the name of a unit: use letters")),
            // 90deg and 10rev are angles of the motor
            _ => Err(format!(
                "`{text}`: a travel needs a unit of its own, such as 10mm; turns, angles and counts are those of the motor"
            )),
        }
    })
}

fn fits(unit: &str) -> bool {
    !unit.is_empty() && unit.len() <= 16 && unit.chars().all(char::is_alphabetic)
}

/// `5:1`, `7:3`, `5`
fn ratio(text: &str) -> Result<f64, String> {
    let number = |text: &str| {
        text.trim()
            .parse::<f64>()
            .ok()
            .filter(|number| number.is_finite() && *number > 0.0)
    };
    let (motor, load) = text.split_once(':').unwrap_or((text, "1"));
    match (number(motor), number(load)) {
        (Some(motor), Some(load)) => Ok(motor / load),
        _ => Err(format!(
            "`{text}`: a gear is written as 5:1, turns of the motor to turns of the load"
        )),
    }
}

/// The settings, in the order of the file. Values that depend on scalings of the drive are checked again when it is there.
fn parameters(
    raw: &RawDrive,
    model: &Model,
    line: &dyn Fn(usize) -> usize,
) -> Result<Vec<(usize, Assignment)>, Located> {
    let tables = Parameters::of(model);
    let mut settings: Vec<(Range<usize>, Assignment)> = Vec::new();
    let mut places: BTreeMap<(u16, u16), usize> = BTreeMap::new();
    if raw.parameters.len() > MOST_PARAMETERS {
        return Err(Located(
            raw.name.span(),
            format!("a drive has at most {MOST_PARAMETERS} parameters here"),
        ));
    }
    let mut pairs: Vec<_> = raw.parameters.iter().collect();
    pairs.sort_by_key(|(key, _)| key.span().start);
    for (key, value) in pairs {
        let text = match value.get_ref() {
            toml::Value::String(text) => text.clone(),
            toml::Value::Integer(number) => number.to_string(),
            toml::Value::Float(number) => number.to_string(),
            toml::Value::Boolean(on) => u8::from(*on).to_string(),
            _ => {
                let message = "a value is a number or a text with its unit".to_owned();
                return Err(Located(value.span(), message));
            }
        };
        let wrong = |problem: ParameterProblem| {
            let hint = problem
                .hint()
                .map_or_else(String::new, |hint| format!(" ({hint})"));
            Located(key.span(), format!("{problem}{hint}"))
        };
        let assignment: Assignment = format!("{}={text}", key.get_ref()).parse().map_err(wrong)?;
        let selection = tables.select(&assignment.reference).map_err(wrong)?;
        if tables
            .check_text(&selection, &assignment.value)
            .map_err(wrong)?
            .is_none()
        {
            tables.check(&selection, &assignment.value).map_err(wrong)?;
        }
        if let Some(first) = places.insert((selection.pnu, selection.first), line(key.span().start)) {
            let message = format!("{} is set in line {first} already", selection.label());
            return Err(Located(key.span(), message));
        }
        settings.push((key.span(), assignment));
    }
    let settings = settings.into_iter();
    Ok(settings
        .map(|(span, assignment)| (line(span.start), assignment))
        .collect())
}

#[cfg(test)]
mod tests;

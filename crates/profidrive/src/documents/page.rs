//! A page about a machine for its documentation: one HTML file that needs no other, for screen and paper.

use askama::Template;
use client::Drive;
use client::backup::Backup;
use profile::notation::figures;
use profile::value::Reading;

use super::{DocumentError, DrivePortrait, NewFile, Portrait, portrait, time_text};
use crate::machine::{Machine, UserUnit};
use crate::open::{Network, Opening};
use crate::report::{FaultsReport, PageReport, Parameter, Quantity, Station, Wording};
use crate::{Part, Selector, Step};

/// Reads the drives that are meant and writes the page. `machine` has their groups and limits, where there is a machine file.
///
/// # Errors
/// When the network fails, the file cannot be written, or the caller requests a stop.
pub async fn page(
    opening: &Opening,
    network: &mut Network,
    (selector, machine): (&Selector, Option<&Machine>),
    file: &NewFile,
    wording: &(dyn Wording + Sync),
    progress: &mut (dyn FnMut(Step) + Send),
) -> Result<PageReport, DocumentError> {
    let portrait = portrait(opening, network, selector, wording, progress).await?;
    progress(Step::of(Part::Writing));
    let text = html(&portrait, machine)?;
    file.write(text.as_bytes())?;
    let drives = portrait.drives.iter().map(DrivePortrait::entry);
    Ok(PageReport {
        file: file.path().display().to_string(),
        size: text.len() as u64,
        drives: drives.collect(),
    })
}

/// Returns the page about drives that were read.
///
/// # Errors
/// When the page cannot be made.
pub fn html(portrait: &Portrait, machine: Option<&Machine>) -> Result<String, DocumentError> {
    let path = machine.and_then(|machine| machine.path.as_ref());
    let page = Page {
        version: env!("CARGO_PKG_VERSION"),
        title: machine
            .and_then(|machine| machine.title.clone())
            .unwrap_or_else(|| "Drives of the machine".to_owned()),
        time: time_text(portrait.time),
        machine_file: path.map(|path| path.display().to_string()),
        drives: portrait
            .drives
            .iter()
            .map(|drive| of_drive(drive, machine))
            .collect(),
        others: others(portrait),
        topology: topology(portrait),
    };
    page.render()
        .map_err(|error| DocumentError::Content(Box::new(error)))
}

#[derive(Template)]
#[template(path = "machine.html")]
struct Page {
    version: &'static str,
    title: String,
    time: String,
    machine_file: Option<String>,
    drives: Vec<DrivePage>,
    others: Vec<[String; 5]>,
    topology: Vec<[String; 4]>,
}

/// What the page says of a drive.
#[derive(Default)]
struct DrivePage {
    name: String,
    model: String,
    order: String,
    firmware: String,
    serial: String,
    ip: String,
    mac: String,
    telegram: String,
    groups: String,
    limit: String,
    state: String,
    sentence: String,
    problems: Vec<String>,
    faults: Vec<[String; 4]>,
    settings_title: String,
    settings: Vec<Setting>,
    settings_note: String,
}

struct Setting {
    name: String,
    number: String,
    value: String,
    default: String,
    unit: &'static str,
    description: &'static str,
}

fn of_drive(read: &DrivePortrait, machine: Option<&Machine>) -> DrivePage {
    let planned = machine.and_then(|machine| machine.drive(&read.name));
    let identity = read.info.as_ref().and_then(|info| info.identity.as_ref());
    let text = |text: Option<&String>| text.cloned().unwrap_or_default();
    let station = read.info.as_ref().map(|info| &info.station);
    let mut page = DrivePage {
        name: read.name.clone(),
        model: read
            .drive
            .as_ref()
            .map_or("", |drive| drive.model.name)
            .to_owned(),
        order: text(identity.map(|identity| &identity.order_id)),
        firmware: text(identity.map(|identity| &identity.software_revision)),
        serial: text(identity.map(|identity| &identity.serial_number)),
        ip: station.map(address).unwrap_or_default(),
        mac: station.map(|station| station.mac.clone()).unwrap_or_default(),
        groups: planned
            .map(|planned| planned.groups.join(", "))
            .unwrap_or_default(),
        limit: machine
            .and_then(|machine| machine.bound(&read.name))
            .map(|limit| speed_limit(limit.rpm, planned.and_then(|planned| planned.user_unit.as_ref())))
            .unwrap_or_default(),
        problems: read.problems.clone(),
        faults: read.faults.as_ref().map(faults).unwrap_or_default(),
        ..DrivePage::default()
    };
    if let Some(status) = &read.status {
        let telegram = status.telegram.map(|telegram| telegram.to_string());
        page.telegram = telegram.unwrap_or_default();
        page.state = status.state_text.clone().unwrap_or_default();
        page.sentence = status.sentence.clone();
    }
    if let Some((drive, backup)) = read.drive.as_ref().zip(read.backup.as_ref()) {
        fill(&mut page, drive, backup);
    }
    page
}

/// `3000 rpm (100 mm/s)`, the second where the load has a unit.
fn speed_limit(rpm: f64, unit: Option<&UserUnit>) -> String {
    let motor = Quantity::rpm(rpm);
    let load = unit.and_then(|unit| unit.of_motor(&motor));
    let load = load.map(|load| format!(" ({} {})", figures(load.value), load.unit));
    format!("{rpm} rpm{}", load.unwrap_or_default())
}

/// The settings that differ from those as delivered; all where the tables have no such values.
fn fill(page: &mut DrivePage, drive: &Drive, backup: &Backup) {
    let all = backup.readings().len();
    let compared: Vec<(&Reading, Delivered)> = backup
        .readings()
        .iter()
        .map(|reading| (reading, delivered(drive, reading)))
        .collect();
    let known = compared
        .iter()
        .filter(|(_, other)| *other != Delivered::Unknown)
        .count();
    let shown = compared.into_iter().filter_map(|(reading, other)| match other {
        Delivered::Same => None,
        Delivered::Other(default) => Some((reading, default)),
        Delivered::Unknown => (known == 0).then(|| (reading, String::new())),
    });
    page.settings = shown
        .map(|(reading, default)| setting(drive, reading, default))
        .collect();
    page.settings_title = match known {
        0 => "Settings".to_owned(),
        _ => "Settings that differ from those as delivered".to_owned(),
    };
    page.settings_note = match known {
        0 => format!("{all} settings; the values as delivered are not known"),
        known if known == all => format!("{all} settings were read"),
        known => format!(
            "{all} settings were read; of {} the value as delivered is not known",
            all - known
        ),
    };
}

/// How a value compares with the one as delivered.
#[derive(Debug, PartialEq)]
enum Delivered {
    Same,
    Other(String),
    Unknown,
}

fn delivered(drive: &Drive, reading: &Reading) -> Delivered {
    let index = reading.index.unwrap_or(0);
    let Some(found) = drive.parameters.at(reading.pnu, index) else {
        return Delivered::Unknown;
    };
    let scaling = &drive.parameters.scaling;
    let (Some(_), Some(value)) = (found.default_in(scaling), reading.number()) else {
        return Delivered::Unknown;
    };
    // a drive has the nearest value that it can represent
    let default = found.engineering(found.raw_default(scaling), scaling);
    let digits = usize::from(reading.decimals);
    if (default - value).abs() <= 0.5 * 10_f64.powi(-i32::from(reading.decimals)) {
        return Delivered::Same;
    }
    let text = format!("{default:.digits$}");
    let short = text.trim_end_matches('0').trim_end_matches('.');
    Delivered::Other(if digits > 0 { short.to_owned() } else { text })
}

fn setting(drive: &Drive, reading: &Reading, default: String) -> Setting {
    let shown = Parameter::from(reading);
    let text = shown.text.unwrap_or_default();
    let index = reading.index.unwrap_or(0);
    let found = drive.parameters.at(reading.pnu, index);
    Setting {
        name: shown.name.unwrap_or_default(),
        number: shown.number,
        value: match shown.meaning {
            Some(meaning) => format!("{text} ({meaning})"),
            None => text,
        },
        default,
        unit: reading.unit,
        description: found.map_or("", |found| found.description),
    }
}

fn faults(report: &FaultsReport) -> Vec<[String; 4]> {
    let text = |text: &Option<String>| text.clone().unwrap_or_default();
    let faults = report.faults.iter().map(|fault| {
        let when = if fault.acknowledged {
            "acknowledged"
        } else {
            "present"
        };
        [
            format!("F{}", fault.number),
            text(&fault.meaning),
            text(&fault.remedy),
            when.to_owned(),
        ]
    });
    let warnings = report.warnings.iter().map(|warning| {
        [
            format!("n{}", warning.number),
            text(&warning.meaning),
            text(&warning.remedy),
            "present".to_owned(),
        ]
    });
    let logged = report.log.iter().map(|entry| {
        [
            format!("F{}", entry.number),
            text(&entry.meaning),
            String::new(),
            "in the log of the drive".to_owned(),
        ]
    });
    faults.chain(warnings).chain(logged).collect()
}

/// Stations that answered and are not among the drives.
fn others(portrait: &Portrait) -> Vec<[String; 5]> {
    let scan = portrait.scan.as_ref().map_or(&[][..], |scan| &scan.stations);
    let is_drive = |station: &Station| {
        let drives = portrait.drives.iter().filter_map(|drive| drive.info.as_ref());
        drives.into_iter().any(|info| info.station.mac == station.mac)
    };
    let other = scan
        .iter()
        .map(|one| &one.station)
        .filter(|station| !is_drive(station));
    other
        .map(|station| {
            [
                station.name.clone().unwrap_or_default(),
                station.station_type.clone(),
                station
                    .vendor
                    .map_or_else(|| format!("0x{:04X}", station.vendor_id), str::to_owned),
                address(station),
                station.mac.clone(),
            ]
        })
        .collect()
}

fn topology(portrait: &Portrait) -> Vec<[String; 4]> {
    let of_drive = |drive: &DrivePortrait| {
        let neighbours = drive.info.as_ref().map_or(&[][..], |info| &info.neighbours);
        let link = |one: &crate::report::Neighbour| {
            let other = one.station.as_ref().unwrap_or(&one.mac);
            [
                drive.name.clone(),
                one.own_port.clone(),
                other.clone(),
                one.port.clone(),
            ]
        };
        neighbours.iter().map(link).collect::<Vec<_>>()
    };
    portrait.drives.iter().flat_map(of_drive).collect()
}

/// `10.0.0.2/24`
fn address(station: &Station) -> String {
    let ip = station.ip.as_ref().zip(station.prefix);
    ip.map(|(ip, prefix)| format!("{ip}/{prefix}"))
        .unwrap_or_default()
}

//! `profidrive info DRIVE`

use client::{Drive, FaultEntry, Identity, Info, Wait, describe};
use profile::model::PROFIDRIVE_API;
use profile::parameter::pnu;
use profile::state::{Mode, bits};
use profile::value::Reading;
use profinet::wire::record::IdentifiedModule;
use serde_json::Value;

use crate::args;
use crate::args::Interface;
use crate::connect::{self, Need};
use crate::failure::Failure;
use crate::fields;
use crate::output::{Colour, Output};
use crate::render::table::clean;
use crate::render::{hex16, value, words};

/// The status word as a parameter.
const ZSW1: u16 = 2;
const STW1: u16 = 1;

pub fn run(args: &args::Drive, interface: &Interface, output: &Output) -> Result<(), Failure> {
    let (mut session, mut drive) = connect::drive(interface, Need::Identity, &args.drive, output)?;
    let spinner = connect::spinner(output, format!("reading {}", drive.label()));
    let info = session.info(&mut drive).wait();
    let readable = info.as_ref().is_ok_and(|info| !info.readings.is_empty());
    let faults = if readable {
        session.faults(&mut drive).wait()
    } else {
        Ok(Vec::new())
    };
    spinner.finish_and_clear();
    let info = info?;
    let faults = faults.unwrap_or_default();
    session.close().wait()?;
    if output.json() {
        output.document("info", json(&drive, &info, &faults));
        return Ok(());
    }
    let kind = if info.is_drive(&drive) {
        drive.model.name
    } else {
        "not a drive"
    };
    output.line(&format!("{} ({kind})", describe(&drive.station)));
    for line in lines(&drive, &info, &faults) {
        output.line(&line);
    }
    if output.verbose() || !info.is_drive(&drive) || info.readings.is_empty() {
        for line in module_lines(&info) {
            output.line(&line);
        }
    }
    if let Some(zsw1) = word(&info, ZSW1) {
        let colour = match zsw1 {
            fault if words::has_fault(fault) => Colour::Fault,
            warning if words::has_warning(warning) => Colour::Warning,
            _ => Colour::Normal,
        };
        output.line(&output.paint(
            colour,
            &format!("state        {}", words::state(zsw1, word(&info, STW1))),
        ));
    }
    for refused in &info.refused {
        output.say(&format!("not available: {refused}"));
    }
    Ok(())
}

fn word(info: &Info, pnu: u16) -> Option<u16> {
    info.raw(pnu).and_then(|raw| u16::try_from(raw & 0xFFFF).ok())
}

/// Mode that decides over the bits of STW1 and ZSW1.
fn word_mode(drive: &Drive, info: &Info) -> Mode {
    let operating_mode = word(info, pnu::OPERATING_MODE).map(i64::from);
    drive.word_mode(operating_mode, word(info, pnu::TELEGRAM))
}

fn lines(drive: &Drive, info: &Info, faults: &[FaultEntry]) -> Vec<String> {
    let mode = word_mode(drive, info);
    let mut lines = Vec::new();
    let mut line = |name: &str, text: String| {
        if !text.trim().is_empty() {
            lines.push(format!("{name:<12} {text}"));
        }
    };
    if let Some(identity) = &info.identity {
        for (name, text) in identity_lines(identity) {
            line(name, text);
        }
    }
    for (pnu, name) in [(964, "unit (964)"), (965, "profile (965)"), (975, "object (975)")] {
        line(name, page(info, pnu));
    }
    for (pnu, name) in [(922, "telegram"), (930, "mode")] {
        if let Some(reading) = info.readings.iter().find(|reading| reading.pnu == pnu) {
            line(name, format!("{} ({})", value::full(reading), reading.shown()));
        }
    }
    if let Some(controller) = &info.controller {
        line("control", control(controller.as_deref(), info));
    }
    for peer in &info.peers {
        let station = match &peer.station[..] {
            "" => format!("a station without a name ({})", peer.mac),
            name => format!("{} ({})", clean(name), peer.mac),
        };
        let (own, port) = (clean(&peer.own_port), clean(&peer.port));
        line("neighbour", format!("{own} leads to {port} of {station}"));
    }
    if let Some(stw1) = word(info, STW1) {
        let set = words::set(bits::stw1(mode), stw1);
        let means = words::stw1_meaning_in(mode, stw1);
        line("STW1", format!("{} {means} {set}", hex16(stw1)));
    }
    if let Some(zsw1) = word(info, ZSW1) {
        line("ZSW1", words::shown(bits::zsw1(mode), zsw1));
    }
    for fault in faults {
        let state = if fault.situation == 0 {
            "present"
        } else {
            "acknowledged"
        };
        let meaning = fault.meaning.unwrap_or("not in the tables");
        line(
            "fault",
            format!(
                "F{} {meaning} ({state}, situation {})",
                fault.number, fault.situation
            ),
        );
    }
    lines
}

/// Who commands the device, and what can be done beside that.
fn control(controller: Option<&str>, info: &Info) -> String {
    // a device that has state and mode is a drive whose parameters can be reached now
    match (controller.map(clean), info.readings.is_empty()) {
        (None, false) => "nobody: no controller is connected, `profidrive run` can take it".into(),
        (None, true) => "nobody: no controller is connected".into(),
        (Some(name), false) => {
            format!("controller \"{name}\"; reading and `profidrive monitor` work beside it")
        }
        (Some(name), true) => format!("controller \"{name}\"; identity and diagnosis can be read beside it"),
    }
}

/// What is plugged where, by ident numbers.
fn module_lines(info: &Info) -> Vec<String> {
    let line = |module: &IdentifiedModule| {
        let submodules: Vec<String> = module
            .submodules
            .iter()
            .map(|submodule| {
                let place = match submodule.subslot {
                    0x8000.. => format!("0x{:04X}", submodule.subslot),
                    subslot => subslot.to_string(),
                };
                format!("{place}: 0x{:08X}", submodule.ident)
            })
            .collect();
        let api = match module.api {
            0 => String::new(),
            PROFIDRIVE_API => ", drive profile".into(),
            api => format!(", API 0x{api:X}"),
        };
        format!(
            "{:<12} slot {}{api}: module 0x{:08X}, subslots {}",
            "module",
            module.slot,
            module.ident,
            submodules.join(", ")
        )
    };
    info.modules.iter().map(line).collect()
}

fn identity_lines(identity: &Identity) -> [(&'static str, String); 8] {
    let profile = match identity.profile_id {
        0x3A00..=0x3AFF => "PROFIdrive",
        0x3D00 => "encoder",
        0 => "",
        _ => "other",
    };
    [
        ("order no.", identity.order_id.clone()),
        ("serial no.", identity.serial_number.clone()),
        (
            "revision",
            format!(
                "hardware {}, software {}",
                identity.hardware_revision, identity.software_revision
            ),
        ),
        (
            "profile",
            format!(
                "0x{:04X} {profile}, type {}",
                identity.profile_id, identity.profile_type
            ),
        ),
        ("function", given(&identity.function)),
        ("location", given(&identity.location)),
        ("installed", given(&identity.installed)),
        ("descriptor", given(&identity.descriptor)),
    ]
}

/// What a person may write into the drive (I&M1 to I&M3); that nobody did is told too.
fn given(text: &str) -> String {
    match text.trim() {
        "" => "-".into(),
        text => text.to_owned(),
    }
}

/// One of the identification parameters in words.
fn page(info: &Info, pnu: u16) -> String {
    let values: Vec<&Reading> = info
        .readings
        .iter()
        .filter(|reading| reading.pnu == pnu)
        .collect();
    if values.is_empty() {
        return String::new();
    }
    let numbers: Vec<i64> = values.iter().filter_map(|reading| reading.raw()).collect();
    let octets: Vec<u8> = values.iter().flat_map(|reading| reading.octets.clone()).collect();
    match (pnu, numbers.as_slice(), octets.as_slice()) {
        (964, [vendor, kind, version, year, day_month, ..], _) => format!(
            "manufacturer {vendor} (0x{vendor:04X}), type {kind}, software {}.{:02}, {}",
            version / 100,
            version % 100,
            date(*year, *day_month)
        ),
        (975, [vendor, kind, version, year, day_month, rest @ ..], _) => {
            let class = match rest.first() {
                Some(1) => ", axis",
                Some(5) => ", encoder",
                _ => "",
            };
            let id = rest.get(2).map_or_else(String::new, |id| format!(", DO-ID {id}"));
            format!(
                "manufacturer {vendor}, type {kind}, software {}.{:02}, {}{class}{id}",
                version / 100,
                version % 100,
                date(*year, *day_month)
            )
        }
        (965, _, [profile, version, ..]) => {
            let name = if *profile == 3 {
                "PROFIdrive"
            } else {
                "other profile"
            };
            format!("{profile} {name}, version {}.{}", version / 10, version % 10)
        }
        _ => values
            .iter()
            .map(|reading| value::value(reading))
            .collect::<Vec<_>>()
            .join(", "),
    }
}

/// Year as YYYY, day and month as DDMM.
fn date(year: i64, day_month: i64) -> String {
    format!("{year:04}-{:02}-{:02}", day_month % 100, day_month / 100)
}

fn json(drive: &Drive, info: &Info, faults: &[FaultEntry]) -> serde_json::Map<String, Value> {
    let station = &drive.station;
    let mode = word_mode(drive, info);
    let mut fields = fields! {
        "name": station.name.as_str(), "mac": station.mac.to_string(), "ip": station.ip.address.to_string(),
        "vendor_id": station.vendor_id, "device_id": station.device_id, "type": station.station_type.as_str(),
        "model": drive.model.name,
    };
    if let Some(identity) = &info.identity {
        let identity = fields! {
            "vendor_id": identity.vendor_id, "order_id": identity.order_id.as_str(),
            "serial_number": identity.serial_number.as_str(), "hardware_revision": identity.hardware_revision,
            "software_revision": identity.software_revision.as_str(), "profile_id": identity.profile_id,
            "profile_type": identity.profile_type, "function": identity.function.as_str(),
            "location": identity.location.as_str(), "installed": identity.installed.as_str(),
            "descriptor": identity.descriptor.as_str(),
        };
        fields.insert("identity".into(), Value::Object(identity));
    }
    if let Some(zsw1) = word(info, ZSW1) {
        fields.insert("state".into(), words::state_number(zsw1, word(info, STW1)).into());
        fields.insert(
            "state_meaning".into(),
            words::state(zsw1, word(info, STW1)).into(),
        );
        fields.insert("zsw1".into(), words::word_json(bits::zsw1(mode), zsw1));
    }
    if let Some(stw1) = word(info, STW1) {
        fields.insert("stw1".into(), words::word_json(bits::stw1(mode), stw1));
    }
    if let Some(controller) = &info.controller {
        fields.insert("controller".into(), controller.as_deref().into());
    }
    let peers: Vec<Value> = info
        .peers
        .iter()
        .map(|peer| {
            Value::Object(fields! {
                "own_port": peer.own_port.as_str(), "port": peer.port.as_str(), "station": peer.station.as_str(),
                "mac": peer.mac.to_string(),
            })
        })
        .collect();
    fields.insert("neighbours".into(), peers.into());
    let modules = info.modules.iter().map(|module| {
        let submodules = module.submodules.iter().map(|submodule| {
            Value::Object(fields! { "subslot": submodule.subslot, "ident": submodule.ident })
        });
        let submodules: Vec<Value> = submodules.collect();
        Value::Object(fields! {
            "api": module.api, "slot": module.slot, "ident": module.ident, "submodules": submodules,
        })
    });
    fields.insert("modules".into(), modules.collect::<Vec<Value>>().into());
    fields.insert("route".into(), info.route.map(client::Route::name).into());
    fields.insert("drive".into(), info.is_drive(drive).into());
    let readings: Vec<Value> = info.readings.iter().map(value::json).collect();
    fields.insert("parameters".into(), readings.into());
    let faults: Vec<Value> = faults
        .iter()
        .map(|fault| {
            Value::Object(fields! {
                "number": fault.number, "meaning": fault.meaning, "remedy": fault.remedy,
                "situation": fault.situation, "position": fault.position,
            })
        })
        .collect();
    fields.insert("faults".into(), faults.into());
    let refused: Vec<Value> = info
        .refused
        .iter()
        .map(|text| Value::from(text.as_str()))
        .collect();
    fields.insert("refused".into(), refused.into());
    fields
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fields_never_written_are_marked() {
        let identity = Identity {
            location: "hall 3 ".into(),
            ..Identity::default()
        };
        let lines = identity_lines(&identity);
        assert!(lines.contains(&("function", "-".into())), "{lines:?}");
        assert!(lines.contains(&("location", "hall 3".into())), "{lines:?}");
    }

    #[test]
    fn dates_as_the_profile_writes_them() {
        assert_eq!(date(2017, 110), "2017-10-01");
        assert_eq!(date(2010, 1705), "2010-05-17");
    }
}

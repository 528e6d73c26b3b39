//! `profidrive info DRIVE`

use client::{Drive, Session, describe};
use profidrive::inspection;
use profidrive::report::{Controller, Identity, InfoReport, Module, Parameter, Word};
use profile::model::PROFIDRIVE_API;

use super::each::{self, Each, Progress, Shown};
use crate::args::{NoArguments, Target};
use crate::connect::Need;
use crate::failure::Failure;
use crate::output::{Colour, Output};
use crate::render::Page;
use crate::render::table::clean;
use crate::render::words;

pub fn run(target: &Target, output: &Output) -> Result<(), Failure> {
    each::run(&NoArguments {}, target, output)
}

impl Each for NoArguments {
    const DOING: &'static str = "reading";

    fn need(&self) -> Need {
        Need::Identity
    }

    async fn work(
        &self,
        session: &mut Session,
        drive: &mut Drive,
        _: &mut Progress<'_>,
    ) -> Result<InfoReport, Failure> {
        Ok(inspection::info(session, drive).await?)
    }
}

impl Shown for NoArguments {
    type Done = InfoReport;
    type Report = InfoReport;
    const COLUMNS: &'static [&'static str] = &[
        "model",
        "IP",
        "order no.",
        "serial no.",
        "software",
        "state",
        "controller",
    ];

    fn report(&self, done: &InfoReport, _: &Drive) -> InfoReport {
        done.clone()
    }

    fn show(&self, done: &InfoReport, drive: &Drive, output: &Output) {
        output.line(&format!("{} ({})", describe(&drive.station), kind(done)));
        done.print(output);
    }

    fn remark(&self, done: &InfoReport, _: &Drive, output: &Output) {
        for refused in &done.refused {
            output.say(&format!("not available: {refused}"));
        }
    }

    fn rows(&self, done: &InfoReport, _: &Drive) -> Vec<Vec<String>> {
        let identity = done.identity.as_ref();
        let of = |field: fn(&Identity) -> &String| {
            identity.map_or_else(String::new, |identity| field(identity).clone())
        };
        let controller = done.controller.as_ref().filter(|controller| controller.connected);
        let state = done.words.zsw1.as_ref().and_then(|word| word.meaning.clone());
        vec![vec![
            kind(done).to_owned(),
            done.station.ip.clone().unwrap_or_default(),
            of(|identity| &identity.order_id),
            of(|identity| &identity.serial_number),
            of(|identity| &identity.software_revision),
            state.unwrap_or_default(),
            controller.map_or_else(String::new, |one| one.name.clone().unwrap_or_default()),
        ]]
    }
}

const fn kind(report: &InfoReport) -> &'static str {
    if report.is_drive {
        report.model
    } else {
        "not a drive"
    }
}

impl Page for InfoReport {
    fn print(&self, output: &Output) {
        for line in lines(self) {
            output.line(&line);
        }
        if output.verbose() || !self.is_drive || self.parameters.is_empty() {
            for module in &self.modules {
                output.line(&module_line(module));
            }
        }
        if let Some(state) = self.words.zsw1.as_ref().and_then(|word| word.meaning.as_ref()) {
            let colour = match (self.words.fault_bit, self.words.warning_bit) {
                (Some(true), _) => Colour::Fault,
                (_, Some(true)) => Colour::Warning,
                _ => Colour::Normal,
            };
            output.line(&output.paint(colour, &format!("state        {state}")));
        }
    }
}

fn lines(report: &InfoReport) -> Vec<String> {
    let mut lines = Vec::new();
    let mut line = |name: &str, text: String| {
        if !text.trim().is_empty() {
            lines.push(format!("{name:<12} {text}"));
        }
    };
    if let Some(identity) = &report.identity {
        for (name, text) in identity_lines(identity) {
            line(name, text);
        }
    }
    for (pnu, name) in [(964, "unit (964)"), (965, "profile (965)"), (975, "object (975)")] {
        line(name, page(report, pnu));
    }
    for (pnu, name) in [(922, "telegram"), (930, "mode")] {
        if let Some(parameter) = report.parameters.iter().find(|parameter| parameter.pnu == pnu) {
            line(name, format!("{} ({})", parameter.full(), parameter.number));
        }
    }
    if let Some(controller) = &report.controller {
        line("control", control(controller, report));
    }
    for peer in &report.neighbours {
        let station = match &peer.station {
            None => format!("a station without a name ({})", peer.mac),
            Some(name) => format!("{} ({})", clean(name), peer.mac),
        };
        let (own, port) = (clean(&peer.own_port), clean(&peer.port));
        line("neighbour", format!("{own} leads to {port} of {station}"));
    }
    if let Some(stw1) = &report.words.stw1 {
        let Word {
            hex, bits, meaning, ..
        } = stw1;
        let means = meaning.as_deref().unwrap_or_default();
        line("STW1", format!("{hex} {means} {}", words::bracketed(bits)));
    }
    if let Some(zsw1) = &report.words.zsw1 {
        line("ZSW1", zsw1.shown());
    }
    for fault in &report.faults {
        let state = if fault.acknowledged {
            "acknowledged"
        } else {
            "present"
        };
        let meaning = fault.meaning.as_deref().unwrap_or("not in the tables");
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
fn control(controller: &Controller, report: &InfoReport) -> String {
    let name = clean(controller.name.as_deref().unwrap_or_default());
    // a device that has state and mode is a drive whose parameters can be reached now
    match (controller.connected, report.parameters.is_empty()) {
        (false, false) => "none: no controller is connected, `profidrive run` can take it".into(),
        (false, true) => "none: no controller is connected".into(),
        (true, false) => format!("controller \"{name}\"; reading and `profidrive monitor` work beside it"),
        (true, true) => format!("controller \"{name}\"; identity and diagnosis can be read beside it"),
    }
}

/// What is plugged where, by ident numbers.
fn module_line(module: &Module) -> String {
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

/// Formats user-defined identification (I&M1 to I&M3), also when it is empty.
fn given(text: &str) -> String {
    match text.trim() {
        "" => "-".into(),
        text => text.to_owned(),
    }
}

/// One of the identification parameters in words.
fn page(report: &InfoReport, pnu: u16) -> String {
    let values: Vec<&Parameter> = report
        .parameters
        .iter()
        .filter(|parameter| parameter.pnu == pnu)
        .collect();
    if values.is_empty() {
        return String::new();
    }
    let raw = |value: &&Parameter| value.raw.as_ref()?.as_i64();
    let numbers: Vec<i64> = values.iter().filter_map(raw).collect();
    let hex = values.iter().filter_map(|value| value.hex.as_deref());
    let octets: Vec<u8> = hex
        .flat_map(str::split_whitespace)
        .filter_map(|octet| u8::from_str_radix(octet, 16).ok())
        .collect();
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
            .filter_map(|value| value.text.clone())
            .collect::<Vec<_>>()
            .join(", "),
    }
}

/// Year as YYYY, day and month as DDMM.
fn date(year: i64, day_month: i64) -> String {
    format!("{year:04}-{:02}-{:02}", day_month % 100, day_month / 100)
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

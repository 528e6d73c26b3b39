//! Whose settings a backup holds.

use core::net::Ipv4Addr;

use profile::catalogue::{Part, Scaling};
use profile::unit::UnitChoice;

use profinet::IpSuite;

use super::TaskCoverage;
use crate::{Drive, Identity};
use profile::model::Model;
use profile::notation::setting::Text;

/// Whose settings they are. No date: the same settings give the same text.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Header {
    /// Name of the model.
    pub model: String,
    /// PROFINET vendor number.
    pub vendor_id: u16,
    /// PROFINET device number.
    pub device_id: u16,
    /// Name of station.
    pub station: String,
    /// Order number; empty when the drive does not report it.
    pub order_id: String,
    /// Serial number.
    pub serial_number: String,
    /// Software revision, for example `V1.17.0`.
    pub software: String,
    /// Address, mask and gateway; `None` where the drive has none, or an older file does not say it.
    pub ip: Option<IpSuite>,
    /// Number of the telegram (PNU 922), where the drive reports it.
    pub telegram: Option<u16>,
    /// Coverage of the motion tasks.
    pub tasks: TaskCoverage,
}

/// What differs between two drives of a kind.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct IdentityDifference {
    /// What it is: order number, software.
    pub what: &'static str,
    /// That of the first drive.
    pub left: String,
    /// That of the second drive.
    pub right: String,
}

impl Header {
    /// Of a drive and what it says in I&M0.
    #[must_use]
    pub fn of(drive: &Drive, identity: Option<&Identity>) -> Self {
        let text = |take: fn(&Identity) -> &String| {
            identity.map_or_else(String::new, |one| take(one).trim().to_owned())
        };
        Self {
            model: drive.model.name.to_owned(),
            vendor_id: drive.station.vendor_id,
            device_id: drive.station.device_id,
            station: drive.station.name.trim().to_owned(),
            order_id: text(|identity| &identity.order_id),
            serial_number: text(|identity| &identity.serial_number),
            software: text(|identity| &identity.software_revision),
            ip: Some(drive.station.ip).filter(|ip| ip.is_set()),
            telegram: None,
            tasks: TaskCoverage::Nothing,
        }
    }

    /// Returns the model of the drive: by its numbers, else by the name of the model, as a drive may be
    /// taken for one whatever its numbers are.
    #[must_use]
    pub fn known(&self) -> Model {
        let by_numbers = Model::of(self.vendor_id, self.device_id);
        match by_numbers.catalogue {
            Some(_) => by_numbers,
            None => Model::by_name(&self.model).unwrap_or(by_numbers),
        }
    }

    /// Returns the difference when the settings are of another kind of drive; `None` when they fit.
    #[must_use]
    pub fn misfit(&self, drive: &Drive) -> Option<String> {
        let station = &drive.station;
        let same_numbers = (self.vendor_id, self.device_id) == (station.vendor_id, station.device_id);
        // a text may be written by hand without the name
        let same_name = self.model.is_empty() || self.model == drive.model.name;
        (!(same_numbers && same_name)).then(|| {
            format!(
                "the settings are of model {} (vendor 0x{:04X}, device 0x{:04X}), {} is model {} (vendor 0x{:04X}, device 0x{:04X})",
                self.model,
                self.vendor_id,
                self.device_id,
                drive.label(),
                drive.model.name,
                station.vendor_id,
                station.device_id
            )
        })
    }

    /// Returns what differs in name and address, where both say them. A restore writes none of it: names and addresses are set by
    /// DCP.
    #[must_use]
    pub fn network_differences(&self, other: &Self) -> Vec<IdentityDifference> {
        let mut all = vec![("name of station", self.station.clone(), other.station.clone())];
        if let (Some(left), Some(right)) = (self.ip, other.ip) {
            all.extend([
                ("IP address", left.address.to_string(), right.address.to_string()),
                ("subnet mask", left.mask.to_string(), right.mask.to_string()),
                ("gateway", left.gateway.to_string(), right.gateway.to_string()),
            ]);
        }
        all.retain(|(_, left, right)| left != right);
        let difference = |(what, left, right)| IdentityDifference { what, left, right };
        all.into_iter().map(difference).collect()
    }

    /// Returns what differs between two drives of a kind, as a person should know before one gets the settings of the other.
    #[must_use]
    pub fn differences(&self, other: &Self) -> Vec<IdentityDifference> {
        [
            ("order number", &self.order_id, &other.order_id),
            ("software", &self.software, &other.software),
        ]
        .into_iter()
        .filter(|(_, left, right)| left != right && !left.is_empty() && !right.is_empty())
        .map(|(what, left, right)| IdentityDifference {
            what,
            left: left.clone(),
            right: right.clone(),
        })
        .collect()
    }

    /// Writes the head of a text.
    pub(super) fn write(&self, text: &mut Text, scaling: Option<&Scaling>) {
        text.head("model", self.model.trim(), "");
        text.head("vendor", &format!("0x{:04X}", self.vendor_id), "");
        text.head("device", &format!("0x{:04X}", self.device_id), "");
        for (key, value) in [
            ("station", &self.station),
            ("order number", &self.order_id),
            ("serial number", &self.serial_number),
            ("software", &self.software),
        ] {
            if !value.is_empty() {
                text.head(key, value.trim(), "");
            }
        }
        if let Some(ip) = self.ip {
            text.head("address", &ip.address.to_string(), "");
            text.head("mask", &ip.mask.to_string(), "");
            if !ip.gateway.is_unspecified() && ip.gateway != ip.address {
                text.head("gateway", &ip.gateway.to_string(), "");
            }
        }
        if let Some(telegram) = self.telegram {
            text.head("telegram", &telegram.to_string(), "PNU 922");
        }
        let has = |part| {
            self.known()
                .catalogue
                .is_some_and(|tables| tables.part(part).is_some())
        };
        if let Some(scaling) = scaling.filter(|_| has(Part::VelocityScaling)) {
            let factors = format!(
                "velocity {}, acceleration {}, position {}, singleturn {}, peak current {}",
                scaling.velocity,
                scaling.acceleration,
                scaling.position,
                scaling.singleturn_bits,
                scaling.peak_current
            );
            text.head("scaling", &factors, "");
        }
        if let Some(scaling) = scaling.filter(|_| has(Part::UnitRotary)) {
            let unit = scaling.unit.unit();
            let values = unit_values(scaling.unit).map(|(name, value)| format!("{name} {value}"));
            let meaning = format!(
                "positions in {}, {} per revolution",
                unit.symbol, unit.per_revolution
            );
            text.head("units", &values.join(", "), &meaning);
        }
        if let Some(tasks) = self.tasks.line() {
            text.head("tasks", tasks.trim(), "");
        }
    }

    fn suite(&mut self) -> &mut IpSuite {
        self.ip.get_or_insert(IpSuite::NONE)
    }

    /// Takes one line `key: value`; the scaling goes into `scaling`.
    pub(super) fn take(
        &mut self,
        key: &str,
        value: &str,
        scaling: &mut Option<Scaling>,
        units: &mut Option<UnitChoice>,
    ) -> Result<(), String> {
        let text = || value.trim().to_owned();
        match key {
            "model" => self.model = text(),
            "vendor" => self.vendor_id = number(value)?,
            "device" => self.device_id = number(value)?,
            "station" => self.station = text(),
            "order number" => self.order_id = text(),
            "serial number" => self.serial_number = text(),
            "software" => self.software = text(),
            "address" => self.suite().address = address(value)?,
            "mask" => self.suite().mask = address(value)?,
            "gateway" => self.suite().gateway = address(value)?,
            "telegram" => {
                let number = value.trim().parse();
                self.telegram =
                    Some(number.map_err(|_| format!("`{value}` is not the number of a telegram"))?);
            }
            "tasks" => self.tasks = TaskCoverage::parse(&text())?,
            "scaling" => *scaling = Some(read_scaling(value)?),
            "units" => *units = Some(read_units(value)?),
            _ => return Err(format!("`{key}:` is not a line of the head of a backup")),
        }
        Ok(())
    }
}

fn address(text: &str) -> Result<Ipv4Addr, String> {
    let address = text.trim().parse();
    address.map_err(|_| format!("`{text}` is not an address such as 192.168.0.1"))
}

fn number(text: &str) -> Result<u16, String> {
    text.strip_prefix("0x")
        .and_then(|digits| u16::from_str_radix(digits, 16).ok())
        .ok_or_else(|| format!("`{text}` is not a number of four hexadecimal digits such as 0x0105"))
}

/// Returns the parameters behind the unit of positions, as a line has them.
fn unit_values(unit: UnitChoice) -> [(&'static str, i64); 6] {
    [
        ("MOTOR.TYPE", i64::from(unit.linear)),
        ("UNIT.PROTARY", unit.rotary_unit),
        ("UNIT.PLINEAR", unit.linear_unit),
        ("UNIT.PIN", unit.custom.0),
        ("UNIT.POUT", unit.custom.1),
        ("MOTOR.PITCH", unit.pitch),
    ]
}

fn read_units(text: &str) -> Result<UnitChoice, String> {
    let mut unit = UnitChoice::DELIVERED;
    for part in text.split(',') {
        let part = part.trim();
        let (name, value) = part
            .rsplit_once(' ')
            .ok_or_else(|| format!("`{part}`: write a parameter and its value"))?;
        let value: u32 = value
            .parse()
            .map_err(|_| format!("`{value}` is not a value of {name}"))?;
        let value = i64::from(value);
        match name {
            "MOTOR.TYPE" => unit.linear = value == 1,
            "UNIT.PROTARY" => unit.rotary_unit = value,
            "UNIT.PLINEAR" => unit.linear_unit = value,
            "UNIT.PIN" => unit.custom.0 = value,
            "UNIT.POUT" => unit.custom.1 = value,
            "MOTOR.PITCH" => unit.pitch = value,
            _ => return Err(format!("the unit of positions does not depend on `{name}`")),
        }
    }
    Ok(unit)
}

fn read_scaling(text: &str) -> Result<Scaling, String> {
    let mut scaling = Scaling::default();
    for part in text.split(',') {
        let (what, value) = part
            .trim()
            .rsplit_once(' ')
            .ok_or_else(|| format!("`{}`: write what is scaled and a number", part.trim()))?;
        let wrong = || format!("`{value}` is not a valid scaling of {what}");
        let whole = || {
            value
                .parse::<u16>()
                .ok()
                .filter(|number| *number > 0)
                .ok_or_else(wrong)
        };
        match what {
            "velocity" => scaling.velocity = whole()?,
            "acceleration" => scaling.acceleration = whole()?,
            "singleturn" => scaling.singleturn_bits = whole()?,
            "position" => {
                scaling.position = value
                    .parse()
                    .ok()
                    .filter(|number| *number > 0)
                    .ok_or_else(wrong)?;
            }
            "peak current" => {
                let amperes: f64 = value.parse().map_err(|_| wrong())?;
                scaling.peak_current = Some(amperes)
                    .filter(|amperes| amperes.is_finite() && *amperes > 0.0)
                    .ok_or_else(wrong)?;
            }
            _ => return Err(format!("nothing is scaled by `{what}`")),
        }
    }
    Ok(scaling)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::backup::Backup;
    use crate::backup::print::FORM;
    use crate::text::is_unsafe;

    /// A terminal shows the text as it is in a file, and it is read back as it was.
    #[test]
    fn text_of_a_drive_is_escaped_and_read_back() {
        let hostile = "a#1\u{1b}[2J\u{202e}\u{ad}\\b".to_owned();
        let header = Header {
            model: "AKD".into(),
            station: hostile.clone(),
            order_id: hostile.clone(),
            serial_number: "\n".to_owned() + &hostile,
            software: hostile.clone(),
            ip: Some(IpSuite {
                address: [192, 168, 0, 11].into(),
                mask: [255, 255, 255, 0].into(),
                gateway: [192, 168, 0, 254].into(),
            }),
            telegram: Some(9),
            tasks: TaskCoverage::LeftOut(hostile),
            ..Header::default()
        };
        let mut text = FORM.begin(FORM.version);
        header.write(&mut text, None);
        let text = text.finish();
        assert!(!text.chars().any(|c| c != '\n' && is_unsafe(c)), "{text:?}");
        let expected = Header {
            serial_number: header.serial_number.trim().to_owned(),
            ..header
        };
        assert_eq!(Backup::read(&text).unwrap().header, expected);
    }
}

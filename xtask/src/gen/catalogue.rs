//! Tables of the drive models: parameters with their texts, faults, identity and modules.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::Path;

use serde::Deserialize;

use super::{Generated, backup};
use crate::Outcome;
use crate::table::{Row, Table};

/// The generated files of the drive models.
pub fn files(root: &Path) -> Outcome<Vec<Generated>> {
    Ok(vec![Generated {
        path: "crates/profidrive/src/catalogue/generated_akd.rs",
        from: "data/akd/",
        text: akd(root)?,
    }])
}

/// `device.toml` of a model.
#[derive(Deserialize)]
struct DeviceFile {
    identity: Identity,
    access_point: AccessPoint,
    description: Description,
    telegram: Vec<TelegramModule>,
    values: BTreeMap<String, f64>,
}

#[derive(Deserialize)]
struct Identity {
    vendor_id: u16,
    device_id: u16,
    vendor: String,
    station_type: String,
    order_id: String,
    hardware_revision: u16,
    software_revision: [u8; 3],
    profile_id: u16,
    drive_unit_type: u16,
    firmware_year: u16,
    firmware_day_month: u16,
}

#[derive(Deserialize)]
struct AccessPoint {
    module: u32,
    submodule: u32,
    interface_submodule: u32,
    port_submodule: u32,
    min_device_interval: u16,
}

#[derive(Deserialize)]
struct Description {
    date: u32,
    family: String,
    product_family: String,
    dns_name: String,
    name: String,
    english: String,
    german: String,
    conformance_class: String,
    netload_class: String,
    protocols: Vec<String>,
    port_rx_delay: u16,
    port_tx_delay: u16,
}

#[derive(Deserialize)]
struct TelegramModule {
    number: u16,
    english: String,
    german: String,
    outputs: u16,
    inputs: u16,
}

/// Module and submodule ident of a telegram: ours, one rule for all.
const TELEGRAM_IDENT: u32 = 0x0001_0000;

fn akd(root: &Path) -> Outcome<String> {
    let device = std::fs::read_to_string(root.join("data/akd/device.toml"))?;
    let mut device: DeviceFile =
        toml::from_str(&device).map_err(|error| format!("data/akd/device.toml: {error}"))?;
    let parameters = Table::read(root, "data/akd/parameters.csv")?;
    let meanings = Meanings::read(root, "data/akd/meanings.csv")?;
    let faults = Table::read(root, "data/akd/faults.csv")?;

    let mut text = String::from(
        "use super::backup::{BackupRule, Phase, Role};\nuse super::device::{DescriptionFacts, Device, TelegramModule, Words};\nuse super::fault::{Cleared, Fault, Reaction};\n\
         use super::parameter::{Access::*, Meaning, Parameter, Scale::*, Size::*};\nuse super::Catalogue;\n\n\
         /// Kollmorgen AKD with PROFINET, firmware 1.17.\n\
         pub static AKD: Catalogue = Catalogue { model: \"AKD\", parameters: PARAMETERS, index: INDEX, names: NAMES, \
         faults: FAULTS, device: DEVICE, backup: BACKUP };\n\n",
    );
    text.push_str(&render_device(&device));
    text.push_str(&meanings.render());

    let mut sources: Vec<String> = Vec::new();
    let mut rows = String::new();
    let mut numbers = Vec::new();
    for row in parameters.rows() {
        let pnu: u16 = row.number("pnu")?;
        if numbers.last().is_some_and(|(last, _)| *last >= pnu) {
            return Err(format!("{}: PNU {pnu} is not in ascending order", row.place()).into());
        }
        let name = row.text("name")?;
        rows.push_str(&render_parameter(
            row,
            &meanings,
            &mut device.values,
            &mut sources,
        )?);
        numbers.push((pnu, name.to_owned()));
    }
    if let Some(name) = device.values.keys().next() {
        return Err(format!("data/akd/device.toml: [values] {name} is no parameter").into());
    }
    writeln!(
        text,
        "#[rustfmt::skip]\nstatic SOURCES: &[&str] = &{sources:#?};\n"
    )?;
    writeln!(
        text,
        "#[rustfmt::skip]\nstatic PARAMETERS: &[Parameter] = &[\n{rows}];\n"
    )?;
    text.push_str(&render_index(&numbers)?);
    writeln!(text, "#[rustfmt::skip]\nstatic FAULTS: &[Fault] = &[")?;
    for row in faults.rows() {
        text.push_str(&render_fault(row)?);
    }
    text.push_str("];\n\n");
    let rules = Table::read(root, "data/akd/backup.csv")?;
    text.push_str(&backup::render(&rules, &backup::known(&parameters)?)?);
    Ok(text)
}

fn render_device(device: &DeviceFile) -> String {
    let identity = &device.identity;
    let point = &device.access_point;
    let mut modules = String::new();
    for telegram in &device.telegram {
        let ident = TELEGRAM_IDENT + u32::from(telegram.number);
        modules.push_str(&format!(
            "TelegramModule {{ telegram: {}, module: {ident:#010x}, submodule: {ident:#010x}, outputs: {}, inputs: {}, \
             words: Words {{ english: {:?}, german: {:?} }} }},",
            telegram.number, telegram.outputs, telegram.inputs, telegram.english, telegram.german
        ));
    }
    format!(
        "static DEVICE: Device = Device {{ vendor_id: {:#06x}, device_id: {:#06x}, vendor: {:?}, station_type: {:?}, \
         order_id: {:?}, hardware_revision: {}, software_revision: {:?}, api: {:#06x}, drive_unit_type: {}, \
         firmware_year: {}, firmware_day_month: {}, access_point_module: {}, access_point_submodule: {}, \
         interface_submodule: {}, port_submodule: {}, min_device_interval: {}, telegrams: &[{modules}], \
         description: {} }};\n\n",
        identity.vendor_id,
        identity.device_id,
        identity.vendor,
        identity.station_type,
        identity.order_id,
        identity.hardware_revision,
        identity.software_revision,
        identity.profile_id,
        identity.drive_unit_type,
        identity.firmware_year,
        identity.firmware_day_month,
        point.module,
        point.submodule,
        point.interface_submodule,
        point.port_submodule,
        point.min_device_interval,
        render_description(&device.description),
    )
}

fn render_description(facts: &Description) -> String {
    format!(
        "DescriptionFacts {{ date: {}, family: {:?}, product_family: {:?}, dns_name: {:?}, name: {:?}, \
         words: Words {{ english: {:?}, german: {:?} }}, conformance_class: {:?}, netload_class: {:?}, \
         protocols: &{:?}, port_rx_delay: {}, port_tx_delay: {} }}",
        facts.date,
        facts.family,
        facts.product_family,
        facts.dns_name,
        facts.name,
        facts.english,
        facts.german,
        facts.conformance_class,
        facts.netload_class,
        facts.protocols,
        facts.port_rx_delay,
        facts.port_tx_delay,
    )
}

fn render_parameter(
    row: Row<'_>,
    meanings: &Meanings,
    values: &mut BTreeMap<String, f64>,
    sources: &mut Vec<String>,
) -> Outcome<String> {
    let name = row.text("name")?;
    let word = |column: &str, words: &[(&str, &'static str)]| -> Outcome<&'static str> {
        let text = row.text(column)?;
        let found = words.iter().find(|(key, _)| *key == text);
        found
            .map(|(_, value)| *value)
            .ok_or_else(|| format!("{}: {column} {text:?}", row.place()).into())
    };
    let yes = |column: &str| word(column, &[("yes", "true"), ("no", "false"), ("", "false")]);
    let number = |column: &str| -> Outcome<String> {
        Ok(row
            .optional::<f64>(column)?
            .map_or("None".to_owned(), |value| format!("Some({value:?})")))
    };
    let size = word(
        "size",
        &[
            ("byte", "Byte"),
            ("word", "Word"),
            ("dword", "Dword"),
            ("command", "Command"),
        ],
    )?;
    let access = word(
        "access",
        &[("ro", "ReadOnly"), ("rw", "ReadWrite"), ("command", "Command")],
    )?;
    // `Command` is both a size and an access: the access keeps the long name.
    let access = if access == "Command" { "WriteOnly" } else { access };
    let scale = word(
        "scale",
        &[
            ("raw", "Raw"),
            ("milli", "Milli"),
            ("position", "Position"),
            ("velocity", "Velocity"),
            ("acceleration", "Acceleration"),
            ("current", "Current"),
            ("singleturn", "Singleturn"),
            ("mdi-velocity", "MdiVelocity"),
        ],
    )?;
    let default = match values.remove(name) {
        Some(value) => format!("Some({value:?})"),
        None => number("default")?,
    };
    let source = row.text("source")?;
    let source = sources
        .iter()
        .position(|known| known == source)
        .unwrap_or_else(|| {
            sources.push(source.to_owned());
            sources.len() - 1
        });
    let (choices, bits) = meanings.names(name);
    Ok(format!(
        "    Parameter {{ pnu: {}, name: {name:?}, size: {size}, elements: {}, signed: {}, access: {access}, saved: {}, \
         wide: {}, unit: {:?}, scale: {scale}, minimum: {}, maximum: {}, default: {default}, choices: {choices}, \
         bits: {bits}, description: {:?}, source: SOURCES[{source}] }},\n",
        row.number::<u16>("pnu")?,
        row.number::<u16>("elements")?,
        yes("signed")?,
        yes("nv")?,
        yes("wide")?,
        row.text("unit")?,
        number("minimum")?,
        number("maximum")?,
        row.text("description")?,
    ))
}

fn render_fault(row: Row<'_>) -> Outcome<String> {
    let place = || row.place();
    let warning = match row.text("kind")? {
        "F" => false,
        "n" => true,
        other => return Err(format!("{}: kind {other:?}", place()).into()),
    };
    let reaction = match row.text("reaction")? {
        "coast" => "Coast",
        "dynamic-brake" => "DynamicBrake",
        "quick-stop" => "QuickStop",
        "ramp-stop" => "RampStop",
        "none" => "None",
        other => return Err(format!("{}: reaction {other:?}", place()).into()),
    };
    if warning != (reaction == "None") {
        return Err(format!("{}: a warning has no reaction, a fault has one", place()).into());
    }
    let cleared = match row.text("cleared")? {
        "acknowledge" => "Acknowledge",
        "by itself" => "ByItself",
        "restart" => "Restart",
        other => return Err(format!("{}: cleared {other:?}", place()).into()),
    };
    let recalled = match row.text("confidence")? {
        "read" => false,
        "recalled" => true,
        other => return Err(format!("{}: confidence {other:?}", place()).into()),
    };
    if row.text("remedy")?.is_empty() {
        return Err(format!("{}: no remedy", place()).into());
    }
    Ok(format!(
        "    Fault {{ number: {}, warning: {warning}, meaning: {:?}, reaction: Reaction::{reaction}, remedy: {:?}, \
         cleared: Cleared::{cleared}, recalled: {recalled}, assumed: {:?}, source: {:?} }},\n",
        row.number::<u16>("number")?,
        row.text("meaning")?,
        row.text("remedy")?,
        row.text("assumed")?,
        row.text("source")?,
    ))
}

/// Position of each PNU in the table plus one (0: none), and the positions in the order of the names.
fn render_index(numbers: &[(u16, String)]) -> Outcome<String> {
    let highest = numbers.last().map_or(0, |(pnu, _)| usize::from(*pnu));
    let mut index = vec![0_usize; highest + 1];
    for (position, (pnu, _)) in numbers.iter().enumerate() {
        index[usize::from(*pnu)] = position + 1;
    }
    // Of two parameters with one name, the one from the drive's own range (2000 and above) comes first.
    let mut names: Vec<usize> = (0..numbers.len()).collect();
    names.sort_by_key(|position| {
        let (pnu, name) = &numbers[*position];
        (name.to_ascii_uppercase(), *pnu < 2000, *pnu)
    });
    let mut text = String::new();
    for (label, values) in [("INDEX", index), ("NAMES", names)] {
        writeln!(text, "#[rustfmt::skip]\nstatic {label}: &[u16] = &[")?;
        for line in values.chunks(24) {
            let line: Vec<String> = line.iter().map(usize::to_string).collect();
            writeln!(text, "    {},", line.join(", "))?;
        }
        writeln!(text, "];\n")?;
    }
    Ok(text)
}

/// Texts of enumeration values and bits by parameter.
struct Meanings {
    tables: BTreeMap<(String, String), Vec<(i32, String)>>,
}

impl Meanings {
    fn read(root: &Path, file: &str) -> Outcome<Self> {
        let mut tables: BTreeMap<_, Vec<_>> = BTreeMap::new();
        for row in Table::read(root, file)?.rows() {
            let kind = row.text("kind")?;
            if !matches!(kind, "choice" | "bit") {
                return Err(format!("{}: kind {kind:?}", row.place()).into());
            }
            let key = (row.text("parameter")?.to_owned(), kind.to_owned());
            tables
                .entry(key)
                .or_default()
                .push((row.number("value")?, row.text("text")?.to_owned()));
        }
        Ok(Self { tables })
    }

    fn render(&self) -> String {
        let mut text = String::new();
        for ((parameter, kind), meanings) in &self.tables {
            text.push_str(&format!(
                "#[rustfmt::skip]\nstatic {}: &[Meaning] = &[\n",
                identifier(parameter, kind)
            ));
            for (value, words) in meanings {
                text.push_str(&format!("    Meaning {{ value: {value}, text: {words:?} }},\n"));
            }
            text.push_str("];\n\n");
        }
        text
    }

    /// The expressions for `choices` and `bits` of a parameter.
    fn names(&self, parameter: &str) -> (String, String) {
        let family = family(parameter);
        let one = |kind: &str| {
            [parameter, family.as_str()]
                .iter()
                .find(|name| self.tables.contains_key(&((**name).to_owned(), kind.to_owned())))
                .map_or("&[]".to_owned(), |name| identifier(name, kind))
        };
        (one("choice"), one("bit"))
    }
}

/// `DIN21.MODE` is of the family `DINx.MODE`.
fn family(parameter: &str) -> String {
    match parameter.split_once('.') {
        Some((group, rest)) => format!("{}x.{rest}", group.trim_end_matches(|c: char| c.is_ascii_digit())),
        None => parameter.to_owned(),
    }
}

fn identifier(parameter: &str, kind: &str) -> String {
    let kind = if kind == "bit" { "BITS" } else { "CHOICES" };
    format!(
        "{}_{kind}",
        parameter.to_ascii_uppercase().replace(['.', ' '], "_")
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn families_and_identifiers() {
        assert_eq!(family("DIN21.MODE"), "DINx.MODE");
        assert_eq!(family("STW1"), "STW1");
        assert_eq!(identifier("DRV.OPMODE", "choice"), "DRV_OPMODE_CHOICES");
    }

    #[test]
    fn the_index_prefers_the_drives_own_range_for_a_double_name() {
        let text = render_index(&[(1, "B".into()), (3, "a".into()), (2000, "B".into())]).unwrap();
        assert!(text.contains("0, 1, 0, 2"), "{text}");
        assert!(text.contains("NAMES: &[u16] = &[\n    1, 2, 0,\n"), "{text}");
    }
}

//! What a machine file has that its drives do not, and a new file of the same drives keeps.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::Path;

use client::Drive;
use toml::{Table, Value};

use super::{Machine, MachineError};

/// The keys of a drive that are kept, as they are written.
const OF_DRIVE: [&str; 5] = ["mac", "groups", "max-speed", "pitch", "gear"];

/// What is kept of a machine file.
#[derive(Debug, Default)]
pub(crate) struct Kept {
    /// The keys of the machine.
    of_machine: Table,
    /// The keys of each drive, by its name.
    of_drives: BTreeMap<String, Table>,
}

impl Kept {
    /// Reads a machine file, and what is to be kept of it.
    ///
    /// # Errors
    /// When it cannot be read or is not valid.
    pub(crate) fn read(path: &Path) -> Result<(Machine, Self), MachineError> {
        let (machine, text) = Machine::read_with_text(path)?;
        // what was read as a machine is read as a table
        let mut table: Table = text.parse().unwrap_or_default();
        let mut of_drives = BTreeMap::new();
        if let Some(Value::Array(drives)) = table.remove("drive") {
            for (drive, read) in drives.into_iter().zip(&machine.drives) {
                if let Value::Table(mut drive) = drive {
                    drive.retain(|key, _| OF_DRIVE.contains(&key));
                    of_drives.insert(read.name.clone(), drive);
                }
            }
        }
        table.remove("format");
        let kept = Self {
            of_machine: table,
            of_drives,
        };
        Ok((machine, kept))
    }

    /// Returns the lines of the machine, which come before its drives.
    pub(super) fn head(&self) -> String {
        // a table that was read has a text
        toml::to_string(&self.of_machine).unwrap_or_default()
    }

    /// Returns the lines of a drive, by its name or its MAC address.
    pub(super) fn lines(&self, drive: &Drive) -> String {
        let mac = drive.station.mac;
        let has_mac = |table: &&Table| {
            let text = table.get("mac").and_then(Value::as_str);
            text.and_then(|text| text.parse().ok()) == Some(mac)
        };
        let of_name = self.of_drives.get(&drive.station.name);
        let table = of_name.or_else(|| self.of_drives.values().find(has_mac));
        let mut lines = String::new();
        for (key, value) in table.into_iter().flatten() {
            // a text takes everything
            let _ = writeln!(lines, "{key} = {value}");
        }
        lines
    }
}

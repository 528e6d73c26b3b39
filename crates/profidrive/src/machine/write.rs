//! A machine file of the drives that are there.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use client::Drive;
use client::backup::Backup;
use profile::model::Model;
use profile::parameter::pnu;
use profile::value::Parameters;

use super::{Kept, Machine, MachineDrive};
use crate::settings::file_in;

impl Machine {
    /// Returns the text of a machine file of drives, each with its name, its address, the file beside the machine file that has
    /// its settings, and what is kept of an older file.
    pub(crate) fn text_of<'d>(
        drives: impl IntoIterator<Item = (&'d Drive, &'d Backup)>,
        kept: &Kept,
    ) -> String {
        let mut text = format!("format = 1\n{}", kept.head());
        for (drive, backup) in drives {
            let quoted = |text: &str| toml::Value::String(text.to_owned()).to_string();
            let mut line = |key: &str, value: &str| {
                // a text takes everything
                let _ = writeln!(text, "{key} = {value}");
            };
            line("\n[[drive]]\nname", &quoted(&drive.station.name));
            line("model", &quoted(drive.model.key));
            let ip = drive.station.ip;
            if ip.is_set() {
                let prefix = u32::from(ip.mask).count_ones();
                line("ip", &quoted(&format!("{}/{prefix}", ip.address)));
                if !ip.gateway.is_unspecified() && ip.gateway != ip.address {
                    line("gateway", &quoted(&ip.gateway.to_string()));
                }
            }
            if let Some(telegram) = telegram(&drive.model, backup) {
                line("telegram", &telegram.to_string());
            }
            let file = file_in(Path::new(""), drive);
            line("backup", &quoted(&file.display().to_string()));
            text.push_str(&kept.lines(drive));
        }
        text
    }

    /// Returns the machine of one drive that takes the place of another: with the name, the address, the telegram and the
    /// settings of a backup.
    #[must_use]
    pub fn replacement(new: &Drive, name: &str, file: &Path, backup: &Backup) -> Self {
        let model = backup.header.known();
        let drive = MachineDrive {
            name: name.to_owned(),
            line: 0,
            model,
            mac: Some(new.station.mac),
            ip: backup.header.ip,
            telegram: telegram(&model, backup),
            groups: Vec::new(),
            max_speed: None,
            user_unit: None,
            backup: Some(PathBuf::from(file.file_name().unwrap_or_default())),
            parameters: Vec::new(),
        };
        Self {
            path: Some(file.to_owned()),
            drives: vec![drive],
            ..Self::default()
        }
    }

    /// Returns the machine of one of its drives, which a new drive takes the place of.
    #[must_use]
    pub fn with_replacement(&self, new: &Drive, name: &str) -> Option<Self> {
        let mut machine = self.clone();
        machine.drives.retain(|drive| drive.name == name);
        machine.drives.first_mut()?.mac = Some(new.station.mac);
        Some(machine)
    }
}

/// The telegram of a backup, where the model has one that can be set.
fn telegram(model: &Model, backup: &Backup) -> Option<u16> {
    let reference = format!("p{}", pnu::TELEGRAM).parse().ok()?;
    let selection = Parameters::of(model).select(&reference).ok()?;
    backup
        .header
        .telegram
        .filter(|_| selection.writable() != Some(false))
}

//! Tables of the drive models: one row of [`MODELS`] and one folder of `data/` each, all made by the same code.

use std::path::Path;

pub use backup::Known;

use super::Generated;
use super::parameter::Formats;
use crate::Outcome;
use crate::table::Table;

mod backup;
mod device;
mod faults;
mod index;
mod meanings;
mod parameters;
mod parts;

pub use parts::variant;

/// A drive model whose tables are in `data/`.
pub struct Model {
    /// Folder of its tables below `data/`, and of the generated module.
    pub folder: &'static str,
    /// Name of the model and of the generated catalogue.
    pub name: &'static str,
    /// One line about it.
    about: &'static str,
    /// First parameter number of the vendor's own range: a name that two numbers have means the one from there on.
    own_from: u16,
    /// How the vendor writes numbers, as Rust.
    notation: &'static str,
    /// Parameters whose bits are faults or warnings (column `bit` of `faults.csv`).
    alarm_words: &'static [AlarmWord],
}

/// A parameter whose bits are faults, or warnings.
struct AlarmWord {
    /// As [`parameters::Number::key`] writes it.
    parameter: &'static str,
    warnings: bool,
    /// What the column `bit` has for its bit 0.
    first: u8,
}

const fn alarm_word(parameter: &'static str, warnings: bool, first: u8) -> AlarmWord {
    AlarmWord {
        parameter,
        warnings,
        first,
    }
}

/// Every model. A further one is a row here, its tables in `data/` and a line in `profile::catalogue`.
pub const MODELS: &[Model] = &[
    Model {
        folder: "akd",
        name: "AKD",
        about: "Kollmorgen AKD with PROFINET, firmware 1.17.",
        own_from: 2000,
        notation: "Notation::Name",
        alarm_words: &[],
    },
    Model {
        folder: "vlt",
        name: "VLT",
        about: "Danfoss VLT AutomationDrive FC 302 with the PROFINET option MCA 120.",
        own_from: 0,
        notation: "Notation::GroupIndex",
        alarm_words: &[
            alarm_word("p1690", false, 0),
            alarm_word("p1691", false, 32),
            alarm_word("p1692", true, 0),
            alarm_word("p1693", true, 32),
        ],
    },
    Model {
        folder: "vacon",
        name: "VACON",
        about: "Vacon 100 with PROFINET (built in, or option OPTEA).",
        own_from: 10001,
        notation: "Notation::Id { pnu: 10001 }",
        alarm_words: &[],
    },
];

/// What a parameter can be.
const PARTS: &str = "data/profile/parts.csv";

/// The parameters of a model.
pub fn known_parameters(root: &Path, model: &Model) -> Outcome<Vec<Known>> {
    backup::known(&Table::read(
        root,
        &format!("data/{}/parameters.csv", model.folder),
    )?)
}

/// The numbers of the warnings of a model.
pub fn warnings(root: &Path, model: &Model) -> Outcome<Vec<u16>> {
    faults::warnings(&Table::read(root, &format!("data/{}/faults.csv", model.folder))?)
}

/// The generated files of the drive models.
pub fn files(root: &Path) -> Outcome<Vec<Generated>> {
    let mut files = vec![Generated {
        path: "crates/profile/src/catalogue/generated_parts.rs".to_owned(),
        from: PARTS.to_owned(),
        text: parts::render_type(&Table::read(root, PARTS)?)?,
    }];
    for model in MODELS {
        files.extend(model.files(root)?);
    }
    Ok(files)
}

impl Model {
    /// One file for each idea, and `mod.rs` that puts them together.
    fn files(&self, root: &Path) -> Outcome<Vec<Generated>> {
        let data = |file: &str| format!("data/{}/{file}", self.folder);
        let parameters = Table::read(root, &data("parameters.csv"))?;
        let numbers = parameters::numbers(&parameters)?;
        let faults = Table::read(root, &data("faults.csv"))?;
        let mut meanings = meanings::Meanings::read(root, &data("meanings.csv"))?;
        for word in self.alarm_words {
            meanings.bits_of_faults(word.parameter, &faults::bits(&faults, word.warnings, word.first)?)?;
        }
        let rules = Table::read(root, &data("backup.csv"))?;
        let parts = Table::read(root, &data("parts.csv"))?;
        let names_of_parts = Table::read(root, PARTS)?;
        let known = backup::known(&parameters)?;
        let mut device = device::DeviceFile::read(root, &data("device.toml"))?;
        let table = parameters::render(&parameters, &meanings, &Formats::read(root)?, &mut device.values)?;
        if let Some(name) = device.values.keys().next() {
            return Err(format!("{}: [values] {name} is not a parameter", data("device.toml")).into());
        }
        let made = |file: &str, from: &str, text: String| Generated {
            path: format!("crates/profile/src/catalogue/{}/{file}.rs", self.folder),
            from: data(from),
            text,
        };
        Ok(vec![
            made("mod", "", self.render(&device)),
            made("device", "device.toml", device::render(&device)),
            made("meanings", "meanings.csv", meanings.render()),
            made("index", "parameters.csv", index::render(&numbers, self.own_from)?),
            made("faults", "faults.csv", faults::render(&faults)?),
            made("backup", "backup.csv", backup::render(&rules, &known)?),
            made(
                "parts",
                "parts.csv",
                parts::render(&parts, &names_of_parts, &known)?,
            ),
            made("parameters", "parameters.csv", table),
            made("words", "meanings.csv", meanings.render_words(&numbers)?),
        ])
    }

    /// Returns the module that puts the tables together.
    fn render(&self, device: &device::DeviceFile) -> String {
        let Self {
            name,
            about,
            notation,
            ..
        } = self;
        let scaling = device::render_scaling(device);
        format!(
            "use super::{{Catalogue, Scaling}};\nuse crate::notation::Notation;\n\n\
             mod backup;\nmod device;\nmod faults;\nmod index;\nmod meanings;\nmod parameters;\nmod parts;\nmod words;\n\n\
             /// {about}\n\
             pub static {name}: Catalogue = Catalogue {{ model: {name:?}, notation: {notation}, scaling: {scaling}, parameters: parameters::PARAMETERS, \
             index: index::INDEX, names: index::NAMES, faults: faults::FAULTS, device: device::DEVICE, \
             backup: backup::BACKUP, parts: parts::PARTS, words: words::WORDS, not_now: words::NOT_NOW }};\n"
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_folder_with_a_device_is_a_model_and_its_files_are_its_own() {
        let root = crate::root();
        let mut folders: Vec<String> = std::fs::read_dir(root.join("data"))
            .unwrap()
            .map(|entry| entry.unwrap().path())
            .filter(|path| path.join("device.toml").exists())
            .map(|path| path.file_name().unwrap().to_str().unwrap().to_owned())
            .collect();
        folders.sort();
        let mut models: Vec<&str> = MODELS.iter().map(|model| model.folder).collect();
        models.sort_unstable();
        assert_eq!(models, folders);
        for model in MODELS {
            let files = model.files(&root).unwrap();
            assert_eq!(files.len(), 9);
            for file in &files {
                let home = format!("crates/profile/src/catalogue/{}/", model.folder);
                assert!(file.path.starts_with(&home), "{}", file.path);
                assert!(root.join(&file.from).exists(), "{}", file.from);
            }
        }
    }
}

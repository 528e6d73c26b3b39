//! Notes of temporary changes. A setting that a motion changes while it runs is noted on disk until it is put back. A
//! killed program leaves its note, from which the next one restores the old value.
//!
//! The notes are in `$XDG_STATE_HOME/profidrive` (`~/.local/state/profidrive`), one file for a drive and a number. A note
//! counts only while the drive still has the value that was set: whoever changed it since has decided.

use std::path::PathBuf;

use client::{Drive, Error, Session};
use network::files::StateFile;
use profile::catalogue::Part;
use profile::notation::{ParameterReference, Quantity};

/// What a command may leave changed: the jog speeds.
const PARTS: [Part; 3] = [Part::Jog1, Part::Jog2, Part::JogOnly];
/// First line of a note.
const MAGIC: &str = "profidrive leftover 1";

/// What a command changed for its time.
#[derive(Debug, Clone, PartialEq)]
pub struct Leftover {
    /// Number of the parameter.
    pub pnu: u16,
    /// Its value before.
    pub old: Quantity,
    /// The number on the wire that was set.
    pub set: i64,
}

impl Leftover {
    fn text(&self) -> String {
        format!("{MAGIC}\nold {}\nset {}\n", self.old, self.set)
    }

    fn parse(pnu: u16, text: &str) -> Option<Self> {
        let mut lines = text.lines();
        if lines.next()? != MAGIC {
            return None;
        }
        Some(Self {
            pnu,
            old: lines.next()?.strip_prefix("old ")?.parse().ok()?,
            set: lines.next()?.strip_prefix("set ")?.parse().ok()?,
        })
    }
}

/// Where a note of one drive and one number is; nothing is noted where there is no folder for it.
#[derive(Debug, Clone)]
pub(super) struct Note {
    pnu: u16,
    file: Option<StateFile>,
}

impl Note {
    pub(super) fn of(drive: &Drive, pnu: u16) -> Self {
        let name = format!("{}-{}-{pnu}", drive.station.mac, drive.label());
        let plain = |c: char| {
            if c.is_ascii_alphanumeric() || matches!(c, '-' | '.') {
                c
            } else {
                '_'
            }
        };
        let name: String = name.chars().map(plain).take(200).collect();
        Self {
            pnu,
            file: folder().map(|folder| StateFile::new(folder.join(name))),
        }
    }

    /// Returns the note of a killed program. A file of another format is ignored.
    pub(super) fn read(&self) -> Option<Leftover> {
        let content = self.file.as_ref()?.read().ok()??;
        Leftover::parse(self.pnu, std::str::from_utf8(&content).ok()?)
    }

    /// Notes it before it is done; why it could not be noted.
    pub(super) fn write(&self, leftover: &Leftover) -> Result<(), String> {
        let file = self.file.as_ref().ok_or("there is no home folder")?;
        file.replace(leftover.text().as_bytes())
            .map_err(|error| error.to_string())
    }

    /// It is put back.
    pub(super) fn clear(&self) {
        if let Some(file) = self.file.as_ref().filter(|file| file.path().exists()) {
            // a note that stays is found out: the drive has another value then
            let _ = file.remove();
        }
    }
}

/// Everything that killed programs left at a drive, as far as it still has it. A note that is out of date goes.
///
/// # Errors
/// When the drive cannot be reached.
pub async fn leftovers(session: &mut Session, drive: &mut Drive) -> Result<Vec<Leftover>, Error> {
    let mut found = Vec::new();
    let tables = drive.model.catalogue;
    let settings = PARTS.iter().filter_map(|&part| tables?.part(part));
    let mut numbers: Vec<u16> = settings.map(|one| one.base.unwrap_or(one.pnu)).collect();
    numbers.dedup();
    for pnu in numbers {
        let note = Note::of(drive, pnu);
        let Some(leftover) = note.read() else { continue };
        let selection = drive.parameters.select(&ParameterReference::number(pnu))?;
        match session.read_one(drive, &selection).await {
            Ok(reading) if reading.raw() == Some(leftover.set) => found.push(leftover),
            Ok(_) => note.clear(),
            Err(Error::Refused { .. }) => {}
            Err(error) => return Err(error),
        }
    }
    Ok(found)
}

fn folder() -> Option<PathBuf> {
    let variable = |name| {
        std::env::var_os(name)
            .map(PathBuf::from)
            .filter(|path| path.is_absolute())
    };
    let state = variable("XDG_STATE_HOME").or_else(|| Some(variable("HOME")?.join(".local/state")));
    Some(state?.join("profidrive"))
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn a_note_reads_back_and_anything_else_is_none() {
        let leftover = Leftover {
            pnu: 1004,
            old: "60.043931007385254rpm".parse().unwrap(),
            set: 246,
        };
        let text = leftover.text();
        assert_eq!(Leftover::parse(1004, &text), Some(leftover.clone()));
        for at in 0..text.trim_end().len() {
            let cut = Leftover::parse(1004, &text[..at]);
            assert!(
                cut.is_none_or(|cut| cut.old == leftover.old && cut.set < 246),
                "{at}"
            );
        }
        assert_eq!(
            Leftover::parse(1004, "profidrive leftover 1\nold x\nset 1\n"),
            None
        );
    }
}

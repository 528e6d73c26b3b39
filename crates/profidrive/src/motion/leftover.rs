//! Notes of temporary changes. The journal of a setting that a motion changes while it runs is on disk until the setting is
//! put back. A killed program leaves its note, from which the next one restores the old value.
//!
//! The notes are in `$XDG_STATE_HOME/profidrive` (`~/.local/state/profidrive`), one file for a drive and a number. A note
//! counts only while the drive still has the value that was set: whoever changed it since has decided. A note that is not readable stays, and nothing is noted over it.

use std::path::PathBuf;

use client::change::ChangeSet;
use client::status::Note;
use client::{Action, Advice, Drive, Error, Session};
use network::files::StateFile;
use profile::catalogue::Part;
use profile::notation::{ParameterReference, Quantity};
use profile::value::{Parameters, Reading, Selection};

/// What a command may leave changed: the jog speeds.
const PARTS: [Part; 3] = [Part::Jog1, Part::Jog2, Part::JogOnly];

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

/// A note that is not readable: what the value was before, and whether it was changed, is not known.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("the note of PNU {pnu} is not readable: {}: {cause}", file.display())]
pub struct UnreadableNote {
    /// Number of the parameter.
    pub pnu: u16,
    /// Where the note is.
    pub file: PathBuf,
    /// Why: of the file, or of its text.
    pub cause: String,
}

impl UnreadableNote {
    /// The same as a note of the status of its drive.
    #[must_use]
    pub fn note(&self) -> Note {
        let Self { pnu, file, .. } = self;
        let shows = Action::Read {
            parameters: vec![pnu.to_string()],
        };
        Note {
            id: "note-unreadable",
            sentence: format!(
                "a jog whose program was killed may have left another value in PNU {pnu}: {self}"
            ),
            next: Some(Advice::from(shows).and(format!(
                " shows the value, which may have to be corrected; remove {} then",
                file.display()
            ))),
        }
    }
}

impl Leftover {
    /// What a killed program left, as a note of the status of its drive.
    #[must_use]
    pub fn note(&self) -> Note {
        let Self { pnu, old, .. } = self;
        let put_back = Action::Write {
            parameter: pnu.to_string(),
            value: old.to_string().replace(' ', ""),
        };
        Note {
            id: "leftover",
            sentence: format!(
                "PNU {pnu} still has the value of a jog whose program was killed, before it was {old}"
            ),
            next: Some(
                Advice::from(put_back)
                    .and(" puts it back, the next ")
                    .with(Action::Jog)
                    .and(" does it too"),
            ),
        }
    }

    /// Of the journal of one change; `None` where nothing was sent.
    fn of(pnu: u16, set: &ChangeSet) -> Option<Self> {
        let change = set
            .changes()
            .first()
            .filter(|change| change.step.may_have_changed())?;
        let old = change.old.as_ref()?.as_ref().ok()?;
        Some(Self {
            pnu,
            old: briefly(set.parameters(), &change.selection, old)?,
            set: change.new.raw()?,
        })
    }
}

/// The value of a reading with as few digits as the drive needs to have it again.
fn briefly(parameters: &Parameters, selection: &Selection, reading: &Reading) -> Option<Quantity> {
    let (number, raw, unit) = (reading.number()?, reading.raw()?, reading.unit);
    let same = |text: String| {
        let value: Quantity = text.parse().ok()?;
        let checked = parameters.check(selection, &value.clone().into()).ok()?;
        (checked.raw == raw).then_some(value)
    };
    let rounded = (0..9).find_map(|digits| same(format!("{number:.digits$}{unit}")));
    rounded.or_else(|| format!("{number}{unit}").parse().ok())
}

/// Where a note of one drive and one number is; nothing is noted where there is no folder for it, and none is needed of a
/// drive that ends with this program.
#[derive(Debug, Clone)]
pub(super) struct NoteFile {
    pnu: u16,
    file: Option<StateFile>,
    needed: bool,
}

impl NoteFile {
    pub(super) fn of(session: &Session, drive: &Drive, pnu: u16) -> Self {
        let name = format!("{}-{}-{pnu}", drive.station.mac, drive.label());
        let plain = |c: char| {
            if c.is_ascii_alphanumeric() || matches!(c, '-' | '.') {
                c
            } else {
                '_'
            }
        };
        let name: String = name.chars().map(plain).take(200).collect();
        let needed = !session.engine().is_simulated();
        let folder = crate::state_folder().filter(|_| needed);
        Self {
            pnu,
            file: folder.map(|folder| StateFile::new(folder.join(name))),
            needed,
        }
    }

    /// Returns what a killed program left.
    ///
    /// # Errors
    /// The note is not readable.
    pub(super) fn read(&self) -> Result<Option<Leftover>, UnreadableNote> {
        let Some(file) = &self.file else {
            return Ok(None);
        };
        let unreadable = |cause| UnreadableNote {
            pnu: self.pnu,
            file: file.path().to_owned(),
            cause,
        };
        let Some(content) = file.read().map_err(|error| unreadable(error.to_string()))? else {
            return Ok(None);
        };
        let set = ChangeSet::from_journal(content).map_err(|error| unreadable(error.to_string()))?;
        Ok(Leftover::of(self.pnu, &set))
    }

    /// Notes how far a change is; why it could not be noted.
    pub(super) fn write(&self, set: &ChangeSet) -> Result<(), String> {
        if !self.needed {
            return Ok(());
        }
        let file = self.file.as_ref().ok_or("there is no home folder")?;
        file.replace(set.journal().as_bytes())
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

/// Everything that killed programs left at a drive, as far as it still has it, and the notes that are not readable. A note
/// that is out of date goes.
///
/// # Errors
/// When the drive cannot be reached.
pub async fn leftovers(
    session: &mut Session,
    drive: &mut Drive,
) -> Result<Vec<Result<Leftover, UnreadableNote>>, Error> {
    let mut found = Vec::new();
    let tables = drive.model.catalogue;
    let settings = PARTS.iter().filter_map(|&part| tables?.part(part));
    let mut numbers: Vec<u16> = settings.map(|one| one.base.unwrap_or(one.pnu)).collect();
    numbers.dedup();
    for pnu in numbers {
        let note = NoteFile::of(session, drive, pnu);
        let leftover = match note.read() {
            Ok(Some(leftover)) => leftover,
            Ok(None) => continue,
            Err(unreadable) => {
                found.push(Err(unreadable));
                continue;
            }
        };
        let selection = drive.parameters.select(&ParameterReference::number(pnu))?;
        match session.read_one(drive, &selection).await {
            Ok(reading) if reading.raw() == Some(leftover.set) => found.push(Ok(leftover)),
            Ok(_) => note.clear(),
            Err(Error::Refused { .. }) => {}
            Err(error) => return Err(error),
        }
    }
    Ok(found)
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use profile::catalogue::{AKD, Scaling};

    use super::*;

    #[test]
    fn a_speed_is_noted_with_the_digits_that_the_drive_needs() {
        let parameters = Parameters {
            catalogue: Some(&AKD),
            scaling: Scaling::default(),
        };
        let selection = parameters.select(&ParameterReference::number(1004)).unwrap();
        let whole: Quantity = "60.043931007385254rpm".parse().unwrap();
        let raw = parameters.check(&selection, &whole.into()).unwrap().raw;
        let octets = i16::try_from(raw).unwrap().to_be_bytes();
        let format = profile::parameter::Format::INTEGER16;
        let plain = profile::value::Interpretation::Plain;
        let reading = parameters.reading(&selection, 0, format.0, plain, &octets);
        let brief = briefly(&parameters, &selection, &reading).unwrap();
        assert!(brief.to_string().len() <= "60.044 rpm".len(), "{brief}");
        assert_eq!(parameters.check(&selection, &brief.into()).unwrap().raw, raw);
    }

    #[test]
    fn a_note_that_is_not_readable_stays_and_says_why() {
        let folder = std::env::temp_dir().join(format!("profidrive-note-{}", std::process::id()));
        let note = NoteFile {
            pnu: 1004,
            file: Some(StateFile::new(folder.join("note"))),
            needed: true,
        };
        assert_eq!(note.read(), Ok(None));
        let file = note.file.as_ref().unwrap();
        for text in [
            "profidrive leftover 1\nold 60 rpm\nset 246\n",
            "profidrive backup 1\n",
            "\u{0}",
        ] {
            file.replace(text.as_bytes()).unwrap();
            let why = note.read().unwrap_err();
            assert_eq!((why.pnu, why.file.as_path()), (1004, file.path()));
            assert!(why.cause.starts_with("line 1: "), "{why}");
            assert_eq!(file.read().unwrap().unwrap(), text.as_bytes());
        }
        std::fs::remove_dir_all(folder).unwrap();
    }

    /// The next run of the plant would read it, and be another run.
    #[cfg(feature = "simulate")]
    #[test]
    fn a_plant_in_memory_has_no_note_and_needs_none() {
        use client::Wait;

        let plant = "[[drive]]\nname = \"akd-1\"\nip = \"10.0.0.1/24\"";
        let mut network = crate::open_plan(plant.parse().unwrap()).unwrap();
        let mut drive = network.find(&"akd-1".parse().unwrap()).wait().unwrap();
        assert!(NoteFile::of(&network, &drive, 1004).file.is_none());
        let wanted = crate::motion::Jog {
            speed: Some(crate::motion::Speed::Rpm(90.0)),
            ..crate::motion::Jog::lasting(std::time::Duration::from_secs(1))
        };
        let observer = crate::motion::Observer::new(|event| {
            assert!(
                !matches!(event, crate::motion::Event::NotNoted { .. }),
                "{event:?}"
            );
        });
        crate::motion::jog(&mut network, &mut drive, &wanted, &observer)
            .wait()
            .unwrap();
    }
}

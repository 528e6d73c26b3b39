//! The state folder: what virtual drives keep over a restart, in `NAME.network.json` and `NAME.parameters`.

use std::path::{Path, PathBuf};
use std::thread::sleep;
use std::time::Duration;

use network::files::{Beside, StateFile, StateFileError};
use network::system::{FolderLock, LockError};
use profinet::IpSuite;
use profinet::device::{ImRecords, Stored};
use serde_json::{Map, Value};
use virtual_drive::model::Model;
use virtual_drive::store::{Image, ImageError, Storage, crc32, save};

/// Name and version of the file with name and address; changes only when a field changes its meaning or goes.
const SCHEMA: &str = "profidrive/1";
/// Times that a folder in use is tried again: a simulation that was just ended may still be saving.
const ATTEMPTS: u32 = 40;
/// Time between two of them.
const PAUSE: Duration = Duration::from_millis(50);

/// The folder of a simulation; locked for as long as this value exists.
#[derive(Debug)]
pub struct StateFolder {
    path: PathBuf,
    _lock: FolderLock,
}

impl StateFolder {
    /// Makes the folder, checks that it can be written to and locks it for this process; `holder` is what others
    /// read who want it meanwhile.
    ///
    /// # Errors
    /// When it cannot be written to, or when another simulation uses it.
    pub fn open(path: &Path, holder: &str) -> Result<Self, LockError> {
        let mut attempts = 0..ATTEMPTS;
        let lock = loop {
            match FolderLock::take(path, holder) {
                Err(LockError::Held { .. }) if attempts.next().is_some() => sleep(PAUSE),
                other => break other?,
            }
        };
        Ok(Self {
            path: path.to_owned(),
            _lock: lock,
        })
    }

    /// Returns the files of the drive `key`.
    #[must_use]
    pub fn drive(&self, key: &str) -> DriveState {
        let file = |ending: &str| StateFile::new(self.path.join(format!("{key}.{ending}")));
        DriveState {
            files: Some((file("network.json"), file("parameters"))),
        }
    }
}

/// What was read of one file.
#[derive(Debug, Default, PartialEq, Eq)]
pub struct Found<T> {
    /// The content; `None` for a drive that starts for the first time, or with the values as delivered.
    pub content: Option<T>,
    /// Why the file was set aside, and its new name.
    pub warning: Option<String>,
}

/// The files of one drive; without a folder nothing is kept.
#[derive(Debug, Clone, Default)]
pub struct DriveState {
    files: Option<(StateFile, StateFile)>,
}

impl DriveState {
    /// Returns true when there is a folder to keep things in.
    #[must_use]
    pub const fn is_kept(&self) -> bool {
        self.files.is_some()
    }

    /// Reads name, address and I&M data. A file that is damaged or holds what no drive can have is set aside.
    ///
    /// # Errors
    /// When the file cannot be read or not be set aside.
    pub fn read_network(&self) -> Result<Found<Stored>, StateFileError> {
        match &self.files {
            Some((file, _)) => checked(file, decode),
            None => Ok(Found::default()),
        }
    }

    /// Keeps them.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub fn write_network(&self, network: &Stored) -> Result<(), StateFileError> {
        match &self.files {
            Some((file, _)) => write(file, &encode(network)),
            None => Ok(()),
        }
    }

    /// Reads the saved parameters of a drive of `model`. A file that is damaged or of another model is set aside.
    ///
    /// # Errors
    /// When the file cannot be read or not be set aside.
    pub fn read_parameters(&self, model: &Model) -> Result<Found<Vec<u8>>, StateFileError> {
        let Some((_, file)) = &self.files else {
            return Ok(Found::default());
        };
        checked(file, |content| {
            let image = Image::decode(content).map_err(|error| error.to_string())?;
            let expected = model.catalogue.model;
            if image.model() == expected {
                return Ok(content.to_owned());
            }
            let found = image.model().to_owned();
            Err(ImageError::Model { found, expected }.to_string())
        })
    }

    /// Keeps them.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub fn write_parameters(&self, text: &str) -> Result<(), StateFileError> {
        match &self.files {
            Some((_, file)) => write(file, text),
            None => Ok(()),
        }
    }
}

/// Reads a file; if `decode` rejects it, it is renamed, so that nothing is lost and the drive can start.
fn checked<T>(
    file: &StateFile,
    decode: impl Fn(&[u8]) -> Result<T, String>,
) -> Result<Found<T>, StateFileError> {
    let Some(content) = file.read()? else {
        return Ok(Found {
            content: None,
            warning: None,
        });
    };
    match decode(&content) {
        Ok(content) => Ok(Found {
            content: Some(content),
            warning: None,
        }),
        Err(why) => {
            let aside = file.set_aside()?;
            let (path, aside) = (file.path().display(), aside.display());
            Ok(Found {
                content: None,
                warning: Some(format!(
                    "{path} is not used: {why}. The drive starts with the values as delivered; the file is kept as {aside}"
                )),
            })
        }
    }
}

fn write(file: &StateFile, text: &str) -> Result<(), StateFileError> {
    save(&mut OnDisk { file, beside: None }, text)
}

/// A file as the place the drive saves to.
struct OnDisk<'f> {
    file: &'f StateFile,
    beside: Option<Beside>,
}

impl Storage for OnDisk<'_> {
    type Error = StateFileError;

    fn read(&mut self) -> Result<Option<Vec<u8>>, StateFileError> {
        self.file.read()
    }

    fn write_beside(&mut self, bytes: &[u8]) -> Result<(), StateFileError> {
        self.beside = Some(self.file.write_beside(bytes)?);
        Ok(())
    }

    fn flush_beside(&mut self) -> Result<(), StateFileError> {
        self.beside.as_ref().map_or(Ok(()), Beside::flush)
    }

    fn replace(&mut self) -> Result<(), StateFileError> {
        self.beside.take().map_or(Ok(()), Beside::put_in_place)
    }

    fn flush_place(&mut self) -> Result<(), StateFileError> {
        self.file.flush_place()
    }
}

fn hex(octets: &[u8]) -> String {
    octets.iter().map(|octet| format!("{octet:02x}")).collect()
}

fn encode(network: &Stored) -> String {
    let ip = &network.ip;
    let fields = [
        ("schema", SCHEMA.to_owned()),
        ("kind", "virtual drive".to_owned()),
        ("name", network.name.clone()),
        ("ip", ip.address.to_string()),
        ("mask", ip.mask.to_string()),
        ("gateway", ip.gateway.to_string()),
        ("im1", hex(&network.im.im1)),
        ("im2", hex(&network.im.im2)),
        ("im3", hex(&network.im.im3)),
        ("im4", hex(&network.im.im4)),
    ];
    let fields = fields.map(|(name, text)| (name.to_owned(), Value::from(text)));
    let mut fields = Map::from_iter(fields);
    fields.insert(CHECKSUM.into(), checksum(&fields).into());
    format!("{:#}\n", Value::Object(fields))
}

/// Field with the checksum of all others.
const CHECKSUM: &str = "checksum";

/// CRC-32 of the fields as compact JSON, so that the layout of the text does not matter.
fn checksum(fields: &Map<String, Value>) -> String {
    let text = Value::Object(fields.clone()).to_string();
    format!("{:08x}", crc32(text.as_bytes()))
}

/// Decodes and checks a state; returns what is wrong with it. Files of earlier versions have no checksum: they are
/// taken when their values are valid, so that a drive keeps its name when the program is replaced.
fn decode(content: &[u8]) -> Result<Stored, String> {
    let not_one = || "it is not the state of a drive".to_owned();
    let Ok(Value::Object(mut fields)) = serde_json::from_slice(content) else {
        return Err(not_one());
    };
    if let Some(found) = fields.remove(CHECKSUM)
        && found != checksum(&fields).as_str()
    {
        return Err("it is damaged or was changed by hand: the checksum does not match".to_owned());
    }
    let stored = stored(&fields).ok_or_else(not_one)?;
    stored.check().map_err(|error| error.to_string())?;
    Ok(stored)
}

fn stored(fields: &Map<String, Value>) -> Option<Stored> {
    let text = |name: &str| fields.get(name)?.as_str();
    let address = |name| text(name)?.parse().ok();
    if text("schema")? != SCHEMA {
        return None;
    }
    Some(Stored {
        name: text("name")?.to_owned(),
        ip: IpSuite {
            address: address("ip")?,
            mask: address("mask")?,
            gateway: address("gateway")?,
        },
        im: ImRecords {
            im1: octets(text("im1")?)?,
            im2: octets(text("im2")?)?,
            im3: octets(text("im3")?)?,
            im4: octets(text("im4")?)?,
        },
    })
}

fn octets<const N: usize>(text: &str) -> Option<[u8; N]> {
    let mut octets = [0; N];
    if text.len() != 2 * N || !text.is_ascii() {
        return None;
    }
    for (at, octet) in octets.iter_mut().enumerate() {
        *octet = u8::from_str_radix(text.get(2 * at..2 * at + 2)?, 16).ok()?;
    }
    Some(octets)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;
    use std::net::Ipv4Addr;
    use virtual_drive::model::{AKD, VLT};

    /// A folder of its own for a test, removed with it.
    struct Place(PathBuf);

    impl Place {
        fn new(name: &str) -> Self {
            let path = std::env::temp_dir().join(format!("profidrive-{name}-{}", std::process::id()));
            let _ = fs::remove_dir_all(&path);
            Self(path)
        }
    }

    impl Drop for Place {
        fn drop(&mut self) {
            let _ = fs::remove_dir_all(&self.0);
        }
    }

    fn example() -> Stored {
        let mut stored = Stored {
            name: "akd-1".into(),
            ip: IpSuite {
                address: Ipv4Addr::new(10, 0, 0, 2),
                mask: Ipv4Addr::new(255, 255, 255, 0),
                gateway: Ipv4Addr::UNSPECIFIED,
            },
            ..Stored::default()
        };
        stored.im.im1[..4].copy_from_slice(b"feed");
        stored
    }

    #[test]
    fn what_is_kept_comes_back() {
        assert_eq!(decode(encode(&example()).as_bytes()), Ok(example()));
    }

    #[test]
    fn a_state_of_an_earlier_version_without_checksum_is_accepted() {
        let text = encode(&example());
        let lines: Vec<&str> = text.lines().filter(|line| !line.contains(CHECKSUM)).collect();
        assert_eq!(lines.len() + 1, text.lines().count());
        assert_eq!(decode(lines.join("\n").as_bytes()), Ok(example()));
    }

    #[test]
    fn an_impossible_state_is_rejected() {
        let long = "a".repeat(5000);
        for (field, value, why) in [
            ("name", "../../etc/passwd", "the name is not valid"),
            ("name", long.as_str(), "5000 characters, and 240 are the most"),
            ("name", "\u{1b}[2J", "the name is not valid"),
            ("ip", "255.255.255.255", "the address is not valid"),
            ("mask", "255.0.255.0", "the address is not valid"),
            ("ip", "here", "not the state of a drive"),
            ("im1", "00", "not the state of a drive"),
        ] {
            let mut fields: Map<String, Value> = serde_json::from_str(&encode(&example())).unwrap();
            fields.insert(field.into(), value.into());
            let changed = Value::Object(fields.clone()).to_string();
            let error = decode(changed.as_bytes()).unwrap_err();
            assert!(error.contains("checksum does not match"), "{error}");
            // also where the one who wrote it made a checksum, or none
            fields.remove(CHECKSUM);
            let error = decode(Value::Object(fields.clone()).to_string().as_bytes()).unwrap_err();
            assert!(error.contains(why), "{field} {value}: {error}");
            let sum = checksum(&fields);
            fields.insert(CHECKSUM.into(), sum.into());
            let error = decode(Value::Object(fields).to_string().as_bytes()).unwrap_err();
            assert!(error.contains(why), "{field} {value}: {error}");
        }
        for content in ["", "{}", "{\"schema\":\"other/1\"}", "not json"] {
            let error = decode(content.as_bytes()).unwrap_err();
            assert!(error.contains("not the state of a drive"), "{error}");
        }
    }

    #[test]
    fn a_broken_file_is_kept_beside_and_the_drive_starts_as_delivered() {
        let place = Place::new("broken");
        let folder = StateFolder::open(&place.0, "a test").unwrap();
        let drive = folder.drive("akd-1");
        drive.write_network(&example()).unwrap();
        assert_eq!(drive.read_network().unwrap().content, Some(example()));
        let (network, parameters) = (
            place.0.join("akd-1.network.json"),
            place.0.join("akd-1.parameters"),
        );
        fs::write(&network, "half of").unwrap();
        let found = drive.read_network().unwrap();
        let warning = found.warning.unwrap();
        assert!(
            found.content.is_none() && warning.contains("akd-1.network.json.broken"),
            "{warning}"
        );
        assert_eq!(
            fs::read(place.0.join("akd-1.network.json.broken")).unwrap(),
            b"half of"
        );
        assert_eq!(drive.read_network().unwrap(), Found::default());

        let saved = Image::new("AKD").encode();
        drive.write_parameters(&saved).unwrap();
        assert_eq!(
            drive.read_parameters(&AKD).unwrap().content,
            Some(saved.clone().into_bytes())
        );
        let other = drive.read_parameters(&VLT).unwrap().warning.unwrap();
        assert!(
            other.contains("of model AKD") && other.contains("akd-1.parameters.broken"),
            "{other}"
        );
        fs::write(&parameters, saved.replace("checksum", "checksun")).unwrap();
        let damaged = drive.read_parameters(&AKD).unwrap().warning.unwrap();
        assert!(damaged.contains("akd-1.parameters.broken-2"), "{damaged}");
    }

    #[test]
    fn a_folder_is_of_one_simulation_at_a_time_and_nothing_stays_in_it() {
        let place = Place::new("folder");
        let first = StateFolder::open(&place.0, "a test").unwrap();
        let error = StateFolder::open(&place.0, "another").unwrap_err().to_string();
        assert!(error.ends_with("is in use by a test"), "{error}");
        drop(first);
        assert_eq!(fs::read_dir(&place.0).unwrap().count(), 0);
    }

    #[test]
    fn a_folder_that_cannot_be_used_is_an_error_at_once() {
        let place = Place::new("state");
        fs::write(&place.0, "a file").unwrap();
        let error = StateFolder::open(&place.0, "a test").unwrap_err();
        assert!(matches!(error, LockError::File(_)), "{error}");
        fs::remove_file(&place.0).unwrap();
    }

    #[test]
    fn without_a_folder_nothing_is_kept() {
        assert_eq!(DriveState::default().read_network().unwrap(), Found::default());
    }
}

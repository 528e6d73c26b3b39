//! What a virtual drive keeps over a restart, in a folder: `NAME.network.json` and `NAME.parameters`.

use std::path::Path;

use network::files::{StateFile, StateFileError};
use profinet::IpSuite;
use profinet::device::{ImRecords, Stored};
use serde_json::Value;
use virtual_drive::store::{Storage, save};

use crate::failure::{Exit, Failure};
use crate::fields;
use crate::output::SCHEMA;

/// Makes the folder and sees whether it can be written to, before a drive promises to keep something in it.
pub fn usable(folder: &Path) -> Result<(), Failure> {
    let probe = StateFile::new(folder.join(format!(".probe-{}", std::process::id())));
    probe.replace(b"").and_then(|()| probe.remove()).map_err(|error| {
        Failure::new(Exit::Failed, format!("--state {}: {error}", folder.display()))
            .hint("choose a folder that can be written to")
    })
}

/// The files of one drive; without a folder nothing is kept.
#[derive(Debug, Clone)]
pub struct DriveState {
    files: Option<(StateFile, StateFile)>,
}

impl DriveState {
    /// The files of the drive `key` in `folder`.
    pub fn new(folder: Option<&Path>, key: &str) -> Self {
        let file = |folder: &Path, ending: &str| StateFile::new(folder.join(format!("{key}.{ending}")));
        Self {
            files: folder.map(|folder| (file(folder, "network.json"), file(folder, "parameters"))),
        }
    }

    /// True when there is a folder to keep things in.
    pub const fn is_kept(&self) -> bool {
        self.files.is_some()
    }

    /// Name, address and I&M data; `None` for a drive that starts for the first time.
    pub fn read_network(&self) -> Result<Option<Stored>, Failure> {
        let Some((file, _)) = &self.files else {
            return Ok(None);
        };
        let Some(content) = file
            .read()
            .map_err(|error| Failure::new(Exit::Failed, error.to_string()))?
        else {
            return Ok(None);
        };
        decode(&content).map(Some).ok_or_else(|| {
            let path = file.path().display();
            Failure::new(Exit::Failed, format!("{path} is no state of a drive"))
                .hint("move the file away to start with a new drive")
        })
    }

    /// Keeps them.
    pub fn write_network(&self, network: &Stored) -> Result<(), Failure> {
        let Some((file, _)) = &self.files else {
            return Ok(());
        };
        save(&mut OnDisk(file), &encode(network))
            .map_err(|error| Failure::new(Exit::Failed, error.to_string()))
    }

    /// The saved parameters.
    pub fn read_parameters(&self) -> Result<Option<Vec<u8>>, Failure> {
        let Some((_, file)) = &self.files else {
            return Ok(None);
        };
        file.read()
            .map_err(|error| Failure::new(Exit::Failed, error.to_string()))
    }

    /// Keeps them.
    pub fn write_parameters(&self, text: &str) -> Result<(), Failure> {
        let Some((_, file)) = &self.files else {
            return Ok(());
        };
        save(&mut OnDisk(file), text).map_err(|error| Failure::new(Exit::Failed, error.to_string()))
    }
}

/// A file as the place the drive saves to.
struct OnDisk<'f>(&'f StateFile);

impl Storage for OnDisk<'_> {
    type Error = StateFileError;

    fn read(&mut self) -> Result<Option<Vec<u8>>, StateFileError> {
        self.0.read()
    }

    fn write_beside(&mut self, bytes: &[u8]) -> Result<(), StateFileError> {
        self.0.write_beside(bytes)
    }

    fn flush_beside(&mut self) -> Result<(), StateFileError> {
        self.0.flush_beside()
    }

    fn replace(&mut self) -> Result<(), StateFileError> {
        self.0.put_in_place()
    }

    fn flush_place(&mut self) -> Result<(), StateFileError> {
        self.0.flush_place()
    }
}

fn hex(octets: &[u8]) -> String {
    octets.iter().map(|octet| format!("{octet:02x}")).collect()
}

fn encode(network: &Stored) -> String {
    let fields = fields! {
        "schema": SCHEMA, "kind": "virtual drive",
        "name": network.name.as_str(), "ip": network.ip.address.to_string(), "mask": network.ip.mask.to_string(),
        "gateway": network.ip.gateway.to_string(), "im1": hex(&network.im.im1), "im2": hex(&network.im.im2),
        "im3": hex(&network.im.im3), "im4": hex(&network.im.im4),
    };
    format!("{:#}\n", Value::Object(fields))
}

fn decode(content: &[u8]) -> Option<Stored> {
    let value: Value = serde_json::from_slice(content).ok()?;
    if value.get("schema")?.as_str()? != SCHEMA {
        return None;
    }
    let text = |name: &str| value.get(name)?.as_str();
    let address = |name| text(name)?.parse().ok();
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
    use std::net::Ipv4Addr;

    #[test]
    fn what_is_kept_comes_back() {
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
        assert_eq!(decode(encode(&stored).as_bytes()), Some(stored));
    }

    #[test]
    fn a_folder_that_cannot_be_used_is_told_at_once() {
        let folder = std::env::temp_dir().join(format!("profidrive-state-{}", std::process::id()));
        assert_eq!(usable(&folder), Ok(()));
        assert_eq!(
            std::fs::read_dir(&folder).unwrap().count(),
            0,
            "nothing left behind"
        );
        std::fs::remove_dir_all(&folder).unwrap();
        std::fs::write(&folder, "a file").unwrap();
        let failure = usable(&folder).unwrap_err();
        assert!(failure.message.contains("--state"), "{failure}");
        std::fs::remove_file(&folder).unwrap();
    }

    #[test]
    fn other_files_are_no_state() {
        for content in ["", "{}", "{\"schema\":\"other/1\"}", "not json"] {
            assert_eq!(decode(content.as_bytes()), None);
        }
        assert!(
            DriveState::new(None, "akd-1")
                .read_network()
                .is_ok_and(|network| network.is_none())
        );
    }
}

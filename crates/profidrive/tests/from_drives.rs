//! A machine file that is written from the drives that are there, in memory.
#![cfg(feature = "simulate")]
#![allow(clippy::unwrap_used)]

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};

use profidrive::client::ErrorKind;
use profidrive::commissioning::{self, CommissionError, FromDrives, MachineFile};
use profidrive::machine::Machine;
use profidrive::{Access, Explained, Opening, Wait, settings};

const PLANT: &str = r#"
[[drive]]
name = "akd-1"
mac = "02:00:00:00:00:01"
ip = "192.168.0.11/24"
[[drive]]
name = "vlt-1"
model = "vlt"
ip = "192.168.0.31/24"
"#;

/// What people add to a machine file.
const OLD: &str = r#"
format = 1
title = "press 3"
[group.fans]
max-speed = "900rpm"
[[drive]]
name = "vlt-1"
model = "vlt"
groups = ["fans"]
[drive.parameters]
"3-41" = "4s"
[[drive]]
name = "feed"
model = "akd"
mac = "02:00:00:00:00:01"
max-speed = "1500rpm"
pitch = "10mm"
gear = "5:1"
"#;

struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Self {
        let folder = std::env::temp_dir().join(format!("profidrive-{name}-{}", std::process::id()));
        let _ = std::fs::remove_dir_all(&folder);
        std::fs::create_dir_all(&folder).unwrap();
        Self(folder)
    }

    fn file(&self) -> PathBuf {
        self.0.join("machine.toml")
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

/// Reads the drives that a selector means; stops when so much of all of them is read.
fn read(path: &Path, drives: &str, stop_at: Option<usize>) -> FromDrives {
    let opening = Opening::new(Access::Records).in_plant(PLANT.parse().unwrap());
    let mut network = opening.clone().open().unwrap();
    let found = opening
        .select(&mut network, &drives.parse().unwrap())
        .wait()
        .unwrap();
    let stopped = Arc::new(AtomicBool::new(false));
    let question = Arc::clone(&stopped);
    network.interrupt_with(move || question.load(Relaxed));
    let file = MachineFile::at(path, true).unwrap();
    let progress = |step: profidrive::Step| {
        if stop_at.is_some_and(|limit| step.done >= limit) {
            stopped.store(true, Relaxed);
        }
    };
    commissioning::from_drives(&network, found.members, &file, progress).wait()
}

#[test]
fn a_machine_file_is_written_from_the_drives_that_are_there() {
    let folder = Folder::new("from-new");
    let read = read(&folder.file(), "all", None);
    assert_eq!(read.written.unwrap(), 2);
    let machine = Machine::read(&folder.file()).unwrap();
    let names: Vec<&str> = machine.drives.iter().map(|drive| drive.name.as_str()).collect();
    assert_eq!(names, ["akd-1", "vlt-1"]);
    for drive in &machine.drives {
        let backup = settings::read(&machine.beside(drive.backup.as_ref().unwrap())).unwrap();
        assert!(settings::missing(&backup).is_nothing() && !backup.readings().is_empty());
    }
    // it is not replaced without a wish
    let error = MachineFile::at(&folder.file(), false).unwrap_err();
    assert!(matches!(error, CommissionError::Exists(_)), "{error}");
    assert!(
        error.advice().to_string().contains("replaces it"),
        "{}",
        error.advice()
    );
}

/// Drives have no groups, limits and units of the load: only the file has them.
#[test]
fn limits_groups_and_units_of_the_load_are_kept() {
    let folder = Folder::new("from-kept");
    std::fs::write(folder.file(), OLD).unwrap();
    let read = read(&folder.file(), "all", None);
    assert_eq!(read.written.unwrap(), 2);
    assert!(
        read.remarks.len() == 1 && read.remarks[0].sentence.contains("vlt-1"),
        "{:?}",
        read.remarks
    );
    let (old, new) = (
        OLD.parse::<Machine>().unwrap(),
        Machine::read(&folder.file()).unwrap(),
    );
    assert_eq!(new.title, old.title);
    assert_eq!(new.group("fans").unwrap(), ["vlt-1"]);
    let rpm = |machine: &Machine, name| machine.bound(name).map(|bound| bound.rpm);
    assert_eq!(rpm(&new, "vlt-1"), Some(900.0));
    // the drive has another name than in the old file; its MAC address is the same
    assert_eq!(rpm(&new, "akd-1"), rpm(&old, "feed"));
    assert_eq!(new.user_unit("akd-1"), old.user_unit("feed"));
    assert!(new.user_unit("akd-1").is_some());
}

#[test]
fn an_interrupted_reading_leaves_the_file_as_it_was() {
    for text in [Some(OLD), None] {
        let folder = Folder::new("from-interrupted");
        if let Some(text) = text {
            std::fs::write(folder.file(), text).unwrap();
        }
        let read = read(&folder.file(), "all", Some(1));
        let error = read.written.unwrap_err();
        assert_eq!(error.kind(), ErrorKind::Interrupted, "{error}");
        assert_eq!(std::fs::read_to_string(folder.file()).ok().as_deref(), text);
    }
}

/// A drive that is off, or was not selected, does not lose its place in the file.
#[test]
fn a_drive_of_the_file_that_was_not_read_keeps_the_file_as_it_was() {
    for (drives, missing) in [("akd-1", "vlt-1"), ("vlt-1", "feed")] {
        let folder = Folder::new(&format!("from-missing-{missing}"));
        std::fs::write(folder.file(), OLD).unwrap();
        let read = read(&folder.file(), drives, None);
        let error = read.written.unwrap_err();
        assert!(
            error.to_string().ends_with(&format!("not read: {missing}")),
            "{error}"
        );
        assert_eq!(std::fs::read_to_string(folder.file()).unwrap(), OLD);
        // what was read is there
        assert!(folder.0.join(format!("{drives}.backup")).exists());
    }
}

#[test]
fn a_file_that_is_not_a_machine_file_is_not_replaced() {
    let folder = Folder::new("from-invalid");
    std::fs::write(
        folder.file(),
        "[[drive]]\nname = \"akd-1\"\nmax-sped = \"90rpm\"\n",
    )
    .unwrap();
    let error = MachineFile::at(&folder.file(), true).unwrap_err();
    assert!(
        error.kind() == ErrorKind::Usage && error.to_string().contains("line 3"),
        "{error}"
    );
    std::fs::write(folder.file(), "").unwrap();
    assert!(MachineFile::at(&folder.file(), true).is_ok());
    // nothing is read for a file that cannot be written
    let error = MachineFile::at(&folder.0.join("sub/machine.toml"), true).unwrap_err();
    assert!(error.to_string().contains("there is no folder"), "{error}");
}

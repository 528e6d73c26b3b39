//! The archive for support and the page of a machine, of drives in memory.
#![cfg(all(feature = "documents", feature = "simulate"))]
#![allow(clippy::unwrap_used)]

use std::io::Read as _;
use std::path::PathBuf;

use profidrive::Explained as _;
use profidrive::client::ErrorKind;
use profidrive::documents::bundle::{Contents, bundle};
use profidrive::documents::{DocumentError, NewFile, page};
use profidrive::machine::Machine;
use profidrive::report::PlainWording;
use profidrive::{Access, Opening, Outcome, Part, Selector, Wait, parameters};

const PLANT: &str = r#"
    [[drive]]
    name = "akd-1"
    ip = "192.168.0.11/24"
    event = [{ at = "0s", do = "fault=439" }]
    [[drive]]
    name = "vlt-1"
    model = "vlt"
    ip = "192.168.0.12/24"
"#;

/// A folder that goes with the test.
struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Self {
        let path = std::env::temp_dir().join(format!("profidrive-{name}-{}", std::process::id()));
        let _ = std::fs::remove_dir_all(&path);
        std::fs::create_dir_all(&path).unwrap();
        Self(path)
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

fn opening() -> Opening {
    Opening::new(Access::Identity).in_plant(PLANT.parse().unwrap())
}

#[test]
fn an_archive_has_what_can_be_read_and_notes_what_cannot() {
    let folder = Folder::new("bundle");
    let added = folder.0.join("machine.toml");
    std::fs::write(&added, "format = 1\n").unwrap();
    let file = NewFile::at(&folder.0.join("state.zip")).unwrap();
    let selector: Selector = "all,absent".parse().unwrap();
    let contents = Contents {
        files: vec![added.clone(), added],
        ..Contents::default()
    };
    let mut parts = Vec::new();
    let mut progress = |step: profidrive::Step| parts.push(step.part);
    let report = bundle(
        &opening(),
        &selector,
        &contents,
        &file,
        &PlainWording,
        &mut progress,
    )
    .wait()
    .unwrap();
    assert!(!report.complete);
    // two were read, one was not
    assert_eq!(report.outcome(), Outcome::NoAnswer);
    let read: Vec<bool> = report.drives.iter().map(|drive| drive.read).collect();
    assert_eq!(read, [true, true, false]);
    let absent = report
        .drives
        .iter()
        .find(|drive| drive.drive == "absent")
        .unwrap();
    assert!(absent.missing[0].starts_with("not found: "), "{absent:?}");
    for part in [Part::Searching, Part::Requests, Part::Drives, Part::Writing] {
        assert!(parts.contains(&part), "{part:?}");
    }

    let mut zip = zip::ZipArchive::new(std::fs::File::open(file.path()).unwrap()).unwrap();
    let mut text = |name: &str| {
        let mut text = String::new();
        zip.by_name(name).unwrap().read_to_string(&mut text).unwrap();
        text
    };
    for (name, part) in [
        ("README.txt", "drives/akd-1/settings.backup: its settings"),
        ("scan.json", r#""command": "scan""#),
        ("doctor.json", r#""schema": "profidrive/1""#),
        ("drives/akd-1/faults.json", r#""number": 439"#),
        ("drives/akd-1/status.json", r#""cause": "fault""#),
        ("drives/vlt-1/info.json", r#""model": "VLT""#),
        ("drives/vlt-1/settings.backup", "profidrive backup "),
        ("drives/absent/problems.txt", "not found: "),
        ("added/machine.toml", "format = 1"),
        ("added/machine-.toml", "format = 1"),
    ] {
        assert!(text(name).contains(part), "{name}: {}", text(name));
    }
    let again = NewFile::at(file.path()).unwrap_err();
    assert_eq!(
        (again.kind(), std::fs::read_dir(&folder.0).unwrap().count()),
        (ErrorKind::Local, 2)
    );
}

#[test]
fn a_file_to_add_that_is_not_there_leaves_no_archive() {
    let folder = Folder::new("bundle-added");
    let file = NewFile::at(&folder.0.join("state.zip")).unwrap();
    let contents = Contents {
        files: vec![folder.0.join("no-such.log")],
        ..Contents::default()
    };
    let selector = Selector::all();
    let error = bundle(
        &opening(),
        &selector,
        &contents,
        &file,
        &PlainWording,
        &mut |_| {},
    )
    .wait()
    .unwrap_err();
    assert!(matches!(error, DocumentError::NotRead { .. }), "{error}");
    assert_eq!(std::fs::read_dir(&folder.0).unwrap().count(), 0);
}

#[test]
fn a_page_shows_drives_changed_settings_and_faults_and_nothing_of_it_is_markup() {
    let folder = Folder::new("page");
    let machine: Machine = r#"
        title = "<b>Press & feed</b>"
        [[drive]]
        name = "akd-1"
        model = "akd"
        groups = ["line1"]
        max-speed = "500rpm"
    "#
    .parse()
    .unwrap();
    let opening = opening();
    let mut network = opening.clone().open().unwrap();
    let mut drive = network.find(&"akd-1".parse().unwrap()).wait().unwrap();
    let change = ["DRV.ACC=5123rpm/s".parse().unwrap()];
    parameters::write(&mut network, &mut drive, &change, parameters::Write::default())
        .wait()
        .unwrap();
    let file = NewFile::at(&folder.0.join("machine.html")).unwrap();
    let about = (&Selector::all(), Some(&machine));
    let report = page::page(&opening, &mut network, about, &file, &PlainWording, &mut |_| {})
        .wait()
        .unwrap();
    assert_eq!((report.drives.len(), report.outcome()), (2, Outcome::Complete));
    let text = std::fs::read_to_string(file.path()).unwrap();
    assert!(!text.contains("<b>"), "the title is escaped");
    let row = text.lines().find(|line| line.contains("DRV.ACC<")).unwrap();
    for part in [">5123<", ">3000<", ">rpm/s<"] {
        assert!(row.contains(part), "{row}");
    }
    for part in [
        "Press &#38; feed",
        "line1",
        "500 rpm",
        "akd-1",
        "F439",
        "192.168.0.12/24",
        "@media print",
    ] {
        assert!(text.contains(part), "{part}");
    }
    assert!(
        !text.contains("<script") && !text.contains("http"),
        "it needs nothing else"
    );
}

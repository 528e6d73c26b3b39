//! A drive whose state folder is on a full disk: who saves hears of it, and the drive goes on.

use std::path::Path;
use std::time::Duration;

use system_tests::{Lab, Running, Side, built, client};

const SHORT: Duration = Duration::from_secs(20);

/// Returns a drive of `model` whose state folder has `room` for files; a filler takes the rest.
fn drive_on_small_disk(lab: &Lab, model: &str, room: usize) -> Running {
    let script = format!(
        "mkdir /run/state && mount -t tmpfs -o size=64k full /run/state && \
         head -c $((65536 - {room})) /dev/zero >/run/state/filler && \
         exec {} simulate --model {model} --name drive-1 --ip 192.168.77.50/24 -i dev0 --state /run/state",
        built("profidrive").display()
    );
    let mut drive = lab.spawn(Side::Device, "sh", ["-c", script.as_str()]);
    drive.wait_for("Ctrl-C ends", SHORT);
    drive
}

/// Makes room on the disk of the drive.
fn make_room(drive: &Running) {
    // its folders are in a mount namespace of its own
    let namespace = Path::new("/proc").join(drive.pid().to_string()).join("root");
    std::fs::remove_file(namespace.join("run/state/filler")).unwrap();
}

/// A Vacon saves each change by itself, so a value that it has already may not be saved.
#[test]
fn the_repeat_of_a_change_that_was_not_saved_saves_it_or_fails_again() {
    let lab = Lab::new("full-repeat");
    let drive = drive_on_small_disk(&lab, "vacon", 8192);
    for _ in 0..2 {
        let refused = client(&lab, &["write", "drive-1", "ID103=8s"]);
        assert_eq!(refused.code, Some(3), "{refused:?}");
    }
    let read = client(&lab, &["read", "drive-1", "ID103"]).ok().out;
    assert!(read.contains(" 8 "), "it counts until the power goes: {read}");
    make_room(&drive);
    let saved = client(&lab, &["write", "drive-1", "ID103=8s"]).ok();
    assert!(saved.err.contains("saves every write"), "{saved:?}");
}

#[test]
fn a_name_that_cannot_be_stored_is_not_set() {
    let lab = Lab::new("full-name");
    let drive = drive_on_small_disk(&lab, "akd", 8192);
    for _ in 0..2 {
        let refused = client(&lab, &["name", "drive-1", "other"]);
        assert_eq!(refused.code, Some(3), "{refused:?}");
        assert!(
            refused.err.contains("resource error") && refused.err.contains("could not store it"),
            "{refused:?}"
        );
    }
    client(&lab, &["read", "drive-1", "922"]).ok();
    make_room(&drive);
    client(&lab, &["name", "drive-1", "other"]).ok();
    client(&lab, &["read", "other", "922"]).ok();
}

#[test]
fn saving_on_a_full_disk_is_an_error_to_the_one_who_saves() {
    let lab = Lab::new("full-disk");
    // three pages: name and address fit, the parameters of an AKD do not
    let mut drives = drive_on_small_disk(&lab, "akd", 3 * 4096);
    client(&lab, &["write", "drive-1", "DRV.ACC=5000rpm/s"]).ok();
    let refused = client(&lab, &["write", "drive-1", "DRV.NVSAVE=1"]);
    assert_eq!(refused.code, Some(3), "{refused:?}");
    assert!(refused.err.contains("0x11"), "{refused:?}");
    drives.wait_for("No space left", SHORT);
    let refused = client(&lab, &["write", "drive-1", "DRV.ACC=5000rpm/s", "--save"]);
    assert!(
        refused.code == Some(3)
            && refused.err.contains("not saved")
            && !refused.err.contains("saved in the drive"),
        "{refused:?}"
    );
    // the value counts until the power goes, and the drive answers as before
    let read = client(&lab, &["read", "drive-1", "DRV.ACC"]).ok().out;
    assert!(read.contains("5000"), "{read}");
}

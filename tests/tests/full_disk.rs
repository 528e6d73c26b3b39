//! A drive whose state folder is on a full disk: who saves hears of it, and the drive goes on.

use std::time::Duration;

use system_tests::{Lab, Side, built, client};

const SHORT: Duration = Duration::from_secs(20);

#[test]
fn saving_on_a_full_disk_is_an_error_to_the_one_who_saves() {
    let lab = Lab::new("full-disk");
    // three pages: name and address fit, the parameters of an AKD do not
    let script = format!(
        "mkdir /run/state && mount -t tmpfs -o size=12k full /run/state && \
         exec {} simulate --model akd --name akd-1 --ip 192.168.77.50/24 -i dev0 --state /run/state",
        built("profidrive").display()
    );
    let mut drives = lab.spawn(Side::Device, "sh", ["-c", script.as_str()]);
    drives.wait_for("Ctrl-C ends", SHORT);
    client(&lab, &["write", "akd-1", "DRV.ACC=5000rpm/s"]).ok();
    let refused = client(&lab, &["write", "akd-1", "DRV.NVSAVE=1"]);
    assert_eq!(refused.code, Some(3), "{refused:?}");
    assert!(refused.err.contains("0x11"), "{refused:?}");
    drives.wait_for("No space left", SHORT);
    let refused = client(&lab, &["write", "akd-1", "DRV.ACC=5000rpm/s", "--save"]);
    assert!(
        refused.code == Some(3)
            && refused.err.contains("not saved")
            && !refused.err.contains("the drive keeps"),
        "{refused:?}"
    );
    // the value counts until the power goes, and the drive answers as before
    let read = client(&lab, &["read", "akd-1", "DRV.ACC"]).ok().out;
    assert!(read.contains("5000"), "{read}");
}

//! A network and a machine on which somebody means harm.

use std::fs;
use std::os::unix::fs::symlink;
use std::time::Duration;

use system_tests::{Lab, Side, built, client, simulate};

const SHORT: Duration = Duration::from_secs(20);

#[test]
fn the_state_folder_follows_no_link_has_one_user_and_is_checked() {
    let lab = Lab::new("hostile-state");
    let state = lab.folder().join("shared");
    fs::create_dir_all(&state).unwrap();
    let victim = lab.folder().join("victim");
    fs::write(&victim, "precious").unwrap();
    for planted in ["akd-1.network.json.new", "akd-1.parameters.new"] {
        let _ = fs::remove_file(state.join(planted));
        symlink(&victim, state.join(planted)).unwrap();
    }
    let broken = r#"{"schema":"profidrive/1","name":"../../x","ip":"255.255.255.255"}"#;
    fs::write(state.join("akd-1.network.json"), broken).unwrap();

    let folder = state.to_str().unwrap().to_owned();
    let drive = ["--name", "akd-1", "--ip", "192.168.77.50/24", "--state", &folder];
    let first = simulate(&lab, &drive);
    let told = first.err();
    assert!(
        told.contains("akd-1.network.json is not used") && told.contains("akd-1.network.json.broken"),
        "{told}"
    );
    client(&lab, &["write", "akd-1", "DRV.ACC=5000rpm/s", "DRV.NVSAVE=1"]).ok();
    client(&lab, &["name", "akd-1", "akd-7"]).ok();

    let other = ["simulate", "-i", "dev0", "--name", "akd-2", "--state", &folder];
    let second = lab.run(Side::Device, built("profidrive"), other, SHORT);
    assert_eq!(second.code, Some(1), "{second:?}");
    assert!(
        second.err.contains("is in use by `profidrive simulate`, process"),
        "{}",
        second.err
    );

    first.interrupt(SHORT).ok();
    assert_eq!(fs::read_to_string(&victim).unwrap(), "precious");
    let kept = fs::read_to_string(state.join("akd-1.network.json")).unwrap();
    assert!(
        kept.contains(r#""name": "akd-7""#) && kept.contains("checksum"),
        "{kept}"
    );
    assert!(
        fs::read_to_string(state.join("akd-1.parameters"))
            .unwrap()
            .contains("DRV.ACC = 5000")
    );
    let broken_now = fs::read_to_string(state.join("akd-1.network.json.broken")).unwrap();
    assert_eq!(broken_now, broken);
    let third = simulate(&lab, &drive);
    assert!(!third.err().contains("not used"), "{}", third.err());
    client(&lab, &["read", "akd-7", "DRV.ACC"]).ok();
}

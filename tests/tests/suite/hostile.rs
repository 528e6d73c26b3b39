//! Behaviour on a hostile network and machine.

use std::fs;
use std::os::unix::fs::symlink;
use std::time::Duration;

use system_tests::{Lab, Side, built, client, peer, simulate};

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
    let error = first.err();
    assert!(
        error.contains("akd-1.network.json is not used") && error.contains("akd-1.network.json.broken"),
        "{error}"
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

#[test]
fn a_drive_with_a_controller_refuses_a_rename_with_a_cause() {
    let lab = Lab::new("hostile-name");
    let mac = "02:50:4e:00:00:71";
    let turn = ["-i", "ctl0", "run", "akd-1", "--velocity", "60rpm", "--for", "3s"];
    let turn = [&turn[..], &["--cycle", "32ms", "--watchdog", "31"]].concat();
    let script = peer("dcp_flood.py");
    let rename = [script.to_str().unwrap(), "ctl0", mac, "0.5", "10"];
    for (option, kept) in [("refuse", true), ("accept", false)] {
        let drive = ["--name", "akd-1", "--ip", "192.168.77.50/24", "--mac", mac];
        let drive = simulate(&lab, &[&drive[..], &["--dcp-in-operation", option]].concat());
        let mut run = lab.spawn(Side::Controller, built("profidrive"), &turn);
        run.wait_for("S4", SHORT);
        lab.run(Side::Controller, "python3", rename, SHORT).ok();
        let run = run.finish(SHORT);
        let said = drive.out();
        if kept {
            assert_eq!(run.code, Some(0), "{run:?}");
            for why in ["2/2 name of station", "5/6 reset to factory"] {
                let words = format!("refused by DCP from 02:00:00:00:0b:ad: {why}, while the motor runs");
                assert!(said.contains(&words), "{said}");
            }
        } else {
            assert_eq!(run.code, Some(4), "{run:?}");
            assert!(said.contains("disconnected"), "{said}");
        }
    }
}

#[test]
fn texts_of_a_drive_do_not_reach_the_terminal_as_they_are() {
    let lab = Lab::new("hostile-text");
    let state = lab.folder().join("kept");
    let _ = fs::remove_dir_all(&state);
    fs::create_dir_all(&state).unwrap();
    let tag = format!("{:<54}", "\u{1b}[2J\u{7}\u{7f}\u{9b}31m\u{202e}gpj\u{200b}");
    let tag: String = tag.bytes().take(54).map(|octet| format!("{octet:02x}")).collect();
    let blank = |octets: usize| "20".repeat(octets);
    let network = serde_json::json!({
        "schema": "profidrive/1", "name": "akd-1", "ip": "192.168.77.50", "mask": "255.255.255.0",
        "gateway": "0.0.0.0", "im1": tag, "im2": blank(16), "im3": blank(54), "im4": "00".repeat(54),
    });
    fs::write(state.join("akd-1.network.json"), network.to_string()).unwrap();
    let _drive = simulate(&lab, &["--name", "akd-1", "--state", state.to_str().unwrap()]);
    for arguments in [
        &["info", "akd-1"][..],
        &["--json", "info", "akd-1"],
        &["-v", "scan"],
    ] {
        let finished = client(&lab, arguments);
        let shown = [finished.out.as_str(), finished.err.as_str()].concat();
        let raw = shown
            .chars()
            .find(|&c| (c.is_control() && c != '\n') || ('\u{200b}'..='\u{202e}').contains(&c));
        assert_eq!(raw, None, "{arguments:?}: {shown:?}");
    }
    let info = client(&lab, &["info", "akd-1"]).ok().out;
    assert!(info.contains("\\u{1b}[2J"), "{info}");
}

//! Plants on a wire: what the time line and `profidrive inject` do to a drive, its client sees.

use std::fs;
use std::path::PathBuf;
use std::time::Duration;

use system_tests::{Finished, Lab, Running, Side, built, client, judge, wait_until};

const SHORT: Duration = Duration::from_secs(20);

/// Returns the example with everything in it, which the page about virtual drives names.
fn example() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../examples/plants/press.toml")
}

fn start(lab: &Lab, plant: &str) -> Running {
    let file = lab.folder().join("plant.toml");
    fs::write(&file, plant).unwrap();
    let file = file.to_str().unwrap();
    let mut drives = lab.spawn(
        Side::Device,
        built("profidrive"),
        ["simulate", file, "-i", "dev0"],
    );
    drives.wait_for("Ctrl-C ends", Duration::from_secs(5));
    drives
}

fn inject(lab: &Lab, arguments: &[&str]) -> Finished {
    let mut all = vec!["inject"];
    all.extend(arguments);
    lab.run(Side::Controller, built("profidrive"), all, SHORT)
}

#[test]
fn what_happens_to_a_drive_is_seen_by_its_client() {
    let lab = Lab::new("plant");
    let capture = lab.capture("traffic");
    let mut drives = start(
        &lab,
        r#"
        [[drive]]
        name = "press-1"
        ip = "192.168.77.50/24"
        parameters = { "DRV.ACC" = "1234rpm/s" }
        event = [{ at = "100ms", do = "warning=107" }]
        [[drive]]
        name = "press-2"
        ip = "192.168.77.51/24"
        "#,
    );
    drives.wait_for("! warning=107", SHORT);
    let read = client(&lab, &["read", "press-1", "DRV.ACC", "DRV.WARNING1"])
        .ok()
        .out;
    assert!(read.contains("1234") && read.contains("107"), "{read}");

    inject(&lab, &["press-2", "fault=439"]).ok();
    drives.wait_for("fault F439", SHORT);
    let faults = client(&lab, &["read", "press-2", "r947[0]"]).ok().out;
    assert!(faults.contains("439"), "{faults}");
    let others = client(&lab, &["read", "press-1", "r947[0]"]).ok().out;
    assert!(!others.contains("439"), "only the one meant: {others}");
    client(&lab, &["ack", "press-2"]).ok();

    // wrong answers are reported as such, and end on request
    inject(&lab, &["press-1", "answers=error 0x11"]).ok();
    let refused = client(&lab, &["read", "press-1", "DRV.ACC"]);
    assert_eq!(refused.code, Some(3), "{refused:?}");
    assert!(refused.err.contains("0x11"), "{refused:?}");
    inject(&lab, &["press-1", "answers=reference"]).ok();
    let wrong = client(&lab, &["read", "press-1", "DRV.ACC"]);
    assert!(wrong.code.is_some_and(|code| code != 0), "{wrong:?}");
    inject(&lab, &["press-1", "answers=none"]).ok();
    client(&lab, &["read", "press-1", "DRV.ACC"]).ok();

    // a cable that is pulled for a while; the drive is known by its address too
    inject(&lab, &["192.168.77.50", "cable=pulled", "--for", "3s"]).ok();
    let gone = client(&lab, &["read", "press-1", "DRV.ACC"]);
    assert_eq!(gone.code, Some(4), "{gone:?}");
    let back = wait_until(SHORT, || {
        client(&lab, &["read", "press-1", "DRV.ACC"]).code == Some(0)
    });
    assert!(back, "the cable is plugged in again");

    // a second drive of the name: which one is meant must be said
    let second = lab.spawn(
        Side::Device,
        built("profidrive"),
        [
            "simulate",
            "--name",
            "press-1",
            "--mac",
            "02:50:4e:00:00:77",
            "-i",
            "dev0",
        ],
    );
    let both = wait_until(SHORT, || inject(&lab, &["press-1", "sto=on"]).code == Some(2));
    assert!(both, "two drives go by this name");
    inject(&lab, &["02:50:4e:00:00:77", "sto=on"]).ok();
    drop(second);

    for (arguments, code, words) in [
        (&["press-9", "fault=439"][..], 4, "press-1"),
        (&["press-1", "fualt=439"], 2, "keys: fault"),
        (&["press-1", "fault=999"], 3, "has no fault 999; next to it"),
        (&["press-1", "fault=439", "--for", "1s"], 2, "has no end"),
    ] {
        let refused = inject(&lab, arguments);
        assert_eq!(refused.code, Some(code), "{refused:?}");
        assert!(refused.err.contains(words), "{refused:?}");
    }
    judge::judge(&capture.stop())
        .clean()
        .saw("pn_dcp", 2)
        .saw("pn_io", 10);
}

#[test]
fn a_connected_controller_meets_what_happens() {
    let lab = Lab::new("plant-cyclic");
    let capture = lab.capture("traffic");
    let mut drives = start(
        &lab,
        r#"
        [[drive]]
        name = "press-1"
        ip = "192.168.77.50/24"
        event = [{ position = "1rev", do = "fault=439" }]
        "#,
    );
    let run = client(&lab, &["run", "press-1", "--velocity", "60rpm", "--for", "5s"]);
    assert!(run.code.is_some_and(|code| code != 0), "{run:?}");
    assert!(run.err.contains("439"), "{run:?}");
    drives.wait_for("fault F439", SHORT);
    judge::judge(&capture.stop())
        .clean()
        .saw("pn_dcp", 2)
        .saw("pn_io", 10);
}

#[test]
fn the_example_gives_the_same_trace_every_time() {
    let play = || {
        let output = std::process::Command::new(built("profidrive"))
            .arg("simulate")
            .arg(example())
            .arg("--virtual-time")
            .output()
            .unwrap();
        assert!(output.status.success(), "{output:?}");
        (
            String::from_utf8(output.stdout).unwrap(),
            String::from_utf8(output.stderr).unwrap(),
        )
    };
    let (trace, said) = play();
    assert_eq!(trace, play().0);
    assert!(said.contains("times real time"), "{said}");
    for words in [
        "-> S4 operation",
        "! load=",
        "! cable=pulled",
        "fault F702",
        "bit 0 = 1 is gone",
    ] {
        assert!(trace.contains(words), "{words}: {trace}");
    }
}

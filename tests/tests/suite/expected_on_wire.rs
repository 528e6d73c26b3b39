//! Expectations of drives on an interface: their clock starts with the first connection of a controller.

use std::fs;
use std::time::Duration;

use system_tests::{Finished, Lab, Running, Side, built, client};

const SHORT: Duration = Duration::from_secs(20);

const PLANT: &str = r#"
    expect = [{ name = "of virtual time", at = "1s", drive = "press-1", state = "S4" }]
    [[drive]]
    name = "press-1"
    ip = "192.168.77.50/24"
    [[drive]]
    name = "press-2"
    ip = "192.168.77.51/24"
"#;

const EXPECTED: &str = r#"expect = [
    { name = "turns", within = "10s", drive = "press-1", speed = ">=50rpm" },
    { name = "stops", within = "20s", after = { drive = "press-1", state = "S4" }, drive = "press-1", connected = false },
    { name = "stands", always = true, drive = "press-2", moving = false },
    { name = "trips", within = "1s", drive = "press-2", fault = 439 },
]"#;

fn start(lab: &Lab) -> Running {
    let write = |name: &str, text: &str| {
        let path = lab.folder().join(name);
        fs::write(&path, text).unwrap();
        path.to_str().unwrap().to_owned()
    };
    let (plant, expected) = (write("plant.toml", PLANT), write("expect.toml", EXPECTED));
    let report = lab.folder().join("report.xml");
    let report = report.to_str().unwrap();
    let mut drives = lab.spawn(
        Side::Device,
        built("profidrive"),
        [
            "simulate", &plant, "-i", "dev0", "--expect", &expected, "--junit", report,
        ],
    );
    drives.wait_for("Ctrl-C ends", Duration::from_secs(5));
    drives
}

fn report(lab: &Lab) -> String {
    fs::read_to_string(lab.folder().join("report.xml")).unwrap()
}

#[test]
fn drives_on_a_wire_are_checked_from_the_first_connection_on() {
    let lab = Lab::new("expected");
    let drives = start(&lab);
    client(&lab, &["run", "press-1", "--velocity", "60rpm", "--for", "1s"]).ok();
    let Finished { code, err, .. } = drives.interrupt(SHORT);
    assert_eq!(code, Some(5), "{err}");
    assert!(err.contains("1 of 4 expectations lost"), "{err}");
    assert!(
        err.contains("expect.toml, line 5: press-2: trips: not met"),
        "{err}"
    );
    assert!(
        err.contains("the expectations of the plant file are left out"),
        "{err}"
    );
    let report = report(&lab);
    assert!(
        report.contains("tests=\"4\" failures=\"1\" errors=\"0\""),
        "{report}"
    );
}

#[test]
fn without_a_controller_nothing_is_met() {
    let lab = Lab::new("expected-none");
    let drives = start(&lab);
    client(&lab, &["read", "press-1", "DRV.ACC"]).ok();
    let Finished { code, err, .. } = drives.interrupt(SHORT);
    assert_eq!(code, Some(5), "{err}");
    assert!(err.contains("4 of 4 expectations lost"), "{err}");
    assert!(err.contains("actual:   no controller connected"), "{err}");
    let report = report(&lab);
    assert!(
        report.contains("tests=\"4\" failures=\"0\" errors=\"4\""),
        "{report}"
    );
}

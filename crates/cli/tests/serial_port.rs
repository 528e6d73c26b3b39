//! The binary at serial ports: `simulate --serial` at one end of a line, the commands of a user at the other. The ports
//! are pseudo-terminals, and the cable between them is a thread that may spoil what passes.
#![cfg(unix)] // pseudo-terminals

mod binary;
mod cable;

use std::time::{Duration, Instant};

use binary::{profidrive, stderr, stdout};
use cable::{Cable, Simulated};

#[test]
fn a_user_reads_writes_and_runs_a_drive_at_a_serial_port() {
    let cable = Cable::lay();
    let _drives = Simulated::start(&cable, &["--count", "2", "--address", "1"]);
    let second = cable.drive("fc", 2);
    let output = profidrive(&["info", &second]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert!(stdout(&output).contains("(AKD)"), "{}", stdout(&output));
    let read = |drive: &str| {
        let output = profidrive(&["--json", "read", drive, "DRV.ACC", "930"]);
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
        let document: serde_json::Value = serde_json::from_str(&stdout(&output)).expect("a document");
        document["parameters"][0]["value"].as_f64().expect("a number")
    };
    let before = read(&cable.drive("fc", 1));
    assert!((before - 5000.0).abs() > 1.0, "{before}");
    let output = profidrive(&["write", &second, "DRV.ACC=5000rpm/s"]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert!((read(&second) - 5000.0).abs() < 1.0);
    assert_eq!(read(&cable.drive("fc", 1)), before, "the other one is as it was");
    let output = profidrive(&["run", &second, "--velocity", "120rpm", "--for", "1s"]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert!(
        stderr(&output).contains("axis at rest, control released"),
        "{}",
        stderr(&output)
    );
    let output = profidrive(&["faults", &second]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let output = profidrive(&["status", &second]);
    assert!(stdout(&output).contains("S2 ready"), "{}", stdout(&output));
}

#[test]
fn uss_carries_the_same() {
    let cable = Cable::lay();
    let _drives = Simulated::start(&cable, &["--protocol", "uss", "--address", "31"]);
    let drive = cable.drive("uss", 31);
    let output = profidrive(&["describe", &drive, "DRV.ACC"]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let output = profidrive(&["run", &drive, "--velocity", "60rpm", "--for", "500ms"]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
}

#[test]
fn noise_halves_and_echo_in_the_middle_of_a_session_are_borne() {
    let cable = Cable::lay();
    let _drives = Simulated::start(&cable, &[]);
    cable.echo(true);
    cable.spoil_every(9);
    let drive = cable.drive("fc", 1);
    let output = profidrive(&[
        "read",
        &drive,
        "930",
        "DRV.ACC",
        "DRV.DEC",
        "964[0..3]",
        "947[0..7]",
    ]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert!(cable.spoiled() > 0);
    let output = profidrive(&["run", &drive, "--velocity", "60rpm", "--for", "2s"]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
}

#[test]
fn a_line_that_is_unplugged_ends_a_motion_with_words_and_in_time() {
    let cable = Cable::lay();
    let mut drives = Simulated::start(&cable, &[]);
    let drive = cable.drive("fc", 1);
    let began = Instant::now();
    let cut = cable.cut_after(Duration::from_secs(3));
    let output = profidrive(&["run", &drive, "--velocity", "60rpm", "--for", "60s"]);
    cut.join().expect("cut");
    assert!(began.elapsed() < Duration::from_secs(30));
    assert_eq!(output.status.code(), Some(4), "{}", stderr(&output));
    assert!(
        stderr(&output).contains("does not answer any more"),
        "{}",
        stderr(&output)
    );
    let printed = drives.output_until("F702");
    assert!(
        printed.contains("connection lost") && printed.contains("F702"),
        "{printed}"
    );
}

#[test]
fn a_simulation_without_its_port_is_never_called_ready() {
    let output = profidrive(&["simulate", "--model", "akd", "--serial", "/dev/ttyNOWHERE"]);
    assert_ne!(output.status.code(), Some(0));
    let printed = stdout(&output) + &stderr(&output);
    assert!(
        printed.contains("there is no serial port /dev/ttyNOWHERE"),
        "{printed}"
    );
    assert!(!printed.contains("ready"), "{printed}");
}

#[test]
fn a_missing_drive_is_reported() {
    let cable = Cable::lay();
    let output = profidrive(&["read", "fc:/dev/ttyNOWHERE/1", "930"]);
    assert_eq!(output.status.code(), Some(4));
    assert!(
        stderr(&output).contains("there is no serial port /dev/ttyNOWHERE"),
        "{}",
        stderr(&output)
    );
    // no station at the other end
    let output = profidrive(&["read", &cable.drive("fc", 5), "930"]);
    assert_eq!(output.status.code(), Some(4));
    assert!(
        stderr(&output).contains("the line is silent"),
        "{}",
        stderr(&output)
    );
    let output = profidrive(&["read", "fc:ttyS0/200", "930"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(stderr(&output).contains("1 to 126"), "{}", stderr(&output));
    let output = profidrive(&["name", &cable.drive("fc", 1), "press"]);
    assert_eq!(output.status.code(), Some(2), "{}", stderr(&output));
    let output = profidrive(&["simulate", "--serial", "/dev/null"]);
    assert!(
        stderr(&output).contains("is not a serial port"),
        "{}",
        stderr(&output)
    );
    let output = profidrive(&["simulate", "--serial", "/dev/null", "--address", "0"]);
    assert!(
        stderr(&output).contains("no drive can have the address 0"),
        "{}",
        stderr(&output)
    );
}

#[test]
fn a_backup_over_the_line_compares_equal_and_is_restored() {
    let cable = Cable::lay();
    let _drives = Simulated::start(&cable, &["--baud", "115200"]);
    let drive = format!("{},baud=115200", cable.drive("fc", 1));
    let folder = tempdir();
    let file = folder.join("axis.backup");
    let file = file.to_str().expect("text");
    let output = profidrive(&["backup", &drive, "-o", file]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let output = profidrive(&["diff", file, &drive]);
    assert_eq!(
        output.status.code(),
        Some(0),
        "{}{}",
        stdout(&output),
        stderr(&output)
    );
    let output = profidrive(&["write", &drive, "DRV.DEC=4000rpm/s"]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let output = profidrive(&["diff", file, &drive]);
    assert_eq!(output.status.code(), Some(5), "{}", stdout(&output));
    let output = profidrive(&["restore", &drive, file]);
    assert_eq!(
        output.status.code(),
        Some(0),
        "{}{}",
        stdout(&output),
        stderr(&output)
    );
    let output = profidrive(&["diff", file, &drive]);
    assert_eq!(output.status.code(), Some(0), "{}", stdout(&output));
    std::fs::remove_dir_all(folder).expect("removed");
}

fn tempdir() -> std::path::PathBuf {
    let folder = std::env::temp_dir().join(format!("profidrive-serial-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a folder");
    folder
}

#[test]
fn inject_reaches_a_drive_at_a_line_by_name_and_by_port() {
    let cable = Cable::lay();
    // other tests simulate at the same time
    let name = format!("press{}", std::process::id());
    let (first, other) = (format!("{name}-1"), format!("{name}-2"));
    let mut drives = Simulated::start(&cable, &["--count", "2", "--name", &name]);
    let second = cable.far_drive("fc", 2);
    let inject = |drive: &str, what: &str| {
        let output = profidrive(&["inject", drive, what]);
        (output.status.code(), stdout(&output) + &stderr(&output))
    };
    let faults = |number| stdout(&profidrive(&["faults", &cable.drive("fc", number)]));
    let (code, printed) = inject(&first, "fault=439");
    assert_eq!(code, Some(0), "{printed}");
    assert!(faults(1).contains("F439"), "{}", faults(1));
    assert!(faults(2).contains("no fault is present"), "{}", faults(2));
    let (code, printed) = inject(&second, "fault=702");
    assert_eq!(code, Some(0), "{printed}");
    assert!(faults(2).contains("F702"), "{}", faults(2));
    let protocol = drives.output_until("fault=702");
    assert!(
        protocol.contains(&other) && protocol.contains("fault=702"),
        "{protocol}"
    );
    // what only a network can suffer, and a drive that is not there
    let (code, printed) = inject(&first, "cable=pulled");
    assert!(
        code == Some(4) || printed.contains("is of a network"),
        "{code:?} {printed}"
    );
    let (code, printed) = inject(&cable.far_drive("fc", 9), "fault=439");
    assert_eq!(code, Some(4), "{printed}");
    assert!(printed.contains(&second), "{printed}");
    let output = profidrive(&["ack", &cable.drive("fc", 1)]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert!(faults(1).contains("no fault is present"), "{}", faults(1));
}

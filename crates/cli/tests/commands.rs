//! The binary as a user meets it: arguments in, output and exit code out.

mod binary;

use binary::{onto, profidrive, profidrive_on, stderr, stdout};

#[test]
fn explain_a_control_word() {
    let output = profidrive(&["explain", "0x047F", "--as", "stw1", "--mode", "velocity"]);
    assert_eq!(output.status.code(), Some(0));
    assert_eq!(
        stdout(&output),
        "STW1 0x047F   0000 0100 0111 1111\n\
         \x20 means  run: follows the setpoint\n\
         \x20 set    ON, EN_OP, EN_RAMP, UNFREEZE, EN_SETPOINT, CTRL_PLC\n\
         \x20 stops  OFF2 not active, OFF3 not active\n\
         \x20 bit\n\
         \x20   0  1  ON            ON\n\
         \x20   1  1  OFF2          OFF2 not active\n\
         \x20   2  1  OFF3          OFF3 not active\n\
         \x20   3  1  EN_OP         operation enabled\n\
         \x20   4  1  EN_RAMP       ramp generator enabled\n\
         \x20   5  1  UNFREEZE      ramp generator runs\n\
         \x20   6  1  EN_SETPOINT   setpoint enabled\n\
         \x20   7  0  ACK           no acknowledge\n\
         \x20   8  0  JOG1          no jog 1\n\
         \x20   9  0  JOG2          no jog 2\n\
         \x20  10  1  CTRL_PLC      control by PLC: process data valid\n\
         \x20  11  0  BIT11         -\n\
         \x20  12  0  BIT12         -\n\
         \x20  13  0  BIT13         -\n\
         \x20  14  0  BIT14         -\n\
         \x20  15  0  BIT15         -\n"
    );
    assert_eq!(stderr(&output), "");
}

/// AKD manual 5.4 and 5.5: the words of the issue, in the mode that is named, and in both where none is.
#[test]
fn explain_names_the_bits_of_position_mode() {
    let explained = |line: &[&str]| {
        let output = profidrive(&[&["explain"], line].concat());
        assert_eq!(output.status.code(), Some(0), "{output:?}");
        stdout(&output)
    };
    let control = explained(&["0x3D7F", "--as", "stw1", "--mode", "position"]);
    assert!(
        control.contains(
            "\n  set    ON, EN_OP, NO_REJECT, NO_INT_STOP, START_TASK, JOG1, CTRL_PLC, HOMING, RT_JOG, RT_JOG_CCW\n"
        ),
        "{control}"
    );
    assert!(
        !control.contains("follows the setpoint") && !control.contains("BIT11"),
        "{control}"
    );
    let status = explained(&["0x2B37", "--as", "zsw1", "--mode", "position"]);
    assert!(
        status.contains("\n  set    READY_ON, READY_OP, OPERATION, IN_TOLERANCE, CTRL_REQ, HOMED, STOPPED\n"),
        "{status}"
    );
    assert!(
        status.contains("   8  1  IN_TOLERANCE  following error in the window\n"),
        "{status}"
    );

    let both = explained(&["0x2B37", "--as", "zsw1"]);
    let (velocity, position) = both.split_once("in position mode").unwrap();
    assert!(velocity.contains("BIT11, BIT13"), "{both}");
    assert!(
        position.contains("HOMED, STOPPED") && !position.contains("READY_ON      "),
        "{both}"
    );
    let json: serde_json::Value = serde_json::from_str(&stdout(&profidrive(&[
        "--json", "explain", "0x3D7F", "--as", "stw1",
    ])))
    .unwrap();
    assert_eq!(json["mode"], "velocity");
    assert_eq!(json["position"]["word"]["bits"][11]["name"], "HOMING", "{json}");
    let refused = profidrive(&["explain", "702", "--as", "fault", "--mode", "position"]);
    assert_eq!(refused.status.code(), Some(2), "{refused:?}");
}

/// A telegram that selects traversing tasks is enough to read its words in position mode.
#[test]
fn decode_names_the_bits_of_telegrams_for_positioning() {
    for (telegram, control) in [
        ("7", "3D7F 0000"),
        ("9", "3D7F 0000 0000 00000000 00000000 0000 0000 0000"),
    ] {
        let line = [
            "decode",
            "--hex",
            control,
            "--telegram",
            telegram,
            "--from",
            "controller",
        ];
        let text = stdout(&profidrive(&line));
        assert!(
            text.contains("NO_REJECT, NO_INT_STOP, START_TASK, JOG1, CTRL_PLC, HOMING"),
            "{text}"
        );
        assert!(!text.contains("follows the setpoint"), "{text}");
    }
    let text = stdout(&profidrive(&[
        "decode",
        "--hex",
        "2B37 0000",
        "--telegram",
        "7",
        "--from",
        "drive",
    ]));
    assert!(text.contains("CTRL_REQ, HOMED, STOPPED]"), "{text}");
}

#[test]
fn what_cannot_be_written_is_a_failure_of_every_command() {
    let hex = "05 02 00 01 10 01 03 A2 00 00 42 01 00 02";
    for line in [
        &["explain", "0x047F", "--as", "stw1"][..],
        &["--json", "explain", "S4", "--as", "state"],
        &["decode", "--hex", hex],
        &["--json", "decode", "--hex", hex],
        &["completions", "bash"],
        &["demo", "--fast"],
        &["--json", "demo", "--fast"],
        &["inject"],
        &["--help"],
        &["read", "--help"],
        &["--version"],
        &["gsdml", "export", "--help"],
    ] {
        let full = std::fs::OpenOptions::new()
            .write(true)
            .open("/dev/full")
            .expect("there");
        let output = onto(line, full.into());
        assert_eq!(output.status.code(), Some(1), "{line:?}: {output:?}");
        let message = stderr(&output);
        let words = "error: the output cannot be written: No space left on device";
        assert_eq!(message.matches(words).count(), 1, "{line:?}: {message}");
        // who had enough is not a failure
        let (reader, writer) = std::io::pipe().expect("a pipe");
        drop(reader);
        let output = onto(line, writer.into());
        assert_eq!(output.status.code(), Some(0), "{line:?}: {output:?}");
        assert!(!stderr(&output).contains("error:"), "{line:?}: {output:?}");
    }
    // a failure of its own is not covered by that of the output
    let full = std::fs::OpenOptions::new()
        .write(true)
        .open("/dev/full")
        .expect("there");
    let output = onto(&["--json", "explain", "0x10000", "--as", "stw1"], full.into());
    assert_eq!(output.status.code(), Some(2), "{output:?}");
    assert!(stderr(&output).contains("cannot be written"), "{output:?}");
}

#[test]
fn explain_a_state_by_its_name() {
    let output = profidrive(&["explain", "S1", "--as", "state"]);
    assert_eq!(output.status.code(), Some(0));
    let text = stdout(&output);
    assert!(
        text.starts_with("S1 switching on inhibited\n  motor    pulses off"),
        "{text}"
    );
    assert!(text.contains("\n  leave    STW1 bit 0 (ON) = 0, "), "{text}");
    let output = profidrive(&["explain", "S9", "--as", "state"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(stderr(&output).contains("S1 to S5"), "{output:?}");
}

#[test]
fn explain_for_programs_has_the_schema() {
    let output = profidrive(&["--json", "explain", "0x0237", "--as", "state"]);
    let value: serde_json::Value = serde_json::from_slice(&output.stdout).expect("one JSON document");
    assert_eq!(value["schema"], "profidrive/1");
    assert_eq!(value["state"], "S4");
    let output = profidrive(&["--json", "explain", "0x10000", "--as", "state"]);
    assert_eq!(output.status.code(), Some(2));
    let value: serde_json::Value = serde_json::from_slice(&output.stdout).expect("one JSON document");
    assert_eq!(value["error"]["kind"], "usage");
}

#[test]
fn a_wrong_command_line_is_one_document_too() {
    for line in [
        &["--json", "explain", "0x1"][..],
        &["--json", "explain", "-1", "--as", "stw1"],
        &["--json", "decode", "--hex", "zz"],
        &["read", "akd-1", "--json"],
        &["--json", "nonsense"],
    ] {
        let output = profidrive(line);
        assert_eq!(output.status.code(), Some(2), "{line:?}");
        let text = stdout(&output);
        assert_eq!(text.lines().count(), 1, "{line:?}: {text}");
        let value: serde_json::Value = serde_json::from_str(&text).expect("one JSON document");
        assert_eq!(value["error"]["kind"], "usage", "{text}");
        assert!(
            !value["error"]["message"].as_str().unwrap_or_default().is_empty(),
            "{text}"
        );
    }
    let missing = stderr(&profidrive(&["explain", "0x1"]));
    assert!(
        missing.contains("--as <KIND> is one of stw1, zsw1, state, fault, error, format, pnio, ctw-fc, ")
            && missing.matches(", alarm-word,").count() == 1,
        "{missing}"
    );
    let negative = stderr(&profidrive(&["explain", "-1", "--as", "stw1"]));
    assert!(negative.contains("`-1` is not a 16-bit number"), "{negative}");
    let help = profidrive(&["--json", "--help"]);
    assert_eq!((help.status.code(), stderr(&help)), (Some(0), String::new()));
}

#[test]
fn explain_faults_errors_formats_and_statuses() {
    for (value, kind, words) in [
        ("F702", "fault", "AKD F702: Fieldbus communication lost"),
        (
            "0x11",
            "error",
            "parameter error 0x11 not executable in the present operating state",
        ),
        ("0x42", "format", "format 0x42: Word"),
        ("0x00", "format", "format 0x00: no data"),
        ("DE80B500", "pnio", "state conflict"),
        ("0x0278", "zsw1", "S1 switching on inhibited, with a fault"),
    ] {
        let output = profidrive(&["explain", value, "--as", kind]);
        assert_eq!(output.status.code(), Some(0), "{value}");
        assert!(stdout(&output).contains(words), "{}", stdout(&output));
    }
}

#[test]
fn decode_the_jobs_of_the_manual() {
    for (hex, expected) in [
        (
            "05 02 00 01 10 01 03 A2 00 00 42 01 00 02",
            "change request 5, axis 0, 1 parameter\n  Operating mode (p0930) = 2",
        ),
        (
            "05 02 00 01 00 00",
            "change response 5, axis 0, 1 parameter\n  written\n",
        ),
        (
            "0B 01 01 01 42 01 0C 05",
            "read response 11, axis 1, 1 parameter\n  3077   [Word 0C 05]\n",
        ),
    ] {
        let output = profidrive(&["decode", "--hex", hex]);
        assert_eq!(output.status.code(), Some(0), "{hex}");
        assert!(
            stdout(&output).starts_with(expected),
            "{hex}: {}",
            stdout(&output)
        );
    }
    let request = "07 01 00 02 10 01 08 3C 00 00 10 01 FF FE 00 00";
    let output = profidrive(&[
        "decode",
        "--hex",
        "07 81 00 02 43 01 00 2D C6 C0 44 01 00 00",
        "--request",
        request,
    ]);
    assert!(
        stdout(&output).contains("DRV.ACC (p2108) = 3000 rpm/s"),
        "{}",
        stdout(&output)
    );
    assert!(
        stdout(&output).contains("refused: 0x00 impermissible parameter number"),
        "{}",
        stdout(&output)
    );
}

#[test]
fn decode_names_the_error() {
    let output = profidrive(&["decode", "--hex", "05 0"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(
        stderr(&output).starts_with("error: `0` is not a hexadecimal octet\n  hint: "),
        "{}",
        stderr(&output)
    );
    // the hint is for who has not given it
    for (more, hinted) in [
        (&[][..], true),
        (&["--as", "request"], false),
        (&["--as", "response"], false),
    ] {
        let line = [&["decode", "--hex", "05 01 00"][..], more].concat();
        let output = profidrive(&line);
        assert_eq!(output.status.code(), Some(1));
        let error = stderr(&output);
        assert_eq!(error.contains("hint: --as request"), hinted, "{error}");
    }
    let output = profidrive(&["decode", "/no/such/file.pcapng"]);
    assert_eq!(output.status.code(), Some(1));
    assert!(
        stderr(&output).contains("cannot read /no/such/file.pcapng"),
        "{}",
        stderr(&output)
    );
    let output = profidrive(&["decode", env!("CARGO_MANIFEST_PATH")]);
    assert_eq!(output.status.code(), Some(1));
    assert!(
        stderr(&output).contains("not a capture file"),
        "{}",
        stderr(&output)
    );
}

#[test]
fn the_script_of_each_shell_has_this_program_complete_the_line() {
    for shell in ["bash", "zsh", "fish", "elvish", "powershell"] {
        let output = profidrive(&["completions", shell]);
        assert_eq!(output.status.code(), Some(0));
        assert!(stdout(&output).contains("PROFIDRIVE_COMPLETE"), "{shell}");
    }
}

#[test]
fn mistakes_on_the_command_line() {
    for line in [
        &["fly"][..],
        &["read", "akd-1"],
        &["run", "akd-1"],
        &["explain", "1", "--as", "colour"],
        &["ip", "akd-1", "10.0.0.2"],
        &["name", "02:00:00:00:00:01", "Bad_Name"],
        &["write", "-i", "lo", "akd-1", "DRV.ACC"],
        &["run", "akd 1", "--velocity", "60rpm", "-i", "lo"],
        &["run", "akd-1", "--velocity", "5A", "-i", "lo"],
        &["monitor", "akd-1", "--every", "0ms", "-i", "lo"],
        &["monitor", "akd-1", "--every", "9ms", "-i", "lo"],
    ] {
        let output = profidrive(line);
        assert_eq!(output.status.code(), Some(2), "{line:?}: {}", stderr(&output));
        assert_eq!(stdout(&output), "", "{line:?}");
        assert!(!stderr(&output).is_empty(), "{line:?}");
    }
    let output = profidrive(&["name", "02:00:00:00:00:01", "Bad_Name"]);
    assert!(stderr(&output).contains("hint: perhaps "), "{}", stderr(&output));
}

#[test]
fn a_speed_above_the_limit_is_stopped_before_anything_is_sent() {
    let output = profidrive(&["run", "akd-1", "--velocity", "9000rpm", "-i", "no-such-interface"]);
    assert_eq!(output.status.code(), Some(6));
    assert!(
        stderr(&output).contains("9000 rpm is above the limit of 3000 rpm"),
        "{}",
        stderr(&output)
    );
}

#[test]
fn a_plant_file_without_end_is_refused() {
    let output = profidrive(&["simulate", "/dev/zero", "--virtual-time"]);
    assert_eq!(output.status.code(), Some(1), "{}", stderr(&output));
    assert!(
        stderr(&output).contains("/dev/zero: longer than 4194304 octets, not a plant file"),
        "{}",
        stderr(&output)
    );
}

#[test]
fn an_unknown_interface_names_the_others() {
    let output = profidrive(&["scan", "-i", "no-such-interface"]);
    assert_eq!(output.status.code(), Some(4));
    let text = stderr(&output);
    assert!(
        text.contains("no-such-interface") && text.contains("hint: "),
        "{text}"
    );
}

#[test]
fn demo_writes_a_capture_that_decode_reads() {
    let folder = std::env::temp_dir().join(format!("profidrive-demo-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a folder");
    let path = folder.join("demo.pcapng");
    let file = path.to_str().expect("a path");
    let output = profidrive(&["demo", "--fast", "--pcap", file]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert_eq!(
        stdout(&output)
            .lines()
            .filter(|line| line.starts_with("ok    "))
            .count(),
        20,
        "{}",
        stdout(&output)
    );
    let output = profidrive(&["decode", file]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let text = stdout(&output);
    for words in [
        "who is name akd-1?",
        "connect as IO controller (advanced start-up) \"profidrive\"",
        "inputs: 40 octets every 16 ms (16 x 32 x 31.25 us), watchdog 7 x 16 ms = 112 ms, RT class 2",
        "STW1 0x047E -> 0x047F run: follows the setpoint",
        "-> 0x0278 S1 switching on inhibited, with a fault",
        "change request",
        "DRV.ACC (p2108) = 1000 rpm/s",
        "VLT telegram 101: subslot 1 0xFFFF, subslot 2 0x65 (12 in, 12 out)",
        "Ramp 1 Ramp up Time (3-41) = 1 s",
        "CTW 0x043C -> 0x047C run: follows the setpoint [START, DATA_VALID]",
        "MRV 50 %, 750 rpm",
        "Deceleration time 1 (ID 104) = 1 s",
        "expects slot 1 API 0x3A00 module 0x00010095, VACON telegram 149: subslot 1 0xFFFF, subslot 2 0x10095 (12 in, 12 out)",
        "CTW 0x047E -> 0x047F run: follows the setpoint [ON1, RUN_EN, START_4, START_5, START_6, FB_CTRL]",
        "MRV 25 %",
        "CTW 0x047E -> 0x04FE acknowledge fault",
        "release",
    ] {
        assert!(text.contains(words), "{words}");
    }
    assert!(stderr(&output).contains("frames: "), "{}", stderr(&output));
    assert!(
        !stderr(&output).contains("began earlier"),
        "no connect is overlooked: {}",
        stderr(&output)
    );
    // nothing of the VLT's telegram is read into the words of the Vacon
    let vacon = text.lines().filter(|line| line.contains(" vacon-1 > "));
    let wrong: Vec<_> = vacon.filter(|line| line.contains("TRIP")).collect();
    assert_eq!(wrong, [] as [&str; 0]);

    // a damaged capture is read as far as it is sound
    let mut octets = std::fs::read(&path).expect("the capture");
    octets.truncate(octets.len() / 2 + 3);
    std::fs::write(&path, &octets).expect("the capture");
    let output = profidrive(&["decode", file]);
    assert_eq!(output.status.code(), Some(1));
    assert!(stdout(&output).contains("who is name akd-1?"));
    assert!(
        stderr(&output).contains("ends in the middle of a block"),
        "{}",
        stderr(&output)
    );
    std::fs::remove_dir_all(&folder).expect("the folder goes");
}

#[test]
fn data_and_talk_are_apart() {
    let output = profidrive(&["--json", "--quiet", "demo", "--fast"]);
    assert_eq!(output.status.code(), Some(0));
    assert_eq!(stderr(&output), "");
    for line in stdout(&output).lines() {
        let value: serde_json::Value = serde_json::from_str(line).expect("every line is a document");
        assert_eq!(value["schema"], "profidrive/1");
    }
}

#[test]
fn an_interface_is_required_only_when_one_exists() {
    for verb in ["explain", "demo", "completions"] {
        let help = stdout(&profidrive(&[verb, "--help"]));
        assert!(!help.contains("--interface"), "{help}");
    }
    assert!(stdout(&profidrive(&["read", "--help"])).contains("--interface"));
    let output = profidrive_on("nosuch0", &["read"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(
        stderr(&output).contains("Usage: profidrive read <DRIVE> <PARAM>..."),
        "{}",
        stderr(&output)
    );
    let output = profidrive_on("nosuch0", &["scan"]);
    assert_eq!(output.status.code(), Some(4));
    assert!(stderr(&output).contains("nosuch0"), "{}", stderr(&output));
}

#[test]
fn an_interface_is_refused_where_no_network_is_used() {
    for line in [
        &["-i", "eth9", "decode", "--hex", "01 01 01 01 10 01 03 A2 00 00"][..],
        &["-i", "eth9", "explain", "0x047F", "--as", "stw1"],
        &["-i", "eth9", "completions", "bash"],
    ] {
        let output = profidrive(line);
        assert_eq!(output.status.code(), Some(2), "{line:?}");
        let verb = line[2];
        let words = format!("`{verb}` does not use the network: -i eth9 has no meaning for it");
        assert!(stderr(&output).contains(&words), "{}", stderr(&output));
        assert_eq!(stdout(&output), "");
    }
}

/// A telegram that only one vendor has needs no --model.
#[test]
fn telegram_number_determines_the_vendor() {
    for (number, octets, words) in [
        ("149", "04 7F 13 88 00 00 00 00 00 00 00 00", "VACON telegram 149"),
        (
            "102",
            "00 00 00 00 00 00 00 00 04 7C 20 00 00 00 00 00 00 00 00 00",
            "VLT telegram 102",
        ),
        ("1", "04 7F 06 66", "AKD telegram 1 "),
    ] {
        let output = profidrive(&[
            "decode",
            "--hex",
            octets,
            "--telegram",
            number,
            "--from",
            "controller",
        ]);
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
        assert!(stdout(&output).contains(words), "{}", stdout(&output));
    }
}

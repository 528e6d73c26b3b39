//! `profidrive gsdml` as a user meets it.

#![allow(clippy::unwrap_used, clippy::panic)]

mod binary;

use std::path::{Path, PathBuf};

use binary::{profidrive, stderr, stdout};

fn json(line: &[&str]) -> serde_json::Value {
    let output = profidrive(&[&["--json"], line].concat());
    serde_json::from_slice(&output.stdout).unwrap_or_else(|e| panic!("{e}: {}", stdout(&output)))
}

/// Returns a folder of its own for a test.
fn folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    let _ = std::fs::remove_dir_all(&folder);
    folder
}

fn vendor_file(name: &str) -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../../tests/descriptions")
        .join(name);
    path.to_str().unwrap().to_owned()
}

/// Returns the exported description: path of the file.
fn exported(name: &str) -> PathBuf {
    let folder = folder(name);
    let output = profidrive(&["gsdml", "export", "-o", folder.to_str().unwrap()]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let written = stdout(&output);
    let lines: Vec<&str> = written.lines().collect();
    assert_eq!(lines.len(), 2, "{written}");
    assert!(lines.iter().all(|line| Path::new(line).is_file()));
    PathBuf::from(lines[0])
}

#[test]
fn export_check_show() {
    let file = exported("gsdml-export");
    let path = file.to_str().unwrap();
    let output = profidrive(&["gsdml", "check", path]);
    assert_eq!(
        (output.status.code(), stdout(&output).as_str()),
        (Some(0), ""),
        "{}",
        stderr(&output)
    );
    assert!(
        stderr(&output).contains("nothing against the rules\n"),
        "{}",
        stderr(&output)
    );

    let shown = stdout(&profidrive(&["gsdml", "show", path]));
    assert!(shown.contains("vendor   0x0105 Kollmorgen"), "{shown}");
    assert!(shown.contains("update time    16 ms and longer"), "{shown}");
    assert!(
        shown.contains("Manufacturer telegram 353, PZD-13/5  0x00010161"),
        "{shown}"
    );
    assert!(!shown.contains("T_SIG_STW1"), "{shown}");
    let shown = stdout(&profidrive(&[
        "gsdml",
        "show",
        path,
        "--texts",
        "--language",
        "de",
    ]));
    assert!(
        shown.contains("Standardtelegramm 1") && shown.contains("T_SIG_STW1"),
        "{shown}"
    );

    let value = json(&["gsdml", "show", path]);
    assert_eq!(
        (&value["schema"], &value["command"]),
        (&"profidrive/1".into(), &"gsdml show".into())
    );
    assert_eq!(value["access_points"][0]["min_device_interval"], 512);
    let telegram = value["modules"]
        .as_array()
        .unwrap()
        .iter()
        .find(|module| module["id"] == "M_TEL_9")
        .unwrap();
    assert_eq!(
        (
            &telegram["submodules"][0]["input"],
            &telegram["submodules"][0]["output"]
        ),
        (&10.into(), &20.into())
    );
    assert_eq!(telegram["submodules"][0]["output_items"][3]["type"], "Integer32");
    assert_eq!(
        value["languages"]["de"]["T_TEL_1"],
        "Standardtelegramm 1, PZD-2/2"
    );
}

#[test]
fn a_second_export_gives_the_same_octets() {
    let (one, two) = (exported("gsdml-first"), exported("gsdml-second"));
    assert_eq!(one.file_name(), two.file_name());
    assert_eq!(std::fs::read(&one).unwrap(), std::fs::read(&two).unwrap());
}

#[test]
fn check_reports_all_problems_with_their_positions() {
    let file = exported("gsdml-broken");
    let text = std::fs::read_to_string(&file).unwrap();
    let text = text
        .replace("MainFamily=\"Drives\"", "MainFamily=\"Motors\"")
        .replace("Name TextId=\"T_TEL_7\"", "Name TextId=\"T_NONE\"");
    let broken = file.with_file_name("GSDML-V2.4-Kollmorgen-AKD-20261121.xml");
    std::fs::write(&broken, text).unwrap();
    let path = broken.to_str().unwrap();
    let output = profidrive(&["gsdml", "check", path]);
    assert_eq!(output.status.code(), Some(5));
    let problems = stdout(&output);
    let lines: Vec<&str> = problems.lines().collect();
    // the name stands at the module and at its submodule
    assert_eq!(lines.len(), 4, "{problems}");
    assert!(
        lines[0].contains(":1:1: error: the file name says schema V2.4, the file V2.35 [file name]"),
        "{problems}"
    );
    assert!(
        lines[1].contains(":21:7:") && lines[1].contains("MainFamily `Motors`"),
        "{problems}"
    );
    assert!(
        lines[2].contains("there is no text `T_NONE` [text]"),
        "{problems}"
    );
    assert!(
        stderr(&output).contains("4 errors; the file can be used here"),
        "{}",
        stderr(&output)
    );

    let output = profidrive(&["--json", "gsdml", "check", path]);
    let first = output.stdout.split(|octet| *octet == b'\n').next().unwrap();
    let value: serde_json::Value = serde_json::from_slice(first).unwrap();
    assert_eq!((&value["sound"], &value["usable"]), (&false.into(), &true.into()));
    assert_eq!(value["problems"][1]["rule"], "value");
    assert_eq!(value["problems"][1]["line"], 21);
}

#[test]
fn pictures_are_looked_for_beside_the_file() {
    let file = exported("gsdml-picture");
    let picture = file.with_file_name("GSDML-0105-0001-AKD-profidrive.bmp");
    let path = file.to_str().unwrap();
    std::fs::write(&picture, b"BM").unwrap();
    assert!(stdout(&profidrive(&["gsdml", "check", path])).contains("is not a bitmap"));
    std::fs::remove_file(&picture).unwrap();
    let output = profidrive(&["gsdml", "check", path]);
    assert!(stdout(&output).contains("there is no GSDML-0105-0001-AKD-profidrive.bmp beside the file"));
    assert_eq!(output.status.code(), Some(0));
}

#[test]
fn hostile_files_are_refused_in_a_moment() {
    let folder = folder("gsdml-hostile");
    std::fs::create_dir_all(&folder).unwrap();
    let laughs =
        "<!DOCTYPE l [<!ENTITY a \"aaaaaaaaaa\"><!ENTITY b \"&a;&a;&a;&a;&a;&a;&a;&a;\">]><l>&b;</l>";
    let deep = "<a>".repeat(1_000_000);
    let attribute = format!("<a {}/>", "b=\"c\" ".repeat(100_000));
    let large = " ".repeat(33 << 20);
    let cases = [
        ("entity.xml", laughs, "1:1: a document type"),
        ("deep.xml", &deep, "nested deeper than 32"),
        ("wide.xml", &attribute, "attributes; at most 128"),
        ("large.xml", &large, "octets; at most"),
        ("empty.xml", "", ""),
    ];
    for (name, content, words) in cases {
        let file = folder.join(name);
        std::fs::write(&file, content).unwrap();
        let output = profidrive(&["gsdml", "show", file.to_str().unwrap()]);
        assert_eq!(output.status.code(), Some(1), "{name}");
        assert!(stderr(&output).contains(words), "{name}: {}", stderr(&output));
        let output = profidrive(&["gsdml", "check", file.to_str().unwrap()]);
        assert_eq!(output.status.code(), Some(5), "{name}");
    }
    let output = profidrive(&["gsdml", "show", folder.join("none.xml").to_str().unwrap()]);
    assert_eq!(output.status.code(), Some(1));
    assert!(stderr(&output).contains("cannot read"), "{}", stderr(&output));
}

#[test]
fn vendor_files_are_shown() {
    let shown = stdout(&profidrive(&[
        "gsdml",
        "show",
        &vendor_file("GSDML-V2.32-Kollmorgen-DriveObject-20170601-103000.xml"),
    ]));
    assert!(shown.contains("+ Speed, PZD-2/2         0x00000065"), "{shown}");
    let output = profidrive(&[
        "gsdml",
        "show",
        &vendor_file("GSDML-V2.1-KOLLMORGEN-AKDLIKE-20140301.xml"),
        "--language",
        "fr",
    ]);
    assert_eq!(output.status.code(), Some(2));
    assert!(stderr(&output).contains("it has de"), "{}", stderr(&output));
    let german = stdout(&profidrive(&[
        "gsdml",
        "show",
        &vendor_file("GSDML-V2.1-KOLLMORGEN-AKDLIKE-20140301.xml"),
        "--language",
        "de",
    ]));
    assert!(
        german.contains("Servoverstärker") && german.contains("Standardtelegramm 1"),
        "{german}"
    );
}

#[test]
fn simulate_refuses_a_file_that_does_not_fit_before_it_touches_the_network() {
    let file = exported("gsdml-simulate");
    let text = std::fs::read_to_string(&file)
        .unwrap()
        .replace("VendorID=\"0x0105\"", "VendorID=\"0x0ABC\"");
    std::fs::write(&file, text).unwrap();
    let output = profidrive(&["simulate", "-i", "lo", "--gsdml", file.to_str().unwrap()]);
    assert_eq!(output.status.code(), Some(2), "{}", stderr(&output));
    assert!(stderr(&output).contains("vendor 0x0ABC"), "{}", stderr(&output));
    let file = vendor_file("GSDML-V2.1-KOLLMORGEN-AKDLIKE-20140301.xml");
    let output = profidrive(&["simulate", "-i", "lo", "--gsdml", &file, "--access-point", "DAP"]);
    assert!(
        stderr(&output).contains("it has ID_DAP_NEW, ID_DAP_OLD"),
        "{}",
        stderr(&output)
    );
}

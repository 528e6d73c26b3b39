//! What is wrong in a machine file is found with its line.

use super::*;
use crate::report::Quantity;

const GOOD: &str = r#"format = 1
title = "Press"

[group.line1]
max-speed = "20rps"

[[drive]]
name = "feed"
model = "akd"
mac = "02:00:00:00:00:01"
ip = "192.168.77.11/24"
gateway = "192.168.77.254"
telegram = 9
groups = ["line1", "all-of-it"]
max-speed = "1500rpm"
backup = "feed.backup"

[drive.parameters]
"DRV.ACC" = "5000rpm/s"
p2115 = 3000

[[drive]]
name = "fan"
model = "vlt"
groups = ["line1"]
"#;

fn problem(from: &str, to: &str) -> (usize, String) {
    assert!(GOOD.contains(from), "{from}");
    let problem = GOOD.replacen(from, to, 1).parse::<Machine>().unwrap_err();
    (problem.line, problem.message)
}

#[test]
fn a_machine_is_read_with_the_lines_of_its_values() {
    let machine: Machine = GOOD.parse().unwrap();
    let feed = machine.drive("feed").unwrap();
    assert_eq!((feed.line, feed.model.key, feed.telegram), (8, "akd", Some(9)));
    assert_eq!(feed.ip.unwrap().gateway, Ipv4Addr::new(192, 168, 77, 254));
    let lines: Vec<usize> = feed.parameters.iter().map(|(line, _)| *line).collect();
    assert_eq!(lines, [19, 20]);
    assert_eq!(machine.group("line1").unwrap(), ["feed", "fan"]);
    // the lower one of the drive and its groups
    assert_eq!(machine.bound("feed"), Some(SpeedBound { rpm: 1200.0, line: 5 }));
    assert_eq!(machine.bound("fan"), Some(SpeedBound { rpm: 1200.0, line: 5 }));
    assert_eq!(machine.bound("other"), None);
    let unknown = machine.group("line2").unwrap_err().to_string();
    assert_eq!(
        unknown,
        "the machine file has no group `line2`; there are all-of-it, line1"
    );
}

#[test]
fn a_load_has_a_unit_by_pitch_and_gear() {
    let text = GOOD.replacen("telegram = 9", "pitch = \"-10mm\"\ngear = \"7:2\"", 1);
    let machine: Machine = text.parse().unwrap();
    for drive in ["feed", "02:00:00:00:00:01", "192.168.77.11"] {
        let unit = machine.user_unit(drive).unwrap();
        let load = unit.of_motor(&Quantity::turns(3.5)).unwrap();
        assert_eq!((unit.name.as_str(), load.value), ("mm", -10.0), "{drive}");
    }
    assert_eq!(machine.user_unit("fan"), None);
}

#[test]
fn each_mistake_has_its_line() {
    for (from, to, line, words) in [
        ("format = 1", "format = 2", 1, "format 2 is not known"),
        (
            "telegram = 9",
            "telegramm = 9",
            13,
            "unknown field `telegramm`, expected one of",
        ),
        (
            "name = \"fan\"",
            "name = \"feed\"",
            23,
            "the name feed belongs to the drive in line 8",
        ),
        (
            "name = \"fan\"",
            "name = \"Fan 1\"",
            23,
            "not a valid station name",
        ),
        (
            "model = \"vlt\"",
            "model = \"siemens\"",
            24,
            "no model `siemens`; there are akd, ",
        ),
        ("\"1500rpm\"", "\"1500\"", 15, "needs its unit"),
        ("\"1500rpm\"", "\"5A\"", 15, "current"),
        ("\"1500rpm\"", "\"-5rpm\"", 15, "above 0"),
        ("5000rpm/s", "5000A", 19, "current"),
        ("DRV.ACC", "DRV.ACCC", 19, "DRV.ACC"),
        ("p2115", "p2108", 20, "is set in line 19 already"),
        ("p2115 = 3000", "p2115 = [1]", 20, "a value is a number"),
        (
            "192.168.77.11/24",
            "192.168.77.11",
            11,
            "an address is written as",
        ),
        (
            "192.168.77.11/24",
            "192.168.77.255/24",
            11,
            "not the address of a station",
        ),
        ("\"192.168.77.254\"", "\"10.0.0.1\"", 12, "in the subnet"),
        ("02:00:00:00:00:01", "01:00:00:00:00:01", 10, "no single station"),
        ("[group.line1]", "[group.line7]", 4, "no drive is in the group"),
        ("\"all-of-it\"", "\"a b\"", 14, "is not a group"),
        ("title = \"Press\"", "title = 5", 2, "invalid type"),
        (
            "telegram = 9",
            "telegram = 99",
            13,
            "has no telegram 99; it has 1,",
        ),
        ("telegram = 9", "gear = \"5:1\"", 13, "a gear needs the travel"),
        ("telegram = 9", "pitch = \"360deg\"", 13, "those of the motor"),
        ("telegram = 9", "pitch = \"10\"", 13, "those of the motor"),
        ("telegram = 9", "pitch = \"0mm\"", 13, "is not 0"),
        ("telegram = 9", "pitch = \"10m/m\"", 13, "not the name of a unit"),
        (
            "telegram = 9",
            "pitch = \"10mm\"\ngear = \"5:0\"",
            14,
            "written as 5:1",
        ),
    ] {
        let (found, message) = problem(from, to);
        assert!(message.contains(words), "{to}: {message}");
        assert_eq!(found, line, "{to}: {message}");
    }
    assert_eq!("".parse::<Machine>().unwrap_err().line, 1);
}

#[test]
fn the_length_and_the_drives_of_a_file_are_bounded() {
    let problem = |text: &str| text.parse::<Machine>().unwrap_err().message;
    assert!(problem(&"#".repeat(LONGEST_FILE + 1)).contains("longer than"));
    let drives: String = (0..=MOST_DRIVES)
        .map(|number| format!("[[drive]]\nname = \"d-{number}\"\nmodel = \"akd\"\n"))
        .collect();
    assert!(problem(&drives).contains("at most 1000 drives"));
    let groups = vec!["\"a\""; MOST_GROUPS + 1].join(",");
    let drive = "[[drive]]\nname = \"a\"\nmodel = \"akd\"\n";
    assert!(problem(&format!("{drive}groups = [{groups}]")).contains("at most 64 groups"));
    let parameters: String = (0..=MOST_PARAMETERS)
        .map(|number| format!("p{number} = 1\n"))
        .collect();
    assert!(problem(&format!("{drive}[drive.parameters]\n{parameters}")).contains("at most 4096 parameters"));
}

proptest::proptest! {
    #[test]
    fn no_text_is_too_strange(cut in 0..GOOD.len(), put in ".{0,6}") {
        let mut text: String = GOOD.chars().take(cut).collect();
        text.push_str(&put);
        text.extend(GOOD.chars().skip(cut + 1));
        // refused or read, with a line that exists
        if let Err(problem) = text.parse::<Machine>() {
            assert!(problem.line <= text.lines().count() + 1, "{text}\n{problem}");
        }
    }
}

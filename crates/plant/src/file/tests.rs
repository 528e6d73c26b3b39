use super::*;
use std::time::Duration;

use proptest::prelude::*;

use crate::plan::Action;

const PLANT: &str = r#"
seed = 7
duration = "20s"
sample = "100ms"

[[drive]]
name = "press-1"
ip = "10.0.0.1/24"
min-cycle = "4ms"
motor = { inertia = 2e-4, torque-constant = 0.5 }
load = { inertia = 1e-3, torque = 0.2 }
travel = { negative-stop = "-5rev", positive-stop = "20rev", home-switch = ["0.5rev", "1rev"] }
parameters = { "DRV.ACC" = "5000rpm/s", 1004 = "100rpm" }
event = [
    { at = "2s", do = "load=0.5Nm", for = "1s" },
    { at = "5s", do = "cable=pulled", for = "300ms" },
    { position = "10rev", do = "fault=439" },
]

[[drive]]
name = "press-2"

[[controller]]
drive = "press-1"
telegram = 1
cycle = "16ms"
watchdog = 6

[[controller.step]]
at = "1s"
send = { STW1 = "0x047F", NSOLL_A = "-60rpm" }
[[controller.step]]
at = "0.5s"
words = [0x047E, 0]
[[controller.step]]
at = "9s"
connection = "release"
"#;

#[test]
fn a_whole_plant_is_read() {
    let plant: PlantPlan = PLANT.parse().unwrap();
    assert_eq!((plant.seed, plant.duration), (7, Some(Duration::from_secs(20))));
    let [press, other] = plant.drives.as_slice() else {
        panic!("two drives")
    };
    assert_eq!(press.plant.motor_inertia, 2e-4);
    assert_eq!(
        press.plant.cogging, press.model.plant.cogging,
        "what is not said is the model's"
    );
    assert_eq!(press.plant.travel.unwrap().home_switch, Some((1 << 31, 1 << 32)));
    assert_eq!(press.min_device_interval, Some(128));
    assert_eq!(press.load, 0.2);
    let names: Vec<_> = press.parameters.iter().map(|p| p.reference.to_string()).collect();
    assert_eq!(names.len(), 2, "{names:?}");
    assert_eq!(press.cues[1].lasts, Some(Duration::from_millis(300)));
    assert_eq!(press.cues[2].trigger, Trigger::Place(10 << 32));
    assert_eq!(other.mac, derived_mac("press-2"));
    assert!(!other.ip.is_set());
    let [controller] = plant.controllers.as_slice() else {
        panic!("one controller")
    };
    assert_eq!((controller.drive, controller.watchdog), (0, 6));
    assert_eq!(
        controller.steps[0].action,
        Action::Words(vec![0x047E, 0]),
        "in the order of time"
    );
    let Action::Send(signals) = &controller.steps[1].action else {
        panic!("signals")
    };
    let sent: Vec<_> = signals
        .iter()
        .map(|(field, raw)| (field.signal.name, *raw))
        .collect();
    assert_eq!(sent, [("STW1", 0x047F), ("NSOLL_A", -164)]);
}

/// Returns the plant with one line replaced, and the resulting error.
fn refused(line: &str, by: &str) -> (usize, String) {
    assert!(PLANT.contains(line), "{line}");
    let read = PLANT.replacen(line, by, 1).parse::<PlantPlan>();
    let error = read.err().unwrap_or_else(|| panic!("{by} was taken"));
    (error.line, error.message)
}

#[test]
fn mistakes_are_reported_with_their_line() {
    for (line, by, at, words) in [
        (r#"duration = "20s""#, r#"duration = "20""#, 3, "needs its unit"),
        (r#"sample = "100ms""#, r#"sample = "0s""#, 4, "time between"),
        ("seed = 7", "sed = 7", 2, "unknown field `sed`"),
        ("seed = 7", "seed = ", 2, "expected"),
        (
            r#"name = "press-1""#,
            r#"name = "Press_1""#,
            7,
            "not a valid station name",
        ),
        (
            r#"name = "press-2""#,
            r#"name = "press-1""#,
            21,
            "belongs to another drive",
        ),
        (
            r#"ip = "10.0.0.1/24""#,
            r#"ip = "10.0.0.1""#,
            8,
            "192.168.0.11/24",
        ),
        (r#"min-cycle = "4ms""#, r#"min-cycle = "3ms""#, 9, "1, 2, 4, 8"),
        ("inertia = 2e-4", "inertia = -1.0", 10, "outside"),
        ("torque = 0.2", "torqe = 0.2", 11, "unknown field `torqe`"),
        (
            r#"negative-stop = "-5rev""#,
            r#"negative-stop = "5rev""#,
            12,
            "between its stops",
        ),
        (
            r#"["0.5rev", "1rev"]"#,
            r#"["1rev", "0.5rev"]"#,
            12,
            "begins behind",
        ),
        (
            r#""DRV.ACC" = "5000rpm/s""#,
            r#""DRV.ACCC" = "5000rpm/s""#,
            13,
            "nearest names: DRV.ACC",
        ),
        (
            r#""DRV.ACC" = "5000rpm/s""#,
            r#""DRV.ACC" = "5A""#,
            13,
            "unit of current",
        ),
        (r#""DRV.ACC" = "5000rpm/s""#, r#""930" = 7"#, 13, "is refused"),
        (
            r#""DRV.ACC" = "5000rpm/s""#,
            r#""DRV.ACC" = [1]"#,
            13,
            "number or a text",
        ),
        (
            r#"at = "5s","#,
            r#"at = "5s", position = "1rev","#,
            16,
            "either `at`",
        ),
        (
            r#"do = "cable=pulled""#,
            r#"do = "cabel=pulled""#,
            16,
            "keys: fault",
        ),
        (
            r#"do = "fault=439""#,
            r#"do = "fault=999""#,
            17,
            "AKD has no fault 999; next to it",
        ),
        (
            r#"do = "fault=439""#,
            r#"do = "fault=439", for = "1s""#,
            17,
            "means nothing here",
        ),
        (
            r#"drive = "press-1""#,
            r#"drive = "press-9""#,
            24,
            "no drive `press-9`",
        ),
        (
            r#"drive = "press-1""#,
            r#"drive = "press-2""#,
            24,
            "needs an `ip`",
        ),
        ("telegram = 1", "telegram = 3", 25, "it has 1, 7, 9"),
        (r#"cycle = "16ms""#, r#"cycle = "2ms""#, 26, "4 ms at the fastest"),
        ("watchdog = 6", "watchdog = 0", 27, "1 to 255"),
        (
            r#"NSOLL_A = "-60rpm""#,
            r#"NSOL_A = "-60rpm""#,
            31,
            "sends no `NSOL_A`",
        ),
        (r#"NSOLL_A = "-60rpm""#, r#"ZSW1 = 0"#, 31, "sends no `ZSW1`"),
        (r#"NSOLL_A = "-60rpm""#, r#"NSOLL_A = "90000rpm""#, 31, "outside"),
        (r#"STW1 = "0x047F""#, r#"STW1 = "0x1047F""#, 31, "does not fit"),
        (
            r#"connection = "release""#,
            r#"connection = "drop""#,
            37,
            "release, connect, stop or run",
        ),
        (r#"connection = "release""#, "", 35, "one of `send`"),
    ] {
        let (found, message) = refused(line, by);
        assert!(message.contains(words), "{by}: {message}");
        assert_eq!(found, at, "{by}: {message}");
    }
    assert!(
        "".parse::<PlantPlan>()
            .unwrap_err()
            .message
            .contains("at least one drive")
    );
}

proptest! {
    #[test]
    fn damaged_files_are_refused_or_read_and_nothing_else(at in 0_usize..1400, by in any::<u8>(), cut in any::<bool>()) {
        let mut octets = PLANT.as_bytes().to_vec();
        let at = at % octets.len();
        if cut {
            octets.truncate(at);
        } else {
            octets[at] = by;
        }
        if let Ok(text) = String::from_utf8(octets) {
            let _ = text.parse::<PlantPlan>();
        }
    }
}

/// A text is a first value like a number.
#[test]
fn a_text_is_given_to_a_drive() {
    let file = |text: &str| {
        format!("[[drive]]\nname = \"vlt-1\"\nmodel = \"vlt\"\nparameters = {{ \"0-37\" = \"{text}\" }}\n")
    };
    let plant: PlantPlan = file("PRESS 1").parse().expect("a plant");
    let drive = &plant.drives[0];
    let unit = drive.build(drive.config(), 1);
    assert!(unit.is_ok());
    let mistake = file("12345678901234567890123456").parse::<PlantPlan>();
    let Err(error) = mistake else { panic!("too long") };
    assert!(error.message.contains("holds 25 characters"), "{}", error.message);
}

#[test]
fn the_length_and_the_events_of_a_file_are_bounded() {
    let message = |text: String| text.parse::<PlantPlan>().err().map(|error| error.message);
    let long = message(" ".repeat(LONGEST_FILE + 1)).unwrap_or_default();
    assert!(long.contains("longer than"), "{long}");
    let events = r#"{ at = "2s", do = "fault=439" },"#.repeat(MOST_CUES + 1);
    let many = message(format!("[[drive]]\nname = \"a\"\nevent = [{events}]\n")).unwrap_or_default();
    assert!(many.contains("more than 10000 events"), "{many}");
}

#[test]
fn the_steps_of_a_controller_are_bounded() {
    let steps = |count| {
        let steps = r#"{at="1"},"#.repeat(count);
        let drive = "[[drive]]\nname = \"a\"\nip = \"10.0.0.1/24\"\n";
        let text = format!("{drive}[[controller]]\ndrive = \"a\"\ntelegram = 1\nstep = [{steps}]\n");
        text.parse::<PlantPlan>().unwrap_err().message
    };
    assert_eq!(steps(100_001), "more than 100000 steps");
    assert_ne!(steps(1), "more than 100000 steps");
}

#[test]
fn two_names_of_one_derived_address_get_two_addresses() {
    let drive = |name: &str| format!("[[drive]]\nname = \"{name}\"\n");
    let plant: PlantPlan = (drive("c-1361") + &drive("c-1369")).parse().unwrap();
    let [first, second] = plant.drives.as_slice() else {
        panic!("two drives")
    };
    assert_eq!(first.mac, derived_mac("c-1369"), "of both names");
    assert_ne!(first.mac, second.mac);
}

//! Error numbers of the parameter channel of a VLT in the words of a PPO type and through records: both can be provoked, and
//! each channel has its own number for the same reason.

use std::process::Command;

use client::modules_of;
use serde_json::Value;
use system_tests::bus::Bus;
use system_tests::{Lab, built, client, simulate};
use virtual_drive::model::VLT;
use virtual_drive::station::AnswerFault;

/// Number, its meaning in the channel, and the number of records.
const NUMBERS: [(u16, &str, u8); 2] = [
    (
        131,
        "131 change not possible, the factory setup is selected",
        0x11,
    ),
    (130, "130 no bus access to the parameter", 0x68),
];
/// Change 3-41 (PNU 341, double word) to 8 s.
const CHANGE: [u8; 8] = [0x31, 0x55, 0, 0, 0, 0, 0x03, 0x20];
/// The same through records.
const JOB: [u8; 16] = [1, 2, 0, 1, 0x10, 1, 0x01, 0x55, 0, 0, 0x07, 1, 0, 0, 0x03, 0x20];

#[test]
fn the_words_of_a_ppo_type_have_the_number_and_a_capture_names_it() {
    let mut bus = Bus::of(&VLT);
    let device = &VLT.catalogue.device;
    let (_, running) = bus.connect_as(modules_of(device, device.telegram(101).expect("PPO type 1")));
    assert!(running);
    let outputs = |channel: [u8; 8]| [&channel[..], &[0x04, 0x3C, 0, 0]].concat();
    for (number, _, record) in NUMBERS {
        bus.send(&outputs([0; 8]), 4);
        bus.station().set_answer_fault(AnswerFault::Error(number));
        let inputs = bus.send(&outputs(CHANGE), 4);
        assert_eq!((inputs[0] >> 4, inputs[7]), (7, number as u8), "{inputs:02X?}");
        let answer = bus.job_at(0xB02E, &JOB);
        assert_eq!(answer, [1, 0x82, 0, 1, 0x44, 1, 0, record]);
    }
    bus.send(&outputs([0; 8]), 4);
    bus.station().set_answer_fault(AnswerFault::None);
    let inputs = bus.send(&outputs(CHANGE), 4);
    assert_eq!(inputs[0] >> 4, 2, "done: {inputs:02X?}");
    bus.release();
    let file = bus.judged("pkw-refusals");

    let decode = |more: &[&str]| {
        let output = Command::new(built("profidrive"))
            .arg("decode")
            .args(more)
            .arg(&file)
            .output()
            .expect("the binary runs");
        String::from_utf8(output.stdout).expect("text")
    };
    let text = decode(&[]);
    let documents: Vec<Value> = decode(&["--json"])
        .lines()
        .map(|line| serde_json::from_str(line).expect("a document"))
        .collect();
    let errors: Vec<&Value> = documents
        .iter()
        .map(|event| &event["data"])
        .filter(|data| data["channel"] == "pkw" && data["error"].is_object())
        .map(|data| &data["error"])
        .collect();
    assert_eq!(errors.len(), NUMBERS.len(), "{documents:?}");
    for ((number, meaning, _), error) in NUMBERS.iter().zip(errors) {
        assert!(text.contains(&format!("refused: {meaning}")), "{text}");
        assert_eq!(
            (&error["number"], &error["meaning"]),
            (&(*number).into(), &(*meaning).into())
        );
        assert!(error["remedy"].is_string(), "{error}");
    }
}

#[test]
fn records_have_the_number_of_the_dialect_in_text_and_json() {
    let lab = Lab::new("pkw-refusals");
    let _drive = simulate(
        &lab,
        &["--model", "vlt", "--name", "vlt-1", "--ip", "192.168.77.50/24"],
    );
    for (number, _, record) in NUMBERS {
        client(&lab, &["inject", "vlt-1", &format!("answers=error {number}")]).ok();
        let words = format!("0x{record:02X} ");
        let refused = client(&lab, &["write", "vlt-1", "3-41=5s"]);
        assert_eq!(refused.code, Some(3), "{refused:?}");
        let start = format!("vlt-1: writing Ramp 1 Ramp up Time (3-41) refused: {words}");
        assert!(refused.err.contains(&start), "{refused:?}");
        let refused = client(&lab, &["write", "vlt-1", "3-41=5s", "--json"]);
        let document: Value = serde_json::from_str(&refused.out).expect("a document");
        let error = &document["changes"][0]["error"];
        assert_eq!(error["number"], record, "{error}");
        assert_eq!(
            (&error["channel"], &error["sent"]),
            (&"records".into(), &true.into())
        );
        let meaning = error["meaning"].as_str().expect("words");
        assert!(meaning.starts_with(&words), "{error}");
    }
    // the drive's own 131
    client(&lab, &["inject", "vlt-1", "answers=none"]).ok();
    client(&lab, &["write", "vlt-1", "0-11=0"]).ok();
    let refused = client(&lab, &["write", "vlt-1", "3-41=5s"]);
    assert!(refused.err.contains("refused: 0x11 "), "{refused:?}");
    assert_eq!(refused.code, Some(3));
}

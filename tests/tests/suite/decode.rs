//! `profidrive decode` of captures: against the dissector's reading of the same file, its options, and live.

use std::collections::BTreeSet;
use std::io::Write;
use std::path::Path;
use std::process::{Command, Output, Stdio};
use std::time::Duration;

use serde_json::Value;
use system_tests::{Lab, Side, built, capture_files, client, judge, root, simulate};

const SHORT: Duration = Duration::from_secs(20);

fn decode(arguments: &[&str], file: &Path) -> Output {
    let mut command = Command::new(built("profidrive"));
    command.args(["--json", "decode"]).arg(file).args(arguments);
    command.output().unwrap()
}

/// Returns the documents on stdout.
#[track_caller]
fn documents(output: &Output) -> Vec<Value> {
    let text = String::from_utf8_lossy(&output.stdout);
    text.lines()
        .map(|line| serde_json::from_str(line).unwrap())
        .collect()
}

fn capture(name: &str) -> std::path::PathBuf {
    root().join("captures").join(name)
}

/// Frames of the events of one kind, by number. An event about the end of a capture stands at a frame too.
fn numbers(documents: &[Value], keep: impl Fn(&Value) -> bool) -> BTreeSet<u64> {
    let kept = documents.iter().filter(|event| keep(event));
    kept.filter_map(|event| event["frame"].as_u64()).collect()
}

/// The numbers of frames are the dissector's, and DCP, alarms and connects stand at the frames that it calls so.
#[test]
fn events_stand_at_the_frames_of_the_dissector() {
    let mut seen = [0; 3];
    for file in capture_files() {
        let events = documents(&decode(&[], &file));
        let by_filter = |filter: &str| -> BTreeSet<u64> {
            let rows = judge::fields(&file, filter, &["frame.number"]);
            rows.iter().map(|row| row[0].parse().unwrap()).collect()
        };
        let of_kind = |kind: &'static str| move |event: &Value| event["kind"] == kind;
        let dcp = numbers(&events, of_kind("dcp"));
        assert_eq!(dcp, by_filter("pn_dcp"), "{}", file.display());
        let asked = numbers(&events, |event| event["data"]["step"] == "request");
        let connects = by_filter("pn_io.block_type == 0x0101");
        assert!(asked.is_subset(&connects), "{asked:?} {connects:?}");
        let alarms = numbers(&events, |event| event["data"]["step"] == "notification");
        assert!(
            alarms.is_subset(&by_filter("pn_io.alarm_type")),
            "{}",
            file.display()
        );
        for (count, found) in seen.iter_mut().zip([&dcp, &asked, &alarms]) {
            *count += found.len();
        }
    }
    assert!(seen.iter().all(|count| *count > 0), "{seen:?}");
}

/// Each record has its numbers beside its words, and every capture ends with a summary of each device.
#[test]
fn events_are_typed_and_devices_are_summed_up() {
    let events = documents(&decode(&[], &capture("pnet-profinetpy-full.pcapng")));
    let (summaries, events): (Vec<_>, Vec<_>) = events.iter().partition(|event| event["kind"] == "summary");
    for event in &events {
        assert_eq!(event["schema"], "profidrive/1", "{event}");
        assert!(event["end"] == true || event["data"].is_object(), "{event}");
    }
    let device = &summaries[0]["data"];
    assert_eq!(
        (&device["mac"], &device["restarts"], &device["connection_losses"]),
        (&"02:50:4e:00:00:01".into(), &0.into(), &0.into())
    );
    let streams = device["streams"].as_array().unwrap();
    assert_eq!(streams.len(), 2, "{device}");
    for stream in streams {
        assert_eq!(
            (&stream["cycle"], &stream["lost"]),
            (&0.032.into(), &0.into()),
            "{stream}"
        );
        let jitter = stream["jitter_p99"].as_f64().unwrap();
        assert!((0.0..0.1).contains(&jitter), "{stream}");
    }
    let im0 = events.iter().find(|event| event["data"]["index"] == 0xAFF0);
    assert_eq!(im0.unwrap()["data"]["content"]["vendor"], 0x0493);
    // an unacknowledged alarm and the end of its connection are trouble
    let file = capture("pnet-profinetpy-alarms.pcapng");
    let trouble = documents(&decode(&["--only", "trouble"], &file));
    assert!(trouble.len() < documents(&decode(&[], &file)).len());
    let text: String = trouble
        .iter()
        .filter_map(|event| event["text"].as_str())
        .collect();
    for words in ["not acknowledged within", "connection ended by an error"] {
        assert!(text.contains(words), "{words}: {text}");
    }
    for event in trouble.iter().filter(|event| event["weight"].is_string()) {
        assert_ne!(event["weight"], "normal", "{event}");
    }
}

#[test]
fn a_capture_is_cut_by_time_and_by_station() {
    let file = capture("pnet-profinetpy-full.pcapng");
    let all = documents(&decode(&[], &file));
    let time = |event: &Value| event["time"].as_f64();
    let cut = documents(&decode(&["--since", "1s", "--until", "2s"], &file));
    let expected = all
        .iter()
        .filter(|event| time(event).is_some_and(|at| (1.0..=2.0).contains(&at)));
    let expected: Vec<_> = expected.map(|event| &event["text"]).collect();
    let found: Vec<_> = cut
        .iter()
        .filter(|event| time(event).is_some())
        .map(|event| &event["text"])
        .collect();
    assert_eq!(found, expected);
    // by address and by a name that is given only later
    let name = all
        .iter()
        .find_map(|event| {
            event["data"]["results"]
                .is_array()
                .then(|| event["from"].as_str().unwrap())
        })
        .unwrap();
    let by_name = documents(&decode(&["--drive", name], &file));
    let by_mac = documents(&decode(&["--drive", "02:50:4e:00:00:01"], &file));
    let texts =
        |events: &[Value]| -> Vec<Value> { events.iter().map(|event| event["text"].clone()).collect() };
    assert!(by_mac.len() > 10);
    let missing: Vec<_> = texts(&by_mac)
        .into_iter()
        .filter(|text| !texts(&by_name).contains(text))
        .collect();
    assert_eq!(missing, [] as [Value; 0]);
    let no_match = documents(&decode(&["--drive", "no-such-drive"], &file));
    assert_eq!(no_match.len(), 1, "the end only: {no_match:?}");
    let no_match = decode(&["--drive", "no-such-drive"], &file);
    let warning = String::from_utf8_lossy(&no_match.stderr).into_owned();
    assert!(warning.contains("about no-such-drive"), "{warning}");
    let none = decode(&["--since", "2s", "--until", "1s"], &file);
    assert_eq!(none.status.code(), Some(2), "{none:?}");
}

#[test]
fn standard_input_is_a_capture_too() {
    let file = capture("pnet-profinetpy-full.pcapng");
    let mut piped = Command::new(built("profidrive"))
        .args(["--json", "decode", "-"])
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    let octets = std::fs::read(&file).unwrap();
    piped.stdin.take().unwrap().write_all(&octets).unwrap();
    let piped = piped.wait_with_output().unwrap();
    assert_eq!(piped.status.code(), Some(0));
    assert_eq!(piped.stdout, decode(&[], &file).stdout);
    let nothing = Command::new(built("profidrive")).arg("decode").output().unwrap();
    assert_eq!(nothing.status.code(), Some(2));
    let hint = String::from_utf8_lossy(&nothing.stderr).into_owned();
    assert!(hint.contains("standard input"), "{hint}");
}

/// Both directions of a wire are decoded as they pass, and Ctrl-C ends with the summary. What was kept is in the next archive.
#[test]
fn live_traffic_is_decoded_until_it_is_interrupted() {
    let lab = Lab::new("decode-live");
    let _drive = simulate(&lab, &["--name", "akd-1", "--ip", "192.168.77.50/24"]);
    let live = ["--json", "decode", "-i", "ctl0", "--keep", "10min"];
    let mut live = lab.spawn(Side::Controller, built("profidrive"), live);
    live.wait_for("capturing on ctl0", SHORT);
    live.wait_for("keeps the last 10 min", SHORT);
    client(&lab, &["scan"]).ok();
    client(&lab, &["read", "akd-1", "DRV.ACC"]).ok();
    live.wait_for("read response", SHORT);
    let live = live.interrupt(SHORT).ok();
    let events = live.json_lines();
    let asked = events
        .iter()
        .find(|event| event["data"]["service"] == "identify")
        .unwrap();
    assert_eq!(
        asked["source"]["mac"],
        Side::Controller.mac(),
        "what this end sends is decoded too"
    );
    assert!(
        events
            .iter()
            .any(|event| event["kind"] == "job" && event["data"]["side"] == "response")
    );
    let end = events.last().unwrap();
    assert_eq!(
        (&end["kind"], end["frames"].as_u64().unwrap() > 5),
        (&"end".into(), true)
    );

    let archive = lab.folder().join("state.zip");
    let name = archive.display().to_string();
    let made = client(&lab, &["bundle", "akd-1", "-o", &name, "--json"]).ok();
    let files = made.json_lines()[0]["files"].as_array().unwrap().clone();
    let kept = files
        .iter()
        .find(|file| file["name"] == "traffic/000001.pcapng")
        .unwrap();
    // what was decoded, frame by frame
    let kept_file = lab.folder().join("state/profidrive/traffic/ctl0/000001.pcapng");
    assert_eq!(kept["size"], kept_file.metadata().unwrap().len());
    let again = documents(&decode(&[], &kept_file));
    assert_eq!(again.last().unwrap()["frames"], end["frames"]);
}

//! What the frames of the network show.

use std::cell::Cell;
use std::io::Cursor;
use std::thread;
use std::time::{Duration, Instant};

use profidrive::traffic::{Detail, Reader, Walker};
use profidrive_workbench::{Settings, Source};
use serde_json::Value;

use crate::change::known;
use crate::namespace;
use crate::server::{Running, eventually};

/// The server reads the frames within this time.
const WAIT: Duration = Duration::from_secs(10);

fn bearer(server: &Running) -> String {
    Running::bearer(&server.view)
}

#[test]
fn states_and_telegram_of_a_drive_are_those_of_its_frames() {
    let server = Running::demo();
    let id = known(&server, "press-1");
    let machine = eventually(&server, &format!("/api/v1/drives/{id}/machine"), |topic| {
        topic["source"] == "frames" && topic["machine"]["state"] == "S4"
    });
    assert_eq!(machine["machine"]["awaited"], Value::Null);
    assert_eq!(
        machine["changes"].as_array().unwrap().last().unwrap()["state"],
        "S4"
    );
    let telegram = server
        .ask(
            "GET",
            &format!("/api/v1/drives/{id}/telegram"),
            &bearer(&server),
            "",
        )
        .json();
    assert_eq!(telegram["telegram"], 1);
    let halves = telegram["halves"].as_array().unwrap();
    let directions: Vec<_> = halves
        .iter()
        .map(|half| half["direction"].as_str().unwrap())
        .collect();
    assert_eq!(directions, ["output", "input"]);
    for half in halves {
        let octets = half["octets"].as_str().unwrap().split(' ').count() as u64;
        assert_eq!(half["tree"]["end"], octets);
        assert!(half["timing"]["frames"].as_u64().unwrap() > 0, "{half}");
    }
    // a drive without a connection is read, and has no frames
    let free = known(&server, "axis-1");
    let machine = server
        .ask(
            "GET",
            &format!("/api/v1/drives/{free}/machine"),
            &bearer(&server),
            "",
        )
        .json();
    assert_eq!(machine["source"], "parameters");
    let telegram = server
        .ask(
            "GET",
            &format!("/api/v1/drives/{free}/telegram"),
            &bearer(&server),
            "",
        )
        .json();
    assert_eq!(telegram["halves"], Value::Array(Vec::new()));
    let unknown = server.ask(
        "GET",
        "/api/v1/drives/02:00:00:00:00:01/machine",
        &bearer(&server),
        "",
    );
    assert_eq!(unknown.status, 404);
}

#[test]
fn the_frames_of_the_last_minute_are_a_capture() {
    let server = Running::demo();
    known(&server, "axis-1");
    let answer = server.ask("GET", "/api/v1/traffic", &bearer(&server), "");
    assert_eq!(answer.status, 200);
    assert_eq!(answer.header("content-type"), Some("application/x-pcapng"));
    // of an event long ago nothing is kept
    let before = server.ask("GET", "/api/v1/traffic?from=1000&to=2000", &bearer(&server), "");
    assert_eq!(before.status, 200);
    assert!(before.body.len() < answer.body.len());
    let wrong = server.ask("GET", "/api/v1/traffic?from=yesterday", &bearer(&server), "");
    assert_eq!(wrong.status, 400);
}

#[test]
fn addresses_alone_show_no_frames() {
    // where the computer has an interface it would be opened
    if !namespace::inside("frames::addresses_alone_show_no_frames") {
        return;
    }
    let addresses = vec!["127.0.0.1".parse().unwrap()];
    let server = Running::start(Settings::new(Source::Addresses(addresses)));
    assert_eq!(
        server.ask("GET", "/api/v1/traffic", &bearer(&server), "").status,
        404
    );
}

#[test]
fn the_log_is_read_in_pages_and_as_files() {
    let server = Running::demo();
    let id = known(&server, "axis-1");
    for number in 1..=5 {
        let event = format!("load=0.{number}Nm");
        server.post(
            "/api/v1/plant/inject",
            &serde_json::json!({ "drive": id, "event": event, "seconds": null }),
        );
    }
    server.logged(|log| log.len() == 10);
    let page = |path: &str| server.ask("GET", path, &bearer(&server), "").json();
    let first = page("/api/v1/audit?most=3");
    assert_eq!(first["records"].as_array().unwrap().len(), 3);
    assert_eq!(first["records"][0]["value"], "load=0.5Nm");
    assert_eq!(first["records"][0]["result"], "done");
    let before = first["before"].as_str().unwrap();
    let second = page(&format!("/api/v1/audit?most=3&before={before}"));
    assert_eq!(second["records"][0]["value"], "load=0.4Nm");
    let one = page(&format!("/api/v1/audit?text=0.2NM&drive={id}&action=inject"));
    assert_eq!(one["records"].as_array().unwrap().len(), 2);
    assert_eq!(
        page("/api/v1/audit?action=stop")["records"],
        Value::Array(Vec::new())
    );
    let csv = server.ask("GET", "/api/v1/logs/log.csv", &bearer(&server), "");
    assert_eq!(
        csv.body.lines().filter(|line| line.contains("load=0.")).count(),
        10
    );
    // a page cannot change a record
    for method in ["POST", "PUT", "DELETE"] {
        let answer = server.ask(method, "/api/v1/audit", &Running::bearer(&server.control), "");
        assert_eq!(answer.status, 405, "{answer:?}");
    }
}

/// Returns the texts of what went wrong on the network, with how often.
fn troubles(server: &Running) -> Vec<(String, u64)> {
    let report = server.ask("GET", "/api/v1/troubles", &bearer(server), "").json();
    let all = report["troubles"].as_array().unwrap().iter();
    all.map(|one| {
        (
            format!("{}: {}", one["from"], one["text"]),
            one["count"].as_u64().unwrap(),
        )
    })
    .collect()
}

/// Waits for the next search.
fn searched(server: &Running) {
    let before = Cell::new(f64::NEG_INFINITY);
    eventually(server, "/api/v1/stations", |report| {
        let age = report["age"].as_f64().unwrap_or(f64::INFINITY);
        age < before.replace(age)
    });
}

/// Returns how often a drive refused a parameter in the frames of the last minute.
fn refusals(server: &Running, drive: &str) -> usize {
    let file = server.file("/api/v1/traffic");
    let mut walker = Walker::new(None);
    let mut count = 0;
    for captured in Reader::new(Cursor::new(file)).unwrap().map(Result::unwrap) {
        let events = walker.frame(captured.time, &captured.frame);
        let of_drive = events.iter().filter(|event| event.from == drive);
        count += of_drive
            .filter(|event| matches!(&event.detail, Detail::Job(job) if job.refused.is_some()))
            .count();
    }
    count
}

/// A VLT has no PNU 930: what is read again and again does not request it each time.
#[test]
fn what_a_drive_does_not_have_is_not_read_again() {
    let server = Running::demo();
    known(&server, "pump-1");
    // identities are read each five seconds, the status each second: all of it is read again when a search ends
    searched(&server);
    let first = refusals(&server, "pump-1");
    assert!(first > 0, "it was looked for once");
    searched(&server);
    assert_eq!(refusals(&server, "pump-1"), first);
}

/// The server looks whether drives have what not each of them has; that they do not is an answer.
#[test]
fn what_the_server_looks_for_is_no_trouble_and_what_is_requested_is() {
    let server = Running::demo();
    let get = |path: String| {
        let answer = server.ask("GET", &path, &bearer(&server), "");
        assert_eq!(answer.status, 200, "{path}: {answer:?}");
        answer.json()
    };
    for name in ["axis-1", "pump-1", "fan-1"] {
        let id = known(&server, name);
        get(format!("/api/v1/drives/{id}/values/927,928?present=true"));
        get(format!("/api/v1/drives/{id}/changed"));
        get(format!("/api/v1/drives/{id}/faults"));
    }
    searched(&server);
    let refused = |text: &str| text.contains("0x00");
    let own: Vec<_> = troubles(&server)
        .into_iter()
        .filter(|(text, _)| refused(text))
        .collect();
    assert!(own.is_empty(), "{own:#?}");
    // a person has requested this one, and the drive refuses it
    let id = known(&server, "axis-1");
    let read = get(format!("/api/v1/drives/{id}/values/60000"));
    assert_eq!(read["parameters"][0]["error"]["number"], 0, "{read}");
    let listed = || {
        let all = troubles(&server);
        let mut own = all
            .iter()
            .filter(|(text, _)| text.contains("60000") && refused(text));
        own.next().map(|(_, count)| *count)
    };
    let begun = Instant::now();
    while listed().is_none() && begun.elapsed() < WAIT {
        thread::yield_now();
    }
    assert_eq!(listed(), Some(1));
}

#[test]
fn a_record_is_read_and_explained() {
    let server = Running::demo();
    let id = known(&server, "axis-1");
    let read = |query: &str| {
        server.ask(
            "GET",
            &format!("/api/v1/drives/{id}/record?{query}"),
            &bearer(&server),
            "",
        )
    };
    let identity = read("slot=0&subslot=1&index=45040");
    assert_eq!(identity.status, 200, "{identity:?}");
    let record = identity.json();
    assert!(
        record["octets"].as_str().unwrap().starts_with("00 20 00 38"),
        "{record}"
    );
    assert!(
        record["text"].as_str().unwrap().contains("order number AKD"),
        "{record}"
    );
    assert_eq!(read("slot=9&subslot=1&index=45040").json()["kind"], "refused");
    for wrong in [
        "slot=0&subslot=1",
        "slot=65536&subslot=1&index=1",
        "slot=x&subslot=1&index=1",
    ] {
        assert_eq!(read(wrong).status, 400, "{wrong}");
    }
}

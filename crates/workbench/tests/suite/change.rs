//! What changes something: what it does, who may do it, and what the log has of it.

use profidrive_workbench::{Settings, Source};
use serde_json::{Value, json};

use crate::server::{Running, eventually};

fn present(server: &Running, id: &str) -> Vec<u64> {
    let path = format!("/api/v1/drives/{id}/faults");
    let report = server
        .ask("GET", &path, &Running::bearer(&server.view), "")
        .json();
    let faults = report["faults"].as_array().unwrap().iter();
    let present = faults.filter(|fault| fault["acknowledged"] == false);
    present.map(|fault| fault["number"].as_u64().unwrap()).collect()
}

/// Waits until the drive of this name was read.
pub fn known(server: &Running, name: &str) -> String {
    let id = server.id(name);
    eventually(server, "/api/v1/stations", |all| {
        let mut stations = all["stations"].as_array().unwrap().iter();
        stations.any(|station| station["id"] == *id && !station["status"].is_null())
    });
    id
}

/// Returns action, value and result of the records of the log, without what was not wanted by this test.
fn records(server: &Running) -> Vec<(String, String, String)> {
    let text = |value: &Value| value.as_str().unwrap_or("-").to_owned();
    let of = |record: Value| {
        (
            text(&record["action"]),
            text(&record["value"]),
            text(&record["result"]),
        )
    };
    server.log().into_iter().map(of).collect()
}

#[test]
fn a_fault_is_injected_acknowledged_and_in_the_log() {
    let server = Running::demo();
    let id = known(&server, "axis-1");
    let inject = |event: &str| {
        server.post(
            "/api/v1/plant/inject",
            &json!({ "drive": id, "event": event, "seconds": null }),
        )
    };
    let path = format!("/api/v1/drives/{id}/acknowledge");
    let acknowledge = || server.post(&path, &json!({ "by": "control_word" }));
    let answer = inject("fault=439!");
    assert_eq!(
        (answer.status, &answer.json()["undo"]),
        (200, &"clear=439".into())
    );
    assert_eq!(present(&server, &id), [439]);
    let refused = acknowledge();
    assert_eq!(refused.status, 409, "the cause is present: {refused:?}");
    assert!(
        refused.json()["detail"].as_str().unwrap().contains("439"),
        "{refused:?}"
    );
    assert_eq!(inject("clear=439").status, 200);
    let done = acknowledge();
    assert_eq!(done.status, 200, "{done:?}");
    assert!(present(&server, &id).is_empty());
    let records = records(&server);
    let lines: Vec<(&str, &str, bool)> = records
        .iter()
        .map(|(action, value, result)| (&**action, &**value, result == "done"))
        .collect();
    assert_eq!(
        lines,
        [
            ("inject", "fault=439!", false),
            ("inject", "fault=439!", true),
            ("acknowledge", "-", false),
            ("acknowledge", "-", false),
            ("inject", "clear=439", false),
            ("inject", "clear=439", true),
            ("acknowledge", "-", false),
            ("acknowledge", "-", true),
        ]
    );
    assert!(records[3].2.contains("439"), "{records:?}");
    let first = &server.log()[0];
    assert_eq!(
        (&first["who"], &first["name"], &first["drive"]),
        (&"token".into(), &"axis-1".into(), &id.into())
    );
}

#[test]
fn a_drive_of_another_controller_keeps_it() {
    let server = Running::demo();
    let id = known(&server, "press-1");
    let path = format!("/api/v1/drives/{id}/acknowledge");
    eventually(&server, "/api/v1/plant/drives", |all| {
        let mut drives = all["drives"].as_array().unwrap().iter();
        drives.any(|drive| drive["id"] == *id && drive["speed"].as_f64().unwrap() > 100.0)
    });
    // nothing is wrong, so nothing is done
    let answer = server.post(&path, &json!({ "by": "control_word" }));
    assert_eq!(answer.status, 200, "{answer:?}");
    server.post(
        "/api/v1/plant/inject",
        &json!({ "drive": id, "event": "fault=439", "seconds": null }),
    );
    let refused = server.post(&path, &json!({ "by": "control_word" }));
    assert_eq!(refused.status, 409, "{refused:?}");
    assert!(
        refused.json()["detail"].as_str().unwrap().contains("plc-1"),
        "{refused:?}"
    );
}

#[test]
fn what_cannot_happen_is_refused_in_words() {
    let server = Running::demo();
    let id = server.id("axis-1");
    for (event, seconds, part) in [
        ("fault=999", Value::Null, "no fault 999"),
        ("fault", Value::Null, "KEY=VALUE"),
        ("=", Value::Null, "not an event"),
        ("sto=on", json!(0), "more than 0 s"),
        ("sto=on", json!(-1), "more than 0 s"),
        ("sto=on", json!(1e300), "at most a day"),
        ("clear=439", json!(5), "no end of its own"),
    ] {
        let body = json!({ "drive": id, "event": event, "seconds": seconds });
        let answer = server.post("/api/v1/plant/inject", &body);
        assert_eq!(answer.status, 400, "{event}: {answer:?}");
        assert!(
            answer.json()["detail"].as_str().unwrap().contains(part),
            "{answer:?}"
        );
    }
    let absent = json!({ "drive": "02:00:00:00:00:01", "event": "sto=on", "seconds": null });
    assert_eq!(server.post("/api/v1/plant/inject", &absent).status, 404);
    let path = format!("/api/v1/plant/drives/{id}/events");
    let possible = server
        .ask("GET", &path, &Running::bearer(&server.view), "")
        .json();
    let has = |list: &str, key: &str, value: Value| {
        let mut rows = possible[list].as_array().unwrap().iter();
        rows.any(|row| row[key] == value)
    };
    assert!(has("faults", "number", json!(439)) && has("keys", "key", json!("sto")));
}

#[test]
fn what_lasts_for_a_time_ends_by_itself() {
    let server = Running::demo();
    let id = known(&server, "axis-1");
    let body = json!({ "drive": id, "event": "sto=on", "seconds": 1.5 });
    assert_eq!(server.post("/api/v1/plant/inject", &body).status, 200);
    let allowed = |wanted: bool| {
        let path = format!("/api/v1/drives/{id}/status");
        eventually(&server, &path, |status| status["torque_allowed"] == wanted)
    };
    allowed(false);
    allowed(true);
}

#[test]
fn without_a_log_nothing_is_changed_and_stop_works() {
    let server = Running::start(Settings {
        log: None,
        ..Settings::new(Source::Demo)
    });
    let id = known(&server, "axis-2");
    let body = json!({ "drive": id, "event": "sto=on", "seconds": null });
    for (path, body) in [
        ("/api/v1/plant/inject".to_owned(), body),
        (
            format!("/api/v1/drives/{id}/acknowledge"),
            json!({ "by": "control_word" }),
        ),
    ] {
        let answer = server.post(&path, &body);
        assert_eq!(
            (answer.status, &answer.json()["kind"]),
            (503, &"log".into()),
            "{answer:?}"
        );
    }
    assert_eq!(present(&server, &id), [439]);
    let path = format!("/api/v1/drives/{id}/status");
    let status = server
        .ask("GET", &path, &Running::bearer(&server.view), "")
        .json();
    assert_eq!(status["torque_allowed"], true);
    assert_eq!(
        server
            .ask("POST", "/api/v1/stop", &Running::bearer(&server.view), "")
            .status,
        200
    );
    assert!(server.log().is_empty());
}

#[test]
fn tokens_are_not_in_the_log() {
    let server = Running::demo();
    let session = server.session(&server.control);
    assert_eq!(server.ask("POST", "/api/v1/stop", &session, "").status, 200);
    let log = server.log();
    assert_eq!(
        (log.len(), &log[0]["who"], &log[0]["action"]),
        (1, &"1".into(), &"stop".into())
    );
    let text = format!("{log:?}");
    let cookie = session
        .lines()
        .find_map(|line| line.strip_prefix("Cookie: a=b; "))
        .unwrap();
    let id = cookie.split_once('=').unwrap().1;
    for secret in [&*server.control, &server.view, &server.once, id] {
        assert!(!text.contains(secret));
    }
}

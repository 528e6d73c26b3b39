//! Signal, name and IP address of stations.

use profidrive_workbench::{Settings, Source};
use serde_json::{Value, json};

use crate::change::known;
use crate::namespace;
use crate::server::{Answer, JSON, Running, eventually};

fn post(server: &Running, id: &str, what: &str, body: &Value) -> Answer {
    server.post(&format!("/api/v1/stations/{id}/{what}"), body)
}

/// Waits until the station of the demo without name and address was found.
fn nameless(server: &Running) -> String {
    let id = server.id("new-1");
    station(server, &id, |_| true);
    id
}

/// Waits until a station is as wanted.
fn station(server: &Running, id: &str, fits: impl Fn(&Value) -> bool) {
    eventually(server, "/api/v1/stations", |all| {
        let mut stations = all["stations"].as_array().unwrap().iter();
        stations.any(|station| station["id"] == *id && fits(station))
    });
}

/// Returns the values of the records of an action, and what became of it.
fn logged(server: &Running, action: &str, count: usize) -> Vec<(String, String)> {
    let of = |log: &[Value]| -> Vec<(String, String)> {
        let text = |value: &Value| value.as_str().unwrap_or("-").to_owned();
        log.iter()
            .filter(|record| record["action"] == action)
            .map(|record| (text(&record["value"]), text(&record["result"])))
            .collect()
    };
    of(&server.logged(|log| of(log).len() >= count))
}

#[test]
fn a_dry_run_checks_a_name_converts_it_and_changes_nothing() {
    let server = Running::demo();
    let id = nameless(&server);
    known(&server, "axis-1");
    let check = |name: &str| {
        let answer = post(
            &server,
            &id,
            "name?dry_run=true",
            &json!({ "name": name, "permanent": true }),
        );
        assert_eq!(answer.status, 200, "{answer:?}");
        answer.json()
    };
    let bad = check("Axis_3");
    assert_eq!(
        (&bad["converted"], &bad["report"]),
        (&"axis-3".into(), &Value::Null)
    );
    let message = bad["refusal"]["message"].as_str().unwrap();
    assert!(message.contains("not a valid station name"), "{bad:#}");
    let twice = check("axis-1");
    let message = twice["refusal"]["message"].as_str().unwrap();
    assert!(message.contains(&server.id("axis-1")), "the other one: {twice:#}");
    assert_eq!(twice["converted"], Value::Null);
    let good = check("axis-3");
    assert_eq!(
        (&good["report"]["dry_run"], &good["refusal"]),
        (&true.into(), &Value::Null)
    );
    station(&server, &id, |station| station["name"].is_null());
    assert!(server.log().is_empty(), "nothing was done");
}

#[test]
fn a_station_is_named_once_and_the_log_has_old_and_new() {
    let server = Running::demo();
    let id = nameless(&server);
    known(&server, "axis-1");
    let named = |name: &str| post(&server, &id, "name", &json!({ "name": name, "permanent": true }));
    let answer = named("axis-3");
    assert_eq!(answer.status, 200, "{answer:?}");
    assert_eq!(answer.json()["report"]["name"], "axis-3");
    station(&server, &id, |station| station["name"] == "axis-3");
    let twice = named("axis-1");
    assert_eq!((twice.status, &twice.json()["kind"]), (409, &"refused".into()));
    let records = logged(&server, "name", 4);
    let change = "none -> axis-3, kept over power-off".to_owned();
    assert_eq!(
        records[..2],
        [(change.clone(), "-".to_owned()), (change, "done".to_owned())]
    );
    assert_eq!(records[2].0, "axis-3 -> axis-1, kept over power-off");
    assert!(records[3].1.contains("taken"), "{records:?}");
    assert_eq!(named("Axis_3").status, 400);
}

#[test]
fn an_address_is_checked_and_set() {
    let server = Running::demo();
    let id = nameless(&server);
    known(&server, "axis-1");
    let address =
        |ip: &str, mask: &str| json!({ "ip": ip, "mask": mask, "gateway": null, "permanent": false });
    let check = |ip: &str, mask: &str| {
        let answer = post(&server, &id, "ip?dry_run=true", &address(ip, mask));
        assert_eq!(answer.status, 200, "{answer:?}");
        answer.json()["refusal"]["message"].as_str().map(str::to_owned)
    };
    let taken = check("192.168.77.22", "255.255.255.0").unwrap();
    assert!(taken.contains(&server.id("axis-1")), "{taken}");
    assert!(
        check("192.168.77.29", "255.0.255.0")
            .unwrap()
            .contains("255.0.255.0")
    );
    assert_eq!(check("192.168.77.29", "255.255.255.0"), None);
    let answer = post(&server, &id, "ip", &address("192.168.77.29", "255.255.255.0"));
    assert_eq!(answer.status, 200, "{answer:?}");
    station(&server, &id, |station| station["ip"] == "192.168.77.29");
    let records = logged(&server, "ip", 2);
    assert_eq!(
        records[0].0,
        "none -> 192.168.77.29 mask 255.255.255.0, until power-off"
    );
    assert_eq!(records[1].1, "done");
    let answer = post(
        &server,
        &id,
        "ip",
        &json!({ "ip": "192.168.77.029", "mask": "255.255.255.0" }),
    );
    assert_eq!((answer.status, &answer.json()["kind"]), (422, &"body".into()));
    let detail = answer.json()["detail"].to_string();
    assert!(detail.contains("not what this request needs: ip: "), "{detail}");
}

#[test]
fn a_drive_under_control_keeps_name_and_address() {
    let server = Running::demo();
    let press = known(&server, "press-1");
    let address =
        json!({ "ip": "192.168.77.29", "mask": "255.255.255.0", "gateway": null, "permanent": true });
    let answer = post(
        &server,
        &press,
        "name",
        &json!({ "name": "axis-9", "permanent": true }),
    );
    assert_eq!(
        (answer.status, &answer.json()["kind"]),
        (409, &"safety".into()),
        "{answer:?}"
    );
    let answer = post(&server, &press, "ip", &address);
    assert_eq!(
        (answer.status, &answer.json()["kind"]),
        (409, &"safety".into()),
        "{answer:?}"
    );
    station(&server, &press, |station| station["name"] == "press-1");
}

#[test]
fn a_station_blinks_for_who_may_change_something() {
    let server = Running::demo();
    let id = nameless(&server);
    let answer = post(&server, &id, "blink", &json!({}));
    assert_eq!((answer.status, &answer.json()["mac"]), (200, &id.as_str().into()));
    assert_eq!(logged(&server, "blink", 2)[1].1, "done");
    let view = format!("{}{JSON}", Running::bearer(&server.view));
    for what in ["blink", "name", "ip", "name?dry_run=true"] {
        let answer = server.ask("POST", &format!("/api/v1/stations/{id}/{what}"), &view, "{}");
        assert_eq!(answer.status, 403, "{what}: {answer:?}");
    }
    assert_eq!(
        post(&server, "02:00:00:00:00:01", "blink", &json!({})).status,
        404
    );
}

#[test]
fn drives_that_are_given_by_their_addresses_are_not_named() {
    // where the computer has an interface it would be opened
    if !namespace::inside("stations::drives_that_are_given_by_their_addresses_are_not_named") {
        return;
    }
    let server = Running::start(Settings::new(Source::Addresses(vec![
        "127.0.0.9".parse().unwrap(),
    ])));
    station(&server, "ip-127.0.0.9", |_| true);
    let answer = post(&server, "ip-127.0.0.9", "blink", &json!({}));
    assert_eq!(
        (answer.status, &answer.json()["kind"]),
        (501, &"unsupported".into())
    );
}

//! STOP, by sockets and requests, and what else stops axes.

use std::time::{Duration, Instant};

use profidrive_workbench::{Settings, Source};
use serde_json::{Value, json};

use crate::change::known;
use crate::hands::{Hands, lease, rests, sentence, speed, turns};
use crate::live::Page;
use crate::server::{Running, eventually};

/// Presses STOP while an axis turns whose page has chosen how it stops. Returns its place in paths, and the hands that hold it.
fn stopped_by(server: &Running, way: &str) -> (String, Hands) {
    let id = known(server, "axis-1");
    let mut hands = Hands::of(server, &server.control);
    let take = json!({ "purpose": "speed", "limit": 300, "stop_by": way });
    let number = hands.send("take", &id, &take);
    let lease = lease(&hands.answer(number));
    hands.order("enable", &id, lease, 0, &json!({}));
    hands.order("velocity", &id, lease, 0, &json!({ "speed": 20 }));
    turns(server, &mut hands, &id, &Value::Null);
    hands.page.send(&json!({ "type": "stop" }));
    assert_eq!(hands.page.next("stopped")["drives"], json!([id]));
    (id, hands)
}

#[test]
fn a_stop_is_along_the_ramp_where_its_page_has_chosen_that() {
    let server = Running::demo();
    let (id, _hands) = stopped_by(&server, "off1");
    rests(&server, &id);
    // the state machine has a stop of its own for each
    let machine = server
        .ask(
            "GET",
            &format!("/api/v1/drives/{id}/machine"),
            &Running::bearer(&server.view),
            "",
        )
        .json();
    let words: Vec<&str> = machine["changes"]
        .as_array()
        .unwrap()
        .iter()
        .filter_map(|change| change["stw1"].as_str())
        .collect();
    assert!(
        words.iter().all(
            |word| u16::from_str_radix(word.trim_start_matches("0x"), 16).unwrap() & 4 != 0
                || *word == "0x0000"
        ),
        "no OFF3: {words:?}"
    );
    server.logged(|log| {
        log.iter()
            .any(|record| record["value"] == "for speed, STOP by OFF1, at most 300 rpm")
    });
}

#[test]
fn a_stop_lets_the_axis_coast_where_its_page_has_chosen_that() {
    let server = Running::demo();
    let (id, _hands) = stopped_by(&server, "off2");
    // the power stage is off at once, and control lasts until the axis rests
    let machine = eventually(&server, &format!("/api/v1/drives/{id}/machine"), |topic| {
        topic["machine"]["state"] == "S1" && topic["source"] == "frames"
    });
    let words = machine["changes"].as_array().unwrap().iter();
    let off2 = |word: &str| u16::from_str_radix(word.trim_start_matches("0x"), 16).unwrap() & 3 == 0;
    assert!(
        words
            .filter_map(|change| change["stw1"].as_str())
            .any(|word| word != "0x0000" && off2(word)),
        "OFF2: {machine:#}"
    );
    rests(&server, &id);
    server.logged(|log| {
        log.iter()
            .any(|record| record["value"] == "for speed, STOP by OFF2, at most 300 rpm")
    });
}

#[test]
fn nothing_waits_for_the_drives_of_a_plant_that_stands_still() {
    let server = Running::demo();
    let id = known(&server, "axis-1");
    let key = Running::bearer(&server.control);
    let clock = |paused: bool| server.post("/api/v1/plant/clock", &json!({ "paused": paused }));
    assert_eq!(clock(true).status, 200);
    let status = format!("/api/v1/drives/{id}/status");
    let waits = server.ask("GET", &status, &key, "");
    assert_eq!(waits.status, 409);
    assert!(
        waits.json()["detail"].as_str().unwrap().contains("stands still"),
        "{}",
        waits.json()
    );
    let stations = server.ask("GET", "/api/v1/stations", &key, "");
    assert_eq!((stations.status, &stations.json()["paused"]), (200, &json!(true)));
    let mut hands = Hands::of(&server, &server.control);
    let taken = hands.take(&id);
    assert!(sentence(&taken).contains("stands still"), "{taken}");
    assert_eq!(clock(false).status, 200);
    assert_eq!(server.ask("GET", &status, &key, "").status, 200);
    lease(&hands.take(&id));
    assert_eq!(clock(true).status, 409, "an axis is controlled");
    // and it does not hold up the end of the server
    let server = Running::demo();
    known(&server, "axis-1");
    let paused = server.post("/api/v1/plant/clock", &json!({ "paused": true }));
    assert_eq!(paused.status, 200);
    drop(server);
}

#[test]
fn a_stop_by_a_request_reaches_the_axis_of_a_socket() {
    let server = Running::demo();
    let id = known(&server, "axis-1");
    let mut hands = Hands::of(&server, &server.control);
    let lease = lease(&hands.take(&id));
    hands.order("enable", &id, lease, 0, &json!({}));
    hands.order("velocity", &id, lease, 0, &json!({ "speed": 20 }));
    turns(&server, &mut hands, &id, &Value::Null);
    // by the way of a program
    let stopped = server
        .ask("POST", "/api/v1/stop", &Running::bearer(&server.view), "")
        .json();
    assert_eq!(stopped["axes"], json!([id]));
    rests(&server, &id);
    let log = server.logged(|log| log.iter().any(|record| record["action"] == "stop"));
    let stop = log.iter().find(|record| record["action"] == "stop").unwrap();
    assert!(stop["result"].as_str().unwrap().contains("axis-1"), "{stop}");
    // it is in the log of that drive, and of no other one
    let of = |id: &str| {
        let path = format!("/api/v1/audit?action=stop&drive={id}");
        let page = server
            .ask("GET", &path, &Running::bearer(&server.view), "")
            .json();
        page["records"].as_array().unwrap().len()
    };
    assert_eq!((of(&id), of("02:00:00:00:00:77")), (1, 0));
}

#[test]
fn a_server_that_ends_stops_its_axes() {
    let server = Running::start(Settings::new(Source::Demo));
    let id = known(&server, "axis-1");
    let mut hands = Hands::of(&server, &server.control);
    let lease = lease(&hands.take(&id));
    hands.order("enable", &id, lease, 0, &json!({}));
    hands.order("velocity", &id, lease, 0, &json!({ "speed": 20 }));
    turns(&server, &mut hands, &id, &Value::Null);
    server.end();
    // written once it is at rest and given back, and before the server is gone
    let log = server.logged(|log| log.iter().any(|record| record["action"] == "release"));
    let release = log.iter().find(|record| record["action"] == "release").unwrap();
    assert_eq!(release["result"], "done", "{release}");
    let begin = Instant::now();
    drop(server);
    assert!(begin.elapsed() < Duration::from_secs(10));
}

/// A pump that turns on when its controller is lost.
const RUNS_ON: &str = r#"
[[drive]]
name = "pump-1"
model = "vlt"
ip = "192.168.77.24/24"
parameters = { "8-04" = 0 }

[[drive]]
name = "press-1"
ip = "192.168.77.21/24"

[[controller]]
drive = "press-1"
telegram = 1
step = [
    { at = "0.3s", send = { STW1 = "0x047E" } },
    { at = "0.5s", send = { STW1 = "0x047F", NSOLL_A = "60rpm" } },
]
"#;

#[test]
fn a_drive_that_turns_without_a_controller_is_stopped_by_each_session() {
    let server = Running::start(Settings::new(Source::Plant(Box::new(RUNS_ON.parse().unwrap()))));
    let (id, owned) = (known(&server, "pump-1"), known(&server, "press-1"));
    let offer = |id: &str, fits: &dyn Fn(&Value) -> bool| {
        let mut seen = Value::Null;
        eventually(&server, "/api/v1/stations", |all| {
            let mut stations = all["stations"].as_array().unwrap().iter();
            seen_of(&mut stations, id).is_some_and(|stop| fits(&stop))
        });
        let all = server.ask("GET", "/api/v1/stations", &Running::bearer(&server.view), "");
        let all = all.json();
        if let Some(stop) = seen_of(&mut all["stations"].as_array().unwrap().iter(), id) {
            seen = stop;
        }
        seen
    };
    let at_rest = offer(&id, &|stop| stop["means"] == "none");
    assert_eq!(at_rest["reason"], "at_rest");
    let mut hands = Hands::of(&server, &server.control);
    let take = json!({ "purpose": "speed", "limit": 300, "may_run_on": true });
    let number = hands.send("take", &id, &take);
    let lease = lease(&hands.answer(number));
    hands.order("enable", &id, lease, 0, &json!({}));
    hands.confirm(&id, lease, 20.0);
    let go = hands.order("velocity", &id, lease, 0, &json!({ "speed": 120 }));
    assert_eq!(go["type"], "accepted", "{go}");
    turns(&server, &mut hands, &id, &Value::Null);
    // no controller has it any more, and it turns on
    let body = json!({ "drive": id, "event": "cable=pulled", "seconds": 1 });
    assert_eq!(server.post("/api/v1/plant/inject", &body).status, 200);
    let turning = offer(&id, &|stop| stop["means"] == "control_word");
    assert_eq!(turning["reason"], Value::Null);
    assert!(speed(&server, &id).abs() > 15.0);
    let view = server.session(&server.view);
    let path = format!("/api/v1/drives/{id}/stop");
    let foreign = view.replace("Origin: http://", "Origin: http://foreign.");
    assert_eq!(server.ask("POST", &path, &foreign, "").status, 403);
    assert!(speed(&server, &id).abs() > 15.0);
    // who presses twice stops it once
    let both = std::thread::scope(|scope| {
        let press = || server.ask("POST", &path, &view, "");
        let both = [scope.spawn(press), scope.spawn(press)];
        both.map(|press| press.join().unwrap())
    });
    for stopped in both {
        assert_eq!(stopped.status, 200, "{stopped:?}");
        assert_eq!(stopped.json()["at_rest"], true, "{stopped:?}");
    }
    assert!(speed(&server, &id).abs() < 1.0);
    server.logged(|log| {
        log.iter()
            .any(|record| record["action"] == "stop" && record["drive"] == *id)
    });
    // that of another controller is left alone
    let stop = offer(&owned, &|stop| stop["reason"] == "controller");
    assert_eq!(
        (&stop["means"], &stop["controller"]),
        (&"none".into(), &"plc-1".into())
    );
    eventually(&server, "/api/v1/plant/drives", |all| {
        let mut drives = all["drives"].as_array().unwrap().iter();
        drives.any(|drive| drive["id"] == *owned && drive["speed"].as_f64() > Some(50.0))
    });
    let path = format!("/api/v1/drives/{owned}/stop");
    let refused = server.ask("POST", &path, &view, "");
    assert_eq!(refused.status, 409, "{refused:?}");
    let why = refused.json()["detail"].as_str().unwrap_or_default().to_owned();
    assert!(why.contains("plc-1"), "{refused:?}");
    let hint = refused.json()["hint"].as_str().unwrap_or_default().to_owned();
    assert!(hint.contains("emergency stop"), "{refused:?}");
    assert!(speed(&server, &owned) > 50.0);
}

/// A ramp of a minute is too long for what a person sees, and a quick stop too hard for what is only to be switched off.
fn a_second_stop_is_quick(waits_for_the_ramp: bool) {
    let plant = RUNS_ON.replace(r#""8-04" = 0"#, r#""8-04" = 0, "3-42" = "60 s", "3-81" = "1 s""#);
    let server = Running::start(Settings::new(Source::Plant(Box::new(plant.parse().unwrap()))));
    let id = known(&server, "pump-1");
    let mut hands = Hands::of(&server, &server.control);
    let take = json!({ "purpose": "speed", "limit": 1500, "may_run_on": true });
    let number = hands.send("take", &id, &take);
    let lease = lease(&hands.answer(number));
    hands.order("enable", &id, lease, 0, &json!({}));
    hands.confirm(&id, lease, 20.0);
    hands.order("velocity", &id, lease, 0, &json!({ "speed": 900 }));
    let begin = Instant::now();
    while speed(&server, &id) < 800.0 {
        assert!(begin.elapsed() < Duration::from_secs(60));
        hands.beat(&Value::Null);
        std::thread::sleep(Duration::from_millis(20));
    }
    let body = json!({ "drive": id, "event": "cable=pulled", "seconds": 1 });
    assert_eq!(server.post("/api/v1/plant/inject", &body).status, 200);
    eventually(&server, "/api/v1/stations", |all| {
        let stop = seen_of(&mut all["stations"].as_array().unwrap().iter(), &id);
        stop.is_some_and(|stop| stop["means"] == "control_word")
    });
    let view = server.session(&server.view);
    let path = format!("/api/v1/drives/{id}/stop");
    let press = || server.ask("POST", &path, &view, "");
    std::thread::scope(|scope| {
        let first = scope.spawn(press);
        let begins = speed(&server, &id);
        if waits_for_the_ramp {
            eventually(&server, "/api/v1/plant/drives", |_| {
                let now = speed(&server, &id);
                assert!(now > 300.0, "it is on its ramp of a minute, {now} rpm");
                now < begins - 10.0
            });
        }
        let begin = Instant::now();
        let second = press();
        assert!(
            begin.elapsed() < Duration::from_secs(15),
            "{:?} {second:?}",
            begin.elapsed()
        );
        for stopped in [second, first.join().unwrap()] {
            let report = stopped.json();
            assert_eq!(report["at_rest"], true, "{stopped:?}");
            assert_eq!(report["sent"], "OFF3 (control word)", "{stopped:?}");
        }
    });
    assert!(speed(&server, &id).abs() < 1.0);
    server.logged(|log| {
        let quick = |record: &Value| {
            record["result"]
                .as_str()
                .is_some_and(|text| text.starts_with("OFF3 "))
        };
        log.iter().any(quick)
    });
}

#[test]
fn a_second_stop_turns_the_ramp_of_a_drive_without_a_controller_into_its_quick_stop() {
    a_second_stop_is_quick(true);
}

/// While the first one still reads who has the drive, or connects.
#[test]
fn a_second_stop_at_once_makes_a_quick_stop_too() {
    a_second_stop_is_quick(false);
}

fn seen_of<'s>(stations: &mut impl Iterator<Item = &'s Value>, id: &str) -> Option<Value> {
    let station = stations.find(|station| station["id"] == *id)?;
    Some(station["stop"].clone()).filter(|stop| !stop.is_null())
}

#[test]
fn a_stop_of_one_drive_that_this_server_controls_is_stop() {
    let server = Running::demo();
    let id = known(&server, "axis-1");
    let mut hands = Hands::of(&server, &server.control);
    let lease = lease(&hands.take(&id));
    hands.order("enable", &id, lease, 0, &json!({}));
    hands.order("velocity", &id, lease, 0, &json!({ "speed": 20 }));
    turns(&server, &mut hands, &id, &Value::Null);
    let path = format!("/api/v1/drives/{id}/stop");
    let stopped = server.ask("POST", &path, &server.session(&server.view), "");
    assert_eq!(stopped.status, 200, "{stopped:?}");
    assert!(speed(&server, &id).abs() < 1.0);
    assert_eq!(hands.page.next("stopped")["epoch"], 1);
    assert_eq!(server.stops(), 1);
}

/// The log is full while an axis moves.
#[cfg(unix)]
#[test]
fn a_disk_that_fills_while_an_axis_moves_keeps_no_stop_from_it() {
    let server = Running::demo();
    let id = known(&server, "axis-1");
    let mut hands = Hands::of(&server, &server.control);
    let mut page = Page::of(&server);
    let lease = lease(&hands.take(&id));
    hands.order("enable", &id, lease, 0, &json!({}));
    hands.order("velocity", &id, lease, 0, &json!({ "speed": 20 }));
    turns(&server, &mut hands, &id, &Value::Null);
    // the file of today is said to be as long as one may be, and no other one has room
    let mut files = std::fs::read_dir(&server.folder).unwrap();
    let file = files
        .find_map(|entry| {
            let path = entry.unwrap().path();
            path.to_string_lossy().ends_with("-000.jsonl").then_some(path)
        })
        .unwrap();
    let full = file.to_string_lossy().replace("-000.jsonl", "-001.jsonl");
    std::os::unix::fs::symlink("/dev/full", &full).unwrap();
    let log = std::fs::OpenOptions::new().append(true).open(&file).unwrap();
    let length = log.metadata().unwrap().len();
    log.set_len(64 << 20).unwrap();
    let refused = hands.order("velocity", &id, lease, 0, &json!({ "speed": 25 }));
    assert!(sentence(&refused).contains("cannot be logged"), "{refused}");
    let inject = json!({ "drive": id, "event": "fault=439!" });
    assert_eq!(server.post("/api/v1/plant/inject", &inject).status, 503);
    assert!(speed(&server, &id).abs() > 15.0, "what was under way goes on");
    hands.page.send(&json!({ "type": "stop" }));
    let stopped = hands.stopped();
    assert_eq!(stopped["confirmed"], true, "{stopped}");
    rests(&server, &id);
    // that it is not in the log is said to all pages
    while page.next("event")["kind"] != "log" {}
    // nothing of what was written is lost, and with room there is a log again
    log.set_len(length).unwrap();
    std::fs::remove_file(&full).unwrap();
    assert_eq!(server.post("/api/v1/stop", &json!({})).status, 200);
    server.logged(|log| {
        ["take", "enable", "velocity", "stop"]
            .iter()
            .all(|action| log.iter().any(|record| record["action"] == *action))
    });
}

/// A link to look is handed to others, and each of them may stop.
#[test]
fn a_flood_of_stops_of_nothing_is_carried_out_and_does_not_fill_the_log() {
    let server = Running::demo();
    let id = known(&server, "axis-1");
    let view = server.session(&server.view);
    let begin = Instant::now();
    let press = || {
        let stopped = server.ask("POST", "/api/v1/stop", &view, "");
        assert_eq!(stopped.status, 200, "{stopped:?}");
        stopped.json()["stops"].as_u64().unwrap()
    };
    for number in 1..=60 {
        assert_eq!(press(), number);
    }
    let seconds = usize::try_from(begin.elapsed().as_secs()).unwrap();
    let of_stops = |log: &[Value]| log.iter().filter(|record| record["action"] == "stop").count();
    let log = server.logged(|log| of_stops(log) >= 20);
    assert!(of_stops(&log) <= 21 + seconds, "{log:#?}");
    // one that ends a motion is in the log whatever came before it, with how and when its frame left
    let mut hands = Hands::of(&server, &server.control);
    let number = hands.send("reset", &id, &json!({ "epoch": 60 }));
    assert_eq!(hands.answer(number)["type"], "accepted");
    let lease = lease(&hands.take(&id));
    hands.order("enable", &id, lease, 60, &json!({}));
    hands.order("velocity", &id, lease, 60, &json!({ "speed": 20 }));
    turns(&server, &mut hands, &id, &Value::Null);
    assert_eq!(press(), 61);
    server.logged(|log| {
        log.iter().any(|record| {
            let text = record["result"].as_str().unwrap_or_default();
            text.starts_with("STOP 61: axis-1: OFF3 sent at ") && text.contains(" UTC")
        })
    });
}

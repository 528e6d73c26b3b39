//! The control socket: who has an axis, and what is sent to the others.

use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

use profidrive_workbench::{Settings, Source};
use serde_json::{Value, json};

use crate::change::known;
use crate::hands::{Hands, PROTOCOL, lease, rests, sentence, speed, turns};
use crate::live::{Page, open_at};
use crate::server::{JSON, Running, eventually};

#[test]
fn a_lease_is_of_its_socket_and_a_stop_of_everybody() {
    let server = Running::demo();
    let id = known(&server, "axis-1");
    let mut hands = Hands::of(&server, &server.control);
    let lease = lease(&hands.take(&id));
    // another session, another tab, and one that only looks
    let mut thief = Hands::of(&server, &server.control);
    assert!(sentence(&thief.take(&id)).contains("has control"));
    let stolen = thief.order("enable", &id, lease, 0, &json!({}));
    assert!(sentence(&stolen).contains("not have control"), "{stolen}");
    thief.send("release", &id, &json!({}));
    thief.send("halt", &id, &json!({ "lease": lease }));
    let mut looker = Hands::of(&server, &server.view);
    assert!(sentence(&looker.take(&id)).contains("view-only"));
    assert_eq!(
        hands.order("enable", &id, lease, 0, &json!({}))["type"],
        "accepted"
    );
    let go = hands.order("velocity", &id, lease, 0, &json!({ "speed": 20 }));
    assert_eq!(go["type"], "accepted", "{go}");
    turns(&server, &mut hands, &id, &Value::Null);
    looker.page.send(&json!({ "type": "stop" }));
    let stopped = looker.page.next("stopped");
    assert_eq!(stopped["drives"], json!([id]));
    // a frame with it has left, and pages report which stop that is
    assert_eq!(stopped["confirmed"], true, "{stopped}");
    let frame = &stopped["axes"][0];
    assert_eq!((&frame["by"], &frame["state"]), (&"off3".into(), &"sent".into()));
    let now = SystemTime::now().duration_since(UNIX_EPOCH).unwrap().as_millis();
    let ago = now - u128::from(frame["sent_unix_ms"].as_u64().unwrap());
    assert!(ago < 10_000, "{ago} ms ago: {stopped}");
    // programs need no sentence for why it stopped
    while hands.page.next("axes")["axes"][0]["trouble"]["kind"] != "stopped" {
        hands.beat(&Value::Null);
    }
    rests(&server, &id);
    // what was sent before the STOP was seen, and before it is reset
    for (epoch, part) in [(0, "before it"), (1, "reset")] {
        for kind in ["enable", "velocity"] {
            let refused = hands.order(kind, &id, lease, epoch, &json!({ "speed": 20 }));
            assert!(sentence(&refused).contains(part), "{refused}");
            assert_eq!(refused["kind"], "refused", "{refused}");
        }
    }
    let number = looker.send("reset", &id, &json!({ "epoch": 1 }));
    assert!(sentence(&looker.answer(number)).contains("view-only"));
    let number = hands.send("reset", &id, &json!({ "epoch": 0 }));
    assert!(sentence(&hands.answer(number)).contains("STOP"));
    let number = hands.send("reset", &id, &json!({ "epoch": 1 }));
    assert_eq!(hands.answer(number)["type"], "accepted");
    // nothing has started by itself
    assert!(speed(&server, &id).abs() < 0.1);
    let enabled = hands.order("enable", &id, lease, 1, &json!({}));
    assert_eq!(enabled["type"], "accepted", "{enabled}");
    // a command once more
    let again = hands.number;
    hands
        .page
        .send(&json!({ "type": "enable", "n": again, "drive": id, "lease": lease, "epoch": 1 }));
    let replayed = hands.answer(again);
    assert!(sentence(&replayed).contains("came before"), "{replayed}");
}

#[test]
fn a_record_has_the_drive_the_time_of_the_engine_and_the_stops() {
    let server = Running::demo();
    let id = known(&server, "axis-1");
    let mut hands = Hands::of(&server, &server.control);
    hands.page.send(&json!({ "type": "stop" }));
    hands.page.next("stopped");
    server.logged(|log| log.iter().any(|record| record["action"] == "stop"));
    let lease = lease(&hands.take(&id));
    hands.order("enable", &id, lease, 0, &json!({}));
    let log = server.logged(|log| log.iter().any(|record| record["action"] == "enable"));
    let stations = server.ask("GET", "/api/v1/stations", &Running::bearer(&server.view), "");
    let stations = stations.json();
    let mut all = stations["stations"].as_array().unwrap().iter();
    let station = all.find(|station| station["id"] == *id).unwrap();
    let serial = &station["info"]["identity"]["serial_number"];
    assert!(
        serial.as_str().is_some_and(|serial| !serial.is_empty()),
        "{station:#}"
    );
    let take = log.iter().find(|record| record["action"] == "take").unwrap();
    assert_eq!((&take["serial"], &take["epoch"]), (serial, &1.into()), "{take}");
    let from = |action: &str| {
        let record = log.iter().find(|record| record["action"] == action).unwrap();
        record["address"].clone()
    };
    assert_eq!(
        (from("take"), from("stop")),
        ("127.0.0.1".into(), "127.0.0.1".into())
    );
    let times: Vec<u64> = log
        .iter()
        .map(|record| record["engine_us"].as_u64().unwrap())
        .collect();
    assert!(
        times[0] > 0 && times.is_sorted_by(|before, after| before <= after),
        "{times:?}"
    );
}

#[test]
fn who_people_say_they_are_stands_beside_what_they_hold_and_in_the_log() {
    let server = Running::demo();
    let id = known(&server, "axis-1");
    let session = server.session(&server.control);
    let put = |headers: &str, body: &str| {
        let headers = format!("{headers}{JSON}");
        server.ask("PUT", "/api/v1/session", &headers, body)
    };
    let long = format!("{{\"name\":\" An\\u0007na \\u202e{}\"}}", "x".repeat(5000));
    let kept = put(&session, &long).json();
    let name = kept["name"].as_str().unwrap().to_owned();
    assert!(
        name.starts_with("Anna xxx") && name.chars().count() == 40,
        "{name}"
    );
    assert_eq!(put(&session, "{\"name\":\"Anna\"}").json()["name"], "Anna");
    assert_eq!(
        server.ask("GET", "/api/v1/session", &session, "").json()["name"],
        "Anna"
    );
    assert_eq!(
        put(&Running::bearer(&server.control), "{\"name\":\"x\"}").status,
        409
    );
    let mut hands = Hands::at(&server, &session);
    let lease = lease(&hands.take(&id));
    let axis = hands.page.next("axes")["axes"][0].clone();
    assert_eq!(axis["claimed_name"], "Anna", "{axis}");
    let mut other = Hands::of(&server, &server.control);
    let refused = other.take(&id);
    assert!(
        sentence(&refused).contains("(\"Anna\", not verified) has control of this drive"),
        "{refused}"
    );
    // a new name is in what follows; the lease has that of the time when it was taken
    put(&session, "{\"name\":\"Ben\"}");
    hands.order("enable", &id, lease, 0, &json!({}));
    hands.page.send(&json!({ "type": "stop" }));
    let stopped = other.page.next("stopped");
    assert_eq!(stopped["claimed_name"], "Ben", "{stopped}");
    assert_eq!(sentence(&other.take(&id)), sentence(&refused));
    server.logged(|log| {
        let has = |action: &str, name: Value| {
            log.iter()
                .any(|record| record["action"] == action && record["claimed_name"] == name)
        };
        has("take", json!("Anna"))
            && has("take", Value::Null)
            && has("enable", json!("Ben"))
            && has("stop", json!("Ben"))
    });
    let csv = server.ask("GET", "/api/v1/logs/log.csv", &session, "").body;
    assert!(
        csv.contains(",claimed_name,address\r\n") && csv.contains(",Anna,127.0.0.1\r\n"),
        "{csv}"
    );
    // an empty one is none
    assert_eq!(put(&session, "{\"name\":\" \"}").json()["name"], Value::Null);
}

#[test]
fn what_is_refused_is_in_the_log() {
    let server = Running::demo();
    let id = known(&server, "axis-1");
    let mut hands = Hands::of(&server, &server.control);
    let lease = lease(&hands.take(&id));
    let mut thief = Hands::of(&server, &server.control);
    thief.take(&id);
    thief.order("enable", &id, lease, 0, &json!({}));
    hands.order("enable", &id, lease, 0, &json!({}));
    hands.order("velocity", &id, lease, 0, &json!({ "speed": 301 }));
    hands.order("home", &id, lease, 0, &json!({}));
    hands.page.send(&json!({ "type": "stop" }));
    hands.page.next("stopped");
    hands.order("velocity", &id, lease, 0, &json!({ "speed": 20 }));
    let foreign = "Host: {address}\r\nOrigin: http://evil.example\r\n";
    assert_eq!(
        server.ask("GET", "/api/v1/server?token=x", foreign, "").status,
        403
    );
    for (action, value, reason) in [
        ("take", None, "has control of this drive"),
        ("enable", None, "not have control"),
        ("velocity", Some("301 rpm"), "above the limit of this page"),
        ("home", None, "direction of a first motion"),
        ("velocity", Some("20 rpm"), "STOP was pressed meanwhile"),
        (
            "request",
            Some("GET /api/v1/server, from http://evil.example"),
            "only the page of this server",
        ),
    ] {
        server.logged(|log| {
            let is = |record: &Value| {
                let result = record["result"].as_str().unwrap_or_default();
                record["action"] == action
                    && record["value"].as_str() == value
                    && result.starts_with("refused: ")
                    && result.contains(reason)
            };
            log.iter().any(is)
        });
    }
}

#[test]
fn a_socket_that_breaks_the_rules_is_closed_and_its_axis_stops() {
    let server = Running::demo();
    let id = known(&server, "axis-1");
    for (message, code) in [
        ("{".to_owned(), 1008),
        (format!("{{\"type\":\"{}\"}}", "x".repeat(5000)), 1009),
        ("[".repeat(1000), 1008),
    ] {
        let mut hands = Hands::of(&server, &server.control);
        let lease = lease(&hands.take(&id));
        hands.order("enable", &id, lease, 0, &json!({}));
        hands.order("velocity", &id, lease, 0, &json!({ "speed": 20 }));
        turns(&server, &mut hands, &id, &Value::Null);
        hands.page.text(&message);
        let closed = hands.page.closed();
        assert!(closed == Some(code) || closed.is_none(), "{closed:?}");
        rests(&server, &id);
        eventually(&server, "/api/v1/server", |report| {
            report["controlled"] == json!([])
        });
    }
    // a flood ends its socket; STOP is not counted
    let mut flood = Hands::of(&server, &server.control);
    for _ in 0..150 {
        flood.page.send(&json!({ "type": "stop" }));
    }
    assert_eq!(flood.page.next("stopped")["type"], "stopped");
    for _ in 0..150 {
        flood.page.text("{\"type\":\"tomorrow\"}");
    }
    let closed = flood.page.closed();
    assert!(closed == Some(1008) || closed.is_none(), "{closed:?}");
    // nor does a STOP behind it get lost
    let before = server.stops();
    let mut late = Hands::of(&server, &server.control);
    for _ in 0..150 {
        late.page.text("{\"type\":\"tomorrow\"}");
    }
    late.page.send(&json!({ "type": "stop" }));
    late.page.closed();
    eventually(&server, "/api/v1/server", |_| server.stops() > before);
}

#[test]
fn an_axis_is_taken_with_the_update_time_that_is_requested() {
    let server = Running::demo();
    let id = known(&server, "axis-1");
    let mut hands = Hands::of(&server, &server.control);
    // one that there is not, and one that this drive does not offer
    let hint = "without an update time in the request one that it offers is used";
    for (cycle, key, part) in [(3, "sentence", "3 ms"), (4, "hint", hint)] {
        let take = json!({ "purpose": "speed", "limit": 300, "cycle_ms": cycle });
        let number = hands.send("take", &id, &take);
        let refused = hands.answer(number);
        assert!(
            refused[key].as_str().is_some_and(|text| text.contains(part)),
            "{refused}"
        );
        // the place of the axis is given back behind the refusal
        eventually(&server, "/api/v1/server", |report| {
            report["controlled"] == json!([])
        });
    }
    let path = format!("/api/v1/drives/{id}/telegram");
    for (cycle, seconds) in [(json!(32), 0.032), (Value::Null, 0.016)] {
        let number = hands.send(
            "take",
            &id,
            &json!({ "purpose": "speed", "limit": 300, "cycle_ms": cycle }),
        );
        lease(&hands.answer(number));
        let begin = Instant::now();
        loop {
            hands.beat(&Value::Null);
            let telegram = server
                .ask("GET", &path, &Running::bearer(&server.view), "")
                .json();
            let timing = &telegram["halves"][0]["timing"];
            if timing["cycle"]
                .as_f64()
                .is_some_and(|is| (is - seconds).abs() < 1e-4)
            {
                break;
            }
            assert!(begin.elapsed() < Duration::from_secs(20), "{timing}");
            std::thread::sleep(Duration::from_millis(30));
        }
        hands.send("release", &id, &json!({}));
        eventually(&server, "/api/v1/server", |report| {
            report["controlled"] == json!([])
        });
    }
}

#[test]
fn a_page_without_an_axis_hears_signs_of_life_of_both_sockets() {
    let server = Running::demo();
    for kind in ["axes", "clock"] {
        let mut page = match kind {
            "axes" => Hands::of(&server, &server.view).page,
            _ => Page::of(&server),
        };
        page.next(kind);
        let begin = Instant::now();
        for _ in 0..8 {
            page.next(kind);
        }
        let time = begin.elapsed();
        // four in a second, on a computer that does other things too
        assert!(time < Duration::from_secs(6), "{kind}: {time:?}");
        assert!(
            time > Duration::from_millis(1200),
            "{kind}: it is no flood: {time:?}"
        );
    }
}

#[test]
fn a_page_learns_from_which_build_its_server_is() {
    let server = Running::demo();
    let report = server.ask("GET", "/api/v1/server", &Running::bearer(&server.view), "");
    let build = report.json()["build"].clone();
    let text = build.as_str().unwrap();
    assert!(
        text.starts_with(env!("CARGO_PKG_VERSION")) && text.contains('+'),
        "{text}"
    );
    let session = server.session(&server.view);
    for (path, protocol) in [("control", PROTOCOL), ("live", "profidrive.live.1")] {
        let path = format!("/api/v1/{path}");
        let page = open_at(&server, &path, &session, Some(protocol));
        let hello = page.unwrap_or_else(|status| panic!("{status}")).next("hello");
        assert_eq!(hello["build"], build, "{path}");
    }
}

#[test]
fn a_lease_is_of_no_other_tab_of_its_session_and_of_no_socket_after_a_reconnect() {
    let server = Running::demo();
    let id = known(&server, "axis-1");
    let session = server.session(&server.control);
    let mut hands = Hands::at(&server, &session);
    let lease = lease(&hands.take(&id));
    let mut tab = Hands::at(&server, &session);
    assert!(sentence(&tab.take(&id)).contains("has control"));
    for kind in ["enable", "disable", "acknowledge", "velocity", "home"] {
        let refused = tab.order(kind, &id, lease, 0, &json!({ "speed": 20 }));
        assert!(
            sentence(&refused).contains("not have control"),
            "{kind}: {refused}"
        );
    }
    tab.send("release", &id, &json!({}));
    tab.send("halt", &id, &json!({ "lease": lease }));
    let own = hands.order("enable", &id, lease, 0, &json!({}));
    assert_eq!(own["type"], "accepted", "its own tab keeps it: {own}");
    drop(hands);
    let mut again = Hands::at(&server, &session);
    for _ in 0..2 {
        let refused = again.order("enable", &id, lease, 0, &json!({}));
        assert!(sentence(&refused).contains("not have control"), "{refused}");
        // while the axis is given back, and afterwards
        eventually(&server, "/api/v1/server", |report| {
            report["controlled"] == json!([])
        });
    }
    server.logged(|log| {
        log.iter().any(|record| {
            let result = record["result"].as_str().unwrap_or_default();
            record["action"] == "enable"
                && result.starts_with("refused: ")
                && result.contains("not have control")
        })
    });
}

#[test]
fn what_one_page_floods_its_socket_with_leaves_the_beats_of_another_alone() {
    let server = Running::demo();
    let id = known(&server, "axis-1");
    let mut hands = Hands::of(&server, &server.control);
    let lease = lease(&hands.take(&id));
    hands.order("enable", &id, lease, 0, &json!({}));
    hands.order("velocity", &id, lease, 0, &json!({ "speed": 20 }));
    turns(&server, &mut hands, &id, &Value::Null);
    let session = server.session(&server.view);
    let attack = || {
        let mut large = Hands::at(&server, &session);
        large.page.text(&"x".repeat(1 << 20));
        let mut closed = vec![large.page.closed()];
        let mut binary = Hands::at(&server, &session);
        binary.page.octets(vec![1; 64]);
        closed.push(binary.page.closed());
        let mut flood = Hands::at(&server, &session);
        for _ in 0..10_000 {
            flood.page.text("{\"type\":\"tomorrow\"}");
        }
        closed.push(flood.page.closed());
        closed
    };
    std::thread::scope(|scope| {
        let attack = scope.spawn(attack);
        hands.page.patience(Duration::from_millis(20));
        let mut echoes = 0;
        while !attack.is_finished() || echoes < 10 {
            hands.beat(&Value::Null);
            let (sent, number) = (Instant::now(), hands.beats);
            let echo = loop {
                assert!(
                    sent.elapsed() < Duration::from_secs(1),
                    "beat {number} is not answered"
                );
                match hands.page.poll() {
                    Some(message) if message["type"] == "beat" && message["n"] == number => break message,
                    _ => {}
                }
            };
            assert_eq!(echo["n"], number);
            echoes += 1;
            std::thread::sleep(Duration::from_millis(20));
        }
        let closed = attack.join().unwrap();
        for (code, closed) in [1009, 1008, 1008].into_iter().zip(closed) {
            assert!(closed == Some(code) || closed.is_none(), "{code} {closed:?}");
        }
    });
    assert!(speed(&server, &id).abs() > 15.0, "it turns on");
    // a flood of STOPs stops, and each page hears of it
    let mut flood = Hands::at(&server, &session);
    for _ in 0..2000 {
        flood.page.send(&json!({ "type": "stop" }));
    }
    while hands.stopped()["epoch"] != 2000 {
        hands.beat(&Value::Null);
    }
    rests(&server, &id);
    let reset = hands.send("reset", &id, &json!({ "epoch": 2000 }));
    assert_eq!(hands.answer(reset)["type"], "accepted", "its socket is open");
}

#[test]
fn a_page_that_controls_nothing_is_refused_with_its_own_reason() {
    let server = Running::demo();
    let id = known(&server, "axis-1");
    let remote = server.session(&server.control) + "X-Forwarded-For: 192.168.0.9\r\n";
    let only = Running::start(Settings {
        read_only: true,
        ..Settings::new(Source::Demo)
    });
    let view = server.session(&server.view);
    let read_only = only.session(&only.control);
    for (server, session, reason) in [
        (&server, &view, "this session is view-only"),
        (&server, &remote, "another computer"),
        (&only, &read_only, "this server was started view-only"),
    ] {
        let mut hands = Hands::at(server, session);
        let taken = hands.take(&id);
        assert!(sentence(&taken).contains(reason), "{taken}");
        let reset = hands.send("reset", &id, &json!({ "epoch": 0 }));
        let reset = hands.answer(reset);
        assert!(sentence(&reset).contains(reason), "{reset}");
    }
}

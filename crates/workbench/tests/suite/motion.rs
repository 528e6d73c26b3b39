//! Motions that a page commands by its control socket, and what limits and ends them.

use std::time::{Duration, Instant};

use profidrive_workbench::{Settings, Source};
use serde_json::{Value, json};

use crate::change::known;
use crate::hands::{Hands, lease, position, rests, sentence, speed, turns};
use crate::server::{Running, eventually};

#[test]
fn a_jog_lasts_as_long_as_fresh_beats_and_control_too() {
    let server = Running::demo();
    let id = known(&server, "axis-1");
    let mut hands = Hands::of(&server, &server.control);
    let lease = lease(&hands.take(&id));
    assert_eq!(
        hands.order("enable", &id, lease, 0, &json!({}))["type"],
        "accepted"
    );
    let t = hands.time();
    let jog = hands.send(
        "jog",
        &id,
        &json!({ "lease": lease, "epoch": 0, "t": t, "rtt": 5, "speed": 20 }),
    );
    let held = json!({ "drive": id, "n": jog });
    turns(&server, &mut hands, &id, &held);
    // no beat comes any more: first the jog ends, then control
    rests(&server, &id);
    eventually(&server, "/api/v1/server", |report| {
        report["controlled"] == json!([])
    });
    let late = hands.order("enable", &id, lease, 0, &json!({}));
    assert!(sentence(&late).contains("not have control"), "{late}");
    for action in ["take", "enable", "jog", "release"] {
        server.logged(|log| log.iter().any(|record| record["action"] == action));
    }
}

#[test]
fn beats_that_come_too_late_keep_nothing_going() {
    let server = Running::demo();
    let id = known(&server, "axis-1");
    let mut hands = Hands::of(&server, &server.control);
    let lease = lease(&hands.take(&id));
    hands.order("enable", &id, lease, 0, &json!({}));
    let t = hands.time();
    let jog = hands.send(
        "jog",
        &id,
        &json!({ "lease": lease, "epoch": 0, "t": t, "rtt": 5, "speed": 20 }),
    );
    let held = json!({ "drive": id, "n": jog });
    turns(&server, &mut hands, &id, &held);
    // as from a network that has held them back: there are enough of them, and each is old
    let begin = Instant::now();
    while speed(&server, &id).abs() > 0.1 {
        assert!(begin.elapsed() < Duration::from_secs(10), "it turns");
        hands.beats += 1;
        let old = hands.time() - 300.0;
        hands
            .page
            .send(&json!({ "type": "beat", "n": hands.beats, "t": old, "held": held }));
        std::thread::sleep(Duration::from_millis(40));
    }
    let t = hands.time() - 300.0;
    let late = hands.send(
        "jog",
        &id,
        &json!({ "lease": lease, "epoch": 0, "t": t, "rtt": 5, "speed": 20 }),
    );
    let late = hands.answer(late);
    assert!(
        sentence(&late).contains("too late") || sentence(&late).contains("not have control"),
        "{late}"
    );
}

#[test]
fn a_jog_needs_a_short_round_trip_that_its_page_reports() {
    let server = Running::demo();
    let id = known(&server, "axis-1");
    let mut hands = Hands::of(&server, &server.control);
    let lease = lease(&hands.take(&id));
    hands.order("enable", &id, lease, 0, &json!({}));
    for (rtt, part) in [
        (Value::Null, "send it as `rtt`"),
        (
            json!(140.5),
            "the round trip to the page is 140.5 ms, above 100 ms",
        ),
        (json!(-3), "is -3 ms"),
        (json!(1e308), "is 1e308 ms"),
    ] {
        let t = hands.time();
        let jog = json!({ "t": t, "rtt": rtt, "speed": 20 });
        let refused = hands.order("jog", &id, lease, 0, &jog);
        assert!(sentence(&refused).contains(part), "{refused}");
    }
    // a program that does not know of it is asked for it
    let t = hands.time();
    let refused = hands.order("jog", &id, lease, 0, &json!({ "t": t, "speed": 20 }));
    assert!(sentence(&refused).contains("send it as `rtt`"), "{refused}");
    assert!(speed(&server, &id).abs() < 0.1);
    server.logged(|log| {
        log.iter().any(|record| {
            let result = record["result"].as_str().unwrap_or_default();
            record["action"] == "jog" && record["value"] == "20 rpm" && result.contains("140.5 ms")
        })
    });
    let t = hands.time();
    let jog = hands.send(
        "jog",
        &id,
        &json!({ "lease": lease, "epoch": 0, "t": t, "rtt": 99.5, "speed": 20 }),
    );
    turns(&server, &mut hands, &id, &json!({ "drive": id, "n": jog }));
}

#[test]
fn an_axis_is_halted_within_its_travel_and_goes_back() {
    let server = Running::demo();
    let id = known(&server, "axis-1");
    let mut hands = Hands::of(&server, &server.control);
    let none = hands.send("take", &id, &json!({ "purpose": "speed", "travel": 0 }));
    assert!(sentence(&hands.answer(none)).contains("travel has to be"));
    let take = json!({ "purpose": "speed", "limit": 300, "travel": 1.5 });
    let number = hands.send("take", &id, &take);
    let lease = lease(&hands.answer(number));
    hands.order("enable", &id, lease, 0, &json!({}));
    let before = position(&server, &id);
    let begin = Instant::now();
    // where frames are late the axis is halted earlier, and what is left is enough to go on for a moment
    let on = loop {
        let on = hands.order("velocity", &id, lease, 0, &json!({ "speed": 30 }));
        if on["type"] == "refused" {
            break on;
        }
        let begun = Instant::now();
        while speed(&server, &id).abs() < 0.1 && begun.elapsed() < Duration::from_secs(1) {
            hands.beat(&Value::Null);
            std::thread::sleep(Duration::from_millis(10));
        }
        while speed(&server, &id).abs() > 0.1 {
            assert!(begin.elapsed() < Duration::from_secs(15), "it turns");
            hands.beat(&Value::Null);
            std::thread::sleep(Duration::from_millis(30));
        }
    };
    let way = position(&server, &id) - before;
    assert!((1.3..=1.5).contains(&way), "{way}");
    assert!(sentence(&on).contains("travel of this session, 1.5 rev"), "{on}");
    let back = hands.order("velocity", &id, lease, 0, &json!({ "speed": -30 }));
    assert_eq!(back["type"], "accepted", "{back}");
    server.logged(|log| {
        let is =
            |record: &Value| record["value"] == "for speed, STOP by OFF3, at most 300 rpm, travel 1.5 rev";
        log.iter().any(is)
    });
}

#[test]
fn speeds_above_the_limits_and_drives_of_others_are_refused_in_words() {
    let server = Running::demo();
    let press = known(&server, "press-1");
    let id = known(&server, "axis-1");
    let mut hands = Hands::of(&server, &server.control);
    assert!(sentence(&hands.take(&press)).contains("plc-1"));
    assert!(sentence(&hands.take("02:00:00:00:00:01")).contains("no such drive"));
    let lease = lease(&hands.take(&id));
    let off = hands.order("velocity", &id, lease, 0, &json!({ "speed": 20 }));
    assert!(sentence(&off).contains("not enabled"), "{off}");
    hands.order("enable", &id, lease, 0, &json!({}));
    let fast = hands.order("velocity", &id, lease, 0, &json!({ "speed": 31 }));
    assert!(sentence(&fast).contains("tenth"), "{fast}");
    hands.confirm(&id, lease, 20.0);
    let fast = hands.order("velocity", &id, lease, 0, &json!({ "speed": -301 }));
    assert!(sentence(&fast).contains("limit of this page"), "{fast}");
    let go = hands.order("velocity", &id, lease, 0, &json!({ "speed": -300 }));
    assert_eq!(go["type"], "accepted", "{go}");
    let other = hands.order("home", &id, lease, 0, &json!({}));
    assert_eq!(other["type"], "refused", "for speeds: {other}");
}

/// An axis that homes by its switch, which is not there, at this speed.
const HOMING: &str = "[[drive]]\nname = \"axis-1\"\nip = \"10.0.0.1/24\"\n\
    parameters = { \"HOME.MODE\" = 4, \"HOME.V\" = \"600rpm\", \"HOME.ACC\" = \"6000rpm/s\" }";

/// An axis in position mode with this highest speed, enabled, its direction confirmed.
fn homing(limit: f64) -> (Running, String, Hands, u64) {
    let server = Running::start(Settings::new(Source::Plant(Box::new(HOMING.parse().unwrap()))));
    let id = known(&server, "axis-1");
    let mut hands = Hands::of(&server, &server.control);
    let take = json!({ "purpose": "position", "limit": limit, "set_mode": true });
    let number = hands.send("take", &id, &take);
    let lease = lease(&hands.answer(number));
    let enabled = hands.order("enable", &id, lease, 0, &json!({}));
    assert_eq!(enabled["type"], "accepted", "{enabled}");
    let first = hands.order("home", &id, lease, 0, &json!({}));
    assert!(
        sentence(&first).contains("direction of a first motion"),
        "{first}"
    );
    let first = hands.order("task", &id, lease, 0, &json!({ "number": 1 }));
    assert!(
        sentence(&first).contains("direction of a first motion"),
        "{first}"
    );
    hands.confirm(&id, lease, limit / 10.0);
    rests(&server, &id);
    (server, id, hands, lease)
}

#[test]
fn homing_is_within_the_highest_speed_of_the_session_too() {
    let (server, id, mut hands, lease) = homing(10.0);
    let fast = hands.order("home", &id, lease, 0, &json!({}));
    let said = sentence(&fast);
    assert!(
        said.contains("600 rpm") && said.contains("limit of 10 rpm"),
        "{fast}"
    );
    assert_eq!(fast["kind"], "safety", "{fast}");
    assert!(speed(&server, &id).abs() < 0.1);
}

/// Homes until the shaft turns fast; returns the number of the command.
fn homes(server: &Running, id: &str, hands: &mut Hands, lease: u64) -> u64 {
    let home = hands.send("home", id, &json!({ "lease": lease, "epoch": 0 }));
    let begin = Instant::now();
    while speed(server, id).abs() < 500.0 {
        assert!(begin.elapsed() < Duration::from_secs(10), "it rests");
        hands.beat(&Value::Null);
        std::thread::sleep(Duration::from_millis(30));
    }
    home
}

#[test]
fn disable_does_not_wait_for_the_end_of_homing() {
    let (server, id, mut hands, lease) = homing(1000.0);
    homes(&server, &id, &mut hands, lease);
    let begin = Instant::now();
    let off = hands.order("disable", &id, lease, 0, &json!({}));
    assert_eq!(off["type"], "accepted", "{off}");
    assert!(speed(&server, &id).abs() < 1.0);
    assert!(begin.elapsed() < Duration::from_secs(5), "{:?}", begin.elapsed());
    let axes = hands.page.next("axes");
    assert_eq!(axes["axes"][0]["phase"], "off", "{axes}");
    // control goes on
    let on = hands.order("enable", &id, lease, 0, &json!({}));
    assert_eq!(on["type"], "accepted", "{on}");
}

#[test]
fn homing_that_is_halted_is_not_done() {
    let (server, id, mut hands, lease) = homing(1000.0);
    let home = homes(&server, &id, &mut hands, lease);
    hands.send("halt", &id, &json!({ "lease": lease }));
    let ended = hands.answer(home);
    assert!(sentence(&ended).contains("homing was ended by a halt"), "{ended}");
    rests(&server, &id);
    server.logged(|log| {
        let is = |record: &Value| {
            let result = record["result"].as_str().unwrap_or_default();
            record["action"] == "home" && result.contains("home position is not set")
        };
        log.iter().any(is)
    });
}

//! The control socket, as pages, programs and attackers use it.

use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

use profidrive_workbench::{Settings, Source};
use serde_json::{Value, json};

use crate::change::known;
use crate::live::{Page, open_at};
use crate::server::{JSON, Running, eventually};

const PROTOCOL: &str = "profidrive.control.1";

/// A page with a control socket, and the numbers of its commands.
pub struct Hands {
    page: Page,
    number: u64,
    begin: Instant,
    beats: u64,
    /// When the last beat was sent.
    beaten: Option<Instant>,
}

impl Hands {
    pub fn of(server: &Running, token: &str) -> Self {
        Self::at(server, &server.session(token))
    }

    /// Those of a session that there is.
    pub fn at(server: &Running, session: &str) -> Self {
        let page = open_at(server, "/api/v1/control", session, Some(PROTOCOL));
        let mut page = page.unwrap_or_else(|status| panic!("{status}"));
        page.next("hello");
        Self {
            page,
            number: 0,
            begin: Instant::now(),
            beats: 0,
            beaten: None,
        }
    }

    /// Returns the next STOP that it hears of.
    pub fn stopped(&mut self) -> Value {
        self.page.next("stopped")
    }

    fn time(&self) -> f64 {
        self.begin.elapsed().as_secs_f64() * 1000.0
    }

    /// Sends a command; returns its number.
    pub fn send(&mut self, kind: &str, drive: &str, more: &Value) -> u64 {
        self.number += 1;
        let mut message = json!({ "type": kind, "n": self.number, "drive": drive });
        for (key, value) in more.as_object().unwrap() {
            message[key] = value.clone();
        }
        self.page.send(&message);
        self.number
    }

    pub fn beat(&mut self, held: &Value) {
        self.beats += 1;
        self.beaten = Some(Instant::now());
        let t = self.time();
        self.page
            .send(&json!({ "type": "beat", "n": self.beats, "t": t, "held": held }));
    }

    /// Beats until a command is answered, and returns the answer.
    pub fn answer(&mut self, number: u64) -> Value {
        let begin = Instant::now();
        self.page.patience(Duration::from_millis(20));
        loop {
            assert!(begin.elapsed() < Duration::from_secs(30), "no answer to {number}");
            if let Some(message) = self.page.poll() {
                let kind = message["type"].as_str().unwrap_or_default();
                if message["n"] == number && matches!(kind, "accepted" | "refused" | "lease") {
                    return message;
                }
            }
            if self
                .beaten
                .is_none_or(|beaten| beaten.elapsed() > Duration::from_millis(50))
            {
                self.beat(&Value::Null);
            }
        }
    }

    /// Waits until the server closes the socket; returns why.
    pub fn closed(&mut self) -> Option<u16> {
        self.page.closed()
    }

    pub fn take(&mut self, drive: &str) -> Value {
        let number = self.send("take", drive, &json!({ "purpose": "speed", "limit": 300 }));
        self.answer(number)
    }

    /// Sends a command of this lease and waits for its answer.
    pub fn order(&mut self, kind: &str, drive: &str, lease: u64, epoch: u64, more: &Value) -> Value {
        let mut all = json!({ "lease": lease, "epoch": epoch });
        for (key, value) in more.as_object().unwrap() {
            all[key] = value.clone();
        }
        let number = self.send(kind, drive, &all);
        self.answer(number)
    }
}

pub fn lease(answer: &Value) -> u64 {
    assert_eq!(answer["type"], "lease", "{answer}");
    answer["lease"].as_u64().unwrap()
}

pub fn sentence(answer: &Value) -> &str {
    assert_eq!(answer["type"], "refused", "{answer}");
    answer["sentence"].as_str().unwrap()
}

fn speed(server: &Running, id: &str) -> f64 {
    let drives = server
        .ask("GET", "/api/v1/plant/drives", &Running::bearer(&server.view), "")
        .json();
    let mut drives = drives["drives"].as_array().unwrap().iter();
    drives.find(|drive| drive["id"] == *id).unwrap()["speed"]
        .as_f64()
        .unwrap()
}

/// Waits until the shaft rests.
fn position(server: &Running, id: &str) -> f64 {
    let answer = server.ask("GET", "/api/v1/plant/drives", &Running::bearer(&server.view), "");
    let drives = answer.json();
    let mut all = drives["drives"].as_array().unwrap().iter();
    all.find(|drive| drive["id"] == id).unwrap()["position"]
        .as_f64()
        .unwrap()
}

fn rests(server: &Running, id: &str) {
    let begin = Instant::now();
    while speed(server, id).abs() > 0.1 {
        assert!(begin.elapsed() < Duration::from_secs(10), "it turns");
        std::thread::sleep(Duration::from_millis(5));
    }
}

/// Beats until the shaft turns.
fn turns(server: &Running, hands: &mut Hands, id: &str, held: &Value) {
    let begin = Instant::now();
    while speed(server, id).abs() < 15.0 {
        assert!(begin.elapsed() < Duration::from_secs(10), "it rests");
        hands.beat(held);
        std::thread::sleep(Duration::from_millis(30));
    }
}

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
    assert!(sentence(&late).contains("no control"), "{late}");
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
        sentence(&late).contains("too late") || sentence(&late).contains("no control"),
        "{late}"
    );
}

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
    assert!(sentence(&stolen).contains("no control"), "{stolen}");
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
        ("enable", None, "no control"),
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
fn a_stop_passes_a_socket_that_takes_no_answers() {
    let server = Running::demo();
    let id = known(&server, "axis-1");
    let mut hands = Hands::of(&server, &server.control);
    let lease = lease(&hands.take(&id));
    hands.order("enable", &id, lease, 0, &json!({}));
    hands.order("velocity", &id, lease, 0, &json!({ "speed": 20 }));
    turns(&server, &mut hands, &id, &Value::Null);
    // by the way of a program, while the socket is not read
    let stopped = server
        .ask("POST", "/api/v1/stop", &Running::bearer(&server.view), "")
        .json();
    assert_eq!(stopped["axes"], json!([id]));
    rests(&server, &id);
    let log = server.logged(|log| log.iter().any(|record| record["action"] == "stop"));
    let stop = log.iter().find(|record| record["action"] == "stop").unwrap();
    assert!(stop["result"].as_str().unwrap().contains("axis-1"), "{stop}");
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
    hands.order("confirm", &id, lease, 0, &json!({}));
    let fast = hands.order("velocity", &id, lease, 0, &json!({ "speed": -301 }));
    assert!(sentence(&fast).contains("limit of this page"), "{fast}");
    let go = hands.order("velocity", &id, lease, 0, &json!({ "speed": -300 }));
    assert_eq!(go["type"], "accepted", "{go}");
    let other = hands.order("home", &id, lease, 0, &json!({}));
    assert_eq!(other["type"], "refused", "for speeds: {other}");
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
    let begin = Instant::now();
    // waits until the axis is at rest and given back
    drop(server);
    assert!(begin.elapsed() < Duration::from_secs(10));
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
    hands.order("confirm", &id, lease, 0, &json!({}));
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
    hands.order("confirm", &id, lease, 0, &json!({}));
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
    assert!(speed(&server, &owned) > 50.0);
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
        assert!(sentence(&refused).contains("no control"), "{kind}: {refused}");
    }
    tab.send("release", &id, &json!({}));
    tab.send("halt", &id, &json!({ "lease": lease }));
    let own = hands.order("enable", &id, lease, 0, &json!({}));
    assert_eq!(own["type"], "accepted", "its own tab keeps it: {own}");
    drop(hands);
    let mut again = Hands::at(&server, &session);
    for _ in 0..2 {
        let refused = again.order("enable", &id, lease, 0, &json!({}));
        assert!(sentence(&refused).contains("no control"), "{refused}");
        // while the axis is given back, and afterwards
        eventually(&server, "/api/v1/server", |report| {
            report["controlled"] == json!([])
        });
    }
    server.logged(|log| {
        log.iter().any(|record| {
            let result = record["result"].as_str().unwrap_or_default();
            record["action"] == "enable" && result.starts_with("refused: ") && result.contains("no control")
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

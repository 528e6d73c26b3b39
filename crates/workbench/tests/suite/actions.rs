//! Which requests have a record in the log: each that changes something of a drive, a station or the plant, or stops or moves it.

use profidrive_workbench::openapi;
use serde_json::{Value, json};

use crate::captures::{self, FULL};
use crate::change::known;
use crate::hands::{Hands, lease};
use crate::restart::plant_file;
use crate::server::{Answer, JSON, Running};
use crate::settings::settled;

/// What stands for the rest: it changes nothing beyond this server.
const READS: Option<&str> = None;

/// Each request that is no `GET`, and the action of its record. In an order in which each can be carried out.
const ROUTES: [(&str, &str, Option<&str>); 22] = [
    ("POST", "/api/v1/session", READS),
    ("PUT", "/api/v1/session", READS),
    ("DELETE", "/api/v1/session", READS),
    ("POST", "/api/v1/stations/scan", READS),
    ("POST", "/api/v1/stations/{id}/blink", Some("blink")),
    ("POST", "/api/v1/stations/{id}/name", Some("name")),
    ("POST", "/api/v1/stations/{id}/ip", Some("ip")),
    ("POST", "/api/v1/drives/{id}/plans", READS),
    ("POST", "/api/v1/plans/{id}/apply", Some("write")),
    ("POST", "/api/v1/plans/{id}/undo", Some("undo")),
    ("POST", "/api/v1/drives/{id}/backups", READS),
    ("POST", "/api/v1/backups", READS),
    ("POST", "/api/v1/compare", READS),
    ("POST", "/api/v1/captures", READS),
    ("DELETE", "/api/v1/captures/{id}", READS),
    ("POST", "/api/v1/plant/inject", Some("inject")),
    ("POST", "/api/v1/drives/{id}/acknowledge", Some("acknowledge")),
    ("POST", "/api/v1/plant/clock", Some("clock")),
    ("POST", "/api/v1/drives/{id}/stop", Some("stop")),
    ("POST", "/api/v1/stop", Some("stop")),
    ("POST", "/api/v1/plant/check", READS),
    ("POST", "/api/v1/plant/restart", Some("restart")),
];

/// A server, and what earlier requests have made there.
struct Play {
    server: Running,
    axis: String,
    unnamed: String,
    /// The number of the job that was begun last.
    job: Value,
    backup: String,
}

impl Play {
    fn new() -> Self {
        let server = Running::demo();
        Self {
            axis: known(&server, "axis-1"),
            unnamed: server.id("new-1"),
            job: Value::Null,
            backup: String::new(),
            server,
        }
    }

    fn settled(&mut self, answer: Answer) -> Answer {
        let job = settled(&self.server, &answer);
        self.job = answer.json()["id"].clone();
        if let Some(file) = job["file"].as_str() {
            self.backup = file.to_owned();
        }
        answer
    }

    /// Makes a request so that it is carried out.
    fn carry_out(&mut self, method: &str, route: &str) -> Answer {
        let bearer = Running::bearer(&self.server.control);
        let of_drive = |path: &str| path.replace("{id}", &self.axis);
        let of_station = |path: &str| path.replace("{id}", &self.unnamed);
        let of_job = |path: &str| path.replace("{id}", &self.job.to_string());
        let ask = |path: &str, body: &Value| {
            self.server
                .ask(method, path, &format!("{bearer}{JSON}"), &body.to_string())
        };
        match (method, route) {
            ("POST", "/api/v1/session") => self.server.login(&self.server.control),
            (_, "/api/v1/session") => {
                let headers = format!("{}{JSON}", self.server.session(&self.server.control));
                self.server.ask(method, route, &headers, "{\"name\":\"Anna\"}")
            }
            (_, "/api/v1/stations/{id}/name") => ask(
                &of_station(route),
                &json!({ "name": "axis-3", "permanent": true }),
            ),
            (_, "/api/v1/stations/{id}/ip") => {
                let address = json!({ "ip": "192.168.77.29", "mask": "255.255.255.0", "gateway": null, "permanent": false });
                ask(&of_station(route), &address)
            }
            (_, "/api/v1/stations/{id}/blink") => ask(&of_station(route), &json!({})),
            (_, "/api/v1/drives/{id}/plans") => {
                let changes = json!([{ "parameter": "DRV.ACC", "value": "8000 rpm/s" }]);
                let answer = ask(&of_drive(route), &json!({ "changes": changes, "save": false }));
                self.settled(answer)
            }
            (_, "/api/v1/plans/{id}/apply" | "/api/v1/plans/{id}/undo") => {
                let answer = ask(&of_job(route), &json!({}));
                self.settled(answer)
            }
            (_, "/api/v1/drives/{id}/backups") => {
                let answer = ask(&of_drive(route), &json!({}));
                self.settled(answer)
            }
            (_, "/api/v1/backups") => {
                let path = format!("/api/v1/backups/{}", self.backup);
                let text = self.server.ask("GET", &path, &bearer, "").body;
                ask(route, &json!({ "text": text }))
            }
            (_, "/api/v1/compare") => {
                let sides = json!({ "left": { "file": self.backup }, "right": { "drive": self.axis } });
                let answer = ask(route, &sides);
                self.settled(answer)
            }
            ("POST", "/api/v1/captures") => {
                let answer = captures::post(&self.server, FULL.len() as u64, FULL);
                self.job = answer.json()["id"].clone();
                answer
            }
            ("DELETE", "/api/v1/captures/{id}") => ask(&of_job(route), &json!({})),
            (_, "/api/v1/plant/inject") => ask(
                route,
                &json!({ "drive": self.axis, "event": "fault=439", "seconds": null }),
            ),
            (_, "/api/v1/drives/{id}/acknowledge") => ask(&of_drive(route), &json!({ "by": "control_word" })),
            (_, "/api/v1/plant/clock") => ask(route, &json!({ "paused": false })),
            (_, "/api/v1/drives/{id}/stop") => ask(&of_drive(route), &json!({})),
            (_, "/api/v1/plant/check") => ask(route, &json!({ "text": plant_file(&self.server) })),
            (_, "/api/v1/plant/restart") => {
                ask(route, &json!({ "text": plant_file(&self.server), "restarts": 0 }))
            }
            (_, "/api/v1/stations/scan" | "/api/v1/stop") => ask(route, &json!({})),
            _ => panic!("a new request: what is it carried out with, and is it in the log?"),
        }
    }
}

#[test]
fn each_request_that_changes_something_has_its_record() {
    let description: Value = serde_json::from_str(&openapi()).unwrap();
    let paths = description["paths"].as_object().unwrap().iter();
    let mut all: Vec<(String, String)> = paths
        .flat_map(|(path, methods)| {
            let methods = methods.as_object().unwrap().keys();
            methods.map(move |method| (method.to_uppercase(), path.clone()))
        })
        .filter(|(method, _)| method != "GET")
        .collect();
    let mut listed: Vec<_> = ROUTES
        .iter()
        .map(|(method, path, _)| ((*method).to_owned(), (*path).to_owned()))
        .collect();
    all.sort();
    listed.sort();
    assert_eq!(listed, all, "each has an answer whether it is in the log");
    let mut play = Play::new();
    for (method, route, action) in ROUTES {
        let before = play.server.log().len();
        let answer = play.carry_out(method, route);
        assert!(
            (200..300).contains(&answer.status),
            "{method} {route}: {answer:?}"
        );
        match action {
            Some(action) => {
                let done = |log: &[Value]| {
                    let mut new = log[before..].iter();
                    new.any(|one| one["action"] == action && !one["result"].is_null())
                };
                play.server.logged(done);
            }
            None => assert_eq!(play.server.log().len(), before, "{method} {route}"),
        }
    }
}

#[test]
fn each_command_of_a_page_has_its_record() {
    let server = Running::demo();
    let id = known(&server, "axis-1");
    let mut hands = Hands::of(&server, &server.control);
    let terms = json!({ "purpose": "position", "limit": 300, "set_mode": true });
    let number = hands.send("take", &id, &terms);
    let lease = lease(&hands.answer(number));
    let speed = json!({ "speed": 20, "rtt": 1, "t": hands.time() });
    let far = json!({ "turns": 1, "relative": true, "speed": 20 });
    for (kind, more) in [
        ("enable", json!({})),
        ("velocity", speed.clone()),
        ("jog", speed),
        ("confirm", json!({})),
        ("home", json!({})),
        ("move", far),
        ("task", json!({ "number": 1 })),
        ("acknowledge", json!({})),
        ("disable", json!({})),
        ("keep", json!({ "request": 9 })),
        ("hand_over", json!({ "request": 9 })),
    ] {
        hands.order(kind, &id, lease, 0, &more);
        // done or refused: both are to be found
        server.logged(|log| {
            let mut records = log.iter();
            records.any(|one| one["action"] == kind && !one["result"].is_null())
        });
    }
    let mut other = Hands::of(&server, &server.control);
    let number = other.send("take", &id, &json!({ "purpose": "speed", "wait": true }));
    server.logged(|log| log.iter().any(|one| one["action"] == "request_control"));
    hands.send("release", &id, &json!({}));
    other.answer(number);
    other.page.send(&json!({ "type": "stop" }));
    server.logged(|log| log.iter().any(|one| one["action"] == "stop"));
    let number = other.send("reset", &id, &json!({ "epoch": 1 }));
    other.answer(number);
    for action in ["take", "release", "reset"] {
        server.logged(|log| {
            let mut records = log.iter();
            records.any(|one| one["action"] == action && one["result"] == "done")
        });
    }
}

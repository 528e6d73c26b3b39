//! A server on a network interface, with drives of their own thread at the other end of a cable: what only a machine requires.

use std::thread::{JoinHandle, spawn};

use profidrive::Stop;
use profidrive::plant::PlantPlan;
use profidrive::plant::host::{Drives, Host, HostConfig, events};
use profidrive_workbench::{Settings, Source};
use serde_json::{Value, json};

use crate::hands::{Hands, lease, sentence};
use crate::namespace;
use crate::server::{Running, eventually};

const PLANT: &str = "[[drive]]\nname = \"axis-1\"\nip = \"192.168.98.11/24\"";

/// Virtual drives at `vb`, until they are dropped.
struct Served {
    stop: Stop,
    thread: Option<JoinHandle<()>>,
}

impl Served {
    fn start() -> Self {
        let plan: PlantPlan = PLANT.parse().unwrap();
        let stop = Stop::new().unwrap();
        let config = HostConfig {
            interface: "vb".to_owned(),
            drives: Drives::Plans(plan.drives),
            seed: plan.seed,
            state: None,
            description: None,
            refuses_in_operation: false,
            capture: None,
            expectations: Vec::new(),
            trace: None,
            time: None,
            load_every: None,
            stop: stop.clone(),
        };
        let (sender, received) = events();
        spawn(move || received.for_each(|_| ()));
        // what is not `Send` stays in its thread
        let thread = spawn(move || {
            Host::open(config, sender).unwrap().run().unwrap();
        });
        Self {
            stop,
            thread: Some(thread),
        }
    }
}

impl Drop for Served {
    fn drop(&mut self) {
        self.stop.stop();
        let ended = self.thread.take().map(JoinHandle::join);
        assert!(matches!(ended, Some(Ok(()))), "the drives ended by a panic");
    }
}

#[test]
fn an_axis_of_a_machine_is_given_after_the_checks_of_a_person_only() {
    if !namespace::inside("machine::an_axis_of_a_machine_is_given_after_the_checks_of_a_person_only") {
        return;
    }
    namespace::veth();
    namespace::run("ip addr add 192.168.98.1/24 dev va");
    let drives = Served::start();
    let server = Running::start(Settings::new(Source::Interface("va".to_owned())));
    let found = |stations: &Value| {
        let mut all = stations["stations"].as_array()?.iter();
        all.find(|station| station["name"] == "axis-1" && !station["status"].is_null())
            .and_then(|station| station["id"].as_str().map(str::to_owned))
    };
    let stations = eventually(&server, "/api/v1/stations", |stations| found(stations).is_some());
    let id = found(&stations).unwrap();
    let mut hands = Hands::of(&server, &server.control);
    let mut take = |more: Value| {
        let mut wanted = json!({ "purpose": "speed", "limit": 100 });
        for (key, value) in more.as_object().unwrap() {
            wanted[key] = value.clone();
        }
        let number = hands.send("take", &id, &wanted);
        hands.answer(number)
    };
    for without in [json!({}), json!({ "checks": false })] {
        let refused = take(without);
        assert!(
            sentence(&refused).contains("a person confirms first that the axis is in sight"),
            "{refused}"
        );
    }
    // nothing was taken by that, and each refusal is in the log
    let report = server
        .ask("GET", "/api/v1/server", &Running::bearer(&server.view), "")
        .json();
    assert_eq!(report["controlled"], json!([]));
    let is = |record: &Value, result: &str| {
        let found = record["result"].as_str().unwrap_or_default();
        record["action"] == "take" && record["drive"] == id && found.starts_with(result)
    };
    server.logged(|log| {
        let refused = |record: &&Value| is(record, "refused: on a machine a person confirms first");
        log.iter().filter(refused).count() == 2
    });
    let lease = lease(&take(json!({ "checks": true })));
    let enabled = hands.order("enable", &id, lease, 0, &json!({}));
    assert_eq!(enabled["type"], "accepted", "{enabled}");
    server.logged(|log| {
        let terms = |record: &Value| {
            let terms = record["value"].as_str().unwrap_or_default();
            terms.ends_with(", checks of the machine confirmed") && is(record, "done")
        };
        log.iter().any(terms)
    });
    // what is none of the two is no message of the protocol: the page is closed, and its axis with it
    hands.send("take", &id, &json!({ "purpose": "speed", "checks": "yes" }));
    assert_eq!(hands.closed(), Some(1008));
    eventually(&server, "/api/v1/server", |report| {
        report["controlled"] == json!([])
    });
    drop((server, drives));
}

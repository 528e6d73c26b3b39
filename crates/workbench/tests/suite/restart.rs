//! A plant that is started in the place of another one.

use serde_json::{Value, json};

use crate::change::known;
use crate::server::{Running, eventually};

fn get(server: &Running, path: &str) -> Value {
    server.ask("GET", path, &Running::bearer(&server.view), "").json()
}

pub fn plant_file(server: &Running) -> String {
    let path = "/api/v1/plant/scenario?without_events=true";
    server.ask("GET", path, &Running::bearer(&server.view), "").body
}

fn names(stations: &Value) -> Vec<&str> {
    let stations = stations["stations"].as_array().unwrap().iter();
    stations.filter_map(|station| station["name"].as_str()).collect()
}

#[test]
fn only_the_drives_of_the_new_plant_are_shown() {
    let server = Running::demo();
    let id = known(&server, "press-1");
    let telegram = format!("/api/v1/drives/{id}/telegram");
    let halves = |report: &Value| report["halves"].as_array().unwrap().len();
    eventually(&server, &telegram, |report| halves(report) == 2);
    let sto = json!({ "drive": id, "event": "sto=on", "seconds": null });
    assert_eq!(server.post("/api/v1/plant/inject", &sto).status, 200);
    // this drive stands now, another one turns, and a third one has another name
    let text = plant_file(&server)
        .replace("drive = \"press-1\"", "drive = \"axis-1\"")
        .replace("\"fan-1\"", "\"fan-9\"");
    let restart = json!({ "text": text, "restarts": 0 });
    let answer = server.post("/api/v1/plant/restart", &restart);
    assert_eq!((answer.status, &answer.json()["restarts"]), (200, &1.into()));
    let stations = get(&server, "/api/v1/stations");
    assert_eq!(stations["restarts"], 1);
    assert!(!names(&stations).contains(&"fan-1"), "{stations:#}");
    let plant = get(&server, "/api/v1/plant/drives");
    let drive = &plant["drives"][0];
    assert_eq!(
        (&plant["restarts"], &drive["id"]),
        (&1.into(), &id.clone().into())
    );
    assert!(drive["lasting"].as_array().unwrap().is_empty(), "{drive:#}");
    assert_eq!(halves(&get(&server, &telegram)), 0, "frames of the drive before");
    let now = eventually(&server, "/api/v1/stations", |all| {
        assert!(!names(all).contains(&"fan-1"), "{all:#}");
        names(all).contains(&"fan-9")
    });
    let mut all = now["stations"].as_array().unwrap().iter();
    assert!(all.all(|station| station["lost"].is_null()), "{now:#}");
    let machine = eventually(&server, &format!("/api/v1/drives/{id}/machine"), |report| {
        report["source"].is_string()
    });
    assert_eq!(machine["source"], "parameters", "nothing is connected to it now");
    let turns = format!("/api/v1/drives/{}/telegram", server.id("axis-1"));
    eventually(&server, &turns, |report| halves(report) == 2);
}

#[test]
fn a_plant_that_another_one_has_replaced_meanwhile_is_not_restarted() {
    let server = Running::demo();
    let text = plant_file(&server);
    let restart = |restarts: Option<u64>| {
        server.post(
            "/api/v1/plant/restart",
            &json!({ "text": text, "restarts": restarts }),
        )
    };
    assert_eq!(restart(Some(0)).status, 200);
    let late = restart(Some(0));
    assert_eq!((late.status, &late.json()["kind"]), (409, &"changed".into()));
    assert_eq!(get(&server, "/api/v1/plant/drives")["restarts"], 1);
    assert_eq!(restart(Some(1)).status, 200);
    assert_eq!(restart(None).json()["restarts"], 3, "whichever runs");
}

#[test]
fn connections_to_the_plant_before_make_no_trouble() {
    let server = Running::demo();
    let text = plant_file(&server);
    for name in ["axis-1", "pump-1", "fan-1"] {
        known(&server, name);
    }
    for restarts in 1..=3 {
        let answer = server.post(
            "/api/v1/plant/restart",
            &json!({ "text": text, "restarts": null }),
        );
        assert_eq!(answer.json()["restarts"], restarts);
        // each drive is read again
        for name in ["axis-1", "pump-1", "fan-1"] {
            known(&server, name);
        }
        let report = get(&server, "/api/v1/troubles");
        let all = report["troubles"].as_array().unwrap().iter();
        let unknown: Vec<_> = all
            .filter(|one| one["text"].to_string().contains("ARUUID"))
            .collect();
        assert!(unknown.is_empty(), "{unknown:#?}");
    }
}

#[test]
fn a_plan_of_the_plant_before_is_refused() {
    let server = Running::demo();
    let id = known(&server, "axis-1");
    let plan = |value: &str| {
        let wanted = json!({ "changes": [{ "parameter": "DRV.ACC", "value": value }], "save": false });
        server.post(&format!("/api/v1/drives/{id}/plans"), &wanted).json()
    };
    let (applied, waiting) = (plan("8000 rpm/s"), plan("9000 rpm/s"));
    assert_eq!(waiting["phase"], "planned", "{waiting}");
    let post = |job: &Value, what: &str| {
        let path = format!("/api/v1/plans/{}/{what}", job["id"]);
        server.post(&path, &json!({}))
    };
    assert_eq!(post(&applied, "apply").status, 200);
    let text = plant_file(&server);
    let restart = json!({ "text": text, "restarts": null });
    assert_eq!(server.post("/api/v1/plant/restart", &restart).status, 200);
    known(&server, "axis-1");
    for (job, what) in [(&waiting, "apply"), (&applied, "undo")] {
        let refused = post(job, what);
        assert_eq!((refused.status, &refused.json()["kind"]), (409, &"plan".into()));
        let detail = refused.json()["detail"].to_string();
        assert!(detail.contains("started again"), "{detail}");
    }
    let value = get(&server, &format!("/api/v1/drives/{id}/values/DRV.ACC"));
    assert_eq!(value["parameters"][0]["text"], "3000", "{value}");
    assert_eq!(post(&plan("9000 rpm/s"), "apply").status, 200);
}

//! Parameters, plans of changes, files with settings and their comparison.

use profidrive_workbench::{Settings, Source};
use serde_json::{Value, json};

use crate::change::known;
use crate::server::{Answer, Running, eventually};

fn get(server: &Running, path: &str) -> Answer {
    server.ask("GET", path, &Running::bearer(&server.view), "")
}

/// Waits for the end of a job that a request began.
pub fn settled(server: &Running, answer: &Answer) -> Value {
    assert_eq!(answer.status, 200, "{answer:?}");
    let path = format!("/api/v1/jobs/{}", answer.json()["id"]);
    eventually(server, &path, |job| job["phase"] != "working")
}

fn plan(server: &Running, id: &str, changes: &[(&str, &str)], save: bool) -> Value {
    let changes: Vec<Value> = changes
        .iter()
        .map(|(parameter, value)| json!({ "parameter": parameter, "value": value }))
        .collect();
    let body = json!({ "changes": changes, "save": save });
    settled(server, &server.post(&format!("/api/v1/drives/{id}/plans"), &body))
}

fn apply(server: &Running, plan: &Value) -> Value {
    let answer = server.post(&format!("/api/v1/plans/{}/apply", plan["id"]), &json!({}));
    settled(server, &answer)
}

fn value(server: &Running, id: &str, parameter: &str) -> Value {
    let answer = get(server, &format!("/api/v1/drives/{id}/values/{parameter}"));
    answer.json()["parameters"][0]["value"].clone()
}

fn back_up(server: &Running, id: &str) -> String {
    let answer = server.post(&format!("/api/v1/drives/{id}/backups"), &json!({}));
    let job = settled(server, &answer);
    assert_eq!(job["phase"], "done", "{job:#}");
    job["file"].as_str().unwrap().to_owned()
}

fn compare(server: &Running, left: &Value, right: &Value) -> Value {
    settled(
        server,
        &server.post("/api/v1/compare", &json!({ "left": left, "right": right })),
    )
}

#[test]
fn parameters_are_listed_described_and_read() {
    let server = Running::demo();
    let id = known(&server, "axis-1");
    let list = get(&server, &format!("/api/v1/drives/{id}/parameters")).json();
    let mut rows = list["parameters"].as_array().unwrap().iter();
    let row = rows.find(|row| row["name"] == "DRV.ACC").unwrap();
    assert_eq!((&row["unit"], &row["number"]), (&"rpm/s".into(), &"p2108".into()));
    let one = get(&server, &format!("/api/v1/drives/{id}/parameters/DRV.ACC")).json();
    assert_eq!(one["values"][0]["value"], 3000.0, "{one:#}");
    let answer = get(
        &server,
        &format!("/api/v1/drives/{id}/values/DRV.ACC,p0964,40000"),
    )
    .json();
    let values = answer["parameters"].as_array().unwrap();
    assert_eq!(values[0]["name"], "DRV.ACC");
    // what the drive does not have has its reason, and the others their values
    assert!(values.last().unwrap()["error"].is_object(), "{values:#?}");
    for path in ["values/DRV.NOTHING", "values/a=b", "parameters/%20"] {
        let answer = get(&server, &format!("/api/v1/drives/{id}/{path}"));
        assert_eq!(answer.status, 400, "{path}: {answer:?}");
    }
    let many = vec!["922"; 201].join(",");
    assert_eq!(
        get(&server, &format!("/api/v1/drives/{id}/values/{many}")).status,
        400
    );
    assert_eq!(
        get(&server, "/api/v1/drives/02:00:00:00:00:01/parameters").status,
        404
    );
}

#[test]
fn a_plan_is_shown_written_verified_undone_and_in_the_log() {
    let server = Running::demo();
    let id = known(&server, "axis-1");
    let planned = plan(
        &server,
        &id,
        &[("DRV.ACC", "8000 rpm/s"), ("DRV.DEC", "3000 rpm/s")],
        false,
    );
    assert_eq!(
        (&planned["phase"], &planned["plan"]["ready"]),
        (&"planned".into(), &true.into())
    );
    let change = &planned["plan"]["changes"][0];
    assert_eq!(
        (&change["old"]["text"], &change["new"]["text"], &change["step"]),
        (&"3000".into(), &"8000".into(), &"not written".into())
    );
    assert_eq!(planned["plan"]["changes"][1]["step"], "same");
    assert_eq!(
        value(&server, &id, "DRV.ACC"),
        3000.0,
        "nothing is written by a plan"
    );
    let undo = format!("/api/v1/plans/{}/undo", planned["id"]);
    assert_eq!(
        server.post(&undo, &json!({})).status,
        409,
        "there is nothing to undo"
    );
    let applied = apply(&server, &planned);
    assert_eq!(
        (&applied["phase"], &applied["plan"]["changes"][0]["step"]),
        (&"applied".into(), &"read back".into())
    );
    let remarks = applied["remarks"].to_string();
    assert!(remarks.contains("lost at the next power cycle"), "{remarks}");
    assert_eq!(value(&server, &id, "DRV.ACC"), 8000.0);
    let again = server.post(&format!("/api/v1/plans/{}/apply", planned["id"]), &json!({}));
    assert_eq!(again.status, 409, "{again:?}");
    let undone = settled(&server, &server.post(&undo, &json!({})));
    assert_eq!(undone["phase"], "undone", "{undone:#}");
    assert_eq!(value(&server, &id, "DRV.ACC"), 3000.0);
    assert_eq!(server.post(&undo, &json!({})).status, 409, "once");
    let log = server.logged(|log| log.len() >= 4);
    let lines: Vec<(&str, bool, &str)> = log
        .iter()
        .map(|record| {
            let change = record["changes"][0].as_str().unwrap();
            (
                record["action"].as_str().unwrap(),
                record["result"].is_null(),
                change,
            )
        })
        .collect();
    assert_eq!(
        lines[..3],
        [
            ("write", true, "DRV.ACC (p2108): 3000 rpm/s -> 8000 rpm/s"),
            (
                "write",
                false,
                "DRV.ACC (p2108): 3000 rpm/s -> 8000 rpm/s, written, read back"
            ),
            (
                "undo",
                true,
                "DRV.ACC (p2108): 3000 rpm/s -> 8000 rpm/s, written, read back"
            ),
        ]
    );
    assert_eq!(
        lines[3].2,
        "DRV.ACC (p2108): 8000 rpm/s -> 3000 rpm/s, written, read back"
    );
}

#[test]
fn what_was_written_is_to_be_saved_until_the_drive_has_saved_it() {
    let server = Running::demo();
    let (id, other) = (known(&server, "axis-1"), known(&server, "axis-2"));
    let unsaved =
        |id: &str| get(&server, &format!("/api/v1/drives/{id}/unsaved")).json()["parameters"].clone();
    let changes = [("DRV.ACC", "8000 rpm/s"), ("DRV.DEC", "3000 rpm/s")];
    let planned = plan(&server, &id, &changes, false);
    assert_eq!(unsaved(&id), json!([]), "nothing is written by a plan");
    apply(&server, &planned);
    // the other value was as it is
    assert_eq!((unsaved(&id), unsaved(&other)), (json!(["p2108"]), json!([])));
    let paused = |paused: bool| {
        server
            .post("/api/v1/plant/clock", &json!({ "paused": paused }))
            .status
    };
    assert_eq!(paused(true), 200);
    assert_eq!(unsaved(&id), json!(["p2108"]), "that is no question to the drive");
    assert_eq!(paused(false), 200);
    let saving = plan(&server, &id, &[("DRV.ACC", "8000 rpm/s")], true);
    assert_eq!(apply(&server, &saving)["phase"], "applied");
    assert_eq!(unsaved(&id), json!([]));
}

#[test]
fn one_value_that_cannot_be_written_keeps_all_from_being_written() {
    let server = Running::demo();
    let id = known(&server, "axis-1");
    let wrong = plan(
        &server,
        &id,
        &[
            ("DRV.ACC", "8000 rpm/s"),
            ("VL.FB", "3"),
            ("DRV.NOTHING", "1"),
            ("DRV.DEC", "fast"),
        ],
        false,
    );
    let named: Vec<&str> = wrong["plan"]["refusals"]
        .as_array()
        .unwrap()
        .iter()
        .map(|refusal| refusal["parameter"].as_str().unwrap())
        .collect();
    assert_eq!(wrong["plan"]["ready"], false);
    for name in ["VL.FB", "DRV.NOTHING", "DRV.DEC"] {
        assert!(named.contains(&name), "{named:?}");
    }
    assert_eq!(named.len(), 3, "{wrong:#}");
    let answer = server.post(&format!("/api/v1/plans/{}/apply", wrong["id"]), &json!({}));
    assert_eq!(answer.status, 409, "{answer:?}");
    assert_eq!(value(&server, &id, "DRV.ACC"), 3000.0);
    let twice = plan(&server, &id, &[("DRV.ACC", "1000"), ("p2108", "2000")], false);
    assert_eq!(
        twice["plan"]["refusals"].as_array().unwrap().len(),
        1,
        "{twice:#}"
    );
    for body in [
        json!({ "save": false }),
        json!({ "save": false, "changes": [], "file": "../x" }),
        json!({ "changes": 3 }),
    ] {
        let answer = server.post(&format!("/api/v1/drives/{id}/plans"), &body);
        assert!(matches!(answer.status, 400 | 404 | 422), "{answer:?}");
    }
}

#[test]
fn a_value_that_changed_since_the_plan_is_not_overwritten() {
    let server = Running::demo();
    let id = known(&server, "axis-1");
    let first = plan(&server, &id, &[("DRV.ACC", "8000 rpm/s")], false);
    let second = plan(&server, &id, &[("DRV.ACC", "5000 rpm/s")], false);
    assert_eq!(apply(&server, &second)["phase"], "applied");
    let refused = server.post(&format!("/api/v1/plans/{}/apply", first["id"]), &json!({}));
    assert_eq!(refused.status, 409, "{refused:?}");
    let details = refused.json()["details"].to_string();
    assert!(details.contains("was 3000 rpm/s, is 5000 rpm/s"), "{details}");
    assert_eq!(value(&server, &id, "DRV.ACC"), 5000.0);
}

#[test]
fn without_a_log_no_value_is_written() {
    let server = Running::start(Settings {
        log: None,
        ..Settings::new(Source::Demo)
    });
    let id = known(&server, "axis-1");
    let planned = plan(&server, &id, &[("DRV.ACC", "8000 rpm/s")], false);
    let answer = server.post(&format!("/api/v1/plans/{}/apply", planned["id"]), &json!({}));
    assert_eq!((answer.status, &answer.json()["kind"]), (503, &"log".into()));
    assert_eq!(value(&server, &id, "DRV.ACC"), 3000.0);
}

#[test]
fn settings_are_backed_up_compared_and_restored_with_a_way_back() {
    let server = Running::demo();
    let id = known(&server, "pump-1");
    let file = back_up(&server, &id);
    assert!(
        file.starts_with("pump-1-") && file.ends_with("Z.backup"),
        "{file}"
    );
    let text = get(&server, &format!("/api/v1/backups/{file}"));
    assert!(text.body.starts_with("profidrive backup "), "{text:?}");
    assert!(
        text.header("content-disposition").unwrap().contains("attachment"),
        "{text:?}"
    );
    let (drive, of_file) = (json!({ "drive": id }), json!({ "file": file }));
    let same = compare(&server, &drive, &of_file);
    assert_eq!(same["differences"]["differences"], json!([]), "{same:#}");
    let planned = plan(&server, &id, &[("3-41", "7 s")], false);
    assert_eq!(apply(&server, &planned)["phase"], "applied");
    let other = compare(&server, &drive, &of_file);
    let rows = other["differences"]["differences"].as_array().unwrap();
    assert_eq!(rows.len(), 1, "{other:#}");
    assert_eq!(rows[0]["left"]["text"], "7");
    let body = json!({ "file": file, "settings": ["3-41"], "save": false });
    let restoring = settled(
        &server,
        &server.post(&format!("/api/v1/drives/{id}/plans"), &body),
    );
    assert_eq!(
        restoring["plan"]["changes"].as_array().unwrap().len(),
        1,
        "{restoring:#}"
    );
    let restored = apply(&server, &restoring);
    assert_eq!(
        (&restored["phase"], &restored["problem"]),
        (&"applied".into(), &Value::Null),
        "{restored:#}"
    );
    let before = restored["plan"]["before"].as_str().unwrap();
    assert!(
        get(&server, &format!("/api/v1/backups/{before}"))
            .body
            .contains("= 7 s")
    );
    let same = compare(&server, &of_file, &drive);
    assert_eq!(same["differences"]["differences"], json!([]), "{same:#}");
    let kept = get(&server, "/api/v1/backups").json();
    let names: Vec<&Value> = kept["files"]
        .as_array()
        .unwrap()
        .iter()
        .map(|one| &one["before"])
        .collect();
    assert_eq!(names.len(), 2, "{kept:#}");
    server.logged(|log| log.iter().any(|record| record["action"] == "restore"));
    // a file of one kind is not for another
    let axis = known(&server, "axis-1");
    let wrong = server.post(
        &format!("/api/v1/drives/{axis}/plans"),
        &json!({ "file": file, "save": false }),
    );
    assert_eq!(wrong.status, 409, "{wrong:?}");
    let detail = wrong.json()["detail"].as_str().unwrap().to_owned();
    assert!(detail.contains("VLT") && detail.contains("AKD"), "{detail}");
    let wrong = server.post(
        "/api/v1/compare",
        &json!({ "left": { "drive": axis }, "right": { "file": file } }),
    );
    assert_eq!(wrong.status, 400, "{wrong:?}");
}

#[test]
fn a_file_that_is_uploaded_has_a_name_of_this_server_and_no_name_leads_elsewhere() {
    let server = Running::demo();
    let id = known(&server, "axis-1");
    let text = get(&server, &format!("/api/v1/backups/{}", back_up(&server, &id))).body;
    let kept = server.post("/api/v1/backups", &json!({ "text": text })).json();
    let file = kept["file"].as_str().unwrap();
    assert!(file.starts_with("uploaded-axis-1-"), "{file}");
    assert_eq!(get(&server, &format!("/api/v1/backups/{file}")).body, text);
    // whatever a file says of its drive, it is stored under a plain name
    let hostile = text.replacen("station: axis-1", "station: ../../x", 1);
    let kept = server.post("/api/v1/backups", &json!({ "text": hostile })).json();
    let name = kept["file"].as_str().unwrap();
    assert!(!name.contains('/') && !name.contains(".."), "{name}");
    let before = tree(&server.folder);
    for text in ["", "profidrive", "profidrive backup 1\nmodel: AKD\n\0\n"] {
        let answer = server.post("/api/v1/backups", &json!({ "text": text }));
        assert_eq!(answer.status, 400, "{answer:?}");
    }
    for name in [
        "..%2F..%2Fetc%2Fpasswd",
        "%2Fetc%2Fpasswd",
        "..",
        "%00",
        ".backup",
        "..%5C..%5Cx.backup",
        "nothing.backup",
    ] {
        let answer = get(&server, &format!("/api/v1/backups/{name}"));
        assert_eq!(answer.status, 404, "{name}: {answer:?}");
        let decoded = name.replace("%2F", "/").replace("%5C", "\\");
        let body = json!({ "file": decoded, "save": false });
        let answer = server.post(&format!("/api/v1/drives/{id}/plans"), &body);
        assert_eq!(answer.status, 404, "{name}: {answer:?}");
    }
    assert_eq!(tree(&server.folder), before, "the state folder is as it was");
}

/// Returns the files below a folder, without what is in them.
fn tree(folder: &std::path::Path) -> Vec<std::path::PathBuf> {
    let mut all = Vec::new();
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        match path.is_dir() {
            true => all.extend(tree(&path)),
            false => all.push(path),
        }
    }
    all.sort();
    all
}

#[test]
fn what_differs_from_values_as_delivered_is_read_and_compared() {
    let server = Running::demo();
    let id = known(&server, "press-1");
    let changed = get(&server, &format!("/api/v1/drives/{id}/changed"));
    assert_eq!(changed.status, 200, "{changed:?}");
    let changed = changed.json();
    let names = |report: &Value| -> Vec<String> {
        let all = report["differences"].as_array().unwrap().iter();
        all.map(|one| one["name"].as_str().unwrap().to_owned()).collect()
    };
    assert_eq!(names(&changed), ["DRV.ACC", "DRV.DEC"]);
    assert_eq!(
        (
            &changed["differences"][0]["left"]["value"],
            &changed["differences"][0]["right"]["value"]
        ),
        (&3000.0.into(), &100.0.into())
    );
    let (drive, delivered) = (json!({ "drive": id }), json!({ "delivered": id }));
    let job = compare(&server, &drive, &delivered);
    assert_eq!(names(&job["differences"]), names(&changed));
    assert_eq!(job["differences"]["right"], "press-1 as delivered");
    assert_eq!(
        get(&server, "/api/v1/drives/02:00:00:00:00:01/changed").status,
        404
    );
}

#[test]
fn network_settings_are_left_out_of_a_restore_unless_they_are_chosen() {
    let server = Running::demo();
    let id = known(&server, "axis-1");
    let file = back_up(&server, &id);
    let text = get(&server, &format!("/api/v1/backups/{file}")).body;
    let telegram = text.lines().find(|line| line.starts_with("p0922")).unwrap();
    let other = text
        .replace(telegram, &telegram.replacen("= 1", "= 9", 1))
        .replace("station: axis-1", "station: axis-7");
    assert_ne!(other, text);
    let kept = server.post("/api/v1/backups", &json!({ "text": other })).json();
    let file = kept["file"].as_str().unwrap().to_owned();
    let job = compare(&server, &json!({ "drive": id }), &json!({ "file": file }));
    let differences = &job["differences"];
    assert_eq!(
        differences["network"],
        json!([{ "setting": "name of station", "left": "axis-1", "right": "axis-7" }])
    );
    let all = differences["differences"].as_array().unwrap();
    let of_connection: Vec<_> = all.iter().map(|one| (&one["pnu"], &one["connection"])).collect();
    assert_eq!(of_connection, [(&json!(922), &json!(true))]);
    let changes = |network: bool| {
        let wanted = json!({ "file": file, "network": network, "save": false });
        let answer = server.post(&format!("/api/v1/drives/{id}/plans"), &wanted);
        let planned = settled(&server, &answer);
        let changes = planned["plan"]["changes"].as_array().unwrap().iter();
        changes
            .map(|change| change["new"]["text"].clone())
            .collect::<Vec<_>>()
    };
    assert!(changes(false).is_empty());
    assert_eq!(changes(true), ["9"]);
}

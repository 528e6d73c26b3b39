//! What paths of the interface have in common, for its description: each request can be refused by the guard, and each drive can be unknown
//! or silent.

use serde_json::{Map, Value, json};

use super::plant::waits_for_drives;

/// The parameter in the path of one drive.
const DRIVE: &str = "MAC address, or `ip-` with the IP address";

/// Adds to each path the answers that it has in common with others, where it has no words of its own for them.
pub(super) fn complete(description: &mut Value) {
    let paths = description["paths"].as_object_mut();
    for (path, methods) in paths.into_iter().flatten() {
        for (method, operation) in methods.as_object_mut().into_iter().flatten() {
            let of_drive = ["/api/v1/drives/{id}/", "/api/v1/stations/{id}/"]
                .iter()
                .any(|of| path.starts_with(of));
            if of_drive {
                name_drive(operation);
            }
            let Some(answers) = operation["responses"].as_object_mut() else {
                continue;
            };
            answer(answers, "401", "No session");
            if method != "get" {
                answer(answers, "403", "Another origin, or a session that is view-only");
            }
            if of_drive {
                answer(answers, "404", "No such drive has answered");
                answer(answers, "504", "The drive does not answer");
            }
            if waits_for_drives(path) {
                answer(answers, "409", "The time of the plant stands still");
            }
            let problems = answers.iter_mut().filter(|(status, _)| status.as_str() >= "400");
            for (_, answer) in problems {
                let schema = json!({ "$ref": "#/components/schemas/Problem" });
                answer["content"] = json!({ "application/problem+json": { "schema": schema } });
            }
        }
    }
}

fn answer(answers: &mut Map<String, Value>, status: &str, text: &str) {
    let entry = answers.entry(status);
    entry.or_insert_with(|| json!({ "description": text }));
}

/// Puts the drive before the other parameters of an operation.
fn name_drive(operation: &mut Value) {
    let drive = json!({
        "name": "id", "in": "path", "required": true, "description": DRIVE, "schema": { "type": "string" },
    });
    let mut parameters = vec![drive];
    if let Some(others) = operation["parameters"].as_array() {
        parameters.extend(others.iter().filter(|one| one["name"] != "id").cloned());
    }
    operation["parameters"] = Value::Array(parameters);
}

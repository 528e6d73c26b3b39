//! Actions of the library as commands of this program.

use drive_client::Action;
use drive_client::status::Diagnosis;
use serde_json::Value;

use crate::fields;

/// The command line of an action.
pub fn command(action: &Action, drive: &str) -> Option<String> {
    Some(match action {
        Action::Stop => format!("profidrive stop {drive}"),
        Action::Disable => format!("profidrive stop {drive} --disable"),
        Action::Status => format!("profidrive status {drive}"),
        Action::Write { parameter, value, .. } => {
            format!("profidrive write {drive} {}={value}", parameter.replace(' ', ""))
        }
        _ => return None,
    })
}

/// An action as a part of a sentence.
pub fn sentence(action: &Action, drive: &str) -> Option<String> {
    let command = command(action, drive)?;
    let does = match action {
        Action::Stop => "brings it to rest".to_owned(),
        Action::Disable => "brings it to rest and switches its power stage off".to_owned(),
        Action::Write {
            meaning: Some(meaning),
            ..
        } => format!("makes it stop when its controller is lost ({meaning})"),
        Action::Write { .. } => "makes it stop when its controller is lost".to_owned(),
        _ => "shows how it is".to_owned(),
    };
    Some(format!("`{command}` {does}"))
}

/// What a diagnosis recommends, in one line.
pub fn next(diagnosis: &Diagnosis, drive: &str) -> Option<String> {
    let actions = diagnosis
        .actions
        .iter()
        .filter_map(|action| sentence(action, drive));
    let all: Vec<String> = actions.chain(diagnosis.next.clone()).collect();
    (!all.is_empty()).then(|| all.join("; "))
}

/// The same for programs.
pub fn json(diagnosis: &Diagnosis, drive: &str) -> Value {
    let actions = diagnosis
        .actions
        .iter()
        .map(|action| Value::Object(fields! { "action": action.id(), "command": command(action, drive) }));
    Value::Array(actions.collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn actions_are_commands_of_this_program() {
        let write = Action::Write {
            parameter: "ID 733".into(),
            value: 2,
            meaning: Some("Fault"),
        };
        assert_eq!(
            sentence(&write, "vacon-1").as_deref(),
            Some("`profidrive write vacon-1 ID733=2` makes it stop when its controller is lost (Fault)")
        );
        assert_eq!(
            command(&Action::Disable, "DRIVE").as_deref(),
            Some("profidrive stop DRIVE --disable")
        );
    }
}

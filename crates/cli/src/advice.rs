//! Actions of the library as commands of this program.

use client::{Action, Advice, Choice};
use profidrive::report::Wording;

use crate::args::model_option;

/// The words of this program for advice about a drive.
#[derive(Debug, Clone, Copy)]
pub struct Commands<'a>(pub &'a str);

impl Commands<'_> {
    /// Returns the words about any drive: `DRIVE` stands for its name.
    pub const fn any() -> Self {
        Self("DRIVE")
    }
}

impl Wording for Commands<'_> {
    fn command(&self, action: &Action) -> Option<String> {
        command(action, self.0)
    }

    fn advice(&self, advice: &Advice) -> String {
        text(advice, self.0)
    }
}

/// The command line of an action; `None` for a choice, which is an option of the command that was given.
pub fn command(action: &Action, drive: &str) -> Option<String> {
    let of = |device: &Option<String>| device.clone().unwrap_or_else(|| drive.to_owned());
    let plain = |word: &str| word.replace(' ', "");
    let rest = match action {
        Action::Scan => "scan".to_owned(),
        Action::Doctor => format!("doctor {drive}"),
        Action::Blink { device } => format!("blink {}", of(device)),
        Action::SetName { device } => format!("name {} NAME", of(device)),
        Action::SetAddress { device } => format!("ip {} A.B.C.D/NN", of(device)),
        Action::Info => format!("info {drive}"),
        Action::Status => format!("status {drive}"),
        Action::Faults => format!("faults {drive}"),
        Action::Acknowledge => format!("ack {drive}"),
        Action::Monitor => format!("monitor {drive}"),
        Action::Read { parameters } => {
            let parameters: Vec<String> = parameters.iter().map(|one| plain(one)).collect();
            format!(
                "read {drive} {}",
                if parameters.is_empty() {
                    "PARAM".to_owned()
                } else {
                    parameters.join(" ")
                }
            )
        }
        Action::Write { parameter, value } => format!("write {drive} {}={value}", plain(parameter)),
        Action::Describe { parameter } => format!("describe {drive} {}", plain(parameter)),
        Action::Find { part, values } => {
            let part = if part.is_empty() { "TEXT" } else { part };
            format!(
                "list {drive} --filter {part}{}",
                if *values { " --values" } else { "" }
            )
        }
        Action::Stop => format!("stop {drive}"),
        Action::Disable => format!("stop {drive} --disable"),
        Action::Run => format!("run {drive} --velocity SPEED"),
        Action::Jog => format!("jog {drive}"),
        Action::Move => format!("move {drive} --to POSITION --velocity SPEED"),
        Action::Home => format!("home {drive}"),
        Action::Backup => format!("backup {drive} -o FILE"),
        _ => return None,
    };
    Some(format!("profidrive {rest}"))
}

/// The option of a choice.
fn option(choice: Choice) -> String {
    let fixed = match choice {
        Choice::Description => "--gsdml FILE",
        Choice::Model => return model_option(),
        Choice::Cycle => "--cycle",
        Choice::Time => "--timeout",
        Choice::SpeedLimit => "--limit",
        Choice::Mode => "--set-mode",
        Choice::Relative => "--relative",
        Choice::Percent => "--velocity 20%",
        Choice::ReferenceSpeed => "--reference-speed 1500rpm",
        Choice::RunOn => "--may-run-on",
        Choice::Interface => "-i IFACE, or PROFIDRIVE_INTERFACE",
        Choice::Force => "--force",
        Choice::WayBack => "--way-back PATH",
        Choice::Save => "--save",
        Choice::Settings => "--only",
        Choice::Machine => "--machine FILE, PROFIDRIVE_MACHINE, or machine.toml in the current folder",
        _ => "another option",
    };
    fixed.to_owned()
}

/// Advice with its actions as commands and options of this program.
pub fn text(advice: &Advice, drive: &str) -> String {
    advice.worded(|action| match (action, command(action, drive)) {
        (Action::Choose(choice), _) => option(*choice),
        (_, Some(command)) => format!("`{command}`"),
        (other, None) => other.to_string(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn actions_are_commands_of_this_program() {
        let write = Action::Write {
            parameter: "ID 733".into(),
            value: "2".into(),
        };
        assert_eq!(
            text(&write.sentence(), "vacon-1"),
            "`profidrive write vacon-1 ID733=2` changes it"
        );
        assert_eq!(
            command(&Action::Disable, "DRIVE").as_deref(),
            Some("profidrive stop DRIVE --disable")
        );
    }
}

//! Actions of the library as calls of the Python package.

use client::{Action, Advice, Choice};
use profidrive::report::Wording;

/// The words of Python for advice: `drive`, `axis` and `network` stand for the objects of a program.
#[derive(Debug, Clone, Copy)]
pub struct Calls;

impl Wording for Calls {
    fn command(&self, action: &Action) -> Option<String> {
        Some(match action {
            Action::Scan => "network.scan()".to_owned(),
            Action::Blink { device } => of_station("blink", device.as_ref(), ""),
            Action::SetName { device } => of_station("set_name", device.as_ref(), ", .."),
            Action::SetAddress { device } => of_station("set_ip", device.as_ref(), ", .."),
            Action::Info => "drive.identity()".to_owned(),
            Action::Describe { parameter } => format!("drive.describe({parameter:?})"),
            Action::Find { part, values: false } => format!("drive.parameters({part:?})"),
            Action::Find { part, values: true } => format!("drive.parameters({part:?}, values=True)"),
            Action::Backup => "drive.backup()".to_owned(),
            Action::Status => "drive.status()".to_owned(),
            Action::Faults => "drive.faults()".to_owned(),
            Action::Acknowledge => "axis.ack()".to_owned(),
            Action::Read { parameters } => match &parameters[..] {
                [] => "drive.read(..)".to_owned(),
                [one] => format!("drive.read({one:?})"),
                several => format!("drive.read({several:?})"),
            },
            Action::Write { parameter, value } => format!("drive.write({{{parameter:?}: {value:?}}})"),
            Action::Stop => "drive.stop()".to_owned(),
            Action::Disable => "drive.stop(disable=True)".to_owned(),
            Action::Run => "axis.run(..)".to_owned(),
            Action::Jog => "axis.jog(..)".to_owned(),
            Action::Move => "axis.move_to(..)".to_owned(),
            Action::Home => "axis.home()".to_owned(),
            Action::Choose(choice) => argument(*choice)?.to_owned(),
            _ => return None,
        })
    }

    fn advice(&self, advice: &Advice) -> String {
        advice.worded(|action| self.command(action).unwrap_or_else(|| action.to_string()))
    }
}

fn of_station(call: &str, device: Option<&String>, more: &str) -> String {
    match device {
        Some(device) => format!("network.{call}({device:?}{more})"),
        None => format!("network.{call}(..)"),
    }
}

const fn argument(choice: Choice) -> Option<&'static str> {
    Some(match choice {
        Choice::Cycle => "cycle=..",
        Choice::Time => "timeout=..",
        Choice::SpeedLimit => "max_speed=..",
        Choice::Mode => "mode=.., set_mode=True",
        Choice::Relative => "axis.move_by(..)",
        Choice::RunOn => "accept_no_timeout=True",
        Choice::Interface => "open(\"eth0\")",
        Choice::Save => "save=True",
        Choice::Machine => "open(.., machine=\"machine.toml\")",
        Choice::WayBack => "way_back=..",
        _ => return None,
    })
}

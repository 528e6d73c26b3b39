//! Actions of the library in the words of this page.

use profidrive::client::{Action, Advice, Choice};
use profidrive::report::Wording;

/// The words of the page. What it carries out has buttons and boxes, so no action has a call.
#[derive(Debug, Clone, Copy)]
pub(crate) struct PageWords;

impl Wording for PageWords {
    fn command(&self, _: &Action) -> Option<String> {
        None
    }

    fn advice(&self, advice: &Advice) -> String {
        advice.worded(words)
    }
}

/// Returns what does an action on the page: a noun, as the sentences of advice have a verb behind it.
fn words(action: &Action) -> String {
    match action {
        Action::Write { parameter, value } => format!("the value {value} in {parameter}"),
        Action::Read { parameters } if !parameters.is_empty() => parameters.join(", "),
        Action::Describe { parameter } => format!("the description of {parameter}"),
        Action::Find { part, .. } if !part.is_empty() => format!("a search for {part}"),
        Action::Scan => "a scan".to_owned(),
        Action::Info => "its identity".to_owned(),
        Action::Status => "its status".to_owned(),
        Action::Faults => "its list of faults".to_owned(),
        Action::Acknowledge => "\"Acknowledge\"".to_owned(),
        Action::Monitor => "its values".to_owned(),
        Action::Stop => "a stop".to_owned(),
        Action::Disable => "a stop that switches it off".to_owned(),
        Action::Home => "\"Home\" on Control".to_owned(),
        Action::Run => "\"Velocity\" on Control".to_owned(),
        Action::Jog => "\"Jog\" on Control".to_owned(),
        Action::Move => "\"Move\" on Control".to_owned(),
        Action::SetName { .. } => "a name".to_owned(),
        Action::SetAddress { .. } => "an IP address".to_owned(),
        Action::Choose(choice) => match choice {
            Choice::Mode => "the box \"Set the operating mode\" in \"Options\"".to_owned(),
            Choice::RunOn => "the box \"The drive may run on\" in \"Options\"".to_owned(),
            Choice::Cycle => "an update time in the request".to_owned(),
            Choice::SpeedLimit => "a higher \"Highest speed\"".to_owned(),
            Choice::Relative => "\"By a distance from here\"".to_owned(),
            Choice::Save => "\"Save in the drive\"".to_owned(),
            Choice::Settings => "the boxes of the differences".to_owned(),
            Choice::Force => "the same at the command line, by force,".to_owned(),
            other => Action::Choose(*other).to_string(),
        },
        other => other.to_string(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn advice_is_a_sentence_without_names_of_programs() {
        for (advice, sentence) in [
            (
                "remove the cause, then {acknowledge}, or acknowledge from its controller (STW1 bit 7)",
                "remove the cause, then \"Acknowledge\", or acknowledge from its controller (STW1 bit 7)",
            ),
            (
                "switch the mains on; {read VBUS.VALUE VBUS.UVFTHRESH} shows the voltage",
                "switch the mains on; VBUS.VALUE, VBUS.UVFTHRESH shows the voltage",
            ),
            ("{write 930=1} changes it", "the value 1 in 930 changes it"),
            (
                "connect a controller, or use {jog} or {run}",
                "connect a controller, or use \"Jog\" on Control or \"Velocity\" on Control",
            ),
            (
                "{home} sets the home position",
                "\"Home\" on Control sets the home position",
            ),
            (
                "{choose run-on} accepts that it may run on",
                "the box \"The drive may run on\" in \"Options\" accepts that it may run on",
            ),
        ] {
            assert_eq!(PageWords.advice(&Advice::from(advice)), sentence);
        }
    }
}

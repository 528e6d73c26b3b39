//! Advice for parameters and values that cannot be used.

use profile::value::ParameterProblem;

use crate::{Action, Advice};

/// Returns the remedy, where the message does not contain it.
pub(super) fn advice(problem: &ParameterProblem) -> Option<Advice> {
    let describe = |parameter| {
        Advice::from(Action::Describe {
            parameter: written(parameter),
        })
    };
    match problem {
        ParameterProblem::Unknown { nearest, .. } if nearest.is_empty() => {
            Some("{find} finds parameters by a part of their name".into())
        }
        ParameterProblem::Unit { parameter, .. } | ParameterProblem::Limit { parameter, .. } => {
            Some(describe(parameter).and(" shows unit and limits"))
        }
        ParameterProblem::Coarse { parameter, .. } => {
            let shows = describe(parameter).and(" shows unit and scaling, which determine the steps");
            Some(Advice::from("write one of them").then(shows))
        }
        _ => problem.hint().map(Advice::from),
    }
}

/// Returns a label (`DRV.ACC (p2108)`, `Ramp 1 Ramp up Time (3-41)`) as one word that a command takes.
fn written(label: &str) -> String {
    match label.split_once(" (") {
        Some((name, number)) if !name.contains(' ') && !number.contains(" (") => name.to_owned(),
        Some(_) => {
            let number = label.rsplit_once(" (").map_or(label, |(_, number)| number);
            number.trim_end_matches(')').replace(' ', "")
        }
        None => label.replace(' ', ""),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn advice_names_the_parameter_as_a_command_takes_it() {
        for (label, word) in [
            ("DRV.ACC (p2108)", "DRV.ACC"),
            ("Ramp 1 Ramp up Time (3-41)", "3-41"),
            ("Motor Power [kW] (1-20)", "1-20"),
            ("Speed (max) limit (4-19)", "4-19"),
            ("Acceleration time 1 (ID 103)", "ID103"),
            ("p1234", "p1234"),
        ] {
            assert_eq!(written(label), word);
        }
    }
}

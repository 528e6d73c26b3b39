//! Why a simulation failed, in the words of the command line.

use client::ErrorKind;
use network::system::LockError;
use plant::PlantFileError;
use plant::host::{FleetError, HostError};
use profidrive::addressing::check_station_name;

use crate::failure::Failure;

impl From<PlantFileError> for Failure {
    fn from(error: PlantFileError) -> Self {
        let exit = match error {
            PlantFileError::PlantPlan { .. } => ErrorKind::Usage,
            _ => ErrorKind::Local,
        };
        Self::new(exit, error.to_string())
    }
}

impl From<HostError> for Failure {
    fn from(error: HostError) -> Self {
        let text = error.to_string();
        match error {
            HostError::Network(error) => error.into(),
            HostError::Serial(error) => error.into(),
            HostError::Fleet(error) => error.into(),
            HostError::LineAddress { .. } => Self::usage(text),
            HostError::MacInUse { .. } => Self::new(ErrorKind::Local, text)
                .hint("does the same simulation run already? Another --name or --mac makes another drive"),
            HostError::StateFolder(error) => {
                Self::new(ErrorKind::Local, format!("--state: {text}")).hint(match error {
                    LockError::Held { .. } => "end that simulation, or give each its own folder",
                    LockError::File(_) => "choose a folder that can be written to",
                })
            }
            _ => Self::new(ErrorKind::Local, text),
        }
    }
}

impl From<FleetError> for Failure {
    fn from(error: FleetError) -> Self {
        let text = error.to_string();
        match error {
            FleetError::NoRotarySwitches(_) | FleetError::SharedSwitches => {
                Self::usage(format!("--rotary: {text}"))
            }
            FleetError::Name { name, .. } => {
                check_station_name(&name).map_or_else(Self::from, |()| Self::usage(text))
            }
            FleetError::SameMac { .. } => Self::usage(text).hint("choose another --name"),
            FleetError::SharedMac => {
                Self::usage("--mac is for one drive; several get theirs from their names")
            }
            FleetError::NoStationMac(mac) => Self::usage(format!("--mac {mac}: {text}")),
            FleetError::NoStationAddress(..) => Self::usage(format!("--ip {text}")),
            FleetError::NoRoom { .. } => {
                Self::usage(text).hint("begin at a lower address, or take a larger subnet (a smaller NN)")
            }
            FleetError::Interval { nearest, .. } => {
                let nearest: Vec<String> = nearest.iter().map(|time| format!("{time} ms")).collect();
                Self::usage(format!("--min-cycle: {text}")).hint(format!(
                    "nearest: {}; possible are 1, 2, 4, 8 .. 512 ms",
                    nearest.join(" and ")
                ))
            }
            _ => Self::usage(text),
        }
    }
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use super::*;

    #[test]
    fn an_update_time_that_does_not_exist_is_a_mistake_with_its_option_and_the_nearest() {
        let failure = Failure::from(FleetError::Interval {
            time: Duration::from_millis(3),
            nearest: vec![2, 4],
        });
        assert_eq!(failure.kind, ErrorKind::Usage);
        assert_eq!(
            failure.message,
            "--min-cycle: an update time of 3 ms does not exist"
        );
        assert!(failure.hint.to_string().starts_with("nearest: 2 ms and 4 ms;"));
    }
}

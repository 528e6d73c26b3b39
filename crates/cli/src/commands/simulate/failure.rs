//! Why a simulation failed, with the option that is wrong.

use plant::host::{FleetError, HostError};
use profidrive::Explained;

use crate::failure::Failure;

impl From<HostError> for Failure {
    fn from(error: HostError) -> Self {
        match error {
            HostError::Fleet(error) => error.into(),
            HostError::StateFolder(_) => of_option("--state", &error),
            _ => Self::explained(&error),
        }
    }
}

impl From<FleetError> for Failure {
    fn from(error: FleetError) -> Self {
        match error {
            FleetError::NoRotarySwitches(_) | FleetError::SharedSwitches => of_option("--rotary", &error),
            FleetError::SharedMac | FleetError::NoStationMac(_) => of_option("--mac", &error),
            FleetError::NoStationAddress(..) | FleetError::NoRoom { .. } => of_option("--ip", &error),
            FleetError::Interval { .. } => of_option("--min-cycle", &error),
            _ => Self::explained(&error),
        }
    }
}

fn of_option(option: &str, error: &impl Explained) -> Failure {
    let failure = Failure::explained(error);
    Failure {
        message: format!("{option}: {}", failure.message),
        ..failure
    }
}

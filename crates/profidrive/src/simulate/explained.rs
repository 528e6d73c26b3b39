//! What every front end shows of an error of a plant or a simulation.

use client::{Action, Advice, Choice, ErrorKind};
use network::system::LockError;
use plant::control_socket::{ControlSocketError, InjectError};
use plant::host::{DescriptionError, FleetError, HostError};
use plant::{
    ChangeError, ModelsError, NotMet, PlantError, PlantEventError, PlantFileError, TraceError, WorldError,
};

use crate::addressing::check_station_name;
use crate::explained::Explained;

impl Explained for PlantFileError {
    fn kind(&self) -> ErrorKind {
        super::kind(self)
    }
}

impl Explained for WorldError {
    fn kind(&self) -> ErrorKind {
        match self {
            Self::Refused { .. } => ErrorKind::Refused,
            _ => ErrorKind::Usage,
        }
    }

    fn advice(&self) -> Advice {
        match self {
            Self::Parameter { problem, .. } => problem.hint().map_or_else(Advice::default, Advice::from),
            _ => Advice::default(),
        }
    }
}

/// What did not come true is a difference between a plant and what was expected of it.
impl Explained for NotMet {
    fn kind(&self) -> ErrorKind {
        ErrorKind::Difference
    }
}

/// Errors that only a caller can avoid, with the remedy in their message.
macro_rules! usage {
    ($($error:ty),*) => {
        $(impl Explained for $error {
            fn kind(&self) -> ErrorKind {
                ErrorKind::Usage
            }
        })*
    };
}

usage!(ChangeError, ModelsError, PlantError, PlantEventError, TraceError);

impl Explained for HostError {
    fn kind(&self) -> ErrorKind {
        match self {
            Self::LineAddress { .. } => ErrorKind::Usage,
            other => other.passed_on().map_or(ErrorKind::Local, Explained::kind),
        }
    }

    fn passed_on(&self) -> Option<&dyn Explained> {
        match self {
            Self::Network(error) => Some(error),
            Self::Serial(error) => Some(error),
            Self::Fleet(error) => Some(error),
            _ => None,
        }
    }

    fn advice(&self) -> Advice {
        match self {
            Self::MacInUse { .. } => {
                "perhaps the same simulation is running already; another name or MAC address makes another drive".into()
            }
            Self::StateFolder(LockError::Held { .. }) => {
                "end that simulation, or give each a folder of its own".into()
            }
            Self::StateFolder(LockError::File(_)) => "choose a folder that can be written to".into(),
            other => other.passed_on().map_or_else(Advice::default, Explained::advice),
        }
    }
}

impl Explained for FleetError {
    fn kind(&self) -> ErrorKind {
        ErrorKind::Usage
    }

    fn message(&self) -> String {
        match self {
            Self::NoStationMac(mac) => format!("{mac}: {self}"),
            other => other.to_string(),
        }
    }

    fn advice(&self) -> Advice {
        match self {
            Self::Name { name, .. } => {
                check_station_name(name).map_or_else(|error| error.advice(), |()| Advice::default())
            }
            Self::NoRoom { .. } => {
                "begin at a lower address, or take a larger subnet (a shorter prefix)".into()
            }
            Self::Interval { nearest, .. } => {
                let nearest: Vec<String> = nearest.iter().map(|time| format!("{time} ms")).collect();
                format!(
                    "nearest: {}; possible are 1, 2, 4, 8 .. 512 ms",
                    nearest.join(" and ")
                )
                .into()
            }
            _ => Advice::default(),
        }
    }
}

impl Explained for DescriptionError {
    fn kind(&self) -> ErrorKind {
        match self {
            Self::NoModel { .. } => ErrorKind::Usage,
            _ => ErrorKind::Local,
        }
    }

    fn advice(&self) -> Advice {
        match self {
            Self::NoModel { .. } => Advice::from(Action::Choose(Choice::Model))
                .and(" decides what the drive is inside; to others it is that of the file"),
            _ => Advice::default(),
        }
    }
}

impl Explained for InjectError {
    fn kind(&self) -> ErrorKind {
        match self {
            Self::NotFound { .. } | Self::NoAnswer { .. } => ErrorKind::Unreachable,
            Self::Refused { .. } => ErrorKind::Refused,
            Self::Socket(_) => ErrorKind::Local,
            _ => ErrorKind::Usage,
        }
    }

    fn advice(&self) -> Advice {
        match self {
            Self::Socket(ControlSocketError::Folder { .. }) => {
                "the folder of running simulations must belong to you alone; XDG_RUNTIME_DIR chooses another place".into()
            }
            Self::NotFound { others, .. } if !others.is_empty() => {
                format!("there are: {}", others.join(", ")).into()
            }
            Self::Ambiguous { here: true, .. } => {
                "name it by its IP or MAC address; one process too many ends with Ctrl-C".into()
            }
            Self::Ambiguous { here: false, .. } => "they are in other network namespaces: call from the one that has it (nsenter -n -t \
                PROCESS), or name it by its IP or MAC address"
                .into(),
            Self::NoAnswer { .. } => "it is busy or stopped (Ctrl-Z); try again".into(),
            _ => Advice::default(),
        }
    }
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use super::*;

    #[test]
    fn an_update_time_that_does_not_exist_is_a_mistake_with_the_nearest_ones() {
        let error = HostError::Fleet(FleetError::Interval {
            time: Duration::from_millis(3),
            nearest: vec![2, 4],
        });
        assert_eq!(error.kind(), ErrorKind::Usage);
        assert_eq!(error.message(), "an update time of 3 ms does not exist");
        assert!(error.advice().to_string().starts_with("nearest: 2 ms and 4 ms;"));
    }

    #[test]
    fn a_plant_file_that_cannot_be_read_is_a_matter_of_this_computer() {
        let error = crate::open_plant("/nonexistent/plant.toml").unwrap_err();
        assert_eq!(error.kind(), ErrorKind::Local);
    }
}

//! Sends requests to the simulations that run on this computer.

use std::fs;
use std::io::ErrorKind;
use std::path::PathBuf;
use std::time::Duration;

use profinet::controller::Station;

use super::{ControlSocketError, InjectRequest, Request, Response, namespace, segment, send, sockets};
use crate::event::{PlantEvent, PlantEventError};

/// Why something did not happen to a drive of a running simulation. Texts of the other process are foreign text.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum InjectError {
    /// Nothing of this kind can happen.
    #[error(transparent)]
    PlantEvent(#[from] PlantEventError),
    /// It has no end, so a duration has no meaning for it.
    #[error("`{0}` has no end, so a duration has no meaning for it")]
    NoEnd(PlantEvent),
    /// The folder of the control sockets cannot be used.
    #[error(transparent)]
    Socket(#[from] ControlSocketError),
    /// No simulation has the drive.
    #[error("no running simulation of this user has a drive {drive}")]
    NotFound {
        /// The drive.
        drive: String,
        /// The drives there are.
        others: Vec<String>,
    },
    /// Several simulations have a drive of this name.
    #[error("{} simulations have a drive {drive}: {}", .found.len(), .found.join("; "))]
    Ambiguous {
        /// The drive.
        drive: String,
        /// Each drive in words, with the process that runs it.
        found: Vec<String>,
        /// They are in the network namespace of this process.
        here: bool,
    },
    /// A simulation that may have the drive does not answer.
    #[error("{drive}: a running simulation does not answer: {why}")]
    NoAnswer {
        /// The drive.
        drive: String,
        /// What failed.
        why: String,
    },
    /// The simulation refuses the request.
    #[error("{drive}: {why}")]
    Refused {
        /// The drive.
        drive: String,
        /// Why.
        why: String,
    },
}

impl InjectRequest {
    /// Returns a request of this process: `events` happen to `drive`, in this order, and end after `lasts`.
    ///
    /// # Errors
    /// When one of `events` is not valid, or has no end where it is to have one.
    pub fn new(drive: &str, events: &[String], lasts: Option<Duration>) -> Result<Self, InjectError> {
        for text in events {
            let event: PlantEvent = text.parse()?;
            if lasts.is_some() && event.undo().is_none() {
                return Err(InjectError::NoEnd(event));
            }
        }
        Ok(Self {
            drive: drive.to_owned(),
            from: namespace(),
            events: events.to_vec(),
            lasts: lasts.map(|lasts| u64::try_from(lasts.as_nanos()).unwrap_or(u64::MAX)),
        })
    }
}

/// The running simulation that has a drive.
#[derive(Debug)]
pub struct Target {
    socket: PathBuf,
    /// The drive in words, with the process that runs it.
    pub drive: String,
    /// The drive is in the network namespace of this process, or at a serial line.
    pub here: bool,
}

impl Target {
    /// Makes `request` happen; returns the drive as its simulation calls it.
    ///
    /// # Errors
    /// When the simulation refuses, or does not answer.
    pub fn inject(&self, request: InjectRequest) -> Result<String, InjectError> {
        let drive = request.drive.clone();
        let why = match send(&self.socket, &Request::Inject(request)) {
            Ok(Some(Response::Done { drive, .. })) => return Ok(drive),
            Ok(Some(Response::Refused(why))) => why,
            Ok(Some(Response::NotHere(_) | Response::Drives(_)) | None) => {
                "the simulation does not know it any more".to_owned()
            }
            Err(error) => error.to_string(),
        };
        Err(InjectError::Refused { drive, why })
    }
}

/// Finds the one simulation that has the drive of `request`.
///
/// # Errors
/// When there is none or more than one, when one does not answer, or when the folder of sockets cannot be used.
pub fn target(request: &InjectRequest) -> Result<Target, InjectError> {
    let drive = &request.drive;
    let probe = Request::Inject(InjectRequest {
        events: Vec::new(),
        lasts: None,
        ..request.clone()
    });
    let (mut found, mut others, mut silent) = (Vec::new(), Vec::new(), None);
    for socket in sockets()? {
        match send(&socket, &probe) {
            Ok(Some(Response::Done { drive, here })) => found.push(Target { socket, drive, here }),
            Ok(Some(Response::NotHere(drives))) => others.extend(drives),
            Ok(Some(Response::Refused(why))) => {
                let drive = drive.clone();
                return Err(InjectError::Refused { drive, why });
            }
            Ok(Some(Response::Drives(_)) | None) => {
                silent = Some(format!("{}: no answer to the request", socket.display()));
            }
            // left behind by a process that was killed
            Err(error) if error.kind() == ErrorKind::ConnectionRefused => {
                let _ = fs::remove_file(&socket);
            }
            Err(error) => silent = Some(format!("{}: {error}", socket.display())),
        }
    }
    let drive = drive.clone();
    match (only(&drive, found)?, silent) {
        (Some(target), _) => Ok(target),
        // a simulation that runs may have the drive
        (None, Some(why)) => Err(InjectError::NoAnswer { drive, why }),
        (None, None) => Err(InjectError::NotFound { drive, others }),
    }
}

/// Returns the only one of `found`; those of the own network namespace come before all others.
fn only(drive: &str, mut found: Vec<Target>) -> Result<Option<Target>, InjectError> {
    let here = found.iter().any(|target| target.here);
    if here {
        found.retain(|target| target.here);
    }
    if found.len() < 2 {
        return Ok(found.pop());
    }
    Err(InjectError::Ambiguous {
        drive: drive.to_owned(),
        found: found.into_iter().map(|target| target.drive).collect(),
        here,
    })
}

/// Returns the drives that other processes simulate on an interface: their frames do not come back to it.
#[must_use]
pub fn neighbours(interface: &str) -> Vec<Station> {
    let request = Request::Drives(segment(interface));
    let responses = sockets()
        .unwrap_or_default()
        .into_iter()
        .map(|socket| send(&socket, &request));
    let drives = responses.filter_map(|response| match response {
        Ok(Some(Response::Drives(drives))) => Some(drives),
        _ => None,
    });
    drives.flatten().collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(drive: &str, here: bool) -> Target {
        Target {
            socket: PathBuf::from(drive),
            drive: drive.into(),
            here,
        }
    }

    #[test]
    fn a_simulation_of_the_own_network_comes_first() {
        let one = only("a", vec![found("far", false), found("near", true)]).unwrap();
        assert_eq!(one.map(|one| one.drive).as_deref(), Some("near"));
        let one = only("a", vec![found("far", false)]).unwrap();
        assert_eq!(one.map(|one| one.here), Some(false));
        assert!(only("a", Vec::new()).unwrap().is_none());
        for place in [true, false] {
            let both = vec![found("a, process 7", place), found("a, process 8", place)];
            let error = only("a", both).unwrap_err();
            assert_eq!(
                error.to_string(),
                "2 simulations have a drive a: a, process 7; a, process 8"
            );
            assert!(matches!(error, InjectError::Ambiguous { here, .. } if here == place));
        }
    }

    #[test]
    fn a_duration_needs_something_that_ends() {
        let request = |text: &str| InjectRequest::new("a", &[text.into()], Some(Duration::from_secs(2)));
        assert_eq!(request("cable=pulled").unwrap().lasts, Some(2_000_000_000));
        assert!(matches!(request("clear=439"), Err(InjectError::NoEnd(_))));
        assert!(matches!(request("hello"), Err(InjectError::PlantEvent(_))));
    }
}

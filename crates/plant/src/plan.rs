//! A plant as its file describes it: drives, what happens to them, and the controllers that run them.

use std::sync::Arc;
use std::time::Duration;

use network::host::Host;
use profile::parameter::{ErrorNumber, Keep, ParameterAccess};
use profile::telegram::Field;
use profile::value::{Assignment, ParameterProblem, Parameters};
use profinet::device::Stored;
use profinet::{IpSuite, MacAddress};
use virtual_drive::axis::Plant;
use virtual_drive::model::Model;
use virtual_drive::station::{Station, StationConfig};

use crate::event::{PlantEvent, PlantEventError, Unit};
use crate::expect::Expectation;
use crate::text::derived_mac;

/// A plant: drives, what happens to them, and the controllers that run them.
///
/// ```
/// let plant: profidrive_plant::PlantPlan = r#"
///     seed = 7
///     [[drive]]
///     name = "press-1"
///     ip = "10.0.0.1/24"
///     parameters = { "DRV.ACC" = "5000rpm/s" }
///     event = [
///         { at = "2s", do = "load=0.5Nm" },
///         { at = "5s", do = "cable=pulled", for = "300ms" },
///         { position = "10rev", do = "fault=439" },
///     ]
/// "#.parse()?;
/// assert_eq!(plant.drives[0].cues.len(), 3);
/// # Ok::<(), profidrive_plant::PlantError>(())
/// ```
#[derive(Debug, Clone)]
pub struct PlantPlan {
    /// Seed of all random events.
    pub seed: u64,
    /// How long it goes on; `None` until it is ended.
    pub duration: Option<Duration>,
    /// Period at which a trace prints all values; `None` for changes only.
    pub sample: Option<Duration>,
    /// The drives.
    pub drives: Vec<DrivePlan>,
    /// The controllers, which exist in virtual time only.
    pub controllers: Vec<ControllerPlan>,
    /// What is expected of the drives.
    pub expectations: Vec<Expectation>,
    /// What it was read from.
    pub(crate) text: Arc<str>,
}

/// One drive of a [`PlantPlan`].
#[derive(Debug, Clone)]
pub struct DrivePlan {
    /// Name of station, by which the plant and its events mean it.
    pub name: String,
    /// Whether it has no name of station at the start, as a drive as delivered.
    pub unnamed: bool,
    /// Its model.
    pub model: &'static Model,
    /// Its Ethernet address.
    pub mac: MacAddress,
    /// Its IP address; none for a drive that waits for it.
    pub ip: IpSuite,
    /// Shortest update time in steps of 31.25 us; `None` for that of the model.
    pub min_device_interval: Option<u16>,
    /// Motor, load and travel.
    pub plant: Plant,
    /// Torque of the load from the start, Nm.
    pub load: f64,
    /// What its parameters are set to before it starts, in order.
    pub parameters: Vec<Assignment>,
    /// What happens to it.
    pub cues: Vec<Cue>,
}

/// Something that happens to a drive, and when.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cue {
    /// When.
    pub trigger: Trigger,
    /// What.
    pub what: PlantEvent,
    /// Duration; `None` until the next change.
    pub lasts: Option<Duration>,
}

/// When something happens.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Trigger {
    /// This long after the start.
    Time(Duration),
    /// When the axis reaches this place, in 2^-32 revolutions from where it started, for the first time.
    Place(i64),
}

/// A controller that runs one drive, in virtual time.
#[derive(Debug, Clone)]
pub struct ControllerPlan {
    /// Which of the drives.
    pub drive: usize,
    /// Telegram it plugs into slot 1.
    pub telegram: u16,
    /// Update time.
    pub cycle: Duration,
    /// Updates that may fail to come before the connection is taken for lost.
    pub watchdog: u16,
    /// What it does, in the order of time.
    pub steps: Vec<Step>,
}

/// One step of a program.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Step {
    /// This long after the start.
    pub at: Duration,
    /// The time after which it is done again, each time; `None` for once.
    pub every: Option<Duration>,
    /// What to do then.
    pub action: Action,
}

/// What a controller can do.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Action {
    /// Set signals; those not named keep their value.
    Send(Vec<(&'static Field, i64)>),
    /// Set the first words of the telegram, whatever they mean.
    Words(Vec<u16>),
    /// Release the connection and stay disconnected until commanded.
    Release,
    /// Connect again after a release.
    Connect,
    /// Report that its own program has stopped (provider state STOP).
    Stop,
    /// Report that its program runs.
    Run,
}

/// A plant that cannot be made.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum WorldError {
    /// A first parameter does not fit the drive as the others have left it.
    #[error("{drive}: {problem}")]
    Parameter {
        /// The drive.
        drive: String,
        /// What is wrong.
        problem: ParameterProblem,
    },
    /// The drive refuses a first parameter.
    #[error("{drive}: {parameter} is refused: {error}")]
    Refused {
        /// The drive.
        drive: String,
        /// The parameter.
        parameter: String,
        /// Why.
        error: ErrorNumber,
    },
    /// No address is left for a controller beside the drive.
    #[error("{drive}: no address is left beside it for its controller; give its subnet a shorter prefix")]
    NoAddress {
        /// The drive.
        drive: String,
    },
    /// The plant has no drive of this name.
    #[error("no drive `{drive}` in this plant")]
    NoDrive {
        /// The name.
        drive: String,
    },
    /// A parameter has not one value that can be read.
    #[error("{drive}: {parameter} {why}")]
    Unreadable {
        /// The drive.
        drive: String,
        /// The parameter.
        parameter: String,
        /// Why.
        why: &'static str,
    },
    /// It cannot happen to this drive.
    #[error(transparent)]
    Event(#[from] PlantEventError),
}

impl DrivePlan {
    /// Creates a drive as delivered: nothing happens to it. It has no address, and its Ethernet address is made of its
    /// name.
    #[must_use]
    pub fn new(name: &str, model: &'static Model) -> Self {
        Self {
            name: name.to_owned(),
            unnamed: false,
            model,
            mac: derived_mac(name),
            ip: IpSuite::NONE,
            min_device_interval: None,
            plant: model.plant,
            load: 0.0,
            parameters: Vec::new(),
            cues: Vec::new(),
        }
    }

    /// Returns the settings of the station; the carrier adds its own, such as values saved in an earlier run.
    #[must_use]
    pub fn config(&self) -> StationConfig {
        let mut config = StationConfig::new(self.model, self.mac);
        config.min_device_interval = self.min_device_interval;
        config.plant = Some(self.plant);
        config.network = Stored {
            name: if self.unnamed {
                String::new()
            } else {
                self.name.clone()
            },
            ip: self.ip,
            ..Stored::default()
        };
        config
    }

    /// Returns the drive, made and set up, as a station on a good cable; `seed` determines the random faults of a bad
    /// one.
    ///
    /// # Errors
    /// When one of its first parameters is refused.
    pub fn build(&self, config: StationConfig, seed: u64) -> Result<Unit, WorldError> {
        let mut station = Station::new(config);
        for assignment in &self.parameters {
            set(&mut station, self.model, &self.name, assignment)?;
        }
        // they are the drive as it is delivered to the plant, not something that happens in it
        station.drive_mut().forget_written();
        station.drive_mut().set_load(self.load);
        Ok(Unit::new(Host::new(station), seed))
    }
}

/// Gives the drive of a station one of its first parameters.
pub(crate) fn set(
    station: &mut Station,
    model: &Model,
    name: &str,
    assignment: &Assignment,
) -> Result<(), WorldError> {
    let drive = station.drive_mut();
    let table = Parameters {
        catalogue: Some(model.catalogue),
        scaling: drive.scaling(),
    };
    let problem = |problem| WorldError::Parameter {
        drive: name.to_owned(),
        problem,
    };
    let selection = table.select(&assignment.reference).map_err(problem)?;
    let (pnu, first) = (selection.pnu, selection.first);
    let written = match table.check_text(&selection, &assignment.value).map_err(problem)? {
        Some(text) => drive.write_text(pnu, first, text.as_bytes(), Keep::Volatile),
        None => {
            let value = table.check(&selection, &assignment.value).map_err(problem)?;
            drive.write(pnu, first, value.raw.cast_unsigned(), Keep::Volatile)
        }
    };
    written.map_err(|error| WorldError::Refused {
        drive: name.to_owned(),
        parameter: selection.label(),
        error,
    })
}

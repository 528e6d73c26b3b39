//! The shafts of virtual drives.

use std::sync::Arc;

use crate::problem::Problem;
use crate::shared::Shared;
use axum::Json;
use axum::extract::State;
use axum::http::StatusCode;
use profidrive::Transport;
use profidrive::plant::PlantEvent;
use schemars::JsonSchema;
use serde::Serialize;

/// The drives of a plant in memory.
#[derive(Debug, Serialize, JsonSchema)]
pub(crate) struct VirtualDrives {
    /// Time of the plant in seconds.
    time: f64,
    /// Whether it stands still.
    paused: bool,
    /// Seed of all random events.
    seed: u64,
    /// How many plants were started in the place of the first one.
    restarts: u64,
    /// Its drives, in the order of the plant file.
    drives: Vec<VirtualDrive>,
}

impl VirtualDrives {
    /// Returns how they are now; `None` where no drive is virtual.
    pub fn now(shared: &Shared) -> Option<Self> {
        let Transport::Plant(plant) = shared.network.transport() else {
            return None;
        };
        let (paused, seed) = (plant.is_paused(), shared.plant().as_ref()?.plan().seed);
        let restarts = shared.board.restarts();
        Some(plant.with_world(|world| {
            Self {
                paused,
                seed,
                restarts,
                time: world.now().as_nanos() as f64 / 1e9,
                drives: (0..)
                    .map_while(|number| world.shaft(number).map(|shaft| (number, shaft)))
                    .map(|(number, shaft)| VirtualDrive {
                        id: shaft.mac.to_string(),
                        name: shaft.name.to_owned(),
                        position: shaft.position,
                        speed: shaft.speed,
                        load: shaft.load,
                        stops: Ends::of(shaft.stops),
                        switches: Ends::of(shaft.switches),
                        lasting: world.lasting(number).iter().map(Lasting::of).collect(),
                    })
                    .collect(),
            }
        }))
    }
}

/// A virtual drive: where its shaft really is, whatever the drive reports.
#[derive(Debug, Serialize, JsonSchema)]
pub(super) struct VirtualDrive {
    /// What it is called in paths: its MAC address.
    id: String,
    /// What the plant calls it.
    name: String,
    /// Position of the shaft in turns.
    position: f64,
    /// Its speed in rpm.
    speed: f64,
    /// Torque that works against positive rotation, in Nm.
    load: f64,
    /// The hard stop in each direction.
    stops: Ends,
    /// The limit switch in each direction.
    switches: Ends,
    /// What has happened to it and has not ended, in the order in which it happened.
    lasting: Vec<Lasting>,
}

/// The places of something at both ends of the way, in turns as the position counts.
#[derive(Debug, Serialize, JsonSchema)]
struct Ends {
    /// Null where there is none.
    negative: Option<f64>,
    /// Null where there is none.
    positive: Option<f64>,
}

impl Ends {
    const fn of((negative, positive): (Option<f64>, Option<f64>)) -> Self {
        Self { negative, positive }
    }
}

/// An event that has not ended.
#[derive(Debug, Serialize, JsonSchema)]
struct Lasting {
    /// As in plant files: `sto=on`.
    event: String,
    /// What ends it: `sto=off`.
    undo: Option<String>,
}

impl Lasting {
    fn of(event: &PlantEvent) -> Self {
        Self {
            event: event.to_string(),
            undo: event.undo().map(|undo| undo.to_string()),
        }
    }
}

/// Returns position and speed of the shafts of all virtual drives.
#[utoipa::path(get, path = "/api/v1/plant/drives", responses(
    (status = 200, description = "The shafts", body = ref("#/components/schemas/VirtualDrives")),
    (status = 404, description = "The drives are no simulation"),
))]
pub(super) async fn drives(State(shared): State<Arc<Shared>>) -> Result<Json<VirtualDrives>, Problem> {
    VirtualDrives::now(&shared).map(Json).ok_or_else(no_simulation)
}

pub(super) fn no_simulation() -> Problem {
    let detail = "the drives of this server are no simulation";
    Problem::new(StatusCode::NOT_FOUND, "simulation", detail)
}

//! What can happen to virtual drives.

use std::sync::Arc;
use std::time::Duration;

use axum::extract::rejection::JsonRejection;
use axum::extract::{Path, State};
use axum::http::StatusCode;
use axum::http::header::{CONTENT_DISPOSITION, CONTENT_TYPE};
use axum::response::{IntoResponse, Response};
use axum::{Extension, Json};
use profidrive::Transport;
use profidrive::plant::{Happened, PlantEvent, keys};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::virtual_drives::no_simulation;
use crate::access::Caller;
use crate::act::{Intent, carry_out};
use crate::problem::Problem;
use crate::query::Query;
use crate::shared::Shared;

/// Something that happens to a virtual drive.
#[derive(Debug, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct Inject {
    /// The drive, as it is called in paths.
    drive: String,
    /// What happens, as in plant files: `fault=439`, `sto=on`, `cable=pulled`.
    event: String,
    /// After how many seconds it ends; null for what lasts until it is undone.
    seconds: Option<f64>,
}

/// What has happened.
#[derive(Debug, Serialize, JsonSchema)]
pub(super) struct Injected {
    /// What the plant calls the drive.
    drive: String,
    /// What happens, in the notation of plant files.
    event: String,
    /// What ends it; null for what has no end of its own.
    undo: Option<String>,
}

/// What can happen to a virtual drive.
#[derive(Debug, Serialize, JsonSchema)]
pub(super) struct Possible {
    /// The kinds of events.
    keys: Vec<EventKey>,
    /// The faults and warnings that the drive has.
    faults: Vec<FaultNumber>,
}

/// A kind of event.
#[derive(Debug, Serialize, JsonSchema)]
struct EventKey {
    /// Left of the `=`.
    key: &'static str,
    /// A whole example.
    example: &'static str,
    /// What it does.
    meaning: &'static str,
}

/// A fault or a warning that a drive has.
#[derive(Debug, Serialize, JsonSchema)]
struct FaultNumber {
    number: u16,
    warning: bool,
    meaning: &'static str,
}

/// Events that are recorded of a run: as many as a plant file may have of one drive.
const RECORDED: usize = 10_000;
/// The longest time for which something may last, s.
const LONGEST: f64 = 86_400.0;

/// Returns what can happen to a virtual drive.
#[utoipa::path(get, path = "/api/v1/plant/drives/{id}/events", params(("id" = String, Path, description = "MAC address")), responses(
    (status = 200, description = "What can happen", body = ref("#/components/schemas/Possible")),
    (status = 404, description = "No such virtual drive"),
))]
pub(super) async fn events(
    State(shared): State<Arc<Shared>>,
    Path(id): Path<String>,
) -> Result<Json<Possible>, Problem> {
    let Transport::Plant(plant) = shared.network.transport() else {
        return Err(no_simulation());
    };
    let tables = plant.with_world(|world| {
        let number = (0..).map_while(|number| world.shaft(number).map(|shaft| (number, shaft.mac)));
        let mut numbers = number.filter(|(_, mac)| mac.to_string().eq_ignore_ascii_case(&id));
        let station = world.drive(numbers.next()?.0)?;
        Some(station.drive().model().catalogue)
    });
    let tables = tables.ok_or_else(no_drive)?;
    Ok(Json(Possible {
        keys: keys()
            .map(|key| EventKey {
                key: key.key,
                example: key.example,
                meaning: key.meaning,
            })
            .collect(),
        faults: tables
            .faults
            .iter()
            .map(|fault| FaultNumber {
                number: fault.number,
                warning: fault.warning,
                meaning: fault.meaning,
            })
            .collect(),
    }))
}

/// Returns what was let happen to the virtual drives as a plant file, in which the same happens again.
#[utoipa::path(get, path = "/api/v1/plant/scenario", params(
    ("since" = Option<f64>, Query, description = "Only what happened from this time of the plant on, in seconds: it is the beginning of the file"),
    ("without_events" = Option<bool>, Query, description = "Nothing of that: the plant file as it was started"),
), responses(
    (status = 200, description = "The plant file", body = String, content_type = "application/toml"),
    (status = 400, description = "A value that is not valid"),
    (status = 404, description = "The drives are no simulation"),
))]
pub(super) async fn scenario(State(shared): State<Arc<Shared>>, query: Query) -> Result<Response, Problem> {
    let invalid = |detail: &str| Problem::new(StatusCode::BAD_REQUEST, "usage", detail);
    let since = query.parsed::<f64>("since")?.unwrap_or(0.0);
    let since = Duration::try_from_secs_f64(since).map_err(|error| invalid(&error.to_string()))?;
    let plant = shared.plant().clone().ok_or_else(no_simulation)?;
    let happened = match query.is_true("without_events") {
        true => Vec::new(),
        false => shared.happened().clone(),
    };
    let all = happened.into_iter();
    let from_then = all.filter_map(|happened| {
        let at = happened.at.checked_sub(since)?;
        Some(Happened { at, ..happened })
    });
    let from_then: Vec<_> = from_then.collect();
    let recorded = plant
        .with_events(&from_then)
        .map_err(|error| invalid(&error.to_string()))?;
    let headers = [
        (CONTENT_TYPE, "application/toml"),
        (CONTENT_DISPOSITION, "attachment; filename=\"scenario.toml\""),
    ];
    Ok((headers, recorded.as_toml().to_owned()).into_response())
}

/// Lets something happen to a virtual drive.
#[utoipa::path(post, path = "/api/v1/plant/inject", request_body(content = ref("#/components/schemas/Inject"), content_type = "application/json"), responses(
    (status = 200, description = "It happens", body = ref("#/components/schemas/Injected")),
    (status = 400, description = "It cannot happen to this drive"),
    (status = 404, description = "No such virtual drive"),
    (status = 503, description = "It cannot be logged"),
))]
pub(super) async fn inject(
    State(shared): State<Arc<Shared>>,
    Extension(caller): Extension<Caller>,
    wanted: Result<Json<Inject>, JsonRejection>,
) -> Result<Json<Injected>, Problem> {
    let Json(wanted) = wanted.map_err(|error| Problem::of_body(&error))?;
    let Transport::Plant(plant) = shared.network.transport().clone() else {
        return Err(no_simulation());
    };
    let invalid = |detail: &str| Problem::new(StatusCode::BAD_REQUEST, "usage", detail);
    let event: PlantEvent = wanted
        .event
        .parse()
        .map_err(|error| invalid(&format!("{error}")))?;
    let lasts = match wanted.seconds {
        None => None,
        Some(seconds) if seconds > 0.0 && seconds <= LONGEST => Some(Duration::from_secs_f64(seconds)),
        Some(seconds) => {
            return Err(invalid(&format!(
                "{seconds} s: a time is more than 0 s and at most a day"
            )));
        }
    };
    let undo = event.undo();
    if lasts.is_some() && undo.is_none() {
        return Err(invalid(&format!(
            "`{event}` has no end of its own, so it lasts for no time"
        )));
    }
    let id = wanted.drive.to_lowercase();
    let intent = Intent {
        action: "inject",
        drive: Some(id.clone()),
        value: Some(match wanted.seconds {
            Some(seconds) => format!("{event} for {seconds} s"),
            None => event.to_string(),
        }),
        ..Intent::default()
    };
    let at = Arc::clone(&shared);
    let work = async move {
        let happened = plant.with_world(|world| {
            let shafts = (0..).map_while(|number| world.shaft(number));
            let mut named = shafts.filter(|shaft| shaft.mac.to_string() == id);
            let name = named.next()?.name.to_owned();
            let now = Duration::from_millis(world.now().as_nanos() / 1_000_000);
            Some(world.inject(&name, event, lasts).map(|()| (name, now)))
        });
        match happened {
            None => Err(no_drive()),
            Some(Err(error)) => Err(Problem::new(StatusCode::BAD_REQUEST, "usage", &error.to_string())),
            Some(Ok((drive, now))) => {
                let mut all = at.happened();
                if all.len() < RECORDED {
                    all.push(Happened {
                        drive: drive.clone(),
                        at: now,
                        event,
                        lasts,
                    });
                }
                Ok(Injected {
                    drive,
                    event: event.to_string(),
                    undo: undo.map(|undo| undo.to_string()),
                })
            }
        }
    };
    carry_out(shared, &caller, intent, work).await.map(Json)
}

fn no_drive() -> Problem {
    let detail = "no such virtual drive; /api/v1/plant/drives lists them";
    Problem::new(StatusCode::NOT_FOUND, "drive", detail)
}

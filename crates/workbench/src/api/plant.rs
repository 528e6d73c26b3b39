//! The plant of a simulation: started again, its time, its file.

use std::sync::Arc;

use axum::extract::rejection::JsonRejection;
use axum::extract::{Request, State};
use axum::http::StatusCode;
use axum::middleware::Next;
use axum::response::{IntoResponse, Response};
use axum::{Extension, Json};
use profidrive::plant::PlantSource;
use profidrive::{OpenError, Transport};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::virtual_drives::no_simulation;
use crate::access::Caller;
use crate::act::{Intent, carry_out};
use crate::problem::{Problem, STANDS_STILL};
use crate::shared::Shared;

/// A plant file that is checked or started.
#[derive(Debug, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct PlantText {
    /// Its text.
    text: String,
}

/// A plant that is started.
#[derive(Debug, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct PlantStart {
    /// The text of its file.
    text: String,
    /// How many plants were started in the place of the first one when the caller looked; another number is refused. Null where it
    /// does not matter which plant is replaced.
    restarts: Option<u64>,
}

/// A plant that was started.
#[derive(Debug, Serialize, JsonSchema)]
pub(super) struct PlantStarted {
    /// How many plants were started in the place of the first one, with this.
    restarts: u64,
}

/// What is wrong with a plant file.
#[derive(Debug, Serialize, JsonSchema)]
pub(super) struct PlantCheck {
    /// The first thing that is wrong; null where the file is valid.
    problem: Option<PlantProblem>,
}

/// Something that is not valid in a plant file.
#[derive(Debug, Serialize, JsonSchema)]
pub(super) struct PlantProblem {
    /// Its line, from 1.
    line: usize,
    message: String,
}

/// Whether the time of the plant stands still.
#[derive(Debug, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct PlantClock {
    paused: bool,
}

const CONTROLS: &str = "this server controls an axis: release it first";
const REPLACED: &str = "another plant was started since: look at it first";
/// The part of the interface that only a simulation has.
const OF_PLANTS: &str = "/api/v1/plant/";
/// Parts of the interface that wait for drives.
const OF_DRIVES: [&str; 4] = [
    "/api/v1/drives/",
    "/api/v1/stations/",
    "/api/v1/plans/",
    "/api/v1/compare",
];
/// What this server knows of a drive without its answer.
const KNOWN: [&str; 4] = ["/machine", "/telegram", "/parameters", "/unsaved"];

/// Returns whether a path of the interface waits for drives.
pub(super) fn waits_for_drives(path: &str) -> bool {
    OF_DRIVES.iter().any(|of| path.starts_with(of)) && !KNOWN.iter().any(|end| path.ends_with(end))
}

/// Refuses what waits for a drive while the time of the plant stands still.
pub(crate) async fn while_it_runs(
    State(shared): State<Arc<Shared>>,
    request: Request,
    next: Next,
) -> Response {
    if waits_for_drives(request.uri().path()) && shared.is_paused() {
        return refused(StatusCode::CONFLICT, STANDS_STILL).into_response();
    }
    next.run(request).await
}

/// Refuses everything of a plant where the drives are no simulation, whatever the request has in its body.
pub(crate) async fn of_a_simulation(
    State(shared): State<Arc<Shared>>,
    request: Request,
    next: Next,
) -> Response {
    if request.uri().path().starts_with(OF_PLANTS) && !shared.source.is_simulation() {
        return no_simulation().into_response();
    }
    next.run(request).await
}

fn refused(status: StatusCode, detail: &str) -> Problem {
    Problem::new(status, "refused", detail)
}

/// Checks a plant file. Nothing is started.
#[utoipa::path(post, path = "/api/v1/plant/check", request_body(content = ref("#/components/schemas/PlantText"), content_type = "application/json"), responses(
    (status = 200, description = "What is wrong with it", body = ref("#/components/schemas/PlantCheck")),
    (status = 404, description = "The drives are no simulation"),
))]
pub(super) async fn check(
    wanted: Result<Json<PlantText>, JsonRejection>,
) -> Result<Json<PlantCheck>, Problem> {
    let Json(PlantText { text }) = wanted.map_err(|error| Problem::of_body(&error))?;
    let problem = text.parse::<PlantSource>().err();
    Ok(Json(PlantCheck {
        problem: problem.map(|error| PlantProblem {
            line: error.line,
            message: error.message,
        }),
    }))
}

/// Starts a plant from its beginning in the place of the one that runs, as if all drives were switched off and on at once. It is
/// refused while this server controls an axis. Nothing is known of the drives of the plant before any more.
#[utoipa::path(post, path = "/api/v1/plant/restart", request_body(content = ref("#/components/schemas/PlantStart"), content_type = "application/json"), responses(
    (status = 200, description = "It runs", body = ref("#/components/schemas/PlantStarted")),
    (status = 400, description = "The file is not valid"),
    (status = 404, description = "The drives are no simulation"),
    (status = 409, description = "This server controls an axis, another plant was started meanwhile, or the plant needs another network"),
    (status = 503, description = "It cannot be logged"),
))]
pub(super) async fn restart(
    State(shared): State<Arc<Shared>>,
    Extension(caller): Extension<Caller>,
    wanted: Result<Json<PlantStart>, JsonRejection>,
) -> Result<Json<PlantStarted>, Problem> {
    let Json(PlantStart { text, restarts: seen }) = wanted.map_err(|error| Problem::of_body(&error))?;
    let Transport::Plant(plant) = shared.network.transport().clone() else {
        return Err(no_simulation());
    };
    let source: PlantSource = text
        .parse()
        .map_err(|error| Problem::new(StatusCode::BAD_REQUEST, "usage", &format!("{error}")))?;
    if shared.control.has_axes() {
        return Err(refused(StatusCode::CONFLICT, CONTROLS));
    }
    let intent = Intent {
        action: "restart",
        value: Some(format!(
            "{} drives, seed {}",
            source.plan().drives.len(),
            source.plan().seed
        )),
        ..Intent::default()
    };
    let at = Arc::clone(&shared);
    let work = async move {
        let mut network = at.network.clone();
        let restarts = at.board.restart(|restarts| {
            if seen.is_some_and(|seen| seen != restarts) {
                return Err(Problem::new(StatusCode::CONFLICT, "changed", REPLACED));
            }
            // one that was taken meanwhile
            if at.control.has_axes() {
                return Err(refused(StatusCode::CONFLICT, CONTROLS));
            }
            plant
                .restart(source.plan(), &mut network)
                .map_err(|error| match error {
                    OpenError::OtherAddress { .. } => refused(StatusCode::CONFLICT, &error.to_string()),
                    _ => Problem::new(StatusCode::BAD_REQUEST, "usage", &error.to_string()),
                })?;
            at.frames.catch_up(&at.network);
            at.hub.forget();
            at.jobs.forget_written();
            at.happened().clear();
            *at.plant() = Some(source);
            Ok(())
        })?;
        plant.pause(false);
        Ok(PlantStarted { restarts })
    };
    carry_out(shared, &caller, intent, work).await.map(Json)
}

/// Lets the time of the plant stand still, or go on. It is refused while this server controls an axis: STOP needs time, too.
#[utoipa::path(post, path = "/api/v1/plant/clock", request_body(content = ref("#/components/schemas/PlantClock"), content_type = "application/json"), responses(
    (status = 200, description = "It stands still, or goes on", body = ref("#/components/schemas/PlantClock")),
    (status = 404, description = "The drives are no simulation"),
    (status = 409, description = "This server controls an axis"),
    (status = 503, description = "It cannot be logged"),
))]
pub(super) async fn clock(
    State(shared): State<Arc<Shared>>,
    Extension(caller): Extension<Caller>,
    wanted: Result<Json<PlantClock>, JsonRejection>,
) -> Result<Json<PlantClock>, Problem> {
    let Json(wanted) = wanted.map_err(|error| Problem::of_body(&error))?;
    let Transport::Plant(plant) = shared.network.transport().clone() else {
        return Err(no_simulation());
    };
    if wanted.paused && shared.control.has_axes() {
        return Err(refused(StatusCode::CONFLICT, CONTROLS));
    }
    let state = if wanted.paused { "paused" } else { "real" };
    let intent = Intent::new("clock", Some(state.to_owned()));
    let at = Arc::clone(&shared);
    let work = async move {
        plant.pause(wanted.paused);
        // one that was taken meanwhile; one that is taken from now on sees the pause
        if wanted.paused && at.control.has_axes() {
            plant.pause(false);
            return Err(refused(StatusCode::CONFLICT, CONTROLS));
        }
        Ok(wanted)
    };
    carry_out(shared, &caller, intent, work).await.map(Json)
}

//! What the frames of the network show: state machine, telegrams, what went wrong, and the frames themselves.

use std::sync::Arc;
use std::time::Duration;

use axum::Json;
use axum::extract::{Path, State};
use axum::http::StatusCode;
use axum::http::header::{CONTENT_DISPOSITION, CONTENT_TYPE};
use axum::response::{IntoResponse, Response};
use profidrive::report::StateMachine;
use schemars::JsonSchema;
use serde::Serialize;

use crate::blocking::blocking;
use crate::frames::{MachineTopic, NetworkTrouble, TelegramTopic};
use crate::problem::Problem;
use crate::query::Query;
use crate::settings::Source;
use crate::shared::Shared;

/// Returns the states and transitions of the general state machine, as the profile has them.
#[utoipa::path(get, path = "/api/v1/state-machine", responses(
    (status = 200, description = "The table", body = ref("#/components/schemas/StateMachine")),
))]
pub(super) async fn state_machine() -> Json<StateMachine> {
    Json(StateMachine::new())
}

/// Returns where a drive is in the state machine, and where it was in the last minute.
#[utoipa::path(get, path = "/api/v1/drives/{id}/machine", responses(
    (status = 200, description = "The state", body = ref("#/components/schemas/MachineTopic")),
))]
pub(super) async fn machine(
    State(shared): State<Arc<Shared>>,
    Path(id): Path<String>,
) -> Result<Json<MachineTopic>, Problem> {
    let id = id.to_lowercase();
    shared.board.look(|_| ());
    let machine = shared.frames.machine(&shared, &id);
    machine.map(Json).ok_or_else(|| {
        let detail = "the words of this drive are not known: no frame has them, and its status was not read";
        Problem::new(StatusCode::NOT_FOUND, "drive", detail)
    })
}

/// Returns the last cyclic frames of a drive, with what they mean, and how regular they are.
#[utoipa::path(get, path = "/api/v1/drives/{id}/telegram", responses(
    (status = 200, description = "The frames", body = ref("#/components/schemas/TelegramTopic")),
))]
pub(super) async fn telegram(
    State(shared): State<Arc<Shared>>,
    Path(id): Path<String>,
) -> Json<TelegramTopic> {
    Json(shared.frames.telegram(&id.to_lowercase()))
}

/// What went wrong on the network.
#[derive(Debug, Serialize, JsonSchema)]
pub(super) struct TroublesReport {
    /// The oldest first; the last 500 since the start.
    troubles: Vec<NetworkTrouble>,
}

/// Lists what the frames show that went wrong: refusals, lost connections, alarms, frames that cannot be decoded.
#[utoipa::path(get, path = "/api/v1/troubles", responses(
    (status = 200, description = "What went wrong", body = ref("#/components/schemas/TroublesReport")),
))]
pub(super) async fn troubles(State(shared): State<Arc<Shared>>) -> Json<TroublesReport> {
    Json(TroublesReport {
        troubles: shared.frames.troubles(),
    })
}

/// Returns the frames of the last minute as a pcapng file, or those of them around an event.
#[utoipa::path(get, path = "/api/v1/traffic", params(
    ("from" = Option<u64>, Query, description = "Only frames since this time of day, in ms since 1970"),
    ("to" = Option<u64>, Query, description = "Only frames up to this time of day, in ms since 1970"),
), responses(
    (status = 200, description = "The capture", body = String, content_type = "application/x-pcapng"),
    (status = 400, description = "A time that is not valid"),
    (status = 404, description = "The drives were given by their addresses: there are no frames"),
))]
pub(super) async fn traffic(State(shared): State<Arc<Shared>>, query: Query) -> Result<Response, Problem> {
    let time = |name| Ok::<_, Problem>(query.parsed(name)?.map(Duration::from_millis));
    let (from, to) = (
        time("from")?.unwrap_or_default(),
        time("to")?.unwrap_or(Duration::MAX),
    );
    let file = match from.is_zero() {
        true => "last-minute".to_owned(),
        false => format!("frames-from-{}", from.as_millis()),
    };
    let name = match &shared.source {
        Source::Interface(name) => name.clone(),
        Source::Demo | Source::Plant(_) => "plant".to_owned(),
        Source::Addresses(_) => {
            let detail = "the drives were given by their addresses: this server sees no frames";
            return Err(Problem::new(StatusCode::NOT_FOUND, "frames", detail));
        }
    };
    let content = blocking(move || {
        let file = shared.frames.traffic().capture_of(&name, from..=to);
        file.map_err(|error| {
            let detail = format!("cannot write the capture: {error}");
            Problem::new(StatusCode::INTERNAL_SERVER_ERROR, "local", &detail)
        })
    });
    let headers = [
        (CONTENT_TYPE, "application/x-pcapng".to_owned()),
        (
            CONTENT_DISPOSITION,
            format!("attachment; filename=\"{file}.pcapng\""),
        ),
    ];
    Ok((headers, content.await?).into_response())
}

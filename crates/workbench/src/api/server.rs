//! What this server is, and STOP.

use std::sync::Arc;

use axum::extract::State;
use axum::{Extension, Json};
use schemars::JsonSchema;
use serde::Serialize;

use crate::access::{Caller, Role};
use crate::act;
use crate::assets;
use crate::control::StopFrame;
use crate::settings::Source;
use crate::shared::Shared;

/// What a server is.
#[derive(Debug, Serialize, JsonSchema)]
pub(super) struct ServerReport {
    /// What people call it.
    name: Option<String>,
    /// Version of the program.
    version: &'static str,
    /// Version and page of the program: a page that was loaded from another build has to be loaded again.
    build: &'static str,
    /// Distinguishes this start from others.
    boot: String,
    /// Whether its drives are virtual.
    simulation: bool,
    /// Where they are: `demo`, `plant`, `interface` or `addresses`.
    source: &'static str,
    /// The network interface.
    interface: Option<String>,
    /// Whether stations are searched for.
    searches: bool,
    /// What the caller may do.
    role: Role,
    /// Whether looking and stopping is all that is permitted.
    read_only: bool,
    /// The axes that this server controls, as they are called in paths.
    controlled: Vec<String>,
    /// How often a stop was requested.
    stops: u64,
}

/// Returns what this server is, and what the caller may do.
#[utoipa::path(get, path = "/api/v1/server", responses(
    (status = 200, description = "The server", body = ref("#/components/schemas/ServerReport")),
))]
pub(super) async fn server(
    State(shared): State<Arc<Shared>>,
    Extension(caller): Extension<Caller>,
) -> Json<ServerReport> {
    let interface = match &shared.source {
        Source::Interface(name) => Some(name.clone()),
        _ => None,
    };
    Json(ServerReport {
        name: shared.name.clone(),
        version: env!("CARGO_PKG_VERSION"),
        build: assets::build(),
        boot: shared.boot.clone(),
        simulation: shared.source.is_simulation(),
        source: shared.source.id(),
        interface,
        searches: shared.board.searches(),
        role: caller.role,
        read_only: shared.read_only,
        controlled: shared.control.drives(),
        stops: shared.control.stops(),
    })
}

/// What a stop did.
#[derive(Debug, Serialize, JsonSchema)]
pub(super) struct StoppedReport {
    /// How often a stop was requested.
    stops: u64,
    /// The axes that are stopped, as they are called in paths: all that this server controls.
    axes: Vec<String>,
    /// Whether the frames with the stop of all of them were handed to the network.
    confirmed: bool,
    /// The stop of each of them.
    frames: Vec<StopFrame>,
}

/// Stops every axis that this server controls by its quick stop (OFF3), or as its page has chosen. Nothing is enabled or moved
/// afterwards before the STOP is reset by a page with control. The answer comes once the frames with the stop were handed to the network,
/// or after 400 ms without that. Drives under another controller or without one are not touched.
#[utoipa::path(post, path = "/api/v1/stop", responses(
    (status = 200, description = "The axes that are stopped", body = ref("#/components/schemas/StoppedReport")),
    (status = 403, description = "Another origin"),
))]
pub(super) async fn stop(
    State(shared): State<Arc<Shared>>,
    Extension(caller): Extension<Caller>,
) -> Json<StoppedReport> {
    let stopped = act::stop(&shared, &caller).await;
    Json(StoppedReport {
        stops: stopped.epoch,
        confirmed: stopped.confirmed,
        frames: stopped.axes,
        axes: stopped.drives,
    })
}

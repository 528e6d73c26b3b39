//! One drive, read when this is called.

use std::sync::Arc;

use axum::Json;
use axum::extract::{Path, State};
use axum::http::StatusCode;
use profidrive::client::Drive;
use profidrive::inspection::{self, Record};
use profidrive::report::{FaultsReport, InfoReport, StatusReport};
use schemars::JsonSchema;
use serde::Serialize;

use crate::problem::Problem;
use crate::query::Query;
use crate::shared::Shared;
use crate::words::PageWords;

/// Finds a drive for a call of its own.
pub(crate) async fn find(shared: &Shared, id: &str) -> Result<(profidrive::Caller, Drive), Problem> {
    let id = id.to_lowercase();
    if !shared.board.look(|stations| stations.known.contains_key(&id)) {
        return Err(unknown());
    }
    let mut network = shared.network.clone();
    let drive = shared.board.find(&mut network, &id).await;
    let drive = drive.map_err(|error| Problem::of(&error))?;
    Ok((network, drive))
}

/// Returns the problem of a drive that is not known.
pub(super) fn unknown() -> Problem {
    let detail = "no such drive has answered; /api/v1/stations lists those that did";
    Problem::new(StatusCode::NOT_FOUND, "drive", detail)
}

/// Reads how a drive is, and in one sentence why it does not run.
#[utoipa::path(get, path = "/api/v1/drives/{id}/status", responses(
    (status = 200, description = "The status", body = ref("#/components/schemas/StatusReport")),
))]
pub(super) async fn status(
    State(shared): State<Arc<Shared>>,
    Path(id): Path<String>,
) -> Result<Json<StatusReport>, Problem> {
    let (mut network, mut drive) = find(&shared, &id).await?;
    let status = inspection::status(&mut network, &mut drive, &PageWords).await;
    status
        .map(|status| Json(status.report))
        .map_err(|error| Problem::of(&error))
}

/// Reads who a drive is: identification, modules, neighbours.
#[utoipa::path(get, path = "/api/v1/drives/{id}/info", responses(
    (status = 200, description = "The identity", body = ref("#/components/schemas/InfoReport")),
))]
pub(super) async fn info(
    State(shared): State<Arc<Shared>>,
    Path(id): Path<String>,
) -> Result<Json<InfoReport>, Problem> {
    let (mut network, mut drive) = find(&shared, &id).await?;
    let info = inspection::info(&mut network, &mut drive).await;
    info.map(Json).map_err(|error| Problem::of(&error))
}

/// Reads the faults and warnings of a drive, with those that were acknowledged.
#[utoipa::path(get, path = "/api/v1/drives/{id}/faults", responses(
    (status = 200, description = "The faults", body = ref("#/components/schemas/FaultsReport")),
))]
pub(super) async fn faults(
    State(shared): State<Arc<Shared>>,
    Path(id): Path<String>,
) -> Result<Json<FaultsReport>, Problem> {
    let (mut network, mut drive) = find(&shared, &id).await?;
    let faults = inspection::faults(&mut network, &mut drive, true).await;
    faults.map(Json).map_err(|error| Problem::of(&error))
}

/// A record of a drive.
#[derive(Debug, Serialize, JsonSchema)]
pub(super) struct RecordReport {
    /// Its octets in hexadecimal, with blanks between them.
    octets: String,
    /// What it has, where its layout is known.
    text: Option<String>,
}

/// Reads a record of any submodule. Nothing is written.
#[utoipa::path(get, path = "/api/v1/drives/{id}/record", params(
    ("api" = Option<u32>, Query, description = "Application process: 0 where it is not given, 14848 (0x3A00) for the drive profile"),
    ("slot" = u16, Query, description = "Slot"),
    ("subslot" = u16, Query, description = "Subslot"),
    ("index" = u16, Query, description = "Index: 45040 (0xAFF0) is the identity"),
), responses(
    (status = 200, description = "The record", body = ref("#/components/schemas/RecordReport")),
    (status = 400, description = "A number that is not valid, or none"),
    (status = 409, description = "The drive refuses"),
))]
pub(super) async fn record(
    State(shared): State<Arc<Shared>>,
    Path(id): Path<String>,
    query: Query,
) -> Result<Json<RecordReport>, Problem> {
    let number = |name: &str| {
        query.parsed::<u16>(name)?.ok_or_else(|| {
            let detail = format!("`{name}` is missing");
            Problem::new(StatusCode::BAD_REQUEST, "usage", &detail)
        })
    };
    let at = Record {
        api: query.parsed("api")?.unwrap_or(0),
        slot: number("slot")?,
        subslot: number("subslot")?,
        index: number("index")?,
    };
    let (mut network, mut drive) = find(&shared, &id).await?;
    let record = inspection::record(&mut network, &mut drive, at).await;
    let (octets, text) = record.map_err(|error| Problem::of(&error))?;
    let octets = octets
        .iter()
        .map(|octet| format!("{octet:02X}"))
        .collect::<Vec<_>>();
    Ok(Json(RecordReport {
        octets: octets.join(" "),
        text,
    }))
}

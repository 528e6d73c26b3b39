//! Captures explained.

use std::sync::Arc;

use axum::Json;
use axum::body::Body;
use axum::extract::{Path, State};
use axum::http::header::CONTENT_LENGTH;
use axum::http::{HeaderMap, StatusCode};
use futures::StreamExt;
use schemars::JsonSchema;
use serde::Serialize;

use crate::blocking::blocking;
use crate::captures::{CaptureReport, EventPage, Filter, FramePage, FrameReport, local};
use crate::problem::Problem;
use crate::query::Query;
use crate::shared::Shared;

/// The largest capture, in octets.
const LARGEST: u64 = 256 << 20;
/// Rows of a page where a request has no number, and the most.
const ROWS: usize = 100;
const MOST: usize = 1000;

/// The captures that are kept.
#[derive(Debug, Serialize, JsonSchema)]
pub(super) struct CapturesReport {
    /// The newest first.
    captures: Vec<CaptureReport>,
}

/// Lists the captures that this server has: the last four, while it runs.
#[utoipa::path(get, path = "/api/v1/captures", responses(
    (status = 200, description = "The captures", body = ref("#/components/schemas/CapturesReport")),
))]
pub(super) async fn captures(State(shared): State<Arc<Shared>>) -> Json<CapturesReport> {
    Json(CapturesReport {
        captures: shared.captures.list(),
    })
}

/// Takes a capture, pcap or pcapng of Ethernet, and begins to read it. It is on this computer only, in a file without a name, and
/// gone when the server ends.
#[utoipa::path(post, path = "/api/v1/captures", request_body(content = String, description = "The file", content_type = "application/octet-stream"), responses(
    (status = 200, description = "The capture; it is read meanwhile", body = ref("#/components/schemas/CaptureReport")),
    (status = 400, description = "The file did not come to its end"),
    (status = 413, description = "More than 256 MiB"),
    (status = 507, description = "No room on the disk"),
))]
pub(super) async fn upload_capture(
    State(shared): State<Arc<Shared>>,
    headers: HeaderMap,
    body: Body,
) -> Result<Json<CaptureReport>, Problem> {
    let announced = headers
        .get(CONTENT_LENGTH)
        .and_then(|length| length.to_str().ok()?.parse::<u64>().ok());
    if announced.is_some_and(|length| length > LARGEST) {
        return Err(too_large());
    }
    let at = Arc::clone(&shared);
    let mut upload = blocking(move || at.captures.begin()).await?;
    let mut body = body.into_data_stream();
    while let Some(chunk) = body.next().await {
        let chunk = chunk.map_err(|_| {
            let detail = "the file did not come to its end";
            Problem::new(StatusCode::BAD_REQUEST, "body", detail)
        })?;
        if upload.octets() + chunk.len() as u64 > LARGEST {
            return Err(too_large());
        }
        upload = blocking(move || {
            upload.write(&chunk).map_err(|error| local(&error))?;
            Ok(upload)
        })
        .await?;
    }
    blocking(move || shared.captures.take(upload)).await.map(Json)
}

fn too_large() -> Problem {
    let detail = "the capture has more than 256 MiB: cut it in pieces, as `editcap` does";
    Problem::new(StatusCode::PAYLOAD_TOO_LARGE, "body", detail)
}

/// Returns what is known of a capture so far.
#[utoipa::path(get, path = "/api/v1/captures/{id}", params(("id" = u64, Path, description = "The capture")), responses(
    (status = 200, description = "The capture", body = ref("#/components/schemas/CaptureReport")),
    (status = 404, description = "No such capture"),
))]
pub(super) async fn capture(
    State(shared): State<Arc<Shared>>,
    Path(id): Path<u64>,
) -> Result<Json<CaptureReport>, Problem> {
    Ok(Json(shared.captures.get(id)?.report()))
}

/// Removes a capture.
#[utoipa::path(delete, path = "/api/v1/captures/{id}", params(("id" = u64, Path, description = "The capture")), responses(
    (status = 204, description = "Removed"),
    (status = 404, description = "No such capture"),
))]
pub(super) async fn remove_capture(
    State(shared): State<Arc<Shared>>,
    Path(id): Path<u64>,
) -> Result<StatusCode, Problem> {
    shared.captures.remove(id)?;
    Ok(StatusCode::NO_CONTENT)
}

/// Returns what happened in a capture.
#[utoipa::path(get, path = "/api/v1/captures/{id}/events", params(
    ("id" = u64, Path, description = "The capture"),
    ("trouble" = Option<bool>, Query, description = "Only what points to a fault"),
    ("states" = Option<bool>, Query, description = "Only states of drives"),
    ("device" = Option<String>, Query, description = "Only from or to this MAC address"),
    ("begin" = Option<f64>, Query, description = "Only from this time on, in seconds"),
    ("end" = Option<f64>, Query, description = "Only before this time, in seconds"),
    ("from" = Option<usize>, Query, description = "Without the first ones"),
    ("most" = Option<usize>, Query, description = "At most so many: 100 where it is not given, at most 1000"),
), responses(
    (status = 200, description = "The events", body = ref("#/components/schemas/EventPage")),
    (status = 400, description = "A value that is not valid"),
    (status = 404, description = "No such capture"),
))]
pub(super) async fn capture_events(
    State(shared): State<Arc<Shared>>,
    Path(id): Path<u64>,
    query: Query,
) -> Result<Json<EventPage>, Problem> {
    let filter = Filter {
        trouble: query.is_true("trouble"),
        states: query.is_true("states"),
        device: query.parsed("device")?,
        from: query.parsed("begin")?,
        to: query.parsed("end")?,
    };
    let from = query.parsed("from")?.unwrap_or(0);
    let most = query.parsed("most")?.unwrap_or(ROWS).clamp(1, MOST);
    Ok(Json(shared.captures.get(id)?.events(&filter, from, most)))
}

/// Returns the frames of a capture.
#[utoipa::path(get, path = "/api/v1/captures/{id}/frames", params(
    ("id" = u64, Path, description = "The capture"),
    ("from" = Option<u64>, Query, description = "From this number on; 1 is the first one"),
    ("most" = Option<usize>, Query, description = "At most so many: 100 where it is not given, at most 1000"),
), responses(
    (status = 200, description = "The frames", body = ref("#/components/schemas/FramePage")),
    (status = 400, description = "A value that is not valid"),
    (status = 404, description = "No such capture"),
    (status = 409, description = "It is still being read"),
))]
pub(super) async fn capture_frames(
    State(shared): State<Arc<Shared>>,
    Path(id): Path<u64>,
    query: Query,
) -> Result<Json<FramePage>, Problem> {
    let from = query.parsed("from")?.unwrap_or(1);
    let most = query.parsed("most")?.unwrap_or(ROWS).clamp(1, MOST);
    let reading = shared.captures.get(id)?;
    blocking(move || reading.frames(from, most)).await.map(Json)
}

/// Returns one frame of a capture with every field of it.
#[utoipa::path(get, path = "/api/v1/captures/{id}/frames/{number}", params(
    ("id" = u64, Path, description = "The capture"),
    ("number" = u64, Path, description = "The frame, from 1"),
), responses(
    (status = 200, description = "The frame", body = ref("#/components/schemas/FrameReport")),
    (status = 404, description = "No such capture, or no such frame"),
    (status = 409, description = "It is still being read"),
))]
pub(super) async fn capture_frame(
    State(shared): State<Arc<Shared>>,
    Path((id, number)): Path<(u64, u64)>,
) -> Result<Json<FrameReport>, Problem> {
    let reading = shared.captures.get(id)?;
    blocking(move || reading.frame(number)).await.map(Json)
}

//! The stations of the network.

use std::sync::Arc;
use std::time::Instant;

use axum::Json;
use axum::extract::State;
use profidrive::motion::StopOffer;
use profidrive::report::{Error, Scanned, StatusReport};
use schemars::JsonSchema;
use serde::Serialize;

use crate::board::Known;
use crate::shared::Shared;

/// The stations of the network. Times are in seconds.
#[derive(Debug, Serialize, JsonSchema)]
pub(crate) struct StationsReport {
    /// All that answered, and those that answered some minutes ago.
    stations: Vec<KnownStation>,
    /// Time since the last search; null before the first.
    age: Option<f64>,
    /// Why the last search failed.
    failure: Option<Error>,
    /// Whether the time of the plant stands still.
    paused: bool,
    /// How many plants were started in the place of the first one: these are the stations of the last.
    restarts: u64,
}

impl StationsReport {
    pub fn now(shared: &Shared) -> Self {
        let now = Instant::now();
        let since =
            |then: Option<Instant>| then.map(|then| now.saturating_duration_since(then).as_secs_f64());
        shared.board.look(|stations| Self {
            stations: stations
                .known
                .iter()
                .map(|(id, known)| KnownStation::new(id, known, now))
                .collect(),
            age: since(stations.searched),
            failure: stations.failure.clone(),
            paused: shared.is_paused(),
            restarts: stations.restarts,
        })
    }
}

/// A station.
#[derive(Debug, Serialize, JsonSchema)]
pub(super) struct KnownStation {
    /// What it is called in paths: its MAC address, or `ip-` with its address.
    id: String,
    /// How it answered, and who it is.
    #[serde(flatten)]
    scanned: Scanned,
    /// Time since it was first missed; null while it answers.
    lost: Option<f64>,
    /// How it is; null where that was not read.
    status: Option<StatusReport>,
    /// Why the status was not read.
    error: Option<Error>,
    /// By what it can be stopped, as its status was read; null where it was not read.
    stop: Option<StopOffer>,
    /// Time since the status was read.
    age: Option<f64>,
}

impl KnownStation {
    fn new(id: &str, known: &Known, now: Instant) -> Self {
        let since =
            |then: Option<Instant>| then.map(|then| now.saturating_duration_since(then).as_secs_f64());
        let (status, error) = match known.status.clone() {
            Some(Ok(status)) => (Some(status), None),
            Some(Err(error)) => (None, Some(error)),
            None => (None, None),
        };
        Self {
            id: id.to_owned(),
            scanned: known.scanned.clone(),
            lost: since(known.lost),
            status,
            error,
            stop: known.stop.clone(),
            age: since(known.read),
        }
    }
}

/// Returns the stations, as they were found and read last. They are read again while this is called.
#[utoipa::path(get, path = "/api/v1/stations", responses(
    (status = 200, description = "The stations", body = ref("#/components/schemas/StationsReport")),
))]
pub(super) async fn stations(State(shared): State<Arc<Shared>>) -> Json<StationsReport> {
    Json(StationsReport::now(&shared))
}

/// Searches for stations now, and returns those that are known then. Searches come by themselves every five seconds while
/// a page looks.
#[utoipa::path(post, path = "/api/v1/stations/scan", responses(
    (status = 200, description = "The stations", body = ref("#/components/schemas/StationsReport")),
))]
pub(super) async fn scan(State(shared): State<Arc<Shared>>) -> Json<StationsReport> {
    shared.board.search_now().await;
    Json(StationsReport::now(&shared))
}

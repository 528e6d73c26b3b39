//! The interface for the page and for programs: `/api/v1`, described by `openapi.json`.

mod drives;
mod problem;
mod server;
mod session;
mod stations;
mod virtual_drives;

use std::sync::atomic::AtomicU64;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Instant;

use axum::Router;
use axum::http::StatusCode;
use profidrive::Caller as Network;
use profidrive::report::{FaultsReport, InfoReport, StatusReport};
use schemars::generate::SchemaSettings;
use serde_json::Value;
use utoipa::OpenApi;
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

use crate::access::{Attempts, Places, Role, Sessions, Tokens};
use crate::board::Board;
use crate::settings::Source;

pub(crate) use problem::Problem;

/// What all requests share.
#[derive(Debug)]
pub(crate) struct Shared {
    pub tokens: Tokens,
    pub places: Places,
    /// Name of the cookie. Browsers send the cookies of a host to each of its ports, so each server has its own name.
    pub cookie: String,
    pub source: Source,
    /// What people call this server.
    pub name: Option<String>,
    /// Distinguishes this start from others.
    pub boot: String,
    /// Counts the stops that were requested.
    pub stops: AtomicU64,
    pub network: Network,
    pub board: Arc<Board>,
    pub sessions: Mutex<Sessions>,
    pub attempts: Mutex<Attempts>,
}

impl Shared {
    pub fn sessions(&self) -> MutexGuard<'_, Sessions> {
        self.sessions.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Returns what the holder of a token may do.
    pub fn try_token(&self, token: &str) -> Result<Role, Problem> {
        let mut attempts = self.attempts.lock().unwrap_or_else(PoisonError::into_inner);
        if !attempts.is_open(Instant::now()) {
            return Err(Problem::new(
                StatusCode::TOO_MANY_REQUESTS,
                "rate",
                "too many wrong tokens were tried: wait a second",
            ));
        }
        self.tokens.role(token).ok_or_else(|| {
            attempts.fail();
            Problem::new(
                StatusCode::UNAUTHORIZED,
                "token",
                "this is no token of this start: open the address that the server printed last",
            )
        })
    }
}

#[derive(OpenApi)]
#[openapi(info(
    title = "profidrive workbench",
    description = "What the page of the workbench uses, for programs too. A program sends its token in the header `Authorization: \
                   Bearer TOKEN`; a browser has a session.",
    license(name = "MIT OR Apache-2.0")
))]
struct Description;

fn routes() -> OpenApiRouter<Arc<Shared>> {
    OpenApiRouter::with_openapi(Description::openapi())
        .routes(routes!(server::server))
        .routes(routes!(server::stop))
        .routes(routes!(session::begin, session::session, session::end))
        .routes(routes!(stations::stations))
        .routes(routes!(drives::status))
        .routes(routes!(drives::info))
        .routes(routes!(drives::faults))
        .routes(routes!(virtual_drives::drives))
}

/// Returns the routes of the interface.
pub(crate) fn router() -> Router<Arc<Shared>> {
    routes().split_for_parts().0
}

/// Returns the description of the interface (OpenAPI) as JSON.
#[must_use]
pub fn openapi() -> String {
    let (_, description) = routes().split_for_parts();
    let mut description = serde_json::to_value(description).unwrap_or_default();
    let mut settings = SchemaSettings::draft2020_12();
    settings.definitions_path = "/components/schemas".into();
    let mut generator = settings.for_serialize().into_generator();
    generator.subschema_for::<server::ServerReport>();
    generator.subschema_for::<server::StoppedReport>();
    generator.subschema_for::<session::Login>();
    generator.subschema_for::<session::SessionReport>();
    generator.subschema_for::<stations::StationsReport>();
    generator.subschema_for::<StatusReport>();
    generator.subschema_for::<InfoReport>();
    generator.subschema_for::<FaultsReport>();
    generator.subschema_for::<virtual_drives::VirtualDrives>();
    generator.subschema_for::<problem::Body>();
    description["components"]["schemas"] = Value::Object(generator.take_definitions(true));
    let text = serde_json::to_string_pretty(&description).unwrap_or_default();
    text + "\n"
}

/// Answers a path of the interface that does not exist.
pub(crate) async fn nothing() -> Problem {
    Problem::new(StatusCode::NOT_FOUND, "path", "the interface has no such path")
}

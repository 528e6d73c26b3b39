//! The session of a browser.

use std::sync::Arc;
use std::time::Instant;

use axum::extract::rejection::JsonRejection;
use axum::extract::{Request, State};
use axum::http::header::SET_COOKIE;
use axum::http::{HeaderMap, StatusCode};
use axum::response::{IntoResponse, Response};
use axum::{Extension, Json};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::access::{Caller, IDLE, LIFETIME, Role, SESSIONS, session_of};
use crate::problem::Problem;
use crate::shared::Shared;

/// What begins a session.
#[derive(Debug, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct Login {
    /// The token of the address that the server printed.
    token: String,
    /// What the people of the session call themselves, for the log and for other pages: nothing verifies it. At most 40 characters
    /// are kept, and no control characters.
    #[serde(default)]
    name: Option<String>,
}

/// What the people of a session call themselves.
#[derive(Debug, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct ClaimedName {
    /// At most 40 characters are kept, and no control characters; an empty one is none. Nothing verifies it.
    name: String,
}

/// A session.
#[derive(Debug, Serialize, JsonSchema)]
pub(super) struct SessionReport {
    /// What it may do.
    role: Role,
    /// What its people call themselves, which nothing verifies.
    name: Option<String>,
    /// Seconds without a request after which it ends.
    idle: u64,
    /// Seconds after which it ends.
    lifetime: u64,
}

impl SessionReport {
    const fn new(role: Role, name: Option<String>) -> Json<Self> {
        Json(Self {
            role,
            name,
            idle: IDLE.as_secs(),
            lifetime: LIFETIME.as_secs(),
        })
    }
}

/// Begins a session; its identity is in a cookie that no script can read.
#[utoipa::path(post, path = "/api/v1/session", request_body(content = ref("#/components/schemas/Login"), content_type = "application/json"), responses(
    (status = 200, description = "The session", body = ref("#/components/schemas/SessionReport")),
    (status = 401, description = "No token of this start"),
    (status = 403, description = "Another origin"),
    (status = 429, description = "Too many tries or sessions"),
))]
pub(super) async fn begin(
    State(shared): State<Arc<Shared>>,
    headers: HeaderMap,
    login: Result<Json<Login>, JsonRejection>,
) -> Result<Response, Problem> {
    let Json(login) = login.map_err(|error| Problem::of_body(&error))?;
    let role = shared.try_login(&login.token)?;
    let before = session_of(&headers, &shared.cookie);
    let begun = shared.sessions().begin(role, before, Instant::now());
    let begun = begun
        .map_err(|error| Problem::new(StatusCode::INTERNAL_SERVER_ERROR, "local", &error.to_string()))?;
    let id = begun.ok_or_else(|| {
        let detail = format!("{SESSIONS} sessions are open, which is the most: end one of them");
        Problem::new(StatusCode::TOO_MANY_REQUESTS, "sessions", &detail)
    })?;
    let claimed = shared.sessions().claimed(&id).unwrap_or_default();
    let name = login.name.and_then(|name| claimed.claim(&name));
    let cookie = cookie(&shared, &id, LIFETIME.as_secs());
    Ok(([(SET_COOKIE, cookie)], SessionReport::new(role, name)).into_response())
}

fn cookie(shared: &Shared, id: &str, seconds: u64) -> String {
    let name = &shared.cookie;
    let secure = if shared.encrypted { "; Secure" } else { "" };
    format!("{name}={id}; Path=/; Max-Age={seconds}; HttpOnly; SameSite=Strict{secure}")
}

/// Returns the session of the caller.
#[utoipa::path(get, path = "/api/v1/session", responses(
    (status = 200, description = "The session", body = ref("#/components/schemas/SessionReport")),
))]
pub(super) async fn session(Extension(caller): Extension<Caller>) -> Json<SessionReport> {
    SessionReport::new(caller.role, caller.claimed.name())
}

/// Says what the people of the session of the caller call themselves. It stands in the log and beside what they control, marked as not
/// verified. A program with a token has no session, and no name.
#[utoipa::path(put, path = "/api/v1/session", request_body(content = ref("#/components/schemas/ClaimedName"), content_type = "application/json"), responses(
    (status = 200, description = "The session, with the name as it is kept", body = ref("#/components/schemas/SessionReport")),
    (status = 403, description = "Another origin"),
    (status = 409, description = "A program with a token has no session"),
))]
pub(super) async fn claim(
    Extension(caller): Extension<Caller>,
    wanted: Result<Json<ClaimedName>, JsonRejection>,
) -> Result<Json<SessionReport>, Problem> {
    let Json(wanted) = wanted.map_err(|error| Problem::of_body(&error))?;
    if caller.session.is_none() {
        let detail = "a program with a token has no session that could have a name: the log calls it `token`";
        return Err(Problem::new(StatusCode::CONFLICT, "session", detail));
    }
    let name = caller.claimed.claim(&wanted.name);
    Ok(SessionReport::new(caller.role, name))
}

/// Ends the session of the caller.
#[utoipa::path(delete, path = "/api/v1/session", responses(
    (status = 204, description = "Ended"),
    (status = 403, description = "Another origin"),
))]
pub(super) async fn end(
    State(shared): State<Arc<Shared>>,
    Extension(caller): Extension<Caller>,
    _: Request,
) -> Response {
    if let Some(id) = caller.session {
        shared.sessions().end(&id);
    }
    (StatusCode::NO_CONTENT, [(SET_COOKIE, cookie(&shared, "", 0))]).into_response()
}

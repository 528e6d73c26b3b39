//! Why a request failed.

use std::error::Error as _;
use std::iter::successors;

use axum::Json;
use axum::extract::rejection::JsonRejection;
use axum::http::StatusCode;
use axum::http::header::CONTENT_TYPE;
use axum::response::{IntoResponse, Response};
use profidrive::Explained;
use profidrive::client::ErrorKind;
use profidrive::report::Error;
use schemars::JsonSchema;
use serde::Serialize;

use crate::board::explained;

/// Why no drive answers.
pub(crate) const STANDS_STILL: &str =
    "the time of the plant stands still, so no drive answers: let it go on first";

/// Why a request failed, and the status of its answer.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Problem {
    status: StatusCode,
    error: Error,
}

/// Why a request failed (RFC 9457).
#[derive(Debug, Serialize, JsonSchema)]
#[schemars(rename = "Problem")]
pub(crate) struct Body {
    /// The status of the answer in words.
    title: &'static str,
    /// The status of the answer.
    status: u16,
    /// What was tried, on which drive and parameter, and what came back.
    detail: String,
    /// What kind of problem it is, what it lists, and what to do.
    #[serde(flatten)]
    error: Error,
}

impl Problem {
    /// Returns a problem of the access, or of the request itself.
    pub fn new(status: StatusCode, kind: &'static str, detail: &str) -> Self {
        let error = Error {
            kind,
            message: detail.to_owned(),
            details: Vec::new(),
            hint: None,
            actions: Vec::new(),
        };
        Self { status, error }
    }

    /// Returns the problem of a request without a session.
    pub fn no_session() -> Self {
        let detail = "there is no session: open the address that the server printed at its start";
        Self::new(StatusCode::UNAUTHORIZED, "session", detail)
    }

    /// Returns the problem of a body that is not what a request needs.
    pub fn of_body(error: &JsonRejection) -> Self {
        let causes = successors(error.source(), |cause| (*cause).source());
        let detail = causes.last().map_or_else(
            || error.body_text(),
            |cause| format!("the body is not what this request needs: {cause}"),
        );
        Self::new(error.status(), "body", &detail)
    }

    /// Returns the problem of a panic, which was printed.
    pub fn defect() -> Self {
        let detail = "the work ended by a defect of the server";
        Self::new(StatusCode::INTERNAL_SERVER_ERROR, "internal", detail)
    }

    /// Returns what it is without its status.
    pub const fn error(&self) -> &Error {
        &self.error
    }

    /// Returns what was tried and what came back.
    pub fn message(&self) -> &str {
        &self.error.message
    }

    /// Returns the problem of a drive.
    pub fn of(error: &impl Explained) -> Self {
        Self {
            status: status(error.kind()),
            error: explained(error),
        }
    }
}

/// The HTTP status of each kind of error.
const fn status(kind: ErrorKind) -> StatusCode {
    match kind {
        ErrorKind::Usage => StatusCode::BAD_REQUEST,
        ErrorKind::Refused | ErrorKind::Safety | ErrorKind::Fault | ErrorKind::NotReached => {
            StatusCode::CONFLICT
        }
        ErrorKind::Unreachable | ErrorKind::Lost => StatusCode::GATEWAY_TIMEOUT,
        ErrorKind::Unsupported => StatusCode::NOT_IMPLEMENTED,
        ErrorKind::Interrupted => StatusCode::SERVICE_UNAVAILABLE,
        _ => StatusCode::INTERNAL_SERVER_ERROR,
    }
}

impl IntoResponse for Problem {
    fn into_response(self) -> Response {
        let body = Body {
            title: self.status.canonical_reason().unwrap_or_default(),
            status: self.status.as_u16(),
            detail: self.error.message.clone(),
            error: self.error,
        };
        let media = [(CONTENT_TYPE, "application/problem+json")];
        (self.status, media, Json(body)).into_response()
    }
}

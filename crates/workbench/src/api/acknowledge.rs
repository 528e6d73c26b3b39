//! Acknowledging the faults of a drive.

use std::sync::Arc;

use axum::extract::rejection::JsonRejection;
use axum::extract::{Path, State};
use axum::{Extension, Json};
use profidrive::motion::{self, Control, Observer, Report};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::drives::find;
use crate::access::Caller;
use crate::act::{Intent, carry_out};
use crate::problem::Problem;
use crate::shared::Shared;

/// By what faults are acknowledged.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub(super) enum By {
    /// STW1 bit 7, for which this server connects to the drive as its controller for a moment.
    ControlWord,
    /// The parameter that the drive has for that, beside the controller that has it.
    Parameter,
}

/// How faults are acknowledged.
#[derive(Debug, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct Acknowledge {
    by: By,
}

/// Acknowledges the faults of a drive. It is not enabled, and nothing moves.
#[utoipa::path(post, path = "/api/v1/drives/{id}/acknowledge", request_body(content = ref("#/components/schemas/Acknowledge"), content_type = "application/json"), responses(
    (status = 200, description = "No fault is present", body = ref("#/components/schemas/MotionReport")),
    (status = 409, description = "A fault stays, or another controller has the drive"),
    (status = 503, description = "It cannot be logged"),
))]
pub(super) async fn acknowledge(
    State(shared): State<Arc<Shared>>,
    Extension(caller): Extension<Caller>,
    Path(id): Path<String>,
    wanted: Result<Json<Acknowledge>, JsonRejection>,
) -> Result<Json<Report>, Problem> {
    let Json(Acknowledge { by }) = wanted.map_err(|error| Problem::of_body(&error))?;
    let (mut network, mut drive) = find(&shared, &id).await?;
    let intent = Intent::of_drive("acknowledge", &id.to_lowercase(), None);
    let work = async move {
        let observer = Observer::default();
        let report = match by {
            By::ControlWord => {
                motion::acknowledge(&mut network, &mut drive, &Control::default(), &observer).await
            }
            By::Parameter => motion::acknowledge_by_parameter(&mut network, &mut drive, &observer).await,
        };
        report.map_err(|error| Problem::of(&error))
    };
    carry_out(shared, &caller, intent, work).await.map(Json)
}

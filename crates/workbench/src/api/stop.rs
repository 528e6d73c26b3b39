//! Stopping one drive, which this server need not control.

use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::time::Duration;

use axum::extract::{Path, State};
use axum::{Extension, Json};
use profidrive::motion::{self, StopReport};

use super::drives::find;
use crate::access::Caller;
use crate::act::{self, Intent};
use crate::problem::Problem;
use crate::shared::Shared;

/// How long a drive may take to come to rest before the answer is that it is not; a ramp that takes longer by its settings gets its
/// time.
const LIMIT: Duration = Duration::from_secs(10);

/// Stops one drive and waits until it is at rest: one that turns without a controller by its parameter or by its control word, as
/// `stop` of its station has it. A drive that this server controls is stopped by STOP, with all others that it controls. Each session may
/// do this, also one that is view-only; whoever stops a drive that is being stopped turns its ramp into its quick stop (OFF3), where it
/// is stopped by its control word, and gets the answer of that stop. A drive that another controller has is left alone: its next command
/// would take the stop back.
#[utoipa::path(post, path = "/api/v1/drives/{id}/stop", responses(
    (status = 200, description = "It is at rest", body = ref("#/components/schemas/StopReport")),
    (status = 403, description = "Another origin"),
    (status = 404, description = "No such drive"),
    (status = 409, description = "Another controller has the drive, it is in local operation, or it is not at rest"),
))]
pub(super) async fn stop_drive(
    State(shared): State<Arc<Shared>>,
    Extension(caller): Extension<Caller>,
    Path(id): Path<String>,
) -> Result<Json<StopReport>, Problem> {
    let id = id.to_lowercase();
    if shared.control.drives().contains(&id) {
        act::stop(&shared, &caller).await;
    }
    let (mut network, mut drive) = find(&shared, &id).await?;
    let mut stop = shared.control.stops.join(&id, |ended, again| {
        let (shared, id) = (Arc::clone(&shared), id.clone());
        let before = network.clone();
        network.hurry_with(move || again.load(Ordering::Relaxed) || before.hurry_requested());
        // it goes on when its page goes away
        tokio::spawn(async move {
            let stopped = motion::stop_unowned(&mut network, &mut drive, LIMIT).await;
            // one that was sent and did not bring the axis to rest is no stop of nothing
            let has_stopped = stopped.as_ref().is_ok_and(|report| report.sent.is_some());
            let stopped = stopped.and_then(|report| report.check().map(|()| report));
            let result = stopped.map_err(|error| Problem::of(&error));
            let intent = Intent::of_drive("stop", &id, None);
            let text = match &result {
                Ok(report) => report.to_string(),
                Err(problem) => problem.message().to_owned(),
            };
            // as each stop it is logged after it was done, whether that succeeds or not
            act::note_stopped(&shared, &caller, &intent, text, has_stopped).await;
            ended.send_replace(Some(result));
        });
    });
    let ended = stop.wait_for(Option::is_some).await.ok();
    let result = ended.and_then(|outcome| outcome.clone());
    result.unwrap_or_else(|| Err(Problem::defect())).map(Json)
}

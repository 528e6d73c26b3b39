//! Plans of changes: made, shown, carried out and undone.

use std::sync::Arc;

use axum::extract::rejection::JsonRejection;
use axum::extract::{Path, State};
use axum::http::StatusCode;
use axum::{Extension, Json};
use profidrive::client::backup::Pattern;
use profidrive::client::change::Choice;
use profidrive::parameters::{self, Write};
use profidrive::settings::{self, Restore};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::drives::find;
use crate::access::Caller;
use crate::act::{Intent, Outcome, carry_out_noted};
use crate::backups;
use crate::jobs::{Job, JobReport, Phase};
use crate::plan::{Planned, Refusal, Restoring, Wanted, assignments, refusal, refused};
use crate::problem::Problem;
use crate::shared::Shared;

/// Values in one plan.
const MOST: usize = 1000;

/// What is planned: values, or the settings of a file.
#[derive(Debug, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct NewPlan {
    /// The values, in the order of writing; empty for those of a file.
    #[serde(default)]
    changes: Vec<Wanted>,
    /// The file with the settings to restore, as `/api/v1/backups` calls it.
    #[serde(default)]
    file: Option<String>,
    /// Only these settings of the file: numbers, names or patterns (`DRV.*`); empty for all.
    #[serde(default)]
    settings: Vec<String>,
    /// Whether the settings of the connection are restored too: telegram, command source, way to get an address.
    #[serde(default)]
    network: bool,
    /// Whether the drive saves the new values over a power cycle.
    save: bool,
}

/// Plans changes. Nothing is written before the plan is applied.
#[utoipa::path(post, path = "/api/v1/drives/{id}/plans", request_body(content = ref("#/components/schemas/NewPlan"), content_type = "application/json"), responses(
    (status = 200, description = "The plan; `working` where it takes longer, then its job has it", body = ref("#/components/schemas/JobReport")),
    (status = 400, description = "Neither values nor a file, or too many values"),
    (status = 404, description = "No such drive has answered, or no such file"),
    (status = 409, description = "The file is of another kind of drive, or a controller has the drive"),
))]
pub(super) async fn plan(
    State(shared): State<Arc<Shared>>,
    Path(id): Path<String>,
    wanted: Result<Json<NewPlan>, JsonRejection>,
) -> Result<Json<JobReport>, Problem> {
    let Json(wanted) = wanted.map_err(|error| Problem::of_body(&error))?;
    let usage = |detail: &str| Problem::new(StatusCode::BAD_REQUEST, "usage", detail);
    if wanted.changes.len() > MOST {
        return Err(usage("a plan has at most 1000 values"));
    }
    if wanted.changes.is_empty() == wanted.file.is_none() {
        return Err(usage("a plan has either values or a file"));
    }
    // an unknown drive is no job
    drop(find(&shared, &id).await?);
    let job = shared
        .jobs
        .begin(Some(&id.to_lowercase()), shared.board.restarts());
    match wanted.file.clone() {
        None => job.run(plan_values(Arc::clone(&shared), Arc::clone(&job), id, wanted)),
        Some(file) => {
            let settings = backups::read(&shared, &file)?;
            let way_back = settings::way_back(&backups::path(&shared, &file)?)
                .ok_or_else(|| usage("there are too many files with the values before a restore"))?;
            let only = wanted.settings.iter().map(|text| text.parse::<Pattern>());
            let only = only
                .collect::<Result<Vec<_>, _>>()
                .map_err(|error| usage(&error.to_string()))?;
            let choice = Choice {
                only,
                network: wanted.network,
                ..Choice::default()
            };
            let restore = Restore {
                choice,
                save: wanted.save,
                ..Restore::default()
            };
            job.run(plan_restore(
                Arc::clone(&shared),
                Arc::clone(&job),
                id,
                file,
                settings,
                restore,
                way_back,
            ))
        }
    }
    job.settled().await.map(Json)
}

async fn plan_values(shared: Arc<Shared>, job: Arc<Job>, id: String, wanted: NewPlan) -> Result<(), Problem> {
    let (good, mut refusals) = assignments(&wanted.changes);
    let (mut network, mut drive) = find(&shared, &id).await?;
    let how = Write {
        save: wanted.save,
        dry_run: false,
        // the plan names it, and a person agrees to that
        beside_controller: true,
    };
    match parameters::plan(&mut network, &mut drive, &good, how).await {
        Ok(written) if refusals.is_empty() => {
            let planned = Planned::Write(Box::new(written));
            let (report, remarks) = (planned.report(&drive), planned.before());
            job.put(Phase::Planned, planned, report, remarks, None);
            return Ok(());
        }
        Ok(_) => {}
        Err(error) => {
            let wrong = parameters::objections(&mut network, &mut drive, &good).await;
            let wrong = wrong.map_err(|error| Problem::of(&error))?;
            let named = |place: usize| {
                good.get(place)
                    .map(|one| one.reference.to_string())
                    .unwrap_or_default()
            };
            let each: Vec<Refusal> = wrong
                .iter()
                .map(|(place, error)| refusal(&named(*place), error))
                .collect();
            if each.is_empty() && error.kind() != profidrive::client::ErrorKind::Usage {
                return Err(Problem::of(&error));
            }
            // what is wrong only with all of them together
            let together = each.is_empty().then(|| refusal("", &error));
            refusals.extend(each.into_iter().chain(together));
        }
    }
    job.end(|report| {
        report.phase = Phase::Planned;
        report.plan = Some(refused(refusals));
    });
    Ok(())
}

async fn plan_restore(
    shared: Arc<Shared>,
    job: Arc<Job>,
    id: String,
    file: String,
    settings: profidrive::client::backup::Backup,
    wanted: Restore,
    way_back: std::path::PathBuf,
) -> Result<(), Problem> {
    let (mut network, mut drive) = find(&shared, &id).await?;
    let progress = |done, total| job.progress(done, total);
    let plan = settings::plan_with(&mut network, &mut drive, &settings, &wanted, progress).await;
    let restoring = Restoring {
        plan: plan.map_err(|error| Problem::of(&error))?,
        file,
        settings,
        wanted,
        way_back,
    };
    let planned = Planned::Restore(Box::new(restoring));
    let (report, remarks) = (planned.report(&drive), planned.before());
    job.put(Phase::Planned, planned, report, remarks, None);
    Ok(())
}

/// Carries a plan out: writes its values, reads them back, and where that was planned lets the drive save them. Nothing is
/// written where the drive has other values now than the plan has as the old ones.
/// What a drive would lose at its next power cycle.
#[derive(Debug, Serialize, JsonSchema)]
pub(super) struct Unsaved {
    /// What this server has written since its start and the drive has not saved, as requests name it.
    parameters: Vec<String>,
}

/// Returns what this server has written to a drive that is not saved in it.
#[utoipa::path(get, path = "/api/v1/drives/{id}/unsaved", responses(
    (status = 200, description = "What was written and is not saved", body = ref("#/components/schemas/Unsaved")),
))]
pub(super) async fn unsaved(State(shared): State<Arc<Shared>>, Path(id): Path<String>) -> Json<Unsaved> {
    let parameters = shared.jobs.unsaved_of(&id.to_lowercase());
    Json(Unsaved { parameters })
}

#[utoipa::path(post, path = "/api/v1/plans/{id}/apply", params(("id" = u64, Path, description = "The plan")), responses(
    (status = 200, description = "What was written; `working` where it takes longer, then its job has it", body = ref("#/components/schemas/JobReport")),
    (status = 404, description = "No such plan"),
    (status = 409, description = "It was applied before, the drive has changed since, or the plant was started again"),
    (status = 503, description = "It cannot be logged"),
    (status = 504, description = "The drive does not answer"),
))]
pub(super) async fn apply(
    State(shared): State<Arc<Shared>>,
    Extension(caller): Extension<Caller>,
    Path(id): Path<u64>,
) -> Result<Json<JobReport>, Problem> {
    let job = shared.jobs.get(id)?;
    job.of_present(shared.board.restarts())?;
    let planned = job.take(Phase::Planned).ok_or_else(|| {
        let detail = "this plan is applied already, or has nothing that can be written";
        Problem::new(StatusCode::CONFLICT, "plan", detail)
    })?;
    let action = match &planned {
        Planned::Write(_) => "write",
        Planned::Restore(_) => "restore",
    };
    let after = Arc::clone(&job);
    job.run(worked(
        shared,
        caller,
        Arc::clone(&job),
        action,
        planned,
        async move |mut network, mut drive, planned: Planned| {
            let progress = |done| after.progress(done, 0);
            let done = planned.carry_out(&mut network, &mut drive, progress).await;
            done.map(|(planned, problem)| (drive, planned, Phase::Applied, problem))
        },
    ));
    job.settled().await.map(Json)
}

/// Writes the values before again, as far as they are known, and reads them back.
#[utoipa::path(post, path = "/api/v1/plans/{id}/undo", params(("id" = u64, Path, description = "The plan")), responses(
    (status = 200, description = "What was written; `working` where it takes longer, then its job has it", body = ref("#/components/schemas/JobReport")),
    (status = 404, description = "No such plan"),
    (status = 409, description = "It was not applied, is undone already, or the plant was started again"),
    (status = 503, description = "It cannot be logged"),
    (status = 504, description = "The drive does not answer"),
))]
pub(super) async fn undo(
    State(shared): State<Arc<Shared>>,
    Extension(caller): Extension<Caller>,
    Path(id): Path<u64>,
) -> Result<Json<JobReport>, Problem> {
    let job = shared.jobs.get(id)?;
    job.of_present(shared.board.restarts())?;
    let no_undo = || {
        let detail = "there is nothing to undo: the plan was not applied, is undone, or is of a file, whose values before are in a file too";
        Problem::new(StatusCode::CONFLICT, "plan", detail)
    };
    if job.report().plan.is_none_or(|plan| !plan.undo) {
        return Err(no_undo());
    }
    let planned = job.take(Phase::Applied).ok_or_else(no_undo)?;
    job.run(worked(
        shared,
        caller,
        Arc::clone(&job),
        "undo",
        planned,
        async |mut network, mut drive, planned: Planned| {
            let undone = match planned {
                Planned::Write(written) => parameters::undo(&mut network, &mut drive, &written).await,
                Planned::Restore(_) => return Err(Problem::defect()),
            };
            let undone = undone.map_err(|error| Problem::of(&error))?;
            Ok((drive, Planned::Write(Box::new(undone)), Phase::Undone, None))
        },
    ));
    job.settled().await.map(Json)
}

/// What became of a plan: its drive, itself, how far it is, and what ended it early.
type Worked = (profidrive::client::Drive, Planned, Phase, Option<Problem>);

/// Logs what a plan does, does it, and notes what became of it.
async fn worked<W, F>(
    shared: Arc<Shared>,
    caller: Caller,
    job: Arc<Job>,
    action: &'static str,
    planned: Planned,
    work: W,
) -> Result<(), Problem>
where
    W: FnOnce(profidrive::Caller, profidrive::client::Drive, Planned) -> F + Send + 'static,
    F: Future<Output = Result<Worked, Problem>> + Send,
{
    let id = job.report().drive.unwrap_or_default();
    let lock = shared.jobs.drive(&id);
    let _alone = lock.lock_owned().await;
    let (network, drive) = find(&shared, &id).await?;
    // the plant may have been started again while this waited
    job.of_present(shared.board.restarts())?;
    let intent = Intent {
        action,
        drive: Some(id.clone()),
        value: Some(count(planned.set().total())),
        changes: planned.lines(),
        ..Intent::default()
    };
    let (at, of) = (Arc::clone(&shared), id);
    let noted = async move {
        let (drive, planned, phase, problem) = work(network, drive, planned).await?;
        let outcome = Outcome {
            text: Some(match &problem {
                Some(problem) => format!("{}; {}", problem.message(), planned.set().summary()),
                None => planned.set().summary(),
            }),
            changes: planned.lines(),
        };
        let (report, remarks) = (planned.report(&drive), planned.after(&drive));
        at.jobs.note_written(&of, &report);
        job.put(phase, planned, report, remarks, problem);
        Ok(((), outcome))
    };
    carry_out_noted(shared, &caller, intent, noted).await
}

fn count(values: usize) -> String {
    match values {
        1 => "1 value".to_owned(),
        values => format!("{values} values"),
    }
}

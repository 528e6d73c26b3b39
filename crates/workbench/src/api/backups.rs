//! Settings of drives in files, and their comparison.

use std::sync::Arc;

use axum::Json;
use axum::extract::rejection::JsonRejection;
use axum::extract::{Path, State};
use axum::http::StatusCode;
use axum::http::header::{CONTENT_DISPOSITION, CONTENT_TYPE};
use axum::response::{IntoResponse, Response};
use profidrive::client::backup::Backup;
use profidrive::report::DiffReport;
use profidrive::settings::{self, Comparison, as_delivered, as_in};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::drives::find;
use crate::backups::{self, KeptBackup};
use crate::blocking::blocking;
use crate::jobs::{Job, JobReport};
use crate::problem::Problem;
use crate::query::Query;
use crate::shared::Shared;
use crate::words::PageWords;

/// The files with settings.
#[derive(Debug, Serialize, JsonSchema)]
pub(super) struct BackupsReport {
    /// The newest first.
    files: Vec<KeptBackup>,
}

/// A file to keep.
#[derive(Debug, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct NewBackup {
    /// Its content.
    text: String,
}

/// The name of a file.
#[derive(Debug, Serialize, JsonSchema)]
pub(super) struct BackupName {
    file: String,
}

/// One side of a comparison.
#[derive(Debug, Clone, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub(super) enum Source {
    /// A drive, as it is called in paths.
    Drive(String),
    /// A file, as `/api/v1/backups` calls it.
    File(String),
    /// What a drive, as it is called in paths, has as delivered.
    Delivered(String),
}

/// What is compared. Of a drive beside a file, or beside values as delivered, only what those have is read.
#[derive(Debug, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct Compare {
    left: Source,
    right: Source,
}

/// Lists the files with settings that this server keeps.
#[utoipa::path(get, path = "/api/v1/backups", responses(
    (status = 200, description = "The files", body = ref("#/components/schemas/BackupsReport")),
))]
pub(super) async fn kept(State(shared): State<Arc<Shared>>) -> Result<Json<BackupsReport>, Problem> {
    let files = blocking(move || Ok(backups::list(&shared))).await?;
    Ok(Json(BackupsReport { files }))
}

/// Keeps a file, under a name that this server makes.
#[utoipa::path(post, path = "/api/v1/backups", request_body(content = ref("#/components/schemas/NewBackup"), content_type = "application/json"), responses(
    (status = 200, description = "Its name", body = ref("#/components/schemas/BackupName")),
    (status = 400, description = "It is no backup, or not a whole one"),
    (status = 503, description = "There is no folder for it"),
))]
pub(super) async fn upload(
    State(shared): State<Arc<Shared>>,
    wanted: Result<Json<NewBackup>, JsonRejection>,
) -> Result<Json<BackupName>, Problem> {
    let Json(NewBackup { text }) = wanted.map_err(|error| Problem::of_body(&error))?;
    let backup = Backup::read(text).map_err(|error| {
        let lines: Vec<String> = error.problems.iter().take(5).map(ToString::to_string).collect();
        let detail = format!("this is no whole backup: {}", lines.join("; "));
        Problem::new(StatusCode::BAD_REQUEST, "file", &detail)
    })?;
    let file = blocking(move || {
        let label = format!("uploaded-{}", backup.header.station);
        backups::keep(&shared, &backup, &label)
    });
    Ok(Json(BackupName { file: file.await? }))
}

/// Returns a file as it is.
#[utoipa::path(get, path = "/api/v1/backups/{file}", params(("file" = String, Path, description = "The name of the file")), responses(
    (status = 200, description = "The text of the file", body = String, content_type = "text/plain"),
    (status = 404, description = "No such file"),
))]
pub(super) async fn backup(
    State(shared): State<Arc<Shared>>,
    Path(name): Path<String>,
) -> Result<Response, Problem> {
    let text = blocking(move || {
        let path = backups::path(&shared, &name)?;
        let text = std::fs::read(&path).map_err(|error| {
            Problem::new(
                StatusCode::INTERNAL_SERVER_ERROR,
                "local",
                &format!("cannot read {name}: {error}"),
            )
        })?;
        Ok((text, name))
    });
    let (text, name) = text.await?;
    let headers = [
        (CONTENT_TYPE, "text/plain; charset=utf-8".to_owned()),
        (CONTENT_DISPOSITION, format!("attachment; filename=\"{name}\"")),
    ];
    Ok((headers, text).into_response())
}

/// Saves all settings of a drive in a file.
#[utoipa::path(post, path = "/api/v1/drives/{id}/backups", responses(
    (status = 200, description = "The job, with the name of the file; `working` where it takes longer", body = ref("#/components/schemas/JobReport")),
    (status = 503, description = "There is no folder for it"),
))]
pub(super) async fn back_up(
    State(shared): State<Arc<Shared>>,
    Path(id): Path<String>,
) -> Result<Json<JobReport>, Problem> {
    let (mut network, mut drive) = find(&shared, &id).await?;
    let job = shared
        .jobs
        .begin(Some(&id.to_lowercase()), shared.board.restarts());
    let work = Arc::clone(&job);
    job.run(async move {
        let progress = |done, total| work.progress(done, total);
        let saved = settings::backup(&mut network, &mut drive, progress).await;
        let saved = saved.map_err(|error| Problem::of(&error))?.report;
        let missing = settings::missing(&saved);
        let label = drive.label();
        let file = blocking(move || backups::keep(&shared, &saved, &label)).await?;
        work.end(|report| {
            report.file = Some(file);
            report
                .remarks
                .extend((!missing.is_nothing()).then(|| missing.to_string()));
        });
        Ok(())
    });
    job.settled().await.map(Json)
}

/// Compares the settings of drives and files.
#[utoipa::path(post, path = "/api/v1/compare", request_body(content = ref("#/components/schemas/Compare"), content_type = "application/json"), responses(
    (status = 200, description = "The job, with what differs; `working` where it takes longer", body = ref("#/components/schemas/JobReport")),
    (status = 400, description = "Two kinds of drives, or no backup"),
    (status = 404, description = "No such drive has answered, or no such file"),
    (status = 504, description = "A drive does not answer"),
))]
pub(super) async fn compare(
    State(shared): State<Arc<Shared>>,
    wanted: Result<Json<Compare>, JsonRejection>,
) -> Result<Json<JobReport>, Problem> {
    let Json(Compare { left, right }) = wanted.map_err(|error| Problem::of_body(&error))?;
    let job = shared.jobs.begin(None, shared.board.restarts());
    let work = Arc::clone(&job);
    job.run(async move {
        let sides = match (known(&shared, &left).await?, known(&shared, &right).await?) {
            (Ok(left), Ok(right)) => (left, right),
            (Ok(known), Err(id)) => {
                let drive = like(&shared, id, &known).await?;
                (known, drive)
            }
            (Err(id), Ok(known)) => (like(&shared, id, &known).await?, known),
            (Err(a), Err(b)) => {
                let left = whole(&shared, a, &work).await?;
                let right = like(&shared, b, &left).await?;
                (left, right)
            }
        };
        let (a, b) = (&sides.0, &sides.1);
        let comparison = Comparison::new(a, b).map_err(|error| Problem::of(&error))?;
        let called = |id: &str| {
            let name = shared.board.name(&id.to_lowercase());
            name.unwrap_or_else(|| id.to_owned())
        };
        let names = [&left, &right].map(|side| match side {
            Source::File(file) => file.clone(),
            Source::Drive(id) => called(id),
            Source::Delivered(id) => format!("{} as delivered", called(id)),
        });
        let mut remarks: Vec<String> = a
            .header
            .differences(&b.header)
            .iter()
            .map(|one| {
                format!(
                    "{}: {} on the left, {} on the right",
                    one.what, one.left, one.right
                )
            })
            .collect();
        for (name, why) in names.iter().zip(comparison.tasks_left_out()) {
            remarks.extend(
                why.map(|why| format!("motion tasks are not compared: they are left out of {name}: {why}")),
            );
        }
        let [left, right] = &names;
        let differences = comparison.report(left, right, &PageWords);
        work.end(|report| {
            report.differences = Some(differences);
            report.remarks = remarks;
        });
        Ok(())
    });
    job.settled().await.map(Json)
}

/// Returns the settings of a side that are known without reading them from a drive, else which drive they are of.
async fn known<'s>(shared: &Shared, side: &'s Source) -> Result<Result<Backup, &'s str>, Problem> {
    Ok(match side {
        Source::Drive(id) => Err(id),
        Source::File(file) => Ok(backups::read(shared, file)?),
        Source::Delivered(id) => {
            let (mut network, mut drive) = find(shared, id).await?;
            let delivered = as_delivered(&mut network, &mut drive).await;
            Ok(delivered.map_err(|error| Problem::of(&error))?)
        }
    })
}

/// Reads which settings of a drive differ from those as delivered, or of a file, on the left.
#[utoipa::path(get, path = "/api/v1/drives/{id}/changed", params(
    ("file" = Option<String>, Query, description = "The file, as `/api/v1/backups` calls it; as delivered where there is none"),
), responses(
    (status = 200, description = "What differs", body = ref("#/components/schemas/DiffReport")),
    (status = 400, description = "The file is of another kind of drive, or no backup"),
    (status = 404, description = "No such drive has answered, or no such file"),
    (status = 501, description = "No value as delivered is known of this model"),
))]
pub(super) async fn changed(
    State(shared): State<Arc<Shared>>,
    Path(id): Path<String>,
    query: Query,
) -> Result<Json<DiffReport>, Problem> {
    let (mut network, mut drive) = find(&shared, &id).await?;
    let before = match query.text("file") {
        Some(file) => backups::read(&shared, file)?,
        None => {
            let delivered = as_delivered(&mut network, &mut drive).await;
            delivered.map_err(|error| Problem::of(&error))?
        }
    };
    let present = as_in(&mut network, &mut drive, &before).await;
    let present = present.map_err(|error| Problem::of(&error))?;
    let comparison = Comparison::new(&before, &present).map_err(|error| Problem::of(&error))?;
    Ok(Json(comparison.report(
        query.text("file").unwrap_or("as delivered"),
        &drive.label(),
        &PageWords,
    )))
}

/// Reads all settings of a drive.
async fn whole(shared: &Shared, id: &str, job: &Job) -> Result<Backup, Problem> {
    let (mut network, mut drive) = find(shared, id).await?;
    let saved = settings::backup(&mut network, &mut drive, |done, total| job.progress(done, total)).await;
    Ok(saved.map_err(|error| Problem::of(&error))?.report)
}

/// Reads what these settings have of a drive.
async fn like(shared: &Shared, id: &str, settings: &Backup) -> Result<Backup, Problem> {
    let (mut network, mut drive) = find(shared, id).await?;
    let read = as_in(&mut network, &mut drive, settings).await;
    read.map_err(|error| Problem::of(&error))
}

/// Returns how far a job is.
#[utoipa::path(get, path = "/api/v1/jobs/{id}", params(("id" = u64, Path, description = "The job")), responses(
    (status = 200, description = "The job; what ended it early is in it", body = ref("#/components/schemas/JobReport")),
    (status = 404, description = "No such job"),
))]
pub(super) async fn job(
    State(shared): State<Arc<Shared>>,
    Path(id): Path<u64>,
) -> Result<Json<JobReport>, Problem> {
    Ok(Json(shared.jobs.get(id)?.report()))
}

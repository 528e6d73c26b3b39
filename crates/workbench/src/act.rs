//! What changes something: logged before and after, reported to all pages.

use std::future::Future;
use std::sync::Arc;
use std::time::Instant;

use axum::http::StatusCode;

use crate::access::Caller;
use crate::api::LogTopic;
use crate::audit::{AuditError, Record};
use crate::control::{StopFrame, Stopped, Stopping};
use crate::live::{Event, Topic};
use crate::problem::Problem;
use crate::shared::Shared;

/// Something that a person or program wants.
#[derive(Debug, Clone, Default)]
pub(crate) struct Intent {
    /// What is done.
    pub action: &'static str,
    /// The drive, as it is called in paths.
    pub drive: Option<String>,
    /// With which values.
    pub value: Option<String>,
    /// Each value that is changed, in one line.
    pub changes: Vec<String>,
    /// The drives of something that is of more than one.
    pub drives: Vec<String>,
}

/// Who wants something, and from where.
#[derive(Debug, Clone)]
pub(crate) struct Author {
    pub who: String,
    pub claimed_name: Option<String>,
    pub address: Option<String>,
}

impl Author {
    pub fn caller(caller: &Caller) -> Self {
        Self {
            who: caller.who.clone(),
            claimed_name: caller.claimed.name(),
            address: caller.address.clone(),
        }
    }
}

impl Intent {
    /// Something that is of no drive.
    pub const fn new(action: &'static str, value: Option<String>) -> Self {
        Self {
            action,
            drive: None,
            value,
            changes: Vec::new(),
            drives: Vec::new(),
        }
    }

    /// Something that changes no value of a drive that is called so in paths.
    pub fn of_drive(action: &'static str, drive: &str, value: Option<String>) -> Self {
        Self {
            drive: Some(drive.to_owned()),
            ..Self::new(action, value)
        }
    }

    fn record(&self, shared: &Shared, author: Author) -> Record {
        let drive = self.drive.as_ref();
        Record {
            who: author.who,
            claimed_name: author.claimed_name,
            address: author.address,
            drive: self.drive.clone(),
            name: drive.and_then(|id| shared.board.name(id)),
            serial: drive.and_then(|id| shared.board.serial(id)),
            action: self.action,
            value: self.value.clone(),
            changes: self.changes.clone(),
            drives: self.drives.clone(),
            result: None,
            ..Record::default()
        }
    }

    fn record_of(&self, shared: &Shared, caller: &Caller) -> Record {
        self.record(shared, Author::caller(caller))
    }
}

/// Writes the intent, works, and writes what became of it. The work goes on when the page that wants it goes away.
///
/// # Errors
/// When the intent cannot be written, and what the work returns.
pub(crate) async fn carry_out<T: Send + 'static>(
    shared: Arc<Shared>,
    caller: &Caller,
    intent: Intent,
    work: impl Future<Output = Result<T, Problem>> + Send + 'static,
) -> Result<T, Problem> {
    let work = async move { work.await.map(|done| (done, Outcome::default())) };
    carry_out_noted(shared, caller, intent, work).await
}

/// What became of something, for the log.
#[derive(Debug, Default)]
pub(crate) struct Outcome {
    /// In one sentence; nothing where it was done as wanted.
    pub text: Option<String>,
    /// Each value that was changed, and what became of it.
    pub changes: Vec<String>,
}

/// The same with words for what became of it.
///
/// # Errors
/// As [`carry_out`].
pub(crate) async fn carry_out_noted<T: Send + 'static>(
    shared: Arc<Shared>,
    caller: &Caller,
    intent: Intent,
    work: impl Future<Output = Result<(T, Outcome), Problem>> + Send + 'static,
) -> Result<T, Problem> {
    let record = intent.record_of(&shared, caller);
    let done = tokio::spawn(async move {
        write(&shared, record.clone())
            .await
            .map_err(|error| unlogged(&error))?;
        let result = work.await;
        let failed = result.is_err();
        let (result, outcome) = match result {
            Ok((done, outcome)) => (Ok(done), outcome),
            Err(problem) => {
                let text = Some(problem.message().to_owned());
                let changes = Vec::new();
                (Err(problem), Outcome { text, changes })
            }
        };
        let text = outcome.text.unwrap_or_else(|| "done".to_owned());
        let changes = outcome.changes;
        noted(&shared, Record { changes, ..record }, text, failed).await;
        result
    });
    done.await.unwrap_or_else(|_| Err(Problem::defect()))
}

/// Writes the intent of something that is carried out next.
///
/// # Errors
/// When it cannot be written: then nothing may be done.
pub(crate) async fn begin(shared: &Shared, caller: &Caller, intent: &Intent) -> Result<(), Problem> {
    let written = write(shared, intent.record_of(shared, caller)).await;
    written.map_err(|error| unlogged(&error))
}

/// Writes what became of something that is no news for other pages: what moves an axis is shown by its values.
pub(crate) async fn noted_quietly(shared: &Shared, caller: &Caller, intent: &Intent, result: String) {
    let record = Record {
        result: Some(result),
        ..intent.record_of(shared, caller)
    };
    written(shared, record).await;
}

/// Stops every axis, and returns once the frames with that have left or do not. It is reported and logged whether the caller waits
/// or not.
pub(crate) async fn stop(shared: &Arc<Shared>, caller: &Caller) -> Stopped {
    let stopping = shared.control.stop(&caller.who, caller.claimed.name());
    confirm_stop(shared, caller, stopping).await
}

/// Reports and logs a STOP that was posted, once it is known what became of it.
pub(crate) async fn confirm_stop(shared: &Arc<Shared>, caller: &Caller, stopping: Stopping) -> Stopped {
    let unconfirmed = stopping.unconfirmed();
    let (shared, caller) = (Arc::clone(shared), caller.clone());
    let confirmed = tokio::spawn(async move {
        let stopped = stopping.confirmed().await;
        shared.control.report_stopped(&stopped);
        note_stop(&shared, &caller, &stopped).await;
        stopped
    });
    // a panic was printed: the STOP was posted before it, and nothing confirms it
    confirmed.await.unwrap_or(unconfirmed)
}

/// Writes a STOP, and reports it to all pages, after it was carried out.
async fn note_stop(shared: &Shared, caller: &Caller, stopped: &Stopped) {
    let drives = stopped.axes.iter().map(|axis| axis.drive().to_owned()).collect();
    let intent = Intent {
        drives,
        ..Intent::new("stop", None)
    };
    let named = |id: &str| shared.board.name(id).unwrap_or_else(|| id.to_owned());
    let axes: Vec<String> = stopped
        .axes
        .iter()
        .map(|axis| axis.words(&named(axis.drive())))
        .collect();
    let axes = match axes.as_slice() {
        [] => "no axis is under control".to_owned(),
        axes => axes.join("; "),
    };
    let text = format!("STOP {}: {axes}", stopped.epoch);
    let ended = stopped.axes.iter().any(StopFrame::ends_operation);
    note_stopped(shared, caller, &intent, text, ended).await;
}

/// Writes a stop that was carried out. `ended`: it ended a motion or an operation, or it may have. Of others, which each session can
/// request without end, a flood is counted instead.
pub(crate) async fn note_stopped(
    shared: &Shared,
    caller: &Caller,
    intent: &Intent,
    text: String,
    ended: bool,
) {
    let left_out = match ended {
        true => Some(0),
        false => shared.idle_stops().admit(Instant::now()),
    };
    let text = match left_out {
        None => return,
        Some(0) => text,
        Some(more) => {
            format!("{text} ({more} stops of nothing that moved, before this one, are not in the log)")
        }
    };
    note(shared, caller, intent, text).await;
}

/// Writes that something was refused, behind the refusal. A flood of refusals is counted instead. Where the log cannot be written the
/// refusal stands alone: nothing was done.
pub(crate) fn note_refusal(shared: &Arc<Shared>, author: Author, intent: Intent, reason: &str) {
    let Some(left_out) = shared.refusals().admit(Instant::now()) else {
        return;
    };
    let result = match left_out {
        0 => format!("refused: {reason}"),
        more => format!("refused: {reason} ({more} refusals before this one are not in the log)"),
    };
    let shared = Arc::clone(shared);
    tokio::spawn(async move {
        let record = Record {
            result: Some(result),
            ..intent.record(&shared, author)
        };
        let _ = write(&shared, record).await;
    });
}

/// Writes what was done without an intent, and reports it to all pages.
pub(crate) async fn note(shared: &Shared, caller: &Caller, intent: &Intent, result: String) {
    noted(shared, intent.record_of(shared, caller), result, false).await;
}

async fn noted(shared: &Shared, record: Record, result: String, failed: bool) {
    shared.hub.report(&Event {
        kind: record.action,
        drive: record.drive.clone(),
        who: record.who.clone(),
        claimed_name: record.claimed_name.clone(),
        text: match &record.value {
            Some(value) => format!("{value}: {result}"),
            None => result.clone(),
        },
        failed,
    });
    let record = Record {
        result: Some(result),
        ..record
    };
    written(shared, record).await;
}

async fn written(shared: &Shared, record: Record) {
    // it was done: that it is not in the log is to be seen
    if let Err(error) = write(shared, record).await {
        shared.hub.report(&Event {
            kind: "log",
            drive: None,
            who: String::new(),
            claimed_name: None,
            text: error.to_string(),
            failed: true,
        });
    }
}

async fn write(shared: &Shared, record: Record) -> Result<(), AuditError> {
    let audit = Arc::clone(&shared.audit);
    let record = Record {
        engine_us: shared.network.now().as_nanos() / 1000,
        epoch: shared.control.stops(),
        ..record
    };
    // a disk may take its time
    let written = tokio::task::spawn_blocking(move || audit.write(&record)).await;
    written.unwrap_or(Err(AuditError::NoFolder))?;
    let records = shared.audit.written();
    shared.hub.publish(&Topic::Log, &LogTopic { records });
    Ok(())
}

fn unlogged(error: &AuditError) -> Problem {
    let detail = format!("nothing was changed, because it cannot be logged: {error}");
    Problem::new(StatusCode::SERVICE_UNAVAILABLE, "log", &detail)
}

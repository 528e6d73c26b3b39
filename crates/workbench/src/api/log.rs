//! The log of what people did.

use std::io;
use std::sync::Arc;

use axum::Json;
use axum::body::{Body, Bytes};
use axum::extract::State;
use axum::http::StatusCode;
use axum::http::header::{CONTENT_DISPOSITION, CONTENT_TYPE};
use axum::response::{IntoResponse, Response};
use futures::stream;
use schemars::JsonSchema;
use serde::Serialize;
use tokio::sync::mpsc;

use crate::audit::{LogPage, LogRecord, Wanted};
use crate::blocking::blocking;
use crate::problem::Problem;
use crate::query::Query;
use crate::shared::Shared;

/// Records of a page where a request has no number, and the most.
const RECORDS: usize = 100;
const MOST: usize = 1000;
/// Octets that are collected before they are sent.
const CHUNK: usize = 64 << 10;
/// Chunks that wait for a reader that is slow.
const CHUNKS: usize = 4;

/// The first row of the log as CSV. Programs read its columns by place: a new one is behind the others.
const HEAD: &str =
    "time,who,drive,name,action,value,changes,result,serial,engine_us,epoch,claimed_name,address\r\n";

/// How many records there are.
#[derive(Debug, Serialize, JsonSchema)]
pub(crate) struct LogTopic {
    /// Written since the start of this server.
    pub records: u64,
}

fn wanted(query: &Query) -> Wanted {
    let text = |name| query.text(name).map(str::to_lowercase);
    Wanted {
        drive: text("drive"),
        action: text("action"),
        text: text("text"),
    }
}

fn failed(error: &io::Error) -> Problem {
    let detail = format!("cannot read the log: {error}");
    Problem::new(StatusCode::INTERNAL_SERVER_ERROR, "log", &detail)
}

/// Returns records of the log, the newest first.
#[utoipa::path(get, path = "/api/v1/audit", params(
    ("drive" = Option<String>, Query, description = "Only those of this drive, as it is called in paths"),
    ("action" = Option<String>, Query, description = "Only those of this action"),
    ("text" = Option<String>, Query, description = "Only those with this text anywhere"),
    ("before" = Option<String>, Query, description = "Those before a place that an earlier page gave"),
    ("most" = Option<usize>, Query, description = "At most so many: 100 where it is not given, at most 1000"),
), responses(
    (status = 200, description = "The records", body = ref("#/components/schemas/LogPage")),
    (status = 400, description = "A value that is not valid"),
))]
pub(super) async fn audit(State(shared): State<Arc<Shared>>, query: Query) -> Result<Json<LogPage>, Problem> {
    let most = query.parsed("most")?.unwrap_or(RECORDS).clamp(1, MOST);
    let log = Arc::clone(&shared.audit);
    let page = blocking(move || {
        let page = log.page(&wanted(&query), query.text("before"), most);
        page.map_err(|error| failed(&error))
    });
    page.await.map(Json)
}

/// Returns all records as JSON Lines, the oldest first.
#[utoipa::path(get, path = "/api/v1/logs/log.jsonl", params(
    ("drive" = Option<String>, Query, description = "Only those of this drive, as it is called in paths"),
    ("action" = Option<String>, Query, description = "Only those of this action"),
    ("text" = Option<String>, Query, description = "Only those with this text anywhere"),
), responses(
    (status = 200, description = "The records, each in a line", body = String, content_type = "application/jsonl"),
))]
pub(super) async fn log_lines(State(shared): State<Arc<Shared>>, query: Query) -> Response {
    let head = String::new();
    file(
        shared,
        &query,
        "log.jsonl",
        "application/jsonl",
        head,
        |line, _| format!("{line}\n"),
    )
}

/// Returns all records as CSV, the oldest first. A text that a spreadsheet would take as a formula has a `'` before it.
#[utoipa::path(get, path = "/api/v1/logs/log.csv", params(
    ("drive" = Option<String>, Query, description = "Only those of this drive, as it is called in paths"),
    ("action" = Option<String>, Query, description = "Only those of this action"),
    ("text" = Option<String>, Query, description = "Only those with this text anywhere"),
), responses(
    (status = 200, description = "The records, each in a row", body = String, content_type = "text/csv"),
))]
pub(super) async fn log_table(State(shared): State<Arc<Shared>>, query: Query) -> Response {
    let head = HEAD.to_owned();
    file(
        shared,
        &query,
        "log.csv",
        "text/csv; charset=utf-8",
        head,
        |_, record| row(record),
    )
}

/// Sends what `each` makes of the records, as fast as its reader takes it.
fn file(
    shared: Arc<Shared>,
    query: &Query,
    name: &str,
    kind: &'static str,
    head: String,
    each: fn(&str, &LogRecord) -> String,
) -> Response {
    let (chunks, receiver) = mpsc::channel::<Result<Bytes, io::Error>>(CHUNKS);
    let wanted = wanted(query);
    tokio::task::spawn_blocking(move || {
        let mut text = head;
        let mut turn = Some(shared.audit.turn());
        let read = shared.audit.each(&wanted, &mut |line, record| {
            text += &each(line, record);
            if text.len() < CHUNK {
                return true;
            }
            // a slow reader keeps the turn from no other one, and one that is gone ends it
            turn = None;
            let taken = chunks.blocking_send(Ok(std::mem::take(&mut text).into())).is_ok();
            turn = Some(shared.audit.turn());
            taken
        });
        drop(turn);
        let _ = chunks.blocking_send(Ok(text.into()));
        if let Err(error) = read {
            let _ = chunks.blocking_send(Err(error));
        }
    });
    let body = stream::unfold(receiver, async |mut receiver| {
        let chunk = receiver.recv().await?;
        Some((chunk, receiver))
    });
    let headers = [
        (CONTENT_TYPE, kind.to_owned()),
        (CONTENT_DISPOSITION, format!("attachment; filename=\"{name}\"")),
    ];
    (headers, Body::from_stream(body)).into_response()
}

fn row(record: &LogRecord) -> String {
    let of = |text: &Option<String>| cell(text.as_deref().unwrap_or_default());
    // older versions did not write them
    let number = |number: Option<u64>| number.map_or_else(String::new, |number| number.to_string());
    let cells = [
        cell(&record.time),
        cell(&record.who),
        cell(record.drive.as_deref().unwrap_or(&record.drives.join(" "))),
        of(&record.name),
        cell(&record.action),
        of(&record.value),
        cell(&record.changes.join("; ")),
        of(&record.result),
        of(&record.serial),
        number(record.engine_us),
        number(record.epoch),
        of(&record.claimed_name),
        of(&record.address),
    ];
    cells.join(",") + "\r\n"
}

/// Returns a cell that no spreadsheet takes as a formula. Numbers are as they are.
fn cell(text: &str) -> String {
    let is_formula = text.starts_with(['=', '+', '-', '@', '\t', '\r']) && text.parse::<f64>().is_err();
    let prefix = if is_formula { "'" } else { "" };
    if text.contains([',', '"', '\n', '\r']) {
        format!("\"{prefix}{}\"", text.replace('"', "\"\""))
    } else {
        format!("{prefix}{text}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_row_has_every_field_of_a_record_that_is_for_people() {
        let record = LogRecord {
            time: "2026-01-02T03:04:05.678Z".to_owned(),
            boot: "b".to_owned(),
            who: "3".to_owned(),
            claimed_name: Some("=Anna, shift 2".to_owned()),
            address: Some("192.168.0.9".to_owned()),
            drive: Some("02:00:00:00:00:01".to_owned()),
            name: Some("axis-1".to_owned()),
            serial: Some("S-1".to_owned()),
            engine_us: Some(12_345),
            epoch: Some(2),
            action: "write".to_owned(),
            value: Some("1".to_owned()),
            changes: vec!["a".to_owned(), "b".to_owned()],
            drives: Vec::new(),
            result: Some("done".to_owned()),
        };
        assert_eq!(
            row(&record),
            "2026-01-02T03:04:05.678Z,3,02:00:00:00:00:01,axis-1,write,1,a; b,done,S-1,12345,2,\"'=Anna, shift 2\",192.168.0.9\r\n"
        );
        assert_eq!(HEAD.split(',').count(), 13);
        let older = LogRecord {
            claimed_name: None,
            address: None,
            serial: None,
            engine_us: None,
            epoch: None,
            ..record
        };
        assert!(row(&older).ends_with(",done,,,,,\r\n"), "{}", row(&older));
    }

    #[test]
    fn no_cell_is_a_formula_and_numbers_are_untouched() {
        for (text, shown) in [
            ("axis-1", "axis-1"),
            ("=1+1", "'=1+1"),
            ("+cmd", "'+cmd"),
            ("-50 rpm", "'-50 rpm"),
            ("-50", "-50"),
            ("+1.5", "+1.5"),
            ("@SUM(A1)", "'@SUM(A1)"),
            ("\t=1", "'\t=1"),
            ("a,b", "\"a,b\""),
            ("=a,\"b\"", "\"'=a,\"\"b\"\"\""),
            ("two\nlines", "\"two\nlines\""),
        ] {
            assert_eq!(cell(text), shown);
        }
    }
}

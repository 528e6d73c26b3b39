//! Files of recordings. What was written is readable after a kill and on a full disk.
//!
//! CSV and Arrow streams grow line by line and batch by batch. Parquet and Arrow files end with a table of contents: such a
//! file is an Arrow stream `NAME.part` as long as it grows, and is made of that when it is complete.

use std::fs::{self, File, OpenOptions};
use std::io::{self, BufReader, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::time::Duration;

use arrow_array::RecordBatch;
use arrow_ipc::reader::StreamReader;
use arrow_ipc::writer::{FileWriter, StreamWriter};
use arrow_schema::ArrowError;
use arrow_select::concat::concat_batches;
use parquet::arrow::ArrowWriter;

use super::batch::Batch;
use super::csv::CsvLines;
use super::error::{PART, WriteError};
use super::table::{Row, Sink, Table};

/// Rows are written at least this often.
const WRITTEN: Duration = Duration::from_secs(1);
/// Rows that wait to be written at most.
const MOST_WAITING: usize = 8192;
/// Rows that stand together in a complete file of columns.
const GROUP: usize = 65_536;

/// The form of a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Form {
    /// Text, one line for each row.
    Csv,
    /// Apache Arrow, a stream: readable as long as it grows.
    ArrowStream,
    /// Apache Arrow, a file with a table of contents.
    Arrow,
    /// Apache Parquet.
    Parquet,
}

/// The ends of names of files, and what they mean.
const ENDS: [(&str, Form); 5] = [
    ("csv", Form::Csv),
    ("arrows", Form::ArrowStream),
    ("arrow", Form::Arrow),
    ("feather", Form::Arrow),
    ("parquet", Form::Parquet),
];

impl Form {
    /// Returns the form that the end of a name means: `csv`, `arrows`, `arrow`, `feather` or `parquet`.
    #[must_use]
    pub fn of(file: &Path) -> Option<Self> {
        let end = file.extension()?.to_str()?;
        let known = ENDS.iter().find(|(known, _)| known.eq_ignore_ascii_case(end));
        known.map(|(_, form)| *form)
    }

    /// Returns the ends of names that have a form.
    pub fn ends() -> impl Iterator<Item = &'static str> {
        ENDS.iter().map(|(end, _)| *end)
    }
}

/// When a file is complete and the next one begins.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Rotation {
    /// After so many octets, as they are written.
    Octets(u64),
    /// After this time.
    Time(Duration),
}

/// A recording in a file, or in several one after the other (`NAME-0001.csv`, ..).
#[derive(Debug)]
pub struct RecordingFile {
    table: Table,
    file: PathBuf,
    form: Form,
    rotation: Option<Rotation>,
    part: Option<Part>,
    /// Files that are complete.
    complete: Vec<PathBuf>,
    begun: u32,
    /// Rows in complete files and in the present one, as written.
    rows: u64,
}

/// A file that grows.
#[derive(Debug)]
struct Part {
    grows: PathBuf,
    complete: PathBuf,
    out: File,
    content: Content,
    first: Duration,
    /// When rows were written last.
    written: Duration,
    waiting: usize,
    octets: u64,
    /// Rows that a write which failed has left in the file.
    kept: u64,
}

enum Content {
    Lines(Box<CsvLines>),
    Columns(Box<Batch>, Box<StreamWriter<Vec<u8>>>),
}

impl std::fmt::Debug for Content {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Lines(_) => "Lines",
            Self::Columns(..) => "Columns",
        })
    }
}

impl RecordingFile {
    /// Begins a file; nothing that exists is replaced.
    ///
    /// # Errors
    /// When the file exists or cannot be written.
    pub fn create(
        table: &Table,
        file: &Path,
        form: Form,
        rotation: Option<Rotation>,
    ) -> Result<Self, WriteError> {
        let mut recording = Self {
            table: table.clone(),
            file: file.to_owned(),
            form,
            rotation,
            part: None,
            complete: Vec::new(),
            begun: 0,
            rows: 0,
        };
        recording.part = Some(recording.begin(Duration::ZERO)?);
        Ok(recording)
    }

    /// Checks that a recording can begin with this file: neither it nor what grows into it exists, and its folder does. To be
    /// called before drives are connected; [`create`](Self::create) has the last word.
    ///
    /// # Errors
    /// When a file exists, or the folder does not.
    pub fn check(file: &Path, form: Form, rotation: Option<Rotation>) -> Result<(), WriteError> {
        let complete = rotation.map_or_else(|| file.to_owned(), |_| numbered(file, 1));
        let grows = growing(&complete, form);
        for taken in [&complete, &grows] {
            if taken.exists() {
                return Err(WriteError::exists(taken));
            }
        }
        let folder = file.parent().filter(|folder| !folder.as_os_str().is_empty());
        match folder.map(fs::metadata) {
            Some(Err(cause)) => Err(WriteError::new("cannot create", file, cause)),
            _ => Ok(()),
        }
    }

    /// Returns the rows in the files, as far as they were written.
    #[must_use]
    pub const fn rows(&self) -> u64 {
        self.rows
    }

    /// Returns the files that are complete, in their order.
    #[must_use]
    pub fn files(&self) -> &[PathBuf] {
        &self.complete
    }

    fn begin(&mut self, at: Duration) -> Result<Part, WriteError> {
        self.begun += 1;
        let complete = match self.rotation {
            None => self.file.clone(),
            Some(_) => numbered(&self.file, self.begun),
        };
        let grows = growing(&complete, self.form);
        let failed = |error| WriteError::new("cannot create", &grows, error);
        if complete.exists() {
            return Err(WriteError::exists(&complete));
        }
        let out = OpenOptions::new()
            .write(true)
            .create_new(true)
            .open(&grows)
            .map_err(failed)?;
        let content = match self.form {
            Form::Csv => Content::Lines(Box::new(CsvLines::new(&self.table).map_err(failed)?)),
            _ => {
                let batch = Batch::new(&self.table);
                let stream = StreamWriter::try_new(Vec::new(), &batch.schema());
                let stream = stream.map_err(|error| failed(of_arrow(error)))?;
                Content::Columns(Box::new(batch), Box::new(stream))
            }
        };
        let mut part = Part {
            grows,
            complete,
            out,
            content,
            first: at,
            written: at,
            waiting: 0,
            octets: 0,
            kept: 0,
        };
        // on a full disk it fails here, before anything is recorded or moved
        if let Err(error) = part.flush() {
            let _ = fs::remove_file(&part.grows);
            return Err(WriteError::new("cannot create", &part.grows, error));
        }
        Ok(part)
    }

    /// Writes what waits. When that fails, the file ends with the last whole line or batch.
    fn flush(&mut self) -> Result<(), WriteError> {
        let Some(part) = &mut self.part else { return Ok(()) };
        let waiting = part.waiting as u64;
        match part.flush() {
            Ok(()) => {
                self.rows += waiting;
                Ok(())
            }
            Err(cause) => {
                let file = part.grows.clone();
                self.rows += part.kept;
                Err(self.failed("cannot write", file, cause))
            }
        }
    }

    fn failed(&mut self, action: &'static str, file: PathBuf, cause: io::Error) -> WriteError {
        let grown = self.part.take().map(|part| part.grows);
        WriteError {
            rows: self.rows,
            readable: grown
                .filter(|_| self.rows > 0)
                .or_else(|| self.complete.last().cloned()),
            ..WriteError::new(action, file, cause)
        }
    }

    /// Completes the present file.
    fn complete(&mut self) -> Result<(), WriteError> {
        self.flush()?;
        let Some(part) = &self.part else { return Ok(()) };
        if let Err(cause) = part.complete(self.form) {
            let file = part.complete.clone();
            let mut error = self.failed("cannot complete", file, cause);
            if self.rows == 0 {
                error.readable = None;
            }
            return Err(error);
        }
        if let Some(part) = self.part.take() {
            self.complete.push(part.complete);
        }
        Ok(())
    }

    fn is_full(&self, row: &Row) -> bool {
        match (&self.part, self.rotation) {
            (Some(part), Some(Rotation::Octets(most))) => part.octets >= most,
            (Some(part), Some(Rotation::Time(most))) => row.time.saturating_sub(part.first) >= most,
            _ => false,
        }
    }
}

impl Sink for RecordingFile {
    fn write(&mut self, row: &Row) -> Result<(), WriteError> {
        if self.is_full(row) {
            self.complete()?;
            self.part = Some(self.begin(row.time)?);
        }
        let Some(part) = &mut self.part else { return Ok(()) };
        if let Err(cause) = part.push(row) {
            let file = part.grows.clone();
            return Err(self.failed("cannot write", file, cause));
        }
        let due = row.time.saturating_sub(part.written) >= WRITTEN || part.waiting >= MOST_WAITING;
        if due {
            part.written = row.time;
            return self.flush();
        }
        Ok(())
    }

    fn finish(&mut self) -> Result<(), WriteError> {
        self.complete()
    }
}

impl Part {
    fn push(&mut self, row: &Row) -> io::Result<()> {
        self.waiting += 1;
        match &mut self.content {
            Content::Lines(lines) => lines.push(row),
            Content::Columns(batch, _) => {
                batch.push(row);
                Ok(())
            }
        }
    }

    fn flush(&mut self) -> io::Result<()> {
        let octets = match &mut self.content {
            Content::Lines(lines) => lines.take()?,
            Content::Columns(batch, stream) => {
                if !batch.is_empty() {
                    let rows = batch.take().map_err(of_arrow)?;
                    stream.write(&rows).map_err(of_arrow)?;
                }
                std::mem::take(stream.get_mut())
            }
        };
        self.waiting = 0;
        let Err(error) = self.out.write_all(&octets) else {
            self.octets += octets.len() as u64;
            return Ok(());
        };
        // what is whole stays, a part of it would make all of it unreadable
        let mut whole = self.octets;
        if let Content::Lines(_) = self.content {
            let reached = self.out.stream_position().unwrap_or(whole);
            let written = usize::try_from(reached.saturating_sub(whole)).unwrap_or(0);
            let lines = octets.get(..written).unwrap_or_default();
            let end = lines.iter().rposition(|octet| *octet == b'\n');
            let lines = lines.get(..end.map_or(0, |end| end + 1)).unwrap_or_default();
            whole += lines.len() as u64;
            let count = lines.iter().filter(|octet| **octet == b'\n').count() as u64;
            self.kept = count;
        }
        let _ = self.out.set_len(whole);
        let _ = self.out.seek(SeekFrom::Start(whole));
        Err(error)
    }

    /// Makes the complete file of one that grew.
    fn complete(&self, form: Form) -> io::Result<()> {
        match form {
            Form::Csv | Form::ArrowStream => return Ok(()),
            Form::Arrow | Form::Parquet => {}
        }
        let unfinished = beside(&self.complete, "new");
        let made = convert(&self.grows, &unfinished, form);
        if made.is_err() {
            let _ = fs::remove_file(&unfinished);
            return made;
        }
        fs::rename(&unfinished, &self.complete)?;
        fs::remove_file(&self.grows)
    }
}

/// Writes an Arrow stream as a file of another form, piece by piece.
fn convert(from: &Path, to: &Path, form: Form) -> io::Result<()> {
    let stream = StreamReader::try_new(BufReader::new(File::open(from)?), None).map_err(of_arrow)?;
    let schema = stream.schema();
    let out = File::create(to)?;
    let mut writer: Box<dyn Columns> = match form {
        Form::Parquet => Box::new(ArrowWriter::try_new(out, schema.clone(), None)?),
        _ => Box::new(FileWriter::try_new(out, &schema).map_err(of_arrow)?),
    };
    let mut group: Vec<RecordBatch> = Vec::new();
    for batch in stream {
        group.push(batch.map_err(of_arrow)?);
        if group.iter().map(RecordBatch::num_rows).sum::<usize>() >= GROUP {
            writer.group(&concat_batches(&schema, &group).map_err(of_arrow)?)?;
            group.clear();
        }
    }
    if !group.is_empty() {
        writer.group(&concat_batches(&schema, &group).map_err(of_arrow)?)?;
    }
    writer.end()
}

/// A file of columns with a table of contents.
trait Columns {
    /// Writes rows that stand together.
    fn group(&mut self, rows: &RecordBatch) -> io::Result<()>;
    /// Writes the table of contents.
    fn end(self: Box<Self>) -> io::Result<()>;
}

impl Columns for ArrowWriter<File> {
    fn group(&mut self, rows: &RecordBatch) -> io::Result<()> {
        self.write(rows)?;
        self.flush()?;
        Ok(())
    }

    fn end(self: Box<Self>) -> io::Result<()> {
        self.into_inner()?.flush()
    }
}

impl Columns for FileWriter<File> {
    fn group(&mut self, rows: &RecordBatch) -> io::Result<()> {
        self.write(rows).map_err(of_arrow)
    }

    fn end(mut self: Box<Self>) -> io::Result<()> {
        self.finish().map_err(of_arrow)
    }
}

/// Returns the error of the system in one of Arrow.
fn of_arrow(error: ArrowError) -> io::Error {
    match error {
        ArrowError::IoError(_, error) => error,
        other => io::Error::other(other),
    }
}

/// Returns the file that grows as long as a recording lasts.
fn growing(complete: &Path, form: Form) -> PathBuf {
    match form {
        Form::Csv | Form::ArrowStream => complete.to_owned(),
        Form::Arrow | Form::Parquet => beside(complete, PART),
    }
}

fn numbered(file: &Path, number: u32) -> PathBuf {
    let stem = file.file_stem().unwrap_or_default().to_string_lossy();
    let end = file.extension().unwrap_or_default().to_string_lossy();
    file.with_file_name(format!("{stem}-{number:04}.{end}"))
}

fn beside(file: &Path, end: &str) -> PathBuf {
    let mut name = file.file_name().unwrap_or_default().to_owned();
    name.push(".");
    name.push(end);
    file.with_file_name(name)
}

//! An archive for support: all that describes a machine and its present state, in one zip file.

use std::collections::BTreeSet;
use std::fmt::Write as _;
use std::io::{Cursor, Write as _};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use client::{Error, ErrorKind};
use futures::channel::oneshot;
use network::ethernet::Capture;
use network::pcap::Writer;
use network::system::Stop;
use serde::Serialize;
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, ZipWriter};

use super::traffic::kept;
use super::{DocumentError, NewFile, Portrait, portrait, time_text};
use crate::open::Opening;
use crate::report::{BundleReport, BundledDrive, BundledFile, DoctorReport, Wording, document};
use crate::{Explained, Part, Selector, Step, doctor};

/// Octets of a capture at most.
const MAX_CAPTURE: usize = 64 << 20;
/// Time between two looks whether a capture is over.
const LOOK: Duration = Duration::from_millis(50);
/// Octets of all files that a caller adds.
const MAX_ADDED: u64 = 256 << 20;

/// What is to be in an archive besides what describes the drives.
#[derive(Debug, Clone, Default)]
pub struct Contents {
    /// How long the traffic of the interface is captured, at least.
    pub capture: Option<Duration>,
    /// The folder in which the last traffic of the interface may have been kept: see [`KeptTraffic`](super::traffic::KeptTraffic).
    pub state: Option<PathBuf>,
    /// Files of the caller: captures, logs, machine files.
    pub files: Vec<PathBuf>,
}

/// Reads the drives that are meant and writes the archive. What cannot be read is noted in it.
///
/// # Errors
/// When the file cannot be written or a file to add cannot be read; when the caller requests a stop. Then no file is left
/// behind.
pub async fn bundle(
    opening: &Opening,
    selector: &Selector,
    contents: &Contents,
    file: &NewFile,
    wording: &(dyn Wording + Sync),
    progress: &mut (dyn FnMut(Step) + Send),
) -> Result<BundleReport, DocumentError> {
    let added = read_all(&contents.files)?;
    let mut notes = Vec::new();
    let examined = doctor::examine(opening, Some(selector), wording, progress)
        .await?
        .report;
    // the traffic of the drives as they are read is in the capture too
    let are_read = Arc::new(AtomicBool::new(false));
    let capturing = contents.capture.and_then(|time| match &examined.interface {
        Some(interface) => Some(start_capture(
            interface.clone(),
            time,
            are_read.clone(),
            opening.stop.clone(),
        )),
        None => {
            notes.push("no capture: no network interface is used".to_owned());
            None
        }
    });
    let read = read(opening, selector, wording, progress).await;
    are_read.store(true, Ordering::Relaxed);
    let read = read?;
    let portrait = match read {
        Ok(portrait) => Some(portrait),
        Err(why) => {
            notes.push(format!("the drives were not read: {why}"));
            None
        }
    };
    let mut captured = None;
    if let Some(capturing) = capturing {
        progress(Step::of(Part::Capture));
        match capturing.await {
            Ok(Ok(traffic)) => captured = Some(traffic),
            Ok(Err(why)) => notes.push(format!("no capture: {why}")),
            Err(_) => notes.push("no capture: it ended early".to_owned()),
        }
    }
    if opening.stop.as_ref().is_some_and(Stop::is_stopped) {
        return Err(Error::Interrupted.into());
    }
    progress(Step::of(Part::Writing));
    let mut archive = Archive::new();
    let drives = archive.fill(&examined, portrait.as_ref(), &mut notes)?;
    if let Some(traffic) = captured {
        archive.add(
            "capture.pcapng",
            "the traffic of the interface, for Wireshark",
            &traffic,
        )?;
    }
    let interface = examined.interface.as_deref();
    let state = contents.state.as_deref();
    let kept = state
        .zip(interface)
        .map_or_else(Vec::new, |(state, interface)| kept(state, interface));
    match read_all(&kept) {
        Ok(kept) => {
            for (path, content) in &kept {
                archive.file(
                    "traffic",
                    path,
                    "traffic of the interface that was kept before",
                    content,
                )?;
            }
        }
        Err(error) => notes.push(format!("the traffic that was kept is missing: {error}")),
    }
    for (path, content) in &added {
        archive.file("added", path, "a file that was added", content)?;
    }
    let (content, files) = archive.finish(&notes)?;
    file.write(&content)?;
    Ok(BundleReport {
        file: file.path().display().to_string(),
        size: content.len() as u64,
        complete: notes.is_empty() && drives.iter().all(|drive| drive.missing.is_empty()),
        files,
        drives,
        notes,
    })
}

/// Reads the drives; what kept that from being done is no reason to have no archive, unless it is a request to stop.
async fn read(
    opening: &Opening,
    selector: &Selector,
    wording: &(dyn Wording + Sync),
    progress: &mut (dyn FnMut(Step) + Send),
) -> Result<Result<Portrait, String>, Error> {
    let mut network = match opening.open_for(selector) {
        Ok(network) => network,
        Err(error) => return Ok(Err(error.message())),
    };
    match portrait(opening, &mut network, selector, wording, progress).await {
        Err(error) if error.kind() == ErrorKind::Interrupted => Err(error),
        Err(error) => Ok(Err(error.message())),
        Ok(portrait) => {
            network.close().await?;
            Ok(Ok(portrait))
        }
    }
}

fn read_all(paths: &[PathBuf]) -> Result<Vec<(&PathBuf, Vec<u8>)>, DocumentError> {
    use std::io::Read as _;
    let mut left = MAX_ADDED;
    let mut all = Vec::new();
    for path in paths {
        let failed = |source| DocumentError::NotRead {
            path: path.clone(),
            source,
        };
        let mut content = Vec::new();
        let file = std::fs::File::open(path).map_err(failed)?;
        file.take(left + 1).read_to_end(&mut content).map_err(failed)?;
        left = left
            .checked_sub(content.len() as u64)
            .ok_or_else(|| DocumentError::TooLarge {
                path: path.clone(),
                limit: MAX_ADDED,
            })?;
        all.push((path, content));
    }
    Ok(all)
}

/// Captures in a thread of its own: for a time, and until the drives are read, as far as it is not too much.
fn start_capture(
    interface: String,
    time: Duration,
    are_read: Arc<AtomicBool>,
    stop: Option<Stop>,
) -> oneshot::Receiver<Result<Vec<u8>, String>> {
    let (send, captured) = oneshot::channel();
    let work = move || {
        let _ = send.send(capture(&interface, time, &are_read, stop));
    };
    // without a thread the channel is closed, and nothing was captured
    drop(std::thread::Builder::new().name("capture".into()).spawn(work));
    captured
}

fn capture(
    interface: &str,
    time: Duration,
    are_read: &AtomicBool,
    stop: Option<Stop>,
) -> Result<Vec<u8>, String> {
    let words = |error: &dyn std::error::Error| error.to_string();
    let stop = stop.map_or_else(Stop::new, Ok).map_err(|error| words(&error))?;
    let mut capture = Capture::open(interface, stop.clone()).map_err(|error| words(&error))?;
    let mut traffic = Vec::new();
    let mut octets = 0;
    {
        let mut writer =
            Writer::new(&mut traffic, interface, Duration::ZERO).map_err(|error| words(&error))?;
        let begin = Instant::now();
        let goes_on = || begin.elapsed() < time || !are_read.load(Ordering::Relaxed);
        while goes_on() && octets < MAX_CAPTURE && !stop.is_stopped() {
            if let Some(captured) = capture.next(LOOK).map_err(|error| words(&error))? {
                octets += captured.frame.len() + 32;
                let at = u64::try_from(captured.time.as_nanos()).unwrap_or_default();
                let at = profinet::Instant::from_nanos(at);
                writer.write(at, captured.frame).map_err(|error| words(&error))?;
            }
        }
        writer.flush().map_err(|error| words(&error))?;
    }
    Ok(traffic)
}

/// The archive while it is made.
struct Archive {
    zip: ZipWriter<Cursor<Vec<u8>>>,
    names: BTreeSet<String>,
    files: Vec<BundledFile>,
}

impl Archive {
    fn new() -> Self {
        Self {
            zip: ZipWriter::new(Cursor::new(Vec::new())),
            names: BTreeSet::new(),
            files: Vec::new(),
        }
    }

    /// Adds a file of this computer to a folder.
    fn file(
        &mut self,
        folder: &str,
        path: &Path,
        meaning: &'static str,
        content: &[u8],
    ) -> Result<(), DocumentError> {
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        self.add(&format!("{folder}/{}", safe(&name)), meaning, content)
    }

    /// Adds a file; one of the same name gets a number.
    fn add(&mut self, name: &str, meaning: &'static str, content: &[u8]) -> Result<(), DocumentError> {
        let mut name = name.to_owned();
        while !self.names.insert(name.clone()) {
            name = match name.rsplit_once('.') {
                Some((stem, ending)) => format!("{stem}-.{ending}"),
                None => name + "-",
            };
        }
        let options = SimpleFileOptions::default()
            .compression_method(CompressionMethod::Deflated)
            .last_modified_time(now());
        self.zip.start_file(name.as_str(), options).map_err(made)?;
        self.zip.write_all(content).map_err(made)?;
        self.files.push(BundledFile {
            name,
            meaning,
            size: content.len() as u64,
        });
        Ok(())
    }

    fn json(
        &mut self,
        name: &str,
        meaning: &'static str,
        command: &str,
        report: &impl Serialize,
    ) -> Result<(), DocumentError> {
        let document = document(command, report).map_err(made)?;
        let text = serde_json::to_string_pretty(&document).map_err(made)?;
        self.add(name, meaning, text.as_bytes())
    }

    /// Adds what was examined and read, and returns what is missing of each drive.
    fn fill(
        &mut self,
        examined: &DoctorReport,
        portrait: Option<&Portrait>,
        notes: &mut Vec<String>,
    ) -> Result<Vec<BundledDrive>, DocumentError> {
        self.json(
            "doctor.json",
            "what was found on the computer and its network",
            "doctor",
            examined,
        )?;
        let Some(portrait) = portrait else {
            return Ok(Vec::new());
        };
        match &portrait.scan {
            Some(scan) => self.json("scan.json", "the stations that answered", "scan", scan)?,
            None => notes.push("no scan: the network has no discovery".to_owned()),
        }
        let mut drives = Vec::new();
        for drive in &portrait.drives {
            let folder = format!("drives/{}", safe(&drive.name));
            if let Some(info) = &drive.info {
                self.json(&format!("{folder}/info.json"), "who the drive is", "info", info)?;
            }
            if let Some(status) = &drive.status {
                let meaning = "why the drive runs or not";
                self.json(&format!("{folder}/status.json"), meaning, "status", status)?;
            }
            if let Some(faults) = &drive.faults {
                let meaning = "its faults and those before";
                self.json(&format!("{folder}/faults.json"), meaning, "faults", faults)?;
            }
            if let Some(backup) = &drive.backup {
                let text = backup.to_string();
                self.add(
                    &format!("{folder}/settings.backup"),
                    "its settings",
                    text.as_bytes(),
                )?;
            }
            if !drive.problems.is_empty() {
                let text = drive.problems.join("\n") + "\n";
                self.add(
                    &format!("{folder}/problems.txt"),
                    "what could not be read of it",
                    text.as_bytes(),
                )?;
            }
            drives.push(drive.entry());
        }
        Ok(drives)
    }

    /// Adds what each file is, and returns the archive and its files.
    fn finish(mut self, notes: &[String]) -> Result<(Vec<u8>, Vec<BundledFile>), DocumentError> {
        let mut text = format!(
            "State of a machine, read by profidrive {} on {} ({} {}).\nDocuments are of the form {}.\n\n",
            env!("CARGO_PKG_VERSION"),
            time_text(std::time::SystemTime::now()),
            std::env::consts::OS,
            std::env::consts::ARCH,
            crate::report::SCHEMA,
        );
        for file in &self.files {
            // a text takes everything
            let _ = writeln!(text, "{}: {}", file.name, file.meaning);
        }
        for note in notes {
            let _ = writeln!(text, "\n{note}");
        }
        self.add("README.txt", "what each file is", text.as_bytes())?;
        let content = self.zip.finish().map_err(made)?.into_inner();
        Ok((content, self.files))
    }
}

/// The present time (UTC), as archives have it; the beginning of their time where they cannot.
fn now() -> zip::DateTime {
    let now = chrono::DateTime::<chrono::Utc>::from(std::time::SystemTime::now());
    zip::DateTime::try_from(now.naive_utc()).unwrap_or_default()
}

fn made(error: impl std::error::Error + Send + Sync + 'static) -> DocumentError {
    DocumentError::Content(Box::new(error))
}

/// A name from a network or a caller as a name in an archive: no folder, nothing that leads out of it.
fn safe(name: &str) -> String {
    let kept = |letter: char| match letter {
        'a'..='z' | 'A'..='Z' | '0'..='9' | '.' | '-' | '_' => letter,
        _ => '-',
    };
    let name: String = name.chars().take(100).map(kept).collect();
    match name.trim_matches('.') {
        "" => "unnamed".to_owned(),
        name => name.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_name_leads_out_of_the_archive() {
        for (name, expected) in [
            ("akd-1", "akd-1"),
            ("../../etc/passwd", "-..-etc-passwd"),
            ("..", "unnamed"),
            ("", "unnamed"),
            ("a\\b\u{1b}[2J", "a-b--2J"),
            ("02:50:4e:00:00:01", "02-50-4e-00-00-01"),
        ] {
            assert_eq!(safe(name), expected);
        }
        assert_eq!(safe(&"x".repeat(1000)).len(), 100);
    }

    #[test]
    fn two_files_of_one_name_are_both_there() {
        let mut archive = Archive::new();
        for content in [b"a", b"b"] {
            archive.add("added/log.txt", "a file", content).unwrap();
        }
        let (content, files) = archive.finish(&["a note".to_owned()]).unwrap();
        let names: Vec<&str> = files.iter().map(|file| file.name.as_str()).collect();
        assert_eq!(names, ["added/log.txt", "added/log-.txt", "README.txt"]);
        let mut read = zip::ZipArchive::new(Cursor::new(content)).unwrap();
        let text = std::io::read_to_string(read.by_name("README.txt").unwrap()).unwrap();
        assert!(
            text.contains("added/log-.txt: a file\n") && text.ends_with("\na note\n"),
            "{text}"
        );
    }
}

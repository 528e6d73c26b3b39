//! The last minutes of traffic of an interface, kept in files until they are wanted: in [`bundle`](super::bundle::bundle).

use std::collections::VecDeque;
use std::fs::File;
use std::path::{Path, PathBuf};
use std::time::Duration;

use client::{Advice, ErrorKind};
use network::files::{StateFileError, create};
use network::pcap::Writer;
use network::system::{FolderLock, LockError};
use profinet::Instant;

use crate::explained::Explained;

/// The time is kept in so many parts, of which the oldest is given up as a whole.
const PARTS: u32 = 5;
/// Time of a part at least.
const SHORTEST: Duration = Duration::from_millis(250);
/// Octets of a part at most. Where more comes, less time is kept.
const LARGEST: usize = 32 << 20;
/// Time between two writes to the disk.
const WRITTEN: Duration = Duration::from_secs(1);

/// Why traffic cannot be kept.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum TrafficError {
    /// Another program keeps that of the interface, or the folder cannot be made.
    #[error(transparent)]
    Folder(#[from] LockError),
    /// A file cannot be written.
    #[error(transparent)]
    File(#[from] StateFileError),
}

impl Explained for TrafficError {
    fn kind(&self) -> ErrorKind {
        ErrorKind::Local
    }

    fn advice(&self) -> Advice {
        match self {
            Self::Folder(LockError::Held { .. }) => "one program keeps the traffic of an interface".into(),
            _ => Advice::default(),
        }
    }
}

/// Keeps the traffic of an interface: at least the time that is wanted, and at most a quarter more, as long as it is no more than
/// 160 MiB. One program keeps that of an interface at a time. What it kept stays when it ends, until the next one begins.
///
/// ```
/// use std::time::Duration;
/// use profidrive::documents::traffic::{KeptTraffic, kept};
///
/// let folder = std::env::temp_dir().join(format!("profidrive-traffic-{}", std::process::id()));
/// let mut traffic = KeptTraffic::begin(&folder, "eth0", Duration::from_secs(600))?;
/// traffic.write(Duration::from_secs(1_800_000_000), &[0xFF; 60])?;
/// drop(traffic);
/// assert_eq!(kept(&folder, "eth0").len(), 1);
/// # std::fs::remove_dir_all(folder).unwrap();
/// # Ok::<(), profidrive::documents::traffic::TrafficError>(())
/// ```
#[derive(Debug)]
pub struct KeptTraffic {
    folder: PathBuf,
    interface: String,
    /// Time of a part.
    part: Duration,
    current: Option<Part>,
    parts: VecDeque<PathBuf>,
    begun: u64,
    _lock: FolderLock,
}

#[derive(Debug)]
struct Part {
    writer: Writer<File>,
    since: Duration,
    octets: usize,
    on_disk: Duration,
}

impl KeptTraffic {
    /// Begins to keep the last `time` of an interface in `state`, the folder for what outlives a program. What was kept of the
    /// interface before is removed.
    ///
    /// # Errors
    /// When another program does it, and when the folder cannot be written to.
    pub fn begin(state: &Path, interface: &str, time: Duration) -> Result<Self, TrafficError> {
        let folder = folder(state, interface);
        let lock = FolderLock::take(&folder, &format!("process {}", std::process::id()))?;
        for file in kept(state, interface) {
            remove(&file)?;
        }
        Ok(Self {
            folder,
            interface: interface.to_owned(),
            part: (time / (PARTS - 1)).max(SHORTEST),
            current: None,
            parts: VecDeque::new(),
            begun: 0,
            _lock: lock,
        })
    }

    /// Adds a frame, with the calendar time since 1970 at which it came.
    ///
    /// # Errors
    /// When the disk refuses it. What was kept before stays.
    pub fn write(&mut self, at: Duration, frame: &[u8]) -> Result<(), TrafficError> {
        let is_full = |part: &Part| {
            // also when the clock of the computer was put back
            part.octets >= LARGEST || at.abs_diff(part.since) >= self.part
        };
        if self.current.as_ref().is_none_or(is_full) {
            self.next_part(at)?;
        }
        let (Some(part), Some(path)) = (&mut self.current, self.parts.back()) else {
            return Ok(());
        };
        part.octets += frame.len() + 32;
        let nanos = u64::try_from(at.as_nanos()).unwrap_or_default();
        let mut written = part.writer.write(Instant::from_nanos(nanos), frame);
        if at.abs_diff(part.on_disk) >= WRITTEN {
            part.on_disk = at;
            written = written.and_then(|()| part.writer.flush());
        }
        written.map_err(|source| failed("write", path, source).into())
    }

    /// Where it is kept.
    #[must_use]
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    fn next_part(&mut self, at: Duration) -> Result<(), TrafficError> {
        if let (Some(mut part), Some(path)) = (self.current.take(), self.parts.back()) {
            part.writer
                .flush()
                .map_err(|source| failed("write", path, source))?;
        }
        while self.parts.len() >= PARTS as usize {
            let oldest = self.parts.pop_front().unwrap_or_default();
            remove(&oldest)?;
        }
        self.begun += 1;
        let path = self.folder.join(format!("{:06}.pcapng", self.begun));
        let file = create(&path)?;
        let writer = Writer::new(file, &self.interface, Duration::ZERO)
            .map_err(|source| failed("write", &path, source))?;
        self.parts.push_back(path);
        self.current = Some(Part {
            writer,
            since: at,
            octets: 0,
            on_disk: at,
        });
        Ok(())
    }
}

/// Returns the files with the traffic that was kept of an interface, the oldest first. The last one may still be written to.
#[must_use]
pub fn kept(state: &Path, interface: &str) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder(state, interface)).into_iter().flatten();
    let paths = entries.flatten().map(|entry| entry.path());
    let mut files: Vec<PathBuf> = paths
        .filter(|path| path.extension().is_some_and(|ending| ending == "pcapng"))
        .collect();
    files.sort();
    files
}

fn folder(state: &Path, interface: &str) -> PathBuf {
    state.join("traffic").join(interface)
}

fn remove(path: &Path) -> Result<(), StateFileError> {
    std::fs::remove_file(path).map_err(|source| failed("remove", path, source))
}

fn failed(action: &'static str, path: &Path, source: std::io::Error) -> StateFileError {
    StateFileError {
        action,
        path: path.to_owned(),
        source,
    }
}

#[cfg(test)]
mod tests {
    use network::pcap::Reader;

    use super::*;

    struct Folder(PathBuf);

    impl Folder {
        fn new(name: &str) -> Self {
            let path = std::env::temp_dir().join(format!("profidrive-kept-{name}-{}", std::process::id()));
            let _ = std::fs::remove_dir_all(&path);
            Self(path)
        }
    }

    impl Drop for Folder {
        fn drop(&mut self) {
            let _ = std::fs::remove_dir_all(&self.0);
        }
    }

    /// The seconds of the frames that are kept.
    fn seconds(state: &Path) -> Vec<u64> {
        let files = kept(state, "eth0").into_iter();
        let frames = files.flat_map(|file| Reader::new(File::open(file).unwrap()).unwrap());
        frames.map(|frame| frame.unwrap().time.as_secs()).collect()
    }

    #[test]
    fn at_least_the_wanted_time_is_kept_and_little_more() {
        let folder = Folder::new("time");
        let mut traffic = KeptTraffic::begin(&folder.0, "eth0", Duration::from_secs(100)).unwrap();
        for second in 0..1000 {
            traffic.write(Duration::from_secs(second), &[0xFF; 60]).unwrap();
        }
        // as a reader finds it while it goes on: what is not on the disk yet is of the last second
        let found = seconds(&folder.0);
        assert!(found.last() >= Some(&998), "{found:?}");
        assert!((100..=125).contains(&found.len()), "{}", found.len());
        drop(traffic);
        let found = seconds(&folder.0);
        let first = 1000 - found.len() as u64;
        assert_eq!(found, (first..1000).collect::<Vec<_>>());
        // the next one does not mix with it
        drop(KeptTraffic::begin(&folder.0, "eth0", Duration::from_secs(100)).unwrap());
        assert!(seconds(&folder.0).is_empty());
    }

    #[test]
    fn a_part_has_an_end_in_size_too_and_a_clock_put_back_ends_one() {
        let folder = Folder::new("size");
        let mut traffic = KeptTraffic::begin(&folder.0, "eth0", Duration::from_secs(100_000)).unwrap();
        let frame = vec![0xFF; 60_000];
        for count in 0..6 * (LARGEST as u64 / 60_000) {
            traffic
                .write(Duration::from_secs(1_000_000 + count), &frame)
                .unwrap();
        }
        let files = kept(&folder.0, "eth0");
        assert_eq!(files.len(), PARTS as usize);
        let size: u64 = files.iter().map(|file| file.metadata().unwrap().len()).sum();
        assert!(size <= u64::from(PARTS) * (LARGEST as u64 + 70_000), "{size}");
        traffic.write(Duration::from_secs(5), &frame).unwrap();
        drop(traffic);
        assert_eq!(seconds(&folder.0).last(), Some(&5));
    }

    #[test]
    fn one_program_keeps_that_of_an_interface() {
        let folder = Folder::new("one");
        let time = Duration::from_secs(10);
        let first = KeptTraffic::begin(&folder.0, "eth0", time).unwrap();
        let error = KeptTraffic::begin(&folder.0, "eth0", time).unwrap_err();
        assert!(error.to_string().contains("is in use by process"), "{error}");
        KeptTraffic::begin(&folder.0, "eth1", time).unwrap();
        drop(first);
        KeptTraffic::begin(&folder.0, "eth0", time).unwrap();
    }

    #[test]
    fn a_disk_that_refuses_is_an_error_with_the_file() {
        let folder = Folder::new("refused");
        let mut traffic = KeptTraffic::begin(&folder.0, "eth0", Duration::from_secs(10)).unwrap();
        std::fs::remove_dir_all(&folder.0).unwrap();
        let error = traffic
            .write(Duration::from_secs(1), &[0; 60])
            .unwrap_err()
            .to_string();
        assert!(error.contains("000001.pcapng"), "{error}");
    }
}

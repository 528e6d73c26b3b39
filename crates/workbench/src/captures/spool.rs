//! Files without a name: an upload, and its frames.

use std::fs::{DirBuilder, File, OpenOptions};
use std::io::{self, BufReader, BufWriter, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

/// Frames from one place that is known to the next.
const STEP: u64 = 64;
/// Octets before a frame: its time in ns and its length.
const HEAD: usize = 12;
/// The longest frame that is kept, in octets.
const LONGEST: usize = 1 << 20;

/// Makes names differ.
static NUMBER: AtomicU64 = AtomicU64::new(0);

/// A file that is written, then read. Nothing is left of it when this is dropped.
#[derive(Debug)]
pub(crate) struct Upload {
    writer: BufWriter<File>,
    reader: File,
    octets: u64,
    /// Where its name could not be removed while it is open.
    _named: Option<Named>,
}

#[derive(Debug)]
struct Named(PathBuf);

impl Drop for Named {
    fn drop(&mut self) {
        // what cannot be removed is in the folder for all to see
        let _ = std::fs::remove_file(&self.0);
    }
}

impl Upload {
    /// Makes a file in a folder.
    pub fn new(folder: &Path) -> io::Result<Self> {
        let mut builder = DirBuilder::new();
        let mut options = OpenOptions::new();
        options.write(true).create_new(true);
        private(&mut builder, &mut options);
        builder.recursive(true).create(folder)?;
        let number = NUMBER.fetch_add(1, Ordering::Relaxed);
        let path = folder.join(format!("capture-{}-{number}.tmp", std::process::id()));
        let writer = options.open(&path)?;
        let reader = File::open(&path)?;
        let _named = std::fs::remove_file(&path).is_err().then_some(Named(path));
        Ok(Self {
            writer: BufWriter::new(writer),
            reader,
            octets: 0,
            _named,
        })
    }

    /// Returns how many octets it has.
    pub const fn octets(&self) -> u64 {
        self.octets
    }

    /// Adds octets.
    pub fn write(&mut self, octets: &[u8]) -> io::Result<()> {
        self.octets += octets.len() as u64;
        self.writer.write_all(octets)
    }

    /// Ends writing, and returns what was written from its beginning.
    pub fn into_reader(mut self) -> io::Result<impl Read + Send + 'static> {
        self.writer.flush()?;
        self.reader.rewind()?;
        Ok(Whole(self))
    }
}

/// Keeps the file until it was read.
#[derive(Debug)]
struct Whole(Upload);

impl Read for Whole {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        self.0.reader.read(buffer)
    }
}

/// The frames of a capture in a file, with the places of some of them.
#[derive(Debug)]
pub(super) struct Frames {
    file: Upload,
    /// Where each [`STEP`]th frame begins.
    places: Vec<u64>,
    count: u64,
}

impl Frames {
    pub const fn new(file: Upload) -> Self {
        Self {
            file,
            places: Vec::new(),
            count: 0,
        }
    }

    /// Returns how many there are.
    pub const fn count(&self) -> u64 {
        self.count
    }

    /// Adds a frame. What does not fit into [`LONGEST`] is cut off.
    pub fn add(&mut self, time: Duration, frame: &[u8]) -> io::Result<()> {
        if self.count.is_multiple_of(STEP) {
            self.places.push(self.file.octets());
        }
        let frame = frame.get(..LONGEST).unwrap_or(frame);
        let nanos = u64::try_from(time.as_nanos()).unwrap_or(u64::MAX);
        let length = u32::try_from(frame.len()).unwrap_or(u32::MAX);
        self.file.write(&nanos.to_le_bytes())?;
        self.file.write(&length.to_le_bytes())?;
        self.file.write(frame)?;
        self.count += 1;
        Ok(())
    }

    /// Lets frames be read that were added.
    pub fn flush(&mut self) -> io::Result<()> {
        self.file.writer.flush()
    }

    /// Calls `each` with the frames from this one on, counted from 0, until it has no room for more. Frames that were not flushed
    /// are left out.
    pub fn each(&mut self, from: u64, each: &mut dyn FnMut(u64, Duration, &[u8]) -> bool) -> io::Result<()> {
        let at = usize::try_from(from / STEP).unwrap_or(usize::MAX);
        let Some(place) = self.places.get(at).filter(|_| from < self.count) else {
            return Ok(());
        };
        self.file.reader.seek(SeekFrom::Start(*place))?;
        let mut reader = BufReader::new(&self.file.reader);
        let mut frame = Vec::new();
        let first = from - from % STEP;
        for number in first..self.count {
            let mut head = [0; HEAD];
            reader.read_exact(&mut head)?;
            let (nanos, length) = head.split_at(8);
            let nanos = u64::from_le_bytes(nanos.try_into().unwrap_or_default());
            let length = u32::from_le_bytes(length.try_into().unwrap_or_default());
            frame.resize(usize::try_from(length).unwrap_or_default().min(LONGEST), 0);
            reader.read_exact(&mut frame)?;
            if number >= from && !each(number, Duration::from_nanos(nanos), &frame) {
                break;
            }
        }
        Ok(())
    }
}

/// Lets only this user read it.
#[cfg(unix)]
fn private(builder: &mut DirBuilder, options: &mut OpenOptions) {
    use std::os::unix::fs::{DirBuilderExt, OpenOptionsExt};
    builder.mode(0o700);
    options.mode(0o600);
}

/// The folder of a user is its own.
#[cfg(not(unix))]
fn private(_: &mut DirBuilder, _: &mut OpenOptions) {}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_are_found_by_their_number() {
        let folder = std::env::temp_dir().join(format!("spool-{}", std::process::id()));
        let mut frames = Frames::new(Upload::new(&folder).unwrap());
        for number in 0..200_u8 {
            frames
                .add(Duration::from_secs(number.into()), &vec![number; number.into()])
                .unwrap();
        }
        frames.flush().unwrap();
        for from in [0, 1, 63, 64, 130, 199] {
            let mut seen = Vec::new();
            frames
                .each(from, &mut |number, time, frame| {
                    assert_eq!(frame, vec![u8::try_from(number).unwrap(); frame.len()]);
                    assert_eq!((time.as_secs(), frame.len() as u64), (number, number));
                    seen.push(number);
                    seen.len() < 3
                })
                .unwrap();
            assert_eq!(seen[0], from);
            assert_eq!(seen.len() as u64, (200 - from).min(3));
        }
        frames.each(200, &mut |_, _, _| panic!("there is none")).unwrap();
        assert_eq!(folder.read_dir().unwrap().count(), 0, "no file has a name");
        std::fs::remove_dir(folder).unwrap();
    }
}

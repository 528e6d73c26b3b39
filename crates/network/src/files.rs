//! Files that are replaced whole or not at all, and files in folders that others can write to as well.

use std::fs::{self, DirBuilder, File, OpenOptions};
use std::io::{self, Read};
use std::path::{Path, PathBuf};

mod beside;
pub(crate) mod system;

pub use beside::Beside;
use beside::{unnamed, with_new_name};

/// Largest state file that is read; anything longer is not one of ours.
pub const MAX_STATE: u64 = 16 << 20;

/// Mode of files only accessible to this user.
const PRIVATE: u32 = 0o600;
/// Mode of files that a user named: the umask decides.
const SHARED: u32 = 0o666;
/// Ending of files that are written before they take the place of another one.
const BESIDE: &str = ".new";
/// Hexadecimal digits of the random part of their names.
const DIGITS: usize = 16;

/// What went wrong with a state file.
#[derive(Debug, thiserror::Error)]
#[error("cannot {action} {}: {source}", path.display())]
pub struct StateFileError {
    /// What was tried: "read", "write", "replace" ...
    pub action: &'static str,
    /// The file or folder.
    pub path: PathBuf,
    /// Why not.
    pub source: io::Error,
}

/// A small file that holds the old content or the new one, never a mixture, whenever the program or the machine
/// stops: written beside, made durable, then renamed over the old one.
///
/// The temporary file has no name until it is complete, so that a killed program leaves nothing. A file system without
/// unnamed files gets a random name. Names are created exclusively, so that a link planted in the folder is never
/// followed. One writer at a time; readers at any time.
///
/// ```
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// # let folder = std::env::temp_dir().join(format!("state-file-doc-{}", std::process::id()));
/// use profidrive_network::files::StateFile;
/// let file = StateFile::new(folder.join("akd-1.state"));
/// assert_eq!(file.read()?, None);
/// file.replace(b"name = akd-1\n")?;
/// assert_eq!(file.read()?.as_deref(), Some(&b"name = akd-1\n"[..]));
/// # std::fs::remove_dir_all(folder)?;
/// # Ok(()) }
/// ```
#[derive(Debug, Clone)]
pub struct StateFile {
    path: PathBuf,
    private: bool,
}

impl StateFile {
    /// Returns the file of a program: only readable by this user (mode 0600), and not read through a link. Nothing is
    /// touched yet.
    #[must_use]
    pub fn new(path: impl Into<PathBuf>) -> Self {
        Self {
            path: path.into(),
            private: true,
        }
    }

    /// Returns a file that the user named: its mode is up to the umask, and it may be read through a link. Nothing is
    /// touched yet.
    #[must_use]
    pub fn document(path: impl Into<PathBuf>) -> Self {
        Self {
            path: path.into(),
            private: false,
        }
    }

    /// Returns the path of the file.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Returns the content, `None` if there is no such file yet.
    ///
    /// # Errors
    /// When the file cannot be read, is longer than [`MAX_STATE`], or is a file of a program and not a regular one.
    pub fn read(&self) -> Result<Option<Vec<u8>>, StateFileError> {
        let opened = if self.private {
            open_regular(OpenOptions::new().read(true), &self.path)
        } else {
            File::open(&self.path)
        };
        let file = match opened {
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(None),
            other => other.map_err(|source| self.error("open", source))?,
        };
        let mut content = Vec::new();
        file.take(MAX_STATE + 1)
            .read_to_end(&mut content)
            .map_err(|source| self.error("read", source))?;
        if content.len() as u64 > MAX_STATE {
            let source = io::Error::new(io::ErrorKind::FileTooLarge, "longer than any state file");
            return Err(self.error("read", source));
        }
        Ok(Some(content))
    }

    /// Replaces the content; makes the folder if need be. When this returns the new content is on the disk.
    ///
    /// # Errors
    /// When anything on the way fails; the old content is then still there.
    pub fn replace(&self, content: &[u8]) -> Result<(), StateFileError> {
        let beside = self.write_beside(content)?;
        beside.flush()?;
        beside.put_in_place()?;
        self.flush_place()
    }

    /// Writes the content of a file that is not there yet: nothing is replaced. When this returns it is on the disk.
    ///
    /// # Errors
    /// When there is something of this name, or anything on the way fails; nothing is left behind then.
    pub fn create(&self, content: &[u8]) -> Result<(), StateFileError> {
        let beside = self.write_beside(content)?;
        beside.flush()?;
        beside.put_where_nothing_is()?;
        self.flush_place()
    }

    /// First step of [`replace`](Self::replace): writes the new content into a file of its own; makes the folder if
    /// need be.
    ///
    /// # Errors
    /// When the folder or the file cannot be written.
    pub fn write_beside(&self, content: &[u8]) -> Result<Beside, StateFileError> {
        let folder = folder_of(&self.path);
        let mut builder = DirBuilder::new();
        system::set_folder_mode(&mut builder, if self.private { 0o700 } else { 0o777 });
        builder
            .recursive(true)
            .create(folder)
            .map_err(|source| at(folder, "make", source))?;
        let mode = if self.private { PRIVATE } else { SHARED };
        let (file, path) = match unnamed(folder, mode) {
            Some(file) => (file.map_err(|source| self.error("create", source))?, None),
            None => self.create_beside(mode)?,
        };
        let mut beside = Beside::new(file, path, &self.path);
        beside.write(content)?;
        Ok(beside)
    }

    /// Last step of [`replace`](Self::replace): returns when the new name is on the disk.
    ///
    /// # Errors
    /// When the disk refuses.
    pub fn flush_place(&self) -> Result<(), StateFileError> {
        let folder = folder_of(&self.path);
        system::flush_folder(folder).map_err(|source| at(folder, "write", source))
    }

    /// Removes the file; no error if there is none.
    ///
    /// # Errors
    /// When the file is there and cannot be removed.
    pub fn remove(&self) -> Result<(), StateFileError> {
        match fs::remove_file(&self.path) {
            Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(()),
            other => other.map_err(|source| self.error("remove", source)),
        }
    }

    /// Renames the file to `NAME.broken`, or to `NAME.broken-2` and so on where that name is in use, and returns the new
    /// path.
    ///
    /// # Errors
    /// When it cannot be renamed.
    pub fn set_aside(&self) -> Result<PathBuf, StateFileError> {
        let aside = |number: u32| match number {
            1 => suffixed(&self.path, ".broken"),
            more => suffixed(&self.path, &format!(".broken-{more}")),
        };
        let free = (1..u32::MAX)
            .map(aside)
            .find(|path| fs::symlink_metadata(path).is_err())
            .unwrap_or_else(|| aside(1));
        fs::rename(&self.path, &free).map_err(|source| self.error("rename", source))?;
        Ok(free)
    }

    /// Creates a named file beside that was not there before: in the open of `O_EXCL` a link counts as a file.
    fn create_beside(&self, mode: u32) -> Result<(File, Option<PathBuf>), StateFileError> {
        let mut options = OpenOptions::new();
        options.write(true).create_new(true);
        system::set_mode(&mut options, mode);
        let (file, path) = with_new_name(&self.path, |path| options.open(path))?;
        Ok((file, Some(path)))
    }

    fn error(&self, action: &'static str, source: io::Error) -> StateFileError {
        at(&self.path, action, source)
    }
}

/// Removes the temporary files of killed programs in `folder`. No other program may be writing there.
pub fn sweep(folder: &Path) {
    let is_left = |name: &str| {
        let random = name.strip_suffix(BESIDE).and_then(|name| name.rsplit_once('.'));
        random.is_some_and(|(_, digits)| {
            digits.len() == DIGITS && digits.bytes().all(|digit| digit.is_ascii_hexdigit())
        })
    };
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        if entry.file_name().to_str().is_some_and(is_left) {
            let _ = fs::remove_file(entry.path());
        }
    }
}

/// Creates or empties a file that the user named, to write a stream into it.
///
/// In a folder that others can write to, an existing link or a file of another user is refused. It may have been
/// planted there, so that a program with more permissions overwrites another file. Elsewhere links are followed
/// (`/dev/stdout`).
///
/// # Errors
/// When the file cannot be created, or must not be written.
pub fn create(path: &Path) -> Result<File, StateFileError> {
    let failed = |source| at(path, "create", source);
    let folder = folder_of(path);
    let shared = fs::metadata(folder).is_ok_and(|folder| system::is_shared(&folder));
    if !shared {
        return File::create(path).map_err(failed);
    }
    let planted = |why: &str| {
        failed(io::Error::other(format!(
            "{why}, in a folder that others can write to; remove it or choose another name"
        )))
    };
    let mut options = OpenOptions::new();
    options.write(true).create(true).truncate(false);
    system::refuse_links(&mut options);
    let file = match options.open(path) {
        Err(error) if system::was_link(&error) => return Err(planted("it is a link")),
        other => other.map_err(failed)?,
    };
    let found = file.metadata().map_err(failed)?;
    if !system::is_own(&found).map_err(failed)? {
        return Err(planted("it is not a file of this user alone"));
    }
    if found.is_file() {
        file.set_len(0).map_err(failed)?;
    }
    Ok(file)
}

/// Opens a file that must be a regular one: no link, and nothing that would wait for a writer.
fn open_regular(options: &mut OpenOptions, path: &Path) -> io::Result<File> {
    system::refuse_links(options);
    let file = match options.open(path) {
        Err(error) if system::was_link(&error) => {
            return Err(io::Error::other("it is a link, which is not followed here"));
        }
        other => other?,
    };
    if file.metadata()?.is_dir() {
        return Err(io::ErrorKind::IsADirectory.into());
    }
    if !file.metadata()?.is_file() {
        return Err(io::Error::other("it is not a regular file"));
    }
    Ok(file)
}

fn folder_of(path: &Path) -> &Path {
    match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    }
}

fn suffixed(path: &Path, suffix: &str) -> PathBuf {
    let mut name = path.file_name().unwrap_or_default().to_owned();
    name.push(suffix);
    path.with_file_name(name)
}

fn at(path: &Path, action: &'static str, source: io::Error) -> StateFileError {
    StateFileError {
        action,
        path: path.to_owned(),
        source,
    }
}

#[cfg(test)]
#[cfg(unix)]
mod tests {
    use super::*;
    use std::io::Write;
    use std::os::unix::fs::{MetadataExt, PermissionsExt, symlink};

    struct Folder(PathBuf);

    impl Folder {
        fn new(name: &str) -> Self {
            let path = std::env::temp_dir().join(format!("network-{name}-{}", std::process::id()));
            let _ = fs::remove_dir_all(&path);
            Self(path)
        }

        fn names(&self) -> Vec<String> {
            let entries = fs::read_dir(&self.0).unwrap();
            let mut names: Vec<String> = entries
                .map(|entry| entry.unwrap().file_name().into_string().unwrap())
                .collect();
            names.sort();
            names
        }
    }

    impl Drop for Folder {
        fn drop(&mut self) {
            let _ = fs::remove_dir_all(&self.0);
        }
    }

    #[test]
    fn replaces_whole_and_leaves_nothing_beside() {
        let folder = Folder::new("replace");
        let file = StateFile::new(folder.0.join("a/b/state"));
        assert_eq!(file.read().unwrap(), None);
        for content in [&b"first, and longer"[..], b"second", b""] {
            file.replace(content).unwrap();
            assert_eq!(file.read().unwrap().as_deref(), Some(content));
        }
        let names: Vec<_> = fs::read_dir(folder.0.join("a/b"))
            .unwrap()
            .map(|e| e.unwrap().file_name())
            .collect();
        assert_eq!(names, ["state"]);
        file.remove().unwrap();
        file.remove().unwrap();
        assert_eq!(file.read().unwrap(), None);
    }

    #[test]
    fn a_new_file_replaces_nothing_and_leaves_nothing_beside() {
        let folder = Folder::new("create");
        let file = StateFile::document(folder.0.join("report.html"));
        file.create(b"first").unwrap();
        let error = file.create(b"second").unwrap_err();
        assert_eq!(error.source.kind(), io::ErrorKind::AlreadyExists);
        assert_eq!(file.read().unwrap().as_deref(), Some(&b"first"[..]));
        assert_eq!(folder.names(), ["report.html"]);
        let link = StateFile::document(folder.0.join("link"));
        symlink("elsewhere", folder.0.join("link")).unwrap();
        assert!(link.create(b"third").is_err(), "a link counts as something");
        assert_eq!(folder.names(), ["link", "report.html"]);
    }

    #[test]
    fn a_write_that_was_killed_leaves_nothing() {
        let folder = Folder::new("unnamed");
        let file = StateFile::document(folder.0.join("drive.backup"));
        let first = file.write_beside(b"half of the n").unwrap();
        if first.has_name() {
            return; // the file system has no unnamed files
        }
        first.flush().unwrap();
        assert!(folder.names().is_empty());
        file.replace(b"old").unwrap();
        let second = file.write_beside(b"new").unwrap();
        assert_eq!(folder.names(), ["drive.backup"]);
        second.put_in_place().unwrap();
        assert_eq!(folder.names(), ["drive.backup"]);
        assert_eq!(file.read().unwrap().as_deref(), Some(&b"new"[..]));
    }

    #[test]
    fn a_named_file_that_was_left_does_not_matter_and_is_swept_away() {
        let folder = Folder::new("killed");
        let file = StateFile::new(folder.0.join("state"));
        file.replace(b"old").unwrap();
        file.create_beside(PRIVATE).unwrap();
        assert_eq!(file.read().unwrap().as_deref(), Some(&b"old"[..]));
        file.replace(b"new").unwrap();
        assert_eq!(file.read().unwrap().as_deref(), Some(&b"new"[..]));
        for other in ["mine.new", "a.0123.new", "notes.0123456789abcdeg.new"] {
            fs::write(folder.0.join(other), b"").unwrap();
        }
        assert_eq!(folder.names().len(), 5);
        sweep(&folder.0);
        assert_eq!(
            folder.names(),
            ["a.0123.new", "mine.new", "notes.0123456789abcdeg.new", "state"]
        );
    }

    #[test]
    fn errors_name_the_file_and_keep_the_old_content() {
        let folder = Folder::new("errors");
        let file = StateFile::new(folder.0.join("state"));
        fs::create_dir_all(folder.0.join("state/in-use")).unwrap();
        let error = file.replace(b"new").unwrap_err().to_string();
        assert!(
            error.starts_with("cannot replace ") && error.contains("state"),
            "{error}"
        );
        assert_eq!(folder.names(), ["state"], "nothing stays beside");
        let error = StateFile::new(&folder.0).read().unwrap_err();
        assert_eq!(error.path, folder.0);
    }

    #[test]
    fn a_planted_link_is_neither_written_through_nor_read_through() {
        let folder = Folder::new("planted");
        fs::create_dir_all(&folder.0).unwrap();
        let victim = folder.0.join("victim");
        fs::write(&victim, "precious").unwrap();
        let file = StateFile::new(folder.0.join("akd-1.network.json"));
        for name in ["akd-1.network.json.new", "akd-1.network.json"] {
            symlink(&victim, folder.0.join(name)).unwrap();
        }
        let error = file.read().unwrap_err().to_string();
        assert!(error.contains("it is a link"), "{error}");
        file.replace(b"name").unwrap();
        assert_eq!(fs::read(&victim).unwrap(), b"precious");
        assert_eq!(file.read().unwrap().as_deref(), Some(&b"name"[..]));
        let mode = |path: &Path| fs::symlink_metadata(path).unwrap().mode() & 0o777;
        assert_eq!(mode(file.path()), 0o600);
    }

    #[test]
    fn what_waits_for_a_writer_is_not_read() {
        let folder = Folder::new("pipe");
        fs::create_dir_all(&folder.0).unwrap();
        let pipe = folder.0.join("state");
        assert!(
            std::process::Command::new("mkfifo")
                .arg(&pipe)
                .status()
                .unwrap()
                .success()
        );
        let error = StateFile::new(&pipe).read().unwrap_err().to_string();
        assert!(error.contains("not a regular file"), "{error}");
    }

    #[test]
    fn a_stream_follows_no_link_in_a_shared_folder() {
        let folder = Folder::new("stream");
        fs::create_dir_all(&folder.0).unwrap();
        let victim = folder.0.join("victim");
        let (link, hard) = (folder.0.join("link.pcapng"), folder.0.join("hard.pcapng"));
        let plant = || {
            fs::write(&victim, "precious").unwrap();
            let _ = (fs::remove_file(&link), fs::remove_file(&hard));
            symlink(&victim, &link).unwrap();
            fs::hard_link(&victim, &hard).unwrap();
        };
        plant();
        let shared = |mode| fs::set_permissions(&folder.0, fs::Permissions::from_mode(mode)).unwrap();
        shared(0o1777);
        for planted in [&link, &hard] {
            let error = create(planted).unwrap_err().to_string();
            assert!(error.contains("others can write"), "{error}");
        }
        assert_eq!(fs::read(&victim).unwrap(), b"precious");
        let own = folder.0.join("own.pcapng");
        for content in ["first, longer", "second"] {
            create(&own).unwrap().write_all(content.as_bytes()).unwrap();
            assert_eq!(fs::read(&own).unwrap(), content.as_bytes());
        }
        shared(0o755);
        create(&link).unwrap();
        assert_eq!(fs::read(&victim).unwrap(), b"");
    }

    #[test]
    fn broken_files_are_kept_under_names_of_their_own() {
        let folder = Folder::new("aside");
        let file = StateFile::new(folder.0.join("state"));
        for name in ["state.broken", "state.broken-2", "state.broken-3"] {
            file.replace(b"broken").unwrap();
            assert_eq!(file.set_aside().unwrap(), folder.0.join(name));
        }
        assert_eq!(folder.names().len(), 3);
    }

    #[test]
    fn a_file_that_is_too_long_is_not_read() {
        let folder = Folder::new("long");
        let path = folder.0.join("state");
        let file = StateFile::new(path.clone());
        file.replace(b"x").unwrap();
        let stretch = |length| {
            let opened = OpenOptions::new().write(true).open(&path).unwrap();
            opened.set_len(length).unwrap();
        };
        stretch(MAX_STATE + 1);
        assert!(file.read().is_err());
        stretch(MAX_STATE);
        assert_eq!(file.read().unwrap().unwrap().len() as u64, MAX_STATE);
    }
}

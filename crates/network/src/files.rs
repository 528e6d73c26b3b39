//! Files that are replaced whole or not at all.

use std::ffi::OsString;
use std::fs::{self, File};
use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};

/// Largest state file that is read; anything longer is not one of ours.
pub const MAX_STATE: u64 = 16 << 20;

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
/// One writer at a time; readers at any time.
///
/// ```
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// # let folder = std::env::temp_dir().join(format!("state-file-doc-{}", std::process::id()));
/// use network::files::StateFile;
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
}

impl StateFile {
    /// Names the file; nothing is touched yet.
    #[must_use]
    pub fn new(path: impl Into<PathBuf>) -> Self {
        Self { path: path.into() }
    }

    /// Where the file is.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The content, `None` if there is no such file yet.
    ///
    /// # Errors
    /// When the file cannot be read or is longer than [`MAX_STATE`].
    pub fn read(&self) -> Result<Option<Vec<u8>>, StateFileError> {
        let file = match File::open(&self.path) {
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
        self.write_beside(content)?;
        self.flush_beside()?;
        self.put_in_place()?;
        self.flush_place()
    }

    /// First step of [`replace`](Self::replace): the new content in a file of its own; makes the folder if need be.
    ///
    /// # Errors
    /// When the folder or the file cannot be written.
    pub fn write_beside(&self, content: &[u8]) -> Result<(), StateFileError> {
        let folder = self.folder();
        fs::create_dir_all(folder).map_err(|source| at(folder, "make", source))?;
        let beside = self.beside();
        let mut file = File::create(&beside).map_err(|source| at(&beside, "create", source))?;
        file.write_all(content)
            .map_err(|source| at(&beside, "write", source))
    }

    /// Second step: returns when the new content is on the disk.
    ///
    /// # Errors
    /// When the disk refuses.
    pub fn flush_beside(&self) -> Result<(), StateFileError> {
        let beside = self.beside();
        File::open(&beside)
            .and_then(|file| file.sync_all())
            .map_err(|source| at(&beside, "write", source))
    }

    /// Third step: the new content takes the place of the old one, at once.
    ///
    /// # Errors
    /// When the file cannot be renamed.
    pub fn put_in_place(&self) -> Result<(), StateFileError> {
        fs::rename(self.beside(), &self.path).map_err(|source| self.error("replace", source))
    }

    /// Fourth step: returns when the new name is on the disk.
    ///
    /// # Errors
    /// When the disk refuses.
    pub fn flush_place(&self) -> Result<(), StateFileError> {
        let folder = self.folder();
        File::open(folder)
            .and_then(|folder| folder.sync_all())
            .map_err(|source| at(folder, "write", source))
    }

    fn folder(&self) -> &Path {
        match self.path.parent() {
            Some(parent) if !parent.as_os_str().is_empty() => parent,
            _ => Path::new("."),
        }
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

    /// The file that is written before it takes the place of the old one.
    fn beside(&self) -> PathBuf {
        let mut name = self.path.file_name().map_or_else(OsString::new, OsString::from);
        name.push(".new");
        self.path.with_file_name(name)
    }

    fn error(&self, action: &'static str, source: io::Error) -> StateFileError {
        at(&self.path, action, source)
    }
}

fn at(path: &Path, action: &'static str, source: io::Error) -> StateFileError {
    StateFileError {
        action,
        path: path.to_owned(),
        source,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    struct Folder(PathBuf);

    impl Folder {
        fn new(name: &str) -> Self {
            let path = std::env::temp_dir().join(format!("network-{name}-{}", std::process::id()));
            let _ = fs::remove_dir_all(&path);
            Self(path)
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
    fn a_write_that_was_killed_does_not_matter() {
        let folder = Folder::new("killed");
        let file = StateFile::new(folder.0.join("state"));
        file.replace(b"old").unwrap();
        fs::write(file.beside(), b"half of the n").unwrap();
        assert_eq!(file.read().unwrap().as_deref(), Some(&b"old"[..]));
        file.replace(b"new").unwrap();
        assert_eq!(file.read().unwrap().as_deref(), Some(&b"new"[..]));
    }

    #[test]
    fn errors_name_the_file_and_keep_the_old_content() {
        let folder = Folder::new("errors");
        let file = StateFile::new(folder.0.join("state"));
        file.replace(b"old").unwrap();
        fs::create_dir(file.beside()).unwrap();
        let error = file.replace(b"new").unwrap_err().to_string();
        assert!(
            error.starts_with("cannot create ") && error.contains("state.new"),
            "{error}"
        );
        assert_eq!(file.read().unwrap().as_deref(), Some(&b"old"[..]));
        let error = StateFile::new(&folder.0).read().unwrap_err();
        assert_eq!(error.path, folder.0);
    }
}

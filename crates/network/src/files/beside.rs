//! New content on its way to the place of a file.

#[cfg(target_os = "linux")]
use std::fs::OpenOptions;
use std::fs::{self, File};
use std::hash::{BuildHasher, RandomState};
use std::io::{self, Write};
#[cfg(target_os = "linux")]
use std::os::unix::fs::OpenOptionsExt;
use std::path::{Path, PathBuf};

use super::{BESIDE, DIGITS, StateFileError, at, suffixed};

/// New content that has not taken its place yet; gone when it never does.
#[derive(Debug)]
pub struct Beside {
    file: File,
    /// Its name, where it has one.
    path: Option<PathBuf>,
    place: PathBuf,
}

impl Beside {
    pub(super) fn new(file: File, path: Option<PathBuf>, place: &Path) -> Self {
        let place = place.to_owned();
        Self { file, path, place }
    }

    pub(super) fn write(&mut self, content: &[u8]) -> Result<(), StateFileError> {
        self.file
            .write_all(content)
            .map_err(|source| at(&self.place, "write", source))
    }

    #[cfg(all(test, unix))]
    pub(super) const fn has_name(&self) -> bool {
        self.path.is_some()
    }

    /// Returns once the new content is on the disk.
    ///
    /// # Errors
    /// When the disk refuses.
    pub fn flush(&self) -> Result<(), StateFileError> {
        self.file
            .sync_all()
            .map_err(|source| at(&self.place, "write", source))
    }

    /// Gives the new content its name, where nothing has that name.
    ///
    /// # Errors
    /// When something has the name, or the file cannot be named.
    pub fn put_where_nothing_is(self) -> Result<(), StateFileError> {
        let named = match &self.path {
            None => name(&self.file, &self.place),
            Some(path) => match fs::hard_link(path, &self.place) {
                // a file system without links: what comes into being meanwhile is replaced
                Err(error) if error.kind() != io::ErrorKind::AlreadyExists => {
                    match fs::symlink_metadata(&self.place) {
                        Ok(_) => Err(io::ErrorKind::AlreadyExists.into()),
                        Err(_) => fs::rename(path, &self.place),
                    }
                }
                linked => linked,
            },
        };
        named.map_err(|source| at(&self.place, "create", source))
    }

    /// Puts the new content in the place of the old one, at once.
    ///
    /// # Errors
    /// When the file cannot be renamed.
    pub fn put_in_place(mut self) -> Result<(), StateFileError> {
        let path = match self.path.take() {
            Some(path) => path,
            // only a rename replaces a file, and only what has a name can be renamed
            None => with_new_name(&self.place, |path| name(&self.file, path))?.1,
        };
        let path = self.path.insert(path);
        fs::rename(path, &self.place).map_err(|source| at(&self.place, "replace", source))
    }
}

impl Drop for Beside {
    fn drop(&mut self) {
        if let Some(path) = &self.path {
            // the final file has another name; no other program uses this one
            let _ = fs::remove_file(path);
        }
    }
}

/// Makes something of a random new name beside `place`; tries another name where there is something of that name.
pub(super) fn with_new_name<T>(
    place: &Path,
    make: impl Fn(&Path) -> io::Result<T>,
) -> Result<(T, PathBuf), StateFileError> {
    let random = RandomState::new();
    let mut attempt = 0_u32;
    loop {
        let number = random.hash_one(attempt);
        let path = suffixed(place, &format!(".{number:0DIGITS$x}{BESIDE}"));
        match make(&path) {
            Err(error) if error.kind() == io::ErrorKind::AlreadyExists && attempt < 8 => attempt += 1,
            made => {
                let made = made.map_err(|source| at(&path, "create", source))?;
                return Ok((made, path));
            }
        }
    }
}

/// Creates a file without a name in `folder`, which goes with the program; `None` where that cannot be had.
#[cfg(target_os = "linux")]
pub(super) fn unnamed(folder: &Path, mode: u32) -> Option<io::Result<File>> {
    if !Path::new(DESCRIPTORS).is_dir() {
        return None;
    }
    let mut options = OpenOptions::new();
    options.write(true).mode(mode).custom_flags(libc::O_TMPFILE);
    match options.open(folder) {
        // file systems and kernels that do not support it
        Err(error)
            if matches!(
                error.raw_os_error(),
                Some(libc::EOPNOTSUPP | libc::EISDIR | libc::EINVAL)
            ) =>
        {
            None
        }
        opened => Some(opened),
    }
}

#[cfg(not(target_os = "linux"))]
pub(super) fn unnamed(_folder: &Path, _mode: u32) -> Option<io::Result<File>> {
    None
}

/// The open files of this process, by number.
#[cfg(target_os = "linux")]
const DESCRIPTORS: &str = "/proc/self/fd";

/// Gives an unnamed file a name that nothing has; a link counts as something.
#[cfg(target_os = "linux")]
#[allow(unsafe_code)] // std links no open file
fn name(file: &File, path: &Path) -> io::Result<()> {
    use std::ffi::CString;
    use std::os::fd::AsRawFd;
    use std::os::unix::ffi::OsStrExt;

    let own = CString::new(format!("{DESCRIPTORS}/{}", file.as_raw_fd()))?;
    let path = CString::new(path.as_os_str().as_bytes())?;
    let (here, flags) = (libc::AT_FDCWD, libc::AT_SYMLINK_FOLLOW);
    // SAFETY: both texts end with a zero and live until the call returns; linkat keeps neither.
    match unsafe { libc::linkat(here, own.as_ptr(), here, path.as_ptr(), flags) } {
        0 => Ok(()),
        _ => Err(io::Error::last_os_error()),
    }
}

#[cfg(not(target_os = "linux"))]
fn name(_file: &File, _path: &Path) -> io::Result<()> {
    Err(io::ErrorKind::Unsupported.into())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_beside_are_not_guessable() {
        let place = Path::new("state");
        let names: std::collections::BTreeSet<PathBuf> = (0..50)
            .map(|_| with_new_name(place, |_| Ok(())).unwrap().1)
            .collect();
        assert_eq!(names.len(), 50);
    }

    #[test]
    #[cfg(target_os = "linux")]
    fn a_name_that_is_a_link_is_rejected() {
        let link = std::env::temp_dir().join(format!("network-beside-{}", std::process::id()));
        std::os::unix::fs::symlink("nowhere", &link).unwrap();
        let error = name(&File::open("/proc/self/stat").unwrap(), &link).unwrap_err();
        fs::remove_file(&link).unwrap();
        assert_eq!(error.kind(), io::ErrorKind::AlreadyExists);
    }
}

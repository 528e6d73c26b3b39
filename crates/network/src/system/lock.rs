//! The exclusive use of a folder.

use std::fs::{DirBuilder, File, OpenOptions, TryLockError, symlink_metadata};
use std::io::{Read, Write};
use std::path::{Path, PathBuf};

use crate::files::system::{is_same, refuse_links, set_folder_mode, set_mode};
use crate::files::{StateFileError, sweep};

/// Name of the file in the folder that is locked.
const NAME: &str = ".lock";
/// Maximum number of octets read of the holder's description.
const LONGEST: u64 = 512;

/// Why a folder cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum LockError {
    /// Another program uses it.
    #[error("{} is in use by {holder}", folder.display())]
    Held {
        /// The folder.
        folder: PathBuf,
        /// Description by the other program; untrusted text.
        holder: String,
    },
    /// The folder or its lock cannot be made.
    #[error(transparent)]
    File(#[from] StateFileError),
}

/// A folder that one program uses: others that request it get an error that names the holder. Given back when dropped,
/// and by the system when the program is killed.
#[derive(Debug)]
pub struct FolderLock {
    _file: File,
    path: PathBuf,
}

impl FolderLock {
    /// Makes the folder if it is not there, takes it, and removes what killed programs left half written. `holder` is
    /// what others read that want it too.
    ///
    /// # Errors
    /// When another program has it, or when it cannot be written to.
    pub fn take(folder: &Path, holder: &str) -> Result<Self, LockError> {
        let failed = |action, path: &Path, source| StateFileError {
            action,
            path: path.to_owned(),
            source,
        };
        let mut builder = DirBuilder::new();
        set_folder_mode(&mut builder, 0o700);
        builder
            .recursive(true)
            .create(folder)
            .map_err(|error| failed("make", folder, error))?;
        let path = folder.join(NAME);
        loop {
            let mut options = OpenOptions::new();
            options.read(true).write(true).create(true).truncate(false);
            set_mode(&mut options, 0o600);
            refuse_links(&mut options);
            let mut file = options
                .open(&path)
                .map_err(|error| failed("open", &path, error))?;
            let locked = match file.try_lock() {
                Ok(()) => true,
                Err(TryLockError::WouldBlock) => false,
                Err(TryLockError::Error(error)) => return Err(failed("lock", &path, error).into()),
            };
            if !locked {
                let mut holder = Vec::new();
                let _ = file.take(LONGEST).read_to_end(&mut holder);
                let holder = String::from_utf8_lossy(&holder).trim_end().to_owned();
                let holder = if holder.is_empty() {
                    "another program".to_owned()
                } else {
                    holder
                };
                let folder = folder.to_owned();
                return Err(LockError::Held { folder, holder });
            }
            let opened = file.metadata().map_err(|error| failed("lock", &path, error))?;
            // the former holder may have removed the file between the open and the lock
            if !symlink_metadata(&path).is_ok_and(|found| is_same(&found, &opened)) {
                continue;
            }
            file.set_len(0)
                .and_then(|()| file.write_all(format!("{holder}\n").as_bytes()))
                .map_err(|error| failed("write", &path, error))?;
            sweep(folder);
            return Ok(Self { _file: file, path });
        }
    }
}

impl Drop for FolderLock {
    fn drop(&mut self) {
        // still locked: no other program can hold it yet
        let _ = std::fs::remove_file(&self.path);
    }
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;

    #[test]
    fn of_a_long_description_of_the_holder_the_beginning_is_read() {
        let folder = std::env::temp_dir().join(format!("network-lock-long-{}", std::process::id()));
        let _first = FolderLock::take(&folder, &"x".repeat(10_000)).unwrap();
        let Err(LockError::Held { holder, .. }) = FolderLock::take(&folder, "other") else {
            panic!("taken twice")
        };
        assert_eq!(holder, "x".repeat(512));
        std::fs::remove_dir_all(&folder).unwrap();
    }

    #[test]
    fn a_folder_has_one_user_at_a_time_and_the_next_one_learns_who() {
        let folder = std::env::temp_dir().join(format!("network-lock-{}", std::process::id()));
        let _ = std::fs::remove_dir_all(&folder);
        let first = FolderLock::take(&folder, "process 4711").unwrap();
        let refused = FolderLock::take(&folder, "process 4712").unwrap_err().to_string();
        assert!(refused.ends_with("is in use by process 4711"), "{refused}");
        drop(first);
        assert_eq!(std::fs::read_dir(&folder).unwrap().count(), 0);
        let second = FolderLock::take(&folder, "process 4712").unwrap();
        assert_eq!(
            std::fs::read_to_string(folder.join(NAME)).unwrap(),
            "process 4712\n"
        );
        drop(second);
        // a killed program leaves the file, unlocked
        std::fs::write(folder.join(NAME), "process 4713, which is gone\n").unwrap();
        FolderLock::take(&folder, "process 4714").unwrap();
        std::os::unix::fs::symlink("/etc/passwd", folder.join(NAME)).unwrap();
        assert!(matches!(FolderLock::take(&folder, "x"), Err(LockError::File(_))));
        std::fs::remove_dir_all(&folder).unwrap();
    }
}

//! Sockets of Linux and the folder they are in.

use std::fs;
use std::os::unix::fs::{DirBuilderExt, MetadataExt};
pub use std::os::unix::net::{UnixListener as Listener, UnixStream as Stream};
use std::path::{Path, PathBuf};

use super::ControlSocketError;

/// Returns the network namespace of this process, as a number that two processes of one namespace share.
pub fn namespace() -> u64 {
    fs::metadata("/proc/self/ns/net").map_or(0, |namespace| namespace.ino())
}

/// Returns the folder of the sockets, made if it is not there.
pub fn folder() -> Result<PathBuf, ControlSocketError> {
    let user = user();
    let path = match std::env::var_os("XDG_RUNTIME_DIR").filter(|path| Path::new(path).is_dir()) {
        Some(runtime) => PathBuf::from(runtime).join("profidrive"),
        None => std::env::temp_dir().join(format!("profidrive-{user}")),
    };
    let failed = |why: String| ControlSocketError::Folder {
        path: path.clone(),
        why,
    };
    match fs::DirBuilder::new().mode(0o700).create(&path) {
        Ok(()) => {}
        Err(error) if error.kind() == std::io::ErrorKind::AlreadyExists => {}
        Err(error) => return Err(failed(error.to_string())),
    }
    let found = fs::symlink_metadata(&path).map_err(|error| failed(error.to_string()))?;
    if !found.is_dir() || found.uid() != user || found.mode() & 0o077 != 0 {
        return Err(failed("open to others, or not yours".into()));
    }
    Ok(path)
}

/// Returns the user this program runs as: the owner of its own entry in /proc.
fn user() -> u32 {
    fs::metadata("/proc/self").map_or(0, |own| own.uid())
}

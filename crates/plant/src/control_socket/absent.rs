//! Where there are no control sockets: a folder that cannot be opened, and so no socket either.

use std::io::{self, Read, Write};
use std::net::Shutdown;
use std::path::{Path, PathBuf};
use std::time::Duration;

use super::ControlSocketError;

/// There is no value of this type.
#[derive(Debug)]
enum Never {}

/// Waits for clients.
#[derive(Debug)]
pub struct Listener(Never);

/// Connects two processes.
#[derive(Debug)]
pub struct Stream(Never);

impl Listener {
    pub fn bind(_path: &Path) -> io::Result<Self> {
        Err(io::ErrorKind::Unsupported.into())
    }

    pub fn accept(&self) -> io::Result<(Stream, ())> {
        match self.0 {}
    }
}

impl Stream {
    pub fn connect(_path: &Path) -> io::Result<Self> {
        Err(io::ErrorKind::Unsupported.into())
    }

    pub fn set_read_timeout(&self, _time: Option<Duration>) -> io::Result<()> {
        match self.0 {}
    }

    pub fn set_write_timeout(&self, _time: Option<Duration>) -> io::Result<()> {
        match self.0 {}
    }

    pub fn shutdown(&self, _how: Shutdown) -> io::Result<()> {
        match self.0 {}
    }
}

impl Read for &Stream {
    fn read(&mut self, _buffer: &mut [u8]) -> io::Result<usize> {
        match self.0 {}
    }
}

impl Write for &Stream {
    fn write(&mut self, _octets: &[u8]) -> io::Result<usize> {
        match self.0 {}
    }

    fn flush(&mut self) -> io::Result<()> {
        match self.0 {}
    }
}

/// There are no network namespaces.
pub fn namespace() -> u64 {
    0
}

/// # Errors
/// Always.
pub fn folder() -> Result<PathBuf, ControlSocketError> {
    Err(ControlSocketError::Unsupported)
}

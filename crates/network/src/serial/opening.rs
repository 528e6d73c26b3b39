//! Why a port cannot be opened, on Linux.

use std::fs;
use std::io::{self, ErrorKind};
use std::path::Path;

use super::{Error, Holder};

/// Returns the reason why a port cannot be opened, found by a second look at it.
pub fn opening(name: &str, error: serialport::Error) -> Error {
    let port = name.to_owned();
    let look = fs::OpenOptions::new().read(true).write(true).custom_open(name);
    match look {
        Err(source) if source.kind() == ErrorKind::NotFound => Error::NoSuchPort {
            port,
            existing: existing(),
        },
        Err(source) if source.kind() == ErrorKind::PermissionDenied => Error::NoPermission { port },
        Err(source) if source.raw_os_error() == Some(libc::EBUSY) => busy(port),
        Err(source) if source.raw_os_error() == Some(libc::EIO) => Error::Gone { port },
        Err(source) => Error::System { port, source },
        Ok(false) => Error::NotSerial { port },
        Ok(true) => match error.kind() {
            // the lock of another program that does not open the port exclusively
            serialport::ErrorKind::NoDevice => busy(port),
            serialport::ErrorKind::Io(ErrorKind::WouldBlock | ErrorKind::ResourceBusy) => busy(port),
            _ => Error::Settings {
                port,
                reason: error.to_string(),
            },
        },
    }
}

fn busy(port: String) -> Error {
    let holders = holders(&port).unwrap_or_default();
    Error::Busy { port, holders }
}

/// Returns the processes that have a port open; those of other users are only visible to root.
fn holders(port: &str) -> io::Result<Vec<Holder>> {
    let device = fs::canonicalize(port)?;
    let opens = |process: &Path| {
        let files = fs::read_dir(process.join("fd")).into_iter().flatten().flatten();
        files
            .filter_map(|file| fs::read_link(file.path()).ok())
            .any(|file| file == device)
    };
    let mut holders = Vec::new();
    for entry in fs::read_dir("/proc")?.flatten() {
        let number = entry.file_name().to_str().and_then(|name| name.parse().ok());
        if let Some(number) = number.filter(|_| opens(&entry.path())) {
            let program = fs::read_to_string(entry.path().join("comm")).unwrap_or_default();
            holders.push(Holder {
                number,
                program: program.trim_end().to_owned(),
            });
        }
    }
    Ok(holders)
}

/// Opens a file without waiting for a modem; returns whether it is a terminal.
trait CustomOpen {
    fn custom_open(&mut self, name: &str) -> io::Result<bool>;
}

impl CustomOpen for fs::OpenOptions {
    fn custom_open(&mut self, name: &str) -> io::Result<bool> {
        use std::io::IsTerminal;
        use std::os::unix::fs::OpenOptionsExt;
        let file = self.custom_flags(libc::O_NONBLOCK | libc::O_NOCTTY).open(name)?;
        Ok(file.is_terminal())
    }
}

/// Serial ports that this computer seems to have: those with hardware behind them.
fn existing() -> Vec<String> {
    let Ok(entries) = fs::read_dir("/sys/class/tty") else {
        return Vec::new();
    };
    let mut names: Vec<String> = entries
        .flatten()
        .filter(|entry| entry.path().join("device").exists())
        .map(|entry| format!("/dev/{}", entry.file_name().to_string_lossy()))
        .filter(|name| Path::new(name).exists())
        .collect();
    names.sort();
    names.truncate(16);
    names
}

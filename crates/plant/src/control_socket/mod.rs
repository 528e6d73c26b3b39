//! The control socket of a running simulation: a socket in a folder of the user, one for each process.
//!
//! A request is a few lines of text: a drive, what is to happen to it and perhaps for how long; or which drives there
//! are on a segment. The response is one line. Only the user can open the folder. On other systems than Linux there is none.

#[cfg(any(test, not(target_os = "linux")))]
#[cfg_attr(target_os = "linux", allow(dead_code))]
mod absent;
mod client;
#[cfg(target_os = "linux")]
mod linux;
mod server;

#[cfg(not(target_os = "linux"))]
use absent as os;
#[cfg(target_os = "linux")]
use linux as os;

pub use client::{InjectError, Target, neighbours, target};
pub(crate) use os::namespace;
use os::{Stream, folder};
pub(crate) use server::ControlSocket;

use std::fs;
use std::io::{BufRead, BufReader, Read, Write};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use profinet::IpSuite;
use profinet::controller::Station;

/// First line of a request.
const INJECT: &str = "profidrive inject 2";
/// First line of the request for drives.
const DRIVES: &str = "profidrive drives 1";
/// Longest request or answer, in octets.
const MAX_LENGTH: u64 = 256 * 1024;
/// How long either side waits for the other, from the first octet to the last.
const TIMEOUT: Duration = Duration::from_secs(2);

/// A request of one process to another.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum Request {
    /// Make this happen.
    Inject(InjectRequest),
    /// The drives on this segment: network namespace and interface.
    Drives(String),
}

/// What is to happen to which drive.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct InjectRequest {
    /// Station name, IP or MAC address, or the place at a serial line.
    pub drive: String,
    /// The network namespace of the sender.
    pub from: u64,
    /// What, in the notation of plant files; empty to find out who has the drive.
    pub events: Vec<String>,
    /// How long, in nanoseconds.
    pub lasts: Option<u64>,
}

/// The response to a request.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum Response {
    /// It happened to this drive, or would.
    Done {
        /// The drive in words.
        drive: String,
        /// It is in the network namespace of the sender, or at a serial line.
        here: bool,
    },
    /// This process has no such drive; these are its drives.
    NotHere(Vec<String>),
    /// It cannot happen.
    Refused(String),
    /// The drives on the segment: name, MAC and IP address of each.
    Drives(Vec<Station>),
}

impl Request {
    fn text(&self) -> String {
        match self {
            Self::Inject(request) => request.text(),
            Self::Drives(segment) => format!("{DRIVES}\n{segment}\n"),
        }
    }

    fn read(from: impl Read) -> Option<Self> {
        let mut lines = BufReader::new(from.take(MAX_LENGTH)).lines();
        match lines.next()?.ok()?.as_str() {
            INJECT => InjectRequest::read(lines).map(Self::Inject),
            DRIVES => lines.next()?.ok().map(Self::Drives),
            _ => None,
        }
    }
}

impl InjectRequest {
    fn text(&self) -> String {
        let mut text = format!("{INJECT}\ndrive {}\nfrom {}\n", self.drive, self.from);
        if let Some(nanos) = self.lasts {
            text += &format!("for {nanos}\n");
        }
        for event in &self.events {
            text += &format!("do {event}\n");
        }
        text + "end\n"
    }

    /// Returns the lines after the first one.
    fn read(mut lines: impl Iterator<Item = std::io::Result<String>>) -> Option<Self> {
        let mut request = Self {
            drive: lines.next()?.ok()?.strip_prefix("drive ")?.to_owned(),
            from: lines.next()?.ok()?.strip_prefix("from ")?.parse().ok()?,
            events: Vec::new(),
            lasts: None,
        };
        for line in lines {
            match line
                .ok()?
                .split_once(' ')
                .map(|(word, rest)| (word.to_owned(), rest.to_owned()))
            {
                None => return Some(request), // end
                Some((word, rest)) if word == "for" => request.lasts = Some(rest.parse().ok()?),
                Some((word, rest)) if word == "do" => request.events.push(rest),
                Some(_) => return None,
            }
        }
        None
    }
}

impl Response {
    fn text(&self) -> String {
        let line = |text: &str| text.replace('\n', " ");
        match self {
            Self::Done { drive, here: true } => format!("here {}\n", line(drive)),
            Self::Done { drive, here: false } => format!("elsewhere {}\n", line(drive)),
            Self::NotHere(drives) => format!("not-here {}\n", line(&drives.join(" "))),
            Self::Refused(why) => format!("refused {}\n", line(why)),
            Self::Drives(drives) => {
                let drives: Vec<String> = drives
                    .iter()
                    .map(|drive| format!("{}/{}/{}", drive.mac, drive.ip.address, drive.name))
                    .collect();
                format!("drives {}\n", line(&drives.join(" ")))
            }
        }
    }

    fn read(text: &str) -> Option<Self> {
        let (word, rest) = text.trim_end_matches('\n').split_once(' ')?;
        Some(match word {
            "here" | "elsewhere" => Self::Done {
                drive: rest.to_owned(),
                here: word == "here",
            },
            "not-here" => Self::NotHere(rest.split_whitespace().map(str::to_owned).collect()),
            "refused" => Self::Refused(rest.to_owned()),
            "drives" => Self::Drives(rest.split_whitespace().map(station).collect::<Option<_>>()?),
            _ => return None,
        })
    }
}

/// One drive of [`Response::Drives`].
fn station(text: &str) -> Option<Station> {
    let (mac, rest) = text.split_once('/')?;
    let (ip, name) = rest.split_once('/')?;
    Some(Station {
        mac: mac.parse().ok()?,
        ip: IpSuite {
            address: ip.parse().ok()?,
            ..IpSuite::NONE
        },
        name: name.to_owned(),
        ..Station::default()
    })
}

/// Names an interface: one of the same name in another network namespace is another one.
pub(crate) fn segment(interface: &str) -> String {
    format!("{}/{interface}", namespace())
}

/// Why the control sockets cannot be used.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ControlSocketError {
    /// This system has none.
    #[error("a simulation can be reached from outside on Linux only")]
    Unsupported,
    /// The folder of the sockets cannot be made, or others can open it.
    #[error("{}: {why}", path.display())]
    Folder {
        /// The folder.
        path: PathBuf,
        /// What is wrong with it.
        why: String,
    },
    /// The folder or a socket in it cannot be opened.
    #[error("cannot {action} {}: {source}", path.display())]
    Io {
        /// What was tried.
        action: &'static str,
        /// Folder or socket.
        path: PathBuf,
        /// Why it failed.
        source: std::io::Error,
    },
}

/// Returns the sockets of all running simulations, in a stable order.
fn sockets() -> Result<Vec<PathBuf>, ControlSocketError> {
    let path = folder()?;
    let entries = fs::read_dir(&path).map_err(|source| ControlSocketError::Io {
        action: "read",
        path,
        source,
    })?;
    let mut found: Vec<_> = entries
        .filter_map(|entry| Some(entry.ok()?.path()))
        .filter(|path| path.extension().is_some_and(|ending| ending == "sock"))
        .collect();
    found.sort();
    Ok(found)
}

/// Sends a request to one process and returns its response.
fn send(socket: &Path, request: &Request) -> std::io::Result<Option<Response>> {
    let stream = Stream::connect(socket)?;
    Deadline::new(&stream, TIMEOUT).write_all(request.text().as_bytes())?;
    let mut answer = String::new();
    // the other side waits for the request first, then for the thread that runs the drives
    let answering = Deadline::new(&stream, 2 * TIMEOUT);
    answering.take(MAX_LENGTH).read_to_string(&mut answer)?;
    Ok(Response::read(&answer))
}

/// Receives one request and sends the response that `decide` finds.
fn serve(stream: &Stream, decide: impl FnOnce(Request) -> Response) -> std::io::Result<()> {
    let response = Request::read(Deadline::new(stream, TIMEOUT))
        .map_or_else(|| Response::Refused("not a valid request".into()), decide);
    Deadline::new(stream, TIMEOUT).write_all(response.text().as_bytes())
}

/// A stream with one deadline for everything: a time limit for each call would let a peer that sends an octet now and
/// then stay for ever.
struct Deadline<'s> {
    stream: &'s Stream,
    until: Instant,
}

impl<'s> Deadline<'s> {
    fn new(stream: &'s Stream, time: Duration) -> Self {
        Self {
            stream,
            until: Instant::now() + time,
        }
    }

    /// Returns the time that is left.
    fn left(&self) -> std::io::Result<Option<Duration>> {
        let left = self.until.saturating_duration_since(Instant::now());
        if left.is_zero() {
            return Err(std::io::ErrorKind::TimedOut.into());
        }
        Ok(Some(left))
    }
}

impl Read for Deadline<'_> {
    fn read(&mut self, buffer: &mut [u8]) -> std::io::Result<usize> {
        self.stream.set_read_timeout(self.left()?)?;
        self.stream.read(buffer)
    }
}

impl Write for Deadline<'_> {
    fn write(&mut self, octets: &[u8]) -> std::io::Result<usize> {
        self.stream.set_write_timeout(self.left()?)?;
        self.stream.write(octets)
    }

    fn flush(&mut self) -> std::io::Result<()> {
        self.stream.flush()
    }
}

#[cfg(all(test, target_os = "linux"))]
mod tests {
    use super::*;

    #[test]
    fn requests_and_answers_survive_the_way() {
        let request = InjectRequest {
            drive: "akd-1".into(),
            from: namespace(),
            events: vec!["fault=439!".into(), "answers=late 500ms".into()],
            lasts: Some(2_000_000_000),
        };
        let request = Request::Inject(request);
        assert_eq!(Request::read(request.text().as_bytes()), Some(request.clone()));
        let roll = Request::Drives(segment("eth0"));
        assert_eq!(Request::read(roll.text().as_bytes()), Some(roll));
        let drives = ["02:00:00:00:00:01/0.0.0.0/", "02:00:00:00:00:02/10.0.0.2/akd-2"].map(station);
        let drives = Response::Drives(drives.into_iter().flatten().collect());
        assert_eq!(Response::read(&drives.text()), Some(drives.clone()));
        assert!(matches!(drives, Response::Drives(drives) if drives.len() == 2));
        for here in [true, false] {
            let drive = "akd-1 (on field)".to_owned();
            let done = Response::Done { drive, here };
            assert_eq!(Response::read(&done.text()), Some(done));
        }
        let (near, far) = Stream::pair().unwrap();
        let sender = std::thread::spawn(move || {
            let mut near = near;
            near.write_all(request.text().as_bytes()).unwrap();
            let mut answer = String::new();
            near.read_to_string(&mut answer).unwrap();
            Response::read(&answer)
        });
        serve(&far, |request| match request {
            Request::Inject(request) => Response::NotHere(vec![request.drive, "akd-2".into()]),
            Request::Drives(_) => Response::Drives(Vec::new()),
        })
        .unwrap();
        drop(far);
        assert_eq!(
            sender.join().unwrap(),
            Some(Response::NotHere(vec!["akd-1".into(), "akd-2".into()]))
        );
    }

    #[test]
    fn a_peer_that_sends_an_octet_now_and_then_is_left_at_the_deadline() {
        let (mut near, far) = Stream::pair().unwrap();
        near.write_all(b"profidrive inj").unwrap();
        let mut stream = Deadline::new(&far, Duration::ZERO);
        let error = stream.read(&mut [0; 4]).unwrap_err();
        assert_eq!(error.kind(), std::io::ErrorKind::TimedOut);
        assert!(stream.write(b"x").is_err());
    }

    #[test]
    fn what_is_no_request_is_refused() {
        for text in [
            "",
            "hello\n",
            "profidrive inject 2\n",
            "profidrive inject 2\ndrive a\nend\n",
            "profidrive inject 2\ndrive a\nfrom x\nend\n",
            "profidrive inject 2\ndrive a\nfrom 1\ndo x=1\n",
            "profidrive inject 2\ndrive a\nfrom 1\nfor x\nend\n",
            "profidrive drives 1\n",
        ] {
            assert_eq!(Request::read(text.as_bytes()), None, "{text}");
        }
    }

    #[test]
    fn an_endless_request_is_read_up_to_its_bound() {
        for head in ["", "profidrive inject 2\ndrive a\nfrom 1\ndo "] {
            let mut endless = head.as_bytes().chain(std::io::repeat(b'x').take(4 * MAX_LENGTH));
            assert_eq!(Request::read(&mut endless), None);
            let rest = std::io::copy(&mut endless, &mut std::io::sink()).unwrap();
            assert_eq!(rest, 3 * MAX_LENGTH + head.len() as u64);
        }
    }
}

//! The way to a running `profidrive simulate`: a socket in a folder of the user, one for each process.
//!
//! A request is a few lines of text: the drive, perhaps how long, and what is to happen; the answer is one line. Nobody
//! but the user can open the folder.

use std::fs;
use std::io::{BufRead, BufReader, Read, Write};
use std::os::unix::fs::{DirBuilderExt, MetadataExt};
use std::os::unix::net::UnixStream;
use std::path::{Path, PathBuf};
use std::time::Duration;

use crate::failure::{Exit, Failure};

/// First line of a request.
const GREETING: &str = "profidrive inject 1";
/// Longest request, in octets.
const LONGEST: u64 = 64 * 1024;
/// How long either side waits for the other.
const PATIENCE: Duration = Duration::from_secs(2);

/// What is to happen to which drive.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Request {
    /// Station name, IP or MAC address.
    pub drive: String,
    /// What, in the notation of scenarios; nothing asks who has the drive.
    pub happenings: Vec<String>,
    /// How long, in nanoseconds.
    pub lasts: Option<u64>,
}

/// What became of a request.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Answer {
    /// It happened to this drive, or would.
    Done(String),
    /// This process has no such drive; these are its drives.
    NotHere(Vec<String>),
    /// It cannot happen.
    Refused(String),
}

impl Request {
    fn text(&self) -> String {
        let mut text = format!("{GREETING}\ndrive {}\n", self.drive);
        if let Some(nanos) = self.lasts {
            text += &format!("for {nanos}\n");
        }
        for happening in &self.happenings {
            text += &format!("do {happening}\n");
        }
        text + "end\n"
    }

    fn read(from: impl Read) -> Option<Self> {
        let mut lines = BufReader::new(from.take(LONGEST)).lines();
        if lines.next()?.ok()? != GREETING {
            return None;
        }
        let mut request = Self {
            drive: lines.next()?.ok()?.strip_prefix("drive ")?.to_owned(),
            happenings: Vec::new(),
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
                Some((word, rest)) if word == "do" => request.happenings.push(rest),
                Some(_) => return None,
            }
        }
        None
    }
}

impl Answer {
    fn text(&self) -> String {
        let line = |text: &str| text.replace('\n', " ");
        match self {
            Self::Done(drive) => format!("done {}\n", line(drive)),
            Self::NotHere(drives) => format!("not-here {}\n", line(&drives.join(" "))),
            Self::Refused(why) => format!("refused {}\n", line(why)),
        }
    }

    fn read(text: &str) -> Option<Self> {
        let (word, rest) = text.trim_end_matches('\n').split_once(' ')?;
        Some(match word {
            "done" => Self::Done(rest.to_owned()),
            "not-here" => Self::NotHere(rest.split_whitespace().map(str::to_owned).collect()),
            "refused" => Self::Refused(rest.to_owned()),
            _ => return None,
        })
    }
}

/// The folder of the sockets, made if it is not there.
pub fn folder() -> Result<PathBuf, Failure> {
    let user = user();
    let path = match std::env::var_os("XDG_RUNTIME_DIR").filter(|path| Path::new(path).is_dir()) {
        Some(runtime) => PathBuf::from(runtime).join("profidrive"),
        None => std::env::temp_dir().join(format!("profidrive-{user}")),
    };
    let failed = |why: String| {
        Failure::new(Exit::Failed, format!("{}: {why}", path.display()))
            .hint("the folder of running simulations must belong to you alone; XDG_RUNTIME_DIR chooses another place")
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

/// The user this program runs as: whoever owns its own entry in /proc.
fn user() -> u32 {
    fs::metadata("/proc/self").map_or(0, |own| own.uid())
}

/// Asks one process.
pub fn ask(socket: &Path, request: &Request) -> std::io::Result<Option<Answer>> {
    let mut stream = UnixStream::connect(socket)?;
    stream.set_read_timeout(Some(PATIENCE))?;
    stream.set_write_timeout(Some(PATIENCE))?;
    stream.write_all(request.text().as_bytes())?;
    let mut answer = String::new();
    stream.take(LONGEST).read_to_string(&mut answer)?;
    Ok(Answer::read(&answer))
}

/// Takes one request and gives the answer that `decide` finds.
pub fn serve(stream: &UnixStream, decide: impl FnOnce(Request) -> Answer) -> std::io::Result<()> {
    stream.set_read_timeout(Some(PATIENCE))?;
    stream.set_write_timeout(Some(PATIENCE))?;
    let answer = Request::read(stream).map_or_else(
        || Answer::Refused("this is no request of `profidrive inject`".into()),
        decide,
    );
    let mut stream = stream;
    stream.write_all(answer.text().as_bytes())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn requests_and_answers_survive_the_way() {
        let request = Request {
            drive: "akd-1".into(),
            happenings: vec!["fault=439!".into(), "answers=late 500ms".into()],
            lasts: Some(2_000_000_000),
        };
        assert_eq!(Request::read(request.text().as_bytes()), Some(request.clone()));
        let (near, far) = UnixStream::pair().unwrap();
        let asked = std::thread::spawn(move || {
            let mut near = near;
            near.write_all(request.text().as_bytes()).unwrap();
            let mut answer = String::new();
            near.read_to_string(&mut answer).unwrap();
            Answer::read(&answer)
        });
        serve(&far, |request| {
            Answer::NotHere(vec![request.drive, "akd-2".into()])
        })
        .unwrap();
        drop(far);
        assert_eq!(
            asked.join().unwrap(),
            Some(Answer::NotHere(vec!["akd-1".into(), "akd-2".into()]))
        );
    }

    #[test]
    fn what_is_no_request_is_refused() {
        for text in [
            "",
            "hello\n",
            "profidrive inject 1\n",
            "profidrive inject 1\ndrive a\ndo x=1\n",
            "profidrive inject 1\ndrive a\nfor x\nend\n",
        ] {
            assert_eq!(Request::read(text.as_bytes()), None, "{text}");
        }
    }
}

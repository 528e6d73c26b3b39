//! Questions of other processes, `profidrive inject` above all, on their way to the thread that runs the drives.

use std::fs;
use std::os::unix::net::{UnixListener, UnixStream};
use std::path::PathBuf;
use std::sync::mpsc::{Receiver, Sender, SyncSender, channel, sync_channel};
use std::thread::spawn;
use std::time::{Duration, SystemTime, UNIX_EPOCH};

use network::linux::Bell;

use crate::desk::{Answer, Question, folder, serve};
use crate::failure::{Exit, Failure};

/// Requests that may wait for the thread that runs the drives.
const WAITING: usize = 16;
/// How long a request waits for that thread.
const PATIENCE: Duration = Duration::from_secs(2);

/// A question and where its answer goes.
pub type Letter = (Question, Sender<Answer>);

/// The open socket of this process; it is gone with this value.
#[derive(Debug)]
pub struct Mailbox {
    path: PathBuf,
    letters: Receiver<Letter>,
}

impl Mailbox {
    /// Opens the socket; `bell` rings for every request.
    pub fn open(bell: Bell) -> Result<Self, Failure> {
        // the number of a process alone is not its own: containers that share the folder count for themselves
        let start = SystemTime::now()
            .duration_since(UNIX_EPOCH)
            .unwrap_or_default()
            .as_nanos();
        let path = folder()?.join(format!("simulate-{}-{start:x}.sock", std::process::id()));
        let failed = |error: std::io::Error| {
            Failure::new(
                Exit::Failed,
                format!("cannot listen on {}: {error}", path.display()),
            )
        };
        let listener = UnixListener::bind(&path).map_err(failed)?;
        let (sender, letters) = sync_channel(WAITING);
        // ends with the process: nothing is lost with it
        spawn(move || listen(&listener, &sender, &bell));
        Ok(Self { path, letters })
    }

    /// The next request.
    pub fn take(&self) -> Option<Letter> {
        self.letters.try_recv().ok()
    }
}

impl Drop for Mailbox {
    fn drop(&mut self) {
        let _ = fs::remove_file(&self.path);
    }
}

fn listen(listener: &UnixListener, letters: &SyncSender<Letter>, bell: &Bell) {
    for stream in listener.incoming().flatten() {
        // one that sends nothing holds up the others for two seconds and is left then
        let _ = answer(&stream, letters, bell);
    }
}

fn answer(stream: &UnixStream, letters: &SyncSender<Letter>, bell: &Bell) -> std::io::Result<()> {
    serve(stream, |request| {
        let (sender, answer) = channel();
        let busy = || Answer::Refused("the simulation does not answer".into());
        if letters.try_send((request, sender)).is_err() {
            return busy();
        }
        bell.ring();
        answer.recv_timeout(PATIENCE).unwrap_or_else(|_| busy())
    })
}

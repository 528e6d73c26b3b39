//! Receives requests of other processes and passes them to the thread that runs the drives.

use std::fs;
use std::net::Shutdown;
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, Sender, SyncSender, channel, sync_channel};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::{Builder, sleep, spawn};
use std::time::{Duration, SystemTime, UNIX_EPOCH};

use network::system::Bell;

use super::os::{Listener, Stream, folder};
use super::{ControlSocketError, Request, Response, serve};

/// Requests that may wait for the thread that runs the drives.
const WAITING: usize = 16;
/// Most clients that are served at the same time; further ones wait until one is done.
const CLIENTS: usize = 8;
/// How long to wait before another client is accepted after that failed, at first and at most.
const SHORTEST_REST: Duration = Duration::from_millis(50);
const LONGEST_REST: Duration = Duration::from_secs(2);
/// How long a request waits for that thread.
const TIMEOUT: Duration = Duration::from_secs(2);

/// A request and where its response goes.
pub type Pending = (Request, Sender<Response>);

/// The open socket of this process; it is gone with this value.
#[derive(Debug)]
pub struct ControlSocket {
    path: PathBuf,
    requests: Receiver<Pending>,
    closed: Arc<AtomicBool>,
}

impl ControlSocket {
    /// Opens the socket; `bell` rings for every request.
    pub fn open(bell: Bell) -> Result<Self, ControlSocketError> {
        // the number of a process alone is not its own: containers that share the folder count for themselves
        let start = SystemTime::now()
            .duration_since(UNIX_EPOCH)
            .unwrap_or_default()
            .as_nanos();
        let path = folder()?.join(format!("simulate-{}-{start:x}.sock", std::process::id()));
        let (socket, listen) = Self::at(path, bell)?;
        spawn(listen);
        Ok(socket)
    }

    /// Returns the socket at `path`, and the thread that serves it.
    fn at(path: PathBuf, bell: Bell) -> Result<(Self, impl FnOnce() + Send), ControlSocketError> {
        let listener = Listener::bind(&path).map_err(|source| ControlSocketError::Io {
            action: "listen on",
            path: path.clone(),
            source,
        })?;
        let (sender, requests) = sync_channel(WAITING);
        let closed = Arc::new(AtomicBool::new(false));
        let ended = Arc::clone(&closed);
        let accept = move || {
            let (stream, _) = listener.accept()?;
            Ok((!ended.load(Ordering::Acquire)).then_some(stream))
        };
        let listen = move || listen(accept, &sender, &bell, sleep);
        let socket = Self {
            path,
            requests,
            closed,
        };
        Ok((socket, listen))
    }

    /// Returns the next request.
    pub fn take(&self) -> Option<Pending> {
        self.requests.try_recv().ok()
    }
}

impl Drop for ControlSocket {
    fn drop(&mut self) {
        self.closed.store(true, Ordering::Release);
        // wakes the thread, which ends
        let _ = Stream::connect(&self.path);
        let _ = fs::remove_file(&self.path);
    }
}

/// Clients that are served at the same time.
#[derive(Debug, Default)]
struct Places {
    clients: Mutex<Vec<Client>>,
    freed: Condvar,
}

/// A client that has a place.
#[derive(Debug)]
struct Client {
    stream: Arc<Stream>,
    /// It has sent its request.
    asked: bool,
}

impl Places {
    /// Waits for a free place. Where there is none, the client idle for longest is disconnected: an idle
    /// connection blocks no other.
    fn take(self: &Arc<Self>, stream: Stream) -> Place {
        let stream = Arc::new(stream);
        let mut clients = self.lock();
        while clients.len() >= CLIENTS {
            // its thread ends with the connection, so that there is a place soon
            if let Some(idle) = clients.iter().find(|client| !client.asked) {
                let _ = idle.stream.shutdown(Shutdown::Both);
            }
            clients = self.freed.wait(clients).unwrap_or_else(PoisonError::into_inner);
        }
        clients.push(Client {
            stream: Arc::clone(&stream),
            asked: false,
        });
        Place {
            places: Arc::clone(self),
            stream,
        }
    }

    fn lock(&self) -> MutexGuard<'_, Vec<Client>> {
        self.clients.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// The place of one client, free again when it is dropped.
#[derive(Debug)]
struct Place {
    places: Arc<Places>,
    stream: Arc<Stream>,
}

impl Place {
    /// The client has sent its request and keeps its place until it is answered.
    fn asked(&self) {
        let mut clients = self.places.lock();
        if let Some(own) = clients.iter_mut().find(|client| self.is(client)) {
            own.asked = true;
        }
    }

    fn is(&self, client: &Client) -> bool {
        Arc::ptr_eq(&client.stream, &self.stream)
    }
}

impl Drop for Place {
    fn drop(&mut self) {
        self.places.lock().retain(|client| !self.is(client));
        self.places.freed.notify_one();
    }
}

/// Serves every client in a thread of its own, so that a slow one blocks no other. When `accept` fails (no file handle
/// is left) `rest` waits, longer after each failure. Ends when `accept` returns no client.
fn listen(
    accept: impl Fn() -> std::io::Result<Option<Stream>>,
    requests: &SyncSender<Pending>,
    bell: &Bell,
    rest: impl Fn(Duration),
) {
    let places = Arc::new(Places::default());
    let mut pause = SHORTEST_REST;
    loop {
        let stream = match accept() {
            Ok(Some(stream)) => stream,
            Ok(None) => return,
            Err(_) => {
                rest(pause);
                pause = (pause * 2).min(LONGEST_REST);
                continue;
            }
        };
        pause = SHORTEST_REST;
        let place = places.take(stream);
        let (requests, bell) = (requests.clone(), bell.clone());
        let client = move || {
            // the client may have disconnected
            let _ = answer(&place, &requests, &bell);
        };
        if Builder::new().name("request".into()).spawn(client).is_err() {
            rest(pause);
        }
    }
}

fn answer(place: &Place, requests: &SyncSender<Pending>, bell: &Bell) -> std::io::Result<()> {
    serve(&place.stream, |request| {
        place.asked();
        let (sender, answer) = channel();
        let busy = || Response::Refused("the simulation does not answer".into());
        if requests.try_send((request, sender)).is_err() {
            return busy();
        }
        bell.ring();
        answer.recv_timeout(TIMEOUT).unwrap_or_else(|_| busy())
    })
}

#[cfg(all(test, target_os = "linux"))]
mod tests {
    use super::*;
    use crate::control_socket::send;
    use std::io::{self, Read, Write};

    fn path(name: &str) -> PathBuf {
        let path = std::env::temp_dir().join(format!("profidrive-{name}-{}.sock", std::process::id()));
        let _ = fs::remove_file(&path);
        path
    }

    #[test]
    fn the_thread_ends_with_the_socket() {
        let path = path("end");
        let (socket, listen) = ControlSocket::at(path.clone(), Bell::new().unwrap()).unwrap();
        let (sender, ended) = channel();
        spawn(move || {
            listen();
            sender.send(()).unwrap();
        });
        drop(socket);
        ended.recv_timeout(Duration::from_secs(10)).unwrap();
        assert!(!path.exists());
    }

    /// The kernel keeps 128 connections that are not accepted; more block the next one.
    #[test]
    fn silent_clients_do_not_block_others() {
        let path = path("slow");
        let (socket, listen) = ControlSocket::at(path.clone(), Bell::new().unwrap()).unwrap();
        spawn(listen);
        spawn(move || {
            while let Ok((request, answer)) = socket.requests.recv() {
                assert!(matches!(request, Request::Drives(_)));
                let _ = answer.send(Response::Drives(Vec::new()));
            }
        });
        for idle in [1, 300] {
            let mut idle: Vec<Stream> = (0..idle).map(|_| Stream::connect(&path).unwrap()).collect();
            let answer = send(&path, &Request::Drives("1/eth0".into())).unwrap();
            assert_eq!(answer, Some(Response::Drives(Vec::new())));
            // the newest is still waited for
            let newest = idle.last_mut().unwrap();
            newest.set_nonblocking(true).unwrap();
            let waits = newest.read(&mut [0]).map_err(|error| error.kind());
            assert_eq!(waits, Err(io::ErrorKind::WouldBlock));
        }
        fs::remove_file(path).unwrap();
    }

    #[test]
    fn without_file_handles_it_rests_longer_each_time() {
        let (sender, _requests) = sync_channel(1);
        let (rested, rests) = sync_channel(0);
        let bell = Bell::new().unwrap();
        let rest = move |pause| {
            if rested.send(pause).is_err() {
                std::thread::park();
            }
        };
        let accept = || Err(io::Error::from_raw_os_error(24)); // EMFILE
        // ends with the test program
        spawn(move || listen(accept, &sender, &bell, rest));
        let rests: Vec<u128> = rests.iter().take(8).map(|pause| pause.as_millis()).collect();
        assert_eq!(rests, [50, 100, 200, 400, 800, 1600, 2000, 2000]);
    }

    #[test]
    fn a_request_for_which_there_is_no_room_is_refused_at_once() {
        let (requests, waiting) = sync_channel(WAITING);
        for _ in 0..WAITING {
            let request = Request::Drives(String::new());
            requests.try_send((request, channel().0)).unwrap();
        }
        let (mut client, server) = Stream::pair().unwrap();
        let request = Request::Drives("1/eth0".into());
        client.write_all(request.text().as_bytes()).unwrap();
        client.shutdown(Shutdown::Write).unwrap();
        let place = Arc::new(Places::default()).take(server);
        let began = std::time::Instant::now();
        answer(&place, &requests, &Bell::new().unwrap()).unwrap();
        assert!(began.elapsed() < TIMEOUT);
        drop(place);
        let mut text = String::new();
        client.read_to_string(&mut text).unwrap();
        assert!(text.contains("the simulation does not answer"), "{text}");
        assert_eq!(waiting.try_iter().count(), WAITING);
    }

    #[test]
    fn no_more_clients_than_there_are_places() {
        let places = Arc::new(Places::default());
        let client = || Stream::pair().unwrap().0;
        let held: Vec<Place> = (0..CLIENTS).map(|_| places.take(client())).collect();
        held.iter().for_each(Place::asked);
        let (sender, got) = channel();
        let next = Arc::clone(&places);
        spawn(move || {
            let place = next.take(client());
            sender.send(()).unwrap();
            drop(place);
        });
        assert_eq!(places.lock().len(), CLIENTS);
        assert!(got.try_recv().is_err());
        drop(held);
        got.recv().unwrap();
    }
}

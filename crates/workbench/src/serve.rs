//! Listening, serving and ending.

use std::cell::RefCell;
use std::io;
use std::net::{SocketAddr, TcpListener as Listener};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use axum::http::StatusCode;
use axum::middleware::{from_fn, from_fn_with_state};
use axum::routing::any;
use axum::{Extension, Router};
use hyper::server::conn::http1;
use hyper_util::rt::{TokioIo, TokioTimer};
use hyper_util::service::TowerToHyperService;
use profidrive::client::{Advice, ErrorKind};
use profidrive::plant::PlantError;
use profidrive::traffic::Traffic;
use profidrive::{Explained, First, Network, OpenError, Rank, Stop, Transport, now};
use tokio::io::{AsyncRead, AsyncWrite};
use tokio::net::TcpListener;
use tokio::sync::Semaphore;
use tokio::time::{interval, sleep, timeout};
use tower_http::limit::RequestBodyLimitLayer;
use tower_http::timeout::TimeoutLayer;

use crate::access::{Attempts, Once, Peer, Places, Sessions, Tls, TlsError, Tokens, guard, secure};
use crate::api::{large_router, long_router, nothing, of_a_simulation, router, while_it_runs};
use crate::assets;
use crate::audit::{Audit, Flood};
use crate::board::Board;
use crate::captures::Captures;
use crate::control::Control;
use crate::frames::{Frames, follow};
use crate::jobs::Jobs;
use crate::live::{Feeds, Hub, produce};
use crate::room::{self, Room};
use crate::settings::{Settings, Source};
use crate::shared::Shared;
use crate::upgrade::SOCKETS;

/// The longest head of a request, in octets.
const HEAD: usize = 64 << 10;
/// The longest body of a request, in octets.
const BODY: usize = 256 << 10;
/// Time for the head of a request.
const HEAD_TIME: Duration = Duration::from_secs(10);
/// Time for a request and its answer.
const REQUEST_TIME: Duration = Duration::from_secs(20);
/// The longest time of the stop of one drive: that of its ramp.
const STOP_TIME: Duration = Duration::from_secs(120);
/// Time for a large file.
const UPLOAD_TIME: Duration = Duration::from_secs(300);
/// Pause after a connection that could not be taken, as when the process has no file handle left.
const RETRY: Duration = Duration::from_millis(100);
/// Time between two looks at the wish to end.
const LOOK: Duration = Duration::from_millis(20);

/// Why a server does not start.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ServeError {
    /// Without encryption the server is for this computer alone.
    #[error("{0} can be reached from other computers, which needs encryption (TLS)")]
    NotLocal(SocketAddr),
    /// What is to encrypt cannot be used.
    #[error(transparent)]
    Tls(#[from] TlsError),
    /// The public address is none of a page.
    #[error("{0} is no address of a page: https://HOST or https://HOST:PORT")]
    PublicUrl(String),
    /// The address is not one of this computer, or the port is in use.
    #[error("cannot listen on {address}: {error}")]
    Listen {
        /// The address.
        address: SocketAddr,
        /// Why.
        error: io::Error,
    },
    /// What carries the network has failed: no frame leaves any more, and each drive stops its axis by its own watchdog.
    #[error("{0}")]
    Carrier(profidrive::client::Error),
    /// The network cannot be opened.
    #[error(transparent)]
    Open(#[from] OpenError),
    /// The plant is not valid.
    #[error("the plant: {0}")]
    Plant(#[from] PlantError),
    /// The operating system has no thread, descriptor or random number left.
    #[error("cannot start the server: {0}")]
    System(#[from] io::Error),
}

impl Explained for ServeError {
    fn kind(&self) -> ErrorKind {
        match self {
            Self::NotLocal(_) | Self::PublicUrl(_) | Self::Tls(_) | Self::Plant(_) => ErrorKind::Usage,
            Self::Open(error) => error.kind(),
            Self::Listen { .. } | Self::System(_) => ErrorKind::Local,
            Self::Carrier(_) => ErrorKind::Internal,
        }
    }

    fn advice(&self) -> Advice {
        match self {
            Self::NotLocal(address) => format!(
                "listen on 127.0.0.1; from another computer, `ssh -L {port}:127.0.0.1:{port} HOST` leads there",
                port = address.port()
            )
            .into(),
            Self::Tls(TlsError::Readable(path)) => {
                format!("`chmod 600 {}` keeps it from them", path.display()).into()
            }
            Self::Open(error) => error.advice(),
            Self::Carrier(_) => Advice::from(
                "each axis that was under control stops by the watchdog of its drive: look at the drives, then start the server again",
            ),
            _ => Advice::default(),
        }
    }
}

/// A server that listens. It serves while [`run`](Self::run) runs.
#[derive(Debug)]
pub struct Server {
    listener: Listener,
    address: SocketAddr,
    network: Network,
    /// Why its log cannot be written.
    unlogged: Option<String>,
    shared: Arc<Shared>,
    tls: Option<Tls>,
    stop: Stop,
}

impl Server {
    /// Listens, and opens the network. Nothing is sent before [`run`](Self::run), which ends once `stop` is raised.
    ///
    /// # Errors
    /// When the address cannot be used, or the network cannot be opened.
    pub fn open(settings: Settings, stop: Stop) -> Result<Self, ServeError> {
        let Settings {
            source,
            listen,
            tls,
            public_url,
            moves_remotely,
            name,
            read_only,
            log,
        } = settings;
        if !listen.ip().is_loopback() && tls.is_none() {
            return Err(ServeError::NotLocal(listen));
        }
        let refused = |error| ServeError::Listen {
            address: listen,
            error,
        };
        let listener = Listener::bind(listen).map_err(refused)?;
        listener.set_nonblocking(true)?;
        let address = listener.local_addr()?;
        let places = Places::new(address, tls.is_some(), public_url.as_deref());
        let places = places.map_err(ServeError::PublicUrl)?;
        let tls = tls.map(|certificate| Tls::new(&certificate, &places.names(), log.as_deref()));
        let tls = tls.transpose()?;
        let opening = source.opening()?.stopped_by(stop.clone());
        let traffic = Traffic::new();
        let network = opening.clone().kept_in(&traffic).open()?;
        let addresses = match &source {
            Source::Addresses(addresses) => addresses.clone(),
            _ => Vec::new(),
        };
        let now = Instant::now();
        let boot = Tokens::random()?.view();
        let audit = Audit::new(log.clone(), boot.clone());
        // looking and STOP need no log, and a folder may be there again later: the server starts
        let unlogged = audit.check().err().map(|error| error.to_string());
        let shared = Shared {
            tokens: Tokens::random()?,
            once: Mutex::new(Once::default()),
            read_only,
            moves_remotely,
            encrypted: tls.is_some(),
            places,
            cookie: format!("profidrive_{}", address.port()),
            plant: Mutex::new(source.plant()?),
            source,
            name,
            backups: log.as_ref().map(|log| log.join("backups")),
            jobs: Jobs::default(),
            naming: tokio::sync::Mutex::default(),
            captures: Captures::new(log.as_deref()),
            happened: Mutex::default(),
            audit: Arc::new(audit),
            boot,
            control: Control::new(),
            network: network.clone(),
            board: Arc::new(Board::new(opening, addresses, now)),
            hub: Hub::new(now),
            feeds: Feeds::default(),
            frames: Frames::new(traffic),
            sockets: Arc::new(Semaphore::new(SOCKETS)),
            control_sockets: Arc::new(Semaphore::new(SOCKETS)),
            sessions: Mutex::new(Sessions::default()),
            attempts: Mutex::new(Attempts::new(now)),
            refusals: Mutex::new(Flood::new(now)),
            idle_stops: Mutex::new(Flood::new(now)),
        };
        Ok(Self {
            listener,
            address,
            network,
            unlogged,
            shared: Arc::new(shared),
            tls,
            stop,
        })
    }

    /// Returns the address that it listens on.
    #[must_use]
    pub const fn address(&self) -> SocketAddr {
        self.address
    }

    fn with_token(&self, token: &str) -> String {
        // what is behind `#` is sent to no server
        format!("{}/#token={token}", self.shared.places.url(self.address))
    }

    /// Returns the fingerprint (SHA-256) of its certificate, as browsers show it; `None` without encryption.
    #[must_use]
    pub fn fingerprint(&self) -> Option<&str> {
        self.tls.as_ref().map(Tls::fingerprint)
    }

    /// Returns why the log cannot be written, as it was at the start: while that is so nothing is changed and no axis is moved, and
    /// STOP works. `None` where it can be written.
    #[must_use]
    pub fn unlogged(&self) -> Option<&str> {
        self.unlogged.as_deref()
    }

    /// Returns the address for a browser, with the token that allows everything; of a server that changes nothing the same as
    /// [`view_url`](Self::view_url).
    #[must_use]
    pub fn url(&self) -> String {
        match self.shared.read_only {
            true => self.view_url(),
            false => self.with_token(&self.shared.tokens.control()),
        }
    }

    /// Returns an address like [`url`](Self::url) that begins one session, within a minute: for a browser that is started with
    /// it as an argument, which all users of a computer can see. A later call ends that of an earlier one.
    ///
    /// # Errors
    /// When the operating system has no random numbers.
    pub fn url_once(&self) -> io::Result<String> {
        let token = self.shared.once().begin(Instant::now())?;
        Ok(self.with_token(&token))
    }

    /// Returns the address for a browser that looks and stops, and changes nothing.
    #[must_use]
    pub fn view_url(&self) -> String {
        self.with_token(&self.shared.tokens.view())
    }

    /// Serves until its stop is raised, brings every axis to rest along its ramp, and closes the network. Pages are served until
    /// all axes are at rest: STOP works meanwhile. Where the stop becomes urgent, what is left of a ramp is a quick stop (OFF3).
    ///
    /// # Errors
    /// When the operating system has no thread left.
    pub fn run(self) -> Result<(), ServeError> {
        let Self {
            listener,
            network,
            shared,
            tls,
            stop,
            ..
        } = self;
        let threads = |name: &str| {
            let mut threads = tokio::runtime::Builder::new_multi_thread();
            threads.worker_threads(2).thread_name(name).enable_all();
            threads
        };
        let runtime = threads("profidrive-web").on_thread_unpark(answer_first).build()?;
        // whatever requests cost there, no STOP waits for it
        let work = threads("profidrive-work").build()?;
        let room = Room::new(work.handle().clone());
        let served = runtime.block_on(async {
            let listener = TcpListener::from_std(listener)?;
            tokio::spawn(Arc::clone(&shared.board).survey(network.clone()));
            tokio::spawn(Arc::clone(&shared.board).read(network.clone()));
            tokio::spawn(produce(Arc::clone(&shared)));
            tokio::spawn(follow(Arc::clone(&shared)));
            let caller = network.clone();
            tokio::select! {
                () = accept(listener, room, Arc::clone(&shared), tls) => Ok(()),
                () = rested(&stop, &shared.control, network.transport()) => Ok(()),
                // pages of a network that nothing carries any more would show what is not so: they lose their server instead
                failure = caller.carrier_ended() => Err(ServeError::Carrier(failure)),
            }
        });
        work.shutdown_timeout(Duration::from_secs(1));
        runtime.shutdown_timeout(Duration::from_secs(1));
        drop(network);
        served
    }
}

/// Lets a thread that serves connections run before other programs, a browser among them: STOP comes to it. What else is requested has
/// other threads.
fn answer_first() {
    thread_local! {
        static FIRST: RefCell<First> = RefCell::new(First::new(Rank::Answers));
    }
    FIRST.with_borrow_mut(|first| first.turn(now()));
}

/// Waits until `stop` is raised, and until every axis is at rest then.
async fn rested(stop: &Stop, control: &Control, transport: &Transport) {
    let mut turn = interval(LOOK);
    while !stop.is_stopped() {
        turn.tick().await;
    }
    if let Transport::Plant(plant) = transport {
        // what ends needs the time of the plant
        plant.pause(false);
    }
    while control.has_axes() || control.stops.is_any() {
        // one that a page takes meanwhile too
        control.end();
        turn.tick().await;
    }
}

fn app(shared: Arc<Shared>) -> Router {
    let in_time = |time| TimeoutLayer::with_status_code(StatusCode::REQUEST_TIMEOUT, time);
    let bounded = |routes: Router<Arc<Shared>>, time| {
        routes
            .layer(RequestBodyLimitLayer::new(BODY))
            .layer(from_fn_with_state(Arc::clone(&shared), while_it_runs))
            .layer(from_fn_with_state(Arc::clone(&shared), of_a_simulation))
            .layer(in_time(time))
    };
    let all = router()
        .route("/api/{*path}", any(nothing))
        .fallback(assets::serve);
    bounded(all, REQUEST_TIME)
        .merge(bounded(long_router(), STOP_TIME))
        .merge(large_router().layer(in_time(UPLOAD_TIME)))
        .layer(from_fn(room::carry_out))
        .layer(from_fn_with_state(Arc::clone(&shared), guard))
        .layer(from_fn(secure))
        .with_state(shared)
}

async fn accept(listener: TcpListener, room: Room, shared: Arc<Shared>, tls: Option<Tls>) {
    let app = app(shared);
    let room = Arc::new(room);
    loop {
        let Ok((stream, peer)) = listener.accept().await else {
            sleep(RETRY).await;
            continue;
        };
        let place = room.enter().await;
        let app = app
            .clone()
            .layer(Extension(Peer(peer)))
            .layer(Extension(place.requests()));
        let tls = tls.clone();
        tokio::spawn(async move {
            let served = async {
                // a client that is too slow or uses another protocol is disconnected
                match tls {
                    None => attend(stream, app).await,
                    Some(tls) => {
                        if let Ok(Ok(stream)) = timeout(HEAD_TIME, tls.accept(stream)).await {
                            attend(stream, app).await;
                        }
                    }
                }
            };
            tokio::select! {
                () = served => {}
                () = place.ended() => {}
            }
        });
    }
}

/// Serves one connection until it ends.
async fn attend(stream: impl AsyncRead + AsyncWrite + Unpin + Send + 'static, app: Router) {
    let connection = http1::Builder::new()
        .timer(TokioTimer::new())
        .header_read_timeout(HEAD_TIME)
        .max_buf_size(HEAD)
        .serve_connection(TokioIo::new(stream), TowerToHyperService::new(app))
        .with_upgrades();
    let _ = connection.await;
}

#[cfg(test)]
mod tests {
    use std::future::Future;
    use std::pin::pin;
    use std::sync::atomic::{AtomicBool, Ordering};
    use std::task::{Context, Wake, Waker};

    use super::*;

    /// Panics in the thread that wakes it first: that which carries the network.
    struct Bomb(AtomicBool);

    impl Wake for Bomb {
        fn wake(self: Arc<Self>) {
            assert!(
                self.0.swap(true, Ordering::Relaxed),
                "an error in the thread that carries the network"
            );
        }
    }

    #[test]
    fn a_server_whose_network_thread_panics_ends_with_that_error() {
        let settings = Settings {
            listen: "127.0.0.1:0".parse().unwrap(),
            log: None,
            ..Settings::new(Source::Demo)
        };
        let server = Server::open(settings, Stop::new().unwrap()).unwrap();
        let mut network: profidrive::Caller = server.network.clone();
        let address = server.address();
        let serving = std::thread::spawn(move || server.run());
        let waker = Waker::from(Arc::new(Bomb(AtomicBool::new(false))));
        {
            let mut call = pin!(network.pass(Duration::from_millis(20)));
            let looked = call.as_mut().poll(&mut Context::from_waker(&waker));
            assert!(looked.is_pending());
            let begin = Instant::now();
            while !serving.is_finished() {
                assert!(
                    begin.elapsed() < Duration::from_secs(30),
                    "it serves a dead network"
                );
                std::thread::sleep(Duration::from_millis(10));
            }
        }
        let error = serving.join().unwrap().unwrap_err();
        assert!(matches!(error, ServeError::Carrier(_)), "{error}");
        assert_eq!(error.kind(), ErrorKind::Internal);
        assert!(
            error.to_string().contains("nothing is carried any more"),
            "{error}"
        );
        // pages lose their connection
        assert!(std::net::TcpStream::connect(address).is_err());
    }
}

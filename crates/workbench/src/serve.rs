//! Listening, serving and ending.

use std::io;
use std::net::{SocketAddr, TcpListener as Listener};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use axum::Router;
use axum::http::StatusCode;
use axum::middleware::{from_fn, from_fn_with_state};
use axum::routing::any;
use hyper::server::conn::http1;
use hyper_util::rt::{TokioIo, TokioTimer};
use hyper_util::service::TowerToHyperService;
use profidrive::client::{Advice, ErrorKind};
use profidrive::plant::PlantError;
use profidrive::traffic::Traffic;
use profidrive::{Explained, Network, OpenError, Stop};
use tokio::net::TcpListener;
use tokio::sync::Semaphore;
use tokio::time::{interval, sleep};
use tower_http::limit::RequestBodyLimitLayer;
use tower_http::timeout::TimeoutLayer;

use crate::access::{Attempts, Once, Places, Sessions, Tokens, guard, secure};
use crate::api::{large_router, nothing, router};
use crate::assets;
use crate::audit::Audit;
use crate::board::Board;
use crate::captures::Captures;
use crate::control::Control;
use crate::frames::{Frames, follow};
use crate::jobs::Jobs;
use crate::live::{Hub, produce};
use crate::settings::{Settings, Source};
use crate::shared::Shared;

/// Connections served at once; further ones wait in the queue of the system.
const CONNECTIONS: usize = 256;
/// Sockets of pages at once.
const SOCKETS: usize = 64;
/// The longest head of a request, in octets.
const HEAD: usize = 64 << 10;
/// The longest body of a request, in octets.
const BODY: usize = 256 << 10;
/// Time for the head of a request.
const HEAD_TIME: Duration = Duration::from_secs(10);
/// Time for a request and its answer.
const REQUEST_TIME: Duration = Duration::from_secs(20);
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
    #[error("{0} can be reached from other computers, which needs encryption (TLS); this version has none")]
    NotLocal(SocketAddr),
    /// The address is not one of this computer, or the port is in use.
    #[error("cannot listen on {address}: {error}")]
    Listen {
        /// The address.
        address: SocketAddr,
        /// Why.
        error: io::Error,
    },
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
            Self::NotLocal(_) | Self::Plant(_) => ErrorKind::Usage,
            Self::Open(error) => error.kind(),
            Self::Listen { .. } | Self::System(_) => ErrorKind::Local,
        }
    }

    fn advice(&self) -> Advice {
        match self {
            Self::NotLocal(address) => format!(
                "listen on 127.0.0.1; from another computer, `ssh -L {port}:127.0.0.1:{port} HOST` leads there",
                port = address.port()
            )
            .into(),
            Self::Open(error) => error.advice(),
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
    shared: Arc<Shared>,
}

impl Server {
    /// Listens, and opens the network. Nothing is sent before [`run`](Self::run).
    ///
    /// # Errors
    /// When the address cannot be used, or the network cannot be opened.
    pub fn open(settings: Settings) -> Result<Self, ServeError> {
        let Settings {
            source,
            listen,
            name,
            read_only,
            moves_real,
            log,
        } = settings;
        if !listen.ip().is_loopback() {
            return Err(ServeError::NotLocal(listen));
        }
        let refused = |error| ServeError::Listen {
            address: listen,
            error,
        };
        let listener = Listener::bind(listen).map_err(refused)?;
        listener.set_nonblocking(true)?;
        let address = listener.local_addr()?;
        let opening = source.opening()?;
        let traffic = Traffic::new();
        let network = opening.clone().kept_in(&traffic).open()?;
        let addresses = match &source {
            Source::Addresses(addresses) => addresses.clone(),
            _ => Vec::new(),
        };
        let now = Instant::now();
        let boot = Tokens::random()?.view();
        let shared = Shared {
            tokens: Tokens::random()?,
            once: Mutex::new(Once::default()),
            read_only,
            moves_real,
            places: Places::new(address),
            cookie: format!("profidrive_{}", address.port()),
            source,
            name,
            backups: log.as_ref().map(|log| log.join("backups")),
            jobs: Jobs::default(),
            captures: Captures::new(log.as_deref()),
            happened: Mutex::default(),
            audit: Arc::new(Audit::new(log, boot.clone())),
            boot,
            control: Control::new(),
            network: network.clone(),
            board: Arc::new(Board::new(opening, addresses, now)),
            hub: Hub::new(now),
            frames: Frames::new(traffic),
            sockets: Arc::new(Semaphore::new(SOCKETS)),
            control_sockets: Arc::new(Semaphore::new(SOCKETS)),
            sessions: Mutex::new(Sessions::default()),
            attempts: Mutex::new(Attempts::new(now)),
        };
        Ok(Self {
            listener,
            address,
            network,
            shared: Arc::new(shared),
        })
    }

    /// Returns the address that it listens on.
    #[must_use]
    pub const fn address(&self) -> SocketAddr {
        self.address
    }

    fn with_token(&self, token: &str) -> String {
        // what is behind `#` is sent to no server
        format!("http://{}/#token={token}", self.address)
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

    /// Serves until `stop` is raised, then closes the network.
    ///
    /// # Errors
    /// When the operating system has no thread left.
    pub fn run(self, stop: &Stop) -> Result<(), ServeError> {
        let Self {
            listener,
            mut network,
            shared,
            ..
        } = self;
        let flag = stop.clone();
        network.interrupt_with(move || flag.is_stopped());
        let runtime = tokio::runtime::Builder::new_multi_thread()
            .worker_threads(2)
            .thread_name("profidrive-web")
            .enable_all()
            .build()?;
        let served = runtime.block_on(async {
            let listener = TcpListener::from_std(listener)?;
            tokio::spawn(Arc::clone(&shared.board).survey(network.clone()));
            tokio::spawn(Arc::clone(&shared.board).read(network.clone()));
            tokio::spawn(produce(Arc::clone(&shared)));
            tokio::spawn(follow(Arc::clone(&shared)));
            tokio::select! {
                () = accept(listener, shared) => {}
                () = raised(stop) => {}
            }
            Ok(())
        });
        runtime.shutdown_timeout(Duration::from_secs(1));
        drop(network);
        served
    }
}

async fn raised(stop: &Stop) {
    let mut turn = interval(LOOK);
    while !stop.is_stopped() {
        turn.tick().await;
    }
}

fn app(shared: Arc<Shared>) -> Router {
    let in_time = |time| TimeoutLayer::with_status_code(StatusCode::REQUEST_TIMEOUT, time);
    router()
        .route("/api/{*path}", any(nothing))
        .fallback(assets::serve)
        .layer(RequestBodyLimitLayer::new(BODY))
        .layer(in_time(REQUEST_TIME))
        .merge(large_router().layer(in_time(UPLOAD_TIME)))
        .layer(from_fn_with_state(Arc::clone(&shared), guard))
        .layer(from_fn(secure))
        .with_state(shared)
}

async fn accept(listener: TcpListener, shared: Arc<Shared>) {
    let app = app(shared);
    let room = Arc::new(Semaphore::new(CONNECTIONS));
    while let Ok(place) = Arc::clone(&room).acquire_owned().await {
        let Ok((stream, _)) = listener.accept().await else {
            sleep(RETRY).await;
            continue;
        };
        let app = TowerToHyperService::new(app.clone());
        tokio::spawn(async move {
            let connection = http1::Builder::new()
                .timer(TokioTimer::new())
                .header_read_timeout(HEAD_TIME)
                .max_buf_size(HEAD)
                .serve_connection(TokioIo::new(stream), app)
                .with_upgrades();
            // a client that is too slow or uses another protocol is disconnected
            let _ = connection.await;
            drop(place);
        });
    }
}

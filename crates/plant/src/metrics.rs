//! The load of a simulation for Prometheus: `GET /metrics` answers in its text format (OpenMetrics 1.0).
//!
//! Anybody who reaches the address can read it; nothing can be changed there. At most [`MOST_CONNECTIONS`] requests are served at once,
//! each for at most [`LONGEST_REQUEST`]; further ones wait in the queue of the system.

use std::convert::Infallible;
use std::fmt;
use std::io;
use std::net::SocketAddr;
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::{JoinHandle, spawn};
use std::time::Duration;

use http_body_util::Full;
use hyper::body::{Bytes, Incoming};
use hyper::header::{ALLOW, CONTENT_TYPE};
use hyper::server::conn::http1;
use hyper::service::service_fn;
use hyper::{Method, Request, Response, StatusCode};
use hyper_util::rt::{TokioIo, TokioTimer};
use prometheus_client::collector::Collector;
use prometheus_client::encoding::text::encode;
use prometheus_client::encoding::{DescriptorEncoder, EncodeMetric};
use prometheus_client::metrics::counter::ConstCounter;
use prometheus_client::metrics::gauge::ConstGauge;
use prometheus_client::registry::{Registry, Unit};
use tokio::net::TcpListener;
use tokio::sync::{Semaphore, oneshot};
use tokio::time::{sleep, timeout};

use crate::host::Load;

/// Requests served at once.
pub const MOST_CONNECTIONS: usize = 16;
/// Longest time for a request and its answer.
pub const LONGEST_REQUEST: Duration = Duration::from_secs(5);

/// Pause after a connection that could not be taken, as when the process has no file handle left.
const RETRY: Duration = Duration::from_millis(100);

const TEXT: &str = "application/openmetrics-text; version=1.0.0; charset=utf-8";

/// Serves the load of a simulation over HTTP, until it is dropped.
///
/// ```
/// use profidrive_plant::host::Load;
/// use profidrive_plant::metrics::MetricsServer;
///
/// let server = MetricsServer::open("127.0.0.1:0".parse()?)?;
/// server.publish(Load { drives: 12, ..Load::default() });
/// println!("http://{}/metrics", server.address());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct MetricsServer {
    address: SocketAddr,
    load: Arc<Latest>,
    end: Option<oneshot::Sender<Infallible>>,
    thread: Option<JoinHandle<()>>,
}

impl MetricsServer {
    /// Listens on an address and a port; port 0 takes a free one.
    ///
    /// # Errors
    /// When the address is not one of this computer, or the port is in use.
    pub fn open(address: SocketAddr) -> io::Result<Self> {
        let listener = std::net::TcpListener::bind(address)?;
        listener.set_nonblocking(true)?;
        let address = listener.local_addr()?;
        let load = Arc::new(Latest::default());
        let mut registry = Registry::with_prefix("profidrive");
        registry.register_collector(Box::new(Arc::clone(&load)));
        let registry = Arc::new(registry);
        let (end, ended) = oneshot::channel();
        let runtime = tokio::runtime::Builder::new_current_thread()
            .enable_io()
            .enable_time()
            .build()?;
        let thread = spawn(move || {
            runtime.block_on(async {
                tokio::select! {
                    () = serve(listener, registry) => {}
                    _ = ended => {}
                }
            });
        });
        Ok(Self {
            address,
            load,
            end: Some(end),
            thread: Some(thread),
        })
    }

    /// Returns the address that it listens on.
    #[must_use]
    pub const fn address(&self) -> SocketAddr {
        self.address
    }

    /// Sets what the next request reads.
    pub fn publish(&self, load: Load) {
        *self.load.0.lock().unwrap_or_else(PoisonError::into_inner) = load;
    }
}

impl Drop for MetricsServer {
    fn drop(&mut self) {
        drop(self.end.take());
        if let Some(thread) = self.thread.take() {
            // a panic there was printed
            let _ = thread.join();
        }
    }
}

async fn serve(listener: std::net::TcpListener, registry: Arc<Registry>) {
    let Ok(listener) = TcpListener::from_std(listener) else {
        return;
    };
    let room = Arc::new(Semaphore::new(MOST_CONNECTIONS));
    while let Ok(place) = Arc::clone(&room).acquire_owned().await {
        let Ok((stream, _)) = listener.accept().await else {
            sleep(RETRY).await;
            continue;
        };
        let registry = Arc::clone(&registry);
        tokio::spawn(async move {
            let answer = service_fn(|request| {
                let answer = answer(&request, &registry);
                async move { Ok::<_, Infallible>(answer) }
            });
            let connection = http1::Builder::new()
                .timer(TokioTimer::new())
                .keep_alive(false)
                .serve_connection(TokioIo::new(stream), answer);
            // a client that is too slow or uses another protocol is disconnected
            let _ = timeout(LONGEST_REQUEST, connection).await;
            drop(place);
        });
    }
}

fn answer(request: &Request<Incoming>, registry: &Registry) -> Response<Full<Bytes>> {
    let refuse = |status, text: &'static str| {
        let mut response = Response::new(Full::from(text));
        *response.status_mut() = status;
        response
    };
    if request.uri().path() != "/metrics" {
        return refuse(StatusCode::NOT_FOUND, "the figures are at /metrics\n");
    }
    if request.method() != Method::GET && request.method() != Method::HEAD {
        let mut response = refuse(StatusCode::METHOD_NOT_ALLOWED, "only GET\n");
        response
            .headers_mut()
            .insert(ALLOW, hyper::header::HeaderValue::from_static("GET, HEAD"));
        return response;
    }
    let mut text = String::new();
    if encode(&mut text, registry).is_err() {
        return refuse(
            StatusCode::INTERNAL_SERVER_ERROR,
            "the figures have no text form\n",
        );
    }
    let mut response = Response::new(Full::from(text));
    response
        .headers_mut()
        .insert(CONTENT_TYPE, hyper::header::HeaderValue::from_static(TEXT));
    response
}

/// The load published last.
#[derive(Debug, Default)]
struct Latest(Mutex<Load>);

impl Collector for Latest {
    fn encode(&self, mut encoder: DescriptorEncoder<'_>) -> Result<(), fmt::Error> {
        let load = *self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let mut write = |name: &str, help: &str, unit: Option<&Unit>, value: &dyn Value| {
            value.write(encoder.encode_descriptor(name, help, unit, value.kind())?)
        };
        for (name, help, value) in [
            ("drives", "Virtual drives", load.drives),
            (
                "drives_exchanging",
                "Drives that exchange data with a controller",
                load.exchanging,
            ),
        ] {
            write(name, help, None, &ConstGauge::new(value as u64))?;
        }
        for (name, help, value) in [
            (
                "connections",
                "Connections of controllers that began to exchange data",
                load.connections,
            ),
            (
                "disconnections",
                "Connections of controllers that ended",
                load.disconnections,
            ),
            ("faults", "Faults of drives that came", load.faults),
            ("frames_received", "Frames received", load.frames.received),
            ("frames_sent", "Frames sent", load.frames.sent),
            (
                "frames_missed",
                "Frames lost because they came faster than they were handled",
                load.frames.missed,
            ),
            (
                "frames_unsent",
                "Frames that the kernel did not take",
                load.frames.unsent,
            ),
            (
                "late_deadlines",
                "Deadlines of drives met more than 1 ms late",
                load.lateness.late,
            ),
        ] {
            write(name, help, None, &ConstCounter::new(value))?;
        }
        let (shortest, longest) = load.cycles.unwrap_or_default();
        for (name, help, value) in [
            ("uptime", "Time since the simulation began", load.time),
            (
                "shortest_cycle",
                "Shortest time between two input frames, 0 without connections",
                shortest,
            ),
            (
                "longest_cycle",
                "Longest time between two input frames, 0 without connections",
                longest,
            ),
            (
                "longest_delay",
                "Longest delay of a deadline since the start",
                load.lateness.longest,
            ),
        ] {
            write(
                name,
                help,
                Some(&Unit::Seconds),
                &ConstGauge::new(value.as_secs_f64()),
            )?;
        }
        let Some(processor) = load.processor else {
            return Ok(());
        };
        for (name, help, value) in [
            (
                "processor",
                "Processor time of the thread that runs the drives",
                processor.ran,
            ),
            (
                "processor_waiting",
                "Time in which that thread waited for a processor",
                processor.waited,
            ),
        ] {
            write(
                name,
                help,
                Some(&Unit::Seconds),
                &ConstCounter::new(value.as_secs_f64()),
            )?;
        }
        Ok(())
    }
}

/// A value with its type, gauge or counter.
trait Value {
    fn kind(&self) -> prometheus_client::metrics::MetricType;

    fn write(&self, encoder: prometheus_client::encoding::MetricEncoder<'_>) -> fmt::Result;
}

impl<M: EncodeMetric> Value for M {
    fn kind(&self) -> prometheus_client::metrics::MetricType {
        self.metric_type()
    }

    fn write(&self, encoder: prometheus_client::encoding::MetricEncoder<'_>) -> fmt::Result {
        self.encode(encoder)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::{Read, Write};
    use std::net::TcpStream;

    fn ask(server: &MetricsServer, request: &str) -> String {
        let mut stream = TcpStream::connect(server.address()).unwrap();
        stream.write_all(request.as_bytes()).unwrap();
        let mut answer = String::new();
        stream.read_to_string(&mut answer).unwrap();
        answer
    }

    fn server() -> MetricsServer {
        let server = MetricsServer::open("127.0.0.1:0".parse().unwrap()).unwrap();
        server.publish(Load {
            drives: 3,
            faults: 7,
            ..Load::default()
        });
        server
    }

    #[test]
    fn the_load_published_last_is_served() {
        let server = server();
        let answer = ask(&server, "GET /metrics HTTP/1.1\r\nHost: a\r\n\r\n");
        assert!(answer.starts_with("HTTP/1.1 200"), "{answer}");
        for line in ["profidrive_drives 3\n", "profidrive_faults_total 7\n", "# EOF\n"] {
            assert!(answer.contains(line), "{answer}");
        }
        server.publish(Load::default());
        let answer = ask(&server, "GET /metrics HTTP/1.1\r\nHost: a\r\n\r\n");
        assert!(answer.contains("profidrive_drives 0\n"), "{answer}");
    }

    #[test]
    fn nothing_else_is_answered() {
        let server = server();
        for (request, status) in [
            ("GET / HTTP/1.1\r\nHost: a\r\n\r\n", "404"),
            (
                "POST /metrics HTTP/1.1\r\nHost: a\r\nContent-Length: 0\r\n\r\n",
                "405",
            ),
            ("\x16\x03\x01 no HTTP\r\n\r\n", "400"),
        ] {
            let answer = ask(&server, request);
            assert!(answer.starts_with(&format!("HTTP/1.1 {status}")), "{answer}");
        }
    }

    #[test]
    fn a_head_without_end_is_not_read() {
        let server = server();
        let mut stream = TcpStream::connect(server.address()).unwrap();
        stream.write_all(b"GET /metrics HTTP/1.1\r\nHost: ").unwrap();
        // it ends with the connection: the server reads no further
        let written = (0..10_000).take_while(|_| stream.write_all(&[b'a'; 1024]).is_ok());
        let written = written.count();
        assert!((408..10_000).contains(&written), "{written} KiB");
    }

    /// They cost at most their places, which become free when they go.
    #[test]
    fn clients_that_ask_nothing_hold_places_only_while_they_stay() {
        let server = server();
        let connect = |_| TcpStream::connect(server.address()).unwrap();
        let idle: Vec<TcpStream> = (0..3 * MOST_CONNECTIONS).map(connect).collect();
        drop(idle);
        let answer = ask(&server, "GET /metrics HTTP/1.1\r\nHost: a\r\n\r\n");
        assert!(answer.contains("profidrive_drives 3\n"), "{answer}");
    }
}

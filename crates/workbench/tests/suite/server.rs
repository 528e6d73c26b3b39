//! A server that runs for a test, and requests to it.

use std::io::{Read, Write};
use std::net::{SocketAddr, TcpStream};
use std::path::PathBuf;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use profidrive::Stop;
use profidrive_workbench::{Server, Settings, Source};
use serde_json::Value;

static STARTED: AtomicUsize = AtomicUsize::new(0);

/// A server that runs until it is dropped.
pub struct Running {
    pub address: SocketAddr,
    pub control: String,
    pub view: String,
    pub once: String,
    /// The folder with its log.
    pub folder: PathBuf,
    stop: Stop,
    thread: Option<JoinHandle<()>>,
}

impl Running {
    pub fn start(settings: Settings) -> Self {
        let listen = "127.0.0.1:0".parse().unwrap();
        let number = STARTED.fetch_add(1, Ordering::Relaxed);
        let folder = format!("profidrive-workbench-{}-{number}", std::process::id());
        let folder = std::env::temp_dir().join(folder);
        // a test without a log has none
        let log = settings.log.as_ref().map(|_| folder.clone());
        let stop = Stop::new().unwrap();
        let settings = Settings {
            listen,
            log,
            ..settings
        };
        let server = Server::open(settings, stop.clone()).unwrap();
        let token = |url: String| url.split_once("#token=").unwrap().1.to_owned();
        let (address, control, view) = (server.address(), token(server.url()), token(server.view_url()));
        let once = token(server.url_once().unwrap());
        let thread = std::thread::spawn(move || server.run().unwrap());
        Self {
            address,
            control,
            view,
            once,
            folder,
            stop,
            thread: Some(thread),
        }
    }

    /// Raises the stop of the server, which then ends by itself.
    pub fn end(&self) {
        self.stop.stop();
    }

    pub fn demo() -> Self {
        Self::start(Settings::new(Source::Demo))
    }

    /// Sends octets as they are and returns the answer.
    pub fn raw(&self, request: &[u8]) -> Answer {
        Answer::of(&self.exchange(request))
    }

    fn exchange(&self, request: &[u8]) -> Vec<u8> {
        let mut stream = TcpStream::connect(self.address).unwrap();
        stream.set_read_timeout(Some(Duration::from_secs(30))).unwrap();
        // the server may answer and close before it has read all
        let _ = stream.write_all(request);
        let mut octets = Vec::new();
        let _ = stream.read_to_end(&mut octets);
        octets
    }

    /// Returns the content of a file as it is.
    pub fn file(&self, path: &str) -> Vec<u8> {
        let headers = Self::bearer(&self.view).replace("{address}", &self.address.to_string());
        let request = format!("GET {path} HTTP/1.1\r\n{headers}Connection: close\r\n\r\n");
        let octets = self.exchange(request.as_bytes());
        let head = octets.windows(4).position(|part| part == b"\r\n\r\n").unwrap();
        octets[head + 4..].to_vec()
    }

    /// Makes a request with these headers in place of none; `Host` and the origin of the page are in `PAGE`.
    pub fn ask(&self, method: &str, path: &str, headers: &str, body: &str) -> Answer {
        let headers = headers.replace("{address}", &self.address.to_string());
        let length = body.len();
        let request = format!(
            "{method} {path} HTTP/1.1\r\n{headers}Connection: close\r\nContent-Length: {length}\r\n\r\n{body}"
        );
        self.raw(request.as_bytes())
    }

    pub fn login(&self, token: &str) -> Answer {
        self.ask(
            "POST",
            "/api/v1/session",
            &format!("{PAGE}{JSON}"),
            &format!("{{\"token\":\"{token}\"}}"),
        )
    }

    /// Begins a session and returns the headers of its page.
    pub fn session(&self, token: &str) -> String {
        let answer = self.login(token);
        assert_eq!(answer.status, 200, "{answer:?}");
        let cookie = answer.header("set-cookie").unwrap();
        for part in ["HttpOnly", "SameSite=Strict", "Path=/"] {
            assert!(cookie.contains(part), "{cookie}");
        }
        format!("{PAGE}Cookie: a=b; {}\r\n", cookie.split(';').next().unwrap())
    }

    /// Returns the log once it fits: what became of something is written after its answer.
    pub fn logged(&self, fits: impl Fn(&[Value]) -> bool) -> Vec<Value> {
        let start = Instant::now();
        loop {
            let log = self.log();
            if fits(&log) {
                return log;
            }
            assert!(start.elapsed() < Duration::from_secs(60), "{log:#?}");
            std::thread::sleep(Duration::from_millis(20));
        }
    }

    /// Returns the records of its log.
    pub fn log(&self) -> Vec<Value> {
        let mut records = Vec::new();
        for file in self.folder.read_dir().into_iter().flatten() {
            let path = file.unwrap().path();
            if path.is_dir() {
                continue;
            }
            let text = std::fs::read_to_string(path).unwrap();
            records.extend(
                text.lines()
                    .map(|line| serde_json::from_str::<Value>(line).unwrap()),
            );
        }
        records
    }

    /// Returns what the drive of this name is called in paths.
    pub fn id(&self, name: &str) -> String {
        let drives = self
            .ask("GET", "/api/v1/plant/drives", &Self::bearer(&self.view), "")
            .json();
        let mut drives = drives["drives"].as_array().unwrap().iter();
        let drive = drives.find(|drive| drive["name"] == name).unwrap();
        drive["id"].as_str().unwrap().to_owned()
    }

    /// Posts what a program with the token for control wants.
    pub fn post(&self, path: &str, body: &Value) -> Answer {
        let headers = format!("{}{JSON}", Self::bearer(&self.control));
        self.ask("POST", path, &headers, &body.to_string())
    }

    pub fn bearer(token: &str) -> String {
        format!("Host: {{address}}\r\nAuthorization: Bearer {token}\r\n")
    }

    pub fn stops(&self) -> u64 {
        let answer = self.ask("GET", "/api/v1/server", &Self::bearer(&self.view), "");
        answer.json()["stops"].as_u64().unwrap()
    }
}

impl Drop for Running {
    fn drop(&mut self) {
        self.stop.stop();
        self.thread.take().unwrap().join().unwrap();
        let _ = std::fs::remove_dir_all(&self.folder);
    }
}

/// The headers of a request of the page.
pub const PAGE: &str = "Host: {address}\r\nOrigin: http://{address}\r\nSec-Fetch-Site: same-origin\r\n";
pub const JSON: &str = "Content-Type: application/json\r\n";

#[derive(Debug)]
pub struct Answer {
    pub status: u16,
    pub head: String,
    pub body: String,
}

impl Answer {
    pub fn of(octets: &[u8]) -> Self {
        let text = String::from_utf8_lossy(octets);
        let (head, body) = text.split_once("\r\n\r\n").unwrap_or((&text, ""));
        let status = head
            .split(' ')
            .nth(1)
            .and_then(|status| status.parse().ok())
            .unwrap_or(0);
        Self {
            status,
            head: head.to_owned(),
            body: body.to_owned(),
        }
    }

    pub fn header(&self, name: &str) -> Option<&str> {
        let found = self
            .head
            .lines()
            .find(|line| line.to_lowercase().starts_with(&format!("{name}: ")));
        found
            .and_then(|line| line.split_once(": "))
            .map(|(_, value)| value)
    }

    pub fn json(&self) -> Value {
        serde_json::from_str(&self.body).unwrap_or_else(|error| panic!("{error}: {self:?}"))
    }
}

/// Returns the answer that satisfies a condition; asks again until then.
pub fn eventually(server: &Running, path: &str, fits: impl Fn(&Value) -> bool) -> Value {
    let start = Instant::now();
    loop {
        let answer = server.ask("GET", path, &Running::bearer(&server.view), "").json();
        if fits(&answer) {
            return answer;
        }
        assert!(start.elapsed() < Duration::from_secs(60), "{answer:#}");
        std::thread::sleep(Duration::from_millis(50));
    }
}

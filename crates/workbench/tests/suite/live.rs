//! The socket of a page.

use std::io::ErrorKind;
use std::net::TcpStream;
use std::time::{Duration, Instant};

use serde_json::{Value, json};
use tungstenite::client::IntoClientRequest;
use tungstenite::handshake::HandshakeError;
use tungstenite::http::{HeaderName, HeaderValue};
use tungstenite::{Error, Message, WebSocket};

use crate::server::Running;

const PROTOCOL: &str = "profidrive.live.1";

/// The socket of one page.
pub struct Page(WebSocket<TcpStream>);

/// Opens a socket with these headers, each as `Name: value`; returns the status of the answer where there is none.
fn open(server: &Running, headers: &str, protocol: Option<&str>) -> Result<Page, u16> {
    open_at(server, "/api/v1/live", headers, protocol)
}

/// The same for another socket.
pub fn open_at(server: &Running, path: &str, headers: &str, protocol: Option<&str>) -> Result<Page, u16> {
    let url = format!("ws://{}{path}", server.address);
    let mut request = url.into_client_request().unwrap();
    let headers = headers.replace("{address}", &server.address.to_string());
    for line in headers.lines() {
        let (name, value) = line.split_once(": ").unwrap();
        let name: HeaderName = name.parse().unwrap();
        request
            .headers_mut()
            .insert(name, HeaderValue::from_str(value).unwrap());
    }
    if let Some(protocol) = protocol {
        request
            .headers_mut()
            .insert("Sec-WebSocket-Protocol", HeaderValue::from_str(protocol).unwrap());
    }
    let stream = TcpStream::connect(server.address).unwrap();
    stream.set_read_timeout(Some(Duration::from_secs(30))).unwrap();
    match tungstenite::client(request, stream) {
        Ok((socket, _)) => Ok(Page(socket)),
        Err(HandshakeError::Failure(Error::Http(answer))) => Err(answer.status().as_u16()),
        Err(error) => panic!("{error}"),
    }
}

/// How a connection is cut on which octets were not read.
const CUT: [ErrorKind; 3] = [
    ErrorKind::ConnectionReset,
    ErrorKind::ConnectionAborted,
    ErrorKind::BrokenPipe,
];

impl Page {
    pub fn of(server: &Running) -> Self {
        let session = server.session(&server.control);
        open(server, &session, Some(PROTOCOL)).unwrap_or_else(|status| panic!("{status}"))
    }

    pub fn send(&mut self, message: &Value) {
        self.text(&message.to_string());
    }

    pub fn text(&mut self, text: &str) {
        // a socket that was closed by the other side is seen by whoever reads
        let _ = self.0.send(Message::text(text));
    }

    /// Sends octets, which is no message of any protocol here.
    pub fn octets(&mut self, octets: Vec<u8>) {
        let _ = self.0.send(Message::binary(octets));
    }

    /// Sets how long a read waits.
    pub fn patience(&mut self, time: Duration) {
        self.0.get_ref().set_read_timeout(Some(time)).unwrap();
    }

    /// Returns the next message, if one comes soon.
    pub fn poll(&mut self) -> Option<Value> {
        match self.0.read() {
            Ok(Message::Text(text)) => Some(serde_json::from_str(&text).unwrap()),
            _ => None,
        }
    }

    /// Returns the next message of this type.
    pub fn next(&mut self, kind: &str) -> Value {
        let begin = Instant::now();
        loop {
            assert!(begin.elapsed() < Duration::from_secs(60), "no {kind}");
            let message = match self.0.read() {
                Err(Error::Io(error)) if error.kind() == ErrorKind::WouldBlock => continue,
                message => message.unwrap(),
            };
            if let Message::Text(text) = message {
                let message: Value = serde_json::from_str(&text).unwrap();
                if message["type"] == kind {
                    return message;
                }
            }
        }
    }

    /// Returns the next message, whatever it is.
    pub fn message(&mut self) -> Message {
        loop {
            match self.0.read() {
                Err(Error::Io(error)) if error.kind() == ErrorKind::WouldBlock => {}
                message => return message.unwrap(),
            }
        }
    }

    /// Waits until the server closes the socket, and returns the code of its reason; `None` where the connection was cut, as
    /// by octets that the server does not read.
    pub fn closed(&mut self) -> Option<u16> {
        loop {
            match self.0.read() {
                Ok(Message::Close(Some(frame))) => return Some(frame.code.into()),
                Ok(_) => {}
                Err(Error::Io(error)) if error.kind() == ErrorKind::WouldBlock => {}
                Err(Error::Io(error)) if CUT.contains(&error.kind()) => return None,
                Err(error) => panic!("{error}"),
            }
        }
    }
}

#[test]
fn only_a_page_of_this_server_with_a_session_gets_a_socket() {
    let server = Running::demo();
    let session = server.session(&server.view);
    let own = "Origin: http://{address}";
    for (origin, status) in [
        ("Origin: http://evil.example", 403),
        ("Origin: null", 403),
        ("Origin: https://{address}", 403),
        ("", 403),
    ] {
        let headers = session.replace(own, origin).replace("\r\n\r\n", "\r\n");
        let headers = headers.trim_start_matches("\r\n");
        let refused = open(&server, headers, Some(PROTOCOL)).err();
        assert_eq!(refused, Some(status), "{origin}");
        let control = open_at(&server, "/api/v1/control", headers, Some("profidrive.control.1"));
        assert_eq!(control.err(), Some(status), "{origin}");
    }
    let rebound = session.replace("{address}", "evil.example");
    assert_eq!(open(&server, &rebound, Some(PROTOCOL)).err(), Some(421));
    let control = open_at(&server, "/api/v1/control", &rebound, Some("profidrive.control.1"));
    assert_eq!(control.err(), Some(421));
    let without = format!("Host: {{address}}\r\n{own}\r\n");
    assert_eq!(open(&server, &without, Some(PROTOCOL)).err(), Some(401));
    for other in [None, Some("profidrive.live.2"), Some("chat")] {
        assert_eq!(open(&server, &session, other).err(), Some(426), "{other:?}");
    }
    assert!(open(&server, &session, Some("profidrive.live.9, profidrive.live.1")).is_ok());
    // a program needs no origin
    assert!(open(&server, &Running::bearer(&server.view), Some(PROTOCOL)).is_ok());
    let plain = server.ask("GET", "/api/v1/live", &Running::bearer(&server.view), "");
    assert_eq!(plain.status, 426);
}

#[test]
fn a_page_gets_the_newest_values_of_its_topics() {
    let server = Running::demo();
    let mut page = Page::of(&server);
    assert_eq!(page.next("hello")["simulation"], true);
    page.send(&json!({ "type": "subscribe", "topic": "network", "rate": 50 }));
    let mut network = page.next("snapshot");
    while network["data"]["stations"].as_array().unwrap().len() < 6 {
        network = page.next("snapshot");
    }
    assert_eq!(network["topic"], "network");
    page.send(&json!({ "type": "unsubscribe", "topic": "network" }));
    page.send(&json!({ "type": "subscribe", "topic": "nothing", "rate": 1 }));
    page.send(&json!({ "type": "of tomorrow", "topic": 7 }));
    let id = server.id("axis-2");
    page.send(&json!({ "type": "subscribe", "topic": format!("drive/{id}/faults"), "rate": 5 }));
    let mut faults = page.next("snapshot");
    while faults["topic"] == "network" {
        faults = page.next("snapshot");
    }
    assert_eq!(faults["data"]["report"]["faults"][0]["number"], 439, "{faults:#}");
    page.send(&json!({ "type": "unsubscribe", "topic": format!("drive/{id}/faults") }));
    page.send(&json!({ "type": "subscribe", "topic": "plant", "rate": 10 }));
    let time = |message: &Value| message["data"]["time"].as_f64().unwrap_or(-1.0);
    let mut first = page.next("snapshot");
    while first["topic"] != "plant" {
        first = page.next("snapshot");
    }
    let second = page.next("snapshot");
    assert!(time(&second) > time(&first) && second["rev"].as_u64() > first["rev"].as_u64());
    // a page that is not visible wants nothing
    page.send(&json!({ "type": "visible", "visible": false }));
    let mut other = Page::of(&server);
    other.send(&json!({ "type": "subscribe", "topic": "plant", "rate": 50 }));
    for _ in 0..10 {
        other.next("snapshot");
    }
    // and gets what comes for others once a second
    page.send(&json!({ "type": "subscribe", "topic": "plant", "rate": 50 }));
    let mut times = Vec::new();
    for _ in 0..4 {
        page.next("snapshot");
        times.push(Instant::now());
    }
    let pause = times[3].duration_since(times[1]);
    assert!(pause > Duration::from_millis(1500), "{pause:?}");
}

#[test]
fn each_page_gets_each_event_and_continues_after_a_pause() {
    let server = Running::demo();
    let (mut first, mut second) = (Page::of(&server), Page::of(&server));
    let hello = first.next("hello");
    second.next("hello");
    let stop = || server.ask("POST", "/api/v1/stop", &Running::bearer(&server.view), "");
    for number in 1..=3 {
        assert_eq!(stop().json()["stops"], number);
        for page in [&mut first, &mut second] {
            let event = page.next("event");
            assert_eq!(
                (&event["kind"], &event["n"]),
                (&"stop".into(), &(number - 1).into())
            );
            assert!(
                event["text"]
                    .as_str()
                    .unwrap()
                    .contains(&format!("STOP {number}"))
            );
        }
    }
    drop(second);
    stop();
    let mut again = Page::of(&server);
    again.send(&json!({ "type": "resume", "boot": hello["boot"], "last_event": 1 }));
    assert_eq!(again.next("event")["n"], 2);
    assert_eq!(again.next("event")["n"], 3);
    // of another start nothing is missing
    let mut stranger = Page::of(&server);
    stranger.send(&json!({ "type": "resume", "boot": "x", "last_event": 0 }));
    stranger.next("clock");
    stop();
    assert_eq!(stranger.next("event")["n"], 4);
    let mut liar = Page::of(&server);
    liar.send(&json!({ "type": "resume", "boot": hello["boot"], "last_event": u64::MAX }));
    stop();
    assert_eq!(liar.next("event")["n"], 5);
}

#[test]
fn a_page_that_breaks_the_rules_is_closed_and_others_go_on() {
    let server = Running::demo();
    let mut good = Page::of(&server);
    good.next("hello");
    let wrong: [(Vec<Message>, u16); 6] = [
        (vec![Message::text("x".repeat(1 << 20))], 1009),
        (vec![Message::text("{\"type\":\"visible\"}".repeat(300))], 1009),
        (vec![Message::binary(vec![0; 16])], 1008),
        (vec![Message::text("[".repeat(1000))], 1008),
        (vec![Message::text("{}")], 1008),
        (vec![Message::text("{\"type\":\"of tomorrow\"}"); 300], 1008),
    ];
    for (messages, code) in wrong {
        let mut page = Page::of(&server);
        let is_one = messages.len() == 1;
        for message in messages {
            // the server may have closed it meanwhile
            let _ = page.0.send(message);
        }
        let closed = page.closed();
        // what is too long, or comes behind what was wrong, is not read to its end
        let unread = code == 1009 || !is_one;
        assert!(
            closed == Some(code) || (unread && closed.is_none()),
            "{closed:?} for {code}"
        );
    }
    let mut greedy = Page::of(&server);
    for number in 0..17 {
        greedy.send(&json!({ "type": "subscribe", "topic": format!("drive/{number}/faults"), "rate": 1 }));
    }
    assert_eq!(greedy.closed(), Some(1008));
    server.ask("POST", "/api/v1/stop", &Running::bearer(&server.view), "");
    assert_eq!(good.next("event")["kind"], "stop");
}

#[test]
fn a_socket_ends_with_its_session() {
    let server = Running::demo();
    let session = server.session(&server.control);
    let mut page = open(&server, &session, Some(PROTOCOL)).unwrap_or_else(|status| panic!("{status}"));
    page.next("hello");
    assert_eq!(server.ask("DELETE", "/api/v1/session", &session, "").status, 204);
    assert_eq!(page.closed(), Some(1008));
}

#[test]
fn sockets_are_bounded_and_their_places_come_back() {
    let server = Running::demo();
    let mut pages: Vec<Page> = Vec::new();
    // links that only look keep no other one from control
    for (token, most) in [(&server.view, 48), (&server.control, 64)] {
        while let Ok(page) = open(&server, &Running::bearer(token), Some(PROTOCOL)) {
            pages.push(page);
            assert!(pages.len() <= most);
        }
        assert_eq!(pages.len(), most);
    }
    let bearer = Running::bearer(&server.control);
    assert_eq!(open(&server, &bearer, Some(PROTOCOL)).err(), Some(429));
    drop(pages.pop());
    let begin = Instant::now();
    while open(&server, &bearer, Some(PROTOCOL)).is_err() {
        assert!(begin.elapsed() < Duration::from_secs(30));
        std::thread::sleep(Duration::from_millis(20));
    }
}

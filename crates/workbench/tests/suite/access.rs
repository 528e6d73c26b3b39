//! Who is let in: hosts, origins, sessions, tokens and limits, by requests as an attacker would make them.

use std::io::{ErrorKind, Read, Write};
use std::net::TcpStream;
use std::time::{Duration, Instant};

use profidrive::Stop;
use profidrive_workbench::{ServeError, Server, Settings, Source, openapi};
use serde_json::{Value, json};

use crate::change::known;
use crate::hands::Hands;
use crate::live::open_at;
use crate::namespace;
use crate::server::{JSON, PAGE, Running, eventually};

/// Every method and path of the interface.
fn routes() -> Vec<(String, String)> {
    let description: Value = serde_json::from_str(&openapi()).unwrap();
    let paths = description["paths"].as_object().unwrap();
    let routes = paths.iter().flat_map(|(path, methods)| {
        // of a drive, and the number of a plan, a job or a capture
        let numbered = ["/plans/", "/jobs/", "/captures/"];
        let id = match numbered.iter().any(|of| path.contains(of)) {
            true => "1",
            false => "02:00:00:00:00:01",
        };
        let path = path
            .replace("{id}", id)
            .replace("{reference}", "922")
            .replace("{references}", "922");
        let path = path.replace("{file}", "a.backup").replace("{number}", "1");
        let methods = methods.as_object().unwrap().keys();
        methods.map(move |method| (method.to_uppercase(), path.clone()))
    });
    let routes: Vec<_> = routes.collect();
    assert!(routes.len() >= 9, "{routes:?}");
    routes
}

#[test]
fn the_committed_description_is_that_of_the_routes() {
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/openapi.json");
    assert!(
        std::fs::read_to_string(file).unwrap() == openapi(),
        "openapi.json is old: cargo run -p profidrive-workbench --example openapi > crates/workbench/openapi.json"
    );
}

#[test]
fn no_route_answers_without_a_session() {
    let server = Running::demo();
    for (method, path) in routes() {
        let login = (&*method, &*path) == ("POST", "/api/v1/session");
        let answer = server.ask(&method, &path, &format!("{PAGE}{JSON}"), "{\"token\":\"0\"}");
        assert_eq!(answer.status, 401, "{method} {path}: {answer:?}");
        assert_eq!(answer.json()["kind"], if login { "token" } else { "session" });
        assert_eq!(answer.header("content-type"), Some("application/problem+json"));
        let foreign = format!(
            "{PAGE}Cookie: profidrive_{}={}\r\n",
            server.address.port(),
            "0".repeat(32)
        );
        let answer = server.ask(&method, &path, &foreign, "");
        assert!(matches!(answer.status, 401 | 415), "{method} {path}: {answer:?}");
    }
}

#[test]
fn a_view_session_changes_nothing_and_can_stop() {
    let server = Running::demo();
    let (view, control) = (server.session(&server.view), server.session(&server.control));
    let own = [
        "/api/v1/stop",
        "/api/v1/session",
        "/api/v1/drives/02:00:00:00:00:01/stop",
    ];
    let changing = routes()
        .into_iter()
        .filter(|(method, path)| method != "GET" && !own.contains(&&**path));
    // a route of tomorrow, whatever it is
    let tomorrow = ("POST".to_owned(), "/api/v1/tomorrow".to_owned());
    for (method, path) in changing.chain([tomorrow]) {
        let answer = server.ask(&method, &path, &view, "");
        assert_eq!(answer.status, 403, "{method} {path}: {answer:?}");
    }
    assert_eq!(server.ask("POST", "/api/v1/tomorrow", &control, "").status, 404);
    let stopped = server.ask("POST", "/api/v1/stop", &view, "");
    assert_eq!(
        (stopped.status, stopped.json()["axes"].clone()),
        (200, Value::Array(Vec::new()))
    );
    assert_eq!(server.ask("DELETE", "/api/v1/session", &view, "").status, 204);
    assert_eq!(server.ask("GET", "/api/v1/session", &view, "").status, 401);
    assert_eq!(
        server.ask("GET", "/api/v1/session", &control, "").json()["role"],
        "control"
    );
}

/// What belongs to a plant is not there, whatever is in the body: a body that is not valid is no way to find out that it is.
#[test]
fn a_server_that_is_no_simulation_has_no_plant() {
    // where the computer has an interface it would be opened
    if !namespace::inside("access::a_server_that_is_no_simulation_has_no_plant") {
        return;
    }
    let addresses = vec!["127.0.0.1".parse().unwrap()];
    let server = Running::start(Settings::new(Source::Addresses(addresses)));
    let of_plants: Vec<_> = routes()
        .into_iter()
        .filter(|(_, path)| path.starts_with("/api/v1/plant/"))
        .collect();
    assert!(of_plants.len() >= 6, "{of_plants:?}");
    let headers = Running::bearer(&server.control);
    for (method, path) in of_plants {
        let typed = format!("{headers}{JSON}");
        for (headers, body) in [(&headers, ""), (&typed, "{"), (&typed, "{\"no\":1}")] {
            let answer = server.ask(&method, &path, headers, body);
            assert_eq!(answer.status, 404, "{method} {path} {body}: {answer:?}");
            assert_eq!(answer.json()["kind"], "simulation", "{method} {path} {body}");
        }
    }
}

#[test]
fn a_server_that_is_read_only_lets_nobody_change_anything() {
    let server = Running::start(Settings {
        read_only: true,
        ..Settings::new(Source::Demo)
    });
    assert_eq!(server.control, server.view, "there is no other address");
    for token in [&server.view, &server.once] {
        let session = server.session(token);
        let report = server.ask("GET", "/api/v1/server", &session, "").json();
        assert_eq!(
            (&report["role"], &report["read_only"]),
            (&"view".into(), &true.into())
        );
        let scan = server.ask("POST", "/api/v1/stations/scan", &session, "");
        assert_eq!(scan.status, 403);
        assert!(
            scan.json()["detail"].as_str().unwrap().contains("view-only"),
            "{scan:?}"
        );
        assert_eq!(server.ask("POST", "/api/v1/stop", &session, "").status, 200);
    }
}

#[test]
fn the_address_of_a_started_browser_begins_one_session() {
    let server = Running::demo();
    let bearer = Running::bearer(&server.once);
    assert_eq!(
        server.ask("GET", "/api/v1/server", &bearer, "").status,
        401,
        "it is for browsers"
    );
    let session = server.session(&server.once);
    assert_eq!(
        server.ask("GET", "/api/v1/session", &session, "").json()["role"],
        "control"
    );
    assert_eq!(server.login(&server.once).status, 401, "used");
}

#[test]
fn a_search_on_request_ends_with_all_stations() {
    let server = Running::demo();
    let control = Running::bearer(&server.control);
    for _ in 0..2 {
        let found = server.ask("POST", "/api/v1/stations/scan", &control, "").json();
        assert_eq!(found["stations"].as_array().unwrap().len(), 6, "{found:#}");
        assert!(found["age"].as_f64().unwrap() < 1.0, "{found:#}");
    }
}

#[test]
fn a_log_that_cannot_be_written_is_reported_at_the_start() {
    let place = std::env::temp_dir().join(format!("profidrive-unlogged-{}", std::process::id()));
    std::fs::write(&place, "a file").unwrap();
    let open = |log: Option<std::path::PathBuf>| {
        let settings = Settings {
            listen: "127.0.0.1:0".parse().unwrap(),
            log,
            ..Settings::new(Source::Demo)
        };
        Server::open(settings, Stop::new().unwrap()).unwrap()
    };
    let below = place.join("log");
    let server = open(Some(below.clone()));
    let why = server.unlogged().unwrap();
    assert!(
        why.contains("cannot write the log in") && why.contains(&below.display().to_string()),
        "{why}"
    );
    assert!(open(None).unlogged().unwrap().contains("no folder for the log"));
    std::fs::remove_file(&place).unwrap();
    // the same place, and nothing in the way
    assert_eq!(open(Some(below)).unlogged(), None);
    std::fs::remove_dir_all(&place).unwrap();
}

#[test]
fn a_foreign_page_does_nothing_with_the_cookie_of_a_session() {
    let server = Running::demo();
    let session = server.session(&server.control);
    let cookie = session.lines().find(|line| line.starts_with("Cookie")).unwrap();
    let port = server.address.port();
    for (foreign, method) in [
        (
            "Origin: http://evil.example\r\nSec-Fetch-Site: cross-site\r\n",
            "POST",
        ),
        ("Origin: http://evil.example\r\n", "POST"),
        ("Origin: null\r\n", "POST"),
        ("", "POST"),
        (
            "Origin: http://{address}\r\nOrigin: http://evil.example\r\n",
            "POST",
        ),
        ("Origin: https://{address}\r\n", "POST"),
        (
            &format!("Origin: http://127.0.0.1:{}\r\n", port.wrapping_add(1)),
            "POST",
        ),
        ("Sec-Fetch-Site: cross-site\r\n", "GET"),
        ("Sec-Fetch-Site: same-site\r\n", "GET"),
        ("Origin: http://evil.example\r\n", "GET"),
    ] {
        let path = if method == "GET" {
            "/api/v1/stations"
        } else {
            "/api/v1/stop"
        };
        for more in ["", JSON, "Content-Type: text/plain\r\n"] {
            let headers = format!("Host: {{address}}\r\n{cookie}\r\n{foreign}{more}");
            let answer = server.ask(method, path, &headers, "");
            assert_eq!(
                (answer.status, &answer.json()["kind"]),
                (403, &Value::from("origin")),
                "{foreign}"
            );
        }
    }
    // the token does not help a foreign page either
    let body = format!("{{\"token\":\"{}\"}}", server.control);
    let foreign = format!("Host: {{address}}\r\nOrigin: http://evil.example\r\n{JSON}");
    assert_eq!(server.ask("POST", "/api/v1/session", &foreign, &body).status, 403);
    assert_eq!(server.stops(), 0);
}

#[test]
fn only_requests_for_this_server_are_answered() {
    let server = Running::demo();
    let session = server.session(&server.control);
    let port = server.address.port();
    for host in [
        "evil.example",
        &format!("evil.example:{port}"),
        "127.0.0.1",
        "localhost",
        "",
    ] {
        let headers = session.replace("Host: {address}", &format!("Host: {host}"));
        for path in ["/", "/app.js", "/api/v1/server"] {
            assert_eq!(server.ask("GET", path, &headers, "").status, 421, "{host} {path}");
        }
    }
    // as after a rebinding of the name: host and origin agree
    let rebound = session.replace("{address}", &format!("evil.example:{port}"));
    assert_eq!(server.ask("POST", "/api/v1/stop", &rebound, "").status, 421);
    let twice = format!("Host: evil.example\r\n{session}");
    assert!(matches!(
        server.ask("GET", "/api/v1/server", &twice, "").status,
        400 | 421
    ));
    for authority in ["evil.example", &server.address.to_string()] {
        let answer = server.ask("GET", &format!("http://{authority}/api/v1/server"), &session, "");
        assert_eq!(answer.status, 421, "{authority}");
    }
    assert_eq!(
        server.ask("GET", "/api/v1/server", "", "").status,
        421,
        "without a host"
    );
    for host in ["localhost", "127.0.0.1", "[::1]"] {
        let named = session.replace("{address}", &format!("{host}:{port}"));
        assert_eq!(
            server.ask("POST", "/api/v1/stop", &named, "").status,
            200,
            "{host}"
        );
    }
    assert_eq!(server.stops(), 3);
}

#[test]
fn tokens_are_not_guessed_and_not_taken_from_addresses() {
    let (server, before) = (Running::demo(), Running::demo());
    assert_eq!(
        server.login(&before.control).status,
        401,
        "the token of another start"
    );
    let query = format!("/api/v1/server?token={}", server.control);
    assert_eq!(
        server.ask("GET", &query, PAGE, "").status,
        401,
        "a token in the query"
    );
    let start = Instant::now();
    let (mut wrong, mut limited) = (0, 0);
    for guess in 0..1000_u32 {
        match server.login(&format!("{guess:032x}")).status {
            401 => wrong += 1,
            429 => {
                limited += 1;
                // another program that tries wrong ones keeps none with the right one from a STOP
                if limited < 10 {
                    let stop = server.ask("POST", "/api/v1/stop", &Running::bearer(&server.view), "");
                    assert_eq!(stop.status, 200, "{stop:?}");
                }
            }
            other => panic!("{other}"),
        }
    }
    let seconds = start.elapsed().as_secs() + 2;
    assert!(wrong <= 10 * seconds, "{wrong} in {seconds} s");
    assert_eq!(wrong + limited, 1000);
}

#[test]
fn a_program_has_its_token_in_a_header() {
    let server = Running::demo();
    for _ in 0..30 {
        let answer = server.ask("GET", "/api/v1/server", &Running::bearer(&server.control), "");
        assert_eq!(
            (answer.status, &answer.json()["role"]),
            (200, &Value::from("control")),
            "right ones are not limited"
        );
    }
    assert_eq!(
        server
            .ask("POST", "/api/v1/stop", &Running::bearer(&server.view), "")
            .status,
        200
    );
    assert_eq!(
        server
            .ask("GET", "/api/v1/server", &Running::bearer("x"), "")
            .status,
        401
    );
    // it does not help that a session is beside it
    let both = format!("{}Authorization: Bearer x\r\n", server.session(&server.control));
    assert_eq!(server.ask("GET", "/api/v1/server", &both, "").status, 401);
}

#[test]
fn sessions_are_bounded() {
    let server = Running::demo();
    for _ in 0..12 {
        server.session(&server.view);
    }
    // links that only look keep no other one from control
    assert_eq!(server.login(&server.view).status, 429);
    let first = server.session(&server.control);
    for _ in 13..16 {
        server.session(&server.control);
    }
    let refused = server.login(&server.control);
    assert_eq!(
        (refused.status, &refused.json()["kind"]),
        (429, &Value::from("sessions"))
    );
    // a browser that begins again has one session as before
    let body = format!("{{\"token\":\"{}\"}}", server.control);
    assert_eq!(
        server
            .ask("POST", "/api/v1/session", &format!("{first}{JSON}"), &body)
            .status,
        200
    );
}

#[test]
fn bodies_are_json_and_bounded() {
    let server = Running::demo();
    let headers = format!("{PAGE}{JSON}");
    let post = |headers: &str, body: &str| server.ask("POST", "/api/v1/session", headers, body).status;
    assert_eq!(post(&headers, &"x".repeat(300 << 10)), 413);
    let form = format!("{PAGE}Content-Type: application/x-www-form-urlencoded\r\n");
    assert_eq!(post(&form, &format!("token={}", server.control)), 415);
    assert!(matches!(post(&headers, &"[".repeat(100_000)), 400 | 422));
    assert_eq!(post(&headers, "{\"token\":7}"), 422);
    // a body without an end
    let address = server.address.to_string();
    let mut endless = format!("POST /api/v1/session HTTP/1.1\r\n{headers}Transfer-Encoding: chunked\r\n\r\n")
        .replace("{address}", &address)
        .into_bytes();
    for _ in 0..400 {
        endless.extend_from_slice(b"400\r\n");
        endless.extend_from_slice(&[b' '; 0x400]);
        endless.extend_from_slice(b"\r\n");
    }
    assert_eq!(server.raw(&endless).status, 413);
    let long = format!("{PAGE}X: {}\r\n", "x".repeat(300 << 10));
    assert_eq!(server.ask("GET", "/", &long, "").status, 431);
}

#[test]
fn nothing_but_the_page_is_served_and_each_answer_has_the_headers() {
    let server = Running::demo();
    for path in [
        "/",
        "/network",
        "/drives/02:00/overview",
        "/app.js",
        "/screens.js",
        "/app.css",
        "/icon.svg",
        "/licences.txt",
    ] {
        let answer = server.ask("GET", path, PAGE, "");
        assert_eq!(answer.status, 200, "{path}");
        let again = format!("{PAGE}If-None-Match: {}\r\n", answer.header("etag").unwrap());
        assert_eq!(server.ask("GET", path, &again, "").status, 304, "{path}");
    }
    for path in [
        "/%2e%2e/Cargo.toml",
        "/../Cargo.toml",
        "//app.js",
        "/app.js/",
        "/\\app.js",
        "/demo.toml",
        "/manifest.json",
        "/%00",
    ] {
        let answer = server.ask("GET", path, PAGE, "");
        assert!(matches!(answer.status, 400 | 404), "{path}: {answer:?}");
    }
    assert_eq!(server.ask("POST", "/", PAGE, "").status, 405);
    for path in ["/", "/nothing", "/api/v1/server", "/api/nothing"] {
        let answer = server.ask("GET", path, PAGE, "");
        let policy = answer.header("content-security-policy").unwrap_or_default();
        for part in [
            "default-src 'none'",
            "script-src 'self';",
            "frame-ancestors 'none'",
            "require-trusted-types-for 'script'",
        ] {
            assert!(policy.contains(part), "{path}: {policy}");
        }
        assert_eq!(answer.header("x-content-type-options"), Some("nosniff"), "{path}");
        assert_eq!(answer.header("referrer-policy"), Some("no-referrer"), "{path}");
        assert_eq!(
            answer.header("cross-origin-resource-policy"),
            Some("same-origin"),
            "{path}"
        );
        assert_eq!(
            answer.header("cross-origin-opener-policy"),
            Some("same-origin"),
            "{path}"
        );
        assert!(answer.header("cache-control").is_some(), "{path}");
    }
}

#[test]
fn connections_that_stay_idle_hold_up_nobody() {
    let server = Running::demo();
    let mut socket = Hands::of(&server, &server.view);
    // one that is within a request keeps its place
    let mut slow = TcpStream::connect(server.address).unwrap();
    let bearer = Running::bearer(&server.control).replace("{address}", &server.address.to_string());
    let head =
        format!("POST /api/v1/captures HTTP/1.1\r\n{bearer}Connection: close\r\nContent-Length: 4\r\n\r\nab");
    slow.write_all(head.as_bytes()).unwrap();
    // some send nothing, some a part of a head, some a part of a login, and all of them stay
    let mut idle: Vec<TcpStream> = Vec::new();
    for number in 0..300 {
        let mut stream = TcpStream::connect(server.address).unwrap();
        if number % 3 == 1 {
            let origin = format!("Host: {0}\r\nOrigin: http://{0}", server.address);
            let login = format!(
                "POST /api/v1/session HTTP/1.1\r\n{origin}\r\nContent-Type: application/json\r\nContent-Length: 100\r\n\r\n{{"
            );
            let _ = stream.write_all(login.as_bytes());
        }
        if number % 3 == 0 {
            // one that was ended already takes nothing
            let _ = stream.write_all(b"POST /api/v1/stop HTTP/1.1\r\nHost: ");
        }
        idle.push(stream);
    }
    let begin = Instant::now();
    let stopped = server.ask("POST", "/api/v1/stop", &Running::bearer(&server.view), "");
    let time = begin.elapsed();
    assert_eq!(stopped.status, 200);
    // far below the time that an idle connection has
    assert!(time < Duration::from_secs(4), "{time:?}");
    assert_eq!(socket.stopped()["epoch"], 1, "a socket goes on");
    slow.write_all(b"cd").unwrap();
    let mut answer = String::new();
    slow.read_to_string(&mut answer).unwrap();
    assert!(answer.starts_with("HTTP/1.1 200"), "{answer}");
    drop(idle);
}

/// Opens more connections than there are places, which request something over and over again and read nothing.
fn that_read_nothing(server: &Running, path: &str, each: usize) -> Vec<TcpStream> {
    let bearer = Running::bearer(&server.view).replace("{address}", &server.address.to_string());
    // a header makes no socket of it
    let requests = format!("GET {path} HTTP/1.1\r\n{bearer}Upgrade: x\r\n\r\n").repeat(each);
    let open = |_| {
        let mut stream = TcpStream::connect(server.address).unwrap();
        // one that was ended already takes nothing
        let _ = stream.write_all(requests.as_bytes());
        stream
    };
    (0..300).map(open).collect()
}

#[test]
fn connections_that_read_nothing_or_request_much_hold_up_no_stop() {
    let server = Running::demo();
    let id = known(&server, "axis-1");
    // a log that is more than a connection takes without being read
    let record = json!({
        "time": "2026-11-01T00:00:00.000Z", "boot": "b", "engine_us": 1, "epoch": 0, "who": "1",
        "action": "stop", "result": "x".repeat(1500),
    });
    let log = format!("{record}\n").repeat(8000);
    std::fs::write(server.folder.join("audit-2026-11-01-000.jsonl"), log).unwrap();
    // and a list of parameters is much work
    let paths = [
        "/api/v1/logs/log.csv".to_owned(),
        format!("/api/v1/drives/{id}/parameters"),
    ];
    for (path, each) in paths.iter().zip([1, 60]) {
        let connections = that_read_nothing(&server, path, each);
        let begin = Instant::now();
        let stopped = server.ask("POST", "/api/v1/stop", &Running::bearer(&server.view), "");
        let time = begin.elapsed();
        // with the others there still, none of which ends by itself
        assert_eq!(stopped.status, 200, "{path}");
        assert!(time < Duration::from_secs(4), "{path}: {time:?}");
        drop(connections);
    }
}

#[test]
fn a_head_that_comes_too_slowly_ends_its_connection() {
    let server = Running::demo();
    let mut slow = TcpStream::connect(server.address).unwrap();
    slow.set_read_timeout(Some(Duration::from_millis(200))).unwrap();
    let begin = Instant::now();
    let head = b"POST /api/v1/stop HTTP/1.1\r\nHost: "
        .iter()
        .chain(std::iter::repeat(&b'a'));
    for octet in head {
        assert!(begin.elapsed() < Duration::from_secs(30), "it is still open");
        let sent = slow.write_all(&[*octet]);
        let mut buffer = [0; 256];
        match (sent, slow.read(&mut buffer)) {
            (Ok(()), Err(error)) if matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut) => {}
            // an answer, an end or a reset
            _ => break,
        }
    }
    assert!(begin.elapsed() > Duration::from_secs(5), "it had its time");
    assert_eq!(server.stops(), 0);
}

#[test]
fn a_server_is_for_this_computer_alone() {
    let listen = "0.0.0.0:0".parse().unwrap();
    let settings = Settings {
        listen,
        ..Settings::new(Source::Demo)
    };
    let open = Server::open(settings, Stop::new().unwrap());
    assert!(matches!(open, Err(ServeError::NotLocal(_))), "{open:?}");
    let server = Running::demo();
    let settings = Settings {
        listen: server.address,
        ..Settings::new(Source::Demo)
    };
    let open = Server::open(settings, Stop::new().unwrap());
    assert!(matches!(open, Err(ServeError::Listen { .. })), "{open:?}");
}

/// A page that came by the address elsewhere looks, changes values and stops; it moves axes only where that was permitted.
#[test]
fn a_page_elsewhere_moves_nothing_without_permission() {
    const ELSEWHERE: &str = "Host: line3.example\r\nOrigin: https://line3.example\r\n";
    for (moves_remotely, refusal) in [(false, Some("remote")), (true, None)] {
        let server = Running::start(Settings {
            public_url: Some("https://line3.example".to_owned()),
            moves_remotely,
            ..Settings::new(Source::Demo)
        });
        let body = format!("{{\"token\":\"{}\"}}", server.control);
        let answer = server.ask("POST", "/api/v1/session", &format!("{ELSEWHERE}{JSON}"), &body);
        assert_eq!(answer.status, 200, "{answer:?}");
        let cookie = answer
            .header("set-cookie")
            .unwrap()
            .split(';')
            .next()
            .unwrap()
            .to_owned();
        let session = format!("{ELSEWHERE}Cookie: {cookie}\r\n");
        let hello = |headers: &str| {
            let page = open_at(&server, "/api/v1/control", headers, Some("profidrive.control.1"));
            page.unwrap_or_else(|status| panic!("{status}")).next("hello")["refusal"].clone()
        };
        assert_eq!(hello(&session).as_str(), refusal);
        // proxies that put the host of this server in place of the one that was wanted
        let own_host = session.replace("Host: line3.example", "Host: {address}");
        assert_eq!(hello(&own_host).as_str(), refusal);
        let passed_on = format!("{PAGE}Cookie: {cookie}\r\nX-Forwarded-For: 192.168.0.9\r\n");
        assert_eq!(hello(&passed_on).as_str(), refusal);
        assert_eq!(hello(&format!("{PAGE}Cookie: {cookie}\r\n")), Value::Null, "here");
        assert_eq!(server.ask("POST", "/api/v1/stop", &session, "").status, 200);
        let foreign = session.replace("https://", "http://");
        assert_eq!(server.ask("POST", "/api/v1/stop", &foreign, "").status, 403);
    }
    let settings = Settings {
        public_url: Some("line3.example".to_owned()),
        ..Settings::new(Source::Demo)
    };
    let open = Server::open(settings, Stop::new().unwrap());
    assert!(matches!(open, Err(ServeError::PublicUrl(_))), "{open:?}");
}

#[test]
fn the_demo_shows_each_situation() {
    let server = Running::demo();
    let cause = |all: &Value, name: Option<&str>| {
        let stations = all["stations"].as_array().unwrap();
        let found = stations.iter().find(|one| one["name"].as_str() == name);
        found.map(|one| one["status"]["cause"].as_str().unwrap_or_default().to_owned())
    };
    let wanted = |all: &Value| {
        cause(all, Some("axis-2")).as_deref() == Some("fault")
            && cause(all, Some("fan-1")).as_deref() == Some("fault")
            && cause(all, Some("axis-1")).as_deref() == Some("no-controller")
            && cause(all, Some("pump-1")).as_deref() == Some("no-controller")
            && cause(all, Some("press-1")).as_deref() == Some("moves")
    };
    let all = eventually(&server, "/api/v1/stations", wanted);
    let stations = all["stations"].as_array().unwrap();
    assert_eq!(stations.len(), 6);
    let named = |name: Option<&str>| stations.iter().find(|one| one["name"].as_str() == name).unwrap();
    assert_eq!(named(Some("press-1"))["status"]["controller"]["name"], "plc-1");
    assert_eq!(
        named(None)["remarks"],
        serde_json::json!(["no_name", "no_address"])
    );
    assert_eq!(named(None)["status"], Value::Null);
    let id = named(Some("axis-2"))["id"].as_str().unwrap();
    let faults = server.ask(
        "GET",
        &format!("/api/v1/drives/{id}/faults"),
        &Running::bearer(&server.view),
        "",
    );
    assert_eq!(faults.json()["faults"][0]["number"], 439);
    let turns = |all: &Value| {
        let drives = all["drives"].as_array().unwrap();
        drives
            .iter()
            .any(|one| one["name"] == "press-1" && one["speed"].as_f64().unwrap() > 100.0)
    };
    eventually(&server, "/api/v1/plant/drives", turns);
    let anonymous = server.ask(
        "GET",
        "/api/v1/drives/nothing/status",
        &Running::bearer(&server.view),
        "",
    );
    assert_eq!(
        (anonymous.status, &anonymous.json()["kind"]),
        (404, &Value::from("drive"))
    );
}

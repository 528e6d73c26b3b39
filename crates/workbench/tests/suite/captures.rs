//! Captures that are uploaded: whole, cut, hostile and too large.

use std::io::{Read, Write};
use std::net::TcpStream;
use std::time::{Duration, Instant};

use serde_json::Value;

use crate::server::{Answer, Running, eventually};

pub const FULL: &[u8] = include_bytes!("../../../../captures/pnet-profinetpy-full.pcapng");

pub fn post(server: &Running, length: u64, octets: &[u8]) -> Answer {
    let head = format!(
        "POST /api/v1/captures HTTP/1.1\r\n{}Connection: close\r\nContent-Length: {length}\r\n\r\n",
        Running::bearer(&server.control).replace("{address}", &server.address.to_string())
    );
    server.raw(&[head.as_bytes(), octets].concat())
}

/// Uploads a capture and waits until it was read.
fn read(server: &Running, octets: &[u8]) -> Value {
    let answer = post(server, octets.len() as u64, octets);
    assert_eq!(answer.status, 200, "{answer:?}");
    let path = format!("/api/v1/captures/{}", answer.json()["id"]);
    eventually(server, &path, |report| report["ended"] == true)
}

fn get(server: &Running, path: &str) -> Answer {
    server.ask("GET", path, &Running::bearer(&server.view), "")
}

#[test]
fn a_capture_is_shown_in_pieces() {
    let server = Running::demo();
    let report = read(&server, FULL);
    assert_eq!(report["error"], Value::Null);
    let total = report["counts"]["frames"].as_u64().unwrap();
    assert!(total > 50, "{report}");
    let id = &report["id"];
    let frames = get(&server, &format!("/api/v1/captures/{id}/frames?from=3&most=2")).json();
    assert_eq!(frames["total"], total);
    let numbers: Vec<_> = frames["frames"]
        .as_array()
        .unwrap()
        .iter()
        .map(|row| row["frame"].as_u64().unwrap())
        .collect();
    assert_eq!(numbers, [3, 4]);
    let events = get(&server, &format!("/api/v1/captures/{id}/events?most=1000")).json();
    let all = events["events"].as_array().unwrap();
    assert_eq!(all.len() as u64, events["total"].as_u64().unwrap());
    // the same frame has the same fields, however it was reached
    let last = all.iter().rev().find(|event| event["topic"] == "record").unwrap();
    let frame = get(
        &server,
        &format!("/api/v1/captures/{id}/frames/{}", last["frame"]),
    )
    .json();
    let texts = frame["texts"].as_array().unwrap();
    assert!(texts.contains(&last["text"]), "{texts:?} {last}");
    let octets = frame["octets"].as_str().unwrap().split(' ').count() as u64;
    assert_eq!(frame["tree"]["end"], octets);
    // filters
    let trouble = get(&server, &format!("/api/v1/captures/{id}/events?trouble=true")).json();
    assert!(
        trouble["events"]
            .as_array()
            .unwrap()
            .iter()
            .all(|event| event["trouble"] == true)
    );
    let late = get(&server, &format!("/api/v1/captures/{id}/events?begin=0.5&most=1")).json();
    assert!(late["events"][0]["time"].as_f64().unwrap() >= 0.5);
    for (path, status) in [
        (format!("/api/v1/captures/{id}/events?begin=x"), 400),
        (format!("/api/v1/captures/{id}/events?device=x"), 400),
        (format!("/api/v1/captures/{id}/frames/0"), 404),
        (format!("/api/v1/captures/{id}/frames/{}", total + 1), 404),
        (format!("/api/v1/captures/{id}/frames/18446744073709551615"), 404),
        (format!("/api/v1/captures/{id}/frames/..%2f1"), 400),
        ("/api/v1/captures/99".to_owned(), 404),
    ] {
        assert_eq!(get(&server, &path).status, status, "{path}");
    }
    let gone = server.ask(
        "DELETE",
        &format!("/api/v1/captures/{id}"),
        &Running::bearer(&server.control),
        "",
    );
    assert_eq!(gone.status, 204);
    assert_eq!(get(&server, &format!("/api/v1/captures/{id}")).status, 404);
}

#[test]
fn a_file_that_is_cut_or_foreign_says_where_and_what() {
    let server = Running::demo();
    let mut seed = 7_u64;
    let mut random = || {
        seed = seed
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (seed >> 33) as usize
    };
    // each octet of its heads and of its first frame
    for length in (1..400).chain([FULL.len() - 1]) {
        let report = read(&server, &FULL[..length]);
        let error = report["error"].as_str();
        assert!(
            error.is_none_or(|error| error.contains("octet") || error.contains("not a capture")),
            "{length} {report}"
        );
    }
    let cut = read(&server, &FULL[..FULL.len() - 1]);
    assert!(cut["error"].as_str().unwrap().contains("octet"), "{cut}");
    assert!(
        cut["counts"]["frames"].as_u64().unwrap() > 50,
        "what is whole is shown: {cut}"
    );
    for _ in 0..40 {
        let mut damaged = FULL.to_vec();
        for _ in 0..20 {
            let at = random() % damaged.len();
            damaged[at] = random() as u8;
        }
        let report = read(&server, &damaged);
        let id = &report["id"];
        for path in ["events?most=1000", "frames?most=1000"] {
            assert_eq!(get(&server, &format!("/api/v1/captures/{id}/{path}")).status, 200);
        }
        for number in 1..=report["counts"]["frames"].as_u64().unwrap().min(5) {
            assert_eq!(
                get(&server, &format!("/api/v1/captures/{id}/frames/{number}")).status,
                200
            );
        }
    }
    assert_eq!(read(&server, b"<html>")["counts"]["frames"], 0);
    // the last four are kept
    let all = get(&server, "/api/v1/captures").json();
    assert_eq!(all["captures"].as_array().unwrap().len(), 4);
}

#[test]
fn a_capture_that_is_too_large_is_refused_before_it_comes() {
    let server = Running::demo();
    let started = Instant::now();
    let answer = post(&server, 300 << 20, b"");
    assert_eq!(answer.status, 413, "{answer:?}");
    assert!(answer.json()["detail"].as_str().unwrap().contains("256 MiB"));
    assert!(started.elapsed() < Duration::from_secs(10));
    // one that does not end leaves nothing
    let mut stream = TcpStream::connect(server.address).unwrap();
    let head = format!(
        "POST /api/v1/captures HTTP/1.1\r\n{}Transfer-Encoding: chunked\r\n\r\n5\r\nabcde\r\n",
        Running::bearer(&server.control).replace("{address}", &server.address.to_string())
    );
    stream.write_all(head.as_bytes()).unwrap();
    drop(stream);
    let all = get(&server, "/api/v1/captures").json();
    assert_eq!(all["captures"].as_array().unwrap().len(), 0);
    // one that never ends is ended at the limit, and leaves nothing either
    let mut stream = TcpStream::connect(server.address).unwrap();
    let head = head.split("5\r\nabcde").next().unwrap();
    stream.write_all(head.as_bytes()).unwrap();
    let chunk = [b"100000\r\n".as_slice(), &vec![0; 1 << 20], b"\r\n"].concat();
    let mut sent = 0;
    while stream.write_all(&chunk).is_ok() {
        sent += 1;
        assert!(sent < 1000, "{sent} MiB were taken");
    }
    let mut answer = [0; 12];
    // a connection that is closed with unread octets may lose its answer on the way
    if stream.read_exact(&mut answer).is_ok() {
        assert_eq!(answer.as_slice(), b"HTTP/1.1 413");
    }
    assert!(sent >= 256, "{sent}");
    let all = get(&server, "/api/v1/captures").json();
    assert_eq!(all["captures"].as_array().unwrap().len(), 0);
    // nothing is decompressed, whatever a head says of it
    let head = format!(
        "POST /api/v1/captures HTTP/1.1\r\n{}Connection: close\r\nContent-Encoding: gzip\r\nContent-Length: 4\r\n\r\n",
        Running::bearer(&server.control).replace("{address}", &server.address.to_string())
    );
    let packed = server.raw(&[head.as_bytes(), &[0x1F, 0x8B, 8, 0]].concat());
    assert_eq!(packed.status, 200, "{packed:?}");
    let path = format!("/api/v1/captures/{}", packed.json()["id"]);
    let report = eventually(&server, &path, |report| report["ended"] == true);
    assert!(
        report["error"].as_str().unwrap().contains("not a capture"),
        "{report}"
    );
    let refused = server.ask("POST", "/api/v1/captures", &Running::bearer(&server.view), "abc");
    assert_eq!(refused.status, 403);
}

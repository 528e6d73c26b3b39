//! Samples of drives, as pages receive them.

use std::time::{Duration, Instant};

use serde_json::{Value, json};
use tungstenite::Message;

use crate::change::known;
use crate::hands::{Hands, lease};
use crate::live::Page;
use crate::server::Running;

/// A block: stream, number, rows, columns, rows lost before it, times of its rows, us.
struct Block {
    stream: u16,
    number: u32,
    lost: u32,
    columns: Vec<Vec<u32>>,
    times: Vec<u64>,
}

impl Block {
    fn of(octets: &[u8]) -> Self {
        let word = |at: usize| u32::from_le_bytes(octets[at..at + 4].try_into().unwrap());
        let short = |at: usize| u16::from_le_bytes(octets[at..at + 2].try_into().unwrap());
        assert_eq!((octets[0], octets[1]), (1, 1), "kind and version");
        let (rows, columns) = (usize::from(short(20)), usize::from(short(22)));
        let first = u64::from_le_bytes(octets[8..16].try_into().unwrap());
        let period = f64::from(f32::from_bits(word(16)));
        let offsets = short(28) & 1 == 1;
        let begin = 32 + if offsets { rows * 4 } else { 0 };
        assert_eq!(octets.len(), begin + rows * columns * 4);
        let times = (0..rows).map(|row| match offsets {
            true => first + u64::from(word(32 + row * 4)),
            false => first + (period * row as f64).round() as u64,
        });
        let column = |column: usize| {
            (0..rows)
                .map(|row| word(begin + (column * rows + row) * 4))
                .collect()
        };
        Self {
            stream: short(2),
            number: word(4),
            lost: word(24),
            columns: (0..columns).map(column).collect(),
            times: times.collect(),
        }
    }
}

/// Returns the next head of a stream of this topic that fits.
fn stream(page: &mut Page, topic: &str, source: &str) -> Value {
    let begin = Instant::now();
    loop {
        assert!(
            begin.elapsed() < Duration::from_secs(30),
            "no {source} of {topic}"
        );
        let head = page.next("stream");
        if head["topic"] == topic && head["source"] == source {
            return head;
        }
    }
}

/// Returns the blocks of a stream until they have so many rows.
fn blocks(page: &mut Page, head: &Value, rows: usize) -> Vec<Block> {
    let mut blocks: Vec<Block> = Vec::new();
    let begin = Instant::now();
    while blocks.iter().map(|block| block.times.len()).sum::<usize>() < rows {
        assert!(begin.elapsed() < Duration::from_secs(30), "no rows");
        if let Message::Binary(octets) = page.message() {
            let block = Block::of(&octets);
            if head["id"] == block.stream {
                blocks.push(block);
            }
        }
    }
    blocks
}

fn place(head: &Value, role: &str) -> usize {
    let columns = head["columns"].as_array().unwrap();
    columns.iter().position(|column| column["role"] == role).unwrap()
}

fn subscribe(page: &mut Page, topic: &str, parameters: &[&str]) {
    page.send(&json!({ "type": "subscribe", "topic": topic, "rate": 30, "parameters": parameters }));
}

#[test]
fn a_drive_of_another_controller_is_read_beside_it() {
    let server = Running::demo();
    let id = known(&server, "press-1");
    let mut page = Page::of(&server);
    let (cyclic, acyclic) = (format!("drive/{id}/samples"), format!("drive/{id}/acyclic"));
    subscribe(&mut page, &cyclic, &[]);
    let head = stream(&mut page, &cyclic, "none");
    assert_eq!(head["reason"], Value::Null);
    subscribe(&mut page, &acyclic, &["DRV.ACC", "p1", "DRV.NAME", "no-such"]);
    let head = stream(&mut page, &acyclic, "acyclic");
    let columns = head["columns"].as_array().unwrap();
    let named: Vec<&str> = columns
        .iter()
        .filter_map(|column| column["name"].as_str())
        .collect();
    assert_eq!(&named[..4], ["STW1", "ZSW1", "set speed", "speed"]);
    assert!(named.contains(&"DRV.ACC") && named.contains(&"p1"), "{named:?}");
    let acceleration = columns.iter().find(|column| column["name"] == "DRV.ACC").unwrap();
    assert_eq!(
        (&acceleration["unit"], &acceleration["from"]),
        (&"rpm/s".into(), &"DRV.ACC (p2108)".into())
    );
    let refused = head["refused"].as_array().unwrap();
    let refused: Vec<&str> = refused.iter().filter_map(|one| one[0].as_str()).collect();
    assert!(
        refused.contains(&"DRV.NAME") && refused.contains(&"no-such"),
        "{head}"
    );
    let status = &columns[place(&head, "status")];
    assert_eq!(status["bits"].as_array().unwrap().len(), 16, "{status}");
    let speed = place(&head, "speed");
    let mut last = 0;
    let mut speeds: Vec<f32> = Vec::new();
    let begin = Instant::now();
    // its controller turns it and lets it rest, every eight seconds
    while speeds.iter().all(|speed| (speed - speeds[0]).abs() < 50.0) {
        assert!(begin.elapsed() < Duration::from_secs(30), "{speeds:?}");
        for block in blocks(&mut page, &head, 1) {
            assert_eq!(block.columns.len(), columns.len());
            for (row, time) in block.times.iter().enumerate() {
                assert!(*time > last, "times grow");
                last = *time;
                speeds.push(f32::from_bits(block.columns[speed][row]));
                // S4: ready, operation enabled
                assert_eq!(block.columns[place(&head, "status")][row] & 7, 7);
            }
        }
    }
    // what no page wants is not read
    page.send(&json!({ "type": "unsubscribe", "topic": acyclic }));
    for _ in 0..8 {
        page.next("clock");
    }
    subscribe(&mut page, &acyclic, &[]);
    let again = stream(&mut page, &acyclic, "acyclic");
    assert!(again["id"].as_u64() > head["id"].as_u64());
}

#[test]
fn an_axis_under_control_has_a_row_for_each_frame() {
    let server = Running::demo();
    let id = known(&server, "axis-1");
    let mut hands = Hands::of(&server, &server.control);
    let lease = lease(&hands.take(&id));
    assert_eq!(
        hands.order("enable", &id, lease, 0, &json!({}))["type"],
        "accepted"
    );
    let topic = format!("drive/{id}/samples");
    let (mut page, mut other) = (Page::of(&server), Page::of(&server));
    for page in [&mut page, &mut other] {
        subscribe(page, &topic, &[]);
    }
    let head = stream(&mut page, &topic, "cyclic");
    assert_eq!(stream(&mut other, &topic, "cyclic")["id"], head["id"]);
    let period = head["period_us"].as_u64().unwrap();
    assert_eq!(head["simulation"], true);
    let columns = head["columns"].as_array().unwrap();
    let named: Vec<&str> = columns
        .iter()
        .filter_map(|column| column["name"].as_str())
        .collect();
    assert!(
        named.starts_with(&["STW1", "NSOLL_A"]) && named.contains(&"NIST_A"),
        "{named:?}"
    );
    let begin = Instant::now();
    let number = hands.send(
        "velocity",
        &id,
        &json!({ "lease": lease, "epoch": 0, "speed": 20 }),
    );
    assert!(number > 0);
    let (set, speed) = (place(&head, "speed_set"), place(&head, "speed"));
    let mut rows: Vec<(u64, f32, f32)> = Vec::new();
    let mut next = None;
    // the motor follows its setpoint, and each cycle has its row
    while rows
        .last()
        .is_none_or(|(_, set, speed)| *set < 19.0 || *speed < 19.0)
    {
        assert!(begin.elapsed() < Duration::from_secs(20), "{:?}", rows.last());
        hands.beat(&Value::Null);
        for block in blocks(&mut page, &head, 1) {
            assert_eq!(block.number, next.unwrap_or(block.number), "no block is missing");
            next = Some(block.number + 1);
            assert_eq!(block.lost, 0);
            for (row, time) in block.times.iter().enumerate() {
                let value = |column: usize| f32::from_bits(block.columns[column][row]);
                rows.push((*time, value(set), value(speed)));
            }
        }
    }
    let (first, last) = (rows[0].0, rows[rows.len() - 1].0);
    let due = (last - first + period / 2) / period;
    assert_eq!(due + 1, rows.len() as u64, "a row for each cycle of {period} us");
    // the same octets for each page
    let (mine, theirs) = (blocks(&mut other, &head, 1), next.unwrap());
    assert!(mine[0].number < theirs, "it had the blocks from the beginning");
    hands.send("release", &id, &json!({}));
    let head = stream(&mut page, &topic, "none");
    assert_eq!(head["columns"], json!([]));
}

#[test]
fn a_drive_that_is_not_there_is_no_source() {
    let server = Running::demo();
    let mut page = Page::of(&server);
    for id in ["02:00:00:00:00:99", "x"] {
        let topic = format!("drive/{id}/acyclic");
        subscribe(&mut page, &topic, &[]);
        let head = stream(&mut page, &topic, "none");
        assert!(!head["reason"].as_str().unwrap_or_default().is_empty(), "{head}");
    }
    // more parameters than a stream has: the message is not taken
    let many: Vec<String> = (0..17).map(|number| format!("p{number}")).collect();
    let many: Vec<&str> = many.iter().map(String::as_str).collect();
    subscribe(&mut page, "drive/x/acyclic", &many);
    page.next("clock");
}

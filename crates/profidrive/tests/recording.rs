//! Recordings of drives in plants in memory, in virtual time.
#![cfg(all(feature = "simulate", feature = "recording"))]

use std::time::Duration;

use profidrive::client::{ErrorKind, Session};
use profidrive::fleet::Selected;
use profidrive::recording::{Every, News, Recording, RecordingError, Request, Row, Value, prepare};
use profidrive::{Access, Explained, Network, Opening, Wait};

const MS: Duration = Duration::from_millis(1);

fn plant(drives: &[(&str, &str)]) -> String {
    let mut text = String::new();
    for (at, (name, more)) in drives.iter().enumerate() {
        text += &format!(
            "[[drive]]\nname = \"{name}\"\nip = \"10.0.0.{}/24\"\n{more}\n",
            at + 1
        );
    }
    text
}

fn open(plant: &str, selector: &str) -> (Network, Vec<Selected>) {
    let opening = Opening::new(Access::Cyclic).in_plant(plant.parse().expect("a plant"));
    let mut network = opening.clone().open().expect("opens");
    let selector = selector.parse().expect("a selector");
    let fleet = opening.select(&mut network, &selector).wait().expect("searched");
    (network, fleet.members)
}

fn begin(
    session: &Session,
    members: Vec<Selected>,
    request: &Request,
) -> Result<Recording, Box<(String, RecordingError)>> {
    let mut sources = Vec::new();
    for member in prepare(session, members, request).wait() {
        sources.push(
            member
                .result
                .map_err(|error| Box::new((member.name.clone(), error)))?,
        );
    }
    Recording::begin(session, profidrive::WallClock::NONE, sources, request)
        .map_err(|error| Box::new((String::new(), error)))
}

/// Everything until the end: rows, and the other news as texts.
fn all(recording: &mut Recording) -> (Vec<Row>, Vec<String>) {
    let (mut rows, mut news) = (Vec::new(), Vec::new());
    while let Some(event) = recording.next().wait().expect("in memory") {
        match event {
            News::Row(row) => rows.push(row),
            other => news.push(format!("{other:?}")),
        }
    }
    (rows, news)
}

fn millis(row: &Row) -> u128 {
    row.time.as_millis()
}

#[test]
fn parameters_of_many_drives_are_read_at_the_interval() {
    let (network, members) = open(&plant(&[("akd-1", ""), ("akd-2", "")]), "all");
    let request = Request {
        time: Some(MS * 1000),
        ..Request::new(["DRV.ACC", "922"], Every::Interval(MS * 100))
    };
    let mut recording = begin(&network, members, &request).unwrap();
    assert_eq!(recording.table().drives, ["akd-1", "akd-2"]);
    assert_eq!(recording.table().columns[0].unit, "rpm/s");
    let (rows, news) = all(&mut recording);
    assert_eq!(news, [""; 0]);
    for drive in 0..2 {
        let own: Vec<&Row> = rows.iter().filter(|row| row.drive == drive).collect();
        assert_eq!(own.len(), 10, "{own:?}");
        assert!(
            own.iter()
                .all(|row| !row.gap && row.values[0] == Some(Value::Number(3000.0)))
        );
        for (at, row) in own.iter().enumerate() {
            let due = at as u128 * 100;
            assert!((due..due + 50).contains(&millis(row)), "{row:?}");
        }
    }
    assert_eq!(recording.counts()[0].rows, 10);
}

#[test]
fn an_outage_is_one_gap_and_is_counted() {
    let pulled = "event = [{ at = \"4s\", do = \"cable=pulled\", for = \"3s\" }]";
    let (network, members) = open(&plant(&[("akd-1", pulled), ("akd-2", "")]), "all");
    let request = Request {
        time: Some(MS * 8000),
        ..Request::new(["DRV.ACC"], Every::Interval(MS * 100))
    };
    let mut recording = begin(&network, members, &request).unwrap();
    let (rows, news) = all(&mut recording);
    let gaps: Vec<&Row> = rows.iter().filter(|row| row.gap).collect();
    assert!(
        gaps.len() == 1 && gaps[0].drive == 0 && gaps[0].values[0].is_none(),
        "{gaps:?} {news:?}"
    );
    assert!(
        news.len() == 2 && news[0].starts_with("Away") && news[1].starts_with("Back"),
        "{news:?}"
    );
    let [first, second] = recording.counts() else {
        panic!()
    };
    assert_eq!((second.rows, second.gaps, second.missed), (80, 0, 0));
    // every reading that was due is a row or is counted as missing
    assert_eq!(first.rows + first.missed, 80, "{first:?}");
    assert!(first.missed >= 25 && first.outages == 1, "{first:?}");
}

#[test]
fn every_cycle_is_a_row_and_the_drive_is_not_commanded() {
    let (network, members) = open(&plant(&[("akd-1", ""), ("vlt-1", "model = \"vlt\"")]), "all");
    let request = Request {
        time: Some(MS * 2000),
        ..Request::new(["STW1", "ZSW1"], Every::CYCLE)
    };
    let mut recording = begin(&network, members, &request).unwrap();
    let (rows, news) = all(&mut recording);
    assert_eq!(news, [""; 0]);
    for drive in 0..2 {
        let own: Vec<&Row> = rows.iter().filter(|row| row.drive == drive).collect();
        assert!((124..=126).contains(&own.len()), "{}", own.len());
        for pair in own.windows(2) {
            let cycle = (pair[1].time - pair[0].time).as_millis();
            assert_eq!(cycle, 16, "{pair:?}");
        }
        for row in own {
            let Some(Value::Word(word)) = row.values[0] else {
                panic!("{row:?}")
            };
            assert_eq!(word & 1 << 10, 0, "bit 10: {word:#06X}");
        }
    }
}

#[test]
fn lost_cycles_are_rows() {
    let lossy = "event = [{ at = \"0s\", do = \"loss=5%\" }]";
    let (network, members) = open(&plant(&[("akd-1", lossy)]), "akd-1");
    let request = Request {
        time: Some(MS * 10_000),
        ..Request::new(["ZSW1"], Every::CYCLE)
    };
    let mut recording = begin(&network, members, &request).unwrap();
    let (rows, _) = all(&mut recording);
    let counts = recording.counts()[0];
    assert!(counts.gaps > 5 && counts.gaps == counts.missed, "{counts:?}");
    assert!((620..=626).contains(&rows.len()), "{}", rows.len());
    for pair in rows.windows(2) {
        let cycle = (pair[1].time - pair[0].time).as_millis();
        assert!((15..=17).contains(&cycle), "{pair:?}");
    }
}

#[test]
fn a_drive_that_was_lost_is_recorded_again() {
    let lost = "event = [{ at = \"2s\", do = \"cable=pulled\", for = \"5s\" }]";
    let (network, members) = open(&plant(&[("akd-1", lost)]), "akd-1");
    let request = Request {
        time: Some(MS * 20_000),
        ..Request::new(["all"], Every::CYCLE)
    };
    let mut recording = begin(&network, members, &request).unwrap();
    let (rows, news) = all(&mut recording);
    let counts = recording.counts()[0];
    assert!(news.len() == 2 && news[1].starts_with("Back"), "{news:?}");
    assert_eq!((counts.gaps, counts.outages), (1, 1), "{counts:?}");
    assert!(millis(rows.last().unwrap()) > 19_900, "{counts:?}");
    // from the last frame on, not from when the connection was given up
    assert!(counts.outage_time > MS * 5000, "{counts:?}");
    assert!(counts.rows + counts.missed >= 1245, "20 s of 16 ms: {counts:?}");
}

#[test]
fn a_trigger_has_the_time_before_it() {
    let fault = "event = [{ at = \"3s\", do = \"fault=439\" }]";
    for (signal, every, count) in [
        ("ZSW1", Every::CYCLE, 43..=45),
        ("DRV.ACC", Every::Interval(MS * 50), 13..=15),
    ] {
        let (network, members) = open(&plant(&[("akd-1", fault), ("akd-2", "")]), "all");
        let request = Request {
            trigger: Some("fault".parse().unwrap()),
            pre: MS * 500,
            time: Some(MS * 200),
            ..Request::new([signal], every)
        };
        let mut recording = begin(&network, members, &request).unwrap();
        let (rows, news) = all(&mut recording);
        assert_eq!(news.len(), 1, "{news:?}");
        let triggered = recording.triggered().unwrap();
        assert_eq!(triggered.drive, 0);
        let numbers: Vec<u16> = triggered.faults.iter().map(|fault| fault.number).collect();
        assert_eq!(numbers, [439]);
        let (first, last) = (rows[0].time, rows[rows.len() - 1].time);
        let before = triggered.time - first;
        assert!(before > MS * 440 && before <= MS * 500, "{before:?}");
        assert!(last < triggered.time + MS * 200, "{last:?}");
        for drive in 0..2 {
            let own = rows.iter().filter(|row| row.drive == drive).count();
            assert!(count.contains(&own), "{signal}: {own} rows of {drive}");
        }
    }
}

#[test]
fn what_cannot_be_recorded_is_refused_before_anything_is() {
    let drives = plant(&[("akd-1", ""), ("vlt-1", "model = \"vlt\"")]);
    let refused = |signals: &[&str], every, trigger: Option<&str>| {
        let (network, members) = open(&drives, "all");
        let request = Request {
            trigger: trigger.map(|text| text.parse().unwrap()),
            ..Request::new(signals.iter().copied(), every)
        };
        let (drive, error) = *begin(&network, members, &request).unwrap_err();
        (drive, error.kind(), error.to_string())
    };
    let interval = Every::Interval(MS * 100);
    for (signals, every, trigger, words) in [
        (&[][..], interval, None, "no signal to record"),
        (&["922", "922"], interval, None, "`922` is named twice"),
        (
            &["922"],
            Every::Interval(MS),
            None,
            "at least 10 ms between two readings",
        ),
        (&["DRV.AC"], interval, None, "DRV.AC"),
        (
            &["NIST_A"],
            Every::CYCLE,
            Some("ZSW1>1"),
            "the trigger compares `ZSW1`",
        ),
        (
            &["ZSW1", "FOO"],
            Every::CYCLE,
            None,
            "telegram 1 has no signal `FOO`; it has STW1, NSOLL_A, ZSW1, NIST_A",
        ),
        (
            &["NIST_A"],
            Every::CYCLE,
            Some("NIST_A>1A"),
            "the trigger on NIST_A",
        ),
    ] {
        let (_, kind, text) = refused(signals, every, trigger);
        assert_eq!(kind, ErrorKind::Usage, "{text}");
        assert!(text.contains(words), "{text}");
    }
}

#[test]
fn a_drive_with_a_controller_or_in_operation_is_not_observed() {
    let controlled = plant(&[("akd-1", "")])
        + "[[controller]]\ndrive = \"akd-1\"\ntelegram = 1\nstep = [{ at = \"0s\", send = { STW1 = \"0x047E\" } }]\n";
    let (mut network, members) = open(&controlled, "akd-1");
    network.pass(MS * 3000).wait().unwrap();
    let request = Request::new(["ZSW1"], Every::CYCLE);
    let (_, error) = *begin(&network, members, &request).unwrap_err();
    assert!(error.to_string().contains("controller"), "{error}");
}

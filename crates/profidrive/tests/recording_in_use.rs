//! Recordings of drives that are operated, lost, restarted or changed meanwhile, in virtual time.
// helpers of tests fail by panicking, like the tests themselves
#![allow(clippy::unwrap_used, clippy::panic)]
#![cfg(all(feature = "simulate", feature = "recording"))]

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
use std::time::Duration;

use profidrive::client::axis::Purpose;
use profidrive::client::{AxisSettings, ErrorKind, WriteMode};
use profidrive::fleet::Selected;
use profidrive::recording::{Absence, Every, News, Recording, RecordingError, Request, Row, Value, prepare};
use profidrive::{Access, Caller, Explained, Network, Opening, Transport, Wait};

const MS: Duration = Duration::from_millis(1);

fn open(drive: &str) -> (Network, Vec<Selected>) {
    let plant = format!("[[drive]]\nip = \"10.0.0.1/24\"\n{drive}\n");
    let opening = Opening::new(Access::Cyclic).in_plant(plant.parse().expect("a plant"));
    let mut network = opening.clone().open().expect("opens");
    let fleet = opening
        .select(&mut network, &"all".parse().expect("a selector"))
        .wait();
    (network, fleet.expect("searched").members)
}

fn begin(
    network: &Network,
    members: Vec<Selected>,
    request: &Request,
) -> Result<Recording, Box<RecordingError>> {
    let mut sources = Vec::new();
    for member in prepare(network, members, request).wait() {
        sources.push(member.result.map_err(Box::new)?);
    }
    Recording::begin(network, profidrive::WallClock::NONE, sources, request).map_err(Box::new)
}

fn cyclic(signals: &[&str], seconds: u32) -> Request {
    Request {
        time: Some(Duration::from_secs(1) * seconds),
        ..Request::new(signals.iter().copied(), Every::CYCLE)
    }
}

/// Everything until the end, and what was not a row.
fn rest(recording: &mut Recording) -> (Vec<Row>, Vec<News>) {
    let (mut rows, mut news) = (Vec::new(), Vec::new());
    while let Some(one) = recording.next().wait().expect("in memory") {
        match one {
            News::Row(row) => rows.push(row),
            other => news.push(other),
        }
    }
    (rows, news)
}

/// Takes rows until a time.
fn until(recording: &mut Recording, time: Duration) {
    while recording.elapsed() < time {
        assert!(recording.next().wait().expect("in memory").is_some());
    }
}

fn write(network: &Network, assignments: &[&str]) {
    write_by((**network).clone(), assignments);
}

fn write_by(mut caller: Caller, assignments: &[&str]) {
    let mut drive = caller.find(&"10.0.0.1".parse().unwrap()).wait().expect("there");
    for assignment in assignments {
        let assignment = assignment.parse().expect("an assignment");
        let done = caller.write(&mut drive, &[assignment], WriteMode::Write).wait();
        let done = done.expect("answers");
        assert!(done.is_done());
    }
}

fn speed(network: &Network) -> f64 {
    let Transport::Plant(plant) = network.transport() else {
        panic!("in memory")
    };
    plant.with_world(|world| {
        world
            .drive(0)
            .map_or(0.0, |station| station.drive().axis().speed())
    })
}

/// Without a reaction of the drive to a lost connection its end leaves the motor alone.
#[test]
fn a_drive_that_its_panel_starts_is_left_and_recorded_again_at_rest() {
    let run = "name = \"vlt-1\"\nmodel = \"vlt\"\nevent = [{ at = \"2s\", do = \"local-speed=300rpm\", for = \"6s\" }]";
    let (network, members) = open(run);
    let mut recording = begin(&network, members, &cyclic(&["all"], 6)).unwrap();
    let (rows, news) = rest(&mut recording);
    assert!(
        matches!(
            news[..],
            [News::Away {
                absence: Absence::InUse,
                ..
            }]
        ),
        "{news:?}"
    );
    assert!(
        rows.last().unwrap().gap && rows.last().unwrap().time < MS * 2500,
        "{:?}",
        rows.last()
    );
    assert!(speed(&network) > 290.0, "{}", speed(&network));

    let (network, members) = open(run);
    let mut recording = begin(&network, members, &cyclic(&["all"], 14)).unwrap();
    let (rows, news) = rest(&mut recording);
    assert!(
        matches!(news[..], [News::Away { .. }, News::Back { .. }]),
        "{news:?}"
    );
    let last = rows.last().unwrap();
    assert!(!last.gap && last.time > MS * 13_900, "{last:?}");
}

/// An AKD stops its motor when its connection ends, so the connection stays.
#[test]
fn a_drive_that_would_stop_is_not_left_while_its_motor_turns() {
    let (network, members) = open("name = \"akd-1\"");
    let mut recording = begin(&network, members, &cyclic(&["ZSW1", "NIST_A"], 6)).unwrap();
    until(&mut recording, MS * 1000);
    write(&network, &["DRV.CMDSOURCE=0", "DRV.EN=1", "VL.CMDU=300rpm"]);
    until(&mut recording, MS * 3000);
    assert!(speed(&network) > 290.0, "{}", speed(&network));
    write(&network, &["DRV.DIS=1"]);
    until(&mut recording, MS * 5000);
    let (rows, _) = rest(&mut recording);
    let count = recording.counts()[0];
    assert_eq!((count.gaps, count.outages), (0, 0), "{count:?}");
    let Some(Value::Word(word)) = rows.last().unwrap().values[0] else {
        panic!()
    };
    assert_eq!(word & 1 << 3, 0, "no fault: {word:#06X}");
}

#[test]
fn a_power_stage_that_is_switched_on_is_reported_once() {
    let (network, members) = open("name = \"akd-1\"");
    let mut recording = begin(&network, members, &cyclic(&["ZSW1"], 4)).unwrap();
    until(&mut recording, MS * 1000);
    write(&network, &["DRV.CMDSOURCE=0", "DRV.EN=1"]);
    let mut reactions = Vec::new();
    while let Some(news) = recording.next().wait().unwrap() {
        match news {
            News::PowerOn { reaction, .. } => reactions.push(reaction.to_string()),
            News::Waits { .. } => recording.stop(),
            _ => {}
        }
    }
    assert!(
        reactions.len() == 1 && reactions[0].contains("quick stop"),
        "{reactions:?}"
    );
}

#[test]
fn a_drive_that_may_move_when_the_connection_is_lost_is_not_observed() {
    for (setting, words) in [(4, "8-04 is Max"), (3, "8-04 is Jog"), (1, "8-04 is Freeze")] {
        let drive = format!("name = \"vlt-1\"\nmodel = \"vlt\"\nparameters = {{ 804 = {setting} }}");
        let (network, members) = open(&drive);
        let error = begin(&network, members, &cyclic(&["all"], 1)).unwrap_err();
        assert_eq!(error.kind(), ErrorKind::Safety, "{error}");
        assert!(error.to_string().contains(words), "{error}");
    }
}

/// It answers again at once and does not know the connections of before.
#[test]
fn a_drive_that_restarts_is_recorded_again() {
    let interval = Request {
        time: Some(MS * 9000),
        ..Request::new(["3-41"], Every::Interval(MS * 100))
    };
    for request in [interval, cyclic(&["ZSW1"], 9)] {
        let (network, members) = open("name = \"vlt-1\"\nmodel = \"vlt\"");
        let mut recording = begin(&network, members, &request).unwrap();
        until(&mut recording, MS * 2000);
        write(&network, &["9-72=1"]);
        let (rows, news) = rest(&mut recording);
        assert!(
            matches!(
                news[..],
                [
                    News::Away {
                        absence: Absence::Silent,
                        ..
                    },
                    News::Back { .. }
                ]
            ),
            "{news:?}"
        );
        assert!(rows.last().unwrap().time > MS * 8800, "{request:?}");
    }
}

#[test]
fn faults_of_an_outage_are_reported_when_the_drive_is_back() {
    let pulled = "name = \"akd-1\"\nevent = [{ at = \"2s\", do = \"cable=pulled\", for = \"3s\" }]";
    let (network, members) = open(pulled);
    let mut recording = begin(&network, members, &cyclic(&["ZSW1"], 12)).unwrap();
    let (_, news) = rest(&mut recording);
    let [News::Away { .. }, News::Back { faults, .. }] = &news[..] else {
        panic!("{news:?}")
    };
    assert_eq!(faults.iter().map(|fault| fault.number).collect::<Vec<_>>(), [702]);
}

/// Another program sets the drive up for positioning meanwhile.
#[test]
fn another_telegram_after_an_absence_ends_the_recording_of_the_drive_with_a_gap() {
    let pulled = "name = \"akd-1\"\nevent = [{ at = \"2s\", do = \"cable=pulled\", for = \"3s\" }]";
    let (network, members) = open(pulled);
    let mut recording = begin(&network, members, &cyclic(&["ZSW1", "NIST_A"], 30)).unwrap();
    let mut steps = 0;
    while recording.counts()[0].outages == 0 {
        recording.next().wait().unwrap();
        steps += 1;
        assert!(steps < 1000, "the connection is not lost");
    }
    let mut other = (*network).clone();
    other.pass(MS * 3000).wait().unwrap();
    write(&network, &["930=2"]);
    let mut drive = other.find(&"akd-1".parse().unwrap()).wait().unwrap();
    let settings = AxisSettings::for_purpose(Purpose::Move);
    let axis = other.take_axis(&mut drive, settings).wait().unwrap();
    assert_ne!(axis.telegram(), 1);
    axis.release().wait().unwrap();
    let (rows, news) = rest(&mut recording);
    let Some(News::Ended { error, .. }) = news.last() else {
        panic!("{news:?}")
    };
    assert!(
        matches!(error, RecordingError::Changed { name, .. } if name == "NIST_A"),
        "{error}"
    );
    assert!(rows.last().unwrap().gap);
}

#[test]
fn an_event_that_did_not_happen_is_an_error_and_a_gap_of_each_drive() {
    let (network, members) = open("name = \"akd-1\"");
    let request = Request {
        trigger: Some("VL.FB > 60rpm".parse().unwrap()),
        ..Request::new(["VL.FB"], Every::Interval(MS * 50))
    };
    let mut recording = begin(&network, members, &request).unwrap();
    (*network).clone().pass(MS * 2000).wait().unwrap();
    recording.stop();
    let (rows, _) = rest(&mut recording);
    assert!(
        rows.len() == 1 && rows[0].gap && rows[0].time >= MS * 2000,
        "{rows:?}"
    );
    let error = recording.check_triggered().unwrap_err();
    assert_eq!(error.kind(), ErrorKind::NotReached);
    assert!(
        error
            .to_string()
            .starts_with("`VL.FB > 60rpm` did not happen within 2"),
        "{error}"
    );
}

#[test]
fn a_condition_that_is_true_from_the_beginning_is_named_at_once_and_at_the_end() {
    let (network, members) = open("name = \"akd-1\"");
    let request = Request {
        trigger: Some("DRV.ACC > 1000rpm/s".parse().unwrap()),
        ..Request::new(["DRV.ACC"], Every::Interval(MS * 50))
    };
    let mut recording = begin(&network, members, &request).unwrap();
    let first = recording.next().wait().unwrap().unwrap();
    assert!(matches!(first, News::HoldsAlready { drive: 0, .. }), "{first:?}");
    let words = first.remarks(recording.table())[0].sentence.clone();
    assert!(
        words.starts_with("akd-1: `DRV.ACC > 1000rpm/s` is true already"),
        "{words}"
    );
    (*network).clone().pass(MS * 2000).wait().unwrap();
    recording.stop();
    let (_, news) = rest(&mut recording);
    assert!(news.is_empty(), "said once: {news:?}");
    let error = recording.check_triggered().unwrap_err().to_string();
    assert!(
        error.contains("true from the beginning on akd-1, and did not become true again"),
        "{error}"
    );
}

#[test]
fn a_recording_of_no_time_is_refused() {
    let error = cyclic(&["ZSW1"], 0).check().unwrap_err();
    assert_eq!(
        (error.kind(), error.to_string().as_str()),
        (ErrorKind::Usage, "a recording of 0 s has no rows")
    );
}

#[test]
fn a_cyclic_signal_has_a_common_name_too() {
    let (network, members) = open("name = \"vlt-1\"\nmodel = \"vlt\"");
    let recording = begin(&network, members, &cyclic(&["Speed", "ZSW1"], 1)).unwrap();
    let names: Vec<&str> = recording
        .table()
        .columns
        .iter()
        .map(|one| one.name.as_str())
        .collect();
    assert_eq!(names, ["Speed", "ZSW1"]);
}

/// Whoever takes no rows for a long time gets a bounded number of them and the number of the rest.
#[test]
fn samples_that_are_not_taken_are_bounded() {
    let (network, members) = open("name = \"akd-1\"");
    let request = Request::new(["ZSW1"], Every::CYCLE);
    let mut recording = begin(&network, members, &request).unwrap();
    until(&mut recording, MS * 1000);
    (*network).clone().pass(MS * 200_000).wait().unwrap();
    until(&mut recording, MS * 201_000);
    recording.stop();
    let (rows, _) = rest(&mut recording);
    let counts = recording.counts()[0];
    assert!(counts.rows <= 4096 + 200 && counts.gaps == 1000, "{counts:?}");
    assert!(
        counts.rows + counts.missed >= 201_000 / 16 && !rows.is_empty(),
        "{counts:?}"
    );
}

/// How a recording ends while a motor turns.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Ends {
    Time,
    Stop,
    Interrupted,
}

/// The end of its time, a first stop and a first wish of the caller to stop are the normal end of a recording.
#[test]
fn a_connection_whose_end_would_stop_a_motor_is_closed_at_rest_or_when_the_caller_insists() {
    for (ends, insists) in [
        (Ends::Time, false),
        (Ends::Time, true),
        (Ends::Stop, false),
        (Ends::Stop, true),
        (Ends::Interrupted, false),
        (Ends::Interrupted, true),
    ] {
        let (mut network, members) =
            open("name = \"akd-1\"\nevent = [{ at = \"9s\", do = \"hardware-disable=on\" }]");
        let (other, interrupted, hurried) = ((*network).clone(), flag(), flag());
        let (first, second) = (Arc::clone(&interrupted), Arc::clone(&hurried));
        network.interrupt_with(move || first.load(Relaxed));
        network.hurry_with(move || second.load(Relaxed));
        let mut request = cyclic(&["ZSW1"], 3);
        request.time = request.time.filter(|_| ends == Ends::Time);
        let mut recording = begin(&network, members, &request).unwrap();
        until(&mut recording, MS * 1000);
        write_by(other, &["DRV.CMDSOURCE=0", "DRV.EN=1", "VL.CMDU=300rpm"]);
        until(&mut recording, MS * 2500);
        match ends {
            Ends::Time => {}
            Ends::Stop => recording.stop(),
            Ends::Interrupted => interrupted.store(true, Relaxed),
        }
        let mut waits = 0;
        while let Some(news) = recording.next().wait().unwrap() {
            if let News::Waits { .. } = news {
                waits += 1;
                let remarks = news.remarks(recording.table());
                let sentence = &remarks[0].sentence;
                assert!(
                    remarks.len() == 1
                        && remarks[0].is_warning
                        && sentence.starts_with("akd-1: the recording"),
                    "{remarks:?}"
                );
                assert!(speed(&network) > 290.0);
                match ends {
                    _ if !insists => {}
                    Ends::Interrupted => hurried.store(true, Relaxed),
                    Ends::Time | Ends::Stop => recording.stop(),
                }
            }
        }
        assert_eq!(waits, 1, "{ends:?} {insists}");
        let ended = recording.elapsed();
        assert_eq!(ended < MS * 6000, insists, "{ends:?}: {ended:?}");
        assert!(recording.counts()[0].rows < 200, "nothing is recorded meanwhile");
    }
}

fn flag() -> Arc<AtomicBool> {
    Arc::default()
}

//! A drive that is watched, in a plant in memory.
#![cfg(feature = "simulate")]

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::time::Duration;

use profidrive::client::{Action, Drive, ErrorKind, WriteMode};
use profidrive::monitor::{Monitor, MonitorError, Observation, SILENCE};
use profidrive::{Network, Wait};

/// Its cable is pulled after two seconds.
const PULLED: &str = r#"
[[drive]]
name = "akd-1"
ip = "10.0.0.1/24"
event = [{ at = "2s", do = "cable=pulled" }]
"#;

fn open(plant: &str) -> (Network, Drive, Monitor) {
    let mut network = profidrive::open_plan(plant.parse().expect("a plant")).expect("opens");
    let drive = network.find(&"akd-1".parse().expect("a name")).wait();
    let monitor = Monitor::new(Duration::from_millis(100)).expect("slow enough");
    (network, drive.expect("there"), monitor)
}

/// Reads until the drive no longer answers or `until` seconds are over; returns how often its silence was reported.
fn watch(
    (network, drive, monitor): &mut (Network, Drive, Monitor),
    until: u64,
) -> (usize, Result<Vec<Observation>, MonitorError>) {
    let reported = Arc::new(AtomicUsize::new(0));
    let end = network.now() + Duration::from_secs(until);
    let mut seen = Vec::new();
    let result = loop {
        let count = reported.clone();
        let silent = move || {
            count.fetch_add(1, Ordering::Relaxed);
        };
        match monitor.read_reporting_silence(network, drive, silent).wait() {
            Ok(Some(observation)) => seen.push(observation),
            Ok(None) => break Ok(seen),
            Err(error) => break Err(error),
        }
        if !monitor.pause(network, end).wait().expect("in memory") {
            break Ok(seen);
        }
    };
    (reported.load(Ordering::Relaxed), result)
}

#[test]
fn a_drive_that_answers_is_read_at_the_interval() {
    let mut watched = open("[[drive]]\nname = \"akd-1\"\nip = \"10.0.0.1/24\"");
    let (silences, seen) = watch(&mut watched, 1);
    // counted from the first answer; each takes its time, which is far less than an interval
    let times: Vec<u128> = seen
        .unwrap()
        .iter()
        .map(|one| (one.time.as_millis() + 50) / 100)
        .collect();
    assert_eq!((silences, times), (0, (0..10).collect()));
}

/// The fault comes during the outage: the reading that shows it is stamped when it arrives, not when it was requested.
#[test]
fn a_reading_after_an_outage_is_stamped_at_its_arrival_and_reports_the_outage() {
    let mut watched = open(
        r#"
[[drive]]
name = "akd-1"
ip = "10.0.0.1/24"
event = [
    { at = "2s", do = "cable=pulled", for = "2s" },
    { at = "3s", do = "fault=439" },
]
"#,
    );
    let begin = watched.0.now();
    let (silences, seen) = watch(&mut watched, 8);
    let seen = seen.unwrap();
    assert_eq!(silences, 1);
    let outages: Vec<_> = seen.iter().filter_map(|one| Some((one, one.outage()?))).collect();
    let [(after, outage)] = outages[..] else {
        panic!("{outages:?}")
    };
    assert!(outage >= Duration::from_millis(1900), "{outage:?}");
    assert!(after.faults.iter().any(|fault| fault.number == 439), "{after:?}");
    // virtual time begins with the plant; the first reading came soon after `begin`
    let arrived = begin + after.time;
    assert!(arrived.as_millis() >= 3950, "{arrived:?}");
    assert_eq!(after.wall, None, "virtual time has no time of day");
}

#[test]
fn a_silent_drive_is_reported_once_and_then_lost() {
    let mut watched = open(PULLED);
    let (silences, seen) = watch(&mut watched, 600);
    let error = seen.unwrap_err();
    assert_eq!(silences, 1);
    assert!(
        matches!(error, MonitorError::Client(_)) && error.kind() == ErrorKind::Unreachable,
        "{error}"
    );
    let advice = error.advice();
    assert!(advice.actions().any(|action| *action == Action::Scan), "{advice}");
    // no drive is left to release a connection to
    let begin = watched.0.now();
    watched.0.close().wait().unwrap();
    assert_eq!(watched.0.now(), begin);
}

#[test]
fn a_stop_is_an_error_only_while_the_drive_is_silent() {
    let mut watched = open(PULLED);
    let stop = Arc::new(AtomicBool::new(false));
    let flag = stop.clone();
    watched.0.interrupt_with(move || flag.load(Ordering::Relaxed));
    let (network, drive, monitor) = &mut watched;
    network.pass(Duration::from_secs(3)).wait().unwrap();
    let request = stop.clone();
    // the person at the keyboard gives up when the silence is reported
    let silent = move || request.store(true, Ordering::Relaxed);
    let error = monitor
        .read_reporting_silence(network, drive, silent)
        .wait()
        .unwrap_err();
    assert!(
        matches!(&error, MonitorError::Silent { drive, waited } if drive == "akd-1" && *waited >= SILENCE),
        "{error}"
    );
    assert_eq!(error.kind(), ErrorKind::Unreachable);
    assert!(
        error.to_string().starts_with("akd-1 has not answered for 1."),
        "{error}"
    );

    // it is requested from the beginning: no reading, and no pause
    let ended = monitor.read_reporting_silence(network, drive, || ()).wait();
    assert_eq!(ended.unwrap(), None);
    let end = network.now() + Duration::from_secs(60);
    assert!(!monitor.pause(network, end).wait().unwrap());
    assert!(network.now() < end);
}

/// It answers again at once and does not know the connection of before.
#[test]
fn a_drive_that_restarts_is_watched_on() {
    let mut watched = open("[[drive]]\nname = \"akd-1\"\nip = \"10.0.0.1/24\"\nmodel = \"vlt\"");
    watch(&mut watched, 1).1.unwrap();
    let mut other = (*watched.0).clone();
    let mut drive = watched.1.clone();
    let restart = "9-72=1".parse().unwrap();
    let written = other.write(&mut drive, &[restart], WriteMode::Write).wait();
    assert!(written.unwrap().is_done());
    let seen = watch(&mut watched, 3).1.unwrap();
    let restarts = seen.iter().filter(|one| one.restarted).count();
    assert!(restarts == 1 && seen.len() > 20, "{restarts} in {}", seen.len());
}

//! Names, addresses and resets, in a plant in memory.
#![cfg(feature = "simulate")]

use std::net::Ipv4Addr;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use profidrive::addressing::{
    AddressingError, FactoryReset, NewAddress, NewName, blink, check_reset, reset, set_ip, set_name,
};
use profidrive::client::{AtWork, Drive, Error, ErrorKind};
use profidrive::{Network, Wait};
use profinet::IpSuite;

const PLANT: &str = r#"
[[drive]]
name = "akd-1"
ip = "10.0.0.1/24"
[[drive]]
name = "akd-2"
ip = "10.0.0.2/24"
[[controller]]
drive = "akd-2"
telegram = 1
"#;

fn open() -> Network {
    profidrive::open_plan(PLANT.parse().expect("a plant")).expect("opens")
}

fn find(network: &mut Network, name: &str) -> Drive {
    network
        .find(&name.parse().expect("a name"))
        .wait()
        .expect("there")
}

fn ip(last: u8) -> NewAddress {
    NewAddress::new(IpSuite {
        address: Ipv4Addr::new(10, 0, 0, last),
        mask: Ipv4Addr::new(255, 255, 255, 0),
        gateway: Ipv4Addr::UNSPECIFIED,
    })
}

#[test]
fn a_name_or_an_address_that_is_taken_is_refused() {
    let mut network = open();
    let drive = find(&mut network, "akd-1");
    let error = set_name(&mut network, &drive, &NewName::new("akd-2"))
        .wait()
        .unwrap_err();
    assert!(
        matches!(&error, AddressingError::NameTaken { other, .. } if other.contains("akd-2")),
        "{error}"
    );
    let error = set_ip(&mut network, &drive, &ip(2)).wait().unwrap_err();
    assert!(matches!(&error, AddressingError::AddressTaken { .. }), "{error}");
    let error = set_name(&mut network, &drive, &NewName::new("Press_1"))
        .wait()
        .unwrap_err();
    assert!(
        matches!(&error, AddressingError::BadName { legal: Some(legal), .. } if legal == "press-1"),
        "{error}"
    );
    // its own are no other station's
    set_name(&mut network, &drive, &NewName::new("akd-1"))
        .wait()
        .unwrap();
    set_ip(&mut network, &drive, &ip(1)).wait().unwrap();
}

#[test]
fn a_dry_run_checks_all_and_changes_nothing() {
    let mut network = open();
    let drive = find(&mut network, "akd-1");
    let wanted = NewName {
        dry_run: true,
        ..NewName::new("press-1")
    };
    let report = set_name(&mut network, &drive, &wanted).wait().unwrap();
    assert!(report.dry_run);
    find(&mut network, "akd-1");
    let wanted = NewAddress {
        dry_run: true,
        ..ip(9)
    };
    set_ip(&mut network, &drive, &wanted).wait().unwrap();
    let broken = NewAddress {
        ip: IpSuite {
            mask: Ipv4Addr::new(255, 0, 255, 0),
            ..wanted.ip
        },
        ..wanted
    };
    let error = set_ip(&mut network, &drive, &broken).wait().unwrap_err();
    assert!(error.to_string().contains("255.0.255.0"), "{error}");
    assert_eq!(
        find(&mut network, "akd-1").station.ip.address,
        Ipv4Addr::new(10, 0, 0, 1)
    );
    set_ip(&mut network, &drive, &ip(9)).wait().unwrap();
    assert_eq!(
        find(&mut network, "akd-1").station.ip.address,
        Ipv4Addr::new(10, 0, 0, 9)
    );
}

/// Its axis would lose the controller.
#[test]
fn a_drive_with_a_controller_keeps_name_address_and_settings() {
    let mut network = open();
    network.pass(Duration::from_secs(2)).wait().unwrap();
    let mut drive = find(&mut network, "akd-2");
    let at_work = |error: AddressingError| match error {
        AddressingError::Client(Error::AtWork { works, .. }) => matches!(works, AtWork::Controller(_)),
        _ => false,
    };
    assert!(at_work(
        set_name(&mut network, &drive, &NewName::new("press-1"))
            .wait()
            .unwrap_err()
    ));
    assert!(at_work(set_ip(&mut network, &drive, &ip(9)).wait().unwrap_err()));
    assert!(at_work(check_reset(&mut network, &mut drive).wait().unwrap_err()));
    let what = FactoryReset::Communication;
    assert!(at_work(
        reset(&mut network, &mut drive, what, false).wait().unwrap_err()
    ));
    find(&mut network, "akd-2");
}

#[test]
fn a_reset_takes_the_name_back() {
    let mut network = open();
    let mut drive = find(&mut network, "akd-1");
    check_reset(&mut network, &mut drive).wait().unwrap();
    let report = reset(&mut network, &mut drive, FactoryReset::Communication, false)
        .wait()
        .unwrap();
    assert_eq!(
        (report.mode, report.what),
        (2, "communication data (name, IP address)")
    );
    network.pass(Duration::from_secs(5)).wait().unwrap();
    assert!(network.find(&"akd-1".parse().unwrap()).wait().is_err());
}

#[test]
fn a_station_blinks_for_the_requested_time_and_is_confirmed_once() {
    let mut network = open();
    let drive = find(&mut network, "akd-1");
    for (time, most) in [(0, 1), (1, 2), (7, 8)] {
        let (begin, mut confirmed) = (network.now(), 0);
        let report = blink(&mut network, &drive, Duration::from_secs(time), || confirmed += 1)
            .wait()
            .unwrap();
        assert_eq!((report.mac, confirmed), (drive.station.mac.to_string(), 1));
        let took = network.now() - begin;
        assert!(
            took >= Duration::from_secs(time) && took < Duration::from_secs(most),
            "{took:?}"
        );
    }
}

#[test]
fn blinking_ends_early_without_an_error_when_the_caller_requests_it() {
    let mut network = open();
    let drive = find(&mut network, "akd-1");
    let answered = Arc::new(AtomicBool::new(false));
    let flag = answered.clone();
    network.interrupt_with(move || flag.load(Ordering::Relaxed));
    let begin = network.now();
    let confirmed = || answered.store(true, Ordering::Relaxed);
    blink(&mut network, &drive, Duration::from_secs(60), confirmed)
        .wait()
        .unwrap();
    assert!(network.now() - begin < Duration::from_secs(1));
}

#[test]
fn a_station_that_does_not_answer_is_not_confirmed_to_blink() {
    let plant = "[[drive]]\nname = \"akd-1\"\nevent = [{ at = \"1s\", do = \"cable=pulled\" }]";
    let mut network = profidrive::open_plan(plant.parse().unwrap()).unwrap();
    let drive = find(&mut network, "akd-1");
    network.pass(Duration::from_secs(2)).wait().unwrap();
    let silent = blink(&mut network, &drive, Duration::from_secs(3), || {
        panic!("no station has answered")
    })
    .wait();
    assert_eq!(silent.unwrap_err().kind(), ErrorKind::Unreachable);
}

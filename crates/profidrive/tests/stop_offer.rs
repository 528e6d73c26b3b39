//! By what a drive that this program does not control can be stopped, as its status has it.
#![cfg(feature = "simulate")]
#![allow(clippy::unwrap_used, clippy::panic, reason = "it is a test")]

use std::time::Duration;

use profidrive::client::StopWay;
use profidrive::inspection::status;
use profidrive::motion::{self, Control, Hold, NoStop, Observer, StopMeans, StopOffer};
use profidrive::report::PlainWording;
use profidrive::{Network, Transport, Wait, open_plan, parameters};

const SECOND: Duration = Duration::from_secs(1);

const PLANT: &str = r#"
    [[drive]]
    name = "akd-1"
    ip = "10.0.0.1/24"
    [[drive]]
    name = "vlt-1"
    model = "vlt"
    ip = "10.0.0.2/24"
    parameters = { "8-04" = 0 }
    [[drive]]
    name = "press-1"
    ip = "10.0.0.3/24"
    [[controller]]
    drive = "press-1"
    telegram = 1
    step = [
        { at = "0.3s", send = { STW1 = "0x047E" } },
        { at = "0.5s", send = { STW1 = "0x047F", NSOLL_A = "60rpm" } },
    ]
"#;

fn open() -> Network {
    open_plan(PLANT.parse().unwrap()).unwrap()
}

fn offer(network: &mut Network, name: &str) -> StopOffer {
    let mut drive = network.find(&name.parse().unwrap()).wait().unwrap();
    let seen = status(network, &mut drive, &PlainWording).wait().unwrap();
    StopOffer::of(network, &drive, &seen.report)
}

fn happens(network: &mut Network, name: &str, event: &str, lasts: Option<Duration>) {
    let event = event.parse().unwrap();
    let Transport::Plant(plant) = network.transport() else {
        panic!("it is a plant");
    };
    plant
        .with_world(|world| world.inject(name, event, lasts))
        .unwrap();
}

fn write(network: &mut Network, name: &str, texts: &[&str]) {
    let mut drive = network.find(&name.parse().unwrap()).wait().unwrap();
    let assignments: Vec<_> = texts.iter().map(|text| text.parse().unwrap()).collect();
    let written = parameters::write(network, &mut drive, &assignments, parameters::Write::default())
        .wait()
        .unwrap();
    assert!(written.problems(name).is_empty());
}

#[test]
fn a_drive_that_stands_or_that_a_controller_has_is_not_stopped_from_here() {
    let mut network = open();
    network.pass(2 * SECOND).wait().unwrap();
    let at_rest = offer(&mut network, "akd-1");
    assert_eq!(
        (at_rest.means, at_rest.reason),
        (StopMeans::None, Some(NoStop::AtRest))
    );
    let owned = offer(&mut network, "press-1");
    assert_eq!(
        (owned.means, owned.reason),
        (StopMeans::None, Some(NoStop::Controller))
    );
    assert_eq!(owned.controller.as_deref(), Some("plc-1"));
}

#[test]
fn a_drive_that_its_service_channel_turns_is_stopped_by_its_parameter() {
    let mut network = open();
    write(&mut network, "akd-1", &["DRV.CMDSOURCE=0", "DRV.EN=1"]);
    network.pass(SECOND).wait().unwrap();
    // it is in local operation too, and its parameter stops it all the same
    let offered = offer(&mut network, "akd-1");
    assert_eq!(
        (offered.means, offered.parameter),
        (StopMeans::Parameter, Some("DRV.STOP"))
    );
    let mut drive = network.find(&"akd-1".parse().unwrap()).wait().unwrap();
    let stopped = motion::stop(&mut network, &mut drive, StopWay::Stop, 5 * SECOND)
        .wait()
        .unwrap();
    assert_eq!(stopped.sent, offered.parameter);
}

#[test]
fn a_drive_that_its_panel_turns_is_stopped_there() {
    let mut network = open();
    happens(&mut network, "vlt-1", "local-speed=600rpm", None);
    network.pass(6 * SECOND).wait().unwrap();
    let local = offer(&mut network, "vlt-1");
    assert_eq!(
        (local.means, local.reason),
        (StopMeans::None, Some(NoStop::LocalOperation))
    );
    // what else is wrong with it does not hide that
    happens(&mut network, "vlt-1", "warning=13", None);
    network.pass(SECOND).wait().unwrap();
    assert_eq!(offer(&mut network, "vlt-1"), local);
}

#[test]
fn a_drive_that_turns_on_without_its_controller_is_stopped_by_its_control_word() {
    let mut network = open();
    let mut drive = network.find(&"vlt-1".parse().unwrap()).wait().unwrap();
    let wanted = Hold {
        control: Control {
            may_run_on: true,
            ..Control::default()
        },
        ..Hold::for_speed()
    };
    let observer = Observer::default();
    let mut axis = motion::hold(&mut network, &mut drive, &wanted, &observer)
        .wait()
        .unwrap();
    axis.enable().wait().unwrap();
    axis.turn(300.0, None).wait().unwrap();
    assert_eq!(offer(&mut network, "vlt-1").means, StopMeans::Frame);
    happens(&mut network, "vlt-1", "cable=pulled", Some(SECOND));
    network.pass(3 * SECOND).wait().unwrap();
    // its connection is gone
    axis.release().wait().unwrap_err();
    let offered = offer(&mut network, "vlt-1");
    assert_eq!((offered.means, offered.reason), (StopMeans::ControlWord, None));
    let stopped = motion::stop_unowned(&mut network, &mut drive, 10 * SECOND)
        .wait()
        .unwrap();
    assert!(stopped.at_rest, "{stopped}");
    assert_eq!(stopped.sent, Some("OFF1 (control word)"));
}

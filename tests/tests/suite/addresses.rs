//! Where a virtual AKD has its address from (AKD PROFINET manual 3.4): rotary switches, AutoIP, DCP, button B1 and
//! IP.RESET, on an in-memory segment in virtual time.

use std::net::Ipv4Addr;
use std::sync::Arc;
use std::time::Duration;

use client::{DriveAddress, Network, Wait, World, WriteMode};
use network::host::{Host, StationId};
use network::segment::{Pace, Segment, SegmentMedium};
use profinet::controller::ControllerConfig;
use profinet::device::Stored;
use profinet::{Endpoint, IpSuite, MacAddress};
use system_tests::{Lab, Side, built, client};
use virtual_drive::drive::Injection;
use virtual_drive::model::AKD;
use virtual_drive::station::{Station, StationConfig, StationEvent};

fn suite(address: [u8; 4]) -> IpSuite {
    IpSuite {
        address: address.into(),
        mask: [255, 255, 255, 0].into(),
        gateway: Ipv4Addr::UNSPECIFIED,
    }
}

/// What outlives a drive: name, address and saved parameters.
#[derive(Default)]
struct Memory {
    network: Stored,
    parameters: Option<Vec<u8>>,
}

/// A drive with these rotary switches that is switched on, and a client beside it.
struct Plant {
    session: Network,
    world: Arc<World<SegmentMedium>>,
    id: StationId,
}

impl Plant {
    fn switched_on(rotary: u8, memory: &Memory) -> Self {
        let mut config = StationConfig::new(&AKD, MacAddress([2, 0, 0, 0, 0, 1]));
        config.rotary = Some(rotary);
        config.network = memory.network.clone();
        config.parameters = memory.parameters.clone();
        let mut segment = Segment::new(1);
        let id = segment.attach(Box::new(Host::new(Station::new(config))));
        let medium = SegmentMedium::new(segment, Pace::Virtual);
        let client = ControllerConfig::new(
            MacAddress([2, 0, 0, 0, 1, 0]),
            suite([192, 168, 0, 200]),
            "client",
            1,
        );
        let (session, world) = Network::on(medium, client);
        Self { session, world, id }
    }

    fn station<T>(&self, act: impl FnOnce(&mut Station) -> T) -> T {
        let mut wire = self.world.wire();
        let host: &mut Host<Station> = wire.segment_mut().station_mut(self.id).expect("attached");
        act(host.endpoint_mut())
    }

    /// Lets time pass; what is to be kept goes into the memory.
    fn pass(&mut self, time: Duration, memory: &mut Memory) {
        self.session.pass(time).wait().expect("a segment cannot fail");
        while let Some(event) = self.station(Station::poll_event) {
            match event {
                StationEvent::PersistNetwork { network, .. } => memory.network = network,
                StationEvent::PersistParameters { text, .. } => memory.parameters = Some(text.into_bytes()),
                _ => {}
            }
        }
    }

    fn ip(&mut self) -> Ipv4Addr {
        self.station(|station| station.ip().address)
    }
}

const SECOND: Duration = Duration::from_secs(1);

fn read(plant: &mut Plant, drive: &mut client::Drive, name: &str) -> Option<i64> {
    let reference = name.parse().expect("a name");
    let selection = drive.parameters.select(&reference).expect("known");
    plant
        .session
        .read_one(drive, &selection)
        .wait()
        .expect("read")
        .raw()
}

#[test]
fn the_rotary_switches_are_the_last_octet() {
    let mut memory = Memory::default();
    let mut plant = Plant::switched_on(42, &memory);
    plant.pass(SECOND, &mut memory);
    assert_eq!(plant.station(|station| station.ip()), suite([192, 168, 0, 42]));
    let mac = DriveAddress::Mac(MacAddress([2, 0, 0, 0, 0, 1]));
    let mut drive = plant.session.find(&mac).wait().expect("found");
    assert_eq!(read(&mut plant, &mut drive, "DIN.ROTARY"), Some(42));
    assert_eq!(read(&mut plant, &mut drive, "IP.MODE"), Some(0));
    // as delivered and as saved, where nothing was saved
    for command in ["DRV.RSTVAR=1", "DRV.NVLOAD=1"] {
        let assignment = command.parse().expect("an assignment");
        let outcomes = plant
            .session
            .write(&mut drive, &[assignment], WriteMode::Write)
            .wait();
        outcomes.expect("reached").accepted().expect("accepted");
        assert_eq!(read(&mut plant, &mut drive, "IP.MODE"), Some(0), "{command}");
    }
}

/// Without a server a drive with switches at 0 takes a link-local address, the same again after a restart.
#[test]
fn switches_at_0_without_a_server_give_a_link_local_address() {
    let mut memory = Memory::default();
    let mut plant = Plant::switched_on(0, &memory);
    plant.pass(SECOND, &mut memory);
    assert!(plant.ip().is_unspecified() && plant.station(|station| station.acquires_address()));
    plant.pass(20 * SECOND, &mut memory);
    let address = plant.ip();
    assert!(address.is_link_local(), "{address}");
    let mut again = Plant::switched_on(0, &memory);
    again.pass(20 * SECOND, &mut memory);
    assert_eq!(again.ip(), address);
    assert!(!memory.network.ip.is_set(), "found, not set");
}

/// DCP overwrites IP.*; B1 gives the delivered settings back at the next power-on.
#[test]
fn dcp_overrules_the_switches_until_b1_is_held() {
    let mut memory = Memory::default();
    let mut plant = Plant::switched_on(0, &memory);
    plant.pass(SECOND, &mut memory);
    let mac = DriveAddress::Mac(MacAddress([2, 0, 0, 0, 0, 1]));
    let set = suite([192, 168, 0, 77]);
    let drive = plant.session.find(&mac).wait().expect("found");
    plant.session.set_ip(&drive, set, true).wait().expect("set");
    plant.pass(30 * SECOND, &mut memory);
    assert_eq!(
        (
            plant.station(|station| station.ip()),
            plant.station(|station| station.acquires_address())
        ),
        (set, false)
    );

    let mut plant = Plant::switched_on(0, &memory);
    plant.pass(30 * SECOND, &mut memory);
    assert_eq!(plant.station(|station| station.ip()), set, "stored, IP.MODE 1");
    plant.station(|station| station.drive_mut().inject(Injection::ButtonB1(4.9)));
    plant.pass(SECOND, &mut memory);
    assert!(memory.network.ip.is_set(), "too short");
    let press = "b1=5s".parse().expect("an injection");
    plant.station(|station| station.drive_mut().inject(press));
    plant.pass(SECOND, &mut memory);
    assert_eq!(
        plant.station(|station| station.ip()),
        set,
        "until the next power-on"
    );
    let mut plant = Plant::switched_on(0, &memory);
    plant.pass(30 * SECOND, &mut memory);
    assert!(plant.ip().is_link_local(), "{}", plant.ip());

    // with other switches the button does nothing
    let mut memory = Memory::default();
    let mut plant = Plant::switched_on(5, &memory);
    let drive = plant.session.find(&mac).wait().expect("found");
    plant.session.set_ip(&drive, set, true).wait().expect("set");
    plant.pass(SECOND, &mut memory);
    plant.station(|station| station.drive_mut().inject(Injection::ButtonB1(9.0)));
    plant.pass(SECOND, &mut memory);
    assert_eq!(memory.network.ip, set);
}

/// IP.RESET takes the address by IP.MODE without a restart.
#[test]
fn ip_reset_applies_the_mode() {
    let mut memory = Memory::default();
    let mut plant = Plant::switched_on(5, &memory);
    let mac = DriveAddress::Mac(MacAddress([2, 0, 0, 0, 0, 1]));
    let mut drive = plant.session.find(&mac).wait().expect("found");
    plant
        .session
        .set_ip(&drive, suite([192, 168, 0, 77]), true)
        .wait()
        .expect("set");
    drive = plant.session.find(&mac).wait().expect("found");
    for text in ["IP.MODE=0", "IP.RESET=1"] {
        let assignment = text.parse().expect("an assignment");
        let outcomes = plant
            .session
            .write(&mut drive, &[assignment], WriteMode::Write)
            .wait();
        outcomes.expect("reached").accepted().expect(text);
    }
    plant.pass(2 * SECOND, &mut memory);
    assert_eq!(plant.station(|station| station.ip()), suite([192, 168, 0, 5]));
}

/// DRV.REBOOT is a power-on for the rotary switches too, also of a drive that never saved anything.
#[test]
fn a_restarted_drive_takes_its_address_from_the_switches_again() {
    let mut memory = Memory::default();
    let mut plant = Plant::switched_on(7, &memory);
    let mac = DriveAddress::Mac(MacAddress([2, 0, 0, 0, 0, 1]));
    let mut drive = plant.session.find(&mac).wait().expect("found");
    let reboot = "DRV.REBOOT=1".parse().expect("an assignment");
    let outcomes = plant
        .session
        .write(&mut drive, &[reboot], WriteMode::Write)
        .wait();
    outcomes.expect("reached").accepted().expect("accepted");
    plant.pass(2 * SECOND, &mut memory);
    assert_eq!(plant.station(|station| station.ip()), suite([192, 168, 0, 7]));
}

/// On the wire: an IO connection keeps its address, which the drive reports; a tool that reads is disconnected.
#[test]
fn an_address_is_changed_beside_a_tool_and_not_beside_a_controller() {
    let lab = Lab::new("addresses");
    let drive = system_tests::simulate(
        &lab,
        &["--model", "akd", "--name", "akd-1", "--ip", "192.168.77.50/24"],
    );
    let start = |line: &[&str]| {
        let line = [&["-i", Side::Controller.interface()], line].concat();
        lab.spawn(Side::Controller, built("profidrive"), line)
    };
    let mut run = start(&["run", "akd-1", "--velocity", "60rpm"]);
    run.wait_for("S4", 30 * SECOND);
    let refused = client(&lab, &["ip", "akd-1", "192.168.77.60/24", "--force"]);
    assert_eq!(refused.code, Some(3), "{refused:?}");
    for words in ["setting the IP address", "while its controller is connected"] {
        assert!(refused.err.contains(words), "{words}: {refused:?}");
    }
    let said = || format!("{}{}", drive.out(), drive.err());
    let reported =
        system_tests::wait_until(30 * SECOND, || said().contains("while a controller is connected"));
    assert!(reported, "{}", said());
    run.signal("INT");
    assert_eq!(run.finish(30 * SECOND).code, Some(0));

    let mut monitor = start(&["monitor", "akd-1"]);
    monitor.wait_for("ZSW1", 30 * SECOND);
    client(&lab, &["ip", "akd-1", "192.168.77.60/24"]).ok();
    assert_eq!(monitor.finish(30 * SECOND).code, Some(4));
    let scan = client(&lab, &["scan"]).ok();
    assert!(scan.out.contains("192.168.77.60"), "{scan:?}");
    client(&lab, &["read", "akd-1", "930"]).ok();
}

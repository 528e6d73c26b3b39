//! Virtual drives, controllers and clients in memory and in virtual time, and what happens to them.
//!
//! | a test needs | module |
//! |---|---|
//! | a client and drives on a segment | this one |
//! | drives at a serial line that loses and spoils octets | [`mod@line`] |
//! | a controller with raw requests and frames | [`plc`] |
//! | a client that is killed or frozen, a cable that is pulled | [`world`] |
//! | drives, clients and accidents by a seed, compared with what must be true | [`life`] |
//! | a station that sends changed, repeated and foreign frames | [`attack`] |
//! | to look at the drive after each step of a session | [`watched`] |
//!
//! For integration tests: a unit test would have a second copy of the types that it tests.
#![allow(clippy::missing_panics_doc)]

pub mod attack;
pub mod life;
pub mod line;
pub mod plc;
pub mod shared;
pub mod watched;
pub mod world;

use std::net::Ipv4Addr;
use std::ops::{Deref, DerefMut};
use std::path::Path;

use client::axis::Purpose;
use client::{AxisSettings, Client, Drive, DriveAddress, Error, Network, Wait};
use network::host::{Host, StationId};
use network::segment::{Pace, Segment, SegmentMedium};
use profile::notation::ParameterReference;
use profile::value::Selection;
use profinet::controller::{ArId, ControllerConfig, Resolve};
use profinet::device::Stored;
use profinet::{Instant, IpSuite, MacAddress};
use virtual_drive::description::Description;
use virtual_drive::model;
use virtual_drive::station::{Station, StationConfig};

use crate::shared::On;

/// A network in memory, with the segment that it is on.
pub type Bench = On<SegmentMedium>;

/// The settings for a purpose on drives as delivered, some of which run on without their controller.
pub fn running_on(purpose: Purpose) -> AxisSettings {
    AxisSettings {
        may_run_on: true,
        ..AxisSettings::for_purpose(purpose)
    }
}

/// Address `10.0.0.last`.
pub fn ip(last: u8) -> IpSuite {
    IpSuite {
        address: Ipv4Addr::new(10, 0, 0, last),
        mask: Ipv4Addr::new(255, 255, 255, 0),
        gateway: Ipv4Addr::UNSPECIFIED,
    }
}

/// A virtual AKD with a name and the address `10.0.0.last`.
pub fn station(name: &str, last: u8) -> Box<Host<Station>> {
    let mut config = StationConfig::new(&model::AKD, MacAddress([2, 0, 0, 0, 0, last]));
    config.network = Stored {
        name: name.into(),
        ip: ip(last),
        ..Stored::default()
    };
    Box::new(Host::new(Station::new(config)))
}

/// AKDs with these names and addresses on a segment, and a client.
pub fn bench(drives: &[(&str, u8)]) -> (Bench, Vec<StationId>) {
    bench_of(drives.iter().map(|&(name, last)| station(name, last)).collect())
}

/// Returns the description of an AKD from a vendor file.
pub fn description(file: &str) -> Description {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../descriptions");
    let text = std::fs::read(folder.join(file)).expect("the file");
    let gsdml = gsdml::parse(&text).expect("a description");
    let import = Description::from_gsdml(&gsdml, &model::AKD, None).expect("an AKD");
    import.description
}

/// Creates a drive with identity and modules of a vendor file.
pub fn bench_from(file: &str) -> (Bench, Vec<StationId>) {
    let mut config = StationConfig::new(&model::AKD, MacAddress([2, 0, 0, 0, 0, 1]));
    config.description = description(file);
    config.network = Stored {
        name: "akd-1".into(),
        ip: ip(1),
        ..Stored::default()
    };
    bench_of(vec![Box::new(Host::new(Station::new(config)))])
}

/// Stations on a segment, and a client.
pub fn bench_of(stations: Vec<Box<Host<Station>>>) -> (Bench, Vec<StationId>) {
    let (medium, config, ids) = parts_of(stations);
    (On::new(Network::on(medium, config)), ids)
}

/// What a session is made of, for a medium of another kind around the segment.
pub fn parts_of(stations: Vec<Box<Host<Station>>>) -> (SegmentMedium, ControllerConfig, Vec<StationId>) {
    let mut segment = Segment::new(7);
    let ids = stations
        .into_iter()
        .map(|station| segment.attach(station))
        .collect();
    let medium = SegmentMedium::new(segment, Pace::Virtual);
    let config = ControllerConfig::new(MacAddress([2, 0, 0, 0, 1, 0]), ip(200), "client", 1);
    (medium, config, ids)
}

/// Finds a drive as a person calls it.
pub fn find(session: &mut Bench, text: &str) -> Result<Drive, Error> {
    session
        .find(&text.parse::<DriveAddress>().expect("an address"))
        .wait()
}

/// The station of a drive, to look at.
pub fn drive_at(session: &Bench, id: StationId) -> impl Deref<Target = Station> + '_ {
    At {
        medium: session.medium(),
        id,
    }
}

/// One drive of a segment.
struct At<M> {
    medium: M,
    id: StationId,
}

impl<M: Deref<Target = SegmentMedium>> Deref for At<M> {
    type Target = Station;

    fn deref(&self) -> &Station {
        let host = self.medium.segment().station::<Host<Station>>(self.id);
        host.expect("the drive").endpoint()
    }
}

/// The parameter that a person means.
pub fn select(drive: &Drive, text: &str) -> Selection {
    drive
        .parameters
        .select(&text.parse::<ParameterReference>().expect("a parameter"))
        .expect("known")
}

/// True when the power stage is off and no controller exchanges data.
pub fn is_at_rest(session: &Bench, id: StationId) -> bool {
    let station = drive_at(session, id);
    !station.drive().is_enabled() && !station.device().is_exchanging()
}

/// Another controller, as a station on the segment.
pub fn other_controller() -> (Box<Host<Client>>, ArId) {
    let config = ControllerConfig::new(MacAddress([2, 0, 0, 0, 1, 1]), ip(201), "plc", 2);
    let mut client = Client::new(config);
    let target = plc::target(&model::AKD, "akd-1", None, IpSuite::NONE);
    let config = plc::connection(&model::AKD, 1, Resolve::Check);
    let ar = client
        .controller()
        .connect(Instant::ZERO, target, config)
        .expect("a request");
    (Box::new(Host::new(client)), ar)
}

/// What the other controller sends from now on.
pub fn command(session: &Bench, plc: (StationId, ArId), data: &[u8]) {
    let mut medium = session.medium();
    let host = medium.segment_mut().station_mut::<Host<Client>>(plc.0);
    let client = host.expect("the controller").endpoint_mut();
    client
        .controller()
        .set_output(plc.1, 1, 1, data)
        .expect("its telegram");
}

/// The drive, to change it.
pub fn drive_mut(session: &Bench, id: StationId) -> impl DerefMut<Target = virtual_drive::drive::Drive> + '_ {
    Changed {
        medium: session.medium(),
        id,
    }
}

/// One drive of a segment, to change it.
struct Changed<M> {
    medium: M,
    id: StationId,
}

impl<M: Deref<Target = SegmentMedium>> Deref for Changed<M> {
    type Target = virtual_drive::drive::Drive;

    fn deref(&self) -> &Self::Target {
        let host = self.medium.segment().station::<Host<Station>>(self.id);
        host.expect("the drive").endpoint().drive()
    }
}

impl<M: DerefMut<Target = SegmentMedium>> DerefMut for Changed<M> {
    fn deref_mut(&mut self) -> &mut Self::Target {
        let host = self.medium.segment_mut().station_mut::<Host<Station>>(self.id);
        host.expect("the drive").endpoint_mut().drive_mut()
    }
}

/// Does something to the drive itself, as a hand at the machine would.
pub fn with_drive(session: &Bench, id: StationId, act: impl FnOnce(&mut virtual_drive::drive::Drive)) {
    act(&mut drive_mut(session, id));
}

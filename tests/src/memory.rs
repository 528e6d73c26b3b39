//! A virtual AKD and a client on an in-memory segment in virtual time, with every frame kept for the dissector.

use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex};
use std::time::Duration;

use client::{Drive, DriveAddress, Network, Session, Wait, World};
use network::host::Host;
use network::pcap::Writer;
use network::segment::{Pace, Segment, SegmentMedium};
use profile::catalogue::{AKD, Access};
use profile::notation::ParameterReference;
use profile::value::Selection;
use profinet::controller::ControllerConfig;
use profinet::device::Stored;
use profinet::{Instant, IpSuite, MacAddress};
use virtual_drive::model;
use virtual_drive::station::{Station, StationConfig};

/// Frames with the time at which each was sent.
pub type Traffic = Vec<(Instant, Vec<u8>)>;

/// Returns a client beside one virtual AKD called `akd-1`, in virtual time, and the wire between them.
#[must_use]
pub fn network() -> (Network, Arc<World<SegmentMedium>>) {
    let ip = |last| IpSuite {
        address: [10, 0, 0, last].into(),
        mask: [255, 255, 255, 0].into(),
        gateway: [0; 4].into(),
    };
    let mut drive = StationConfig::new(&model::AKD, MacAddress([2, 0x50, 0x4E, 0, 0, 1]));
    drive.network = Stored {
        name: "akd-1".into(),
        ip: ip(1),
        ..Stored::default()
    };
    let mut segment = Segment::new(1);
    segment.attach(Box::new(Host::new(Station::new(drive))));
    let config = ControllerConfig::new(MacAddress([2, 0x50, 0x4E, 0, 0, 2]), ip(2), "plc", 1);
    Network::on(SegmentMedium::new(segment, Pace::Virtual), config)
}

/// Returns the drive of [`network()`].
#[must_use]
#[track_caller]
pub fn find(session: &mut Session) -> Drive {
    let address: DriveAddress = "akd-1".parse().unwrap();
    session
        .find(&address)
        .wait()
        .unwrap_or_else(|e| panic!("akd-1: {e}"))
}

/// Every parameter of the AKD that has a value to read.
#[must_use]
#[track_caller]
pub fn everything(drive: &Drive) -> Vec<Selection> {
    AKD.parameters
        .iter()
        .filter(|parameter| parameter.access != Access::WriteOnly)
        .map(|parameter| {
            let reference = ParameterReference::number(parameter.pnu);
            drive.parameters.select(&reference).unwrap()
        })
        .collect()
}

/// Keeps all frames of a segment from now on.
pub fn listen(segment: &mut Segment) -> Arc<Mutex<Traffic>> {
    let traffic = Arc::new(Mutex::new(Traffic::new()));
    segment.add_tap(Box::new(Arc::clone(&traffic)));
    traffic
}

/// Writes frames as a capture file below `target/system`.
#[must_use]
#[track_caller]
pub fn save(name: &str, traffic: &[(Instant, Vec<u8>)]) -> PathBuf {
    let file = scratch(name);
    let out = std::fs::File::create(&file).unwrap_or_else(|e| panic!("{}: {e}", file.display()));
    let mut writer = Writer::new(out, "segment", Duration::from_secs(1)).unwrap();
    for (at, frame) in traffic {
        writer.write(*at, frame).unwrap();
    }
    writer.flush().unwrap();
    file
}

/// Returns a file of this name below `target/system`.
#[must_use]
#[track_caller]
pub fn scratch(name: &str) -> PathBuf {
    let folder: &Path = &crate::root().join("target/system");
    std::fs::create_dir_all(folder).unwrap_or_else(|e| panic!("{}: {e}", folder.display()));
    folder.join(name)
}

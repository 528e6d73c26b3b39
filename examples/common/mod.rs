//! A virtual AKD and a client on an in-memory segment: the stage of the examples.

use std::net::Ipv4Addr;
use std::sync::Arc;

use client::{Network, World};
use network::host::Host;
use network::segment::{Pace, Segment, SegmentMedium};
use profinet::controller::ControllerConfig;
use profinet::device::Stored;
use profinet::{IpSuite, MacAddress};
use virtual_drive::model;
use virtual_drive::station::{Station, StationConfig};

/// Returns a client in virtual time beside one virtual AKD called `akd-1`, and the wire between them. On a real network
/// it is `profidrive::open("eth0")?`, and everything else stays as it is.
pub fn network() -> (Network, Arc<World<SegmentMedium>>) {
    let ip = |last| IpSuite {
        address: Ipv4Addr::new(192, 168, 0, last),
        mask: Ipv4Addr::new(255, 255, 255, 0),
        gateway: Ipv4Addr::UNSPECIFIED,
    };
    let mut drive = StationConfig::new(&model::AKD, MacAddress([0x02, 0x50, 0x4E, 0, 0, 1]));
    drive.network = Stored {
        name: "akd-1".into(),
        ip: ip(10),
        ..Stored::default()
    };
    let mut segment = Segment::new(1);
    segment.attach(Box::new(Host::new(Station::new(drive))));
    let own_mac = MacAddress([0x02, 0x50, 0x4E, 0, 0, 0xC0]);
    let config = ControllerConfig::new(own_mac, ip(1), "example", 1);
    Network::on(SegmentMedium::new(segment, Pace::Virtual), config)
}

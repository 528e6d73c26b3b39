//! Devices that refuse ways to their records, as many real ones do: on one interface, each made of our device engine with
//! other refusals.
//!
//! `stubborn-devices INTERFACE` puts four stations on it until it is killed or its standard input closes:
//!
//! | name | address | what it is | what it refuses |
//! |---|---|---|---|
//! | vlt-1 | 192.168.77.51 | VLT | ARType 6 |
//! | akd-1 | 192.168.77.52 | AKD | a connect without AlarmCR, writes before data exchange |
//! | vacon-1 | 192.168.77.53 | Vacon | every connect and implicit reads |
//! | rio-1 | 192.168.77.54 | remote I/O | ARType 6, and answers no DCP Set |
#![forbid(unsafe_code)]

#[path = "../../../crates/client/tests/suite/remote_io/mod.rs"]
mod remote_io;

use std::io::Read;
use std::net::SocketAddrV4;
use std::process::ExitCode;
use std::time::Duration;

use network::ethernet::Runner;
use network::host::Host;
use network::system::now;
use profinet::device::{Device, Refusals, Stored};
use profinet::wire::PnioStatus;
use profinet::wire::dcp::{Pdu, ServiceId};
use profinet::wire::ethernet::{Frame, FrameId};
use profinet::{Endpoint, Instant, IpSuite, MacAddress, Traffic, Transmit};
use remote_io::remote_io;
use virtual_drive::model::{self, Model};
use virtual_drive::station::{Station, StationConfig};

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [interface] = arguments.as_slice() else {
        eprintln!("usage: stubborn-devices INTERFACE");
        return ExitCode::from(2);
    };
    match serve(interface) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("stubborn-devices: {error}");
            ExitCode::FAILURE
        }
    }
}

fn serve(interface: &str) -> Result<(), Box<dyn std::error::Error>> {
    let mut runner = Runner::open(interface)?;
    let no_alarm_cr = PnioStatus::connect(0x40, 3);
    let resource = PnioStatus::connect(0x3D, 1);
    for (model, name, last, refusals) in [
        (
            &model::VLT,
            "vlt-1",
            51,
            Refusals {
                device_access: Some(PnioStatus::connect(1, 4)),
                ..Refusals::default()
            },
        ),
        (
            &model::AKD,
            "akd-1",
            52,
            Refusals {
                device_access: Some(no_alarm_cr),
                start_up_write: Some(PnioStatus::write(0xB5)),
                ..Refusals::default()
            },
        ),
        (
            &model::VACON,
            "vacon-1",
            53,
            Refusals {
                device_access: Some(no_alarm_cr),
                implicit_read: Some(PnioStatus::new(0xDE, 0x81, 0x40, 5)),
                controller: Some(resource),
                start_up_write: None,
            },
        ),
    ] {
        runner.attach(Box::new(Host::new(drive(model, name, last, refusals))))?;
    }
    runner.attach(Box::new(Host::new(Mute(remote_io(
        mac(54),
        stored("rio-1", 54),
        0,
    )))))?;
    println!("ready");
    std::thread::spawn(|| {
        let mut rest = Vec::new();
        let _ = std::io::stdin().read_to_end(&mut rest);
        std::process::exit(0);
    });
    loop {
        runner.step(now() + Duration::from_secs(1))?;
    }
}

const fn mac(last: u8) -> MacAddress {
    MacAddress([2, 0x50, 0x4E, 0, 1, last])
}

fn stored(name: &str, last: u8) -> Stored {
    Stored {
        name: name.into(),
        ip: IpSuite {
            address: [192, 168, 77, last].into(),
            mask: [255, 255, 255, 0].into(),
            gateway: [0; 4].into(),
        },
        ..Stored::default()
    }
}

fn drive(model: &'static Model, name: &str, last: u8, refusals: Refusals) -> Station {
    let mut config = StationConfig::new(model, mac(last));
    config.refusals = refusals;
    config.network = stored(name, last);
    Station::new(config)
}

/// A device that answers no DCP Set: it neither takes a name nor blinks.
struct Mute(Device);

fn is_set(frame: &[u8]) -> bool {
    Frame::parse(frame).is_some_and(|frame| {
        frame.frame_id == FrameId::DCP_GET_SET
            && Pdu::parse(frame.payload).is_ok_and(|pdu| pdu.service == ServiceId::Set)
    })
}

impl Endpoint for Mute {
    fn mac(&self) -> MacAddress {
        self.0.mac()
    }

    fn ip(&self) -> IpSuite {
        self.0.ip()
    }

    fn handle_frame(&mut self, now: Instant, frame: &[u8]) {
        if !is_set(frame) {
            self.0.handle_frame(now, frame);
        }
    }

    fn handle_datagram(&mut self, now: Instant, source: SocketAddrV4, local_port: u16, payload: &[u8]) {
        self.0.handle_datagram(now, source, local_port, payload);
    }

    fn serves(&self, port: u16) -> bool {
        self.0.serves(port)
    }

    fn note_traffic(&mut self, traffic: Traffic, frame: &[u8]) {
        self.0.note_traffic(traffic, frame);
    }

    fn handle_timeout(&mut self, now: Instant) {
        self.0.handle_timeout(now);
    }

    fn poll_transmit(&mut self, now: Instant, buffer: &mut [u8]) -> Option<Transmit> {
        self.0.poll_transmit(now, buffer)
    }

    fn poll_timeout(&self) -> Option<Instant> {
        self.0.poll_timeout()
    }
}

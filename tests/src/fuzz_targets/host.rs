//! The Ethernet station around an engine.

use std::net::SocketAddrV4;

use network::host::{Host, Station};
use profinet::{Endpoint, Instant, IpSuite, MAX_FRAME, MacAddress, Transmit};

use super::steps::{Step, Steps};

/// ARP, IPv4, ICMP and UDP around an engine that echoes datagrams.
pub fn host(data: &[u8]) {
    let mut host = Host::new(Echo::default());
    let mut buffer = [0; MAX_FRAME];
    let mut now = Instant::ZERO;
    // a seed is one frame; anything else may also be several steps
    host.handle_frame(now, data);
    for step in Steps(data) {
        match step {
            Step::Frame(frame) | Step::Datagram(frame) => host.handle_frame(now, frame),
            Step::Wait(time) => now += time,
        }
        host.handle_timeout(now);
        for round in 0.. {
            let Some(length) = host.poll_transmit(now, &mut buffer) else {
                break;
            };
            assert!((60..=MAX_FRAME).contains(&length));
            assert!(round < 1000, "it never stops sending");
        }
    }
}

#[derive(Default)]
struct Echo {
    pending: Option<(SocketAddrV4, u16, usize)>,
}

impl Endpoint for Echo {
    fn mac(&self) -> MacAddress {
        MacAddress([2, 0x50, 0x4E, 0, 0, 1])
    }

    fn ip(&self) -> IpSuite {
        IpSuite {
            address: [192, 168, 77, 50].into(),
            mask: [255, 255, 255, 0].into(),
            gateway: [0; 4].into(),
        }
    }

    fn handle_frame(&mut self, _: Instant, _: &[u8]) {}

    fn handle_datagram(&mut self, _: Instant, source: SocketAddrV4, port: u16, payload: &[u8]) {
        self.pending = Some((source, port, payload.len().min(1400)));
    }

    fn handle_timeout(&mut self, _: Instant) {}

    fn poll_transmit(&mut self, _: Instant, buffer: &mut [u8]) -> Option<Transmit> {
        let (destination, source_port, length) = self.pending.take()?;
        buffer[..length].fill(0xA5);
        Some(Transmit::Datagram {
            destination,
            source_port,
            length,
        })
    }

    fn poll_timeout(&self) -> Option<Instant> {
        None
    }
}

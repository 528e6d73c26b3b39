//! The Ethernet station around an engine.

use std::net::SocketAddrV4;

use network::host::{Audience, Host, Station};
use profinet::{Endpoint, Instant, IpSuite, MAX_FRAME, MacAddress, Transmit};

use super::steps::{Step, Steps};

/// ARP, IPv4, ICMP, UDP and TCP around an engine that echoes datagrams: with an address, and looking for one by DHCP and
/// AutoIP.
pub fn host(data: &[u8]) {
    let ip = IpSuite {
        address: [192, 168, 77, 50].into(),
        mask: [255, 255, 255, 0].into(),
        gateway: [0; 4].into(),
    };
    for (ip, acquires) in [(ip, false), (IpSuite::NONE, true)] {
        feed(
            data,
            Echo {
                ip,
                acquires,
                pending: None,
            },
        );
    }
}

fn feed(data: &[u8], endpoint: Echo) {
    let mut host = Host::new(endpoint);
    let mut buffer = [0; MAX_FRAME];
    let mut now = Instant::ZERO;
    // what it sends first: its announcement
    while host.poll_transmit(now, &mut buffer).is_some() {}
    // a seed is one frame; anything else may also be several steps
    for step in std::iter::once(Step::Frame(data)).chain(Steps(data)) {
        match step {
            Step::Frame(frame) | Step::Datagram(frame) => {
                let (audience, interest) = (Audience::of(frame), host.interest());
                host.handle_frame(now, frame);
                // an ARP request for others may still show the address of its sender, which something waits for
                if !interest.covers(audience) && matches!(audience, Audience::Name(_)) {
                    assert_eq!(host.poll_transmit(now, &mut buffer), None, "it is for others");
                }
            }
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

struct Echo {
    ip: IpSuite,
    acquires: bool,
    pending: Option<(SocketAddrV4, u16, usize)>,
}

impl Endpoint for Echo {
    fn mac(&self) -> MacAddress {
        MacAddress([2, 0x50, 0x4E, 0, 0, 1])
    }

    fn ip(&self) -> IpSuite {
        self.ip
    }

    fn acquires_address(&self) -> bool {
        self.acquires
    }

    fn take_address(&mut self, _: Instant, suite: IpSuite) {
        self.ip = suite;
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

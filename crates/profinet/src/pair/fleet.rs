//! One controller and many devices on a wire without latency.

use alloc::format;
use alloc::vec;
use alloc::vec::Vec;
use core::net::SocketAddrV4;
use core::time::Duration;

use super::station::{PLC, Station, config, ip, target};
use crate::controller::{ConnectConfig, Controller, ControllerConfig, Event, Phase, Resolve};
use crate::{Endpoint, Instant, IpSuite, MAX_FRAME, MacAddress, Transmit};

/// More than start up at once.
const COUNT: u8 = 100;

fn mac(number: u8) -> MacAddress {
    MacAddress([2, 0x50, 0x4e, 0, 1, number])
}

struct Fleet {
    controller: Controller,
    stations: Vec<Station>,
    now: Instant,
}

impl Fleet {
    /// Carries all frames until no station has any to send.
    fn exchange(&mut self) {
        let mut buffer = [0; MAX_FRAME];
        for round in 0.. {
            assert!(round < 1000, "never quiet");
            let mut quiet = true;
            while let Some(transmit) = self.controller.poll_transmit(self.now, &mut buffer) {
                quiet = false;
                for station in &mut self.stations {
                    give(station, self.now, ip(11), transmit, &buffer);
                }
            }
            for station in &mut self.stations {
                while let Some(transmit) = station.poll_transmit(self.now, &mut buffer) {
                    quiet = false;
                    give(&mut self.controller, self.now, station.ip(), transmit, &buffer);
                }
            }
            if quiet {
                return;
            }
        }
    }

    fn run(&mut self, duration: Duration) -> Vec<Event> {
        let end = self.now + duration;
        let mut events = vec![];
        loop {
            self.exchange();
            events.extend(core::iter::from_fn(|| self.controller.poll_event()));
            let stations = self.stations.iter().filter_map(Endpoint::poll_timeout).min();
            let next = Instant::earliest([self.controller.poll_timeout(), stations]);
            match next.filter(|next| *next <= end) {
                Some(next) => self.now = next,
                None => {
                    self.now = end;
                    return events;
                }
            }
            self.controller.handle_timeout(self.now);
            for station in &mut self.stations {
                if station.poll_timeout().is_some_and(|due| due <= self.now) {
                    station.handle_timeout(self.now);
                }
            }
        }
    }
}

fn give(to: &mut dyn Endpoint, now: Instant, from: IpSuite, transmit: Transmit, buffer: &[u8]) {
    match transmit {
        Transmit::Frame { length } => {
            if buffer[..6] == to.mac().0 || buffer[0] & 1 == 1 {
                to.handle_frame(now, &buffer[..length]);
            }
        }
        Transmit::Datagram {
            destination,
            source_port,
            length,
        } => {
            if *destination.ip() == to.ip().address {
                let source = SocketAddrV4::new(from.address, source_port);
                to.handle_datagram(now, source, destination.port(), &buffer[..length]);
            }
        }
    }
}

#[test]
fn more_drives_than_start_up_at_once_half_of_them_unaddressed() {
    let stations = (0..COUNT).map(|n| {
        let suite = if n % 2 == 0 { ip(100 + n) } else { IpSuite::NONE };
        Station::with_mac(mac(n), &format!("drive-{n}"), suite)
    });
    let controller = Controller::new(ControllerConfig::new(PLC, ip(11), "plc", 3));
    let mut fleet = Fleet {
        controller,
        stations: stations.collect(),
        now: Instant::ZERO,
    };
    let mut ars = vec![];
    for n in 0..COUNT {
        let mut to = target();
        to.name = format!("drive-{n}");
        to.ip = ip(100 + n);
        let config = ConnectConfig {
            resolve: Resolve::SetIp,
            ..config(16)
        };
        ars.push(fleet.controller.connect(fleet.now, to, config).unwrap());
    }
    let events = fleet.run(Duration::from_secs(5));
    let running = events
        .iter()
        .filter(|e| matches!(e, Event::Running { .. }))
        .count();
    assert_eq!(
        running,
        usize::from(COUNT),
        "{:?}",
        events.iter().find(|e| matches!(e, Event::Lost { .. }))
    );
    for (n, ar) in (0..).zip(&ars) {
        fleet.controller.set_output(*ar, 1, 1, &[1, n, 2, n]).unwrap();
    }
    let events = fleet.run(Duration::from_secs(30));
    assert_eq!(events, []);
    for (n, ar) in (0..).zip(&ars) {
        assert_eq!(fleet.controller.phase(*ar), Some(Phase::Data));
        assert_eq!(fleet.controller.input(*ar, 1, 1).unwrap().0, [1, n, 2, n]);
        let statistics = fleet.controller.statistics(*ar).unwrap();
        assert!(
            statistics.missed == 0 && statistics.received > 1900,
            "{statistics:?}"
        );
    }
    for ar in &ars {
        fleet.controller.release(fleet.now, *ar).unwrap();
    }
    let events = fleet.run(Duration::from_secs(1));
    assert_eq!(events.len(), usize::from(COUNT));
}

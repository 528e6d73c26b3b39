//! Cyclic frames cost no allocation: not in a host, not on the segment.
#![allow(clippy::unwrap_used, clippy::panic)]

use std::net::SocketAddrV4;
use std::time::Duration;

use profidrive_network::host::{Host, Station};
use profidrive_network::segment::{Conditions, Segment};
use profinet::{Endpoint, Instant, IpSuite, MAX_FRAME, MacAddress, Transmit};

/// Sends a frame to its peer per cycle, hears the peer's.
struct Cyclic {
    mac: MacAddress,
    peer: MacAddress,
    next: Instant,
    due: bool,
    received: u64,
}

const CYCLE: Duration = Duration::from_millis(16);

impl Endpoint for Cyclic {
    fn mac(&self) -> MacAddress {
        self.mac
    }
    fn ip(&self) -> IpSuite {
        IpSuite::NONE
    }
    fn handle_frame(&mut self, _: Instant, _: &[u8]) {
        self.received += 1;
    }
    fn handle_datagram(&mut self, _: Instant, _: SocketAddrV4, _: u16, _: &[u8]) {}
    fn handle_timeout(&mut self, now: Instant) {
        if self.next <= now {
            self.next += CYCLE;
            self.due = true;
        }
    }
    fn poll_transmit(&mut self, _: Instant, buffer: &mut [u8]) -> Option<Transmit> {
        let frame = buffer.get_mut(..64).filter(|_| std::mem::take(&mut self.due))?;
        frame.fill(0);
        frame[..6].copy_from_slice(&self.peer.0);
        frame[6..12].copy_from_slice(&self.mac.0);
        frame[12..18].copy_from_slice(&[0x81, 0, 0xC0, 0, 0x88, 0x92]);
        Some(Transmit::Frame { length: 64 })
    }
    fn poll_timeout(&self) -> Option<Instant> {
        Some(self.next)
    }
}

fn cyclic(own: u8, peer: u8) -> Host<Cyclic> {
    let mac = |n| MacAddress([2, 0, 0, 0, 0, n]);
    let next = Instant::ZERO + CYCLE;
    Host::new(Cyclic {
        mac: mac(own),
        peer: mac(peer),
        next,
        due: false,
        received: 0,
    })
}

#[test]
fn a_host_passes_cyclic_frames_without_allocation() {
    let (mut a, mut b) = (cyclic(1, 2), cyclic(2, 1));
    let mut buffer = [0; MAX_FRAME];
    let count = allocations::made_by(|| {
        for n in 1..=10_000 {
            let now = Instant::ZERO + CYCLE * n;
            a.handle_timeout(now);
            while let Some(length) = a.poll_transmit(now, &mut buffer) {
                b.handle_frame(now, &buffer[..length]);
            }
            assert!(a.poll_timeout() > Some(now));
        }
    });
    assert_eq!((count, b.endpoint().received), (0, 10_000));
}

#[test]
fn the_segment_carries_cyclic_frames_without_allocation() {
    let mut segment = Segment::new(11);
    segment.set_all_conditions(Conditions {
        loss: 0.01,
        duplicate: 0.01,
        reorder: 0.01,
        reorder_by: Duration::from_millis(20),
        jitter: Duration::from_micros(100),
        ..Conditions::default()
    });
    let id = segment.attach(Box::new(cyclic(1, 2)));
    segment.attach(Box::new(cyclic(2, 1)));
    // The queue and the buffers grow to their size first.
    segment.run_until(Instant::from_millis(60_000));
    let count = allocations::made_by(|| segment.run_until(Instant::from_millis(600_000)));
    assert!(segment.station::<Host<Cyclic>>(id).unwrap().endpoint().received > 36_000);
    assert_eq!(count, 0);
}

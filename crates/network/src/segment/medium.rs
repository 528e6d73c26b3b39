//! The caller's own endpoint on the segment.

use std::convert::Infallible;
use std::time::{Duration, Instant as Wall};

use profinet::{Endpoint, Instant, MacAddress, Medium};

use super::{Guest, Segment};
use crate::host::Stack;

/// How time passes on a [`SegmentMedium`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Pace {
    /// Jumps to the next event: for tests.
    Virtual,
    /// One second per second: for people who watch.
    Wall,
}

/// Carries the caller's endpoint on a [`Segment`], beside the stations there.
///
/// The endpoint gets its own place at the switch, found by its Ethernet address, and ARP, IP and UDP around it; so
/// several endpoints can be stepped in turn. What arrives for one while another is stepped is kept for it.
///
/// ```
/// use profidrive_network::segment::{Pace, Segment, SegmentMedium};
/// use profinet::{Instant, Medium};
/// let mut medium = SegmentMedium::new(Segment::new(1), Pace::Virtual);
/// assert_eq!(medium.now(), Instant::ZERO);
/// medium.segment_mut().run_until(Instant::from_millis(5));
/// assert_eq!(medium.now(), Instant::from_millis(5));
/// ```
#[derive(Debug)]
pub struct SegmentMedium {
    segment: Segment,
    guests: Vec<Place>,
    pace: Pace,
    /// The wall-clock time of the virtual time, at [`Pace::Wall`].
    origin: (Wall, Instant),
}

#[derive(Debug)]
struct Place {
    mac: MacAddress,
    port: usize,
    stack: Stack,
}

impl SegmentMedium {
    /// Puts the medium on a segment, which goes on from its present time.
    #[must_use]
    pub fn new(segment: Segment, pace: Pace) -> Self {
        let origin = (Wall::now(), segment.now());
        Self {
            segment,
            guests: Vec::new(),
            pace,
            origin,
        }
    }

    /// Returns the segment, to look at.
    #[must_use]
    pub fn segment(&self) -> &Segment {
        &self.segment
    }

    /// Returns the segment, to plug and pull stations and cables.
    #[must_use]
    pub fn segment_mut(&mut self) -> &mut Segment {
        &mut self.segment
    }

    /// Sets how time passes from now on.
    pub fn set_pace(&mut self, pace: Pace) {
        self.pace = pace;
        self.origin = (Wall::now(), self.segment.now());
    }

    /// Takes the segment back.
    #[must_use]
    pub fn into_segment(self) -> Segment {
        self.segment
    }

    /// Returns the port of the endpoint with address `mac`, to set its conditions or cut its cable.
    pub fn place(&mut self, mac: MacAddress) -> super::StationId {
        let index = self.find_or_add(mac);
        super::StationId(self.guests.get(index).map_or(0, |place| place.port))
    }

    fn find_or_add(&mut self, mac: MacAddress) -> usize {
        if let Some(index) = self.guests.iter().position(|place| place.mac == mac) {
            return index;
        }
        let port = self.segment.add_guest_port(mac);
        self.guests.push(Place {
            mac,
            port,
            stack: Stack::new(mac),
        });
        self.guests.len() - 1
    }

    /// Carries bytes to and from `endpoint` as [`Medium::step`] does. Returns whether it handled an input or a deadline; else
    /// `until` is reached.
    pub fn advance(&mut self, endpoint: &mut dyn Endpoint, until: Instant) -> bool {
        let index = self.find_or_add(endpoint.mac());
        // The stack is taken out for the call, so that sleeping and the segment can be used beside it.
        let Some(place) = self.guests.get_mut(index) else {
            return false;
        };
        let port = place.port;
        let mut stack = std::mem::replace(&mut place.stack, Stack::new(place.mac));
        let mut guest = Some(Guest {
            port,
            stack: &mut stack,
            endpoint,
        });
        self.segment.dirty.push(port);
        self.segment.drain_dirty(&mut guest);
        let mut worked = match self.segment.fabric.pop_kept(port) {
            Some(delivery) => self.segment.deliver(delivery, &mut guest),
            None => false,
        };
        while !worked {
            match self.segment.next_event().filter(|at| *at <= until) {
                Some(at) => {
                    self.wait(at);
                    worked = self.segment.turn(at, &mut guest);
                }
                None => {
                    self.wait(until);
                    self.segment.now = self.segment.now.max(until);
                    break;
                }
            }
        }
        self.segment.deadlines.set(port, None);
        if let Some(place) = self.guests.get_mut(index) {
            place.stack = stack;
        }
        worked
    }

    /// At [`Pace::Wall`], sleeps until the wall clock has reached `at`.
    fn wait(&self, at: Instant) {
        if self.pace == Pace::Wall {
            let ahead = (at - self.origin.1).saturating_sub(self.origin.0.elapsed());
            if ahead > Duration::ZERO {
                std::thread::sleep(ahead);
            }
        }
    }
}

impl Medium for SegmentMedium {
    type Error = Infallible;

    fn now(&self) -> Instant {
        self.segment.now()
    }

    fn step(&mut self, endpoint: &mut dyn Endpoint, until: Instant) -> Result<(), Infallible> {
        self.advance(endpoint, until);
        Ok(())
    }
}

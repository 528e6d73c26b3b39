//! ARP: who uses which IP address, and who floods the network.

use std::collections::HashMap;
use std::net::Ipv4Addr;
use std::time::Duration;

use profinet::MacAddress;

use super::event::{Detail, Sink, Trouble};
use super::names::Names;
use crate::Weight;

/// Most senders counted.
const MAX_SENDERS: usize = 4096;
/// Time over which the frames of a sender are counted.
const WINDOW: Duration = Duration::from_secs(1);
/// Frames of one sender within the window that are a flood: a scanner of a whole class C network stays below.
const FLOOD: u32 = 300;

/// ARP frames of each sender.
#[derive(Debug, Default)]
pub struct Arp {
    senders: HashMap<MacAddress, Count>,
}

#[derive(Debug, Default)]
struct Count {
    since: Duration,
    frames: u32,
    /// The flood was reported, and did not end since.
    flooding: bool,
}

/// One ARP frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ArpFrame {
    pub source: MacAddress,
    sender: (MacAddress, Ipv4Addr),
}

/// Returns the ARP frame in an Ethernet frame, tag looked through; `None` for everything else.
pub fn frame(bytes: &[u8]) -> Option<ArpFrame> {
    let word = |at: usize| bytes.get(at..)?.first_chunk::<2>().copied();
    let start = if word(12)? == [0x81, 0x00] { 16 } else { 12 };
    if word(start)? != [0x08, 0x06] {
        return None;
    }
    let arp = bytes.get(start + 2..)?;
    // Ethernet, IPv4, their lengths
    if !arp.starts_with(&[0, 1, 8, 0, 6, 4]) {
        return None;
    }
    let mac = MacAddress(*arp.get(8..)?.first_chunk()?);
    let ip = Ipv4Addr::from(*arp.get(14..)?.first_chunk::<4>()?);
    Some(ArpFrame {
        source: MacAddress(*bytes.get(6..)?.first_chunk()?),
        sender: (mac, ip),
    })
}

impl Arp {
    /// Looks at one frame.
    pub fn frame(&mut self, frame: &ArpFrame, names: &mut Names, sink: &mut Sink<'_>) {
        let (mac, ip) = frame.sender;
        // a probe for conflicts has no address of its own yet
        if !ip.is_unspecified() {
            names.seen_at(mac, ip, sink);
        }
        if self.senders.len() >= MAX_SENDERS && !self.senders.contains_key(&frame.source) {
            self.senders
                .retain(|_, count| sink.at.saturating_sub(count.since) < WINDOW);
            if self.senders.len() >= MAX_SENDERS {
                return;
            }
        }
        let count = self.senders.entry(frame.source).or_default();
        if sink.at.saturating_sub(count.since) >= WINDOW {
            count.flooding &= count.frames >= FLOOD;
            count.since = sink.at;
            count.frames = 0;
        }
        count.frames = count.frames.saturating_add(1);
        if count.frames == FLOOD && !count.flooding {
            count.flooding = true;
            let text = format!("ARP flood: {FLOOD} frames within 1 s");
            let trouble = Trouble::ArpFlood { frames: FLOOD };
            sink.report(Weight::Error, "ARP", text, Detail::Trouble(trouble));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::event::Party;
    use super::*;

    #[test]
    fn senders_are_bounded_and_make_room_when_they_are_silent() {
        let mut arp = Arp::default();
        let mut names = Names::default();
        let mut frame_of = |arp: &mut Arp, number: u16, at| {
            let [high, low] = number.to_be_bytes();
            let source = MacAddress([2, 0, 0, 1, high, low]);
            let frame = ArpFrame {
                source,
                sender: (source, Ipv4Addr::UNSPECIFIED),
            };
            let mut sink = Sink {
                frame: 1,
                at,
                source: Party::default(),
                target: Party::default(),
                events: &mut Vec::new(),
            };
            arp.frame(&frame, &mut names, &mut sink);
            arp.senders.contains_key(&source)
        };
        for number in 0..5000 {
            let counted = frame_of(&mut arp, number, Duration::ZERO);
            assert_eq!(counted, number < 4096);
        }
        assert!(frame_of(&mut arp, 5000, WINDOW));
        assert_eq!(arp.senders.len(), 1);
    }
}

//! LLDP: who sits at which cable.

use std::collections::BTreeMap;

use profinet::MacAddress;
use profinet::wire::lldp::Lldpdu;
use profinet::wire::{DecodeError, Reader};

use super::event::{Detail, Neighbour, Sink};
use super::names::Names;
use crate::Weight;

/// Maximum number of stored senders; frames of further senders are reported each time.
const MAX_SENDERS: usize = 4096;

/// The last announcement of each sender: reported once, since it is repeated every few seconds.
#[derive(Debug, Default)]
pub(super) struct Neighbours(BTreeMap<MacAddress, String>);

impl Neighbours {
    /// Looks at the LLDPDU of a frame.
    pub(super) fn pdu(
        &mut self,
        source: MacAddress,
        payload: &[u8],
        names: &mut Names,
        sink: &mut Sink<'_>,
    ) -> Result<(), DecodeError> {
        let lldpdu = Lldpdu::decode(Reader::new(payload))?;
        let (port, station) = lldpdu.profinet_names();
        let words = |octets: &[u8]| String::from_utf8_lossy(octets).into_owned();
        let address = lldpdu.management.and_then(|management| management.ipv4());
        let mut text = match (lldpdu.ttl, station) {
            (0, _) => format!("{} goes", words(port)),
            (_, b"") => format!("is here with {}, without a name", words(port)),
            (_, station) => format!("is here with {} of {}", words(port), words(station)),
        };
        if let Some(address) = address.filter(|_| lldpdu.ttl > 0) {
            text = format!("{text}, {address}");
        }
        if lldpdu.chassis_mac.is_some() && !station.is_empty() {
            // a PROFINET station: the name is the one it has
            names.seen(source, address, Some(station), sink);
        }
        if self.0.get(&source) != Some(&text) {
            let detail = Neighbour {
                port: words(port),
                station: words(station),
                ip: address,
                ttl: lldpdu.ttl,
            };
            sink.report(Weight::Normal, "LLDP", text.as_str(), Detail::Neighbour(detail));
            if self.0.len() < MAX_SENDERS || self.0.contains_key(&source) {
                self.0.insert(source, text);
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use profinet::MacAddress;
    use profinet::wire::lldp::{GROUP, Id, LOCALLY_ASSIGNED, Lldpdu, Management};

    use crate::capture::Walker;

    #[test]
    fn senders_are_bounded_and_further_ones_are_reported_each_time() {
        let own = |value| Id {
            subtype: LOCALLY_ASSIGNED,
            value,
        };
        let mut frame = [&GROUP.0[..], &[2, 0, 0, 1, 0, 0], &[0x88, 0xCC]].concat();
        Lldpdu {
            ttl: 20,
            ..Lldpdu::new(own(b"akd-1"), own(b"port-001"))
        }
        .encode(&mut frame);
        let mut walker = Walker::default();
        for again in [false, true] {
            for number in 0..4100_u16 {
                frame[10..12].copy_from_slice(&number.to_be_bytes());
                let events = walker.frame(Duration::ZERO, &frame);
                assert_eq!(events.is_empty(), again && number < 4096, "{number}");
            }
        }
        assert_eq!(walker.neighbours.0.len(), 4096);
    }

    #[test]
    fn a_neighbour_is_reported_on_arrival_and_departure() {
        let own = |value| Id {
            subtype: LOCALLY_ASSIGNED,
            value,
        };
        let frame = |ttl| {
            let mut frame = [&GROUP.0[..], &[2, 0, 0, 0, 0, 9], &[0x88, 0xCC]].concat();
            Lldpdu {
                ttl,
                chassis_mac: Some(MacAddress([2, 0, 0, 0, 0, 9])),
                management: Some(Management {
                    family: 1,
                    address: &[10, 0, 0, 2],
                    numbering: 2,
                    interface: 1,
                    object: &[],
                }),
                ..Lldpdu::new(own(b"akd-1"), own(b"port-001"))
            }
            .encode(&mut frame);
            frame
        };
        let mut walker = Walker::default();
        let mut texts = Vec::new();
        for ttl in [20, 20, 0] {
            texts.extend(walker.frame(Duration::ZERO, &frame(ttl)));
        }
        let texts: Vec<_> = texts.iter().map(|n| (&n.from[..], &n.text[..])).collect();
        assert_eq!(
            texts,
            [
                ("akd-1", "is here with port-001 of akd-1, 10.0.0.2"),
                ("akd-1", "port-001 goes")
            ]
        );
        assert_eq!(
            walker.frame(Duration::ZERO, &frame(20)[..20])[0].topic,
            "malformed"
        );
    }
}

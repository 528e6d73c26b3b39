//! A request or a response in fragments.

use std::collections::BTreeMap;

use profinet::wire::rpc::Header;

/// Largest request or answer put together: a record has 65,535 octets at most.
const MAX_BODY: usize = 1 << 17;
/// What the place of a piece counts beside its octets, so that empty pieces are not free.
const PLACE: usize = 64;

/// A body in pieces.
#[derive(Debug, Default)]
pub struct Assembly {
    fragments: BTreeMap<u16, Vec<u8>>,
    last: Option<u16>,
    /// Octets of all pieces and [`PLACE`] for each of them; at most [`MAX_BODY`].
    octets: usize,
    done: bool,
}

impl Assembly {
    /// Returns true once the whole body was returned.
    pub const fn is_done(&self) -> bool {
        self.done
    }

    /// Ends it: what still comes is a repetition.
    pub fn finish(&mut self) {
        self.done = true;
        self.fragments.clear();
    }

    /// Adds a piece. Returns the whole body once, when the last piece is there.
    pub fn add(&mut self, header: &Header, body: &[u8]) -> Option<Vec<u8>> {
        if self.done {
            return None;
        }
        if !header.flags.is_fragment() {
            self.done = true;
            return Some(body.to_vec());
        }
        let octets = self.octets + PLACE + body.len();
        if octets > MAX_BODY || self.fragments.contains_key(&header.fragment) {
            return None;
        }
        if header.flags.is_last() {
            self.last = Some(header.fragment);
        }
        self.fragments.insert(header.fragment, body.to_vec());
        self.octets = octets;
        let last = self.last?;
        if self.fragments.len() != usize::from(last) + 1 || self.fragments.keys().next_back() != Some(&last) {
            return None;
        }
        self.done = true;
        Some(
            std::mem::take(&mut self.fragments)
                .into_values()
                .flatten()
                .collect(),
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use profinet::wire::Uuid;
    use profinet::wire::rpc::{Flags, operation};

    fn fragment(number: u16, last: bool) -> Header {
        let mut header = Header::request(Uuid::NIL, Uuid::DEVICE_INTERFACE, Uuid::NIL, 0, operation::WRITE);
        header.flags = Flags(Flags::FRAGMENT | if last { Flags::LAST_FRAGMENT } else { 0 });
        header.fragment = number;
        header
    }

    #[test]
    fn fragments_in_any_order_and_twice() {
        let mut assembly = Assembly::default();
        assert_eq!(assembly.add(&fragment(2, true), b"c"), None);
        assert_eq!(assembly.add(&fragment(0, false), b"a"), None);
        assert_eq!(assembly.add(&fragment(0, false), b"a"), None);
        assert_eq!(assembly.add(&fragment(1, false), b"b"), Some(b"abc".to_vec()));
        assert_eq!(
            assembly.add(&fragment(1, false), b"b"),
            None,
            "a repetition is not a second body"
        );
    }

    #[test]
    fn pieces_are_bounded_in_number_and_octets() {
        let mut assembly = Assembly::default();
        for body in [&b""[..], &[0; 1384]] {
            for number in 0..u16::MAX {
                assert_eq!(assembly.add(&fragment(number, false), body), None);
            }
        }
        let octets: usize = assembly.fragments.values().map(Vec::len).sum();
        assert_eq!((assembly.fragments.len(), octets), (MAX_BODY / PLACE, 0));
    }
}

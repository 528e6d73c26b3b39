//! The SNMP tables of the device: system, interface, address, and LLDP with all neighbours.
//!
//! Source: RFC 3418 (system), RFC 2863 (interfaces), RFC 4293 (addresses), IEEE 802.1AB clause 12 (LLDP-MIB). The
//! objects of conformance class B. Everything is read-only.

use alloc::borrow::ToOwned;
use alloc::vec;
use alloc::vec::Vec;
use core::net::SocketAddrV4;

use super::Device;
use super::port::{HOLD, IF_INDEX, INTERVAL, OBJECT, port_name, system_identification};
use crate::Instant;
use crate::lldp::Neighbour;
use crate::snmp::{Mib, answer};
use crate::wire::lldp::Lldpdu;
use crate::wire::snmp::{Oid, Value};

/// The community that may read; the one that PROFINET tools use.
pub const COMMUNITY: &[u8] = b"public";
/// Answers that may wait to be sent; a client repeats requests that are lost.
const WAITING: usize = 8;
/// Rate of the only port.
const BITS_PER_SECOND: u32 = 100_000_000;
/// sysServices: a host with applications.
const SERVICES: i32 = 72;
/// Local port number in the LLDP tables.
const PORT: u32 = 1;
const YES: i32 = 1;
const NO: i32 = 2;

/// Which rows a column has.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Rows {
    /// The only instance, 0.
    Scalar,
    /// The interface or port, 1.
    Port,
    /// The own address, where one is set.
    Address,
    /// The own address as LLDP numbers it.
    Management,
    /// One for each neighbour.
    Neighbour,
    /// One for each neighbour that reported an address.
    NeighbourAddress,
}

/// Objects whose identifiers begin alike.
struct Group {
    prefix: &'static [u32],
    objects: &'static [Object],
}

/// An object: the rest of its identifier, its rows and their values.
struct Object {
    number: &'static [u32],
    rows: Rows,
    value: fn(&View<'_>, &Row<'_>) -> Value,
}

/// One row: its index, and the neighbour it is about.
#[derive(Clone)]
struct Row<'a> {
    index: Vec<u32>,
    neighbour: Option<&'a Neighbour>,
}

impl<'a> Row<'a> {
    /// Returns the LLDPDU of its neighbour.
    fn lldpdu(&self) -> Option<Lldpdu<'a>> {
        self.neighbour.and_then(Neighbour::lldpdu)
    }
}

/// The device at a moment.
struct View<'a> {
    device: &'a Device,
    now: Instant,
}

fn text(octets: &[u8]) -> Value {
    Value::Octets(octets.to_owned())
}

/// Returns a text that may be absent.
fn optional(octets: Option<&[u8]>) -> Value {
    text(octets.unwrap_or_default())
}

/// Counters of 32 bits start again at 0.
fn counter(value: u64) -> Value {
    Value::Counter((value & u64::from(u32::MAX)) as u32)
}

/// Capabilities as LLDP has them (bit 0 is the lowest) as BITS of a MIB (bit 0 is the highest of the first octet).
fn capabilities(bits: Option<u16>) -> Value {
    let [high, low] = bits.unwrap_or(0).to_be_bytes();
    Value::Octets(vec![low.reverse_bits(), high.reverse_bits()])
}

impl View<'_> {
    /// Hundredths of a second from the start of the device to `at`.
    fn ticks(&self, at: Instant) -> u32 {
        let start = self.device.started.unwrap_or(self.now);
        let hundredths = at.saturating_since(start).as_millis() / 10;
        (hundredths & u128::from(u32::MAX)) as u32
    }

    fn rows(&self, rows: Rows) -> Vec<Row<'_>> {
        let one = |index: Vec<u32>| {
            vec![Row {
                index,
                neighbour: None,
            }]
        };
        let octets = |address: [u8; 4]| address.map(u32::from);
        let own = Some(self.device.ip.address.octets()).filter(|_| self.device.ip.is_set());
        match (rows, own) {
            (Rows::Scalar, _) => one(vec![0]),
            (Rows::Port, _) => one(vec![PORT]),
            (Rows::Address, Some(own)) => one(octets(own).to_vec()),
            (Rows::Management, Some(own)) => one([&[1, 4][..], &octets(own)].concat()),
            (Rows::Address | Rows::Management, None) => Vec::new(),
            (Rows::Neighbour | Rows::NeighbourAddress, _) => {
                let row = |neighbour| self.neighbour_row(rows, neighbour);
                let mut all: Vec<Row<'_>> = self.device.port.neighbours.iter().filter_map(row).collect();
                all.sort_by(|a, b| a.index.cmp(&b.index));
                all
            }
        }
    }

    fn neighbour_row<'a>(&self, rows: Rows, neighbour: &'a Neighbour) -> Option<Row<'a>> {
        let mut index = vec![self.ticks(neighbour.since), PORT, neighbour.index];
        if rows == Rows::NeighbourAddress {
            let management = neighbour.lldpdu()?.management?;
            index.extend([u32::from(management.family), management.address.len() as u32]);
            index.extend(management.address.iter().copied().map(u32::from));
        }
        Some(Row {
            index,
            neighbour: Some(neighbour),
        })
    }
}

impl Mib for View<'_> {
    fn get(&self, name: &Oid) -> Value {
        let found = GROUPS
            .iter()
            .find_map(|group| Some((group, name.behind(group.prefix)?)))
            .and_then(|(group, rest)| {
                let mut objects = group.objects.iter();
                objects.find_map(|object| Some((object, rest.strip_prefix(object.number)?)))
            });
        let Some((object, index)) = found else {
            return Value::NoSuchObject;
        };
        let rows = self.rows(object.rows);
        match rows.iter().find(|row| row.index == index) {
            Some(row) => (object.value)(self, row),
            None => Value::NoSuchInstance,
        }
    }

    fn next(&self, name: &Oid) -> Option<(Oid, Value)> {
        GROUPS.iter().find_map(|group| {
            // a name behind the group's own goes to one of its objects, one before it to the first
            let rest = match name.behind(group.prefix) {
                Some(rest) => rest,
                None if *group.prefix > name.0[..] => &[],
                None => return None,
            };
            group.objects.iter().find_map(|object| {
                let index = match rest.strip_prefix(object.number) {
                    Some(index) => index,
                    None if object.number > rest => &[],
                    None => return None,
                };
                let rows = self.rows(object.rows);
                let row = rows.iter().find(|row| row.index[..] > *index)?;
                let found = Oid([group.prefix, object.number, &row.index].concat());
                Some((found, (object.value)(self, row)))
            })
        })
    }
}

impl Device {
    /// Answers a datagram at the port of SNMP.
    pub(super) fn handle_snmp(&mut self, now: Instant, source: SocketAddrV4, request: &[u8]) {
        if self.answers.len() >= WAITING {
            return;
        }
        let view = View { device: self, now };
        if let Some(answer) = answer(&view, COMMUNITY, request) {
            self.answers.push_back((source, answer));
        }
    }

    /// Writes the next answer to SNMP.
    pub(super) fn emit_snmp(&mut self, buffer: &mut [u8]) -> Option<(SocketAddrV4, usize)> {
        let (to, answer) = self.answers.pop_front()?;
        buffer.get_mut(..answer.len())?.copy_from_slice(&answer);
        Some((to, answer.len()))
    }

    /// I&M1 TagLocation without the blanks behind it.
    fn location(&self) -> &[u8] {
        self.im.im1.get(32..).unwrap_or_default().trim_ascii_end()
    }
}

/// Makes the table: the numbers of a group, then its objects with number, rows and value.
macro_rules! objects {
    ($($prefix:tt { $($number:tt $rows:ident |$view:pat_param, $row:pat_param| $value:expr;)* })*) => {
        /// Every object, in the order of their identifiers.
        const GROUPS: &[Group] = &[$(Group {
            prefix: &$prefix,
            objects: &[$(Object {
                number: &$number,
                rows: Rows::$rows,
                value: |$view, $row| $value,
            },)*],
        },)*];
    };
}

objects! {
    // LLDP-MIB: configuration
    [1, 0, 8802, 1, 1, 2, 1, 1] {
        [1] Scalar |_, _| Value::Integer(INTERVAL.as_secs() as i32);
        [2] Scalar |_, _| Value::Integer(HOLD.into());
        [3] Scalar |_, _| Value::Integer(2);
        [4] Scalar |_, _| Value::Integer(1);
        [5] Scalar |_, _| Value::Integer(5);
        [6, 1, 2] Port |_, _| Value::Integer(3);
        [6, 1, 3] Port |_, _| Value::Integer(NO);
        // system name, description and capabilities
        [6, 1, 4] Port |_, _| Value::Octets(vec![0x70]);
    }
    // statistics
    [1, 0, 8802, 1, 1, 2, 1, 2] {
        [1] Scalar |v, _| Value::Ticks(v.ticks(v.device.port.neighbours.changed()));
        [2] Scalar |v, _| Value::Gauge(v.device.port.neighbours.counts().inserts);
        [3] Scalar |v, _| Value::Gauge(v.device.port.neighbours.counts().deletes);
        [4] Scalar |v, _| Value::Gauge(v.device.port.neighbours.counts().drops);
        [5] Scalar |v, _| Value::Gauge(v.device.port.neighbours.counts().ageouts);
        [6, 1, 2] Port |v, _| Value::Counter(v.device.port.neighbours.counts().sent);
        [7, 1, 2] Port |v, _| Value::Counter(v.device.port.neighbours.counts().errors);
        [7, 1, 3] Port |v, _| Value::Counter(v.device.port.neighbours.counts().errors);
        [7, 1, 4] Port |v, _| Value::Counter(v.device.port.neighbours.counts().frames);
        [7, 1, 5] Port |v, _| Value::Counter(v.device.port.neighbours.counts().tlvs_discarded);
        [7, 1, 6] Port |v, _| Value::Counter(v.device.port.neighbours.counts().tlvs_unknown);
        [7, 1, 7] Port |v, _| Value::Gauge(v.device.port.neighbours.counts().ageouts);
    }
    // this station
    [1, 0, 8802, 1, 1, 2, 1, 3] {
        [1] Scalar |v, _| v.device.with_lldpdu(|lldpdu| Value::Integer(lldpdu.chassis.subtype.into()));
        [2] Scalar |v, _| v.device.with_lldpdu(|lldpdu| text(lldpdu.chassis.value));
        [3] Scalar |v, _| text(v.device.name.as_bytes());
        [4] Scalar |v, _| text(system_identification(&v.device.config.identity).as_bytes());
        [5] Scalar |v, _| v.device.with_lldpdu(|lldpdu| capabilities(lldpdu.capabilities.map(|c| c.0)));
        [6] Scalar |v, _| v.device.with_lldpdu(|lldpdu| capabilities(lldpdu.capabilities.map(|c| c.1)));
        [7, 1, 2] Port |v, _| v.device.with_lldpdu(|lldpdu| Value::Integer(lldpdu.port.subtype.into()));
        [7, 1, 3] Port |v, _| v.device.with_lldpdu(|lldpdu| text(lldpdu.port.value));
        [7, 1, 4] Port |v, _| text(port_name(v.device.port_subslot()).as_bytes());
        // family and address
        [8, 1, 3] Management |_, _| Value::Integer(5);
        [8, 1, 4] Management |_, _| Value::Integer(2);
        [8, 1, 5] Management |_, _| Value::Integer(IF_INDEX as i32);
        [8, 1, 6] Management |_, _| Value::Oid(OBJECT.into());
    }
    // neighbours
    [1, 0, 8802, 1, 1, 2, 1, 4, 1, 1] {
        [4] Neighbour |_, r| Value::Integer(r.lldpdu().map_or(0, |lldpdu| lldpdu.chassis.subtype.into()));
        [5] Neighbour |_, r| optional(r.lldpdu().map(|lldpdu| lldpdu.chassis.value));
        [6] Neighbour |_, r| Value::Integer(r.lldpdu().map_or(0, |lldpdu| lldpdu.port.subtype.into()));
        [7] Neighbour |_, r| optional(r.lldpdu().map(|lldpdu| lldpdu.port.value));
        [8] Neighbour |_, r| optional(r.lldpdu().and_then(|lldpdu| lldpdu.port_description));
        [9] Neighbour |_, r| optional(r.lldpdu().and_then(|lldpdu| lldpdu.system_name));
        [10] Neighbour |_, r| optional(r.lldpdu().and_then(|lldpdu| lldpdu.system_description));
        [11] Neighbour |_, r| capabilities(r.lldpdu().and_then(|lldpdu| lldpdu.capabilities).map(|c| c.0));
        [12] Neighbour |_, r| capabilities(r.lldpdu().and_then(|lldpdu| lldpdu.capabilities).map(|c| c.1));
    }
    [1, 0, 8802, 1, 1, 2, 1, 4, 2, 1] {
        [3] NeighbourAddress |_, r| {
            let numbering = r.lldpdu().and_then(|lldpdu| lldpdu.management).map_or(1, |m| m.numbering);
            Value::Integer(numbering.into())
        };
        [4] NeighbourAddress |_, r| {
            let number = r.lldpdu().and_then(|lldpdu| lldpdu.management).map_or(0, |m| m.interface);
            Value::Integer(i32::try_from(number).unwrap_or(i32::MAX))
        };
    }
    // system
    [1, 3, 6, 1, 2, 1, 1] {
        [1] Scalar |v, _| text(system_identification(&v.device.config.identity).as_bytes());
        [2] Scalar |_, _| Value::Oid(OBJECT.into());
        [3] Scalar |v, _| Value::Ticks(v.ticks(v.now));
        [4] Scalar |_, _| text(&[]);
        [5] Scalar |v, _| text(v.device.name.as_bytes());
        [6] Scalar |v, _| text(v.device.location());
        [7] Scalar |_, _| Value::Integer(SERVICES);
    }
    // interfaces
    [1, 3, 6, 1, 2, 1, 2] {
        [1] Scalar |_, _| Value::Integer(1);
        [2, 1, 1] Port |_, _| Value::Integer(IF_INDEX as i32);
        [2, 1, 2] Port |v, _| text(port_name(v.device.port_subslot()).as_bytes());
        [2, 1, 3] Port |_, _| Value::Integer(6);
        [2, 1, 4] Port |_, _| Value::Integer(1500);
        [2, 1, 5] Port |_, _| Value::Gauge(BITS_PER_SECOND);
        [2, 1, 6] Port |v, _| text(&v.device.config.mac.0);
        [2, 1, 7] Port |_, _| Value::Integer(YES);
        [2, 1, 8] Port |_, _| Value::Integer(YES);
        [2, 1, 9] Port |_, _| Value::Ticks(0);
        [2, 1, 10] Port |v, _| counter(v.device.port.received.octets);
        [2, 1, 11] Port |v, _| counter(v.device.port.received.unicast);
        [2, 1, 12] Port |v, _| counter(v.device.port.received.multicast + v.device.port.received.broadcast);
        [2, 1, 13] Port |_, _| Value::Counter(0);
        [2, 1, 14] Port |_, _| Value::Counter(0);
        [2, 1, 15] Port |_, _| Value::Counter(0);
        [2, 1, 16] Port |v, _| counter(v.device.port.sent.octets);
        [2, 1, 17] Port |v, _| counter(v.device.port.sent.unicast);
        [2, 1, 18] Port |v, _| counter(v.device.port.sent.multicast + v.device.port.sent.broadcast);
        [2, 1, 19] Port |_, _| Value::Counter(0);
        [2, 1, 20] Port |_, _| Value::Counter(0);
        [2, 1, 21] Port |_, _| Value::Gauge(0);
        [2, 1, 22] Port |_, _| Value::Oid(Oid::from([0, 0]));
    }
    // addresses
    [1, 3, 6, 1, 2, 1, 4, 20, 1] {
        [1] Address |v, _| Value::IpAddress(v.device.ip.address);
        [2] Address |_, _| Value::Integer(IF_INDEX as i32);
        [3] Address |v, _| Value::IpAddress(v.device.ip.mask);
        [4] Address |_, _| Value::Integer(1);
    }
    // interfaces, what came later
    [1, 3, 6, 1, 2, 1, 31, 1, 1, 1] {
        [1] Port |v, _| text(port_name(v.device.port_subslot()).as_bytes());
        [2] Port |v, _| counter(v.device.port.received.multicast);
        [3] Port |v, _| counter(v.device.port.received.broadcast);
        [4] Port |v, _| counter(v.device.port.sent.multicast);
        [5] Port |v, _| counter(v.device.port.sent.broadcast);
        [6] Port |v, _| Value::Counter64(v.device.port.received.octets);
        [7] Port |v, _| Value::Counter64(v.device.port.received.unicast);
        [8] Port |v, _| Value::Counter64(v.device.port.received.multicast);
        [9] Port |v, _| Value::Counter64(v.device.port.received.broadcast);
        [10] Port |v, _| Value::Counter64(v.device.port.sent.octets);
        [11] Port |v, _| Value::Counter64(v.device.port.sent.unicast);
        [12] Port |v, _| Value::Counter64(v.device.port.sent.multicast);
        [13] Port |v, _| Value::Counter64(v.device.port.sent.broadcast);
        [14] Port |_, _| Value::Integer(NO);
        [15] Port |_, _| Value::Gauge(BITS_PER_SECOND / 1_000_000);
        [16] Port |_, _| Value::Integer(NO);
        [17] Port |_, _| Value::Integer(YES);
        [18] Port |_, _| text(&[]);
        [19] Port |_, _| Value::Ticks(0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_objects_stand_in_order_and_none_within_another() {
        let names: Vec<Vec<u32>> = GROUPS
            .iter()
            .flat_map(|group| {
                group
                    .objects
                    .iter()
                    .map(|object| [group.prefix, object.number].concat())
            })
            .collect();
        for pair in names.windows(2) {
            assert!(pair[0] < pair[1], "{:?}", pair[1]);
            assert!(!pair[1].starts_with(&pair[0]), "{:?}", pair[1]);
        }
        for pair in GROUPS.windows(2) {
            assert!(
                !pair[1].prefix.starts_with(pair[0].prefix),
                "{:?}",
                pair[1].prefix
            );
        }
    }
}

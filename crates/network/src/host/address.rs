//! Which IPv4 addresses a station may have, and the next hop of a datagram for an address.

use std::net::Ipv4Addr;

use profinet::{IpSuite, MacAddress};

/// Returns true for an address that one host can have.
pub(super) fn is_unicast(address: Ipv4Addr) -> bool {
    !(address.is_unspecified() || address.is_broadcast() || address.is_multicast() || address.is_loopback())
}

/// Returns true for 255.255.255.255 and for the broadcast address of the suite's own network.
pub(super) fn is_broadcast(suite: &IpSuite, address: Ipv4Addr) -> bool {
    let mask = u32::from(suite.mask);
    address.is_broadcast()
        || (mask < u32::MAX - 1 && suite.is_local(address) && u32::from(address) | mask == u32::MAX)
}

/// The next station on the way to an address.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum NextHop {
    /// Known without a request.
    Mac(MacAddress),
    /// To be requested by ARP.
    Neighbour(Ipv4Addr),
    /// No way there.
    None,
}

/// Finds the next station on the way from a host with `suite` to `destination`.
pub(super) fn next_hop(suite: &IpSuite, destination: Ipv4Addr) -> NextHop {
    if !suite.is_set() || destination.is_unspecified() || destination == suite.address {
        NextHop::None
    } else if is_broadcast(suite, destination) {
        NextHop::Mac(MacAddress::BROADCAST)
    } else if destination.is_multicast() {
        let [_, b, c, d] = destination.octets();
        NextHop::Mac(MacAddress([0x01, 0x00, 0x5E, b & 0x7F, c, d]))
    } else if suite.is_local(destination) {
        NextHop::Neighbour(destination)
    } else if is_unicast(suite.gateway) && suite.is_local(suite.gateway) && suite.gateway != suite.address {
        NextHop::Neighbour(suite.gateway)
    } else {
        NextHop::None
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SUITE: IpSuite = IpSuite {
        address: Ipv4Addr::new(192, 168, 0, 10),
        mask: Ipv4Addr::new(255, 255, 255, 0),
        gateway: Ipv4Addr::new(192, 168, 0, 1),
    };

    #[test]
    fn the_way_depends_on_the_network() {
        let hop = |a, b, c, d| next_hop(&SUITE, Ipv4Addr::new(a, b, c, d));
        assert_eq!(
            hop(192, 168, 0, 77),
            NextHop::Neighbour(Ipv4Addr::new(192, 168, 0, 77))
        );
        assert_eq!(hop(10, 0, 0, 1), NextHop::Neighbour(SUITE.gateway));
        assert_eq!(hop(192, 168, 0, 255), NextHop::Mac(MacAddress::BROADCAST));
        assert_eq!(hop(255, 255, 255, 255), NextHop::Mac(MacAddress::BROADCAST));
        assert_eq!(
            hop(239, 129, 2, 3),
            NextHop::Mac(MacAddress([1, 0, 0x5E, 1, 2, 3]))
        );
        assert_eq!(hop(192, 168, 0, 10), NextHop::None);
    }

    #[test]
    fn without_a_usable_gateway_there_is_no_way_out() {
        let far = Ipv4Addr::new(10, 0, 0, 1);
        for gateway in [
            Ipv4Addr::UNSPECIFIED,
            Ipv4Addr::new(172, 16, 0, 1),
            SUITE.address,
            Ipv4Addr::BROADCAST,
        ] {
            assert_eq!(next_hop(&IpSuite { gateway, ..SUITE }, far), NextHop::None);
        }
        assert_eq!(next_hop(&IpSuite::NONE, far), NextHop::None);
    }

    #[test]
    fn point_to_point_networks_have_no_broadcast_address() {
        let suite = IpSuite {
            mask: Ipv4Addr::new(255, 255, 255, 254),
            ..SUITE
        };
        assert!(!is_broadcast(&suite, Ipv4Addr::new(192, 168, 0, 11)));
        assert!(is_broadcast(&SUITE, Ipv4Addr::new(192, 168, 0, 255)));
    }
}

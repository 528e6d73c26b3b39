//! The interfaces of this computer.

use std::net::Ipv4Addr;

use profinet::{IpSuite, MacAddress};

use super::error::Error;

/// A network interface as it is now.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct InterfaceInfo {
    /// Its name, `eth0`.
    pub name: String,
    /// The kernel's number for it.
    pub index: u32,
    /// Its Ethernet address; `None` for anything else than Ethernet.
    pub mac: Option<MacAddress>,
    /// Its IPv4 addresses and masks; no gateway.
    pub addresses: Vec<IpSuite>,
    /// Switched on (not: cable plugged in).
    pub up: bool,
    /// The loopback interface.
    pub loopback: bool,
}

impl InterfaceInfo {
    /// Returns all interfaces, by name; none on a system whose interfaces this library does not list (any but Linux).
    ///
    /// # Errors
    /// When the operating system does not list them.
    pub fn list() -> Result<Vec<Self>, Error> {
        super::os::interfaces()
    }

    /// Returns the interface `name`, up or down.
    ///
    /// # Errors
    /// [`Error::NoSuchInterface`] with the names there are.
    pub fn find(name: &str) -> Result<Self, Error> {
        let mut all = Self::list()?;
        match all.iter().position(|info| info.name == name) {
            Some(index) => Ok(all.swap_remove(index)),
            None => {
                let existing = all.into_iter().map(|info| info.name).collect();
                Err(Error::NoSuchInterface {
                    interface: name.to_owned(),
                    existing,
                })
            }
        }
    }

    /// Returns the Ethernet address, if the interface is up and an Ethernet interface.
    ///
    /// # Errors
    /// [`Error::NotEthernet`] or [`Error::InterfaceDown`].
    pub fn usable(&self) -> Result<MacAddress, Error> {
        let mac = self.mac.ok_or_else(|| Error::NotEthernet {
            interface: self.name.clone(),
        })?;
        if self.up {
            Ok(mac)
        } else {
            Err(Error::InterfaceDown {
                interface: self.name.clone(),
            })
        }
    }

    /// Returns the first IPv4 address, [`IpSuite::NONE`] if there is none.
    ///
    /// An interface may have several; which of them leads to a station is [`InterfaceInfo::ip_towards`].
    #[must_use]
    pub fn ip(&self) -> IpSuite {
        self.addresses.first().copied().unwrap_or_default()
    }

    /// Returns the address in the subnet of `other`, in the smallest one where several contain it.
    #[must_use]
    pub fn ip_towards(&self, other: Ipv4Addr) -> Option<IpSuite> {
        towards(&self.addresses, other)
    }

    /// Returns whether `address` is one of the interface's own.
    #[must_use]
    pub fn owns(&self, address: Ipv4Addr) -> bool {
        self.addresses.iter().any(|own| own.address == address)
    }
}

/// Returns the own address that has `other` in its subnet; the longest mask wins, as in a routing table.
pub(super) fn towards(own: &[IpSuite], other: Ipv4Addr) -> Option<IpSuite> {
    let near = own.iter().copied().filter(|own| own.is_local(other));
    // of equals the first: the kernel lists the main address before the others
    near.rev().max_by_key(|own| u32::from(own.mask))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[cfg(target_os = "linux")]
    #[test]
    fn the_loopback_interface_is_found_and_is_no_ethernet() {
        let lo = InterfaceInfo::find("lo").unwrap();
        assert!(lo.loopback && lo.index > 0);
        assert!(matches!(lo.usable(), Err(Error::NotEthernet { .. })));
    }

    #[test]
    fn the_smallest_subnet_with_the_other_station_decides() {
        let suite = |address: [u8; 4], mask: [u8; 4]| IpSuite {
            address: address.into(),
            mask: mask.into(),
            gateway: Ipv4Addr::UNSPECIFIED,
        };
        let wide = suite([10, 0, 0, 1], [255, 0, 0, 0]);
        let narrow = suite([10, 0, 5, 1], [255, 255, 255, 0]);
        let second = suite([10, 0, 5, 2], [255, 255, 255, 0]);
        let other = suite([192, 168, 77, 1], [255, 255, 255, 0]);
        let own = [wide, narrow, second, other];
        for (station, expected) in [
            ([10, 0, 0, 11], Some(wide)),
            ([10, 0, 5, 11], Some(narrow)),
            ([192, 168, 77, 11], Some(other)),
            ([192, 168, 5, 11], None),
        ] {
            assert_eq!(towards(&own, station.into()), expected, "{station:?}");
        }
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn an_unknown_name_lists_the_known_ones() {
        let error = InterfaceInfo::find("no-such-0").unwrap_err();
        assert_eq!(error.to_string(), "there is no network interface `no-such-0`");
        assert!(error.hint().unwrap().contains("lo"));
    }
}

//! The interfaces of this computer.

use std::collections::BTreeMap;
use std::ffi::CStr;
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
    /// All interfaces, by name.
    ///
    /// # Errors
    /// When the operating system does not tell.
    pub fn list() -> Result<Vec<Self>, Error> {
        let mut found: BTreeMap<String, Self> = BTreeMap::new();
        let mut list: *mut libc::ifaddrs = std::ptr::null_mut();
        // SAFETY: `list` is a valid place for the result; it is freed below exactly once.
        if unsafe { libc::getifaddrs(&raw mut list) } != 0 {
            return Err(Error::system("cannot list the network interfaces")(
                std::io::Error::last_os_error(),
            ));
        }
        let mut next = list;
        // SAFETY: every non-null `ifa_next` of the list getifaddrs made points to a valid entry until freeifaddrs.
        while let Some(entry) = unsafe { next.as_ref() } {
            next = entry.ifa_next;
            // SAFETY: `ifa_name` is a NUL-terminated string that lives as long as the list.
            let label = unsafe { CStr::from_ptr(entry.ifa_name) }.to_string_lossy();
            // an address may carry a label of its own, `eth0:1`; no interface has a colon in its name
            let name = label.split(':').next().unwrap_or_default().to_owned();
            let flags = entry.ifa_flags as i32;
            let info = found.entry(name.clone()).or_insert_with(|| Self {
                name,
                index: 0,
                mac: None,
                addresses: Vec::new(),
                up: flags & libc::IFF_UP != 0,
                loopback: flags & libc::IFF_LOOPBACK != 0,
            });
            // SAFETY: `ifa_addr` is null or points to a socket address whose family says its real type.
            match unsafe { entry.ifa_addr.as_ref() }.map(|address| i32::from(address.sa_family)) {
                Some(libc::AF_PACKET) => {
                    // SAFETY: AF_PACKET addresses are `sockaddr_ll`; read unaligned because only `sockaddr` is promised.
                    let link: libc::sockaddr_ll =
                        unsafe { entry.ifa_addr.cast::<libc::sockaddr_ll>().read_unaligned() };
                    info.index = link.sll_ifindex as u32;
                    if link.sll_hatype == libc::ARPHRD_ETHER && link.sll_halen == 6 {
                        let [a, b, c, d, e, f, ..] = link.sll_addr;
                        info.mac = Some(MacAddress([a, b, c, d, e, f]));
                    }
                }
                Some(libc::AF_INET) => {
                    info.addresses.push(IpSuite {
                        address: ipv4(entry.ifa_addr),
                        mask: ipv4(entry.ifa_netmask),
                        gateway: Ipv4Addr::UNSPECIFIED,
                    });
                }
                _ => {}
            }
        }
        // SAFETY: `list` came from getifaddrs and no reference into it is left.
        unsafe { libc::freeifaddrs(list) };
        Ok(found.into_values().collect())
    }

    /// The interface `name`, up or down.
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

    /// The Ethernet address, if the interface is up and an Ethernet interface.
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

    /// The first IPv4 address, [`IpSuite::NONE`] if there is none.
    ///
    /// An interface may have several; which of them leads to a station is [`InterfaceInfo::ip_towards`].
    #[must_use]
    pub fn ip(&self) -> IpSuite {
        self.addresses.first().copied().unwrap_or_default()
    }

    /// The address in the subnet of `other`, in the smallest one where several contain it.
    #[must_use]
    pub fn ip_towards(&self, other: Ipv4Addr) -> Option<IpSuite> {
        towards(&self.addresses, other)
    }

    /// Whether `address` is one of the interface's own.
    #[must_use]
    pub fn owns(&self, address: Ipv4Addr) -> bool {
        self.addresses.iter().any(|own| own.address == address)
    }
}

/// Which of several own addresses has `other` in its subnet; the longest mask wins, as in a routing table.
pub(super) fn towards(own: &[IpSuite], other: Ipv4Addr) -> Option<IpSuite> {
    let near = own.iter().copied().filter(|own| own.is_local(other));
    // of equals the first: the kernel lists the main address before the others
    near.rev().max_by_key(|own| u32::from(own.mask))
}

/// The IPv4 address in a socket address; 0.0.0.0 if there is none.
fn ipv4(address: *const libc::sockaddr) -> Ipv4Addr {
    // SAFETY: null, or a socket address of the list, valid for at least `sa_family`.
    match unsafe { address.as_ref() } {
        Some(any) if i32::from(any.sa_family) == libc::AF_INET => {
            // SAFETY: AF_INET addresses are `sockaddr_in`.
            let inet: libc::sockaddr_in = unsafe { address.cast::<libc::sockaddr_in>().read_unaligned() };
            Ipv4Addr::from(u32::from_be(inet.sin_addr.s_addr))
        }
        _ => Ipv4Addr::UNSPECIFIED,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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

    #[test]
    fn an_unknown_name_lists_the_known_ones() {
        let error = InterfaceInfo::find("no-such-0").unwrap_err();
        assert_eq!(error.to_string(), "there is no network interface `no-such-0`");
        assert!(error.hint().unwrap().contains("lo"));
    }
}

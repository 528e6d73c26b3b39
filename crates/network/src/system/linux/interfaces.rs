//! The network interfaces, as the kernel lists them.

use std::collections::BTreeMap;
use std::ffi::CStr;
use std::net::Ipv4Addr;

use profinet::{IpSuite, MacAddress};

use crate::system::{Error, InterfaceInfo};

/// Returns all interfaces, by name.
pub fn interfaces() -> Result<Vec<InterfaceInfo>, Error> {
    let mut found: BTreeMap<String, InterfaceInfo> = BTreeMap::new();
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
        let info = found.entry(name.clone()).or_insert_with(|| InterfaceInfo {
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

/// Returns the IPv4 address in a socket address; 0.0.0.0 if there is none.
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

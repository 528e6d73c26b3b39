//! This computer: permissions, its interface, its address, the port of the controller.

use std::time::Duration;

use client::Advice;
use network::ethernet;
use network::system::{InterfaceInfo, Link, Permissions, PortHolder, grant_raw_ethernet};
use profinet::RPC_PORT;

use crate::Explained;
use crate::open::OpenError;
use crate::report::{Check, Finding, Severity, Wording};

/// The slowest interface that PROFINET permits, in Mbit/s.
const SLOWEST: u32 = 100;
/// The largest packet of Ethernet: the records of PROFINET need it.
const MTU: u32 = 1500;
/// From here on held back frames matter to short update times.
const HELD_BACK: Duration = Duration::from_micros(250);

/// Examines this computer and returns the interface that was examined.
pub(super) fn examine(
    interface: Result<Option<String>, OpenError>,
    findings: &mut Vec<Finding>,
    wording: &dyn Wording,
) -> Option<String> {
    findings.push(permission(Permissions::own(), wording));
    let found = interface.and_then(|name| {
        let name = name.ok_or_else(OpenError::no_interface)?;
        Ok(InterfaceInfo::find(&name)?)
    });
    let info = match found {
        Ok(info) => info,
        Err(error) => {
            let finding = Finding::new(Check::Interface, Severity::Error, error.message());
            findings.push(finding.remedied(&error.advice(), wording));
            findings.push(port(PortHolder::of(RPC_PORT), None, wording));
            return None;
        }
    };
    let state = Finding::new(Check::Interface, Severity::Ok, format!("{} is up", info.name));
    findings.push(match info.usable() {
        Ok(_) => state,
        Err(error) => Finding::new(Check::Interface, Severity::Error, error.message())
            .remedied(&error.advice(), wording),
    });
    let link = Link::of(&info.name);
    findings.extend(of_link(&info, &link, wording));
    findings.push(address(&info, wording));
    findings.push(port(PortHolder::of(RPC_PORT), Some(&info), wording));
    Some(info.name)
}

fn permission(own: Option<Permissions>, wording: &dyn Wording) -> Finding {
    if !ethernet::AVAILABLE {
        let found =
            "this program has no raw Ethernet: it was not built for Linux with the feature raw-ethernet";
        return Finding::new(Check::Permission, Severity::Warning, found)
            .because("without raw Ethernet there is no discovery and no cyclic data");
    }
    match own {
        Some(own) if own.raw && own.first => Finding::new(
            Check::Permission,
            Severity::Ok,
            "raw Ethernet is permitted, and that frames go before other programs",
        ),
        Some(own) if own.raw => {
            let advice = format!("permit it once: {}", grant_raw_ethernet());
            Finding::new(
                Check::Permission,
                Severity::Note,
                "raw Ethernet is permitted, but not that frames go before other programs (CAP_SYS_NICE)",
            )
            .because("while other programs compute, frames are late, and connections end by their watchdogs")
            .remedied(&Advice::from(advice), wording)
        }
        None => Finding::new(
            Check::Permission,
            Severity::Unchecked,
            "the system does not report it",
        ),
        Some(_) => {
            let advice = format!("run as root, or permit it once: {}", grant_raw_ethernet());
            Finding::new(Check::Permission, Severity::Error, "raw Ethernet (CAP_NET_RAW) is not permitted")
                .because("without raw Ethernet there is no discovery and no cyclic data; drives given by their IP address can be read and written")
                .remedied(&Advice::from(advice), wording)
        }
    }
}

fn of_link(info: &InterfaceInfo, link: &Link, wording: &dyn Wording) -> Vec<Finding> {
    let name = &info.name;
    if !info.up {
        let found = format!("{name} is down: carrier and speed are not known");
        return vec![Finding::new(Check::Carrier, Severity::Unchecked, found)];
    }
    let mut findings = vec![match link.carrier {
        Some(true) => Finding::new(Check::Carrier, Severity::Ok, format!("{name} has a carrier")),
        Some(false) => Finding::new(Check::Carrier, Severity::Error, format!("{name} has no carrier"))
            .because("no frame leaves this computer")
            .remedied(
                &Advice::from("check the cable and the power of the switch or drive at its other end"),
                wording,
            ),
        None => Finding::new(
            Check::Carrier,
            Severity::Unchecked,
            "the system does not report it",
        ),
    }];
    if link.carrier == Some(true) {
        findings.push(speed(link, wording));
    }
    if let Some(mtu) = link.mtu {
        let found = format!("{mtu} octets");
        findings.push(match mtu < MTU {
            false => Finding::new(Check::Mtu, Severity::Ok, found),
            true => Finding::new(Check::Mtu, Severity::Warning, found)
                .because("PROFINET needs frames of 1500 octets: connections and long records fail")
                .remedied(&format!("ip link set {name} mtu 1500").into(), wording),
        });
    }
    findings.push(offload(name, link, wording));
    findings
}

fn speed(link: &Link, wording: &dyn Wording) -> Finding {
    let duplex = link.full_duplex.map_or("", |full| match full {
        true => ", full duplex",
        false => ", half duplex",
    });
    let found = match link.speed {
        Some(speed) => format!("{speed} Mbit/s{duplex}"),
        None => {
            return Finding::new(
                Check::Speed,
                Severity::Unchecked,
                "the interface does not report it",
            );
        }
    };
    if link.full_duplex != Some(false) && link.speed.is_none_or(|speed| speed >= SLOWEST) {
        return Finding::new(Check::Speed, Severity::Ok, found);
    }
    Finding::new(Check::Speed, Severity::Warning, found)
        .because("PROFINET needs 100 Mbit/s full duplex; half duplex loses frames by collisions")
        .remedied(
            &Advice::from("let both ends negotiate their speed; replace a hub by a switch"),
            wording,
        )
}

/// Merging of segments concerns TCP and does not touch PROFINET frames; what holds frames back concerns all.
fn offload(name: &str, link: &Link, wording: &dyn Wording) -> Finding {
    let on = |what: Option<bool>| match what {
        Some(true) => "on",
        Some(false) => "off",
        None => "not reported",
    };
    let held = link.holds_back.unwrap_or_default();
    let adaptive = link.adaptive == Some(true);
    let held_text = match link.holds_back {
        None => "not reported".to_owned(),
        Some(_) if adaptive => "adaptive".to_owned(),
        Some(held) => format!("{} us", held.as_micros()),
    };
    let found = format!(
        "GRO {}, LRO {}, interrupt coalescing {held_text}",
        on(link.merges),
        on(link.merges_in_hardware)
    );
    if held >= HELD_BACK {
        let advice = format!("ethtool -C {name} adaptive-rx off rx-usecs 0");
        return Finding::new(Check::Offload, Severity::Warning, found)
            .because("the interface holds each received frame back for that time: answers and cyclic data are late")
            .remedied(&advice.into(), wording);
    }
    if link.merges_in_hardware == Some(true) {
        return Finding::new(Check::Offload, Severity::Note, found)
            .because("LRO holds frames of TCP back and is of no use for PROFINET")
            .remedied(&format!("ethtool -K {name} lro off").into(), wording);
    }
    Finding::new(Check::Offload, Severity::Ok, found)
}

fn address(info: &InterfaceInfo, wording: &dyn Wording) -> Finding {
    if info.addresses.is_empty() {
        let error = network::system::Error::NoAddress {
            interface: info.name.clone(),
        };
        return Finding::new(Check::Address, Severity::Error, error.message())
            .because("drives can be found, named and addressed, but not read or run")
            .remedied(&error.advice(), wording);
    }
    let all: Vec<String> = info
        .addresses
        .iter()
        .map(|own| crate::reach::shown(*own))
        .collect();
    Finding::new(
        Check::Address,
        Severity::Ok,
        format!("{} has {}", info.name, all.join(", ")),
    )
}

fn port(holders: Option<Vec<PortHolder>>, info: Option<&InterfaceInfo>, wording: &dyn Wording) -> Finding {
    let Some(holders) = holders else {
        return Finding::new(
            Check::Port,
            Severity::Unchecked,
            "the system does not report who has UDP port 34964",
        );
    };
    let here = |one: &&PortHolder| {
        let own = |info: &InterfaceInfo| info.owns(one.address) || one.address.is_unspecified();
        info.is_none_or(own)
    };
    let holders: Vec<String> = holders.iter().filter(here).map(held_by).collect();
    if holders.is_empty() {
        return Finding::new(Check::Port, Severity::Ok, "UDP port 34964 is free");
    }
    Finding::new(
        Check::Port,
        Severity::Warning,
        format!("UDP port 34964 is in use: {}", holders.join(", ")),
    )
    .because("devices call their controller on this port: nothing here can have a cyclic connection meanwhile; drives can be read and written")
    .remedied(&Advice::from("end the other controller or engineering tool before an axis is moved from here"), wording)
}

/// `10.0.0.1 by codesys (process 812)`
fn held_by(holder: &PortHolder) -> String {
    let address = if holder.address.is_unspecified() {
        "all addresses".to_owned()
    } else {
        holder.address.to_string()
    };
    format!("{address} by {holder}")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::PlainWording;
    use std::net::Ipv4Addr;

    fn info() -> InterfaceInfo {
        InterfaceInfo {
            name: "eth7".into(),
            index: 7,
            mac: None,
            addresses: Vec::new(),
            up: true,
            loopback: false,
        }
    }

    fn severity(link: Link, check: Check) -> Option<Severity> {
        let found = of_link(&info(), &link, &PlainWording);
        found
            .iter()
            .find(|one| one.check == check)
            .map(|one| one.severity)
    }

    #[test]
    fn a_link_is_judged_by_what_profinet_needs() {
        let good = Link {
            carrier: Some(true),
            speed: Some(1000),
            full_duplex: Some(true),
            mtu: Some(1500),
            holds_back: Some(Duration::from_micros(20)),
            ..Link::default()
        };
        for check in [Check::Carrier, Check::Speed, Check::Mtu, Check::Offload] {
            assert_eq!(severity(good, check), Some(Severity::Ok), "{check:?}");
        }
        for (link, check, expected) in [
            (
                Link {
                    carrier: Some(false),
                    ..good
                },
                Check::Carrier,
                Severity::Error,
            ),
            (
                Link {
                    carrier: None,
                    ..good
                },
                Check::Carrier,
                Severity::Unchecked,
            ),
            (
                Link {
                    speed: Some(10),
                    ..good
                },
                Check::Speed,
                Severity::Warning,
            ),
            (Link { speed: None, ..good }, Check::Speed, Severity::Unchecked),
            (
                Link {
                    full_duplex: Some(false),
                    ..good
                },
                Check::Speed,
                Severity::Warning,
            ),
            (
                Link {
                    mtu: Some(1499),
                    ..good
                },
                Check::Mtu,
                Severity::Warning,
            ),
            (
                Link {
                    holds_back: Some(HELD_BACK),
                    ..good
                },
                Check::Offload,
                Severity::Warning,
            ),
            (
                Link {
                    merges_in_hardware: Some(true),
                    ..good
                },
                Check::Offload,
                Severity::Note,
            ),
        ] {
            assert_eq!(severity(link, check), Some(expected), "{link:?}");
        }
        assert_eq!(
            severity(
                Link {
                    carrier: Some(false),
                    ..good
                },
                Check::Speed
            ),
            None
        );
    }

    #[test]
    fn a_missing_permission_and_a_missing_address_have_a_remedy() {
        let none = Permissions {
            raw: false,
            admin: true,
            first: false,
        };
        if ethernet::AVAILABLE {
            let finding = permission(Some(none), &PlainWording);
            assert_eq!(finding.severity, Severity::Error);
            assert!(
                finding
                    .remedy
                    .unwrap()
                    .contains("setcap cap_net_raw,cap_sys_nice+ep /")
            );
        }
        let finding = address(&info(), &PlainWording);
        assert_eq!(finding.severity, Severity::Error);
        assert!(finding.remedy.unwrap().contains("dev eth7"));
    }

    #[test]
    fn only_who_has_the_port_of_this_interface_matters() {
        let holder = |address: [u8; 4]| PortHolder {
            address: address.into(),
            process: Some(812),
            program: Some("codesys".into()),
        };
        let own = profinet::IpSuite {
            address: Ipv4Addr::new(10, 0, 0, 1),
            ..profinet::IpSuite::NONE
        };
        let info = InterfaceInfo {
            addresses: vec![own],
            ..info()
        };
        let of = |address| port(Some(vec![holder(address)]), Some(&info), &PlainWording);
        assert_eq!(of([10, 0, 0, 2]).severity, Severity::Ok);
        assert_eq!(
            of([10, 0, 0, 1]).found,
            "UDP port 34964 is in use: 10.0.0.1 by codesys (process 812)"
        );
        assert_eq!(of([0, 0, 0, 0]).severity, Severity::Warning);
        assert_eq!(port(None, None, &PlainWording).severity, Severity::Unchecked);
    }
}

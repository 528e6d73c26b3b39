//! Whether a drive and this computer can exchange IP packets, checked before any request is sent.

use std::net::Ipv4Addr;

use profinet::IpSuite;

/// Whether both sides can reach each other, by their addresses.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Reach {
    /// One subnet, or nothing known against it.
    Near,
    /// Two subnets; a router may lead from one to the other. In words.
    Routed(String),
}

/// Two subnets and no gateway: no answer can come.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{}: two subnets, and the drive has no gateway: no answer can come", both(.interface, .own, .drive, *.station))]
pub struct OtherSubnet {
    /// The drive as it is called.
    pub drive: String,
    /// Its address.
    pub station: IpSuite,
    /// The interface of this computer.
    pub interface: String,
    /// Its addresses.
    pub own: Vec<IpSuite>,
}

impl OtherSubnet {
    /// Returns the subnet of this computer, in which the drive needs an address: `10.0.0.0/24`.
    #[must_use]
    pub fn own_subnet(&self) -> String {
        self.own.first().copied().map(subnet).unwrap_or_default()
    }

    /// Returns the subnet of the drive.
    #[must_use]
    pub fn subnet(&self) -> String {
        subnet(self.station)
    }

    /// Prefix length of the subnet of the drive.
    #[must_use]
    pub fn prefix(&self) -> u32 {
        prefix(self.station)
    }
}

/// `akd-1 has 192.168.5.11/24, eth0 has 10.0.0.1/24`
fn both(interface: &str, own: &[IpSuite], label: &str, drive: IpSuite) -> String {
    let ours: Vec<String> = own.iter().copied().map(shown).collect();
    format!(
        "{label} has {}, {interface} has {}",
        shown(drive),
        ours.join(", ")
    )
}

/// Compares the addresses of `interface` with that of a drive, which answers only where its mask or a gateway leads.
///
/// # Errors
/// Two subnets and no gateway: no answer can come. With both subnets and what to change.
pub fn reach(interface: &str, own: &[IpSuite], label: &str, drive: IpSuite) -> Result<Reach, OtherSubnet> {
    let answers = |own: &IpSuite| drive.is_local(own.address);
    if own.is_empty() || !drive.is_set() || own.iter().any(|own| answers(own) && own.is_local(drive.address))
    {
        return Ok(Reach::Near);
    }
    if own.iter().any(answers) || !drive.gateway.is_unspecified() {
        let both = both(interface, own, label, drive);
        return Ok(Reach::Routed(format!(
            "{both}: two subnets, it takes a router between them"
        )));
    }
    Err(OtherSubnet {
        drive: label.to_owned(),
        station: drive,
        interface: interface.to_owned(),
        own: own.to_vec(),
    })
}

/// Returns a word on an address that no subnet of this computer contains.
#[must_use]
pub fn far(own: &[IpSuite], address: Ipv4Addr) -> Option<String> {
    // nothing is known of a computer that does not list its addresses
    let near = own.is_empty() || own.iter().any(|own| own.is_local(address));
    (!near).then(|| {
        let ours: Vec<String> = own.iter().copied().map(subnet).collect();
        format!(
            "{address} is in no subnet of this computer ({}): it takes a router to get there",
            ours.join(", ")
        )
    })
}

fn prefix(ip: IpSuite) -> u32 {
    u32::from(ip.mask).leading_ones()
}

pub(crate) fn shown(ip: IpSuite) -> String {
    format!("{}/{}", ip.address, prefix(ip))
}

fn subnet(ip: IpSuite) -> String {
    let first = Ipv4Addr::from(u32::from(ip.address) & u32::from(ip.mask));
    format!("{first}/{}", prefix(ip))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn suite(address: [u8; 4], prefix: u32, gateway: [u8; 4]) -> IpSuite {
        let mask = u32::MAX.checked_shl(32 - prefix).unwrap_or_default();
        IpSuite {
            address: address.into(),
            mask: mask.into(),
            gateway: gateway.into(),
        }
    }

    const NONE: [u8; 4] = [0; 4];

    #[test]
    fn one_subnet_is_enough() {
        let own = [suite([10, 0, 0, 1], 24, NONE), suite([192, 168, 77, 1], 24, NONE)];
        for drive in [
            suite([10, 0, 0, 11], 24, NONE),
            suite([192, 168, 77, 11], 24, NONE),
            // found by its IP address alone: its mask is not known
            suite([10, 0, 0, 11], 0, NONE),
            IpSuite::NONE,
        ] {
            assert_eq!(reach("plc", &own, "akd-1", drive), Ok(Reach::Near), "{drive:?}");
        }
    }

    #[test]
    fn two_subnets_are_reported_with_both() {
        let own = [suite([10, 0, 0, 1], 24, NONE)];
        let error = reach("plc", &own, "akd-1", suite([192, 168, 5, 11], 24, NONE)).unwrap_err();
        assert_eq!(
            error.to_string(),
            "akd-1 has 192.168.5.11/24, plc has 10.0.0.1/24: two subnets, and the drive has no gateway: no answer can come"
        );
        assert_eq!(
            (error.own_subnet(), error.subnet(), error.prefix()),
            ("10.0.0.0/24".to_owned(), "192.168.5.0/24".to_owned(), 24)
        );
        // our mask contains the drive, but the drive's mask does not contain us
        assert!(reach("plc", &own, "akd-1", suite([10, 0, 0, 11], 30, NONE)).is_err());
    }

    #[test]
    fn where_a_router_may_lead_it_is_tried() {
        let own = [suite([10, 0, 0, 1], 24, NONE)];
        for drive in [
            suite([192, 168, 5, 11], 24, [192, 168, 5, 254]),
            // the drive finds us without a gateway; whether we find it is up to our routes
            suite([10, 0, 9, 11], 16, NONE),
        ] {
            assert!(
                matches!(reach("plc", &own, "akd-1", drive), Ok(Reach::Routed(words)) if words.contains("two subnets")),
                "{drive:?}"
            );
        }
    }

    #[test]
    fn an_address_in_no_subnet_is_far() {
        let own = [suite([10, 0, 0, 1], 24, NONE)];
        assert_eq!(far(&own, [10, 0, 0, 9].into()), None);
        assert!(far(&own, [10, 0, 1, 9].into()).is_some());
        assert_eq!(far(&[], [10, 0, 1, 9].into()), None);
    }
}

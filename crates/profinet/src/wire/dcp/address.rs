//! Which IP settings a station may take.

use core::net::Ipv4Addr;

use crate::IpSuite;

/// Why an IP setting is refused.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, thiserror::Error)]
pub enum IpRule {
    /// Loopback, multicast, class E or 0.x.
    #[error("{0} is not a valid address of a station")]
    Address(Ipv4Addr),
    /// Ones behind a zero, or no usable host part.
    #[error("{0} is not a valid subnet mask")]
    Mask(Ipv4Addr),
    /// The host part is all zero or all one.
    #[error("{0} is the subnet's own or broadcast address")]
    Host(Ipv4Addr),
    /// The gateway is outside the subnet.
    #[error("gateway {0} is outside the subnet")]
    Gateway(Ipv4Addr),
}

/// Checks address, mask and gateway. All zero means "delete the address" and is good. A gateway of 0.0.0.0 or equal
/// to the own address means none.
///
/// Source: IEC 61158-6-10, IPParameterValue.
///
/// # Errors
/// The first rule that is broken.
pub fn check_ip(suite: &IpSuite) -> Result<(), IpRule> {
    if *suite == IpSuite::NONE {
        return Ok(());
    }
    let IpSuite {
        address,
        mask,
        gateway,
    } = *suite;
    if address.is_loopback() || address.octets()[0] == 0 || address.octets()[0] >= 224 {
        return Err(IpRule::Address(address));
    }
    let bits = u32::from(mask);
    if bits.leading_ones() + bits.trailing_zeros() != 32 || bits == 0 || bits == u32::MAX {
        return Err(IpRule::Mask(mask));
    }
    let host = u32::from(address) & !bits;
    if host == 0 || host == !bits {
        return Err(IpRule::Host(address));
    }
    if !gateway.is_unspecified() && gateway != address && !suite.is_local(gateway) {
        return Err(IpRule::Gateway(gateway));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check(address: [u8; 4], mask: [u8; 4], gateway: [u8; 4]) -> Result<(), IpRule> {
        check_ip(&IpSuite {
            address: address.into(),
            mask: mask.into(),
            gateway: gateway.into(),
        })
    }

    #[test]
    fn rules() {
        const C: [u8; 4] = [255, 255, 255, 0];
        assert_eq!(check([0; 4], [0; 4], [0; 4]), Ok(()));
        assert_eq!(
            check([172, 16, 2, 10], C, [172, 16, 2, 10]),
            Ok(()),
            "own address as gateway"
        );
        assert_eq!(check([172, 16, 2, 10], C, [172, 16, 2, 1]), Ok(()));
        assert!(matches!(
            check([172, 16, 2, 10], C, [172, 16, 3, 1]),
            Err(IpRule::Gateway(_))
        ));
        assert!(matches!(check([172, 16, 2, 0], C, [0; 4]), Err(IpRule::Host(_))));
        assert!(matches!(
            check([172, 16, 2, 255], C, [0; 4]),
            Err(IpRule::Host(_))
        ));
        assert!(matches!(
            check([172, 16, 2, 1], [255, 0, 255, 0], [0; 4]),
            Err(IpRule::Mask(_))
        ));
        assert!(matches!(
            check([172, 16, 2, 1], [0; 4], [0; 4]),
            Err(IpRule::Mask(_))
        ));
        assert!(matches!(
            check([172, 16, 2, 1], [255; 4], [0; 4]),
            Err(IpRule::Mask(_))
        ));
        for bad in [[127, 0, 0, 1], [224, 0, 0, 1], [240, 0, 0, 1], [0, 0, 0, 1]] {
            assert!(matches!(check(bad, C, [0; 4]), Err(IpRule::Address(_))));
        }
        assert!(matches!(check([0; 4], C, [0; 4]), Err(IpRule::Address(_))));
    }
}

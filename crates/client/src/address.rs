//! How a person names a drive.

mod line;

use std::fmt;
use std::net::Ipv4Addr;
use std::str::FromStr;

use profinet::MacAddress;

pub use line::{LineAddress, Parity};

/// A station name, an IP address, a MAC address, or a place at a serial line.
///
/// ```
/// use profidrive_client::DriveAddress;
/// assert!(matches!("akd-1".parse()?, DriveAddress::Name(_)));
/// assert!(matches!("10.0.0.2".parse()?, DriveAddress::Ip(_)));
/// assert!(matches!("02:50:4e:00:00:01".parse()?, DriveAddress::Mac(_)));
/// assert!(matches!("fc:/dev/ttyUSB0/1".parse()?, DriveAddress::Line(_)));
/// # Ok::<(), profidrive_client::DriveAddressError>(())
/// ```
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub enum DriveAddress {
    /// Station name.
    Name(String),
    /// IP address.
    Ip(Ipv4Addr),
    /// MAC address.
    Mac(MacAddress),
    /// At a serial line.
    Line(LineAddress),
}

/// The text is not a station name, IP address, MAC address or place at a serial line.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("`{text}` names no drive: {reason}")]
pub struct DriveAddressError {
    /// The text as given.
    pub text: String,
    /// What is wrong with it.
    pub reason: &'static str,
}

impl FromStr for DriveAddress {
    type Err = DriveAddressError;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let text = text.trim();
        let wrong = |reason| DriveAddressError {
            text: text.to_owned(),
            reason,
        };
        if let Some(line) = LineAddress::parse(text) {
            return line.map(Self::Line);
        }
        if let Ok(mac) = text.parse::<MacAddress>() {
            let single = !mac.is_multicast() && mac != MacAddress::default();
            return if single {
                Ok(Self::Mac(mac))
            } else {
                Err(wrong("this MAC address belongs to no single station"))
            };
        }
        if let Ok(ip) = text.parse::<Ipv4Addr>() {
            let single = !(ip.is_unspecified() || ip.is_multicast() || ip.is_broadcast());
            return if single {
                Ok(Self::Ip(ip))
            } else {
                Err(wrong("this IP address belongs to no single station"))
            };
        }
        if text.is_empty() {
            return Err(wrong(
                "write a station name (akd-1), an IP address (10.0.0.2) or a MAC address",
            ));
        }
        if text.len() > 240 {
            return Err(wrong("a station name has at most 240 characters"));
        }
        let lower = text.to_ascii_lowercase();
        if !lower
            .bytes()
            .all(|b| b.is_ascii_lowercase() || b.is_ascii_digit() || matches!(b, b'-' | b'.'))
        {
            return Err(wrong(
                "a station name has lower case letters, digits, hyphens and dots only",
            ));
        }
        Ok(Self::Name(lower))
    }
}

impl fmt::Display for DriveAddress {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Name(name) => f.write_str(name),
            Self::Ip(ip) => ip.fmt(f),
            Self::Mac(mac) => mac.fmt(f),
            Self::Line(line) => line.fmt(f),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn three_ways_to_name_a_drive() {
        assert_eq!("AKD-1".parse(), Ok(DriveAddress::Name("akd-1".into())));
        assert_eq!(
            "10.0.0.2".parse(),
            Ok(DriveAddress::Ip(Ipv4Addr::new(10, 0, 0, 2)))
        );
        assert_eq!(
            "02-50-4E-00-00-01".parse(),
            Ok(DriveAddress::Mac(MacAddress([2, 0x50, 0x4E, 0, 0, 1])))
        );
        for text in [
            "",
            "a b",
            "0.0.0.0",
            "255.255.255.255",
            "ff:ff:ff:ff:ff:ff",
            "01:0e:cf:00:00:00",
            "akd_1",
        ] {
            assert!(text.parse::<DriveAddress>().is_err(), "{text}");
        }
    }
}

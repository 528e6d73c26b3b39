//! The address octet, in the three forms it has.

use core::fmt;

/// Whose meaning the address octet has.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Protocol {
    /// Slaves 0 to 31, broadcast, mirror and special telegrams.
    Uss,
    /// Danfoss FC: slaves 1 to 31 or, with bit 7, 1 to 126; broadcast in both forms.
    Fc,
}

/// Whom a telegram is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Addressee {
    /// One slave.
    Slave(u8),
    /// One slave, which sends the telegram back as it is.
    Mirror(u8),
    /// All slaves; none answers.
    Broadcast,
    /// A special telegram, of which nothing more is known.
    Special,
    /// No slave can have this address.
    Invalid,
}

/// The third octet of a telegram. A reply has that of its request.
/// Source: Siemens CU240S p. 178 (USS); Danfoss VLT 2800 design guide p. 108 (FC).
///
/// ```
/// use profidrive_uss::{Address, Addressee, Protocol};
/// assert_eq!(Address::fc(1).unwrap(), Address(0x81));
/// assert_eq!(Address(0x81).addressee(Protocol::Fc), Addressee::Slave(1));
/// assert_eq!(Address(0x80).addressee(Protocol::Fc), Addressee::Broadcast);
/// assert_eq!(Address(0x81).addressee(Protocol::Uss), Addressee::Special);
/// assert_eq!(Address::uss(31).unwrap().mirror(), Address(0x5F));
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Address(pub u8);

/// Long form of the FC protocol, special telegram of USS.
const LONG: u8 = 0x80;
/// Mirror telegram of USS.
const MIRROR: u8 = 0x40;
/// Broadcast, but for the long form.
const BROADCAST: u8 = 0x20;
/// The number, but for the long form.
const NUMBER: u8 = 0x1F;

impl Address {
    /// Broadcast of USS and of the short form of the FC protocol.
    pub const BROADCAST: Self = Self(BROADCAST);
    /// Broadcast of the long form of the FC protocol.
    pub const FC_BROADCAST: Self = Self(LONG);

    /// Returns a slave of USS, 0 to 31.
    #[must_use]
    pub const fn uss(number: u8) -> Option<Self> {
        if number <= 31 { Some(Self(number)) } else { None }
    }

    /// Returns a slave of the FC protocol in the long form, 1 to 126.
    #[must_use]
    pub const fn fc(number: u8) -> Option<Self> {
        if number >= 1 && number <= 126 {
            Some(Self(LONG | number))
        } else {
            None
        }
    }

    /// Returns a slave of the FC protocol in the short form, 1 to 31.
    #[must_use]
    pub const fn fc_short(number: u8) -> Option<Self> {
        if number >= 1 && number <= 31 {
            Some(Self(number))
        } else {
            None
        }
    }

    /// Returns the address with which a USS slave sends the telegram back as it is.
    #[must_use]
    pub const fn mirror(self) -> Self {
        Self(self.0 | MIRROR)
    }

    /// Whom it means.
    #[must_use]
    pub const fn addressee(self, protocol: Protocol) -> Addressee {
        let long = self.0 & LONG != 0;
        match protocol {
            Protocol::Uss if long => Addressee::Special,
            Protocol::Fc if long => match self.0 & !LONG {
                0 => Addressee::Broadcast,
                127 => Addressee::Invalid,
                number => Addressee::Slave(number),
            },
            _ if self.0 & BROADCAST != 0 => Addressee::Broadcast,
            Protocol::Uss if self.0 & MIRROR != 0 => Addressee::Mirror(self.0 & NUMBER),
            Protocol::Uss => Addressee::Slave(self.0 & NUMBER),
            Protocol::Fc => match self.0 & NUMBER {
                0 => Addressee::Invalid,
                number => Addressee::Slave(number),
            },
        }
    }
}

impl fmt::Display for Address {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "0x{:02X}", self.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_octet_means_what_the_manuals_say() {
        for octet in 0..=255 {
            let address = Address(octet);
            let fc = match octet {
                0x80 => Addressee::Broadcast,
                0xFF => Addressee::Invalid,
                0x81.. => Addressee::Slave(octet - 0x80),
                _ if octet & 0x20 != 0 => Addressee::Broadcast,
                _ if octet & 0x1F == 0 => Addressee::Invalid,
                _ => Addressee::Slave(octet & 0x1F),
            };
            assert_eq!(address.addressee(Protocol::Fc), fc, "{address}");
            let uss = match octet {
                0..=31 => Addressee::Slave(octet),
                0x40..=0x5F => Addressee::Mirror(octet - 0x40),
                0x20..=0x3F | 0x60..=0x7F => Addressee::Broadcast,
                _ => Addressee::Special,
            };
            assert_eq!(address.addressee(Protocol::Uss), uss, "{address}");
        }
    }

    #[test]
    fn numbers_out_of_range_have_no_address() {
        assert_eq!(
            (Address::uss(32), Address::fc(0), Address::fc(127)),
            (None, None, None)
        );
        assert_eq!((Address::fc_short(0), Address::fc_short(32)), (None, None));
        assert!((1..=126).all(|n| Address::fc(n).unwrap().addressee(Protocol::Fc) == Addressee::Slave(n)));
    }
}

//! A drive at a serial line: `fc:/dev/ttyUSB0/1`.

use std::fmt;

use uss::{Address, Protocol};

use super::DriveAddressError;

/// Parity of the characters on a line.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Parity {
    /// The usual of both protocols, 8E1.
    #[default]
    Even,
    /// 8O1.
    Odd,
    /// 8N1.
    None,
}

impl Parity {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Even, Self::Odd, Self::None];

    /// As it is written.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Even => "even",
            Self::Odd => "odd",
            Self::None => "none",
        }
    }
}

/// Where a drive is at a serial line: `fc:PORT/ADDRESS` or `uss:PORT/ADDRESS`, with `,baud=19200` and `,parity=none`
/// where they are not 9600 and even.
///
/// ```
/// use profidrive_client::{LineAddress, Parity};
/// let drive = LineAddress::parse("uss:/dev/ttyUSB0/3,baud=19200").unwrap()?;
/// assert_eq!((drive.port.as_str(), drive.number), ("/dev/ttyUSB0", 3));
/// assert_eq!((drive.baud, drive.parity), (19_200, Parity::Even));
/// assert_eq!(drive.to_string(), "uss:/dev/ttyUSB0/3,baud=19200");
/// # Ok::<(), profidrive_client::DriveAddressError>(())
/// ```
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub struct LineAddress {
    /// Danfoss FC protocol, or USS.
    pub protocol: Protocol,
    /// The serial port: a path, or the name of a file in `/dev`.
    pub port: String,
    /// Address of the drive.
    pub number: u8,
    /// Bits per second.
    pub baud: u32,
    /// Parity.
    pub parity: Parity,
}

/// The usual speed of both protocols.
const BAUD: u32 = 9600;

impl LineAddress {
    /// From text that begins with `fc:` or `uss:`; `None` for any other.
    ///
    /// # Errors
    /// When port, address or a setting is missing or cannot be.
    #[must_use]
    pub fn parse(text: &str) -> Option<Result<Self, DriveAddressError>> {
        let (scheme, rest) = text.split_once(':')?;
        let protocol = match scheme.to_ascii_lowercase().as_str() {
            "fc" => Protocol::Fc,
            "uss" => Protocol::Uss,
            _ => return None,
        };
        Some(Self::of(protocol, rest).map_err(|reason| DriveAddressError {
            text: text.to_owned(),
            reason,
        }))
    }

    fn of(protocol: Protocol, rest: &str) -> Result<Self, &'static str> {
        let (place, settings) = rest.split_once([',', '?']).unwrap_or((rest, ""));
        let (port, number) = place
            .rsplit_once('/')
            .filter(|(port, _)| !port.is_empty())
            .ok_or("write PORT/ADDRESS behind it, for example fc:/dev/ttyUSB0/1")?;
        let wrong = match protocol {
            Protocol::Fc => "the address behind the last / is a number from 1 to 126",
            Protocol::Uss => "the address behind the last / is a number from 0 to 31",
        };
        let number: u8 = number.parse().map_err(|_| wrong)?;
        let exists = match protocol {
            Protocol::Fc => Address::fc(number),
            Protocol::Uss => Address::uss(number),
        };
        exists.ok_or(wrong)?;
        let mut address = Self {
            protocol,
            port: Self::path(port),
            number,
            baud: BAUD,
            parity: Parity::default(),
        };
        for setting in settings.split([',', '&']).filter(|setting| !setting.is_empty()) {
            match setting.split_once('=') {
                Some(("baud", rate)) => {
                    address.baud = rate
                        .parse()
                        .ok()
                        .filter(|rate| (1200..=4_000_000).contains(rate))
                        .ok_or("baud is a number of bits per second, for example 9600, 19200 or 115200")?;
                }
                Some(("parity", name)) => {
                    address.parity = Parity::ALL
                        .into_iter()
                        .find(|parity| parity.name() == name)
                        .ok_or("parity is even, odd or none")?;
                }
                _ => return Err("behind the address only baud=9600 and parity=even, odd or none can follow"),
            }
        }
        Ok(address)
    }

    /// Returns the file of a serial port: `ttyUSB0` is `/dev/ttyUSB0`.
    #[must_use]
    pub fn path(port: &str) -> String {
        if port.contains('/') {
            port.to_owned()
        } else {
            format!("/dev/{port}")
        }
    }
}

impl fmt::Display for LineAddress {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let scheme = match self.protocol {
            Protocol::Fc => "fc",
            Protocol::Uss => "uss",
        };
        write!(f, "{scheme}:{}/{}", self.port, self.number)?;
        if self.baud != BAUD {
            write!(f, ",baud={}", self.baud)?;
        }
        if self.parity != Parity::default() {
            write!(f, ",parity={}", self.parity.name())?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn as_it_is_written_it_comes_back() {
        for text in [
            "fc:/dev/ttyUSB0/1",
            "fc:/dev/ttyS0/126,baud=115200,parity=none",
            "uss:/dev/serial/by-id/usb-FTDI-if00/0,parity=odd",
        ] {
            let address = LineAddress::parse(text).unwrap().unwrap();
            assert_eq!(address.to_string(), text);
        }
        // as people write addresses with settings elsewhere
        let query = LineAddress::parse("FC:ttyUSB0/1?baud=19200&parity=none")
            .unwrap()
            .unwrap();
        assert_eq!(query.to_string(), "fc:/dev/ttyUSB0/1,baud=19200,parity=none");
    }

    #[test]
    fn mistakes_are_reported() {
        for (text, words) in [
            ("fc:", "PORT/ADDRESS"),
            ("fc:/1", "PORT/ADDRESS"),
            ("fc:/dev/ttyUSB0", "1 to 126"),
            ("fc:/dev/ttyUSB0/0", "1 to 126"),
            ("fc:/dev/ttyUSB0/127", "1 to 126"),
            ("uss:/dev/ttyUSB0/32", "0 to 31"),
            ("fc:/dev/ttyUSB0/1,baud=fast", "bits per second"),
            ("fc:/dev/ttyUSB0/1,parity=mark", "even, odd or none"),
            ("fc:/dev/ttyUSB0/1,speed=1", "can follow"),
        ] {
            let error = LineAddress::parse(text).unwrap().unwrap_err();
            assert!(error.to_string().contains(words), "{text}: {error}");
        }
        assert_eq!(LineAddress::parse("akd-1"), None);
        assert_eq!(LineAddress::parse("02:50:4e:00:00:01"), None);
    }
}

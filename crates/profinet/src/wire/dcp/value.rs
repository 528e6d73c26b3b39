//! What a DCP block carries.

use core::net::Ipv4Addr;

use super::code::DcpOption;
use crate::wire::{DecodeError, Problem, Reader, Writer};
use crate::{IpSuite, MacAddress};

/// The value of one block, without BlockInfo and BlockQualifier.
///
/// Source: IEC 61158-6-10, DCP blocks. Names and texts are octets: a sender may put anything there, see
/// [`check_name`](super::check_name).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Value<'a> {
    /// 1/1.
    Mac(MacAddress),
    /// 1/2.
    Ip(IpSuite),
    /// 1/3.
    FullIp {
        /// Address, mask, gateway.
        suite: IpSuite,
        /// DNS servers.
        dns: [Ipv4Addr; 4],
    },
    /// 2/1 type of station, ASCII.
    StationType(&'a [u8]),
    /// 2/2 name of station, ASCII; empty for none.
    Name(&'a [u8]),
    /// 2/3.
    DeviceId {
        /// Vendor.
        vendor: u16,
        /// Device.
        device: u16,
    },
    /// 2/4 bits of [`role`](super::role).
    Role(u8),
    /// 2/5 pairs of option and suboption.
    Options(&'a [u8]),
    /// 2/6 `port.station` of the neighbour.
    Alias(&'a [u8]),
    /// 2/7.
    Instance(u16),
    /// 2/8.
    OemDeviceId {
        /// Vendor.
        vendor: u16,
        /// Device.
        device: u16,
    },
    /// 5/3; 0x0100 is flash.
    Signal(u16),
    /// 6/1; 1 sends Hello.
    Initiative(u16),
    /// No octets: 5/1, 5/2, 5/5, 5/6, 255/255.
    Empty(DcpOption),
    /// An option without a form here.
    Other(DcpOption, &'a [u8]),
}

/// Signal value: flash an LED.
const FLASH: u16 = 0x0100;

impl<'a> Value<'a> {
    /// Blink.
    pub const FLASH: Self = Self::Signal(FLASH);
    /// All options.
    pub const ALL: Self = Self::Empty(DcpOption::ALL);

    /// Reads the octets of an option: all that the reader has left.
    ///
    /// # Errors
    /// When an option of fixed length has another one, or a list of pairs is odd.
    pub fn decode(option: DcpOption, mut r: Reader<'a>) -> Result<Self, DecodeError> {
        let value = match option {
            DcpOption::MAC => Self::Mac(MacAddress(r.array("DCP MAC address")?)),
            DcpOption::IP => Self::Ip(suite(&mut r)?),
            DcpOption::FULL_IP => {
                let suite = suite(&mut r)?;
                let mut dns = [Ipv4Addr::UNSPECIFIED; 4];
                for server in &mut dns {
                    *server = Ipv4Addr::from(r.array::<4>("DCP DNS server")?);
                }
                Self::FullIp { suite, dns }
            }
            DcpOption::STATION_TYPE => Self::StationType(r.rest("station type")),
            DcpOption::NAME => Self::Name(r.rest("name of station")),
            DcpOption::DEVICE_ID => Self::DeviceId {
                vendor: r.u16("DCP vendor id")?,
                device: r.u16("DCP device id")?,
            },
            DcpOption::ROLE => {
                let role = r.u8("DCP role")?;
                r.skip(1, "DCP role reserved")?;
                Self::Role(role)
            }
            DcpOption::OPTIONS => {
                let list = r.rest("device options");
                if list.len() % 2 == 1 {
                    return Err(r.error("DCP device options", 1, Problem::Trailing { count: 1 }));
                }
                Self::Options(list)
            }
            DcpOption::ALIAS => Self::Alias(r.rest("alias name")),
            DcpOption::INSTANCE => Self::Instance(r.u16("DCP instance")?),
            DcpOption::OEM_DEVICE_ID => Self::OemDeviceId {
                vendor: r.u16("DCP vendor id")?,
                device: r.u16("DCP device id")?,
            },
            DcpOption::SIGNAL => Self::Signal(r.u16("DCP signal")?),
            DcpOption::INITIATIVE => Self::Initiative(r.u16("DCP initiative")?),
            // some senders put two octets here
            DcpOption::ALL if r.remaining() == 2 => {
                r.rest("reserved");
                Self::ALL
            }
            DcpOption::START
            | DcpOption::END
            | DcpOption::FACTORY_RESET
            | DcpOption::RESET_TO_FACTORY
            | DcpOption::ALL => Self::Empty(option),
            other => Self::Other(other, r.rest("value")),
        };
        r.finish("DCP block value")?;
        Ok(value)
    }

    /// Returns the option of the value.
    #[must_use]
    pub const fn option(&self) -> DcpOption {
        match self {
            Self::Mac(_) => DcpOption::MAC,
            Self::Ip(_) => DcpOption::IP,
            Self::FullIp { .. } => DcpOption::FULL_IP,
            Self::StationType(_) => DcpOption::STATION_TYPE,
            Self::Name(_) => DcpOption::NAME,
            Self::DeviceId { .. } => DcpOption::DEVICE_ID,
            Self::Role(_) => DcpOption::ROLE,
            Self::Options(_) => DcpOption::OPTIONS,
            Self::Alias(_) => DcpOption::ALIAS,
            Self::Instance(_) => DcpOption::INSTANCE,
            Self::OemDeviceId { .. } => DcpOption::OEM_DEVICE_ID,
            Self::Signal(_) => DcpOption::SIGNAL,
            Self::Initiative(_) => DcpOption::INITIATIVE,
            Self::Empty(option) | Self::Other(option, _) => *option,
        }
    }

    /// Writes the octets.
    pub fn encode(&self, out: &mut impl Writer) {
        match self {
            Self::Mac(mac) => out.bytes(&mac.0),
            Self::Ip(suite) => put_suite(out, suite),
            Self::FullIp { suite, dns } => {
                put_suite(out, suite);
                for server in dns {
                    out.bytes(&server.octets());
                }
            }
            Self::StationType(text)
            | Self::Name(text)
            | Self::Options(text)
            | Self::Alias(text)
            | Self::Other(_, text) => out.bytes(text),
            Self::DeviceId { vendor, device } | Self::OemDeviceId { vendor, device } => {
                out.u16(*vendor);
                out.u16(*device);
            }
            Self::Role(role) => out.bytes(&[*role, 0]),
            Self::Instance(n) | Self::Signal(n) | Self::Initiative(n) => out.u16(*n),
            Self::Empty(_) => {}
        }
    }
}

fn suite(r: &mut Reader<'_>) -> Result<IpSuite, DecodeError> {
    Ok(IpSuite {
        address: Ipv4Addr::from(r.array::<4>("DCP IP address")?),
        mask: Ipv4Addr::from(r.array::<4>("DCP subnet mask")?),
        gateway: Ipv4Addr::from(r.array::<4>("DCP gateway")?),
    })
}

fn put_suite(out: &mut impl Writer, suite: &IpSuite) {
    out.bytes(&suite.address.octets());
    out.bytes(&suite.mask.octets());
    out.bytes(&suite.gateway.octets());
}

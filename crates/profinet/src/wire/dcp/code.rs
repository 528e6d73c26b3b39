//! Codes of DCP: services, options, errors, qualifiers.

use core::fmt;

/// ServiceID: what a PDU does.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum ServiceId {
    /// Read settings, 3.
    Get,
    /// Change settings, 4.
    Set,
    /// Find stations, 5.
    Identify,
    /// A station announces itself, 6.
    Hello,
    /// Any other number.
    Other(u8),
}

impl From<u8> for ServiceId {
    fn from(code: u8) -> Self {
        match code {
            3 => Self::Get,
            4 => Self::Set,
            5 => Self::Identify,
            6 => Self::Hello,
            other => Self::Other(other),
        }
    }
}

impl From<ServiceId> for u8 {
    fn from(service: ServiceId) -> Self {
        match service {
            ServiceId::Get => 3,
            ServiceId::Set => 4,
            ServiceId::Identify => 5,
            ServiceId::Hello => 6,
            ServiceId::Other(other) => other,
        }
    }
}

/// ServiceType: request or kind of response.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum ServiceType {
    /// Request, 0.
    Request,
    /// Response, 1.
    Success,
    /// Response: this service is not supported, 5.
    NotSupported,
    /// Any other number.
    Other(u8),
}

impl From<u8> for ServiceType {
    fn from(code: u8) -> Self {
        match code {
            0 => Self::Request,
            1 => Self::Success,
            5 => Self::NotSupported,
            other => Self::Other(other),
        }
    }
}

impl From<ServiceType> for u8 {
    fn from(kind: ServiceType) -> Self {
        match kind {
            ServiceType::Request => 0,
            ServiceType::Success => 1,
            ServiceType::NotSupported => 5,
            ServiceType::Other(other) => other,
        }
    }
}

/// Option and suboption: what a block is about.
///
/// Source: IEC 61158-6-10, coding of the DCP options.
#[derive(Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct DcpOption {
    /// Group.
    pub option: u8,
    /// Member of the group.
    pub suboption: u8,
}

/// Names of the options; one row each.
const OPTIONS: &[(DcpOption, &str)] = &[
    (DcpOption::MAC, "MAC address"),
    (DcpOption::IP, "IP parameter"),
    (DcpOption::FULL_IP, "full IP suite"),
    (DcpOption::STATION_TYPE, "type of station"),
    (DcpOption::NAME, "name of station"),
    (DcpOption::DEVICE_ID, "device id"),
    (DcpOption::ROLE, "device role"),
    (DcpOption::OPTIONS, "device options"),
    (DcpOption::ALIAS, "alias name"),
    (DcpOption::INSTANCE, "device instance"),
    (DcpOption::OEM_DEVICE_ID, "OEM device id"),
    (DcpOption::RSI, "RSI properties"),
    (DcpOption::START, "start transaction"),
    (DcpOption::END, "end transaction"),
    (DcpOption::SIGNAL, "signal"),
    (DcpOption::RESPONSE, "response"),
    (DcpOption::FACTORY_RESET, "factory reset"),
    (DcpOption::RESET_TO_FACTORY, "reset to factory"),
    (DcpOption::INITIATIVE, "device initiative"),
    (DcpOption::ALL, "all selector"),
];

impl DcpOption {
    /// 1/1 MAC address.
    pub const MAC: Self = Self::new(1, 1);
    /// 1/2 address, mask, gateway.
    pub const IP: Self = Self::new(1, 2);
    /// 1/3 address, mask, gateway, four DNS servers.
    pub const FULL_IP: Self = Self::new(1, 3);
    /// 2/1 type of station.
    pub const STATION_TYPE: Self = Self::new(2, 1);
    /// 2/2 name of station.
    pub const NAME: Self = Self::new(2, 2);
    /// 2/3 vendor and device.
    pub const DEVICE_ID: Self = Self::new(2, 3);
    /// 2/4 role.
    pub const ROLE: Self = Self::new(2, 4);
    /// 2/5 list of supported options.
    pub const OPTIONS: Self = Self::new(2, 5);
    /// 2/6 alias name.
    pub const ALIAS: Self = Self::new(2, 6);
    /// 2/7 instance.
    pub const INSTANCE: Self = Self::new(2, 7);
    /// 2/8 vendor and device of the OEM.
    pub const OEM_DEVICE_ID: Self = Self::new(2, 8);
    /// 2/10 RSI properties.
    pub const RSI: Self = Self::new(2, 10);
    /// 5/1 start transaction.
    pub const START: Self = Self::new(5, 1);
    /// 5/2 end transaction.
    pub const END: Self = Self::new(5, 2);
    /// 5/3 signal: blink.
    pub const SIGNAL: Self = Self::new(5, 3);
    /// 5/4 result of a block.
    pub const RESPONSE: Self = Self::new(5, 4);
    /// 5/5 factory reset, the old form.
    pub const FACTORY_RESET: Self = Self::new(5, 5);
    /// 5/6 reset to factory with a mode.
    pub const RESET_TO_FACTORY: Self = Self::new(5, 6);
    /// 6/1 device initiative.
    pub const INITIATIVE: Self = Self::new(6, 1);
    /// 255/255, all options.
    pub const ALL: Self = Self::new(255, 255);

    /// From its two numbers.
    #[must_use]
    pub const fn new(option: u8, suboption: u8) -> Self {
        Self { option, suboption }
    }

    /// Both octets as one number.
    #[must_use]
    pub const fn number(self) -> u16 {
        u16::from_be_bytes([self.option, self.suboption])
    }

    /// Plain name; `None` for options without one here.
    #[must_use]
    pub fn name(self) -> Option<&'static str> {
        match OPTIONS.iter().find(|row| row.0 == self) {
            Some(row) => Some(row.1),
            None if self.option == 3 => Some("DHCP"),
            None => None,
        }
    }

    /// Returns the block error that refuses this option: the whole group is unknown, or only the member.
    #[must_use]
    pub const fn unsupported(self) -> BlockError {
        match self.option {
            1..=3 | 5 | 6 => BlockError::SuboptionUnsupported,
            _ => BlockError::OptionUnsupported,
        }
    }
}

impl fmt::Display for DcpOption {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{}", self.option, self.suboption)?;
        match self.name() {
            Some(name) => write!(f, " {name}"),
            None => Ok(()),
        }
    }
}

impl fmt::Debug for DcpOption {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Display::fmt(self, f)
    }
}

/// How a Set or Get of one block ended.
///
/// Source: IEC 61158-6-10, coding of the field BlockError.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum BlockError {
    /// 0.
    Ok,
    /// 1.
    OptionUnsupported,
    /// 2.
    SuboptionUnsupported,
    /// 3: wrong value or length.
    NotSet,
    /// 4.
    Resource,
    /// 5.
    LocalReasons,
    /// 6.
    InOperation,
    /// Any other number.
    Other(u8),
}

impl From<u8> for BlockError {
    fn from(code: u8) -> Self {
        match code {
            0 => Self::Ok,
            1 => Self::OptionUnsupported,
            2 => Self::SuboptionUnsupported,
            3 => Self::NotSet,
            4 => Self::Resource,
            5 => Self::LocalReasons,
            6 => Self::InOperation,
            other => Self::Other(other),
        }
    }
}

impl From<BlockError> for u8 {
    fn from(error: BlockError) -> Self {
        match error {
            BlockError::Ok => 0,
            BlockError::OptionUnsupported => 1,
            BlockError::SuboptionUnsupported => 2,
            BlockError::NotSet => 3,
            BlockError::Resource => 4,
            BlockError::LocalReasons => 5,
            BlockError::InOperation => 6,
            BlockError::Other(other) => other,
        }
    }
}

impl fmt::Display for BlockError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let text = match self {
            Self::Ok => "ok",
            Self::OptionUnsupported => "option not supported",
            Self::SuboptionUnsupported => "suboption not supported, or no such data",
            Self::NotSet => "not set: the value or its length is wrong",
            Self::Resource => "resource error",
            Self::LocalReasons => "set not possible for local reasons",
            Self::InOperation => "in operation, set not possible",
            Self::Other(code) => return write!(f, "unknown error {code}"),
        };
        f.write_str(text)
    }
}

/// Duration of a setting, or scope of a reset.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Qualifier(pub u16);

impl Qualifier {
    /// Until power-off; also clears what was stored.
    pub const TEMPORARY: Self = Self(0);
    /// For good.
    pub const PERMANENT: Self = Self(1);

    /// Bit 0: store the setting permanently.
    #[must_use]
    pub const fn is_permanent(self) -> bool {
        self.0 & 1 == 1
    }

    /// Of a reset to factory: mode 1 application data, 2 communication parameters, 3 engineering, 4 all stored
    /// data, 8 device, 9 reset and restore.
    #[must_use]
    pub const fn reset(mode: u8) -> Self {
        Self((mode as u16) << 1)
    }

    /// Reset mode of this qualifier.
    #[must_use]
    pub const fn reset_mode(self) -> u16 {
        self.0 >> 1
    }
}

/// Block info of a value in a response; only IP settings use values other than 0.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct BlockInfo(pub u16);

impl BlockInfo {
    /// Nothing to remark; for IP settings: not set.
    pub const NONE: Self = Self(0);
    /// The IP address is set.
    pub const IP_SET: Self = Self(1);
    /// The IP address came by DHCP.
    pub const IP_BY_DHCP: Self = Self(2);
    /// Bit 7: another station has the same address.
    pub const CONFLICT: u16 = 0x80;

    /// Returns true if another station has the same address.
    #[must_use]
    pub const fn has_conflict(self) -> bool {
        self.0 & Self::CONFLICT != 0
    }
}

/// Bits of the device role.
pub mod role {
    /// IO-Device.
    pub const DEVICE: u8 = 1;
    /// IO-Controller.
    pub const CONTROLLER: u8 = 2;
    /// IO-Multidevice.
    pub const MULTIDEVICE: u8 = 4;
    /// IO-Supervisor.
    pub const SUPERVISOR: u8 = 8;
}

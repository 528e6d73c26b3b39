//! The blocks of an alarm: notification and acknowledgement.

use alloc::borrow::Cow;
use core::fmt;

use super::diagnosis::DiagnosisItems;
use crate::wire::{DecodeError, PnioStatus, Problem, Reader, Writer};

/// Which of the two alarm channels.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Priority {
    /// FrameID 0xFE01.
    Low,
    /// FrameID 0xFC01.
    High,
}

/// What happened.
///
/// Source: IEC 61158-6-10, coding of the field AlarmType.
#[derive(Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct AlarmType(pub u16);

/// Names of the alarm types; one row each.
const TYPES: &[(u16, &str)] = &[
    (0x01, "diagnosis appears"),
    (0x02, "process"),
    (0x03, "pull"),
    (0x04, "plug"),
    (0x05, "status"),
    (0x06, "update"),
    (0x07, "redundancy"),
    (0x08, "controlled by supervisor"),
    (0x09, "released"),
    (0x0A, "plug wrong submodule"),
    (0x0B, "return of submodule"),
    (0x0C, "diagnosis disappears"),
    (0x0D, "multicast mismatch"),
    (0x0E, "port data change"),
    (0x0F, "sync data change"),
    (0x10, "isochronous mode problem"),
    (0x11, "network component problem"),
    (0x12, "time data change"),
    (0x1E, "upload and retrieval"),
    (0x1F, "pull module"),
];

impl AlarmType {
    /// Diagnosis appears.
    pub const DIAGNOSIS: Self = Self(0x01);
    /// Process alarm, the only one of high priority.
    pub const PROCESS: Self = Self(0x02);
    /// A submodule was pulled.
    pub const PULL: Self = Self(0x03);
    /// A submodule was plugged.
    pub const PLUG: Self = Self(0x04);
    /// A supervisor took the submodule over.
    pub const CONTROLLED_BY_SUPERVISOR: Self = Self(0x08);
    /// It gave the submodule back.
    pub const RELEASED: Self = Self(0x09);
    /// A wrong submodule was plugged.
    pub const PLUG_WRONG: Self = Self(0x0A);
    /// The submodule can be used again.
    pub const RETURN_OF_SUBMODULE: Self = Self(0x0B);
    /// Diagnosis disappears.
    pub const DIAGNOSIS_DISAPPEARS: Self = Self(0x0C);

    /// Plain name, if it has one here.
    #[must_use]
    pub fn name(self) -> Option<&'static str> {
        TYPES.iter().find(|row| row.0 == self.0).map(|row| row.1)
    }

    /// Channel this alarm travels on unless the connection uses the low one only.
    #[must_use]
    pub const fn priority(self) -> Priority {
        if self.0 == Self::PROCESS.0 {
            Priority::High
        } else {
            Priority::Low
        }
    }
}

impl fmt::Display for AlarmType {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.name() {
            Some(name) => f.write_str(name),
            None => write!(f, "alarm type 0x{:04X}", self.0),
        }
    }
}

impl fmt::Debug for AlarmType {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "AlarmType(0x{:04X})", self.0)
    }
}

/// Sequence number of an alarm and which diagnosis is pending.
///
/// Source: IEC 61158-6-10, coding of the field AlarmSpecifier.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub struct AlarmSpecifier(pub u16);

impl AlarmSpecifier {
    /// Bit 11: channel diagnosis pending.
    pub const CHANNEL: u16 = 0x0800;
    /// Bit 12: manufacturer diagnosis pending.
    pub const MANUFACTURER: u16 = 0x1000;
    /// Bit 13: the submodule has a diagnosis of severity fault.
    pub const SUBMODULE: u16 = 0x2000;
    /// Bit 15: something in the connection has a diagnosis of severity fault.
    pub const CONNECTION: u16 = 0x8000;

    /// Counts per connection and priority, 0 to 2047.
    #[must_use]
    pub const fn sequence(self) -> u16 {
        self.0 & 0x07FF
    }

    /// With this sequence number, modulo 2048.
    #[must_use]
    pub const fn with_sequence(self, sequence: u16) -> Self {
        Self(self.0 & !0x07FF | sequence & 0x07FF)
    }
}

/// An alarm from a device.
///
/// Source: IEC 61158-6-10, AlarmNotification-PDU, BlockType 0x0001 and 0x0002.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Notification<'a> {
    /// Channel; also given by the BlockType.
    pub priority: Priority,
    /// What happened.
    pub alarm_type: AlarmType,
    /// Application process identifier.
    pub api: u32,
    /// Slot.
    pub slot: u16,
    /// Subslot.
    pub subslot: u16,
    /// Module there.
    pub module_ident: u32,
    /// Submodule there.
    pub submodule_ident: u32,
    /// Sequence number and pending diagnosis.
    pub specifier: AlarmSpecifier,
    /// UserStructureIdentifier: what `data` is; absent for pull, plug and the like.
    pub usi: Option<u16>,
    /// What follows the UserStructureIdentifier.
    pub data: Cow<'a, [u8]>,
}

impl Notification<'_> {
    /// Returns the same, owning its data.
    #[must_use]
    pub fn into_owned(self) -> Notification<'static> {
        Notification {
            data: Cow::Owned(self.data.into_owned()),
            ..self
        }
    }

    /// Diagnosis and maintenance items it carries.
    #[must_use]
    pub fn items(&self) -> DiagnosisItems<'_> {
        DiagnosisItems::new(self.usi, &self.data)
    }

    /// Octets of the whole block.
    #[must_use]
    pub fn len(&self) -> usize {
        28 - if self.usi.is_none() { 2 } else { 0 } + self.data.len()
    }

    /// Never true: there are always 26 octets.
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        false
    }

    /// Writes the block.
    pub fn encode(&self, out: &mut impl Writer) {
        let kind = match self.priority {
            Priority::High => 0x0001,
            Priority::Low => 0x0002,
        };
        out.u16(kind);
        out.u16(u16::try_from(self.len() - 4).unwrap_or(u16::MAX));
        out.u16(0x0100);
        out.u16(self.alarm_type.0);
        out.u32(self.api);
        out.u16(self.slot);
        out.u16(self.subslot);
        out.u32(self.module_ident);
        out.u32(self.submodule_ident);
        out.u16(self.specifier.0);
        if let Some(usi) = self.usi {
            out.u16(usi);
            out.bytes(&self.data);
        }
    }
}

/// Response of a controller to an alarm.
///
/// Source: IEC 61158-6-10, AlarmAck-PDU, BlockType 0x8001 and 0x8002.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct AlarmAck {
    /// Channel.
    pub priority: Priority,
    /// Repeated from the alarm.
    pub alarm_type: AlarmType,
    /// Repeated from the alarm.
    pub api: u32,
    /// Repeated from the alarm.
    pub slot: u16,
    /// Repeated from the alarm.
    pub subslot: u16,
    /// Repeated from the alarm.
    pub specifier: AlarmSpecifier,
    /// Ok, or DA 81 3C 00 (type not supported), DA 81 3C 01 (wrong submodule state).
    pub status: PnioStatus,
}

impl AlarmAck {
    /// Returns the answer to `alarm`.
    #[must_use]
    pub const fn to(alarm: &Notification<'_>, status: PnioStatus) -> Self {
        Self {
            priority: alarm.priority,
            alarm_type: alarm.alarm_type,
            api: alarm.api,
            slot: alarm.slot,
            subslot: alarm.subslot,
            specifier: alarm.specifier,
            status,
        }
    }

    /// Writes the block.
    pub fn encode(&self, out: &mut impl Writer) {
        let kind = match self.priority {
            Priority::High => 0x8001,
            Priority::Low => 0x8002,
        };
        out.u16(kind);
        out.u16(18);
        out.u16(0x0100);
        out.u16(self.alarm_type.0);
        out.u32(self.api);
        out.u16(self.slot);
        out.u16(self.subslot);
        out.u16(self.specifier.0);
        self.status.encode(out);
    }
}

/// The block inside a data RTA PDU.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Alarm<'a> {
    /// From a device.
    Notification(Notification<'a>),
    /// From a controller.
    Ack(AlarmAck),
}

impl<'a> Alarm<'a> {
    /// Reads an alarm block.
    ///
    /// # Errors
    /// When type, length or version are wrong or the block is cut.
    pub fn decode(mut r: Reader<'a>) -> Result<Self, DecodeError> {
        let offset = r.offset();
        let kind = r.u16("alarm BlockType")?;
        let length = r.u16("alarm BlockLength")?;
        let mut r = r.sub(usize::from(length), "alarm block")?;
        let version = r.u16("alarm BlockVersion")?;
        if version != 0x0100 {
            let problem = Problem::Expected {
                expected: 0x0100,
                found: u64::from(version),
            };
            return Err(r.error("alarm BlockVersion", 2, problem));
        }
        let priority = if kind & 0x7FFF == 1 {
            Priority::High
        } else {
            Priority::Low
        };
        let alarm_type = AlarmType(r.u16("AlarmType")?);
        let api = r.u32("alarm API")?;
        let slot = r.u16("alarm slot")?;
        let subslot = r.u16("alarm subslot")?;
        match kind {
            0x0001 | 0x0002 => {
                let module_ident = r.u32("alarm ModuleIdentNumber")?;
                let submodule_ident = r.u32("alarm SubmoduleIdentNumber")?;
                let specifier = AlarmSpecifier(r.u16("AlarmSpecifier")?);
                let usi = if r.is_empty() {
                    None
                } else {
                    Some(r.u16("UserStructureIdentifier")?)
                };
                let data = Cow::Borrowed(r.rest("alarm data"));
                Ok(Self::Notification(Notification {
                    priority,
                    alarm_type,
                    api,
                    slot,
                    subslot,
                    module_ident,
                    submodule_ident,
                    specifier,
                    usi,
                    data,
                }))
            }
            0x8001 | 0x8002 => {
                let specifier = AlarmSpecifier(r.u16("AlarmSpecifier")?);
                let status = PnioStatus::decode(&mut r)?;
                r.finish("AlarmAck block")?;
                Ok(Self::Ack(AlarmAck {
                    priority,
                    alarm_type,
                    api,
                    slot,
                    subslot,
                    specifier,
                    status,
                }))
            }
            other => Err(DecodeError {
                what: "alarm BlockType",
                offset,
                problem: Problem::Invalid {
                    found: u64::from(other),
                },
            }),
        }
    }

    /// Writes the block.
    pub fn encode(&self, out: &mut impl Writer) {
        match self {
            Self::Notification(notification) => notification.encode(out),
            Self::Ack(ack) => ack.encode(out),
        }
    }
}

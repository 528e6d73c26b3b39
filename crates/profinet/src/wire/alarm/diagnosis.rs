//! Diagnosis data of alarms and diagnosis records.

use crate::wire::{DecodeError, Problem, Reader, Writer};

/// How bad it is.
///
/// Source: IEC 61158-6-10, ChannelProperties bits 9 and 10.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Severity {
    /// Fault.
    Fault,
    /// Maintenance required.
    MaintenanceRequired,
    /// Maintenance demanded.
    MaintenanceDemanded,
    /// Given by the qualifier.
    Qualified,
}

/// Comes or goes.
///
/// Source: IEC 61158-6-10, ChannelProperties bits 11 and 12.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Specifier {
    /// All of this channel are gone.
    AllDisappear,
    /// Came.
    Appears,
    /// Gone.
    Disappears,
    /// Gone, others of this channel remain.
    DisappearsOthersRemain,
}

/// One diagnosis of a channel, in the plain, extended or qualified form.
///
/// Source: IEC 61158-6-10, ChannelDiagnosisData (USI 0x8000), ExtChannelDiagnosisData (0x8002),
/// QualifiedChannelDiagnosisData (0x8003).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct ChannelDiagnosis {
    /// Channel; 0x8000 is the whole submodule.
    pub channel: u16,
    /// ChannelProperties.
    pub properties: u16,
    /// ChannelErrorType.
    pub error_type: u16,
    /// ExtChannelErrorType and ExtChannelAddValue.
    pub extended: Option<(u16, u32)>,
    /// QualifiedChannelQualifier; only with `extended`.
    pub qualifier: Option<u32>,
}

impl ChannelDiagnosis {
    /// The whole submodule.
    pub const WHOLE_SUBMODULE: u16 = 0x8000;
    /// UserStructureIdentifier of the plain form.
    pub const USI: u16 = 0x8000;
    /// UserStructureIdentifier of the extended form.
    pub const USI_EXTENDED: u16 = 0x8002;
    /// UserStructureIdentifier of the qualified form.
    pub const USI_QUALIFIED: u16 = 0x8003;

    /// UserStructureIdentifier that fits the fields present.
    #[must_use]
    pub const fn usi(&self) -> u16 {
        match (self.extended, self.qualifier) {
            (Some(_), Some(_)) => Self::USI_QUALIFIED,
            (Some(_), None) => Self::USI_EXTENDED,
            _ => Self::USI,
        }
    }

    /// Returns the severity.
    #[must_use]
    pub const fn severity(&self) -> Severity {
        match self.properties >> 9 & 3 {
            0 => Severity::Fault,
            1 => Severity::MaintenanceRequired,
            2 => Severity::MaintenanceDemanded,
            _ => Severity::Qualified,
        }
    }

    /// Comes or goes.
    #[must_use]
    pub const fn specifier(&self) -> Specifier {
        match self.properties >> 11 & 3 {
            0 => Specifier::AllDisappear,
            1 => Specifier::Appears,
            2 => Specifier::Disappears,
            _ => Specifier::DisappearsOthersRemain,
        }
    }

    /// ChannelProperties of a fault that appears, without direction and type.
    pub const APPEARS: u16 = 1 << 11;
    /// ChannelProperties of a fault that disappears.
    pub const DISAPPEARS: u16 = 2 << 11;

    /// Meaning of the error type, if it is a standard one.
    #[must_use]
    pub fn error_words(&self) -> Option<&'static str> {
        ERROR_TYPES
            .iter()
            .find(|row| row.0 == self.error_type)
            .map(|row| row.1)
    }

    fn read(usi: u16, r: &mut Reader<'_>) -> Result<Self, DecodeError> {
        let channel = r.u16("ChannelNumber")?;
        let properties = r.u16("ChannelProperties")?;
        let error_type = r.u16("ChannelErrorType")?;
        let mut item = Self {
            channel,
            properties,
            error_type,
            extended: None,
            qualifier: None,
        };
        if usi != Self::USI {
            item.extended = Some((r.u16("ExtChannelErrorType")?, r.u32("ExtChannelAddValue")?));
        }
        if usi == Self::USI_QUALIFIED {
            item.qualifier = Some(r.u32("QualifiedChannelQualifier")?);
        }
        Ok(item)
    }

    /// Writes the item without its UserStructureIdentifier.
    pub fn encode(&self, out: &mut impl Writer) {
        out.u16(self.channel);
        out.u16(self.properties);
        out.u16(self.error_type);
        if let Some((error_type, value)) = self.extended {
            out.u16(error_type);
            out.u32(value);
            if let Some(qualifier) = self.qualifier {
                out.u32(qualifier);
            }
        }
    }
}

/// Names of ChannelErrorType.
const ERROR_TYPES: &[(u16, &str)] = &[
    (0x0001, "short circuit"),
    (0x0002, "undervoltage"),
    (0x0003, "overvoltage"),
    (0x0004, "overload"),
    (0x0005, "overtemperature"),
    (0x0006, "wire break"),
    (0x0007, "upper limit exceeded"),
    (0x0008, "lower limit exceeded"),
    (0x0009, "error"),
    (0x000A, "simulation active"),
    (0x000F, "parameter missing"),
    (0x0010, "parameterization fault"),
    (0x0011, "power supply fault"),
    (0x0012, "fuse blown"),
    (0x0015, "reference point lost"),
    (0x001A, "external fault"),
    (0x001F, "temporary fault"),
    (0x8000, "data transmission impossible"),
    (0x8001, "remote mismatch"),
];

/// One item behind a UserStructureIdentifier.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum DiagnosisItem<'a> {
    /// A channel's diagnosis.
    Channel(ChannelDiagnosis),
    /// Maintenance status of the submodule: bit 0 required, bit 1 demanded.
    Maintenance(u32),
    /// Anything else, to the end of the alarm.
    Other {
        /// UserStructureIdentifier.
        usi: u16,
        /// What follows it.
        data: &'a [u8],
    },
}

const USI_MAINTENANCE: u16 = 0x8100;

/// Iterator over the items of an alarm. Ends after the first error.
#[derive(Debug, Clone)]
pub struct DiagnosisItems<'a> {
    usi: Option<u16>,
    reader: Reader<'a>,
}

impl<'a> DiagnosisItems<'a> {
    /// Items of `data`, the first one's UserStructureIdentifier already read.
    #[must_use]
    pub const fn new(usi: Option<u16>, data: &'a [u8]) -> Self {
        Self {
            usi,
            reader: Reader::new(data),
        }
    }

    fn read(&mut self) -> Result<DiagnosisItem<'a>, DecodeError> {
        let r = &mut self.reader;
        let usi = match self.usi.take() {
            Some(usi) => usi,
            None => r.u16("UserStructureIdentifier")?,
        };
        match usi {
            ChannelDiagnosis::USI | ChannelDiagnosis::USI_EXTENDED | ChannelDiagnosis::USI_QUALIFIED => {
                ChannelDiagnosis::read(usi, r).map(DiagnosisItem::Channel)
            }
            USI_MAINTENANCE => {
                let kind = r.u32("MaintenanceItem block")?;
                if kind != 0x0F00_0008 {
                    let problem = Problem::Expected {
                        expected: 0x0F00_0008,
                        found: u64::from(kind),
                    };
                    return Err(r.error("MaintenanceItem block", 4, problem));
                }
                r.skip(4, "MaintenanceItem version and padding")?;
                Ok(DiagnosisItem::Maintenance(r.u32("MaintenanceStatus")?))
            }
            usi => Ok(DiagnosisItem::Other {
                usi,
                data: r.rest("diagnosis data"),
            }),
        }
    }
}

impl<'a> Iterator for DiagnosisItems<'a> {
    type Item = Result<DiagnosisItem<'a>, DecodeError>;

    fn next(&mut self) -> Option<Self::Item> {
        if self.usi.is_none() && self.reader.is_empty() {
            return None;
        }
        let item = self.read();
        if item.is_err() {
            self.reader.rest("diagnosis data");
        }
        Some(item)
    }
}

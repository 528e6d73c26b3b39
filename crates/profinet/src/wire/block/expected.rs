//! What a controller expects to be plugged, and what differs from it.

use alloc::vec::Vec;

use super::{BlockType, write_block};
use crate::wire::{DecodeError, Reader, Writer};

/// One DataDescription of an expected submodule.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct DataDescription {
    /// 1 input, 2 output.
    pub direction: u16,
    /// Octets of data.
    pub length: u16,
    /// LengthIOCS, 1.
    pub iocs_length: u8,
    /// LengthIOPS, 1.
    pub iops_length: u8,
}

/// One expected submodule.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ExpectedSubmodule {
    /// Subslot.
    pub subslot: u16,
    /// SubmoduleIdentNumber.
    pub ident: u32,
    /// Bits 0 and 1: 0 no data, 1 input, 2 output, 3 both.
    pub properties: u16,
    /// One description, or two for input and output.
    pub data: Vec<DataDescription>,
}

impl ExpectedSubmodule {
    /// Creates a submodule with these lengths and status octets of length 1.
    #[must_use]
    pub fn new(subslot: u16, ident: u32, input: u16, output: u16) -> Self {
        let description = |direction, length| DataDescription {
            direction,
            length,
            iocs_length: 1,
            iops_length: 1,
        };
        let (properties, data) = match (input, output) {
            (_, 0) => (u16::from(input > 0), alloc::vec![description(1, input)]),
            (0, _) => (2, alloc::vec![description(2, output)]),
            _ => (3, alloc::vec![description(1, input), description(2, output)]),
        };
        Self {
            subslot,
            ident,
            properties,
            data,
        }
    }

    /// Octets of input data.
    #[must_use]
    pub fn input_length(&self) -> u16 {
        self.data
            .iter()
            .find(|d| d.direction == 1)
            .map_or(0, |d| d.length)
    }

    /// Octets of output data.
    #[must_use]
    pub fn output_length(&self) -> u16 {
        self.data
            .iter()
            .find(|d| d.direction == 2)
            .map_or(0, |d| d.length)
    }
}

/// One expected module with its submodules of one API: an entry of ExpectedSubmoduleBlockReq, block 0x0104.
///
/// IEC 61158-6-10, ExpectedSubmoduleBlockReq.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ExpectedModule {
    /// Application process identifier of its submodules.
    pub api: u32,
    /// Slot.
    pub slot: u16,
    /// ModuleIdentNumber, not 0.
    pub ident: u32,
    /// ModuleProperties, 0.
    pub properties: u16,
    /// Submodules.
    pub submodules: Vec<ExpectedSubmodule>,
}

impl ExpectedModule {
    /// Reads the body of a block, which may hold several entries.
    ///
    /// # Errors
    /// When its length does not fit its counts.
    pub fn decode_block(mut r: Reader<'_>) -> Result<Vec<Self>, DecodeError> {
        let count = r.u16("NumberOfAPIs")?;
        let mut modules = Vec::new();
        for _ in 0..count {
            let mut module = Self {
                api: r.u32("API")?,
                slot: r.u16("SlotNumber")?,
                ident: r.u32("ModuleIdentNumber")?,
                properties: r.u16("ModuleProperties")?,
                submodules: Vec::new(),
            };
            let submodules = r.u16("NumberOfSubmodules")?;
            for _ in 0..submodules {
                let mut submodule = ExpectedSubmodule {
                    subslot: r.u16("SubslotNumber")?,
                    ident: r.u32("SubmoduleIdentNumber")?,
                    properties: r.u16("SubmoduleProperties")?,
                    data: Vec::new(),
                };
                let descriptions = if submodule.properties & 3 == 3 { 2 } else { 1 };
                for _ in 0..descriptions {
                    submodule.data.push(DataDescription {
                        direction: r.u16("DataDescription")?,
                        length: r.u16("SubmoduleDataLength")?,
                        iocs_length: r.u8("LengthIOCS")?,
                        iops_length: r.u8("LengthIOPS")?,
                    });
                }
                module.submodules.push(submodule);
            }
            modules.push(module);
        }
        r.finish("ExpectedSubmoduleBlockReq")?;
        Ok(modules)
    }

    /// Writes one block with these entries.
    pub fn encode_block(modules: &[Self], out: &mut impl Writer) {
        write_block(out, BlockType::EXPECTED_SUBMODULE, 0, |out| {
            out.u16(u16::try_from(modules.len()).unwrap_or(u16::MAX));
            for module in modules {
                out.u32(module.api);
                out.u16(module.slot);
                out.u32(module.ident);
                out.u16(module.properties);
                out.u16(u16::try_from(module.submodules.len()).unwrap_or(u16::MAX));
                for submodule in &module.submodules {
                    out.u16(submodule.subslot);
                    out.u32(submodule.ident);
                    out.u16(submodule.properties);
                    for data in &submodule.data {
                        out.u16(data.direction);
                        out.u16(data.length);
                        out.bytes(&[data.iocs_length, data.iops_length]);
                    }
                }
            }
        });
    }
}

/// ModuleState.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct ModuleState(pub u16);

impl ModuleState {
    /// Nothing is plugged.
    pub const NO_MODULE: Self = Self(0);
    /// Another module is plugged.
    pub const WRONG: Self = Self(1);
    /// The expected module is plugged; some submodule differs.
    pub const PROPER: Self = Self(2);
    /// A compatible module is plugged.
    pub const SUBSTITUTE: Self = Self(3);

    /// Meaning in words.
    #[must_use]
    pub const fn words(self) -> &'static str {
        match self {
            Self::NO_MODULE => "no module",
            Self::WRONG => "wrong module",
            Self::PROPER => "proper module",
            Self::SUBSTITUTE => "substitute module",
            _ => "unknown module state",
        }
    }
}

/// SubmoduleState: with FormatIndicator 1 a word of fields, with FormatIndicator 0 one number.
///
/// IEC 61158-6-10, coding of the field SubmoduleState.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct SubmoduleState(pub u16);

impl SubmoduleState {
    /// Nothing differs.
    pub const OK: Self = Self(0x8000);
    /// A compatible submodule is plugged.
    pub const SUBSTITUTE: Self = Self(0x8800);
    /// Another submodule is plugged.
    pub const WRONG: Self = Self(0x9000);
    /// Nothing is plugged.
    pub const NO_SUBMODULE: Self = Self(0x9800);
    /// Application not ready yet.
    pub const READY_PENDING: Self = Self(0x8080);
    /// Another controller owns it.
    pub const LOCKED_BY_CONTROLLER: Self = Self(0x8180);
    /// A diagnosis (fault) is pending.
    pub const FAULT: u16 = 1 << 6;
    /// Maintenance is demanded.
    pub const MAINTENANCE_DEMANDED: u16 = 1 << 5;
    /// Maintenance is required.
    pub const MAINTENANCE_REQUIRED: u16 = 1 << 4;
    /// There is an advice.
    pub const ADVICE: u16 = 1 << 3;

    /// Returns the same with FormatIndicator 1; reserved numbers have an IdentInfo that is reserved too.
    const fn fields(self) -> u16 {
        let state = match self.0 {
            0 => Self::NO_SUBMODULE,
            1 => Self::WRONG,
            2 => Self::LOCKED_BY_CONTROLLER,
            4 => Self::READY_PENDING,
            7 => Self::SUBSTITUTE,
            0x8000.. => self,
            _ => Self(0xF800),
        };
        state.0
    }

    /// IdentInfo: 0 ok, 1 substitute, 2 wrong, 3 no submodule.
    #[must_use]
    pub const fn ident_info(self) -> u8 {
        (self.fields() >> 11 & 0xF) as u8
    }

    /// Returns true when data can be exchanged with it: as expected or compatible, and owned by the requesting
    /// controller.
    #[must_use]
    pub const fn is_usable(self) -> bool {
        self.ident_info() <= 1 && self.ar_info() == 0
    }

    /// Returns true when a fault, maintenance or an advice is pending, independent of the plugged module.
    #[must_use]
    pub const fn has_diagnosis(self) -> bool {
        let pending = Self::FAULT | Self::MAINTENANCE_DEMANDED | Self::MAINTENANCE_REQUIRED | Self::ADVICE;
        self.fields() & pending != 0
    }

    /// Meanings of the fields that are not 0, for people; none where everything is as expected.
    pub fn words(self) -> impl Iterator<Item = &'static str> {
        let ident = match self.ident_info() {
            0 => None,
            1 => Some("substitute submodule"),
            2 => Some("wrong submodule"),
            3 => Some("no submodule"),
            _ => Some("unknown IdentInfo"),
        };
        let ar = match self.ar_info() {
            0 => None,
            1 => Some("application ready pending"),
            2 => Some("locked by a superordinated connection"),
            3 => Some("locked by another controller"),
            4 => Some("locked by a supervisor"),
            _ => Some("unknown ARInfo"),
        };
        let flag = move |bit: u16, words| (self.fields() & bit != 0).then_some(words);
        [
            ident,
            ar,
            flag(Self::FAULT, "diagnosis pending"),
            flag(Self::MAINTENANCE_DEMANDED, "maintenance demanded"),
            flag(Self::MAINTENANCE_REQUIRED, "maintenance required"),
            flag(Self::ADVICE, "advice pending"),
            flag(0x0001, "take-over not allowed"),
        ]
        .into_iter()
        .flatten()
    }

    /// ARInfo: 0 own, 1 ready pending, 2 superordinated locked, 3 locked by controller, 4 locked by supervisor.
    #[must_use]
    pub const fn ar_info(self) -> u8 {
        (self.fields() >> 7 & 0xF) as u8
    }
}

/// A submodule that differs.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct DiffSubmodule {
    /// Subslot.
    pub subslot: u16,
    /// What is really plugged, 0 if nothing.
    pub ident: u32,
    /// In which way it differs.
    pub state: SubmoduleState,
}

/// A module that differs, or has a submodule that does.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct DiffModule {
    /// API.
    pub api: u32,
    /// Slot.
    pub slot: u16,
    /// What is really plugged, 0 if nothing.
    pub ident: u32,
    /// In which way it differs.
    pub state: ModuleState,
    /// Submodules that differ; normally empty if the module itself does.
    pub submodules: Vec<DiffSubmodule>,
}

/// ModuleDiffBlock, block 0x8104: modules in which expected and real differ.
///
/// IEC 61158-6-10, ModuleDiffBlock. Modules of one API stand one behind the other.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct ModuleDiff {
    /// The modules.
    pub modules: Vec<DiffModule>,
}

impl ModuleDiff {
    /// Reads the body.
    ///
    /// # Errors
    /// When its length does not fit its counts.
    pub fn decode(mut r: Reader<'_>) -> Result<Self, DecodeError> {
        let apis = r.u16("NumberOfAPIs")?;
        let mut diff = Self::default();
        for _ in 0..apis {
            let api = r.u32("API")?;
            let modules = r.u16("NumberOfModules")?;
            for _ in 0..modules {
                let mut module = DiffModule {
                    api,
                    slot: r.u16("SlotNumber")?,
                    ident: r.u32("ModuleIdentNumber")?,
                    state: ModuleState(r.u16("ModuleState")?),
                    submodules: Vec::new(),
                };
                let submodules = r.u16("NumberOfSubmodules")?;
                for _ in 0..submodules {
                    module.submodules.push(DiffSubmodule {
                        subslot: r.u16("SubslotNumber")?,
                        ident: r.u32("SubmoduleIdentNumber")?,
                        state: SubmoduleState(r.u16("SubmoduleState")?),
                    });
                }
                diff.modules.push(module);
            }
        }
        r.finish("ModuleDiffBlock")?;
        Ok(diff)
    }

    /// Writes the whole block.
    pub fn encode(&self, out: &mut impl Writer) {
        write_block(out, BlockType::MODULE_DIFF, 0, |out| {
            let runs = self.modules.chunk_by(|a, b| a.api == b.api);
            out.u16(u16::try_from(runs.clone().count()).unwrap_or(u16::MAX));
            for run in runs {
                out.u32(run.first().map_or(0, |module| module.api));
                out.u16(u16::try_from(run.len()).unwrap_or(u16::MAX));
                for module in run {
                    out.u16(module.slot);
                    out.u32(module.ident);
                    out.u16(module.state.0);
                    out.u16(u16::try_from(module.submodules.len()).unwrap_or(u16::MAX));
                    for submodule in &module.submodules {
                        out.u16(submodule.subslot);
                        out.u32(submodule.ident);
                        out.u16(submodule.state.0);
                    }
                }
            }
        });
    }
}

#[cfg(test)]
mod tests {
    use super::super::Block;
    use super::*;
    use proptest::collection::vec;
    use proptest::prelude::*;

    fn module() -> impl Strategy<Value = ExpectedModule> {
        let data = any::<(u16, u16, u8, u8)>().prop_map(|(direction, length, iocs_length, iops_length)| {
            DataDescription {
                direction,
                length,
                iocs_length,
                iops_length,
            }
        });
        let submodule = (any::<u16>(), any::<u32>(), any::<u16>(), [data.clone(), data]).prop_map(
            |(subslot, ident, properties, data)| {
                let count = if properties & 3 == 3 { 2 } else { 1 };
                ExpectedSubmodule {
                    subslot,
                    ident,
                    properties,
                    data: data[..count].to_vec(),
                }
            },
        );
        (any::<(u32, u16, u32, u16)>(), vec(submodule, 0..4)).prop_map(|(n, submodules)| ExpectedModule {
            api: n.0,
            slot: n.1,
            ident: n.2,
            properties: n.3,
            submodules,
        })
    }

    fn diff_module() -> impl Strategy<Value = DiffModule> {
        let submodule = any::<(u16, u32, u16)>().prop_map(|(subslot, ident, state)| DiffSubmodule {
            subslot,
            ident,
            state: SubmoduleState(state),
        });
        (0u32..2, any::<(u16, u32, u16)>(), vec(submodule, 0..4)).prop_map(|(api, n, submodules)| {
            DiffModule {
                api,
                slot: n.0,
                ident: n.1,
                state: ModuleState(n.2),
                submodules,
            }
        })
    }

    #[test]
    fn iocs_length_comes_before_iops_length() {
        let mut submodule = ExpectedSubmodule::new(1, 0x30, 4, 0);
        submodule.data[0].iocs_length = 2;
        let module = ExpectedModule {
            api: 0x3A00,
            slot: 1,
            ident: 7,
            properties: 0,
            submodules: alloc::vec![submodule],
        };
        let mut out = Vec::new();
        ExpectedModule::encode_block(&[module], &mut out);
        assert_eq!(out[out.len() - 6..], [0, 1, 0, 4, 2, 1]);
    }

    proptest! {
        #[test]
        fn expected_modules_survive(modules in vec(module(), 0..4), at: u16, bit in 0u8..8) {
            let mut out = Vec::new();
            ExpectedModule::encode_block(&modules, &mut out);
            let body = Block::expect(&mut Reader::new(&out), BlockType::EXPECTED_SUBMODULE).unwrap();
            prop_assert_eq!(ExpectedModule::decode_block(body), Ok(modules));
            for end in 6..out.len() {
                prop_assert!(ExpectedModule::decode_block(Reader::new(&out[6..end])).is_err());
            }
            let at = usize::from(at) % out.len();
            out[at] ^= 1 << bit;
            if let Ok(block) = Block::decode(&mut Reader::new(&out)) {
                let _ = ExpectedModule::decode_block(block.body);
            }
        }

        #[test]
        fn diffs_survive(modules in vec(diff_module(), 0..4), at: u16, bit in 0u8..8) {
            let diff = ModuleDiff { modules };
            let mut out = Vec::new();
            diff.encode(&mut out);
            let body = Block::expect(&mut Reader::new(&out), BlockType::MODULE_DIFF).unwrap();
            prop_assert_eq!(ModuleDiff::decode(body), Ok(diff));
            for end in 6..out.len() {
                prop_assert!(ModuleDiff::decode(Reader::new(&out[6..end])).is_err());
            }
            let at = usize::from(at) % out.len();
            out[at] ^= 1 << bit;
            if let Ok(block) = Block::decode(&mut Reader::new(&out)) {
                let _ = ModuleDiff::decode(block.body);
            }
        }
    }
}

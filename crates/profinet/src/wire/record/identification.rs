//! What is plugged, what was expected, which APIs there are, who has I&M0.

use alloc::vec::Vec;

use crate::wire::block::{Block, BlockType, write_block};
use crate::wire::{DecodeError, Reader, Writer};

/// A submodule in an identification record.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct IdentifiedSubmodule {
    /// Subslot.
    pub subslot: u16,
    /// SubmoduleIdentNumber.
    pub ident: u32,
}

/// A module in an identification record.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct IdentifiedModule {
    /// API.
    pub api: u32,
    /// Slot.
    pub slot: u16,
    /// ModuleIdentNumber.
    pub ident: u32,
    /// Submodules of this API.
    pub submodules: Vec<IdentifiedSubmodule>,
}

/// RealIdentificationData (0x0013) or ExpectedIdentificationData (0x0012), version 1.1; also the body of
/// I&M0FilterData.
///
/// IEC 61158-6-10. Modules of one API stand one behind the other.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Identification {
    /// The modules.
    pub modules: Vec<IdentifiedModule>,
}

impl Identification {
    /// Reads a block of this type: real, expected or one of the three filter blocks.
    ///
    /// # Errors
    /// When it is another block, or its length does not fit its counts.
    pub fn decode(reader: &mut Reader<'_>, block_type: BlockType) -> Result<Self, DecodeError> {
        let before = *reader;
        let low = Block::decode(&mut { before })?.version.1;
        let mut r = Block::expect(reader, block_type)?;
        let identification = matches!(
            block_type,
            BlockType::REAL_IDENTIFICATION | BlockType::EXPECTED_IDENTIFICATION
        );
        // version 1.0 of the identification has no API level
        let apis = if identification && low == 0 {
            None
        } else {
            Some(r.u16("NumberOfAPIs")?)
        };
        let mut result = Self::default();
        for _ in 0..apis.unwrap_or(1) {
            let api = if apis.is_some() { r.u32("API")? } else { 0 };
            let slots = r.u16("NumberOfSlots")?;
            for _ in 0..slots {
                let mut module = IdentifiedModule {
                    api,
                    slot: r.u16("SlotNumber")?,
                    ident: r.u32("ModuleIdentNumber")?,
                    submodules: Vec::new(),
                };
                let count = r.u16("NumberOfSubslots")?;
                for _ in 0..count {
                    module.submodules.push(IdentifiedSubmodule {
                        subslot: r.u16("SubslotNumber")?,
                        ident: r.u32("SubmoduleIdentNumber")?,
                    });
                }
                result.modules.push(module);
            }
        }
        r.finish("identification")?;
        Ok(result)
    }

    /// Writes it as a block of this type; `version_low` is 1 for the identification, 0 for filter blocks.
    pub fn encode(&self, block_type: BlockType, version_low: u8, out: &mut impl Writer) {
        write_block(out, block_type, version_low, |out| {
            let runs = self.modules.chunk_by(|a, b| a.api == b.api);
            out.u16(u16::try_from(runs.clone().count()).unwrap_or(u16::MAX));
            for run in runs {
                out.u32(run.first().map_or(0, |module| module.api));
                out.u16(u16::try_from(run.len()).unwrap_or(u16::MAX));
                for module in run {
                    out.u16(module.slot);
                    out.u32(module.ident);
                    out.u16(u16::try_from(module.submodules.len()).unwrap_or(u16::MAX));
                    for submodule in &module.submodules {
                        out.u16(submodule.subslot);
                        out.u32(submodule.ident);
                    }
                }
            }
        });
    }
}

/// Writes I&M0FilterData: the submodules with their own I&M0, and the one that stands for the device.
pub fn encode_filter(own: &Identification, device: &Identification, out: &mut impl Writer) {
    own.encode(BlockType::IM0_FILTER_SUBMODULE, 0, out);
    device.encode(BlockType::IM0_FILTER_DEVICE, 0, out);
}

/// Reads APIData.
///
/// # Errors
/// When it is another block, or its length does not fit its count.
pub fn decode_apis(mut reader: Reader<'_>) -> Result<Vec<u32>, DecodeError> {
    let mut r = Block::expect(&mut reader, BlockType::API_DATA)?;
    let count = r.u16("NumberOfAPIs")?;
    let mut apis = Vec::new();
    for _ in 0..count {
        apis.push(r.u32("API")?);
    }
    r.finish("APIData")?;
    Ok(apis)
}

/// Writes APIData.
pub fn encode_apis(apis: &[u32], out: &mut impl Writer) {
    write_block(out, BlockType::API_DATA, 0, |out| {
        out.u16(u16::try_from(apis.len()).unwrap_or(u16::MAX));
        for api in apis {
            out.u32(*api);
        }
    });
}

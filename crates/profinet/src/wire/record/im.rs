//! Identification and maintenance records.

use crate::wire::block::{Block, BlockType, write_block};
use crate::wire::{DecodeError, Problem, Reader, Writer};

/// I&M0: who a submodule is. 60 octets, block 0x0020.
///
/// IEC 61158-6-10, I&M0.
///
/// ```
/// use profidrive_profinet::wire::record::Im0;
/// use profidrive_profinet::wire::Reader;
/// let im0 = Im0 { vendor_id: 0x0105, profile_id: 0x3A00, supported: 0x1E, ..Im0::default() };
/// let mut record = Vec::new();
/// im0.encode(&mut record);
/// assert_eq!(record.len(), 60);
/// assert_eq!(Im0::decode(Reader::new(&record)), Ok(im0));
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Im0 {
    /// Vendor number.
    pub vendor_id: u16,
    /// Order number, blank-padded.
    pub order_id: [u8; 20],
    /// Serial number, blank-padded.
    pub serial_number: [u8; 16],
    /// Hardware revision.
    pub hardware_revision: u16,
    /// `V`, `R`, `P`, `U` or `T`.
    pub software_prefix: u8,
    /// Functional enhancement, bug fix, internal change.
    pub software_revision: [u8; 3],
    /// Counts changes of static parameters.
    pub revision_counter: u16,
    /// Profile, 0x3A00 for PROFIdrive.
    pub profile_id: u16,
    /// Profile specific type.
    pub profile_specific_type: u16,
    /// IM_Version, 1.1.
    pub version: (u8, u8),
    /// Bit n: I&Mn is supported.
    pub supported: u16,
}

impl Default for Im0 {
    fn default() -> Self {
        Self {
            vendor_id: 0,
            order_id: [b' '; 20],
            serial_number: [b' '; 16],
            hardware_revision: 0,
            software_prefix: b'V',
            software_revision: [0; 3],
            revision_counter: 0,
            profile_id: 0,
            profile_specific_type: 0,
            version: (1, 1),
            supported: 0,
        }
    }
}

impl Im0 {
    /// Reads the record.
    ///
    /// # Errors
    /// When it is another block or has another length.
    pub fn decode(mut reader: Reader<'_>) -> Result<Self, DecodeError> {
        let mut r = Block::expect(&mut reader, BlockType::IM0)?;
        let im0 = Self {
            vendor_id: r.u16("VendorID")?,
            order_id: r.array("OrderID")?,
            serial_number: r.array("SerialNumber")?,
            hardware_revision: r.u16("HardwareRevision")?,
            software_prefix: r.u8("SoftwareRevisionPrefix")?,
            software_revision: r.array("SoftwareRevision")?,
            revision_counter: r.u16("RevisionCounter")?,
            profile_id: r.u16("ProfileID")?,
            profile_specific_type: r.u16("ProfileSpecificType")?,
            version: (r.u8("IM_Version")?, r.u8("IM_Version")?),
            supported: r.u16("IM_Supported")?,
        };
        r.finish("I&M0")?;
        Ok(im0)
    }

    /// Writes the record.
    pub fn encode(&self, out: &mut impl Writer) {
        write_block(out, BlockType::IM0, 0, |out| {
            out.u16(self.vendor_id);
            out.bytes(&self.order_id);
            out.bytes(&self.serial_number);
            out.u16(self.hardware_revision);
            out.u8(self.software_prefix);
            out.bytes(&self.software_revision);
            out.u16(self.revision_counter);
            out.u16(self.profile_id);
            out.u16(self.profile_specific_type);
            out.bytes(&[self.version.0, self.version.1]);
            out.u16(self.supported);
        });
    }
}

/// Octets of the bodies of I&M1 to I&M4.
const BODIES: [usize; 4] = [54, 16, 54, 54];

/// I&M1 to I&M4: a body of fixed length.
///
/// IEC 61158-6-10, I&M1 (tag function 32, tag location 22), I&M2 (date 16), I&M3 (descriptor 54), I&M4 (signature
/// 54).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ImText<'a> {
    /// 1 to 4.
    pub number: u8,
    /// What it holds.
    pub body: &'a [u8],
}

impl<'a> ImText<'a> {
    /// Reads record `number` (1 to 4).
    ///
    /// # Errors
    /// When it is another block, has another length, or there is no such number.
    pub fn decode(mut reader: Reader<'a>, number: u8) -> Result<Self, DecodeError> {
        let place = usize::from(number.wrapping_sub(1));
        let Some(length) = BODIES.get(place) else {
            return Err(reader.error("I&M", 0, Problem::Invalid { found: number.into() }));
        };
        let mut r = Block::expect(&mut reader, BlockType(BlockType::IM0.0 + u16::from(number)))?;
        let body = r.bytes(*length, "I&M")?;
        r.finish("I&M")?;
        reader.finish("I&M")?;
        Ok(Self { number, body })
    }

    /// Tag function of I&M1.
    #[must_use]
    pub fn tag_function(&self) -> &'a [u8] {
        self.body.get(..32).unwrap_or(&[])
    }

    /// Tag location of I&M1.
    #[must_use]
    pub fn tag_location(&self) -> &'a [u8] {
        self.body.get(32..).unwrap_or(&[])
    }
}

/// Writes I&M1 to I&M4.
pub fn encode_im(number: u8, body: &[u8], out: &mut impl Writer) {
    write_block(out, BlockType(BlockType::IM0.0 + u16::from(number)), 0, |out| {
        out.bytes(body)
    });
}

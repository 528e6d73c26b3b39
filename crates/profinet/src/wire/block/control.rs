//! Control and release blocks: PrmEnd, ApplicationReady, Release and their answers.

use super::{BlockType, write_block};
use crate::wire::{ByteOrder, DecodeError, Reader, Uuid, Writer};

/// What a control block requests; one bit each.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct ControlCommand(pub u16);

impl ControlCommand {
    /// The controller has written all parameters.
    pub const PRM_END: Self = Self(0x0001);
    /// The device's application is ready.
    pub const APPLICATION_READY: Self = Self(0x0002);
    /// Closes the AR.
    pub const RELEASE: Self = Self(0x0004);
    /// Positive answer to any of the others.
    pub const DONE: Self = Self(0x0008);
    /// Ready for the companion AR.
    pub const READY_FOR_COMPANION: Self = Self(0x0010);
    /// Ready for class 3.
    pub const READY_FOR_RTC3: Self = Self(0x0020);
    /// Parameters follow while data is exchanged.
    pub const PRM_BEGIN: Self = Self(0x0040);
}

/// A control block, 32 octets.
///
/// IEC 61158-6-10, IODControlReq, IOXControlReq, ReleaseBlock and their responses.
///
/// ```
/// use profidrive_profinet::wire::block::{BlockType, ControlBlock, ControlCommand};
/// use profidrive_profinet::wire::Uuid;
/// let request = ControlBlock::new(BlockType::PRM_END, Uuid([7; 16]), 2, ControlCommand::PRM_END);
/// let mut out = Vec::new();
/// request.done().encode(&mut out);
/// assert_eq!(out[..6], [0x81, 0x10, 0x00, 0x1C, 0x01, 0x00]);
/// assert_eq!(out[28..], [0x00, 0x08, 0x00, 0x00]);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ControlBlock {
    /// Which service.
    pub block_type: BlockType,
    /// The AR.
    pub ar_uuid: Uuid,
    /// SessionKey of its connect.
    pub session_key: u16,
    /// Sequence number of the plug alarm in the plug variants, else 0.
    pub alarm_sequence: u16,
    /// What is requested.
    pub command: ControlCommand,
    /// ControlBlockProperties, 0.
    pub properties: u16,
}

impl ControlBlock {
    /// Creates a block without alarm sequence number and properties.
    #[must_use]
    pub const fn new(
        block_type: BlockType,
        ar_uuid: Uuid,
        session_key: u16,
        command: ControlCommand,
    ) -> Self {
        Self {
            block_type,
            ar_uuid,
            session_key,
            alarm_sequence: 0,
            command,
            properties: 0,
        }
    }

    /// Returns the positive answer: same block, response type, command Done.
    #[must_use]
    pub const fn done(&self) -> Self {
        Self {
            block_type: self.block_type.response(),
            command: ControlCommand::DONE,
            properties: 0,
            ..*self
        }
    }

    /// Reads the body of a block of type `block_type`.
    ///
    /// # Errors
    /// When it has another length.
    pub fn decode(block_type: BlockType, mut r: Reader<'_>) -> Result<Self, DecodeError> {
        r.skip(2, "reserved")?;
        let ar_uuid = Uuid::decode(&mut r, ByteOrder::Big, "ARUUID")?;
        let session_key = r.u16("SessionKey")?;
        let alarm_sequence = r.u16("AlarmSequenceNumber")?;
        let command = ControlCommand(r.u16("ControlCommand")?);
        let properties = r.u16("ControlBlockProperties")?;
        r.finish("control block")?;
        Ok(Self {
            block_type,
            ar_uuid,
            session_key,
            alarm_sequence,
            command,
            properties,
        })
    }

    /// Writes the whole block.
    pub fn encode(&self, out: &mut impl Writer) {
        write_block(out, self.block_type, 0, |out| {
            out.u16(0);
            self.ar_uuid.encode(out, ByteOrder::Big);
            out.u16(self.session_key);
            out.u16(self.alarm_sequence);
            out.u16(self.command.0);
            out.u16(self.properties);
        });
    }
}

#[cfg(test)]
mod tests {
    use super::super::Block;
    use super::*;
    use alloc::vec::Vec;
    use proptest::prelude::*;

    #[test]
    fn golden_prm_end() {
        let golden = b"\x01\x10\x00\x1c\x01\x00\x00\x00AAAAAAAAAAAAAAAA\x00\x02\x00\x00\x00\x01\x00\x00";
        let mut out = Vec::new();
        ControlBlock::new(BlockType::PRM_END, Uuid([b'A'; 16]), 2, ControlCommand::PRM_END).encode(&mut out);
        assert_eq!(out, golden);
    }

    proptest! {
        #[test]
        fn control_blocks_survive_the_wire(n in any::<(u16, [u8; 16], u16, u16, u16, u16)>()) {
            let control = ControlBlock {
                block_type: BlockType(n.0), ar_uuid: Uuid(n.1), session_key: n.2, alarm_sequence: n.3,
                command: ControlCommand(n.4), properties: n.5,
            };
            let mut out = Vec::new();
            control.encode(&mut out);
            prop_assert_eq!(out.len(), 32);
            let block = Block::decode(&mut Reader::new(&out)).unwrap();
            prop_assert_eq!(ControlBlock::decode(block.block_type, block.body), Ok(control));
            for end in 0..out.len() {
                prop_assert!(Block::decode(&mut Reader::new(&out[..end])).is_err());
                let body = Reader::new(out.get(6..end).unwrap_or(&[]));
                prop_assert!(ControlBlock::decode(control.block_type, body).is_err());
            }
        }
    }
}

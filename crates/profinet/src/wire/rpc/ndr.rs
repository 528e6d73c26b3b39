//! The 20 octets between the RPC header and the PNIO blocks.

use crate::wire::{ByteOrder, DecodeError, PnioStatus, Problem, Reader, Writer};

/// Octets of the NDR header.
pub const NDR_LENGTH: usize = 20;

/// NDR header of a request, in the byte order of the RPC header.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct NdrRequest {
    /// Octets of blocks the answer may have.
    pub args_maximum: u32,
    /// Octets of blocks that follow.
    pub args_length: u32,
}

/// NDR header of a response, in the byte order of the RPC header.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct NdrResponse {
    /// How the service ended.
    pub status: PnioStatus,
    /// Octets of blocks that follow.
    pub args_length: u32,
    /// ArgsMaximum of the request.
    pub args_maximum: u32,
}

fn array(r: &mut Reader<'_>, order: ByteOrder, args_length: u32) -> Result<u32, DecodeError> {
    let maximum = r.u32_in(order, "MaximumCount")?;
    let offset = r.u32_in(order, "Offset")?;
    if offset != 0 {
        return Err(r.error(
            "Offset",
            4,
            Problem::Expected {
                expected: 0,
                found: offset.into(),
            },
        ));
    }
    let actual = r.u32_in(order, "ActualCount")?;
    if actual != args_length {
        return Err(r.error(
            "ActualCount",
            4,
            Problem::Expected {
                expected: args_length.into(),
                found: actual.into(),
            },
        ));
    }
    let left = r.remaining();
    if usize::try_from(args_length) != Ok(left) {
        return Err(r.error(
            "ArgsLength",
            16,
            Problem::Expected {
                expected: left as u64,
                found: args_length.into(),
            },
        ));
    }
    Ok(maximum)
}

impl NdrRequest {
    /// Reads the header of a whole stub; the blocks are then what `reader` has left.
    ///
    /// # Errors
    /// When the stub is too short or its lengths do not agree with each other and with the octets present.
    pub fn decode(r: &mut Reader<'_>, order: ByteOrder) -> Result<Self, DecodeError> {
        let args_maximum = r.u32_in(order, "ArgsMaximum")?;
        let args_length = r.u32_in(order, "ArgsLength")?;
        array(r, order, args_length)?;
        Ok(Self {
            args_maximum,
            args_length,
        })
    }

    /// Writes the header; `args_length` octets of blocks must follow.
    pub fn encode(&self, out: &mut impl Writer, order: ByteOrder) {
        out.u32_in(order, self.args_maximum);
        out.u32_in(order, self.args_length);
        out.u32_in(order, self.args_maximum);
        out.u32_in(order, 0);
        out.u32_in(order, self.args_length);
    }
}

impl NdrResponse {
    /// Reads the header of a whole stub; the blocks are then what `reader` has left.
    ///
    /// # Errors
    /// When the stub is too short or its lengths do not agree with each other and with the octets present.
    pub fn decode(r: &mut Reader<'_>, order: ByteOrder) -> Result<Self, DecodeError> {
        let status = PnioStatus::from_u32(r.u32_in(order, "PNIOStatus")?);
        let args_length = r.u32_in(order, "ArgsLength")?;
        let args_maximum = array(r, order, args_length)?;
        Ok(Self {
            status,
            args_length,
            args_maximum,
        })
    }

    /// Writes the header; `args_length` octets of blocks must follow.
    pub fn encode(&self, out: &mut impl Writer, order: ByteOrder) {
        out.u32_in(order, self.status.to_u32());
        out.u32_in(order, self.args_length);
        out.u32_in(order, self.args_maximum);
        out.u32_in(order, 0);
        out.u32_in(order, self.args_length);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::vec::Vec;
    use proptest::prelude::*;

    #[test]
    fn connect_response_of_the_capture() {
        let golden = [
            0, 0, 0, 0, 0, 0, 0, 0x5A, 0, 0, 2, 0x2D, 0, 0, 0, 0, 0, 0, 0, 0x5A,
        ];
        let mut stub = golden.to_vec();
        stub.resize(20 + 90, 0xEE);
        let mut reader = Reader::new(&stub);
        let ndr = NdrResponse::decode(&mut reader, ByteOrder::Big).unwrap();
        assert_eq!(
            ndr,
            NdrResponse {
                status: PnioStatus::OK,
                args_length: 90,
                args_maximum: 557
            }
        );
        assert_eq!(reader.remaining(), 90);
        let mut out = Vec::new();
        ndr.encode(&mut out, ByteOrder::Big);
        assert_eq!(out, golden);
    }

    #[test]
    fn a_little_endian_status_starts_with_error_code_2() {
        let ndr = NdrResponse {
            status: PnioStatus::from_u32(0xDE80_B500),
            args_length: 0,
            args_maximum: 4,
        };
        let mut out = Vec::new();
        ndr.encode(&mut out, ByteOrder::Little);
        assert_eq!(out[..4], [0x00, 0xB5, 0x80, 0xDE]);
        assert_eq!(
            NdrResponse::decode(&mut Reader::new(&out), ByteOrder::Little),
            Ok(ndr)
        );
    }

    #[test]
    fn lengths_that_disagree_are_refused() {
        let mut out = Vec::new();
        NdrRequest {
            args_maximum: 100,
            args_length: 3,
        }
        .encode(&mut out, ByteOrder::Big);
        out.extend_from_slice(&[1, 2]);
        let error = NdrRequest::decode(&mut Reader::new(&out), ByteOrder::Big).unwrap_err();
        assert_eq!((error.what, error.offset), ("ArgsLength", 4));
        out.push(3);
        assert!(NdrRequest::decode(&mut Reader::new(&out), ByteOrder::Big).is_ok());
        out[19] = 2;
        let error = NdrRequest::decode(&mut Reader::new(&out), ByteOrder::Big).unwrap_err();
        assert_eq!((error.what, error.offset), ("ActualCount", 16));
    }

    proptest! {
        #[test]
        fn requests_survive_and_truncations_are_errors(maximum: u32, little: bool, blocks in 0usize..50) {
            let order = if little { ByteOrder::Little } else { ByteOrder::Big };
            let ndr = NdrRequest { args_maximum: maximum, args_length: blocks as u32 };
            let mut out = Vec::new();
            ndr.encode(&mut out, order);
            out.zeros(blocks);
            prop_assert_eq!(NdrRequest::decode(&mut Reader::new(&out), order), Ok(ndr));
            for end in 0..out.len() {
                prop_assert!(NdrRequest::decode(&mut Reader::new(&out[..end]), order).is_err());
            }
        }
    }
}

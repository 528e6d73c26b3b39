//! Parameter jobs inside records: requests with names, answers matched with them.

use std::collections::HashMap;
use std::net::Ipv4Addr;

use profinet::wire::PnioStatus;
use profinet::wire::Uuid;
use profinet::wire::block::{ReadRequest, WriteRequest};

use super::{Sink, Weight};
use crate::job::{self, JobDrive};

/// Most channels with an open request.
const MAX_OPEN: usize = 1024;

/// True for the records that carry parameter jobs.
pub const fn is_parameter_record(index: u16) -> bool {
    matches!(index, 0x002F | 0xB02E | 0xB02F)
}

/// Which drive, and the record of which connection.
type Channel = (Ipv4Addr, Uuid, u16, u16, u16);

/// Requests that wait for their answer.
#[derive(Debug, Default)]
pub struct Jobs {
    open: HashMap<Channel, Vec<u8>>,
}

impl Jobs {
    /// A request was written to a drive.
    pub fn request(
        &mut self,
        at: Ipv4Addr,
        drive: &JobDrive,
        write: &WriteRequest,
        data: &[u8],
        sink: &mut Sink<'_>,
    ) {
        for (weight, line) in job::request_lines(drive, data) {
            sink.note(weight, "parameter", line);
        }
        if self.open.len() < MAX_OPEN {
            self.open.insert(
                (at, write.ar_uuid, write.slot, write.subslot, write.index),
                data.to_vec(),
            );
        }
    }

    /// An answer of a drive was read, or refused.
    pub fn answer(
        &mut self,
        at: Ipv4Addr,
        drive: &mut JobDrive,
        read: &ReadRequest,
        data: Option<&[u8]>,
        status: PnioStatus,
        sink: &mut Sink<'_>,
    ) {
        let channel = (at, read.ar_uuid, read.slot, read.subslot, read.index);
        match data {
            Some(data) => {
                let request = self.open.remove(&channel);
                for (weight, line) in job::response_lines(drive, data, request.as_deref()) {
                    sink.note(weight, "parameter", line);
                }
            }
            // not ready yet: the controller asks again
            None if status.is_state_conflict() && self.open.contains_key(&channel) => {}
            None => {
                sink.note(Weight::Error, "parameter", format!("answer refused: {status}"));
            }
        }
    }
}

//! Parameter jobs inside records: requests with names, answers matched with them.

use std::net::Ipv4Addr;
use std::time::Duration;

use profinet::wire::PnioStatus;
use profinet::wire::Uuid;
use profinet::wire::block::{ReadRequest, WriteRequest};

use super::event::{Detail, Job, Origin, Record, Sink, Trouble};
use super::names::seconds;
use super::pending::{CUT_OFF, Pending};
use super::records::number;
use crate::Weight;
use crate::job::{self, Decoded, JobDrive};

/// Time for the answer to a request: clients read it again and again for some 10 s.
const TIMEOUT: Duration = Duration::from_secs(10);

/// Longest request stored for its response. Requests of drives have 240 octets.
const MAX_REQUEST: usize = 4096;

/// Returns true for the records that carry parameter jobs.
pub const fn is_parameter_record(index: u16) -> bool {
    matches!(index, 0x002F | 0xB02E | 0xB02F)
}

/// Which drive, and the record of which connection.
type Channel = (Ipv4Addr, Uuid, u16, u16, u16);

/// Requests that wait for their answer.
#[derive(Debug, Default)]
pub struct Jobs {
    open: Pending<Channel, Asked>,
    /// The request that was answered last.
    answered: Option<Asked>,
}

#[derive(Debug, Default)]
struct Asked {
    origin: Origin,
    data: Vec<u8>,
}

impl Jobs {
    /// Returns the request that the last response answered.
    pub fn answered(&self) -> Option<&[u8]> {
        self.answered.as_ref().map(|asked| asked.data.as_slice())
    }

    /// A request was written to a drive.
    pub fn request(
        &mut self,
        at: Ipv4Addr,
        drive: &mut JobDrive,
        write: &WriteRequest,
        data: &[u8],
        sink: &mut Sink<'_>,
    ) {
        report(job::request_job(drive, data), None, sink);
        let channel = (at, write.ar_uuid, write.slot, write.subslot, write.index);
        let asked = Asked {
            origin: sink.origin(),
            data: data
                .get(..data.len().min(MAX_REQUEST))
                .unwrap_or_default()
                .to_vec(),
        };
        self.open.insert(channel, sink.at + TIMEOUT, asked);
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
                let asked = self.open.remove(&channel);
                let request = asked.as_ref().map(|asked| asked.data.as_slice());
                let frame = asked.as_ref().map(|asked| asked.origin.frame);
                report(job::response_job(drive, data, request), frame, sink);
                if asked.is_none() {
                    let what = "parameter request".to_owned();
                    let text = format!("answer to a {what} that is not in the capture");
                    sink.report(
                        Weight::Warning,
                        "parameter",
                        text,
                        Detail::Trouble(Trouble::Unasked { what }),
                    );
                }
                self.answered = asked;
            }
            // not ready yet: the controller reads again
            None if status.is_state_conflict() && self.open.get_mut(&channel).is_some() => {}
            None => {
                self.open.remove(&channel);
                let detail = Record {
                    service: "read",
                    api: read.api,
                    slot: read.slot,
                    subslot: read.subslot,
                    index: read.index,
                    status: Some(number(status)),
                    ..Record::default()
                };
                let text = format!("answer refused: {status}");
                sink.report(Weight::Error, "parameter", text, Detail::Record(detail));
            }
        }
    }

    /// Reports the requests whose answer was not read until `now`.
    pub fn give_up(&mut self, now: Duration, sink: &mut Sink<'_>) {
        while let Some((deadline, asked)) = self.open.due(now) {
            let waited = deadline.min(sink.at).saturating_sub(asked.origin.at);
            if waited < CUT_OFF {
                continue;
            }
            let reference = asked.data.first().copied().unwrap_or(0);
            let what = format!("parameter request {reference}");
            let text = format!("{what}: no answer was read within {}", seconds(waited));
            let trouble = Trouble::Unanswered {
                what,
                sent: 1,
                waited,
            };
            sink.report_of(
                asked.origin,
                Weight::Warning,
                "parameter",
                text,
                Detail::Trouble(trouble),
            );
        }
    }
}

/// Reports a job, one event for each of its lines; its numbers are in the first.
fn report(decoded: Decoded, request_frame: Option<u64>, sink: &mut Sink<'_>) {
    let mut fields = Some(decoded.fields);
    let mut refused = decoded.refused.into_iter().peekable();
    for (place, (weight, line)) in decoded.lines.into_iter().enumerate() {
        let detail = Job {
            channel: "record",
            job: fields.take().unwrap_or_default(),
            request_frame,
            refused: refused.next_if(|(line, _)| *line == place).map(|(_, one)| one),
        };
        sink.report(weight, "parameter", line, Detail::Job(detail));
    }
}

#[cfg(test)]
mod tests {
    use super::super::event::Party;
    use super::*;

    #[test]
    fn of_a_long_request_the_beginning_is_stored() {
        let mut jobs = Jobs::default();
        let at = Ipv4Addr::new(10, 0, 0, 2);
        let write = WriteRequest {
            sequence: 1,
            ar_uuid: Uuid([9; 16]),
            api: 0x3A00,
            slot: 1,
            subslot: 1,
            index: 0xB02E,
            length: 60_000,
        };
        let mut sink = Sink {
            frame: 1,
            at: Duration::ZERO,
            source: Party::default(),
            target: Party::default(),
            events: &mut Vec::new(),
        };
        jobs.request(at, &mut JobDrive::default(), &write, &[1; 60_000], &mut sink);
        let channel = (at, write.ar_uuid, write.slot, write.subslot, write.index);
        let stored = jobs.open.get_mut(&channel).unwrap();
        assert_eq!(stored.data, [1; 4096]);
    }
}

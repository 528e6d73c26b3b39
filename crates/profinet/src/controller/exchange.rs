//! Records and cyclic data of a controller's connections.

use alloc::boxed::Box;
use alloc::vec::Vec;
use core::net::SocketAddrV4;
use core::time::Duration;

use super::Controller;
use super::ar::Owner;
use super::calls::Op;
use super::config::Target;
use super::error::Misuse;
use super::event::{ArId, CallId};
use super::job::Job;
use super::phase::Phase;
use super::record::{self, MAX_RECORD};
use crate::cyclic::{Consumer, CyclicStatistics, Provider};
use crate::wire::Uuid;
use crate::wire::block::RecordAddress;
use crate::wire::rpc::{Header, operation};
use crate::wire::rt::{DataStatus, Iops};
use crate::{Instant, RPC_PORT};

/// Records.
impl Controller {
    /// Reads a record of at most `length` octets. Event: `RecordDone`.
    ///
    /// # Errors
    /// When there is no such connection, it takes no records at present, or too many requests wait.
    pub fn read(&mut self, now: Instant, ar: ArId, at: RecordAddress, length: u32) -> Result<CallId, Misuse> {
        if length > MAX_RECORD {
            return Err(Misuse::Range("record length"));
        }
        self.call(now, ar, |call| Op::Read { call, at, length })
    }

    /// Writes a record. Event: `RecordDone` without data.
    ///
    /// # Errors
    /// When there is no such connection, it takes no records at present, or too many requests wait.
    pub fn write(
        &mut self,
        now: Instant,
        ar: ArId,
        at: RecordAddress,
        data: &[u8],
    ) -> Result<CallId, Misuse> {
        if data.len() > MAX_RECORD as usize {
            return Err(Misuse::Range("record length"));
        }
        self.call(now, ar, |call| Op::Write {
            call,
            at,
            data: data.to_vec(),
        })
    }

    /// Writes several records in one request. Event: `WritesDone`.
    ///
    /// # Errors
    /// When there is no such connection, it takes no records at present, or too much is to be written at once.
    pub fn write_multiple(
        &mut self,
        now: Instant,
        ar: ArId,
        records: &[(RecordAddress, Vec<u8>)],
    ) -> Result<CallId, Misuse> {
        let octets: usize = records.iter().map(|(_, data)| data.len() + 64 + 3).sum();
        if records.is_empty() || octets > MAX_RECORD as usize {
            return Err(Misuse::Range("length of all records"));
        }
        self.call(now, ar, |call| Op::WriteMany {
            call,
            records: records.to_vec(),
        })
    }

    fn call(&mut self, now: Instant, ar: ArId, op: impl FnOnce(CallId) -> Op) -> Result<CallId, Misuse> {
        let index = self.records_index(ar)?;
        let call = self.new_call();
        let op = op(call);
        let taken = self.with(now, index, |ar, shared| ar.push(shared, op));
        if taken {
            Ok(call)
        } else {
            Err(Misuse::TooMany("record requests"))
        }
    }

    /// Executes one job on a parameter channel: writes `request` to the record, reads the answer from it, waits and
    /// repeats while the device answers "not ready" (10 to 50 ms apart, 10 s altogether unless configured otherwise).
    /// Jobs of a connection are executed one after the other. Event: `RecordDone` with the answer.
    ///
    /// # Errors
    /// When there is no such connection, it takes no records at present, or too many requests wait.
    pub fn parameter_job(
        &mut self,
        now: Instant,
        ar: ArId,
        at: RecordAddress,
        request: &[u8],
    ) -> Result<CallId, Misuse> {
        self.parameter_job_within(now, ar, at, request, self.config.timeouts.parameter_job)
    }

    /// As [`parameter_job`](Self::parameter_job), but the device may be "not ready" for no longer than `limit`.
    ///
    /// # Errors
    /// When there is no such connection, it takes no records at present, or too many requests wait.
    pub fn parameter_job_within(
        &mut self,
        now: Instant,
        ar: ArId,
        at: RecordAddress,
        request: &[u8],
        limit: Duration,
    ) -> Result<CallId, Misuse> {
        if request.len() > MAX_RECORD as usize {
            return Err(Misuse::Range("record length"));
        }
        let index = self.records_index(ar)?;
        let call = self.new_call();
        let job = Job::new(now, call, at, request.to_vec(), limit);
        let taken = self.with(now, index, |ar, shared| ar.push_job(shared, job));
        if taken {
            Ok(call)
        } else {
            Err(Misuse::TooMany("parameter jobs"))
        }
    }

    /// Reads a record without a connection. Event: `RecordDone`.
    ///
    /// # Errors
    /// When the target has no IP address, or too many requests are open.
    pub fn read_implicit(
        &mut self,
        now: Instant,
        target: &Target,
        at: RecordAddress,
        length: u32,
    ) -> Result<CallId, Misuse> {
        if !target.ip.is_set() {
            return Err(Misuse::Incomplete("IP address"));
        }
        if length > MAX_RECORD {
            return Err(Misuse::Range("record length"));
        }
        if self.owners.len() >= 4096 {
            return Err(Misuse::TooMany("record requests"));
        }
        let call = self.new_call();
        let asker = record::Asker {
            sequence: 0,
            ar_uuid: Uuid::NIL,
        };
        let request = record::read_request(asker, at, length, Uuid::NIL);
        let object = Uuid::object(target.instance, target.device_id, target.vendor_id);
        let header = Header::request(
            object,
            Uuid::DEVICE_INTERFACE,
            self.uuids.uuid(),
            0,
            operation::READ_IMPLICIT,
        );
        let server = SocketAddrV4::new(target.ip.address, RPC_PORT);
        let id = self.rpc.call(now, server, header, record::read_stub(&request));
        self.owners.insert(
            id,
            Owner::Implicit {
                call,
                request: Box::new(request),
            },
        );
        Ok(call)
    }
}

/// Cyclic data.
impl Controller {
    /// Sets a submodule's output for the next frames.
    ///
    /// # Errors
    /// When there is no such connection, or `data` has another length than agreed.
    pub fn set_output(&mut self, ar: ArId, slot: u16, subslot: u16, data: &[u8]) -> Result<(), Misuse> {
        let index = self.index(ar)?;
        let ar = self.ars.get_mut(index).ok_or(Misuse::UnknownConnection)?;
        let state = ar.output_state();
        let provider = ar.provider.as_mut().ok_or(Misuse::NoSuchData)?;
        if provider.set_data(slot, subslot, data, state) {
            Ok(())
        } else {
            Err(Misuse::NoSuchData)
        }
    }

    /// Lets the outputs be valid (run) or not (stop): DataStatus bit 4 and the IOPS of all outputs. Frames continue.
    ///
    /// # Errors
    /// When there is no such connection.
    pub fn set_run(&mut self, ar: ArId, run: bool) -> Result<(), Misuse> {
        let index = self.index(ar)?;
        let ar = self.ars.get_mut(index).ok_or(Misuse::UnknownConnection)?;
        ar.run = run;
        ar.apply_run();
        Ok(())
    }

    /// Latest input of a submodule with its IOPS. After the connection ended: the last data, IOPS bad.
    #[must_use]
    pub fn input(&self, ar: ArId, slot: u16, subslot: u16) -> Option<(&[u8], Iops)> {
        let ar = self.get(ar)?;
        let (data, iops) = ar.consumer.as_ref()?.data(slot, subslot)?;
        Some((
            data,
            if ar.phase == Phase::Closed {
                Iops::BAD_CONTROLLER
            } else {
                iops
            },
        ))
    }

    /// Returns the output data of a submodule in the next frame.
    #[must_use]
    pub fn output(&self, ar: ArId, slot: u16, subslot: u16) -> Option<(&[u8], Iops)> {
        self.get(ar)?.provider.as_ref()?.data(slot, subslot)
    }

    /// Returns whether the device takes the outputs of a submodule: its IOCS.
    #[must_use]
    pub fn output_consumed(&self, ar: ArId, slot: u16, subslot: u16) -> Option<Iops> {
        self.get(ar)?.consumer.as_ref()?.iocs(slot, subslot)
    }

    /// Status the device sent last.
    #[must_use]
    pub fn input_status(&self, ar: ArId) -> Option<DataStatus> {
        self.get(ar)?.consumer.as_ref().map(Consumer::status)
    }

    /// Returns the counters of received frames; they stay readable after the connection ended.
    #[must_use]
    pub fn statistics(&self, ar: ArId) -> Option<CyclicStatistics> {
        self.get(ar)?.consumer.as_ref().map(Consumer::statistics)
    }

    /// Frames sent, and intervals in which none was.
    #[must_use]
    pub fn sent(&self, ar: ArId) -> Option<(u64, u64)> {
        self.get(ar)?.provider.as_ref().map(|p| (p.sent(), p.skipped()))
    }

    /// Returns the time when the next output frame leaves: outputs set before are in it.
    #[must_use]
    pub fn next_cycle(&self, ar: ArId) -> Option<Instant> {
        let ar = self.get(ar)?;
        ar.provider
            .as_ref()
            .filter(|_| ar.phase.is_cyclic())
            .map(Provider::next_send)
    }
}

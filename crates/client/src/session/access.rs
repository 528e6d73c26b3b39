//! Records: over the connection of an axis where there is one, else on the first [way](Route) that is open.

use std::sync::Arc;
use std::time::Duration;

use profinet::controller::{ArId, CallId, LostCause, Misuse, RecordAddress, Resolve, ServiceError, Target};
use profinet::rpc::PathCount;
use profinet::wire::{PnioStatus, Uuid};
use profinet::{Instant, MacAddress};
use std::net::Ipv4Addr;

use super::axis::Place;
use super::route::{Routes, is_no_service, refusal};
use super::temporary::Work;
use super::{Session, locked};
use crate::absent::{Absent, Looks};
use crate::engine::{At, Queues, Turn, at};
use crate::line::Answered;
use crate::{Client, Connection, Drive, Error, Link, Route, RouteNotice};

/// Longer than a connect may take with its repetitions.
const CONNECT_LIMIT: Duration = Duration::from_secs(90);
/// Longer than a record call may take.
const RECORD_LIMIT: Duration = Duration::from_secs(90);
/// How long a release may take.
const RELEASE_LIMIT: Duration = Duration::from_secs(10);

/// The field of the answer to a connect that identifies its owner.
const RESPONDER: &str = "CMResponderMacAdd";

/// Largest record requested.
const MAX_RECORD: u32 = 4096;

/// Connections for records, shared by all callers.
#[derive(Debug, Default)]
pub(crate) struct Records {
    access: Vec<Access>,
    /// What turned out about the ways to drives.
    pub(super) routes: Vec<Routes>,
    /// Reference of the last parameter request.
    pub(super) reference: u8,
    /// The axes that were taken.
    pub(super) axes: Vec<Place>,
    /// Where drives are whose axes are being taken.
    taking: Vec<At>,
    /// Settings that are changed for some piece of work.
    pub(super) temporary: Vec<Arc<Work>>,
    /// Queued callers of each drive.
    pub(crate) queues: Queues,
}

impl Records {
    /// Returns whether an axis of this drive is being brought to rest, or settings of it are being put back.
    pub(super) fn ends_work(&mut self, drive: &Drive) -> bool {
        self.forget_ended();
        self.axes.iter().any(|axis| axis.is_of(drive) && axis.is_ending())
            || self
                .temporary
                .iter()
                .any(|work| work.is_of(drive) && work.is_ending())
    }

    /// Returns whether an axis is being brought to rest, or settings are being put back.
    pub(super) fn ends_any_work(&mut self) -> bool {
        self.forget_ended();
        self.axes.iter().any(Place::is_ending) || self.temporary.iter().any(|work| work.is_ending())
    }

    /// Returns whether an axis of this drive is being brought to rest; while the network is left, every axis is going to be.
    pub(super) fn holds_axis(&mut self, drive: &Drive, closing: bool) -> bool {
        self.forget_ended();
        let mut own = self.axes.iter().filter(|axis| axis.is_of(drive));
        own.any(|axis| axis.is_ending() || closing && !axis.is_done())
    }

    /// Returns the connection of the axis of this drive that this program has.
    pub(super) fn own_axis(&mut self, drive: &Drive) -> Option<Link> {
        self.forget_ended();
        let mut own = self.axes.iter().filter(|axis| axis.is_of(drive));
        own.find_map(Place::held)
    }

    /// Notes that the axis of this drive is being taken. False where that is so already, or this program has the axis.
    pub(super) fn begin_taking(&mut self, drive: &Drive) -> bool {
        let is_free = self.own_axis(drive).is_none() && !self.taking.contains(&at(drive));
        if is_free {
            self.taking.push(at(drive));
        }
        is_free
    }

    /// Ends that.
    pub(super) fn end_taking(&mut self, place: At) {
        self.taking.retain(|one| *one != place);
    }

    fn forget_ended(&mut self) {
        self.axes.retain(|axis| !axis.is_over());
        self.temporary.retain(|work| !work.is_done());
    }
}

/// A connection kept for the records of one drive.
#[derive(Debug, Clone, Copy)]
pub struct Access {
    mac: MacAddress,
    ip: Ipv4Addr,
    /// The connection.
    pub ar: ArId,
    /// True for one that belongs to an axis.
    pub cyclic: bool,
    /// The way that it is.
    pub route: Route,
}

impl Access {
    const fn of(drive: &Drive, ar: ArId, cyclic: bool, route: Route) -> Self {
        Self {
            mac: drive.station.mac,
            ip: drive.station.ip.address,
            ar,
            cyclic,
            route,
        }
    }

    pub fn is_to(&self, drive: &Drive) -> bool {
        self.mac == drive.station.mac && self.ip == drive.station.ip.address
    }
}

/// Returns the route to a drive for records.
pub(super) fn target(drive: &Drive) -> Target {
    Target {
        // without discovery the MAC address is learned from the answer
        mac: Some(drive.station.mac).filter(|mac| *mac != MacAddress::default()),
        ..Target::of(&drive.station)
    }
}

/// Returns the record of the parameter channel.
pub(super) const fn channel(drive: &Drive) -> RecordAddress {
    let channel = drive.model.channel;
    RecordAddress {
        api: channel.api,
        slot: channel.slot,
        subslot: channel.subslot,
        index: channel.index,
    }
}

impl Session {
    /// Opens the way to the records of a drive, if it is not open.
    ///
    /// # Errors
    /// When the drive has no address, cannot be reached or refuses.
    pub async fn open(&mut self, drive: &Drive) -> Result<(), Error> {
        if drive.is_on_line() {
            return Ok(());
        }
        let _turn = self.turn(drive).await?;
        let open = self.for_records(drive).await;
        Self::reached(drive, open).map(|_| ())
    }

    /// Waits for its turn among the requests to a drive. What a stop or a motion requests goes first.
    async fn turn(&mut self, drive: &Drive) -> Result<Turn, Error> {
        let urgent = self.is_hurried();
        let turn = self.engine.turn_at(drive, urgent, self.due()).await?;
        self.glance()?;
        Ok(turn)
    }

    /// Returns the connection that records are read over, opened if necessary; `None` where they are read without one.
    async fn for_records(&mut self, drive: &Drive) -> Result<Option<ArId>, Error> {
        if let Some(ar) = self.beside_controller(drive).await? {
            return Ok(Some(ar));
        }
        if !self.is_closed(drive, Route::Implicit) {
            return Ok(None);
        }
        self.as_controller(drive).await.map(Some)
    }

    /// Returns the connection for parameter jobs, opened if necessary.
    pub(super) async fn for_parameters(&mut self, drive: &Drive) -> Result<ArId, Error> {
        match self.beside_controller(drive).await? {
            Some(ar) => Ok(ar),
            None => self.as_controller(drive).await,
        }
    }

    /// Returns a connection that is open already, else device access; `None` where the device refuses that.
    async fn beside_controller(&mut self, drive: &Drive) -> Result<Option<ArId>, Error> {
        if let Some(known) = self.access_to(drive, |_| true) {
            match self.connection(known.ar) {
                Connection::Lost(_) | Connection::Silent | Connection::Released => self.drop_access(known.ar),
                // begun by a call that was interrupted
                Connection::Opening => return self.opened(drive, known).await,
                Connection::Open | Connection::Running => return Ok(Some(known.ar)),
            }
        }
        if !drive.station.ip.is_set() {
            return Err(Error::NoIpAddress { drive: drive.label() });
        }
        let route = Route::DeviceAccess;
        if self.is_closed(drive, route) {
            return Ok(None);
        }
        if drive.device_access == Some(false) {
            self.close_route(drive, route, "its device description declares none".into());
            return Ok(None);
        }
        let now = self.now();
        let ar = self
            .client()
            .controller()
            .connect_device_access(now, target(drive), Resolve::Trust)?;
        let access = self.remember(drive, ar, route);
        self.opened(drive, access).await
    }

    /// Notes a connection for records. It is known before it is open: whoever interrupts the wait leaves nothing behind
    /// at the drive.
    pub(super) fn remember(&mut self, drive: &Drive, ar: ArId, route: Route) -> Access {
        let access = Access::of(drive, ar, false, route);
        self.engine.records().access.push(access);
        access
    }

    /// Returns the ARUUIDs of the connections for records to a drive.
    pub(super) fn record_ars(&self, drive: &Drive) -> Vec<Uuid> {
        let own = self.accesses(drive).into_iter();
        let client = self.client();
        own.filter_map(|ar| client.controller_ref().ar_uuid(ar)).collect()
    }

    /// Waits until a connection for records is open; `None` when the device refuses this kind of connection.
    pub(super) async fn opened(&mut self, drive: &Drive, access: Access) -> Result<Option<ArId>, Error> {
        let Access { ar, route, .. } = access;
        let limit = self.end_of(CONNECT_LIMIT) - self.now();
        let end = self
            .wait(CONNECT_LIMIT, |client| match client.connection(ar) {
                Connection::Opening => None,
                other => Some(other),
            })
            .await?;
        match end {
            Some(Connection::Lost(cause)) => {
                self.drop_access(ar);
                // who has the one connection may go: the way is not closed by that
                let owned = route == Route::Controller && is_owned(&cause);
                match refusal(&cause).filter(|_| !owned) {
                    Some(reason) => {
                        self.close_route(drive, route, reason);
                        Ok(None)
                    }
                    None => Err(self.connect_error(drive, cause, None).await),
                }
            }
            Some(_) => {
                let details = String::new();
                if route == Route::DeviceAccess {
                    self.describe_route(drive, &RouteNotice::Taken { route, details });
                }
                Ok(Some(ar))
            }
            None => {
                self.release(ar.into()).await?;
                Err(Error::Timeout {
                    drive: drive.label(),
                    what: "connecting",
                    limit,
                })
            }
        }
    }

    /// Returns the first connection to a drive that is like this.
    pub(super) fn access_to(&self, drive: &Drive, like: impl Fn(&Access) -> bool) -> Option<Access> {
        let records = self.engine.records();
        let mut own = records.access.iter().filter(|access| access.is_to(drive));
        own.find(|access| like(access)).copied()
    }

    /// Returns the connections for record access to a drive.
    pub(super) fn accesses(&self, drive: &Drive) -> Vec<ArId> {
        let records = self.engine.records();
        let own = records.access.iter();
        own.filter(|access| !access.cyclic && access.is_to(drive))
            .map(|access| access.ar)
            .collect()
    }

    /// Remembers the cyclic connection of an axis: records of its drive go through it too.
    pub(super) fn share(&mut self, drive: &Drive, ar: ArId) {
        let mut records = self.engine.records();
        records.access.retain(|access| access.ar != ar);
        records
            .access
            .insert(0, Access::of(drive, ar, true, Route::Controller));
    }

    /// Records do not go through a connection any more. What became of the connection of an axis stays known until the
    /// axis is released.
    pub(super) fn drop_access(&mut self, ar: ArId) {
        let of_axis = {
            let mut records = self.engine.records();
            let of_axis = records
                .access
                .iter()
                .any(|access| access.ar == ar && access.cyclic);
            records.access.retain(|access| access.ar != ar);
            of_axis
        };
        if !of_axis {
            self.client().forget(ar);
        }
    }

    /// Forgets what is known of drives that are no more because others are in their places, and drops all connections for their
    /// parameters without a release. Calls that wait for them end with [`Error::ConnectionLost`].
    pub fn forget_all(&mut self) {
        let now = self.now();
        let ended: Vec<ArId> = {
            let mut records = self.engine.records();
            let ended = records.access.extract_if(.., |access| !access.cyclic);
            ended.map(|access| access.ar).collect()
        };
        for ar in ended {
            // one that has ended by itself is no error
            let _ = self.client().controller().abort(now, ar);
        }
        *locked(&self.absent) = Absent::default();
        *locked(&self.looks) = Looks::default();
        self.engine.stir();
    }

    /// Closes every connection for record access.
    ///
    /// # Errors
    /// When the medium fails.
    pub async fn close(&mut self) -> Result<(), Error> {
        self.close_within(RELEASE_LIMIT).await
    }

    /// Closes the connections for record access to one drive: others of this session, and of its other callers, stay open.
    ///
    /// # Errors
    /// When the medium fails.
    pub async fn close_to(&mut self, drive: &Drive) -> Result<(), Error> {
        for ar in self.accesses(drive) {
            self.release_within(ar, RELEASE_LIMIT).await?;
        }
        Ok(())
    }

    /// Closes every connection for record access, waiting for each as long as given.
    pub(super) async fn close_within(&mut self, limit: Duration) -> Result<(), Error> {
        let open: Vec<ArId> = {
            let records = self.engine.records();
            let own = records.access.iter().filter(|access| !access.cyclic);
            own.map(|access| access.ar).collect()
        };
        for ar in open {
            self.release_within(ar, limit).await?;
        }
        Ok(())
    }

    /// Releases the connection as IO controller that was opened for records: the place is needed for an axis.
    pub(super) async fn make_way(&mut self, drive: &Drive) -> Result<(), Error> {
        let own = |access: &Access| !access.cyclic && access.route == Route::Controller;
        match self.access_to(drive, own) {
            Some(access) => self.release_within(access.ar, RELEASE_LIMIT).await,
            None => Ok(()),
        }
    }

    /// Releases a connection and waits for its end.
    pub(super) async fn release(&mut self, link: Link) -> Result<(), Error> {
        match link {
            Link::ArListEntry(ar) => self.release_within(ar, RELEASE_LIMIT).await,
            Link::Slave(slave) => {
                self.client().forget(slave);
                Ok(())
            }
        }
    }

    async fn release_within(&mut self, ar: ArId, limit: Duration) -> Result<(), Error> {
        let open = matches!(
            self.connection(ar),
            Connection::Open | Connection::Running | Connection::Opening
        );
        let now = self.now();
        let released = open && self.client().controller().release(now, ar).is_ok();
        if released {
            let _meanwhile = self.unstoppable();
            self.wait(limit, |client| {
                matches!(client.connection(ar), Connection::Released | Connection::Lost(_)).then_some(())
            })
            .await?;
        }
        self.drop_access(ar);
        self.client().forget(ar);
        Ok(())
    }

    /// Reads a record of any submodule.
    ///
    /// # Errors
    /// When the drive cannot be reached or refuses.
    pub async fn read_record(&mut self, drive: &Drive, at: RecordAddress) -> Result<Vec<u8>, Error> {
        let _turn = self.turn(drive).await?;
        let read = self.read_record_now(drive, at).await;
        Self::reached(drive, read)
    }

    async fn read_record_now(&mut self, drive: &Drive, at: RecordAddress) -> Result<Vec<u8>, Error> {
        if drive.is_on_line() {
            let (drive, what) = (drive.label(), "record");
            return Err(Error::NotOnLine { drive, what });
        }
        let what = || {
            format!(
                "reading record 0x{:04X} of slot {} subslot 0x{:X}",
                at.index, at.slot, at.subslot
            )
        };
        loop {
            if let Some(ar) = self.for_records(drive).await? {
                return self
                    .call(drive, ar, &what, |client, now, ar| {
                        client.controller().read(now, ar, at, MAX_RECORD)
                    })
                    .await;
            }
            match self.read_implicitly(drive, at).await? {
                Ok(data) => return Ok(data),
                // the next way is tried
                Err(_) if self.is_closed(drive, Route::Implicit) => {}
                Err(error) => {
                    return Err(Error::Record {
                        drive: drive.label(),
                        what: what(),
                        error,
                    });
                }
            }
        }
    }

    /// Reads a record without a connection. A device that serves no such reads closes this way.
    pub(super) async fn read_implicitly(
        &mut self,
        drive: &Drive,
        at: RecordAddress,
    ) -> Result<Result<Vec<u8>, ServiceError>, Error> {
        let now = self.now();
        let call = self
            .client()
            .controller()
            .read_implicit(now, &target(drive), at, MAX_RECORD)?;
        let result = self.wait(RECORD_LIMIT, |client| client.take_record(call)).await?;
        let result = result.unwrap_or(Err(ServiceError::Timeout {
            what: "implicit read",
            path: PathCount::default(),
        }));
        match &result {
            Err(error) if is_no_service(error) => self.close_route(drive, Route::Implicit, error.to_string()),
            // a device that is there and never answers this service does not serve it
            Err(error @ ServiceError::Timeout { .. }) => {
                if !self.reads_implicitly(drive) {
                    self.close_route(drive, Route::Implicit, error.to_string());
                }
            }
            _ => self.take_implicit(drive),
        }
        Ok(result)
    }

    /// One parameter job over the parameter channel of the drive.
    pub(super) async fn job(&mut self, drive: &Drive, request: &[u8]) -> Result<Answered, Error> {
        let _turn = self.turn(drive).await?;
        let done = self.job_now(drive, request).await;
        Self::reached(drive, done)
    }

    async fn job_now(&mut self, drive: &Drive, request: &[u8]) -> Result<Answered, Error> {
        if let Some(slave) = drive.slave {
            return self.line_job(drive, slave, request).await;
        }
        let what = || "parameter access".to_owned();
        let ar = self.for_parameters(drive).await?;
        let time = self.time_for_answer();
        let octets = self
            .call(drive, ar, &what, |client, now, ar| {
                let (controller, at) = (client.controller(), channel(drive));
                match time {
                    Some(time) => controller.parameter_job_within(now, ar, at, request, time),
                    None => controller.parameter_job(now, ar, at, request),
                }
            })
            .await?;
        self.manner().first_answer = None;
        Ok(Answered::by_record(octets))
    }

    async fn call(
        &mut self,
        drive: &Drive,
        ar: ArId,
        what: &(dyn Fn() -> String + Sync),
        start: impl FnOnce(&mut Client, Instant, ArId) -> Result<CallId, Misuse> + Send,
    ) -> Result<Vec<u8>, Error> {
        let now = self.now();
        let started = start(&mut self.client(), now, ar);
        let call = match started {
            Ok(call) => call,
            // it ended meanwhile: no mistake of the caller
            Err(Misuse::UnknownConnection | Misuse::NotOpenYet) => {
                return Err(self.lost_access(drive, ar, "record access"));
            }
            Err(misuse) => return Err(misuse.into()),
        };
        let limit = self.end_of(RECORD_LIMIT) - now;
        match self.wait(RECORD_LIMIT, |client| client.take_record(call)).await? {
            Some(Ok(data)) => Ok(data),
            Some(Err(ServiceError::Closed { what: service })) => Err(self.lost_access(drive, ar, service)),
            // a drive that has restarted does not know the connection any more
            Some(Err(_)) if matches!(self.connection(ar), Connection::Lost(_)) => {
                Err(self.lost_access(drive, ar, "record access"))
            }
            Some(Err(error)) => Err(Error::Record {
                drive: drive.label(),
                what: what(),
                error,
            }),
            None => Err(Error::Timeout {
                drive: drive.label(),
                what: "record access",
                limit,
            }),
        }
    }

    /// Returns the error of a call whose connection is gone.
    fn lost_access(&mut self, drive: &Drive, ar: ArId, what: &'static str) -> Error {
        let cause = match self.connection(ar) {
            Connection::Lost(cause) => cause,
            _ => LostCause::Service(ServiceError::Closed { what }),
        };
        self.drop_access(ar);
        Error::ConnectionLost {
            drive: drive.label(),
            cause,
            reaction: None,
        }
    }

    /// Waits until a cyclic connection carries valid data.
    pub(super) async fn running(&mut self, drive: &Drive, link: Link) -> Result<(), Error> {
        let running = self.running_now(drive, link).await;
        Self::reached(drive, running)
    }

    async fn running_now(&mut self, drive: &Drive, link: Link) -> Result<(), Error> {
        let limit = self.end_of(CONNECT_LIMIT) - self.now();
        let end = self
            .wait(CONNECT_LIMIT, |client| match client.connection(link) {
                Connection::Opening | Connection::Open => None,
                other => Some(other),
            })
            .await?;
        match end {
            Some(Connection::Running) => Ok(()),
            Some(Connection::Lost(cause)) => {
                self.client().forget(link);
                // records may be read beside the controller that has it
                let owner = if is_owned(&cause) {
                    self.owner(drive).await
                } else {
                    Ok(None)
                };
                Err(self
                    .connect_error(drive, cause, owner.ok().flatten().flatten())
                    .await)
            }
            Some(Connection::Silent) => {
                self.client().forget(link);
                Err(Error::LineSilent {
                    drive: drive.label(),
                    reaction: None,
                })
            }
            _ => {
                self.client().forget(link);
                Err(Error::Timeout {
                    drive: drive.label(),
                    what: "cyclic data",
                    limit,
                })
            }
        }
    }
}

impl Session {
    /// Returns the error of a failed connection. A refusal because another controller, `owner`, is connected, and an
    /// answer of another station have kinds of their own, as the user can act on them.
    async fn connect_error(&mut self, drive: &Drive, cause: LostCause, owner: Option<String>) -> Error {
        if is_owned(&cause) {
            return Error::OwnedByController {
                drive: drive.label(),
                controller: owner,
                cause: cause.to_string(),
            };
        }
        if is_of_other_device(&cause) {
            return Error::SharedAddress {
                drive: drive.label(),
                ip: drive.station.ip.address,
                macs: self.holders(drive).await.unwrap_or_default(),
            };
        }
        Error::Connect {
            drive: drive.label(),
            cause,
        }
    }
}

/// Returns true if another controller has the one cyclic connection.
pub(super) fn is_owned(cause: &LostCause) -> bool {
    match cause {
        LostCause::Service(ServiceError::Refused { status, .. }) => out_of_ars(*status),
        LostCause::AbortedByPeer(status) => out_of_ars(*status),
        _ => false,
    }
}

/// Returns whether the answer to a connect came from another device than the one meant.
fn is_of_other_device(cause: &LostCause) -> bool {
    let LostCause::Service(ServiceError::Mismatch { field, .. }) = cause else {
        return false;
    };
    *field == RESPONDER
}

/// RPC "out of AR resources" or "out of provider, consumer or alarm resources": another controller has the one cyclic
/// connection.
const fn out_of_ars(status: PnioStatus) -> bool {
    status.code1 == 0x40 && matches!(status.code2, 0x04 | 0x07)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two drives with one IP address: the answer of the other one is known for what it is.
    #[test]
    fn an_answer_of_another_device_is_a_shared_address() {
        let mismatch = |field| {
            LostCause::Service(ServiceError::Mismatch {
                what: "connect",
                field,
            })
        };
        assert!(is_of_other_device(&mismatch(RESPONDER)));
        assert!(!is_of_other_device(&mismatch("ARUUID")));
        let mac = |last| MacAddress([2, 0, 0, 0, 0, last]);
        let error = Error::SharedAddress {
            drive: "b-1".into(),
            ip: Ipv4Addr::new(10, 0, 0, 11),
            macs: vec![mac(1), mac(2)],
        };
        assert_eq!(
            error.to_string(),
            "b-1: another device answers at 10.0.0.11: 02:00:00:00:00:01 and 02:00:00:00:00:02 have this IP address"
        );
        assert!(
            error
                .advice()
                .is_some_and(|advice| advice.to_string().contains("[address MAC]"))
        );
    }
}

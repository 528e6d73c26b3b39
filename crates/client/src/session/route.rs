//! How the records of a drive are reached: which ways a device refuses, and the one in use.

use std::net::Ipv4Addr;

use profinet::MacAddress;
use profinet::controller::{LostCause, ServiceError};
use profinet::wire::PnioStatus;
use profinet::wire::status::{DECODE_RECORD, record};

use super::{Session, locked, shared};
use crate::{ClosedRoute, Drive, Error, Route, RouteNotice};

/// What is known about the ways to one drive.
#[derive(Debug, Clone)]
pub(super) struct Routes {
    mac: MacAddress,
    ip: Ipv4Addr,
    closed: Vec<ClosedRoute>,
    /// Implicit reads are in use and were reported.
    implicit: bool,
}

impl Routes {
    fn is_to(&self, drive: &Drive) -> bool {
        self.mac == drive.station.mac && self.ip == drive.station.ip.address
    }
}

impl Session {
    /// Reports each step on the way to the records of a drive to `follow`: the drive's name and what happened. It
    /// holds for this session and the clones that are made of it from now on.
    pub fn follow_routes(&mut self, follow: impl FnMut(&str, &RouteNotice) + Send + 'static) {
        self.route_follower = shared(Box::new(follow));
    }

    /// Returns the way on which records of a drive are read, once one was taken.
    #[must_use]
    pub fn route(&self, drive: &Drive) -> Option<Route> {
        let open = self.access_to(drive, |_| true);
        let implicit = || self.reads_implicitly(drive).then_some(Route::Implicit);
        open.map(|access| access.route).or_else(implicit)
    }

    /// Returns the ways to a drive that turned out to be closed, in the order in which they were tried.
    #[must_use]
    pub fn closed_routes(&self, drive: &Drive) -> Vec<ClosedRoute> {
        self.routes_to(drive, |routes| routes.closed.clone())
    }

    /// Returns the known routes to a drive, for reading and writing.
    fn routes_to<T>(&self, drive: &Drive, with: impl FnOnce(&mut Routes) -> T) -> T {
        let mut records = self.engine.records();
        let routes = &mut records.routes;
        let known = routes.iter().position(|routes| routes.is_to(drive));
        let at = known.unwrap_or_else(|| {
            routes.push(Routes {
                mac: drive.station.mac,
                ip: drive.station.ip.address,
                closed: Vec::new(),
                implicit: false,
            });
            routes.len() - 1
        });
        with(&mut routes[at])
    }

    pub(super) fn is_closed(&self, drive: &Drive, route: Route) -> bool {
        self.closed_routes(drive)
            .iter()
            .any(|closed| closed.route == route)
    }

    /// Notes that a way is closed for the rest of the session.
    pub(super) fn close_route(&mut self, drive: &Drive, route: Route, reason: String) {
        let closed = ClosedRoute { route, reason };
        self.describe_route(drive, &RouteNotice::Closed(closed.clone()));
        self.routes_to(drive, |routes| routes.closed.push(closed));
    }

    /// Implicit reads worked before.
    pub(super) fn reads_implicitly(&self, drive: &Drive) -> bool {
        self.routes_to(drive, |routes| routes.implicit)
    }

    /// Notes that implicit reads work.
    pub(super) fn take_implicit(&mut self, drive: &Drive) {
        let known = self.routes_to(drive, |routes| std::mem::replace(&mut routes.implicit, true));
        if !known {
            let (route, details) = (Route::Implicit, String::new());
            self.describe_route(drive, &RouteNotice::Taken { route, details });
        }
    }

    pub(super) fn describe_route(&mut self, drive: &Drive, notice: &RouteNotice) {
        (locked(&self.route_follower))(&drive.label(), notice);
    }

    /// Every way is closed.
    pub(super) fn no_route(&self, drive: &Drive) -> Error {
        Error::NoRoute {
            drive: drive.label(),
            closed: self.closed_routes(drive),
        }
    }
}

/// Returns the device answered a connect, but with a refusal: another kind of connection may be accepted.
pub(super) fn refusal(cause: &LostCause) -> Option<String> {
    match cause {
        LostCause::Service(error @ (ServiceError::Refused { .. } | ServiceError::Call { .. })) => {
            Some(error.to_string())
        }
        LostCause::AbortedByPeer(_) => Some(cause.to_string()),
        _ => None,
    }
}

/// Returns whether the device does not serve implicit reads at all; a refusal of the record itself is an answer.
pub(super) const fn is_no_service(error: &ServiceError) -> bool {
    match error {
        ServiceError::Refused { status, .. } => status.decode != DECODE_RECORD,
        ServiceError::Call { .. } => true,
        _ => false,
    }
}

/// Returns whether the state of the connection forbids the write: the device may require cyclic data first.
pub(super) const fn wants_data(error: &ServiceError) -> bool {
    const WRITE: u8 = 0xDF;
    const fn forbids(status: PnioStatus) -> bool {
        status.code == WRITE
            && status.decode == DECODE_RECORD
            && matches!(status.code1, record::STATE_CONFLICT | record::ACCESS_DENIED)
    }
    match error {
        ServiceError::NotReady { status, .. } | ServiceError::Refused { status, .. } => forbids(*status),
        _ => false,
    }
}

//! The ways to the records of a drive.

use std::fmt;

/// A way to the records of a drive. The ways are tried in this order; the choice holds for the session.
///
/// Reads of records (identification, plugged modules, diagnosis) need no connection. Parameter jobs and writes belong to
/// a connection: the answer to a job is read by the connection that wrote the request.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Route {
    /// A connection for records only (ARType 6, device access), beside any controller.
    DeviceAccess,
    /// Reads without a connection (Read Implicit), beside any controller.
    Implicit,
    /// A connection as IO controller whose outputs are never valid.
    Controller,
}

impl Route {
    /// Returns the name of the way for messages and programs.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::DeviceAccess => "device access",
            Self::Implicit => "implicit reads",
            Self::Controller => "connection as IO controller",
        }
    }
}

impl fmt::Display for Route {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// A way that is closed, and why.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ClosedRoute {
    /// The way.
    pub route: Route,
    /// What the device answered, or what its device description declares.
    pub reason: String,
}

impl fmt::Display for ClosedRoute {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.route, self.reason)
    }
}

/// A step on the way to the records of a drive, for observers.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum RouteNotice {
    /// A way is taken.
    Taken {
        /// The way.
        route: Route,
        /// Particulars; empty for none.
        details: String,
    },
    /// A way is closed; the next one is tried.
    Closed(ClosedRoute),
    /// The device accepts parameter jobs only while cyclic data is exchanged.
    StartUpEnded,
}

impl fmt::Display for RouteNotice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Taken { route, details } => {
                let what = match route {
                    Route::DeviceAccess => "records and parameters over device access (ARType 6)",
                    Route::Implicit => "records by implicit reads, without a connection",
                    Route::Controller => "parameters over a connection as IO controller with invalid outputs",
                };
                f.write_str(what)?;
                if details.is_empty() {
                    Ok(())
                } else {
                    write!(f, ": {details}")
                }
            }
            Self::Closed(closed) => write!(f, "no {closed}"),
            Self::StartUpEnded => f.write_str(
                "the device accepts no parameter jobs during start-up: start-up ended, outputs stay invalid",
            ),
        }
    }
}

//! Client for drives: finds and identifies them, reads and writes their parameters, runs their axes.
//!
//! The profile (`profile`) and the controller (`profinet::controller`) meet here. Still no I/O: a
//! [`Medium`](profinet::Medium) carries the bytes. [`Client`] is the state machine, for programs with a loop of their own.
//! An [`Engine`] shares it between any number of callers, and a [`Driver`] carries its bytes: the calls of a [`Session`] are
//! futures that need no runtime; [`Wait::wait`] waits for one.
//!
//! | to | use |
//! |---|---|
//! | find, name, address, blink, reset | [`Session::scan`], [`Session::find`], [`Session::set_name`], [`Session::set_ip`], .. |
//! | identify and diagnose | [`Session::info`], [`Session::status`] with [`status::diagnose`], [`Session::faults`], [`Session::snapshot`] |
//! | read and write | [`Session::read`], [`Session::write`] with [`profile::value`] |
//! | save, compare, restore | [`backup`], [`Session::backup`], [`Session::plan`] |
//! | change, verify, undo | [`change`], [`Session::apply`], [`Session::undo`] |
//! | open a network, or a serial line | [`Network::on`], [`Network::on_line`] with a [`Wire`] |
//! | move | [`Session::take_axis`] gives an [`Axis`], [`Axis::enable`] an [`Enabled`] one with motions; it stops when it goes |
#![forbid(unsafe_code)]

mod absent;
mod action;
mod address;
mod authority;
pub mod axis;
pub mod backup;
mod bound;
pub mod change;
mod client;
mod drive;
mod engine;
mod error;
mod identity;
mod learn;
mod line;
mod loss;
mod mapper;
mod modules;
mod names;
mod network;
mod route;
#[cfg(feature = "serde")]
mod serial;
mod session;
pub mod status;
pub mod text;
mod wide;

pub use action::{Action, Advice, AdvicePart, Choice};
pub use address::{DriveAddress, DriveAddressError, LineAddress, Parity};
pub use authority::{AtWork, Authority, LocalControl};
pub use bound::{BoundedDrive, SpeedBound};
pub use client::{AxisView, Client, Connection, Discovered, Link};
pub use drive::Drive;
pub use engine::{Driver, Engine, Wait, Waiters, Wire, World};
pub use error::{
    ChannelCause, ChannelRefusal, Error, ErrorKind, MoveEnd, NotCarried, Refusal, Rule, WireFailure, describe,
};
pub use identity::Identity;
pub use line::LineConfig;
pub use loss::{LossAction, LossReaction, Remedy};
pub use mapper::{QueryId, Registered};
pub use modules::{VendorModule, modules_of};
pub use network::Network;
pub use route::{ClosedRoute, Route, RouteNotice};
pub use session::{
    Axis, AxisPlan, AxisSettings, AxisStatus, BeatHandle, Described, Enabled, FaultEntry, FaultReport,
    HomingSpeed, Info, JogSpeed, Keep, LoggedFault, ModeChange, Peer, PutBack, Released, ReportedLimits,
    Rest, Samples, Session, Snapshot, StopHandle, StopMeans, StopOutcome, StopWay, TemporaryChange,
    WarningEntry, WarningWatcher, Watcher, WriteMode, synchronous_speed,
};

//! PROFINET IO as a device and as a controller: protocol engines that take bytes and a time and give bytes, events
//! and the next deadline. No socket, thread or clock inside.
//!
//! The crate is independent of drives; the drive profile is carried as records and cyclic data.
//!
//! | module | what it holds |
//! |---|---|
//! | [`device`] | [`Device`](device::Device): DCP, connections, records, cyclic data and alarms of a station that is controlled |
//! | [`controller`] | [`Controller`](controller::Controller): finds, names, connects, reads and writes, exchanges data |
//! | [`cyclic`], [`alarm`], [`rpc`] | the engines both sides share |
//! | [`lldp`], [`snmp`] | neighbours, and an SNMP agent that reports them |
//! | [`wire`] | what the bytes of each PDU mean, without behaviour |
//!
//! [`Endpoint`] is the interface between an engine and its carrier, [`Medium`] carries one endpoint until an event.
#![no_std]
#![forbid(unsafe_code)]
extern crate alloc;

pub mod alarm;
pub mod controller;
pub mod cyclic;
mod deadlines;
pub mod device;
mod endpoint;
pub mod lldp;
#[cfg(test)]
mod pair;
pub mod rpc;
pub mod snmp;
mod time;
pub mod wire;

pub use deadlines::Deadlines;
pub use endpoint::{
    Endpoint, IpSuite, MAX_FRAME, MacAddress, MacAddressError, Medium, RPC_PORT, Traffic, Transmit,
};
pub use time::Instant;

//! What travels: views, builders and codes of every PROFINET PDU, without behaviour.
//!
//! Frames are decoded with a [`Reader`], which cannot read past the end and whose errors have an offset, and encoded
//! into any [`Writer`]. Numbers are big-endian except in RPC headers.

pub mod alarm;
pub mod block;
mod bytes;
pub mod dcp;
pub mod ethernet;
pub mod lldp;
pub mod record;
pub mod rpc;
pub mod rt;
pub mod snmp;
pub mod status;
mod trace;
mod uuid;

pub use bytes::{BufferTooSmall, ByteOrder, DecodeError, Problem, Reader, SliceWriter, Writer};
pub use status::PnioStatus;
pub use trace::{Field, Trace};
pub use uuid::{Uuid, UuidSource};

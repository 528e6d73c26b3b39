//! Virtual PROFIdrive drives: an axis, a parameter store and a drive model on top of a PROFINET device.
//!
//! Still no I/O: bytes and a time go in, bytes, events and the next deadline come out.
#![forbid(unsafe_code)]

pub mod axis;
pub mod drive;
pub mod model;
pub mod station;
pub mod store;

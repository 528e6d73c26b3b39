//! What one wants of a drive: find it, know it, read and write its parameters, run it.
//!
//! The profile (`profidrive`) and the controller (`profinet::controller`) meet here. Still no I/O: a
//! [`Medium`](profinet::Medium) carries the bytes.
#![forbid(unsafe_code)]

mod address;
pub mod axis;
pub mod parameter;

pub use address::{DriveAddress, DriveAddressError};

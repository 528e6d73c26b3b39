//! profidrive
#![no_std]
#![forbid(unsafe_code)]
extern crate alloc;

pub mod catalogue;
pub mod notation;
pub mod state;

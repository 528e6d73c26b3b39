//! What the whole-system tests stand on: namespaces of their own ([`Lab`]), programs in them ([`Running`]), captures at
//! the controller's end ([`Capture`]) and an independent dissector that judges them ([`judge`]).
//!
//! Everything is bounded in time and cleaned up: the namespaces are tied to the life of the test process, a program in them
//! dies with them. No real interface is ever touched.
#![forbid(unsafe_code)]

pub mod bus;
pub mod compare;
mod ends;
pub mod fuzz_targets;
pub mod judge;
mod lab;
pub mod memory;
mod process;
pub mod profinetpy;
mod programs;
pub mod rewrite;
pub mod traffic;

pub use ends::{client, simulate, simulate_at};
pub use lab::{Capture, Lab, Side};
pub use process::{Finished, Running, step};
pub use programs::{built, capture_files, peer, python, root, undisturbed, wait_until};

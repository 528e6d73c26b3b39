//! Virtual PROFIdrive drives: an axis, a parameter store and a drive model on top of a PROFINET device.
//!
//! Still no I/O: bytes and a time go in, bytes, events and the next deadline come out.
//!
//! | module | what it holds |
//! |---|---|
//! | [`station`] | [`Station`](station::Station): a drive on the network, a PROFINET device with a drive in it |
//! | [`serial`] | [`SerialStation`](serial::SerialStation): a drive at a serial line |
//! | [`description`] | [`Description`](description::Description): identity and modules, from the model or a vendor's GSDML file; the exported GSDML |
//! | [`mod@drive`] | [`Drive`](drive::Drive): state machine, process data, parameters and faults, one tick per cycle |
//! | [`axis`] | motor, load, speed loop and ramps |
//! | [`store`] | parameter values and what of them survives |
//! | [`model`] | what the drive models differ in |
#![forbid(unsafe_code)]

pub mod axis;
pub mod description;
pub mod drive;
pub mod model;
pub mod serial;
pub mod station;
pub mod store;

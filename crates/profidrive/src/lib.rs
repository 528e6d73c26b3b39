//! Drives on a real network or at a serial line: opened here, then found, read, written and run.
//!
//! ```no_run
//! use profidrive::Wait;
//!
//! let mut network = profidrive::open("eth0")?;
//! let mut drive = network.find(&"akd-1".parse()?).wait()?;
//! let selection = drive.select("DRV.ACC")?;
//! let reading = network.read_one(&mut drive, &selection).wait()?;
//! println!("{} {}", reading.number().unwrap_or_default(), reading.unit);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! The same calls work in memory, on a [`client::Session`] over a segment with virtual drives.
//!
//! | to | use |
//! |---|---|
//! | open a network interface, UDP alone or a serial line | [`open`], [`Opening`], [`open_line`] |
//! | open the way to a drive and find it, in one call | [`Opening::drive`] |
//! | end waiting calls and stop axes by Ctrl-C | [`Stop`] with [`Opening::stopped_by`] |
//! | know whether both sides can reach each other | [`reach`](reach()) |
//! | find, read, write | [`Network`], which is a [`client::Session`] |
//! | move an axis, with every safety rule | [`motion`] |
//! | restore settings, with a way back | [`settings`] |
#![forbid(unsafe_code)]

mod carrier;
#[cfg(feature = "gsdml")]
mod description;
mod drive;
mod driver;
pub mod motion;
mod open;
mod reach;
pub mod report;
pub mod settings;

pub use carrier::{CarrierError, serial_settings};
pub use client::Wait;
#[cfg(feature = "gsdml")]
pub use description::{DescriptionError, describe};
pub use drive::{DriveError, FindEvent, FindObserver};
pub use network::system::{ForcedExit, Stop};
pub use open::{Access, Network, OpenError, Opening, Way, interface, open, open_line};
pub use reach::{OtherSubnet, Reach, far, reach};

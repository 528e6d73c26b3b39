//! Drives on a real network, on a serial line or in a plant in memory: opened here, then found, read, written and run.
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
//! The same program runs without a network when its first line is another one. With the feature `simulate`,
//! `open_plant("plant.toml")` opens a plant file, `open_plan` a plant that is text in the program; its drives are virtual:
//!
//! ```
//! # #[cfg(feature = "simulate")] {
//! use profidrive::Wait;
//!
//! let plant = r#"
//!     [[drive]]
//!     name = "akd-1"
//!     ip = "192.168.0.11/24"
//!     event = [{ at = "5s", do = "fault=439" }]
//! "#;
//! let mut network = profidrive::open_plan(plant.parse()?)?;
//! let mut drive = network.find(&"akd-1".parse()?).wait()?;
//! let selection = drive.select("DRV.ACC")?;
//! let reading = network.read_one(&mut drive, &selection).wait()?;
//! assert_eq!((reading.number(), reading.unit), (Some(3000.0), "rpm/s"));
//!
//! network.pass(std::time::Duration::from_secs(5)).wait()?; // in no time: time is virtual
//! assert_eq!(network.faults(&mut drive).wait()?[0].number, 439);
//! # }
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! | to | use |
//! |---|---|
//! | open a network interface, UDP alone or a serial line | [`open`], [`Opening`], [`open_line`] |
//! | open a plant in memory (feature `simulate`) | `open_plant`, `open_plan`, `Opening::in_plant` |
//! | run a plant in memory, look at it, and join it later | `Running` |
//! | open a network and find a drive, in one call | [`Opening::drive`] |
//! | end waiting calls and stop axes by Ctrl-C | [`Stop`] with [`Opening::stopped_by`] |
//! | end the calls of one caller and stop its axes | [`StopRequests`] with [`Caller::obey`] |
//! | check whether both sides can reach each other | [`reach`](reach()) |
//! | find, read, write | [`Network`], which is a [`client::Session`] |
//! | share a network between threads or the clients of a server | [`Caller`], a clone of what a [`Network`] is |
//! | let several axes run at once | [`client::Axis`], one for each; `examples/two_axes.rs` |
//! | record every cyclic sample of an axis | [`client::Axis::samples`]; `examples/record_samples.rs` |
//! | decide by the kind of an error | [`client::ErrorKind`], [`Explained`]: kind, message and advice |
//! | select many drives and work on them side by side | [`Selector`], [`fleet`] |
//! | scan a network, and watch who comes and goes | [`scan`] |
//! | see status, identity and faults of a drive | [`inspection`] |
//! | read a machine file, apply it, replace a drive | [`machine`], [`commissioning`] |
//! | pass on what a verb reports | [`report`], [`Reported`] with its [`Outcome`] |
//! | examine this computer, its network and the way to each drive | [`doctor`] |
//! | write an archive for support, or a page for the documentation of a machine (feature `documents`) | `documents` |
//! | watch the values and faults of a drive | [`monitor`] |
//! | record signals of many drives (feature `recording`) | `recording` |
//! | read, list, describe and write parameters as people name them | [`parameters`] |
//! | move an axis, with every safety rule | [`motion`] |
//! | restore settings, with a way back | [`settings`] |
//! | keep the frames of the last minute, and follow what they mean | [`traffic`] |
//! | name, address and reset stations, with every check | [`addressing`] |
//! | read, check and show device descriptions (feature `gsdml`) | `device_description` |
#![forbid(unsafe_code)]

pub mod addressing;
mod carrier;
mod clock;
pub mod commissioning;
#[cfg(feature = "gsdml")]
mod description;
#[cfg(feature = "gsdml")]
pub mod device_description;
pub mod doctor;
#[cfg(feature = "documents")]
pub mod documents;
mod drive;
mod driver;
mod explained;
pub mod fleet;
pub mod inspection;
mod listed;
pub mod machine;
pub mod monitor;
pub mod motion;
mod open;
mod outcome;
pub mod parameters;
mod progress;
mod reach;
#[cfg(feature = "recording")]
pub mod recording;
mod remark;
pub mod report;
pub mod scan;
mod selector;
pub mod settings;
#[cfg(feature = "simulate")]
mod simulate;
mod state_folder;
pub mod traffic;

/// The features that this library was built with, by name.
///
/// ```
/// assert_eq!(profidrive::FEATURES.contains(&"gsdml"), cfg!(feature = "gsdml"));
/// ```
pub const FEATURES: &[&str] = &[
    #[cfg(feature = "documents")]
    "documents",
    #[cfg(feature = "gsdml")]
    "gsdml",
    #[cfg(feature = "raw-ethernet")]
    "raw-ethernet",
    #[cfg(feature = "recording")]
    "recording",
    #[cfg(feature = "schema")]
    "schema",
    #[cfg(feature = "simulate")]
    "simulate",
];

pub use carrier::{CarrierError, serial_settings};
/// The services of a drive, and the types of this library that come from there.
pub use client;
pub use client::Wait;
#[cfg(any(feature = "recording", feature = "documents"))]
pub use clock::date_and_time;
pub use clock::{WallClock, lasting};
#[cfg(feature = "gsdml")]
pub use description::{DescriptionError, describe};
pub use drive::{DriveError, FindEvent, FindObserver};
pub use explained::Explained;
pub use listed::listed;
pub use network::files::{StateFile, StateFileError};
pub use network::system::{First, ForcedExit, InterfaceInfo, Rank, Stop, StopRequests, now};
pub use open::{Access, Caller, Network, OpenError, Opening, Transport, interface, open, open_line};
pub use outcome::{Outcome, Reported};
/// Plants of virtual drives: their file, and what happens to them.
#[cfg(feature = "simulate")]
pub use plant;
/// The drive profile: parameters, values, telegrams, models.
pub use profile;
pub use profinet::{Instant, IpSuite, MacAddress};
pub use progress::{Part, Step, Sum};
pub use reach::{OtherSubnet, Reach, far, reach};
pub use remark::Remark;
pub use selector::{Selector, SelectorError};
#[cfg(feature = "simulate")]
pub use simulate::{Joined, Running, open_plan, open_plant};
pub use state_folder::state_folder;

//! The frames of a network as this computer sees them: those of the last minute, and what they mean.
//!
//! ```
//! # #[cfg(feature = "simulate")] {
//! use profidrive::traffic::{Traffic, Watch};
//! use profidrive::{Access, Opening, Wait};
//!
//! let plant = "[[drive]]\nname = \"akd-1\"\nip = \"10.0.0.1/24\"";
//! let traffic = Traffic::new();
//! let opening = Opening::new(Access::Records).in_plant(plant.parse()?).kept_in(&traffic);
//! let mut network = opening.open()?;
//! network.find(&"akd-1".parse()?).wait()?;
//! let mut watch = Watch::new(&traffic);
//! watch.catch_up(&mut |_| {});
//! assert!(watch.counts().frames > 0);
//! assert!(traffic.capture("plant")?.starts_with(&[0x0A, 0x0D, 0x0D, 0x0A]), "a pcapng file");
//! # }
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod keep;
mod watch;

use client::Session;
use profile::parameter::ErrorNumber;

pub use keep::{Frame, Traffic};
pub use watch::{News, Watch};

/// Returns true for a refusal that is an answer to this program: it has read a parameter to see whether a drive has it
/// ([`Session::has_looked_for`](client::Session::has_looked_for)), and the drive does not.
#[must_use]
pub fn is_own_look(event: &Event, session: &Session) -> bool {
    let Detail::Job(job) = &event.detail else {
        return false;
    };
    let (Some(refused), Some(drive)) = (job.refused, event.source.ip) else {
        return false;
    };
    refused.error == ErrorNumber::UNKNOWN_PARAMETER
        && event.target.mac == Some(session.mac())
        && session.has_looked_for(drive, refused.pnu)
}

/// Captures: their files, and what their frames mean.
pub use dissect::capture::event::Detail;
pub use dissect::capture::{Counts, DeviceSummary, Event, StreamSummary, Walker};
pub use dissect::tree::Node;
pub use dissect::{Weight, hex_bytes};
pub use network::pcap::{Captured, ReadError, Reader};

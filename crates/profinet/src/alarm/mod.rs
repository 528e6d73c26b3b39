//! The alarm connection of one application AR, the same for both sides.
//!
//! [`Alarms`] holds the two channels (high and low priority), raises and acknowledges alarms, and builds whole frames.
//! Source: IEC 61158-6-10, RTA protocol and alarm services.

mod channel;
mod connection;

pub use channel::{Channel, NotAcknowledged, Received};
pub use connection::{AlarmConfig, AlarmError, AlarmEvent, Alarms, emit_error};

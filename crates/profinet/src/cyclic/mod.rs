//! Cyclic data exchange, the same for both sides: where each submodule's data lies ([`Layout`]), when a frame is sent
//! ([`Provider`]), which received frame counts and when the peer is lost ([`Consumer`]).
//!
//! Source: IEC 61158-6-10, IOCRBlockReq, RTC-PDU, provider and consumer protocol machines (PPM, CPM). No call in here
//! allocates after construction.

mod consumer;
mod layout;
mod provider;
mod timing;

pub use consumer::{Accepted, Consumer, ConsumerState, CyclicStatistics, Rejected};
pub use layout::{DataObject, Direction, IoKind, Layout, ObjectPlace, StatusObject, SubmoduleSize, pack};
pub use provider::{Provider, ProviderConfig};
pub use timing::{IocrError, MAX_FACTOR, TICK, Timing};

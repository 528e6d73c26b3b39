//! What pages receive by a socket instead of requesting it again and again.
//!
//! The newest value of each topic is encoded once for all pages. A page that reads slowly skips values and never gets old ones; it gets
//! each event, or its socket is closed.

mod block;
mod client;
mod hub;
mod producer;
mod samples;
mod streams;

pub(crate) use client::{__path_live, live};
pub(crate) use hub::{Event, Hub, Topic};
pub(crate) use producer::{FaultsTopic, produce};
pub(crate) use samples::Feeds;

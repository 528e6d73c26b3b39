//! Capture files: a pcapng [`Writer`], and a [`Reader`] of pcap and pcapng.

mod reader;
mod writer;

pub use reader::{Captured, MAX_BLOCK, ReadError, Reader};
pub use writer::Writer;

#[cfg(test)]
mod tests;

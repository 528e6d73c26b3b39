//! PROFINET and PROFIdrive explained: frames and octets in, words and typed numbers out. No I/O.
//!
//! | to explain | use |
//! |---|---|
//! | a capture, frame by frame | [`capture::Walker`] |
//! | one frame, every field with its octets | [`capture::Walker::tree`], [`tree::Node`] |
//! | octets without their frame: a parameter job, a telegram, a parameter channel | [`octets::decode`] |
//! | one number: a control word, a state, a fault, an error | [`explain::explain`] |
//! | a value that a drive gave | [`value`], [`words`] |
#![forbid(unsafe_code)]
#![deny(clippy::print_stdout, clippy::print_stderr)]

pub mod capture;
pub mod explain;
pub mod job;
pub mod meaning;
pub mod octets;
pub mod report;
pub mod states;
mod text;
pub mod tree;
pub mod value;
pub mod words;

use serde::Serialize;

pub use profile::notation::figures as number;
pub use text::{hex_bytes, hex16, nibbles};

/// How much something matters that was found in a capture or in octets.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub enum Weight {
    /// What is to be expected.
    Normal,
    /// Worth a look.
    Warning,
    /// A refusal, a fault, a malformed PDU.
    Error,
}

/// Makes a JSON object from fields.
macro_rules! fields {
    ($($name:literal : $value:expr),* $(,)?) => {{
        #[allow(unused_mut)]
        let mut map = serde_json::Map::new();
        $( map.insert($name.into(), serde_json::Value::from($value)); )*
        map
    }};
}
pub(crate) use fields;

//! Tables and live views. Knows how things look, nothing of where they come from.

pub mod live;
pub mod table;

pub use dissect::{hex16, nibbles, number, value, words};

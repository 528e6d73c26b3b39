//! Tables and live views. Knows how things look, nothing of where they come from.

pub mod chart;
pub mod live;
mod page;
pub mod table;

pub use dissect::{hex16, nibbles, number, value, words};
pub use page::Page;

//! Text of drives and networks, which can hold anything.

pub use profile::notation::setting::is_unsafe;

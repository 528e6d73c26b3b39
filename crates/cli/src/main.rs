//! The profidrive command.
#![forbid(unsafe_code)]
fn main() {}

//! drive-client
#![forbid(unsafe_code)]

//! The server, by requests and sockets as pages, programs and attackers make them.
#![allow(clippy::unwrap_used, clippy::panic)] // a test reports by panicking

mod access;
mod actions;
mod captures;
mod change;
mod control;
mod frames;
mod handover;
mod hands;
mod live;
mod machine;
mod motion;
#[path = "../../../network/tests/namespace/mod.rs"]
mod namespace;
mod restart;
mod samples;
mod server;
mod settings;
mod stations;
mod stop;

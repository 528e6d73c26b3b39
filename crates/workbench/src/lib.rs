//! The workbench: PROFIdrive drives in the browser. A local HTTP server with its page.
//!
//! It composes `profidrive` and owns no protocol, no rule of the drive profile and no safety rule. It changes
//! parameters as plans that are shown first, and moves axes as long as a page is there.
//!
//! ```
//! use profidrive::Stop;
//! use profidrive_workbench::{Server, Settings, Source};
//!
//! let demo = Settings {
//!     listen: "127.0.0.1:0".parse()?,
//!     ..Settings::new(Source::Demo)
//! };
//! let server = Server::open(demo, Stop::new()?)?;
//! println!("open {}", server.url());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
#![forbid(unsafe_code)]

mod access;
mod act;
mod api;
mod assets;
mod audit;
mod backups;
mod blocking;
mod board;
mod captures;
mod control;
mod frames;
mod jobs;
mod live;
mod plan;
mod problem;
mod query;
mod room;
mod serve;
mod settings;
mod shared;
mod upgrade;
mod words;

pub use access::TlsError;
pub use api::openapi;
pub use serve::{ServeError, Server};
pub use settings::{Certificate, Settings, Source};

//! Parameter values: what the drive has now, what it has saved, and a way of saving that survives a kill at any moment.

mod image;
mod storage;
mod values;

pub use image::{Image, ImageError};
pub use profile::notation::setting::crc32;
pub use storage::{CrashingStorage, Killed, Storage, load, save};
pub use values::Values;
pub(crate) use values::{is_saved, key};

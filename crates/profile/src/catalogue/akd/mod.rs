// Generated from data/akd/ by `cargo run -p xtask -- gen`.

use super::{Catalogue, Scaling};
use crate::notation::Notation;

mod backup;
mod device;
mod faults;
mod index;
mod meanings;
mod parameters;
mod parts;
mod words;

/// Kollmorgen AKD with PROFINET, firmware 1.17.
pub static AKD: Catalogue = Catalogue {
    model: "AKD",
    notation: Notation::Name,
    scaling: Scaling::DELIVERED,
    parameters: parameters::PARAMETERS,
    index: index::INDEX,
    names: index::NAMES,
    faults: faults::FAULTS,
    device: device::DEVICE,
    backup: backup::BACKUP,
    parts: parts::PARTS,
    words: words::WORDS,
    not_now: words::NOT_NOW,
};

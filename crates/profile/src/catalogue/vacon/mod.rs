// Generated from data/vacon/ by `cargo run -p xtask -- gen`.

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

/// Vacon 100 with PROFINET (built in, or option OPTEA).
pub static VACON: Catalogue = Catalogue {
    model: "VACON",
    notation: Notation::Id { pnu: 10001 },
    scaling: Scaling::of_reference(1500.0),
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

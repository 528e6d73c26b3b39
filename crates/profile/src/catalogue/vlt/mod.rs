// Generated from data/vlt/ by `cargo run -p xtask -- gen`.

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

/// Danfoss VLT AutomationDrive FC 302 with the PROFINET option MCA 120.
pub static VLT: Catalogue = Catalogue {
    model: "VLT",
    notation: Notation::GroupIndex,
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

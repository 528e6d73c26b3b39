//! How people write parameters and values, read and printed in one place.
//!
//! Accepts what the field writes (`DRV.ACC`, `p922`, `r947[0]`, `P0922`, `PNU 922.0`, `922[0..7]`, `0x39A`, `8-10`,
//! `ID 1805`, `50rpm`, `0x047F`) and prints one form (`p0922`, `r0947[0]`).

mod figures;
mod position;
mod quantity;
mod reference;
pub mod setting;
mod units;
mod wildcard;

pub use figures::{figures, fixed};
pub use position::{NoPosition, Position};
pub use quantity::{Number, Quantity, QuantityError, UnitMismatch};
pub use reference::{Elements, Notation, ParameterReference, Prefix, ReferenceError, Shown, Target};
pub use units::{Dimension, UNITS, Unit, unit_named, units_of};
pub use wildcard::wildcard_fits;

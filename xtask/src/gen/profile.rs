//! Tables of the profile: signals, telegrams, error numbers.

use std::path::Path;

use super::Generated;
use crate::Outcome;

/// The generated files of the profile.
pub fn files(_root: &Path) -> Outcome<Vec<Generated>> {
    Ok(Vec::new())
}

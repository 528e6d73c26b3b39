//! Tables of the drive models.

use std::path::Path;

use super::Generated;
use crate::Outcome;

/// The generated files of the drive models.
pub fn files(_root: &Path) -> Outcome<Vec<Generated>> {
    Ok(Vec::new())
}

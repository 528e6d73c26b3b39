//! Names of vendors by VendorID: `vendors.csv` of the profile.

use std::fmt::Write as _;
use std::path::Path;

use super::Generated;
use crate::Outcome;
use crate::table::Table;

const FROM: &str = "data/profile/vendors.csv";

/// The generated file.
pub fn file(root: &Path) -> Outcome<Generated> {
    let table = Table::read(root, FROM)?;
    let mut rows = String::new();
    let mut last = None;
    for row in table.rows() {
        let (name, place) = (row.text("name")?, row.place());
        let id = row.text("vendor_id")?;
        let id = id
            .strip_prefix("0x")
            .and_then(|digits| u16::from_str_radix(digits, 16).ok())
            .ok_or_else(|| format!("{place}: {id:?} is not a VendorID as 0x0105"))?;
        if name.is_empty() || row.text("source")?.is_empty() {
            return Err(format!("{place}: a name and a source are missing").into());
        }
        if last >= Some(id) {
            return Err(format!("{place}: the VendorIDs do not rise").into());
        }
        last = Some(id);
        writeln!(rows, "(0x{id:04X}, {name:?}),")?;
    }
    Ok(Generated {
        path: "crates/profile/src/catalogue/generated_vendors.rs".to_owned(),
        from: FROM.to_owned(),
        text: format!(
            "/// VendorIDs, rising, with names.\npub(super) static VENDORS: &[(u16, &str)] = &[{rows}];\n"
        ),
    })
}

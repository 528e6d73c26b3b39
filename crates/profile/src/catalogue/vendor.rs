//! Names of vendors.

use super::generated_vendors::VENDORS;

/// Returns the name of a vendor by its PROFINET VendorID; `None` for one that is not in `data/profile/vendors.csv`.
///
/// ```
/// use profidrive_profile::catalogue::vendor_name;
/// assert_eq!(vendor_name(0x0105), Some("Kollmorgen"));
/// ```
#[must_use]
pub fn vendor_name(id: u16) -> Option<&'static str> {
    let at = VENDORS.binary_search_by_key(&id, |(id, _)| *id).ok()?;
    VENDORS.get(at).map(|(_, name)| *name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_model_is_of_a_vendor_with_the_name_of_its_tables() {
        for tables in crate::model::ALL.iter().filter_map(|model| model.catalogue) {
            assert_eq!(vendor_name(tables.device.vendor_id), Some(tables.device.vendor));
        }
        assert_eq!((vendor_name(0), vendor_name(0xFFFF)), (None, None));
    }
}

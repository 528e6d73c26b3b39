//! Device descriptions as they come from anywhere.

use profinet::MacAddress;
use virtual_drive::description::Description;
use virtual_drive::model;
use virtual_drive::station::{Station, StationConfig};

/// Device descriptions: a check knows everything that reading refuses, and what is read is written and read back as the
/// same. A drive is created from it or it is rejected.
pub fn gsdml(data: &[u8]) {
    let report = ::gsdml::check(data, Some("GSDML-V2.35-Vendor-Drive-20260101.xml"));
    assert!(report.problems.len() <= 201);
    match ::gsdml::parse(data) {
        Ok(mut read) => {
            assert_eq!(report.description.as_ref(), Some(&read));
            // a missing schema version becomes that of the writer
            read.schema_version.get_or_insert(::gsdml::SchemaVersion::WRITTEN);
            let text = read.to_xml();
            assert_eq!(::gsdml::parse(text.as_bytes()).as_ref(), Ok(&read), "{text}");
            if let Ok(import) = Description::from_gsdml(&read, &model::AKD, None) {
                let mut config = StationConfig::new(&model::AKD, MacAddress([2, 0, 0, 0, 0, 1]));
                config.description = import.description;
                let _ = Station::new(config);
            }
        }
        Err(problem) => {
            assert!(report.description.is_none());
            assert!(report.problems.contains(&problem), "{problem}");
        }
    }
}

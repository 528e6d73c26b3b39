//! Device descriptions of PROFINET devices (GSDML): text in, typed model out, and the other way round.
//!
//! Reads, checks and writes GSDML files. A description comes from a vendor's web page, so [`parse`] treats it as
//! hostile input: entities are rejected, size, depth and counts are bounded, circular references are rejected, and
//! errors have line and column. [`check`] reports all violations of the rules, not only the first; [`Gsdml::to_xml`]
//! writes. The crate has no dependency on drives or protocols and does no I/O.
//!
//! ```
//! let text = r#"<?xml version="1.0" encoding="UTF-8"?>
//! <ISO15745Profile xmlns="http://www.profibus.com/GSDML/2003/11/DeviceProfile"><ProfileBody>
//!   <DeviceIdentity VendorID="0x0105" DeviceID="0x0001"><VendorName Value="Some vendor"/></DeviceIdentity>
//!   <ApplicationProcess><DeviceAccessPointList>
//!     <DeviceAccessPointItem ID="DAP" ModuleIdentNumber="0x1" MinDeviceInterval="512"/>
//!   </DeviceAccessPointList><ExternalTextList><PrimaryLanguage/></ExternalTextList></ApplicationProcess>
//! </ProfileBody></ISO15745Profile>"#;
//! let description = profidrive_gsdml::parse(text.as_bytes()).unwrap();
//! assert_eq!(description.identity.vendor_id, 0x0105);
//! assert_eq!(description.access_points[0].min_device_interval, 512);
//!
//! let problem = profidrive_gsdml::parse(&text.replace("512", "5e5").into_bytes()).unwrap_err();
//! assert_eq!((problem.position.line, problem.position.column), (5, 61));
//!
//! // usable, but far from complete
//! assert!(profidrive_gsdml::check(text.as_bytes(), None).problems.len() > 3);
//! ```
#![no_std]
#![forbid(unsafe_code)]
extern crate alloc;

mod bitmap;
mod check;
mod data;
mod file_name;
#[cfg(test)]
mod fixtures;
mod model;
mod problem;
mod read;
mod source;
mod text;
mod value;
mod write;

pub use bitmap::Bitmap;
pub use check::{Report, check};
pub use data::{BitItem, Consistency, DataDescription, DataItem, DataType, IoData};
pub use file_name::{FileName, FileNameError};
pub use model::{
    AccessPoint, Category, Certification, ChannelDiagnosis, Constant, DeviceIdentity, Family, Features,
    Graphic, GraphicRef, Gsdml, Interface, IoLimits, MAIN_FAMILIES, Menu, MenuEntry, Module, ModuleInfo,
    ModuleRef, ParameterRecord, ParameterRef, Port, Submodule, SubmoduleRef, SubslotName, ValueItem,
};
pub use problem::{Position, Problem, Rule, Severity};
pub use read::NAMESPACE;
pub use source::{MOST_DEPTH, MOST_NODES, MOST_OCTETS};
pub use text::{Language, TextId, Texts};
pub use value::{NoList, NoVersion, SchemaVersion, ValueList};

/// Reads a device description.
///
/// Takes files of all schema versions 2.x; unknown elements and attributes are passed over, and rules that do not change
/// what the file means are not looked at ([`check`] does).
///
/// # Errors
/// Returns the first problem that makes the meaning of the file uncertain, with its position.
pub fn parse(octets: &[u8]) -> Result<Gsdml, Problem> {
    let source = source::Source::new(octets)?;
    let document = read::document(&source)?;
    let mut reader = read::Reader::new(&source);
    let gsdml = reader.gsdml(&document);
    let unusable = |problem: &Problem| problem.severity == Severity::Unusable;
    match (gsdml, reader.problems.list.into_iter().find(unusable)) {
        (_, Some(problem)) => Err(problem),
        (Some(gsdml), None) => Ok(gsdml),
        // the reader reports a problem whenever it returns nothing; this case keeps every path free of panics
        (None, None) => Err(Problem {
            severity: Severity::Unusable,
            rule: Rule::Root,
            position: Position { line: 1, column: 1 },
            message: "no device description".into(),
        }),
    }
}

//! Error numbers and formats of parameter jobs in words.

use profile::model::Model;
use profile::parameter::{CodeSpace, ErrorNames, ErrorNumber, Format};
use profile::pkw::PkwErrorNames;

use crate::meaning::Meaning;

/// Vendors with error numbers of their own, in parameter jobs and in a parameter channel.
const VENDORS: [(&str, ErrorNames, PkwErrorNames); 2] = [
    ("Danfoss", ErrorNames::Danfoss, PkwErrorNames::Danfoss),
    ("Vacon", ErrorNames::Vacon, PkwErrorNames::Profile),
];

/// Returns an error number of the parameter manager in words: those of the model's make, or of all. What the same
/// number says in a parameter channel (PKW) comes with it where it is another thing.
pub fn explain_error(number: u16, model: Option<Model>, output: &mut Vec<String>) -> Meaning {
    let error = ErrorNumber(number);
    let own = model.map(|model| model.dialect.error_names);
    let vendors = || {
        VENDORS
            .iter()
            .filter(move |(_, names, _)| own.is_none_or(|own| own == *names))
    };
    // of one model its own word comes first
    let known = own.filter(|_| number >= OWN).and_then(|names| error.info(names));
    let meaning = known.map_or_else(
        || error.to_string(),
        |info| format!("0x{number:02X} {}", info.meaning),
    );
    output.push(format!("parameter error {meaning}"));
    let general = known.or_else(|| error.info(ErrorNames::Profile));
    if let Some(info) = general {
        output.push(format!("  do     {}", info.remedy));
    }
    let mut in_channel = None;
    let others = || vendors().filter(|_| number >= OWN && known.is_none());
    for (vendor, names, _) in others() {
        if let Some(info) = error.info(*names) {
            output.push(format!("  {vendor:<6} {}", info.meaning));
        }
    }
    for (vendor, _, names) in vendors() {
        let channel = names.rows().iter().find(|row| row.number == number);
        if let Some(row) = channel {
            output.push(format!(
                "  in a parameter channel (PKW) of {vendor}: {}; {}",
                row.meaning, row.remedy
            ));
            in_channel = Some(row.meaning);
        }
    }
    let of = |names: ErrorNames| {
        let vendor = others().find(|(_, own, _)| *own == names);
        Some(error.info(vendor?.1)?.meaning)
    };
    Meaning::Error {
        r#as: "error",
        raw: number,
        meaning,
        remedy: general.map(|info| info.remedy),
        danfoss: of(ErrorNames::Danfoss),
        vacon: of(ErrorNames::Vacon),
        channel: in_channel,
    }
}

/// From this number on error numbers are the vendor's.
const OWN: u16 = 0x65;

/// Describes a format code: as defined by the vendor of the model, or by the current profile.
pub fn explain_format(code: u8, model: Option<Model>, output: &mut Vec<String>) -> Meaning {
    let name = |space| Format(code).info(space).map(|row| row.name);
    let (v4, v3) = (name(CodeSpace::V4), name(CodeSpace::V3));
    let today = ("PROFIdrive V4", v4);
    let older = ("PROFIdrive V2/V3 and Danfoss drives", v3);
    let older_first = model.is_some_and(|model| model.dialect.code_space == CodeSpace::V3);
    let (first, second) = if older_first {
        (older, today)
    } else {
        (today, older)
    };
    output.push(format!(
        "format 0x{code:02X}: {}",
        first.1.unwrap_or("reserved or unknown")
    ));
    if v3 != v4 {
        output.push(format!("  in {}: {}", second.0, second.1.unwrap_or("unknown")));
    }
    Meaning::Format {
        r#as: "format",
        raw: code,
        v4,
        v3,
    }
}

//! Error numbers and formats of parameter jobs in words.

use profidrive::parameter::{CodeSpace, ErrorNames, ErrorNumber, Format};
use serde_json::{Map, Value};

use crate::fields;

/// An error number of the parameter manager in words.
pub fn explain_error(number: u16, output: &mut Vec<String>) -> Map<String, Value> {
    let error = ErrorNumber(number);
    output.push(format!("parameter error {error}"));
    let mut fields = fields! { "as": "error", "raw": number, "meaning": error.to_string() };
    if let Some(info) = error.info(ErrorNames::Profile) {
        output.push(format!("  do     {}", info.remedy));
        fields.insert("remedy".into(), info.remedy.into());
    }
    let makers: Vec<(&str, &str)> = [("Danfoss", ErrorNames::Danfoss), ("Vacon", ErrorNames::Vacon)]
        .into_iter()
        .filter(|_| number >= 0x65)
        .filter_map(|(maker, names)| Some((maker, error.info(names)?.meaning)))
        .collect();
    for (maker, meaning) in makers {
        output.push(format!("  {maker:<6} {meaning}"));
        fields.insert(maker.to_lowercase(), meaning.into());
    }
    fields
}

/// A format code in words.
pub fn explain_format(code: u8, output: &mut Vec<String>) -> Map<String, Value> {
    let name = |space| Format(code).info(space).map(|row| row.name);
    let (v4, v3) = (name(CodeSpace::V4), name(CodeSpace::V3));
    output.push(format!(
        "format 0x{code:02X}: {}",
        v4.unwrap_or("reserved or unknown")
    ));
    if v3 != v4 {
        output.push(format!(
            "  in PROFIdrive V2/V3 and Danfoss drives: {}",
            v3.unwrap_or("unknown")
        ));
    }
    fields! { "as": "format", "raw": code, "v4": v4, "v3": v3 }
}

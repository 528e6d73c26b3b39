//! Parameter jobs in words.

use crate::decode::Weight;
use crate::render::hex_bytes;

/// A request in words.
pub fn request_lines(bytes: &[u8]) -> Vec<String> {
    vec![format!("request {}", hex_bytes(bytes))]
}

/// A response in words, with the request it answers where that is known.
pub fn response_lines(bytes: &[u8], request: Option<&[u8]>) -> Vec<(Weight, String)> {
    let _ = request;
    vec![(Weight::Normal, format!("answer {}", hex_bytes(bytes)))]
}

/// A job in words and for programs.
#[derive(Debug)]
pub struct Decoded {
    /// In words.
    pub lines: Vec<String>,
    /// For programs.
    pub fields: serde_json::Map<String, serde_json::Value>,
}

/// Decodes one job.
pub fn decode(
    data: &[u8],
    side: Option<crate::args::Side>,
    request: Option<&[u8]>,
) -> Result<Decoded, crate::failure::Failure> {
    let _ = (side, request);
    Ok(Decoded {
        lines: request_lines(data),
        fields: serde_json::Map::new(),
    })
}

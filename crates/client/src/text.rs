//! Text of drives and networks, which can hold anything.

use core::fmt::Write as _;

/// Returns true for what a terminal obeys (C0, DEL, C1), and for what is not seen but changes what is: bidirectional
/// controls, characters without width, separators of lines, tags.
///
/// Source: Unicode, general category Cc, and the default ignorable code points that are not letters of a script.
#[must_use]
pub fn is_unsafe(c: char) -> bool {
    c.is_control()
        || matches!(c,
            '\u{AD}' | '\u{34F}' | '\u{61C}' | '\u{115F}' | '\u{1160}' | '\u{17B4}' | '\u{17B5}'
            | '\u{180B}'..='\u{180F}' | '\u{200B}'..='\u{200F}' | '\u{2028}'..='\u{202E}' | '\u{2060}'..='\u{206F}'
            | '\u{3164}' | '\u{FE00}'..='\u{FE0F}' | '\u{FEFF}' | '\u{FFA0}' | '\u{FFF0}'..='\u{FFFB}'
            | '\u{1BCA0}'..='\u{1BCA3}' | '\u{1D173}'..='\u{1D17A}' | '\u{E0000}'..='\u{E0FFF}')
}

/// Escapes such characters and others that `more` names, a backslash too: `\u{202e}`. [`unescape`] is the way back.
pub(crate) fn escape(text: &str, more: impl Fn(char) -> bool) -> String {
    let mut escaped = String::with_capacity(text.len());
    for c in text.chars() {
        if c == '\\' || is_unsafe(c) || more(c) {
            // writing into a String does not fail
            let _ = write!(escaped, "{}", c.escape_unicode());
        } else {
            escaped.push(c);
        }
    }
    escaped
}

/// Returns the text before [`escape`]; what is not such an escape stays as it is.
pub(crate) fn unescape(text: &str) -> String {
    let mut pieces = text.split("\\u{");
    let mut plain = pieces.next().unwrap_or_default().to_owned();
    for piece in pieces {
        let escaped = piece.split_once('}').and_then(|(digits, rest)| {
            let number = u32::from_str_radix(digits, 16).ok()?;
            Some((char::from_u32(number)?, rest))
        });
        if let Some((c, rest)) = escaped {
            plain.push(c);
            plain += rest;
        } else {
            plain += "\\u{";
            plain += piece;
        }
    }
    plain
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_escaped_comes_back() {
        for text in [
            "",
            "AKD-P00306",
            "a\u{202e}b\u{ad}",
            "\u{1b}[2J\n",
            "\\u{41}",
            "\\u{",
            "#1",
        ] {
            let escaped = escape(text, |c| c == '#');
            assert!(!escaped.chars().any(|c| is_unsafe(c) || c == '#'), "{escaped}");
            assert_eq!(unescape(&escaped), text);
        }
        assert_eq!(unescape("\\u{110000} \\u{zz} \\u{1"), "\\u{110000} \\u{zz} \\u{1");
    }
}

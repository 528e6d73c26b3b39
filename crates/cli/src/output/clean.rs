//! Foreign text made harmless: names, texts and errors come from networks, files and other programs.

use std::fmt::Write as _;

use client::text::is_unsafe;

/// Returns the text on one line: `\n`, `\t` and `\u{1b}` stand for what must not be printed.
pub fn clean(text: &str) -> String {
    escaped(text, |_| false)
}

/// Returns the text with its lines; everything else as [`clean`].
pub fn clean_lines(text: &str) -> String {
    escaped(text, |c| matches!(c, '\n' | '\t'))
}

fn escaped(text: &str, kept: impl Fn(char) -> bool) -> String {
    let mut clean = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            _ if kept(c) || !is_unsafe(c) => clean.push(c),
            '\n' | '\r' | '\t' => clean.extend(c.escape_default()),
            _ => clean.extend(c.escape_unicode()),
        }
    }
    clean
}

/// Returns a JSON text in which such characters are escaped, which a serializer does for C0 only. Outside of strings
/// JSON has none of them.
pub fn clean_json(json: &str) -> String {
    let mut clean = String::with_capacity(json.len());
    for c in json.chars() {
        if is_unsafe(c) {
            for unit in c.encode_utf16(&mut [0; 2]) {
                // writing into a String does not fail
                let _ = write!(clean, "\\u{unit:04x}");
            }
        } else {
            clean.push(c);
        }
    }
    clean
}

/// Returns the text with its lines and colours (`ESC [ numbers m`): help and errors of the command line.
pub fn clean_styled(text: &str) -> String {
    let mut pieces = text.split('\u{1b}');
    let mut clean = clean_lines(pieces.next().unwrap_or_default());
    for piece in pieces {
        let colour = piece.strip_prefix('[').and_then(|piece| piece.split_once('m'));
        let is_code = |code: &str| code.bytes().all(|c| c.is_ascii_digit() || c == b';');
        match colour.filter(|(code, _)| is_code(code)) {
            Some((code, rest)) => {
                let _ = write!(clean, "\u{1b}[{code}m{}", clean_lines(rest));
            }
            None => {
                clean += "\\u{1b}";
                clean += &clean_lines(piece);
            }
        }
    }
    clean
}

#[cfg(test)]
mod tests {
    use super::*;

    const HOSTILE: &str = "a\x1b[2J\x07\x7f\u{9b}31m\u{202e}b\u{200b}\u{2066}\u{feff}\u{e0041}\nc\r";

    #[test]
    fn nothing_that_a_terminal_obeys_or_hides_is_left() {
        let shown =
            "a\\u{1b}[2J\\u{7}\\u{7f}\\u{9b}31m\\u{202e}b\\u{200b}\\u{2066}\\u{feff}\\u{e0041}\\nc\\r";
        assert_eq!(clean(HOSTILE), shown);
        assert!(clean_lines(HOSTILE).contains("\nc\\r"));
        for text in [clean(HOSTILE), clean_lines(HOSTILE), clean_styled(HOSTILE)] {
            assert!(text.chars().all(|c| c == '\n' || !is_unsafe(c)), "{text:?}");
        }
        assert_eq!(clean("Größe 20 °C, 軸-1"), "Größe 20 °C, 軸-1");
    }

    #[test]
    fn json_has_the_same_text_without_raw_characters() {
        let json = serde_json::Value::from(HOSTILE).to_string();
        let safe = clean_json(&json);
        assert!(!safe.chars().any(is_unsafe), "{safe}");
        assert_eq!(serde_json::from_str::<String>(&safe).unwrap(), HOSTILE);
    }

    #[test]
    fn only_colours_are_left_of_styles() {
        assert_eq!(clean_styled("\x1b[1mhelp\x1b[0m"), "\x1b[1mhelp\x1b[0m");
        assert_eq!(
            clean_styled("\x1b[2Jx\x1b]0;t\x07"),
            "\\u{1b}[2Jx\\u{1b}]0;t\\u{7}"
        );
    }
}

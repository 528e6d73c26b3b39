//! Names with `*` for any part and `?` for any character.

use alloc::vec::Vec;

/// Returns true when `pattern`, with `*` for any part and `?` for any character, fits the whole of `text`; case does not
/// matter. It takes at most the product of both lengths.
///
/// ```
/// use profidrive_profile::notation::wildcard_fits;
/// assert!(wildcard_fits("MOTOR.*", "motor.poles") && wildcard_fits("akd-?", "akd-1"));
/// assert!(!wildcard_fits("akd-?", "akd-12"));
/// ```
#[must_use]
pub fn wildcard_fits(pattern: &str, text: &str) -> bool {
    let lower = |text: &str| text.to_ascii_lowercase().chars().collect::<Vec<_>>();
    let (pattern, text) = (lower(pattern), lower(text));
    let (mut at, mut place) = (0, 0);
    // greedy, with one way back
    let mut back: Option<(usize, usize)> = None;
    while let Some(&c) = text.get(place) {
        match pattern.get(at) {
            Some('*') => {
                back = Some((at, place));
                at += 1;
            }
            Some(&wanted) if wanted == '?' || wanted == c => {
                at += 1;
                place += 1;
            }
            _ => match back {
                Some((star, from)) => {
                    back = Some((star, from + 1));
                    at = star + 1;
                    place = from + 1;
                }
                None => return false,
            },
        }
    }
    pattern.get(at..).unwrap_or_default().iter().all(|&c| c == '*')
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stars_and_question_marks_stand_for_what_is_there() {
        for (pattern, name, fit) in [
            ("*.EN", "SWLS.EN", true),
            ("*.EN", "SWLS.EN2", false),
            ("DIN?.MODE", "DIN1.MODE", true),
            ("DIN?.MODE", "DIN21.MODE", false),
            ("*A*A*", "BANANA", true),
            ("*A*B", "BANANA", false),
            ("*", "", true),
            ("?", "", false),
            ("", "", true),
        ] {
            assert_eq!(wildcard_fits(pattern, name), fit, "{pattern} {name}");
        }
    }
}

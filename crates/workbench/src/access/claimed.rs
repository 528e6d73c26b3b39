//! What the people of a session call themselves. Nothing verifies it.

use std::sync::{Arc, Mutex, PoisonError};

use profidrive::profile::notation::setting::is_unsafe;

/// The longest name, in characters.
pub(crate) const NAME: usize = 40;

/// The name that a session claims. All that have it, sockets too, get the newest.
#[derive(Debug, Clone, Default)]
pub(crate) struct Claimed(Arc<Mutex<Option<String>>>);

impl Claimed {
    /// Returns the name, cleaned; `None` where none was given.
    pub fn name(&self) -> Option<String> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    /// Takes another name; an empty one is none. Returns what is left of it.
    pub fn claim(&self, name: &str) -> Option<String> {
        let name = cleaned(name);
        self.0
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
            .clone_from(&name);
        name
    }
}

/// Returns a name without what no name has: control characters, those that change the direction of a text, and what is too long.
fn cleaned(name: &str) -> Option<String> {
    let printable: String = name
        .chars()
        .filter(|character| character.is_whitespace() || !is_unsafe(*character))
        .collect();
    let words: Vec<&str> = printable.split_whitespace().collect();
    let name: String = words.join(" ").chars().take(NAME).collect();
    let name = name.trim_end();
    (!name.is_empty()).then(|| name.to_owned())
}

/// Returns who has or did something, for a sentence: a session by its number, with the name that it claims.
pub(crate) fn person(who: &str, claimed: Option<&str>) -> String {
    let of = match who {
        "token" => "a program".to_owned(),
        number => format!("session {number}"),
    };
    match claimed {
        Some(name) => format!("{of} (\"{name}\", not verified)"),
        None => of,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_claimed_name_is_short_and_printable() {
        let claimed = Claimed::default();
        let same = claimed.clone();
        assert_eq!(claimed.name(), None);
        for (text, name) in [
            ("Anna", Some("Anna")),
            ("  Anna \t\n of  shift\u{0} 2 ", Some("Anna of shift 2")),
            ("\u{1b}[31mred\u{7}", Some("[31mred")),
            ("\u{202e}annA\u{2066}", Some("annA")),
            (" \u{200b}\r\n ", None),
            ("", None),
        ] {
            assert_eq!(claimed.claim(text).as_deref(), name, "{text:?}");
            assert_eq!(same.name().as_deref(), name);
        }
        let long = claimed.claim(&"\u{e4}".repeat(5000)).unwrap();
        assert_eq!(long.chars().count(), NAME);
    }

    #[test]
    fn a_sentence_says_that_a_name_is_not_verified() {
        assert_eq!(person("3", None), "session 3");
        assert_eq!(person("3", Some("Anna")), "session 3 (\"Anna\", not verified)");
        assert_eq!(person("token", None), "a program");
    }
}

//! Which names a station may have, and a legal form of those it may not.

use alloc::string::String;

/// Longest name of a station in octets.
pub const MAX_NAME: usize = 240;

/// Longest part between two dots in octets.
const MAX_LABEL: usize = 63;

/// The rule a name breaks; positions count octets from 0.
///
/// Source: IEC 61158-6-10, NameOfStationValue.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, thiserror::Error)]
pub enum NameRule {
    /// Nothing at all.
    #[error("it has no character")]
    Empty,
    /// More than 240 octets.
    #[error("it has {0} characters, and 240 are the most")]
    TooLong(usize),
    /// Another character than a-z, 0-9, hyphen, dot.
    #[error("its character {} is {character:?}, and only a-z, 0-9, '-' and '.' are permitted", .position + 1)]
    Character {
        /// The character (of octets that are not UTF-8: U+FFFD).
        character: char,
        /// Where it is.
        position: usize,
    },
    /// Two dots in a row, or one at the start or end.
    #[error("its part between dots that begins at character {} is empty", .position + 1)]
    EmptyLabel {
        /// Where it would be.
        position: usize,
    },
    /// A part between dots of more than 63 octets.
    #[error("its part between dots that begins at character {} is longer than 63 characters", .position + 1)]
    LabelTooLong {
        /// Where it starts.
        position: usize,
    },
    /// A part starts or ends with a hyphen.
    #[error("a part between dots must not start or end with '-', as character {} does", .position + 1)]
    Hyphen {
        /// Where the hyphen is.
        position: usize,
    },
    /// The first part looks like the name of a port, `port-001` or `port-001-00000`.
    #[error("its first part looks like the name of a port")]
    PortForm,
    /// Four numbers with dots.
    #[error("it looks like an IP address")]
    IpForm,
}

/// Checks the name of a station.
///
/// # Errors
/// The first rule that is broken, from left to right.
///
/// ```
/// use profidrive_profinet::wire::dcp::{NameRule, check_name};
/// assert_eq!(check_name(b"akd-1.line-2"), Ok(()));
/// assert_eq!(check_name(b"AKD-1"), Err(NameRule::Character { character: 'A', position: 0 }));
/// ```
pub fn check_name(name: &[u8]) -> Result<(), NameRule> {
    if name.is_empty() {
        return Err(NameRule::Empty);
    }
    if name.len() > MAX_NAME {
        return Err(NameRule::TooLong(name.len()));
    }
    if let Some(position) = name.iter().position(|c| !is_legal(*c)) {
        let rest = name.get(position..).unwrap_or_default();
        let character = rest.utf8_chunks().next();
        let character = character
            .and_then(|c| c.valid().chars().next())
            .unwrap_or('\u{FFFD}');
        return Err(NameRule::Character { character, position });
    }
    let mut position = 0;
    for label in name.split(|c| *c == b'.') {
        check_label(label, position)?;
        position += label.len() + 1;
    }
    if name.split(|c| *c == b'.').next().is_some_and(is_port) {
        return Err(NameRule::PortForm);
    }
    let numeric = name
        .split(|c| *c == b'.')
        .all(|label| label.iter().all(u8::is_ascii_digit));
    if numeric && name.split(|c| *c == b'.').count() == 4 {
        return Err(NameRule::IpForm);
    }
    Ok(())
}

const fn is_legal(c: u8) -> bool {
    matches!(c, b'a'..=b'z' | b'0'..=b'9' | b'-' | b'.')
}

fn check_label(label: &[u8], position: usize) -> Result<(), NameRule> {
    match label {
        [] => Err(NameRule::EmptyLabel { position }),
        [b'-', ..] => Err(NameRule::Hyphen { position }),
        [.., b'-'] => Err(NameRule::Hyphen {
            position: position + label.len() - 1,
        }),
        _ if label.len() > MAX_LABEL => Err(NameRule::LabelTooLong { position }),
        _ => Ok(()),
    }
}

/// `port-` and three digits, or that and `-` and five more.
fn is_port(label: &[u8]) -> bool {
    let Some(rest) = label.strip_prefix(b"port-") else {
        return false;
    };
    let digits = |text: &[u8], count: usize| text.len() == count && text.iter().all(u8::is_ascii_digit);
    match rest.split_at_checked(3) {
        Some((port, [])) => digits(port, 3),
        Some((port, [b'-', slot @ ..])) => digits(port, 3) && digits(slot, 5),
        _ => false,
    }
}

/// Returns a legal name close to `text`, to be offered to a user who typed an illegal one; the text itself if it is
/// legal.
///
/// Letters become small, German umlauts two letters, everything else that is not allowed a hyphen; hyphens and dots
/// are tidied. Empty if nothing usable is left. (Engineering tools have an encoding of their own that ends in a
/// checksum; this is not it.)
///
/// ```
/// use profidrive_profinet::wire::dcp::legal_name;
/// assert_eq!(legal_name("Drive_1 (links)"), "drive-1-links");
/// ```
#[must_use]
pub fn legal_name(text: &str) -> String {
    let mut plain = String::new();
    for character in text.chars().flat_map(char::to_lowercase) {
        match character {
            'ä' => plain.push_str("ae"),
            'ö' => plain.push_str("oe"),
            'ü' => plain.push_str("ue"),
            'ß' => plain.push_str("ss"),
            'a'..='z' | '0'..='9' | '.' => plain.push(character),
            _ if plain.ends_with(['-', '.']) => {}
            _ => plain.push('-'),
        }
    }
    let mut name = String::new();
    for label in plain.split('.') {
        let label = label
            .get(..label.len().min(MAX_LABEL))
            .unwrap_or(label)
            .trim_matches('-');
        if label.is_empty() {
            continue;
        }
        let dot = usize::from(!name.is_empty());
        let room = MAX_NAME.saturating_sub(name.len() + dot);
        let label = label
            .get(..label.len().min(room))
            .unwrap_or("")
            .trim_end_matches('-');
        if label.is_empty() {
            break;
        }
        if dot == 1 {
            name.push('.');
        }
        name.push_str(label);
    }
    match check_name(name.as_bytes()) {
        Err(NameRule::PortForm | NameRule::IpForm) => {
            name.insert_str(0, "x-");
            // the first part or the whole may now be too long by two; a numeric or port part never is
            name
        }
        _ => name,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::format;
    use alloc::string::ToString;
    use alloc::vec;
    use proptest::prelude::*;

    #[test]
    fn good_names() {
        let long = format!("{0}.{0}.{0}.{1}", "a".repeat(63), "b".repeat(48));
        assert_eq!(long.len(), 240);
        for name in [
            "a",
            "1",
            "drive-1",
            "akd-1.line-2",
            "port-01",
            "port-0001",
            "port-001-0000",
            "1.2.3",
            "1.2.3.4.5",
            &long,
        ] {
            assert_eq!(check_name(name.as_bytes()), Ok(()), "{name}");
        }
    }

    #[test]
    fn each_rule() {
        assert_eq!(check_name(b""), Err(NameRule::Empty));
        assert_eq!(check_name(&vec![b'a'; 241]), Err(NameRule::TooLong(241)));
        assert_eq!(check_name(&[b'a'; 63]), Ok(()));
        assert_eq!(
            check_name(&[b'a'; 64]),
            Err(NameRule::LabelTooLong { position: 0 })
        );
        assert_eq!(
            check_name(b"a_b"),
            Err(NameRule::Character {
                character: '_',
                position: 1
            })
        );
        assert_eq!(
            check_name("aä".as_bytes()),
            Err(NameRule::Character {
                character: 'ä',
                position: 1
            })
        );
        assert_eq!(
            check_name(b"a\xFF"),
            Err(NameRule::Character {
                character: '\u{FFFD}',
                position: 1
            })
        );
        assert_eq!(
            check_name(b"a\0"),
            Err(NameRule::Character {
                character: '\0',
                position: 1
            })
        );
        assert_eq!(check_name(b"a..b"), Err(NameRule::EmptyLabel { position: 2 }));
        assert_eq!(check_name(b"a."), Err(NameRule::EmptyLabel { position: 2 }));
        assert_eq!(check_name(b".a"), Err(NameRule::EmptyLabel { position: 0 }));
        assert_eq!(check_name(b"a.-b"), Err(NameRule::Hyphen { position: 2 }));
        assert_eq!(check_name(b"ab-.c"), Err(NameRule::Hyphen { position: 2 }));
        assert_eq!(check_name(b"-"), Err(NameRule::Hyphen { position: 0 }));
        assert_eq!(check_name(b"port-001"), Err(NameRule::PortForm));
        assert_eq!(check_name(b"port-001-00002.plc"), Err(NameRule::PortForm));
        assert_eq!(check_name(b"10.0.0.256"), Err(NameRule::IpForm));
        assert_eq!(
            NameRule::Hyphen { position: 2 }.to_string(),
            "a part between dots must not start or end with '-', as character 3 does"
        );
    }

    #[test]
    fn offered_names() {
        for (text, name) in [
            ("AKD 1", "akd-1"),
            ("Drive_1", "drive-1"),
            ("Förderband.Süd", "foerderband.sued"),
            ("..a..b..", "a.b"),
            ("--", ""),
            ("", ""),
            ("port-001", "x-port-001"),
            ("10.0.0.1", "x-10.0.0.1"),
            ("drive-1", "drive-1"),
            ("日本", ""),
        ] {
            assert_eq!(legal_name(text), name, "{text}");
        }
    }

    proptest! {
        #[test]
        fn what_is_offered_is_legal_or_empty(text in ".{0,300}") {
            let name = legal_name(&text);
            prop_assert!(name.is_empty() || check_name(name.as_bytes()).is_ok(), "{}", name);
        }

        #[test]
        fn a_legal_name_is_offered_unchanged(name in "[a-z][a-z0-9]{0,20}(-[a-z0-9]{1,5})?(\\.[a-z][a-z0-9]{0,20}){0,3}") {
            prop_assume!(check_name(name.as_bytes()).is_ok());
            prop_assert_eq!(legal_name(&name), name);
        }

        #[test]
        fn any_octets_are_judged(name in proptest::collection::vec(any::<u8>(), 0..260)) {
            let _ = check_name(&name);
        }
    }
}

//! Which parameters a person means by `MOTOR.*`, `p2108`, `DRV.ACC`.

use std::str::FromStr;

use profile::notation::{Elements, ParameterReference, ReferenceError, Target};

use profile::value::Reading;

/// A name with `*` for any part and `?` for any character, or a number with its elements.
///
/// ```
/// use profidrive_client::backup::Pattern;
/// let motor: Pattern = "motor.*".parse()?;
/// assert!(motor.names("MOTOR.POLES") && !motor.names("DRV.ACC"));
/// # Ok::<(), profidrive_client::backup::PatternError>(())
/// ```
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Pattern {
    text: String,
    number: Option<(u16, Option<Elements>)>,
}

/// Why a text is not a pattern.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("`{text}`: write a name, with * for any part (MOTOR.*), or a number (2108, p915[0])")]
pub struct PatternError {
    /// The text as given.
    pub text: String,
}

impl Pattern {
    /// Returns true when it fits a name; case does not matter.
    #[must_use]
    pub fn names(&self, name: &str) -> bool {
        let lower = |text: &str| text.to_ascii_lowercase().chars().collect::<Vec<_>>();
        self.number.is_none() && fits(&lower(&self.text), &lower(name))
    }

    /// Returns true when it means the parameter of a reading.
    #[must_use]
    pub fn means(&self, reading: &Reading) -> bool {
        match self.number {
            None => reading.name.is_some_and(|name| self.names(name)),
            Some((pnu, elements)) => {
                let index = u32::from(reading.index.unwrap_or(0));
                pnu == reading.pnu
                    && elements.is_none_or(|run| {
                        let first = u32::from(run.first);
                        (first..first + u32::from(run.count)).contains(&index)
                    })
            }
        }
    }

    /// As written.
    #[must_use]
    pub fn text(&self) -> &str {
        &self.text
    }
}

impl FromStr for Pattern {
    type Err = PatternError;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let text = text.trim().to_owned();
        let number = match text.parse::<ParameterReference>() {
            Ok(ParameterReference {
                target: Target::Number(pnu),
                elements,
                ..
            }) => Some((pnu, elements)),
            Ok(_) | Err(ReferenceError::Character { .. }) => None,
            Err(_) => return Err(PatternError { text }),
        };
        // long runs of stars would cost more than they mean
        if text.is_empty() || text.len() > 100 || text.matches('*').count() > 8 {
            return Err(PatternError { text });
        }
        Ok(Self { text, number })
    }
}

/// Greedy with one way back, so that it takes at most the product of both lengths.
fn fits(pattern: &[char], text: &[char]) -> bool {
    let (mut at, mut place) = (0, 0);
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
    fn stars_stand_for_any_part() {
        for (pattern, name, fit) in [
            ("MOTOR.*", "MOTOR.R", true),
            ("motor.*", "MOTOR.R", true),
            ("*.EN", "SWLS.EN", true),
            ("*.EN", "SWLS.EN2", false),
            ("DIN?.MODE", "DIN1.MODE", true),
            ("DIN?.MODE", "DIN21.MODE", false),
            ("*A*A*", "BANANA", true),
            ("*A*B", "BANANA", false),
            ("DRV.ACC", "DRV.ACC", true),
            ("DRV.AC", "DRV.ACC", false),
            ("*", "", true),
        ] {
            assert_eq!(
                pattern.parse::<Pattern>().unwrap().names(name),
                fit,
                "{pattern} {name}"
            );
        }
        assert!("".parse::<Pattern>().is_err());
        assert!("0".parse::<Pattern>().is_err());
        assert!("*********".parse::<Pattern>().is_err());
    }
}

//! Which parameters a person means by `MOTOR.*`, `p2108`, `DRV.ACC`.

use std::str::FromStr;

use profile::notation::{Elements, ParameterReference, ReferenceError, Target, wildcard_fits};

use super::task::Name;
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
        self.number.is_none() && wildcard_fits(&self.text, name)
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

    /// Returns true when it means the motion task of a number: `MT*`, `MT[3]`.
    #[must_use]
    pub fn means_task(&self, number: u16) -> bool {
        self.names(&Name(number).to_string())
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stars_stand_for_any_part() {
        for (pattern, name, fit) in [
            ("MOTOR.*", "MOTOR.R", true),
            ("motor.*", "MOTOR.R", true),
            ("DRV.ACC", "DRV.ACC", true),
            ("DRV.AC", "DRV.ACC", false),
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

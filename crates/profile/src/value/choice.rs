//! Values as a person gives them: a number with its unit, or the text that a selection has for it.

use alloc::borrow::ToOwned;
use alloc::string::String;
use alloc::vec::Vec;

use crate::catalogue::{Meaning, Parameter};
use crate::notation::{Quantity, QuantityError};

use super::{ParameterProblem, Selection};

/// Octets of a text in a parameter description (attribute text): longer ones are truncated.
const CUT: usize = 16;

/// A value as given.
///
/// ```
/// use profidrive_profile::value::{Assignment, Parameters};
/// use profidrive_profile::catalogue::{Scaling, VLT};
/// let tables = Parameters { catalogue: Some(&VLT), scaling: Scaling::default() };
/// let raw = |text: &str| {
///     let assignment: Assignment = text.parse().unwrap();
///     let selection = tables.select(&assignment.reference).unwrap();
///     tables.check(&selection, &assignment.value).map(|value| value.raw)
/// };
/// assert_eq!((raw("8-10=fc"), raw("8-10=\"FC profile\""), raw("8-10=0")), (Ok(0), Ok(0), Ok(0)));
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Given {
    text: String,
    /// Between quotation marks, so never a number.
    quoted: bool,
    /// Blanks stood in front of it, without quotation marks, and are not part of it.
    cut: bool,
    quantity: Result<Quantity, QuantityError>,
}

impl Given {
    /// From what stands behind the `=`.
    pub(super) fn of(text: &str) -> Result<Self, QuantityError> {
        let cut = text.starts_with(char::is_whitespace);
        let text = text.trim();
        let inner = ['"', '\'']
            .into_iter()
            .find_map(|mark| text.strip_prefix(mark)?.strip_suffix(mark));
        let quantity = match inner {
            Some(_) => Err(QuantityError::NoNumber {
                text: text.to_owned(),
            }),
            None => text.parse(),
        };
        match quantity {
            Err(error @ QuantityError::Empty) => Err(error),
            quantity => Ok(Self {
                text: inner.unwrap_or(text).to_owned(),
                quoted: inner.is_some(),
                cut: cut && inner.is_none(),
                quantity,
            }),
        }
    }

    /// Returns the number as it travels, where it was given as such (`0x047F`).
    #[must_use]
    pub fn raw(&self) -> Option<u64> {
        self.quantity.as_ref().ok()?.raw()
    }

    /// Returns the number with its unit, where one was given.
    #[must_use]
    pub fn number(&self) -> Option<&Quantity> {
        self.quantity.as_ref().ok()
    }

    /// Returns the characters that were given, without quotation marks. Between these all blanks are part of the text,
    /// without them those around it are not.
    #[must_use]
    pub fn text(&self) -> &str {
        &self.text
    }

    /// Returns true when blanks stood in front of a text without quotation marks: they are not part of it.
    ///
    /// ```
    /// use profidrive_profile::value::Assignment;
    /// let given = |text: &str| text.parse::<Assignment>().unwrap().value;
    /// assert_eq!((given("0-38= y").text(), given("0-38= y").has_lost_blanks()), ("y", true));
    /// assert_eq!((given("0-38=\" y\"").text(), given("0-38=\" y\"").has_lost_blanks()), (" y", false));
    /// ```
    #[must_use]
    pub const fn has_lost_blanks(&self) -> bool {
        self.cut
    }

    /// Returns the number that was given.
    pub(super) fn quantity(&self, parameter: &str) -> Result<Quantity, ParameterProblem> {
        self.quantity
            .clone()
            .map_err(|problem| ParameterProblem::Quantity {
                parameter: parameter.to_owned(),
                problem,
            })
    }

    /// Returns the value whose text was given: all of it, or as much as only one text begins with; case does not
    /// matter. `None` for a number, and where the parameter is not a selection.
    pub(super) fn choice(
        &self,
        selection: &Selection,
        parameter: &Parameter,
    ) -> Result<Option<i32>, ParameterProblem> {
        let number = !self.quoted && self.quantity.as_ref().is_ok_and(|one| one.unit.is_none());
        if parameter.choices.is_empty() || number {
            return Ok(None);
        }
        let wanted = self.text.trim().to_lowercase();
        let which = |fits: &dyn Fn(&str) -> bool| -> Vec<Meaning> {
            let choices = parameter.choices.iter();
            choices
                .filter(|choice| fits(&choice.text.to_lowercase()))
                .copied()
                .collect()
        };
        let mut found = which(&|text| text == wanted);
        if found.is_empty() && !wanted.is_empty() {
            found = which(&|text| text.starts_with(&wanted));
        }
        if found.is_empty() {
            found = which(&|text| text.chars().count() >= CUT && wanted.starts_with(text));
        }
        match (found.as_slice(), &self.quantity) {
            ([only], _) => Ok(Some(only.value)),
            // a number with a unit
            ([], Ok(_)) => Ok(None),
            ([], Err(_)) => Err(ParameterProblem::NoChoice {
                parameter: selection.label(),
                text: self.text.clone(),
                choices: parameter.choices,
            }),
            (_, _) => Err(ParameterProblem::ManyChoices {
                parameter: selection.label(),
                text: self.text.clone(),
                choices: found,
            }),
        }
    }
}

impl From<Quantity> for Given {
    fn from(quantity: Quantity) -> Self {
        Self {
            text: String::new(),
            quoted: false,
            cut: false,
            quantity: Ok(quantity),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Assignment, Parameters};
    use super::*;
    use crate::catalogue::{AKD, Catalogue, Scaling, VLT};
    use alloc::format;
    use alloc::string::ToString;

    fn raw(catalogue: &'static Catalogue, text: &str) -> Result<i64, String> {
        let tables = Parameters {
            catalogue: Some(catalogue),
            scaling: Scaling::default(),
        };
        let assignment: Assignment = text
            .parse()
            .map_err(|error: ParameterProblem| error.to_string())?;
        let selection = tables.select(&assignment.reference).unwrap();
        let checked = tables.check(&selection, &assignment.value);
        checked.map(|value| value.raw).map_err(|error| error.to_string())
    }

    #[test]
    fn a_text_of_a_selection_is_its_number() {
        for (text, number) in [
            ("8-10=FC profile", 0),
            ("8-10=\"fc PROFILE\"", 0),
            ("8-10='PROFIdrive profile'", 1),
            ("8-10=prof", 1),
            ("8-10=1", 1),
            ("8-10=0x1", 1),
        ] {
            assert_eq!(raw(&VLT, text), Ok(number), "{text}");
        }
        assert!(raw(&AKD, "DRV.OPMODE=velocity").is_ok());
    }

    #[test]
    fn blanks_between_quotation_marks_are_part_of_a_text() {
        let tables = Parameters {
            catalogue: Some(&VLT),
            scaling: Scaling::default(),
        };
        for (text, written, lost) in [
            ("0-37=\"  x \"", "  x", false),
            ("0-37 = '  x '", "  x", false),
            ("0-37=\"  \"", "", false),
            ("0-37=  x ", "x", true),
            ("0-37=x y", "x y", false),
            // blanks at the end fill the string and do not count
            (
                "0-37=\"1234567890123456789012345 \"",
                "1234567890123456789012345",
                false,
            ),
        ] {
            let assignment: Assignment = text.parse().unwrap();
            let selection = tables.select(&assignment.reference).unwrap();
            let checked = tables.check_text(&selection, &assignment.value).unwrap();
            assert_eq!(checked.as_deref(), Some(written), "{text}");
            assert_eq!(assignment.value.has_lost_blanks(), lost, "{text}");
        }
        assert_eq!(raw(&VLT, "8-10=\" FC profile \""), Ok(0));
    }

    #[test]
    fn what_is_no_text_lists_those_that_there_are() {
        let error = raw(&VLT, "8-10=Siemens").unwrap_err();
        assert!(
            error.contains("`Siemens` is none of its texts: 0 FC profile, 1 PROFIdrive"),
            "{error}"
        );
        let error = raw(&VLT, "8-10=\"0\"").unwrap_err();
        assert!(error.contains("none of its texts"), "{error}");
        // a text for something that is not a selection
        let error = raw(&VLT, "3-41=fast").unwrap_err();
        assert!(error.contains("does not start with a number"), "{error}");
        assert!(
            raw(&VLT, "8-10=")
                .unwrap_err()
                .starts_with("8-10: no value given")
        );
    }

    #[test]
    fn an_ambiguous_prefix_is_reported_with_its_candidates() {
        let mut rows = VLT.parameters.iter().flat_map(|row| {
            let first = row.choices.iter().map(|choice| choice.text.to_lowercase());
            let texts: Vec<String> = first.collect();
            let several = |start: &str| texts.iter().filter(|text| text.starts_with(start)).count() > 1;
            let start = texts
                .iter()
                .filter_map(|text| text.get(..1).map(str::to_owned))
                .find(|one| {
                    several(one) && !texts.contains(one) && !one.bytes().all(|byte| byte.is_ascii_digit())
                });
            start
                .map(|start| (row.pnu, start))
                .filter(|_| !row.choices.is_empty())
        });
        let (pnu, start) = rows.next().expect("two texts that begin alike");
        let error = raw(&VLT, &format!("p{pnu}={start}")).unwrap_err();
        assert!(error.contains("may be") || error.contains("read-only"), "{error}");
    }
}

//! Parameters as a person means them: name or number in, engineering value with unit out.

mod check;
mod choice;
mod reading;
mod scaling;
mod select;

pub use check::{Assignment, CheckedValue, MOST_ROUNDING};
pub use check::{is_other_value, is_rounding};
pub use choice::Given;
pub use reading::{Beyond, Content, Interpretation, Reading};
pub use scaling::{SCALING, is_scaling, take_scale};
pub use select::Selection;

use crate::model::Model;
use alloc::format;
use alloc::string::String;
use alloc::vec::Vec;

use crate::catalogue::{Catalogue, Meaning, Parameter, Scaling};
use crate::notation::{Quantity, QuantityError, ReferenceError, UnitMismatch, figures};

/// What is known about the parameters of one drive: its tables, if there are any, and the values that scale others.
#[derive(Debug, Clone, Copy)]
pub struct Parameters {
    /// Tables of the model; `None` for a drive without a built-in catalogue or description.
    pub catalogue: Option<&'static Catalogue>,
    /// Values of the drive that scale other values.
    pub scaling: Scaling,
}

impl Parameters {
    /// Of a model, as delivered.
    #[must_use]
    pub fn of(model: &Model) -> Self {
        Self {
            catalogue: model.catalogue,
            scaling: model.scaling(),
        }
    }

    /// Returns the number that means here what `raw` means under another scaling.
    pub fn converted(&self, parameter: &Parameter, raw: i64, from: &Scaling) -> i64 {
        if self.scales_as(parameter, from) {
            raw
        } else {
            let value = parameter.engineering(raw, from);
            parameter.raw(value * self.units_for_one(parameter, from), &self.scaling)
        }
    }

    /// Returns true when the numbers of a parameter mean the same under both scalings.
    pub fn scales_as(&self, parameter: &Parameter, other: &Scaling) -> bool {
        self.scaling.linear(parameter.scale) == other.linear(parameter.scale)
            && (!parameter.user_unit || self.scaling.unit.unit() == other.unit.unit())
    }

    /// Returns the factor from a unit of a parameter under another scaling to its unit here.
    fn units_for_one(&self, parameter: &Parameter, from: &Scaling) -> f64 {
        if parameter.user_unit && self.scaling.unit.unit() != from.unit.unit() {
            self.scaling.unit.unit().per_revolution / from.unit.unit().per_revolution
        } else {
            1.0
        }
    }
}

/// A parameter or value that cannot be used, found before anything was sent.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ParameterProblem {
    /// The text is not a parameter.
    #[error(transparent)]
    Reference(#[from] ReferenceError),
    /// The text is not a value.
    #[error("{parameter}: {problem}")]
    Quantity {
        /// The parameter to be written.
        parameter: String,
        /// What is wrong.
        problem: QuantityError,
    },
    /// Not `PARAM=VALUE`.
    #[error("`{text}`: write PARAM=VALUE, for example DRV.ACC=5000rpm/s")]
    NoAssignment {
        /// The text as given.
        text: String,
    },
    /// The model has no parameter of this name.
    #[error("{model} has no parameter `{name}`")]
    Unknown {
        /// The name as given.
        name: String,
        /// The model.
        model: &'static str,
        /// Names that are near, best first.
        nearest: Vec<&'static str>,
    },
    /// A name was given, but there are no tables for this drive.
    #[error("`{name}`: no names are known for this drive, give the number of the parameter")]
    NoNames {
        /// The name as given.
        name: String,
    },
    /// A number that collects parameters, without naming them.
    #[error("p{pnu:04} collects parameters by their ids: say which, for example ID 103 or {pnu}[103]")]
    NoId {
        /// The number.
        pnu: u16,
    },
    /// Element beyond the array, or of a parameter that is none.
    #[error("{parameter} has {}, element {index} does not exist", elements_text(*.elements))]
    Element {
        /// The parameter.
        parameter: String,
        /// How many elements there are.
        elements: u16,
        /// The first element requested that is not there.
        index: u32,
    },
    /// Cannot be written.
    #[error("{parameter} is read-only")]
    ReadOnly {
        /// The parameter.
        parameter: String,
    },
    /// A number for something that is none.
    #[error("{parameter} is text: a number cannot be written to it")]
    Text {
        /// The parameter.
        parameter: String,
    },
    /// More characters than a string holds.
    #[error("{parameter} holds {most} characters, not {length}")]
    TextLength {
        /// The parameter.
        parameter: String,
        /// Characters given.
        length: usize,
        /// Characters that fit.
        most: u16,
    },
    /// A character that a VisibleString cannot have.
    #[error(
        "{parameter}: {character:?} is not a printable ASCII character, which is all that a string of a drive has"
    )]
    Character {
        /// The parameter.
        parameter: String,
        /// The first such character.
        character: char,
    },
    /// One value for several elements.
    #[error("{parameter}: one value for {count} elements; write them one by one")]
    ManyElements {
        /// The parameter.
        parameter: String,
        /// How many elements were addressed.
        count: u16,
    },
    /// The unit does not fit.
    #[error("{parameter}: {problem}")]
    Unit {
        /// The parameter.
        parameter: String,
        /// What is wrong.
        problem: UnitMismatch,
    },
    /// A text that none of the selection has.
    #[error("{parameter}: `{text}` is none of its texts: {}", listed(.choices))]
    NoChoice {
        /// The parameter.
        parameter: String,
        /// The text as given.
        text: String,
        /// Every value with its text.
        choices: &'static [Meaning],
    },
    /// A text that several of the selection begin with.
    #[error("{parameter}: `{text}` may be {}", listed(.choices))]
    ManyChoices {
        /// The parameter.
        parameter: String,
        /// The text as given.
        text: String,
        /// Those that it may be.
        choices: Vec<Meaning>,
    },
    /// Below or above what the drive takes.
    #[error("{parameter}: {}{} is outside {} to {}{}", figures(*.value), unit_text(.unit), limit_text(*.minimum, *.value), limit_text(*.maximum, *.value), unit_text(.unit))]
    Limit {
        /// The parameter.
        parameter: String,
        /// The value to write, in the unit of the parameter.
        value: f64,
        /// Lowest value.
        minimum: f64,
        /// Highest value.
        maximum: f64,
        /// Unit of the parameter.
        unit: &'static str,
    },
    /// The drive cannot hold it, and what it can hold is too far away: see [`MOST_ROUNDING`].
    #[error("{parameter}: {}{} is not representable: the nearest values are {}{} and {}{}", figures(.wanted.number.as_f64()), unit_text(.wanted.unit.as_deref().unwrap_or(.unit)), figures(.nearest[0]), unit_text(.unit), figures(.nearest[1]), unit_text(.unit))]
    Coarse {
        /// The parameter.
        parameter: String,
        /// The value as it was written.
        wanted: Quantity,
        /// The values below and above it that the drive can hold.
        nearest: [f64; 2],
        /// Unit of the parameter.
        unit: &'static str,
    },
    /// A fraction for a parameter of whole numbers.
    #[error("{parameter} takes whole numbers, not {}", figures(*.value))]
    Fraction {
        /// The parameter.
        parameter: String,
        /// The value to write.
        value: f64,
    },
    /// Written twice at once.
    #[error("{parameter} is written twice; give it one value")]
    Twice {
        /// The parameter.
        parameter: String,
    },
    /// Half of a value.
    #[error("{parameter} is the high half of {whole}; it counts only with the low half that follows")]
    HighHalf {
        /// The number of the half.
        parameter: String,
        /// Name of the whole value.
        whole: &'static str,
    },
    /// A raw value that does not fit.
    #[error("{parameter}: 0x{raw:X} does not fit {octets} octets")]
    RawSize {
        /// The parameter.
        parameter: String,
        /// The raw value to write.
        raw: u64,
        /// Size of the parameter.
        octets: usize,
    },
}

impl ParameterProblem {
    /// Returns the remedy, where the message does not contain it.
    #[must_use]
    pub fn hint(&self) -> Option<String> {
        match self {
            Self::Unknown { nearest, .. } if !nearest.is_empty() => {
                Some(format!("nearest names: {}", nearest.join(", ")))
            }
            Self::HighHalf { whole, .. } => {
                Some(format!("write {whole}: both halves are sent where it needs them"))
            }
            Self::ManyChoices { .. } => Some("write more of the text, or the number".into()),
            Self::Coarse { .. } => Some("write one of them".into()),
            _ => None,
        }
    }
}

/// `0 PROFIdrive profile, 1 FC profile`
fn listed(choices: &[Meaning]) -> String {
    let texts = choices
        .iter()
        .map(|choice| format!("{} {}", choice.value, choice.text));
    texts.collect::<Vec<_>>().join(", ")
}

fn elements_text(elements: u16) -> String {
    match elements {
        0 | 1 => "no elements".into(),
        count => format!("elements 0 to {}", count - 1),
    }
}

/// Formats a limit with as many decimals as distinguish it from the value beyond it.
fn limit_text(limit: f64, value: f64) -> String {
    let short = figures(limit);
    if limit == value || short != figures(value) {
        return short;
    }
    let texts = (1..=9).map(|decimals| (format!("{limit:.decimals$}"), format!("{value:.decimals$}")));
    let mut apart = texts.filter(|(limit, value)| limit != value);
    apart.next().map_or(short, |(limit, _)| limit)
}

fn unit_text(unit: &str) -> String {
    if unit.is_empty() {
        String::new()
    } else {
        format!(" {unit}")
    }
}

//! What a recording waits for, and what it has of the time before.

use std::collections::VecDeque;
use std::fmt;
use std::str::FromStr;
use std::time::Duration;

use client::FaultEntry;
use profile::notation::Quantity;

use super::error::RecordingError;
use super::table::{Column, Row, Table};

/// Rows that are kept before the trigger: more are not held in memory.
pub const MOST_BEFORE: usize = 200_000;

/// The event at which a recording begins. A condition has to become true: one that is true from the beginning is no event
/// ([`News::HoldsAlready`](super::News::HoldsAlready)).
///
/// ```
/// use profidrive::recording::Trigger;
/// assert_eq!("fault".parse(), Ok(Trigger::Fault));
/// let trigger: Trigger = "NIST_A >= 60rpm".parse()?;
/// assert_eq!(trigger.to_string(), "NIST_A >= 60rpm");
/// assert!("NIST_A about 60rpm".parse::<Trigger>().is_err());
/// # Ok::<(), profidrive::recording::TriggerError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Trigger {
    /// A drive reports a fault (ZSW1 bit 3).
    Fault,
    /// A drive reports a warning (ZSW1 bit 7).
    Warning,
    /// Values are missing.
    Gap,
    /// A signal compares with a value.
    Signal {
        /// Name of its column.
        name: String,
        /// How it compares.
        comparison: Comparison,
        /// The value, in its own unit.
        value: Quantity,
        /// The value as it was given.
        text: String,
    },
}

/// How a signal compares with a value.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Comparison {
    /// `>=`
    AtLeast,
    /// `<=`
    AtMost,
    /// `!=`
    NotEqual,
    /// `>`
    Above,
    /// `<`
    Below,
    /// `=`
    Equal,
}

/// In the order in which a text is searched for them.
const COMPARISONS: [(&str, Comparison); 6] = [
    (">=", Comparison::AtLeast),
    ("<=", Comparison::AtMost),
    ("!=", Comparison::NotEqual),
    (">", Comparison::Above),
    ("<", Comparison::Below),
    ("=", Comparison::Equal),
];

impl Comparison {
    fn holds(self, signal: f64, value: f64) -> bool {
        match self {
            Self::AtLeast => signal >= value,
            Self::AtMost => signal <= value,
            Self::NotEqual => (signal - value).abs() > f64::EPSILON,
            Self::Above => signal > value,
            Self::Below => signal < value,
            Self::Equal => (signal - value).abs() <= f64::EPSILON,
        }
    }
}

/// Why a text is not a trigger.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("`{text}` is not a trigger: {cause}")]
pub struct TriggerError {
    text: String,
    cause: String,
}

impl FromStr for Trigger {
    type Err = TriggerError;

    fn from_str(text: &str) -> Result<Self, TriggerError> {
        let wrong = |cause: String| TriggerError {
            text: text.to_owned(),
            cause,
        };
        match text.trim() {
            "fault" => return Ok(Self::Fault),
            "warning" => return Ok(Self::Warning),
            "gap" => return Ok(Self::Gap),
            _ => {}
        }
        let found = COMPARISONS.iter().find_map(|(sign, comparison)| {
            let (name, value) = text.split_once(sign)?;
            Some((name.trim(), value.trim(), *comparison))
        });
        let Some((name, value, comparison)) = found else {
            return Err(wrong(
                "expected fault, warning, gap or a comparison such as NIST_A>60rpm".to_owned(),
            ));
        };
        if name.is_empty() {
            return Err(wrong("the signal is missing".to_owned()));
        }
        Ok(Self::Signal {
            name: name.to_owned(),
            comparison,
            value: value.parse().map_err(|error| wrong(format!("{error}")))?,
            text: value.to_owned(),
        })
    }
}

impl fmt::Display for Trigger {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Fault => f.write_str("fault"),
            Self::Warning => f.write_str("warning"),
            Self::Gap => f.write_str("gap"),
            Self::Signal {
                name,
                comparison,
                text,
                ..
            } => {
                let sign = COMPARISONS.iter().find(|(_, other)| other == comparison);
                write!(f, "{name} {} {text}", sign.map_or("", |(sign, _)| sign))
            }
        }
    }
}

/// A row with what its drive reports about itself.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Reported {
    pub row: Row,
    pub fault: bool,
    pub warning: bool,
    /// The faults that came with this row.
    pub faults: Vec<FaultEntry>,
}

/// A trigger on the columns of a recording.
#[derive(Debug)]
pub(super) struct Armed {
    condition: Condition,
    /// Whether the condition held in the last row of each drive that has a value for it.
    held: Vec<Option<bool>>,
    /// Drives on which it held in the first row.
    already: Vec<usize>,
    before: VecDeque<Row>,
    pre: Duration,
}

#[derive(Debug)]
enum Condition {
    Fault,
    Warning,
    Gap,
    Column(usize, Comparison, f64),
}

impl Armed {
    pub(super) fn new(trigger: &Trigger, pre: Duration, table: &Table) -> Result<Self, RecordingError> {
        let condition = match trigger {
            Trigger::Fault => Condition::Fault,
            Trigger::Warning => Condition::Warning,
            Trigger::Gap => Condition::Gap,
            Trigger::Signal {
                name,
                comparison,
                value,
                ..
            } => {
                let named = |text: &str| text.eq_ignore_ascii_case(name);
                let at = table.columns.iter().position(|column| named(&column.name));
                let unknown = || RecordingError::TriggerSignal {
                    name: name.clone(),
                    recorded: table.columns.iter().map(|column| column.name.clone()).collect(),
                };
                let at = at.ok_or_else(unknown)?;
                let column = table.columns.get(at).ok_or_else(unknown)?;
                let twice = |other: &&Column| other.name != column.name && other.is_called(&column.name);
                if let Some(other) = table.columns.iter().find(twice) {
                    return Err(RecordingError::TriggerUnits {
                        name: name.clone(),
                        units: (column.unit.clone(), other.unit.clone()),
                    });
                }
                let value = value
                    .in_unit(&column.unit)
                    .map_err(|error| RecordingError::TriggerUnit {
                        name: name.clone(),
                        cause: error.to_string(),
                    })?;
                Condition::Column(at, *comparison, value)
            }
        };
        Ok(Self {
            condition,
            held: vec![None; table.drives.len()],
            already: Vec::new(),
            before: VecDeque::new(),
            pre,
        })
    }

    /// Looks at a row. Returns the rows to record once the trigger came: those before it, then the row itself.
    pub(super) fn look(&mut self, reported: Reported) -> Option<Vec<Row>> {
        let Reported {
            row, fault, warning, ..
        } = reported;
        let holds = match self.condition {
            Condition::Gap => Some(row.gap),
            _ if row.gap => None,
            Condition::Fault => Some(fault),
            Condition::Warning => Some(warning),
            Condition::Column(at, comparison, value) => {
                let signal = row.values.get(at).copied().flatten();
                signal.map(|signal| comparison.holds(signal.number(), value))
            }
        };
        let began = match (self.held.get_mut(row.drive), holds) {
            (Some(held), Some(holds)) => {
                let before = held.replace(holds);
                if before.is_none() && holds {
                    self.already.push(row.drive);
                }
                before == Some(false) && holds
            }
            _ => false,
        };
        let oldest = row.time.saturating_sub(self.pre);
        self.before.push_back(row);
        // rows of several drives are in order to within a reading
        while self.before.front().is_some_and(|row| row.time < oldest) || self.before.len() > MOST_BEFORE {
            self.before.pop_front();
        }
        began.then(|| std::mem::take(&mut self.before).into())
    }

    /// Returns the drives on which the condition held from the beginning.
    pub(super) fn already(&self) -> &[usize] {
        &self.already
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::recording::{Kind, Value};

    fn armed(trigger: &str, pre: u64) -> Armed {
        let table = Table {
            drives: vec!["a".into(), "b".into()],
            facts: Vec::new(),
            columns: vec![Column {
                name: "speed".into(),
                kind: Kind::Number,
                unit: "rpm".into(),
                parameter: String::new(),
                scaling: String::new(),
            }],
        };
        Armed::new(&trigger.parse().unwrap(), Duration::from_millis(pre), &table).unwrap()
    }

    fn row(millis: u64, drive: usize, speed: Option<f64>) -> Reported {
        Reported {
            row: Row {
                time: Duration::from_millis(millis),
                wall: None,
                drive,
                gap: speed.is_none(),
                values: vec![speed.map(Value::Number)],
            },
            fault: false,
            warning: false,
            faults: Vec::new(),
        }
    }

    fn times(rows: Option<Vec<Row>>) -> Option<Vec<u128>> {
        Some(rows?.iter().map(|row| row.time.as_millis()).collect())
    }

    #[test]
    fn a_condition_has_to_become_true_on_one_drive() {
        let mut armed = armed("speed > 1rps", 20);
        assert_eq!(armed.look(row(0, 0, Some(70.0))), None, "true from the beginning");
        assert_eq!(armed.look(row(1, 1, Some(10.0))), None, "the other drive");
        assert_eq!(armed.look(row(10, 0, None)), None, "a gap is no value");
        assert_eq!(armed.look(row(20, 0, Some(50.0))), None);
        assert_eq!(times(armed.look(row(30, 0, Some(61.0)))), Some(vec![10, 20, 30]));
        assert_eq!(armed.already(), [0]);
    }

    #[test]
    fn a_gap_triggers() {
        let mut armed = armed("gap", 0);
        assert_eq!(armed.look(row(0, 0, Some(1.0))), None);
        assert_eq!(times(armed.look(row(5, 0, None))), Some(vec![5]));
    }

    #[test]
    fn what_is_kept_before_the_trigger_is_bounded() {
        let mut armed = armed("fault", u64::MAX / 2_000_000);
        for at in 0..MOST_BEFORE as u64 + 10 {
            assert_eq!(armed.look(row(at, 0, Some(0.0))), None);
        }
        let fault = Reported {
            fault: true,
            ..row(MOST_BEFORE as u64 + 10, 0, Some(0.0))
        };
        assert_eq!(armed.look(fault).map(|rows| rows.len()), Some(MOST_BEFORE));
    }

    proptest::proptest! {
        #[test]
        fn any_text_is_a_trigger_or_an_error(text in ".{0,40}") {
            if let Ok(trigger) = text.parse::<Trigger>() {
                proptest::prop_assert_eq!(trigger.to_string().parse::<Trigger>(), Ok(trigger));
            }
        }
    }
}

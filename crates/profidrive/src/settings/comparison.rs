//! Comparing settings.

use client::backup::{self, Backup, Difference, TaskDifference};
use profile::catalogue::Role;

use crate::Outcome;
use crate::report::{self, DiffReport, MotionTask, Wording};

/// The settings are of two models: names and numbers mean different things.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{left} and {right} are two models: their parameters cannot be compared")]
pub struct OtherModel {
    /// The model on the left.
    pub left: String,
    /// The model on the right.
    pub right: String,
}

/// What two sets of settings differ in.
///
/// ```
/// use profidrive::client::backup::Backup;
/// use profidrive::settings::Comparison;
///
/// let head = "profidrive backup 1\nmodel: AKD\nvendor: 0x0105\ndevice: 0x0001\n";
/// let left = Backup::read(format!("{head}p922 = 1\np2108 = 3000 rpm/s\n"))?;
/// let right = Backup::read(format!("{head}p922 = 9\np2108 = 3000 rpm/s\n"))?;
/// let comparison = Comparison::new(&left, &right)?;
/// assert_eq!((comparison.count(), comparison.of_connection()), (1, 1));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct Comparison<'b> {
    /// One side.
    pub left: &'b Backup,
    /// The other side.
    pub right: &'b Backup,
    /// The settings that differ, by number and element.
    pub settings: Vec<Difference>,
    /// The motion tasks that differ.
    pub tasks: Vec<TaskDifference>,
}

impl<'b> Comparison<'b> {
    /// Compares two sets of settings of one model.
    ///
    /// # Errors
    /// When they are of two models.
    pub fn new(left: &'b Backup, right: &'b Backup) -> Result<Self, OtherModel> {
        if left.header.model != right.header.model {
            return Err(OtherModel {
                left: left.header.model.clone(),
                right: right.header.model.clone(),
            });
        }
        Ok(Self {
            left,
            right,
            settings: backup::compare(left, right),
            tasks: backup::compare_tasks(left, right),
        })
    }

    /// Returns true where the controller decides over a setting by connecting: telegram, mapping, command source, address.
    #[must_use]
    pub fn is_of_connection(&self, one: &Difference) -> bool {
        one.reading().is_some_and(|reading| {
            backup::rule(self.left.parameters(), reading.pnu, reading.index).role == Role::Network
        })
    }

    /// How many settings and motion tasks differ.
    #[must_use]
    pub const fn count(&self) -> usize {
        self.settings.len() + self.tasks.len()
    }

    /// How many of them a controller decides over by connecting.
    #[must_use]
    pub fn of_connection(&self) -> usize {
        let settings = self.settings.iter();
        settings.filter(|one| self.is_of_connection(one)).count()
    }

    /// [`Outcome::Difference`] where anything differs.
    #[must_use]
    pub fn outcome(&self) -> Outcome {
        if self.count() > 0 {
            Outcome::Difference
        } else {
            Outcome::Complete
        }
    }

    /// The same as data; `left` and `right` name the sides.
    #[must_use]
    pub fn report(&self, left: &str, right: &str, wording: &dyn Wording) -> DiffReport {
        let difference = |one| report::Difference::new(one, self.is_of_connection(one), wording);
        let task = |one: &TaskDifference| report::TaskDifference {
            number: one.number,
            left: MotionTask::from(&one.left),
            right: MotionTask::from(&one.right),
        };
        DiffReport {
            left: left.to_owned(),
            right: right.to_owned(),
            differences: self.settings.iter().map(difference).collect(),
            tasks: self.tasks.iter().map(task).collect(),
        }
    }
}

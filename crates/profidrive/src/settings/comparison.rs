//! Comparing settings.

use client::backup::{self, Backup, Difference, IdentityDifference, Pattern, TaskCoverage, TaskDifference};
use client::{Drive, Error, ErrorKind, Session};
use profile::catalogue::Role;

use crate::Outcome;
use crate::report::{self, DiffReport, MotionTask, Wording};

/// Why settings are not compared.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum CompareError {
    /// The settings are of two models: names and numbers mean different things.
    #[error("{left} and {right} are two models: their parameters cannot be compared")]
    OtherModel {
        /// The model on the left.
        left: String,
        /// The model on the right.
        right: String,
    },
    /// The settings are of another kind of drive than the one that they are compared with.
    #[error("{0}")]
    Misfit(String),
    /// No delivered value of the drive is known.
    #[error("{drive}: no value as delivered is known of model {model}")]
    NotDelivered {
        /// The drive.
        drive: String,
        /// Its model.
        model: &'static str,
    },
    /// No setting of either side is meant by a pattern.
    #[error("{0} matches no setting of either side")]
    NoneMeant(String),
    /// The drive cannot be reached, or refuses.
    #[error(transparent)]
    Client(#[from] Error),
}

impl CompareError {
    /// The kind of the error.
    #[must_use]
    pub fn kind(&self) -> ErrorKind {
        match self {
            Self::OtherModel { .. } | Self::Misfit(_) | Self::NoneMeant(_) => ErrorKind::Usage,
            Self::NotDelivered { .. } => ErrorKind::Unsupported,
            Self::Client(error) => error.kind(),
        }
    }
}

/// The settings of a drive that a file has, to compare them.
///
/// # Errors
/// [`CompareError::Misfit`] where the file is of another kind of drive, and when the drive cannot be reached.
pub async fn as_in(session: &mut Session, drive: &mut Drive, file: &Backup) -> Result<Backup, CompareError> {
    if let Some(misfit) = file.header.misfit(drive) {
        return Err(CompareError::Misfit(misfit));
    }
    Ok(session.backup_like(drive, file).await?)
}

/// The settings of a drive as its model is delivered, as far as the tables have them, to compare them ([`as_in`]).
///
/// ```
/// # #[cfg(feature = "simulate")] {
/// use profidrive::Wait;
/// use profidrive::settings::{Comparison, as_delivered, as_in};
///
/// let plant = "[[drive]]\nname = \"akd-1\"\nip = \"192.168.0.11/24\"\nparameters = { \"DRV.ACC\" = 5000 }";
/// let mut network = profidrive::open_plan(plant.parse()?)?;
/// let mut drive = network.find(&"akd-1".parse()?).wait()?;
/// let delivered = as_delivered(&mut network, &mut drive).wait()?;
/// let present = as_in(&mut network, &mut drive, &delivered).wait()?;
/// let changed = Comparison::new(&delivered, &present)?;
/// assert!(changed.settings.iter().any(|one| one.name() == Some("DRV.ACC")));
/// # }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`CompareError::NotDelivered`], and when the drive cannot be reached.
pub async fn as_delivered(session: &mut Session, drive: &mut Drive) -> Result<Backup, CompareError> {
    let delivered = session.as_delivered(drive).await?;
    if delivered.readings().is_empty() {
        return Err(CompareError::NotDelivered {
            drive: drive.label(),
            model: drive.model.name,
        });
    }
    Ok(delivered)
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
    /// [`CompareError::OtherModel`]
    pub fn new(left: &'b Backup, right: &'b Backup) -> Result<Self, CompareError> {
        if left.header.model != right.header.model {
            return Err(CompareError::OtherModel {
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

    /// Returns it without what none of these patterns means; all of it where there is none.
    ///
    /// ```
    /// use profidrive::client::backup::Backup;
    /// use profidrive::settings::Comparison;
    ///
    /// let head = "profidrive backup 1\nmodel: AKD\nvendor: 0x0105\ndevice: 0x0001\n";
    /// let left = Backup::read(format!("{head}p922 = 1\np2108 = 3000 rpm/s\n"))?;
    /// let right = Backup::read(format!("{head}p922 = 9\np2108 = 5000 rpm/s\n"))?;
    /// let telegram = Comparison::new(&left, &right)?.only(&["p922".parse()?])?;
    /// assert_eq!((telegram.count(), telegram.of_connection()), (1, 1));
    /// let error = Comparison::new(&left, &right)?.only(&["DVR.*".parse()?]).unwrap_err();
    /// assert_eq!(error.to_string(), "DVR.* matches no setting of either side");
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`CompareError::NoneMeant`] for a pattern that matches no setting of either side: a name with a mistake would look like
    /// settings that are equal.
    pub fn only(mut self, patterns: &[Pattern]) -> Result<Self, CompareError> {
        let sides = [self.left, self.right];
        let means = |pattern: &&Pattern| {
            let setting = |side: &&Backup| side.readings().iter().any(|reading| pattern.means(reading));
            let task = |number: u16| pattern.means_task(number);
            sides.iter().any(setting) || sides.iter().any(|side| side.task_numbers().into_iter().any(task))
        };
        if let Some(none) = patterns.iter().find(|pattern| !means(pattern)) {
            return Err(CompareError::NoneMeant(none.text().to_owned()));
        }
        if patterns.is_empty() {
            return Ok(self);
        }
        let meant = |one: &Difference| {
            let reading = one.reading();
            reading.is_some_and(|reading| patterns.iter().any(|pattern| pattern.means(reading)))
        };
        self.settings.retain(meant);
        let tasks = |one: &TaskDifference| patterns.iter().any(|pattern| pattern.means_task(one.number));
        self.tasks.retain(tasks);
        Ok(self)
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

    /// What differs in name and address, which no restore writes and which is none of the differences that count.
    ///
    /// ```
    /// use profidrive::client::backup::Backup;
    /// use profidrive::settings::Comparison;
    ///
    /// let head = "profidrive backup 1\nmodel: AKD\nvendor: 0x0105\ndevice: 0x0001\n";
    /// let left = Backup::read(format!("{head}station: axis-1\np2108 = 3000 rpm/s\n"))?;
    /// let right = Backup::read(format!("{head}station: axis-9\np2108 = 3000 rpm/s\n"))?;
    /// let comparison = Comparison::new(&left, &right)?;
    /// assert_eq!(comparison.count(), 0);
    /// let [name] = &comparison.network()[..] else { panic!("only the name differs") };
    /// assert_eq!((name.what, &*name.left, &*name.right), ("name of station", "axis-1", "axis-9"));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub fn network(&self) -> Vec<IdentityDifference> {
        self.left.header.network_differences(&self.right.header)
    }

    /// Why motion tasks of the left and of the right side are not compared though the other side has some: they are left out
    /// there.
    #[must_use]
    pub fn tasks_left_out(&self) -> [Option<&'b str>; 2] {
        let why = |one: &'b Backup, other: &Backup| match &one.header.tasks {
            TaskCoverage::LeftOut(why) if !other.task_numbers().is_empty() => Some(why.as_str()),
            _ => None,
        };
        [why(self.left, self.right), why(self.right, self.left)]
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
            network: self.network().into_iter().map(Into::into).collect(),
        }
    }
}

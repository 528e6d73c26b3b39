//! What a person can do next, as a value: each front end words it as its own command, button or call.

/// Something to do about a state of a drive or about an error.
///
/// Every action applies to the drive that the state or the error is about.
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub enum Action {
    /// Bring the axis to rest along its ramp.
    Stop,
    /// Bring the axis to rest and switch its power stage off.
    Disable,
    /// Read the status of the drive.
    Status,
    /// Write a parameter.
    Write {
        /// The parameter as its vendor writes it.
        parameter: String,
        /// The raw value.
        value: i64,
        /// Name of the value, where it has one.
        meaning: Option<&'static str>,
    },
}

impl Action {
    /// Stable name for programs.
    ///
    /// ```
    /// assert_eq!(drive_client::Action::Disable.id(), "disable");
    /// ```
    #[must_use]
    pub const fn id(&self) -> &'static str {
        match self {
            Self::Stop => "stop",
            Self::Disable => "disable",
            Self::Status => "status",
            Self::Write { .. } => "write",
        }
    }
}

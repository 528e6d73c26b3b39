//! What a parameter is to a tool that saves and restores: data, one rule for each parameter that is not a plain
//! setting.

/// What a parameter is to a tool that saves and restores.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Role {
    /// A setting of the drive.
    Setting,
    /// A setting that belongs to the connection: address, name, telegram.
    Network,
    /// Something that the drive acts on at once: a setpoint, an output.
    Setpoint,
    /// Writing it does something.
    Action,
    /// Shows one row of a table of the drive.
    Window,
    /// Written by the drive itself.
    State,
    /// The same value as another parameter.
    Alias {
        /// Number of the other one, which is not an element of a collecting number.
        of: u16,
    },
    /// Writing it saves all settings.
    Save,
    /// Writing it clears the faults.
    ClearFaults,
    /// Reads 1 while the power stage is on.
    Active,
}

/// When a setting is written: a later phase may depend on all earlier ones.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Default)]
pub enum Phase {
    /// Units and scalings, which decide what other values mean.
    Scaling,
    /// Modes and sources.
    Mode,
    /// Data of motor and feedback, which bound limits.
    Motor,
    /// Limits, which bound other values.
    Limit,
    /// Everything else.
    #[default]
    Value,
    /// Switches that bring other values into effect.
    Enable,
}

/// One row of `data/<model>/backup.csv`, for one parameter.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct BackupRule {
    /// Number of the parameter.
    pub pnu: u16,
    /// Its subindex where it is an element of a collecting number.
    pub base: Option<u16>,
    /// What it is.
    pub role: Role,
    /// When it is written.
    pub phase: Phase,
    /// Why it is not restored like any setting, where the role alone does not explain it.
    pub why: &'static str,
}

impl BackupRule {
    /// Returns the rule of a parameter that no row names.
    #[must_use]
    pub const fn plain(pnu: u16) -> Self {
        Self {
            pnu,
            base: None,
            role: Role::Setting,
            phase: Phase::Value,
            why: "",
        }
    }
}

//! What differs between frequency converters beside their parameters.

/// What differs between frequency converters beside their parameters.
#[derive(Debug, Clone, Copy)]
pub struct Converter {
    /// What a ramp time is the time to.
    pub ramp_to: RampTo,
    /// First and last number of what each set-up has for itself.
    pub own_in_set_up: [u16; 2],
    /// Faults that are counted as those of temperature.
    pub hot: &'static [u16],
    /// Faults that are counted as those of too high a voltage.
    pub over_voltage: &'static [u16],
}

/// What a ramp time is the time to, from standstill.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RampTo {
    /// The synchronous speed of the motor (VLT 3-41).
    Synchronous,
    /// The highest reference (Vacon ID 103).
    HighestReference,
}

//! The parameters that a frequency converter obeys.

/// Numbers of the parameters of a frequency converter; 0: the model has no such parameter.
///
/// Units are those of the catalogue: a current limit in percent is one of the nominal current of the motor, a speed in Hz
/// one of its output frequency.
#[derive(Debug, Clone, Copy, Default)]
pub struct InverterRoles {
    /// Name plate of the motor.
    pub plate: PlateRoles,
    /// Ramps 1 and 2, up and down, s; how far they go says [`ramp_to`](Self::ramp_to).
    pub ramps: [[u16; 2]; 2],
    /// What a ramp time is the time to.
    pub ramp_to: RampTo,
    /// Ramp of the quick stop, s; 0: ramp 1 down.
    pub quick_stop: u16,
    /// Ramp of jogging, s; 0: ramp 1.
    pub jog_ramp: u16,
    /// Speeds of bus jog 1 and 2.
    pub jogs: [u16; 2],
    /// Speed of the jog of control words that have only one.
    pub jog: u16,
    /// Lowest and highest reference: 100 % is the highest.
    pub reference: [u16; 2],
    /// The speed word of the maker's own telegrams goes from the lowest to the highest reference, else from 0.
    pub own_speed_of_range: bool,
    /// Unit of both where it can be chosen, and the value that means Hz; any other value means rpm.
    pub reference_in_hertz: (u16, i64),
    /// A parameter, and the value with which a negative reference turns backwards; with any other value nothing is below
    /// the lowest reference. 0: it always turns backwards.
    pub both_signs: (u16, i64),
    /// Array of preset references, % of the highest one.
    pub presets: u16,
    /// What catch up and slow down add and take away, %.
    pub correction: u16,
    /// Lowest and highest speed of the motor.
    pub speed_limits: [u16; 2],
    /// Lowest and highest output frequency without a warning, Hz.
    pub frequency_limits: [u16; 2],
    /// Permitted direction: 0 forward, 1 backward, 2 both.
    pub direction: u16,
    /// Highest current.
    pub current_limit: u16,
    /// Nominal and highest current of the inverter, A.
    pub inverter_current: [u16; 2],
    /// Current of the DC brake.
    pub brake_current: u16,
    /// Slip compensation, %, and its time, s.
    pub slip: [u16; 2],
    /// Not 0: starts a motor that turns at the speed it has.
    pub flying_start: u16,
    /// Calculated motor protection: the parameter with its values for a warning and for a trip.
    pub thermal: (u16, i64, i64),
    /// Local operation.
    pub panel: PanelRoles,
    /// Set-ups.
    pub set_ups: SetUpRoles,
    /// What is counted and kept over power-off; none: nothing is kept.
    pub counters: Option<&'static CounterRoles>,
    /// Currents and speeds outside of which the extended status word says so: low and high, A and rpm.
    pub watched: [[u16; 2]; 2],
}

/// Numbers of the parameters on the name plate of a motor.
#[derive(Debug, Clone, Copy, Default)]
pub struct PlateRoles {
    /// kW.
    pub power: u16,
    /// V.
    pub voltage: u16,
    /// Hz.
    pub frequency: u16,
    /// A.
    pub current: u16,
    /// rpm.
    pub speed: u16,
    /// Poles, twice the pairs; 0: they follow from the speed.
    pub poles: u16,
    /// Magnetising current, A; 0: half the nominal one.
    pub magnetising: u16,
}

/// Numbers of the parameters of local operation.
#[derive(Debug, Clone, Copy, Default)]
pub struct PanelRoles {
    /// Not 0: the key for running by hand, the one for off and the one for the bus work. 0: they always do.
    pub keys: [u16; 3],
    /// A parameter, and the value with which the control word of the bus has no effect.
    pub not_by_bus: (u16, i64),
}

/// Numbers of the parameters of set-ups.
#[derive(Debug, Clone, Copy, Default)]
pub struct SetUpRoles {
    /// Chooses the one that is active, 0 to 4; any other value: the control word does. 0: the model has no set-ups.
    pub active: u16,
    /// Chooses the one that is read and written, 0 to 4; any other value: the active one.
    pub edit: u16,
    /// A parameter, and its values with which the control word counts.
    pub by_bus: (u16, &'static [i64]),
    /// First and last number of what each set-up has for itself.
    pub own: [u16; 2],
}

/// What a drive counts and logs.
#[derive(Debug, Clone, Copy, Default)]
pub struct CounterRoles {
    /// Faults of temperature.
    pub hot: &'static [u16],
    /// Faults of too high a voltage.
    pub over_voltage: &'static [u16],
    /// Parameters whose changes are logged, with the number of the event.
    pub history: &'static [(u8, u16)],
}

/// What a ramp time is the time to, from standstill.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum RampTo {
    /// The synchronous speed of the motor (VLT 3-41).
    #[default]
    Synchronous,
    /// The highest reference (Vacon ID 103).
    HighestReference,
}

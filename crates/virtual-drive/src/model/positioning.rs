//! The parameters of positioning.

/// PNUs of the parameters that positioning obeys; all 0 for a model that cannot position.
#[derive(Debug, Clone, Copy, Default)]
pub struct PositionRoles {
    /// Values of the motion task being edited.
    pub task: TaskRoles,
    /// Homing.
    pub home: HomeRoles,
    /// Unit of positions.
    pub unit: UnitRoles,
    /// Ends of the modulo range, its switch, and the direction of absolute targets.
    pub modulo_range: [u16; 2],
    /// 1: a modulo axis.
    pub modulo: u16,
    /// 0 inside the range, 1 positive, 2 negative, 3 the shortest way.
    pub modulo_direction: u16,
    /// Bit mask of the software limits.
    pub limits_enabled: u16,
    /// Software limits, negative and positive.
    pub limits: [u16; 2],
    /// Window around the target, in position units.
    pub target_window: u16,
    /// Window around the speed of the task, rpm.
    pub speed_window: u16,
    /// Following error up to which it is in range; 0 always.
    pub error_window: u16,
}

impl PositionRoles {
    /// The model has none of them.
    pub const NONE: Self = Self {
        task: TaskRoles::NONE,
        home: HomeRoles::NONE,
        unit: UnitRoles::NONE,
        modulo_range: [0; 2],
        modulo: 0,
        modulo_direction: 0,
        limits_enabled: 0,
        limits: [0; 2],
        target_window: 0,
        speed_window: 0,
        error_window: 0,
    };
}

/// PNUs of the values of the motion task being edited.
#[derive(Debug, Clone, Copy, Default)]
pub struct TaskRoles {
    /// Which task.
    pub number: u16,
    /// Target or distance.
    pub position: u16,
    /// Speed, rpm.
    pub speed: u16,
    /// Acceleration, rpm/s.
    pub acceleration: u16,
    /// Deceleration, rpm/s.
    pub deceleration: u16,
    /// Control word.
    pub control: u16,
    /// Number of the following task.
    pub next: u16,
    /// Time before it, ms.
    pub dwell: u16,
    /// Profile table.
    pub profile: u16,
}

impl TaskRoles {
    /// The model has none of them.
    pub const NONE: Self = Self {
        number: 0,
        position: 0,
        speed: 0,
        acceleration: 0,
        deceleration: 0,
        control: 0,
        next: 0,
        dwell: 0,
        profile: 0,
    };
}

/// PNUs of homing.
#[derive(Debug, Clone, Copy, Default)]
pub struct HomeRoles {
    /// Method.
    pub mode: u16,
    /// Speed, rpm.
    pub speed: u16,
    /// Acceleration and deceleration, rpm/s.
    pub ramps: [u16; 2],
    /// Start direction: 1 positive.
    pub direction: u16,
    /// Percentage of the speed while an index is looked for.
    pub feedrate: u16,
    /// Current limit on the way to a hard stop, A.
    pub current: u16,
    /// Position of the home point.
    pub position: u16,
    /// Extra move.
    pub distance: u16,
    /// Following error that counts as hard stop.
    pub stop_error: u16,
    /// Longest way, in the unit of positions; 0 any.
    pub farthest: u16,
    /// Not 0: homing starts when the axis is enabled and not homed.
    pub automatic: u16,
}

impl HomeRoles {
    /// The model has none of them.
    pub const NONE: Self = Self {
        mode: 0,
        speed: 0,
        ramps: [0; 2],
        direction: 0,
        feedrate: 0,
        current: 0,
        position: 0,
        distance: 0,
        stop_error: 0,
        farthest: 0,
        automatic: 0,
    };
}

/// PNUs of the unit of positions.
#[derive(Debug, Clone, Copy, Default)]
pub struct UnitRoles {
    /// 1: a linear motor.
    pub motor: u16,
    /// Rotary unit and linear unit.
    pub unit: [u16; 2],
    /// Numerator and denominator of the custom unit.
    pub custom: [u16; 2],
    /// What a linear motor moves in one electrical revolution, um.
    pub pitch: u16,
}

impl UnitRoles {
    /// The model has none of them.
    pub const NONE: Self = Self {
        motor: 0,
        unit: [0; 2],
        custom: [0; 2],
        pitch: 0,
    };
}

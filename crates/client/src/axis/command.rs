//! What a controller sends to an axis in one cycle.

use profile::state::Stw1;

/// Bit 15 of SATZANW: the values of the telegram count (MDI), not a task of the drive's table.
const MDI: u16 = 1 << 15;
/// Bit 0 of MDI_MOD: the target is a position, not a distance.
const ABSOLUTE: u16 = 1 << 0;

/// One traversing task as it travels.
/// Source: AKD manual 5.10.1 and 5.10.2, profile 6.3.4.
///
/// ```
/// use profidrive_client::axis::Traverse;
/// let task = Traverse::task(3);
/// assert_eq!((task.satzanw, task.is_mdi()), (3, false));
/// let move_ = Traverse::absolute(98_304).with_speed(0x0147_AE14, 2, 2);
/// assert_eq!((move_.satzanw, move_.modus), (0x8000, 1));
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Traverse {
    /// SATZANW: number of a task of the drive, or bit 15 for the values below (MDI).
    pub satzanw: u16,
    /// MDI_TARPOS in increments.
    pub target: i32,
    /// MDI_VELOCITY; an AKD takes it without sign, 2^32 is 12000 rpm.
    pub velocity: u32,
    /// MDI_ACC.
    pub acceleration: u16,
    /// MDI_DEC.
    pub deceleration: u16,
    /// MDI_MOD: bit 0 is 1 for a position, 0 for a distance.
    pub modus: u16,
}

impl Traverse {
    /// Creates a task of the drive's own table (program mode).
    #[must_use]
    pub const fn task(number: u16) -> Self {
        Self {
            satzanw: number & !MDI,
            target: 0,
            velocity: 0,
            acceleration: 0,
            deceleration: 0,
            modus: 0,
        }
    }

    /// To a position in increments (MDI).
    #[must_use]
    pub const fn absolute(target: i32) -> Self {
        Self {
            satzanw: MDI,
            target,
            modus: ABSOLUTE,
            ..Self::task(0)
        }
    }

    /// By a distance in increments (MDI).
    #[must_use]
    pub const fn relative(distance: i32) -> Self {
        Self {
            satzanw: MDI,
            target: distance,
            ..Self::task(0)
        }
    }

    /// Returns the same with speed and ramps as they travel.
    #[must_use]
    pub const fn with_speed(self, velocity: u32, acceleration: u16, deceleration: u16) -> Self {
        Self {
            velocity,
            acceleration,
            deceleration,
            ..self
        }
    }

    /// Returns true when the values of the telegram count, false for a task of the drive.
    #[must_use]
    pub const fn is_mdi(self) -> bool {
        self.satzanw & MDI != 0
    }

    /// Returns true for a position, false for a distance or a task of the drive.
    #[must_use]
    pub const fn is_absolute(self) -> bool {
        self.is_mdi() && self.modus & ABSOLUTE != 0
    }
}

/// What to put into the telegram.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Command {
    /// Control word 1.
    pub stw1: Stw1,
    /// Speed setpoint A, where the telegram has it.
    pub nsoll_a: i16,
    /// Traversing task, where the telegram has its signals. Takes effect only with the edge of STW1 bit 6; without a
    /// task the target is the last reported position.
    pub traverse: Traverse,
}

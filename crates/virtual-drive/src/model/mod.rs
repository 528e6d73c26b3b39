//! What makes one drive model differ from another: tables, and nothing that runs.
//!
//! A model is a catalogue (the numbers, from `data/`), a table that says which of its parameters are measured or do
//! something ([`Live`]), and the list of its parameters that the drive obeys ([`Roles`]). The behaviour itself is the
//! same for all models and lives in [`crate::drive`].

mod akd;
mod akd_conditions;
mod condition;
mod live;
mod positioning;

pub use akd::AKD;
pub use condition::{Cause, Condition, Delay, Limit, When};
pub use live::{Action, Bit, Live, Place, Quantity, Sensor, Table};
pub use positioning::{HomeRoles, PositionRoles, TaskRoles, UnitRoles};

use profidrive::catalogue::Catalogue;
use profidrive::parameter::Dialect;

use crate::axis::Plant;

/// Most conditions a model can have.
pub const MOST_CONDITIONS: usize = 32;

/// A drive model.
#[derive(Debug)]
pub struct Model {
    /// Its parameters, faults and modules.
    pub catalogue: &'static Catalogue,
    /// Parameters that are not just stored, ascending by PNU; every other parameter keeps what is written.
    pub live: &'static [(u16, Live)],
    /// Parameters that the drive obeys.
    pub roles: Roles,
    /// Motor and load of the virtual drive.
    pub plant: Plant,
    /// How its parameter manager answers.
    pub dialect: &'static Dialect,
    /// What it watches, and the numbers that come of it; at most [`MOST_CONDITIONS`].
    pub conditions: &'static [Condition],
    /// Faults with a parameter that says what becomes of them (0 fault, 1 nothing, 4 warning), ascending by fault.
    pub fault_actions: &'static [(u16, u16)],
    /// Fault raised when the controller is lost.
    pub connection_lost_fault: u16,
    /// Value of PNU 965: profile 3, version 41.
    pub profile: u16,
}

/// PNUs of the parameters that the drive obeys; `None` where a model has no such parameter.
#[derive(Debug, Clone, Copy, Default)]
pub struct Roles {
    /// Acceleration ramp, rpm/s.
    pub acceleration: Option<u16>,
    /// Deceleration ramp, rpm/s.
    pub deceleration: Option<u16>,
    /// Deceleration of the quick stop, rpm/s.
    pub quick_stop: Option<u16>,
    /// Speed below which the quick stop and the ramp stop take the axis as standing, rpm.
    pub standstill: Option<u16>,
    /// Jog speeds 1 and 2, rpm.
    pub jog_speed: [Option<u16>; 2],
    /// Jog ramps up and down, rpm/s.
    pub jog_ramp: [Option<u16>; 2],
    /// Peak current of the drive, A.
    pub peak_current: Option<u16>,
    /// User limits of the current, positive and negative, A.
    pub current_limit: [Option<u16>; 2],
    /// Limits of the speed, positive and negative, rpm.
    pub speed_limit: [Option<u16>; 2],
    /// Proportional gain of the velocity loop, A/(rad/s).
    pub gain: Option<u16>,
    /// Corner frequency of the integral part, Hz.
    pub integral: Option<u16>,
    /// Proportional gain of the position loop, (rev/s)/rev.
    pub position_gain: Option<u16>,
    /// Part of the reference speed that goes past the position loop.
    pub speed_forward: Option<u16>,
    /// Continuous currents of drive and motor, A and mA.
    pub continuous_current: [Option<u16>; 2],
    /// Peak current of the motor, mA.
    pub motor_peak_current: Option<u16>,
    /// Longest time at the peak current of the motor, s.
    pub motor_peak_time: Option<u16>,
    /// Steps of speed signals.
    pub velocity_scaling: Option<u16>,
    /// Steps of acceleration signals, rpm/s.
    pub acceleration_scaling: Option<u16>,
    /// Divisor of positions.
    pub position_scaling: Option<u16>,
    /// Bits of one revolution in position signals.
    pub singleturn_bits: Option<u16>,
    /// Control mode: 0 current, 1 speed, 2 position.
    pub mode: Option<u16>,
    /// Who commands: 0 the service channel, 1 the field bus.
    pub command_source: Option<u16>,
    /// Speed command of the service channel, rpm.
    pub service_speed: Option<u16>,
    /// Current command of the service channel, A.
    pub service_current: Option<u16>,
    /// What a disable does: 0 and 1 at once, 2 and 3 after a ramp.
    pub disable_mode: Option<u16>,
    /// How the IP address is obtained: 1 as DCP set it.
    pub address_mode: Option<u16>,
    /// 1 when a holding brake is fitted, and 1 when it is released by hand.
    pub brake: [Option<u16>; 2],
    /// Bit 0: 1 raises the connection fault when the controller goes from RUN to STOP.
    pub bus_options: Option<u16>,
    /// What positioning obeys.
    pub positioning: PositionRoles,
}

impl Model {
    /// What a parameter is beyond its stored number, by position in the catalogue; made once per drive.
    #[must_use]
    pub fn live_by_position(&self) -> Box<[Live]> {
        let mut table = vec![Live::Stored; self.catalogue.parameters.len()].into_boxed_slice();
        for (pnu, live) in self.live {
            if let Some(place) = self
                .catalogue
                .position(*pnu)
                .and_then(|position| table.get_mut(position))
            {
                *place = *live;
            }
        }
        table
    }
}

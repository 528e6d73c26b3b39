//! What makes one drive model differ from another: tables, and nothing that runs.
//!
//! A model is a catalogue (the numbers, from `data/`), a table that says which of its parameters are measured or do
//! something ([`Live`]), and the list of its parameters that the drive obeys ([`Roles`]). The behaviour itself is the
//! same for all models and lives in [`crate::drive`].

mod akd;
mod akd_conditions;
mod condition;
mod inverter;
mod live;
mod positioning;
mod process;
mod terminal;
mod vacon;
mod vlt;

pub use akd::AKD;
pub use condition::{Cause, Condition, Delay, Limit, When};
pub use inverter::{CounterRoles, InverterRoles, PanelRoles, PlateRoles, RampTo, SetUpRoles};
pub use live::{Action, Bit, Live, Place, Quantity, Sensor, Table};
pub use positioning::{HomeRoles, PositionRoles, TaskRoles, UnitRoles};
pub use process::{Chosen, ControlTimeout, Lost, ProcessFacts, Signals, TimeoutAction, Wire};
pub use terminal::{InputFunction, Terminal};
pub use vacon::VACON;
pub use vlt::VLT;

use profile::catalogue::{Catalogue, Parameter};
use profile::fault::Shape;

use crate::axis::Plant;

/// Most conditions a model can have.
pub const MOST_CONDITIONS: usize = 32;

/// Every model.
pub static ALL: [&Model; 3] = [&AKD, &VLT, &VACON];

/// The model with this name, case does not matter.
///
/// ```
/// use profidrive_virtual_drive::model;
/// assert_eq!(model::by_name("vlt").unwrap().catalogue.model, "VLT");
/// assert!(model::by_name("sinamics").is_none());
/// ```
#[must_use]
pub fn by_name(name: &str) -> Option<&'static Model> {
    ALL.into_iter()
        .find(|model| model.catalogue.model.eq_ignore_ascii_case(name))
}

/// A drive model.
#[derive(Debug, Clone)]
pub struct Model {
    /// Its parameters, faults and modules.
    pub catalogue: &'static Catalogue,
    /// Parameters that are not just stored, ascending by number; every other parameter keeps what is written.
    pub live: &'static [(u16, Live)],
    /// Parameters that the drive obeys.
    pub roles: Roles,
    /// Motor and load of the virtual drive.
    pub plant: Plant,
    /// What its clients know too: dialect of its parameter manager, parameter channel, control words.
    pub known: &'static profile::model::Model,
    /// What its process data are.
    pub process: ProcessFacts,
    /// What is particular about it on PROFINET.
    pub wire: Wire,
    /// What it watches, and the numbers that come of it; at most [`MOST_CONDITIONS`].
    pub conditions: &'static [Condition],
    /// Faults with a parameter that says what becomes of them (0 fault, 1 nothing, 4 warning), ascending by fault.
    pub fault_actions: &'static [(u16, u16)],
    /// Parameters that cannot be changed while the power stage is on, as the maker counts them, ascending.
    pub only_stopped: &'static [u16],
    /// Fault raised when the controller is lost.
    pub connection_lost_fault: u16,
    /// When that is a fault.
    pub connection_lost: Lost,
    /// Shape of its fault buffer.
    pub fault_buffer: Shape,
    /// Value of PNU 965: profile 3, version 41.
    pub profile: u16,
}

/// Numbers of the parameters that the drive obeys, as its maker counts them: PNUs, or application ids of a Vacon. `None`
/// where a model has no such parameter.
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
    /// 0: the bus may change no parameter but this one (PNU 927).
    pub edit: Option<u16>,
    /// What positioning obeys.
    pub positioning: PositionRoles,
    /// Digital inputs, from number 1 on.
    pub terminals: &'static [Terminal],
    /// What they do by their modes; a mode that is not here does nothing.
    pub input_functions: &'static [(i64, InputFunction)],
    /// What a frequency converter obeys; none for a servo drive.
    pub inverter: Option<&'static InverterRoles>,
}

impl Roles {
    /// A drive that obeys no parameter.
    pub const NONE: Self = Self {
        acceleration: None,
        deceleration: None,
        quick_stop: None,
        standstill: None,
        jog_speed: [None; 2],
        jog_ramp: [None; 2],
        peak_current: None,
        current_limit: [None; 2],
        speed_limit: [None; 2],
        gain: None,
        integral: None,
        position_gain: None,
        speed_forward: None,
        continuous_current: [None; 2],
        motor_peak_current: None,
        motor_peak_time: None,
        velocity_scaling: None,
        acceleration_scaling: None,
        position_scaling: None,
        singleturn_bits: None,
        mode: None,
        command_source: None,
        service_speed: None,
        service_current: None,
        disable_mode: None,
        address_mode: None,
        brake: [None; 2],
        bus_options: None,
        edit: None,
        positioning: PositionRoles::NONE,
        terminals: &[],
        input_functions: &[],
        inverter: None,
    };
}

/// Where in the catalogue the parameter with a number of its maker is: a PNU, or an application id of a Vacon.
#[must_use]
pub fn numbered(catalogue: &Catalogue, number: u16) -> Option<usize> {
    let (pnu, base) = catalogue.meant(number, None);
    catalogue
        .place(pnu, base.unwrap_or_default())
        .map(|(position, _)| position)
}

impl Model {
    /// The parameter with a number of the maker.
    #[must_use]
    pub fn numbered(&self, number: u16) -> Option<&'static Parameter> {
        self.catalogue.parameters.get(numbered(self.catalogue, number)?)
    }

    /// The parameter at this place of the catalogue cannot be changed while the power stage is on.
    #[must_use]
    pub fn is_only_stopped(&self, position: usize) -> bool {
        let mut numbers = self.only_stopped.iter();
        numbers.any(|number| numbered(self.catalogue, *number) == Some(position))
    }

    /// Where in the catalogue the parameter is that a signal is.
    #[must_use]
    pub fn position_of_signal(&self, signal: u16) -> Option<usize> {
        numbered(self.catalogue, self.process.signals.parameter(signal)?)
    }

    /// What a parameter is beyond its stored number, by position in the catalogue; made once per drive.
    #[must_use]
    pub fn live_by_position(&self) -> Box<[Live]> {
        let mut table = vec![Live::Stored; self.catalogue.parameters.len()].into_boxed_slice();
        for (pnu, live) in self.live {
            if let Some(place) = numbered(self.catalogue, *pnu).and_then(|position| table.get_mut(position)) {
                *place = *live;
            }
        }
        table
    }
}

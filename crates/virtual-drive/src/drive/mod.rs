//! One drive: control word in, status word out, an axis and its parameters. Independent of PROFINET.

mod address;
mod alias;
mod control_timeout;
mod counters;
mod external;
mod faults;
mod history;
mod injection;
mod inverter;
mod memory;
mod motion;
mod observation;
mod panel;
mod parameters;
mod position;
mod reading;
mod saving;
mod set_ups;
mod settings;
mod signals;
mod telegrams;
mod terminals;
mod velocity;
mod words;
mod writing;
mod written;

use std::collections::VecDeque;
use std::time::Duration;

use profile::catalogue::Scaling;
use profile::parameter::SaveId;
use profile::pkw;
use profile::state::{FaultReaction, Machine, Orders, SetpointChannel, Stw1, Zsw1};
use profinet::Instant;

pub use address::AddressSource;
pub use injection::{Injection, InjectionError, Key as InjectionKey};
pub use profile::state::State;
pub use settings::Mode;
pub use written::{WriteChannel, Written, WrittenValue};

use crate::axis::{Axis, Plant};
use crate::model::{Live, Model};
use crate::store::Values;
use control_timeout::ControllerLoss;
use counters::Meter;
use external::ExternalInputs;
use faults::{Faults, Keeper};
use history::History;
use parameters::Half;
use position::Positioning;
use saving::Saving;
use set_ups::SetUps;
use settings::Settings;
use signals::Process;
use telegrams::FreeTelegram;
use terminals::Terminals;

/// How often a drive that moves without a connection has to be looked after.
const OWNERLESS_PERIOD: Duration = Duration::from_millis(4);

/// For how many ticks a drive at rest is looked after when something happened to it: two seconds, until its bus has
/// settled.
const RESTLESS: u16 = 500;

/// Most events that wait; older ones are dropped. More than the elements that one parameter job can write.
const MOST_EVENTS: usize = 256;
/// Events that there is room for from the beginning: a tick allocates nothing while its owner takes them.
const USUAL_EVENTS: usize = 16;

/// An event of the drive that its owner may report or must handle.
#[derive(Debug, Clone, PartialEq)]
pub enum Event {
    /// The profile state changed.
    State {
        /// Before.
        from: State,
        /// Now.
        to: State,
    },
    /// A fault came.
    Fault {
        /// Its number, as in PNU 947.
        number: u16,
    },
    /// The faults were acknowledged.
    Acknowledged,
    /// A warning came or went.
    Warning {
        /// Its number, as in DRV.WARNING1.
        number: u16,
        /// True when it came.
        active: bool,
    },
    /// Store this text so that the drive can be started with it (`store::save`).
    Save {
        /// The image of all saved parameters.
        text: String,
        /// A client requested it. Otherwise the drive saves its counters.
        asked: bool,
        /// Number of the save, for [`Drive::report_save`].
        save: SaveId,
    },
    /// Show which drive this is.
    Blink,
    /// Restart (DRV.REBOOT, VLT 9-72).
    Restart,
    /// Take the address by the settings of now (IP.RESET).
    ApplyAddress,
    /// The address settings are those of the delivery at the next power-on (button B1).
    AddressReset,
    /// A setpoint of the telegram is outside the limits of the parameter that it stands for: that one keeps its value. Once,
    /// until the setpoint is inside again.
    Ignored {
        /// Number of the setpoint.
        pnu: u16,
        /// As it came.
        raw: i64,
    },
    /// A parameter was written.
    Written(Written),
    /// A command was refused because a virtual drive has not what it is about.
    Unable {
        /// Its number.
        pnu: u16,
    },
}

/// Why a connection ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Disconnect {
    /// The controller released it.
    Released,
    /// It broke.
    Lost,
    /// No connection, but the master of a serial line became silent.
    Silent,
}

/// What the service channel (DRV.EN) does with the power stage.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Service {
    /// Nothing.
    Off,
    /// Switches it on in the next step.
    Starting,
    /// Has it on.
    On,
}

/// What is known of the controller.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Link {
    /// No cyclic connection.
    None,
    /// A cyclic connection; `running` when its data is valid, `exchanging` once start-up is over.
    Cyclic {
        watchdog: Duration,
        running: bool,
        exchanging: bool,
    },
}

impl Link {
    const fn is_cyclic(self) -> bool {
        matches!(self, Self::Cyclic { .. })
    }

    const fn watchdog(self) -> Duration {
        match self {
            Self::None => Duration::ZERO,
            Self::Cyclic { watchdog, .. } => watchdog,
        }
    }

    const fn is_exchanging(self) -> bool {
        matches!(self, Self::Cyclic { exchanging: true, .. })
    }
}

/// A virtual drive.
///
/// ```
/// use std::time::Duration;
/// use profinet::Instant;
/// use profidrive_virtual_drive::{drive::Drive, model};
///
/// let mut drive = Drive::new(&model::AKD);
/// drive.connect(1, Duration::from_millis(48)).unwrap();
/// let mut now = Instant::ZERO;
/// let mut inputs = [0; 4];
/// for words in [0x047E_0000_u32, 0x047F_00A3] {
///     for _ in 0..10 {
///         now += Duration::from_millis(16);
///         drive.tick(now, Some(&words.to_be_bytes()), &mut inputs);
///     }
/// }
/// let speed = i16::from_be_bytes([inputs[2], inputs[3]]);
/// assert!((155..170).contains(&speed)); // 60 rpm
/// ```
#[derive(Debug)]
pub struct Drive {
    model: &'static Model,
    live: &'static [Live],
    /// One half of a 64-bit value.
    half: Option<Half>,
    /// Where the change that is being made came from.
    write_channel: WriteChannel,
    /// Those of the active set-up.
    values: Values,
    set_ups: Option<SetUps>,
    settings: Settings,
    saving: Saving,
    machine: Machine,
    /// What the control word requests that the machine took last.
    orders: Orders,
    /// Parameter channel in the process data.
    pkw: Option<pkw::Server>,
    meter: Meter,
    history: History,
    channel: SetpointChannel,
    /// Reaction to the faults that came since the last step of the machine.
    reaction: Option<FaultReaction>,
    /// Without its controller, and not yet stopped by that.
    controller_loss: Option<ControllerLoss>,
    faults: Faults,
    external: ExternalInputs,
    /// Position of the rotary switches, where they give the address as delivered.
    rotary: Option<u8>,
    terminals: Terminals,
    axis: Axis,
    positioning: Positioning,
    /// Speed that the axis has when the ramp is done, rpm.
    target: f64,
    /// Current that a frozen setpoint keeps, A.
    held_current: f64,
    process: Process,
    free: Vec<FreeTelegram>,
    /// At a serial line, whose process data have one form: the value of PNU 922 then, which is a setting of the
    /// network.
    aside: Option<u16>,
    link: Link,
    service: Service,
    clear_requested: bool,
    disable_requested: bool,
    /// When it was requested.
    disable_since: Instant,
    stop_requested: bool,
    /// Ticks for which a drive that rests is looked after anyway: something happened to it.
    restless: u16,
    last: Instant,
    events: VecDeque<Event>,
}

impl Drive {
    /// Creates a drive as delivered, at rest.
    #[must_use]
    pub fn new(model: &'static Model) -> Self {
        let values = Values::new(model.catalogue);
        let settings = Settings::new(model, &values);
        let live = model.live_by_position();
        let mut drive = Self {
            model,
            set_ups: SetUps::new(model, live),
            live,
            half: None,
            write_channel: WriteChannel::Other,
            values,
            settings,
            saving: Saving::default(),
            machine: Machine::new(),
            orders: Orders::default(),
            pkw: model.known.pkw.map(|dialect| pkw::Server::new(*dialect)),
            meter: Meter::default(),
            history: History::new(model),
            channel: SetpointChannel::default(),
            reaction: None,
            controller_loss: None,
            faults: Faults::new(model.fault_buffer, model.known.dialect.fault_counter),
            external: ExternalInputs::default(),
            rotary: None,
            terminals: Terminals::default(),
            axis: Axis::new(model.plant),
            positioning: Positioning::new(),
            target: 0.0,
            held_current: 0.0,
            process: Process::new(model),
            free: FreeTelegram::of(model),
            aside: None,
            link: Link::None,
            service: Service::Off,
            clear_requested: false,
            disable_requested: false,
            disable_since: Instant::ZERO,
            stop_requested: false,
            restless: 0,
            last: Instant::ZERO,
            events: VecDeque::with_capacity(USUAL_EVENTS),
        };
        drive.fit_motor();
        drive.process.status = drive.in_profile_bits(drive.process.status);
        drive
    }

    /// Returns the model of the drive.
    #[must_use]
    pub const fn model(&self) -> &'static Model {
        self.model
    }

    /// Returns the next event. A drive with counters emits a save event from time to time.
    pub fn poll_event(&mut self) -> Option<Event> {
        self.count_due();
        self.events.pop_front().or_else(|| self.saving.poll())
    }

    fn emit(&mut self, event: Event) {
        if self.events.len() >= MOST_EVENTS {
            self.events.pop_front();
        }
        self.events.push_back(event);
    }

    /// A controller has connected and will exchange this telegram; it counts as lost after `watchdog`.
    ///
    /// # Errors
    /// When the model has no such telegram.
    pub fn connect(&mut self, telegram: u16, watchdog: Duration) -> Result<(), UnknownTelegram> {
        let in_force = (self.process.speed, self.process.current);
        if !self.choose_telegram(telegram) {
            return Err(UnknownTelegram(telegram));
        }
        if self.controller_loss.is_some_and(ControllerLoss::holds) {
            // The last control word counts until this controller takes control, and so does the setpoint beside it.
            (self.process.speed, self.process.current) = in_force;
        }
        self.keep(self.model.connection_lost_fault, Keeper::Action, false);
        self.take_command_source();
        if let Some(server) = &mut self.pkw {
            server.reset();
        }
        self.link = Link::Cyclic {
            watchdog,
            running: false,
            exchanging: false,
        };
        Ok(())
    }

    /// Ends the start-up: cyclic data is exchanged. Valid outputs in [`tick`](Self::tick) have the same effect.
    pub const fn data_exchange(&mut self) {
        if let Link::Cyclic { exchanging, .. } = &mut self.link {
            *exchanging = true;
        }
    }

    /// The connection is gone. A lost one raises the fault of the model (702) once data was exchanged, a start-up that
    /// breaks off before that does not; a released one only when the power stage was on, and then it stops too.
    pub fn disconnect(&mut self, cause: Disconnect) {
        let exchanging = self.link.is_exchanging();
        let age = self.link.watchdog();
        self.link = Link::None;
        if exchanging && (cause != Disconnect::Released || self.is_enabled()) {
            self.raise_lost(cause, age);
        }
    }

    /// Moves the drive on to `now`: reads the outputs of the controller (`None` while they are not valid), writes the
    /// inputs for it. Call it right before each input frame, or with empty inputs when [`next_tick`](Self::next_tick)
    /// says so. Allocates nothing.
    pub fn tick(&mut self, now: Instant, outputs: Option<&[u8]>, inputs: &mut [u8]) {
        let passed = now - self.last;
        self.last = now;
        self.count_time_without_controller(passed);
        self.take_outputs(outputs);
        self.serve_channel(outputs, inputs);
        let was_enabled = self.is_enabled();
        let mut status = self.decide();
        self.hold_brake();
        if self.is_enabled() && !was_enabled {
            // What forbids it counts before the first current flows.
            status = self.look_after(status);
        }
        self.restless = self.restless.saturating_sub(1);
        self.position_decide();
        if self.is_enabled() || !self.axis.is_at_rest() {
            self.move_axis(passed.as_secs_f64());
        } else {
            self.axis.rest(passed.as_secs_f64(), &self.settings.tuning);
        }
        status = self.look_after(status);
        self.position_settle();
        self.process.status = self.in_profile_bits(status);
        self.meter.count(passed, self.is_enabled(), &self.axis);
        self.watch_history();
        self.give_inputs(inputs);
    }

    /// Follows what happened since the last tick, as a tick of no time: without a cyclic connection nothing else ticks a
    /// drive at rest. It is ticked for a while from then on, as what happened may need time.
    fn follow(&mut self) {
        if !self.link.is_cyclic() {
            self.tick(self.last, None, &mut []);
            self.restless = RESTLESS;
        }
    }

    /// Returns the time when a drive without a connection has to be ticked; `None` while nothing moves. With a
    /// connection the cycle of the input frames ticks it.
    #[must_use]
    pub fn next_tick(&self) -> Option<Instant> {
        let waits = matches!(self.controller_loss, Some(ControllerLoss::Waits(_)));
        let pending =
            waits || self.reaction.is_some() || self.disable_requested || self.service == Service::Starting;
        let idle = !self.is_enabled() && self.axis.is_at_rest() && !pending && self.restless == 0;
        if idle || self.link.is_cyclic() {
            None
        } else {
            Some(self.last + OWNERLESS_PERIOD)
        }
    }

    /// Returns the control word received last.
    #[must_use]
    pub const fn control_word(&self) -> Stw1 {
        self.process.control
    }

    /// Returns the status word sent last.
    #[must_use]
    pub const fn status_word(&self) -> Zsw1 {
        Zsw1(self.process.status)
    }

    /// Returns the values of its parameters that scale others.
    #[must_use]
    pub const fn scaling(&self) -> Scaling {
        self.settings.scaling
    }

    /// Profile state.
    #[must_use]
    pub const fn state(&self) -> State {
        self.machine.state()
    }

    /// Returns the mechanics, to look at.
    #[must_use]
    pub const fn axis(&self) -> &Axis {
        &self.axis
    }

    /// Torque in Nm that the load puts on the shaft against positive rotation.
    pub const fn set_load(&mut self, torque: f64) {
        self.axis.set_load(torque);
    }

    /// Puts the drive, where it is, on another motor, load and way.
    pub fn set_plant(&mut self, plant: Plant) {
        self.axis.set_plant(plant);
        self.fit_motor();
    }

    /// Returns true while the power stage is on (DRV.ACTIVE).
    #[must_use]
    pub fn is_enabled(&self) -> bool {
        self.state().pulses()
    }

    /// Returns true while the motor turns or may turn: the power stage is on, or the axis is not at standstill yet.
    #[must_use]
    pub fn is_operating(&self) -> bool {
        self.is_enabled() || !self.axis.is_standing(self.settings.standstill)
    }

    /// Finds faults and warnings; a new fault has its effect on the status word at once.
    fn look_after(&mut self, status: u16) -> u16 {
        self.supervise();
        if self.reaction.is_some() {
            self.decide()
        } else {
            status
        }
    }

    const fn is_quick_stopping(&self) -> bool {
        matches!(self.state(), State::S5Quick)
    }

    fn request_disable(&mut self) {
        self.disable_requested = self.is_enabled();
        self.disable_since = self.last;
    }

    /// Bit 10 of the control word: the controller has control.
    const fn is_controlled_by_bus(&self) -> bool {
        matches!(self.link, Link::Cyclic { running: true, .. })
            && self.process.orders.stw1.has(Stw1::CONTROL_BY_PLC)
    }

    /// Takes changed parameters over.
    fn apply(&mut self) {
        self.follow_set_up();
        self.settings = Settings::new(self.model, &self.values);
        self.fit_motor();
        self.choose_words();
        self.follow_levels();
    }
}

/// The model has no such telegram.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("this drive has no telegram {0}")]
pub struct UnknownTelegram(pub u16);

#[cfg(test)]
mod bench;
#[cfg(test)]
mod conformance;
#[cfg(test)]
mod counter_tests;
#[cfg(test)]
mod fault_tests;
#[cfg(test)]
mod memory_tests;
#[cfg(test)]
mod objection_tests;
#[cfg(test)]
mod panel_tests;
#[cfg(test)]
mod set_up_tests;
#[cfg(test)]
mod table_tests;
#[cfg(test)]
mod telegram_tests;
#[cfg(test)]
mod terminal_tests;
#[cfg(test)]
mod tests;
#[cfg(test)]
mod vacon_tests;
#[cfg(test)]
mod velocity_tests;
#[cfg(test)]
mod vendors_tests;
#[cfg(test)]
mod vlt_tests;

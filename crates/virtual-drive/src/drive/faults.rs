//! Faults and warnings: what has come, what its cause is, and when it may go.
//!
//! Faults come from three sides: from the conditions of the model ([`Condition`](crate::model::Condition), walked here in
//! every tick), from other parts of the drive (a lost controller, a motion task that cannot run), and from outside
//! ([`Injection`](super::Injection)). Source: AKD PROFINET manual 5.14.

use std::time::Duration;

use profile::catalogue::{Cleared, Part};
use profile::fault::{Counting, Fault, FaultBuffer, Shape};
use profile::state::FaultReaction;
use profinet::Instant;

use super::{Drive, Event};
use crate::model::{Cause, Limit, MOST_CONDITIONS, Model, When};

/// Faults shown by DRV.FAULT1 and following; a situation of the buffer holds eight of them.
const MOST_ACTIVE: usize = 10;

/// Fault numbers whose cause was put there from outside and lasts.
const MOST_LASTING: usize = 8;

/// Warnings at one time.
const MOST_WARNINGS: usize = 16;

/// Faults in the log (VLT 15-30).
const LOGGED: usize = 10;

/// Value of FAULTn.ACTION: the fault is ignored.
const IGNORE: i64 = 1;

/// Value of FAULTn.ACTION: a warning instead.
const WARN: i64 = 4;

/// A few numbers in the order in which they came; 0 is not a number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Numbers<const N: usize>([u16; N]);

impl<const N: usize> Numbers<N> {
    const NONE: Self = Self([0; N]);

    fn iter(&self) -> impl Iterator<Item = u16> + '_ {
        self.0.iter().copied().take_while(|number| *number != 0)
    }

    fn contains(&self, number: u16) -> bool {
        self.iter().any(|known| known == number)
    }

    fn at(&self, place: usize) -> u16 {
        self.0.get(place).copied().unwrap_or(0)
    }

    /// Adds a number that is not there yet; false when it is, or when there is no place.
    fn push(&mut self, number: u16) -> bool {
        if self.contains(number) {
            return false;
        }
        match self.0.iter_mut().find(|place| **place == 0) {
            Some(place) => {
                *place = number;
                true
            }
            None => false,
        }
    }

    /// Takes a number out; the later ones move up.
    fn remove(&mut self, number: u16) -> bool {
        let Some(place) = self.0.iter().position(|known| *known == number && number != 0) else {
            return false;
        };
        if let Some(rest) = self.0.get_mut(place..) {
            rest.rotate_left(1);
        }
        if let Some(last) = self.0.last_mut() {
            *last = 0;
        }
        true
    }
}

/// Cause of an active warning.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Keeper {
    /// A condition of the model.
    Condition = 1,
    /// Motion: tasks, homing, software limits.
    Motion = 2,
    /// Put there from outside.
    ExternalInputs = 4,
    /// A fault that its FAULTn.ACTION made a warning.
    Action = 8,
}

/// The faults and warnings of one drive.
#[derive(Debug, Clone)]
pub(super) struct Faults {
    buffer: FaultBuffer,
    active: Numbers<MOST_ACTIVE>,
    lasting: Numbers<MOST_LASTING>,
    warnings: Numbers<MOST_WARNINGS>,
    /// Causes of the warning in the same place, bits of [`Keeper`].
    keepers: [u8; MOST_WARNINGS],
    /// Conditions whose cause is there, by place in the table of the model; and those that count.
    present: u32,
    counting: u32,
    /// Since when a delayed condition has its cause.
    since: [Option<Instant>; MOST_CONDITIONS],
    /// The faults that came last with their time, the newest first.
    log: [(u16, Duration); LOGGED],
}

impl Faults {
    pub fn new(shape: Shape, counting: Counting) -> Self {
        let buffer = FaultBuffer::with_shape(shape).unwrap_or_default();
        Self {
            buffer: buffer.with_counting(counting),
            active: Numbers::NONE,
            lasting: Numbers::NONE,
            warnings: Numbers::NONE,
            keepers: [0; MOST_WARNINGS],
            present: 0,
            counting: 0,
            since: [None; MOST_CONDITIONS],
            log: [(0, Duration::ZERO); LOGGED],
        }
    }

    /// PNU 952.
    pub const fn situations(&self) -> u16 {
        self.buffer.situations()
    }

    /// Empties the buffer.
    pub fn forget(&mut self) {
        self.buffer.clear();
    }

    /// One of the faults that came last, from 0, and when.
    pub fn logged(&self, place: usize) -> Option<(u16, Duration)> {
        self.log.get(place).copied().filter(|(number, _)| *number != 0)
    }

    /// Puts an entry of the log back.
    pub fn log_again(&mut self, place: usize, number: u16, at: Duration) {
        if let Some(entry) = self.log.get_mut(place) {
            *entry = (number, at);
        }
    }

    /// Returns true while a fault is there that only a restart clears, or whose cause was put there from outside.
    pub const fn has_lasting(&self) -> bool {
        self.lasting.0[0] != 0
    }

    /// Returns the faults whose cause was put there from outside and lasts.
    pub fn lasting_numbers(&self) -> impl Iterator<Item = u16> {
        self.lasting.iter()
    }

    /// PNU 944.
    pub const fn counter(&self) -> u16 {
        self.buffer.counter()
    }

    /// PNU 947.
    pub fn number(&self, index: u16) -> u16 {
        self.buffer.element(index).map_or(0, |fault| fault.number)
    }

    /// DRV.FAULT1 and following, from 0.
    pub fn active(&self, place: usize) -> u16 {
        self.active.at(place)
    }

    pub fn is_active(&self, number: u16) -> bool {
        self.active.contains(number)
    }

    /// Returns true while a fault is not acknowledged.
    pub fn any(&self) -> bool {
        self.active.at(0) != 0
    }

    /// DRV.WARNING1 and following, from 0.
    pub fn warning(&self, place: usize) -> u16 {
        self.warnings.at(place)
    }

    /// Sets or clears one cause of a warning; returns whether the warning appeared or disappeared.
    fn keep(&mut self, number: u16, keeper: Keeper, active: bool) -> bool {
        if number == 0 {
            return false;
        }
        let came = active && self.warnings.push(number);
        let Some(place) = self.warnings.0.iter().position(|known| *known == number) else {
            return false;
        };
        let Some(bits) = self.keepers.get_mut(place) else {
            return false;
        };
        if active {
            *bits |= keeper as u8;
            return came;
        }
        *bits &= !(keeper as u8);
        if *bits != 0 {
            return false;
        }
        self.warnings.remove(number);
        if let Some(rest) = self.keepers.get_mut(place..) {
            rest.rotate_left(1);
        }
        true
    }
}

/// Limits of the conditions and when they count, out of the parameters once after each change.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Watching {
    /// In the direction "above": negated for a cause that must be below. Not a number where supervision is off.
    limits: [f64; MOST_CONDITIONS],
    /// The lowest of these limits by number of the cause: below all of them nothing is wrong.
    lowest: [f64; Cause::COUNT],
    /// Bit by place in the table: counts while enabled, while disabled.
    enabled: u32,
    disabled: u32,
    /// Must last for its delay.
    delayed: u32,
}

impl Watching {
    /// `value` gives the engineering value of a parameter.
    pub fn new(model: &Model, is_current: bool, value: impl Fn(Part) -> f64) -> Self {
        let mut watching = Self {
            limits: [f64::NAN; MOST_CONDITIONS],
            lowest: [f64::INFINITY; Cause::COUNT],
            enabled: 0,
            disabled: 0,
            delayed: 0,
        };
        for ((place, condition), limit) in model.conditions.iter().enumerate().zip(&mut watching.limits) {
            let bit = 1_u32 << place;
            *limit = match condition.limit {
                Limit::Parameter(part) => match value(part) {
                    0.0 => f64::NAN,
                    value => value,
                },
                Limit::Fixed(value) => value,
                Limit::Present => 0.5,
            };
            if condition.cause.is_below() {
                *limit = -*limit;
            }
            if let Some(lowest) = watching.lowest.get_mut(condition.cause as usize) {
                *lowest = lowest.min(*limit); // not a number loses
            }
            let (enabled, disabled) = match condition.when {
                When::Always => (true, true),
                When::Enabled => (true, false),
                When::Disabled => (false, true),
                When::NotCurrent => (!is_current, !is_current),
                When::ByMode(part) => (true, value(part) == 0.0),
            };
            watching.enabled |= if enabled { bit } else { 0 };
            watching.disabled |= if disabled { bit } else { 0 };
            if condition.delay.is_some_and(|delay| value(delay.mode) != 0.0) {
                watching.delayed |= bit;
            }
        }
        watching
    }
}

impl Drive {
    /// Returns true while there is a fault that is not acknowledged.
    #[must_use]
    pub fn has_fault(&self) -> bool {
        self.faults.any()
    }

    /// Returns true while there is a warning (ZSW1 bit 7).
    #[must_use]
    pub fn has_warning(&self) -> bool {
        self.faults.warning(0) != 0
    }

    /// Entry of the fault buffer (PNU 947): situation times 8 plus place, 0 where nothing is.
    #[must_use]
    pub fn fault_number(&self, index: u16) -> u16 {
        self.faults.number(index)
    }

    /// Returns the n-th warning, from 0; 0 where there is none.
    #[must_use]
    pub fn warning_number(&self, place: usize) -> u16 {
        self.faults.warning(place)
    }

    /// Puts a fault that is not there already into the buffer and starts its reaction. Its FAULTn.ACTION can make a
    /// warning or nothing of it.
    pub(super) fn raise(&mut self, number: u16) {
        match self.action(number) {
            Some(IGNORE) => return,
            Some(WARN) => return self.keep(number, Keeper::Action, true),
            _ => {}
        }
        if !self.faults.active.push(number) {
            return;
        }
        // More than eight faults in one situation: DRV.FAULT9 and 10 contain them, the buffer does not.
        self.faults.buffer.raise(Fault {
            number,
            ..Fault::default()
        });
        self.faults.log.rotate_right(1);
        if let Some(newest) = self.faults.log.first_mut() {
            *newest = (number, self.last - Instant::ZERO);
        }
        self.count_fault(number);
        let known = self.model.catalogue.fault(number, false);
        if known.is_some_and(|fault| fault.cleared == Cleared::Restart) {
            self.faults.lasting.push(number);
        }
        let reaction = known
            .and_then(|fault| fault.reaction.of_machine())
            .unwrap_or(FaultReaction::Coast);
        self.reaction = Some(
            self.reaction
                .map_or(reaction, |before| stronger(before, reaction)),
        );
        self.emit(Event::Fault { number });
    }

    /// A warning of motion is there, or is gone: motion tasks, homing, software limits.
    pub(super) fn warn(&mut self, number: u16, active: bool) {
        self.keep(number, Keeper::Motion, active);
    }

    pub(super) fn keep(&mut self, number: u16, keeper: Keeper, active: bool) {
        if self.faults.keep(number, keeper, active) {
            self.emit(Event::Warning { number, active });
        }
    }

    /// FAULTn.ACTION of a fault, where there is one.
    fn action(&self, number: u16) -> Option<i64> {
        let mut rows = self.model.catalogue.parts.iter();
        let row = rows.find(|row| row.part == Part::FaultAction && row.values.contains(&number.into()))?;
        Some(self.values.get(row.number()))
    }

    /// Returns true while the cause of a fault that has come is there: it cannot be acknowledged.
    pub(super) fn a_cause_lasts(&self) -> bool {
        let faults = &self.faults;
        faults.lasting.at(0) != 0 || self.lasting_conditions().next().is_some()
    }

    /// Faults that have come and whose condition still has its cause.
    fn lasting_conditions(&self) -> impl Iterator<Item = u16> + '_ {
        let conditions = self.model.conditions.iter().enumerate();
        conditions
            .filter(|(place, condition)| !condition.warning && self.faults.present & (1 << place) != 0)
            .map(|(_, condition)| condition.number)
            .filter(|number| self.faults.active.contains(*number))
    }

    /// The state machine has taken the acknowledge: the situation moves on.
    pub(super) fn acknowledged(&mut self) {
        self.faults.buffer.acknowledge();
        self.faults.active = Numbers::NONE;
        self.end_actions();
        self.emit(Event::Acknowledged);
    }

    /// Takes back the warnings that came in the place of a fault.
    fn end_actions(&mut self) {
        while let Some(number) = self.kept_by_action() {
            self.keep(number, Keeper::Action, false);
        }
    }

    fn kept_by_action(&self) -> Option<u16> {
        let kept = self.faults.warnings.iter().zip(self.faults.keepers);
        kept.filter(|(_, keepers)| keepers & Keeper::Action as u8 != 0)
            .map(|(number, _)| number)
            .next()
    }

    /// DRV.CLRFAULTS: as the acknowledge of the control word, but faults whose cause is gone are cleared even if others
    /// last; those come straight back, as a new situation. Source: AKD Parameter Guide 12/2009.
    pub(super) fn clear_faults(&mut self) {
        self.end_actions();
        if !self.faults.any() || !self.a_cause_lasts() {
            self.clear_requested = true;
            let status = self.decide();
            self.process.status = self.in_profile_bits(status);
            return;
        }
        let mut back = Numbers::<MOST_ACTIVE>::NONE;
        for number in self.faults.active.iter() {
            let lasts = self.faults.lasting.contains(number)
                || self.lasting_conditions().any(|lasting| lasting == number);
            if lasts {
                back.push(number);
            }
        }
        if back == self.faults.active {
            return;
        }
        self.acknowledged();
        for number in back.iter() {
            self.raise(number);
        }
    }

    /// Looks at all conditions of the model with the values of now. Allocates nothing.
    pub(super) fn supervise(&mut self) {
        let values = self.watched();
        let watching = &self.settings.watching;
        let beyond = values.iter().zip(&watching.lowest);
        let quiet = beyond.fold(true, |quiet, (value, lowest)| quiet & (value <= lowest));
        if quiet && self.faults.present | self.faults.counting == 0 {
            return;
        }
        let now = self.last;
        let mut present = 0_u32;
        let conditions = self.model.conditions.iter().zip(&watching.limits);
        for (place, (condition, limit)) in conditions.enumerate() {
            let value = values.get(condition.cause as usize).copied().unwrap_or(0.0);
            present |= u32::from(value > *limit) << place;
        }
        let delayed = present & watching.delayed;
        let situation = if self.is_enabled() {
            watching.enabled
        } else {
            watching.disabled
        };
        let mut counting = present & situation;
        if watching.delayed != 0 {
            counting &= !self.waiting(delayed & counting, now);
        }
        self.faults.present = present;
        let changed = counting ^ self.faults.counting;
        self.faults.counting = counting;
        if changed == 0 && counting == 0 {
            return;
        }
        let model = self.model;
        for (place, condition) in model.conditions.iter().enumerate() {
            let holds = counting & (1 << place) != 0;
            if condition.warning {
                if changed & (1 << place) != 0 {
                    self.keep(condition.number, Keeper::Condition, holds);
                }
            } else if holds && !self.faults.is_active(condition.number) {
                self.raise(condition.number);
            }
        }
    }

    /// Of the delayed conditions that have their cause, those that do not have it for long enough yet.
    fn waiting(&mut self, delayed: u32, now: Instant) -> u32 {
        let mut waiting = 0;
        let conditions = self.model.conditions.iter().enumerate();
        for ((place, condition), since) in conditions.zip(&mut self.faults.since) {
            let bit = 1 << place;
            if delayed & bit == 0 {
                *since = None;
                continue;
            }
            let begin = *since.get_or_insert(now);
            let needed = condition.delay.map_or(0, |delay| u128::from(delay.milliseconds));
            if (now - begin).as_millis() < needed {
                waiting |= bit;
            }
        }
        waiting
    }

    /// A number is wrong from outside: as if the drive had found it.
    pub(super) fn raise_external(&mut self, number: u16, lasting: bool) {
        if lasting {
            self.faults.lasting.push(number);
        }
        self.raise(number);
    }

    /// A warning from outside is there, or is gone.
    pub(super) fn warn_external(&mut self, number: u16, active: bool) {
        self.keep(number, Keeper::ExternalInputs, active);
    }

    /// The cause of a lasting fault from outside is gone, and a warning from outside with the same number too.
    pub(super) fn end_cause(&mut self, number: u16) {
        self.faults.lasting.remove(number);
        self.keep(number, Keeper::ExternalInputs, false);
        self.keep(number, Keeper::Action, false);
    }

    /// Returns the values that conditions look at, by number of the cause; negated where the cause must be below its
    /// limit.
    fn watched(&self) -> [f64; Cause::COUNT] {
        let mut values = [0.0; Cause::COUNT];
        let mut put = |cause: Cause, value: f64| {
            if let Some(place) = values.get_mut(cause as usize) {
                *place = value;
            }
        };
        let axis = &self.axis;
        let (inputs, electrical) = (axis.inputs(), axis.electrical());
        let yes = |holds: bool| f64::from(u8::from(holds));
        let following = self.settings.position.units.value(axis.following_error());
        put(Cause::FollowingError, following.abs());
        put(Cause::Overspeed, axis.speed().abs());
        put(Cause::BusHigh, electrical.bus_voltage());
        put(Cause::BusLow, -electrical.bus_voltage());
        put(Cause::DriveFoldback, -electrical.drive_foldback_limit());
        put(Cause::MotorFoldback, -electrical.motor_foldback_limit());
        put(Cause::MotorSensor, motor_sensor(electrical.motor_temperature()));
        put(Cause::PowerStage, electrical.power_stage_temperature());
        put(Cause::SafeTorqueOff, yes(inputs.sto));
        put(Cause::FeedbackLost, yes(inputs.feedback_lost));
        put(Cause::PositiveSwitch, yes(inputs.limit_positive));
        put(Cause::NegativeSwitch, yes(inputs.limit_negative));
        put(Cause::BrakeClosed, yes(inputs.brake));
        put(Cause::SlowDisable, self.disabling_for());
        if let Some(inverter) = &self.settings.inverter {
            let output = axis.motor_output();
            let load = 100.0 * output.thermal_load;
            let counts = inverter.thermal_warning || inverter.thermal_trip;
            put(Cause::MotorLoad, if counts { load } else { 0.0 });
            put(
                Cause::MotorLoadTrip,
                if inverter.thermal_trip { load } else { 0.0 },
            );
            put(Cause::InverterLoad, 100.0 * electrical.drive_load());
            put(Cause::CurrentLimit, yes(output.limited));
            put(Cause::MainsLost, yes(!electrical.has_mains()));
            put(Cause::MotorHot, electrical.motor_temperature());
        }
        values
    }
}

impl Drive {
    /// Returns the duration of a disable on the ramp so far, ms.
    fn disabling_for(&self) -> f64 {
        if self.disable_requested {
            (self.last - self.disable_since).as_secs_f64() * 1000.0
        } else {
            0.0
        }
    }
}

impl Drive {
    /// 32 bits of the alarm or warning word from a bit on: what is active has its bit in the table.
    pub(super) fn alarm_word(&self, warning: bool, first: u8) -> i64 {
        let catalogue = self.model.catalogue;
        let bits = |number: u16| {
            let bit = catalogue.fault(number, warning)?.bit?.checked_sub(first)?;
            (bit < 32).then_some(1_i64 << bit)
        };
        let word = |word: i64, number: u16| word | bits(number).unwrap_or(0);
        if warning {
            self.faults.warnings.iter().fold(0, word)
        } else {
            self.faults.active.iter().fold(0, word)
        }
    }
}

/// Resistance of the temperature sensor in the motor, ohm, at a temperature in degC: a KTY 84-130, 1000 ohm at 100 degC,
/// within its range of -40 to 300 degC.
pub(super) fn motor_sensor(temperature: f64) -> f64 {
    let above = temperature.clamp(-40.0, 300.0) - 100.0;
    1000.0 * (1.0 + 6.12e-3 * above + 1.1e-5 * above * above)
}

/// Returns the reaction that takes the power away sooner.
const fn stronger(one: FaultReaction, other: FaultReaction) -> FaultReaction {
    match (one, other) {
        (FaultReaction::Coast, _) | (_, FaultReaction::Coast) => FaultReaction::Coast,
        (FaultReaction::QuickStop, _) | (_, FaultReaction::QuickStop) => FaultReaction::QuickStop,
        _ => FaultReaction::RampStop,
    }
}

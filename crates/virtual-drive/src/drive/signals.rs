//! Process data: the signals of the telegram in use, between the bytes of a frame and the drive.
//!
//! Source: AKD manual 5.8 (signals; each is a parameter of the same number too), 5.11 (telegrams).

use std::time::Duration;

use profile::state::{Orders, Stw1};
use profile::telegram::{Field, Mapping, Telegram, signal};
use profile::unit::akd;

use super::words::{ChosenWord, MOST_WORDS};
use super::{Disconnect, Drive, Event, Link};
use crate::model::{Live, Model};

/// Number of the telegram in use until a controller or PNU 922 chooses another.
pub(super) const FIRST_TELEGRAM: u16 = 1;

/// Signal numbers that have a place: those of the profile up to 99 and those of the vendor behind them.
const SIGNALS: usize = 128;

/// One step of a sign of life: bits 12 to 15 of STW2 and ZSW2.
const LIFE: i64 = 0x1000;

/// Setpoints that move the axis as long as they stand there, without an edge in STW1: while there is a controller only
/// its own telegram may give them, and they start with 0 in each connection.
const MOVING: [u16; 2] = [signal::NSOLL_A, signal::kollmorgen::IL_CMD_FIELDBUS];

/// Value of a setpoint signal that was never received: no motion task is slowed down, everything else is 0.
const fn ungiven(number: u16) -> i64 {
    if number == signal::kollmorgen::MT_FEEDRATE {
        100
    } else {
        0
    }
}

/// Fields of one direction at most.
pub(super) const MOST_FIELDS: usize = 32;

/// The present process values.
#[derive(Debug, Clone)]
pub(super) struct Process {
    telegram: u16,
    setpoint: Mapping,
    actual: Mapping,
    /// The fields of both with the places of their parameters in the catalogue.
    takes: Vec<(Field, Option<usize>)>,
    gives: Vec<(Field, Option<usize>)>,
    /// Value of each setpoint signal as it came last.
    values: [i64; SIGNALS],
    /// One bit for each setpoint signal that is ignored now.
    ignored: u128,
    /// Status word 2 as sent last.
    status2: i64,
    /// Control word as received last.
    pub control: Stw1,
    /// Status word as sent last.
    pub status: u16,
    /// What the control word requests.
    pub orders: Orders,
    /// The telegram in use is one of the vendor's own.
    own: Option<&'static Telegram>,
    /// Words that carry a parameter which is chosen by settings: first octet and word.
    pub words_in: Vec<ChosenWord>,
    pub words_out: Vec<ChosenWord>,
    /// Speed setpoint, rpm.
    pub speed: f64,
    /// Current setpoint, A.
    pub current: f64,
}

impl Process {
    /// Returns the first telegram, nothing received: switching on inhibited, control requested.
    pub fn new(model: &Model) -> Self {
        let mut process = Self {
            telegram: 0,
            setpoint: Mapping::EMPTY,
            actual: Mapping::EMPTY,
            takes: Vec::with_capacity(MOST_FIELDS),
            gives: Vec::with_capacity(MOST_FIELDS),
            values: [0; SIGNALS],
            ignored: 0,
            status2: 0,
            control: Stw1::default(),
            status: 0x0240,
            orders: Orders::default(),
            own: None,
            words_in: Vec::with_capacity(MOST_WORDS),
            words_out: Vec::with_capacity(MOST_WORDS),
            speed: 0.0,
            current: 0.0,
        };
        for (number, value) in (0..).zip(&mut process.values) {
            *value = ungiven(number);
        }
        if let Some(telegram) = Telegram::find(FIRST_TELEGRAM, model.catalogue.device.vendor_id) {
            process.use_telegram(
                model,
                telegram.number,
                Mapping::of(&telegram.setpoint),
                Mapping::of(&telegram.actual),
            );
        }
        process
    }

    /// Activates a telegram. Its setpoints start with their defaults, and so do those of the previous telegram that
    /// move the axis or scale the feedrate; the others keep the values of their parameters.
    pub fn use_telegram(&mut self, model: &Model, number: u16, setpoint: Mapping, actual: Mapping) {
        let places = |mapping: &Mapping, into: &mut Vec<(Field, Option<usize>)>| {
            into.clear();
            into.extend(
                mapping
                    .fields()
                    .iter()
                    .map(|field| (*field, model.position_of_signal(field.signal.number))),
            );
        };
        let carried = self.setpoint.has(signal::kollmorgen::MT_FEEDRATE);
        places(&setpoint, &mut self.takes);
        places(&actual, &mut self.gives);
        self.telegram = number;
        self.setpoint = setpoint;
        self.actual = actual;
        self.own = Telegram::find(number, model.catalogue.device.vendor_id)
            .filter(|telegram| telegram.vendor.is_some());
        self.control = Stw1::default();
        self.orders = Orders::default();
        self.ignored = 0;
        self.status2 = 0;
        self.speed = 0.0;
        self.current = 0.0;
        for (number, value) in (0..).zip(&mut self.values) {
            let stale = carried && number == signal::kollmorgen::MT_FEEDRATE;
            if setpoint.has(number) || MOVING.contains(&number) || stale {
                *value = ungiven(number);
            }
        }
    }

    /// Value of a setpoint signal as it came last from the controller, or as it was written into the parameter of its
    /// number; 0 before that. STW1 is the word that was received, not the one in force.
    pub fn signal(&self, number: u16) -> i64 {
        self.values.get(usize::from(number)).copied().unwrap_or(0)
    }

    /// Sets the value of a setpoint signal.
    pub fn set_signal(&mut self, number: u16, value: i64) {
        if let Some(place) = self.values.get_mut(usize::from(number)) {
            *place = value;
        }
    }

    /// Notes whether a setpoint signal is ignored; true when it is and was not before.
    const fn note_ignored(&mut self, number: u16, ignored: bool) -> bool {
        let Some(bit) = 1_u128.checked_shl(number as u32) else {
            return false;
        };
        let before = self.ignored & bit != 0;
        if ignored {
            self.ignored |= bit;
        } else {
            self.ignored &= !bit;
        }
        ignored && !before
    }

    /// Returns whether the control and status word of the telegram in use have the vendor's bits.
    pub fn has_own_words(&self) -> bool {
        self.own.is_some_and(|telegram| telegram.own_words)
    }

    /// Returns the telegram in use if it is one of the vendor's own.
    pub const fn own_telegram(&self) -> Option<&'static Telegram> {
        self.own
    }

    /// Returns the number of the telegram in use, PNU 922.
    pub const fn telegram(&self) -> u16 {
        self.telegram
    }

    /// Returns the setpoints of the telegram in use.
    pub const fn setpoints(&self) -> &Mapping {
        &self.setpoint
    }

    /// Returns the actual values of the telegram in use.
    pub const fn actuals(&self) -> &Mapping {
        &self.actual
    }

    /// The drive's sign of life: it counts from 1 to 15 while the controller's is not 0.
    /// Source: profile, STW2 and ZSW2 bits 12 to 15; that it needs no clock synchronism is our reading.
    fn live_on(&mut self) {
        let controller = self.signal(signal::STW2) & !(LIFE - 1);
        self.status2 = match self.status2 {
            _ if controller == 0 => 0,
            last if last >= 15 * LIFE => LIFE,
            last => last + LIFE,
        };
    }
}

impl Drive {
    /// There is a control word that counts.
    pub(super) const fn is_running(&self) -> bool {
        match self.controller_loss {
            Some(controller_loss) => controller_loss.holds(),
            None => matches!(self.link, Link::Cyclic { running: true, .. }),
        }
    }

    /// Returns true while only the controller may set this setpoint.
    pub(super) fn is_commanded(&self, number: u16) -> bool {
        self.link.is_cyclic() && (self.process.setpoints().has(number) || MOVING.contains(&number))
    }

    /// Takes the outputs of the controller over. Setpoints beside a control word without control by PLC are ignored.
    pub(super) fn take_outputs(&mut self, outputs: Option<&[u8]>) {
        let Link::Cyclic {
            running, exchanging, ..
        } = &mut self.link
        else {
            return;
        };
        let Some(outputs) = outputs else {
            let stopped = core::mem::replace(running, false);
            let supervised = self.settings.fault_on_stop || self.control_timeout().is_some();
            if stopped && supervised {
                self.raise_lost(Disconnect::Silent, Duration::ZERO);
            }
            return;
        };
        *running = true;
        *exchanging = true;
        self.controller_is_back();
        if let Some(control) = self.process.setpoint.get(outputs, signal::STW1) {
            self.process.control = Stw1(control as u16);
            self.process.set_signal(signal::STW1, control);
            self.process.orders = self.profile().orders(control as u16, self.state());
        }
        if !self.process.orders.stw1.has(Stw1::CONTROL_BY_PLC) {
            return;
        }
        // From the last to the first: of a signal that is mapped twice the first place counts.
        for index in (0..self.process.takes.len()).rev() {
            if let Some((field, position)) = self.process.takes.get(index).copied()
                && let Some(value) = field.get(outputs)
                && field.signal.number != signal::STW1
            {
                self.take_setpoint(field.signal.number, position, value);
            }
        }
        self.take_words(outputs);
        self.process.live_on();
    }

    /// A setpoint signal has a value now, out of a frame or written as parameter. Where it stands for another parameter
    /// (DRV_ACC for DRV.ACC) the limits of that one hold; what is outside of them changes nothing there and is reported.
    pub(super) fn take_setpoint(&mut self, number: u16, position: Option<usize>, value: i64) {
        self.process.set_signal(number, value);
        match number {
            signal::NSOLL_A => self.process.speed = self.speed_of(value),
            signal::kollmorgen::IL_CMD_FIELDBUS => {
                self.process.current = akd::current(&self.settings.scaling).engineering(value);
            }
            _ => {
                let Some(position) = position else { return };
                let Some(Live::Through(other)) = self.live.get(position).copied() else {
                    return;
                };
                let Some(parameter) = self.model.catalogue.parameters.get(position) else {
                    return;
                };
                let written = self
                    .differs(parameter, other, value)
                    .then(|| self.write_same(parameter, other, value));
                if written == Some(Ok(())) {
                    self.apply();
                }
                if self.process.note_ignored(number, matches!(written, Some(Err(_)))) {
                    let pnu = parameter.pnu;
                    self.emit(Event::Ignored { pnu, raw: value });
                }
            }
        }
    }

    /// Writes the actual values.
    pub(super) fn give_inputs(&self, inputs: &mut [u8]) {
        for (field, position) in &self.process.gives {
            let value = match (field.signal.number, position) {
                (signal::ZSW2, _) => self.process.status2,
                (signal::ZSW1, _) => self.process.status.into(),
                (signal::NIST_A, _) if self.settings.inverter.is_some() => self.speed_number(),
                (_, Some(position)) => self.element(*position, 0).unwrap_or(0),
                _ => 0,
            };
            // Inputs that are too short for the telegram get what fits.
            let _ = field.set(inputs, value);
        }
        self.give_words(inputs);
    }
}

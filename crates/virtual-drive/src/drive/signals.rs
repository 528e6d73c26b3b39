//! Process data: the signals of the telegram in use, between the bytes of a frame and the drive.

use profidrive::state::Stw1;
use profidrive::telegram::{Direction, Signal, Telegram, signal};
use profidrive::unit::akd;

use super::{Drive, Link};
use crate::model::{Live, Model};

/// Number of the telegram in use until a controller or PNU 922 chooses another.
const FIRST_TELEGRAM: u16 = 1;

/// The present process values.
#[derive(Debug, Clone, Copy)]
pub(super) struct Process {
    telegram: Option<&'static Telegram>,
    /// Control word as received last.
    pub control: Stw1,
    /// Status word as sent last.
    pub status: u16,
    /// Speed setpoint, rpm.
    pub speed: f64,
}

impl Process {
    pub fn new(model: &Model) -> Self {
        let telegram = Telegram::find(FIRST_TELEGRAM, model.catalogue.device.vendor_id);
        // Switching on inhibited, control requested.
        Self {
            telegram,
            control: Stw1::default(),
            status: 0x0240,
            speed: 0.0,
        }
    }
}

impl Drive {
    /// True for a signal that the controller sends.
    pub(super) fn is_setpoint(&self, number: u16) -> bool {
        Signal::find(number, self.model.catalogue.device.vendor_id)
            .is_some_and(|signal| signal.direction == Direction::Setpoint)
    }

    pub(super) fn telegram_number(&self) -> u16 {
        self.process.telegram.map_or(0, |telegram| telegram.number)
    }

    /// Puts a telegram of the model into use; false when it has no such telegram.
    pub(super) fn choose_telegram(&mut self, number: u16) -> bool {
        let device = &self.model.catalogue.device;
        let found = Telegram::find(number, device.vendor_id).filter(|_| device.telegram(number).is_some());
        if found.is_some() {
            self.process = Process {
                telegram: found,
                status: self.process.status,
                ..Process::new(self.model)
            };
        }
        found.is_some()
    }

    pub(super) fn setpoint_signal(&self, word: usize) -> u16 {
        self.process
            .telegram
            .and_then(|telegram| telegram.setpoint.words().nth(word))
            .unwrap_or(0)
    }

    pub(super) fn actual_signal(&self, word: usize) -> u16 {
        self.process
            .telegram
            .and_then(|telegram| telegram.actual.words().nth(word))
            .unwrap_or(0)
    }

    pub(super) const fn is_running(&self) -> bool {
        matches!(self.link, Link::Cyclic { running: true, .. })
    }

    /// Takes the outputs of the controller over. Setpoints beside a control word without control by PLC are ignored.
    pub(super) fn take_outputs(&mut self, outputs: Option<&[u8]>) {
        let Link::Cyclic { running, .. } = &mut self.link else {
            return;
        };
        let Some(outputs) = outputs else {
            let stopped = core::mem::replace(running, false);
            if stopped && self.settings.fault_on_stop {
                self.raise(self.model.connection_lost_fault);
            }
            return;
        };
        *running = true;
        let Some(telegram) = self.process.telegram else {
            return;
        };
        if let Some(control) = telegram.setpoint.get(outputs, signal::STW1) {
            self.process.control = Stw1(control as u16);
        }
        if !self.process.control.has(Stw1::CONTROL_BY_PLC) {
            return;
        }
        for field in telegram.setpoint.fields {
            if let Some(value) = field.get(outputs) {
                self.take_setpoint(field.signal.number, value);
            }
        }
    }

    fn take_setpoint(&mut self, number: u16, value: i64) {
        match number {
            signal::STW1 => {}
            signal::NSOLL_A => self.process.speed = akd::velocity(&self.settings.scaling).engineering(value),
            // The number of a signal is the number of its parameter too; where that stands for another one (DRV_ACC for
            // DRV.ACC), the limits of that one hold, and what is outside of them changes nothing.
            number => {
                let Some(position) = self.model.catalogue.position(number) else {
                    return;
                };
                if !matches!(self.live.get(position), Some(Live::Same(_))) {
                    self.values.set_at(position, value);
                } else if self.element(position, 0) != Ok(value) {
                    let _ = self.set_element(position, 0, value);
                }
            }
        }
    }

    /// Writes the actual values.
    pub(super) fn give_inputs(&self, inputs: &mut [u8]) {
        let Some(telegram) = self.process.telegram else {
            return;
        };
        for field in telegram.actual.fields {
            let position = self.model.catalogue.position(field.signal.number);
            let value = position
                .and_then(|position| self.element(position, 0).ok())
                .unwrap_or(0);
            // Inputs that are too short for the telegram get what fits.
            let _ = field.set(inputs, value);
        }
    }
}

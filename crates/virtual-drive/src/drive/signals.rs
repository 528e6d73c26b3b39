//! Process data: the words of the telegram in use, between the bytes of a frame and the drive.

use profidrive::catalogue::Scale;

use super::{Drive, Link};

/// STW1 bit 10, control by PLC.
pub(super) const STW1_BY_PLC: u16 = 1 << 10;

/// Signal numbers, which on this model are PNUs too.
mod number {
    pub const STW1: u16 = 1;
    pub const NSOLL_A: u16 = 5;
    pub const DRV_ACC: u16 = 108;
    pub const DRV_DEC: u16 = 109;
}

/// Signals that a controller sends.
const SETPOINTS: &[u16] = &[1, 3, 5, 32, 34, 35, 36, 37, 38, 100, 101, 102, 103, 108, 109];

/// True for the PNU of a signal that the controller sends.
pub(super) fn is_setpoint(pnu: u16) -> bool {
    SETPOINTS.contains(&pnu)
}

/// Words of a telegram: the signal of each word, twice for a double word, 0 for a free one.
struct Words {
    telegram: u16,
    setpoints: &'static [u16],
    actuals: &'static [u16],
}

const WORDS: &[Words] = &[
    Words {
        telegram: 1,
        setpoints: &[1, 5],
        actuals: &[2, 6],
    },
    Words {
        telegram: 7,
        setpoints: &[1, 32],
        actuals: &[2, 33],
    },
    Words {
        telegram: 9,
        setpoints: &[1, 32, 3, 34, 34, 35, 35, 36, 37, 38],
        actuals: &[2, 33, 4, 28, 28],
    },
    Words {
        telegram: 350,
        setpoints: &[1, 5],
        actuals: &[2, 6, 52],
    },
    Words {
        telegram: 351,
        setpoints: &[1, 5],
        actuals: &[2, 6, 52, 28, 28],
    },
    Words {
        telegram: 352,
        setpoints: &[1, 32, 3, 34, 34, 35, 35, 36, 37, 38, 100, 100],
        actuals: &[2, 33, 4, 28, 28],
    },
    Words {
        telegram: 353,
        setpoints: &[1, 32, 3, 34, 34, 35, 35, 36, 37, 38, 100, 100, 103],
        actuals: &[2, 33, 4, 28, 28],
    },
    Words {
        telegram: 354,
        setpoints: &[1, 5, 108, 109],
        actuals: &[2, 6],
    },
    Words {
        telegram: 400,
        setpoints: &[1, 32, 3, 34, 34, 35, 35, 36, 37, 38, 0, 0],
        actuals: &[2, 33, 4, 28, 28, 0, 0, 0, 0, 0, 0, 0],
    },
    Words {
        telegram: 0,
        setpoints: &[1, 32, 3, 34, 34, 35, 35, 36, 37, 38, 0, 0],
        actuals: &[2, 33, 4, 28, 28, 0, 0, 0, 0, 0, 0, 0],
    },
];

/// The present process values.
#[derive(Debug, Clone, Copy)]
pub(super) struct Process {
    /// Place of the telegram in the table.
    telegram: usize,
    /// Control word as received last.
    pub control: u16,
    /// Status word as sent last.
    pub status: u16,
    /// Speed setpoint, rpm.
    pub speed: f64,
}

impl Default for Process {
    fn default() -> Self {
        Self {
            telegram: 0,
            control: 0,
            status: 0x0240,
            speed: 0.0,
        }
    }
}

impl Drive {
    fn words(&self) -> &'static Words {
        WORDS.get(self.process.telegram).unwrap_or(&WORDS[0])
    }

    pub(super) fn telegram_number(&self) -> u16 {
        self.words().telegram
    }

    pub(super) fn choose_telegram(&mut self, number: u16) -> Result<(), ()> {
        let offered = self.model.catalogue.device.telegram(number).is_some();
        let place = WORDS
            .iter()
            .position(|words| words.telegram == number)
            .filter(|_| offered)
            .ok_or(())?;
        self.process = Process {
            telegram: place,
            status: self.process.status,
            ..Process::default()
        };
        Ok(())
    }

    pub(super) fn setpoint_signal(&self, word: usize) -> u16 {
        self.words().setpoints.get(word).copied().unwrap_or(0)
    }

    pub(super) fn actual_signal(&self, word: usize) -> u16 {
        self.words().actuals.get(word).copied().unwrap_or(0)
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
        let word = |place: usize| {
            let octets = outputs.get(2 * place..2 * place + 2);
            octets
                .and_then(|octets| octets.try_into().ok())
                .map_or(0, u16::from_be_bytes)
        };
        let setpoints = self.words().setpoints;
        let mut place = 0;
        while let Some(signal) = setpoints.get(place) {
            let double = setpoints.get(place + 1) == Some(signal) && *signal != 0;
            let raw = if double {
                u32::from(word(place)) << 16 | u32::from(word(place + 1))
            } else {
                word(place).into()
            };
            place += if double { 2 } else { 1 };
            if *signal == number::STW1 {
                self.process.control = word(0);
                if self.process.control & STW1_BY_PLC == 0 {
                    return;
                }
            } else {
                self.take_setpoint(*signal, raw);
            }
        }
    }

    fn take_setpoint(&mut self, signal: u16, raw: u32) {
        match signal {
            number::NSOLL_A => {
                self.process.speed = f64::from(raw as i16) * self.settings.scaling.step(Scale::Velocity);
            }
            number::DRV_ACC | number::DRV_DEC => {
                // 0 is no ramp at all; the drive keeps what it has.
                if raw != 0
                    && let Some(position) = self.model.catalogue.position(signal)
                    && self.element(position, 0) != Ok(i64::from(raw))
                {
                    let _ = self.set_element(position, 0, i64::from(raw));
                }
            }
            0 => {}
            signal => {
                if let Some(parameter) = self.model.catalogue.by_pnu(signal) {
                    let value = if parameter.signed && parameter.size.octets() == 4 {
                        i64::from(raw as i32)
                    } else {
                        raw.into()
                    };
                    self.values.set(signal, value);
                }
            }
        }
    }

    /// Writes the actual values.
    pub(super) fn give_inputs(&self, inputs: &mut [u8]) {
        let mut before = 0;
        for (word, signal) in inputs.chunks_exact_mut(2).zip(self.words().actuals) {
            let position = self.model.catalogue.position(*signal).filter(|_| *signal != 0);
            let raw = position
                .and_then(|position| self.element(position, 0).ok())
                .unwrap_or(0);
            let double = position
                .and_then(|position| self.model.catalogue.parameters.get(position))
                .is_some_and(|parameter| parameter.size.octets() == 4);
            // The first word of a double word is the high one.
            let high = double && before != *signal;
            before = if high { *signal } else { 0 };
            let value = if high { raw >> 16 } else { raw };
            word.copy_from_slice(&(value as u16).to_be_bytes());
        }
    }
}

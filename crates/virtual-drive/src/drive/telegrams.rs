//! Which telegram is in use (PNU 922), and the mapping of the free ones (PNU 915 and 916).
//!
//! Source: AKD manual 5.8, 5.11.1 and 5.11.10; profile reference on the configuration of telegrams. Whether 922 is kept over
//! power-off is defined by the table of parameters: an AKD saves neither it nor the mappings, a VLT saves it (9-22).

use profile::catalogue::Part;
use profile::parameter::ErrorNumber;
use profile::telegram::{Direction, FreeMapping, Mapping, Signal, Telegram, signal};

use super::Drive;
use super::signals::FIRST_TELEGRAM;
use crate::model::{Live, Model};
use crate::store::is_saved;

/// Values of DRV.CMDSOURCE: telegrams with a speed or current setpoint need the field bus, those of positioning the
/// service channel. Source: Kollmorgen developer network, command source for PROFINET.
const FIELD_BUS: i64 = 1;
const SERVICE: i64 = 0;

/// A free telegram with what is mapped into it.
#[derive(Debug, Clone, Copy)]
pub(super) struct FreeTelegram {
    number: u16,
    setpoint: FreeMapping,
    actual: FreeMapping,
    /// Has a mapping of its own; else it takes over that of the telegram that was in use before.
    own: bool,
}

impl FreeTelegram {
    /// Returns the free telegrams of a model as delivered; each is as long as its module.
    pub fn of(model: &Model) -> Vec<Self> {
        let device = &model.catalogue.device;
        let free = device.telegrams.iter().filter_map(|module| {
            let telegram =
                Telegram::find(module.telegram, device.vendor_id).filter(|telegram| telegram.free)?;
            let half = |words: &mut dyn Iterator<Item = u16>, octets: u16, direction| {
                let words: Vec<u16> = words.collect();
                FreeMapping::new(&words, usize::from(octets / 2), device.vendor_id, direction).ok()
            };
            Some(Self {
                number: telegram.number,
                setpoint: half(
                    &mut telegram.setpoint.words(),
                    module.outputs,
                    Direction::Setpoint,
                )?,
                actual: half(&mut telegram.actual.words(), module.inputs, Direction::Actual)?,
                own: telegram.setpoint.octets > 0,
            })
        });
        free.collect()
    }

    /// Gives it the length of a module, in octets. Signals that do not fit any more are taken out.
    fn resize(&mut self, vendor: u16, outputs: u16, inputs: u16) {
        for (octets, direction) in [(outputs, Direction::Setpoint), (inputs, Direction::Actual)] {
            let half = self.half(direction);
            let used = half.words().iter().rposition(|number| *number != 0);
            let words = half
                .words()
                .get(..used.map_or(0, |last| last + 1))
                .unwrap_or_default();
            if let Ok(sized) = FreeMapping::new(words, usize::from(octets / 2), vendor, direction) {
                *half = sized;
            }
        }
    }

    fn half(&mut self, direction: Direction) -> &mut FreeMapping {
        match direction {
            Direction::Actual => &mut self.actual,
            _ => &mut self.setpoint,
        }
    }

    /// Takes a mapping over as far as it fits.
    fn follow(&mut self, vendor: u16, setpoint: &Mapping, actual: &Mapping) {
        for (mapping, direction) in [(setpoint, Direction::Setpoint), (actual, Direction::Actual)] {
            let words: Vec<u16> = mapping.words().collect();
            let length = self.half(direction).words().len();
            if let Ok(taken) = FreeMapping::new(&words, length, vendor, direction) {
                *self.half(direction) = taken;
            }
        }
    }
}

impl Drive {
    /// Puts a telegram of the model into use; false when it has no such telegram.
    pub(super) fn choose_telegram(&mut self, number: u16) -> bool {
        let device = &self.model.catalogue.device;
        let Some(telegram) =
            Telegram::find(number, device.vendor_id).filter(|_| device.telegram(number).is_some())
        else {
            return false;
        };
        let (setpoints, actuals) = (*self.process.setpoints(), *self.process.actuals());
        let free = self.free.iter_mut().find(|free| free.number == number);
        let mapped = free.and_then(|free| {
            if !free.own {
                free.follow(device.vendor_id, &setpoints, &actuals);
            }
            Some((free.setpoint.mapping().ok()?, free.actual.mapping().ok()?))
        });
        let (setpoint, actual) =
            mapped.unwrap_or_else(|| (Mapping::of(&telegram.setpoint), Mapping::of(&telegram.actual)));
        self.process.use_telegram(self.model, number, setpoint, actual);
        self.choose_words();
        self.follow_command_source(&setpoint);
        true
    }

    /// Sets the length of the module of a telegram in octets: the length of a free telegram. Has no effect on other
    /// telegrams, whose length is fixed. Without this call the length comes from the tables of the model.
    ///
    /// ```
    /// use std::time::Duration;
    /// use profidrive_virtual_drive::{drive::Drive, model};
    /// let mut drive = Drive::new(&model::AKD);
    /// drive.plug(0, 4, 32); // telegram 0 in a module of 2 and 16 words
    /// drive.connect(0, Duration::from_millis(48)).unwrap();
    /// ```
    pub fn plug(&mut self, telegram: u16, outputs: u16, inputs: u16) {
        let vendor = self.model.catalogue.device.vendor_id;
        let Some(free) = self.free.iter_mut().find(|free| free.number == telegram) else {
            return;
        };
        free.resize(vendor, outputs, inputs);
        if self.process.telegram() == telegram && !self.link.is_cyclic() {
            self.choose_telegram(telegram);
        }
    }

    /// Gives the free telegrams the lengths that these have: the modules stay where they are in a restart.
    pub(super) fn take_lengths(&mut self, plugged: &[FreeTelegram]) {
        for free in plugged {
            let octets = |half: &FreeMapping| u16::try_from(2 * half.words().len()).unwrap_or(u16::MAX);
            self.plug(free.number, octets(&free.setpoint), octets(&free.actual));
        }
    }

    /// It is at a serial line: PNU 922 does not choose its process data any more.
    pub(crate) fn set_aside_telegram(&mut self) {
        self.aside = Some(self.process.telegram());
    }

    /// Returns the value of PNU 922.
    pub(super) fn telegram_setting(&self) -> u16 {
        self.aside.unwrap_or_else(|| self.process.telegram())
    }

    /// Changes PNU 922, which chooses the process data of the network.
    ///
    /// # Errors
    /// 0x11 while they are exchanged, 0x14 for a telegram that the drive does not have.
    pub(super) fn set_telegram(&mut self, number: u16) -> Result<(), ErrorNumber> {
        if self.aside.is_some() {
            let device = &self.model.catalogue.device;
            device.telegram(number).ok_or(ErrorNumber::VALUE)?;
            self.aside = Some(number);
            return Ok(());
        }
        if self.link.is_cyclic() {
            return Err(ErrorNumber::NOT_NOW);
        }
        if self.choose_telegram(number) {
            Ok(())
        } else {
            Err(ErrorNumber::VALUE)
        }
    }

    /// As delivered; not while a controller uses the present one.
    pub(super) fn reset_telegrams(&mut self) {
        if self.aside.is_some() {
            self.aside = Some(FIRST_TELEGRAM);
        } else if !self.link.is_cyclic() {
            self.free = FreeTelegram::of(self.model);
            self.choose_telegram(FIRST_TELEGRAM);
        }
    }

    /// After power on: restores the saved telegram, where the table marks it as saved.
    pub(super) fn restore_telegram(&mut self) {
        let Some(position) = self.live.iter().position(|live| *live == Live::Telegram) else {
            return;
        };
        let parameter = self.model.catalogue.parameters.get(position);
        if !parameter.is_some_and(is_saved) || self.link.is_cyclic() {
            return;
        }
        let kept = u16::try_from(self.values.at(position)).unwrap_or_default();
        if kept == self.telegram_setting() || self.set_telegram(kept).is_ok() {
            return;
        }
        self.values.set_at(position, self.telegram_setting().into());
    }

    /// The telegram sets DRV.CMDSOURCE.
    fn follow_command_source(&mut self, setpoints: &Mapping) {
        let speed = [signal::NSOLL_A, signal::kollmorgen::IL_CMD_FIELDBUS];
        let source = if speed.iter().any(|number| setpoints.has(*number)) {
            FIELD_BUS
        } else if setpoints.has(signal::SATZANW) {
            SERVICE
        } else {
            return;
        };
        if let Some(pnu) = self.model.number(Part::CommandSource)
            && self.values.get(pnu) != source
        {
            self.values.set(pnu, source);
            self.apply();
        }
    }

    /// Writes one word of PNU 915 or 916.
    ///
    /// # Errors
    /// 0x11 while a controller exchanges the telegram and while the telegram in use has a fixed mapping; 0x14 for a
    /// signal that the drive does not have or that goes the other way, for anything but STW1 or ZSW1 in the first word
    /// and for these in another word, for a part of a signal of two words, and behind the end of the telegram.
    pub(super) fn map_signal(
        &mut self,
        direction: Direction,
        word: u16,
        number: u16,
    ) -> Result<(), ErrorNumber> {
        if self.link.is_cyclic() {
            return Err(ErrorNumber::NOT_NOW);
        }
        let known = number == 0 || self.has_signal(number);
        let telegram = self.process.telegram();
        let free = self.free.iter_mut().find(|free| free.number == telegram);
        let free = free.ok_or(ErrorNumber::NOT_NOW)?;
        let half = free.half(direction);
        let word = usize::from(word);
        if word >= half.words().len() && number == 0 {
            return Ok(());
        }
        if !known || half.set(word, number).is_err() {
            return Err(ErrorNumber::VALUE);
        }
        free.own = true;
        self.choose_telegram(telegram);
        Ok(())
    }

    /// Returns true for a signal that the drive has: one with a parameter of its number, or one of its fixed telegrams
    /// (STW2 and ZSW2 have no parameter).
    fn has_signal(&self, number: u16) -> bool {
        let device = &self.model.catalogue.device;
        self.parameter_of_signal(number).is_some()
            || device
                .telegrams
                .iter()
                .filter_map(|module| Telegram::find(module.telegram, device.vendor_id))
                .any(|telegram| {
                    [&telegram.setpoint, &telegram.actual]
                        .iter()
                        .any(|half| half.field(number).is_some())
                })
    }

    /// PNU of the parameter that a signal is (PNU 923); none for a number that is not a signal or is reserved.
    pub(super) fn parameter_of_signal(&self, number: u16) -> Option<u16> {
        Signal::find(number, self.model.catalogue.device.vendor_id)?;
        let of = self.model.number_of_signal(number)?;
        let parameter = self.model.numbered(of)?;
        // an application id is a subindex of a number that is not a parameter by itself
        (parameter.name != RESERVED && parameter.base.is_none()).then_some(parameter.pnu)
    }
}

/// Name of a number that the vendor keeps free.
const RESERVED: &str = "reserved";

//! Non-volatile memory: the parameters that the table marks as non-volatile, and only those that were saved. Everything
//! else is gone with the power.
//!
//! DRV.NVSAVE saves, DRV.NVLOAD fetches what was saved last, DRV.RSTVAR puts the values as delivered into the working
//! memory and leaves what is saved alone. Motion tasks are kept like parameters. Source: AKD Parameter Guide 12/2009.

use profile::catalogue::Part;
use profile::parameter::{ErrorNumber, SaveId};

use super::Drive;
use super::settings::Settings;
use crate::store::{Image, ImageError, is_saved, key};

impl Drive {
    /// Starts with what was saved; returns the number of entries that this model does not have or rejects.
    ///
    /// # Errors
    /// When the text is damaged or of another model; the drive then keeps the values it has.
    pub fn start_with(&mut self, saved: &[u8]) -> Result<usize, ImageError> {
        let image = Image::decode(saved)?;
        let left_out = self.restore(&image)?;
        self.take_counters(&image);
        self.saving.start(self.image().encode());
        Ok(left_out)
    }

    /// Makes the drive wait for its owner: a change that is to be saved is acknowledged only when
    /// [`report_save`](Self::report_save) reports that the values are stored. Without this call it is acknowledged at
    /// once.
    pub fn confirm_saves(&mut self) {
        self.saving.confirm();
    }

    /// Reports that the text of an [`Event::Save`](super::Event::Save) is stored, or that it could not be. The report counts
    /// for every earlier save too. After a failure the values stored before are the saved ones.
    pub fn report_save(&mut self, save: SaveId, stored: bool) {
        self.saving.report(save, stored);
    }

    /// Puts everything that can be saved back to the values as delivered and saves it; stops the axis first.
    pub fn reset_to_delivery(&mut self) {
        self.request_disable();
        self.values.reset_to(&self.delivered());
        self.reset_set_ups();
        self.forget_tasks();
        self.reset_telegrams();
        self.apply();
        self.save();
    }

    /// Restarts the drive where it is: what is outside it stays, its values are as saved, everything else is as after
    /// power-on. What it counted is saved first, as when power goes in order.
    pub(crate) fn restart(&mut self) {
        self.end_counting();
        self.count_due();
        let mut fresh = Self::new(self.model);
        if self.aside.is_some() {
            fresh.set_aside_telegram();
        }
        fresh.rotary = self.rotary;
        fresh.last = self.last;
        fresh.external = self.external;
        fresh.terminals = self.terminals;
        std::mem::swap(&mut fresh.axis, &mut self.axis);
        fresh.take_lengths(&self.free);
        std::mem::swap(&mut fresh.events, &mut self.events);
        std::mem::swap(&mut fresh.saving, &mut self.saving);
        let lasting: Vec<u16> = self.faults.lasting_numbers().collect();
        *self = fresh;
        if let Some(text) = self.saving.newest().map(str::to_owned) {
            // what it saved itself is what it reads
            let _ = self.start_with(text.as_bytes());
        }
        self.apply();
        for number in lasting {
            self.raise_external(number, true);
        }
        self.follow();
    }

    /// Saves IP.MODE and nothing else.
    pub(super) fn keep_address_mode(&mut self, mode: i64) {
        let Some(parameter) = self
            .model
            .number(Part::AddressMode)
            .and_then(|pnu| self.model.numbered(pnu))
        else {
            return;
        };
        self.values.set(parameter.pnu, mode);
        let mut image = self.saved_image();
        if image.set(parameter, mode, &self.settings.scaling) {
            self.keep_saved(&image);
        }
    }

    /// DRV.NVSAVE.
    pub(super) fn save(&mut self) {
        self.keep_saved(&self.image());
    }

    /// DRV.NVLOAD: not while the power stage is on.
    pub(super) fn load(&mut self) -> Result<(), ErrorNumber> {
        if self.is_enabled() {
            return Err(ErrorNumber::NOT_NOW);
        }
        let image = self.saved_image();
        self.restore(&image).map_err(|_| ErrorNumber::NOT_NOW)?;
        Ok(())
    }

    /// DRV.RSTVAR: not while the power stage is on.
    pub(super) fn defaults(&mut self) -> Result<(), ErrorNumber> {
        if self.is_enabled() {
            return Err(ErrorNumber::NOT_NOW);
        }
        self.values.reset_to(&self.delivered());
        self.reset_set_ups();
        self.forget_tasks();
        Ok(())
    }

    /// Everything that would be saved now.
    fn image(&self) -> Image {
        let mut image = self.first_set_up().image(&self.settings.scaling);
        self.push_set_ups(&mut image);
        for (name, text) in self.task_lines() {
            image.push_text(&name, &text);
        }
        self.push_counters(&mut image);
        image
    }

    /// Returns the values saved last; those as delivered where nothing was saved.
    pub(super) fn saved_image(&self) -> Image {
        let saved = self.saving.newest();
        saved
            .and_then(|text| Image::decode(text.as_bytes()).ok())
            .unwrap_or_else(|| self.delivered().image(&self.model.catalogue.scaling))
    }

    fn restore(&mut self, image: &Image) -> Result<usize, ImageError> {
        let model = self.model;
        self.reset_set_ups();
        let left_out = self
            .values
            .restore(image, |values| Settings::new(model, values).scaling)?;
        self.forget_tasks();
        let others = image.entries();
        let taken = others
            .filter(|(name, text)| {
                self.take_task_line(name, text)
                    || self.take_set_up_line(image, name, text)
                    || self.is_counter_line(name, text)
            })
            .count();
        self.apply();
        self.restore_telegram();
        Ok(left_out - taken)
    }

    /// Saves one value and nothing else.
    pub(super) fn save_element(&mut self, position: usize, element: u16) {
        let Some(parameter) = self.model.catalogue.parameters.get(position) else {
            return;
        };
        if !is_saved(parameter) {
            return;
        }
        let mut image = self.saved_image();
        if let Some(text) = self.values.text_at(position) {
            let key = key(self.model.catalogue, position, 0);
            if image
                .entries()
                .any(|entry| entry == (key.as_str(), text.as_str()))
            {
                return self.saving.join();
            }
            image.set_text(&key, &text);
            return self.keep_saved(&image);
        }
        let key = self.saved_key(position, element);
        let raw = self.stored(position, element);
        if image.set_as(&key, parameter, raw, &self.settings.scaling.kept()) {
            self.keep_saved(&image);
        } else {
            self.saving.join();
        }
    }

    fn keep_saved(&mut self, image: &Image) {
        self.saving.save(image.encode(), true);
    }
}

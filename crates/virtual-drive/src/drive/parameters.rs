//! Parameter service: the drive behind base mode parameter access.

use profile::catalogue::{Access, Parameter, Part, Scale, Size, padded};
use profile::notation::Notation;
use profile::parameter::{
    Attributes, Description, ErrorNumber, Format, Identifier, Keep, ParameterAccess, Refusal, SaveId,
    SaveState, Saving, Served, serve, serve_saving,
};
use profile::unit::Variable;

use super::{Drive, WriteChannel};
use crate::model::Live;

/// One half of a 64-bit value that waits for the other.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Half {
    /// The low half was read; the high half of the same sample may follow.
    Read { pnu: u16, whole: i64 },
    /// The high half was written; the low half must follow.
    Written { pnu: u16, high: u32 },
}

impl Drive {
    /// Answers a parameter request block; writes the response block into `out` and gives its length. Allocates nothing
    /// but for the commands that save, strings that are written, and events that are not taken.
    ///
    /// # Errors
    /// When the block is not a request; the record write is to be refused then.
    pub fn serve(&mut self, request: &[u8], out: &mut [u8]) -> Result<usize, Refusal> {
        let dialect = self.model.known.dialect;
        self.written_through(WriteChannel::Record, |drive| serve(request, dialect, drive, out))
    }

    /// As [`serve`](Self::serve); names the save that the response waits for too.
    ///
    /// # Errors
    /// As [`serve`](Self::serve).
    pub fn serve_saving(&mut self, request: &[u8], out: &mut [u8]) -> Result<Served, Refusal> {
        let dialect = self.model.known.dialect;
        self.written_through(WriteChannel::Record, |drive| {
            serve_saving(request, dialect, drive, out)
        })
    }

    /// Returns the index of the parameter in the catalogue, and the element that is meant.
    pub(super) fn place(
        &self,
        pnu: u16,
        subindex: u16,
    ) -> Result<(usize, u16, &'static Parameter), ErrorNumber> {
        let catalogue = self.model.catalogue;
        let (position, element) = catalogue
            .place(pnu, subindex)
            .ok_or(ErrorNumber::UNKNOWN_PARAMETER)?;
        let parameter = catalogue
            .parameters
            .get(position)
            .ok_or(ErrorNumber::UNKNOWN_PARAMETER)?;
        Ok((position, element, parameter))
    }
}

impl ParameterAccess for Drive {
    fn attributes(&self, pnu: u16, subindex: u16) -> Option<Attributes> {
        self.model.catalogue.attributes(pnu, subindex)
    }

    fn exists(&self, pnu: u16) -> bool {
        self.model.catalogue.exists(pnu)
    }

    /// Of a 64-bit value the low half is read at its own number and the high half at the next one. Reading the low half
    /// keeps the high half that belongs to it for a read that follows.
    fn read(&mut self, pnu: u16, subindex: u16) -> Result<u64, ErrorNumber> {
        let kept = self.half.take();
        if let Some(parameter) = self.model.catalogue.by_high(pnu) {
            let whole = match kept {
                Some(Half::Read { pnu, whole }) if pnu == parameter.pnu => whole,
                _ => self.element(self.place(parameter.pnu, subindex)?.0, subindex)?,
            };
            return Ok(whole.cast_unsigned() >> 32);
        }
        let (position, element, parameter) = self.place(pnu, subindex)?;
        let whole = self.element(position, element)?;
        if parameter.wide {
            self.half = Some(Half::Read { pnu, whole });
        }
        Ok(whole.cast_unsigned())
    }

    /// Writes a raw value. The high half of a 64-bit value is written first and takes effect with the low half. A low
    /// half without a high half is the whole value. Any other access in between discards the high half.
    fn write(&mut self, pnu: u16, subindex: u16, raw: u64, keep: Keep) -> Result<(), ErrorNumber> {
        let kept = self.half.take();
        if let Some(parameter) = self.model.catalogue.by_high(pnu) {
            let pnu = parameter.pnu;
            self.half = Some(Half::Written {
                pnu,
                high: raw as u32,
            });
            return Ok(());
        }
        let (position, element, parameter) = self.place(pnu, subindex)?;
        let raw = match (parameter.size, parameter.signed) {
            (Size::Dword, _) if parameter.wide => match kept {
                Some(Half::Written { pnu: written, high }) if written == pnu => {
                    parameter.whole(high, raw as u32)
                }
                _ => parameter.low_word(raw as u32),
            },
            (Size::Byte, true) => i64::from(raw as i8),
            (Size::Word, true) => i64::from(raw as i16),
            (Size::Dword, true) => i64::from(raw as i32),
            (Size::Byte, false) => i64::from(raw as u8),
            (Size::Word | Size::Command, _) => i64::from(raw as u16),
            (Size::Dword, false) => i64::from(raw as u32),
        };
        self.set_element(position, element, raw)?;
        self.follow();
        self.report_written(pnu, subindex, raw);
        if keep == Keep::Permanent || self.model.known.dialect.saving == Saving::Always {
            self.save_element(position, element);
        }
        Ok(())
    }

    fn started_save(&mut self) -> Option<SaveId> {
        self.saving.take_started()
    }

    fn save_state(&self, save: SaveId) -> SaveState {
        self.saving.state(save)
    }

    /// With 927 at 0 the bus may change nothing but that.
    fn may_change(&self, pnu: u16) -> bool {
        self.model
            .number(Part::ParameterEdit)
            .is_none_or(|edit| pnu == edit || self.values.get(edit) != 0)
    }

    /// Texts of an enumeration, the text of a value at its number.
    fn text(&self, pnu: u16, index: u16) -> Option<[u8; 16]> {
        if !self.model.known.dialect.texts {
            return None;
        }
        self.model.catalogue.text(pnu, index)
    }

    /// Returns the description. Its limits are those of a double word: the values that can be written to this number. A
    /// high half is described as the bare number that it is.
    fn description(&self, pnu: u16) -> Option<Description> {
        let catalogue = self.model.catalogue;
        let high = catalogue.by_high(pnu);
        let (position, _, parameter) = self.place(high.map_or(pnu, |parameter| parameter.pnu), 0).ok()?;
        let mut flags = u16::from(parameter.format.0);
        let mut set = |flag: u16, when: bool| {
            if when {
                flags |= flag;
            }
        };
        let Variable { size, conversion } = match high {
            Some(_) => Variable::NONE,
            None if catalogue.notation != Notation::Name => parameter.variable,
            None => variable(parameter).unwrap_or_default(),
        };
        let stored = matches!(self.live.get(position), Some(Live::Stored));
        set(Identifier::ARRAY, parameter.is_array());
        set(Identifier::READ_ONLY, parameter.access == Access::ReadOnly);
        // a selection of a VLT has no quantity either, and yet 0-01 is described as 0x0405 (FC 300 design guide)
        set(Identifier::NO_SCALE, size == 0 && parameter.choices.is_empty());
        set(Identifier::CHANGED, stored && self.values.is_changed(position));
        set(
            Identifier::TEXT,
            self.model.known.dialect.texts && !parameter.choices.is_empty(),
        );
        let fits = parameter.size.range(parameter.signed);
        let normalised = parameter.format == Format::N2;
        let (low, high) = match high {
            Some(_) => (*fits.start(), *fits.end()),
            None => {
                let (low, high) = self.limits(position, parameter);
                let within = |limit: i64| limit.clamp(*fits.start(), *fits.end());
                (within(low), within(high))
            }
        };
        Some(Description {
            identifier: Identifier(flags),
            elements: match (parameter.is_array(), parameter.length) {
                (true, _) => parameter.elements,
                (false, length) => length,
            },
            factor: factor(conversion.0),
            size_index: size,
            conversion_index: conversion.0,
            name: padded(parameter.name),
            minimum: (low as u32).to_be_bytes(),
            maximum: (high as u32).to_be_bytes(),
            reference_pnu: if normalised { self.reference_number() } else { 0 },
            normalisation: if normalised { NORMALISED } else { 0 },
            ..Description::default()
        })
    }
}

/// Standardisation factor of a conversion index: the value by which one divides to have the unit itself, as in the
/// example of the MCA 101 manual (mV, 1000). Minutes, hours and days are 70, 74 and 77; others than powers of ten are 1.
fn factor(conversion: i8) -> f32 {
    match conversion {
        -9..=9 => 10_f32.powi(-i32::from(conversion)),
        70 => 1.0 / 60.0,
        74 => 1.0 / 3600.0,
        77 => 1.0 / 86400.0,
        _ => 1.0,
    }
}

/// Normalisation of a cyclic value: valid, bit 14 is 100 %. Source: MCA 101 manual p. 33.
const NORMALISED: u16 = 0x800E;

impl Drive {
    /// PNU of the value that is 100 % of a reference.
    fn reference_number(&self) -> u16 {
        self.model.number(Part::Reference).unwrap_or(0)
    }
}

/// Returns unit and step of a value whose table has no indices for them, from unit and scale. Dimensionless numbers
/// have none.
fn variable(parameter: &Parameter) -> Option<Variable> {
    let exponent = match parameter.scale {
        Scale::Raw => 0,
        Scale::Milli => -3,
        _ => return None,
    };
    let unit = parameter.unit.strip_suffix("rms").unwrap_or(parameter.unit);
    Variable::of(unit, exponent).filter(|_| !unit.is_empty())
}

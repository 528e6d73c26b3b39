//! Parameter service: the drive behind base mode parameter access.

use profidrive::catalogue::{Access, Parameter, Scale, Size};
use profidrive::parameter::{
    Attributes, Description, ErrorNumber, Format, Identifier, Keep, ParameterAccess, Refusal, serve,
};

use super::Drive;
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
    /// but for the commands that save.
    ///
    /// # Errors
    /// When the block is no request; the record write is to be refused then.
    pub fn serve(&mut self, request: &[u8], out: &mut [u8]) -> Result<usize, Refusal> {
        serve(request, self.model.dialect, self, out)
    }

    /// Where the parameter is in the catalogue, and which element of it is meant.
    fn place(&self, pnu: u16, subindex: u16) -> Result<(usize, u16, &'static Parameter), ErrorNumber> {
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
        let high = || self.model.catalogue.by_high(pnu);
        let parameter = self
            .place(pnu, subindex)
            .map_or_else(|_| high(), |(_, _, parameter)| Some(parameter))?;
        let writable = parameter.access != Access::ReadOnly;
        Some(Attributes {
            elements: if parameter.is_array() {
                parameter.elements
            } else {
                0
            },
            first: parameter.base.unwrap_or(0),
            ..Attributes::simple(format(parameter), parameter.size.octets(), writable)
        })
    }

    fn exists(&self, pnu: u16) -> bool {
        self.attributes(pnu, 0).is_some() || self.model.catalogue.is_collecting(pnu)
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

    /// Of a 64-bit value the high half is written first and has no effect before the low half, which makes one value of
    /// both. A low half that comes alone is the whole value. Any other access in between forgets the high half.
    fn write(&mut self, pnu: u16, subindex: u16, raw: u64, _: Keep) -> Result<(), ErrorNumber> {
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
                _ => parameter.alone(raw as u32),
            },
            (Size::Byte, true) => i64::from(raw as i8),
            (Size::Word, true) => i64::from(raw as i16),
            (Size::Dword, true) => i64::from(raw as i32),
            (Size::Byte, false) => i64::from(raw as u8),
            (Size::Word | Size::Command, _) => i64::from(raw as u16),
            (Size::Dword, false) => i64::from(raw as u32),
        };
        self.set_element(position, element, raw)
    }

    /// The limits are those of a double word: what can be written to this number alone. A high half is described as the
    /// bare number that it is.
    fn description(&self, pnu: u16) -> Option<Description> {
        let catalogue = self.model.catalogue;
        let high = catalogue.by_high(pnu);
        let (position, _, parameter) = self.place(high.map_or(pnu, |parameter| parameter.pnu), 0).ok()?;
        let scaling = &self.settings.scaling;
        let mut flags = u16::from(format(parameter).0);
        let mut set = |flag: u16, when: bool| {
            if when {
                flags |= flag;
            }
        };
        let (size_index, conversion_index) = match high {
            Some(_) => (0, 0),
            None => unit(parameter).unwrap_or_default(),
        };
        let stored = matches!(self.live.get(position), Some(Live::Stored));
        set(Identifier::ARRAY, parameter.is_array());
        set(Identifier::READ_ONLY, parameter.access == Access::ReadOnly);
        set(Identifier::NO_SCALE, size_index == 0);
        set(
            Identifier::CHANGED,
            stored && self.values.at(position) != parameter.raw_default(scaling),
        );
        let fits = parameter.size.range(parameter.signed);
        let (low, high) = match high {
            Some(_) => (*fits.start(), *fits.end()),
            None => {
                let (low, high) = self.limits(position, parameter);
                let within = |limit: i64| limit.clamp(*fits.start(), *fits.end());
                (within(low), within(high))
            }
        };
        let mut name = [b' '; 16];
        for (place, octet) in name.iter_mut().zip(parameter.name.bytes()) {
            *place = octet;
        }
        Some(Description {
            identifier: Identifier(flags),
            elements: if parameter.is_array() {
                parameter.elements
            } else {
                0
            },
            factor: 1.0,
            size_index,
            conversion_index,
            name,
            minimum: (low as u32).to_be_bytes(),
            maximum: (high as u32).to_be_bytes(),
            ..Description::default()
        })
    }
}

/// True type of the value; dialects that know only sizes do not show it.
const fn format(parameter: &Parameter) -> Format {
    match (parameter.size, parameter.signed) {
        (Size::Byte, true) => Format::INTEGER8,
        (Size::Byte, false) => Format::UNSIGNED8,
        (Size::Word, true) => Format::INTEGER16,
        (Size::Word | Size::Command, _) => Format::UNSIGNED16,
        (Size::Dword, true) => Format::INTEGER32,
        (Size::Dword, false) => Format::UNSIGNED32,
    }
}

/// Size index and conversion index of the unit. Source: profile reference 1.9 by way of Danfoss MCA 101. `None` where
/// the table has no index for the unit and the steps of the value.
fn unit(parameter: &Parameter) -> Option<(u8, i8)> {
    let milli = match parameter.scale {
        Scale::Raw => 0,
        Scale::Milli => -3,
        _ => return None,
    };
    Some(match (parameter.unit, milli) {
        ("rpm", 0) => (11, 67),
        ("s", exponent) => (4, exponent),
        ("ms", 0) => (4, -3),
        ("W", exponent) => (9, exponent),
        ("degC", exponent) => (17, exponent),
        ("V" | "Vrms", exponent) => (21, exponent),
        ("A" | "Arms", exponent) => (22, exponent),
        ("mA", 0) => (22, -3),
        ("ohm", exponent) => (23, exponent),
        ("%", exponent) => (24, exponent),
        ("Hz", exponent) => (28, exponent),
        ("kHz", exponent) => (28, exponent + 3),
        _ => return None,
    })
}

//! Parameter service: the drive behind base mode parameter access.

use profidrive::catalogue::{Access, Parameter, Scale, Size};
use profidrive::parameter::{
    Attributes, Description, ErrorNumber, Format, Identifier, ParameterAccess, Refusal, serve,
};

use super::Drive;
use crate::model::Live;

impl Drive {
    /// Answers a parameter request block; writes the response block into `out` and gives its length. Allocates nothing
    /// but for the commands that save.
    ///
    /// # Errors
    /// When the block is no request; the record write is to be refused then.
    pub fn serve(&mut self, request: &[u8], out: &mut [u8]) -> Result<usize, Refusal> {
        serve(request, self.model.dialect, self, out)
    }

    fn place(&self, pnu: u16) -> Result<(usize, &'static Parameter), ErrorNumber> {
        let catalogue = self.model.catalogue;
        let position = catalogue.position(pnu).ok_or(ErrorNumber::UNKNOWN_PARAMETER)?;
        let parameter = catalogue
            .parameters
            .get(position)
            .ok_or(ErrorNumber::UNKNOWN_PARAMETER)?;
        Ok((position, parameter))
    }
}

impl ParameterAccess for Drive {
    fn attributes(&self, pnu: u16) -> Option<Attributes> {
        let parameter = self.model.catalogue.by_pnu(pnu)?;
        Some(Attributes {
            format: format(parameter),
            octets: parameter.size.octets(),
            elements: if parameter.is_array() {
                parameter.elements
            } else {
                0
            },
            writable: parameter.access != Access::ReadOnly,
        })
    }

    fn read(&mut self, pnu: u16, subindex: u16) -> Result<u64, ErrorNumber> {
        let (position, _) = self.place(pnu)?;
        self.element(position, subindex).map(i64::cast_unsigned)
    }

    fn write(&mut self, pnu: u16, subindex: u16, raw: u64) -> Result<(), ErrorNumber> {
        let (position, parameter) = self.place(pnu)?;
        let raw = match (parameter.size, parameter.signed) {
            (Size::Byte, true) => i64::from(raw as i8),
            (Size::Word, true) => i64::from(raw as i16),
            (Size::Dword, true) => i64::from(raw as i32),
            (Size::Byte, false) => i64::from(raw as u8),
            (Size::Word | Size::Command, _) => i64::from(raw as u16),
            (Size::Dword, false) => i64::from(raw as u32),
        };
        self.set_element(position, subindex, raw)
    }

    fn description(&self, pnu: u16) -> Option<Description> {
        let (position, parameter) = self.place(pnu).ok()?;
        let scaling = &self.settings.scaling;
        let mut flags = u16::from(format(parameter).0);
        let mut set = |flag: u16, when: bool| {
            if when {
                flags |= flag;
            }
        };
        let (size_index, conversion_index) = unit(parameter).unwrap_or_default();
        let stored = matches!(self.live.get(position), Some(Live::Stored));
        set(Identifier::ARRAY, parameter.is_array());
        set(Identifier::READ_ONLY, parameter.access == Access::ReadOnly);
        set(Identifier::NO_SCALE, size_index == 0);
        set(
            Identifier::CHANGED,
            stored && self.values.at(position) != parameter.raw_default(scaling),
        );
        let (low, high) = parameter.raw_limits(scaling);
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

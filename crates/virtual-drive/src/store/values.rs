//! The present values of all parameters that are not measured.

use std::collections::HashMap;

use profile::catalogue::{Access, Catalogue, Parameter, Scale, Scaling};
use profile::notation::Notation;

use super::{Image, ImageError};
use crate::model::numbered;

/// One number per parameter of a catalogue, as on the wire but for positions ([`Scaling::kept`]), and the elements of arrays
/// and the octets of strings that can be written. Other strings and measured values are not here.
#[derive(Debug, Clone)]
pub struct Values {
    catalogue: &'static Catalogue,
    raw: Box<[i64]>,
    /// Position of an array and where its elements begin, ascending.
    arrays: Box<[(usize, usize)]>,
    elements: Box<[i64]>,
}

impl Values {
    /// As delivered.
    #[must_use]
    pub fn new(catalogue: &'static Catalogue) -> Self {
        let scaling = &catalogue.scaling.kept();
        let raw = catalogue
            .parameters
            .iter()
            .map(|parameter| parameter.raw_default(scaling))
            .collect();
        let mut arrays = Vec::new();
        let mut elements = Vec::new();
        for (position, parameter) in catalogue.parameters.iter().enumerate() {
            if (parameter.is_array() || parameter.is_text()) && parameter.access == Access::ReadWrite {
                arrays.push((position, elements.len()));
                elements.extend((0..cells(parameter)).map(|element| fresh(parameter, element, scaling)));
            }
        }
        Self {
            catalogue,
            raw,
            arrays: arrays.into(),
            elements: elements.into(),
        }
    }

    /// Returns the place of an element of an array.
    fn cell(&self, position: usize, element: u16) -> Option<usize> {
        let parameter = self.catalogue.parameters.get(position)?;
        let found = self
            .arrays
            .binary_search_by_key(&position, |(position, _)| *position);
        let (_, first) = self.arrays.get(found.ok()?)?;
        (element < cells(parameter)).then_some(first + usize::from(element))
    }

    /// One element of an array by its position in the catalogue; the number itself of a parameter that is none.
    #[must_use]
    pub fn element_at(&self, position: usize, element: u16) -> i64 {
        match self.cell(position, element) {
            Some(cell) => self.elements.get(cell).copied().unwrap_or(0),
            None => self.at(position),
        }
    }

    /// One element of an array by its number.
    #[must_use]
    pub fn element_of(&self, number: u16, element: u16) -> i64 {
        numbered(self.catalogue, number).map_or(0, |position| self.element_at(position, element))
    }

    /// Sets one element of an array, or the number of a parameter that is none; cut to what fits.
    pub fn set_element_at(&mut self, position: usize, element: u16, raw: i64) {
        let (Some(cell), Some(parameter)) = (
            self.cell(position, element),
            self.catalogue.parameters.get(position),
        ) else {
            return self.set_at(position, raw);
        };
        let range = parameter.range();
        if let Some(place) = self.elements.get_mut(cell) {
            *place = raw.clamp(*range.start(), *range.end());
        }
    }

    /// Returns the catalogue the values belong to.
    #[must_use]
    pub const fn catalogue(&self) -> &'static Catalogue {
        self.catalogue
    }

    /// Returns the number of a parameter by its position in the catalogue, 0 for a position outside.
    #[must_use]
    pub fn at(&self, position: usize) -> i64 {
        self.raw.get(position).copied().unwrap_or(0)
    }

    /// Sets a number by position; cut to what fits its size.
    pub fn set_at(&mut self, position: usize, raw: i64) {
        if let (Some(place), Some(parameter)) = (
            self.raw.get_mut(position),
            self.catalogue.parameters.get(position),
        ) {
            let range = parameter.range();
            *place = raw.clamp(*range.start(), *range.end());
        }
    }

    /// Returns the number of a parameter, 0 for an unknown one.
    #[must_use]
    pub fn get(&self, pnu: u16) -> i64 {
        numbered(self.catalogue, pnu).map_or(0, |position| self.at(position))
    }

    /// Sets the number of a parameter; nothing happens for an unknown one.
    pub fn set(&mut self, pnu: u16, raw: i64) {
        if let Some(position) = numbered(self.catalogue, pnu) {
            self.set_at(position, raw);
        }
    }

    /// Returns true when a parameter, or an element of it, is not as delivered.
    #[must_use]
    pub fn is_changed(&self, position: usize) -> bool {
        let Some(parameter) = self.catalogue.parameters.get(position) else {
            return false;
        };
        let scaling = &self.catalogue.scaling.kept();
        if self.cell(position, 0).is_none() {
            return self.at(position) != parameter.raw_default(scaling);
        }
        (0..cells(parameter))
            .any(|element| self.element_at(position, element) != fresh(parameter, element, scaling))
    }

    /// Puts every writable parameter back to the value as `delivered` (DRV.RSTVAR).
    pub fn reset_to(&mut self, delivered: &Self) {
        for (position, parameter) in self.catalogue.parameters.iter().enumerate() {
            if parameter.access == Access::ReadWrite {
                self.set_at(position, delivered.at(position));
            }
        }
        self.elements.clone_from(&delivered.elements);
    }

    /// Returns the image of everything that is saved.
    #[must_use]
    pub fn image(&self, scaling: &Scaling) -> Image {
        let scaling = &scaling.kept();
        let mut image = Image::new(self.catalogue.model);
        for (position, parameter) in self.catalogue.parameters.iter().enumerate() {
            if let Some(text) = self.text_at(position).filter(|_| is_saved(parameter)) {
                image.push_text(&key(self.catalogue, position, 0), &text);
            } else if is_saved(parameter) {
                for element in 0..self.stored_elements(position) {
                    let raw = self.element_at(position, element);
                    image.push_as(&key(self.catalogue, position, element), parameter, raw, scaling);
                }
            }
        }
        image
    }

    /// Returns the octets of a string as text: printable ASCII as it is, everything else as `%` with two hexadecimal
    /// digits. The blanks behind its end are left out.
    pub(crate) fn text_at(&self, position: usize) -> Option<String> {
        let parameter = self.catalogue.parameters.get(position)?;
        let count = cells(parameter);
        let octet = |element| u8::try_from(self.element_at(position, element)).unwrap_or(b' ');
        let length = (0..count).rev().find(|element| octet(*element) != b' ');
        parameter.is_text().then(|| {
            let octets = (0..length.map_or(0, |last| last + 1)).map(octet);
            octets.map(written).collect()
        })
    }

    /// Sets a string from its text; false when it is not one, or too long.
    fn set_text_at(&mut self, position: usize, text: &str) -> bool {
        let Some(parameter) = self.catalogue.parameters.get(position) else {
            return false;
        };
        let count = cells(parameter);
        let octets = match read(text) {
            Some(octets) if octets.len() <= usize::from(count) => octets,
            _ => return false,
        };
        for (element, octet) in (0..count).zip(octets.into_iter().chain(std::iter::repeat(b' '))) {
            self.set_element_at(position, element, octet.into());
        }
        true
    }

    /// Elements that are kept: none of an array that only seems to be stored.
    fn stored_elements(&self, position: usize) -> u16 {
        match self.catalogue.parameters.get(position) {
            Some(parameter) if parameter.is_array() && self.cell(position, 0).is_none() => 0,
            Some(parameter) => cells(parameter).max(1),
            None => 0,
        }
    }

    /// Takes over a saved image. Parameters missing in it get the value as delivered. Names that this model does not
    /// have or does not save, and values outside their limits, are skipped and counted. `scaling` scales the values
    /// once those that scale others are set.
    ///
    /// # Errors
    /// When the image is of another model; nothing has changed then.
    pub fn restore(
        &mut self,
        image: &Image,
        scaling: impl Fn(&Self) -> Scaling,
    ) -> Result<usize, ImageError> {
        if image.model() != self.catalogue.model {
            return Err(ImageError::Model {
                found: image.model().to_owned(),
                expected: self.catalogue.model,
            });
        }
        let fresh = Self::new(self.catalogue);
        for (position, parameter) in self.catalogue.parameters.iter().enumerate() {
            if is_saved(parameter) {
                for element in 0..self.stored_elements(position) {
                    self.set_element_at(position, element, fresh.element_at(position, element));
                }
            }
        }
        let known = self.keys();
        let mut taken = 0;
        // What scales others is itself a bare number and comes first.
        for first in [true, false] {
            let scaling = scaling(self).kept();
            for (name, text) in image.entries() {
                let string = known
                    .get(name)
                    .filter(|(position, _)| first && self.text_at(*position).is_some());
                if let Some((position, _)) = string {
                    taken += usize::from(self.set_text_at(*position, text));
                    continue;
                }
                let value = known.get(name).and_then(|(position, element)| {
                    let parameter = self.catalogue.parameters.get(*position)?;
                    if parameter.is_text() {
                        return None;
                    }
                    let raw = image.number(parameter, text, &scaling)?;
                    let (low, high) = parameter.raw_limits(&scaling);
                    let fits = (low..=high).contains(&raw) && (parameter.scale == Scale::Raw) == first;
                    fits.then_some((*position, *element, raw))
                });
                if let Some((position, element, raw)) = value {
                    self.set_element_at(position, element, raw);
                    taken += 1;
                }
            }
        }
        Ok(image.entries().count() - taken)
    }
}

impl Values {
    /// Every key of an image with what it means.
    fn keys(&self) -> HashMap<String, (usize, u16)> {
        let mut keys = HashMap::new();
        for (position, parameter) in self.catalogue.parameters.iter().enumerate() {
            if is_saved(parameter) {
                let count = if parameter.is_text() {
                    1
                } else {
                    self.stored_elements(position)
                };
                for element in 0..count {
                    keys.insert(key(self.catalogue, position, element), (position, element));
                }
            }
        }
        keys
    }
}

/// Returns the key of a parameter in an image: the vendor's name where it has one, else its number as the vendor
/// writes it.
pub(crate) fn key(catalogue: &Catalogue, position: usize, element: u16) -> String {
    let Some(parameter) = catalogue.parameters.get(position) else {
        return String::new();
    };
    let label = if catalogue.notation == Notation::Name {
        parameter.name.to_owned()
    } else {
        catalogue.label(parameter)
    };
    if parameter.is_array() {
        format!("{label}[{element}]")
    } else {
        label
    }
}

/// Returns true for what a drive keeps when it saves. The mapping of free telegrams of an AKD is not (its table has it
/// so).
pub(crate) fn is_saved(parameter: &Parameter) -> bool {
    let is_kept = parameter.length == 0 || (parameter.is_text() && !parameter.is_array());
    parameter.saved && parameter.access == Access::ReadWrite && is_kept
}

/// Places for the elements of an array, or the octets of a string.
const fn cells(parameter: &Parameter) -> u16 {
    match (parameter.length, parameter.elements) {
        (0, elements) => elements,
        (length, 0) => length,
        (length, elements) => length.saturating_mul(elements),
    }
}

/// Element of an array, or octet of a string, as delivered.
fn fresh(parameter: &Parameter, element: u16, scaling: &Scaling) -> i64 {
    if parameter.is_text() {
        let place = usize::from(element % parameter.length.max(1));
        parameter
            .text
            .as_bytes()
            .get(place)
            .copied()
            .unwrap_or(b' ')
            .into()
    } else {
        parameter.raw_default(scaling)
    }
}

/// Returns an octet of a string in an image, which has marks of its own.
fn written(octet: u8) -> String {
    if octet.is_ascii_alphanumeric() || b"-_.,:;/+*()".contains(&octet) {
        char::from(octet).to_string()
    } else {
        format!("%{octet:02X}")
    }
}

/// Returns the octets of such a text; none where it is not one.
fn read(text: &str) -> Option<Vec<u8>> {
    let mut octets = Vec::new();
    let mut rest = text.as_bytes();
    while let Some((&octet, after)) = rest.split_first() {
        rest = after;
        if octet == b'%' {
            let (digits, after) = rest.split_at_checked(2)?;
            let digits = core::str::from_utf8(digits).ok()?;
            octets.push(u8::from_str_radix(digits, 16).ok()?);
            rest = after;
        } else {
            octets.push(octet);
        }
    }
    Some(octets)
}

#[cfg(test)]
mod tests {
    use super::*;
    use profile::catalogue::{AKD, VLT};
    use proptest::prelude::*;

    #[test]
    fn values_as_delivered() {
        let values = Values::new(&AKD);
        assert_eq!(values.get(2108), 3_000_000); // DRV.ACC 3000 rpm/s
        assert_eq!(values.get(3064), 1638);
        assert_eq!(values.get(2135), 1);
        assert_eq!(values.get(4), 0);
    }

    #[test]
    fn a_value_never_leaves_its_size() {
        let mut values = Values::new(&AKD);
        values.set(2135, 1_000);
        assert_eq!(values.get(2135), 255);
        values.set(2003, -40_000); // AIN.OFFSET, signed word
        assert_eq!(values.get(2003), -32768);
        values.set_at(usize::MAX, 1);
    }

    #[test]
    fn saved_names_are_unambiguous() {
        let mut names: Vec<_> = AKD
            .parameters
            .iter()
            .filter(|parameter| is_saved(parameter))
            .map(|p| p.name)
            .collect();
        names.sort_unstable();
        let count = names.len();
        names.dedup();
        assert_eq!(names.len(), count);
        assert!(count > 300, "{count}");
    }

    #[test]
    fn reset_and_restore() {
        let mut values = Values::new(&AKD);
        values.set(2108, 5_000_500);
        values.set(3065, 400);
        values.set(2110, 1); // DRV.ACTIVE is measured, not reset
        let image = values.image(&Scaling::default());
        values.reset_to(&Values::new(&AKD));
        assert_eq!(
            (values.get(2108), values.get(3065), values.get(2110)),
            (3_000_000, 763, 1)
        );
        assert_eq!(values.restore(&image, |_| Scaling::default()).unwrap(), 0);
        assert_eq!((values.get(2108), values.get(3065)), (5_000_500, 400));
    }

    proptest! {
        #[test]
        fn a_string_of_any_octets_survives(octets in proptest::collection::vec(any::<u8>(), 0..30)) {
            let position = VLT.parameters.iter().position(|parameter| parameter.pnu == 37).unwrap();
            let mut values = Values::new(&VLT);
            let text: String = octets.iter().copied().map(written).collect();
            let fits = octets.len() <= 25;
            prop_assert_eq!(values.set_text_at(position, &text), fits);
            let mut image = values.image(&VLT.scaling);
            image = Image::decode(image.encode().as_bytes()).unwrap();
            let mut again = Values::new(&VLT);
            prop_assert_eq!(again.restore(&image, |_| VLT.scaling).unwrap(), 0);
            for (element, octet) in (0..25).zip(octets.iter().filter(|_| fits)) {
                prop_assert_eq!(again.element_at(position, element), i64::from(*octet));
            }
            prop_assert_eq!(again.is_changed(position), fits && octets.iter().any(|octet| *octet != b' '));
        }
    }

    #[test]
    fn strange_entries_are_left_out_and_counted() {
        let mut values = Values::new(&AKD);
        let mut image = Image::new("AKD");
        image.push_text("DRV.ACC", "4000.000");
        image.push_text("DRV.NEWER", "1");
        image.push_text("DRV.DEC", "fast");
        image.push_text("PN.VELSCALING", "99999");
        image.push_text("VL.FB_32", "5"); // measured
        assert_eq!(values.restore(&image, |_| Scaling::default()).unwrap(), 4);
        assert_eq!(
            (values.get(2108), values.get(2115), values.get(3064)),
            (4_000_000, 3_000_000, 1638)
        );
        assert!(matches!(
            values.restore(&Image::new("VLT"), |_| Scaling::default()),
            Err(ImageError::Model { .. })
        ));
    }
}

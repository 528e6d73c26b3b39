//! The present values of all parameters that are not measured.

use profidrive::catalogue::{Access, Catalogue, Parameter, Scale, Scaling};

use super::{Image, ImageError};

/// One number per parameter of a catalogue, as on the wire. Arrays and measured values are not here.
#[derive(Debug, Clone)]
pub struct Values {
    catalogue: &'static Catalogue,
    raw: Box<[i64]>,
}

impl Values {
    /// As delivered.
    #[must_use]
    pub fn new(catalogue: &'static Catalogue) -> Self {
        let scaling = Scaling::default();
        let raw = catalogue
            .parameters
            .iter()
            .map(|parameter| parameter.raw_default(&scaling))
            .collect();
        Self { catalogue, raw }
    }

    /// The catalogue the values belong to.
    #[must_use]
    pub const fn catalogue(&self) -> &'static Catalogue {
        self.catalogue
    }

    /// The number of a parameter by its position in the catalogue, 0 for a position outside.
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

    /// The number of a parameter, 0 for an unknown one.
    #[must_use]
    pub fn get(&self, pnu: u16) -> i64 {
        self.catalogue
            .position(pnu)
            .map_or(0, |position| self.at(position))
    }

    /// Sets the number of a parameter; nothing happens for an unknown one.
    pub fn set(&mut self, pnu: u16, raw: i64) {
        if let Some(position) = self.catalogue.position(pnu) {
            self.set_at(position, raw);
        }
    }

    /// Puts every writable parameter back to the value as delivered (DRV.RSTVAR).
    pub fn reset(&mut self) {
        let fresh = Self::new(self.catalogue);
        for (position, parameter) in self.catalogue.parameters.iter().enumerate() {
            if parameter.access == Access::ReadWrite {
                self.set_at(position, fresh.at(position));
            }
        }
    }

    /// The image of everything that is saved.
    #[must_use]
    pub fn image(&self, scaling: &Scaling) -> Image {
        let mut image = Image::new(self.catalogue.model);
        for (position, parameter) in self.catalogue.parameters.iter().enumerate() {
            if is_saved(parameter) {
                image.push(parameter, self.at(position), scaling);
            }
        }
        image
    }

    /// Takes over a saved image: parameters that it does not name get the value as delivered; names that this model
    /// does not have or does not save, and values outside their limits, are left out and counted. `scaling` tells how the
    /// values scale each other once those are there that scale others.
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
                self.set_at(position, fresh.at(position));
            }
        }
        let mut taken = 0;
        // What scales others is itself a bare number and comes first.
        for first in [true, false] {
            let scaling = scaling(self);
            for (name, text) in image.entries() {
                let found = self
                    .catalogue
                    .all_by_name(name)
                    .find(|parameter| is_saved(parameter) && (parameter.scale == Scale::Raw) == first);
                let value = found.and_then(|parameter| {
                    let raw = image.number(parameter, text, &scaling)?;
                    let (low, high) = parameter.raw_limits(&scaling);
                    (low..=high).contains(&raw).then_some((parameter.pnu, raw))
                });
                if let Some((pnu, raw)) = value {
                    self.set(pnu, raw);
                    taken += 1;
                }
            }
        }
        Ok(image.entries().count() - taken)
    }
}

/// True for what DRV.NVSAVE stores.
fn is_saved(parameter: &Parameter) -> bool {
    parameter.saved && parameter.access == Access::ReadWrite && !parameter.is_array()
}

#[cfg(test)]
mod tests {
    use super::*;
    use profidrive::catalogue::AKD;

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
        values.reset();
        assert_eq!(
            (values.get(2108), values.get(3065), values.get(2110)),
            (3_000_000, 763, 1)
        );
        assert_eq!(values.restore(&image, |_| Scaling::default()).unwrap(), 0);
        assert_eq!((values.get(2108), values.get(3065)), (5_000_500, 400));
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

//! From what a person wrote to parameter number and elements.

use alloc::borrow::ToOwned;
use alloc::format;
use alloc::string::{String, ToString};

use crate::catalogue::{Access, Parameter};
use crate::notation::{Elements, Notation, ParameterReference, Shown, Target};

use super::{ParameterProblem, Parameters};

/// One parameter and a run of its elements, found in the tables where there are any.
#[derive(Debug, Clone, Copy)]
pub struct Selection {
    /// Parameter number.
    pub pnu: u16,
    /// First element as a subindex on the wire: 0 for a parameter that is not an array, the application id of a Vacon.
    pub first: u16,
    /// How many elements, at least 1.
    pub count: u16,
    /// True when elements are distinguished: an array, or an index was given.
    pub indexed: bool,
    /// Contents of the tables.
    pub parameter: Option<&'static Parameter>,
    /// How its number is written.
    pub notation: Notation,
}

impl Selection {
    /// Returns all of one parameter of the tables.
    #[must_use]
    pub fn of(parameter: &'static Parameter, notation: Notation) -> Self {
        Self {
            pnu: parameter.pnu,
            first: parameter.subindex(0),
            count: parameter.elements.max(1),
            indexed: parameter.is_array() || parameter.base.is_some(),
            parameter: Some(parameter),
            notation,
        }
    }

    /// Creates a number of which nothing else is known.
    #[must_use]
    pub const fn number(pnu: u16, notation: Notation) -> Self {
        Self {
            pnu,
            first: 0,
            count: 1,
            indexed: false,
            parameter: None,
            notation,
        }
    }

    /// Returns true when it can be written, as far as is known.
    #[must_use]
    pub fn writable(&self) -> Option<bool> {
        self.parameter
            .map(|parameter| parameter.access != Access::ReadOnly)
    }

    /// Returns the number of element `offset` of the selection as printed: `p2108`, `r0947[3]`.
    #[must_use]
    pub fn shown(&self, offset: u16) -> Shown {
        let index = self.indexed.then(|| self.first.saturating_add(offset));
        Shown {
            pnu: self.pnu,
            index,
            writable: self.writable(),
            notation: self.notation,
        }
    }

    /// Returns the number and name: `DRV.ACC (p2108)`.
    #[must_use]
    pub fn label(&self) -> String {
        let elements = Elements {
            first: self.first,
            count: self.count,
        };
        // what one number collects is called by its element
        let collected = matches!(self.notation, Notation::Id { pnu } if pnu == self.pnu && self.indexed);
        let shown = Shown {
            index: collected.then_some(self.first),
            ..self.shown(0)
        };
        let elements = if self.indexed && !(collected && self.count == 1) {
            elements.to_string()
        } else {
            String::new()
        };
        match self.parameter {
            Some(parameter) => format!("{} ({shown}{elements})", parameter.name),
            None => format!("{shown}{elements}"),
        }
    }
}

impl Parameters {
    /// Finds what `reference` means for this drive.
    ///
    /// # Errors
    /// An unknown name (with the nearest ones), or elements that the tables do not have. A number that is in no
    /// table is passed on: the drive may have it.
    pub fn select(&self, reference: &ParameterReference) -> Result<Selection, ParameterProblem> {
        let notation = self.notation();
        let first = reference.elements.map(|elements| elements.first);
        let (pnu, parameter) = match &reference.target {
            Target::Name(name) => {
                let parameter = self.named(name)?;
                (parameter.pnu, Some(parameter))
            }
            Target::Number(number) => {
                let (pnu, id) = self
                    .catalogue
                    .map_or((*number, None), |tables| tables.meant(*number, reference.prefix));
                match (id, self.at(pnu, id.or(first).unwrap_or(0))) {
                    (Some(id), None) => return Ok(unknown_id(pnu, id, notation)),
                    (_, found) => (pnu, found),
                }
            }
        };
        let elements = reference.elements.unwrap_or_default();
        let several = parameter.is_none() || elements.count > 1;
        if several && self.catalogue.is_some_and(|tables| tables.is_collecting(pnu)) {
            if reference.elements.is_none() {
                return Err(ParameterProblem::NoId { pnu });
            }
            return Ok(Selection {
                first: elements.first,
                count: elements.count.max(1),
                indexed: true,
                ..Selection::number(pnu, notation)
            });
        }
        let base = parameter.and_then(|parameter| parameter.base);
        let size = parameter.map_or(u32::from(u16::MAX) + 1, |parameter| {
            u32::from(parameter.elements.max(1))
        });
        let array = parameter.is_some_and(Parameter::is_array);
        let elements = match reference.elements {
            // `ID 103` is the element already
            Some(elements) if base.is_some() && reference.target == Target::Number(pnu) => Elements {
                first: elements.first.saturating_sub(base.unwrap_or(0)),
                count: elements.count,
            },
            Some(elements) => elements,
            None if array => Elements {
                first: 0,
                count: u16::try_from(size).unwrap_or(u16::MAX),
            },
            None => Elements::default(),
        };
        let count = elements.count.max(1);
        let selection = Selection {
            first: elements.first.saturating_add(base.unwrap_or(0)),
            count,
            indexed: array || base.is_some() || (parameter.is_none() && reference.elements.is_some()),
            parameter,
            ..Selection::number(pnu, notation)
        };
        if u32::from(elements.first) + u32::from(count) > size {
            let index = u32::from(elements.first).max(size);
            let whole = Selection {
                first: base.unwrap_or(0),
                count: 1,
                indexed: base.is_some(),
                ..selection
            };
            let elements = u16::try_from(size).unwrap_or(u16::MAX);
            return Err(ParameterProblem::Element {
                parameter: whole.label(),
                elements,
                index,
            });
        }
        Ok(selection)
    }

    /// Returns the vendor's number format.
    #[must_use]
    pub fn notation(&self) -> Notation {
        self.catalogue.map_or(Notation::Name, |tables| tables.notation)
    }

    /// Formats one element by number, and by index where there is one.
    #[must_use]
    pub fn element(&self, pnu: u16, index: Option<u16>) -> Selection {
        Selection {
            first: index.unwrap_or(0),
            indexed: index.is_some(),
            parameter: self.at(pnu, index.unwrap_or(0)),
            ..Selection::number(pnu, self.notation())
        }
    }

    /// Returns the parameter of the tables that a number and a subindex on the wire mean.
    #[must_use]
    pub fn at(&self, pnu: u16, subindex: u16) -> Option<&'static Parameter> {
        self.catalogue?.at(pnu, subindex)
    }

    fn named(&self, name: &str) -> Result<&'static Parameter, ParameterProblem> {
        let Some(tables) = self.catalogue else {
            return Err(ParameterProblem::NoNames {
                name: name.to_owned(),
            });
        };
        // a name of the vendor comes first
        let found = tables.by_name(name).or_else(|| tables.by_common_name(name));
        found.ok_or_else(|| ParameterProblem::Unknown {
            name: name.to_owned(),
            model: tables.model,
            nearest: tables
                .nearest(name, 3)
                .into_iter()
                .map(|parameter| parameter.name)
                .collect(),
        })
    }
}

/// Returns an application id that no table has: the drive may have it.
const fn unknown_id(pnu: u16, id: u16, notation: Notation) -> Selection {
    Selection {
        first: id,
        indexed: true,
        ..Selection::number(pnu, notation)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::catalogue::{AKD, Scaling, VACON, VLT};

    const DRIVE: Parameters = Parameters {
        catalogue: Some(&AKD),
        scaling: DELIVERED,
    };
    const DELIVERED: Scaling = Scaling::DELIVERED;

    fn select(text: &str) -> Result<Selection, ParameterProblem> {
        DRIVE.select(&text.parse().unwrap())
    }

    #[test]
    fn names_and_numbers_meet() {
        assert_eq!(select("drv.acc").unwrap().label(), "DRV.ACC (p2108)");
        assert_eq!(select("p2108").unwrap().label(), "DRV.ACC (p2108)");
        assert_eq!(select("0x83C").unwrap().pnu, 2108);
        let faults = select("947").unwrap();
        assert_eq!((faults.first, faults.count, faults.indexed), (0, 64, true));
        assert_eq!(select("r947[8..15]").unwrap().shown(2).to_string(), "r0947[10]");
        assert_eq!(select("2108.0").unwrap().shown(0).to_string(), "p2108");
    }

    #[test]
    fn mistakes_say_what_is_near() {
        let error = select("DRV.ACCL").unwrap_err();
        assert!(matches!(&error, ParameterProblem::Unknown { nearest, .. } if nearest.contains(&"DRV.ACC")));
        assert!(error.hint().unwrap().contains("DRV.ACC"), "{error}");
        let error = select("947[60..70]").unwrap_err().to_string();
        assert!(
            error.ends_with("(r0947) has elements 0 to 63, element 64 does not exist"),
            "{error}"
        );
        let error = select("DRV.ACC[1]").unwrap_err().to_string();
        assert_eq!(error, "DRV.ACC (p2108) has no elements, element 1 does not exist");
    }

    #[test]
    fn one_parameter_in_every_spelling_of_its_vendor() {
        let of = |catalogue| {
            move |text: &str| {
                let drive = Parameters {
                    catalogue: Some(catalogue),
                    scaling: DELIVERED,
                };
                let found = drive
                    .select(&text.parse().unwrap())
                    .map_err(|error| error.to_string());
                found.map(|found| (found.pnu, found.first, found.label()))
            }
        };
        let vlt = of(&VLT);
        for text in ["1-20", "120", "p120", "PNU 120", "motor-power-kw"] {
            assert_eq!(
                vlt(text),
                Ok((120, 0, "Motor Power [kW] (1-20)".into())),
                "{text}"
            );
        }
        assert_eq!(
            vlt("15-30[1]"),
            Ok((1530, 1, "Fault Log: Error Code (15-30[1])".into()))
        );
        let vacon = of(&VACON);
        for text in [
            "ID 103",
            "ID103",
            "103",
            "id103",
            "10001[103]",
            "acceleration-time-1",
        ] {
            let expected = (10001, 103, "Acceleration time 1 (ID 103)".into());
            assert_eq!(vacon(text), Ok(expected), "{text}");
        }
        assert_eq!(vacon("930"), Ok((930, 0, "Operating mode (r0930)".into())));
        assert_eq!(vacon("p103").unwrap().0, 103);
        assert_eq!(vacon("ID 3333"), Ok((10001, 3333, "ID 3333".into())));
        assert_eq!(vacon("947[2]"), Ok((947, 2, "Fault numbers (r0947[2])".into())));
        let error = vacon("p10001").unwrap_err();
        assert!(
            error.contains("say which") && error.contains("10001[103]"),
            "{error}"
        );
        let several = vacon("10001[101..103]").unwrap();
        assert_eq!((several.0, several.1), (10001, 101));
        assert!(vlt("1-20[1]").unwrap_err().contains("has no elements"));
    }

    #[test]
    fn a_drive_without_tables_goes_by_number() {
        let plain = Parameters {
            catalogue: None,
            scaling: Scaling::DELIVERED,
        };
        let selection = plain.select(&"947[0..7]".parse().unwrap()).unwrap();
        assert_eq!(
            (selection.label(), selection.writable()),
            ("0947[0..7]".into(), None)
        );
        assert!(matches!(
            plain.select(&"DRV.ACC".parse().unwrap()),
            Err(ParameterProblem::NoNames { .. })
        ));
    }
}

//! From what a person wrote to parameter number and elements.

use profidrive::catalogue::{Access, Parameter};
use profidrive::notation::{Elements, ParameterReference, Shown, Target};

use super::{ParameterProblem, Parameters};

/// One parameter and a run of its elements, found in the tables where there are any.
#[derive(Debug, Clone, Copy)]
pub struct Selection {
    /// Parameter number.
    pub pnu: u16,
    /// First element, 0 for a parameter that is no array.
    pub first: u16,
    /// How many elements, at least 1.
    pub count: u16,
    /// True when elements are told apart: an array, or an index was given.
    pub indexed: bool,
    /// What the tables say.
    pub parameter: Option<&'static Parameter>,
}

impl Selection {
    /// All of one parameter of the tables.
    #[must_use]
    pub fn of(parameter: &'static Parameter) -> Self {
        Self {
            pnu: parameter.pnu,
            first: 0,
            count: parameter.elements.max(1),
            indexed: parameter.is_array(),
            parameter: Some(parameter),
        }
    }

    /// True when it can be written, as far as is known.
    #[must_use]
    pub fn writable(&self) -> Option<bool> {
        self.parameter
            .map(|parameter| parameter.access != Access::ReadOnly)
    }

    /// Number of element `offset` of the selection as printed: `p2108`, `r0947[3]`.
    #[must_use]
    pub fn shown(&self, offset: u16) -> Shown {
        let index = self.indexed.then(|| self.first.saturating_add(offset));
        Shown {
            pnu: self.pnu,
            index,
            writable: self.writable(),
        }
    }

    /// Number and name: `DRV.ACC (p2108)`.
    #[must_use]
    pub fn label(&self) -> String {
        let elements = Elements {
            first: self.first,
            count: self.count,
        };
        let shown = Shown {
            pnu: self.pnu,
            index: None,
            writable: self.writable(),
        };
        let elements = if self.indexed {
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
    /// table is passed on: the drive may know it.
    pub fn select(&self, reference: &ParameterReference) -> Result<Selection, ParameterProblem> {
        let (pnu, parameter) = match &reference.target {
            Target::Number(pnu) => (*pnu, self.catalogue.and_then(|tables| tables.by_pnu(*pnu))),
            Target::Name(name) => {
                let parameter = self.named(name)?;
                (parameter.pnu, Some(parameter))
            }
        };
        let size = parameter.map_or(u32::from(u16::MAX) + 1, |parameter| {
            u32::from(parameter.elements.max(1))
        });
        let array = parameter.is_some_and(Parameter::is_array);
        let elements = match reference.elements {
            Some(elements) => elements,
            None if array => Elements {
                first: 0,
                count: u16::try_from(size).unwrap_or(u16::MAX),
            },
            None => Elements::default(),
        };
        let count = elements.count.max(1);
        let selection = Selection {
            pnu,
            first: elements.first,
            count,
            indexed: array || (parameter.is_none() && reference.elements.is_some()),
            parameter,
        };
        if u32::from(elements.first) + u32::from(count) > size {
            let index = u32::from(elements.first).max(size);
            let whole = Selection {
                first: 0,
                count: 1,
                indexed: false,
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

    fn named(&self, name: &str) -> Result<&'static Parameter, ParameterProblem> {
        let Some(tables) = self.catalogue else {
            return Err(ParameterProblem::NoNames {
                name: name.to_owned(),
            });
        };
        tables.by_name(name).ok_or_else(|| ParameterProblem::Unknown {
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

#[cfg(test)]
mod tests {
    use super::*;
    use profidrive::catalogue::{AKD, Scaling};

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

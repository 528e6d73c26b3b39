//! Names that mean the same on the drives of every vendor: `ramp-up`, `max-speed`, `current-limit`.

use super::generated_names::NAMES;
use super::{Catalogue, Parameter, Part};

/// A name for what parameters of several vendors have in common, one row of `data/profile/names.csv`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct CommonName {
    /// The name.
    pub name: &'static str,
    /// What such a parameter is; the first part that a model has counts.
    pub parts: &'static [Part],
    /// What the parameter sets or shows.
    pub about: &'static str,
}

impl CommonName {
    /// Every common name.
    pub const ALL: &'static [Self] = NAMES;

    /// Returns the parameter of a model that has this name; `None` where the model has no such parameter.
    #[must_use]
    pub fn parameter(&self, tables: &Catalogue) -> Option<&'static Parameter> {
        self.parts.iter().find_map(|part| tables.part(*part))
    }
}

impl Catalogue {
    /// Returns the parameter that a common name means on this model; case does not matter. Value and unit are those of the
    /// vendor's parameter: a ramp is an acceleration on one drive and a time on another.
    ///
    /// ```
    /// use profidrive_profile::catalogue::{AKD, VACON, VLT};
    /// let ramp = |tables: &profidrive_profile::catalogue::Catalogue| {
    ///     let ramp = tables.by_common_name("ramp-up").unwrap();
    ///     (ramp.name, ramp.unit)
    /// };
    /// assert_eq!(ramp(&AKD), ("DRV.ACC", "rpm/s"));
    /// assert_eq!(ramp(&VLT), ("Ramp 1 Ramp up Time", "s"));
    /// assert_eq!(ramp(&VACON), ("Acceleration time 1", "s"));
    /// assert!(AKD.by_common_name("motor-poles").is_none());
    /// ```
    #[must_use]
    pub fn by_common_name(&self, name: &str) -> Option<&'static Parameter> {
        let mut names = NAMES.iter();
        names
            .find(|common| common.name.eq_ignore_ascii_case(name))?
            .parameter(self)
    }

    /// Returns the common names of a parameter of this model.
    pub fn common_names(&self, parameter: &Parameter) -> impl Iterator<Item = &'static CommonName> {
        NAMES.iter().filter(|common| {
            let meant = common.parameter(self);
            meant.is_some_and(|meant| (meant.pnu, meant.base) == (parameter.pnu, parameter.base))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::super::{AKD, VACON, VLT};
    use super::*;

    #[test]
    fn no_common_name_hides_or_is_hidden_by_another_parameter() {
        for tables in [&AKD, &VLT, &VACON] {
            for common in NAMES {
                let (Some(own), Some(meant)) = (tables.by_name(common.name), common.parameter(tables)) else {
                    continue;
                };
                assert_eq!(own.name, meant.name, "{} of the {}", common.name, tables.model);
            }
        }
    }

    #[test]
    fn ramps_speeds_and_currents_have_one_name_on_every_model() {
        for name in [
            "ramp-up",
            "ramp-down",
            "max-speed",
            "current-limit",
            "jog-speed",
            "speed",
            "current",
        ] {
            for tables in [&AKD, &VLT, &VACON] {
                assert!(
                    tables.by_common_name(name).is_some(),
                    "{name} of the {}",
                    tables.model
                );
            }
        }
        assert_eq!(AKD.by_common_name("Current-Limit").unwrap().name, "IL.LIMITP");
        assert_eq!(VACON.by_common_name("jog-speed").unwrap().unit, "Hz");
        assert_eq!(VLT.by_common_name("max-speed").unwrap().pnu, 413);
    }
}

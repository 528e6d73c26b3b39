//! Set-ups: several sets of the ordinary parameters, one of which is active (VLT 0-10, 0-11, 0-51).
//!
//! A parameter selects the active one, or, with one of its values, the control word does. Another parameter says which
//! one is read and written; the factory set-up cannot be written. Source: FC 300 programming guide 0-1*, from memory;
//! control word bits 13 and 14: FC 300 design guide. Which parameters belong to a set-up no source at hand lists: here
//! they are those of motor, brakes, references, ramps and limits. That a running motor changes between set-ups only
//! when their motor data are the same is our reading of 0-12.

use profile::catalogue::{Access, Part};
use profile::parameter::ErrorNumber;
use profile::pkw::PkwErrorNumber;

use super::Drive;
use crate::model::{Live, Model};
use crate::store::{Image, Values, key};

/// Set-ups 1 to 4, and the factory set-up in the place of 0.
const COUNT: usize = 5;

/// The values of all set-ups.
#[derive(Debug, Clone)]
pub(super) struct SetUps {
    model: &'static Model,
    /// Numbers of the parameters that choose the active set-up and the edited one.
    active_by: u16,
    edited_by: u16,
    /// Number of the parameter that lets the control word choose, and its values with which it does.
    site: Option<u16>,
    by_bus: &'static [i64],
    /// Places in the catalogue and elements of what each set-up has for itself, ascending.
    places: Box<[(usize, u16)]>,
    /// Their values; those of the active set-up are in the values of the drive.
    banks: [Box<[i64]>; COUNT],
    active: usize,
}

impl SetUps {
    /// As delivered: all alike, the first one active.
    pub fn new(model: &'static Model, live: &[Live]) -> Option<Self> {
        let [first, last] = model.converter?.own_in_set_up;
        let active_by = model.number(Part::ActiveSetUp)?;
        let edited_by = model.number(Part::EditedSetUp)?;
        let parameters = model.catalogue.parameters;
        let own = parameters
            .iter()
            .zip(live)
            .enumerate()
            .filter(|(_, (parameter, live))| {
                let stored = **live == Live::Stored && parameter.access == Access::ReadWrite;
                stored && parameter.length == 0 && (first..=last).contains(&parameter.pnu)
            });
        let places: Box<[_]> = own
            .flat_map(|(position, (parameter, _))| {
                let count = if parameter.is_array() {
                    parameter.elements
                } else {
                    1
                };
                (0..count).map(move |element| (position, element))
            })
            .collect();
        let fresh = Values::new(model.catalogue);
        let bank = || {
            places
                .iter()
                .map(|(position, element)| fresh.element_at(*position, *element))
        };
        Some(Self {
            model,
            active_by,
            edited_by,
            site: model.number(Part::SetUpSite),
            by_bus: model.catalogue.part_values(Part::SetUpSite),
            banks: std::array::from_fn(|_| bank().collect()),
            places,
            active: 1,
        })
    }

    fn place(&self, position: usize, element: u16) -> Option<usize> {
        self.places.binary_search(&(position, element)).ok()
    }

    fn bank(&self, number: usize) -> impl Iterator<Item = ((usize, u16), i64)> + '_ {
        let bank = self.banks.get(number).map(|bank| &bank[..]).unwrap_or_default();
        self.places.iter().copied().zip(bank.iter().copied())
    }

    /// Puts the values of a set-up into the place of the active one, which are put away.
    fn change(&mut self, number: usize, values: &mut Values) {
        self.put_away(values);
        for ((position, element), raw) in self.bank(number) {
            values.set_element_at(position, element, raw);
        }
        self.active = number;
    }

    fn put_away(&mut self, values: &Values) {
        if let Some(bank) = self.banks.get_mut(self.active) {
            for (raw, (position, element)) in bank.iter_mut().zip(&self.places) {
                *raw = values.element_at(*position, *element);
            }
        }
    }

    /// Returns whether a motor that runs may change to this set-up: nothing that holds while it runs is different.
    fn is_like(&self, number: usize, values: &Values) -> bool {
        self.bank(number)
            .filter(|((position, _), _)| self.model.is_only_stopped(*position))
            .all(|((position, element), raw)| values.element_at(position, element) == raw)
    }
}

/// A parameter of the factory set-up is written: 131 of the parameter channel (PKW).
const FACTORY: ErrorNumber = ErrorNumber(PkwErrorNumber::FACTORY_SET_UP.0);

/// What stands in a saved text before the key of a parameter of another set-up than the first.
const PREFIX: &str = "set-up ";

impl Drive {
    /// Returns the number of the active set-up: 1 to 4, 0 for the factory set-up; 1 where the model has
    /// none.
    #[must_use]
    pub fn set_up(&self) -> u8 {
        self.set_ups.as_ref().map_or(1, |set_ups| set_ups.active as u8)
    }

    /// Returns the number of the set-up that is read and written.
    fn edited(&self, set_ups: &SetUps) -> usize {
        let chosen = usize::try_from(self.values.get(set_ups.edited_by)).unwrap_or(COUNT);
        if chosen < COUNT { chosen } else { set_ups.active }
    }

    /// Returns the number of the other set-up that keeps the value that is meant, and the place there.
    fn elsewhere(&self, position: usize, element: u16) -> Option<(usize, usize)> {
        let set_ups = self.set_ups.as_ref()?;
        let place = set_ups.place(position, element)?;
        let edited = self.edited(set_ups);
        (edited != set_ups.active).then_some((edited, place))
    }

    /// Returns the value of a parameter that is kept.
    pub(super) fn stored(&self, position: usize, element: u16) -> i64 {
        let other = self.elsewhere(position, element).and_then(|(number, place)| {
            let bank = self.set_ups.as_ref()?.banks.get(number)?;
            bank.get(place).copied()
        });
        other.unwrap_or_else(|| self.values.element_at(position, element))
    }

    /// The factory set-up is the one that is written, and the parameter is one of those that each set-up has.
    pub(super) fn check_factory_set_up(&self, position: usize, element: u16) -> Result<(), ErrorNumber> {
        match &self.set_ups {
            Some(set_ups) if set_ups.place(position, element).is_some() && self.edited(set_ups) == 0 => {
                Err(FACTORY)
            }
            _ => Ok(()),
        }
    }

    /// Keeps a value that is inside its limits.
    pub(super) fn store(&mut self, position: usize, element: u16, raw: i64) -> Result<(), ErrorNumber> {
        let other = self.elsewhere(position, element).and_then(|(number, place)| {
            let bank = self.set_ups.as_mut()?.banks.get_mut(number)?;
            bank.get_mut(place)
        });
        if let Some(value) = other {
            *value = raw;
        } else if self.is_fixed(position) && self.values.element_at(position, element) != raw {
            return Err(ErrorNumber::NOT_NOW);
        } else {
            self.values.set_element_at(position, element, raw);
        }
        Ok(())
    }

    /// Returns whether the motor runs, and this cannot be changed meanwhile.
    fn is_fixed(&self, position: usize) -> bool {
        self.is_enabled() && self.model.is_only_stopped(position)
    }

    /// Returns the set-up that settings and control word request.
    fn wanted_set_up(&self, set_ups: &SetUps) -> usize {
        let chosen = self.values.get(set_ups.active_by);
        if let Some(number) = usize::try_from(chosen).ok().filter(|number| *number < COUNT) {
            return number;
        }
        let site = set_ups.site.map(|number| self.values.get(number));
        match self.orders.set_up {
            // the inputs, which choose otherwise, are all off
            _ if !site.is_some_and(|site| set_ups.by_bus.contains(&site)) => 1,
            Some(number) => usize::from(number) + 1,
            None => set_ups.active.max(1),
        }
    }

    /// Changes the set-up when another one is requested; true when it did, and then the settings are to be applied.
    /// Allocates nothing.
    pub(super) fn follow_set_up(&mut self) -> bool {
        let Some(set_ups) = &self.set_ups else {
            return false;
        };
        let wanted = self.wanted_set_up(set_ups);
        if wanted == set_ups.active || self.is_enabled() && !set_ups.is_like(wanted, &self.values) {
            return false;
        }
        if let Some(set_ups) = &mut self.set_ups {
            set_ups.change(wanted, &mut self.values);
        }
        true
    }

    /// Copies the set-up that is edited to another one, 0: to all.
    pub(super) fn copy_set_up(&mut self, to: u8) -> Result<(), ErrorNumber> {
        let enabled = self.is_enabled();
        let Some(set_ups) = &self.set_ups else {
            return Err(ErrorNumber::NOT_NOW);
        };
        let from = self.edited(set_ups);
        let targets = |number: usize| number > 0 && (to == 0 || number == usize::from(to));
        if enabled && targets(set_ups.active) {
            return Err(ErrorNumber::NOT_NOW);
        }
        if let Some(set_ups) = &mut self.set_ups {
            set_ups.put_away(&self.values);
            let Some(source) = set_ups.banks.get(from).cloned() else {
                return Err(ErrorNumber::NOT_NOW);
            };
            for (number, bank) in set_ups.banks.iter_mut().enumerate() {
                if targets(number) {
                    bank.clone_from(&source);
                }
            }
            if targets(set_ups.active) {
                for ((position, element), raw) in set_ups.bank(from) {
                    self.values.set_element_at(position, element, raw);
                }
            }
        }
        Ok(())
    }

    /// All set-ups as delivered, the first one active.
    pub(super) fn reset_set_ups(&mut self) {
        self.set_ups = SetUps::new(self.model, self.live);
    }

    /// Set-ups by a digit for each channel, from the right: panel, FC bus, USB, the option; A is the active one, F the
    /// factory one. Here one parameter is for all channels. Source: FC 300 programming guide 0-14, from memory.
    pub(super) fn edited_digits(&self) -> i64 {
        let Some(set_ups) = &self.set_ups else {
            return 0;
        };
        let digit = match self.values.get(set_ups.edited_by) {
            0 => 0xF,
            number @ 1..=4 => number,
            _ => 0xA,
        };
        i64::from((0xAAAA_0000_u32 | (digit as u32 * 0x1111)).cast_signed())
    }
}

/// What is kept.
impl Drive {
    /// Returns the values that stand without the number of a set-up: those of the first one.
    pub(super) fn first_set_up(&self) -> Values {
        let mut values = self.values.clone();
        if let Some(set_ups) = self.set_ups.as_ref().filter(|set_ups| set_ups.active != 1) {
            for ((position, element), raw) in set_ups.bank(1) {
                values.set_element_at(position, element, raw);
            }
        }
        values
    }

    /// Adds what is not as delivered in set-ups 2 to 4.
    pub(super) fn push_set_ups(&self, image: &mut Image) {
        let Some(set_ups) = &self.set_ups else {
            return;
        };
        let catalogue = self.model.catalogue;
        for number in 2..COUNT {
            for (((position, element), kept), (_, fresh)) in set_ups.bank(number).zip(set_ups.bank(0)) {
                let raw = if set_ups.active == number {
                    self.values.element_at(position, element)
                } else {
                    kept
                };
                if raw != fresh
                    && let Some(parameter) = catalogue.parameters.get(position)
                {
                    let name = format!("{PREFIX}{number} {}", key(catalogue, position, element));
                    image.push_as(&name, parameter, raw, &catalogue.scaling);
                }
            }
        }
    }

    /// Puts a value of set-ups 2 to 4 back; false when the line is none.
    pub(super) fn take_set_up_line(&mut self, image: &Image, name: &str, text: &str) -> bool {
        let catalogue = self.model.catalogue;
        let Some((number, name)) = name.strip_prefix(PREFIX).and_then(|rest| rest.split_once(' ')) else {
            return false;
        };
        let number = number.parse().ok().filter(|number| (2..COUNT).contains(number));
        let (Some(number), Some(set_ups)) = (number, &mut self.set_ups) else {
            return false;
        };
        let mut places = set_ups.places.iter();
        let place = places.position(|(position, element)| key(catalogue, *position, *element) == name);
        let Some(place) = place else {
            return false;
        };
        let value = set_ups.places.get(place).and_then(|(position, _)| {
            let parameter = catalogue.parameters.get(*position)?;
            let raw = image.number(parameter, text, &catalogue.scaling)?;
            let (low, high) = parameter.raw_limits(&catalogue.scaling);
            (low..=high).contains(&raw).then_some(raw)
        });
        let kept = set_ups.banks.get_mut(number).and_then(|bank| bank.get_mut(place));
        match (kept, value) {
            (Some(kept), Some(raw)) => {
                *kept = raw;
                true
            }
            _ => false,
        }
    }

    /// Returns the text of a saved value.
    pub(super) fn saved_key(&self, position: usize, element: u16) -> String {
        let key = key(self.model.catalogue, position, element);
        let number = self.set_ups.as_ref().and_then(|set_ups| {
            set_ups.place(position, element)?;
            Some(self.edited(set_ups)).filter(|number| *number > 1)
        });
        match number {
            Some(number) => format!("{PREFIX}{number} {key}"),
            None => key,
        }
    }
}

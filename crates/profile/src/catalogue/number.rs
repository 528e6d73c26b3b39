//! From numbers to parameters: PNU and subindex on the wire, and numbers as the vendor writes them.

use alloc::format;
use alloc::string::String;
use alloc::vec;
use alloc::vec::Vec;

use super::{Catalogue, Device, Parameter, Scaling, compare};
use crate::notation::{Notation, Prefix, Shown};

impl Catalogue {
    /// Creates a catalogue made at run time, for example of what a drive reports of itself. It holds no faults and
    /// every parameter is a plain setting. Its tables live as long as the program: make one for each type of drive, not
    /// one for each connection.
    ///
    /// ```
    /// use profidrive_profile::catalogue::{AKD, Catalogue};
    /// let few = AKD.parameters.iter().take(3).copied().collect();
    /// let own = Catalogue::assemble("own", AKD.notation, AKD.scaling, AKD.device, few);
    /// assert_eq!(own.by_name("nsoll_a").unwrap().pnu, 5);
    /// ```
    #[must_use]
    pub fn assemble(
        model: &'static str,
        notation: Notation,
        scaling: Scaling,
        device: Device,
        mut parameters: Vec<Parameter>,
    ) -> Self {
        parameters.sort_by_key(|parameter| (parameter.pnu, parameter.base));
        parameters.dedup_by_key(|parameter| (parameter.pnu, parameter.base));
        parameters.truncate(usize::from(u16::MAX) - 1);
        let highest = parameters
            .last()
            .map_or(0, |parameter| usize::from(parameter.pnu));
        let mut index = vec![0_u16; highest + 1];
        for (place, parameter) in (1_u16..).zip(&parameters) {
            if let (None, Some(cell)) = (parameter.base, index.get_mut(usize::from(parameter.pnu))) {
                *cell = place;
            }
        }
        let mut names: Vec<u16> = (0_u16..).take(parameters.len()).collect();
        let name = |position: &u16| {
            parameters
                .get(usize::from(*position))
                .map_or("", |found| found.name)
        };
        names.sort_by(|a, b| compare(name(a), name(b)));
        Self {
            model,
            notation,
            scaling,
            parameters: parameters.leak(),
            faults: &[],
            device,
            backup: &[],
            parts: &[],
            words: &[],
            not_now: &[],
            index: index.leak(),
            names: names.leak(),
        }
    }

    /// Returns the parameter with this number. Takes constant time. An element of a collecting number has none of its
    /// own: [`by_address`](Self::by_address).
    #[must_use]
    pub fn by_pnu(&self, pnu: u16) -> Option<&'static Parameter> {
        self.position(pnu)
            .and_then(|position| self.parameters.get(position))
    }

    /// Returns the index in [`parameters`](Self::parameters) of the parameter with this number, in constant time.
    #[must_use]
    pub fn position(&self, pnu: u16) -> Option<usize> {
        usize::from(*self.index.get(usize::from(pnu))?).checked_sub(1)
    }

    /// Returns the index in [`parameters`](Self::parameters) for a PNU and a subindex on the wire,
    /// and which element of it. That it has such an element is not checked.
    ///
    /// ```
    /// use profidrive_profile::catalogue::{VACON, VLT};
    /// let (position, element) = VLT.place(1530, 1).unwrap();
    /// assert_eq!((VLT.parameters[position].pnu, element), (1530, 1));
    /// let (position, element) = VACON.place(10001, 103).unwrap();
    /// assert_eq!((VACON.parameters[position].name, element), ("Acceleration time 1", 0));
    /// assert_eq!(VACON.place(10001, 20_000), None);
    /// ```
    #[must_use]
    pub fn place(&self, pnu: u16, subindex: u16) -> Option<(usize, u16)> {
        if let Some(position) = self.position(pnu) {
            return Some((position, subindex));
        }
        // the last element of the collecting number that does not begin behind the subindex
        let after = self
            .parameters
            .partition_point(|parameter| (parameter.pnu, parameter.base) <= (pnu, Some(subindex)));
        let position = after.checked_sub(1)?;
        let parameter = self.parameters.get(position)?;
        let element = subindex.checked_sub(parameter.base?)?;
        (parameter.pnu == pnu && element < parameter.elements.max(1)).then_some((position, element))
    }

    /// Returns the parameter that a PNU and a subindex on the wire mean.
    #[must_use]
    pub fn at(&self, pnu: u16, subindex: u16) -> Option<&'static Parameter> {
        self.parameters.get(self.place(pnu, subindex)?.0)
    }

    /// Returns the parameter with this number and [`base`](Parameter::base).
    #[must_use]
    pub fn by_address(&self, pnu: u16, base: Option<u16>) -> Option<&'static Parameter> {
        let key = |parameter: &Parameter| (parameter.pnu, parameter.base);
        let found = self.parameters.binary_search_by_key(&(pnu, base), key).ok()?;
        self.parameters.get(found)
    }

    /// Returns true for a number whose elements are parameters of their own, as PNU 10001 of a Vacon.
    #[must_use]
    pub fn is_collecting(&self, pnu: u16) -> bool {
        let start = self.parameters.partition_point(|parameter| parameter.pnu < pnu);
        let found = self.parameters.get(start);
        found.is_some_and(|parameter| parameter.pnu == pnu && parameter.base.is_some())
    }

    /// Returns the 64-bit parameter whose high half has this number.
    #[must_use]
    pub fn by_high(&self, pnu: u16) -> Option<&'static Parameter> {
        self.by_pnu(pnu.checked_sub(1)?)
            .filter(|parameter| parameter.high() == Some(pnu))
    }

    /// Every number of the model, ascending, each once: one for each parameter, two for 64-bit values, one for all the
    /// elements of a collecting number. That is what PNU 980 and following list.
    pub fn numbers(&self) -> impl Iterator<Item = u16> + use<> {
        let parameters = self.parameters;
        let first = move |position: &usize| {
            let before = position.checked_sub(1).and_then(|before| parameters.get(before));
            let number = |parameter: Option<&Parameter>| parameter.map(|parameter| parameter.pnu);
            number(before) != number(parameters.get(*position))
        };
        (0..parameters.len())
            .filter(first)
            .filter_map(|position| parameters.get(position))
            .flat_map(|parameter| [Some(parameter.pnu), parameter.high()])
            .flatten()
    }

    /// Returns the meaning of a number written by a person: the PNU, and the subindex where it is an element of a
    /// collecting number.
    ///
    /// Only where application ids are used (Vacon) a bare number can mean two things: it is an application id, but a
    /// PNU where the tables have that and no such id, where the profile has its numbers (900 to 999), and above 32767.
    /// `p930`, `r930` and `PNU 930` always are the PNU, `ID 930` always is the application id.
    ///
    /// ```
    /// use profidrive_profile::catalogue::{AKD, VACON};
    /// use profidrive_profile::notation::Prefix;
    /// assert_eq!(VACON.meant(103, None), (10001, Some(103)));
    /// assert_eq!(VACON.meant(930, None), (930, None));
    /// assert_eq!(VACON.meant(103, Some(Prefix::Writable)), (103, None));
    /// assert_eq!(AKD.meant(103, None), (103, None));
    /// ```
    #[must_use]
    pub fn meant(&self, number: u16, prefix: Option<Prefix>) -> (u16, Option<u16>) {
        let Notation::Id { pnu } = self.notation else {
            return (number, None);
        };
        let is_id = self.by_address(pnu, Some(number)).is_some();
        let is_number = self.by_pnu(number).is_some()
            || self.is_collecting(number)
            || matches!(number, 900..=999 | 0x8000..);
        if prefix.is_none() && (is_id || !is_number) {
            (pnu, Some(number))
        } else {
            (number, None)
        }
    }

    /// Returns a parameter as its vendor writes it: `DRV.ACC`, `1-20`, `ID 103`; what has no number of the vendor by
    /// its PNU.
    ///
    /// ```
    /// use profidrive_profile::catalogue::{AKD, VACON, VLT};
    /// assert_eq!(AKD.label(AKD.by_pnu(2108).unwrap()), "DRV.ACC");
    /// assert_eq!(VLT.label(VLT.by_pnu(120).unwrap()), "1-20");
    /// assert_eq!(VACON.label(VACON.at(10001, 103).unwrap()), "ID 103");
    /// assert_eq!(VACON.label(VACON.by_pnu(930).unwrap()), "r0930");
    /// ```
    #[must_use]
    pub fn label(&self, parameter: &Parameter) -> String {
        if self.notation == Notation::Name && !parameter.name.is_empty() {
            return parameter.name.into();
        }
        let shown = Shown {
            pnu: parameter.pnu,
            index: parameter.base,
            writable: Some(parameter.access != super::Access::ReadOnly),
            notation: self.notation,
        };
        format!("{shown}")
    }
}

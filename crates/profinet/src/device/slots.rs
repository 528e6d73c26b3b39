//! What is plugged, and how it differs from what a controller expects.

use alloc::vec::Vec;

use super::config::{DeviceConfig, ModuleDescription, SubmoduleDescription};
use crate::wire::block::{
    DiffModule, DiffSubmodule, ExpectedModule, ExpectedSubmodule, ModuleDiff, ModuleState, SubmoduleState,
};
use crate::wire::record::{Identification, IdentifiedModule, IdentifiedSubmodule};

/// The slots that hold a module: slot number and place in the catalogue, in slot order.
#[derive(Debug, Clone)]
pub(super) struct Slots {
    plugged: Vec<(u16, usize)>,
}

impl Slots {
    pub(super) fn new(config: &DeviceConfig) -> Self {
        let mut slots = Self { plugged: Vec::new() };
        for (slot, ident) in &config.plugged {
            slots.plug(&config.modules, *slot, *ident);
        }
        slots
    }

    /// Plugs a module of the catalogue if it fits there.
    pub(super) fn plug(&mut self, catalogue: &[ModuleDescription], slot: u16, ident: u32) -> bool {
        let Some(index) = catalogue
            .iter()
            .position(|m| m.ident == ident && m.slots.contains(&slot))
        else {
            return false;
        };
        self.put(slot, index);
        true
    }

    fn put(&mut self, slot: u16, index: usize) {
        match self.plugged.binary_search_by_key(&slot, |(slot, _)| *slot) {
            Ok(at) => {
                if let Some(place) = self.plugged.get_mut(at) {
                    place.1 = index;
                }
            }
            Err(at) => self.plugged.insert(at, (slot, index)),
        }
    }

    /// Plugs the expected module if it fits there; of several with this ident, which differ in their submodules, the
    /// one that is most like what is expected.
    fn plug_expected(
        &mut self,
        catalogue: &[ModuleDescription],
        expected: &[ExpectedModule],
        slot: u16,
        ident: u32,
    ) {
        let alike = |real: &ModuleDescription| {
            let here = expected.iter().filter(|module| module.slot == slot);
            let submodules = here.flat_map(|module| module.submodules.iter().map(|s| (module.api, s)));
            submodules
                .filter(|(api, submodule)| compare(real, *api, submodule).is_none())
                .count()
        };
        let fitting = catalogue
            .iter()
            .enumerate()
            .filter(|(_, module)| module.ident == ident && module.slots.contains(&slot));
        // the first of equals
        let best = fitting.rev().max_by_key(|(_, module)| alike(module));
        if let Some((index, _)) = best {
            self.put(slot, index);
        }
    }

    pub(super) fn iter<'a>(
        &'a self,
        catalogue: &'a [ModuleDescription],
    ) -> impl Iterator<Item = (u16, &'a ModuleDescription)> {
        self.plugged
            .iter()
            .filter_map(|(slot, index)| Some((*slot, catalogue.get(*index)?)))
    }

    pub(super) fn module<'a>(
        &self,
        catalogue: &'a [ModuleDescription],
        slot: u16,
    ) -> Option<&'a ModuleDescription> {
        let (_, index) = self.plugged.iter().find(|(used, _)| *used == slot)?;
        catalogue.get(*index)
    }

    pub(super) fn submodule<'a>(
        &self,
        catalogue: &'a [ModuleDescription],
        slot: u16,
        subslot: u16,
    ) -> Option<&'a SubmoduleDescription> {
        self.module(catalogue, slot)?
            .submodules
            .iter()
            .find(|s| s.subslot == subslot)
    }

    /// Returns all APIs that have a submodule, ascending.
    pub(super) fn apis(&self, catalogue: &[ModuleDescription]) -> Vec<u32> {
        let mut apis: Vec<u32> = self
            .iter(catalogue)
            .flat_map(|(_, module)| module.submodules.iter().map(|s| s.api))
            .collect();
        apis.sort_unstable();
        apis.dedup();
        apis
    }

    /// Returns the plugged modules accepted by `keep`, by API and slot.
    pub(super) fn identification(
        &self,
        catalogue: &[ModuleDescription],
        keep: impl Fn(u16, &SubmoduleDescription) -> bool,
    ) -> Identification {
        let mut result = Identification::default();
        for api in self.apis(catalogue) {
            for (slot, module) in self.iter(catalogue) {
                let chosen = module.submodules.iter().filter(|s| s.api == api && keep(slot, s));
                let submodules: Vec<_> = chosen
                    .map(|s| IdentifiedSubmodule {
                        subslot: s.subslot,
                        ident: s.ident,
                    })
                    .collect();
                if !submodules.is_empty() {
                    result.modules.push(IdentifiedModule {
                        api,
                        slot,
                        ident: module.ident,
                        submodules,
                    });
                }
            }
        }
        result
    }

    /// Plugs what a controller expects where the catalogue allows it, and returns the differences; for the slots
    /// `always_listed` also the matching submodules.
    pub(super) fn adapt(
        &mut self,
        catalogue: &[ModuleDescription],
        expected: &[ExpectedModule],
        always_listed: &[u16],
    ) -> ModuleDiff {
        for module in expected {
            self.plug_expected(catalogue, expected, module.slot, module.ident);
        }
        let mut diff = ModuleDiff::default();
        for module in expected {
            let real = self.module(catalogue, module.slot);
            let (state, submodules) = match real {
                None => (ModuleState::NO_MODULE, Vec::new()),
                Some(real) if real.ident != module.ident => (ModuleState::WRONG, Vec::new()),
                Some(real) => {
                    let listed = always_listed.contains(&module.slot);
                    let different: Vec<_> = module
                        .submodules
                        .iter()
                        .filter_map(|s| {
                            compare(real, module.api, s).or(listed.then_some(DiffSubmodule {
                                subslot: s.subslot,
                                ident: s.ident,
                                state: SubmoduleState::SUBSTITUTE,
                            }))
                        })
                        .collect();
                    if different.is_empty() {
                        continue;
                    }
                    (ModuleState::PROPER, different)
                }
            };
            let ident = real.map_or(0, |real| real.ident);
            diff.modules.push(DiffModule {
                api: module.api,
                slot: module.slot,
                ident,
                state,
                submodules,
            });
        }
        // the block names every API once
        diff.modules.sort_by_key(|module| module.api);
        diff
    }
}

/// Returns the difference between an expected submodule and the real one; a wrong length counts as a wrong submodule.
fn compare(real: &ModuleDescription, api: u32, expected: &ExpectedSubmodule) -> Option<DiffSubmodule> {
    let subslot = expected.subslot;
    let Some(submodule) = real.submodules.iter().find(|s| s.subslot == subslot) else {
        return Some(DiffSubmodule {
            subslot,
            ident: 0,
            state: SubmoduleState::NO_SUBMODULE,
        });
    };
    let same = submodule.ident == expected.ident
        && submodule.api == api
        && submodule.input_length == expected.input_length()
        && submodule.output_length == expected.output_length();
    (!same).then_some(DiffSubmodule {
        subslot,
        ident: submodule.ident,
        state: SubmoduleState::WRONG,
    })
}

/// Returns true if this submodule is unusable according to the difference.
pub(super) fn differs(diff: &ModuleDiff, slot: u16, subslot: u16) -> bool {
    diff.modules.iter().filter(|m| m.slot == slot).any(|module| {
        let unusable = |s: &DiffSubmodule| s.subslot == subslot && !s.state.is_usable();
        module.state != ModuleState::PROPER || module.submodules.iter().any(unusable)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::wire::block::Block;
    use crate::wire::{Reader, Writer as _};
    use alloc::vec;

    #[test]
    fn of_modules_with_one_ident_the_one_like_the_expected_is_plugged() {
        let submodule = |subslot, ident, octets| SubmoduleDescription {
            subslot,
            ident,
            api: 0x3A00,
            input_length: octets,
            output_length: octets,
        };
        let variant = |telegram, octets| ModuleDescription {
            ident: 0x100,
            slots: vec![1],
            submodules: vec![submodule(1, 0xFFFF, 0), submodule(2, telegram, octets)],
        };
        let catalogue = [variant(0x65, 4), variant(0x66, 4), variant(0x68, 12)];
        let mut slots = Slots {
            plugged: vec![(1, 0)],
        };
        let expected = |ident, octets| {
            [ExpectedModule {
                api: 0x3A00,
                slot: 1,
                ident: 0x100,
                properties: 0,
                submodules: vec![
                    ExpectedSubmodule::new(1, 0xFFFF, 0, 0),
                    ExpectedSubmodule::new(2, ident, octets, octets),
                ],
            }]
        };
        for (ident, octets, index) in [(0x68, 12, 2), (0x66, 4, 1), (0x65, 4, 0)] {
            assert!(
                slots
                    .adapt(&catalogue, &expected(ident, octets), &[])
                    .modules
                    .is_empty()
            );
            assert_eq!(slots.plugged, [(1, index)]);
        }
        // none fits: the first, and the difference is reported
        let diff = slots.adapt(&catalogue, &expected(0x69, 4), &[]);
        assert_eq!((slots.plugged[0], diff.modules[0].submodules.len()), ((1, 0), 1));
    }

    #[test]
    fn a_difference_names_every_api_once() {
        let expected = |api, slot| ExpectedModule {
            api,
            slot,
            ident: 7,
            properties: 0,
            submodules: vec![ExpectedSubmodule::new(1, 7, 0, 0)],
        };
        let expected = [expected(0, 1), expected(0x3A00, 2), expected(0, 3)];
        let diff = Slots { plugged: vec![] }.adapt(&[], &expected, &[]);
        let mut out = Vec::new();
        diff.encode(&mut out);
        let apis = Block::decode(&mut Reader::new(&out)).unwrap().body.u16("APIs");
        assert_eq!(apis, Ok(2));
        assert_eq!(out.position(), 6 + 2 + 2 * 6 + 3 * 10);
        let slots: Vec<u16> = diff.modules.iter().map(|module| module.slot).collect();
        assert_eq!(slots, [1, 3, 2]);
    }
}

//! The modules of a drive as they really are: ident numbers are the vendor's, and no table is sure to have them.

use profile::catalogue::{Device, TelegramModule};
use profinet::controller::{ModuleConfig, RecordAddress, SubmoduleConfig};
use profinet::wire::Reader;
use profinet::wire::block::BlockType;
use profinet::wire::record::{Identification, IdentifiedModule, IdentifiedSubmodule, decode_apis, index};

use super::Session;
use crate::modules::{PLACE, UNKNOWN, VendorModule, modules_of, place_of};
use crate::{Drive, Error};
use profile::model::PROFIDRIVE_API;

/// Application processes of a device whose modules are read.
const MOST_APIS: usize = 16;

/// Plugged modules, as far as the device reports them (RealIdentificationData).
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub(super) struct Plugged {
    /// Slot 0.
    pub access_point: Option<IdentifiedModule>,
    /// The first module of the drive profile: it carries the telegram.
    pub drive: Option<IdentifiedModule>,
}

/// What to connect with.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Layout {
    pub modules: Vec<ModuleConfig>,
    /// Slot and subslot of the telegram.
    pub place: (u16, u16),
}

impl Session {
    /// Reads the plugged modules. Empty for a device that does not report them.
    pub(super) async fn plugged(&mut self, drive: &Drive) -> Result<Plugged, Error> {
        let own = self.modules_of(drive, 0, (0, 1)).await?;
        Ok(Plugged::new(
            own,
            self.modules_of(drive, PROFIDRIVE_API, PLACE).await?,
        ))
    }

    /// Returns the modules that are plugged, of all application processes; empty when the device does not report them.
    ///
    /// # Errors
    /// When the device cannot be reached.
    pub async fn modules(&mut self, drive: &Drive) -> Result<Vec<IdentifiedModule>, Error> {
        if drive.is_on_line() {
            return Ok(Vec::new());
        }
        let at = RecordAddress {
            api: 0,
            slot: 0,
            subslot: 1,
            index: index::API_DATA,
        };
        let apis = match self.read_record(drive, at).await {
            Ok(data) => decode_apis(Reader::new(&data)).unwrap_or_default(),
            Err(Error::Record { .. }) => Vec::new(),
            Err(error) => return Err(error),
        };
        let apis = if apis.is_empty() {
            vec![0, PROFIDRIVE_API]
        } else {
            apis
        };
        let mut modules = Vec::new();
        for api in apis.into_iter().take(MOST_APIS) {
            let place = if api == 0 { (0, 1) } else { PLACE };
            modules.extend(self.modules_of(drive, api, place).await?);
        }
        modules.sort_by_key(|module| (module.slot, module.api));
        Ok(modules)
    }

    async fn modules_of(
        &mut self,
        drive: &Drive,
        api: u32,
        (slot, subslot): (u16, u16),
    ) -> Result<Vec<IdentifiedModule>, Error> {
        let at = RecordAddress {
            api,
            slot,
            subslot,
            index: index::REAL_IDENTIFICATION_API,
        };
        match self.read_record(drive, at).await {
            Ok(data) => Ok(modules_in(&data, api)),
            Err(Error::Record { .. }) => Ok(Vec::new()),
            Err(error) => Err(error),
        }
    }
}

/// Returns the modules of one API in RealIdentificationData.
pub(super) fn modules_in(data: &[u8], api: u32) -> Vec<IdentifiedModule> {
    let found = Identification::decode(&mut Reader::new(data), BlockType::REAL_IDENTIFICATION);
    let modules = found.map_or_else(|_| Vec::new(), |found| found.modules);
    modules.into_iter().filter(|module| module.api == api).collect()
}

impl Plugged {
    /// From the modules of API 0 and of the drive profile.
    pub(super) fn new(own: Vec<IdentifiedModule>, profile: Vec<IdentifiedModule>) -> Self {
        Self {
            access_point: own.into_iter().find(|module| module.slot == 0),
            drive: profile.into_iter().find(|module| !module.submodules.is_empty()),
        }
    }

    /// Returns the modules of a connection for records: the plugged ones, so that nothing changes. `None` when slot 0
    /// is unknown. The module of the drive is left out when the length of its data is unknown.
    pub(super) fn for_records(
        &self,
        device: Option<&Device>,
        vendor_modules: &[VendorModule],
    ) -> Option<Vec<ModuleConfig>> {
        let of_tables = device.map(|device| ModuleConfig {
            api: 0,
            slot: 0,
            ident: device.access_point_module,
            submodules: device
                .access_point()
                .map(|(subslot, ident)| plain(subslot, ident))
                .collect(),
        });
        let mut access_point = of_tables.or_else(|| {
            self.access_point.as_ref().map(|module| ModuleConfig {
                api: 0,
                slot: 0,
                ident: module.ident,
                submodules: Vec::new(),
            })
        })?;
        self.take_access_point(&mut access_point);
        let mut modules = vec![access_point];
        if let Some(module) = &self.drive {
            modules.extend(known_module(device, vendor_modules, module));
        }
        Some(modules)
    }

    /// Returns the telegram that is plugged, where the tables have its module.
    pub(super) fn telegram(&self, device: &Device) -> Option<u16> {
        let module = self.drive.as_ref().filter(|module| is_ours(device, module))?;
        device
            .telegram_of_module(module.ident)
            .map(|known| known.telegram)
    }

    /// Returns the modules to connect with: the tables' where the drive has those, else the ones that are plugged.
    /// `None` when the telegram wanted is not the one plugged and its ident number is not known. Of a drive without
    /// tables no ident number is; where it does not report which telegram is plugged either, telegram 1 is tried.
    pub(super) fn layout(
        &self,
        device: &Device,
        telegram: &TelegramModule,
        reported: Option<u16>,
    ) -> Option<Layout> {
        let data = |subslot, ident| SubmoduleConfig {
            subslot,
            ident,
            input_length: telegram.inputs,
            output_length: telegram.outputs,
        };
        let mut modules = modules_of(device, telegram);
        let [access_point, drive] = modules.as_mut_slice() else {
            return None;
        };
        self.take_access_point(access_point);
        let known = telegram.module != UNKNOWN;
        if !known && (self.access_point.is_none() || self.drive.is_none()) {
            return None;
        }
        let reported = reported.or((!known).then_some(telegram.telegram));
        let place = match self.drive.as_ref().filter(|module| !is_ours(device, module)) {
            None => place_of(device),
            Some(_) if reported != Some(telegram.telegram) => return None,
            Some(module) => {
                // where parameter access has a submodule of its own, it comes first
                let carrier = module.submodules.get(1).or(module.submodules.first())?.subslot;
                let submodules = module.submodules.iter().map(|submodule| {
                    if submodule.subslot == carrier {
                        data(submodule.subslot, submodule.ident)
                    } else {
                        plain(submodule.subslot, submodule.ident)
                    }
                });
                *drive = ModuleConfig {
                    api: PROFIDRIVE_API,
                    slot: module.slot,
                    ident: module.ident,
                    submodules: submodules.collect(),
                };
                (module.slot, carrier)
            }
        };
        Some(Layout { modules, place })
    }

    /// Returns the modules of a telegram by the device description of the vendor, if that has one as long and the drive
    /// has not those of the tables.
    pub(super) fn layout_of(
        &self,
        vendor_modules: &[VendorModule],
        device: &Device,
        telegram: &TelegramModule,
    ) -> Option<Layout> {
        if self.drive.as_ref().is_some_and(|module| is_ours(device, module)) {
            return None;
        }
        let lengths = (telegram.outputs, telegram.inputs);
        let module = vendor_modules
            .iter()
            .find(|module| module.telegram == telegram.telegram && module.lengths() == lengths)?;
        let mut access_point = modules_of(device, telegram).into_iter().next()?;
        self.take_access_point(&mut access_point);
        Some(Layout {
            modules: [access_point]
                .into_iter()
                .chain(module.modules.iter().cloned())
                .collect(),
            place: module.place,
        })
    }

    /// Slot 0 is what is plugged there.
    fn take_access_point(&self, access_point: &mut ModuleConfig) {
        if let Some(module) = &self.access_point {
            access_point.ident = module.ident;
            let submodules = module.submodules.iter();
            access_point.submodules = submodules
                .map(|submodule| plain(submodule.subslot, submodule.ident))
                .collect();
        }
    }
}

/// Returns a plugged module with the lengths of its data, one entry for each API; empty where they are not known.
fn known_module(
    device: Option<&Device>,
    vendor_modules: &[VendorModule],
    module: &IdentifiedModule,
) -> Vec<ModuleConfig> {
    let has = |subslot, ident| {
        let same = |own: &&IdentifiedSubmodule| (own.subslot, own.ident) == (subslot, ident);
        module.submodules.iter().any(|own| same(&own))
    };
    let own = device.and_then(|device| {
        let carrier = device.layout.telegram;
        let mut telegrams = device.telegrams.iter();
        let own = telegrams.find(|own| own.module == module.ident && has(carrier, own.submodule))?;
        Some((carrier, own))
    });
    if let Some((carrier, telegram)) = own {
        let submodules = module.submodules.iter().map(|submodule| {
            let mut config = plain(submodule.subslot, submodule.ident);
            if submodule.subslot == carrier {
                (config.input_length, config.output_length) = (telegram.inputs, telegram.outputs);
            }
            config
        });
        return vec![ModuleConfig {
            api: module.api,
            slot: module.slot,
            ident: module.ident,
            submodules: submodules.collect(),
        }];
    }
    let plugged = vendor_modules.iter().find(|module_set| {
        let here = module_set
            .modules
            .iter()
            .filter(|config| config.slot == module.slot);
        let mut ours = here.filter(|config| config.api == module.api && config.ident == module.ident);
        ours.any(|config| config.submodules.iter().all(|sub| has(sub.subslot, sub.ident)))
    });
    plugged.map_or_else(Vec::new, |module_set| module_set.modules.clone())
}

/// Returns a submodule without cyclic data.
const fn plain(subslot: u16, ident: u32) -> SubmoduleConfig {
    SubmoduleConfig {
        subslot,
        ident,
        input_length: 0,
        output_length: 0,
    }
}

/// Returns true for a module of the tables: then its siblings are known too.
fn is_ours(device: &Device, module: &IdentifiedModule) -> bool {
    device.telegram_of_module(module.ident).is_some_and(|known| {
        let carries = |submodule: &IdentifiedSubmodule| {
            submodule.subslot == device.layout.telegram && submodule.ident == known.submodule
        };
        module.submodules.iter().any(carries)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use profile::catalogue::AKD;

    fn module(api: u32, slot: u16, ident: u32, submodules: &[(u16, u32)]) -> IdentifiedModule {
        IdentifiedModule {
            api,
            slot,
            ident,
            submodules: submodules
                .iter()
                .map(|&(subslot, ident)| IdentifiedSubmodule { subslot, ident })
                .collect(),
        }
    }

    #[test]
    fn tables_are_used_when_the_drive_has_their_modules_or_reports_none() {
        let device = &AKD.device;
        let nine = device.telegram(9).unwrap();
        let one = device.telegram(1).unwrap();
        let plugged = Plugged {
            access_point: None,
            drive: Some(module(0x3A00, 1, one.module, &[(1, one.submodule)])),
        };
        for plugged in [Plugged::default(), plugged] {
            let layout = plugged.layout(device, nine, Some(1)).unwrap();
            assert_eq!(layout.place, (1, 1));
            assert_eq!(layout.modules[1].ident, nine.module);
            assert_eq!(layout.modules[1].submodules[0].output_length, 20);
            assert_eq!(layout.modules[0].submodules.len(), 3);
        }
    }

    #[test]
    fn foreign_modules_are_used_as_they_are_plugged() {
        let device = &AKD.device;
        let plugged = Plugged {
            access_point: Some(module(
                0,
                0,
                0x77,
                &[(1, 0x78), (0x8000, 5), (0x8001, 6), (0x8002, 6)],
            )),
            drive: Some(module(0x3A00, 2, 0x9000, &[(1, 0x9001), (2, 0x9002)])),
        };
        let nine = device.telegram(9).unwrap();
        let layout = plugged.layout(device, nine, Some(9)).unwrap();
        assert_eq!(layout.place, (2, 2));
        let lengths: Vec<_> = layout
            .modules
            .iter()
            .flat_map(|module| &module.submodules)
            .map(|submodule| (submodule.ident, submodule.output_length, submodule.input_length))
            .collect();
        assert_eq!(
            lengths,
            [
                (0x78, 0, 0),
                (5, 0, 0),
                (6, 0, 0),
                (6, 0, 0),
                (0x9001, 0, 0),
                (0x9002, 20, 10)
            ]
        );
        // the ident number of another telegram is not known
        assert_eq!(plugged.layout(device, nine, Some(1)), None);
        assert_eq!(plugged.layout(device, nine, None), None);
        let empty = Plugged {
            drive: Some(module(0x3A00, 1, 0x9000, &[])),
            ..plugged
        };
        assert_eq!(empty.layout(device, nine, Some(9)), None);
    }
}

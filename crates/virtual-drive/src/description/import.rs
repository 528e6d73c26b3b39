//! Identity and modules from a vendor's device description.

use std::collections::BTreeMap;

use gsdml::{AccessPoint, Gsdml, Module, Submodule, SubmoduleRef};
use profile::catalogue::Catalogue;
use profinet::device::{Identity, ModuleDescription, ResetMode, SubmoduleDescription};
use thiserror::Error;

use super::mapping::{Found, telegram_of};
use super::{Description, TelegramModule};
use crate::model::Model;

/// Most modules of one virtual drive, and most submodules of one module.
const MOST_MODULES: usize = 512;
/// Most modules, submodules and access points of a file, and most references of an access point to modules: far more
/// than a drive has.
const MOST_ITEMS: usize = 4096;
/// Longest order number and name of a product.
const ORDER: usize = 20;
const STATION_TYPE: usize = 25;

/// A description made from a file, and what of the file was left out.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Import {
    /// Identity and modules.
    pub description: Description,
    /// What the virtual drive does not have, and why, in words.
    pub left_out: Vec<String>,
}

/// Why a device description does not fit a model.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum ImportError {
    /// It is not a device of the model's vendor.
    #[error("the file is that of vendor {found:#06x}, the {model} is one of vendor {expected:#06x}")]
    Vendor {
        /// The model.
        model: &'static str,
        /// Its vendor.
        expected: u16,
        /// Vendor of the file.
        found: u16,
    },
    /// No access point with this identifier.
    #[error("the file has no access point `{wanted}`; it has {}", there.join(", "))]
    AccessPoint {
        /// The identifier requested.
        wanted: String,
        /// Those of the file.
        there: Vec<String>,
    },
    /// No module carries a telegram of the model.
    #[error(
        "no module of the file carries a telegram of the {model}{}",
        reasons(left_out)
    )]
    NoTelegram {
        /// The model.
        model: &'static str,
        /// Why not, for each module.
        left_out: Vec<String>,
    },
    /// A module is named after a telegram but is not as long.
    #[error("module `{module}`: {reason}")]
    Contradiction {
        /// The module.
        module: String,
        /// What does not fit.
        reason: String,
    },
    /// A property that the virtual device cannot have.
    #[error("`{item}`: {reason}")]
    Unsupported {
        /// Identifier of what it is about.
        item: String,
        /// What it is.
        reason: String,
    },
}

fn reasons(left_out: &[String]) -> String {
    match left_out.first() {
        None => "; none has a submodule of the drive's API with data in both directions".to_owned(),
        Some(first) => format!("; {first}"),
    }
}

impl Description {
    /// Identity, modules and ident numbers as a vendor's file has them, for a drive that behaves like the model.
    ///
    /// Every access point of the file can be used by a controller, or only one when `access_point` names it. A module is
    /// that of a telegram by its name, by the signals its data items name or by lengths that only one telegram has.
    ///
    /// # Errors
    /// When the file is not one of the model's vendor, no module carries a telegram of the model, or one contradicts it.
    pub fn from_gsdml(
        gsdml: &Gsdml,
        model: &Model,
        access_point: Option<&str>,
    ) -> Result<Import, ImportError> {
        let (expected, found) = (model.catalogue.device.vendor_id, gsdml.identity.vendor_id);
        if found != expected {
            return Err(ImportError::Vendor {
                model: model.catalogue.model,
                expected,
                found,
            });
        }
        Self::under_the_name_of(gsdml, model, access_point)
    }

    /// Returns the same for a file of any vendor: a drive that goes by the name of another vendor and is the model
    /// inside. Of another vendor's modules those are taken that are as long as the model's telegrams.
    ///
    /// # Errors
    /// When no module carries a telegram of the model, or one of the model's own vendor contradicts it.
    pub fn under_the_name_of(
        gsdml: &Gsdml,
        model: &Model,
        access_point: Option<&str>,
    ) -> Result<Import, ImportError> {
        let catalogue = model.catalogue;
        let own = Self::of(model);
        let points: Vec<&AccessPoint> = gsdml
            .access_points
            .iter()
            .filter(|point| access_point.is_none_or(|wanted| point.id == wanted))
            .collect();
        let Some(first) = points.first() else {
            return Err(ImportError::AccessPoint {
                wanted: access_point.unwrap_or_default().to_owned(),
                there: gsdml.access_points.iter().map(|point| point.id.clone()).collect(),
            });
        };
        let references = gsdml.access_points.iter().map(|point| point.modules.len());
        let items = [
            gsdml.modules.len(),
            gsdml.submodules.len(),
            gsdml.access_points.len(),
            references.sum(),
        ];
        if let Some(items) = items.into_iter().find(|items| *items > MOST_ITEMS) {
            return Err(ImportError::Unsupported {
                item: first.id.clone(),
                reason: format!("a drive with {items} modules; at most {MOST_ITEMS} are taken"),
            });
        }
        let modules: BTreeMap<&str, &Module> = gsdml
            .modules
            .iter()
            .map(|module| (module.id.as_str(), module))
            .collect();
        let submodules = gsdml.submodules.iter();
        let mut reader = Reader {
            gsdml,
            submodules: submodules
                .map(|submodule| (submodule.id.as_str(), submodule))
                .collect(),
            catalogue,
            api: own.api,
            telegrams: Vec::new(),
            others: Vec::new(),
            left_out: Vec::new(),
        };
        let access_points = points
            .iter()
            .map(|point| slot_zero(point))
            .collect::<Result<Vec<_>, _>>()?;
        for point in &points {
            for reference in &point.modules {
                let slots = [&reference.fixed, &reference.used, &reference.allowed];
                let slot = slots.into_iter().find_map(gsdml::ValueList::first);
                let slot = slot
                    .and_then(|slot| u16::try_from(slot).ok())
                    .filter(|slot| *slot > 0);
                if let (Some(module), Some(slot)) = (modules.get(reference.target.as_str()), slot) {
                    reader.module(module, slot)?;
                }
            }
        }
        let Reader {
            telegrams,
            mut others,
            left_out,
            ..
        } = reader;
        if telegrams.is_empty() {
            return Err(ImportError::NoTelegram {
                model: catalogue.model,
                left_out,
            });
        }
        // a slot with a telegram has no other module from the start
        others.retain(|other| {
            !telegrams
                .iter()
                .any(|telegram| other.slots.contains(&telegram.slot))
        });
        let intervals = points.iter().map(|point| point.min_device_interval);
        let shortest = intervals.filter(|interval| *interval > 0).min();
        Ok(Import {
            description: Self {
                identity: identity(gsdml, first, &own.identity),
                access_points,
                telegrams,
                others,
                api: own.api,
                min_device_interval: shortest.unwrap_or(own.min_device_interval),
                reset_modes: reset_modes(first),
                // older files leave the attribute out though the device has them
                device_access: first.features.device_access != Some(false),
            },
            left_out,
        })
    }
}

/// Returns the identity of the drive in the file; revisions that are not numbers are those of the model.
fn identity(gsdml: &Gsdml, point: &AccessPoint, own: &Identity) -> Identity {
    let text = |text: &str, most: usize| -> String {
        let signs = text.chars().filter(|c| c.is_ascii_graphic() || *c == ' ');
        signs.take(most).collect()
    };
    let or = |found: String, own: &str| if found.is_empty() { own.to_owned() } else { found };
    let name = text(gsdml.text(point.info.name.as_ref()), STATION_TYPE);
    let order = text(point.info.order_number.as_deref().unwrap_or_default(), ORDER);
    let hardware = point.info.hardware.as_deref().unwrap_or_default();
    let software = software(point.info.software.as_deref().unwrap_or_default());
    let (software_prefix, software_revision) =
        software.unwrap_or((own.software_prefix, own.software_revision));
    Identity {
        vendor_id: gsdml.identity.vendor_id,
        device_id: gsdml.identity.device_id,
        instance: point.object_instance,
        station_type: or(name, &own.station_type),
        order_id: or(order, &own.order_id),
        hardware_revision: hardware.parse().unwrap_or(own.hardware_revision),
        software_prefix,
        software_revision,
        ..own.clone()
    }
}

/// `V1.17.0`, `V1.2`.
fn software(text: &str) -> Option<(char, [u8; 3])> {
    let mut signs = text.chars();
    let prefix = signs.next().filter(|c| "VRPUT".contains(*c))?;
    let mut numbers = signs.as_str().split('.').map(|part| part.trim().parse::<u8>());
    let mut next = || numbers.next().transpose().ok();
    let (major, minor, fix) = (next()??, next()?.unwrap_or(0), next()?.unwrap_or(0));
    Some((prefix, [major, minor, fix]))
}

/// Returns the resets of the file that a virtual drive has; that of the communication parameters is always there.
fn reset_modes(point: &AccessPoint) -> Vec<ResetMode> {
    let numbers = point.reset_modes.iter().take(16);
    let mut modes: Vec<ResetMode> = numbers
        .filter_map(|number| ResetMode::from_number(u16::try_from(number).ok()?))
        .collect();
    if !modes.contains(&ResetMode::Communication) {
        modes.push(ResetMode::Communication);
    }
    modes
}

/// Slot 0 with the submodules that are always there, the interface and its ports.
fn slot_zero(point: &AccessPoint) -> Result<ModuleDescription, ImportError> {
    let plain = |subslot, ident| SubmoduleDescription {
        subslot,
        ident,
        api: 0,
        input_length: 0,
        output_length: 0,
    };
    let mut submodules = Vec::new();
    for submodule in point.virtual_submodules.iter().take(MOST_MODULES) {
        submodules.extend(at_its_subslots(submodule)?);
        submodules.truncate(MOST_MODULES);
    }
    let interface = point.interface.iter();
    submodules.extend(interface.map(|interface| plain(interface.subslot, interface.ident)));
    submodules.extend(
        point
            .ports
            .iter()
            .take(MOST_MODULES)
            .map(|port| plain(port.subslot, port.ident)),
    );
    if submodules.is_empty() {
        return Err(ImportError::Unsupported {
            item: point.id.clone(),
            reason: "an access point without any submodule".to_owned(),
        });
    }
    Ok(ModuleDescription {
        ident: point.module_ident,
        slots: vec![0],
        submodules,
    })
}

/// Returns a virtual submodule at each of its subslots.
fn at_its_subslots(submodule: &Submodule) -> Result<Vec<SubmoduleDescription>, ImportError> {
    let subslots = submodule.fixed_in_subslots.iter().take(MOST_MODULES);
    subslots.map(|subslot| described(submodule, subslot)).collect()
}

fn described(submodule: &Submodule, subslot: u32) -> Result<SubmoduleDescription, ImportError> {
    let unsupported = |reason: String| ImportError::Unsupported {
        item: submodule.id.clone(),
        reason,
    };
    let (input, output) = submodule.lengths();
    if (submodule.io.iops_length, submodule.io.iocs_length) != (1, 1) {
        return Err(unsupported("status of more than one octet".to_owned()));
    }
    let length =
        |octets: u32| u16::try_from(octets).map_err(|_| unsupported(format!("{octets} octets of data")));
    Ok(SubmoduleDescription {
        subslot: u16::try_from(subslot).map_err(|_| unsupported(format!("subslot {subslot}")))?,
        ident: submodule.ident,
        api: submodule.api,
        input_length: length(input)?,
        output_length: length(output)?,
    })
}

/// Goes over the modules of a file.
struct Reader<'a> {
    gsdml: &'a Gsdml,
    /// Pluggable submodules by their identifiers.
    submodules: BTreeMap<&'a str, &'a Submodule>,
    catalogue: &'static Catalogue,
    api: u32,
    telegrams: Vec<TelegramModule>,
    others: Vec<ModuleDescription>,
    left_out: Vec<String>,
}

impl Reader<'_> {
    fn module(&mut self, module: &Module, slot: u16) -> Result<(), ImportError> {
        let count = module.virtual_submodules.len().max(module.submodules.len());
        if count > MOST_MODULES {
            return Err(ImportError::Unsupported {
                item: module.id.clone(),
                reason: format!("a module with {count} submodules"),
            });
        }
        let mut fixed: Vec<(u32, &Submodule)> = Vec::new();
        for submodule in &module.virtual_submodules {
            let subslots = submodule.fixed_in_subslots.iter().take(MOST_MODULES);
            fixed.extend(subslots.map(|subslot| (subslot, submodule)));
            fixed.truncate(MOST_MODULES);
        }
        let pluggable = |reference: &SubmoduleRef| {
            let submodule = self.submodules.get(reference.target.as_str()).copied();
            let subslots = [&reference.fixed, &reference.used, &reference.allowed];
            let subslot = subslots.into_iter().find_map(gsdml::ValueList::first);
            Some((subslot?, submodule?, !reference.fixed.is_empty()))
        };
        let mut choices: Vec<(u32, &Submodule)> = Vec::new();
        for (subslot, submodule, always) in module.submodules.iter().filter_map(pluggable) {
            if self.carries_data(submodule) {
                choices.push((subslot, submodule));
            } else if always || submodule.api == self.api && submodule.lengths() == (0, 0) {
                fixed.push((subslot, submodule));
            }
        }
        let own = fixed
            .iter()
            .position(|(_, submodule)| self.carries_data(submodule));
        if let Some(own) = own {
            let (subslot, submodule) = fixed.remove(own);
            self.variant(module, slot, &fixed, subslot, submodule)?;
        } else if choices.is_empty() {
            let module = self.assembled(module, slot, &fixed)?;
            let room = self.others.len() < MOST_MODULES;
            if room && !module.submodules.is_empty() && !self.others.contains(&module) {
                self.others.push(module);
            }
        }
        for (subslot, submodule) in choices {
            self.variant(module, slot, &fixed, subslot, submodule)?;
        }
        Ok(())
    }

    /// Returns true for a submodule of the drive with data in both directions.
    fn carries_data(&self, submodule: &Submodule) -> bool {
        let (inputs, outputs) = submodule.lengths();
        submodule.api == self.api && inputs > 0 && outputs > 0
    }

    /// A module with one submodule for the telegram and all that is always there.
    fn variant(
        &mut self,
        module: &Module,
        slot: u16,
        fixed: &[(u32, &Submodule)],
        subslot: u32,
        submodule: &Submodule,
    ) -> Result<(), ImportError> {
        let none = None;
        let own = submodule.info.as_ref().map_or(&none, |info| &info.name);
        let found = telegram_of(
            self.gsdml,
            self.catalogue,
            &[own, &module.info.name],
            &[&submodule.id, &module.id],
            submodule,
        );
        let label = self.label(module, submodule);
        match found {
            Found::Telegram(telegram) => {
                let mut all = fixed.to_vec();
                all.retain(|(other, _)| *other != subslot);
                all.push((subslot, submodule));
                let made = TelegramModule {
                    telegram,
                    module: self.assembled(module, slot, &all)?,
                    slot,
                    subslot: described(submodule, subslot)?.subslot,
                };
                if self.telegrams.len() < MOST_MODULES && !self.telegrams.contains(&made) {
                    self.telegrams.push(made);
                }
                Ok(())
            }
            // numbers of telegrams from 100 on mean something else at each vendor
            Found::Contradiction(reason)
                if self.gsdml.identity.vendor_id == self.catalogue.device.vendor_id =>
            {
                Err(ImportError::Contradiction {
                    module: label,
                    reason,
                })
            }
            Found::Unknown(reason) | Found::Contradiction(reason) => {
                let reason = format!("{label}: {reason}");
                if self.left_out.len() < MOST_MODULES && !self.left_out.contains(&reason) {
                    self.left_out.push(reason);
                }
                Ok(())
            }
        }
    }

    /// Returns the name of a module, and of its submodule where that has one of its own.
    fn label(&self, module: &Module, submodule: &Submodule) -> String {
        let name = |info: Option<&gsdml::ModuleInfo>, id: &str| {
            let text = self.gsdml.text(info.and_then(|info| info.name.as_ref()));
            if text.is_empty() {
                id.to_owned()
            } else {
                text.to_owned()
            }
        };
        let module = name(Some(&module.info), &module.id);
        let submodule = name(submodule.info.as_ref(), &submodule.id);
        if module == submodule {
            module
        } else {
            format!("{module}, {submodule}")
        }
    }

    fn assembled(
        &self,
        module: &Module,
        slot: u16,
        submodules: &[(u32, &Submodule)],
    ) -> Result<ModuleDescription, ImportError> {
        let mut submodules = submodules
            .iter()
            .map(|(subslot, submodule)| described(submodule, *subslot))
            .collect::<Result<Vec<_>, _>>()?;
        submodules.sort_by_key(|submodule| submodule.subslot);
        Ok(ModuleDescription {
            ident: module.ident,
            slots: vec![slot],
            submodules,
        })
    }
}

//! A device description as data for people and programs.

use std::collections::BTreeMap;

use gsdml::{AccessPoint, Gsdml, Interface, Module, ModuleInfo, Submodule, TextId, ValueList};

use crate::report::{
    GsdmlAccessPoint, GsdmlItem, GsdmlModule, GsdmlShowReport, GsdmlSubmodule, GsdmlSystemSubmodule,
};

/// The texts of a device description are not in a language.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("the file has no texts in `{language}`")]
pub struct LanguageError {
    /// The language.
    pub language: String,
    /// Tags of the languages that it has beside the primary one.
    pub there: Vec<String>,
}

/// Returns what is in a device description, with its texts in a language, by default the primary one of the file.
///
/// # Errors
/// When the file has no texts in this language.
pub fn show(description: &Gsdml, language: Option<&str>) -> Result<GsdmlShowReport, LanguageError> {
    let languages = &description.texts.languages;
    match language {
        Some(language) if !languages.contains_key(language) => Err(LanguageError {
            language: language.to_owned(),
            there: languages.keys().cloned().collect(),
        }),
        language => Ok(View::new(description, language).report()),
    }
}

/// A description with the language to show.
struct View<'a> {
    gsdml: &'a Gsdml,
    language: Option<&'a str>,
    /// Slots of each module at all access points.
    slots: BTreeMap<&'a str, Vec<String>>,
    /// Pluggable submodules by their identifiers.
    submodules: BTreeMap<&'a str, &'a Submodule>,
}

impl<'a> View<'a> {
    fn new(gsdml: &'a Gsdml, language: Option<&'a str>) -> Self {
        let mut slots: BTreeMap<&str, Vec<String>> = BTreeMap::new();
        for reference in gsdml.access_points.iter().flat_map(|point| &point.modules) {
            let lists = [&reference.fixed, &reference.used, &reference.allowed];
            let text = lists.into_iter().rev().find(|list| !list.is_empty());
            let text = text.map(ValueList::to_string).unwrap_or_default();
            let known = slots.entry(&reference.target).or_default();
            if known.last() != Some(&text) {
                known.push(text);
            }
        }
        let submodules = gsdml.submodules.iter();
        Self {
            gsdml,
            language,
            slots,
            submodules: submodules
                .map(|submodule| (submodule.id.as_str(), submodule))
                .collect(),
        }
    }

    fn text(&self, id: Option<&TextId>) -> &'a str {
        let found = id.and_then(|id| match self.language {
            Some(language) => self.gsdml.texts.in_language(language, id),
            None => self.gsdml.texts.get(id),
        });
        found.unwrap_or_default()
    }

    fn name(&self, info: &ModuleInfo, id: &'a str) -> &'a str {
        match self.text(info.name.as_ref()) {
            "" => id,
            name => name,
        }
    }

    /// Submodules of a module: those that are always there, then those that can be plugged.
    fn submodules(&self, module: &'a Module) -> Vec<GsdmlSubmodule> {
        let fixed = module.virtual_submodules.iter();
        let fixed = fixed.map(|one| self.submodule(one.fixed_in_subslots.to_string(), false, one));
        let pluggable = module.submodules.iter().filter_map(|reference| {
            let lists = [&reference.fixed, &reference.used, &reference.allowed];
            let subslots = lists.into_iter().find(|list| !list.is_empty());
            let subslots = subslots.map(ValueList::to_string).unwrap_or_default();
            let submodule = self.submodules.get(reference.target.as_str())?;
            Some(self.submodule(subslots, reference.fixed.is_empty(), submodule))
        });
        fixed.chain(pluggable).collect()
    }

    /// Slots of a module at all access points.
    fn slots(&self, module: &Module) -> String {
        let slots = self.slots.get(module.id.as_str());
        slots.map(|slots| slots.join(" ")).unwrap_or_default()
    }

    fn report(&self) -> GsdmlShowReport {
        let gsdml = self.gsdml;
        let identity = &gsdml.identity;
        let language = |texts: &gsdml::Language| {
            let pairs = texts.iter();
            pairs.map(|(id, text)| (id.to_string(), text.clone())).collect()
        };
        let languages = gsdml.texts.languages.iter();
        GsdmlShowReport {
            schema_version: gsdml.schema_version.map(|version| version.to_string()),
            vendor_id: identity.vendor_id,
            device_id: identity.device_id,
            vendor: identity.vendor.clone(),
            info: self.text(identity.info.as_ref()).to_owned(),
            main_family: gsdml.family.main.clone(),
            product_family: gsdml.family.product.clone(),
            access_points: gsdml
                .access_points
                .iter()
                .map(|point| self.point(point))
                .collect(),
            modules: gsdml.modules.iter().map(|module| self.module(module)).collect(),
            texts: language(&gsdml.texts.primary),
            languages: languages
                .map(|(tag, texts)| (tag.clone(), language(texts)))
                .collect(),
        }
    }

    fn point(&self, point: &AccessPoint) -> GsdmlAccessPoint {
        let own = point.virtual_submodules.iter();
        let own = own.map(|one| self.submodule(one.fixed_in_subslots.to_string(), false, one));
        let of_system = |subslot: u16, ident: u32| GsdmlSystemSubmodule { subslot, ident };
        let interface = point
            .interface
            .as_ref()
            .map(|one| of_system(one.subslot, one.ident));
        let ports: Vec<_> = point
            .ports
            .iter()
            .map(|one| of_system(one.subslot, one.ident))
            .collect();
        let system: Vec<_> = interface
            .iter()
            .chain(&ports)
            .map(|one| GsdmlSubmodule {
                subslots: one.subslot.to_string(),
                ident: one.ident,
                ..GsdmlSubmodule::default()
            })
            .collect();
        let info = &point.info;
        let listed = |list: fn(&Interface) -> &Vec<String>| {
            let interface = point.interface.as_ref();
            interface.map(|one| list(one).clone()).unwrap_or_default()
        };
        GsdmlAccessPoint {
            id: point.id.clone(),
            name: self.name(info, &point.id).to_owned(),
            order_number: info.order_number.clone(),
            hardware: info.hardware.clone(),
            software: info.software.clone(),
            module_ident: point.module_ident,
            slots: point.physical_slots.to_string(),
            min_device_interval: point.min_device_interval,
            instance: point.object_instance,
            reset_modes: point.reset_modes.to_string(),
            max_input: point.io_limits.input,
            max_output: point.io_limits.output,
            submodules: own.chain(system).collect(),
            interface,
            ports,
            conformance_class: point
                .certification
                .as_ref()
                .map(|one| one.conformance_class.clone()),
            modules: point.modules.iter().map(|module| module.target.clone()).collect(),
            rt_classes: listed(|interface| &interface.rt_classes),
            start_up: listed(|interface| &interface.start_up),
            protocols: listed(|interface| &interface.protocols),
        }
    }

    fn module(&self, module: &'a Module) -> GsdmlModule {
        GsdmlModule {
            id: module.id.clone(),
            name: self.name(&module.info, &module.id).to_owned(),
            ident: module.ident,
            info: self.text(module.info.info.as_ref()).to_owned(),
            slots: self.slots(module),
            submodules: self.submodules(module),
        }
    }

    fn submodule(&self, subslots: String, pluggable: bool, submodule: &Submodule) -> GsdmlSubmodule {
        let (input, output) = submodule.lengths();
        let name = self.text(submodule.info.as_ref().and_then(|info| info.name.as_ref()));
        let items = |data: &Option<gsdml::DataDescription>| {
            let items = data.iter().flat_map(|data| &data.items);
            items
                .map(|item| GsdmlItem {
                    data_type: item.data_type.name().to_owned(),
                    octets: item.octets(),
                    name: self.text(item.text.as_ref()).to_owned(),
                })
                .collect()
        };
        GsdmlSubmodule {
            id: Some(submodule.id.clone()),
            name: Some(name.to_owned()),
            subslots,
            pluggable,
            ident: submodule.ident,
            api: submodule.api,
            input,
            output,
            input_items: items(&submodule.io.input),
            output_items: items(&submodule.io.output),
        }
    }
}

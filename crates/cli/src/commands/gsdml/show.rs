//! `profidrive gsdml show FILE`

use std::collections::BTreeMap;

use gsdml::{AccessPoint, Gsdml, Interface, Module, ModuleInfo, Submodule, TextId, ValueList};
use profidrive::report::{GsdmlAccessPoint, GsdmlItem, GsdmlModule, GsdmlShowReport, GsdmlSubmodule};

use crate::args::GsdmlShow;
use crate::failure::Failure;
use crate::output::{Colour, Output};
use crate::render::number;
use crate::render::table::{Table, clean};

/// Milliseconds of one step of an update time.
const TICK: f64 = 0.031_25;

pub fn run(args: &GsdmlShow, output: &Output) -> Result<(), Failure> {
    let description = super::read(&args.file)?;
    let languages = &description.texts.languages;
    if let Some(language) = &args.language
        && !languages.contains_key(language)
    {
        let there: Vec<&str> = languages.keys().map(String::as_str).collect();
        let failure = Failure::usage(format!("the file has no texts in `{language}`"));
        return Err(match there.is_empty() {
            true => failure.hint("its texts are in the primary language only"),
            false => failure.hint(format!("it has {}", there.join(", "))),
        });
    }
    let view = View::new(&description, args.language.as_deref());
    if output.json() {
        output.json_report(&view.report());
        return Ok(());
    }
    view.identity(output);
    for point in &description.access_points {
        view.access_point(point, output);
    }
    output.line("");
    view.modules().lines().iter().for_each(|line| output.line(line));
    if args.texts {
        output.line("");
        let mut table = Table::new(&["text", "words"]);
        for id in description.texts.primary.keys() {
            table.row([id.to_string(), view.text(Some(id)).to_owned()]);
        }
        table.lines().iter().for_each(|line| output.line(line));
    }
    Ok(())
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

    fn identity(&self, output: &Output) {
        let gsdml = self.gsdml;
        let identity = &gsdml.identity;
        let languages: Vec<&str> = gsdml.texts.languages.keys().map(String::as_str).collect();
        let version = gsdml.schema_version.map(|version| version.to_string());
        let family = [Some(gsdml.family.main.clone()), gsdml.family.product.clone()];
        let family: Vec<String> = family.into_iter().flatten().collect();
        for (name, value) in [
            (
                "vendor",
                format!("0x{:04X} {}", identity.vendor_id, identity.vendor),
            ),
            (
                "device",
                format!(
                    "0x{:04X} {}",
                    identity.device_id,
                    self.text(identity.info.as_ref())
                ),
            ),
            ("family", family.join(", ")),
            ("schema", version.unwrap_or_else(|| "not given".to_owned())),
            (
                "texts",
                format!(
                    "{} in the primary language{}{}",
                    gsdml.texts.primary.len(),
                    if languages.is_empty() { "" } else { "; also " },
                    languages.join(", ")
                ),
            ),
        ] {
            output.line(&format!("{name:<8} {}", clean(&value)));
        }
    }

    fn access_point(&self, point: &AccessPoint, output: &Output) {
        let name = clean(&format!("access point {}", point.id));
        output.line("");
        output.line(&format!(
            "{}  {}",
            output.paint(Colour::Strong, &name),
            clean(self.name(&point.info, &point.id))
        ));
        let info = &point.info;
        let release = [
            ("order number", &info.order_number),
            ("hardware", &info.hardware),
            ("software", &info.software),
        ];
        let release: Vec<String> = release
            .iter()
            .filter_map(|(name, value)| value.as_ref().map(|value| format!("{name} {value}")))
            .collect();
        let line = |name: &str, value: String| {
            if !value.is_empty() {
                output.line(&format!("  {name:<14} {}", clean(&value)));
            }
        };
        line("release", release.join(", "));
        line("module ident", format!("0x{:08X}", point.module_ident));
        line("slots", point.physical_slots.to_string());
        let interval = point.min_device_interval;
        line(
            "update time",
            format!(
                "{} ms and longer ({interval} steps of 31.25 us)",
                number(f64::from(interval) * TICK)
            ),
        );
        if let Some(interface) = &point.interface {
            line(
                "interface",
                format!(
                    "subslot 0x{:04X}, ident 0x{:08X}, {}, start-up {}",
                    interface.subslot,
                    interface.ident,
                    interface.rt_classes.join(" "),
                    interface.start_up.join(" ")
                ),
            );
            line("protocols", interface.protocols.join(" "));
        }
        for port in &point.ports {
            line(
                "port",
                format!("subslot 0x{:04X}, ident 0x{:08X}", port.subslot, port.ident),
            );
        }
        if let Some(certification) = &point.certification {
            line(
                "conformance",
                format!("class {}", certification.conformance_class),
            );
        }
        line("reset modes", point.reset_modes.to_string());
        let limits = point.io_limits;
        line(
            "cyclic data",
            format!(
                "at most {} octets of input, {} of output with status",
                limits.input, limits.output
            ),
        );
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

    fn modules(&self) -> Table {
        let mut table = Table::new(&[
            "module",
            "ident",
            "slots",
            "subslot",
            "submodule",
            "ident",
            "api",
            ">input",
            ">output",
        ]);
        for module in self.gsdml.modules.iter().map(|module| self.module(module)) {
            let ident = format!("0x{:08X}", module.ident);
            let mut head = [module.name.clone(), ident, module.slots];
            if module.submodules.is_empty() {
                table.row(head.clone());
            }
            for submodule in module.submodules {
                let name = submodule.name.filter(|name| !name.is_empty());
                let own = name.or(submodule.id).unwrap_or_default();
                let own = match (own == module.name, submodule.pluggable) {
                    (true, _) => String::new(),
                    (false, true) => format!("+ {own}"),
                    (false, false) => own,
                };
                table.row(std::mem::take(&mut head).into_iter().chain([
                    submodule.subslots,
                    own,
                    format!("0x{:08X}", submodule.ident),
                    format!("0x{:04X}", submodule.api),
                    submodule.input.to_string(),
                    submodule.output.to_string(),
                ]));
            }
        }
        table
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
        let interface = point.interface.iter().map(|one| (one.subslot, one.ident));
        let ports = point.ports.iter().map(|one| (one.subslot, one.ident));
        let system = interface.chain(ports).map(|(subslot, ident)| GsdmlSubmodule {
            subslots: subslot.to_string(),
            ident,
            ..GsdmlSubmodule::default()
        });
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

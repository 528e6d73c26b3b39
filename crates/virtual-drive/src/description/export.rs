//! The device description of a virtual drive, made from the same tables as its device.

use gsdml::{
    AccessPoint, Certification, Consistency, DataDescription, DataItem, DataType, DeviceIdentity, Family,
    Features, FileName, Graphic, GraphicRef, Gsdml, Interface, IoData, IoLimits, Module, ModuleInfo,
    ModuleRef, Port, SchemaVersion, Submodule, TextId, Texts, ValueList,
};
use profile::catalogue::{self, Words};
use profile::telegram::{Image, Signal, Telegram};
use profinet::MacAddress;
use profinet::device::{DeviceConfig, ModuleDescription, ResetMode, SubmoduleDescription};

use super::{Description, INTERFACE, SLOT, TelegramModule, picture};
use crate::model::Model;
use crate::station::{StationConfig, describe};

/// Language of the translations.
const GERMAN: &str = "de";
/// Kind of line of the port: 100BASE-TX full duplex.
const MAU_TYPE: u16 = 16;
/// Longest record that every tool may request.
const RECORD: u32 = 4068;
/// I&M records that can be written on slot 0.
const WRITABLE_IM: std::ops::RangeInclusive<u32> = 1..=4;
/// Send clocks every controller may request; the device takes all of them, and every reduction ratio.
const SEND_CLOCKS: [u32; 5] = [8, 16, 32, 64, 128];
const REDUCTION_RATIOS: std::ops::RangeInclusive<u32> = 0..=9;
/// Identifiers of things that are there once.
const ACCESS_POINT: &str = "DAP_1";
const PICTURE: &str = "G_DEVICE";

/// A device description with all its files.
#[derive(Debug, Clone, PartialEq)]
pub struct Exported {
    /// Name of the description's file.
    pub file_name: FileName,
    /// The description.
    pub description: Gsdml,
    /// Pictures: file name and octets.
    pub pictures: Vec<(String, Vec<u8>)>,
}

/// Returns the device description of a model. Always the same for the same model.
///
/// ```
/// use profidrive_virtual_drive::description::export::export;
/// use profidrive_virtual_drive::model;
/// let exported = export(&model::AKD);
/// assert_eq!(exported.description.modules.len(), 10);
/// assert!(exported.file_name.to_string().starts_with("GSDML-V2.35-Kollmorgen-AKD"));
/// ```
#[must_use]
pub fn export(model: &'static Model) -> Exported {
    export_with(model, None)
}

/// The same with the shortest update time of the drive in steps of 31.25 us (`StationConfig::min_device_interval`); `None` is that of
/// the model. The file has the same name and identity: an engineering tool takes one of them.
#[must_use]
pub fn export_with(model: &'static Model, min_device_interval: Option<u16>) -> Exported {
    let device = &model.catalogue.device;
    let facts = &device.description;
    let description = Description::of(model);
    // the answers of the device on the wire have to match the file
    let config = describe::device_config(&StationConfig {
        min_device_interval,
        ..StationConfig::new(model, MacAddress([2, 0, 0, 0, 0, 0]))
    });
    let picture = FileName::picture(device.vendor_id, device.device_id, facts.family);
    let mut texts = Texts::default();
    let info = add(&mut texts, "T_DEVICE_INFO", &facts.words);
    let modules: Vec<Module> = description
        .telegrams
        .iter()
        .filter_map(|telegram| module(&mut texts, device, telegram))
        .collect();
    let mut point = access_point(&mut texts, device, &config, &description);
    point.io_limits = io_limits(&point, &modules);
    point.modules = modules.iter().map(|module| module_ref(&module.id)).collect();
    let gsdml = Gsdml {
        schema_version: Some(SchemaVersion::WRITTEN),
        identity: DeviceIdentity {
            vendor_id: config.identity.vendor_id,
            device_id: config.identity.device_id,
            info: Some(info),
            vendor: device.vendor.to_owned(),
        },
        family: Family {
            main: "Drives".to_owned(),
            product: Some(facts.product_family.to_owned()),
        },
        access_points: vec![point],
        modules,
        submodules: Vec::new(),
        values: Vec::new(),
        channel_diagnoses: Vec::new(),
        graphics: vec![Graphic {
            id: PICTURE.to_owned(),
            file: picture.clone(),
        }],
        categories: Vec::new(),
        texts,
    };
    Exported {
        file_name: FileName {
            version: SchemaVersion::WRITTEN,
            vendor: device.vendor.to_owned(),
            family: facts.family.to_owned(),
            date: facts.date,
            time: None,
        },
        description: gsdml,
        pictures: vec![(format!("{picture}.bmp"), picture::draw(facts.name).to_bmp())],
    }
}

/// Returns a text in both languages.
fn add(texts: &mut Texts, id: &str, words: &Words) -> TextId {
    let id = texts.add(id, words.english);
    texts.translate(GERMAN, &id, words.german);
    id
}

fn access_point(
    texts: &mut Texts,
    device: &catalogue::Device,
    config: &DeviceConfig,
    description: &Description,
) -> AccessPoint {
    let facts = &device.description;
    let identity = &config.identity;
    let slot = description.access_points.first();
    let submodules = slot.map_or(&[][..], |slot| &slot.submodules);
    let name = texts.add("T_DEVICE_NAME", facts.name);
    let info = TextId::from("T_DEVICE_INFO");
    let [major, minor, fix] = identity.software_revision;
    let release = ModuleInfo {
        name: Some(name.clone()),
        info: Some(info.clone()),
        vendor: Some(device.vendor.to_owned()),
        order_number: Some(identity.order_id.clone()),
        hardware: Some(identity.hardware_revision.to_string()),
        software: Some(format!("{}{major}.{minor}.{fix}", identity.software_prefix)),
        category: None,
    };
    let own = submodules
        .iter()
        .filter(|submodule| submodule.subslot < INTERFACE)
        .map(|submodule| Submodule {
            id: format!("S_DAP_{}", submodule.subslot),
            ident: submodule.ident,
            api: submodule.api,
            fixed_in_subslots: ValueList::one(submodule.subslot.into()),
            process_alarms: false,
            writable_im: WRITABLE_IM.collect(),
            info: Some(ModuleInfo {
                name: Some(name.clone()),
                info: Some(info.clone()),
                ..ModuleInfo::default()
            }),
            io: IoData::default(),
            records: Vec::new(),
            graphics: Vec::new(),
        });
    AccessPoint {
        id: ACCESS_POINT.to_owned(),
        info: release,
        module_ident: slot.map_or(0, |slot| slot.ident),
        pnio_version: Some(SchemaVersion::WRITTEN),
        required_schema: None,
        physical_slots: format!("0..{SLOT}").parse().unwrap_or_default(),
        fixed_in_slots: ValueList::one(0),
        min_device_interval: config.min_device_interval,
        dns_name: Some(facts.dns_name.to_owned()),
        object_instance: identity.instance,
        features: Features {
            multiple_write: true,
            check_device_id: true,
            lldp_nod: true,
            device_access: Some(config.max_device_access > 0),
            ..Features::default()
        },
        address_assignment: vec!["DCP".to_owned()],
        reset_modes: modes(&config.reset_modes),
        device_access_ars: u16::try_from(config.max_device_access).ok(),
        max_record: Some(RECORD),
        certification: Some(Certification {
            conformance_class: facts.conformance_class.to_owned(),
            application_class: Vec::new(),
            netload_class: Some(facts.netload_class.to_owned()),
        }),
        subslots: Vec::new(),
        io_limits: IoLimits::default(),
        modules: Vec::new(),
        virtual_submodules: own.collect(),
        interface: submodules
            .iter()
            .find(|submodule| submodule.subslot == INTERFACE)
            .map(|submodule| interface(texts, facts, submodule)),
        ports: submodules
            .iter()
            .filter(|submodule| submodule.subslot > INTERFACE)
            .map(|submodule| port(texts, facts, submodule))
            .collect(),
        submodules: Vec::new(),
        graphics: vec![GraphicRef {
            kind: "DeviceSymbol".to_owned(),
            target: PICTURE.to_owned(),
        }],
    }
}

fn modes(modes: &[ResetMode]) -> ValueList {
    modes.iter().map(|mode| u32::from(mode.number())).collect()
}

fn interface(
    texts: &mut Texts,
    facts: &catalogue::DescriptionFacts,
    submodule: &SubmoduleDescription,
) -> Interface {
    let words = Words {
        english: "PROFINET interface",
        german: "PROFINET-Schnittstelle",
    };
    Interface {
        id: "S_INTERFACE".to_owned(),
        subslot: submodule.subslot,
        ident: submodule.ident,
        text: Some(add(texts, "T_INTERFACE", &words)),
        rt_classes: vec!["RT_CLASS_1".to_owned()],
        protocols: facts.protocols.iter().map(|name| (*name).to_owned()).collect(),
        dcp_hello: false,
        // the only port: whatever a boundary keeps from leaving is never sent anyway
        ptp_boundary: true,
        dcp_boundary: true,
        ars: 1,
        start_up: vec!["Legacy".to_owned(), "Advanced".to_owned()],
        send_clocks: SEND_CLOCKS.into_iter().collect(),
        reduction_ratios: REDUCTION_RATIOS.map(|power| 1 << power).collect(),
    }
}

fn port(texts: &mut Texts, facts: &catalogue::DescriptionFacts, submodule: &SubmoduleDescription) -> Port {
    let number = submodule.subslot - INTERFACE;
    Port {
        id: format!("S_PORT_{number}"),
        subslot: submodule.subslot,
        ident: submodule.ident,
        text: Some(texts.add(format!("T_PORT_{number}"), format!("Port {number}"))),
        rx_delay: Some(facts.port_rx_delay),
        tx_delay: Some(facts.port_tx_delay),
        mau_types: vec![MAU_TYPE],
    }
}

fn module_ref(id: &str) -> ModuleRef {
    ModuleRef {
        target: id.to_owned(),
        allowed: ValueList::one(SLOT.into()),
        used: ValueList::EMPTY,
        fixed: ValueList::EMPTY,
    }
}

/// Returns the access point with the largest module in each direction, all with their status octets.
fn io_limits(point: &AccessPoint, modules: &[Module]) -> IoLimits {
    let own = point.own_octets();
    let largest = modules
        .iter()
        .map(Module::own_octets)
        .fold((0, 0), |most: (u32, u32), one| {
            (most.0.max(one.0), most.1.max(one.1))
        });
    let octets = |number: u32| u16::try_from(number).unwrap_or(u16::MAX);
    let (input, output) = (octets(own.0 + largest.0), octets(own.1 + largest.1));
    IoLimits {
        input,
        output,
        both: Some(input.saturating_add(output)),
    }
}

fn module(texts: &mut Texts, device: &catalogue::Device, module: &TelegramModule) -> Option<Module> {
    let number = module.telegram;
    let telegram = Telegram::find(number, device.vendor_id)?;
    let data = module.data()?;
    let (setpoints, actuals) = (data.output_length / 2, data.input_length / 2);
    let (english, german) = match (telegram.free, telegram.vendor) {
        (true, _) => ("Free telegram", "Freies Telegramm"),
        (false, None) => ("Standard telegram", "Standardtelegramm"),
        (false, Some(_)) => ("Manufacturer telegram", "Herstellertelegramm"),
    };
    let name = texts.add(
        format!("T_TEL_{number}"),
        format!("{english} {number}, PZD-{setpoints}/{actuals}"),
    );
    texts.translate(
        GERMAN,
        &name,
        format!("{german} {number}, PZD-{setpoints}/{actuals}"),
    );
    let purpose = device.telegram(number).map(|known| known.words)?;
    let info = add(texts, &format!("T_TEL_{number}_INFO"), &purpose);
    let info = ModuleInfo {
        name: Some(name),
        info: Some(info),
        ..ModuleInfo::default()
    };
    let mut image = |half: &Image, octets: u16| {
        Some(DataDescription {
            consistency: Consistency::All,
            items: items(texts, telegram, half, octets),
        })
    };
    let io = IoData {
        input: image(&telegram.actual, data.input_length),
        output: image(&telegram.setpoint, data.output_length),
        ..IoData::default()
    };
    let ModuleDescription { ident, .. } = module.module;
    Some(Module {
        id: format!("M_TEL_{number}"),
        ident,
        info: info.clone(),
        physical_subslots: ValueList::EMPTY,
        subslots: Vec::new(),
        submodules: Vec::new(),
        virtual_submodules: module
            .module
            .submodules
            .iter()
            .map(|submodule| {
                let carries = submodule.subslot == module.subslot;
                Submodule {
                    id: if carries {
                        format!("S_TEL_{number}")
                    } else {
                        format!("S_PAP_{number}")
                    },
                    ident: submodule.ident,
                    api: submodule.api,
                    fixed_in_subslots: ValueList::one(submodule.subslot.into()),
                    process_alarms: false,
                    writable_im: ValueList::EMPTY,
                    info: Some(if carries { info.clone() } else { point(texts) }),
                    io: if carries { io.clone() } else { IoData::default() },
                    records: Vec::new(),
                    graphics: Vec::new(),
                }
            })
            .collect(),
        graphics: Vec::new(),
    })
}

/// Returns the submodule that takes parameter jobs and has no data.
fn point(texts: &mut Texts) -> ModuleInfo {
    let words = Words {
        english: "Parameter access point",
        german: "Parameterzugriffspunkt",
    };
    ModuleInfo {
        name: Some(add(texts, "T_PAP", &words)),
        info: Some(add(texts, "T_PAP_INFO", &words)),
        ..ModuleInfo::default()
    }
}

/// One item for each signal; words without a fixed signal have numbers.
fn items(texts: &mut Texts, telegram: &Telegram, image: &Image, octets: u16) -> Vec<DataItem> {
    let mut items = Vec::new();
    let mut at = 0;
    while at < octets {
        let field = image.fields.iter().find(|field| field.offset == at);
        match field.filter(|_| !telegram.free) {
            Some(field) => {
                items.push(signal(texts, field.signal));
                at += field.signal.octets();
            }
            None => {
                let number = at / 2 + 1;
                let words = format!("Process data word {number}");
                let id = texts.add(format!("T_WORD_{number}"), words);
                texts.translate(GERMAN, &id, format!("Prozessdatenwort {number}"));
                items.push(DataItem::new(DataType::UNSIGNED16, id));
                at += 2;
            }
        }
    }
    items
}

fn signal(texts: &mut Texts, signal: &Signal) -> DataItem {
    let text = format!("{}: {}", signal.name, signal.meaning);
    let id = texts.add(format!("T_SIG_{}", signal.name), text);
    let word = if signal.signed { "Integer" } else { "Unsigned" };
    DataItem::new(DataType::of(&format!("{word}{}", signal.bits)), id)
}

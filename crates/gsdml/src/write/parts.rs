//! The elements in the order of the schema.

use super::Writer;
use crate::data::{DataDescription, IoData};
use crate::model::{
    AccessPoint, GraphicRef, Gsdml, Interface, MenuEntry, Module, ModuleInfo, ParameterRecord, Port,
    Submodule, SubmoduleRef, SubslotName,
};
use crate::text::{Language, TextId};
use alloc::string::String;
use alloc::vec::Vec;

/// What stands in the head of every file.
pub(crate) const HEADER: [(&str, &str); 5] = [
    ("ProfileIdentification", "PROFINET Device Profile"),
    ("ProfileRevision", "1.00"),
    ("ProfileName", "Device Profile for PROFINET Devices"),
    ("ProfileSource", "PROFIBUS Nutzerorganisation e. V. (PNO)"),
    ("ProfileClassID", "Device"),
];
/// The same of the reference to ISO 15745.
pub(crate) const REFERENCE: [(&str, &str); 3] = [
    ("ISO15745Part", "4"),
    ("ISO15745Edition", "1"),
    ("ProfileTechnology", "GSDML"),
];

pub(super) fn header(w: &mut Writer) {
    w.element("ProfileHeader", |w| {
        for (name, text) in HEADER {
            w.words(name, text);
        }
        w.element("ISO15745Reference", |w| {
            for (name, text) in REFERENCE {
                w.words(name, text);
            }
        });
    });
}

pub(super) fn identity(w: &mut Writer, gsdml: &Gsdml) {
    let identity = &gsdml.identity;
    w.element("DeviceIdentity", |w| {
        w.attribute("VendorID", format_args!("0x{:04X}", identity.vendor_id));
        w.attribute("DeviceID", format_args!("0x{:04X}", identity.device_id));
        w.single("InfoText", "TextId", identity.info.as_ref());
        w.single("VendorName", "Value", Some(&identity.vendor));
    });
    w.element("DeviceFunction", |w| {
        w.element("Family", |w| {
            w.attribute("MainFamily", &gsdml.family.main);
            w.optional("ProductFamily", gsdml.family.product.as_ref());
        });
    });
}

/// A list, left out when empty.
fn list<T>(w: &mut Writer, name: &str, items: &[T], mut write: impl FnMut(&mut Writer, &T)) {
    if !items.is_empty() {
        w.element(name, |w| items.iter().for_each(|item| write(w, item)));
    }
}

pub(super) fn process(w: &mut Writer, gsdml: &Gsdml) {
    list(w, "DeviceAccessPointList", &gsdml.access_points, access_point);
    list(w, "ModuleList", &gsdml.modules, module);
    list(w, "SubmoduleList", &gsdml.submodules, |w, item| {
        submodule(w, "SubmoduleItem", item);
    });
    list(w, "ValueList", &gsdml.values, |w, item| {
        w.element("ValueItem", |w| {
            w.attribute("ID", &item.id);
            list(w, "Assignments", &item.assignments, |w, (content, text)| {
                w.element("Assign", |w| {
                    w.attribute("TextId", text);
                    w.attribute("Content", content);
                });
            });
        });
    });
    list(w, "ChannelDiagList", &gsdml.channel_diagnoses, |w, item| {
        w.element("ChannelDiagItem", |w| {
            w.attribute("ErrorType", item.error_type);
            w.single("Name", "TextId", item.name.as_ref());
            w.single("Help", "TextId", item.help.as_ref());
        });
    });
    list(w, "GraphicsList", &gsdml.graphics, |w, item| {
        w.element("GraphicItem", |w| {
            w.attribute("ID", &item.id);
            w.attribute("GraphicFile", &item.file);
        });
    });
    list(w, "CategoryList", &gsdml.categories, |w, item| {
        w.element("CategoryItem", |w| {
            w.attribute("ID", &item.id);
            w.optional("TextId", item.text.as_ref());
        });
    });
    w.element("ExternalTextList", |w| {
        w.element("PrimaryLanguage", |w| language(w, &gsdml.texts.primary));
        for (tag, texts) in &gsdml.texts.languages {
            w.element("Language", |w| {
                w.attribute("xml:lang", tag);
                language(w, texts);
            });
        }
    });
}

fn language(w: &mut Writer, texts: &Language) {
    for (id, text) in texts {
        w.element("Text", |w| {
            w.attribute("TextId", id);
            w.attribute("Value", text);
        });
    }
}

fn access_point(w: &mut Writer, point: &AccessPoint) {
    w.element("DeviceAccessPointItem", |w| {
        let features = point.features;
        w.attribute("ID", &point.id);
        w.optional("PNIO_Version", point.pnio_version);
        w.values("PhysicalSlots", &point.physical_slots);
        w.ident("ModuleIdentNumber", point.module_ident);
        w.attribute("MinDeviceInterval", point.min_device_interval);
        w.optional("DNS_CompatibleName", point.dns_name.as_ref());
        w.attribute("FixedInSlots", &point.fixed_in_slots);
        w.attribute("ObjectUUID_LocalIndex", point.object_instance);
        w.optional("RequiredSchemaVersion", point.required_schema);
        w.attribute("MultipleWriteSupported", features.multiple_write);
        w.optional("DeviceAccessSupported", features.device_access);
        w.optional("NumberOfDeviceAccessAR", point.device_access_ars);
        w.attribute("SharedDeviceSupported", features.shared_device);
        w.attribute("SharedInputSupported", features.shared_input);
        w.attribute("CheckDeviceID_Allowed", features.check_device_id);
        w.attribute("NameOfStationNotTransferable", features.name_not_transferable);
        w.attribute("LLDP_NoD_Supported", features.lldp_nod);
        w.values("ResetToFactoryModes", &point.reset_modes);
        w.optional("MaxSupportedRecordSize", point.max_record);
        w.tokens("AddressAssignment", &point.address_assignment);
        module_info(w, &point.info);
        if let Some(certification) = &point.certification {
            w.element("CertificationInfo", |w| {
                w.attribute("ConformanceClass", &certification.conformance_class);
                w.tokens("ApplicationClass", &certification.application_class);
                w.optional("NetloadClass", certification.netload_class.as_ref());
            });
        }
        subslots(w, &point.subslots);
        w.element("IOConfigData", |w| {
            w.attribute("MaxInputLength", point.io_limits.input);
            w.attribute("MaxOutputLength", point.io_limits.output);
            w.optional("MaxDataLength", point.io_limits.both);
        });
        list(w, "UseableModules", &point.modules, |w, item| {
            w.element("ModuleItemRef", |w| {
                w.attribute("ModuleItemTarget", &item.target);
                w.values("AllowedInSlots", &item.allowed);
                w.values("UsedInSlots", &item.used);
                w.values("FixedInSlots", &item.fixed);
            });
        });
        virtual_submodules(w, &point.virtual_submodules);
        if point.interface.is_some() || !point.ports.is_empty() {
            w.element("SystemDefinedSubmoduleList", |w| {
                if let Some(item) = &point.interface {
                    interface(w, item);
                }
                point.ports.iter().for_each(|item| port(w, item));
            });
        }
        submodule_refs(w, &point.submodules);
        graphics(w, &point.graphics);
    });
}

fn subslots(w: &mut Writer, subslots: &[SubslotName]) {
    list(w, "SubslotList", subslots, |w, item| {
        w.element("SubslotItem", |w| {
            w.attribute("SubslotNumber", item.number);
            w.attribute("TextId", &item.text);
        });
    });
}

fn virtual_submodules(w: &mut Writer, submodules: &[Submodule]) {
    list(w, "VirtualSubmoduleList", submodules, |w, item| {
        submodule(w, "VirtualSubmoduleItem", item);
    });
}

fn submodule_refs(w: &mut Writer, submodules: &[SubmoduleRef]) {
    list(w, "UseableSubmodules", submodules, |w, item| {
        w.element("SubmoduleItemRef", |w| {
            w.attribute("SubmoduleItemTarget", &item.target);
            w.values("AllowedInSubslots", &item.allowed);
            w.values("UsedInSubslots", &item.used);
            w.values("FixedInSubslots", &item.fixed);
        });
    });
}

fn graphics(w: &mut Writer, graphics: &[GraphicRef]) {
    list(w, "Graphics", graphics, |w, item| {
        w.element("GraphicItemRef", |w| {
            w.attribute("Type", &item.kind);
            w.attribute("GraphicItemTarget", &item.target);
        });
    });
}

fn module_info(w: &mut Writer, info: &ModuleInfo) {
    w.element("ModuleInfo", |w| {
        w.optional("CategoryRef", info.category.as_ref());
        let text = |w: &mut Writer, name: &str, id: &Option<TextId>| w.single(name, "TextId", id.as_ref());
        let value =
            |w: &mut Writer, name: &str, text: &Option<String>| w.single(name, "Value", text.as_ref());
        text(w, "Name", &info.name);
        text(w, "InfoText", &info.info);
        value(w, "VendorName", &info.vendor);
        value(w, "OrderNumber", &info.order_number);
        value(w, "HardwareRelease", &info.hardware);
        value(w, "SoftwareRelease", &info.software);
    });
}

fn module(w: &mut Writer, module: &Module) {
    w.element("ModuleItem", |w| {
        w.attribute("ID", &module.id);
        w.ident("ModuleIdentNumber", module.ident);
        w.values("PhysicalSubslots", &module.physical_subslots);
        module_info(w, &module.info);
        subslots(w, &module.subslots);
        submodule_refs(w, &module.submodules);
        virtual_submodules(w, &module.virtual_submodules);
        graphics(w, &module.graphics);
    });
}

fn submodule(w: &mut Writer, element: &str, submodule: &Submodule) {
    w.element(element, |w| {
        w.attribute("ID", &submodule.id);
        w.ident("SubmoduleIdentNumber", submodule.ident);
        w.attribute("API", submodule.api);
        w.attribute("FixedInSubslots", &submodule.fixed_in_subslots);
        w.attribute("MayIssueProcessAlarm", submodule.process_alarms);
        w.values("Writeable_IM_Records", &submodule.writable_im);
        io_data(w, &submodule.io);
        list(w, "RecordDataList", &submodule.records, record);
        if let Some(info) = &submodule.info {
            module_info(w, info);
        }
        graphics(w, &submodule.graphics);
    });
}

fn io_data(w: &mut Writer, io: &IoData) {
    w.element("IOData", |w| {
        w.attribute("IOPS_Length", io.iops_length);
        w.attribute("IOCS_Length", io.iocs_length);
        let directions = [("Input", &io.input), ("Output", &io.output)];
        for (name, data) in directions {
            if let Some(data) = data {
                w.element(name, |w| description(w, data));
            }
        }
    });
}

fn description(w: &mut Writer, data: &DataDescription) {
    w.attribute("Consistency", data.consistency.word());
    for item in &data.items {
        w.element("DataItem", |w| {
            w.attribute("DataType", &item.data_type);
            w.optional("Length", item.length);
            w.optional("TextId", item.text.as_ref());
            if item.use_as_bits {
                w.attribute("UseAsBits", true);
            }
            for bit in &item.bits {
                w.element("BitDataItem", |w| {
                    w.attribute("BitOffset", bit.offset);
                    w.optional("TextId", bit.text.as_ref());
                });
            }
        });
    }
}

fn record(w: &mut Writer, record: &ParameterRecord) {
    w.element("ParameterRecordDataItem", |w| {
        w.attribute("Index", record.index);
        w.attribute("Length", record.length);
        if record.sequence != 0 {
            w.attribute("TransferSequence", record.sequence);
        }
        w.single("Name", "TextId", record.name.as_ref());
        for constant in &record.constants {
            let octets = constant.data.iter();
            let octets: Vec<String> = octets.map(|octet| alloc::format!("0x{octet:02x}")).collect();
            w.element("Const", |w| {
                w.attribute("ByteOffset", constant.offset);
                w.attribute("Data", octets.join(","));
            });
        }
        for parameter in &record.parameters {
            w.element("Ref", |w| {
                w.optional("ID", parameter.id.as_ref());
                w.optional("ValueItemTarget", parameter.values.as_ref());
                w.attribute("DataType", &parameter.data_type);
                w.attribute("ByteOffset", parameter.offset);
                w.optional("BitOffset", parameter.bit_offset);
                w.optional("BitLength", parameter.bit_length);
                w.optional("Length", parameter.length);
                w.optional("DefaultValue", parameter.default.as_ref());
                w.optional("AllowedValues", parameter.allowed.as_ref());
                w.attribute("Changeable", parameter.changeable);
                w.attribute("Visible", parameter.visible);
                w.optional("TextId", parameter.text.as_ref());
            });
        }
        list(w, "MenuList", &record.menus, |w, menu| {
            w.element("MenuItem", |w| {
                w.attribute("ID", &menu.id);
                w.single("Name", "TextId", menu.name.as_ref());
                for entry in &menu.entries {
                    match entry {
                        MenuEntry::Parameter(id) => w.single("ParameterRef", "ParameterTarget", Some(id)),
                        MenuEntry::Menu(id) => w.single("MenuRef", "MenuTarget", Some(id)),
                    }
                }
            });
        });
    });
}

fn interface(w: &mut Writer, item: &Interface) {
    w.element("InterfaceSubmoduleItem", |w| {
        w.attribute("ID", &item.id);
        w.attribute("SubslotNumber", item.subslot);
        w.ident("SubmoduleIdentNumber", item.ident);
        w.optional("TextId", item.text.as_ref());
        w.tokens("SupportedRT_Classes", &item.rt_classes);
        w.tokens("SupportedProtocols", &item.protocols);
        w.attribute("DCP_HelloSupported", item.dcp_hello);
        w.attribute("PTP_BoundarySupported", item.ptp_boundary);
        w.attribute("DCP_BoundarySupported", item.dcp_boundary);
        w.element("ApplicationRelations", |w| {
            w.attribute("NumberOfAR", item.ars);
            w.tokens("StartupMode", &item.start_up);
            w.element("TimingProperties", |w| {
                w.attribute("SendClock", &item.send_clocks);
                w.attribute("ReductionRatio", &item.reduction_ratios);
            });
        });
    });
}

fn port(w: &mut Writer, item: &Port) {
    w.element("PortSubmoduleItem", |w| {
        w.attribute("ID", &item.id);
        w.attribute("SubslotNumber", item.subslot);
        w.ident("SubmoduleIdentNumber", item.ident);
        w.optional("TextId", item.text.as_ref());
        w.optional("MaxPortRxDelay", item.rx_delay);
        w.optional("MaxPortTxDelay", item.tx_delay);
        list(w, "MAUTypeList", &item.mau_types, |w, number| {
            w.element("MAUTypeItem", |w| w.attribute("Value", number));
        });
    });
}

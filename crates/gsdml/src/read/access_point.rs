//! Access points, modules, interface and ports.

use alloc::borrow::ToOwned as _;
use alloc::format;
use alloc::string::String;
use alloc::vec::Vec;

use roxmltree::Node;

use super::attributes::attribute;
use super::references::Kind;
use super::{Reader, child};
use crate::model::{
    AccessPoint, Certification, Features, GraphicRef, Interface, IoLimits, Module, ModuleInfo, ModuleRef,
    Port, SubmoduleRef, SubslotName,
};
use crate::problem::{Rule, Severity};
use crate::value::ValueList;

/// Subslot of the first interface and of its first port.
const INTERFACE: u16 = 0x8000;
const PORT: u16 = 0x8001;
/// Reduction ratios of a device that does not list its own.
const RATIOS: &str = "1 2 4 8 16 32 64 128 256 512";
/// Kinds of line as version 2.0 wrote them.
const OLD_MAU_TYPES: [(&str, u16); 4] = [
    ("100BASETXFD", 16),
    ("100BASEFXFD", 18),
    ("1000BASEXFD", 22),
    ("1000BASETFD", 30),
];

impl Reader<'_> {
    pub(super) fn access_point(&mut self, node: Node<'_, '_>) -> Option<AccessPoint> {
        let id = self.id(node, Kind::AccessPoint);
        let module_ident = self.ident(node, "ModuleIdentNumber");
        let min_device_interval = self.number(node, "MinDeviceInterval");
        let features = Features {
            multiple_write: self.flag(node, "MultipleWriteSupported"),
            check_device_id: self.flag(node, "CheckDeviceID_Allowed"),
            name_not_transferable: self.flag(node, "NameOfStationNotTransferable"),
            lldp_nod: self.flag(node, "LLDP_NoD_Supported"),
            device_access: self.given_flag(node, "DeviceAccessSupported"),
            shared_device: self.flag(node, "SharedDeviceSupported"),
            shared_input: self.flag(node, "SharedInputSupported"),
        };
        let mut address_assignment = self.tokens(node, "AddressAssignment");
        if address_assignment.is_empty() {
            address_assignment.push("DCP".to_owned());
        }
        let system = child(node, "SystemDefinedSubmoduleList");
        let interface = system
            .and_then(|list| child(list, "InterfaceSubmoduleItem"))
            .and_then(|item| self.interface(item));
        let ports = system.map_or_else(Vec::new, |list| {
            self.children(list, "PortSubmoduleItem", Self::port)
        });
        let point = AccessPoint {
            info: self.module_info(node).unwrap_or_default(),
            pnio_version: self.version(node, "PNIO_Version"),
            required_schema: self.version(node, "RequiredSchemaVersion"),
            physical_slots: self.values(node, "PhysicalSlots"),
            fixed_in_slots: self.values_or(node, "FixedInSlots", "0"),
            min_device_interval: min_device_interval.unwrap_or(0),
            dns_name: self.string(node, "DNS_CompatibleName"),
            object_instance: self.number(node, "ObjectUUID_LocalIndex").unwrap_or(1),
            features,
            address_assignment,
            reset_modes: self.values(node, "ResetToFactoryModes"),
            device_access_ars: self.number(node, "NumberOfDeviceAccessAR"),
            max_record: self.number(node, "MaxSupportedRecordSize"),
            certification: child(node, "CertificationInfo").map(|node| Certification {
                conformance_class: self.string(node, "ConformanceClass").unwrap_or_default(),
                application_class: self.tokens(node, "ApplicationClass"),
                netload_class: self.string(node, "NetloadClass"),
            }),
            subslots: self.list(node, "SubslotList", "SubslotItem", Self::subslot),
            io_limits: self.io_limits(node),
            modules: self.list(node, "UseableModules", "ModuleItemRef", Self::module_ref),
            virtual_submodules: self.virtual_submodules(node),
            interface,
            ports,
            submodules: self.list(node, "UseableSubmodules", "SubmoduleItemRef", Self::submodule_ref),
            graphics: self.graphic_refs(node),
            id: id?,
            module_ident: module_ident?,
        };
        Some(point)
    }

    pub(super) fn module(&mut self, node: Node<'_, '_>) -> Option<Module> {
        let id = self.id(node, Kind::Module);
        let ident = self.ident(node, "ModuleIdentNumber");
        let module = Module {
            info: self.module_info(node).unwrap_or_default(),
            physical_subslots: self.values(node, "PhysicalSubslots"),
            subslots: self.list(node, "SubslotList", "SubslotItem", Self::subslot),
            submodules: self.list(node, "UseableSubmodules", "SubmoduleItemRef", Self::submodule_ref),
            virtual_submodules: self.virtual_submodules(node),
            graphics: self.graphic_refs(node),
            id: id?,
            ident: ident?,
        };
        Some(module)
    }

    fn virtual_submodules(&mut self, node: Node<'_, '_>) -> Vec<crate::model::Submodule> {
        self.list(
            node,
            "VirtualSubmoduleList",
            "VirtualSubmoduleItem",
            |reader, node| reader.submodule(node, Kind::Own),
        )
    }

    /// Returns a ModuleIdentNumber; 0 stands for no module.
    fn ident(&mut self, node: Node<'_, '_>, name: &str) -> Option<u32> {
        let ident = self.needed_number(node, name)?;
        if ident == 0 {
            let at = attribute(node, name).map_or(0, |attribute| attribute.range().start);
            self.problem(
                Severity::Error,
                Rule::Value,
                at,
                format!("{name} is 0, which stands for no module"),
            );
        }
        Some(ident)
    }

    pub(super) fn module_info(&mut self, node: Node<'_, '_>) -> Option<ModuleInfo> {
        let node = child(node, "ModuleInfo")?;
        let category = self.string(node, "CategoryRef");
        if let Some(category) = &category {
            self.name(node, "CategoryRef", Kind::Category, category);
        }
        let mut value = |name: &str| child(node, name).and_then(|node| self.string(node, "Value"));
        let (vendor, order_number) = (value("VendorName"), value("OrderNumber"));
        let (hardware, software) = (value("HardwareRelease"), value("SoftwareRelease"));
        Some(ModuleInfo {
            name: self.text_of_child(node, "Name"),
            info: self.text_of_child(node, "InfoText"),
            vendor,
            order_number,
            hardware,
            software,
            category,
        })
    }

    fn subslot(&mut self, node: Node<'_, '_>) -> Option<SubslotName> {
        let number = self.needed_number(node, "SubslotNumber");
        let text = self.text_of(node, "TextId");
        Some(SubslotName {
            number: number?,
            text: text?,
        })
    }

    fn io_limits(&mut self, node: Node<'_, '_>) -> IoLimits {
        let Some(node) = child(node, "IOConfigData") else {
            return IoLimits::default();
        };
        IoLimits {
            input: self.number(node, "MaxInputLength").unwrap_or(0),
            output: self.number(node, "MaxOutputLength").unwrap_or(0),
            both: self.number(node, "MaxDataLength"),
        }
    }

    fn module_ref(&mut self, node: Node<'_, '_>) -> Option<ModuleRef> {
        let target = self.needed_string(node, "ModuleItemTarget")?;
        self.name(node, "ModuleItemTarget", Kind::Module, &target);
        Some(ModuleRef {
            target,
            allowed: self.values(node, "AllowedInSlots"),
            used: self.values(node, "UsedInSlots"),
            fixed: self.values(node, "FixedInSlots"),
        })
    }

    fn submodule_ref(&mut self, node: Node<'_, '_>) -> Option<SubmoduleRef> {
        let target = self.needed_string(node, "SubmoduleItemTarget")?;
        self.name(node, "SubmoduleItemTarget", Kind::Submodule, &target);
        Some(SubmoduleRef {
            target,
            allowed: self.values(node, "AllowedInSubslots"),
            used: self.values(node, "UsedInSubslots"),
            fixed: self.values(node, "FixedInSubslots"),
        })
    }

    pub(super) fn graphic_refs(&mut self, node: Node<'_, '_>) -> Vec<GraphicRef> {
        self.list(node, "Graphics", "GraphicItemRef", |reader, node| {
            let target = reader.needed_string(node, "GraphicItemTarget")?;
            reader.name(node, "GraphicItemTarget", Kind::Graphic, &target);
            Some(GraphicRef {
                kind: reader.string(node, "Type").unwrap_or_default(),
                target,
            })
        })
    }

    fn interface(&mut self, node: Node<'_, '_>) -> Option<Interface> {
        let id = self.id(node, Kind::Own);
        let ident = self.needed_number(node, "SubmoduleIdentNumber");
        let relations = child(node, "ApplicationRelations");
        let timing = relations.and_then(|node| child(node, "TimingProperties"));
        let mut start_up = relations.map_or_else(Vec::new, |node| self.tokens(node, "StartupMode"));
        if start_up.is_empty() {
            start_up.push("Legacy".to_owned());
        }
        let ars = relations.and_then(|node| self.number(node, "NumberOfAR"));
        let (send_clocks, reduction_ratios) = match timing {
            Some(node) => (
                self.values_or(node, "SendClock", "32"),
                self.values_or(node, "ReductionRatio", RATIOS),
            ),
            None => (ValueList::one(32), RATIOS.parse().unwrap_or_default()),
        };
        let interface = Interface {
            subslot: self.number(node, "SubslotNumber").unwrap_or(INTERFACE),
            text: self.text_of(node, "TextId"),
            rt_classes: self.rt_classes(node),
            protocols: self.tokens(node, "SupportedProtocols"),
            dcp_hello: self.flag(node, "DCP_HelloSupported"),
            ptp_boundary: self.flag(node, "PTP_BoundarySupported"),
            dcp_boundary: self.flag(node, "DCP_BoundarySupported"),
            ars: ars.unwrap_or(1),
            start_up,
            send_clocks,
            reduction_ratios,
            id: id?,
            ident: ident?,
        };
        Some(interface)
    }

    /// `SupportedRT_Classes="RT_CLASS_1;RT_CLASS_2"`, before version 2.2 `SupportedRT_Class="Class2"`.
    fn rt_classes(&mut self, node: Node<'_, '_>) -> Vec<String> {
        let classes = self.tokens(node, "SupportedRT_Classes");
        if !classes.is_empty() {
            return classes;
        }
        let old = self.string(node, "SupportedRT_Class").unwrap_or_default();
        let highest = old
            .strip_prefix("Class")
            .and_then(|digit| digit.parse().ok())
            .unwrap_or(1_u8);
        (1..=highest.clamp(1, 3))
            .map(|class| format!("RT_CLASS_{class}"))
            .collect()
    }

    fn port(&mut self, node: Node<'_, '_>) -> Option<Port> {
        let id = self.id(node, Kind::Own);
        let ident = self.needed_number(node, "SubmoduleIdentNumber");
        let mut mau_types: Vec<u16> = self.list(node, "MAUTypeList", "MAUTypeItem", |reader, node| {
            reader.needed_number(node, "Value")
        });
        if mau_types.is_empty() {
            mau_types = self.old_mau_types(node);
        }
        let port = Port {
            subslot: self.number(node, "SubslotNumber").unwrap_or(PORT),
            text: self.text_of(node, "TextId"),
            rx_delay: self.number(node, "MaxPortRxDelay"),
            tx_delay: self.number(node, "MaxPortTxDelay"),
            mau_types,
            id: id?,
            ident: ident?,
        };
        Some(port)
    }

    /// `MAUTypes="16 30"`, in version 2.0 `MAUType="100BASETXFD"`.
    fn old_mau_types(&mut self, node: Node<'_, '_>) -> Vec<u16> {
        let list = self.values(node, "MAUTypes");
        if !list.is_empty() {
            let numbers = list.iter().take(usize::from(u8::MAX));
            return numbers.filter_map(|number| u16::try_from(number).ok()).collect();
        }
        let name = self.string(node, "MAUType").unwrap_or_default();
        let known = OLD_MAU_TYPES.iter().find(|(known, _)| *known == name);
        known.map(|(_, number)| *number).into_iter().collect()
    }
}

//! A description with some of everything, for the tests.

use alloc::vec;
use alloc::vec::Vec;

use crate::*;

/// A file name that fits it.
pub const NAME: &str = "GSDML-V2.35-Vendor-Drive-20260102.xml";

fn list(text: &str) -> ValueList {
    text.parse().unwrap()
}

fn id(text: &str) -> Option<TextId> {
    Some(text.into())
}

fn info(name: &str) -> ModuleInfo {
    ModuleInfo {
        name: id(name),
        info: id("T_INFO"),
        ..ModuleInfo::default()
    }
}

fn submodule(name: &str, ident: u32) -> Submodule {
    Submodule {
        id: name.into(),
        ident,
        api: 0,
        fixed_in_subslots: list("1"),
        process_alarms: false,
        writable_im: ValueList::EMPTY,
        info: Some(info("T_INFO")),
        io: IoData::default(),
        records: Vec::new(),
        graphics: Vec::new(),
    }
}

fn words(names: &[&str]) -> Option<DataDescription> {
    Some(DataDescription {
        consistency: Consistency::All,
        items: names
            .iter()
            .map(|name| DataItem::new(DataType::UNSIGNED16, (*name).into()))
            .collect(),
    })
}

fn record() -> ParameterRecord {
    ParameterRecord {
        index: 100,
        length: 4,
        sequence: 1,
        name: id("T_INFO"),
        constants: vec![Constant {
            offset: 0,
            data: vec![0, 1, 2, 3],
        }],
        parameters: vec![ParameterRef {
            id: Some("P_1".into()),
            data_type: "BitArea".into(),
            offset: 1,
            bit_offset: Some(2),
            bit_length: Some(2),
            length: None,
            default: Some("1".into()),
            allowed: Some("0..2".into()),
            changeable: true,
            visible: false,
            values: Some("V_1".into()),
            text: id("T_INFO"),
        }],
        menus: vec![
            Menu {
                id: "MENU_A".into(),
                name: id("T_INFO"),
                entries: vec![MenuEntry::Menu("MENU_B".into())],
            },
            Menu {
                id: "MENU_B".into(),
                name: id("T_INFO"),
                entries: vec![MenuEntry::Parameter("P_1".into())],
            },
        ],
    }
}

fn access_point() -> AccessPoint {
    let reference = |target: &str| ModuleRef {
        target: target.into(),
        allowed: list("1"),
        used: ValueList::EMPTY,
        fixed: ValueList::EMPTY,
    };
    let mut dap = submodule("S_DAP", 1);
    dap.writable_im = list("1..4");
    AccessPoint {
        id: "DAP_1".into(),
        info: ModuleInfo {
            vendor: Some("Vendor".into()),
            order_number: Some("D-1".into()),
            hardware: Some("1".into()),
            software: Some("V1.0".into()),
            category: Some("C_1".into()),
            ..info("T_INFO")
        },
        module_ident: 1,
        pnio_version: Some(SchemaVersion::WRITTEN),
        required_schema: Some("V2.3".parse().unwrap()),
        physical_slots: list("0..1"),
        fixed_in_slots: list("0"),
        min_device_interval: 512,
        dns_name: Some("drive".into()),
        object_instance: 1,
        features: Features {
            multiple_write: true,
            check_device_id: true,
            lldp_nod: true,
            device_access: Some(true),
            ..Features::default()
        },
        address_assignment: vec!["DCP".into()],
        reset_modes: list("2"),
        device_access_ars: Some(2),
        max_record: Some(65535),
        certification: Some(Certification {
            conformance_class: "B".into(),
            application_class: Vec::new(),
            netload_class: Some("I".into()),
        }),
        subslots: vec![SubslotName {
            number: 1,
            text: "T_INFO".into(),
        }],
        io_limits: IoLimits {
            input: 9,
            output: 9,
            both: Some(18),
        },
        modules: vec![reference("M_1"), reference("M_2")],
        virtual_submodules: vec![dap],
        interface: Some(Interface {
            id: "S_IF".into(),
            subslot: 0x8000,
            ident: 2,
            text: id("T_INFO"),
            rt_classes: vec!["RT_CLASS_1".into()],
            protocols: vec!["SNMP".into(), "LLDP".into()],
            dcp_hello: false,
            ptp_boundary: true,
            dcp_boundary: true,
            ars: 1,
            start_up: vec!["Legacy".into(), "Advanced".into()],
            send_clocks: list("32"),
            reduction_ratios: list("1 2 4 8 16 32 64 128 256 512"),
        }),
        ports: vec![Port {
            id: "S_P1".into(),
            subslot: 0x8001,
            ident: 3,
            text: id("T_INFO"),
            rx_delay: Some(350),
            tx_delay: Some(160),
            mau_types: vec![16],
        }],
        submodules: Vec::new(),
        graphics: vec![GraphicRef {
            kind: "DeviceSymbol".into(),
            target: "G_1".into(),
        }],
    }
}

/// Returns the description.
pub fn description() -> Gsdml {
    let mut telegram = submodule("S_1", 0x11);
    telegram.api = 0x3A00;
    telegram.io.input = words(&["T_M1", "T_M2"]);
    telegram.io.output = words(&["T_M1", "T_INFO"]);
    telegram.records = vec![record()];
    let mut parameters = submodule("S_2", 0x21);
    parameters.api = 0x3A00;
    let mut word = submodule("S_3", 0x22);
    word.api = 0x3A00;
    word.fixed_in_subslots = list("2");
    word.io.input = words(&["T_M1"]);
    if let Some(item) = word.io.input.as_mut().and_then(|data| data.items.first_mut()) {
        item.use_as_bits = true;
        item.bits = vec![BitItem {
            offset: 15,
            text: id("T_INFO"),
        }];
    }
    let module = |name: &str, ident, text: &str, submodules| Module {
        id: name.into(),
        ident,
        info: info(text),
        physical_subslots: list("1..3"),
        subslots: Vec::new(),
        submodules: Vec::new(),
        virtual_submodules: submodules,
        graphics: Vec::new(),
    };
    let mut second = module("M_2", 0x12, "T_M2", vec![parameters, word]);
    second.submodules = vec![SubmoduleRef {
        target: "P_S".into(),
        allowed: list("3"),
        used: list("3"),
        fixed: ValueList::EMPTY,
    }];
    let mut texts = Texts::default();
    texts.add("T_INFO", "Some <words> & \"signs\"");
    let first = texts.add("T_M1", "Telegram 1");
    texts.add("T_M2", "Telegram 2");
    texts.translate("de", &first, "Telegramm 1");
    Gsdml {
        schema_version: Some(SchemaVersion::WRITTEN),
        identity: DeviceIdentity {
            vendor_id: 0x0105,
            device_id: 1,
            info: id("T_INFO"),
            vendor: "Vendor".into(),
        },
        family: Family {
            main: "Drives".into(),
            product: Some("Drive".into()),
        },
        access_points: vec![access_point()],
        modules: vec![module("M_1", 0x11, "T_M1", vec![telegram]), second],
        submodules: vec![submodule("P_S", 0x31)],
        values: vec![ValueItem {
            id: "V_1".into(),
            assignments: vec![("0".into(), "T_M1".into()), ("1".into(), "T_M2".into())],
        }],
        channel_diagnoses: vec![ChannelDiagnosis {
            error_type: 256,
            name: id("T_M1"),
            help: id("T_INFO"),
        }],
        graphics: vec![Graphic {
            id: "G_1".into(),
            file: "GSDML-0105-0001-X".into(),
        }],
        categories: vec![Category {
            id: "C_1".into(),
            text: id("T_INFO"),
        }],
        texts,
    }
}

// Generated from data/vlt/device.toml by `cargo run -p xtask -- gen`.

use crate::catalogue::{DescriptionFacts, Device, Layout, ParameterPoint, TelegramModule, Words};

pub static DEVICE: Device = Device {
    vendor_id: 0x0080,
    device_id: 0x0001,
    vendor: "Danfoss",
    station_type: "VLT FC",
    order_id: "FC-302PK75T5E20",
    hardware_revision: 1,
    software_revision: [7, 51, 0],
    api: 0x3a00,
    drive_unit_type: 302,
    firmware_year: 2017,
    firmware_day_month: 112,
    access_point_module: 2,
    access_point_submodule: 1,
    interface_submodule: 2,
    port_submodule: 3,
    ports: 2,
    layout: Layout {
        telegram: 2,
        parameters: ParameterPoint {
            subslot: 1,
            submodule: Some(65535),
        },
        records: &[],
    },
    min_device_interval: 128,
    telegrams: &[
        TelegramModule {
            telegram: 1,
            module: 0x00010001,
            submodule: 0x00000001,
            outputs: 4,
            inputs: 4,
            words: Words {
                english: "Standard telegram 1",
                german: "Standardtelegramm 1",
            },
        },
        TelegramModule {
            telegram: 101,
            module: 0x00010065,
            submodule: 0x00000065,
            outputs: 12,
            inputs: 12,
            words: Words {
                english: "PPO type 1: parameter channel and two words",
                german: "PPO-Typ 1: Parameterkanal und zwei Wörter",
            },
        },
        TelegramModule {
            telegram: 102,
            module: 0x00010066,
            submodule: 0x00000066,
            outputs: 20,
            inputs: 20,
            words: Words {
                english: "PPO type 2: parameter channel and six words",
                german: "PPO-Typ 2: Parameterkanal und sechs Wörter",
            },
        },
        TelegramModule {
            telegram: 103,
            module: 0x00010067,
            submodule: 0x00000067,
            outputs: 4,
            inputs: 4,
            words: Words {
                english: "PPO type 3: two words",
                german: "PPO-Typ 3: zwei Wörter",
            },
        },
        TelegramModule {
            telegram: 104,
            module: 0x00000100,
            submodule: 0x00000068,
            outputs: 12,
            inputs: 12,
            words: Words {
                english: "PPO type 4: six words",
                german: "PPO-Typ 4: sechs Wörter",
            },
        },
        TelegramModule {
            telegram: 105,
            module: 0x00010069,
            submodule: 0x00000069,
            outputs: 28,
            inputs: 28,
            words: Words {
                english: "PPO type 5: parameter channel and ten words",
                german: "PPO-Typ 5: Parameterkanal und zehn Wörter",
            },
        },
        TelegramModule {
            telegram: 106,
            module: 0x0001006a,
            submodule: 0x0000006a,
            outputs: 20,
            inputs: 20,
            words: Words {
                english: "PPO type 6: ten words",
                german: "PPO-Typ 6: zehn Wörter",
            },
        },
        TelegramModule {
            telegram: 107,
            module: 0x0001006b,
            submodule: 0x0000006b,
            outputs: 24,
            inputs: 24,
            words: Words {
                english: "PPO type 7: parameter channel and eight words",
                german: "PPO-Typ 7: Parameterkanal und acht Wörter",
            },
        },
        TelegramModule {
            telegram: 108,
            module: 0x0001006c,
            submodule: 0x0000006c,
            outputs: 16,
            inputs: 16,
            words: Words {
                english: "PPO type 8: eight words",
                german: "PPO-Typ 8: acht Wörter",
            },
        },
    ],
    description: DescriptionFacts {
        date: 20261121,
        family: "VLT-profidrive",
        product_family: "VLT (profidrive)",
        dns_name: "vlt",
        name: "VLT FC 302",
        words: Words {
            english: "Virtual Danfoss VLT AutomationDrive FC 302 with PROFINET",
            german: "Virtueller Frequenzumrichter Danfoss VLT AutomationDrive FC 302 mit PROFINET",
        },
        conformance_class: "B",
        netload_class: "I",
        protocols: &["SNMP", "LLDP"],
        port_rx_delay: 350,
        port_tx_delay: 160,
    },
};

// Generated from data/vacon/device.toml by `cargo run -p xtask -- gen`.

use crate::catalogue::{DescriptionFacts, Device, Layout, ParameterPoint, RecordView, TelegramModule, Words};

pub static DEVICE: Device = Device {
    vendor_id: 0x01ba,
    device_id: 0x0100,
    vendor: "Vacon",
    station_type: "Vacon 100",
    order_id: "VACON0100-3L-0003-5",
    hardware_revision: 1,
    software_revision: [1, 0, 0],
    api: 0x3a00,
    drive_unit_type: 2,
    firmware_year: 2014,
    firmware_day_month: 101,
    access_point_module: 1,
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
        records: &[
            RecordView {
                subslot: 1,
                octets: 2,
            },
            RecordView {
                subslot: 2,
                octets: 4,
            },
        ],
    },
    min_device_interval: 128,
    telegrams: &[
        TelegramModule {
            telegram: 1,
            module: 0x00010001,
            submodule: 0x00010001,
            outputs: 4,
            inputs: 4,
            words: Words {
                english: "Standard telegram 1",
                german: "Standardtelegramm 1",
            },
        },
        TelegramModule {
            telegram: 148,
            module: 0x00010094,
            submodule: 0x00010094,
            outputs: 4,
            inputs: 4,
            words: Words {
                english: "Vendor telegram: control word and speed",
                german: "Herstellertelegramm: Steuerwort und Drehzahl",
            },
        },
        TelegramModule {
            telegram: 149,
            module: 0x00010095,
            submodule: 0x00010095,
            outputs: 12,
            inputs: 12,
            words: Words {
                english: "Vendor telegram: control word, speed and four process data",
                german: "Herstellertelegramm: Steuerwort, Drehzahl und vier Prozessdaten",
            },
        },
        TelegramModule {
            telegram: 150,
            module: 0x00010096,
            submodule: 0x00010096,
            outputs: 20,
            inputs: 20,
            words: Words {
                english: "Vendor telegram: control word, speed and eight process data",
                german: "Herstellertelegramm: Steuerwort, Drehzahl und acht Prozessdaten",
            },
        },
    ],
    description: DescriptionFacts {
        date: 20261121,
        family: "Vacon100-profidrive",
        product_family: "Vacon (profidrive)",
        dns_name: "vacon",
        name: "Vacon 100",
        words: Words {
            english: "Virtual Vacon 100 with PROFINET",
            german: "Virtueller Frequenzumrichter Vacon 100 mit PROFINET",
        },
        conformance_class: "B",
        netload_class: "I",
        protocols: &["SNMP", "LLDP"],
        port_rx_delay: 350,
        port_tx_delay: 160,
    },
};

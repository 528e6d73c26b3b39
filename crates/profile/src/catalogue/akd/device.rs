// Generated from data/akd/device.toml by `cargo run -p xtask -- gen`.

use crate::catalogue::{DescriptionFacts, Device, Layout, ParameterPoint, TelegramModule, Words};

pub static DEVICE: Device = Device {
    vendor_id: 0x0105,
    device_id: 0x0001,
    vendor: "Kollmorgen",
    station_type: "AKD",
    order_id: "AKD-P00306-NBPN-0000",
    hardware_revision: 1,
    software_revision: [1, 17, 0],
    api: 0x3a00,
    drive_unit_type: 1,
    firmware_year: 2017,
    firmware_day_month: 110,
    access_point_module: 1,
    access_point_submodule: 1,
    interface_submodule: 2,
    port_submodule: 3,
    ports: 1,
    layout: Layout {
        telegram: 1,
        parameters: ParameterPoint {
            subslot: 1,
            submodule: None,
        },
        records: &[],
    },
    min_device_interval: 512,
    telegrams: &[
        TelegramModule {
            telegram: 1,
            module: 0x00010001,
            submodule: 0x00010001,
            outputs: 4,
            inputs: 4,
            words: Words {
                english: "Speed setpoint",
                german: "Drehzahlsollwert",
            },
        },
        TelegramModule {
            telegram: 7,
            module: 0x00010007,
            submodule: 0x00010007,
            outputs: 4,
            inputs: 4,
            words: Words {
                english: "Selection of motion tasks",
                german: "Auswahl von Fahraufträgen",
            },
        },
        TelegramModule {
            telegram: 9,
            module: 0x00010009,
            submodule: 0x00010009,
            outputs: 20,
            inputs: 10,
            words: Words {
                english: "Selection of motion tasks and direct positioning (MDI)",
                german: "Auswahl von Fahraufträgen und direkte Positionierung (MDI)",
            },
        },
        TelegramModule {
            telegram: 350,
            module: 0x0001015e,
            submodule: 0x0001015e,
            outputs: 4,
            inputs: 6,
            words: Words {
                english: "Speed setpoint; with actual current",
                german: "Drehzahlsollwert; mit Stromistwert",
            },
        },
        TelegramModule {
            telegram: 351,
            module: 0x0001015f,
            submodule: 0x0001015f,
            outputs: 4,
            inputs: 10,
            words: Words {
                english: "Speed setpoint; with actual current and position",
                german: "Drehzahlsollwert; mit Strom- und Lageistwert",
            },
        },
        TelegramModule {
            telegram: 352,
            module: 0x00010160,
            submodule: 0x00010160,
            outputs: 24,
            inputs: 10,
            words: Words {
                english: "Positioning as telegram 9 with homing distance",
                german: "Positionierung wie Telegramm 9 mit Referenzweg",
            },
        },
        TelegramModule {
            telegram: 353,
            module: 0x00010161,
            submodule: 0x00010161,
            outputs: 26,
            inputs: 10,
            words: Words {
                english: "Positioning as telegram 9 with homing distance and mode",
                german: "Positionierung wie Telegramm 9 mit Referenzweg und -modus",
            },
        },
        TelegramModule {
            telegram: 354,
            module: 0x00010162,
            submodule: 0x00010162,
            outputs: 8,
            inputs: 4,
            words: Words {
                english: "Speed setpoint with both ramps",
                german: "Drehzahlsollwert mit beiden Rampen",
            },
        },
        TelegramModule {
            telegram: 400,
            module: 0x00010190,
            submodule: 0x00010190,
            outputs: 24,
            inputs: 24,
            words: Words {
                english: "Free mapping by PNU 915 and 916, as delivered like telegram 9",
                german: "Freie Belegung über PNU 915 und 916, Lieferzustand wie Telegramm 9",
            },
        },
        TelegramModule {
            telegram: 0,
            module: 0x00010000,
            submodule: 0x00010000,
            outputs: 24,
            inputs: 24,
            words: Words {
                english: "Free mapping by PNU 915 and 916",
                german: "Freie Belegung über PNU 915 und 916",
            },
        },
    ],
    description: DescriptionFacts {
        date: 20261121,
        family: "AKD-profidrive",
        product_family: "AKD (profidrive)",
        dns_name: "akd",
        name: "AKD",
        words: Words {
            english: "Virtual Kollmorgen AKD servo drive with PROFIdrive telegrams",
            german: "Virtueller Servoantrieb Kollmorgen AKD mit PROFIdrive-Telegrammen",
        },
        conformance_class: "B",
        netload_class: "I",
        protocols: &["SNMP", "LLDP"],
        port_rx_delay: 350,
        port_tx_delay: 160,
    },
};

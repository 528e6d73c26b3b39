// Generated from data/vacon/meanings.csv by `cargo run -p xtask -- gen`.

use crate::catalogue::Meaning;

#[rustfmt::skip]
pub static ID108_CHOICES: &[Meaning] = &[
    Meaning { value: 0, text: "Linear" },
    Meaning { value: 1, text: "Squared" },
    Meaning { value: 2, text: "Programmable" },
];

#[rustfmt::skip]
pub static ID109_CHOICES: &[Meaning] = &[
    Meaning { value: 0, text: "Off" },
    Meaning { value: 1, text: "On" },
];

#[rustfmt::skip]
pub static ID172_CHOICES: &[Meaning] = &[
    Meaning { value: 0, text: "I/O control" },
    Meaning { value: 1, text: "Fieldbus control" },
];

#[rustfmt::skip]
pub static ID504_CHOICES: &[Meaning] = &[
    Meaning { value: 0, text: "Disabled" },
    Meaning { value: 1, text: "Enabled: run" },
    Meaning { value: 2, text: "Enabled: run and stop" },
    Meaning { value: 3, text: "Enabled: run, no test" },
];

#[rustfmt::skip]
pub static ID505_CHOICES: &[Meaning] = &[
    Meaning { value: 0, text: "Ramping" },
    Meaning { value: 1, text: "Flying start" },
];

#[rustfmt::skip]
pub static ID506_CHOICES: &[Meaning] = &[
    Meaning { value: 0, text: "Coasting" },
    Meaning { value: 1, text: "Ramping" },
];

#[rustfmt::skip]
pub static ID520_CHOICES: &[Meaning] = &[
    Meaning { value: 0, text: "Disabled" },
    Meaning { value: 1, text: "Enabled" },
];

#[rustfmt::skip]
pub static ID600_CHOICES: &[Meaning] = &[
    Meaning { value: 0, text: "OL frequency" },
    Meaning { value: 1, text: "OL speed" },
];

#[rustfmt::skip]
pub static ID607_CHOICES: &[Meaning] = &[
    Meaning { value: 0, text: "Disabled" },
    Meaning { value: 1, text: "Enabled" },
];

#[rustfmt::skip]
pub static ID608_CHOICES: &[Meaning] = &[
    Meaning { value: 0, text: "Disabled" },
    Meaning { value: 1, text: "Enabled" },
];

#[rustfmt::skip]
pub static ID631_CHOICES: &[Meaning] = &[
    Meaning { value: 0, text: "Not active" },
    Meaning { value: 1, text: "At standstill" },
    Meaning { value: 2, text: "With rotation" },
];

#[rustfmt::skip]
pub static ID700_CHOICES: &[Meaning] = &[
    Meaning { value: 0, text: "No action" },
    Meaning { value: 1, text: "Alarm" },
    Meaning { value: 2, text: "Fault: stop by stop function" },
    Meaning { value: 3, text: "Fault: stop by coasting" },
];

#[rustfmt::skip]
pub static ID701_CHOICES: &[Meaning] = &[
    Meaning { value: 0, text: "No action" },
    Meaning { value: 1, text: "Alarm" },
    Meaning { value: 2, text: "Fault: stop by stop function" },
    Meaning { value: 3, text: "Fault: stop by coasting" },
];

#[rustfmt::skip]
pub static ID702_CHOICES: &[Meaning] = &[
    Meaning { value: 0, text: "No action" },
    Meaning { value: 1, text: "Alarm" },
    Meaning { value: 2, text: "Fault: stop by stop function" },
    Meaning { value: 3, text: "Fault: stop by coasting" },
];

#[rustfmt::skip]
pub static ID703_CHOICES: &[Meaning] = &[
    Meaning { value: 0, text: "No action" },
    Meaning { value: 1, text: "Alarm" },
    Meaning { value: 2, text: "Fault: stop by stop function" },
    Meaning { value: 3, text: "Fault: stop by coasting" },
];

#[rustfmt::skip]
pub static ID704_CHOICES: &[Meaning] = &[
    Meaning { value: 0, text: "No action" },
    Meaning { value: 1, text: "Alarm" },
    Meaning { value: 2, text: "Fault: stop by stop function" },
    Meaning { value: 3, text: "Fault: stop by coasting" },
];

#[rustfmt::skip]
pub static ID709_CHOICES: &[Meaning] = &[
    Meaning { value: 0, text: "No action" },
    Meaning { value: 1, text: "Alarm" },
    Meaning { value: 2, text: "Fault: stop by stop function" },
    Meaning { value: 3, text: "Fault: stop by coasting" },
];

#[rustfmt::skip]
pub static ID713_CHOICES: &[Meaning] = &[
    Meaning { value: 0, text: "No action" },
    Meaning { value: 1, text: "Alarm" },
    Meaning { value: 2, text: "Fault: stop by stop function" },
    Meaning { value: 3, text: "Fault: stop by coasting" },
];

#[rustfmt::skip]
pub static ID719_CHOICES: &[Meaning] = &[
    Meaning { value: 0, text: "Flying start" },
    Meaning { value: 1, text: "According to stop function" },
];

#[rustfmt::skip]
pub static ID730_CHOICES: &[Meaning] = &[
    Meaning { value: 0, text: "No action" },
    Meaning { value: 1, text: "Alarm" },
    Meaning { value: 2, text: "Fault: stop by stop function" },
    Meaning { value: 3, text: "Fault: stop by coasting" },
];

#[rustfmt::skip]
pub static ID731_CHOICES: &[Meaning] = &[
    Meaning { value: 0, text: "Disabled" },
    Meaning { value: 1, text: "Enabled" },
];

#[rustfmt::skip]
pub static ID732_CHOICES: &[Meaning] = &[
    Meaning { value: 0, text: "No action" },
    Meaning { value: 1, text: "Alarm" },
    Meaning { value: 2, text: "Fault: stop by stop function" },
    Meaning { value: 3, text: "Fault: stop by coasting" },
];

#[rustfmt::skip]
pub static ID733_CHOICES: &[Meaning] = &[
    Meaning { value: 0, text: "No action" },
    Meaning { value: 1, text: "Alarm" },
    Meaning { value: 2, text: "Fault: stop by stop function" },
    Meaning { value: 3, text: "Fault: stop by coasting" },
];

#[rustfmt::skip]
pub static ID734_CHOICES: &[Meaning] = &[
    Meaning { value: 0, text: "No action" },
    Meaning { value: 1, text: "Alarm" },
    Meaning { value: 2, text: "Fault: stop by stop function" },
    Meaning { value: 3, text: "Fault: stop by coasting" },
];

#[rustfmt::skip]
pub static P930_CHOICES: &[Meaning] = &[
    Meaning { value: 1, text: "Speed control" },
];

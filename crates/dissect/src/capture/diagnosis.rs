//! Diagnosis of channels, in alarms and in diagnosis records.

use profinet::wire::alarm::{ChannelDiagnosis, DiagnosisItem, Severity, Specifier};

use super::event::Diagnosis;
use super::records;
use crate::Weight;

/// One item: how much it matters, in words, and in numbers where it is that of a channel.
pub struct Item {
    pub weight: Weight,
    pub text: String,
    pub numbers: Option<Diagnosis>,
}

/// Returns an item of an alarm or of a record.
pub fn item(item: &DiagnosisItem<'_>) -> Item {
    match item {
        DiagnosisItem::Channel(channel) => of_channel(channel),
        DiagnosisItem::Maintenance(status) => {
            let words = match (status & 1 != 0, status & 2 != 0) {
                (true, true) => "maintenance required and demanded".into(),
                (true, false) => "maintenance required".into(),
                (false, true) => "maintenance demanded".into(),
                (false, false) if *status == 0 => "no maintenance".into(),
                (false, false) => format!("maintenance status 0x{status:08X}"),
            };
            Item {
                weight: if *status == 0 {
                    Weight::Normal
                } else {
                    Weight::Warning
                },
                text: words,
                numbers: None,
            }
        }
        DiagnosisItem::Other { usi, data } => Item {
            weight: Weight::Warning,
            text: format!("0x{usi:04X} {}", records::content(data)),
            numbers: None,
        },
    }
}

fn of_channel(channel: &ChannelDiagnosis) -> Item {
    let numbers = Diagnosis {
        usi: channel.usi(),
        channel: (channel.channel != ChannelDiagnosis::WHOLE_SUBMODULE).then_some(channel.channel),
        specifier: specifier(channel.specifier()),
        severity: severity(channel.severity()),
        error_type: channel.error_type,
        error: channel.error_words(),
        ext_error_type: channel.extended.map(|(error, _)| error),
        add_value: channel.extended.map(|(_, value)| value),
        qualifier: channel.qualifier,
    };
    let direction = match channel.properties >> 13 {
        1 => "input ",
        2 => "output ",
        3 => "input and output ",
        _ => "",
    };
    let place = match numbers.channel {
        Some(number) => format!("{direction}channel {number}"),
        None => "whole submodule".to_owned(),
    };
    let words = numbers.error.unwrap_or("error of the vendor or profile");
    let severity = match channel.severity() {
        Severity::Fault => String::new(),
        _ => format!("{}, ", numbers.severity),
    };
    let mut text = format!(
        "{place}: {severity}{words} (0x{:04X}) {}",
        numbers.error_type, numbers.specifier
    );
    if let Some((error, value)) = channel.extended {
        text = format!("{text}, extended error 0x{error:04X}, value 0x{value:08X}");
    }
    if let Some(qualifier) = channel.qualifier {
        text = format!("{text}, qualifier 0x{qualifier:08X}");
    }
    let weight = match channel.specifier() {
        Specifier::Appears | Specifier::DisappearsOthersRemain => Weight::Warning,
        Specifier::Disappears | Specifier::AllDisappear => Weight::Normal,
    };
    Item {
        weight,
        text,
        numbers: Some(numbers),
    }
}

const fn specifier(specifier: Specifier) -> &'static str {
    match specifier {
        Specifier::Appears => "appears",
        Specifier::Disappears => "disappears",
        Specifier::DisappearsOthersRemain => "disappears, others remain",
        Specifier::AllDisappear => "all disappear",
    }
}

const fn severity(severity: Severity) -> &'static str {
    match severity {
        Severity::Fault => "fault",
        Severity::MaintenanceRequired => "maintenance required",
        Severity::MaintenanceDemanded => "maintenance demanded",
        Severity::Qualified => "qualified",
    }
}

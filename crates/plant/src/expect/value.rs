//! Single values of an expectation as TOML.

use std::time::Duration;

use profile::notation::Quantity as Written;
use profile::state::{Stw1, Zsw1};
use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::condition::{Numbers, Test};
use super::expectation::quoted;
use crate::located::Located;
use crate::plan::DrivePlan;
use crate::text::time;

pub(super) type Value<'a> = Spanned<DeValue<'a>>;

pub(super) fn wrong(value: &Value<'_>, message: &str) -> Located {
    Located(value.span(), message.to_owned())
}

pub(super) fn table<'a, 'b>(value: &'b Value<'a>) -> Result<&'b DeTable<'a>, Located> {
    match value.get_ref() {
        DeValue::Table(table) => Ok(table),
        _ => Err(wrong(value, "a table is expected, { KEY = VALUE, .. }")),
    }
}

pub(super) fn text<'a>(value: &'a Value<'_>) -> Result<&'a str, Located> {
    match value.get_ref() {
        DeValue::String(text) => Ok(text),
        _ => Err(wrong(value, "a text is expected, \"..\"")),
    }
}

pub(super) fn get<'a, 'b>(table: &'b DeTable<'a>, key: &str) -> Option<&'b Value<'a>> {
    table
        .iter()
        .find(|(name, _)| name.get_ref() == key)
        .map(|(_, value)| value)
}

pub(super) fn duration(value: &Value<'_>) -> Result<Duration, Located> {
    time(text(value)?).map_err(|message| wrong(value, &message))
}

/// Returns a number in `unit`.
pub(super) fn number(text: &str, unit: &str) -> Result<f64, String> {
    let quantity: Written = text.trim().parse().map_err(|error| format!("{error}"))?;
    let number = quantity.in_unit(unit).map_err(|error| error.to_string())?;
    if number.is_finite() {
        Ok(number)
    } else {
        Err(format!("`{text}` is not a finite number"))
    }
}

/// Returns half the width around a target: `2rpm` or `1%` of it.
pub(super) fn tolerance(value: &Value<'_>, target: f64, unit: &str) -> Result<f64, Located> {
    let written = text(value)?;
    let half = match written.trim().strip_suffix('%').filter(|_| unit != "%") {
        Some(share) => number(share, "").map(|share| target.abs() * share / 100.0),
        None => number(written, unit),
    };
    let half = half.map_err(|message| wrong(value, &format!("tolerance: {message}")))?;
    if half < 0.0 {
        return Err(wrong(value, "a tolerance is not negative"));
    }
    Ok(half)
}

pub(super) fn states(value: &Value<'_>) -> Result<Vec<u8>, Located> {
    let state = |text: &str| match text.trim() {
        "S1" => Ok(1),
        "S2" => Ok(2),
        "S3" => Ok(3),
        "S4" => Ok(4),
        "S5" => Ok(5),
        other => Err(wrong(
            value,
            &format!("`{other}`: states are S1 to S5, several as \"S1|S2\""),
        )),
    };
    text(value)?.split('|').map(state).collect()
}

pub(super) fn numbers(value: &Value<'_>, warnings: bool, drive: &DrivePlan) -> Result<Numbers, Located> {
    let kind = if warnings { "warning" } else { "fault" };
    let form = format!("a {kind} is a number, a list of numbers, \"none\" or \"any\"");
    let one = |value: &Value<'_>| {
        let number = match value.get_ref() {
            DeValue::Integer(written) => written.to_string().parse::<u16>().ok(),
            _ => None,
        };
        let number = number.ok_or_else(|| wrong(value, &form))?;
        match drive.model.catalogue.fault(number, warnings) {
            Some(_) => Ok(number),
            None => Err(wrong(
                value,
                &format!(
                    "{}: {} has no {kind} {number}",
                    drive.name, drive.model.catalogue.device.station_type
                ),
            )),
        }
    };
    match value.get_ref() {
        DeValue::String(text) if text == "none" => Ok(Numbers::None),
        DeValue::String(text) if text == "any" => Ok(Numbers::Any),
        DeValue::Array(list) if !list.is_empty() => {
            Ok(Numbers::These(list.iter().map(one).collect::<Result<_, _>>()?))
        }
        _ => Ok(Numbers::These(vec![one(value)?])),
    }
}

/// Names of the bits of the status word, as the library has them.
const ZSW1: [(&str, Zsw1); 15] = [
    ("READY_TO_SWITCH_ON", Zsw1::READY_TO_SWITCH_ON),
    ("READY_TO_OPERATE", Zsw1::READY_TO_OPERATE),
    ("OPERATION_ENABLED", Zsw1::OPERATION_ENABLED),
    ("FAULT", Zsw1::FAULT),
    ("NO_COAST_STOP", Zsw1::NO_COAST_STOP),
    ("NO_QUICK_STOP", Zsw1::NO_QUICK_STOP),
    ("INHIBITED", Zsw1::INHIBITED),
    ("WARNING", Zsw1::WARNING),
    ("IN_TOLERANCE", Zsw1::IN_TOLERANCE),
    ("CONTROL_REQUESTED", Zsw1::CONTROL_REQUESTED),
    ("REACHED", Zsw1::REACHED),
    ("HOMED", Zsw1::HOMED),
    ("TASK_ACKNOWLEDGED", Zsw1::TASK_ACKNOWLEDGED),
    ("STOPPED", Zsw1::STOPPED),
    ("TASK_ACTIVE", Zsw1::TASK_ACTIVE),
];

/// Names of the bits of the control word.
const STW1: [(&str, Stw1); 17] = [
    ("ON", Stw1::ON),
    ("NO_COAST_STOP", Stw1::NO_COAST_STOP),
    ("NO_QUICK_STOP", Stw1::NO_QUICK_STOP),
    ("ENABLE_OPERATION", Stw1::ENABLE_OPERATION),
    ("ENABLE_RAMP", Stw1::ENABLE_RAMP),
    ("NO_REJECT", Stw1::NO_REJECT),
    ("UNFREEZE_RAMP", Stw1::UNFREEZE_RAMP),
    ("NO_INTERMEDIATE_STOP", Stw1::NO_INTERMEDIATE_STOP),
    ("ENABLE_SETPOINT", Stw1::ENABLE_SETPOINT),
    ("ACTIVATE_TASK", Stw1::ACTIVATE_TASK),
    ("ACKNOWLEDGE_FAULT", Stw1::ACKNOWLEDGE_FAULT),
    ("JOG_1", Stw1::JOG_1),
    ("JOG_2", Stw1::JOG_2),
    ("CONTROL_BY_PLC", Stw1::CONTROL_BY_PLC),
    ("START_HOMING", Stw1::START_HOMING),
    ("REAL_TIME_JOG", Stw1::REAL_TIME_JOG),
    ("REAL_TIME_JOG_REVERSE", Stw1::REAL_TIME_JOG_REVERSE),
];

/// `0x0737/0x0FFF`, `0x0737`, or names of bits, those that must be 0 with a `!`.
pub(super) fn word(value: &Value<'_>, status: bool) -> Result<Test, Located> {
    let written = text(value)?.trim();
    let number = |text: &str| {
        let digits = text.trim().strip_prefix("0x").unwrap_or("");
        u16::from_str_radix(digits, 16)
            .map_err(|_| wrong(value, &format!("`{text}` is not a word, 0x0000 to 0xFFFF")))
    };
    let (mut mask, mut wanted) = (0, 0);
    if written.starts_with("0x") {
        let (word, only) = written.split_once('/').unwrap_or((written, "0xFFFF"));
        (wanted, mask) = (number(word)?, number(only)?);
    } else {
        for name in written.split_whitespace() {
            let bare = name.strip_prefix('!').unwrap_or(name);
            let bit = if status {
                ZSW1.iter()
                    .find(|(known, _)| *known == bare)
                    .map(|(_, bit)| bit.0)
            } else {
                STW1.iter()
                    .find(|(known, _)| *known == bare)
                    .map(|(_, bit)| bit.0)
            };
            let bit = bit.ok_or_else(|| {
                let zsw1 = ZSW1.iter().map(|(name, _)| *name).filter(|_| status);
                let stw1 = STW1.iter().map(|(name, _)| *name).filter(|_| !status);
                let names: Vec<_> = zsw1.chain(stw1).collect();
                wrong(
                    value,
                    &format!("no bit `{bare}`; there are: {}", names.join(", ")),
                )
            })?;
            mask |= bit;
            if bare == name {
                wanted |= bit;
            } else if wanted & bit != 0 {
                return Err(wrong(value, &format!("`{bare}` cannot be 0 and 1")));
            }
        }
    }
    if wanted & !mask != 0 || mask == 0 {
        return Err(wrong(
            value,
            "a word is VALUE/MASK, and VALUE has no bit outside of MASK; or names of bits",
        ));
    }
    Ok(Test::Word {
        status,
        mask,
        value: wanted,
    })
}

/// The entries of a table as TOML, in the order in which they were written; without one key.
pub(super) fn entries(table: &DeTable<'_>, without: &str) -> Vec<String> {
    let mut all: Vec<_> = table.iter().filter(|(key, _)| key.get_ref() != without).collect();
    all.sort_by_key(|(key, _)| key.span().start);
    all.into_iter()
        .map(|(key, value)| entry(key.get_ref(), value))
        .collect()
}

/// `key = value` as TOML.
pub(super) fn entry(key: &str, value: &Value<'_>) -> String {
    let bare = !key.is_empty()
        && key
            .bytes()
            .all(|octet| octet.is_ascii_alphanumeric() || matches!(octet, b'-' | b'_'));
    let key = if bare { key.to_owned() } else { quoted(key) };
    format!("{key} = {}", written(value))
}

pub(super) fn written(value: &Value<'_>) -> String {
    match value.get_ref() {
        DeValue::String(text) => quoted(text),
        DeValue::Integer(number) => number.to_string(),
        DeValue::Float(number) => number.to_string(),
        DeValue::Boolean(is) => is.to_string(),
        DeValue::Datetime(time) => time.to_string(),
        DeValue::Array(list) => {
            let items: Vec<_> = list.iter().map(written).collect();
            format!("[{}]", items.join(", "))
        }
        DeValue::Table(table) => {
            format!("{{ {} }}", entries(table, "").join(", "))
        }
    }
}

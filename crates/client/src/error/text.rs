//! The words that messages are made of.

use std::time::Duration;

use profile::catalogue::name_distance;
use profile::notation::{figures, fixed};
use profile::state::Mode;
use profinet::MacAddress;
use profinet::controller::{ServiceError, Station};

use super::MoveEnd;
use crate::axis::{Objection, SpeedUnit};
use crate::{ClosedRoute, DriveAddress, LossAction, LossReaction};

/// Describes the octets received instead of an answer.
pub(super) fn in_place(telegrams: u64, noise: u64) -> String {
    match (telegrams, noise) {
        (0, 0) => "; the line is silent".into(),
        (_, 0) => "; others answer on this line".into(),
        _ => format!("; {noise} octets or invalid telegrams were received"),
    }
}

/// Returns the parameter that scales NSOLL_A.
pub(super) fn scaling_text(scaling: Option<&(String, u16)>) -> String {
    scaling.map_or_else(String::new, |(name, value)| {
        format!(" (NSOLL_A with {name} = {value})")
    })
}

/// Returns the owner of the drive.
pub(super) fn owner_text(controller: Option<&str>) -> String {
    match controller {
        Some(name) if !name.is_empty() => format!("controller \"{}\"", name.escape_debug()),
        _ => "another controller".into(),
    }
}

/// Returns the ways that were tried, each with its reason.
pub(super) fn closed_text(closed: &[ClosedRoute]) -> String {
    let texts: Vec<String> = closed.iter().map(ToString::to_string).collect();
    if texts.is_empty() {
        return String::new();
    }
    format!(" ({})", texts.join("; "))
}

/// Several devices with one address.
pub(super) fn holders_text(macs: &[MacAddress]) -> String {
    match macs {
        [] | [_] => String::new(),
        several => format!(": {} have this IP address", join(several)),
    }
}

/// PNU 930 in words.
pub(crate) const fn mode_words(mode: Mode) -> &'static str {
    match mode {
        Mode::Velocity => "velocity mode (PNU 930 = 1)",
        Mode::Position => "position mode (PNU 930 = 2)",
    }
}

/// Returns the operation and the cause of its failure, without repeating the operation when the cause begins with it.
pub(super) fn once(what: &str, error: &ServiceError) -> String {
    let error = error.to_string();
    if error.starts_with(what) {
        error
    } else {
        format!("{what}: {error}")
    }
}

/// Words the reaction of the drive to a lost controller, by its settings; later changes by other clients are not
/// visible.
pub(super) fn reaction_text(reaction: &Option<Box<LossReaction>>) -> String {
    let since = |reaction: &LossReaction| match reaction.action {
        LossAction::KeepsTurning => ", unless something else has stopped it meanwhile",
        LossAction::Unknown => "",
        // a drive that was restarted coasts
        _ => ", unless it restarted: then it coasts",
    };
    reaction
        .as_ref()
        .map_or_else(String::new, |reaction| format!("; {reaction}{}", since(reaction)))
}

/// Returns which speed is above which limit, also where one of them is no number.
pub(super) fn speed_limit_text(wanted: f64, limit: f64, unit: &str) -> String {
    if wanted.is_nan() {
        return "the speed is not a number (NaN), so no axis can have it".into();
    }
    if limit.is_nan() {
        return "the limit of the speed is not a number (NaN), so no speed is within it".into();
    }
    let limit = figures(limit);
    if wanted.is_infinite() {
        return format!("an infinite speed is above the limit of {limit} {unit}");
    }
    format!("{} {unit} is above the limit of {limit} {unit}", figures(wanted))
}

pub(super) fn speed_text(speed: Option<f64>, unit: &str) -> String {
    speed.map_or_else(
        || "not reported".into(),
        |speed| format!("{} {unit}", fixed(speed, 1)),
    )
}

/// Returns why a move ended early, where the axis stands and where it should stand.
pub(super) fn move_ended_text(end: MoveEnd, position: Option<f64>, target: Option<f64>) -> String {
    let why = match end {
        MoveEnd::Halted => "the motion was halted before its target",
        MoveEnd::Travel => {
            "the motion was halted at the end of the travel of this session, before its target"
        }
        MoveEnd::Paused => "an intermediate stop holds the motion before its target",
    };
    // a thousandth of a turn, as elsewhere
    let turns = |turns: f64| figures((turns * 1000.0).round() / 1000.0 + 0.0);
    let stands = position.map_or_else(String::new, |at| format!(": the axis is at {} rev", turns(at)));
    let wanted = target.map_or_else(String::new, |target| {
        let before = if position.is_some() { ", " } else { ": " };
        format!("{before}the target is {} rev", turns(target))
    });
    format!("{why}{stands}{wanted}")
}

/// Returns the speed of an axis that should have moved.
pub(super) fn highest_text(speed: Option<f64>, unit: &str) -> String {
    speed.map_or_else(String::new, |speed| {
        format!(", its highest speed was {speed:.1} {unit}")
    })
}

pub(super) const fn unit_text(wanted: SpeedUnit) -> &'static str {
    match wanted {
        SpeedUnit::Rpm => {
            "its speed setpoint is a percentage of its reference speed, which is not known in rpm"
        }
        SpeedUnit::Percent => "its speed setpoint is in rpm, there is no reference to take percent of",
    }
}

pub(super) const fn frequency_text(converter: bool) -> &'static str {
    if converter {
        "pole pairs, nominal frequency and nominal speed of its motor are not known"
    } else {
        "it is not a frequency converter"
    }
}

pub(super) fn telegram_text(number: Option<u16>) -> String {
    number.map_or_else(
        || "an unknown telegram".into(),
        |number| format!("telegram {number}"),
    )
}

pub(super) fn objections_text(objections: &[Objection]) -> String {
    let texts: Vec<String> = objections.iter().map(ToString::to_string).collect();
    texts.join("; ")
}

/// Most stations of a list in a message.
const MOST_LISTED: usize = 8;

/// Lists the stations that answered instead; of many those with the most similar names.
pub(super) fn others(drive: &DriveAddress, stations: &[Station]) -> String {
    if stations.is_empty() {
        return "; no other station answered".into();
    }
    let mut nearest: Vec<&Station> = stations.iter().collect();
    if nearest.len() > MOST_LISTED {
        nearest.sort_by_cached_key(|station| {
            let far = match drive {
                DriveAddress::Name(name) => name_distance(name, &station.name) as u64,
                DriveAddress::Ip(ip) => u32::from(*ip).abs_diff(station.ip.address.into()).into(),
                DriveAddress::Mac(mac) => number(*mac).abs_diff(number(station.mac)),
                DriveAddress::Line(_) => 0,
            };
            (far, station.name.clone(), station.mac)
        });
    }
    let more = nearest.len().saturating_sub(MOST_LISTED);
    let names: Vec<String> = nearest.into_iter().take(MOST_LISTED).map(describe).collect();
    let list = names.join(", ");
    match more {
        0 => format!("; stations that answered: {list}"),
        _ => format!(
            "; {} stations answered, the nearest: {list} and {more} more",
            stations.len()
        ),
    }
}

fn number(mac: MacAddress) -> u64 {
    mac.0
        .iter()
        .fold(0, |number, octet| number << 8 | u64::from(*octet))
}

/// Returns a station in a few words: `akd-1 (02:50:4e:00:00:01, 10.0.0.2)`.
#[must_use]
pub fn describe(station: &Station) -> String {
    let name = if station.name.is_empty() {
        "no name"
    } else {
        &station.name
    };
    if station.mac == MacAddress::default() && !station.ip.is_set() {
        // at a serial line: its name is where it is
        name.to_owned()
    } else if station.mac == MacAddress::default() {
        // found by its IP address alone
        station.ip.address.to_string()
    } else if station.ip.is_set() {
        format!("{name} ({}, {})", station.mac, station.ip.address)
    } else {
        format!("{name} ({}, no IP address)", station.mac)
    }
}

pub(super) fn join(macs: &[MacAddress]) -> String {
    macs.iter()
        .map(ToString::to_string)
        .collect::<Vec<_>>()
        .join(" and ")
}

/// Times in milliseconds: `1, 2, 4 ms`.
pub(super) fn times_text(times: &[Duration]) -> String {
    let millis: Vec<String> = times
        .iter()
        .map(|time| figures(time.as_secs_f64() * 1e3))
        .collect();
    format!("{} ms", millis.join(", "))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Error;

    fn stations(count: u8) -> Vec<Station> {
        let station = |last| Station {
            name: format!("akd-{last}"),
            mac: MacAddress([2, 0x50, 0x4E, 0, 0, last]),
            ip: profinet::IpSuite {
                address: [10, 0, 0, last].into(),
                ..profinet::IpSuite::NONE
            },
            ..Station::default()
        };
        (1..=count).map(station).collect()
    }

    #[test]
    fn of_many_stations_the_nearest_are_listed() {
        for (drive, first) in [
            ("akd-64x", "akd-64 (02:50:4e:00:00:40, 10.0.0.64)"),
            ("10.0.0.99", "akd-80 (02:50:4e:00:00:50, 10.0.0.80)"),
            ("02:50:4e:00:00:00", "akd-1 (02:50:4e:00:00:01, 10.0.0.1)"),
        ] {
            let not_found = |count| Error::NotFound {
                drive: drive.parse().unwrap(),
                answered: stations(count),
            };
            let message = not_found(80).to_string();
            assert!(
                message.contains(&format!("; 80 stations answered, the nearest: {first}, ")),
                "{message}"
            );
            assert!(message.ends_with(" and 72 more"), "{message}");
            let all = not_found(8).to_string();
            assert!(
                all.contains("; stations that answered: akd-1 (") && all.contains("akd-8 ("),
                "{all}"
            );
        }
    }
}

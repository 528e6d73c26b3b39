//! Where the parameters of a drive stand in its telegram.

use client::{Drive, Refusal, Session};
use profile::catalogue::{Catalogue, Part};
use profile::parameter::pnu;
use profile::telegram::{Direction, Image, Mapping, Signal, Telegram};
use profile::value::{Reading, Selection};

use super::ParameterError;
use crate::report::{TelegramLayout, TelegramPlace, number};

/// Reads what is where in the telegram that a drive has selected (PNU 922), and which of its parameters have the same values: by the
/// names that signals and parameters have in common, and, of words that settings choose, by those settings. A drive without a telegram
/// that is known has no places.
///
/// # Errors
/// When the drive cannot be reached.
pub async fn layout(session: &mut Session, drive: &mut Drive) -> Result<TelegramLayout, ParameterError> {
    let vendor = drive.station.vendor_id;
    let notation = drive.parameters.notation();
    let tables = drive.model.catalogue;
    let telegram = session
        .read(drive, &[Selection::number(pnu::TELEGRAM, notation)])
        .await?;
    let telegram = words(&telegram).first().copied();
    let mut report = TelegramLayout {
        drive: drive.label(),
        telegram,
        places: Vec::new(),
    };
    let Some(known) = telegram.and_then(|number| Telegram::find(number, vendor)) else {
        return Ok(report);
    };
    let halves = [
        (
            Direction::Setpoint,
            &known.setpoint,
            pnu::SETPOINT_SIGNALS,
            Part::ChosenSetpoints,
        ),
        (
            Direction::Actual,
            &known.actual,
            pnu::ACTUAL_SIGNALS,
            Part::ChosenActuals,
        ),
    ];
    for (direction, image, signals, chosen) in halves {
        let mapping = if known.free {
            let all = drive.select(&signals.to_string());
            let all = all.unwrap_or_else(|_| Selection::number(signals, notation));
            let read = session.read(drive, &[all]).await?;
            Mapping::new(used(&words(&read)), vendor, direction).unwrap_or(Mapping::EMPTY)
        } else {
            Mapping::of(image)
        };
        let name = match direction {
            Direction::Setpoint => "setpoint",
            _ => "actual",
        };
        report
            .places
            .extend(mapping.fields().iter().map(|field| TelegramPlace {
                direction: name,
                octet: field.offset,
                octets: field.signal.octets(),
                signal: Some(field.signal.name),
                meaning: field.signal.meaning,
                parameters: tables.map_or_else(Vec::new, |tables| same(tables, field.signal)),
            }));
        let row = tables.and_then(|tables| Some((tables, tables.part(chosen)?)));
        let Some((tables, row)) = row.filter(|_| known.parameters) else {
            continue;
        };
        let read = session
            .read(drive, &[Selection::of(row, tables.notation)])
            .await?;
        report
            .places
            .extend(chosen_places(known, image, name, tables, &words(&read)));
    }
    Ok(report)
}

/// Returns the words that settings choose.
fn chosen_places(
    telegram: &Telegram,
    image: &Image,
    direction: &'static str,
    tables: &'static Catalogue,
    chosen: &[u16],
) -> Vec<TelegramPlace> {
    let places = telegram.parameter_words(image).filter_map(|(index, octet)| {
        let pnu = chosen.get(usize::from(index)).copied().filter(|pnu| *pnu != 0)?;
        let rows = tables.parameters.iter().filter(|row| row.pnu == pnu);
        Some(TelegramPlace {
            direction,
            octet,
            octets: 2,
            signal: None,
            meaning: "",
            parameters: rows.map(|row| number(tables, row)).collect(),
        })
    });
    places.collect()
}

/// Returns the numbers of the parameters with the name of a signal, its own or the common one.
fn same(tables: &'static Catalogue, signal: &Signal) -> Vec<String> {
    let common = |row: &profile::catalogue::Parameter| {
        tables.common_names(row).any(|known| known.name == signal.common)
    };
    let named = |row: &&profile::catalogue::Parameter| row.name == signal.name || common(row);
    tables
        .parameters
        .iter()
        .filter(named)
        .map(|row| number(tables, row))
        .collect()
}

/// Returns the words of an array as far as the drive has it.
fn words(readings: &[Result<Reading, Refusal>]) -> Vec<u16> {
    let raw = readings.iter().flatten().filter_map(Reading::raw);
    raw.filter_map(|raw| u16::try_from(raw).ok()).collect()
}

/// Returns the words of a free telegram up to the last one in use.
fn used(words: &[u16]) -> &[u16] {
    let end = words
        .iter()
        .rposition(|word| *word != 0)
        .map_or(0, |last| last + 1);
    words.get(..end).unwrap_or_default()
}

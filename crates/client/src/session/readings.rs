//! Reads parameters by role (`Part`) instead of by number; the tables of the model map roles to numbers.

use profile::catalogue::{Part, Scaling};
use profile::notation::Notation;
use profile::parameter::Format;
use profile::state::{Profile, Zsw1};
use profile::telegram::{Telegram, signal};

use super::Session;
use crate::{Drive, Error};
use profile::value::{Content, Reading, Selection};

/// Where a drive without tables may have a part; the first number that it has counts.
const WITHOUT_TABLES: [(Part, u16); 7] = [
    (Part::ControlWord, 967),
    (Part::ControlWord, 1),
    (Part::StatusWord, 968),
    (Part::StatusWord, 2),
    (Part::SpeedSetpoint, 5),
    (Part::SpeedActual, 6),
    (Part::FaultSituations, 952),
];

/// What every reply of a serial line carries, also where its parameter channel cannot carry the parameter.
const IN_EVERY_REPLY: [Part; 3] = [Part::StatusWord, Part::SpeedActual, Part::Speed];
/// What the words of a drive at a line may be beside those of PROFIdrive.
const UNKNOWN: [Profile; 1] = [Profile::DanfossFc];
/// Actual value as it travels (N2) up to which the axis stands: 0.2 % of its reference.
const STANDS: u16 = 0x4000 / 500;
/// Actual value (N2) that is 100 %.
const FULL: u16 = 0x4000;
const PERCENT: &str = "%";

/// Values, by the part that their parameter has.
#[derive(Debug)]
pub(super) struct Readings {
    rows: Vec<(Part, Reading)>,
    scaling: Scaling,
    /// Status word and actual value of a serial line, where no parameter has them.
    line: Option<[u16; 2]>,
    /// The actual value of the line that is 100 % of the reference; `None` where it is not a part of one.
    full: Option<u16>,
}

impl Session {
    /// Reads the parameters with these parts in as few jobs as possible; what the model has not or the drive refuses is
    /// left out.
    pub(super) async fn ask(&mut self, drive: &mut Drive, parts: &[Part]) -> Result<Readings, Error> {
        let wanted: Vec<(Part, Selection)> = parts.iter().flat_map(|&part| places(drive, part)).collect();
        let selections: Vec<Selection> = wanted.iter().map(|(_, selection)| *selection).collect();
        let mut rows = Vec::new();
        for reading in self.read_present(drive, &selections).await? {
            let is = |selection: &Selection| {
                let first = selection.first;
                let own = first..first.saturating_add(selection.count);
                selection.pnu == reading.pnu && own.contains(&reading.index.unwrap_or(first))
            };
            let of = wanted.iter().filter(|(_, selection)| is(selection));
            rows.extend(of.map(|(part, _)| (*part, reading.clone())));
        }
        let found = |part: Part| rows.iter().any(|(of, _)| *of == part);
        let lacks = |part: &Part| parts.contains(part) && !found(*part);
        let line = match drive.slave.filter(|_| IN_EVERY_REPLY.iter().any(lacks)) {
            Some(slave) => self.line_words(drive, slave).await?,
            None => None,
        };
        Ok(Readings {
            rows,
            scaling: drive.parameters.scaling,
            line,
            full: full_speed(drive),
        })
    }
}

/// Returns the actual value at a line that is 100 % of the reference of a converter.
fn full_speed(drive: &Drive) -> Option<u16> {
    let tables = drive.model.catalogue?;
    let telegram = Telegram::of_line(drive.station.vendor_id);
    let own = telegram.and_then(|telegram| telegram.full_speed);
    tables.part(Part::Reference).map(|_| own.unwrap_or(FULL))
}

/// Returns the parameters of a drive that have a part.
pub(super) fn places(drive: &Drive, part: Part) -> Vec<(Part, Selection)> {
    let tables = drive.model.catalogue;
    let known = tables.into_iter().flat_map(|tables| {
        tables
            .parts_of(part)
            .map(|parameter| (part, Selection::of(parameter, tables.notation)))
    });
    let mut places: Vec<_> = known.collect();
    if places.is_empty() {
        let numbers = WITHOUT_TABLES.iter().filter(|(of, _)| *of == part);
        let has = |pnu: u16| {
            drive
                .model
                .learned_or_none()
                .is_some_and(|tables| tables.is_none_or(|tables| tables.by_pnu(pnu).is_some()))
        };
        places.extend(
            numbers
                .filter(|(_, pnu)| has(*pnu))
                .map(|(part, pnu)| (*part, Selection::number(*pnu, Notation::Name))),
        );
    }
    places
}

impl Readings {
    /// Returns the first value of a part.
    pub fn find(&self, part: Part) -> Option<&Reading> {
        self.all(part).next()
    }

    /// Every value of a part.
    pub fn all(&self, part: Part) -> impl Iterator<Item = &Reading> {
        self.rows
            .iter()
            .filter(move |(of, _)| *of == part)
            .map(|(_, reading)| reading)
    }

    pub fn number(&self, part: Part) -> Option<f64> {
        self.find(part).and_then(Reading::number)
    }

    pub fn raw(&self, part: Part) -> Option<i64> {
        self.find(part).and_then(Reading::raw)
    }

    pub fn flag(&self, part: Part) -> Option<bool> {
        self.raw(part).map(|raw| raw != 0)
    }

    pub fn word(&self, part: Part) -> Option<u16> {
        match (self.raw(part), self.line) {
            (Some(raw), _) => u16::try_from(raw & 0xFFFF).ok(),
            (None, Some([status, _])) if part == Part::StatusWord => Some(status),
            _ => None,
        }
    }

    /// Returns the actual value of a serial line as it travels, where no parameter has the speed.
    pub fn line_speed(&self) -> Option<i16> {
        self.line.map(|[_, actual]| actual.cast_signed())
    }

    /// Returns whether the axis stands: slower than `rpm`, else by the actual value as it travels.
    pub fn stands(&self, rpm: f64) -> Option<bool> {
        let speed = self.rpm(Part::Speed).map(|speed| speed.abs() < rpm);
        let actual = || self.word(Part::SpeedActual).map(u16::cast_signed);
        let actual = || actual().or_else(|| self.line_speed());
        speed.or_else(|| actual().map(|actual| actual.unsigned_abs() <= STANDS))
    }

    pub fn double_word(&self, part: Part) -> Option<u32> {
        let raw = self.raw(part)?;
        u32::try_from(raw & 0xFFFF_FFFF).ok()
    }

    /// Returns the actual value of a line as a reading in percent of the reference.
    fn line_reading(&self) -> Option<Reading> {
        let (raw, full) = self.line_speed().zip(self.full)?;
        Some(Reading {
            pnu: signal::NIST_A,
            index: None,
            notation: Notation::Name,
            name: Some("NIST_A"),
            writable: Some(false),
            format: Format::N2.0,
            octets: raw.to_be_bytes().to_vec(),
            content: Content::Number {
                raw: raw.into(),
                engineering: f64::from(raw) * 100.0 / f64::from(full),
            },
            unit: PERCENT,
            decimals: 2,
            choice: None,
            word: None,
            high_half_of: None,
        })
    }

    /// Returns a speed as a reading in rpm, converted if the drive reports it in percent of its reference. In percent
    /// when only the serial line reports it: then the reference was not read either.
    pub fn speed(&self, part: Part) -> Option<Reading> {
        let Some(mut reading) = self.find(part).cloned() else {
            return self.line_reading().filter(|_| part == Part::SpeedActual);
        };
        if let (Some(reference), PERCENT, Content::Number { raw, engineering }) =
            (self.scaling.reference, reading.unit, &reading.content)
        {
            reading.content = Content::Number {
                raw: *raw,
                engineering: engineering * reference / 100.0,
            };
            reading.unit = "rpm";
            reading.decimals = 1;
        }
        Some(reading)
    }

    pub fn rpm(&self, part: Part) -> Option<f64> {
        self.speed(part).filter(|speed| speed.unit != PERCENT)?.number()
    }

    /// Returns a speed in percent of the reference, where that is not known.
    pub fn percent(&self, part: Part) -> Option<f64> {
        self.speed(part).filter(|speed| speed.unit == PERCENT)?.number()
    }

    /// Returns a ramp in rpm/s: as the drive has it, or out of its time, which counts to the synchronous speed of the
    /// motor or to the reference, whichever is lower.
    pub fn ramp(&self, rate: Part, time: Part) -> Option<f64> {
        let positive = |number: f64| Some(number).filter(|number| *number > 0.0);
        if let Some(rate) = self.number(rate).and_then(positive) {
            return Some(rate);
        }
        let synchronous = self
            .number(Part::MotorFrequency)
            .map(|hertz| 60.0 * hertz / self.pole_pairs());
        let reference = self.scaling.reference?;
        let speed = synchronous.map_or(reference, |speed| speed.min(reference));
        Some(speed / self.number(time).and_then(positive)?)
    }

    /// Returns the pole pairs of the motor: from the drive or its nameplate; 1 when unknown.
    pub fn pole_pairs(&self) -> f64 {
        self.known_pole_pairs().unwrap_or(1.0)
    }

    /// The same; `None` when unknown.
    pub fn known_pole_pairs(&self) -> Option<f64> {
        let poles = self.number(Part::MotorPoles).filter(|poles| *poles >= 2.0);
        let plate = || {
            let speed = self.number(Part::MotorSpeed).filter(|speed| *speed > 0.0)?;
            Some((60.0 * self.number(Part::MotorFrequency)? / speed).floor())
        };
        let pairs = poles.map(|poles| poles / 2.0).or_else(plate);
        pairs.map(|pairs| pairs.max(1.0))
    }

    /// Returns the speed that is 100 % of the reference, in rpm; `None` when the reference is not a speed, or not
    /// reported.
    pub fn reference(&self) -> Option<f64> {
        self.reference_at(Part::Reference).filter(|value| *value > 0.0)
    }

    /// Returns a reference in rpm.
    pub fn reference_at(&self, part: Part) -> Option<f64> {
        let reading = self.find(part)?;
        let unit = self.find(Part::ReferenceUnit).and_then(|unit| unit.choice);
        let value = reading.number()?;
        match unit.unwrap_or(reading.unit) {
            unit if unit.eq_ignore_ascii_case("rpm") => Some(value),
            unit if unit.eq_ignore_ascii_case("hz") => Some(value * 60.0 / self.pole_pairs()),
            _ => None,
        }
    }

    /// Returns whose bits the control and status word have now.
    pub fn profile(&self, drive: &Drive, telegram: Option<u16>) -> Profile {
        let choice = self.raw(Part::ControlProfile);
        let found = telegram.and_then(|number| Telegram::find(number, drive.station.vendor_id));
        let words = drive.model.words.of(found, choice);
        match (choice, self.line) {
            // only the status word itself shows whose bits it has
            (None, Some([status, _])) if drive.model.catalogue.is_none() => words.or_as(status, &UNKNOWN),
            (None, Some([status, _])) if found.is_some_and(|telegram| telegram.own_words) => {
                let chosen = drive.model.words.chosen.iter();
                let others: Vec<Profile> = chosen.map(|(_, profile)| *profile).collect();
                words.or_as(status, &others)
            }
            _ => words,
        }
    }
}

/// Returns the status word of a drive in the bits of the profile.
pub(super) fn zsw1_of(drive: &Drive, readings: &Readings, telegram: Option<u16>) -> Option<Zsw1> {
    let status = readings.word(Part::StatusWord)?;
    let sent = readings.word(Part::ControlWord).unwrap_or_default();
    Some(readings.profile(drive, telegram).zsw1(status, sent))
}

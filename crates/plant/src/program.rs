//! The program of a controller: what it sends, and when.

use std::time::Duration;

use profile::catalogue::Scaling;
use profile::notation::{Quantity, UnitMismatch};
use profile::telegram::{Direction, Field, Signal, Telegram, signal};
use profile::value::Parameters;
use profinet::cyclic::Timing;
use serde::Deserialize;
use toml::Spanned;
use virtual_drive::drive::Drive;

use crate::file::{RawValues, assignments_of_signals};
use crate::located::{Located, located};
use crate::plan::{Action, ControllerPlan, DrivePlan, Step};
use crate::text::time;

/// Shortest time after which a step is done again.
const SHORTEST_REPEAT: Duration = Duration::from_millis(1);
/// Most steps of one program.
const MOST_STEPS: usize = 100_000;

#[derive(Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub(crate) struct RawController {
    drive: Spanned<String>,
    telegram: Spanned<u16>,
    cycle: Option<Spanned<String>>,
    watchdog: Option<Spanned<u16>>,
    #[serde(default)]
    step: Vec<Spanned<RawStep>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
struct RawStep {
    at: Spanned<String>,
    every: Option<Spanned<String>>,
    send: Option<RawValues>,
    words: Option<Spanned<Vec<u16>>>,
    /// `release`, `connect`, `stop`, `run`
    connection: Option<Spanned<String>>,
}

impl RawController {
    pub(crate) fn read(&self, drives: &[DrivePlan]) -> Result<ControllerPlan, Located> {
        let drive = located(&self.drive, |name| {
            let found = drives.iter().position(|drive| drive.name == *name);
            found.ok_or_else(|| format!("no drive `{name}` in this plant"))
        })?;
        let plan = drives
            .get(drive)
            .ok_or_else(|| Located(self.drive.span(), "no such drive".into()))?;
        if !plan.ip.is_set() {
            return Err(Located(
                self.drive.span(),
                format!(
                    "{} needs an `ip` so that a controller can connect to it",
                    plan.name
                ),
            ));
        }
        let device = &plan.model.catalogue.device;
        let telegram = located(&self.telegram, |number| {
            let known = device.telegram(*number).map(|_| *number);
            known.ok_or_else(|| {
                let all: Vec<_> = device.telegrams.iter().map(|t| t.telegram.to_string()).collect();
                format!("the drive has no telegram {number}; it has {}", all.join(", "))
            })
        })?;
        let fastest = plan.min_device_interval.unwrap_or(device.min_device_interval);
        let cycle = match &self.cycle {
            None => Duration::from_nanos(u64::from(fastest) * 31_250),
            Some(text) => located(text, |text| {
                let cycle = time(text)?;
                if Timing::for_interval(cycle).is_none() {
                    return Err(format!("`{text}` is not an update time: 1, 2, 4, 8 .. 512 ms"));
                }
                if cycle.as_nanos() < u128::from(fastest) * 31_250 {
                    return Err(format!(
                        "`{text}`: the drive takes {} ms at the fastest",
                        fastest / 32
                    ));
                }
                Ok(cycle)
            })?,
        };
        let watchdog = match &self.watchdog {
            None => 3,
            Some(factor) => located(factor, |factor| {
                let fits = (1..=255).contains(factor);
                fits.then_some(*factor)
                    .ok_or("the watchdog is 1 to 255 update times")
            })?,
        };
        if self.step.len() > MOST_STEPS {
            return Err(Located(
                self.drive.span(),
                format!("more than {MOST_STEPS} steps"),
            ));
        }
        // the scale of a speed in a telegram depends on the set-up of the drive; the plant reports when it cannot be
        // set
        let unit = plan.build(plan.config(), 0).ok();
        let made = unit.as_ref().map(|unit| unit.inner().endpoint().drive());
        let mut steps = Vec::new();
        for raw in &self.step {
            let at = located(&raw.get_ref().at, |text| time(text))?;
            let every = raw.get_ref().every.as_ref();
            let every = every.map(|text| located(text, |text| repeat(text))).transpose()?;
            let action = read_action(raw, plan, made, telegram)?;
            steps.push(Step { at, every, action });
        }
        steps.sort_by_key(|step| step.at);
        Ok(ControllerPlan {
            drive,
            telegram,
            cycle,
            watchdog,
            steps,
        })
    }
}

fn repeat(text: &str) -> Result<Duration, String> {
    let every = time(text)?;
    if every < SHORTEST_REPEAT {
        return Err(format!("`{text}`: a step is repeated every 1 ms at the fastest"));
    }
    Ok(every)
}

fn read_action(
    raw: &Spanned<RawStep>,
    plan: &DrivePlan,
    drive: Option<&Drive>,
    telegram: u16,
) -> Result<Action, Located> {
    let step = raw.get_ref();
    Ok(match (&step.send, &step.words, &step.connection) {
        (Some(values), None, None) => Action::Send(read_signals(values, plan, drive, telegram)?),
        (None, Some(words), None) => Action::Words(words.get_ref().clone()),
        (None, None, Some(word)) => located(word, |word| {
            Ok(match word.as_str() {
                "release" => Action::Release,
                "connect" => Action::Connect,
                "stop" => Action::Stop,
                "run" => Action::Run,
                _ => {
                    return Err(format!(
                        "`{word}`: a connection can release, connect, stop or run"
                    ));
                }
            })
        })?,
        _ => {
            return Err(Located(
                raw.span(),
                "a step has one of `send`, `words` and `connection`".into(),
            ));
        }
    })
}

fn read_signals(
    values: &RawValues,
    plan: &DrivePlan,
    drive: Option<&Drive>,
    telegram: u16,
) -> Result<Vec<(&'static Field, i64)>, Located> {
    let vendor = plan.model.catalogue.device.vendor_id;
    let known = Telegram::find(telegram, vendor);
    let image = known.map(|telegram| &telegram.setpoint);
    let converter = drive.zip(known).filter(|_| plan.model.converter.is_some());
    let mut fields = Vec::new();
    for (span, name, quantity) in assignments_of_signals(values)? {
        let refuse = |message: String| Located(span.clone(), message);
        let field = Signal::by_name(&name, vendor)
            .filter(|signal| signal.direction == Direction::Setpoint)
            .and_then(|signal| image?.field(signal.number))
            .ok_or_else(|| {
                refuse(format!(
                    "telegram {telegram} sends no `{name}`; `words` sends any words"
                ))
            })?;
        let signal = field.signal;
        let of_converter = converter.filter(|_| signal.number == signal::NSOLL_A);
        let raw = match (quantity.raw(), of_converter) {
            (Some(raw), _) => {
                let bits = 8 * u32::from(signal.octets());
                if bits < 64 && raw >> bits != 0 {
                    return Err(refuse(format!(
                        "{name}: 0x{raw:X} does not fit {} octets",
                        signal.octets()
                    )));
                }
                let shift = 64 - bits.min(64);
                let signed = signal.range().0 < 0;
                if signed {
                    (raw << shift).cast_signed() >> shift
                } else {
                    raw.cast_signed()
                }
            }
            (None, Some((drive, telegram))) => reference(&quantity, drive, telegram)
                .map_err(|problem| refuse(format!("{name}: {problem}")))?,
            (None, None) => {
                let parameter = plan.model.number_of_signal(signal.number);
                let parameter = parameter.and_then(|number| plan.model.numbered(number));
                let unit = parameter.map_or("", |parameter| parameter.unit);
                let value = quantity
                    .in_unit(unit)
                    .map_err(|problem| refuse(format!("{name}: {problem}")))?;
                match parameter {
                    Some(parameter) => {
                        let scaling = Scaling::default();
                        let (low, high) = Parameters {
                            catalogue: Some(plan.model.catalogue),
                            scaling,
                        }
                        .limits(parameter);
                        if !(low..=high).contains(&value) {
                            return Err(refuse(format!(
                                "{name}: {value} {unit} is outside {low} to {high} {unit}"
                            )));
                        }
                        parameter.raw(value, &scaling)
                    }
                    None => value.round() as i64,
                }
            }
        };
        let (low, high) = signal.range();
        if !(low..=high).contains(&raw) {
            return Err(refuse(format!("{name}: {raw} is outside {low} to {high}")));
        }
        fields.push((field, raw));
    }
    Ok(fields)
}

/// Returns the number of a speed or of a part of the highest reference in the speed word of a converter; without a unit
/// it is that number itself.
fn reference(quantity: &Quantity, drive: &Drive, telegram: &Telegram) -> Result<i64, UnitMismatch> {
    Ok(match quantity.unit.as_deref() {
        None => quantity.number.as_f64().round() as i64,
        Some("%") => {
            let full = telegram.full_speed.unwrap_or(N2_FULL);
            (quantity.number.as_f64() / 100.0 * f64::from(full)).round() as i64
        }
        Some(_) => drive.speed_word(telegram, quantity.in_unit("rpm")?),
    })
}

/// 100 % of a word of the type N2.
const N2_FULL: u16 = 0x4000;

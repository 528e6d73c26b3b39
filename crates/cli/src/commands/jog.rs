//! `profidrive jog`

use std::time::Duration;

use clap::Args;
use client::axis::{Jog as JogSetpoint, Purpose, SpeedUnit};
use client::{Drive, Error, JogSpeed, Session, Wait, WriteMode};
use profile::notation::{Number, ParameterReference, Quantity};
use profile::value::{Assignment, Content, Parameters, Reading, Selection};

use super::axis::{self, End};
use super::dry_run;
use super::limit;
use crate::args::{Consent, Cyclic, Interface, duration};
use crate::connect::{self, Live, Need};
use crate::failure::Failure;
use crate::fields;
use crate::leftover::{Leftover, Note};
use crate::output::Output;
use crate::render::{number, value};

#[derive(Debug, Args)]
pub struct Jog {
    /// Station name, IP address, MAC address, or fc:PORT/ADDRESS or uss:PORT/ADDRESS
    pub drive: String,
    /// Which jog setpoint of the drive: 1 (STW1 bit 8) or 2 (bit 9)
    #[arg(long, default_value_t = 1, value_parser = clap::value_parser!(u8).range(1..=2))]
    pub jog: u8,
    /// Set the jog speed for this command; the drive's own value when left out
    #[arg(long, value_name = "SPEED", allow_hyphen_values = true)]
    pub velocity: Option<Quantity>,
    /// Jog at --velocity itself by real-time jogging (STW1 bits 12 and 13, position mode, telegram 9, 352 or 353): no
    /// parameter of the drive is changed
    #[arg(long, requires = "velocity", conflicts_with = "jog")]
    pub real_time: bool,
    /// How long to jog
    #[arg(long = "for", value_name = "TIME", default_value = "2s", value_parser = duration)]
    pub time: Duration,
    /// Refuse any speed above this
    #[arg(long, value_name = "SPEED", default_value = "3000rpm")]
    pub limit: Quantity,
    /// Check and show, but take no control and move nothing
    #[arg(long)]
    pub dry_run: bool,
    #[command(flatten)]
    pub consent: Consent,
    #[command(flatten)]
    pub cyclic: Cyclic,
}

pub fn run(args: &Jog, interface: &Interface, output: &Output) -> Result<(), Failure> {
    let limit = axis::rpm(&args.limit, "--limit")?.abs();
    let wanted = args
        .velocity
        .as_ref()
        .map(|quantity| axis::rpm(quantity, "--velocity"))
        .transpose()?;
    if let Some(speed) = wanted {
        axis::within(speed, limit, SpeedUnit::Rpm)?;
    }
    axis::checked(&args.cyclic)?;
    let need = if args.dry_run { Need::Records } else { Need::Cyclic };
    let (mut session, mut drive) = connect::drive(interface, need, &args.drive, output)?;
    let jog = match args.jog {
        2 => JogSetpoint::Two,
        _ => JogSetpoint::One,
    };
    if args.dry_run {
        try_out(args, limit, wanted, jog, &mut session, &mut drive, output)?;
        return Ok(session.close().wait()?);
    }
    if let Some(speed) = wanted.filter(|_| args.real_time) {
        real_time(args, speed, limit, &mut session, &mut drive, output)?;
        return Ok(session.close().wait()?);
    }
    let setting = session.jog_speed(&mut drive, jog).wait()?;
    let pnu = setting.number;
    let called = setting.selection.label();
    let mut before: Option<Reading> = None;
    let result = go(
        args,
        limit,
        (jog, &setting),
        &mut before,
        &mut session,
        &mut drive,
        output,
    );
    if let Some(speed) = before {
        let back = session
            .uninterrupted(async |session: &mut Session| put_back(session, &mut drive, pnu, &speed).await)
            .wait();
        match back {
            Ok(()) => {
                Note::of(&drive, pnu).clear();
                output.say(&format!("{called} is {} again", value::full(&speed)));
            }
            Err(error) => output.warn(&format!(
                "{called} was not put back to {}: {error}",
                value::full(&speed)
            )),
        }
    }
    result?;
    Ok(session.close().wait()?)
}

/// Everything that `jog` reads and checks; nothing is sent that changes anything.
fn try_out(
    args: &Jog,
    limit: f64,
    wanted: Option<f64>,
    jog: JogSetpoint,
    session: &mut Live,
    drive: &mut Drive,
    output: &Output,
) -> Result<(), Failure> {
    axis::report_controller_loss(session, drive, &args.consent, "jog", output)?;
    let purpose = if args.real_time {
        Purpose::RealTimeJog
    } else {
        Purpose::Jog
    };
    let settings = axis::settings(&args.cyclic, &args.consent, purpose, limit);
    let tried = dry_run::axis(session, drive, &settings, None, output)?;
    let speed = match wanted.filter(|_| args.real_time) {
        Some(speed) => real_time_speed(session, drive, speed, limit, output)?,
        None => {
            let setting = session.jog_speed(drive, jog).wait()?;
            let called = setting.selection.label();
            let mut speed = session.read_one(drive, &setting.selection).wait()?;
            let left = Note::of(drive, setting.number).read();
            if let Some(left) = left.filter(|left| speed.raw() == Some(left.set)) {
                output.warn(&left.message(&drive.label()).0);
            }
            let present = setting.rpm(&speed).unwrap_or(0.0);
            let mut rpm = present;
            if let (Some(asked), Some(wanted)) = (&args.velocity, wanted) {
                let asked = setting.quantity(asked);
                let value = drive.parameters.check(&setting.selection, &asked.into())?;
                let before = value::full(&speed);
                speed.content = Content::Number {
                    raw: value.raw.into(),
                    engineering: value.engineering,
                };
                rpm = setting.rpm(&speed).unwrap_or(wanted);
                axis::report_rounding(wanted, rpm, "rpm", output);
                if before != value::full(&speed) {
                    output.say(&format!(
                        "{called} would be {before} -> {} for this and back afterwards",
                        value::full(&speed)
                    ));
                }
            }
            axis::within(rpm, limit, SpeedUnit::Rpm)?;
            limit::jog(rpm, &session.motion_facts(drive).wait()?, drive)?;
            rpm
        }
    };
    let label = drive.label();
    let seconds = args.time.as_secs_f64();
    output.say(&format!(
        "dry run: {label} would jog at {} rpm for {seconds} s{}; nothing was sent",
        number(speed),
        tried.telegram_text()
    ));
    if output.json() {
        let mut fields = tried.json();
        fields.extend(
            fields! { "drive": label, "dry_run": true, "speed": speed, "speed_unit": "rpm", "time": seconds },
        );
        output.document("jog", fields);
    }
    Ok(())
}

fn go(
    args: &Jog,
    limit: f64,
    (jog, setting): (JogSetpoint, &JogSpeed),
    before: &mut Option<Reading>,
    session: &mut Live,
    drive: &mut Drive,
    output: &Output,
) -> Result<(), Failure> {
    axis::report_controller_loss(session, drive, &args.consent, "jog", output)?;
    let facts = session.motion_facts(drive).wait()?;
    if let Some(wanted) = &args.velocity {
        limit::jog(axis::rpm(wanted, "--velocity")?, &facts, drive)?;
    }
    let settings = axis::settings(&args.cyclic, &args.consent, Purpose::Jog, limit);
    let mut axis = session.take_axis(drive, settings).wait()?;
    let (inner, own) = axis.session();
    let JogSpeed {
        selection,
        number: pnu,
        ..
    } = *setting;
    let called = selection.label();
    let mut speed = inner.read_one(own, &selection).wait()?;
    let note = Note::of(own, pnu);
    let left = note.read().filter(|left| speed.raw() == Some(left.set));
    if let Some(left) = left {
        output.warn(&left.message(&own.label()).0);
        set_speed(inner, own, pnu, &left.old).wait()?;
        note.clear();
        output.say(&format!("{called} is {} again", left.old));
        speed = inner.read_one(own, &selection).wait()?;
    }
    if let Some(wanted) = &args.velocity {
        let wanted = &setting.quantity(wanted);
        let checked = own.parameters.check(&selection, &wanted.clone().into())?;
        let set = checked.raw;
        if checked.is_rounded() {
            axis::report_rounding(checked.asked, checked.engineering, checked.unit, output);
        }
        // what the drive has already is neither written nor put back
        let old = (speed.raw() != Some(set)).then(|| briefly(&own.parameters, &selection, &speed));
        if let Some(old) = old.flatten() {
            let old_value = value::full(&speed);
            let leftover = Leftover { pnu, old, set };
            if let Err(why) = note.write(&leftover) {
                output.warn(&format!(
                    "if this program is killed, {called} stays changed; it was {old_value}: {why}"
                ));
            }
            // put back at the end, whatever happens
            *before = Some(speed);
            set_speed(inner, own, pnu, wanted).wait()?;
            speed = inner.read_one(own, &selection).wait()?;
        }
    }
    let rpm = setting.rpm(&speed).unwrap_or(0.0);
    axis::within(rpm, limit, SpeedUnit::Rpm)?;
    limit::jog(rpm, &facts, axis.drive())?;
    axis::warn_switch(rpm, &facts, output);
    output.say(&format!(
        "this moves the axis: {} jogs at {} for {} s; Ctrl-C stops it",
        drive.label(),
        value::full(&speed),
        args.time.as_secs_f64()
    ));
    axis::watch(&mut axis, "jog", false, output);
    let result = axis.enable().wait().and_then(|mut enabled| {
        enabled.jog(jog).wait()?;
        enabled.keep_jog(rpm, args.time).wait()?;
        held_back(&mut enabled, output);
        Ok(())
    });
    axis::finish(axis, result, End::Time, "jog", serde_json::Map::new(), output)
        .map_err(|error| axis::explained(error, End::Time, session, drive))
}

/// The value of a reading with as few digits as the drive needs to have it again.
fn briefly(parameters: &Parameters, selection: &Selection, reading: &Reading) -> Option<Quantity> {
    let (number, raw) = (reading.number()?, reading.raw()?);
    brief(parameters, selection, (number, reading.unit), raw)
}

fn brief(
    parameters: &Parameters,
    selection: &Selection,
    (number, unit): (f64, &str),
    raw: i64,
) -> Option<Quantity> {
    let same = |text: String| {
        let value: Quantity = text.parse().ok()?;
        let checked = parameters.check(selection, &value.clone().into()).ok()?;
        (checked.raw == raw).then_some(value)
    };
    let rounded = (0..9).find_map(|digits| same(format!("{number:.digits$}{unit}")));
    rounded.or_else(|| format!("{number}{unit}").parse().ok())
}

fn real_time(
    args: &Jog,
    speed: f64,
    limit: f64,
    session: &mut Live,
    drive: &mut Drive,
    output: &Output,
) -> Result<(), Failure> {
    axis::report_controller_loss(session, drive, &args.consent, "jog", output)?;
    axis::warn_switch(speed, &session.motion_facts(drive).wait()?, output);
    real_time_speed(session, drive, speed, limit, output)?;
    let settings = axis::settings(&args.cyclic, &args.consent, Purpose::RealTimeJog, limit);
    let mut axis = session.take_axis(drive, settings).wait()?;
    output.say(&format!(
        "this moves the axis: {} jogs at {} rpm for {} s (real-time jogging, telegram {}); Ctrl-C stops it",
        drive.label(),
        number(speed),
        args.time.as_secs_f64(),
        axis.telegram()
    ));
    axis::watch(&mut axis, "jog", false, output);
    let result = axis.enable().wait().and_then(|mut enabled| {
        enabled.jog_at(speed).wait()?;
        enabled.keep_jog(speed, args.time).wait()?;
        held_back(&mut enabled, output);
        Ok(())
    });
    axis::finish(axis, result, End::Time, "jog", serde_json::Map::new(), output)
        .map_err(|error| axis::explained(error, End::Time, session, drive))
}

/// The speed as MDI_VELOCITY carries it, once nothing speaks against it.
fn real_time_speed(
    session: &mut Live,
    drive: &mut Drive,
    wanted: f64,
    limit: f64,
    output: &Output,
) -> Result<f64, Failure> {
    let speed = session.check_jog(drive, wanted, limit).wait()?;
    axis::report_rounding(wanted, speed, "rpm", output);
    Ok(speed)
}

/// A jog that ended at a limit says so.
fn held_back(enabled: &mut axis::Enabled<'_>, output: &Output) {
    if let Some(evidence) = enabled.held_back().wait() {
        output.warn(&format!("the axis stood at the end of the jog: {evidence}"));
    }
}

/// The speed of the drive as it was, to the last bit.
async fn put_back(session: &mut Session, drive: &mut Drive, pnu: u16, before: &Reading) -> Result<(), Error> {
    let Some(number) = before.number() else {
        return Ok(());
    };
    let quantity = Quantity {
        number: Number::Decimal(number),
        unit: None,
    };
    set_speed(session, drive, pnu, &quantity).await
}

async fn set_speed(
    session: &mut Session,
    drive: &mut Drive,
    pnu: u16,
    speed: &Quantity,
) -> Result<(), Error> {
    let assignment = Assignment {
        reference: ParameterReference::number(pnu),
        value: speed.clone().into(),
    };
    let set = session.write(drive, &[assignment], WriteMode::Write).await?;
    set.accepted()
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use profile::catalogue::{AKD, Scaling};

    #[test]
    fn a_speed_is_noted_with_the_digits_that_the_drive_needs() {
        let parameters = Parameters {
            catalogue: Some(&AKD),
            scaling: Scaling::default(),
        };
        let selection = parameters.select(&ParameterReference::number(1004)).unwrap();
        let whole: Quantity = "60.043931007385254rpm".parse().unwrap();
        let raw = parameters.check(&selection, &whole.into()).unwrap().raw;
        let brief = brief(&parameters, &selection, (60.043_931_007_385_254, "rpm"), raw).unwrap();
        assert!(brief.to_string().len() <= "60.044 rpm".len(), "{brief}");
        assert_eq!(parameters.check(&selection, &brief.into()).unwrap().raw, raw);
    }
}

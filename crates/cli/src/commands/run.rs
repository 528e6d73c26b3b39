//! `profidrive run`

use std::time::Duration;

use clap::Args;
use client::axis::{Purpose, SpeedUnit};
use client::{AxisSettings, Drive, Error, Wait};
use profile::catalogue::Part;
use profile::notation::Quantity;
use profile::state::Mode;
use profile::telegram::DANFOSS;

use super::axis::{self, End, SetMode};
use super::dry_run;
use super::limit::{above, too_fast};
use crate::args::{Consent, Cyclic, Interface, duration};
use crate::connect::{self, Live, Need};
use crate::failure::Failure;
use crate::fields;
use crate::output::Output;

/// Number of PPO type 0, if there were one: the selections of 9-22.
const PPO: u16 = 100;
/// A longer ramp is reported beforehand.
const LONG_RAMP: Duration = Duration::from_secs(2);

#[derive(Debug, Args)]
pub struct Run {
    /// Station name, IP address, MAC address, or fc:PORT/ADDRESS or uss:PORT/ADDRESS
    pub drive: String,
    /// Speed: 60rpm, -1rps, or 20% of the reference of the drive; a bare number is in rpm
    #[arg(long, value_name = "SPEED", allow_hyphen_values = true)]
    pub velocity: Quantity,
    /// What 100 % of the reference is, for a drive that does not report it: 1500rpm
    #[arg(long, value_name = "SPEED")]
    pub reference_speed: Option<Quantity>,
    /// Telegram to connect with: its number as in PNU 922, or ppo1 to ppo8 of a VLT; left out it is the one that the drive
    /// reports if that carries a speed, else telegram 1
    #[arg(long, value_name = "NUMBER|ppoN", value_parser = telegram)]
    pub telegram: Option<TelegramName>,
    /// How long to run at the speed, counted from when it is reached; until Ctrl-C when left out
    #[arg(long = "for", value_name = "TIME", value_parser = duration)]
    pub time: Option<Duration>,
    /// Refuse any speed above this [default: 3000rpm, or 100% for a speed in percent]
    #[arg(long, value_name = "SPEED")]
    pub limit: Option<Quantity>,
    /// Check and show, but take no control and move nothing
    #[arg(long)]
    pub dry_run: bool,
    #[command(flatten)]
    pub mode: SetMode,
    #[command(flatten)]
    pub consent: Consent,
    #[command(flatten)]
    pub cyclic: Cyclic,
}

/// A telegram as a user names it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TelegramName {
    /// As in PNU 922.
    Number(u16),
    /// PPO type of a VLT.
    Ppo(u8),
}

fn telegram(text: &str) -> Result<TelegramName, &'static str> {
    let lower = text.to_ascii_lowercase();
    match lower.strip_prefix("ppo") {
        Some(number) => {
            let number = number.parse().ok();
            let number = number.filter(|number| (1..=8).contains(number));
            number.map(TelegramName::Ppo).ok_or("PPO types are ppo1 to ppo8")
        }
        None => text
            .parse()
            .map(TelegramName::Number)
            .map_err(|_| "a number as in PNU 922, or ppo1 to ppo8"),
    }
}

impl TelegramName {
    /// Its number at this drive.
    fn number(self, drive: &Drive) -> Result<u16, Failure> {
        match self {
            Self::Number(number) => Ok(number),
            Self::Ppo(number) if drive.station.vendor_id == DANFOSS => Ok(PPO + u16::from(number)),
            Self::Ppo(_) => {
                let message = format!("{} has no PPO types: they are telegrams of a VLT", drive.label());
                Err(Failure::usage(message).hint("--telegram takes the number of a telegram"))
            }
        }
    }
}

/// What was requested, in one unit.
struct Wish {
    speed: f64,
    unit: SpeedUnit,
    limit: f64,
    reference_speed: Option<f64>,
}

impl Wish {
    fn of(args: &Run) -> Result<Self, Failure> {
        let unit = match args.velocity.unit.as_deref() {
            Some("%") => SpeedUnit::Percent,
            _ => SpeedUnit::Rpm,
        };
        let symbol = unit.symbol();
        let speed = axis::in_unit(&args.velocity, symbol, "--velocity")?;
        let limit = match (&args.limit, unit) {
            (Some(limit), _) => axis::in_unit(limit, symbol, "--limit")?.abs(),
            (None, SpeedUnit::Rpm) => 3000.0,
            (None, SpeedUnit::Percent) => 100.0,
        };
        let reference = args.reference_speed.as_ref();
        let reference = reference.map(|speed| axis::rpm(speed, "--reference-speed"));
        let reference_speed = reference.transpose()?;
        if reference_speed.is_some_and(|speed| !speed.is_finite() || speed <= 0.0) {
            return Err(Failure::usage("--reference-speed: a speed above 0"));
        }
        axis::within(speed, limit, unit)?;
        Ok(Self {
            speed,
            unit,
            limit,
            reference_speed,
        })
    }

    fn speed_text(&self) -> String {
        format!("{} {}", self.speed, self.unit.symbol())
    }
}

pub fn run(args: &Run, interface: &Interface, output: &Output) -> Result<(), Failure> {
    let wish = Wish::of(args)?;
    axis::checked(&args.cyclic)?;
    if args.dry_run {
        return try_out(args, &wish, interface, output);
    }
    let needed = (Mode::Velocity, &args.mode);
    axis::with_drive(interface, &args.drive, needed, output, |session, drive| {
        go(args, &wish, session, drive, output)
    })
}

/// Everything that `run` reads and checks; nothing is sent that changes anything.
fn try_out(args: &Run, wish: &Wish, interface: &Interface, output: &Output) -> Result<(), Failure> {
    let (mut session, mut drive) = connect::drive(interface, Need::Records, &args.drive, output)?;
    permitted(args, wish, &mut session, &mut drive, output)?;
    let settings = settings(args, wish, &drive)?;
    let needed = Some((Mode::Velocity, &args.mode));
    let tried = dry_run::axis(&mut session, &mut drive, &settings, needed, output)?;
    session.close().wait()?;
    let plan = tried.plan.as_ref();
    let rounded = plan
        .map(|plan| plan.rounded_speed_for(&drive, wish.speed))
        .transpose()?;
    if let Some(rounded) = rounded {
        axis::report_rounding(wish.speed, rounded, wish.unit.symbol(), output);
    }
    let (label, speed) = (drive.label(), wish.speed_text());
    output.say(&format!(
        "dry run: {label} would turn at {speed} {}{}; nothing was sent",
        duration_text(args),
        tried.telegram_text()
    ));
    if output.json() {
        let mut fields = tried.json();
        fields.extend(
            fields! { "drive": label, "dry_run": true, "speed": wish.speed, "speed_told": rounded,
            "speed_unit": wish.unit.symbol(), "time": args.time.map(|time| time.as_secs_f64()) },
        );
        output.document("run", fields);
    }
    Ok(())
}

fn duration_text(args: &Run) -> String {
    args.time.map_or_else(
        || "until Ctrl-C".into(),
        |time| format!("for {} s", time.as_secs_f64()),
    )
}

fn settings(args: &Run, wish: &Wish, drive: &Drive) -> Result<AxisSettings, Failure> {
    Ok(AxisSettings {
        telegram: args.telegram.map(|name| name.number(drive)).transpose()?,
        unit: wish.unit,
        reference_speed: wish.reference_speed,
        ..axis::settings(&args.cyclic, &args.consent, Purpose::Speed, wish.limit)
    })
}

/// What the drive itself says against a speed, before anything is sent.
fn permitted(
    args: &Run,
    wish: &Wish,
    session: &mut Live,
    drive: &mut Drive,
    output: &Output,
) -> Result<(), Failure> {
    let speed = wish.speed;
    if wish.unit == SpeedUnit::Rpm {
        // of all others the scale is known with the telegram only
        let known = drive.model.catalogue.is_some() && !drive.model.learned;
        if known && args.telegram.is_none() && args.reference_speed.is_none() {
            session.check_speed(drive, speed).wait()?;
        }
        let facts = session.motion_facts(drive).wait()?;
        axis::warn_switch(speed, &facts, output);
        // who says what 100 % is knows better than the drive
        let applies = |part: &Option<Part>| *part != Some(Part::Reference) || args.reference_speed.is_none();
        if let Some(limit) = above(speed, &facts).filter(|(_, part)| applies(part)) {
            return Err(too_fast(speed, limit, drive));
        }
    }
    axis::report_controller_loss(session, drive, &args.consent, "run", output)
}

fn go(
    args: &Run,
    wish: &Wish,
    session: &mut Live,
    drive: &mut Drive,
    output: &Output,
) -> Result<(), Failure> {
    let speed = wish.speed;
    permitted(args, wish, session, drive, output)?;
    let end = if args.time.is_some() { End::Time } else { End::Open };
    let settings = settings(args, wish, drive)?;
    let mut axis = session.take_axis(drive, settings).wait()?;
    if let Some(nearest) = axis.rounded_speed(speed) {
        axis::report_rounding(speed, nearest, wish.unit.symbol(), output);
    }
    output.say(&format!(
        "this moves the axis: {} turns at {} {}; Ctrl-C stops it",
        drive.label(),
        wish.speed_text(),
        duration_text(args)
    ));
    axis::watch(&mut axis, "run", args.mode.set_mode, output);
    let result = axis.enable().wait().and_then(|mut enabled| match args.time {
        Some(time) => {
            let ramp = enabled.speed_time(speed);
            if ramp > LONG_RAMP {
                let named = enabled.drive().named(&[Part::Acceleration, Part::RampUpTime]);
                let by = named
                    .first()
                    .map_or_else(String::new, |name| format!(" ({name})"));
                output.say(&format!(
                    "the ramp up takes about {:.0} s{by}, the time counts from its end",
                    ramp.as_secs_f64()
                ));
            }
            enabled.reach_speed(speed, None).wait()?;
            enabled.keep_speed(speed, time).wait()
        }
        None => {
            match enabled.reach_speed(speed, None).wait() {
                Err(Error::Interrupted) => {
                    let actual = enabled.status().and_then(|status| status.speed_actual);
                    output.warn(&unreached(wish, actual));
                    return Err(Error::Interrupted);
                }
                other => other?,
            }
            enabled.keep_speed(speed, axis::FOR_EVER).wait()
        }
    });
    axis::finish(axis, result, end, "run", serde_json::Map::new(), output)
        .map_err(|error| axis::explained(error, end, session, drive))
}

/// A run that ended before it was at its speed.
fn unreached(wish: &Wish, actual: Option<f64>) -> String {
    let unit = wish.unit.symbol();
    let actual = actual.map_or_else(String::new, |actual| format!(", it was {actual:.1} {unit}"));
    format!("{} was not reached when the stop came{actual}", wish.speed_text())
}

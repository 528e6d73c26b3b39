//! Turning at a speed.

use std::time::Duration;

use client::axis::{Purpose, SpeedUnit};
use client::{AxisSettings, Drive, Enabled, Error, Session, synchronous_speed};
use profile::catalogue::Part;
use profile::state::Mode;
use profile::telegram::Telegram;

use super::axis::{Done, Taken, check_controller_loss, report_rounded, report_switch};
use super::check::checked_axis;
use super::error::{End, MotionError};
use super::event::{Event, Observer};
use super::limit::{self, above, too_fast, within};
use super::plan::RunPlan;
use super::report::{MotionResult, Report};
use super::start::Start;
use super::{Control, SPEED_LIMIT, UNLIMITED, mode};
use crate::report::Quantity;

/// Number of PPO type 0, if there were one: the selections of 9-22.
const PPO: u16 = 100;
/// A ramp that takes longer than this is reported beforehand.
const LONG_RAMP: Duration = Duration::from_secs(2);

/// A speed for some time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Run {
    /// Speed, in `unit`.
    pub speed: f64,
    /// Unit of `speed` and `limit`: rpm, or percent of the reference of the drive.
    pub unit: SpeedUnit,
    /// Any speed above this is refused.
    pub limit: f64,
    /// Output frequency of a frequency converter in place of `speed`; see [`Run::at_frequency`].
    pub frequency: Option<Frequency>,
    /// Speed in rpm that is 100 % of the reference, for a drive that does not report it.
    pub reference_speed: Option<f64>,
    /// The telegram to connect with. When `None` it is the one that the drive reports if that carries a speed, else telegram 1.
    pub telegram: Option<TelegramName>,
    /// How long to run at the speed, counted from when it is reached; when `None` until the caller stops it.
    pub time: Option<Duration>,
    /// What all motions have in common.
    pub control: Control,
}

/// A speed as the output frequency of a frequency converter.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Frequency {
    /// Output frequency, Hz.
    pub hertz: f64,
    /// Any frequency above this is refused; when `None` the limit is that of the speed.
    pub limit: Option<f64>,
}

/// A telegram as a person names it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TelegramName {
    /// As in PNU 922.
    Number(u16),
    /// PPO type of a VLT.
    Ppo(u8),
}

impl TelegramName {
    /// Its number at this drive.
    fn number(self, drive: &Drive) -> Result<u16, MotionError> {
        match self {
            Self::Number(number) => Ok(number),
            Self::Ppo(number) => {
                let number = PPO + u16::from(number);
                let known = Telegram::find(number, drive.station.vendor_id);
                let no_ppo = || MotionError::NoPpo { drive: drive.label() };
                known.map(|_| number).ok_or_else(no_ppo)
            }
        }
    }
}

impl Run {
    /// At a speed in rpm, up to [`SPEED_LIMIT`], until the caller stops it.
    #[must_use]
    pub fn at(rpm: f64) -> Self {
        Self {
            speed: rpm,
            unit: SpeedUnit::Rpm,
            limit: SPEED_LIMIT,
            frequency: None,
            reference_speed: None,
            telegram: None,
            time: None,
            control: Control::default(),
        }
    }

    /// At a share of the reference of the drive, up to 100 %, until the caller stops it.
    #[must_use]
    pub fn at_percent(percent: f64) -> Self {
        Self {
            unit: SpeedUnit::Percent,
            limit: 100.0,
            ..Self::at(percent)
        }
    }

    /// At an output frequency in Hz, for a frequency converter, until the caller stops it. The speed is that of the motor
    /// without slip: the pole pairs are read from the drive, and the conversion is reported.
    #[must_use]
    pub fn at_frequency(hertz: f64) -> Self {
        Self {
            frequency: Some(Frequency { hertz, limit: None }),
            ..Self::at(0.0)
        }
    }

    /// Returns the run with its speed in place of a frequency.
    pub(super) async fn in_rpm(
        &self,
        session: &mut Session,
        drive: &mut Drive,
        observer: &Observer,
    ) -> Result<Self, MotionError> {
        let Some(Frequency { hertz, limit }) = self.frequency else {
            return Ok(*self);
        };
        let (speed, pole_pairs) = converted(session, drive, hertz, observer).await?;
        let wanted = Self {
            speed,
            unit: SpeedUnit::Rpm,
            limit: limit.map_or(self.limit, |limit| synchronous_speed(limit, pole_pairs).abs()),
            frequency: None,
            ..*self
        };
        wanted.check()?;
        Ok(wanted)
    }

    /// Checks what is wrong whatever the drive is like.
    ///
    /// # Errors
    /// A speed above the limit, a reference that is not above 0.
    pub fn check(&self) -> Result<(), MotionError> {
        if self
            .reference_speed
            .is_some_and(|speed| !speed.is_finite() || speed <= 0.0)
        {
            return Err(MotionError::Invalid {
                what: "the reference speed has to be above 0",
            });
        }
        within(self.speed, self.limit, self.unit, &self.control)
    }

    pub(super) fn settings(&self, drive: &Drive) -> Result<AxisSettings, MotionError> {
        Ok(AxisSettings {
            telegram: self.telegram.map(|name| name.number(drive)).transpose()?,
            unit: self.unit,
            reference_speed: self.reference_speed,
            ..self.control.settings(Purpose::Speed, self.limit)
        })
    }
}

/// Returns the speed of a frequency converter at an output frequency, rpm: that of the motor without slip. The pole pairs are read
/// from the drive, and the conversion is reported.
///
/// # Errors
/// [`Error::NoFrequency`] where the drive is not a frequency converter or its motor data are not valid.
pub async fn speed_at(
    session: &mut Session,
    drive: &mut Drive,
    hertz: f64,
    observer: &Observer,
) -> Result<f64, MotionError> {
    Ok(converted(session, drive, hertz, observer).await?.0)
}

/// The same with the pole pairs of the motor.
pub(super) async fn converted(
    session: &mut Session,
    drive: &mut Drive,
    hertz: f64,
    observer: &Observer,
) -> Result<(f64, f64), MotionError> {
    let pole_pairs = session.pole_pairs(drive).await?;
    let rpm = synchronous_speed(hertz, pole_pairs);
    observer.report(&Event::Converted {
        hertz,
        rpm,
        pole_pairs,
    });
    Ok((rpm, pole_pairs))
}

/// Turns the axis at a speed.
///
/// # Errors
/// Nothing is sent where a limit, the mode, the loss reaction or another controller speaks against it; else when the speed is
/// not reached or not kept, and when the caller stops a run that has a time before its end.
pub async fn run(
    session: &mut Session,
    drive: &mut Drive,
    wanted: &Run,
    observer: &Observer,
) -> Result<Report, MotionError> {
    let wanted = &Run {
        control: wanted.control.on(session, drive),
        ..*wanted
    };
    wanted.check()?;
    let wanted = &wanted.in_rpm(session, drive, observer).await?;
    let mode = (Mode::Velocity, &wanted.control);
    mode::during((session, drive), mode, wanted, observer, turn).await
}

/// Reads and checks everything that [`run`] does; nothing is sent that changes anything.
///
/// # Errors
/// As [`run`] before it takes the axis, and when something keeps the drive from running.
pub async fn plan_run(
    session: &mut Session,
    drive: &mut Drive,
    wanted: &Run,
    observer: &Observer,
) -> Result<RunPlan, MotionError> {
    let wanted = &Run {
        control: wanted.control.on(session, drive),
        ..*wanted
    };
    wanted.check()?;
    let wanted = &wanted.in_rpm(session, drive, observer).await?;
    permitted(session, drive, wanted, observer).await?;
    let settings = wanted.settings(drive)?;
    let set_mode = wanted.control.set_mode.then_some(Mode::Velocity);
    let (plan, telegrams) = checked_axis(session, drive, &settings, set_mode, observer).await?;
    let speed_sent = plan
        .map(|plan| plan.rounded_speed_for(drive, wanted.speed))
        .transpose()?;
    if let Some(sent) = speed_sent {
        report_rounded(wanted.speed, sent, wanted.unit.symbol(), observer);
    }
    Ok(RunPlan {
        drive: drive.label(),
        dry_run: true,
        speed: Quantity::speed(wanted.speed, wanted.unit),
        speed_rounded: speed_sent.map(|sent| Quantity::speed(sent, wanted.unit)),
        time: wanted.time.map(|time| time.as_secs_f64()),
        telegrams,
    })
}

/// The objections of the drive to a run, before anything is sent.
pub(super) async fn permitted(
    session: &mut Session,
    drive: &mut Drive,
    wanted: &Run,
    observer: &Observer,
) -> Result<(), MotionError> {
    permitted_speed(session, drive, wanted, observer).await?;
    Ok(check_controller_loss(session, drive, &wanted.control, observer).await?)
}

/// The objections of the drive to the speed of a run.
pub(super) async fn permitted_speed(
    session: &mut Session,
    drive: &mut Drive,
    wanted: &Run,
    observer: &Observer,
) -> Result<(), MotionError> {
    let speed = wanted.speed;
    if wanted.unit == SpeedUnit::Rpm {
        // of all others the scale is known with the telegram only
        let known = drive.model.catalogue.is_some() && !drive.model.learned;
        if known && wanted.telegram.is_none() && wanted.reference_speed.is_none() {
            session.check_speed(drive, speed).await?;
        }
        permit_speed(session, drive, speed, wanted.reference_speed, observer).await?;
    }
    if wanted.unit == SpeedUnit::Percent && wanted.control.bound.is_some() {
        let facts = session.motion_facts(drive).await?;
        limit::share(speed, wanted.reference_speed, &facts, &wanted.control, drive)?;
    }
    Ok(())
}

/// The objections of the drive to a speed in rpm: its own limits. A limit switch in that direction is reported. The value for
/// 100 % that the caller gives takes precedence over that of the drive.
pub(super) async fn permit_speed(
    session: &mut Session,
    drive: &mut Drive,
    speed: f64,
    reference_speed: Option<f64>,
    observer: &Observer,
) -> Result<(), MotionError> {
    let facts = session.motion_facts(drive).await?;
    report_switch(speed, &facts, observer);
    let counts = |part: &Option<Part>| *part != Some(Part::Reference) || reference_speed.is_none();
    match above(speed, &facts).filter(|(_, part)| counts(part)) {
        Some(limit) => Err(too_fast(speed, limit, drive)),
        None => Ok(()),
    }
}

async fn turn(
    session: &mut Session,
    drive: &mut Drive,
    wanted: &Run,
    observer: &Observer,
) -> Result<Done, MotionError> {
    permitted(session, drive, wanted, observer).await?;
    let end = if wanted.time.is_some() {
        End::Time
    } else {
        End::Open
    };
    let axis = session.take_axis(drive, wanted.settings(drive)?).await?;
    if let Some(nearest) = axis.rounded_speed(wanted.speed) {
        report_rounded(wanted.speed, nearest, wanted.unit.symbol(), observer);
    }
    let start = Start::Run {
        speed: Quantity::speed(wanted.speed, wanted.unit),
        time: wanted.time,
    };
    let mut taken = Taken::begin(axis, end, start, wanted.control.set_mode, observer).await?;
    let mut found = MotionResult::default();
    let motion = async |enabled: &mut Enabled<'_>| keep(enabled, wanted, &mut found, observer).await;
    let result = taken.move_by(motion).await;
    found.speed = taken.speed();
    Ok(taken.finish(result, found).await)
}

async fn keep(
    enabled: &mut Enabled<'_>,
    wanted: &Run,
    found: &mut MotionResult,
    observer: &Observer,
) -> Result<(), Error> {
    reach(enabled, wanted, found, observer).await?;
    hold(enabled, wanted.speed, wanted.time.unwrap_or(UNLIMITED), found).await
}

/// Comes up to the speed.
pub(super) async fn reach(
    enabled: &mut Enabled<'_>,
    wanted: &Run,
    found: &mut MotionResult,
    observer: &Observer,
) -> Result<(), Error> {
    let time = enabled.speed_time(wanted.speed);
    if wanted.time.is_some() && time > LONG_RAMP {
        let named = enabled.drive().named(&[Part::Acceleration, Part::RampUpTime]);
        let by = named.into_iter().next();
        observer.report(&Event::LongRamp { time, by });
    }
    let reached = enabled.reach_speed(wanted.speed, None).await;
    if matches!(reached, Err(Error::Interrupted)) && wanted.time.is_none() {
        let actual = enabled.status().and_then(|status| status.speed_actual);
        observer.report(&Event::SpeedNotReached {
            wanted: wanted.speed,
            actual,
            unit: wanted.unit.symbol(),
        });
    }
    reached?;
    found.reached = true;
    Ok(())
}

/// Keeps the speed that was reached.
pub(super) async fn hold(
    enabled: &mut Enabled<'_>,
    speed: f64,
    time: Duration,
    found: &mut MotionResult,
) -> Result<(), Error> {
    let begin = enabled.session().0.now();
    let kept = enabled.keep_speed(speed, time).await;
    found.time_at_speed = Some((enabled.session().0.now() - begin).as_secs_f64());
    kept
}

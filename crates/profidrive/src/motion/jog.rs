//! Jogging: by the jog function of the drive, or at a speed of the telegram.

use std::time::Duration;

use client::axis::{Jog as Setpoint, Purpose, SpeedUnit};
use client::change::{Change, ChangeSet};
use client::{Axis, Drive, Enabled, Error, JogSpeed, Session, TemporaryChange};
use profile::notation::{Number, ParameterReference, Quantity};
use profile::value::{Assignment, CheckedValue, Content, Reading};

use super::axis::{Done, Restored, Taken, check_controller_loss, report_rounded, report_switch};
use super::check::checked_axis;
use super::error::{End, MotionError};
use super::event::{Event, Observer, Setting};
use super::leftover::{Leftover, NoteFile, UnreadableNote};
use super::limit::{self, within};
use super::plan::{JogChange, JogPlan};
use super::report::{MotionResult, Report};
use super::speed::Speed;
use super::start::Start;
use super::{Control, SPEED_LIMIT};
use crate::report;

/// A jog by the jog function of the drive, in velocity or position mode.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Jog {
    /// Which jog setpoint of the drive: STW1 bit 8 or bit 9.
    pub setpoint: Setpoint,
    /// Jog speed for this time: the parameter of the drive is set and put back. When `None` the drive keeps its own.
    pub speed: Option<Speed>,
    /// How long to jog.
    pub time: Duration,
    /// Any speed above this is refused.
    pub limit: Speed,
    /// What all motions have in common.
    pub control: Control,
}

/// A jog at a speed of the telegram (real-time jogging, STW1 bits 12 and 13). No parameter of the drive is changed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RealTimeJog {
    /// Speed.
    pub speed: Speed,
    /// How long to jog.
    pub time: Duration,
    /// Any speed above this is refused.
    pub limit: Speed,
    /// What all motions have in common.
    pub control: Control,
}

impl Jog {
    /// At the jog speed 1 of the drive, up to [`SPEED_LIMIT`].
    #[must_use]
    pub fn lasting(time: Duration) -> Self {
        Self {
            setpoint: Setpoint::One,
            speed: None,
            time,
            limit: Speed::Rpm(SPEED_LIMIT),
            control: Control::default(),
        }
    }

    /// Checks what is wrong whatever the drive is like.
    ///
    /// # Errors
    /// A speed above the limit.
    pub fn check(&self) -> Result<(), MotionError> {
        self.speed
            .map_or(Ok(()), |speed| known(speed, self.limit, &self.control))
    }

    async fn in_rpm(
        &self,
        session: &mut Session,
        drive: &mut Drive,
        observer: &Observer,
    ) -> Result<InRpm, MotionError> {
        let speed = match self.speed {
            Some(speed) => Some(speed.in_rpm(session, drive, observer).await?),
            None => None,
        };
        let limit = limit_in_rpm(self.limit, session, drive).await?;
        Ok(InRpm { speed, limit })
    }
}

impl RealTimeJog {
    /// At a speed, up to [`SPEED_LIMIT`].
    #[must_use]
    pub fn at(speed: Speed, time: Duration) -> Self {
        Self {
            speed,
            time,
            limit: Speed::Rpm(SPEED_LIMIT),
            control: Control::default(),
        }
    }

    /// Checks what is wrong whatever the drive is like.
    ///
    /// # Errors
    /// A speed above the limit.
    pub fn check(&self) -> Result<(), MotionError> {
        known(self.speed, self.limit, &self.control)
    }

    /// Returns the same with the speeds in rpm, checked.
    async fn in_rpm(
        &self,
        session: &mut Session,
        drive: &mut Drive,
        observer: &Observer,
    ) -> Result<(f64, f64), MotionError> {
        let speed = self.speed.in_rpm(session, drive, observer).await?;
        let limit = limit_in_rpm(self.limit, session, drive).await?;
        within(speed, limit, SpeedUnit::Rpm, &self.control)?;
        Ok((speed, limit))
    }
}

/// The speeds of a [`Jog`] in rpm.
#[derive(Clone, Copy)]
struct InRpm {
    speed: Option<f64>,
    limit: f64,
}

/// Checks a speed where its relation to the limit is known without the drive.
fn known(speed: Speed, limit: Speed, control: &Control) -> Result<(), MotionError> {
    match (speed, limit) {
        (Speed::Rpm(speed), Speed::Rpm(limit)) => within(speed, limit.abs(), SpeedUnit::Rpm, control),
        _ => Ok(()),
    }
}

/// The motor data that convert it are reported with the speed.
async fn limit_in_rpm(limit: Speed, session: &mut Session, drive: &mut Drive) -> Result<f64, MotionError> {
    let silent = Observer::default();
    Ok(limit.in_rpm(session, drive, &silent).await?.abs())
}

/// Jogs by the jog function of the drive. A jog speed that is set for the time is put back, whatever happened; the value
/// before is noted on the disk until then.
///
/// # Errors
/// Nothing is sent where a limit, the loss reaction or another controller speaks against it; else when the axis does not
/// turn, and when the caller stops it before its end.
pub async fn jog(
    session: &mut Session,
    drive: &mut Drive,
    wanted: &Jog,
    observer: &Observer,
) -> Result<Report, MotionError> {
    let wanted = &Jog {
        control: wanted.control.on(session, drive),
        ..*wanted
    };
    wanted.check()?;
    let setting = session.jog_speed(drive, wanted.setpoint).await?;
    // dropped after the axis: a change of the speed is put back once that is at rest
    let mut change = None;
    let result = with_setting(session, drive, wanted, &setting, &mut change, observer).await;
    let mut restored = Vec::new();
    if let Some(SpeedChange { before, change }) = change {
        let done = change.put_back().await;
        let refused = done.map(|done| done.into_iter().find_map(|one| one.result.err()));
        let one = Restored {
            setting: Some(Setting::Reading {
                parameter: setting.selection.label(),
                reading: Box::new(before),
            }),
            result: match refused {
                Ok(None) => Ok(()),
                Ok(Some(error)) | Err(error) => Err(error.to_string()),
            },
        };
        restored.push(one.reported(observer));
    }
    result?.report(restored, observer, (session, drive)).await
}

/// Jogs at a speed of the telegram.
///
/// # Errors
/// As [`jog`].
pub async fn jog_in_real_time(
    session: &mut Session,
    drive: &mut Drive,
    wanted: &RealTimeJog,
    observer: &Observer,
) -> Result<Report, MotionError> {
    let wanted = &RealTimeJog {
        control: wanted.control.on(session, drive),
        ..*wanted
    };
    wanted.check()?;
    check_controller_loss(session, drive, &wanted.control, observer).await?;
    let (speed, limit) = wanted.in_rpm(session, drive, observer).await?;
    let facts = session.motion_facts(drive).await?;
    report_switch(speed, &facts, observer);
    real_time_speed(session, drive, (speed, limit), observer).await?;
    let settings = wanted.control.settings(Purpose::RealTimeJog, limit);
    let start = Start::RealTimeJog {
        speed,
        time: wanted.time,
    };
    let axis = session.take_axis(drive, settings).await?;
    let mut taken = Taken::begin(axis, End::Time, start, false, observer).await?;
    let mut found = MotionResult::default();
    let motion = async |enabled: &mut Enabled<'_>| {
        enabled.jog_at(speed).await?;
        keep(enabled, speed, wanted.time, &mut found, observer).await
    };
    let result = taken.move_by(motion).await;
    found.speed = taken.speed();
    let done = taken.finish(result, found).await;
    done.report(Vec::new(), observer, (session, drive)).await
}

/// Reads and checks everything that [`jog`] does; nothing is sent that changes anything.
///
/// # Errors
/// As [`jog`] before it takes the axis, and when something keeps the drive from running.
pub async fn plan_jog(
    session: &mut Session,
    drive: &mut Drive,
    wanted: &Jog,
    observer: &Observer,
) -> Result<JogPlan, MotionError> {
    let wanted = &Jog {
        control: wanted.control.on(session, drive),
        ..*wanted
    };
    wanted.check()?;
    check_controller_loss(session, drive, &wanted.control, observer).await?;
    let InRpm { speed: asked, limit } = wanted.in_rpm(session, drive, observer).await?;
    let settings = wanted.control.settings(Purpose::Jog, limit);
    let (_, telegrams) = checked_axis(session, drive, &settings, None, observer).await?;
    let setting = session.jog_speed(drive, wanted.setpoint).await?;
    let before = session.read_one(drive, &setting.selection).await?;
    let note = NoteFile::of(session, drive, setting.number);
    // reported, and in a dry run nothing else
    let _ = left_over(&note, &before, observer);
    let mut speed = setting.rpm(&before).unwrap_or(0.0);
    let mut change = None;
    if let Some(asked) = asked {
        let quantity = setting.quantity(&rpm(asked));
        let value = drive
            .parameters
            .check(&setting.selection, &quantity.into())
            .map_err(Error::from)?;
        let mut after = before.clone();
        after.content = Content::Number {
            raw: value.raw.into(),
            engineering: value.engineering,
        };
        speed = setting.rpm(&after).unwrap_or(asked);
        report_rounded(asked, speed, SpeedUnit::Rpm.symbol(), observer);
        change = (before.raw() != after.raw()).then(|| {
            Box::new(JogChange {
                parameter: setting.selection.label(),
                before,
                after,
            })
        });
    }
    within(speed, limit, SpeedUnit::Rpm, &wanted.control)?;
    limit::jog(speed, &session.motion_facts(drive).await?, drive)?;
    Ok(JogPlan {
        drive: drive.label(),
        dry_run: true,
        speed: report::Quantity::rpm(speed),
        time: wanted.time.as_secs_f64(),
        change,
        telegrams,
    })
}

/// Reads and checks everything that [`jog_in_real_time`] does; nothing is sent that changes anything.
///
/// # Errors
/// As [`jog_in_real_time`] before it takes the axis, and when something keeps the drive from running.
pub async fn plan_jog_in_real_time(
    session: &mut Session,
    drive: &mut Drive,
    wanted: &RealTimeJog,
    observer: &Observer,
) -> Result<JogPlan, MotionError> {
    let wanted = &RealTimeJog {
        control: wanted.control.on(session, drive),
        ..*wanted
    };
    wanted.check()?;
    check_controller_loss(session, drive, &wanted.control, observer).await?;
    let speeds = wanted.in_rpm(session, drive, observer).await?;
    let settings = wanted.control.settings(Purpose::RealTimeJog, speeds.1);
    let (_, telegrams) = checked_axis(session, drive, &settings, None, observer).await?;
    Ok(JogPlan {
        drive: drive.label(),
        dry_run: true,
        speed: report::Quantity::rpm(real_time_speed(session, drive, speeds, observer).await?),
        time: wanted.time.as_secs_f64(),
        change: None,
        telegrams,
    })
}

/// A jog speed that is changed for a jog, and its value before.
struct SpeedChange {
    before: Reading,
    change: TemporaryChange,
}

async fn with_setting(
    session: &mut Session,
    drive: &mut Drive,
    wanted: &Jog,
    setting: &JogSpeed,
    change: &mut Option<SpeedChange>,
    observer: &Observer,
) -> Result<Done, MotionError> {
    check_controller_loss(session, drive, &wanted.control, observer).await?;
    let InRpm { speed: asked, limit } = wanted.in_rpm(session, drive, observer).await?;
    let facts = session.motion_facts(drive).await?;
    if let Some(speed) = asked {
        within(speed, limit, SpeedUnit::Rpm, &wanted.control)?;
        limit::jog(speed, &facts, drive)?;
    }
    let settings = wanted.control.settings(Purpose::Jog, limit);
    let mut axis = session.take_axis(drive, settings).await?;
    let reading = prepared(&mut axis, asked, setting, change, observer).await?;
    let speed = setting.rpm(&reading).unwrap_or(0.0);
    within(speed, limit, SpeedUnit::Rpm, &wanted.control)?;
    limit::jog(speed, &facts, drive)?;
    report_switch(speed, &facts, observer);
    let start = Start::Jog {
        speed: Box::new(reading),
        time: wanted.time,
    };
    let mut taken = Taken::begin(axis, End::Time, start, false, observer).await?;
    let mut found = MotionResult::default();
    let motion = async |enabled: &mut Enabled<'_>| {
        enabled.jog(wanted.setpoint).await?;
        keep(enabled, speed, wanted.time, &mut found, observer).await
    };
    let result = taken.move_by(motion).await;
    found.speed = taken.speed();
    Ok(taken.finish(result, found).await)
}

/// What a killed program left, if the drive still has this value of it; reported, also where that is not known.
fn left_over(
    note: &NoteFile,
    speed: &Reading,
    observer: &Observer,
) -> Result<Option<Leftover>, UnreadableNote> {
    let left = note
        .read()
        .map(|left| left.filter(|left| speed.raw() == Some(left.set)));
    match &left {
        Ok(Some(left)) => observer.report(&Event::LeftOver(left.clone())),
        Ok(None) => {}
        Err(unreadable) => observer.report(&Event::NoteUnreadable(unreadable.clone())),
    }
    left
}

/// The jog speed as it is to be, what a killed program left put back before.
async fn prepared(
    axis: &mut Axis,
    asked: Option<f64>,
    setting: &JogSpeed,
    change: &mut Option<SpeedChange>,
    observer: &Observer,
) -> Result<Reading, MotionError> {
    let (session, drive) = axis.session();
    let (selection, number) = (setting.selection, setting.number);
    let parameter = selection.label();
    let mut speed = session.read_one(drive, &selection).await?;
    let note = NoteFile::of(session, drive, number);
    let noted = left_over(&note, &speed, observer);
    if let Ok(Some(left)) = &noted {
        let mut set = plan_speed(session, drive, number, &left.old).await?;
        session.apply(drive, &mut set).await?;
        set.accepted()?;
        note.clear();
        observer.report(&Event::PutBack(Setting::Noted {
            parameter: parameter.clone(),
            value: left.old.clone(),
        }));
        speed = session.read_one(drive, &selection).await?;
    }
    let Some(asked) = asked else {
        return Ok(speed);
    };
    let mut set = plan_speed(session, drive, number, &setting.quantity(&rpm(asked))).await?;
    let planned = set.changes().first();
    if let Some(rounding) = planned
        .and_then(|one| one.rounding)
        .filter(CheckedValue::is_rounded)
    {
        report_rounded(rounding.asked, rounding.engineering, rounding.unit, observer);
    }
    // what the drive has already is neither written nor put back
    if planned.is_none_or(Change::is_same) {
        return Ok(speed);
    }
    let temporary = session.temporarily(drive, std::slice::from_ref(&speed))?;
    // a note that is not readable stays: a person may need it
    let mut unnoted = noted
        .err()
        .map(|unreadable| format!("{} is kept", unreadable.file.display()));
    let keeps = unnoted.is_none();
    if keeps {
        let note = note.clone();
        temporary.once_restored(move || note.clear());
    }
    *change = Some(SpeedChange {
        before: speed.clone(),
        change: temporary,
    });
    let mut keep = |set: &ChangeSet| {
        if keeps && let Err(cause) = note.write(set) {
            unnoted.get_or_insert(cause);
        }
        Ok(())
    };
    let applied = session.apply_kept(drive, &mut set, &mut keep).await;
    if let Some(cause) = unnoted {
        let reading = Box::new(speed);
        let setting = Setting::Reading { parameter, reading };
        observer.report(&Event::NotNoted { setting, cause });
    }
    applied?;
    set.accepted()?;
    Ok(session.read_one(drive, &selection).await?)
}

/// Keeps a jog at this speed.
pub(super) async fn keep(
    enabled: &mut Enabled<'_>,
    speed: f64,
    time: Duration,
    found: &mut MotionResult,
    observer: &Observer,
) -> Result<(), Error> {
    let begin = enabled.session().0.now();
    let kept = enabled.keep_jog(speed, time).await;
    found.time_at_speed = Some((enabled.session().0.now() - begin).as_secs_f64());
    kept?;
    match enabled.held_back().await {
        Some(evidence) => observer.report(&Event::HeldBack(evidence)),
        None => found.reached = true,
    }
    Ok(())
}

/// The speed as MDI_VELOCITY carries it, once nothing speaks against it.
async fn real_time_speed(
    session: &mut Session,
    drive: &mut Drive,
    (asked, limit): (f64, f64),
    observer: &Observer,
) -> Result<f64, Error> {
    let speed = session.check_jog(drive, asked, limit).await?;
    report_rounded(asked, speed, SpeedUnit::Rpm.symbol(), observer);
    Ok(speed)
}

fn rpm(speed: f64) -> Quantity {
    Quantity {
        number: Number::Decimal(speed),
        unit: Some("rpm".into()),
    }
}

async fn plan_speed(
    session: &mut Session,
    drive: &mut Drive,
    pnu: u16,
    speed: &Quantity,
) -> Result<ChangeSet, Error> {
    let assignment = Assignment {
        reference: ParameterReference::number(pnu),
        value: speed.clone().into(),
    };
    session.plan_write(drive, &[assignment], false).await
}

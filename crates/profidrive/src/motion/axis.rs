//! What all motions share once the axis is taken: how it is shown and measured, how it ends.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use client::axis::{Goal, MotionFacts, Seen, SpeedUnit};
use client::{Axis, AxisStatus, Drive, Enabled, Error, Released, Rest, Session};

use super::Control;
use super::error::{End, MotionError, explained};
use super::event::{Arrival, Ended, Event, Observer, Setting, TelegramChange};
use super::report::{Frames, MotionResult, PutBack, Report};
use super::start::Start;
use super::tap::Tapped;
use crate::report::Quantity;

/// From which time on a stop is a long one.
const LONG_STOP: Duration = Duration::from_secs(1);
/// How far an axis may be away from where it was before that is reported, turns.
const LEFT: f64 = 0.01;
const SECONDS_PER_MINUTE: f64 = 60.0;

/// Refuses a drive that may run on without its controller, unless that is consented to; then it is an event.
pub(super) async fn check_controller_loss(
    session: &mut Session,
    drive: &mut Drive,
    control: &Control,
    observer: &Observer,
) -> Result<(), Error> {
    let loss = session.loss_reaction(drive).await?;
    loss.permit(drive, control.may_run_on)?;
    if !loss.action.stops() {
        observer.report(&Event::RunsOn(loss));
    }
    Ok(())
}

/// Reports that a speed travels as another one.
pub(super) fn report_rounded(asked: f64, sent: f64, unit: &'static str, observer: &Observer) {
    if (asked - sent).abs() > f64::EPSILON {
        observer.report(&Event::Rounded { asked, sent, unit });
    }
}

/// Reports a limit switch in the direction of the commanded motion.
pub(super) fn report_switch(speed: f64, facts: &MotionFacts, observer: &Observer) {
    if facts.is_at_switch(speed) {
        observer.report(&Event::AtSwitch);
    }
}

/// Where the axis is once the power stage is off, if it has left its place since.
fn left(place: Option<f64>, now: Option<f64>) -> Option<f64> {
    now.zip(place)
        .filter(|(now, place)| (now - place).abs() > LEFT)
        .map(|(now, _)| now)
}

/// What the axis did, by its status at every look.
#[derive(Debug, Default)]
struct Course {
    time: Duration,
    /// What the speeds are in.
    unit: SpeedUnit,
    speed: Option<f64>,
    highest: Option<f64>,
    first_position: Option<f64>,
    position: Option<f64>,
    /// Speed over time, in turns.
    turned: Option<f64>,
    stop: LongStop,
}

impl Course {
    fn look(&mut self, status: &AxisStatus) {
        if status.lost {
            return;
        }
        let passed = status.time.saturating_sub(self.time).as_secs_f64();
        self.time = status.time;
        self.unit = status.unit;
        if let Some(speed) = status.speed_actual {
            if status.unit == SpeedUnit::Rpm {
                let mean = (speed + self.speed.unwrap_or(speed)) / 2.0;
                *self.turned.get_or_insert(0.0) += mean * passed / SECONDS_PER_MINUTE;
            }
            let fastest = self.highest.is_none_or(|highest| speed.abs() > highest.abs());
            self.highest = if fastest { Some(speed) } else { self.highest };
            self.speed = Some(speed);
        }
        if let Some(position) = status.position {
            self.first_position.get_or_insert(position);
            self.position = Some(position);
        }
    }

    fn complete(&self, found: MotionResult) -> MotionResult {
        MotionResult {
            highest_speed: self.highest.map(|speed| Quantity::speed(speed, self.unit)),
            distance: self.distance().map(Quantity::turns),
            ..found
        }
    }

    fn distance(&self) -> Option<f64> {
        match self.position.zip(self.first_position) {
            Some((last, first)) => Some(last - first),
            None => self.turned,
        }
    }
}

/// A ramp that takes its time is reported once.
#[derive(Debug, Default)]
struct LongStop {
    since: Option<Duration>,
    reported: bool,
}

impl LongStop {
    fn is_news(&mut self, status: &AxisStatus) -> bool {
        if status.view.goal != Goal::Stop || status.view.at_rest || status.view.quick_stop || status.lost {
            self.since = None;
            return false;
        }
        let since = *self.since.get_or_insert(status.time);
        if self.reported || status.time.saturating_sub(since) < LONG_STOP {
            return false;
        }
        self.reported = true;
        true
    }
}

/// An axis under control, watched and measured.
#[derive(Debug)]
pub(super) struct Taken {
    pub(super) axis: Axis,
    observer: Observer,
    course: Arc<Mutex<Course>>,
    end: End,
    tapped: Option<Tapped>,
}

impl Taken {
    /// Reports the start and what taking the axis has changed at the drive, and watches it from now on.
    ///
    /// # Errors
    /// When the tap of the observer does not begin: the axis is released.
    pub(super) async fn begin(
        mut axis: Axis,
        end: End,
        start: Start,
        set_mode: bool,
        observer: &Observer,
    ) -> Result<Self, MotionError> {
        let tapped = match observer.tap().map(|tap| Tapped::begin(&axis, tap)).transpose() {
            Ok(tapped) => tapped,
            Err(error) => {
                let _ = axis.release().await;
                return Err(error);
            }
        };
        let telegram = axis.telegram();
        observer.report(&Event::Starting { telegram, start });
        if let Some(before) = axis.telegram_before() {
            observer.report(&Event::TelegramChanged(TelegramChange {
                before,
                now: telegram,
                kept: !set_mode,
            }));
        }
        if let Some(strained) = axis.strained() {
            observer.report(&Event::Strained(strained));
        }
        let course = Arc::new(Mutex::new(Course::default()));
        let warned = observer.clone();
        axis.watch_warnings(move |status, warnings| {
            warned.report(&Event::Warnings {
                status: *status,
                warnings: warnings.to_vec(),
            });
        });
        let (watched, shown, samples) = (Arc::clone(&course), observer.clone(), tapped.clone());
        axis.watch(move |status| {
            if let Some(samples) = &samples {
                samples.take();
            }
            let long = {
                let mut course = locked(&watched);
                course.look(status);
                course.stop.is_news(status)
            };
            shown.report(&Event::Sample(*status));
            if long {
                shown.report(&Event::LongStop);
            }
        });
        Ok(Self {
            axis,
            observer: observer.clone(),
            course,
            end,
            tapped,
        })
    }

    /// The samples that follow are no part of the motion.
    pub(super) fn end_tap(&self) {
        if let Some(tapped) = &self.tapped {
            tapped.end();
        }
    }

    pub(super) const fn observer(&self) -> &Observer {
        &self.observer
    }

    /// Enables the axis and moves it.
    pub(super) async fn move_by(
        &mut self,
        motion: impl AsyncFnOnce(&mut Enabled<'_>) -> Result<(), Error>,
    ) -> Result<(), Error> {
        motion(&mut self.axis.enable().await?).await
    }

    /// What follows is measured as a motion of its own.
    pub(super) fn begin_course(&self) {
        let mut course = locked(&self.course);
        *course = Course {
            time: course.time,
            ..Course::default()
        };
    }

    /// Returns what the motion was like until now; the axis is kept.
    pub(super) fn report(&self, found: MotionResult) -> Report {
        let view = self.axis.status().filter(|status| !status.lost);
        let view = view.map(|status| status.view);
        let rest = match view {
            None => Rest::Unknown,
            Some(view) if !view.turns => Rest::Stands,
            Some(view) if view.seen.is_some_and(Seen::pulses_off) => Rest::Coasts,
            Some(_) => Rest::Runs,
        };
        Report {
            rest,
            coasts: rest == Rest::Coasts,
            frames: Frames::of(self.axis.statistics()),
            result: locked(&self.course).complete(found),
            ..Report::default()
        }
    }

    /// The last speed of the motor that was seen.
    pub(super) fn speed(&self) -> Option<Quantity> {
        let course = locked(&self.course);
        course.speed.map(|speed| Quantity::speed(speed, course.unit))
    }

    /// Waits for the stop and reports where the axis arrived, and whether it has left that place since.
    pub(super) async fn arrived(
        &mut self,
        arrival: Arrival,
        place: Option<f64>,
        result: &Result<(), Error>,
    ) -> Option<f64> {
        // how it ended is reported with the release
        let _ = self.axis.stopped().await;
        let now = self.axis.status().and_then(|status| status.position);
        let left_to = left(place, now).filter(|_| result.is_ok());
        if result.is_ok() {
            let per_turn = self.axis.drive().counts_per_turn();
            self.observer.report(&Event::Arrived {
                arrival,
                position: place,
                counts: place.map(|place| place * per_turn),
                left_to,
            });
        }
        left_to
    }

    /// Stops and releases the axis whatever happened.
    pub(super) async fn finish(self, result: Result<(), Error>, found: MotionResult) -> Done {
        let statistics = self.axis.statistics();
        // a ramp that was under way may have ended meanwhile, by a trip for example
        let Released {
            rest,
            closed,
            result: released,
            ..
        } = self.axis.release_and_look().await;
        if let Some(tapped) = self.tapped {
            tapped.end();
        }
        let interrupted = matches!(result, Err(Error::Interrupted));
        let result = match (result, self.end) {
            (Err(Error::Interrupted), End::Open) => Ok(()),
            (other, _) => other,
        };
        let report = Report {
            released: closed,
            rest,
            coasts: rest == Rest::Coasts,
            interrupted: interrupted && self.end != End::Open,
            frames: Frames::of(statistics),
            result: locked(&self.course).complete(found),
            ..Report::default()
        };
        Done {
            ended: Ended {
                statistics,
                interrupted,
                report,
            },
            result: result.and(released),
            end: self.end,
        }
    }
}

/// A motion whose axis is released. What it changed at the drive is put back before it counts as ended.
pub(super) struct Done {
    ended: Ended,
    result: Result<(), Error>,
    end: End,
}

impl Done {
    /// Reports how the motion ended, and what was put back and what was not.
    pub(super) async fn report(
        self,
        put_back: Vec<Restored>,
        observer: &Observer,
        (session, drive): (&mut Session, &mut Drive),
    ) -> Result<Report, MotionError> {
        let Self {
            mut ended,
            result,
            end,
        } = self;
        for Restored { setting, result } in &put_back {
            let failed = result.as_ref().err().cloned();
            ended.report.put_back.push(PutBack::of(setting.as_ref(), failed));
        }
        let report = ended.report.clone();
        observer.report(&Event::Ended(Box::new(ended)));
        match result {
            Ok(()) if put_back.iter().all(|one| one.result.is_ok()) => Ok(report),
            Ok(()) => Err(MotionError::NotPutBack {
                drive: drive.label(),
                report: Box::new(report),
            }),
            Err(error) => Err(explained(error, end, report, session, drive).await),
        }
    }
}

/// A setting that was changed for a motion, after it.
#[derive(Debug)]
pub(super) struct Restored {
    /// The setting with its value from before; `None` where mode and telegram of the drive cannot be read.
    pub(super) setting: Option<Setting>,
    /// Why it was not put back.
    pub(super) result: Result<(), String>,
}

impl Restored {
    /// Reports what became of a setting.
    pub(super) fn reported(self, observer: &Observer) -> Self {
        observer.report(&match (&self.result, &self.setting) {
            (Ok(()), Some(setting)) => Event::PutBack(setting.clone()),
            (Ok(()), None) => return self,
            (Err(cause), setting) => Event::NotPutBack {
                setting: setting.clone(),
                cause: cause.clone(),
            },
        });
        self
    }
}

fn locked(course: &Mutex<Course>) -> MutexGuard<'_, Course> {
    course.lock().unwrap_or_else(PoisonError::into_inner)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_axis_that_rolls_away_has_left_its_place() {
        assert_eq!(left(Some(1.0), Some(1.005)), None);
        assert_eq!(left(Some(1.0), Some(1.5)), Some(1.5));
        assert_eq!(left(None, Some(1.5)), None);
    }

    #[test]
    fn a_distance_is_that_of_the_position_where_there_is_one() {
        let mut course = Course {
            turned: Some(3.0),
            ..Course::default()
        };
        assert_eq!(course.distance(), Some(3.0));
        (course.first_position, course.position) = (Some(1.0), Some(0.5));
        assert_eq!(course.distance(), Some(-0.5));
    }
}

//! A step of the speed, with every cyclic sample of it.

use std::time::Duration;

use client::axis::{AxisSignal, Sample};
use client::{Drive, Enabled, Error, Session};
use profile::state::Mode;
use profile::telegram::signal;

use super::axis::Taken;
use super::error::{End, MotionError};
use super::event::Observer;
use super::report::{MotionResult, Report};
use super::response::{StepPoint, step_in};
use super::run::{Frequency, Run, permitted, permitted_speed};
use super::start::Start;
use super::{Response, mode};
use crate::report::Quantity;

/// How long the first speed is kept before the step.
const BEFORE: Duration = Duration::from_millis(300);
/// The longest step that is recorded, with the way to the first speed.
pub const LONGEST_STEP: Duration = Duration::from_secs(60);
/// Samples of the shortest cycle in that time, and what the ramps to the first speed take.
const MOST_SAMPLES: usize = 120_000;

/// A step from one speed to another, which is kept for some time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Step {
    /// Speed before the step, in the unit of `run`; an output frequency in Hz where `run` has one.
    pub from: f64,
    /// The speed after the step, the time for which it is commanded, and what all motions have in common.
    pub run: Run,
    /// Share of the step to either side of the new speed within which it counts as settled: 0.02.
    pub band: f64,
}

/// What a step was like.
#[derive(Debug, Clone)]
pub struct Stepped {
    /// The motion.
    pub report: Report,
    /// The figures; `None` where the connection carries no speed or the step was not seen.
    pub response: Option<Response>,
    /// Every sample, from the first one under control to the end of the step.
    pub samples: Vec<Sample>,
    /// Samples that were lost on the way.
    pub dropped: u64,
    /// Cycles without a sample.
    pub missed: u64,
    /// The times of the figures are exact to this: the longest time between two samples of the step, one cycle at least.
    pub resolution: Duration,
    /// The signals of the samples.
    pub signals: Vec<AxisSignal>,
    /// The update time.
    pub cycle: Duration,
    /// The drive.
    pub drive: String,
}

impl Step {
    /// Checks what is wrong whatever the drive is like.
    ///
    /// # Errors
    /// A speed above the limit, speeds that are no step, a time that is missing or too long, a band that is none.
    pub fn check(&self) -> Result<(), MotionError> {
        self.run.check()?;
        self.before().check()?;
        let invalid = |what| Err(MotionError::Invalid { what });
        let to = self.run.frequency.map_or(self.run.speed, |to| to.hertz);
        if (to - self.from).abs() < f64::EPSILON {
            return invalid("both speeds of the step are the same");
        }
        if !(self.band > 0.0 && self.band < 1.0) {
            return invalid("the band of a step is more than 0 % and less than 100 %");
        }
        match self.run.time {
            Some(time) if !time.is_zero() && time <= LONGEST_STEP => Ok(()),
            _ => invalid("a step lasts up to 60 s"),
        }
    }

    /// The speed before the step, as a run.
    fn before(&self) -> Run {
        match self.run.frequency {
            None => Run {
                speed: self.from,
                ..self.run
            },
            Some(to) => Run {
                frequency: Some(Frequency {
                    hertz: self.from,
                    ..to
                }),
                ..self.run
            },
        }
    }

    /// Returns the step with its speeds in place of frequencies.
    ///
    /// # Errors
    /// Where the drive is not a frequency converter or its motor data are not valid, and a speed above the limit.
    pub async fn in_rpm(
        &self,
        session: &mut Session,
        drive: &mut Drive,
        observer: &Observer,
    ) -> Result<Self, MotionError> {
        if self.run.frequency.is_none() {
            return Ok(*self);
        }
        let from = self.before().in_rpm(session, drive, &Observer::default()).await?;
        Ok(Self {
            from: from.speed,
            run: self.run.in_rpm(session, drive, observer).await?,
            ..*self
        })
    }
}

/// Turns the axis at one speed, then commands the other one at once and keeps it for some time. Every cyclic sample is
/// recorded. All rules of [`run`](super::run()) apply.
///
/// # Errors
/// As [`run`](super::run()).
pub async fn step(
    session: &mut Session,
    drive: &mut Drive,
    wanted: &Step,
    observer: &Observer,
) -> Result<Stepped, MotionError> {
    let control = wanted.run.control.on(session, drive);
    let run = Run {
        control,
        ..wanted.run
    };
    let wanted = &Step { run, ..*wanted };
    wanted.check()?;
    let wanted = &wanted.in_rpm(session, drive, observer).await?;
    let change = mode::enter(session, drive, Mode::Velocity, &wanted.run.control, observer).await?;
    let mut stepped = Stepped {
        report: Report::default(),
        response: None,
        samples: Vec::new(),
        dropped: 0,
        missed: 0,
        resolution: Duration::ZERO,
        signals: Vec::new(),
        cycle: Duration::ZERO,
        drive: drive.label(),
    };
    let result = turn(session, drive, wanted, observer, &mut stepped).await;
    let restored = mode::leave(change, observer).await;
    stepped.report = result?.report(restored, observer, (session, drive)).await?;
    let points = stepped.points();
    if let Some(at) = step_in(&points) {
        // the step itself is between two samples
        let seen = points.get(at.saturating_sub(1)..).unwrap_or_default();
        stepped.resolution = longest_gap(seen).max(stepped.cycle);
        let points = points.get(at..).unwrap_or_default();
        stepped.response = Response::of(points, wanted.from, wanted.run.speed, wanted.band);
    }
    Ok(stepped)
}

/// Returns the longest time between two points.
fn longest_gap(points: &[StepPoint]) -> Duration {
    let gaps = points.windows(2).map(|pair| match pair {
        [before, after] => after.time - before.time,
        _ => 0.0,
    });
    Duration::try_from_secs_f64(gaps.fold(0.0, f64::max)).unwrap_or_default()
}

async fn turn(
    session: &mut Session,
    drive: &mut Drive,
    wanted: &Step,
    observer: &Observer,
    stepped: &mut Stepped,
) -> Result<super::axis::Done, MotionError> {
    permitted_speed(session, drive, &wanted.before(), observer).await?;
    permitted(session, drive, &wanted.run, observer).await?;
    let axis = session.take_axis(drive, wanted.run.settings(drive)?).await?;
    let mut samples = axis.samples(MOST_SAMPLES);
    stepped.signals = axis.signals();
    stepped.cycle = axis.cycle();
    let set_mode = wanted.run.control.set_mode;
    let start = Start::Step {
        from: Quantity::speed(wanted.from, wanted.run.unit),
        to: Quantity::speed(wanted.run.speed, wanted.run.unit),
    };
    let mut taken = Taken::begin(axis, End::Time, start, set_mode, observer).await?;
    let mut found = MotionResult::default();
    let result = match taken.axis.enable().await {
        Ok(mut enabled) => both(&mut enabled, wanted, &mut found).await,
        Err(error) => Err(error),
    };
    found.speed = taken.speed();
    // the stop that follows is no part of the step
    taken.end_tap();
    while let Some(sample) = samples.take() {
        stepped.samples.push(sample);
    }
    stepped.dropped = samples.dropped();
    let counted = stepped.samples.first().zip(stepped.samples.last());
    let lost = counted.map_or(0, |(first, last)| last.missed.saturating_sub(first.missed));
    stepped.missed = lost + stepped.dropped;
    Ok(taken.finish(result, found).await)
}

async fn both(enabled: &mut Enabled<'_>, wanted: &Step, found: &mut MotionResult) -> Result<(), Error> {
    if wanted.from == 0.0 {
        enabled.run(0.0).await?;
    } else {
        enabled.reach_speed(wanted.from, None).await?;
    }
    enabled.hold(BEFORE).await?;
    enabled.run(wanted.run.speed).await?;
    let time = wanted.run.time.unwrap_or_default();
    enabled.hold(time).await?;
    let status = enabled.status();
    let actual = status.and_then(|status| status.speed_actual);
    let near = wanted
        .run
        .unit
        .near()
        .max((wanted.run.speed - wanted.from).abs() * wanted.band);
    found.reached = actual.is_some_and(|actual| (actual - wanted.run.speed).abs() <= near);
    found.time_at_speed = Some(time.as_secs_f64());
    Ok(())
}

impl Stepped {
    /// Returns commanded speed and speed of every sample; empty where the connection does not carry both.
    #[must_use]
    pub fn points(&self) -> Vec<StepPoint> {
        let find = |number| self.signals.iter().find(|one| one.field.signal.number == number);
        let Some((set, actual)) = find(signal::NSOLL_A).zip(find(signal::NIST_A)) else {
            return Vec::new();
        };
        let start = self.samples.first().map(|sample| sample.at);
        let value = |signal: &AxisSignal, sample: &Sample| signal.engineering(signal.raw(sample)?);
        let point = |sample: &Sample| {
            Some(StepPoint {
                time: (sample.at - start?).as_secs_f64(),
                set: value(set, sample)?,
                actual: value(actual, sample)?,
            })
        };
        self.samples.iter().filter_map(point).collect()
    }
}

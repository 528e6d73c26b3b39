//! `profidrive jog`

use std::time::Duration;

use client::axis::Jog as Setpoint;
use client::{Drive, Wait};
use profidrive::lasting;
use profidrive::motion::{self, JogPlan, MotionError, Observer, RealTimeJog, Start};

use super::axis::{self, Speed};
use super::recorded::Recorder;
use super::run::telegram_text;
use crate::args::{Jog, Target};
use crate::connect::{Live, Need};
use crate::failure::Failure;
use crate::output::Output;
use crate::render::{number, value};

pub fn run(args: &Jog, target: &Target, output: &Output) -> Result<(), Failure> {
    let speed = args.velocity.as_ref();
    let speed = speed
        .map(|quantity| Speed::of(quantity, "--velocity"))
        .transpose()?;
    let speeds = Speeds {
        speed,
        limit: Speed::of(&args.limit, "--limit")?,
    };
    let control = axis::enabling(&args.control)?;
    let mut recorder = Recorder::of(args.recorded.record.as_deref())?;
    if args.real_time {
        let wanted = RealTimeJog {
            control,
            ..RealTimeJog::at(0.0, args.time)
        };
        return real_time(args, wanted, speeds, &mut recorder, target, output);
    }
    let mut wanted = motion::Jog {
        setpoint: match args.jog {
            2 => Setpoint::Two,
            _ => Setpoint::One,
        },
        control,
        ..motion::Jog::lasting(args.time)
    };
    // what is wrong whatever the drive is like is found before it is connected
    if let (Some(Speed::Rpm(speed)), Speed::Rpm(limit)) = (speed, speeds.limit) {
        (wanted.speed, wanted.limit) = (Some(speed), limit.abs());
        wanted.check()?;
    }
    if args.dry_run {
        let plan = axis::moving(target, Need::Records, output, |session, drive, bound| {
            wanted.control.bound = bound;
            let observer = axis::observer(&drive.label(), Box::new(|_, _| None), output);
            (wanted.speed, wanted.limit) = speeds.in_rpm(session, drive, &observer)?;
            motion::plan_jog(session, drive, &wanted, &observer).wait()
        })?;
        show(&plan, output);
        return Ok(());
    }
    let time = lasting(args.time);
    let done = axis::moving(target, Need::Cyclic, output, |session, drive, bound| {
        wanted.control.bound = bound;
        let start = Box::new(move |start: &_, _| match start {
            Start::Jog { speed } => Some(format!("jogs at {} for {time}", value::full(speed))),
            _ => None,
        });
        let observer = recorder.tap(axis::observer(&drive.label(), start, output), session);
        (wanted.speed, wanted.limit) = speeds.in_rpm(session, drive, &observer)?;
        motion::jog(session, drive, &wanted, &observer).wait()
    });
    recorder.end(done, output).map(|_| ())
}

/// The speeds of a jog.
#[derive(Clone, Copy)]
struct Speeds {
    speed: Option<Speed>,
    limit: Speed,
}

impl Speeds {
    /// Returns speed and limit in rpm.
    fn in_rpm(
        self,
        session: &mut Live,
        drive: &mut Drive,
        observer: &Observer,
    ) -> Result<(Option<f64>, f64), MotionError> {
        let speed = match self.speed {
            Some(speed) => Some(speed.in_rpm(session, drive, observer)?),
            None => None,
        };
        let limit = self.limit.in_rpm(session, drive, &Observer::default())?;
        Ok((speed, limit.abs()))
    }
}

fn real_time(
    args: &Jog,
    mut wanted: RealTimeJog,
    speeds: Speeds,
    recorder: &mut Recorder,
    target: &Target,
    output: &Output,
) -> Result<(), Failure> {
    if let (Some(Speed::Rpm(speed)), Speed::Rpm(limit)) = (speeds.speed, speeds.limit) {
        (wanted.speed, wanted.limit) = (speed, limit.abs());
        wanted.check()?;
    }
    if args.dry_run {
        let plan = axis::moving(target, Need::Records, output, |session, drive, bound| {
            wanted.control.bound = bound;
            let observer = axis::observer(&drive.label(), Box::new(|_, _| None), output);
            let (speed, limit) = speeds.in_rpm(session, drive, &observer)?;
            (wanted.speed, wanted.limit) = (speed.unwrap_or_default(), limit);
            motion::plan_jog_in_real_time(session, drive, &wanted, &observer).wait()
        })?;
        show(&plan, output);
        return Ok(());
    }
    let given = args.velocity.as_ref().map_or_else(String::new, axis::speed_text);
    let time = lasting(args.time);
    let done = axis::moving(target, Need::Cyclic, output, |session, drive, bound| {
        wanted.control.bound = bound;
        let start = Box::new(move |_: &_, telegram| {
            Some(format!(
                "jogs at {given} for {time} (real-time jogging, telegram {telegram})"
            ))
        });
        let observer = recorder.tap(axis::observer(&drive.label(), start, output), session);
        let (speed, limit) = speeds.in_rpm(session, drive, &observer)?;
        (wanted.speed, wanted.limit) = (speed.unwrap_or_default(), limit);
        motion::jog_in_real_time(session, drive, &wanted, &observer).wait()
    });
    recorder.end(done, output).map(|_| ())
}

fn show(plan: &JogPlan, output: &Output) {
    if let Some(change) = &plan.change {
        let (before, after) = (value::full(&change.before), value::full(&change.after));
        output.say(&format!(
            "{} would be {before} -> {after} for this and back afterwards",
            change.parameter
        ));
    }
    output.say(&format!(
        "dry run: {} would jog at {} rpm for {}{}; nothing was sent",
        plan.drive,
        number(plan.speed.value),
        lasting(Duration::try_from_secs_f64(plan.time).unwrap_or_default()),
        telegram_text(&plan.telegrams)
    ));
    output.json_report(plan);
}

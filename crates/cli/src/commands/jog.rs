//! `profidrive jog`

use client::axis::Jog as Setpoint;
use client::{Drive, Wait};
use profidrive::motion::{self, JogPlan, MotionError, Observer, RealTimeJog, Speed};

use super::axis;
use super::recorded::Recorder;
use crate::args::{Jog, Target};
use crate::connect::{Live, Need};
use crate::failure::Failure;
use crate::output::Output;
use crate::render::value;

pub fn run(args: &Jog, target: &Target, output: &Output) -> Result<(), Failure> {
    let mut args = args.clone();
    let quantities = std::iter::once(&mut args.limit).chain(&mut args.velocity);
    let unit = axis::in_motor_units(target, quantities, output)?;
    let args = &args;
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
        let plan = axis::moving(
            target,
            Need::Records,
            output,
            |(session, drive), bound, observer| {
                wanted.control.bound = bound;
                (wanted.speed, wanted.limit) = speeds.in_rpm(session, drive, &observer)?;
                motion::plan_jog(session, drive, &wanted, &observer).wait()
            },
        )?;
        show(&plan, output);
        return Ok(());
    }
    let (report, recorded) = recorder.moving(target, output, |(session, drive), bound, observer| {
        wanted.control.bound = bound;
        (wanted.speed, wanted.limit) = speeds.in_rpm(session, drive, observer)?;
        motion::jog(session, drive, &wanted, observer).wait()
    })?;
    axis::show_travel(unit.as_ref(), &report, output);
    recorded
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
            Some(speed) => Some(speed.in_rpm(session, drive, observer).wait()?),
            None => None,
        };
        let limit = self.limit.in_rpm(session, drive, &Observer::default()).wait()?;
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
        let plan = axis::moving(
            target,
            Need::Records,
            output,
            |(session, drive), bound, observer| {
                wanted.control.bound = bound;
                let (speed, limit) = speeds.in_rpm(session, drive, &observer)?;
                (wanted.speed, wanted.limit) = (speed.unwrap_or_default(), limit);
                motion::plan_jog_in_real_time(session, drive, &wanted, &observer).wait()
            },
        )?;
        show(&plan, output);
        return Ok(());
    }
    let (_, recorded) = recorder.moving(target, output, |(session, drive), bound, observer| {
        wanted.control.bound = bound;
        let (speed, limit) = speeds.in_rpm(session, drive, observer)?;
        (wanted.speed, wanted.limit) = (speed.unwrap_or_default(), limit);
        motion::jog_in_real_time(session, drive, &wanted, observer).wait()
    })?;
    recorded
}

fn show(plan: &JogPlan, output: &Output) {
    if let Some(change) = &plan.change {
        let (before, after) = (value::full(&change.before), value::full(&change.after));
        output.say(&format!(
            "{} would be {before} -> {after} for this and back afterwards",
            change.parameter
        ));
    }
    output.say(&format!("dry run: {} would {plan}; nothing was sent", plan.drive));
    output.json_report(plan);
}

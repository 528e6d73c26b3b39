//! `profidrive jog`

use client::Wait;
use client::axis::Jog as Setpoint;
use profidrive::motion::{self, JogPlan, RealTimeJog};

use super::axis;
use super::recorded::Recorder;
use crate::args::{Jog, Target};
use crate::connect::Need;
use crate::failure::Failure;
use crate::output::Output;
use crate::render::value;

pub fn run(args: &Jog, target: &Target, output: &Output) -> Result<(), Failure> {
    let mut args = args.clone();
    let quantities = std::iter::once(&mut args.limit).chain(&mut args.velocity);
    let unit = axis::in_motor_units(target, quantities, output)?;
    let args = &args;
    let control = axis::enabling(&args.control)?;
    let mut recorder = Recorder::of(args.recorded.record.as_deref())?;
    if let Some(speed) = args.velocity.as_ref().filter(|_| args.real_time) {
        let wanted = RealTimeJog {
            control,
            ..RealTimeJog::of(speed, Some(&args.limit), args.time)?
        };
        return real_time(args, wanted, &mut recorder, target, output);
    }
    let wanted = motion::Jog {
        setpoint: match args.jog {
            2 => Setpoint::Two,
            _ => Setpoint::One,
        },
        control,
        ..motion::Jog::of(args.velocity.as_ref(), Some(&args.limit), args.time)?
    };
    // what is wrong whatever the drive is like is found before it is connected
    wanted.check()?;
    if args.dry_run {
        let plan = axis::moving(target, Need::Records, output, |(session, drive), observer| {
            motion::plan_jog(session, drive, &wanted, &observer).wait()
        })?;
        show(&plan, output);
        return Ok(());
    }
    let (report, recorded) = recorder.moving(target, output, |(session, drive), observer| {
        motion::jog(session, drive, &wanted, observer).wait()
    })?;
    axis::show_travel(unit.as_ref(), &report, output);
    recorded
}

fn real_time(
    args: &Jog,
    wanted: RealTimeJog,
    recorder: &mut Recorder,
    target: &Target,
    output: &Output,
) -> Result<(), Failure> {
    wanted.check()?;
    if args.dry_run {
        let plan = axis::moving(target, Need::Records, output, |(session, drive), observer| {
            motion::plan_jog_in_real_time(session, drive, &wanted, &observer).wait()
        })?;
        show(&plan, output);
        return Ok(());
    }
    let (_, recorded) = recorder.moving(target, output, |(session, drive), observer| {
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

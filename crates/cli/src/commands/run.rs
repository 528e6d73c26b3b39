//! `profidrive run`

use client::Wait;
use profidrive::motion::{self, RunPlan};

use super::axis;
use super::recorded::Recorder;
use crate::args::{Run, Target};
use crate::connect::Need;
use crate::failure::Failure;
use crate::output::Output;

pub fn run(args: &Run, target: &Target, output: &Output) -> Result<(), Failure> {
    let mut args = args.clone();
    let quantities = std::iter::once(&mut args.velocity).chain(&mut args.limit);
    let unit = axis::in_motor_units(target, quantities, output)?;
    let mut wanted = wanted(&args)?;
    let mut recorder = Recorder::of(args.recorded.record.as_deref())?;
    if args.dry_run {
        let plan = axis::moving(
            target,
            Need::Records,
            output,
            |(session, drive), bound, observer| {
                wanted.control.bound = bound;
                motion::plan_run(session, drive, &wanted, &observer).wait()
            },
        )?;
        show(&plan, output);
        return Ok(());
    }
    let (report, recorded) = recorder.moving(target, output, |(session, drive), bound, observer| {
        wanted.control.bound = bound;
        motion::run(session, drive, &wanted, observer).wait()
    })?;
    axis::show_travel(unit.as_ref(), &report, output);
    recorded
}

/// The requested speed, in one unit.
fn wanted(args: &Run) -> Result<motion::Run, Failure> {
    let reference = args.reference_speed.as_ref();
    let reference = reference.map(|speed| axis::rpm(speed, "--reference-speed"));
    let wanted = motion::Run {
        reference_speed: reference.transpose()?,
        telegram: args.telegram,
        time: args.time,
        control: axis::in_mode(&args.control)?,
        ..motion::Run::of(&args.velocity, args.limit.as_ref())?
    };
    wanted.check()?;
    Ok(wanted)
}

fn show(plan: &RunPlan, output: &Output) {
    output.say(&format!("dry run: {} would {plan}; nothing was sent", plan.drive));
    output.json_report(plan);
}

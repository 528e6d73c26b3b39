//! `profidrive move`

use client::{Error, Wait};
use profidrive::motion::{self, MoveReport};

use super::axis;
use super::recorded::Recorder;
use crate::args::{Move, Target};
use crate::connect::Need;
use crate::failure::Failure;
use crate::output::Output;

pub fn run(args: &Move, target: &Target, output: &Output) -> Result<(), Failure> {
    let mut args = args.clone();
    let ramps = args.acceleration.iter_mut().chain(&mut args.deceleration);
    let quantities = [&mut args.to, &mut args.velocity, &mut args.limit].into_iter();
    let unit = axis::in_motor_units(target, quantities.chain(ramps), output)?;
    let wanted = motion::Move::of(&args.to, args.relative, &args.velocity)?
        .with_ramps(args.acceleration.as_ref(), args.deceleration.as_ref())?
        .limited_to(&args.limit)?;
    let wanted = motion::Move {
        timeout: args.timeout,
        control: axis::in_mode(&args.control)?,
        ..wanted
    };
    wanted.check()?;
    let mut recorder = Recorder::of(args.recorded.record.as_deref())?;
    if args.dry_run {
        return try_out(wanted, target, output);
    }
    let (report, recorded) = recorder.moving(target, output, |(session, drive), observer| {
        motion::move_to(session, drive, &wanted, observer).wait()
    })?;
    axis::show_travel(unit.as_ref(), &report, output);
    recorded
}

/// Everything that `move` reads and checks; nothing is sent that changes anything.
fn try_out(wanted: motion::Move, target: &Target, output: &Output) -> Result<(), Failure> {
    let (plan, report) = axis::moving(target, Need::Records, output, |(session, drive), observer| {
        let plan = motion::plan_move(session, drive, &wanted, &observer).wait()?;
        let report = MoveReport::of(&plan, drive);
        Ok((plan, report))
    })?;
    output.say(&format!("dry run: {} {}; nothing moves", report.drive, plan));
    output.json_report(&report);
    if plan.objections.is_empty() {
        return Ok(());
    }
    Err(Error::Objections {
        drive: report.drive,
        objections: plan.objections,
    }
    .into())
}
